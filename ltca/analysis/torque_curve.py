"""Torque against wind-up over both directions, and what is read from it: backlash, lost motion, torsional stiffness.

The crank is held, the output is loaded one way and the other. Without friction the curve has no loop; what remains
between the branches at vanishing torque is the play of all clearances together. Torques and angles are those of the
output, whichever member that is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import Engine, HalfSpace
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE

FloatArray = NDArray[np.float64]

SMALLEST = 1e-4
"""Smallest torque as a part of the rated one: elastic wind-up is some 1e-4 of its rated value there."""
LOST_MOTION = 0.03
"""Lost motion is read between ± this part of the rated torque, as makers of precision reducers do."""
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
        Deviation of the output, rad: that of the wheel with the pin shaft held.
    backlash : array, shape (angles,)
        Between the branches at the smallest torques, rad.
    lost_motion : array, shape (angles,)
        Between ±3 % of the rated torque, rad.
    stiffness : array, shape (angles, 2)
        Of the whole drive, from half the rated torque to all of it, clockwise and counter-clockwise, N·mm/rad.
    """

    crank_angle: FloatArray
    torque: FloatArray
    wheel_angle: FloatArray
    output_angle: FloatArray
    backlash: FloatArray
    lost_motion: FloatArray
    stiffness: FloatArray


@names_unit_mistakes
def torque_curve(
    drive: Drive,
    crank_angle: FloatArray,
    *,
    points: int = 40,
    engine: Engine | None = None,
) -> TorqueCurve:
    """Load the output both ways at held crank angles.

    Parameters
    ----------
    drive : Drive
        The drive; its torque is the rated one.
    crank_angle : array, shape (angles,)
        φ_C, rad.
    points : int
        Torques of each direction, evenly spaced in their square root (dense where the curve bends).
    engine : Engine, optional
        How bodies yield; half-spaces by default.

    Returns
    -------
    TorqueCurve

    Raises
    ------
    ConvergenceError
        When a position does not balance.
    """
    angles = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    rated = drive.load.torque
    parts = np.unique(
        np.concatenate([np.linspace(SMALLEST**0.5, 1.0, points) ** 2, [SMALLEST, LOST_MOTION, STIFF_FROM]])
    )
    torque = rated * np.concatenate([-parts[::-1], parts])
    held = np.repeat(angles, torque.size)
    # A torque that turns the output ccw opposes a crank driving ccw with the wheel as output; the pin shaft turns the
    # other way, and so does what opposes it.
    opposing = (1.0 if drive.wheel_is_held else -1.0) * drive.driving_sign
    loads = np.tile(opposing * torque, angles.size)
    tables = HalfSpace().prepare(drive).model
    found = solve_at_output(tables, drive, held, loads)
    model = tables if engine is None else engine.prepare(drive).model
    if not isinstance(model.discs[0], HalfSpaceCompliance):
        found = solve_at_output(model, drive, held, loads, found.pose)
    wheel = found.pose[:, WHEEL_ANGLE].reshape(angles.size, torque.size)
    output = drive.output_per_wheel_angle * wheel

    def at(part: float) -> FloatArray:
        return np.asarray(output[:, int(np.argmin(np.abs(torque - part * rated)))])

    half = (1.0 - STIFF_FROM) * rated
    return TorqueCurve(
        crank_angle=angles,
        torque=torque,
        wheel_angle=wheel,
        output_angle=output,
        backlash=at(SMALLEST) - at(-SMALLEST),
        lost_motion=at(LOST_MOTION) - at(-LOST_MOTION),
        stiffness=np.stack([half / (at(-STIFF_FROM) - at(-1.0)), half / (at(1.0) - at(STIFF_FROM))], axis=1),
    )
