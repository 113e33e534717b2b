"""The angle of the wheel with the input held, and its free play: those of the first stage join those of the cycloid stage."""

from __future__ import annotations

import numpy as np

from ltca.arrays import FloatArray, take_positions
from ltca.compliance.response import Start
from ltca.equilibrium.balance import Equilibrium, lever_arms
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE

LITTLE_MORE = 1e-3
"""Additional torque, by that of all pins, at which shares of cranks are taken; over it they change by some 1e-4."""
FLOATS = 1e-9
"""Stiffness by the largest one, as forces at the pitch circles, below which nothing holds a motion."""


def crank_lag(model: Reducer, found: Equilibrium) -> FloatArray:
    """Return the angle of the cranks less the one that the held input gives them, rad, shape (positions,)."""
    if model.stage is None:
        return np.zeros(found.crank_angle.shape)
    moments = model.crank_moments(found.crank_angle, found.pose, found.response.parts)
    displaced, runout = None, None
    if model.stage.yields:
        carried = model.stage.beside_discs(model.stage.on_planets(moments)[0])
        given = None if model.supports is None else model.supports.given(found.pose, carried)
        displaced = model.stage.displaced(moments, found.pose, given)
    if model.stage.runs_out:
        each = model.stage.lag_by_runout(found.crank_angle, np.sign(moments.sum(axis=1)))
        runout = (shares_of_cranks(model, found, moments) * each).sum(axis=1)
    return model.stage.crank_lag(moments, displaced, runout)


def shares_of_cranks(model: Reducer, found: Equilibrium, moments: FloatArray) -> FloatArray:
    """Return shares of cranks in a little more torque at the wheel (Maxwell), shape (positions, cranks); NaN without answer."""
    response, shares = found.response, np.full(moments.shape, np.nan)
    rows = np.nonzero(np.isfinite(response.tangent).all(axis=(1, 2)) & np.isfinite(moments).all(axis=1))[0]
    if not rows.size:
        return shares
    arms = np.broadcast_to(lever_arms(model), found.pose.shape)[rows]
    own, angle, pose = model.take(rows), found.crank_angle[rows], found.pose[rows]
    response = take_positions(response, rows)
    scaled = response.tangent / (arms[:, :, None] * arms[:, None, :])
    # What floats without load moves no crank: the least motion of all.
    motion = np.linalg.pinv(scaled, rcond=FLOATS)[:, :, WHEEL_ANGLE] / arms / arms[:, WHEEL_ANGLE, None]
    pressed = np.abs(response.flank.gradient[:, :, WHEEL_ANGLE] * response.pin_load)
    sense = np.where(found.wheel_moment[rows] < 0.0, -1.0, 1.0)  # more of what is there, in both directions
    step = (LITTLE_MORE * sense * pressed.sum(axis=1))[:, None]
    moved = pose + step * motion
    after = own.respond(angle, moved, Start.after(response))
    more = own.crank_moments(angle, moved, after.parts) - moments[rows]
    shares[rows] = more / more.sum(axis=1, keepdims=True)
    return shares


def wheel_angle_of_input(model: Reducer, found: Equilibrium) -> FloatArray:
    """Return the deviation of the wheel from its ideal angle by the held input, ccw positive, rad, shape (positions,)."""
    wheel = found.pose[:, WHEEL_ANGLE]
    return wheel if model.stage is None else wheel + crank_lag(model, found) / model.stage.reduction_ratio


def play_before_cranks(model: Reducer, crank_angle: FloatArray) -> FloatArray:
    """Return the free play of the wheel by the first stage, rad, shape (positions,)."""
    return np.zeros(crank_angle.shape) if model.stage is None else model.stage.play(crank_angle)
