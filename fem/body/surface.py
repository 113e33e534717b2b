"""Contact zones on meshed boundaries: the side that carries the pressure and the side opposite.

Points are complex numbers in mm in the frame of the body. A zone is a run of boundary edges with the body on
the left; a place on it is one number s, edge index plus the reference coordinate in [0, 1] along the edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from fem.body.elasticity import unknowns_of_nodes
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve
from ltca.arrays import ComplexArray, FloatArray, IntArray

# Products of a quadratic and a linear shape function, a normal that turns by less than 0.1 rad along the edge and
# a square-root length element: five points integrate them to round-off.
GAUSS_POINTS, GAUSS_WEIGHTS = (
    0.5 * (np.polynomial.legendre.leggauss(5)[0] + 1.0),
    0.5 * np.polynomial.legendre.leggauss(5)[1],
)


def quadratic_shapes(xi: FloatArray) -> FloatArray:
    """Return the three quadratic shape functions of an edge (first, middle, last), shape (3, …)."""
    return np.stack([(1.0 - xi) * (1.0 - 2.0 * xi), 4.0 * xi * (1.0 - xi), xi * (2.0 * xi - 1.0)])


def quadratic_slopes(xi: FloatArray) -> FloatArray:
    """Return the derivatives of `quadratic_shapes`, shape (3, …)."""
    return np.stack([4.0 * xi - 3.0, 4.0 - 8.0 * xi, 4.0 * xi - 1.0])


def run_of_edges(body: BodyMesh, boundary: str, place: complex, reach: float) -> IntArray:
    """Return the edges of a closed boundary whose middles lie within `reach` (mm) of a place, as one run in chain order.

    The result has the shape (edges, 3): first, middle and last node of each edge, body on the left. MeshError when the
    boundary is missing or has fewer than four edges there.
    """
    if body.order != 2:
        raise MeshError(f"mesh of {body.name} has straight elements; contact needs second-order ones")
    chain = body.boundary_nodes(boundary)
    middles = body.mesh.doflocs[0, chain[:, 1]] + 1j * body.mesh.doflocs[1, chain[:, 1]]
    away = np.abs(middles - place)
    nearest = int(np.argmin(away))
    # Walk from the nearest edge both ways, so that a far part of the boundary is never mixed in.
    near = np.roll(away <= reach, -nearest)
    if np.all(near):
        return np.roll(chain, len(chain) // 2 - nearest, axis=0)
    ahead = int(np.argmin(near)) if near[0] else 0
    behind = int(np.argmin(near[::-1]))
    if ahead + behind < 4:
        raise MeshError(
            f"boundary {boundary!r} of {body.name} has {ahead + behind} edges within {reach:.3g} mm of "
            f"({place.real:.4g}, {place.imag:.4g}) mm; a contact zone needs at least 4: use smaller elements"
        )
    return chain[(nearest + np.arange(-behind, ahead)) % len(chain)]


@dataclass(frozen=True, slots=True, kw_only=True)
class PressureZone:
    """Zone whose surface carries the contact pressure, piecewise linear.

    Attributes
    ----------
    nodes : array of int, shape (edges, 3)
        First, middle and last node of each edge.
    places : array of complex, shape (edges, 3)
        Their places in the frame of the body, mm.
    curve : Curve
        The exact boundary; gaps and normals are taken from it.
    thickness : float
        mm.
    loaded_ends : bool
        Whether the end vertices carry pressure, too (bodies that touch up to their corners); else it is zero there.
    """

    nodes: IntArray
    places: ComplexArray
    curve: Curve
    thickness: float
    loaded_ends: bool = False

    @classmethod
    def on_boundary(
        cls,
        body: BodyMesh,
        curve: Curve,
        place: complex,
        reach: float,
        *,
        thickness: float,
        loaded_ends: bool = False,
    ) -> PressureZone:
        """Return the zone of a mesh within `reach` (mm) of a place; see `run_of_edges` for the errors."""
        nodes = run_of_edges(body, curve.name, place, reach)
        x, y = body.mesh.doflocs
        places = x[nodes] + 1j * y[nodes]
        return cls(nodes=nodes, places=places, curve=curve, thickness=thickness, loaded_ends=loaded_ends)

    @property
    def edge_count(self) -> int:
        """Number of edges."""
        return len(self.nodes)

    @property
    def unknown_count(self) -> int:
        """Number of pressure unknowns: the inner vertices, or all."""
        return len(self.nodes) + (1 if self.loaded_ends else -1)

    def unknowns_at(self, vertex: IntArray) -> tuple[NDArray[np.bool_], IntArray]:
        """Return which of the vertices carry an unknown, and its number for those."""
        unknown = vertex if self.loaded_ends else vertex - 1
        carries = (unknown >= 0) & (unknown < self.unknown_count)
        return carries, unknown[carries]

    def at_vertices(self, pressure: FloatArray) -> FloatArray:
        """Return the pressure at all vertices, ends included, MPa."""
        return pressure if self.loaded_ends else np.concatenate([[0.0], pressure, [0.0]])

    @property
    def arc(self) -> FloatArray:
        """Arc length of every vertex from the first one, mm, shape (edges + 1,)."""
        slope = np.tensordot(self.places, quadratic_slopes(GAUSS_POINTS), axes=(1, 0))
        return np.concatenate([[0.0], np.cumsum(np.abs(slope) @ GAUSS_WEIGHTS)])

    def points(self, edge: IntArray, xi: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Return meshed points and length elements (mm for a unit of ξ) at places of edges."""
        corner = self.places[edge].T
        point = np.sum(corner * quadratic_shapes(xi), axis=0)
        return point, np.abs(np.sum(corner * quadratic_slopes(xi), axis=0))

    def exact(self, points: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Return the points of the exact curve nearest to meshed points, and its unit normals out of the body."""
        parameter = self.curve.parameter_of(points)
        return self.curve.points(parameter), self.curve.normals(parameter)

    def load_shapes(self, unknowns: int) -> sp.csc_matrix:
        """Return nodal forces on the body of a unit of each pressure unknown (1 MPa at a vertex).

        The shape is (unknowns, pressure unknowns); forces are in N by MPa and act against the outward normal.
        """
        edges = np.repeat(np.arange(self.edge_count), len(GAUSS_POINTS))
        xi = np.tile(GAUSS_POINTS, self.edge_count)
        weights = np.tile(GAUSS_WEIGHTS, self.edge_count)
        points, length = self.points(edges, xi)
        _, normal = self.exact(points)
        force = -self.thickness * weights * length * normal
        shapes = quadratic_shapes(xi)
        rows, columns, values = [], [], []
        for vertex, hat in ((edges, 1.0 - xi), (edges + 1, xi)):
            inner, unknown = self.unknowns_at(vertex)
            for local in range(3):
                amount = (force * hat * shapes[local])[inner]
                node = self.nodes[edges, local][inner]
                rows += [2 * node, 2 * node + 1]
                columns += [unknown] * 2
                values += [amount.real, amount.imag]
        matrix = sp.coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
            shape=(unknowns, self.unknown_count),
        )
        return sp.csc_matrix(matrix)


@dataclass(frozen=True, slots=True, kw_only=True)
class OppositeZone:
    """Meshed zone opposite a pressure zone, on a full circle about the origin or on a flat.

    Attributes
    ----------
    nodes : array of int, shape (k,)
        Nodes along the zone: vertex, middle, vertex, middle, …, vertex.
    coordinates : array of float, shape (k,)
        Of the nodes in the frame of the body, increasing: polar angle on a circle, rad (unwrapped about the
        middle); place along a flat from its origin, mm.
    """

    nodes: IntArray
    coordinates: FloatArray

    @classmethod
    def on_circle(cls, body: BodyMesh, boundary: str, place: complex, reach: float) -> OppositeZone:
        """Return the zone of a circle about the origin within `reach` (mm) of a place on it."""
        edges = run_of_edges(body, boundary, place, reach)
        nodes = np.append(edges[:, :2].ravel(), edges[-1, 2])
        x, y = body.mesh.doflocs[:, nodes]
        middle = float(np.angle(place))
        return cls(nodes=nodes, coordinates=middle + np.angle((x + 1j * y) * np.exp(-1j * middle)))

    @classmethod
    def on_flat(cls, body: BodyMesh, boundary: str, place: complex, reach: float) -> OppositeZone:
        """Return the zone within `reach` of a place on a flat along x with the body below it."""
        edges = run_of_edges(body, boundary, place, reach)[::-1, ::-1]
        nodes = np.append(edges[:, :2].ravel(), edges[-1, 2])
        return cls(nodes=nodes, coordinates=np.array(body.mesh.doflocs[0, nodes]))

    @property
    def edge_count(self) -> int:
        """Number of edges."""
        return len(self.nodes) // 2

    @property
    def unknowns(self) -> IntArray:
        """Displacement unknowns of the nodes, both components side by side."""
        return unknowns_of_nodes(self.nodes)

    @property
    def vertices(self) -> FloatArray:
        """Coordinates of the vertices, shape (edges + 1,)."""
        return self.coordinates[::2]

    def unit_loads(self, unknowns: int) -> sp.csc_matrix:
        """Return unit forces on each unknown of the zone, shape (unknowns, 2 k)."""
        own = self.unknowns
        return sp.csc_matrix((np.ones(len(own)), (own, np.arange(len(own)))), shape=(unknowns, len(own)))

    def shapes_at(self, coordinate: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return the edge at each coordinate and the shape functions of its nodes there, shapes (n,) and (3, n).

        Coordinates beyond the zone are taken at its end; the solution must not carry pressure there.
        """
        vertices = self.vertices
        edge = np.clip(np.searchsorted(vertices, coordinate, side="right") - 1, 0, self.edge_count - 1)
        first, middle, last = (self.coordinates[2 * edge + k] for k in range(3))
        # The coordinate runs along the edge as a quadratic in ξ; invert it (its second-order part is small).
        slope, bend = 4.0 * middle - 3.0 * first - last, 2.0 * (first + last - 2.0 * middle)
        rise = np.clip(coordinate, vertices[0], vertices[-1]) - first
        xi = 2.0 * rise / (slope + np.sqrt(slope**2 + 4.0 * bend * rise))
        return edge, quadratic_shapes(xi)
