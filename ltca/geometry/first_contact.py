"""Tooth contact analysis without load: first contact, backlash, interference.

The disc is held on the nominal eccentricity without rotation, in slices square to its crank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import BoolArray, FloatArray
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import RIGID, WHEEL_ANGLE, Coordinates
from ltca.geometry.length_profile import ACROSS
from ltca.geometry.pairs import ContactGeometry

TOUCHING = 1e-12
"""Interference that counts as touching, by the pin circle radius: some thousand times the round-off."""
ROUND_OFF = 1e-15
"""Rotation at which bisections end, rad."""
QUADRATIC = 1e-9
"""Step of Newton's method behind which nothing is left but its square, rad."""
MAX_ITERATIONS = 60
"""Newton steps, and bisections."""


def first_contact(
    geometry: ContactGeometry, crank_angle: FloatArray, coordinate: int, sense: int
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return the rotation of disc (2) or wheel (−1) at which the first pin touches, rad, and that pin, both (positions,)."""
    rotation, pin, settled = turn_to_contact(geometry, crank_angle, coordinate, sense)
    if not np.all(settled):
        raise ConvergenceError("no pin touches the flank within half a pitch, the disc in its nominal place")
    return rotation, pin


def turn_to_contact(
    geometry: ContactGeometry, crank_angle: FloatArray, coordinate: int, sense: int
) -> tuple[FloatArray, NDArray[np.intp], BoolArray]:
    """Return rotation and pin as `first_contact` does, and whether contact was found; rotations are zero where it was not."""
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    bottom, pressed = _least_interference(geometry, angle, coordinate)
    rotation, pin, stops = _farthest_free(geometry, angle, coordinate, sense, bottom)
    free = pressed <= TOUCHING * _size(geometry)
    return np.where(free, np.where(stops, rotation, 0.0), bottom), pin, stops | ~free


def interference(geometry: ContactGeometry, crank_angle: FloatArray) -> FloatArray:
    """Return the overlap of pins and flank where turning the wheel makes it least, mm, shape (positions,); zero with backlash."""
    angle = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    _, pressed = _least_interference(geometry, angle, WHEEL_ANGLE)
    return np.where(pressed > TOUCHING * _size(geometry), pressed, 0.0)


def _size(geometry: ContactGeometry) -> FloatArray:
    """Radius of the outermost pin, mm; of a batch one for each position."""
    return np.asarray(np.max(np.abs(geometry.placement.wheel_pin_centres), axis=-1))


def _quarter_pitch(geometry: ContactGeometry) -> float:
    return 0.5 * np.pi / geometry.placement.reduction_ratio


def _approaches(
    geometry: ContactGeometry, angle: FloatArray, coordinate: int, rotation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Approach of every pin where along its width it is largest, and its derivative by the rotation."""
    askew = geometry.stands_askew
    if askew:
        geometry = replace(geometry, coordinates=Coordinates(leans=True))
    pose = np.zeros((angle.size, RIGID + 2 * askew))
    pose[:, coordinate] = rotation
    if askew:
        lean = np.broadcast_to(np.reshape(geometry.placement.crank_lean, -1), angle.shape)
        pose[:, geometry.coordinates.lean_place] = np.stack((lean.real, lean.imag), axis=1)
    motion = geometry.flank(angle, pose)
    gap, slope = -motion.approach, -motion.gradient
    if askew:
        tilt, shape = geometry.flank_tilt(angle, pose, motion), (angle.size, ACROSS.size)
        height, drop = (np.broadcast_to(each, shape) for each in (geometry.half_width * ACROSS, geometry.flank_drop))
        gap, slope = tilt.at(gap, slope, *tilt.deepest(height, drop))
    return -gap, -slope[..., coordinate]


def _least_interference(geometry: ContactGeometry, angle: FloatArray, coordinate: int) -> tuple[FloatArray, FloatArray]:
    """Return the rotation at which the largest approach is no interference, or the least one, and that approach."""
    quarter, touching = _quarter_pitch(geometry), TOUCHING * _size(geometry)
    rows, bottom = np.arange(angle.size), np.zeros(angle.size)
    low, high = np.full(angle.size, -quarter), np.full(angle.size, quarter)
    left = right = np.full(angle.size, -1)
    for _ in range(MAX_ITERATIONS):
        approach, slope = _approaches(geometry, angle, coordinate, bottom)
        pin = np.argmax(approach, axis=1)
        largest, falling = approach[rows, pin], slope[rows, pin] < 0.0
        low, high = np.where(falling, bottom, low), np.where(falling, high, bottom)
        left, right = np.where(falling, pin, left), np.where(falling, right, pin)
        closing = slope[rows, right] - slope[rows, left]
        meets = (left >= 0) & (right >= 0) & (closing > 0.0)
        alike = bottom + (approach[rows, left] - approach[rows, right]) / np.where(meets, closing, 1.0)
        place = np.where(meets & (alike > low) & (alike < high), alike, 0.5 * (low + high))
        if np.all((largest <= touching) | (np.abs(place - bottom) < ROUND_OFF)):
            break
        bottom = np.where(largest <= touching, bottom, place)
    return bottom, largest


def _farthest_free(
    geometry: ContactGeometry, angle: FloatArray, coordinate: int, sense: int, start: FloatArray
) -> tuple[FloatArray, NDArray[np.intp], BoolArray]:
    """Return the rotation from a start at which a pin presses, that pin, and whether one does, by bracketed Newton's method."""
    approach, slope = _approaches(geometry, angle, coordinate, start)
    # Where all touch at the start, round-off of their approaches must not count.
    level = np.maximum(approach.max(axis=1), 0.0)
    inside, outside = start, start + 2.0 * sense * _quarter_pitch(geometry)
    rate = sense * slope
    closing = (rate > 0.0) & (approach < 0.0)
    travel = np.divide(-approach, rate, out=np.full(rate.shape, np.inf), where=closing).min(axis=1)
    place = np.where(travel < np.abs(outside - start), start + sense * travel, 0.5 * (inside + outside))
    rows, going, stops = np.arange(angle.size), np.ones(angle.size, dtype=bool), np.zeros(angle.size, dtype=bool)
    for _ in range(MAX_ITERATIONS):
        approach, slope = _approaches(geometry, angle, coordinate, place)
        pin = np.argmax(approach, axis=1)
        largest, turning = approach[rows, pin], slope[rows, pin]
        over = largest > level
        inside, outside = np.where(over, inside, place), np.where(over, place, outside)
        newton = place - (largest - level) / np.where(turning == 0.0, np.nan, turning)
        within = (sense * (newton - inside) > -ROUND_OFF) & (sense * (newton - outside) < ROUND_OFF)
        following = np.where(within, newton, 0.5 * (inside + outside))
        moved, place = np.abs(following - place), np.where(going, following, place)
        ends = moved < np.where(within, QUADRATIC, ROUND_OFF)
        stops |= going & (over | ends & within)
        going &= ~ends
        if not going.any():
            break
    return place, pin, stops


def backlash(
    geometry: ContactGeometry | Sequence[ContactGeometry], crank_angle: FloatArray, coordinate: int
) -> FloatArray:
    """Return the backlash of disc (2) or wheel (−1), rotation between first contacts of any disc both ways, rad, (positions,)."""
    discs = [geometry] if isinstance(geometry, ContactGeometry) else geometry
    forward = np.min([first_contact(disc, crank_angle, coordinate, 1)[0] for disc in discs], axis=0)
    backward = np.max([first_contact(disc, crank_angle, coordinate, -1)[0] for disc in discs], axis=0)
    return np.asarray(forward - backward)
