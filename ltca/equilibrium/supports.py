"""Springs on coordinates: crankshafts on their bearings, and the wheel on its own.

Every crank is a beam on two bearings (`ltca.laws.beam`); its stiffness ties x and y of the crank in the planes of the discs,
alike in every direction. The wheel's main bearing holds its x and y. A ring that ties the tips of the shaft pins is held by
what the pins resist when it moves all tips; as the far flange of a carrier it is held by the posts as well
(`ltca.laws.carrier`), and the far bearings of the cranks stand in it: a crank bends by its displacement relative to the straight
line between its bearings.
"""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import shaft_pin_beam
from ltca.laws.beam import shaft_flexibility
from ltca.laws.carrier import far_flange_stiffness


def crank_stiffness(drive: Drive) -> FloatArray | None:
    """Return the forces on a crank at the planes of the discs by displacements there, N/mm, shape (discs, discs).

    None where cranks are rigid.
    """
    support = drive.crank.support
    if support is None:
        return None
    modulus = drive.materials.crankshaft.youngs_modulus
    planes = drive.disc.disc_planes
    return np.asarray(
        np.linalg.inv(shaft_flexibility(planes, support.positions, support.stiffness, support.diameter, modulus))
    )


def support_stiffness(drive: Drive, geometry: ContactGeometry) -> FloatArray | None:
    """Return the stiffness matrix of all supports by the coordinates of a drive, N/mm; None where nothing yields.

    The contact geometry of one disc is for the tips of shaft pins that a ring ties.
    """
    coordinates = Coordinates.of_drive(drive)
    shaft, wheel = crank_stiffness(drive), drive.pin_wheel.support_stiffness
    if shaft is None and wheel is None and not coordinates.ring:
        return None
    matrix = np.zeros((coordinates.size, coordinates.size))
    flange = far_flange_stiffness(drive)
    if shaft is not None:
        starts = coordinates.own * np.arange(coordinates.discs)
        for crank in range(coordinates.cranks):
            for direction in (0, 1):
                places = starts + coordinates.crank(crank) + direction
                matrix[np.ix_(places, places)] += shaft
                if flange is not None:
                    seats = np.outer(_seat_shares(drive), _seat_by_flange(geometry, crank, direction))
                    ring = np.arange(coordinates.size)[coordinates.ring_place]
                    matrix[np.ix_(places, ring)] -= shaft @ seats
                    matrix[np.ix_(ring, places)] -= seats.T @ shaft
                    matrix[np.ix_(ring, ring)] += seats.T @ shaft @ seats
    if wheel is not None:
        places = np.arange(coordinates.size)[coordinates.wheel_place]
        matrix[places, places] += wheel
    if flange is not None:
        matrix[coordinates.ring_place, coordinates.ring_place] += flange
    if geometry.tips_by_ring.size and coordinates.ring:
        matrix[coordinates.ring_place, coordinates.ring_place] += _ring_stiffness(drive, geometry)
    return matrix


def _seat_shares(drive: Drive) -> FloatArray:
    """Displacement of a straight crank in the plane of each disc by its bearing in the far flange."""
    if drive.crank_supports is None:
        raise AssertionError("cranks stand in a flange")
    near, far = drive.crank_supports
    return (np.asarray(drive.disc.disc_planes) - near) / (far - near)


def _seat_by_flange(geometry: ContactGeometry, crank: int, direction: int) -> FloatArray:
    """x or y of the bearing of a crank in the far flange by x, y and rotation of the flange, shape (3,)."""
    by_ring = geometry.seats_by_ring[..., crank, :]
    return np.asarray(by_ring.imag if direction else by_ring.real)


def _ring_stiffness(drive: Drive, geometry: ContactGeometry) -> FloatArray:
    """Forces on the ring by its x, y and rotation, shape (3, 3): Σ k vᵀ v over the tips it moves by v."""
    beam = shaft_pin_beam(drive)
    if beam is None:
        raise AssertionError("a ring ties beams")
    tips = geometry.tips_by_ring
    return np.asarray(beam.tip_stiffness * (tips.conjugate().T @ tips).real)
