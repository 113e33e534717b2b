"""A body where it stands: turned and shifted, its edges on its boundary, its faces filling it."""

from __future__ import annotations

import numpy as np
import pytest

from fem.mesh.placed_body import PlacedBody
from fem.mesh.triangulation import mesh_ring
from fem.shapes import RingShape

CENTRE, TURN = 30.0 - 12.0j, 0.7


@pytest.fixture(scope="module")
def placed():
    body = mesh_ring(RingShape(inner_radius=10.0, outer_radius=20.0, name="ring"), coarse_size=2.0)
    return PlacedBody(body=body, centre=CENTRE, rotation=TURN, kind="inner_race")


def test_nodes_are_turned_then_shifted(placed):
    local = placed.body.mesh.doflocs[0] + 1j * placed.body.mesh.doflocs[1]
    np.testing.assert_allclose(placed.nodes - CENTRE, local * complex(np.cos(TURN), np.sin(TURN)), rtol=1e-14)


def test_edges_are_drawn_along_the_curved_boundary(placed):
    """Edges of 2 mm on 20 mm: quadratic ones lie (h/R)⁴/400 from the circle, chords would be 25 µm inside."""
    lines = placed.edge_lines()
    assert lines.shape == (placed.body.mesh.facets.shape[1], 5)
    rim = np.abs(np.abs(lines[:, [0, 2, 4]] - CENTRE) - 20.0).max(axis=1) < 1e-9
    assert np.count_nonzero(rim) > 50
    np.testing.assert_allclose(np.abs(lines[rim] - CENTRE), 20.0, atol=2e-5)
    # five points, evenly spaced from end to end
    ends, steps = lines[rim][:, [0, -1]], np.abs(np.diff(lines[rim], axis=1))
    np.testing.assert_allclose(steps.sum(axis=1), np.abs(np.diff(ends, axis=1))[:, 0], rtol=1e-3)
    np.testing.assert_allclose(steps, steps.mean(axis=1, keepdims=True) * np.ones(4), rtol=1e-3)


def test_faces_fill_the_body(placed):
    corners = placed.nodes[placed.faces()]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = 0.5 * (first.conjugate() * second).imag
    assert np.all(areas > 0.0)
    assert len(areas) == 4 * placed.body.mesh.nelements
    # a polygon of some sixty corners a circle and twice that at mid-edges: 4/3 (π/120)² of π (20² − 10²), 0.1 %
    assert areas.sum() == pytest.approx(np.pi * 300.0, rel=1e-3)
