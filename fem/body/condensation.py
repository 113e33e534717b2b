r"""Condensation of a body to its loads: one sparse factorisation gives the compliance of all of them.

With stiffness K and m load shapes B (forces for a unit of each contact unknown) the contact needs only
:math:`S = B^T K^{-1} B`. A solve for each column of B costs far more than the factorisation itself; instead
the loads are put behind the stiffness,

.. math:: \begin{pmatrix} K & B \\ B^T & 0 \end{pmatrix} = L U, \qquad L_{BB} U_{BB} = -B^T K^{-1} B,

and S is read from the trailing block of the factors. A contact zone is local, so its columns fill only the
path of its nodes to the root of the elimination tree. Nothing pivots: K is positive definite and the Schur
complement negative definite.

A free body is fixed at three unknowns that just hold it and its loads are balanced by body forces spread
over the area, so that the fixed unknowns carry nothing; its displacement is reported with the area mean of
its rigid motion removed, which does not depend on the choice of those unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from scipy.spatial import cKDTree

from fem.body.elasticity import area_loads, rigid_modes
from fem.body.sparse_factor import factor_sparse
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray, IntArray

SYMMETRIC = {"SymmetricMode": True, "Equil": False}
# Any diagonal above the sum of a row keeps the proxy of the node graph positive definite.
PROXY_DIAGONAL = 200.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CondensedBody:
    """A body reduced to its unit loads: compliance between them and nodal displacements under them.

    The one thing that changes is a memory of the last displacement, which several results of one solution ask for.

    Attributes
    ----------
    compliance : array, shape (m, m)
        Displacement measured by load shape i for a unit of load shape j, symmetric, positive semidefinite; of
        a free body with area-mean rigid motion removed and loads balanced by body forces.
    loads : csc_matrix, shape (unknowns, m)
        Nodal forces of each unit load, N.
    resultants : array, shape (3, m)
        Force in x, in y (N) and moment (N·mm) about the centre of each unit load.
    """

    compliance: FloatArray
    loads: sp.csc_matrix
    resultants: FloatArray
    _factor: BorderedFactor
    _kept: IntArray
    _modes: FloatArray | None
    _area: FloatArray | None
    _trailing: FloatArray
    _last: dict[bytes, FloatArray] = field(default_factory=dict, repr=False, compare=False)

    @property
    def entries(self) -> int:
        """Number of stored values, most of them those of the factor."""
        return int(self._factor.lower.nnz) + self.compliance.size + self._trailing.size

    def displacement(self, amounts: FloatArray) -> FloatArray:
        """Return the nodal displacement under amounts of the unit loads, mm.

        That of a free body is relative to its area-mean rigid motion. Amounts have the shape (m,), or (m, k) for k load
        cases; the displacement (unknowns,) or (unknowns, k), read-only.
        """
        amounts = np.asarray(amounts, dtype=float)
        if amounts.ndim == 1:
            asked = amounts.tobytes()
            if asked not in self._last:
                self._last.clear()
                self._last[asked] = self._displacements(amounts[:, None])[:, 0]
                self._last[asked].flags.writeable = False
            return self._last[asked]
        return self._displacements(amounts)

    def _displacements(self, columns: FloatArray) -> FloatArray:
        force = self.loads @ columns
        full = columns
        if self._modes is not None and self._area is not None:
            balance = _balance(self._modes, self._area, self._modes.T @ force)
            force = force - self._area @ balance
            full = np.vstack([columns, -balance])
        # The loads' own displacement as right-hand side makes the multipliers vanish: what is left is K⁻¹ f.
        right = np.vstack([force[self._kept], self._trailing @ full])
        found = self._factor.solve(right)[: len(self._kept)]
        result = np.zeros((self.loads.shape[0], columns.shape[1]))
        result[self._kept] = found
        if self._modes is not None and self._area is not None:
            result -= self._modes @ _balance(self._modes, self._area, self._area.T @ result)
        return result


def _balance(modes: FloatArray, area: FloatArray, resultant: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.solve(modes.T @ area, resultant))


def order_nodes(body: BodyMesh) -> IntArray:
    """Return an elimination order of the nodes that keeps the factor sparse.

    Only the vertices are ordered, a quarter of the nodes; each mid-side node stands just before the first of its edge's ends,
    which fills less than an order of all nodes. Vertices by nested dissection (METIS) where the extra ``fast`` is installed
    and copes with the mesh, else by minimum degree, which SuperLU finds while it factorises a scalar matrix of their graph.
    """
    mesh = body.mesh
    place = order_vertices(mesh.t, mesh.nvertices)
    if body.order == 2:
        place = np.concatenate([place, place[mesh.facets].min(axis=0) - 0.5])
    return np.argsort(place, kind="stable").astype(np.int64)


def order_vertices(corners: IntArray, count: int) -> FloatArray:
    """Return the place of each of `count` vertices in an elimination order; `corners` of the elements, (corners, elements)."""
    return _order_graph(_graph(corners, count))


def order_graph(graph: sp.csc_matrix) -> IntArray:
    """Return an elimination order of the nodes of a graph, a symmetric matrix with its diagonal."""
    return np.argsort(_order_graph(graph), kind="stable").astype(np.int64)


def node_graph(stiffness: sp.csc_matrix) -> sp.csc_matrix:
    """Return which nodes a stiffness matrix joins."""
    graph = sp.csc_matrix(stiffness[::2, ::2])
    graph.data = np.ones_like(graph.data)
    return graph


def _order_graph(graph: sp.csc_matrix) -> FloatArray:
    """Return the place of each node of a graph in an elimination order."""
    try:
        return _nested_dissection(graph)
    except (ImportError, RuntimeError):
        # METIS not there, or out of its depth (its C++ exceptions arrive as RuntimeError: "unknown exception").
        return _minimum_degree(graph)


def _nested_dissection(graph: sp.csc_matrix) -> FloatArray:
    """Return the place of each vertex in a nested dissection of their graph."""
    import pymetis

    graph = graph.copy()
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    _, place = pymetis.nested_dissection(pymetis.CSRAdjacency(graph.indptr, graph.indices))
    return np.asarray(place, dtype=np.float64)


def _minimum_degree(graph: sp.csc_matrix) -> FloatArray:
    """Return the place of each vertex in a minimum-degree order of their graph."""
    graph = graph.copy()
    graph.data[:] = -1.0
    graph.setdiag(PROXY_DIAGONAL)
    factor = factor_sparse(graph, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=SYMMETRIC)
    return np.asarray(factor.perm_c, dtype=np.float64)


def _graph(corners: IntArray, count: int) -> sp.csc_matrix:
    """Return which vertices share an element."""
    corners = corners.astype(np.int32)
    rows = np.repeat(corners, len(corners), axis=0).ravel()
    columns = np.tile(corners, (len(corners), 1)).ravel()
    return sp.csc_matrix((np.ones(rows.size), (rows, columns)), shape=(count, count))


def statically_determinate(places: FloatArray, loads: sp.csc_matrix) -> IntArray:
    """Return three unknowns that hold a free body without straining it, at nodes far from the loads; shape (nodes, 2)."""
    first, second, _ = unloaded_nodes(places, loads)
    direction = places[second] - places[first]
    across = 1 if abs(direction[0]) >= abs(direction[1]) else 0
    return np.array([2 * first, 2 * first + 1, 2 * second + across])


def unloaded_nodes(places: FloatArray, loads: sp.spmatrix) -> tuple[int, int, int]:
    """Return three nodes of a section far from its loads, from one another and from one line; a load on a held one would vanish.

    `places` have the shape (nodes, 2), loads (2 nodes, n).
    """
    loaded = np.unique(sp.coo_matrix(loads).row // 2)
    away = cKDTree(places[loaded]).query(places)[0] if loaded.size else np.ones(len(places))
    first = int(np.argmax(away))
    span = places - places[first]
    second = int(np.argmax(np.minimum(np.hypot(*span.T), away) * (away > 0.0)))
    height = np.abs(span[second, 0] * span[:, 1] - span[second, 1] * span[:, 0])
    return first, second, int(np.argmax(height * (away > 0.0)))


def condense_body(
    body: BodyMesh,
    stiffness: sp.csc_matrix,
    loads: sp.spmatrix,
    *,
    fixed: IntArray | None = None,
    centre: complex = 0j,
) -> CondensedBody:
    """Factorise a body and condense it to its load shapes.

    Parameters
    ----------
    body : BodyMesh
        The mesh.
    stiffness : csc_matrix, shape (unknowns, unknowns)
        From `fem.body.elasticity.assemble_stiffness`.
    loads : sparse matrix, shape (unknowns, m)
        Nodal forces of each unit load; linearly independent columns, none of them zero.
    fixed : array of int, optional
        Unknowns held at zero; without them the body is free and its loads are balanced by body forces.
    centre : complex
        Centre for moments and the rotation of a free body, mm.

    Returns
    -------
    CondensedBody
        Compliance and factor.
    """
    loads = sp.csc_matrix(loads)
    count, number = loads.shape
    order = order_nodes(body)
    free = fixed is None
    modes = rigid_modes(body, centre)
    area = area_loads(body, centre) if free else None
    held = np.zeros(count, dtype=bool)
    held[statically_determinate(body.mesh.doflocs.T, loads) if fixed is None else fixed] = True
    unknowns = (2 * order[:, None] + np.arange(2)).reshape(-1)
    kept = unknowns[~held[unknowns]]
    trailing = loads if area is None else sp.hstack([loads, sp.csc_matrix(area)], format="csc")
    schur, factor = _factorise(stiffness, trailing, kept)
    resultants = np.asarray(modes.T @ loads)
    compliance = schur
    if area is not None:
        balance = _balance(modes, area, resultants)
        transform = np.vstack([np.eye(number), -balance])
        compliance = transform.T @ schur @ transform
    return CondensedBody(
        compliance=0.5 * (compliance + compliance.T),
        loads=loads,
        resultants=resultants,
        _factor=factor,
        _kept=kept,
        _modes=modes if free else None,
        _area=area,
        _trailing=schur,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class BorderedFactor:
    """Factors L D Lᵀ of a bordered matrix.

    Attributes
    ----------
    lower : csc_matrix
        L, unit lower triangular.
    diagonal : array
        D.
    """

    lower: sp.csc_matrix
    diagonal: FloatArray

    def solve(self, right: FloatArray) -> FloatArray:
        """Return the solution of L D Lᵀ x = right, shape as right."""
        # What overwriting means here: ones on the diagonal are set to one. A copy would cost ten times the solve.
        forward = spla.spsolve_triangular(self.lower, right, lower=True, unit_diagonal=True, overwrite_A=True)
        scaled = forward / self.diagonal[:, None]
        return np.asarray(
            spla.spsolve_triangular(self.lower.T, scaled, lower=False, unit_diagonal=True, overwrite_A=True)
        )


def _factorise(stiffness: sp.csc_matrix, loads: sp.csc_matrix, kept: IntArray) -> tuple[FloatArray, BorderedFactor]:
    """Return Bᵀ K⁻¹ B over the kept unknowns and the factor of the bordered matrix."""
    # The columns of a symmetric matrix are its rows: no conversion is needed to pick them.
    inner = stiffness.T[kept].tocsc()[:, kept]
    border = loads.tocsr()[kept]
    count = len(kept)
    matrix = sp.vstack([sp.hstack([inner, border]), sp.hstack([border.T, sp.csr_matrix((loads.shape[1],) * 2)])])
    factor = factor_sparse(matrix.tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=SYMMETRIC)
    # SuperLU's object would keep three copies of the factors alive; L and the diagonal of U are enough.
    lower, diagonal = factor.L, factor.U.diagonal()
    trailing = lower[count:, count:].toarray()
    schur = -(trailing * diagonal[count:]) @ trailing.T
    return schur, BorderedFactor(lower=lower, diagonal=diagonal)
