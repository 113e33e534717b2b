"""Torque against wind-up with the input locked: contacts that stick and slip.

Under a torque that comes and goes contacts hold by friction until it has changed enough (`ltca.equilibrium.friction.sticking`),
so the output comes back another way. Makers read lost motion in the middle of the loop, at a small part of the rated torque.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ltca.analysis.engines import Engine, HalfSpace
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.equilibrium.friction.sticking import StickingFriction
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError, DriveError

LEAST_TORQUE_RATIO = 1e-4
"""Smallest torque relative to the largest: at zero the discs would float."""


LONGEST_EXTRAPOLATION = 3.0
"""Step of the torque by the one before, up to which poses are extrapolated to start from."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HysteresisLoop:
    """Closed loop of the output between the same torque either way, input locked.

    Attributes
    ----------
    crank_angle : array, shape (angles,)
        φ_C, rad.
    torque : array, shape (points,)
        Torque on the output, as it turns it ccw positive, ascending, N·mm.
    rising, falling : array, shape (angles, points)
        Deviation of the output while the torque rises and while it falls, rad.
    energy : array, shape (angles,)
        Lost in a loop, N·mm.
    lost_motion : array, shape (angles,)
        Between the middles of the loop at ± the part asked for, rad.
    width : array, shape (angles,)
        Of the loop where the lost motion is read, mean of both sides, rad.
    """

    crank_angle: FloatArray
    torque: FloatArray
    rising: FloatArray
    falling: FloatArray
    energy: FloatArray
    lost_motion: FloatArray
    width: FloatArray


def locked_path(
    drive: Drive,
    crank_angle: FloatArray,
    torque: ArrayLike,
    *,
    engine: Engine | None = None,
    advance: Callable[[int], None] = lambda _: None,
) -> FloatArray:
    """Return the deviation of the output along a path of torques, input locked, rad, shape (angles, torques).

    Parameters
    ----------
    drive : Drive
        With friction.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    torque : array, shape (torques,)
        On the output one after the other, N·mm, as `load.direction` says; negative ones load the other way. The first is
        reached without friction.
    engine : Engine, optional
        How bodies yield; half-spaces by default.
    advance : callable
        Told of solved positions.

    Raises
    ------
    ConvergenceError
        When a state does not balance.
    DriveError
        When nothing rubs in the drive.
    """
    angles, path = np.atleast_1d(np.asarray(crank_angle, dtype=float)), np.atleast_1d(np.asarray(torque, dtype=float))
    model = (HalfSpace() if engine is None else engine).prepare(drive).model
    friction = model.friction
    if friction is None:
        raise DriveError(["friction: must be given for a loop, which only friction makes"])
    smooth = replace(model, friction=None)
    found = solve_at_output(smooth, [drive], angles, float(path[0]))
    state = StickingFriction.at_rest(friction, smooth, found)
    wound = [wheel_angle_of_input(model, found)]
    advance(angles.size)
    gone = np.zeros_like(found.pose)
    for place, (before, value) in enumerate(pairwise(path), start=1):
        # While the torque goes on the same way under the same contacts so do the bodies.
        part = (value - before) / (before - path[place - 2]) if place > 1 and before != path[place - 2] else 0.0
        goes_on = 0.0 < part < LONGEST_EXTRAPOLATION and before * value > 0.0 and path[place - 2] * before > 0.0
        rubbed, pose = replace(model, friction=state), found.pose
        moment = found.wheel_moment * (value / before) if before * value > 0.0 else None
        ahead = pose + (part * gone if goes_on else 0.0)
        try:
            found = solve_at_output(rubbed, [drive], angles, float(value), ahead, wheel_moment=moment)
        except ConvergenceError as error:
            if not goes_on:
                error.add(f"torque path from {before:g} to {value:g} N·mm")
                raise
            found = solve_at_output(rubbed, [drive], angles, float(value), pose)
        gone = found.pose - pose
        state = state.after(model, found)
        wound.append(wheel_angle_of_input(model, found))
        advance(angles.size)
    return np.asarray(drive.output_deviation(np.stack(wound, axis=1), path))


def hysteresis_loop(
    drive: Drive,
    crank_angle: FloatArray,
    *,
    amplitude: float = 1.0,
    lost_motion: float = 0.03,
    points: int = 16,
    engine: Engine | None = None,
) -> HysteresisLoop:
    """Load the output both ways and back with the input locked.

    Parameters
    ----------
    drive : Drive
        With friction; its torque is the rated one.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    amplitude : float
        Largest torque as a part of the rated one.
    lost_motion : float
        Part of the rated torque at which lost motion is read.
    points : int
        Torques of each direction, evenly spaced in their square root.
    engine : Engine, optional
        How bodies yield; half-spaces by default.

    Returns
    -------
    HysteresisLoop

    Raises
    ------
    ConvergenceError
        When a state does not balance.
    DriveError
        When nothing rubs in the drive, or the lost motion lies beyond the loop.
    """
    if not 0.0 < lost_motion < amplitude:
        raise DriveError([f"lost_motion = {lost_motion:g}: must be greater than 0 and less than {amplitude:g}"])
    drive.require_torque("loops, which go up to it")
    read = lost_motion / amplitude
    up = np.unique(np.concatenate([np.linspace(LEAST_TORQUE_RATIO**0.5, 1.0, points) ** 2, [read]]))
    once = np.concatenate([-up[::-1], up])
    path = drive.load.torque * amplitude * np.concatenate([up, once[::-1][1:], once[1:]])
    sense = drive.load_sign
    found = locked_path(drive, crank_angle, path, engine=engine)
    first, second = found[:, up.size - 1 : up.size - 1 + once.size], found[:, -once.size :]
    torque = drive.load.torque * amplitude * once
    if sense > 0.0:
        rising, falling = second, first[:, ::-1]
    else:
        rising, falling = first, second[:, ::-1]
    middle = 0.5 * (rising + falling)
    here = [int(np.argmin(np.abs(once - side * read))) for side in (1.0, -1.0)]
    gap = np.abs(falling - rising)
    return HysteresisLoop(
        crank_angle=np.atleast_1d(np.asarray(crank_angle, dtype=float)),
        torque=torque,
        rising=rising,
        falling=falling,
        energy=np.abs(np.trapezoid(falling - rising, torque, axis=1)),
        lost_motion=middle[:, here[0]] - middle[:, here[1]],
        width=0.5 * (gap[:, here[0]] + gap[:, here[1]]),
    )
