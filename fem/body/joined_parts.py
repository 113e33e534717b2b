r"""A body of several parts of which there are copies: each part is condensed once to the nodes that it shares.

With the unknowns of a part divided into inner ones (i) and shared ones (s), and loads B,

.. math:: S = K_{ss} - K_{si} K_{ii}^{-1} K_{is}, \qquad g = B_s - K_{si} K_{ii}^{-1} B_i, \qquad
    C = B_i^T K_{ii}^{-1} B_i

are what its copies add to the stiffness of the whole, to the loads on its nodes and to the displacement that the loads of one
copy measure under one another. All three are blocks of one product, :math:`(K_{is}, B_i)^T K_{ii}^{-1} (K_{is}, B_i)`. A copy
that is turned has all vectors turned with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from fem.body.condensation import node_graph, order_graph
from fem.body.elasticity import first_order_space, unknowns_of_nodes
from fem.body.influence import carried_down, factor_below, sum_products
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A part with its loads.

    Attributes
    ----------
    stiffness : csc_matrix, shape (unknowns, unknowns)
        N/mm.
    places : array of complex, shape (nodes,)
        Of the first copy, mm.
    loads : csc_matrix, shape (unknowns, m)
        Nodal forces of each unit load on the first copy.
    shared : array of int
        Nodes that it shares with other parts or copies.
    turns, shifts : array of complex, shape (copies,)
        Rotation about the origin from the first copy to each, as a factor, then shift, mm.
    numbers : array of int, shape (copies, m)
        Numbers of the loads of each copy among all loads, -1 where it is without one.
    """

    stiffness: sp.csc_matrix
    places: ComplexArray
    loads: sp.csc_matrix
    shared: IntArray
    turns: ComplexArray
    shifts: ComplexArray
    numbers: IntArray


