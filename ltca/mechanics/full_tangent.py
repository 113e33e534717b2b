"""The whole tangent of the contacts: with the derivatives of laws and bodies by the places of the contacts, which a search leaves
out.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.mechanics.contacts import Linearised
from ltca.mechanics.pressing import BySlope

STEP = 1e-3
"""Step of the places, mm: curvatures change over millimetres, and round-off of places is 1e-11 of it."""
PASSES = 3
"""Times that displaced pins are taken along: each leaves a thousandth of what the one before did."""


def with_whole_tangent(at: Linearised, lever: FloatArray) -> Linearised:
    r"""Return contacts that have settled with the derivative of their force by the pose, nothing left out.

    Beside the tangent of a search, with f(e, ρ) the load of a law, ρ the radius of curvature where it presses and C what the
    bodies yield, a contact takes :math:`\partial_q C\, f` more, and its load goes by :math:`\partial_\rho f\, \rho'` without its
    deformation.

    Parameters
    ----------
    at : Linearised
        Contacts, found exactly.
    lever : array, shape (coordinates,) or (positions, coordinates)
        Lengths by which coordinates are displacements, mm.
    """
    found = copy(at)
    for _ in range(1 if at.shifts is None else PASSES):
        found.by_slope = _slopes(at, found.inner.shifts_by_pose, lever)
        found.linearise()
    return found


def _slopes(at: Linearised, shifts_by_pose: ComplexArray | None, lever: FloatArray) -> BySlope:
    """Differences of loads and of what bodies take between places a step to either side, coordinate by coordinate."""
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
