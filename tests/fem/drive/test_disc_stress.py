"""Stress in the disc of a full solution: how it is read from nodal stresses (the LTCA's against it: `tests/validation`)."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fem.body.stress import Stress
from fem.body.surface import PressureZone
from fem.body.wall_stress import WallStress, stress_along_wall
from fem.contact.subsurface_shear import largest_shear_below
from fem.drive.disc_stress import _centre_of_pressure
from fem.drive.meshes import wall_refinements
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleCurve, CircleShape, DriveShapes, RingShape
from validation.hertz import line_contact_stress


def hertz_field(body, half_width, peak):
    """McEwen's stresses at the nodes of a body whose surface at (0, −R) is pressed upward, as if it were a half-plane."""
    x, y = body.mesh.doflocs
    depth = np.maximum(y - y.min(), 1e-9)
    found = line_contact_stress(x, depth, half_width, peak)
    return Stress(xx=found.across, yy=found.depthwise, xy=-found.shear, zz=0.3 * (found.across + found.depthwise))


def test_largest_shear_of_mcewens_field():
    """0.300 p0 at 0.786 b, read from nodes b/16 apart; a stress along the wall adds half of itself."""
    half_width, peak, radius = 0.2, 1000.0, 6.0
    shape = CircleShape(name="pin", radius=radius)
    body = mesh_circle(shape, [Refinement(0.0, -radius, half_width / 8.0, 1.5 * half_width)])
    stress = hertz_field(body, half_width, peak)
    shear, depth = largest_shear_below(body, stress, -1j * radius, 1j, half_width)
    # Straight lines between nodes cut the crest by 0.1 %; it is flat, so its place is known to a node or two.
    assert shear == pytest.approx(0.30028 * peak, rel=2e-3)
    assert depth == pytest.approx(0.786 * half_width, abs=0.06 * half_width)
    along = replace(stress, xx=stress.xx + 60.0)
    assert largest_shear_below(body, along, -1j * radius, 1j, half_width)[0] == pytest.approx(shear + 30.0, rel=2e-3)
    with pytest.raises(MeshError, match="contact"):
        largest_shear_below(body, stress, 3j * radius, 1j, half_width)


def test_stress_along_a_wall_turns_with_it():
    """Uniform tension along x: cos² of the angle between wall and x, at nodes in order of their parameter."""
    shape = CircleShape(name="pin", radius=5.0, core_radius=2.0)
    body = mesh_circle(shape, coarse_size=1.5)
    nodes = body.node_count
    stress = Stress(xx=np.full(nodes, 80.0), yy=np.zeros(nodes), xy=np.zeros(nodes), zz=np.zeros(nodes))
    for curve in shape.curves:
        wall = stress_along_wall(body, stress, curve)
        assert np.all(np.diff(wall.parameter) > 0.0)
        np.testing.assert_allclose(np.abs(wall.points), curve.radius)
        np.testing.assert_allclose(wall.stress, 80.0 * np.sin(wall.parameter) ** 2, atol=1e-9)
    made = WallStress(
        name="w", parameter=np.array([1.0, 4.0]), points=np.zeros(2, complex), stress=np.array([2.0, 8.0])
    )
    # Over the end of the period the wall goes on at its beginning.
    np.testing.assert_allclose(
        made.at(np.array([2.0, 2.5 + np.pi])), [4.0, 8.0 - 6.0 * (np.pi - 1.5) / (2 * np.pi - 3.0)]
    )


def test_fine_walls_follow_every_wall(paper_cases):
    shape = DriveShapes.of_drive(paper_cases["CS-1"]).disc
    spots = wall_refinements(shape)
    places = np.array([spot.point for spot in spots])
    assert max(spot.size for spot in spots) == pytest.approx(shape.narrowest_wall / 6.0)
    for curve in (*shape.bores, *shape.holes):
        along = curve.points(np.linspace(0.0, 2.0 * np.pi, 97))
        assert np.max(np.min(np.abs(along[:, None] - places), axis=1)) < 1.01 * shape.narrowest_wall / 6.0
    roots = shape.flank.points(2.0 * np.pi * np.arange(13) / 13)
    assert np.max(np.min(np.abs(roots[:, None] - places), axis=1)) < 1e-9


def test_the_centre_of_pressure_lies_on_its_own_edge():
    """On a circle its angle is arc over radius; a neighbour's edge drawn out to it misses it by a hundredth of an edge."""
    radius = 5.0
    ring = mesh_ring(RingShape(inner_radius=radius, outer_radius=8.0), coarse_size=1.2)
    zone = PressureZone.on_boundary(
        ring, CircleCurve(name="inner", radius=radius, encloses_body=False), radius + 0j, 3.5, thickness=1.0
    )
    arc = zone.arc
    start, end = np.angle(zone.places[0, 0]), np.angle(zone.places[-1, 2])
    sense = np.sign(end - start)
    # Both ends, vertices, and places on the first and the last edge; round-off may lead a little over the end.
    middles = [0.0, 0.3 * arc[1], arc[1], 0.5 * (arc[1] + arc[2]), arc[-2], 0.1 * arc[-2] + 0.9 * arc[-1], arc[-1]]
    for middle in (*middles, float(np.nextafter(arc[-1], np.inf))):
        place, normal = _centre_of_pressure(SimpleNamespace(zone=zone), SimpleNamespace(middle=middle))
        # A quadratic edge of 0.24 of the radius: its arc runs unevenly by (h/R)² / 100 of it within the edge.
        assert np.angle(place) == pytest.approx(start + sense * middle / radius, abs=1e-3 * np.diff(arc).max() / radius)
        assert abs(place) == pytest.approx(radius, abs=1e-12)
        assert normal == pytest.approx(-place / radius, abs=1e-12)
