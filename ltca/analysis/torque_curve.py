"""Torque against wind-up over both directions, and what is read from it: backlash, lost motion, torsional stiffness.

The crank is held, the output is loaded one way and the other. Without friction the curve has no loop; what remains
between the branches at vanishing torque is the play of all clearances together. Torques are those of the whole drive:
its discs share them alike, and turn the wheel together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.engines import Engine
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import names_unit_mistakes
from ltca.equilibrium.balance import solve_equilibrium
from ltca.geometry.pairs import WHEEL_ANGLE

FloatArray = NDArray[np.float64]

SMALLEST = 1e-4
"""Smallest torque as a part of the rated one: elastic wind-up is some 1e-4 of its rated value there."""
LOST_MOTION = 0.03
"""Lost motion is read between ± this part of the rated torque, as makers of precision reducers do."""
STIFF_FROM = 0.5
"""Torsional stiffness is the mean slope from this part of the rated torque to the whole."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueCurve:
    """Wind-up of the wheel at held crank angles.

    Attributes
    ----------
    crank_angle : array, shape (angles,)
        φ_C, rad.
    torque : array, shape (points,)
        Moment on the wheel of all discs together, ccw positive, ascending through negative to positive, N·mm.
    wheel_angle : array, shape (angles, points)
        Wheel angle, rad.
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
    """Load the wheel both ways at held crank angles.

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
    rated, share = drive.load.torque, drive.disc.torque_share
    parts = np.unique(
        np.concatenate([np.linspace(SMALLEST**0.5, 1.0, points) ** 2, [SMALLEST, LOST_MOTION, STIFF_FROM]])
    )
    torque = rated * np.concatenate([-parts[::-1], parts])
    held, moment = np.repeat(angles, torque.size), np.tile(share * torque, angles.size)
    tables = HalfSpaceCompliance.of_drive(drive)
    found = solve_equilibrium(tables, held, moment)
    model = tables if engine is None else engine.prepare(drive).model
    if not isinstance(model, HalfSpaceCompliance):
        found = solve_equilibrium(model, held, moment, found.pose)
    wheel = found.pose[:, WHEEL_ANGLE].reshape(angles.size, torque.size)

    def at(part: float) -> FloatArray:
        return np.asarray(wheel[:, int(np.argmin(np.abs(torque - part * rated)))])

    half = (1.0 - STIFF_FROM) * rated
    return TorqueCurve(
        crank_angle=angles,
        torque=torque,
        wheel_angle=wheel,
        backlash=at(SMALLEST) - at(-SMALLEST),
        lost_motion=at(LOST_MOTION) - at(-LOST_MOTION),
        stiffness=np.stack([half / (at(-STIFF_FROM) - at(-1.0)), half / (at(1.0) - at(STIFF_FROM))], axis=1),
    )
