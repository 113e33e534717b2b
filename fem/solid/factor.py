"""Factors of large symmetric positive definite matrices of extruded bodies.

CHOLMOD (cvxopt, the extra ``fast``) where it is installed, else SuperLU in symmetric mode, which takes longer and more memory.
Both eliminate the unknowns in the order in which they are given (`fem.solid.order`, or all heights of a node together in the
order of `fem.body.condensation.order_nodes`).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import scipy.sparse as sp

from fem.body.condensation import SYMMETRIC
from fem.body.sparse_factor import enough_memory, factor_sparse
from ltca.arrays import FloatArray, IntArray

BLOCK = 16
"""Right-hand sides that SuperLU solves together: more leave its cache."""


class SymmetricFactor:
    """Factor of the kept rows and columns of a symmetric positive definite matrix.

    Parameters
    ----------
    matrix : csc_matrix, shape (unknowns, unknowns)
        Symmetric.
    kept : array of int
        Unknowns in their order of elimination; the others are held at zero.
    many_loads : bool
        Whether hundreds of right-hand sides follow: SuperLU then, whose factor takes a third longer and whose solutions take
        less than half of the time of CHOLMOD's (measured from 40,000 to 160,000 unknowns).
    """

    def __init__(self, matrix: sp.csc_matrix, kept: IntArray, *, many_loads: bool = False) -> None:
        self._count, self._kept = matrix.shape[0], kept
        inner = matrix.T[kept].tocsc()[:, kept]
        self._solve = _cholmod(inner) if cholmod_is_there() and not many_loads else _superlu(inner)

    def solve(self, right: FloatArray | sp.spmatrix) -> FloatArray:
        """Return the displacements under forces, zero at held unknowns, shape (unknowns, k)."""
        forces = right if isinstance(right, np.ndarray) else right.toarray()
        found = np.zeros((self._count, forces.shape[1]))
        found[self._kept] = self._solve(forces[self._kept])
        return found


def cholmod_is_there() -> bool:
    """Whether cvxopt, which holds CHOLMOD, is installed."""
    return find_spec("cvxopt") is not None


def _superlu(inner: sp.csc_matrix) -> Callable[[FloatArray], FloatArray]:
    # Nothing pivots: the matrix is positive definite.
    factor = factor_sparse(inner, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=SYMMETRIC)

    def solve(right: FloatArray) -> FloatArray:
        found = np.empty_like(right)
        for first in range(0, right.shape[1], BLOCK):
            own = slice(first, first + BLOCK)
            found[:, own] = factor.solve(np.ascontiguousarray(right[:, own]))
        return found

    return solve


def _cholmod(inner: sp.csc_matrix) -> Callable[[FloatArray], FloatArray]:
    import cvxopt
    import cvxopt.cholmod

    lower = sp.tril(inner, format="coo")
    matrix = cvxopt.spmatrix(
        cvxopt.matrix(lower.data), cvxopt.matrix(lower.row.astype(np.int64)), cvxopt.matrix(lower.col.astype(np.int64))
    )
    del lower
    order = cvxopt.matrix(np.arange(inner.shape[0], dtype=np.int64))
    cvxopt.cholmod.options["supernodal"] = 2
    with enough_memory(inner.shape[0]):
        factor = cvxopt.cholmod.symbolic(matrix, p=order)
        cvxopt.cholmod.numeric(matrix, factor)
    del matrix

    def solve(right: FloatArray) -> FloatArray:
        values = cvxopt.matrix(np.asfortranarray(right))
        cvxopt.cholmod.solve(factor, values)
        return np.array(values)

    return solve
