"""Torque against wind-up over both directions, and what is read from it: backlash, lost motion, torsional stiffness.

The input is held, the output is loaded one way and the other. Without friction the curve has no loop; towards vanishing torque
its branches end at the two stops of the free play (`ltca.geometry.play`), which is the backlash, with that of
a first stage. Forces from outside on a wheel whose main bearing yields take up what is free on their side before any torque: the
backlash is then the gap that they leave between the branches. The stiffness of the cycloid stage is that with the cranks held:
flanks, pins, crank bearings and, where the file has them, beams, supports, ring and carrier; that of the reducer has everything
that the file describes, and what it leaves out is told (`ltca.drive.yielding_parts`). With friction the curve is what the bodies
yield, and the loop about it is told beside it (`ltca.analysis.friction.hysteresis`). Torques and angles are those of the output,
whichever member that is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.analysis.engines import Engine, HalfSpace
from ltca.analysis.friction.hysteresis import HysteresisLoop, hysteresis_loop
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.drive.yielding_parts import YieldingParts, yielding_parts
from ltca.equilibrium.output_angle import play_before_cranks, wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.play import free_play

LEAST_TORQUE_RATIO = 1e-4
"""Smallest torque relative to the rated one: elastic wind-up is some 1e-4 of its rated value there."""
GAP_TORQUE_RATIOS = (1e-6, 1e-5, LEAST_TORQUE_RATIO)
"""Torque by the rated one, either way, between which the gap under forces from outside is read: the first that balances beside
them. Bodies yield some 1e-5 of the gap at the first."""
UNDER_FORCES = "backlash is what the forces from outside leave of the play: they displace the wheel on its main bearing"
LOST_MOTION = 0.03
"""Lost motion is read between ± this part of the rated torque unless another is asked for, as makers of precision reducers do."""
LEAST_PART, MOST_PART = 0.001, 0.5
"""Bounds of that part: where clearances are taken up, and where the wind-up is that of the stiffness."""
STIFF_FROM = 0.5
"""Torsional stiffness is the mean slope from this part of the rated torque to the whole."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueCurve:
    """Wind-up of the output at held crank angles.

    Attributes
    ----------
    crank_angle : array, shape (angles,)
        φ_C, rad.
    torque : array, shape (points,)
        Torque on the output, as it turns it ccw positive, ascending through negative to positive, N·mm.
    wheel_angle : array, shape (angles, points)
        Wheel angle, rad.
    output_angle : array, shape (angles, points)
        Deviation of the output with the input held, rad.
    backlash : array, shape (angles,)
        Free play of the output with every clearance (`ltca.geometry.play`), rad; where forces from outside displace the wheel
        what these leave of it.
    lost_motion : array, shape (angles,)
        Between ± `lost_motion_part` of the rated torque, rad; with friction between the middles of the loop there.
    stiffness : array, shape (angles, 2)
        Torsional stiffness of the cycloid stage, all discs, from half the rated torque to all of it, clockwise and
        counter-clockwise, cranks held, N·mm/rad.
    reducer_stiffness : array, shape (angles, 2)
        The same with the input held: of everything that the file describes, N·mm/rad.
    yielding : YieldingParts
        What yields in both, and what is rigid because the file leaves it out.
    displaced : bool
        Whether forces from outside displace the wheel.
    lost_motion_part : float
        Part of the rated torque at which lost motion is read.
    loop : HysteresisLoop or None
        Of a drive with friction.
    """

    crank_angle: FloatArray
    torque: FloatArray
    wheel_angle: FloatArray
    output_angle: FloatArray
    backlash: FloatArray
    lost_motion: FloatArray
    stiffness: FloatArray
    reducer_stiffness: FloatArray
    yielding: YieldingParts
    displaced: bool = False
    lost_motion_part: float = LOST_MOTION
    loop: HysteresisLoop | None = None


