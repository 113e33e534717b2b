"""How far the wheel can turn while no body gives: the play of all clearances together, disc floating.

The farthest wheel angle at which no pair interferes is a linear programme repeated about the pose it ends at
(sequential linear programming); gaps curve little within a clearance, so a few rounds reach round-off. It is what the
loaded analysis tends to as torque goes to zero.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from ltca.errors import ConvergenceError
from ltca.geometry.pairs import ROTATIONS, WHEEL_ANGLE, ContactGeometry, X, Y, disc_displacement

FloatArray = NDArray[np.float64]

TRUST = 2e-3
"""Largest step of a round as a part of e z_P."""


def rigid_poses(geometry: ContactGeometry, crank_angle: FloatArray, sense: int) -> FloatArray:
    """Return the poses in which the wheel is turned as far as rigid bodies allow.

    Parameters
    ----------
    geometry : ContactGeometry
        One drive.
    crank_angle : array, shape (positions,)
        Held φ_C, rad.
    sense : {+1, −1}
        Counter-clockwise or clockwise; −1 is where the load of a crank driving counter-clockwise turns it.

    Returns
    -------
    array, shape (positions, 4)
        q of `ltca.geometry.pairs`.

    Raises
    ------
    ConvergenceError
        When parts interfere in every pose (a drive that cannot be put together without force).
    """
    angles = np.atleast_1d(np.asarray(crank_angle, dtype=float))
    return np.stack([_farthest(geometry, angle, sense) for angle in angles])


def rigid_play(geometry: ContactGeometry, crank_angle: FloatArray) -> FloatArray:
    """Return the play of the wheel with the crank held and the disc floating, rad, shape (positions,)."""
    forward = rigid_poses(geometry, crank_angle, 1)[:, WHEEL_ANGLE]
    return forward - rigid_poses(geometry, crank_angle, -1)[:, WHEEL_ANGLE]


def _gaps(geometry: ContactGeometry, angle: FloatArray, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Approaches of all pairs at one pose and their gradients: pins, holes, rollers."""
    flank, holes, rays = geometry.flank(angle, pose), geometry.holes(angle, pose), geometry.rollers(angle)
    place = disc_displacement(pose)
    # A roller on the inner race presses on the bore with |s n − d| less the bore play.
    arm = rays.outermost * rays.direction - place[:, None]
    length = np.abs(arm)
    rollers = np.zeros((*length.shape, 4))
    rollers[..., X], rollers[..., Y] = -(arm / length).real, -(arm / length).imag
    approach = np.concatenate([flank.approach, holes.approach, length - rays.bore_play], axis=1)[0]
    return approach, np.concatenate([flank.gradient, holes.gradient, rollers], axis=1)[0]


def _farthest(geometry: ContactGeometry, angle: float, sense: int) -> FloatArray:
    place = geometry.placement
    lever = np.array([1.0, 1.0, 1.0, 1.0])
    lever[ROTATIONS] = float(place.eccentricity) * place.reduction_ratio
    pose = np.zeros((1, 4))
    at = np.array([angle])
    history: list[float] = []
    radius = TRUST * lever[WHEEL_ANGLE]
    for _ in range(60):
        approach, gradient = _gaps(geometry, at, pose)
        # Turning on is paid with the worst interference, so that a start that interferes finds its way out.
        rows = np.hstack([gradient / lever, -np.ones((len(approach), 1))])
        solved = linprog(
            [0.0, 0.0, 0.0, -float(sense), 1e3],
            A_ub=rows,
            b_ub=-approach,
            bounds=[(-radius, radius)] * 4 + [(0.0, None)],
            method="highs",
        )
        if not solved.success:
            raise ConvergenceError(f"no rigid pose at crank angle {angle:.6g} rad: {solved.message}", history)
        step = solved.x[:4] / lever
        pose = pose + step
        history.append(float(np.max(np.abs(solved.x[:4]))))
        if history[-1] < 1e-12:
            break
        # Directions without a bound (a disc that slides along its play) must not wander for ever.
        if len(history) > 8:
            radius *= 0.5
    interference = float(np.max(_gaps(geometry, at, pose)[0]))
    if interference > 1e-9:
        raise ConvergenceError(
            f"parts interfere by {interference:.3g} mm in every rigid pose at crank angle {angle:.6g} rad", history
        )
    return np.asarray(pose[0])
