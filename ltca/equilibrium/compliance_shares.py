r"""Which parts of the reducer yield how much of what its output yields: shares of the compliance at a balanced position.

A little more torque moves everything by :math:`dq = K^{-1} e\, dT`. The work of that torque, :math:`dT\, d\psi`, is what the
contacts take, :math:`\sum dF_i\, d\delta_i`, and the supports, :math:`dq^T K_S\, dq`; what is left is geometry: loads that turn
with their contacts. Changes of loads come from two poses beside the balanced one, whatever the bodies' compliance is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import Start, bearing_pushes
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE

PARTS = ("pins", "crank_bearings", "shaft_pins", "cranks", "wheel_bearing", "geometry")
RELATIVE_TORQUE_STEP = 1e-4
"""Relative change of the torque: loads follow it linearly, and round-off stays below 1e-4 of their change."""


def compliance_shares(model: Reducer, found: Equilibrium) -> dict[str, FloatArray]:
    """Return the shares of the wheel's compliance by part (`PARTS`), crank held, shape (positions,); they add up to one.

    They are not a number where nothing resists a free motion.
    """
    response, size = found.response, found.pose.shape[1]
    if model.friction is not None:  # what bodies yield, not what rubs
        model = replace(model, friction=None)
        response = model.respond(found.crank_angle, found.pose, Start.after(response))
    tangent = response.tangent
    one = np.zeros((found.pose.shape[0], size, 1))
    one[:, WHEEL_ANGLE] = RELATIVE_TORQUE_STEP * found.wheel_moment[:, None]
    try:
        moved: FloatArray = np.asarray(np.linalg.solve(tangent, one)[..., 0], dtype=float)
    except np.linalg.LinAlgError:  # a disc that carries nothing floats
        return dict.fromkeys(PARTS, np.full(found.pose.shape[0], np.nan))
    start = Start.after(response)
    ends = [model.respond(found.crank_angle, found.pose + side * moved, start) for side in (0.5, -0.5)]
    work = {part: np.zeros(found.pose.shape[0]) for part in PARTS}
    for number, here in enumerate(response.parts):
        own = moved[:, model.coordinates.columns(number)]
        up, down = (end.parts[number] for end in ends)
        work["pins"] += _taken(here.flank.gradient, own, up.pin_load - down.pin_load)
        work["shaft_pins"] += _taken(here.holes.gradient, own, up.hole_load - down.hole_load)
        bores = model.discs[number].geometry.bores(found.crank_angle, found.pose[:, model.coordinates.columns(number)])
        shift = np.einsum("bcj,bj->bc", bores.gradient, own)
        push = bearing_pushes(up.rollers, shift.shape[1]) - bearing_pushes(down.rollers, shift.shape[1])
        work["crank_bearings"] -= (push.conjugate() * shift).real.sum(axis=1)
    if model.supports is not None:
        stiffness = model.supports.respond(found.pose)[1]
        wheel, ring = np.zeros(size, dtype=bool), np.zeros(size, dtype=bool)
        wheel[model.coordinates.wheel_place] = True
        ring[model.coordinates.ring_place] = True
        for part, columns in (("cranks", ~(wheel | ring)), ("wheel_bearing", wheel), ("shaft_pins", ring)):
            held = np.where(columns, moved, 0.0)
            work[part] += np.matmul(held[:, None, :], np.matmul(stiffness, held[..., None]))[:, 0, 0]
    total = one[:, WHEEL_ANGLE, 0] * moved[:, WHEEL_ANGLE]
    work["geometry"] = total - sum(work[part] for part in PARTS[:-1])
    return {part: value / total for part, value in work.items()}


def _taken(gradient: FloatArray, moved: FloatArray, change: FloatArray) -> FloatArray:
    """Work of changed loads along the approaches of a motion."""
    return np.asarray((np.einsum("bij,bj->bi", gradient, moved) * change).sum(axis=1))
