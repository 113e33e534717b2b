r"""Patches with semi-elliptic pressure on meshed boundaries: loads, and the means by which they measure.

A patch of half-width b about a place of a boundary carries, for one newton and thickness t,

.. math:: p(s)\, t = \frac{2}{\pi b} \sqrt{1 - s^2/b^2}, \qquad |s| \le b,

along the arc length s, against the outward normal. Its nodal forces, taken as weights on nodal displacements,
give the pressure-weighted mean of the displacement into the body: one vector loads and measures, so the matrix
of approaches is symmetric whatever the mesh. The integrals run over the curved edges with s = b sin φ, which
takes the square root out of the integrand, from vertex to vertex: they do not care where the nodes lie.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from fem.body.surface import quadratic_shapes, quadratic_slopes
from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from fem.shapes import Curve
from ltca.arrays import ComplexArray, FloatArray, IntArray

# Between two vertices the integrand is cos²φ times a quadratic in s = b sin φ; where the patch lies within one edge,
# φ runs over all of π, and ten points leave 1e-13.
GAUSS = np.polynomial.legendre.leggauss(10)
# Length of a quadratic edge whose speed varies by some per cent: four points leave 1e-12.
LENGTH_GAUSS = np.polynomial.legendre.leggauss(4)
# A patch must be small against its boundary: it may cover this part of it.
MAX_BOUNDARY_SHARE = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundaryArc:
    """A closed meshed boundary by arc length.

    Attributes
    ----------
    nodes : array of int, shape (edges, 3)
        First, middle and last node of each edge, body on the left.
    places : array of complex, shape (edges, 3)
        Their places, mm.
    start : array, shape (edges + 1,)
        Arc length at the first vertex of each edge, and the whole length, mm.
    curve : Curve
        The exact curve; normals are taken from it.
    """

    nodes: IntArray
    places: ComplexArray
    start: FloatArray
    curve: Curve

    @classmethod
    def of_boundary(cls, body: BodyMesh, curve: Curve) -> BoundaryArc:
        """Return the boundary of a quadratic mesh that follows a curve; MeshError for a mesh of first order."""
        if body.order != 2:
            raise MeshError(f"mesh of {body.name} has straight elements; patches need second-order ones")
        nodes = body.boundary_nodes(curve.name)
        x, y = body.mesh.doflocs
        places = x[nodes] + 1j * y[nodes]
        lengths = edge_length(places, np.ones(len(nodes)))
        return cls(nodes=nodes, places=places, start=np.concatenate([[0.0], np.cumsum(lengths)]), curve=curve)

    @property
    def length(self) -> float:
        """Length of the boundary, mm."""
        return float(self.start[-1])

    def arc_of(self, points: ComplexArray) -> FloatArray:
        """Return the arc length of the places of the boundary nearest to points on the exact curve, mm."""
        middles = self.places[:, 1]
        _, edge = cKDTree(np.column_stack([middles.real, middles.imag])).query(
            np.column_stack([points.real, points.imag])
        )
        # The nearest middle is that of the edge itself, or of a neighbour: ξ then runs out of [0, 1] a little,
        # where the arc length still continues smoothly to far below the accuracy of the place.
        for _ in range(2):
            xi = self._nearest_coordinate(edge, points)
            edge = (edge + (xi > 1.0) - (xi < 0.0)) % len(self.nodes)
        xi = self._nearest_coordinate(edge, points)
        return np.asarray(self.start[edge] + edge_length(self.places[edge], xi))

    def _nearest_coordinate(self, edge: IntArray, points: ComplexArray) -> FloatArray:
        corner = self.places[edge].T
        xi = np.full(len(points), 0.5)
        for _ in range(4):
            away = np.sum(corner * quadratic_shapes(xi), axis=0) - points
            slope = np.sum(corner * quadratic_slopes(xi), axis=0)
            xi = xi - (away * slope.conjugate()).real / np.abs(slope) ** 2
        return xi

    def coordinate_of(self, arc: FloatArray) -> tuple[IntArray, FloatArray]:
        """Return edge and reference coordinate ξ at arc lengths, which may run over either end."""
        arc = np.mod(arc, self.length)
        edge = np.clip(np.searchsorted(self.start, arc, side="right") - 1, 0, len(self.nodes) - 1)
        rise = arc - self.start[edge]
        corner = self.places[edge]
        xi = rise / (self.start[edge + 1] - self.start[edge])
        for _ in range(4):
            speed = np.abs(np.sum(corner.T * quadratic_slopes(xi), axis=0))
            xi = xi - (edge_length(corner, xi) - rise) / speed
        return edge, xi


def edge_length(places: ComplexArray, xi: FloatArray) -> FloatArray:
    """Return the arc length of quadratic edges from their first vertex to ξ, mm; shapes (n, 3) and (n,)."""
    nodes, weights = LENGTH_GAUSS
    total = np.zeros(len(xi))
    for node, weight in zip(nodes, weights, strict=True):
        slope = np.sum(places.T * quadratic_slopes(0.5 * (node + 1.0) * xi), axis=0)
        total += 0.5 * weight * xi * np.abs(slope)
    return total


def patch_loads(
    body: BodyMesh,
    curve: Curve,
    parameters: FloatArray,
    half_width: FloatArray | float,
    *,
    along_normals: bool = False,
) -> sp.csc_matrix:
    """Return nodal forces of one newton on patches of a boundary.

    Parameters
    ----------
    body : BodyMesh
        Quadratic mesh.
    curve : Curve
        Exact curve of a closed boundary of the mesh.
    parameters : array, shape (n,)
        Middles of the patches as parameters of the curve, rad.
    half_width : float or array, shape (n,)
        Along the arc length, mm.
    along_normals : bool
        Whether the pressure follows the normals of a curved wall, as that of a contact does; by default it has one
        direction, that in the middle of the patch.

    Returns
    -------
    csc_matrix, shape (unknowns, n)
        N for each newton; pressures add up to 1 N, forces point into the body.

    Raises
    ------
    MeshError
        When a half-width is not positive or the patch is no small part of the boundary.
    """
    parameters = np.atleast_1d(np.asarray(parameters, dtype=float))
    width = np.broadcast_to(np.asarray(half_width, dtype=float), parameters.shape)
    boundary = BoundaryArc.of_boundary(body, curve)
    if not (np.all(width > 0.0) and np.all(2.0 * width < MAX_BOUNDARY_SHARE * boundary.length)):
        raise MeshError(
            f"patch half-width {width.min():.4g} to {width.max():.4g} mm on {curve.name!r} of {body.name}: must be "
            f"greater than 0 and less than {0.5 * MAX_BOUNDARY_SHARE * boundary.length:.4g} mm"
        )
    middle = boundary.arc_of(curve.points(parameters))
    phi, weight, owner = divide_patches(boundary, middle, width)
    offset = width[owner] * np.sin(phi)
    edge, xi = boundary.coordinate_of(middle[owner] + offset)
    shapes = quadratic_shapes(xi)
    normals = curve.normals(parameters)[owner]
    if along_normals:
        normals = curve.normals(curve.parameter_of(np.sum(boundary.places[edge].T * shapes, axis=0)))
    # p t ds = (2/π) cos²φ dφ
    force = -2.0 / np.pi * np.cos(phi) ** 2 * weight * normals
    return sum_at_nodes(boundary.nodes[edge].T, force * shapes, owner, (body.unknowns, len(parameters)))


def sum_at_nodes(nodes: IntArray, vectors: ComplexArray, owner: IntArray, shape: tuple[int, int]) -> sp.csc_matrix:
    """Return the sums of vectors at nodes, a column for each patch: x in the even rows, y in the odd ones.

    `nodes` and `vectors` have the shape (3, points); `owner` is the patch of each point.
    """
    rows = np.concatenate([(2 * nodes).ravel(), (2 * nodes + 1).ravel()])
    values = np.concatenate([vectors.real.ravel(), vectors.imag.ravel()])
    return sp.csc_matrix(sp.coo_matrix((values, (rows, np.tile(owner, 6))), shape=shape))


def divide_patches(
    boundary: BoundaryArc, middle: FloatArray, width: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Divide patches at the vertices they cover.

    `middle` and `width` are the arc length of the middle of each patch and its half-width, mm. Returned are Gauss points φ
    between neighbouring vertices (s = b sin φ from the middle of the patch), their weights for ∫ dφ, and the patch of each
    point.
    """
    nodes, weights = GAUSS
    phis, steps, owners = [], [], []
    # Two turns of vertices, so that a patch over the first vertex finds those on both sides of it.
    vertices = np.concatenate(
        [boundary.start[:-1] - boundary.length, boundary.start[:-1], boundary.start + boundary.length]
    )
    for index, (place, half) in enumerate(zip(middle.tolist(), width.tolist(), strict=True)):
        first, last = np.searchsorted(vertices, [place - half, place + half])
        ends = np.concatenate([[-1.0], (vertices[first:last] - place) / half, [1.0]])
        angle = np.arcsin(np.clip(ends, -1.0, 1.0))
        half_step = 0.5 * np.diff(angle)
        phis.append((0.5 * (angle[1:] + angle[:-1])[:, None] + half_step[:, None] * nodes).ravel())
        steps.append((half_step[:, None] * weights).ravel())
        owners.append(np.full(phis[-1].size, index))
    return np.concatenate(phis), np.concatenate(steps), np.concatenate(owners)
