"""The whole tangent of the contacts, with the derivatives of laws and bodies by the places of the contacts."""

from __future__ import annotations

from copy import copy

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.mechanics.contacts import Linearised
from ltca.mechanics.pressing import BySlope

STEP = 1e-3
"""Step of the places, mm: curvatures change over millimetres, and round-off of places is 1e-11 of it."""
PASSES = 3
"""Passes in which displaced pins are taken along: each leaves a thousandth."""


def with_whole_tangent(at: Linearised, lever: FloatArray) -> Linearised:
    """Return settled contacts with the whole derivative of their force by the pose; `lever` is that of coordinates, mm.

    Beside the tangent of a search contacts take ∂C/∂q f more, and their loads go by ∂f/∂ρ ρ′.
    """
    found = copy(at)
    for _ in range(1 if at.shifts is None else PASSES):
        found.by_slope = _slopes(at, found.inner.shifts_by_pose, lever)
        found.linearise()
    return found


def _slopes(at: Linearised, shifts_by_pose: ComplexArray | None, lever: FloatArray) -> BySlope:
    """Differences of loads and of deformations of bodies between places a step to either side, by coordinate."""
    rows, size = at.pose.shape
    load, taken = np.zeros((2, rows, at.system.components, at.count, size))
    pressing = at.of_chosen(at.corrected_load)
    for place, step in enumerate(np.broadcast_to(STEP / lever, (rows, size)).T):
        for sense in (1.0, -1.0):
            moved = (sense * step)[:, None]
            beside, state = copy(at), at.here
            pose = at.pose.copy()
            pose[:, place] += moved[:, 0]
            if at.shifts is not None and shifts_by_pose is not None:
                state = state._replace(shifts=at.shifts + moved[..., None] * shifts_by_pose[..., place])
            beside.stand(pose, state)
            load[..., place] += at.of_chosen(beside.load) / (2.0 * moved[..., None])
            for disc, bodies in enumerate(beside.bodies_between()):
                kinds = at.at[disc]
                walls = slice(kinds[0].start, kinds[2].stop)
                for component, body in enumerate(bodies):
                    each = np.matmul(body.among, pressing[:, component, walls, None])[..., 0]
                    taken[:, component, walls, place] += each / (2.0 * moved)
    return BySlope(load, taken)
