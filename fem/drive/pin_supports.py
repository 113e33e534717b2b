"""What holds the pins of all discs behind their cores and axes: the ring of the wheel, pins as beams or springs, u = S f.

Wheel pins are held by their cores, and the cores move with the seats of the ring, whose flexibility is condensed from a mesh of
the whole of it (`fem.body.pin_ring`), and bend as beams on their ends; shaft pins bend or yield as springs, and a ring or posts
may tie their tips. Beams, springs and posts are those of the LTCA, a shared assumption. Forces and displacements of wheel pins
are in the turning wheel. What ``ring.model`` says of the LTCA makes no difference here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.body.pin_ring import seat_flexibility
from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import PinBeam
from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.drive.ring_shape import ring_shape
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement
from ltca.laws.carrier import far_flange_stiffness

MAX_KEPT = 8
"""Rings that a process keeps: all positions and discs of a drive have the same."""
_KEPT: dict[str, FloatArray] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class PinSupports:
    """Flexibility of what holds the pins, by forces of all discs, disc after disc, pin after pin, x and y.

    Attributes
    ----------
    wheel : array, shape (discs · 2 z_P, discs · 2 z_P), or None
        mm/N; None where no wheel pin yields.
    shaft : array, shape (discs · 2 z_PS, discs · 2 z_PS)
        mm/N.
    """

    wheel: FloatArray | None
    shaft: FloatArray

    @classmethod
    def of_drive(cls, drive: Drive, halvings: int = 0) -> PinSupports:
        """Return the supports of a whole drive; the mesh of a ring is refined uniformly `halvings` times."""
        discs, wheel = drive.disc.number_of_discs, None
        if drive.ring is not None:
            wheel = np.tile(ring_of_seats(drive, halvings), (discs, discs))
        if (beam := wheel_pin_beam(drive)) is not None:
            bent = _each_alone(_bending(beam, drive), drive.pin_wheel.number_of_pins)
            wheel = bent if wheel is None else wheel + bent
        return cls(wheel=wheel, shaft=_of_shaft_pins(drive))

    def moved(self, on_wheel: ComplexArray, on_shaft: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return displacements of wheel pins and shaft pins, mm, by forces on them, N, shapes (discs, pins)."""
        wheel = np.zeros_like(on_wheel) if self.wheel is None else _under(self.wheel, on_wheel)
        return wheel, _under(self.shaft, on_shaft)


def _under(flexibility: FloatArray, force: ComplexArray) -> ComplexArray:
    """Displacements by forces, both as complex numbers."""
    flat = np.stack([force.real, force.imag], axis=-1).ravel()
    moved = (flexibility @ flat).reshape(*force.shape, 2)
    return np.asarray(moved[..., 0] + 1j * moved[..., 1])


def _bending(beam: PinBeam, drive: Drive) -> FloatArray:
    """Flexibility of one pin at the planes of the discs, its ends at rest, mm/N, shape (discs, discs)."""
    return beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)


def _each_alone(flexibility: FloatArray, pins: int) -> FloatArray:
    """The flexibility of pins that bend alike in every direction and do not feel each other."""
    return np.asarray(np.kron(flexibility, np.eye(2 * pins)))


def mean_spring(drive: Drive) -> float:
    """Return the stiffness of one shaft pin against one disc alone, N/mm: of beams that of the mean flexibility."""
    if shaft_pin_beam(drive) is None:
        return drive.hole_stiffness
    return 1.0 / float(np.mean(np.diag(_of_shaft_pins(drive))))


def _of_shaft_pins(drive: Drive) -> FloatArray:
    """Flexibility of the shaft pins: springs, or beams whose tips a floating ring or posts may tie."""
    pins, discs, beam = drive.number_of_holes, drive.disc.number_of_discs, shaft_pin_beam(drive)
    if beam is None:
        return _each_alone(np.eye(discs) / drive.hole_stiffness, pins)
    found = _each_alone(_bending(beam, drive), pins)
    if beam.ends[1] == "free":
        return found
    # A rigid flange moves by x, y and a rotation, and takes the tips along.
    centres = Placement.of_drive(single_discs(drive)[0]).shaft_pin_centres
    tips = np.zeros((pins, 2, 3))
    tips[:, 0, 0] = tips[:, 1, 1] = 1.0
    tips[:, 0, 2], tips[:, 1, 2] = -centres.imag, centres.real
    tips = tips.reshape(2 * pins, 3)
    posts = far_flange_stiffness(drive)
    stiffness = beam.tip_stiffness * tips.T @ tips + (0.0 if posts is None else posts)
    share = np.asarray(beam.tip_shape(from_start(beam, drive).tolist(), drive.disc.thickness))
    carried = np.kron(share[:, None], tips)
    return np.asarray(found + carried @ np.linalg.solve(stiffness, carried.T))


def ring_of_seats(drive: Drive, halvings: int = 0) -> FloatArray:
    """Return the flexibility of the ring of a drive at the seats of its pins, mm/N, shape (2 z_P, 2 z_P); found once.

    Its mesh is refined uniformly `halvings` times.
    """
    ring = drive.ring
    assert ring is not None
    material, bolts = ring.material, ring.bolts
    stiffness = {
        "modulus": material.youngs_modulus,
        "width": ring.width,
        "bolts": 0.0 if bolts is None else bolts.stiffness,
        "halvings": halvings,
    }
    key = fingerprint_of(ring_shape(drive) | stiffness)
    if key not in _KEPT:
        while len(_KEPT) >= MAX_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[key] = seat_flexibility(drive, halvings=halvings)
        _KEPT[key].flags.writeable = False
    return _KEPT[key]
