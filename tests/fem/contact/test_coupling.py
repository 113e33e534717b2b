"""Pair integrals: exact gaps, one line of action, one rule on both sides."""

import numpy as np
import pytest

from fem.body.surface import OppositeZone, PressureZone
from fem.contact.coupling import NO_PARTNER, Pose, _segment_ends, gap_to_opposite, integrate_pair
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_disc, mesh_ring
from fem.shapes import CircleCurve, CircleShape, DriveShapes, RingShape
from ltca.reading.drive_file import load_drive


@pytest.fixture(scope="module")
def pair():
    ring = mesh_ring(RingShape(inner_radius=20.0, outer_radius=30.0), [Refinement(20.0, 0.0, 0.05, 0.4)])
    roller = mesh_circle(CircleShape(name="roller", radius=5.0), [Refinement(5.0, 0.0, 0.033, 0.4)])
    bore = CircleCurve(name="inner", radius=20.0, encloses_body=False)
    zone = PressureZone.on_boundary(ring, bore, 20.0 + 0j, 0.5, thickness=11.8)
    return ring, roller, zone, OppositeZone.on_circle(roller, "surface", 5.0 + 0j, 0.7)


def test_gap_along_the_axis_is_exact():
    pose = Pose(centre=15.0 - 0.002 + 0j)
    gap = gap_to_opposite(np.array([20.0 + 0j]), np.array([-1.0 + 0j]), pose, 5.0)
    assert gap[0] == pytest.approx(0.002, abs=1e-14)
    assert gap_to_opposite(np.array([20.0 + 9j]), np.array([-1.0 + 0j]), pose, 5.0)[0] == NO_PARTNER


def test_weighted_gap_is_the_integral_of_the_exact_gap(pair):
    """Roller in a bore: along the bore's normal the gap is a − √(r² − d²), integrated on the exact circles."""
    _, _, zone, opposite = pair
    centre = 15.0 - 0.003 + 0.001j
    integrals = integrate_pair(zone, Pose(), Pose(centre=centre), 5.0, opposite)
    vertices = np.append(zone.places[:, 0], zone.places[-1, 2])
    angles = np.angle(vertices)
    fine = np.linspace(angles[3], angles[5], 20001)
    low, top, high = angles[3], angles[4], angles[5]
    weight = np.where((fine - top) * (low - top) > 0.0, (fine - low) / (top - low), (fine - high) / (top - high))
    points, normals = 20.0 * np.exp(1j * fine), -np.exp(1j * fine)
    away = (centre - points) * normals.conjugate()
    exact = away.real - np.sqrt(25.0 - away.imag**2)
    expected = 11.8 * 20.0 * abs(np.trapezoid(weight * exact, fine))
    # The meshed arc is 1e-9 shorter and its hats run along ξ, not along the angle.
    assert abs(integrals.gap[3]) == pytest.approx(expected, rel=1e-5)


def test_segments_end_where_vertices_opposite_are_met(pair):
    """From every end that is no vertex of the zone the bore's normal meets a vertex of the roller, and none is left out.

    Both bodies turned by 0.7 rad, as they stand in a drive: a normal and its conjugate then point apart.
    """
    _, _, zone, opposite = pair
    turn = np.exp(0.7j)
    pose, opposite_pose = Pose(rotation=0.7), Pose(centre=(15.0 - 0.003 + 0.001j) * turn, rotation=0.7)
    ends = _segment_ends(zone, pose, opposite_pose, 5.0, opposite)
    between = ends[ends % 1.0 > 0.0]
    edge = between.astype(int)
    exact, normal = zone.exact(zone.points(edge, between - edge)[0])
    points, normals = exact * turn, normal * turn
    away = (opposite_pose.centre - points) * normals.conjugate()
    met = (points + (away.real - np.sqrt(25.0 - away.imag**2)) * normals - opposite_pose.centre) / turn
    # The roller fills the bore's zone: its zone reaches further on both sides.
    first, last = sorted(np.angle((np.array([zone.places[0, 0], zone.places[-1, 2]]) - 15.0) / 5.0))
    vertices = opposite.vertices[(opposite.vertices > first) & (opposite.vertices < last)]
    # Half-edges of the zone are interpolated between: 1e-4 of an edge. Off the circle by twice the gap it would be a tenth.
    np.testing.assert_allclose(np.sort(np.angle(met)), vertices, atol=2e-3 * np.diff(opposite.vertices).min())


