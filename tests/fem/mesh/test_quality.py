"""Quality measures against triangles whose angles and Jacobians are known."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says
from skfem import MeshTri1, MeshTri2
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from fem.mesh.quality import jacobian_determinants, measure_quality, require_quality, require_valid_elements


def single(corners: list[complex], order: int = 1) -> BodyMesh:
    places = np.array([[z.real for z in corners], [z.imag for z in corners]])
    return BodyMesh(name="one", mesh=triangle_mesh(places, np.array([[0], [1], [2]]), {}, order=order))


def with_middle(body: BodyMesh, ends: tuple[int, int], place: complex) -> BodyMesh:
    facet = int(np.flatnonzero(np.all(ends == np.sort(body.mesh.facets, axis=0).T, axis=1))[0])
    body.mesh.doflocs[:, body.mesh.nvertices + facet] = [place.real, place.imag]
    return body


def test_equilateral_and_right_triangle() -> None:
    equilateral = measure_quality(single([0j, 1 + 0j, 0.5 + 0.5j * np.sqrt(3.0)]))
    assert np.degrees(equilateral.smallest_angle) == pytest.approx(60.0)
    assert equilateral.mean_shape == pytest.approx(1.0)
    assert equilateral.scaled_jacobian == pytest.approx(1.0)
    right = measure_quality(single([0j, 2 + 0j, 2j], order=2))
    assert np.degrees(right.smallest_angle) == pytest.approx(45.0)
    assert (right.shortest_edge, right.longest_edge) == pytest.approx((2.0, 2.0 * np.sqrt(2.0)))


@pytest.mark.parametrize(("position", "expected"), [(0.5, 1.0), (0.3, 0.2), (0.25, 0.0), (0.2, -0.2)])
def test_a_shifted_mid_side_node_has_the_jacobian_of_the_quarter_point_element(position, expected) -> None:
    """dx/ds at the end of an edge is 4·position − 1 of its length: 0 at the quarter point (Barsoum 1976)."""
    body = with_middle(single([0j, 1 + 0j, 1j], order=2), (0, 1), complex(position))
    assert measure_quality(body).scaled_jacobian == pytest.approx(expected, abs=1e-12)
    if expected <= 0.0:
        with error_says(MeshError, "mesh of one has 1 inverted element(s)"):
            require_valid_elements(body)


def test_determinants_match_scikit_fem_on_a_curved_element() -> None:
    body = with_middle(single([0j, 1 + 0j, 1j], order=2), (1, 2), 0.6 + 0.65j)
    points, _ = get_quadrature(RefTri, 6)
    reference = body.mesh.mapping().detDF(points)  # (elements, points)
    ours = jacobian_determinants(body)[6:].T
    np.testing.assert_allclose(ours, reference, rtol=1e-12)


def test_a_clockwise_triangle_is_inverted() -> None:
    with error_says(MeshError, "1 inverted element(s); the worst is element 0 near (0.333333, 0.333333)"):
        require_valid_elements(single([0j, 1j, 1 + 0j]))


def test_a_flat_triangle_is_too_distorted() -> None:
    with error_says(MeshError, "too distorted ", "smallest angle must be at least 15°"):
        require_quality(single([0j, 1 + 0j, 0.5 + 0.05j]))


def test_measures_of_a_structured_mesh() -> None:
    for kind, mesh in ((1, MeshTri1()), (2, MeshTri2())):
        body = BodyMesh(name="square", mesh=mesh.refined(2))
        assert body.order == kind
        assert np.degrees(measure_quality(body).smallest_angle) == pytest.approx(45.0)
