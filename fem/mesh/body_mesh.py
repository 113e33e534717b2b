"""The mesh of one body: curved triangles with named boundaries, as a value."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from skfem import MeshTri1, MeshTri2

from fem.errors import MeshError
from ltca.arrays import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyMesh:
    """Mesh of one body in the frame of the body.

    Nodes are compact (every node belongs to an element). For order 2 the vertices come first and the
    mid-side node of facet f is node ``mesh.nvertices + f``; its displacement components are the unknowns
    ``basis.facet_dofs[:, f]`` of an ``ElementVector(ElementTriP2())``.

    Attributes
    ----------
    name : str
        Name of the body.
    mesh : MeshTri2 or MeshTri1
        Counter-clockwise triangles with boundaries as facet index arrays; for order 2 isoparametric, the
        mid-side nodes of boundary facets on the exact curve.
    """

    name: str
    mesh: MeshTri1

    @property
    def order(self) -> int:
        """1 or 2."""
        return 2 if isinstance(self.mesh, MeshTri2) else 1

    @property
    def boundary_names(self) -> tuple[str, ...]:
        """Names of the boundaries."""
        return tuple(self.mesh.boundaries or ())

    @property
    def node_count(self) -> int:
        """Number of nodes, mid-side nodes included."""
        return int(self.mesh.doflocs.shape[1])

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns."""
        return 2 * self.node_count

    @property
    def places(self) -> ComplexArray:
        """Places of the nodes in the frame of the body, mm."""
        return np.asarray(self.mesh.doflocs[0] + 1j * self.mesh.doflocs[1])

    @property
    def element_nodes(self) -> IntArray:
        """Nodes of each element, shape (elements, 3 or 6): vertices, then mid-sides of (0,1), (1,2), (2,0)."""
        mesh = self.mesh
        nodes = np.vstack([mesh.t, mesh.nvertices + mesh.t2f]) if self.order == 2 else mesh.t
        return np.asarray(nodes, dtype=np.int64).T

    def boundary_nodes(self, name: str) -> IntArray:
        """Return the nodes of a closed boundary edge by edge, body on the left, shape (edges, 3), or (edges, 2) for order 1.

        First vertex, mid-side node and last vertex of each edge, from the rightmost vertex on (the same after a file); the
        last vertex of an edge is the first of the next one, cyclically. The outward normal points to the right of the
        direction of travel. MeshError when the mesh has no such boundary, or it is not one closed line.
        """
        facets = self.require_boundary(name)
        mesh = self.mesh
        elements = mesh.f2t[0, facets]
        # Local edge of each facet in its (counter-clockwise) triangle: body on the left from its first vertex.
        local = np.argmax(mesh.t2f[:, elements] == facets, axis=0)
        pairs = np.array([[0, 1, 0], [1, 2, 2]])
        first = mesh.t[pairs[0, local], elements].astype(np.int64)
        last = mesh.t[pairs[1, local], elements].astype(np.int64)
        clockwise = local == 2  # t2f row 2 is the edge (0, 2), travelled from 2 to 0
        first[clockwise], last[clockwise] = last[clockwise].copy(), first[clockwise].copy()
        starting_at = {int(vertex): edge for edge, vertex in enumerate(first)}
        # Start at a vertex that depends on the place only, so that the order survives a file.
        places = mesh.doflocs[:, first]
        edge = int(np.lexsort((places[1], -places[0]))[0])
        order = np.empty(len(facets), dtype=np.int64)
        for position in range(len(facets)):
            order[position] = edge
            following = starting_at.get(int(last[edge]))
            if following is None:
                raise MeshError(f"boundary {name!r} of {self.name} is not a closed line")
            edge = following
        if len(np.unique(order)) != len(facets):
            raise MeshError(f"boundary {name!r} of {self.name} is not one closed line")
        if self.order == 1:
            return np.column_stack([first, last])[order]
        return np.column_stack([first, mesh.nvertices + facets, last])[order]

    def require_boundary(self, name: str) -> IntArray:
        """Return the facets of a boundary as stored; MeshError when the mesh has no such boundary."""
        boundaries = self.mesh.boundaries or {}
        if name not in boundaries or len(boundaries[name]) == 0:
            known = ", ".join(boundaries) or "none"
            raise MeshError(f"mesh of {self.name} has no boundary {name!r}; its boundaries are: {known}")
        return np.asarray(boundaries[name], dtype=np.int64)

    def require_complete_boundaries(self) -> None:
        """Raise MeshError unless every outer facet belongs to exactly one named boundary."""
        count = np.zeros(self.mesh.nfacets, dtype=np.int64)
        for name in self.boundary_names:
            np.add.at(count, self.require_boundary(name), 1)
        outer = count[self.mesh.boundary_facets()]
        if np.any(outer != 1):
            raise MeshError(
                f"mesh of {self.name}: {int(np.sum(outer == 0))} outer edges belong to no named boundary and "
                f"{int(np.sum(outer > 1))} to several; its boundaries are: {', '.join(self.boundary_names) or 'none'}"
            )

    def turned(self, angle: float, name: str | None = None) -> BodyMesh:
        """Return the same mesh turned counter-clockwise about the origin by `angle`, rad, under a new name."""
        cosine, sine = np.cos(angle), np.sin(angle)
        rotation = np.array([[cosine, -sine], [sine, cosine]])
        return BodyMesh(
            name=self.name if name is None else name,
            mesh=move_nodes(self.mesh, np.ascontiguousarray(rotation @ self.mesh.doflocs)),
        )


