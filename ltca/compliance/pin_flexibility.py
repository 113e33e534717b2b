"""Flexibility of what holds pins, u = −S f with one symmetric S: beams under several discs, and the ring of the pin wheel.

Displacements of wheel pins are in the turning wheel. In slices pins lean: leans stand as displacements at half the thickness,
moments as forces there, behind those of all discs. Bending by a disc's own force is in S there, else in `ltca.laws.backed`.
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
    """Flexibility of wheel pins, then shaft pins, by beams and ring."""

    beams: FloatArray = by_drive(3)  # mm/N, (…, pairs, discs, discs), zero for d = d'; where pins lean, leans follow
    ring: FloatArray | None = by_drive(4, default=None)  # of seats by forces, in the wheel, mm/N, (…, z_P, 2, z_P, 2)
    leans: bool = False

    @classmethod
    def of_drive(cls, drive: Drive, lender: Drive | None = None) -> PinDisplacements | None:
        """Return the flexibility of a drive, a ring of elements shaped as the `lender`'s; None where it displaces no pin."""
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
