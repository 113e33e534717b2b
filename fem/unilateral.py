r"""Unilateral contact on condensed bodies: pressures that never pull and gaps that never close below zero.

Minimise :math:`\tfrac12 p^T S p + g^T p` over :math:`p \ge 0` with :math:`G^T p = f`; the multipliers of the
equilibrium are the rigid motions q,

.. math:: w = S p + g + G q \ge 0, \quad p \ge 0, \quad p_i w_i = 0, \quad G^T p = f.

A primal–dual active set (a semi-smooth Newton method: Hintermüller, Ito & Kunisch 2002) solves it; every
step is one small dense system, and at the end equilibrium holds to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sla
from numpy.typing import NDArray

from ltca.errors import ConvergenceError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# A rigid motion whose pivot is this much smaller than the others is not held by the active contacts.
SINGULAR_MOTION = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactProblem:
    """Condensed contact problem.

    Attributes
    ----------
    compliance : array, shape (m, m)
        S, weighted gap opened by a unit of each pressure.
    gap : array, shape (m,)
        g, weighted gap of the undeformed bodies.
    motions : array, shape (m, r)
        G, weighted gap opened by a unit of each rigid motion.
    external : array, shape (r,)
        f = Gᵀp in equilibrium: minus the external load on each rigid motion.
    """

    compliance: FloatArray
    gap: FloatArray
    motions: FloatArray
    external: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactSolution:
    """Solution of a condensed contact problem.

    Attributes
    ----------
    pressure : array, shape (m,)
        MPa.
    motion : array, shape (r,)
        Rigid motions; those no active contact holds are zero.
    opening : array, shape (m,)
        w, weighted gap left.
    active : array of bool, shape (m,)
        Unknowns in contact.
    residual : float
        Largest entry of Gᵀp − f relative to the largest force on that motion.
    iterations : int
        Active-set steps.
    """

    pressure: FloatArray
    motion: FloatArray
    opening: FloatArray
    active: BoolArray
    residual: float
    iterations: int


def solve_unilateral_contact(
    problem: ContactProblem, start: BoolArray, *, limit: int = 200, damping: FloatArray | None = None
) -> ContactSolution:
    """Solve the contact problem by a primal–dual active set.

    Parameters
    ----------
    problem : ContactProblem
        The condensed problem.
    start : array of bool, shape (m,)
        First guess of the active set.
    limit : int
        Active-set steps.
    damping : array, shape (r,), optional
        Proximal term of each rigid motion: the equilibrium then reads Gᵀp − damping·q = f. Used while a pose is
        far off; a converged pose has q = 0, so that no trace of it is left.

    Returns
    -------
    ContactSolution
        Complementary to round-off.

    Raises
    ------
    ConvergenceError
        When nothing is in contact or the active set does not settle; the history holds the number of
        unknowns that changed in each step.
    """
    active = np.array(start, dtype=bool)
    history: list[float] = []
    seen: set[bytes] = set()
    single = False
    for iteration in range(1, limit + 1):
        if not np.any(active):
            raise ConvergenceError("no contact is left that could carry the load", history)
        pressure, motion = _equilibrium_of(problem, active, damping)
        opening = problem.compliance @ pressure + problem.gap + problem.motions @ motion
        scale = float(np.max(np.abs(problem.gap[active]), initial=0.0)) + float(np.max(np.abs(opening)))
        leaving = active & (pressure < 0.0)
        entering = ~active & (opening < -1e-13 * scale)
        changed = leaving | entering
        history.append(float(np.count_nonzero(changed)))
        if not np.any(changed):
            return ContactSolution(
                pressure=np.where(active, pressure, 0.0),
                motion=motion,
                opening=np.where(active, 0.0, opening),
                active=active,
                residual=_imbalance(problem, pressure),
                iterations=iteration,
            )
        following = active ^ changed
        key = np.packbits(following).tobytes()
        single = single or key in seen
        seen.add(key)
        if single:
            # The full step cycles: exchange one unknown at a time, the last by number (Murty's rule), which
            # ends after finitely many steps.
            only = int(np.flatnonzero(changed)[-1])
            following = active.copy()
            following[only] = ~following[only]
        active = following
    raise ConvergenceError(f"active set did not settle in {limit} steps; history: unknowns changed", history)


def _equilibrium_of(
    problem: ContactProblem, active: BoolArray, damping: FloatArray | None
) -> tuple[FloatArray, FloatArray]:
    """Return pressures and motions with all active gaps closed."""
    index = np.flatnonzero(active)
    motions = problem.motions[index]
    factor = sla.cho_factor(problem.compliance[np.ix_(index, index)], lower=True, check_finite=False)
    solved = sla.cho_solve(factor, np.column_stack([motions, problem.gap[index]]), check_finite=False)
    stiffness = motions.T @ solved[:, :-1]
    right = -(problem.external + motions.T @ solved[:, -1])
    if damping is not None:
        stiffness = stiffness + np.diag(damping)
    motion = _solve_held(0.5 * (stiffness + stiffness.T), right)
    pressure = np.zeros(len(problem.gap))
    pressure[index] = -(solved[:, -1] + solved[:, :-1] @ motion)
    return pressure, motion


def _solve_held(stiffness: FloatArray, right: FloatArray) -> FloatArray:
    """Solve for the motions that contacts hold; the others stay zero."""
    scale = np.sqrt(np.maximum(np.diag(stiffness), 0.0))
    held = scale > 0.0
    motion = np.zeros(len(right))
    if not np.any(held):
        return motion
    unit = scale[held]
    values, vectors = np.linalg.eigh(stiffness[np.ix_(held, held)] / np.outer(unit, unit))
    good = values > SINGULAR_MOTION
    amounts = (vectors.T @ (right[held] / unit))[good] / values[good]
    motion[held] = (vectors[:, good] @ amounts) / unit
    return motion


def _imbalance(problem: ContactProblem, pressure: FloatArray) -> float:
    carried = np.abs(problem.motions).T @ np.abs(pressure)
    left = np.abs(problem.motions.T @ pressure - problem.external)
    scale = np.maximum(carried, np.abs(problem.external))
    return float(np.max(left[scale > 0.0] / scale[scale > 0.0], initial=0.0))
