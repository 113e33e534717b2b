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

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from fem.body.condensation import SYMMETRIC, node_graph, order_graph, statically_determinate
from fem.body.elasticity import modes_at, unknowns_of_nodes
from fem.body.sparse_factor import factor_sparse
from ltca.arrays import ComplexArray, FloatArray, IntArray

# Columns of Z that are made dense together. With fewer the overhead of each panel counts, with more the zeros: 64 to
# 128 take the least time on discs of 26 to 90 teeth.
PANEL = 96
# Right-hand sides that are solved for together: of 18 four at a time take half of the time of all at once (SuperLU).
TOGETHER = 4


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
    _beyond: sp.csr_matrix

    def block(self, measuring: slice | IntArray, loading: slice, datum: int = 0) -> FloatArray:
        """Return the displacements that some loads measure under a unit of others, both balanced by a datum.

        The shape is (measuring, loading); symmetric to the last bit where both slices are the same.
        """
        rows = self._carried[measuring]
        same = isinstance(measuring, slice) and measuring == loading
        found = sum_products(rows, rows if same else self._carried[loading])
        self._add_beyond(found, measuring, loading)
        return self._refer(found, measuring, loading, self.datums[datum])

    def in_every_datum(self, loads: slice) -> tuple[FloatArray, ...]:
        """Return the displacements that some loads measure under one another, by datum; the product is computed once."""
        rows = self._carried[loads]
        held = sum_products(rows, rows)
        self._add_beyond(held, loads, loads)
        return tuple(self._refer(held.copy(), loads, loads, datum) for datum in self.datums)

    def own(self, loads: slice, datum: int = 0) -> FloatArray:
        """Return the displacement that each load measures under itself, shape (loads,)."""
        rows, by = self._carried[loads], self.datums[datum]
        held = np.asarray(rows.power(2).sum(axis=1)).ravel() + self._beyond.diagonal()[loads]
        motion, measured = by.motion[:, loads], by.measured[loads]
        crossed = np.einsum("ij,ji->i", measured, motion)
        return np.asarray(held - 2.0 * crossed + np.einsum("ai,ab,bi->i", motion, by.own, motion))

    def _add_beyond(self, held: FloatArray, measuring: slice | IntArray, loading: slice) -> None:
        entries = self._beyond[measuring, loading].tocoo()
        held[entries.row, entries.col] += entries.data

    @staticmethod
    def _refer(held: FloatArray, measuring: slice | IntArray, loading: slice, datum: Datum) -> FloatArray:
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
    places: ComplexArray,
    stiffness: sp.csc_matrix,
    loads: sp.spmatrix,
    datums: Sequence[sp.csc_matrix],
    sampled: IntArray,
    *,
    order: IntArray | None = None,
    beyond: sp.csc_matrix | None = None,
) -> LoadInfluence:
    """Factorise a free body with many loads behind it; the factor of the stiffness is not kept.

    `loads` are nodal forces, shape (unknowns, m), `places` those of the nodes, mm. Each datum is three sets of amounts of the
    loads, shape (m, 3), whose Gram matrix with the rigid modes is regular. Under the `sampled` loads the displacement is solved
    for. `order` of elimination of the nodes; `beyond`, shape (m, m), is what loads measure under one another while all nodes are
    held (`fem.body.joined_parts`).
    """
    loads = sp.csc_matrix(loads)
    beyond = sp.csr_matrix(loads.shape[1:] * 2) if beyond is None else sp.csr_matrix(beyond)
    # Datums may load every node; balanced loads do not feel where the body is held.
    single = np.setdiff1d(np.arange(loads.shape[1]), np.concatenate([sp.csc_matrix(each).indices for each in datums]))
    held = np.zeros(loads.shape[0], dtype=bool)
    held[statically_determinate(np.column_stack([places.real, places.imag]), loads[:, single])] = True
    unknowns = unknowns_of_nodes(order_graph(node_graph(stiffness)) if order is None else order)
    kept = unknowns[~held[unknowns]]
    # The columns of a symmetric matrix are its rows: no conversion is needed to pick them.
    factor = factor_below(stiffness.T[kept].tocsc()[:, kept], loads.tocsr()[kept])
    modes = modes_at(places)
    resultants = np.asarray(modes.T @ loads)
    amounts = sp.hstack([*datums, sp.eye_array(loads.shape[1], format="csc")[:, sampled]], format="csc")
    measured = loads.T @ _displacement(factor, kept, (loads @ amounts).toarray()) + (beyond @ amounts).toarray()
    of_shapes = []
    for number, each in enumerate(datums):
        by = measured[:, 3 * number : 3 * number + 3]
        balance, own = np.linalg.solve(modes.T @ (loads @ each), resultants), each.T @ by
        of_shapes.append(Datum(motion=balance, measured=by, own=0.5 * (own + own.T)))
    # Both the loads that act and those that measure are balanced by the first datum.
    balance = of_shapes[0].motion
    seen = measured[:, 3 * len(datums) :] - measured[:, :3] @ balance[:, sampled]
    seen -= balance.T @ (datums[0].T @ seen)
    return LoadInfluence(
        resultants=resultants,
        datums=tuple(of_shapes),
        sampled=seen,
        _carried=carried_down(factor, len(kept)),
        _beyond=beyond,
    )


def factor_below(inner: sp.csc_matrix, loads: sp.spmatrix) -> spla.SuperLU:
    """Return the factors of a positive definite matrix with loads, shape (unknowns, m), as rows below it."""
    # Nothing pivots: what is beside the loads is one.
    return factor_sparse(
        _bordered_below(inner, sp.csr_matrix(loads)), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=SYMMETRIC
    )


def carried_down(factor: spla.SuperLU, count: int) -> sp.csc_matrix:
    """Return Z D^½: what is carried down to the loads below so many unknowns, shape (m, unknowns)."""
    # Both factors are made at once.
    lower, diagonal = factor.L, factor.U.diagonal()[:count]
    carried = lower[count:, :count]
    carried.data *= np.sqrt(np.repeat(diagonal, np.diff(carried.indptr)))
    return carried


def _displacement(factor: spla.SuperLU, kept: IntArray, force: FloatArray) -> FloatArray:
    """Return the displacement under forces, three unknowns held; shapes (unknowns, k)."""
    found = np.zeros_like(force)
    for first in range(0, force.shape[1], TOGETHER):
        few = slice(first, first + TOGETHER)
        right = np.zeros((factor.shape[0], force[:, few].shape[1]))
        right[: len(kept)] = force[kept, few]
        found[kept, few] = factor.solve(right)[: len(kept)]
    return found


def _bordered_below(inner: sp.csc_matrix, border: sp.csr_matrix) -> sp.csc_matrix:
    """Return a matrix with loads as rows below it and ones on the diagonal beside those."""
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