def test_both_sides_feel_the_same_force_on_one_line(pair):
    ring, roller, zone, opposite = pair
    pose = Pose(centre=15.0 - 0.003 + 0.001j, rotation=0.01)
    integrals = integrate_pair(zone, Pose(), pose, 5.0, opposite)
    pressure = np.random.default_rng(7).uniform(100.0, 900.0, zone.unknown_count)
    carrier = zone.load_shapes(ring.unknowns) @ pressure
    force = integrals.force @ pressure
    assert complex(carrier[0::2].sum(), carrier[1::2].sum()) == pytest.approx(-complex(force[0], force[1]), rel=1e-12)
    x, y = ring.mesh.doflocs
    moment = np.sum(x * carrier[1::2] - y * carrier[0::2])
    # Meshed arcs leave the circle by (h/R)⁴/400 of the radius: that, times the force, is all that may differ.
    assert moment == pytest.approx(-force[2], abs=1e-8 * abs(complex(force[0], force[1])))
    nodal = integrals.opposite_loads @ pressure
    on_roller = complex(nodal[0::2].sum(), nodal[1::2].sum()) * np.exp(1j * pose.rotation)
    assert on_roller == pytest.approx(complex(force[0], force[1]), rel=1e-12)
    places = roller.mesh.doflocs[0, opposite.nodes] + 1j * roller.mesh.doflocs[1, opposite.nodes]
    local = nodal[0::2] + 1j * nodal[1::2]
    about = (
        np.sum((places.conjugate() * local).imag)
        + ((pose.centre * np.exp(-1j * pose.rotation)).conjugate() * local.sum()).imag
    )
    assert about == pytest.approx(force[2], abs=1e-7 * abs(on_roller))


def test_a_translation_opens_the_gap_as_the_force_says(pair):
    """Virtual work: the change of the weighted gap with the place of the roller is the resultant."""
    _, _, zone, opposite = pair
    centre, step = 15.0 - 0.003 + 0j, 1e-6
    gaps = [integrate_pair(zone, Pose(), Pose(centre=centre + s * step), 5.0, opposite).gap for s in (-1.0, 1.0)]
    slope = (gaps[1] - gaps[0]) / (2.0 * step)
    force = integrate_pair(zone, Pose(), Pose(centre=centre), 5.0, opposite).force[0]
    # Away from the axis the roller's own normal differs from the bore's by x/r − x/R < 0.075.
    np.testing.assert_allclose(slope, force, rtol=0.01)


def test_flank_gap_is_that_of_the_profile():
    """At the contact point the gap along the normal is distance minus pin radius, on the real flank."""
    drive = load_drive("paper").cases["CS-1"]
    shapes = DriveShapes.of_drive(drive)
    profile = shapes.disc.flank.profile
    theta = np.array([0.9])
    point, normal = profile.flank(theta), profile.normal(theta)
    disc = mesh_disc(shapes.disc, [Refinement(point[0].real, point[0].imag, 0.02, 0.3)])
    zone = PressureZone.on_boundary(disc, shapes.disc.flank, complex(point[0]), 0.3, thickness=1.0)
    centre = complex(point[0] + (6.5 + 0.004) * normal[0])
    integrals = integrate_pair(zone, Pose(), Pose(centre=centre), 6.5, None)
    mean = integrals.gap / integrals.measure
    # Mean over an edge of 0.02 mm near the closest point: 4 µm plus x²/2R of at most 0.03 µm.
    assert mean.min() == pytest.approx(0.004, abs=3e-5)
    assert integrals.opposite_loads.size == 0
