"""Frictionless unilateral contact: pressures that never pull and surfaces that never overlap.

Find p with ``p ≥ 0``, ``w = A p − penetration ≥ 0`` and ``p·w = 0`` for a symmetric positive definite A, the minimum of
``½ p·A·p − penetration·p`` over p ≥ 0, which is unique. Block principal pivoting finds it exactly: release every cell that
pulls, add every cell that overlaps, solve again. Exchange in blocks may cycle in principle, so when the number of offending
cells has not fallen for a few steps single cells are exchanged by Murty's rule (the one of highest index), which terminates.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.errors import ConvergenceError

MAX_ITERATIONS = 500
"""Factorisations."""
_BLOCK_TRIALS = 4
"""Block exchanges without fewer offending cells before single cells are exchanged."""


class UnilateralSolution(NamedTuple):
    """Solution of a unilateral contact problem.

    Pressures are non-negative, zero outside the `active` cells, which are in contact. `rate` solves A q = load_direction on the
    contact, zero outside: the exact tangent of the pressure when the penetration grows by that, all zeros when no direction was
    given. `history` has the number of offending cells before each solve.
    """

    pressure: FloatArray
    active: BoolArray
    rate: FloatArray
    history: tuple[int, ...]


def solve_unilateral_contact(
    influence: FloatArray,
    penetration: FloatArray,
    *,
    start: BoolArray | None = None,
    load_direction: FloatArray | None = None,
) -> UnilateralSolution:
    """Solve p ≥ 0, A p − penetration ≥ 0, p·(A p − penetration) = 0 exactly by block principal pivoting.

    A is `influence`, symmetric positive definite, shape (n, n); `penetration` is the overlap of the undeformed bodies
    (area-weighted if A is), and contact cells are initially `start`, by default those where it is positive. `load_direction`,
    shape (n,) or (n, directions), asks for the tangent `rate`. ConvergenceError if A is not positive definite on a contact set,
    or the iterations run out; its history is the number of offending cells.

    References
    ----------
    J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587 (block principal pivoting with Murty's rule).
    """
    from scipy.linalg import lapack  # 0.1 s to import; laws from tables solve no cells

    count = penetration.size
    active = (penetration > 0.0) if start is None else np.array(start, dtype=bool)
    pressure = np.zeros(count)
    rate = np.zeros(count) if load_direction is None else np.zeros(load_direction.shape)
    history: list[int] = []
    fewest, trials = count + 1, _BLOCK_TRIALS
    scale = float(np.max(np.abs(penetration), initial=0.0))
    for _ in range(MAX_ITERATIONS):
        inside = np.nonzero(active)[0]
        pressure[:] = 0.0
        opening = -penetration
        factor = None
        if inside.size:
            factor, info = lapack.dpotrf(influence[np.ix_(inside, inside)], lower=1, clean=0, overwrite_a=1)
            if info != 0:
                raise ConvergenceError("the influence matrix is not positive definite on the contact cells", history)
            solved, _ = lapack.dpotrs(factor, penetration[inside], lower=1)
            pressure[inside] = solved
            opening = influence[:, inside] @ solved - penetration
            opening[inside] = 0.0
        offending = (pressure < 0.0) | (opening < -1e-13 * scale)
        offenders = int(np.count_nonzero(offending))
        history.append(offenders)
        if offenders == 0:
            if load_direction is not None and factor is not None:
                rate[inside] = lapack.dpotrs(factor, load_direction[inside], lower=1)[0]
            return UnilateralSolution(pressure, active, rate, tuple(history))
        if offenders < fewest:
            fewest, trials = offenders, _BLOCK_TRIALS
        else:
            trials -= 1
        if trials <= 0:  # the last one alone
            offending[: np.nonzero(offending)[0][-1]] = False
        active = active ^ offending
    raise ConvergenceError(
        f"unilateral contact of {count} cells: the contact set did not settle (offending cells listed)", history
    )
