"""Flexibility of what holds pins: beams under several discs, and the ring of the pin wheel under all its pins.

What the forces on pins displace is :math:`u = -S f`, with one symmetric flexibility S: a pin is one beam under the forces of all
discs (`ltca.beam`), and the ring moves every pin by the forces on all of them, summed over the discs (`ltca.compliance.ring`).
Displacements of wheel pins are those in the turning wheel, so S does not turn. What a disc's own force makes a beam yield lies
along the common normal, in series with the contact, and is part of its law (`ltca.laws.backed`).

In slices a disc presses a pin with a moment as well, and the pin leans. Leans are kept as displacements at half the thickness
of the disc and moments as forces there, behind those of all discs, so that S stays symmetric. All that a beam bends is in S
then, also under its own disc. A ring moves seats and does not lean them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.beam import PinBeam
from ltca.compliance.ring import ring_flexibility
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam


@dataclass(frozen=True, slots=True, kw_only=True)
class PinDisplacements:
    """What displaces pins.

    Attributes
    ----------
    beams : array, shape (pairs, discs, discs) or (positions, pairs, discs, discs)
        Deflection of each pin at disc d under a unit force of disc d', wheel pins before shaft pins, mm/N; zero for d = d', and
        for pins that do not bend. Where pins lean, leans and moments follow, and d = d' is not zero.
    ring : array, shape (z_P, 2, z_P, 2) or (positions, z_P, 2, z_P, 2), or None
        Displacement (x, y) of the seats of the wheel pins in the wheel under unit forces at the seats, mm/N.
    leans : bool
        Whether pins lean.
    """

    beams: FloatArray = by_drive(3)
    ring: FloatArray | None = by_drive(4, default=None)
    leans: bool = False

    @classmethod
    def of_drive(cls, drive: Drive, lender: Drive | None = None) -> PinDisplacements | None:
        """Return what displaces the pins of a drive; None where they stand still but for what each disc alone bends.

        A ring of finite elements takes the shape of that of the `lender`, if one is given (`ring_flexibility`).
        """
        beams, ring = _beams(drive), ring_flexibility(drive, lender)
        if ring is None and not beams.any():
            return None
        return cls(beams=beams, ring=ring, leans=drive.contact.slices > 1)

    @property
    def discs(self) -> int:
        """Number of discs."""
        return int(self.beams.shape[-1]) // (1 + self.leans)

    def unmoved(self, positions: int) -> ComplexArray:
        """Return the displacements of pins that stand where they stand without load, shape (positions, discs, pairs)."""
        pairs, rows, _ = self.beams.shape[-3:]
        return np.zeros((positions, rows, pairs), dtype=complex)

    def under(self, force: ComplexArray) -> ComplexArray:
        """Return S f, mm, for forces on the pins by disc, N, shape (positions, discs, pairs)."""
        found: ComplexArray = np.matmul(self.beams.astype(complex), force.swapaxes(1, 2)[..., None])[..., 0].swapaxes(
            1, 2
        )
        if self.ring is not None:
            found[:, : self.discs, : self.ring.shape[-2]] += self.of_ring(force)[:, None]
        return found

    def of_ring(self, force: ComplexArray) -> ComplexArray:
        """Return the part of the ring in S f, the same for all discs, shape (positions, z_P)."""
        if self.ring is None:
            return np.zeros((force.shape[0], 0), dtype=complex)
        seats = self.ring.shape[-2]
        total = force[:, : self.discs, :seats].sum(axis=1)
        flat = np.stack((total.real, total.imag), axis=-1).reshape(-1, 2 * seats, 1)
        matrix = self.ring.reshape(*self.ring.shape[:-4], 2 * seats, 2 * seats)
        moved = np.matmul(matrix, flat).reshape(-1, seats, 2)
        return np.asarray(moved[..., 0] + 1j * moved[..., 1])


def _beams(drive: Drive) -> FloatArray:
    """Flexibility of the pins between discs, without what each disc bends alone; in slices with that and with leans."""
    discs, thickness, leans = drive.disc.number_of_discs, drive.disc.thickness, drive.contact.slices > 1

    def of(beam: PinBeam | None, pins: int) -> FloatArray:
        rows = discs * (1 + leans)
        if beam is None or (discs == 1 and not leans):
            return np.zeros((pins, rows, rows))
        found = beam.flexibility(from_start(beam, drive).tolist(), thickness, slopes=leans)
        if leans:
            lever = np.repeat([1.0, 0.5 * thickness], discs)
            found = found * lever[:, None] * lever
        else:
            found = found - np.diag(np.diag(found))
        return np.broadcast_to(found, (pins, rows, rows))

    shaft = of(shaft_pin_beam(drive), drive.number_of_holes)
    return np.concatenate((of(wheel_pin_beam(drive), drive.pin_wheel.number_of_pins), shaft))
