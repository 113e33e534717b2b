"""Tooth contact analysis without load: backlash, unloaded transmission error, pairs that can carry (Eq. 2–6).

The disc is held on the nominal eccentricity without rotation, as bearing and pin holes without clearance hold it;
what is left is the backlash between flank and pins.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, take_rows
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.pairs import ContactGeometry

STEEP = 1e-3
"""Lever arm of a pin's contact normal, as a part of e u, above which Newton's method finds where it touches."""
TOUCHING = 1e-12
"""Interference that counts as touching, as a part of the pin circle radius: some thousand times the round-off."""
CLOSE = 1e-15
"""Rotation, rad, that is round-off."""
ROUNDS, BISECTIONS = 60, 60


def first_contact(
    geometry: ContactGeometry, crank_angle: FloatArray, coordinate: int, sense: int
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Turn disc or wheel about the nominal pose until the first pin touches.

    Parameters
    ----------
    geometry : ContactGeometry
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    coordinate : {2, −1}
        What turns: the disc about its centre (2) or the wheel (−1).
    sense : {+1, −1}
        Counter-clockwise or clockwise.

    Returns
    -------
    rotation : array, shape (positions,)
        Signed rotation at first contact, rad.
    pin : array of int, shape (positions,)
        The pin that touches first.

    Raises
    ------
    ConvergenceError
        When no pin can touch in that sense.

    Notes
    -----
    Where pins press on the flank at every rotation, by errors of single parts or as they are drawn, the answer is the
    rotation of least `interference` in both senses, so that backlash is zero.
    """
    rotation, pin, settled, history = turn_to_contact(geometry, crank_angle, coordinate, sense)
    if not np.all(settled):
        raise ConvergenceError(
            "no pin touches the flank within half a pitch, the disc in its nominal place; last rotations in rad",
            history,
        )
    return rotation, pin


def turn_to_contact(
    geometry: ContactGeometry, crank_angle: FloatArray, coordinate: int, sense: int
) -> tuple[FloatArray, NDArray[np.intp], NDArray[np.bool_], list[float]]:
    """Turn as `first_contact` does and tell where that found contact.

    Returns
    -------
    rotation : array, shape (positions,)
        rad, zero where no contact was found.
    pin : array of int, shape (positions,)
        The pin that touches first.
    settled : array of bool, shape (positions,)
        Whether contact was found.
    history : list of float
        Largest rotation of each round, rad.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    pose = np.zeros((angle.size, 4))
    lever = geometry.placement.mean_eccentricity * geometry.placement.reduction_ratio
    history: list[float] = []
    settled = np.zeros(angle.size, dtype=bool)
    pin = np.zeros(angle.size, dtype=np.intp)
    for _ in range(ROUNDS):
        motion = geometry.flank(angle, pose)
        rate = sense * motion.gradient[..., coordinate]
        closing = rate > STEEP * lever
        travel = np.where(closing, -motion.approach / np.where(closing, rate, 1.0), np.inf)
        pin = np.argmin(travel, axis=1)
        step = np.take_along_axis(travel, pin[:, None], axis=1)[:, 0]
        reachable = np.isfinite(step)
        step = np.where(reachable, step, 0.0)
        pose[:, coordinate] += sense * step
        settled = reachable & (np.abs(step) < 1e-14)
        history.append(float(np.max(np.abs(step))))
        if np.all(settled | ~reachable):
            break
    # A pin whose normal points at the axis hardly moves along it: such pins were left out above.
    others = np.max(motion.approach, axis=1) > TOUCHING * _size(geometry)  # where it settled, at that pose
    unsure = np.nonzero(~settled | others)[0]
    if unsure.size:
        part = take_rows(geometry, unsure)
        bottom, pressed = _least_interference(part, angle[unsure], coordinate)
        rotation, touching, stopped = _farthest_free(part, angle[unsure], coordinate, sense, bottom)
        free = pressed <= TOUCHING * _size(geometry)
        rotation = np.where(free, rotation, bottom)
        # Among pins that overlap Newton's method above follows the steepest away: no rotation frees them.
        better = stopped | ~free
        rows = unsure[better]
        pose[rows, coordinate], pin[rows], settled[rows] = rotation[better], touching[better], True
    pose[~settled, coordinate] = 0.0
    return pose[:, coordinate], pin, settled, history


def interference(geometry: ContactGeometry, crank_angle: FloatArray) -> FloatArray:
    """Return how far pins and flank overlap where turning the wheel makes it least, the disc in its nominal place, mm.

    Parameters
    ----------
    geometry : ContactGeometry
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.

    Returns
    -------
    array, shape (positions,)
        Zero where there is backlash.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    _, pressed = _least_interference(geometry, angle, WHEEL_ANGLE)
    return np.where(pressed > TOUCHING * _size(geometry), pressed, 0.0)


