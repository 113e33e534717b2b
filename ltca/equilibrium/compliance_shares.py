"""Shares of the parts of the reducer in the compliance of its output, by the work of a little more torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import Response, Start, bearing_moments, bearing_pushes
from ltca.equilibrium.balance import Equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.rotation import unit

PARTS = ("pins", "ring", "crank_bearings", "shaft_pins", "cranks", "wheel_bearing", "carrier", "geometry")
RELATIVE_TORQUE_STEP = 1e-4
"""Relative change of the torque: loads follow linearly, and round-off stays below 1e-4 of their change."""


def compliance_shares(model: Reducer, found: Equilibrium, behind: float = 0.0) -> dict[str, FloatArray]:
    """Return the shares of `PARTS` in the output's compliance, crank held, shape (positions,); NaN where a motion is free."""
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
    poses = [found.pose + side * moved for side in (0.5, -0.5)]
    ends = [model.respond(found.crank_angle, pose, start) for pose in poses]
    work = {part: np.zeros(found.pose.shape[0]) for part in PARTS}
    for number, here in enumerate(response.parts):
        own = moved[:, model.coordinates.columns(number)]
        up, down = (end.parts[number] for end in ends)
        work["pins"] += _taken(here.flank.gradient, own, up.pin_load - down.pin_load)
        work["shaft_pins"] += _taken(here.holes.gradient, own, up.hole_load - down.hole_load)
        geometry = model.discs[number].geometry
        bores = geometry.bores(found.crank_angle, found.pose[:, model.coordinates.columns(number)])
        shift = np.einsum("bcj,bj->bc", bores.gradient, own)
        push = bearing_pushes(up.rollers, shift.shape[1]) - bearing_pushes(down.rollers, shift.shape[1])
        work["crank_bearings"] -= (push.conjugate() * shift).real.sum(axis=1)
        lean = own[:, model.coordinates.lean_place]
        if up.leaning_pins is not None and lean.size:
            for part, name in (("pins", "leaning_pins"), ("shaft_pins", "leaning_holes")):
                change = getattr(up, name).contact.moment - getattr(down, name).contact.moment
                work[part] += _taken(getattr(here, name).tilt.gradient, own, change)
            rays = geometry.rollers(found.crank_angle)
            turning, back = (bearing_moments(end.rollers, rays, shift.shape[1]) for end in (up, down))
            for crank, changed in enumerate((turning - back).T):
                relative = lean
                if model.coordinates.cranks:
                    place = model.coordinates.crank_lean(crank)
                    relative = lean - own[:, place : place + 2]
                work["crank_bearings"] -= changed.real * relative[:, 0] + changed.imag * relative[:, 1]
    if model.pins is not None and ends[0].ring is not None:
        work["ring"] = _of_ring(model, found.crank_angle, poses, ends)
        work["pins"] -= work["ring"]
    if model.supports is not None:
        carried = model.carried_beside_discs(found.crank_angle, found.pose, response.parts)
        stiffness = model.supports.respond(found.pose, carried)[1]
        wheel, ring = np.zeros(size, dtype=bool), np.zeros(size, dtype=bool)
        wheel[model.coordinates.wheel_place] = wheel[model.coordinates.wheel_lean_place] = True
        ring[model.coordinates.ring_place] = True
        relative = moved if model.flange is None else _against_flanges(model, moved)
        work["wheel_bearing"] += _stored(stiffness, np.where(wheel, moved, 0.0))
        work["cranks"] += _stored(stiffness, np.where(wheel | ring, 0.0, relative))
        if model.flange is None:
            work["shaft_pins"] += _stored(stiffness, np.where(ring, moved, 0.0))
        else:
            work["carrier"] += _stored(model.flange, moved[:, model.coordinates.ring_place])
            if model.discs[0].geometry.tips_by_ring.size:  # what is left are the tips of the shaft pins
                held = _stored(stiffness, np.where(wheel, 0.0, moved))
                work["shaft_pins"] += held - work["cranks"] - work["carrier"]
    # The compliance `behind` the wheel, rad/(N·mm), twists up to the output and holds no contact.
    twisted = behind * one[:, WHEEL_ANGLE, 0] ** 2
    work["carrier"] += twisted
    total = one[:, WHEEL_ANGLE, 0] * moved[:, WHEEL_ANGLE] + twisted
    work["geometry"] = total - sum(work[part] for part in PARTS[:-1])
    return {part: value / total for part, value in work.items()}


def _of_ring(
    model: Reducer, crank_angle: FloatArray, poses: Sequence[FloatArray], ends: Sequence[Response]
) -> FloatArray:
    """Work of changed forces on the ring along its displacements."""
    turned, forces = model.discs[0].geometry.placement.wheel_rotation(crank_angle), []
    for pose, end in zip(poses, ends, strict=True):
        pins = end.parts[0].pin_load.shape[1]
        force = sum(part.pin_forces[:, :pins] for part in end.parts)
        forces.append(force * unit(-turned - pose[:, WHEEL_ANGLE])[:, None])
    moved = np.asarray(ends[0].ring) - np.asarray(ends[1].ring)
    return np.asarray(((forces[0] - forces[1]).conjugate() * moved).real.sum(axis=1))


def _against_flanges(model: Reducer, moved: FloatArray) -> FloatArray:
    """Displacements with those and the leans of yielding cranks taken against the straight lines between their bearings."""
    coordinates = model.coordinates
    bent = moved.copy()
    for number, disc in enumerate(model.discs):
        geometry, first = disc.geometry, coordinates.own * number
        seats = np.matmul(geometry.seats_by_ring, moved[:, coordinates.ring_place, None])[..., 0]
        by_flange = [(coordinates.crank, np.asarray(geometry.seat_share) * seats)]
        if coordinates.leans:
            by_flange.append((coordinates.crank_lean, np.asarray(geometry.crank_slopes)[..., 1, None] * seats))
        for place, given in by_flange:
            for crank in range(coordinates.cranks):
                x = first + place(crank)
                bent[:, x] -= given[:, crank].real
                bent[:, x + 1] -= given[:, crank].imag
    return bent


def _stored(stiffness: FloatArray, moved: FloatArray) -> FloatArray:
    """Work of the forces of springs along a motion, shape (positions,)."""
    return np.asarray(np.matmul(moved[:, None, :], np.matmul(stiffness, moved[..., None]))[:, 0, 0])


def _taken(gradient: FloatArray, moved: FloatArray, change: FloatArray) -> FloatArray:
    """Work of changed loads along the approaches of a motion."""
    return np.asarray((np.einsum("bij,bj->bi", gradient, moved) * change).sum(axis=1))