def move_nodes(mesh: MeshTri1, places: FloatArray) -> MeshTri1:
    """Return a mesh with its nodes at other places, shape (2, nodes), mm."""
    return _share_connectivity(replace(mesh, doflocs=places), mesh)


def _share_connectivity(mesh: MeshTri1, known: MeshTri1) -> MeshTri1:
    """Give a mesh the facets that another one with the same triangles has found: scikit-fem sorts all edges for them."""
    for name in ("_facets", "_t2f", "_f2t"):
        if name in vars(known):
            setattr(mesh, name, getattr(known, name))
    return mesh


def triangle_mesh(
    vertices: FloatArray, triangles: IntArray, boundary_edges: dict[str, IntArray], *, order: int
) -> MeshTri1:
    """Return a straight-sided mesh with named boundaries; for order 2 the mid-side nodes lie at the middle of the edges.

    `vertices` has the shape (2, vertices), mm, `triangles` (3, triangles), counter-clockwise, and each of `boundary_edges`
    (edges, 2), pairs of vertices. Facets of a boundary are in the order of its edges.
    """
    if order not in (1, 2):
        raise MeshError(f"element order {order}: must be 1 or 2")
    linear = MeshTri1(vertices, triangles, sort_t=False, validate=False)
    boundaries = {name: facets_of_edges(linear, edges, name) for name, edges in boundary_edges.items()}
    if order == 1:
        return _share_connectivity(linear.with_boundaries(boundaries), linear)
    middles = 0.5 * (linear.p[:, linear.facets[0]] + linear.p[:, linear.facets[1]])
    doflocs = np.hstack([linear.p, middles])
    curved = MeshTri2(doflocs, linear.t, sort_t=False, validate=False).with_boundaries(boundaries)
    return _share_connectivity(curved, linear)


def facets_of_edges(mesh: MeshTri1, edges: IntArray, name: str) -> IntArray:
    """Return the facet index of each vertex pair; MeshError when a pair is no edge of the mesh, or an edge inside it."""
    stride = np.int64(mesh.nvertices)
    facets = np.sort(mesh.facets.astype(np.int64), axis=0)
    keys = facets[0] * stride + facets[1]
    sorter = np.argsort(keys)
    wanted = np.sort(np.asarray(edges, dtype=np.int64).reshape(-1, 2), axis=1)
    wanted_keys = wanted[:, 0] * stride + wanted[:, 1]
    place = np.minimum(np.searchsorted(keys, wanted_keys, sorter=sorter), len(keys) - 1)
    found = sorter[place]
    if np.any(keys[found] != wanted_keys):
        raise MeshError(f"boundary {name!r} has edges that belong to no triangle")
    if np.any(mesh.f2t[1, found] != -1):
        raise MeshError(f"boundary {name!r} has edges that lie between two triangles")
    return np.asarray(found, dtype=np.int64)
