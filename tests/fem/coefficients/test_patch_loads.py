"""Patches against closed integrals, wherever the nodes lie."""

import numpy as np
import pytest
from scipy.special import j1

from fem.coefficients.patch_loads import patch_loads
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleShape, RingShape

RADIUS = 5.0


@pytest.fixture(scope="module")
def circle():
    shape = CircleShape(name="circle", radius=RADIUS)
    return shape, mesh_circle(shape, [Refinement.polar(RADIUS, 0.3, size=0.02, radius=0.1)], coarse_size=0.12)


def angles():
    # Over the first vertex of the boundary, inside one coarse edge, and over many fine ones.
    return np.array([0.0, 1e-3, 0.3, 2.0, 4.567, 2.0 * np.pi - 1e-3])


def test_one_newton_along_the_normal(circle):
    shape, body = circle
    parameters = angles()
    loads = patch_loads(body, shape.curves[0], parameters, 0.25)
    np.testing.assert_allclose(np.asarray(loads[0::2].sum(axis=0)).ravel(), -np.cos(parameters), atol=1e-12)
    np.testing.assert_allclose(np.asarray(loads[1::2].sum(axis=0)).ravel(), -np.sin(parameters), atol=1e-12)


def test_moment_about_the_centre_vanishes_on_a_circle(circle):
    shape, body = circle
    x, y = body.mesh.doflocs
    loads = patch_loads(body, shape.curves[0], angles(), 0.25).toarray()
    moment = x @ loads[1::2] - y @ loads[0::2]
    # The edges leave the circle by up to 1e-6 of its radius.
    np.testing.assert_allclose(moment, 0.0, atol=1e-6 * RADIUS)


@pytest.mark.parametrize("half_width", [0.05, 0.25, 1.0])
def test_pressure_is_semi_elliptic(circle, half_width):
    r"""⟨(s-offset)²⟩ of a semi-ellipse on a circle: R² (1/2 - J₁(z)/z), z = 2b/R, whatever the nodes."""
    shape, body = circle
    x, y = body.mesh.doflocs
    loads = patch_loads(body, shape.curves[0], angles(), half_width).toarray()
    z = 2.0 * half_width / RADIUS
    expected = RADIUS**2 * (0.5 - j1(z) / z)
    for column, angle in zip(loads.T, angles(), strict=True):
        across = -np.sin(angle) * x + np.cos(angle) * y
        measured = -(column[0::2] * np.cos(angle) + column[1::2] * np.sin(angle)) @ across**2
        # A square on a curved quadratic edge is no polynomial of its shape functions; on 0.4 mm edges that adds.
        assert measured == pytest.approx(expected, rel=1e-3)


def test_holes_are_pressed_outward():
    shape = RingShape(inner_radius=5.0, outer_radius=10.0)
    body = mesh_ring(shape, coarse_size=1.5)
    loads = patch_loads(body, shape.curves[1], np.array([0.5 * np.pi]), 0.4)
    np.testing.assert_allclose(
        [loads[0::2].sum(), loads[1::2].sum()], [0.0, 1.0], atol=1e-12, err_msg="into the ring is away from the hole"
    )


@pytest.mark.parametrize("half_width", [0.0, -1.0, 4.0, float("nan")])
def test_unfit_width_is_refused(circle, half_width):
    shape, body = circle
    with pytest.raises(MeshError, match="half-width"):
        patch_loads(body, shape.curves[0], np.array([0.0]), half_width)


def test_straight_elements_are_refused():
    shape = CircleShape(name="circle", radius=RADIUS)
    with pytest.raises(MeshError, match="second-order"):
        patch_loads(mesh_circle(shape, order=1), shape.curves[0], np.array([0.0]), 0.2)
