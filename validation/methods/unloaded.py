"""What the paper reads from a drive without load: its transmission error, and the pairs that can carry (Eq. 2–6).

The disc is held on the nominal eccentricity without rotation, as in `ltca.geometry.first_contact`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import first_contact
from ltca.geometry.pairs import ContactGeometry


def unloaded_transmission_error(
    geometry: ContactGeometry | Sequence[ContactGeometry], crank_angle: FloatArray, driving_sign: int = 1
) -> FloatArray:
    """Return the wheel angle without load and without clearances, from geometry alone (Eq. 6), rad, shape (positions,).

    The angle at first contact: negative when a crank driving counter-clockwise (`driving_sign` = +1) takes up the backlash.
    With several discs on one wheel `geometry` has each of them.
    """
    discs = [geometry] if isinstance(geometry, ContactGeometry) else geometry
    turned = [first_contact(disc, crank_angle, WHEEL_ANGLE, -driving_sign)[0] for disc in discs]
    # The sense of the load is −driving_sign: the first disc that touches stops the wheel.
    return np.asarray(-driving_sign * np.min([-driving_sign * each for each in turned], axis=0))


def carrying_pins(geometry: ContactGeometry, crank_angle: FloatArray, driving_sign: int = 1) -> BoolArray:
    """Return which wheel pins can drive the wheel against its load, shape (positions, z_P).

    A pin carries when pressing it on the flank turns the wheel in the driving sense: the lever of its contact
    normal about the wheel axis has that sign.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    motion = geometry.flank(angle, np.zeros((angle.size, 4)))
    return np.asarray(driving_sign * motion.gradient[..., WHEEL_ANGLE] < 0.0)


def carrying_holes(geometry: ContactGeometry, crank_angle: FloatArray, driving_sign: int = 1) -> BoolArray:
    """Return which pin holes can hold the disc against rotation (Eq. 2–4), shape (positions, z_PS).

    The product of n = (−sin θ, cos θ) at the hole and the direction from disc centre to crank axis is positive.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    hole = np.angle(geometry.placement.hole_centres)
    return np.asarray(driving_sign * np.sin(hole - angle[:, None]) > 0.0)


def carrying_rollers(
    geometry: ContactGeometry,
    crank_angle: FloatArray,
    load_direction: FloatArray,
    loaded_zone: float = 0.5 * np.pi,
) -> BoolArray:
    """Return which rollers lie within ± `loaded_zone` (θ_predict, rad) of a direction (Eq. 5), shape (positions, n_BR).

    `load_direction` is the direction of the bearing force on the disc, θ_F, rad, shape (positions,).
    """
    rollers = geometry.placement.roller_angles(np.atleast_1d(np.asarray(crank_angle, dtype=float)))
    away = rollers - np.atleast_1d(np.asarray(load_direction, dtype=float))[:, None]
    return np.asarray(np.cos(away) >= np.cos(loaded_zone))
