"""Contact zones on boundaries: arc length, ends, tractions and rigid motions by hand."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from fem.body.surface import PressureZone, run_of_edges
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleCurve, CircleShape

RADIUS = 5.0


@pytest.fixture(scope="module")
def zone():
    body = mesh_circle(CircleShape(name="roller", radius=RADIUS), [Refinement(RADIUS, 0.0, 0.1, 1.0)])
    curve = CircleCurve(name="surface", radius=RADIUS, encloses_body=True)
    return body, PressureZone.on_boundary(body, curve, RADIUS + 0j, 0.6, thickness=3.0)


def test_arc_length_starts_at_the_first_vertex(zone):
    _, own = zone
    vertices = np.append(own.places[:, 0], own.places[-1, 2])
    angle = np.unwrap(np.angle(vertices))
    assert own.arc[0] == 0.0
    # quadratic edges of h = 0.1 mm lie (h/R)⁴/400 from the circle
    np.testing.assert_allclose(own.arc, RADIUS * (angle - angle[0]), rtol=1e-8, atol=1e-9)


def test_ends_carry_nothing_unless_bodies_end_there(zone):
    body, own = zone
    unknowns = np.arange(1.0, own.edge_count)
    np.testing.assert_array_equal(own.at_vertices(unknowns), [0.0, *unknowns, 0.0])
    assert own.unknown_count == own.edge_count - 1
    ended = PressureZone.on_boundary(body, own.curve, RADIUS + 0j, 0.6, thickness=3.0, loaded_ends=True)
    assert ended.unknown_count == own.edge_count + 1
    every = np.arange(1.0, own.edge_count + 2.0)
    np.testing.assert_array_equal(ended.at_vertices(every), every)


def test_a_pressure_pushes_inward_with_its_own_sum(zone):
    """Nodal loads of a pressure linear in the arc: force and moment are its integrals along the exact normal."""
    body, own = zone
    arc = own.arc
    pressure = (100.0 + 40.0 * arc)[1:-1]
    loads = own.load_shapes(body.unknowns) @ pressure
    full = own.at_vertices(pressure)
    fine = np.linspace(0.0, arc[-1], 40001)
    start = np.angle(own.places[0, 0])
    outward = np.exp(1j * (start + fine / RADIUS))
    along = np.interp(fine, arc, full)
    total = -3.0 * np.trapezoid(along * outward, fine)
    assert complex(loads[0::2].sum(), loads[1::2].sum()) == pytest.approx(total, rel=1e-6)
    x, y = body.mesh.doflocs
    # normals of a circle go through its centre
    assert np.sum(x * loads[1::2] - y * loads[0::2]) == pytest.approx(0.0, abs=1e-6 * abs(total))


def test_too_coarse_a_boundary_is_refused(zone):
    body, _ = zone
    with error_says(MeshError, "has 2 edges within 0.1 mm of (5, 0) mm"):
        run_of_edges(body, "surface", RADIUS + 0j, 0.1)
