"""Quality of a mesh: smallest angle and scaled Jacobian, reported and checked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh
from ltca.arrays import FloatArray

# Below this angle the interpolation error grows visibly (1/sin); gmsh's frontal meshes stay above 25°.
SMALLEST_ANGLE = np.radians(15.0)
SMALLEST_SCALED_JACOBIAN = 0.3
# Integration of degree 6: more points than the stiffness uses, so what is positive here is positive there.
INTEGRATION_DEGREE = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshQuality:
    """Quality of one mesh.

    Attributes
    ----------
    smallest_angle : float
        Smallest angle between the chords of a triangle, rad.
    scaled_jacobian : float
        Smallest Jacobian determinant over nodes and integration points of an element by twice the area of the
        triangle of its vertices: 1 for straight elements, 0 or less for inverted ones.
    mean_shape : float
        Mean of 4√3 area/(sum of squared edges): 1 for equilateral triangles.
    elements, nodes : int
        Counts.
    shortest_edge, longest_edge : float
        mm.
    """

    smallest_angle: float
    scaled_jacobian: float
    mean_shape: float
    elements: int
    nodes: int
    shortest_edge: float
    longest_edge: float

    def describe(self) -> str:
        """Return one line for people."""
        return (
            f"{self.elements:,} elements, {self.nodes:,} nodes, edges {self.shortest_edge:.3g} to "
            f"{self.longest_edge:.3g} mm, smallest angle {np.degrees(self.smallest_angle):.1f}°, "
            f"smallest scaled Jacobian {self.scaled_jacobian:.3f}, mean shape {self.mean_shape:.3f}"
        )


def jacobian_determinants(body: BodyMesh) -> FloatArray:
    """Return the Jacobian determinant of every element, mm², shape (points, elements).

    Points are vertices, mid-sides and integration points. The determinant is signed, unlike ``mapping.detDF`` of scikit-fem,
    which takes the absolute value into its integrals.
    """
    nodes = np.array([[0.0, 1.0, 0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 1.0, 0.0, 0.5, 0.5]])
    inner, _ = get_quadrature(RefTri, INTEGRATION_DEGREE)
    s, t = np.hstack([nodes, inner])
    mesh = body.mesh
    corners = mesh.doflocs[:, mesh.t]  # (2, 3, elements)
    zero, one = np.zeros_like(s), np.ones_like(s)
    if body.order == 1:
        by_s, by_t, places = np.array([-one, one, zero]), np.array([-one, zero, one]), corners
    else:
        middles = mesh.doflocs[:, mesh.nvertices + mesh.t2f]  # edges (0,1), (1,2), (0,2)
        places = np.concatenate([corners, middles], axis=1)
        r = 1.0 - s - t
        by_s = np.array([1.0 - 4.0 * r, 4.0 * s - 1.0, zero, 4.0 * (r - s), 4.0 * t, -4.0 * t])
        by_t = np.array([1.0 - 4.0 * r, zero, 4.0 * t - 1.0, -4.0 * s, 4.0 * s, 4.0 * (r - t)])
    ds = np.einsum("dne,np->dpe", places, by_s)
    dt = np.einsum("dne,np->dpe", places, by_t)
    return np.asarray(ds[0] * dt[1] - ds[1] * dt[0])


def _angles_and_edges(body: BodyMesh) -> tuple[FloatArray, FloatArray, FloatArray]:
    corners = body.mesh.doflocs[0, body.mesh.t] + 1j * body.mesh.doflocs[1, body.mesh.t]
    sides = np.roll(corners, -1, axis=0) - corners
    angles = np.abs(np.angle(-sides / np.roll(sides, 1, axis=0)))
    double_area = (sides[0].conjugate() * (corners[2] - corners[0])).imag
    return np.asarray(angles), np.abs(sides), np.asarray(double_area)


def measure_quality(body: BodyMesh) -> MeshQuality:
    """Measure a mesh; never raises for a bad one (see `require_quality`)."""
    angles, lengths, double_area = _angles_and_edges(body)
    scale = np.maximum(np.abs(double_area), np.finfo(float).tiny)
    determinants = np.minimum.reduce(jacobian_determinants(body), axis=0)
    shape = 2.0 * np.sqrt(3.0) * double_area / np.sum(lengths**2, axis=0)
    return MeshQuality(
        smallest_angle=float(angles.min()),
        scaled_jacobian=float(np.min(determinants / scale)),
        mean_shape=float(shape.mean()),
        elements=int(body.mesh.nelements),
        nodes=body.node_count,
        shortest_edge=float(lengths.min()),
        longest_edge=float(lengths.max()),
    )


def require_valid_elements(body: BodyMesh) -> None:
    """Raise MeshError, with the number of inverted elements and the place of the worst, when there are any."""
    determinants = np.minimum.reduce(jacobian_determinants(body), axis=0)
    inverted = np.flatnonzero(~(determinants > 0.0))
    if inverted.size:
        worst = int(inverted[np.argmin(determinants[inverted])])
        x, y = body.mesh.doflocs[:, body.mesh.t[:, worst]].mean(axis=1)
        raise MeshError(
            f"mesh of {body.name} has {inverted.size} inverted element(s); the worst is element {worst} "
            f"near ({x:.6g}, {y:.6g}) mm with a Jacobian of {determinants[worst]:.3g} mm²"
        )


def require_quality(body: BodyMesh) -> MeshQuality:
    """Measure a mesh; MeshError when an element is inverted, an angle is under 15° or the scaled Jacobian is under 0.3."""
    require_valid_elements(body)
    quality = measure_quality(body)
    if quality.smallest_angle < SMALLEST_ANGLE or quality.scaled_jacobian < SMALLEST_SCALED_JACOBIAN:
        raise MeshError(
            f"mesh of {body.name} is too distorted ({quality.describe()}): the smallest angle must be at least "
            f"{np.degrees(SMALLEST_ANGLE):.0f}° and the scaled Jacobian at least {SMALLEST_SCALED_JACOBIAN}"
        )
    return quality
