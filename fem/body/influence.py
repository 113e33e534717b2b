r"""Influence between very many loads of a free body: only the requested blocks, without a dense factor.

Behind the stiffness as in `fem.body.condensation`, m loads end in a dense trailing matrix of m columns: with several
thousand of them its factorisation is nearly all the work, and most of its blocks are not needed. Here the loads border the
stiffness below only,

.. math:: \begin{pmatrix} K & 0 \\ B^T & 1 \end{pmatrix} = \begin{pmatrix} L & 0 \\ Z & 1 \end{pmatrix}
    \begin{pmatrix} D L^T & 0 \\ 0 & 1 \end{pmatrix}, \qquad B^T K^{-1} B = Z D Z^T.

Nothing fills the trailing block. Z is sparse: a load fills the path of its nodes to the root of the elimination tree, which
is long for the last separators only. A block of the product is summed over panels of columns of Z, each made dense in
the rows that it has.

Loads are balanced by forces of given shapes W (three of them, or three for each datum): with resultants R and the Gram
matrix G of the shapes with the rigid modes, each load is :math:`b - W G^{-1} R b`. The displacement measured by a load so
balanced is that relative to the rigid motion that W measures (`fem.body.free_body`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from fem.body.condensation import SYMMETRIC, order_nodes, statically_determinate
from fem.body.elasticity import rigid_modes, unknowns_of_nodes
from fem.body.sparse_factor import factor_sparse
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray, IntArray

# Columns of Z that are made dense together. With fewer the overhead of each panel counts, with more the zeros: 64 to
# 128 take the least time on discs of 26 to 90 teeth.
PANEL = 96


@dataclass(frozen=True, slots=True, kw_only=True)
class Datum:
    """Force shapes that balance loads and measure rigid motions.

    Attributes
    ----------
    motion : array, shape (3, m)
        Amounts of the shapes that have the resultant of each load.
    measured : array, shape (m, 3)
        Displacement measured by each load for a unit of each shape, held.
    own : array, shape (3, 3)
        Displacement measured by the shapes under themselves.
    """

    motion: FloatArray
    measured: FloatArray
    own: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadInfluence:
    """Displacements measured by the loads of a free body under one another.

    Attributes
    ----------
    resultants : array, shape (3, m)
        Force in x, in y (N) and moment (N·mm) about the origin of each unit load.
    datums : tuple of Datum
        In the order in which they were given.
    sampled : array, shape (m, k)
        Displacement measured by each load under the sampled loads, solved for; both balanced by the first datum.
    """

    resultants: FloatArray
    datums: tuple[Datum, ...]
    sampled: FloatArray
    _carried: sp.csc_matrix

    def block(self, measuring: slice, loading: slice, datum: int = 0) -> FloatArray:
        """Return the displacements that some loads measure under a unit of others, both balanced by a datum.

        The shape is (measuring, loading); symmetric to the last bit where both slices are the same.
        """
        rows = self._carried[measuring]
        found = sum_products(rows, rows if measuring == loading else self._carried[loading])
        return self._refer(found, measuring, loading, self.datums[datum])

    def in_every_datum(self, loads: slice) -> tuple[FloatArray, ...]:
        """Return the displacements that some loads measure under one another, by datum; the product is computed once."""
        rows = self._carried[loads]
        held = sum_products(rows, rows)
        return tuple(self._refer(held.copy(), loads, loads, datum) for datum in self.datums)

    def own(self, loads: slice, datum: int = 0) -> FloatArray:
        """Return the displacement that each load measures under itself, shape (loads,)."""
        rows, by = self._carried[loads], self.datums[datum]
        held = np.asarray(rows.power(2).sum(axis=1)).ravel()
        motion, measured = by.motion[:, loads], by.measured[loads]
        crossed = np.einsum("ij,ji->i", measured, motion)
        return np.asarray(held - 2.0 * crossed + np.einsum("ai,ab,bi->i", motion, by.own, motion))

    @staticmethod
    def _refer(held: FloatArray, measuring: slice, loading: slice, datum: Datum) -> FloatArray:
        left, right = datum.motion[:, measuring], datum.motion[:, loading]
        # One product of rank six, so that both halves of a symmetric block stay equal.
        seen = datum.measured[measuring] - 0.5 * left.T @ datum.own
        acting = datum.measured[loading] - 0.5 * right.T @ datum.own
        correction = seen @ right
        correction += (acting @ left).T
        held -= correction
        return held


def sum_products(rows: sp.csc_matrix, columns: sp.csc_matrix) -> FloatArray:
    """Return rows · columnsᵀ of sparse factors with few long columns, shapes (p, n) and (q, n), as a dense matrix.

    The product is symmetric to the last bit when both are the same object.
    """
    total = np.zeros((rows.shape[0], columns.shape[0]))
    same = rows is columns
    used = np.flatnonzero((np.diff(rows.indptr) > 0) & (np.diff(columns.indptr) > 0))
    for first in range(0, len(used), PANEL):
        panel = used[first : first + PANEL]
        places, left = _dense_panel(rows, panel)
        if same:
            total[np.ix_(places, places)] += left @ left.T
        else:
            others, right = _dense_panel(columns, panel)
            total[np.ix_(places, others)] += left @ right.T
    return total


def _dense_panel(matrix: sp.csc_matrix, panel: IntArray) -> tuple[IntArray, FloatArray]:
    """Return the rows that some columns have, and the columns in those rows, shapes (r,) and (r, columns)."""
    starts, ends = matrix.indptr[panel], matrix.indptr[panel + 1]
    lengths = ends - starts
    if panel[-1] - panel[0] + 1 == len(panel):
        chosen: IntArray | slice = slice(int(starts[0]), int(ends[-1]))
    else:
        shift = np.repeat(starts - np.concatenate([[0], np.cumsum(lengths)[:-1]]), lengths)
        chosen = shift + np.arange(int(lengths.sum()))
    row = matrix.indices[chosen]
    number = np.zeros(matrix.shape[0], dtype=np.int64)
    number[row] = 1
    places = np.flatnonzero(number)
    number[places] = np.arange(len(places))
    dense = np.zeros((len(places), len(panel)))
    dense[number[row], np.repeat(np.arange(len(panel)), lengths)] = matrix.data[chosen]
    return places, dense


def influence_of_loads(
    body: BodyMesh,
    stiffness: sp.csc_matrix,
    loads: sp.spmatrix,
    datums: list[FloatArray],
    sampled: IntArray,
) -> LoadInfluence:
    """Factorise a free body with many loads behind it; the factor of the stiffness is not kept.

    `loads` are nodal forces, shape (unknowns, m). Each datum is three force shapes, shape (unknowns, 3), whose Gram matrix
    with the rigid modes is regular. Under the `sampled` loads the displacement is solved for.
    """
    loads = sp.csc_matrix(loads)
    factor, kept = _factorise(body, stiffness, loads)
    modes = rigid_modes(body)
    resultants = np.asarray(modes.T @ loads)
    of_shapes = []
    for shapes in datums:
        moved = _displacement(factor, kept, shapes)
        own = np.asarray(shapes.T @ moved)
        balance = np.linalg.solve(modes.T @ shapes, resultants)
        of_shapes.append(Datum(motion=balance, measured=np.asarray(loads.T @ moved), own=0.5 * (own + own.T)))
    shapes, balance = datums[0], of_shapes[0].motion
    moved = _displacement(factor, kept, loads[:, sampled].toarray() - shapes @ balance[:, sampled])
    measured = np.asarray(loads.T @ moved) - balance.T @ (shapes.T @ moved)
    # Both factors are made at once; what is carried down to the loads is the part below the stiffness.
    lower, diagonal = factor.L, factor.U.diagonal()[: len(kept)]
    del factor
    carried = lower[len(kept) :, : len(kept)]
    carried.data *= np.sqrt(np.repeat(diagonal, np.diff(carried.indptr)))
    return LoadInfluence(resultants=resultants, datums=tuple(of_shapes), sampled=measured, _carried=carried)


def _factorise(body: BodyMesh, stiffness: sp.csc_matrix, loads: sp.csc_matrix) -> tuple[spla.SuperLU, IntArray]:
    """Return the factors of the stiffness with the loads below it, and the unknowns in their order, three of them held."""
    held = np.zeros(loads.shape[0], dtype=bool)
    held[statically_determinate(body, loads)] = True
    unknowns = unknowns_of_nodes(order_nodes(body))
    kept = unknowns[~held[unknowns]]
    matrix = _bordered_below(stiffness, loads, kept)
    # Nothing pivots: the stiffness is positive definite, what is beside the loads is one.
    return factor_sparse(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=SYMMETRIC), kept


def _displacement(factor: spla.SuperLU, kept: IntArray, force: FloatArray) -> FloatArray:
    """Return the displacement under forces, three unknowns held; shapes (unknowns, k)."""
    right = np.zeros((factor.shape[0], force.shape[1]))
    right[: len(kept)] = force[kept]
    found = np.zeros_like(force)
    found[kept] = factor.solve(right)[: len(kept)]
    return found


def _bordered_below(stiffness: sp.csc_matrix, loads: sp.csc_matrix, kept: IntArray) -> sp.csc_matrix:
    """Return the kept part of the stiffness with the loads as rows below it and ones on the diagonal beside those."""
    # The columns of a symmetric matrix are its rows: no conversion is needed to pick them.
    inner = stiffness.T[kept].tocsc()[:, kept]
    border = loads.tocsr()[kept]
    count, number = border.shape
    starts = inner.indptr + border.indptr
    indices = np.empty(int(starts[-1]) + number, dtype=np.int32)
    data = np.empty(len(indices))
    upper = np.arange(inner.nnz) + np.repeat(border.indptr[:-1], np.diff(inner.indptr))
    indices[upper], data[upper] = inner.indices, inner.data
    del upper
    below = np.arange(border.nnz) + np.repeat(inner.indptr[1:], np.diff(border.indptr))
    indices[below], data[below] = count + border.indices, border.data
    indices[int(starts[-1]) :], data[int(starts[-1]) :] = count + np.arange(number), 1.0
    starts = np.concatenate([starts, starts[-1] + 1 + np.arange(number)])
    return sp.csc_matrix((data, indices, starts), shape=(count + number,) * 2)