def of_first_order(part: Part, mesh: BodyMesh) -> Part:
    """Return a part as linear elements make it of its quadratic mesh (`fem.body.elasticity.first_order_space`)."""
    space, vertices = first_order_space(mesh), mesh.mesh.nvertices
    return replace(
        part,
        stiffness=sp.csc_matrix(space.T @ part.stiffness @ space),
        places=part.places[:vertices],
        loads=sp.csc_matrix(space.T @ part.loads),
        shared=part.shared[part.shared < vertices],
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedBody:
    """The parts as one body on the nodes that are left.

    Attributes
    ----------
    places : array of complex, shape (nodes,)
        Those of the core first, in its order, mm.
    stiffness : csc_matrix, shape (2 nodes, 2 nodes)
        N/mm.
    loads : csc_matrix, shape (2 nodes, m)
        All loads.
    held : csc_matrix, shape (m, m)
        Displacement that loads measure under one another while all these nodes are held, mm.
    unknowns : int
        Of the body before anything was condensed.
    """

    places: ComplexArray
    stiffness: sp.csc_matrix
    loads: sp.csc_matrix
    held: sp.csc_matrix
    unknowns: int


def join_parts(core: Part, parts: Sequence[Part], apart: float) -> JoinedBody:
    """Join a core, of which there is one copy and which shares all nodes, with copies of parts; nodes within `apart` are one."""
    count = 1 + max(int(part.numbers.max()) for part in (core, *parts))
    placed = [
        turn * part.places[part.shared] + shift
        for part in parts
        for turn, shift in zip(part.turns, part.shifts, strict=True)
    ]
    places, nodes = _merge([core.places, *placed], apart)
    stiffness, loads, held = _Sum(), _Sum(), _Sum()
    own = unknowns_of_nodes(nodes[0])
    stiffness.add(core.stiffness, own, own)
    loads.add(core.loads, own, core.numbers[0])
    following, unknowns = iter(nodes[1:]), 2 * len(places)
    for part in parts:
        condensed = _condense(part)
        for turn, every in zip(part.turns, part.numbers, strict=True):
            (wanted,) = np.nonzero(every >= 0)
            numbers = every[wanted]
            own = unknowns_of_nodes(next(following))
            stiffness.add(_turned(_turned(condensed.stiffness, turn).T, turn), own, own)
            loads.add(_turned(condensed.loads[:, wanted], turn), own, numbers)
            held.add(condensed.held[np.ix_(wanted, wanted)], numbers, numbers)
        unknowns += len(part.turns) * 2 * (len(part.places) - len(part.shared))
    return JoinedBody(
        places=places,
        stiffness=stiffness.matrix(2 * len(places), 2 * len(places)),
        loads=loads.matrix(2 * len(places), count),
        held=held.matrix(count, count),
        unknowns=unknowns,
    )


def motions_of_copy(turn: complex, shift: complex) -> FloatArray:
    """Return the rigid motions of the whole (columns x, y, rotation) in those of a copy that is turned, then shifted.

    A load in the form of the motions of the first copy, copied and taken in these amounts, is one in the form of the motions of
    the whole.
    """
    x, y, about = np.conj(turn) * np.array([1.0, 1j, 1j * shift])
    return np.array([[x.real, y.real, about.real], [x.imag, y.imag, about.imag], [0.0, 0.0, 1.0]])


class _Condensed(NamedTuple):
    """What a copy of a part adds to the whole."""

    stiffness: FloatArray
    loads: FloatArray
    held: FloatArray


def _condense(part: Part) -> _Condensed:
    """Condense a part to its shared nodes."""
    outer = unknowns_of_nodes(part.shared)
    within = np.ones(len(part.places), dtype=bool)
    within[part.shared] = False
    order = order_graph(node_graph(part.stiffness))
    inner = unknowns_of_nodes(order[within[order]])
    rows = part.stiffness[inner]
    acting = sp.hstack([rows[:, outer], part.loads[inner]], format="csc")
    carried = carried_down(factor_below(rows[:, inner].tocsc(), acting), len(inner))
    product, count = sum_products(carried, carried), len(outer)
    return _Condensed(
        stiffness=part.stiffness[outer][:, outer].toarray() - product[:count, :count],
        loads=part.loads[outer].toarray() - product[:count, count:],
        held=product[count:, count:],
    )


def _turned(vectors: FloatArray, turn: complex) -> FloatArray:
    """Return vectors at nodes, x and y by turns down each column, turned."""
    found = np.empty_like(vectors)
    found[0::2] = turn.real * vectors[0::2] - turn.imag * vectors[1::2]
    found[1::2] = turn.imag * vectors[0::2] + turn.real * vectors[1::2]
    return found


def _merge(groups: Sequence[ComplexArray], apart: float) -> tuple[ComplexArray, list[IntArray]]:
    """Return places without those that are there already, and the number of each place of each group."""
    every = np.concatenate(groups)
    tree = cKDTree(np.column_stack([every.real, every.imag]))
    pairs = tree.query_pairs(apart, output_type="ndarray")
    graph = sp.coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(every),) * 2)
    _, label = connected_components(graph, directed=False)
    # Labels count from the first place on, so that those of the first group keep their order.
    _, first = np.unique(label, return_index=True)
    ends = np.cumsum([len(group) for group in groups])
    return every[first], np.split(label.astype(np.int64), ends[:-1])


class _Sum:
    """Sum of blocks of a sparse matrix, each at its rows and columns."""

    def __init__(self) -> None:
        self._parts: list[tuple[FloatArray, IntArray, IntArray]] = []

    def add(self, block: sp.spmatrix | FloatArray, rows: IntArray, columns: IntArray) -> None:
        """Add a block."""
        entries = sp.coo_array(block)
        self._parts.append((entries.data, rows[entries.row], columns[entries.col]))

    def matrix(self, rows: int, columns: int) -> sp.csc_matrix:
        """Return the sum."""
        if not self._parts:
            return sp.csc_matrix((rows, columns))
        data, row, column = (np.concatenate(each) for each in zip(*self._parts, strict=True))
        return sp.csc_matrix((data, (row, column)), shape=(rows, columns))