def _size(geometry: ContactGeometry) -> float:
    return float(np.max(np.abs(geometry.placement.wheel_pin_centres)))


def _quarter(geometry: ContactGeometry) -> float:
    return 0.5 * np.pi / geometry.placement.reduction_ratio  # of a pitch, rad


def _approaches(
    geometry: ContactGeometry, angle: FloatArray, coordinate: int, rotation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Approach of every pin and its slope by the rotation."""
    pose = np.zeros((angle.size, 4))
    pose[:, coordinate] = rotation
    motion = geometry.flank(angle, pose)
    return motion.approach, motion.gradient[..., coordinate]


def _largest_approach(
    geometry: ContactGeometry, angle: FloatArray, coordinate: int, rotation: FloatArray
) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Largest approach of all pins, its slope by the rotation, and the pin."""
    approach, slope = _approaches(geometry, angle, coordinate, rotation)
    rows, pin = np.arange(angle.size), np.argmax(approach, axis=1)
    return approach[rows, pin], slope[rows, pin], pin


def _least_interference(geometry: ContactGeometry, angle: FloatArray, coordinate: int) -> tuple[FloatArray, FloatArray]:
    """Rotation at which the largest approach is no interference, or the least one, and that approach.

    The largest approach is a valley over the rotation: its slope says on which side of a place the bottom lies. There two
    pins, each the one that presses most on its side, press alike. With unmodified flanks that is where all pins touch;
    with equal offsets it is just below zero.
    """
    quarter, touching = _quarter(geometry), TOUCHING * _size(geometry)
    rows, bottom = np.arange(angle.size), np.zeros(angle.size)
    low, high = np.full(angle.size, -quarter), np.full(angle.size, quarter)
    left = right = np.full(angle.size, -1)
    for _ in range(BISECTIONS):
        approach, slope = _approaches(geometry, angle, coordinate, bottom)
        pin = np.argmax(approach, axis=1)
        largest, falling = approach[rows, pin], slope[rows, pin] < 0.0
        low, high = np.where(falling, bottom, low), np.where(falling, high, bottom)
        left, right = np.where(falling, pin, left), np.where(falling, right, pin)
        closing = slope[rows, right] - slope[rows, left]
        meets = (left >= 0) & (right >= 0) & (closing > 0.0)
        alike = bottom + (approach[rows, left] - approach[rows, right]) / np.where(meets, closing, 1.0)
        place = np.where(meets & (alike > low) & (alike < high), alike, 0.5 * (low + high))
        if np.all((largest <= touching) | (np.abs(place - bottom) < CLOSE)):
            break
        bottom = np.where(largest <= touching, bottom, place)
    return bottom, largest


def _farthest_free(
    geometry: ContactGeometry, angle: FloatArray, coordinate: int, sense: int, start: FloatArray
) -> tuple[FloatArray, NDArray[np.intp], NDArray[np.bool_]]:
    """How far it can turn from a start until a pin presses, which one, and whether one does.

    Newton's method between a place where a pin presses and one where none does; where it leaves them, their middle.
    """
    # Where all touch at the start, round-off of their approaches is no way to go.
    level = np.maximum(_largest_approach(geometry, angle, coordinate, start)[0], 0.0)
    step = sense * _quarter(geometry)
    inside, outside = start, start + step
    outside = np.where(_largest_approach(geometry, angle, coordinate, outside)[0] > level, outside, outside + step)
    largest, slope, pin = _largest_approach(geometry, angle, coordinate, outside)
    stops, place = largest > level, outside
    for _ in range(BISECTIONS):
        newton = place - (largest - level) / np.where(slope == 0.0, np.nan, slope)
        following = np.where((newton - inside) * (newton - outside) < 0.0, newton, 0.5 * (inside + outside))
        if np.all(np.abs(following - place) < CLOSE):
            break
        place = following
        largest, slope, pin = _largest_approach(geometry, angle, coordinate, place)
        over = largest > level
        inside, outside = np.where(over, inside, place), np.where(over, place, outside)
    return place, pin, stops


def backlash(
    geometry: ContactGeometry | Sequence[ContactGeometry], crank_angle: FloatArray, coordinate: int
) -> FloatArray:
    """Return the backlash of disc (2) or wheel (−1): rotation between first contact in both senses, rad.

    Parameters
    ----------
    geometry : ContactGeometry or sequence of them
        The drive; of several discs on one wheel each, which turns until the first of them touches.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    coordinate : {2, −1}
        What turns.
    """
    discs = [geometry] if isinstance(geometry, ContactGeometry) else geometry
    forward = np.min([first_contact(disc, crank_angle, coordinate, 1)[0] for disc in discs], axis=0)
    backward = np.max([first_contact(disc, crank_angle, coordinate, -1)[0] for disc in discs], axis=0)
    return np.asarray(forward - backward)


def unloaded_transmission_error(
    geometry: ContactGeometry | Sequence[ContactGeometry], crank_angle: FloatArray, driving_sign: int = 1
) -> FloatArray:
    """Return the wheel angle without load and without clearances, from geometry alone (Eq. 6), rad.

    Parameters
    ----------
    geometry : ContactGeometry or sequence of them
        The drive; of several discs on one wheel each.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    driving_sign : {+1, −1}
        Sense in which the crank drives.

    Returns
    -------
    array, shape (positions,)
        Wheel angle at first contact: negative when a crank driving counter-clockwise takes up the backlash.
    """
    discs = [geometry] if isinstance(geometry, ContactGeometry) else geometry
    turned = [first_contact(disc, crank_angle, WHEEL_ANGLE, -driving_sign)[0] for disc in discs]
    # The sense of the load is −driving_sign: the first disc that touches stops the wheel.
    return np.asarray(-driving_sign * np.min([-driving_sign * each for each in turned], axis=0))


def carrying_pins(geometry: ContactGeometry, crank_angle: FloatArray, driving_sign: int = 1) -> NDArray[np.bool_]:
    """Return which wheel pins can drive the wheel against its load, shape (positions, z_P).

    A pin carries when pressing it on the flank turns the wheel in the driving sense: the lever of its contact
    normal about the wheel axis has that sign.
    """
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    motion = geometry.flank(angle, np.zeros((angle.size, 4)))
    return np.asarray(driving_sign * motion.gradient[..., WHEEL_ANGLE] < 0.0)


def carrying_holes(geometry: ContactGeometry, crank_angle: FloatArray, driving_sign: int = 1) -> NDArray[np.bool_]:
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
) -> NDArray[np.bool_]:
    """Return which rollers stand within ± the loaded zone about a direction of load (Eq. 5), shape (positions, n_BR).

    Parameters
    ----------
    geometry : ContactGeometry
        The drive.
    crank_angle : array, shape (positions,)
        φ_C, rad.
    load_direction : array, shape (positions,)
        Direction of the bearing force on the disc, θ_F, rad.
    loaded_zone : float
        θ_predict, rad.
    """
    rollers = geometry.placement.roller_angles(np.atleast_1d(np.asarray(crank_angle, dtype=float)))
    away = rollers - np.atleast_1d(np.asarray(load_direction, dtype=float))[:, None]
    return np.asarray(np.cos(away) >= np.cos(loaded_zone))
