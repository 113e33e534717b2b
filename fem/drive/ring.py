"""The elastic ring behind the wheel pins of a full finite-element solution.

Pins are held by their cores, and the cores move with the seats of the ring: its flexibility at the seats, condensed from a mesh
of the whole ring (`fem.body.pin_ring`), joins the compliance of the contact problem. Forces and displacements are those of all
wheel pins in the turning wheel. What ``ring.model`` says of the LTCA makes no difference here.
"""

from __future__ import annotations

from fem.body.pin_ring import seat_flexibility
from ltca.arrays import FloatArray
from ltca.drive.fingerprints import fingerprint_of
from ltca.drive.parts import Drive
from ltca.drive.ring_shape import ring_shape

MAX_KEPT = 8
"""Rings that a process keeps: all positions and discs of a drive have the same."""
_KEPT: dict[str, FloatArray] = {}


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
