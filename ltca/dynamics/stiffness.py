"""Stiffness of a drive about balanced positions, over the coordinates of its motion, without friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.response import Response, Start
from ltca.dynamics.kinetics import Motion
from ltca.equilibrium.balance import Equilibrium, lever_arms
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE, X, Y

STEP = 1e-5
"""Step of the crank angle, rad: contacts move by nanometres, round-off of the forces is 1e-6 of their change."""


def stiffness_matrices(model: Reducer, motion: Motion, found: Equilibrium) -> FloatArray:
    """Return the stiffness at positions that a model without friction balanced, N/mm, N and N·mm, shape (positions, n, n)."""
    angle, pose, start = found.crank_angle, found.pose, Start.after(found.response)
    contacts = replace(model, supports=None, stage=None, friction=None, external=None)
    tangent = contacts.whole_tangent(angle, pose, start, np.broadcast_to(lever_arms(model), pose.shape))
    if model.supports is not None:
        # What bearings of cranks with clearance or preload yield depends on all that they carry.
        carried = model.carried_beside_discs(angle, pose, found.response.parts)
        tangent = tangent + model.supports.respond(pose, carried)[1]
    ends = []
    for sense in (-1.0, 1.0):
        turned = angle + sense * STEP
        response = contacts.respond(turned, pose, start)
        ends.append(np.concatenate((response.force, crank_force(contacts, turned, pose, response)[:, None]), axis=1))
    by_crank = (ends[1] - ends[0]) / (2.0 * STEP)
    stiffness = np.zeros((angle.size, motion.size, motion.size))
    pose_size = motion.pose.size
    stiffness[:, :pose_size, :pose_size] = 0.5 * (tangent + tangent.swapaxes(1, 2))
    stiffness[:, : pose_size + 1, motion.crank] = by_crank
    stiffness[:, motion.crank, :pose_size] = by_crank[:, :pose_size]
    if motion.sun is not None:
        row = motion.unit(motion.crank) - motion.unit(motion.sun)
        row[:pose_size] += motion.mesh_by_pose
        stiffness += np.outer(row, row) / motion.mesh_compliance
    return stiffness + motion.springs


def crank_force(model: Reducer, crank_angle: FloatArray, pose: FloatArray, response: Response) -> FloatArray:
    """∂U/∂φ_C at a held pose, N·mm: moments of the cranks, and work of the forces on the nominal motion of discs and wheel."""
    moment = model.crank_moments(crank_angle, pose, response.parts).sum(axis=1)
    for number, disc in enumerate(model.discs):
        own, velocity = model.coordinates.columns(number), disc.geometry.placement.races(crank_angle).velocity
        moment = moment + response.force[:, own[X]] * velocity.real + response.force[:, own[Y]] * velocity.imag
    ratio = model.discs[0].geometry.placement.reduction_ratio
    return np.asarray(moment + response.force[:, WHEEL_ANGLE] / ratio)


def levers(model: Reducer, motion: Motion) -> FloatArray:
    """Return the lengths by which coordinates of one drive are displacements, mm, shape (n,): 1 of displacements."""
    pose = np.atleast_2d(lever_arms(model))[0]
    found = np.full(motion.size, float(model.discs[0].geometry.placement.mean_eccentricity.ravel()[0]))
    found[: pose.size] = pose
    if motion.twist is not None:
        found[motion.twist] = pose[-1]
    return found
