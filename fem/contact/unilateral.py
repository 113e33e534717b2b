r"""Unilateral contact on condensed bodies: pressures that never pull and gaps that never close below zero.

Minimise :math:`\tfrac12 p^T S p + g^T p` over :math:`p \ge 0` with :math:`G^T p = f`; the multipliers of the
equilibrium are the rigid motions q,

.. math:: w = S p + g + G q \ge 0, \quad p \ge 0, \quad p_i w_i = 0, \quad G^T p = f.

A primal–dual active set (a semi-smooth Newton method: Hintermüller, Ito & Kunisch 2002) solves it; every
step is one small dense system, and at the end equilibrium holds to round-off. From a bad first guess it may
cycle; then an interior-point method (Nocedal & Wright, *Numerical Optimization*, 16.6), which converges from
anywhere but ends slightly inside the bounds, provides the active set to continue with.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sla

from ltca.arrays import BoolArray, FloatArray
from ltca.errors import ConvergenceError

# A rigid motion whose pivot is this much smaller than the others is not held by the active contacts.
SINGULAR_MOTION = 1e-12
# Active-set steps before the interior-point method is asked; a good start needs fewer than ten.
MAX_PLAIN_STEPS = 30
MAX_INTERIOR_STEPS = 120
CENTRING = 0.1


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
        Rigid motions; bodies that no contact holds rest midway between their neighbours.
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


def solve_floating_contact(problem: ContactProblem, start: BoolArray, *, limit: int = 120) -> ContactSolution:
    """Solve the contact problem by a primal–dual active set.

    Parameters
    ----------
    problem : ContactProblem
        The condensed problem.
    start : array of bool, shape (m,)
        First guess of the active set.
    limit : int
        Active-set steps.

    Returns
    -------
    ContactSolution
        Complementary to round-off.

    Raises
    ------
    ConvergenceError
        When no pressures balance the load (history: relative imbalance) or the active set does not settle
        (history: number of unknowns that changed in each step).
    """
    active = np.array(start, dtype=bool)
    history: list[float] = []
    seen: set[bytes] = set()
    restarted = False
    for iteration in range(1, limit + 1):
        key = np.packbits(active).tobytes()
        if not restarted and (key in seen or iteration > MAX_PLAIN_STEPS or not np.any(active)):
            active = find_active_set(problem)
            restarted = True
        seen.add(key)
        active &= ~_pushed_one_way(problem, active)
        pressure, motion = _equilibrium_of(problem, active)
        motion = _rest_idle(problem, active, pressure, motion)
        opening = problem.compliance @ pressure + problem.gap + problem.motions @ motion
        scale = float(np.max(np.abs(problem.gap[active]), initial=0.0)) + float(np.max(np.abs(opening)))
        changed = (active & (pressure < 0.0)) | (~active & (opening < -1e-13 * scale))
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
        if restarted and iteration > MAX_PLAIN_STEPS and iteration % 2:
            # What still flips are unknowns that hardly touch: exchange them one by one (Murty's rule).
            changed[: int(np.flatnonzero(changed)[-1])] = False
        active = active ^ changed
    raise ConvergenceError(f"active set did not settle in {limit} steps; history: unknowns changed", history)


def find_active_set(problem: ContactProblem) -> BoolArray:
    """Return the active set by an interior-point method, from any start.

    ConvergenceError when no pressures balance the external load; the history holds the relative imbalance.
    """
    unit = 1.0 / np.sqrt(np.diag(problem.compliance))
    stiffness = problem.compliance * np.outer(unit, unit)
    motions = problem.motions * unit[:, None]
    reach = np.linalg.norm(motions, axis=0)
    motions = motions / np.where(reach > 0.0, reach, 1.0)
    external = problem.external / np.where(reach > 0.0, reach, 1.0)
    gap = problem.gap * unit
    count = len(gap)
    # Without motions (an approach is given) the pressures are sized by those that would close the gaps one by one.
    load = float(np.max(np.abs(external), initial=0.0)) or float(np.linalg.norm(gap)) or 1.0
    pressure = np.full(count, load / np.sqrt(count))
    opening = np.full(count, max(load / np.sqrt(count), float(np.max(np.abs(gap)))))
    motion = np.zeros(motions.shape[1])
    history: list[float] = []
    for _ in range(MAX_INTERIOR_STEPS):
        dual = stiffness @ pressure + gap + motions @ motion - opening
        primal = motions.T @ pressure - external
        history.append(float(np.max(np.abs(primal), initial=0.0)) / load)
        mean = float(pressure @ opening) / count
        size = float(np.max(np.abs(gap))) + float(np.max(np.abs(stiffness @ pressure)))
        settled = float(np.max(np.abs(dual))) < 1e-10 * size and mean < 1e-12 * float(pressure.max()) * size
        if history[-1] < 1e-10 and settled:
            return np.asarray(pressure / pressure.max() > opening / size)
        target = CENTRING * mean
        right = -dual + target / pressure - opening
        factor = sla.cho_factor(stiffness + np.diag(opening / pressure), lower=True, check_finite=False)
        solved = sla.cho_solve(factor, np.column_stack([motions, right]), check_finite=False)
        schur = motions.T @ solved[:, :-1]
        turn = np.zeros(0)
        if motions.shape[1]:
            turn = np.linalg.lstsq(schur, motions.T @ solved[:, -1] + primal, rcond=1e-14)[0]
        step = solved[:, -1] - solved[:, :-1] @ turn
        opened = target / pressure - opening - opening / pressure * step
        length = min(_longest(pressure, step), _longest(opening, opened))
        pressure, motion, opening = pressure + length * step, motion + length * turn, opening + length * opened
    raise ConvergenceError("no contact pressures balance the load; relative imbalance", history)


def _longest(values: FloatArray, step: FloatArray) -> float:
    """Return the step, at most 1, that keeps all values positive."""
    shrinking = step < 0.0
    if not np.any(shrinking):
        return 1.0
    return min(1.0, 0.97 * float(np.min(-values[shrinking] / step[shrinking])))


def _pushed_one_way(problem: ContactProblem, active: BoolArray) -> BoolArray:
    """Return active unknowns that push an unloaded body one way only: in balance they carry nothing."""
    idle = np.zeros(len(active), dtype=bool)
    for column, load in zip(problem.motions.T, problem.external, strict=True):
        pushing = active & (column != 0.0)
        if load == 0.0 and np.any(pushing) and (np.all(column[pushing] > 0.0) or np.all(column[pushing] < 0.0)):
            idle |= pushing
    return idle


def _rest_idle(problem: ContactProblem, active: BoolArray, pressure: FloatArray, motion: FloatArray) -> FloatArray:
    """Place bodies that no contact holds midway between their neighbours, so that they touch only if squeezed."""
    placed = motion.copy()
    for index, column in enumerate(problem.motions.T):
        if np.any(active & (column != 0.0)):
            continue
        touching = column != 0.0
        others = np.delete(np.arange(len(motion)), index)
        room = (
            problem.compliance[touching] @ pressure
            + problem.gap[touching]
            + problem.motions[np.ix_(touching, others)] @ motion[others]
        ) / np.abs(column[touching])
        forward = column[touching] > 0.0
        if np.any(forward) and not np.all(forward):
            placed[index] = 0.5 * (float(np.min(room[~forward])) - float(np.min(room[forward])))
    return placed


def _equilibrium_of(problem: ContactProblem, active: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return pressures and motions with all active gaps closed."""
    index = np.flatnonzero(active)
    motions = problem.motions[index]
    factor = sla.cho_factor(problem.compliance[np.ix_(index, index)], lower=True, check_finite=False)
    solved = sla.cho_solve(factor, np.column_stack([motions, problem.gap[index]]), check_finite=False)
    stiffness = motions.T @ solved[:, :-1]
    right = -(problem.external + motions.T @ solved[:, -1])
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
