"""What holds pins and cranks behind their cores and axes: ring and bearing of the wheel, beams, springs, shafts, u = S f.

Wheel pins are held by their cores, and the cores move with the seats of the ring, whose flexibility is condensed from a mesh of
the whole of it (`fem.body.pin_ring`), and bend as beams on their ends; shaft pins bend or yield as springs, and a ring or posts
may tie their tips; cranks bend between bearings. Beams, springs and posts are those of the LTCA, a shared assumption. Forces and
displacements of wheel pins are in the turning wheel. What ``ring.model`` says of the LTCA makes no difference here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sla

from fem.body.pin_ring import seat_flexibility
from ltca.arrays import ComplexArray, FloatArray
from ltca.beam import PinBeam, support_parts
from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.drive.ring_shape import ring_shape
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement
from ltca.laws.carrier import far_flange_stiffness
from ltca.laws.member_bearings import crank_flexibility, wheel_law

MAX_KEPT = 8
"""Rings that a process keeps: all positions and discs of a drive have the same."""
_KEPT: dict[str, FloatArray] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Supports:
    """Flexibility of what holds pins and cranks by the forces of all discs, disc after disc, part after part, x and y.

    Attributes
    ----------
    wheel : array, shape (discs · 2 z_P, discs · 2 z_P), or None
        Of the wheel pins in the wheel, mm/N; None where none yields.
    shaft : array, shape (n, n), n = discs · 2 z_PS + discs · 2 cranks
        Of the shaft pins of all discs, then of the cranks at all discs, mm/N.
    """

    wheel: FloatArray | None
    shaft: FloatArray

    @classmethod
    def of_drive(cls, drive: Drive, halvings: int = 0) -> Supports:
        """Return the supports of a whole drive; the mesh of a ring is refined uniformly `halvings` times."""
        discs, pins, wheel = drive.disc.number_of_discs, drive.pin_wheel.number_of_pins, list[FloatArray]()
        if drive.ring is not None:
            wheel.append(np.tile(ring_of_seats(drive, halvings), (discs, discs)))
        if (beam := wheel_pin_beam(drive)) is not None:
            wheel.append(_each_alone(_bending(beam, drive), pins))
        if (bearing := wheel_law(drive)) is not None:
            assert isinstance(bearing, float)
            wheel.append(np.tile(np.eye(2), (discs * pins, discs * pins)) / bearing)
        return cls(wheel=np.sum(wheel, axis=0) if wheel else None, shaft=_of_pin_shaft(drive))

    def moved(
        self, on_wheel: ComplexArray, on_shaft: ComplexArray, on_cranks: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return displacements of wheel pins, shaft pins and cranks, mm, by forces on them, N, shapes (discs, parts)."""
        wheel = np.zeros_like(on_wheel) if self.wheel is None else _under(self.wheel, on_wheel.ravel())
        shaft = _under(self.shaft, np.concatenate([on_shaft.ravel(), on_cranks.ravel()]))
        pins, cranks = np.split(shaft, [on_shaft.size])
        return wheel.reshape(on_wheel.shape), pins.reshape(on_shaft.shape), cranks.reshape(on_cranks.shape)


def _under(flexibility: FloatArray, force: ComplexArray) -> ComplexArray:
    """Displacements by forces, both as complex numbers."""
    moved = (flexibility @ np.column_stack([force.real, force.imag]).ravel()).reshape(-1, 2)
    return np.asarray(moved[:, 0] + 1j * moved[:, 1])


def _bending(beam: PinBeam, drive: Drive) -> FloatArray:
    """Flexibility of one pin at the planes of the discs, its ends at rest, mm/N, shape (discs, discs)."""
    return beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)


def _each_alone(flexibility: FloatArray, parts: int) -> FloatArray:
    """The flexibility of parts that yield alike in every direction and do not feel each other."""
    return np.asarray(np.kron(flexibility, np.eye(2 * parts)))


def _carried_by_flange(centres: ComplexArray) -> FloatArray:
    """Displacement of places of a rigid flange by its x, y and rotation, shape (2 places, 3)."""
    found = np.zeros((centres.size, 2, 3))
    found[:, 0, 0] = found[:, 1, 1] = 1.0
    found[:, 0, 2], found[:, 1, 2] = -centres.imag, centres.real
    return found.reshape(2 * centres.size, 3)


def mean_spring(drive: Drive) -> float:
    """Return the stiffness of one shaft pin against one disc alone, N/mm: of beams that of the mean flexibility."""
    if shaft_pin_beam(drive) is None:
        return drive.hole_stiffness
    own = drive.disc.number_of_discs * 2 * drive.number_of_holes
    return 1.0 / float(np.mean(np.diag(_of_pin_shaft(drive))[:own]))


def _of_pin_shaft(drive: Drive) -> FloatArray:
    """Flexibility of shaft pins and cranks: springs, beams and shafts, whose far ends a floating ring or posts may hold."""
    pins, discs, beam, cranks = (
        drive.number_of_holes,
        drive.disc.number_of_discs,
        shaft_pin_beam(drive),
        drive.crank.number,
    )
    place, posts = Placement.of_drive(single_discs(drive)[0]), far_flange_stiffness(drive)
    of_pins = np.eye(discs) / drive.hole_stiffness if beam is None else _bending(beam, drive)
    of_cranks = crank_flexibility(drive)
    rigid = np.zeros((discs, discs))
    found = sla.block_diag(_each_alone(of_pins, pins), _each_alone(rigid if of_cranks is None else of_cranks, cranks))
    stiffness, shares = np.zeros((3, 3)) if posts is None else posts, [np.zeros(discs), np.zeros(discs)]
    tips, seats = _carried_by_flange(place.shaft_pin_centres), _carried_by_flange(place.crank_axes)
    if beam is not None and beam.ends[1] != "free":
        stiffness = stiffness + beam.tip_stiffness * tips.T @ tips
        shares[0] = np.asarray(beam.tip_shape(from_start(beam, drive).tolist(), drive.disc.thickness))
    bearings = drive.crank_supports  # of rigid cranks as well
    if posts is not None and bearings is not None:
        shares[1] = support_parts(drive.disc.disc_planes, bearings)[1]
    if not np.any(shares):
        return np.asarray(found)
    # The flange at the far ends moves by x, y and a rotation under the parts of the forces that go there.
    carried = np.vstack([np.kron(share[:, None], at) for share, at in zip(shares, (tips, seats), strict=True)])
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
