"""Uniform refinement: four triangles for one, nodes kept, boundaries on the exact curves, corners kept, refusals."""

from itertools import pairwise

import numpy as np
import pytest

from fem.body.pin_ring import mesh_ring_for_seats
from fem.errors import MeshError
from fem.mesh.triangulation import mesh_circle, mesh_disc
from fem.mesh.uniform_refinement import refine_uniformly
from fem.shapes import CircleShape, DriveShapes, PinRingShape, SlottedCircle


def area_of(body):
    """Area by the divergence theorem over the quadratic boundary: ½ ∮ x × dx, exact with three Gauss points."""
    total = 0.0
    points, weights = np.polynomial.legendre.leggauss(3)
    xi = 0.5 * (points + 1.0)
    shapes = np.array([(1 - xi) * (1 - 2 * xi), 4 * xi * (1 - xi), xi * (2 * xi - 1)])
    slopes = np.array([4 * xi - 3, 4 - 8 * xi, 4 * xi - 1])
    for name in body.boundary_names:
        corners = body.places[body.boundary_nodes(name)]
        place, along = corners @ shapes, corners @ slopes
        total += 0.25 * float(np.sum((place.conjugate() * along).imag * weights))
    return total


@pytest.fixture(scope="module")
def shape(paper_cases):
    return DriveShapes.of_drive(paper_cases["CS-3"]).disc


@pytest.fixture(scope="module")
def family(shape):
    bodies = [mesh_disc(shape, coarse_size=8.0)]
    for _ in range(2):
        bodies.append(refine_uniformly(bodies[-1], shape.curves))
    return bodies


def test_four_for_one_and_nodes_stay(family):
    for coarse, fine in pairwise(family):
        assert fine.mesh.nelements == 4 * coarse.mesh.nelements
        assert fine.mesh.nvertices == coarse.node_count
        np.testing.assert_array_equal(fine.places[: coarse.node_count], coarse.places)
        assert fine.boundary_names == coarse.boundary_names


def test_boundary_nodes_are_on_the_curves(family, shape):
    """Mid-side nodes included, to round-off of Newton's method on a flank of 90 mm."""
    for curve in shape.curves:
        nodes = np.unique(family[-1].boundary_nodes(curve.name))
        places = family[-1].places[nodes]
        np.testing.assert_allclose(curve.points(curve.parameter_of(places)), places, atol=1e-11)


def test_area_converges_with_the_fourth_order(family, shape):
    """A quadratic edge with its nodes on a curve leaves it by h⁴ in the mean: 16 each time; 12 leaves room for higher terms."""
    errors = [abs(area_of(body) - shape.area) for body in family]
    assert errors[0] > 12.0 * errors[1] > 144.0 * errors[2]


def test_corners_of_a_ring_are_kept():
    inner = SlottedCircle(radius=50.0, seats=7, seat_circle_radius=50.5, seat_radius=4.0)
    ring = PinRingShape(inner=inner, outer_radius=65.0)
    body = mesh_ring_for_seats(ring, np.zeros(0, dtype=complex), 1.0, size=4.0)
    fine = refine_uniformly(body, ring.curves)
    corners = inner.points(np.array(inner.corners))
    vertices = fine.places[np.unique(fine.boundary_nodes("inner")[:, 0])]
    assert np.max(np.min(np.abs(corners[:, None] - vertices), axis=1)) < 1e-9
    assert abs(area_of(fine) - ring.area) < abs(area_of(body) - ring.area) / 12.0


def test_refusals():
    shape = CircleShape(name="pin", radius=5.0, core_radius=2.0)
    with pytest.raises(MeshError, match="order 1"):
        refine_uniformly(mesh_circle(shape, order=1), shape.curves)
    with pytest.raises(MeshError, match="no named boundary"):
        refine_uniformly(mesh_circle(shape), shape.curves[:1])