@names_unit_mistakes
def torque_curve(
    drive: Drive,
    crank_angle: FloatArray,
    *,
    points: int = 40,
    engine: Engine | None = None,
    lost_motion: float = LOST_MOTION,
) -> TorqueCurve:
    """Load the output both ways at held crank angles.

    Parameters
    ----------
    drive : Drive
        The drive; its torque is the rated one.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    points : int
        Torques of each direction, evenly spaced in their square root (dense where the curve bends); 0 for those alone at which
        lost motion and stiffness are read.
    engine : Engine, optional
        How bodies yield; half-spaces by default.
    lost_motion : float
        Part of the rated torque at which lost motion is read, from 0.001 to 0.5.

    Returns
    -------
    TorqueCurve

    Raises
    ------
    ConvergenceError
        When a position does not balance, or nothing stops the output without load.
    DriveError
        When the lost motion is to be read elsewhere.
    """
    if not LEAST_PART <= lost_motion <= MOST_PART:
        raise DriveError(
            [f"lost_motion = {lost_motion:g}: must be from {LEAST_PART:g} to {MOST_PART:g} of the rated torque"]
        )
    angles = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    rated = drive.require_torque("torque curves, which go up to it").load.torque
    along = np.linspace(LEAST_TORQUE_RATIO**0.5, 1.0, points) ** 2
    least = [LEAST_TORQUE_RATIO] if points else []
    parts = np.unique(np.concatenate([along, least, [lost_motion, STIFF_FROM, 1.0]]))
    torque = rated * np.concatenate([-parts[::-1], parts])
    held = np.repeat(angles, torque.size)
    # A torque that turns the output ccw opposes a crank driving ccw with the wheel as output; the pin shaft turns the
    # other way, and so does what opposes it.
    opposing = (1.0 if drive.wheel_is_held else -1.0) * drive.driving_sign
    loads = np.tile(opposing * torque, angles.size)
    model = tables = replace(HalfSpace().prepare(drive).model, friction=None)
    found = solve_at_output(tables, [drive], held, loads)
    if not (engine is None or engine == HalfSpace()):
        model = replace(engine.prepare(drive).model, friction=None)
        found = solve_at_output(model, [drive], held, loads, found.pose)
    wheel = found.pose[:, WHEEL_ANGLE].reshape(angles.size, torque.size)
    of_stage = drive.output_deviation(wheel, opposing * torque)
    by_input = wheel_angle_of_input(model, found).reshape(wheel.shape)
    output = drive.output_deviation(by_input, opposing * torque)

    def at(part: float, angle: FloatArray = output) -> FloatArray:
        return np.asarray(angle[:, int(np.argmin(np.abs(torque - part * rated)))])

    def stiffness(angle: FloatArray) -> FloatArray:
        low, high = at(-STIFF_FROM, angle) - at(-1.0, angle), at(1.0, angle) - at(STIFF_FROM, angle)
        return np.stack([half / low, half / high], axis=1)

    loop = None
    if drive.friction is not None:
        loop = hysteresis_loop(drive, angles, lost_motion=lost_motion, engine=engine)
    half = (1.0 - STIFF_FROM) * rated
    return TorqueCurve(
        crank_angle=angles,
        torque=torque,
        wheel_angle=wheel,
        output_angle=output,
        backlash=abs(drive.output_per_wheel_angle)
        * (_play(tables, drive, angles) + play_before_cranks(tables, angles)),
        lost_motion=at(lost_motion) - at(-lost_motion) if loop is None else loop.lost_motion,
        stiffness=stiffness(of_stage),
        reducer_stiffness=stiffness(output),
        yielding=yielding_parts(drive),
        displaced=_displaced(tables),
        lost_motion_part=lost_motion,
        loop=loop,
    )


def _displaced(model: Reducer) -> bool:
    """Tell whether forces from outside displace the wheel."""
    return model.external is not None and model.coordinates.wheel and bool(np.any(model.external.on_wheel(np.zeros(1))))


def _play(model: Reducer, drive: Drive, crank_angle: FloatArray) -> FloatArray:
    """Return the free play of the wheel with the cranks held, or what forces from outside leave of it, rad, (angles,)."""
    free = free_play(model.geometries, crank_angle).play
    if not _displaced(model):
        return free
    for part in GAP_TORQUE_RATIOS:
        torque = np.tile(part * drive.load.torque * np.array([-1.0, 1.0]), crank_angle.size)
        try:
            found = solve_at_output(model, [drive], np.repeat(crank_angle, 2), torque)
        except ConvergenceError:  # loads that are round-off beside those of a large arm
            if part == GAP_TORQUE_RATIOS[-1]:
                raise
            continue
        break
    ends = found.pose[:, WHEEL_ANGLE].reshape(-1, 2)
    return np.asarray(np.where(free > 0.0, np.abs(ends[:, 1] - ends[:, 0]), 0.0))


def torsional_stiffness(drive: Drive, crank_angle: FloatArray, *, engine: Engine | None = None) -> FloatArray:
    """Return the `TorqueCurve.reducer_stiffness` alone, which takes a third of the time: small torques are the dear ones.

    Parameters are those of `torque_curve`; shape (angles, 2), N·mm/rad.
    """
    angles, rated = np.atleast_1d(np.asarray(crank_angle, dtype=float)), drive.load.torque
    sense = (1.0 if drive.wheel_is_held else -1.0) * drive.driving_sign
    parts = np.array([-1.0, -STIFF_FROM, STIFF_FROM, 1.0])
    model = replace((HalfSpace() if engine is None else engine).prepare(drive).model, friction=None)
    loads = sense * rated * np.tile(parts, angles.size)
    found = solve_at_output(model, [drive], np.repeat(angles, parts.size), loads)
    wheel = wheel_angle_of_input(model, found).reshape(angles.size, parts.size)
    output = drive.output_deviation(wheel, sense * rated * parts)
    return np.asarray((1.0 - STIFF_FROM) * rated / np.diff(output, axis=1)[:, [0, 2]])


def curve_content(curve: TorqueCurve, drive: Drive) -> dict[str, Any]:
    """Return a torque curve as files hold it.

    Parameters
    ----------
    curve : TorqueCurve
        The curve.
    drive : Drive
        Whose it is.
    """
    return {
        "number_of_discs": drive.disc.number_of_discs,
        "held": drive.installation.held,
        "crank_angle_rad": curve.crank_angle.tolist(),
        "torque_N_mm": curve.torque.tolist(),
        "wheel_angle_rad": curve.wheel_angle.tolist(),
        "output_angle_rad": curve.output_angle.tolist(),
        "backlash_rad": curve.backlash.tolist(),
        "lost_motion_part": curve.lost_motion_part,
        "lost_motion_rad": curve.lost_motion.tolist(),
        "stiffness_N_mm_per_rad": curve.stiffness.tolist(),
        "reducer_stiffness_N_mm_per_rad": curve.reducer_stiffness.tolist(),
        "torsional_stiffness_of": curve.yielding.content,
        "hysteresis": _loop(curve.loop),
    }


def _loop(loop: HysteresisLoop | None) -> dict[str, Any] | None:
    if loop is None:
        return None
    return {
        "torque_N_mm": loop.torque.tolist(),
        "rising_output_angle_rad": loop.rising.tolist(),
        "falling_output_angle_rad": loop.falling.tolist(),
        "width_rad": loop.width.tolist(),
        "energy_N_mm": loop.energy.tolist(),
    }
