"""Shapes of the bodies: the flank as envelope of the pins, normals, areas and places against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from fem.errors import MeshError
from fem.mesh.triangulation import mesh_disc
from fem.shapes import CircleCurve, CircleShape, DiscShape, DriveShapes, RingShape
from ltca.drive.deviations import BoreErrors, OneDisc
from ltca.drive.parts import Drive, PlacementErrors
from ltca.drive.single_discs import single_discs
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive


@pytest.fixture(scope="module")
def drive() -> Drive:
    return load_drive("paper").cases["CS-3"]


@pytest.fixture(scope="module")
def shapes(drive: Drive) -> DriveShapes:
    return DriveShapes.of_drive(drive)


@pytest.fixture(scope="module")
def reducer() -> Drive:
    """The first disc of the reducer with three cranks."""
    return single_discs(parse_drive(shipped_drive("rv"), "rv").cases["nominal"])[0]


def test_flank_is_the_envelope_of_the_generating_pins(drive: Drive, shapes: DriveShapes) -> None:
    """No generating pin cuts into the flank, and each flank point is touched by one (independent motion)."""
    wheel, e, disc = drive.pin_wheel, drive.crank.eccentricity, drive.disc
    radius = wheel.pin_circle_radius + disc.shifting_offset
    offset = wheel.pin_radius + disc.equidistant_offset
    # Motion written anew: disc centre on the crank, wheel turning u times slower, pin centres seen from the disc.
    crank = np.linspace(0.0, 2.0 * np.pi, 20000, endpoint=False)
    pins = 2.0 * np.pi * np.arange(wheel.number_of_pins)[:, None] / wheel.number_of_pins
    centres = radius * np.exp(1j * (crank / wheel.number_of_pins + pins)) - e * np.exp(1j * crank)
    for theta in np.linspace(0.0, 2.0 * np.pi, 57):
        nearest = np.abs(centres - shapes.disc.flank.points(np.array(theta))).min()
        # The step of 3e-4 rad moves a centre by 4e-3 mm at most: (2e-3)²/(2·6.65) = 3e-7 mm beside the minimum.
        assert nearest == pytest.approx(offset, abs=1e-6)


def test_flank_normals_and_curvature_match_finite_differences(shapes: DriveShapes) -> None:
    flank = shapes.disc.flank
    theta, step = np.linspace(0.0, 2.0 * np.pi, 400), 1e-5
    ahead, here, behind = (flank.points(theta + k * step) for k in (1, 0, -1))
    tangent = (ahead - behind) / (2.0 * step)
    np.testing.assert_allclose(flank.normals(theta), -1j * tangent / np.abs(tangent), atol=1e-8)
    second = (ahead - 2.0 * here + behind) / step**2
    curvature = np.abs((tangent.conjugate() * second).imag) / np.abs(tangent) ** 3
    # Second differences of points of 88 mm at a step of 1e-5 carry 2e-14/1e-10 = 2e-4 of round-off.
    np.testing.assert_allclose(1.0 / flank.curvature_radius(theta), curvature, atol=1e-6)


def test_normals_point_out_of_the_body(shapes: DriveShapes) -> None:
    disc = shapes.disc
    theta = np.linspace(0.0, 2.0 * np.pi, 200)
    step = 1e-3

    def material(points: np.ndarray) -> np.ndarray:
        inside = np.abs(points) < disc.flank.profile.root_radius
        near = points[~inside]
        inside[~inside] = disc.flank.profile.distance(near, disc.flank.parameter_of(near)) < 0.0
        inside &= np.abs(points) > disc.bores[0].radius
        for hole in disc.holes:
            inside &= np.abs(points - hole.centre) > hole.radius
        return inside

    for curve in (disc.flank, *disc.holes):
        points, normals = curve.points(theta), curve.normals(theta)
        assert not material(points + step * normals).any()
        assert material(points - step * normals).all()
    points, normals = disc.bores[0].points(theta), disc.bores[0].normals(theta)
    assert np.all(np.abs(points + step * normals) < disc.bores[0].radius)


def test_disc_area_matches_a_fine_polygon(shapes: DriveShapes) -> None:
    theta = np.linspace(0.0, 2.0 * np.pi, 400_001)
    points = shapes.disc.flank.points(theta)
    polygon = 0.5 * np.sum((points[:-1].conjugate() * points[1:]).imag)
    circles = np.pi * (shapes.disc.bores[0].radius ** 2 + sum(hole.radius**2 for hole in shapes.disc.holes))
    # A polygon of 4e5 sides of 1.4e-3 mm lacks about perimeter · h²/(12 ρ) = 3e-5 mm².
    assert shapes.disc.area == pytest.approx(polygon - circles, abs=1e-4)


def test_area_of_a_circle_about_its_core() -> None:
    assert CircleShape(name="pin_0", radius=3.0, core_radius=1.0).area == pytest.approx(8.0 * np.pi, rel=1e-14)
    assert CircleShape(name="pin_0", radius=3.0).area == pytest.approx(9.0 * np.pi, rel=1e-14)


def test_parameter_of_inverts_points(shapes: DriveShapes) -> None:
    theta = np.linspace(0.001, 6.28, 997)
    for curve in (*shapes.disc.curves, *shapes.inner_race.curves):
        np.testing.assert_allclose(curve.parameter_of(curve.points(theta)), theta, atol=1e-9)


def test_clearances_and_errors_enter_the_shapes(drive: Drive) -> None:
    errors = PlacementErrors(radial=(0.02, *[0.0] * 7), tangential=(0.03, *[0.0] * 7), diameter=(0.04, *[0.0] * 7))
    clearance = replace(drive.clearance, bearing=0.03, pin_hole=0.01)
    changed = replace(drive, clearance=clearance, disc=replace(drive.disc, hole_errors=errors))
    disc = DiscShape.of_drive(changed)
    assert disc.bores[0].radius == pytest.approx(29.5 + 0.015, abs=1e-12)  # the clearance is diametral
    assert disc.holes[0].centre == pytest.approx(56.02 + 0.03j, abs=1e-12)
    assert disc.holes[0].radius == pytest.approx(14.075 + 0.01 + 0.02, abs=1e-12)
    assert disc.holes[3].radius == pytest.approx(14.075 + 0.01, abs=1e-12)


def test_default_core_and_race_bore_shrink_with_the_part(drive: Drive) -> None:
    assert DriveShapes.of_drive(drive).wheel_pins[0].core_radius == 2.0
    assert DriveShapes.of_drive(drive).inner_race.inner_radius == 10.0
    small = replace(
        drive,
        pin_wheel=replace(drive.pin_wheel, pin_radius=3.0),
        crank_bearing=replace(drive.crank_bearing, inner_race_radius=8.0, outer_race_radius=18.0),
    )
    assert DriveShapes.of_drive(small).wheel_pins[0].core_radius == pytest.approx(1.0)
    assert DriveShapes.of_drive(small).inner_race.inner_radius == pytest.approx(4.8)


def test_core_and_race_bore_of_the_drive_are_those_of_the_bodies(drive: Drive) -> None:
    changed = with_fields(drive, {"pin_wheel.core_radius": 3.5, "crank_bearing.race_bore_radius": 15.0})
    shapes = DriveShapes.of_drive(changed)
    assert {pin.core_radius for pin in shapes.wheel_pins} == {3.5}
    assert shapes.inner_race.inner_radius == 15.0


def test_discs_with_profile_errors_are_told_apart(drive: Drive) -> None:
    """A flank with deviations could not be hashed: full finite elements of it ended in a TypeError."""
    waves = {
        "disc.profile_errors.orders": (2,),
        "disc.profile_errors.cosine": (0.001,),
        "disc.profile_errors.sine": (0.0,),
    }
    first, again = (DiscShape.of_drive(with_fields(drive, waves)) for _ in range(2))
    other = DiscShape.of_drive(with_fields(drive, waves | {"disc.profile_errors.cosine": (0.002,)}))
    assert first == again
    assert hash(first) == hash(again)
    assert len({first, other, DiscShape.of_drive(drive)}) == 3


def test_a_single_small_pin_does_not_change_the_core_of_all(drive: Drive) -> None:
    """Coefficients are of nominal pins: with the core of the smallest one full finite elements had another support."""
    small = with_fields(
        drive,
        {
            "pin_wheel.pin_radius": 5.7,
            "disc.equidistant_offset": 0.0,
            "pin_wheel.pin_errors.diameter": (-0.05, *[0.0] * (drive.pin_wheel.number_of_pins - 1)),
        },
        check=False,
    )
    assert DriveShapes.of_drive(small).wheel_pins[0].core_radius == pytest.approx(5.7 / 3.0)


def test_coefficients_of_the_default_supports_keep_their_shape(drive: Drive) -> None:
    """Files from before the fields serve drives that leave them out, or give the defaults."""
    given = with_fields(drive, {"pin_wheel.core_radius": 2.0, "crank_bearing.race_bore_radius": 10.0})
    assert given.body_shape() == drive.body_shape()
    assert not {"pin_wheel.core_radius", "crank_bearing.race_bore_radius"} & drive.body_shape().keys()


def test_narrowest_wall_of_the_disc(shapes: DriveShapes) -> None:
    # Between root circle and hole: (88.09 − 4 − 6.65) − (56 + 14.075).
    assert shapes.disc.narrowest_wall == pytest.approx(77.44 - 70.075, abs=1e-9)


def test_a_disc_of_one_crank_has_one_bore_by_its_old_name(shapes: DriveShapes) -> None:
    assert [curve.name for curve in shapes.disc.curves] == ["flank", "bore", *(f"hole_{k}" for k in range(8))]
    assert shapes.disc.bores[0].centre == 0j


def test_a_disc_of_several_cranks_has_a_bore_for_each(reducer: Drive) -> None:
    errors = BoreErrors(radial=(0.003, 0.0, 0.0), tangential=(0.0, 0.002, 0.0))
    shape = DiscShape.of_drive(replace(reducer, disc=replace(reducer.disc, of=(OneDisc(bore_errors=errors),))))
    assert [curve.name for curve in shape.curves] == ["flank", "bore_0", "bore_1", "bore_2"]
    turn = np.exp(2j * np.pi / 3.0)
    centres = np.array([42.003, (42.0 + 0.002j) * turn, 42.0 * turn**2])
    np.testing.assert_allclose([bore.centre for bore in shape.bores], centres, atol=1e-12)
    assert [bore.radius for bore in shape.bores] == pytest.approx([18.004] * 3, abs=1e-12)


def test_walls_and_area_of_a_disc_with_several_bores(reducer: Drive) -> None:
    shape = DiscShape.of_drive(reducer)
    # Between root circle, 80.005 − 1.25 − 3.02, and bore; bores stand √3·42 apart, 36.7 mm of wall.
    assert shape.narrowest_wall == pytest.approx(75.735 - 42.0 - 18.004, abs=1e-9)
    theta = np.linspace(0.0, 2.0 * np.pi, 400_001)
    points = shape.flank.points(theta)
    polygon = 0.5 * np.sum((points[:-1].conjugate() * points[1:]).imag)
    # As for the paper's disc: perimeter · h²/(12 ρ), with lobes three times as tight.
    assert shape.area == pytest.approx(polygon - 3.0 * np.pi * 18.004**2, abs=3e-4)


def test_a_disc_with_several_bores_is_meshed(reducer: Drive) -> None:
    shape = DiscShape.of_drive(reducer)
    body = mesh_disc(shape, coarse_size=8.0)
    assert set(body.mesh.boundaries) == {curve.name for curve in shape.curves}
    for bore in shape.bores:
        x, y = body.mesh.doflocs[:, np.unique(body.boundary_nodes(bore.name))]
        np.testing.assert_allclose(np.abs(x + 1j * y - bore.centre), bore.radius, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: CircleShape(name="pin_0", radius=6.5, core_radius=6.5), "core radius 6.5 mm of pin_0"),
        (lambda: CircleShape(name="pin_0", radius=6.5, core_radius=-1.0), "core radius -1 mm of pin_0"),
        (lambda: RingShape(inner_radius=20.0, outer_radius=19.5), "inner radius 20 mm of inner_race"),
    ],
)
def test_shapes_without_material_are_refused(make, message: str) -> None:
    with error_says(MeshError, message):
        make()


def test_circle_curve_closed_forms() -> None:
    circle = CircleCurve(name="hole", radius=2.0, centre=1.0 + 1.0j, encloses_body=False)
    assert circle.points(np.array(0.5 * np.pi)) == pytest.approx(1.0 + 3.0j)
    assert circle.normals(np.array(0.0)) == pytest.approx(-1.0)
