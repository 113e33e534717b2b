"""Geometry of a drive for drawing: outlines, radii and places of parts, in the frame of the body that carries them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.geometry.pairs import ContactGeometry

POINTS_PER_LOBE = 36
DIGITS = 4
"""Of a place, mm: a ten-thousandth is less than a picture shows."""


def drive_scene(drive: Drive) -> dict[str, Any]:
    """Return the fixed shapes of a drive of one disc: the disc's outline in its frame and radii, mm."""
    geometry = ContactGeometry.of_drive(drive)
    place = geometry.placement
    count = POINTS_PER_LOBE * drive.disc.number_of_teeth
    outline = geometry.profile.flank(2.0 * np.pi * np.arange(count) / count)
    return {
        "outline": points(outline),
        "bores": circles(place.bore_centres, np.full(place.cranks, drive.bore_radius)),
        "race": round(drive.crank_bearing.inner_race_radius, DIGITS),
        "holes": circles(place.hole_centres, place.hole_radii),
        "reach": round(1.1 * float(np.max(np.abs(place.wheel_pin_centres) + place.wheel_pin_radii)), DIGITS),
    } | _ring(drive)  # fmt: skip


def _ring(drive: Drive) -> dict[str, Any]:
    """Inner and outer radius of an elastic ring of the wheel, which the picture then has room for; nothing of a rigid one."""
    if drive.ring is None:
        return {}
    inner, outer = drive.ring.inner_radius, drive.ring.outer_radius
    return {"ring": [round(inner, DIGITS), round(outer, DIGITS)], "reach": round(1.1 * outer, DIGITS)}


def moving_scene(drive: Drive) -> dict[str, Any]:
    """Return `drive_scene` and where the parts of a drive of one disc stand, for any crank angle.

    Besides: wheel pins in the frame of the wheel, shaft pins in the fixed one, rollers by their angle in the cage, crank axes,
    eccentricities and phases, cage speed and reduction ratio (`ltca.geometry.placement.Placement`).
    """
    place = ContactGeometry.of_drive(drive).placement
    return {
        **drive_scene(drive),
        "pins": circles(place.wheel_pin_centres, place.wheel_pin_radii),
        "shafts": circles(place.shaft_pin_centres, place.shaft_pin_radii),
        "rollers": [_numbers(place.roller_cage_angles), _numbers(place.roller_radii)],
        "axes": [point(axis) for axis in place.crank_axes.tolist()],
        "eccentricity": _numbers(place.eccentricity),
        "phase": _numbers(place.eccentric_phase),
        "wheelAxis": point(complex(place.wheel_axis)),
        "cageSpeed": float(place.cage_speed),
        "ratio": float(place.reduction_ratio),
    }


def point(value: complex) -> list[float]:
    """Return a place as a list of x and y, mm."""
    return [round(float(value.real), DIGITS), round(float(value.imag), DIGITS)]


def points(values: ComplexArray) -> list[list[float]]:
    """Return places of an outline, mm, fine enough for the directions of its normals."""
    return [[round(value.real, 5), round(value.imag, 5)] for value in values.tolist()]


def circles(centres: ComplexArray, radii: FloatArray) -> list[list[float]]:
    """Return circles as x, y and radius, mm."""
    each = zip(centres.tolist(), np.broadcast_to(radii, centres.shape).tolist(), strict=True)
    return [[*point(centre), round(radius, DIGITS)] for centre, radius in each]


def _numbers(values: FloatArray) -> list[float]:
    return [float(f"{value:.9g}") for value in np.asarray(values).tolist()]
