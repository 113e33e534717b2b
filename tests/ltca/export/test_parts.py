"""What parts hold: bodies, frames, clearances, compensation; and what cannot be exported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from ltca.errors import DriveError
from ltca.export.flank_outline import FlankSpline
from ltca.export.parts import make_parts
from ltca.reading.changes import with_fields


def circles(part, feature):
    bodies = [circle for body in part.bodies for circle in (body.outer, *body.inner)]
    every = [circle for circle in bodies if not isinstance(circle, FlankSpline)] + [wall.circle for wall in part.walls]
    return [circle for circle in every if circle.feature == feature]


def features(part):
    return {circle.feature: len(circles(part, circle.feature)) for body in part.bodies for circle in
            [*body.inner, *([] if isinstance(body.outer, FlankSpline) else [body.outer])]} | (
        {"slot": len(part.walls)} if part.walls else {}
    )  # fmt: skip


def test_bores_and_holes_of_a_disc(kinds_of_drives):
    """Clearance is diametral in the bearing and whole in the hole; errors of diameters count by half."""
    (part,) = make_parts(kinds_of_drives["plastic"], "nominal")
    assert part.name == "disc"
    assert features(part) == {"bore": 1, "hole": 8}
    assert circles(part, "bore")[0].radius == pytest.approx(29.5 + 0.5 * 0.03)
    assert circles(part, "bore")[0].centre == 0.0
    holes = circles(part, "hole")
    assert [hole.radius for hole in holes] == pytest.approx([14.075 + 0.05 + 0.01] * 8)
    assert holes[0].centre == pytest.approx(56.01)
    assert holes[2].centre == pytest.approx(56.0j)
    assert (part.bodies[0].bottom, part.bodies[0].top) == (0.0, 11.8)


def test_runout_and_deviation_are_in_the_flank(kinds_of_drives):
    """A root of the design lies at R_C + ΔR_C − e − r_P − Δr_P on +x; runout moves it, metal that is left lifts it."""
    (part,) = make_parts(kinds_of_drives["plastic"], "nominal")
    root = 88.09 - 4.0 - 6.65 + (0.004 - 0.002 + 0.0005) + 0.01 * np.exp(0.7j)
    assert part.bodies[0].outer.points[0] == pytest.approx(root, abs=1e-12)


def test_each_disc_has_its_phase(kinds_of_drives):
    """Holes stay, the flank is turned by −ζ/z_C: disc 1 of two has a root there."""
    parts = make_parts(kinds_of_drives["robot-joint"], "nominal")
    assert [part.name for part in parts] == ["disc_0", "disc_1"]
    roots = [part.bodies[0].outer.points[0] for part in parts]
    assert np.angle(roots[0]) == pytest.approx(0.0, abs=1e-12)
    assert np.angle(roots[1]) == pytest.approx(-np.pi / 39, abs=1e-12)
    for part in parts:
        assert np.angle(circles(part, "hole")[0].centre) == pytest.approx(0.0, abs=1e-12)
    (alone,) = make_parts(kinds_of_drives["robot-joint"], "nominal", disc=1)
    assert alone.name == "disc_1"
    assert "-0.0805536578 rad" in alone.frame


def test_bores_of_several_cranks(kinds_of_drives):
    part = make_parts(kinds_of_drives["rv"], "nominal", disc=0)[0]
    assert features(part) == {"bore": 3}
    assert np.sum([bore.centre for bore in circles(part, "bore")]) == pytest.approx(0.0, abs=1e-12)
    assert abs(circles(part, "bore")[1].centre) == pytest.approx(42.0)


def test_slots_and_sleeves(kinds_of_drives):
    drive = kinds_of_drives["sleeved"]
    (wheel,) = make_parts(drive, "nominal", "pin-wheel")
    assert features(wheel) == {"pin": 30, "slot": 30}
    assert circles(wheel, "slot")[0].radius == 3.51
    assert (wheel.bodies[0].bottom, wheel.bodies[0].top) == (0.0, 26.0)  # between the walls of the wheel
    (shaft,) = make_parts(drive, "nominal", "pin-shaft")
    assert features(shaft) == {"shaft-pin": 10, "shaft-sleeve": 10, "shaft-sleeve-bore": 10}
    radii = [circles(shaft, name)[3].radius for name in ("shaft-pin", "shaft-sleeve-bore", "shaft-sleeve")]
    assert radii == [4.5, 4.51, 6.0]
    sleeve = shaft.bodies[1]
    assert (sleeve.bottom, sleeve.top) == pytest.approx((1.0, 23.0))  # along the discs, pins from −12 to 12


@pytest.mark.parametrize("kind", ["paper", "rv", "robot-joint", "sleeved"])
def test_the_assembly_meshes(kinds_of_drives, kind):
    """At φ_C = 0 the root of disc 0 and pin 0 lie on +x, the gap between them is Δr_P − ΔR_C of the design."""
    drive = kinds_of_drives[kind]
    (part,) = make_parts(drive, "nominal", "assembly")
    discs = [body for body in part.bodies if isinstance(body.outer, FlankSpline)]
    assert len(discs) == drive.disc.number_of_discs
    pins = circles(part, "pin")
    for number, disc in enumerate(discs):
        phase, plane = drive.disc.disc_phases[number], drive.disc.disc_planes[number]
        assert disc.outer.centre == pytest.approx(drive.crank.eccentricity * np.exp(1j * phase), abs=1e-12)
        assert (disc.bottom + disc.top) / 2 == pytest.approx(plane)
        gaps = [np.min(np.abs(disc.outer.points - pin.centre)) - pin.radius for pin in pins]
        # Roots are points of the spline: exact there. Everywhere else parts stay clear as well.
        towards = round(phase / (2 * np.pi) * len(pins))
        assert gaps[towards] == pytest.approx(drive.disc.equidistant_offset - drive.disc.shifting_offset, abs=1e-9)
        assert min(gaps) > 0.0
        # The disc's share of each hole stays clear of its pin.
        shaft = circles(part, "shaft-sleeve") or circles(part, "shaft-pin")
        for hole, pin in zip([c for c in disc.inner if c.feature == "hole"], shaft, strict=True):
            assert abs(hole.centre - pin.centre) <= hole.radius - pin.radius + 1e-9  # CS-1 has no play
        bores = [c for c in disc.inner if c.feature == "bore"]
        assert len(bores) == drive.crank.number
    assert len(circles(part, "roller")) == drive.crank_bearing.number_of_rollers * len(circles(part, "inner-race"))


def test_compensation_moves_faces_into_the_material(kinds_of_drives):
    drive = kinds_of_drives["paper"]
    (plain,), (moved,) = make_parts(drive, "CS-1"), make_parts(drive, "CS-1", compensation=0.1)
    theta = np.linspace(0.0, 6.0, 40)
    away = moved.bodies[0].outer.flank.points(theta) - plain.bodies[0].outer.flank.points(theta)
    assert away == pytest.approx(-0.1 * plain.bodies[0].outer.flank.normals(theta), abs=1e-12)
    for before, after in zip(plain.bodies[0].inner, moved.bodies[0].inner, strict=True):
        assert after.radius - before.radius == pytest.approx(0.1)
        assert after.centre == before.centre
    assert moved.stem == "paper_CS-1_disc_compensated_0.1mm"
    assert "moved into the material by 0.1 mm (outlines shrink, bores and holes grow" in moved.remarks[-1]
    (grown,) = make_parts(drive, "CS-1", compensation=-0.1)
    assert "moved out of the material by 0.1 mm (outlines grow, bores and holes shrink" in grown.remarks[-1]
    assert grown.bodies[0].inner[0].radius == pytest.approx(29.4)
    (shaft,) = make_parts(kinds_of_drives["sleeved"], "nominal", "pin-shaft", compensation=0.05)
    radii = [circles(shaft, name)[0].radius for name in ("shaft-pin", "shaft-sleeve-bore", "shaft-sleeve")]
    assert radii == pytest.approx([4.45, 4.56, 5.95])
    (wheel,) = make_parts(kinds_of_drives["sleeved"], "nominal", "pin-wheel", compensation=0.05)
    assert circles(wheel, "slot")[0].radius == pytest.approx(3.56)


def test_parts_are_made_at_20_degrees(kinds_of_drives):
    cold = kinds_of_drives["paper"]
    warm = with_fields(cold, {"temperature.disc": 80.0, "materials.disc.thermal_expansion": 1.2e-5})
    assert warm.temperature is not None
    assert make_parts(warm, "CS-1")[0].bodies[0].inner == make_parts(cold, "CS-1")[0].bodies[0].inner


@pytest.mark.parametrize(
    ("kind", "part", "arguments", "told"),
    [
        ("rv", "pin-shaft", {}, "--part pin-shaft: there is no pin_shaft in this drive"),
        ("paper", "disc", {"disc": 1}, "--disc 1: there is no such disc; disc.number_of_discs = 1, counted from 0"),
        ("paper", "pin-wheel", {"disc": 0}, "--disc 0: is for --part disc, not for pin-wheel"),
        ("paper", "assembly", {"compensation": 0.1}, "--compensate: is for parts that are made one by one"),
        ("many", "disc", {"compensation": 0.9}, "--compensate 0.9 mm: must be less than … convex radius of the flank"),
        ("many", "disc", {"compensation": -0.9}, "--compensate -0.9 mm: must be less than … concave radius"),
        ("sleeved", "pin-shaft", {"compensation": 0.8}, "--compensate 0.8 mm: nothing is left of shaft sleeve 0"),
    ],
)  # fmt: skip
def test_what_cannot_be_exported_is_refused_by_name(kinds_of_drives, kind, part, arguments, told):
    with error_says(DriveError, *told.split("…")):
        make_parts(kinds_of_drives[kind], "nominal", part, **arguments)


def test_holes_that_compensation_lets_cut_into_each_other(kinds_of_drives):
    drive = kinds_of_drives["paper"]
    # On a circle of 40 mm neighbours stand 80 sin 22.5° = 30.615 mm apart: holes of 15.4 mm overlap by 0.185 mm.
    shaft = replace(drive.pin_shaft, pin_circle_radius=40.0, hole_radius=14.4)
    wide = replace(drive, pin_shaft=shaft, crank_bearing=replace(drive.crank_bearing, outer_race_radius=20.0))
    assert make_parts(wide, "CS-1")
    with error_says(DriveError, "--compensate 1 mm: hole ", " and hole ", " cut into each other by 0.1853 mm"):
        make_parts(wide, "CS-1", compensation=1.0)


def test_names_of_files_fit(kinds_of_drives):
    long = replace(kinds_of_drives["paper"], name="ä" * 60)
    (part,) = make_parts(long, "b" * 120, compensation=-0.125)
    assert len(f"{part.stem}_flank.csv".encode()) < 255


CARRIER = {
    "carrier.flange": (10.0, 8.0), "carrier.posts.number": 3, "carrier.posts.radius": 42.0, "carrier.posts.size": 14.0,
}  # fmt: skip


def test_flanges_stand_on_their_posts(kinds_of_drives):
    """Holes where cranks and pins go through; posts between two cranks; the assembly has them at the discs' planes."""
    drive = with_fields(kinds_of_drives["rv"], CARRIER)
    (part,) = make_parts(drive, "nominal", "carrier")
    assert features(part) == {"post": 3, "flange": 2, "flange-hole": 6}
    heights = {body.name: (body.bottom, body.top) for body in part.bodies}
    assert heights["near flange"] == pytest.approx((0.0, 10.0))
    assert heights["post 1"] == pytest.approx((10.0, 40.0))  # the stack of the discs
    assert heights["far flange"] == pytest.approx((40.0, 48.0))
    posts = np.array([post.centre for post in circles(part, "post")])
    assert np.abs(posts) == pytest.approx(42.0)
    for hole in circles(part, "flange-hole"):
        assert hole.radius == 10.0  # of the shaft in its bearings
        assert abs(hole.centre) == pytest.approx(42.0)
        assert np.min(np.abs(posts - hole.centre)) == pytest.approx(42.0)  # a sixth of a turn aside
    (whole,) = make_parts(drive, "nominal", "assembly")
    (far,) = (body for body in whole.bodies if body.name == "far flange")
    assert (far.bottom, far.top) == (15.0, 23.0)
    sleeved = with_fields(kinds_of_drives["sleeved"], CARRIER)
    (part,) = make_parts(sleeved, "nominal", "carrier", compensation=0.1)
    assert features(part) == {"post": 3, "flange": 2, "flange-hole": 22}
    assert {hole.radius for hole in circles(part, "flange-hole") if abs(hole.centre) > 1.0} == {4.6}
    with error_says(DriveError, "--part carrier: there is no carrier.posts in this drive"):
        make_parts(kinds_of_drives["paper"], "CS-1", "carrier")


def test_inclined_pins_stand_where_they_are_at_the_zero_of_the_planes(kinds_of_drives):
    """They stood where they are in the plane of the first disc, 0.09 mm beside the middle, and nothing was said of it."""
    upright = with_fields(kinds_of_drives["robot-joint"], {"contact.slices": 3})
    inclined = with_fields(upright, {"pin_wheel.inclination.x": 8e-3})
    for kind in ("pin-wheel", "assembly"):
        (one,), (other,) = (make_parts(drive, "nominal", kind) for drive in (upright, inclined))
        expected = [circle.centre for circle in circles(one, "pin")]
        assert [circle.centre for circle in circles(other, "pin")] == pytest.approx(expected, abs=1e-12)
        assert "pin_wheel.inclination" in " ".join(other.remarks)
        assert "inclined" not in " ".join(one.remarks)
