"""Frictionless unilateral contact: p ≥ 0, w = A p − penetration ≥ 0, p·w = 0 for a symmetric positive definite A.

Block principal pivoting releases every cell that pulls, adds every one that overlaps and solves again; where the number of
offending cells does not fall, Murty's rule exchanges the last one alone, which terminates.
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
    """Solution of a unilateral contact problem."""

    pressure: FloatArray
    active: BoolArray  # cells in contact
    rate: FloatArray  # A⁻¹ load_direction on the contact, zero outside and without a direction
    history: tuple[int, ...]  # offending cells before each solve


def solve_unilateral_contact(
    influence: FloatArray,
    penetration: FloatArray,
    *,
    start: BoolArray | None = None,
    load_direction: FloatArray | None = None,
) -> UnilateralSolution:
    """Solve p ≥ 0, A p − penetration ≥ 0, p·(A p − penetration) = 0 exactly by block principal pivoting.

    J. J. Júdice, F. M. Pires, Comput. Oper. Res. 21 (1994) 587. `load_direction`, (n,) or (n, directions), asks for `rate`.
    ConvergenceError if A is not positive definite on a contact set, or iterations run out.
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
