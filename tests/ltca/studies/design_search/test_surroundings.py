"""Ring, carrier, main bearing, first stage and forces from outside of drives that are searched."""

import csv
import math
from functools import cache

import numpy as np
import pytest
from refusals import refused_field

from ltca.commands.program import main
from ltca.studies.design_search.closed_forms import Setting, shape_values
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.sizes import Sizes, drive_of
from ltca.studies.design_search.solution import solve_coarsely
from ltca.studies.design_search.surroundings import inner_radius, seat_depth

RV = """
kind = "rv"
discs = 2
ratio = 81
torque = "412 N m"
speed = "15 rpm"
outer_diameter = "180 mm"
length = "40 mm"
stiffness = "30 N·m/arcmin"
[shop]
crank_support_stiffness = 4.0e5
housing_wall = 15.0
flanges = 6.0
[materials]
disc = "100Cr6"
wheel_pin = "100Cr6"
roller = "100Cr6"
inner_race = "100Cr6"
"""
SURROUNDED = """
[ring]
material = "42CrMo4"
bolts = { number = 12, stiffness = "1000 N/µm" }
[carrier]
stiffness_torsion = "300 N·m/arcmin"
flange = [8.0, 8.0]
posts = { number = 6, size = 18.0 }
[main_bearing]
radial_stiffness = "500 N/µm"
preload = "2 kN"
[first_stage]
mesh_stiffness = 2e5
plane = 25.0
backlash = "30 µm"
[[load.external]]
force = { x = "1.5 kN" }
at = { z = 60.0 }
"""
ROW = {
    "discs": 2.0, "pins": 56.0, "stage": 10.0 / 7.0, "sun": 14.0, "planet": 20.0, "eccentricity": 0.65, "pin_circle": 55.0,
    "pin_radius": 2.0, "thickness": 8.0, "bore": 22.5, "roller_radius": 3.5, "roller_length": 7.0, "rollers": 14.0,
    "holes": 0.0, "hole_circle": 27.5, "hole_pin": 1.0, "equidistant_offset": 0.01, "shifting_offset": 0.0,
    "bearing_clearance": 0.005, "pin_hole_clearance": 0.0, "lead_crown_drop": 0.0, "torque": 412e3,
}  # fmt: skip


def test_what_is_left_out_follows_the_sizes_that_are_searched():
    """The ring is the wall of 15 mm outside of pins of 2 mm on 55 mm, and as wide as two discs of 8, their gap and 6 mm."""
    requirements = parse_requirements(RV + SURROUNDED)
    drive = drive_of(ROW, requirements)
    ring, posts = drive.ring, drive.carrier.posts
    assert (ring.inner_radius, ring.outer_radius, ring.width) == (55.0, 72.0, 23.0)
    assert ring.bolts.circle_radius == 64.5
    assert 2.0 * ring.outer_radius == shape_values(Sizes.of_rows([ROW]), Setting.of(requirements))["outer_diameter"]
    assert (posts.radius, posts.size, posts.number) == (27.5, 18.0, 6)
    assert (drive.first_stage.sun_teeth, drive.first_stage.planet_teeth, drive.first_stage.backlash) == (14, 20, 0.03)
    assert drive.installation.first_stage_ratio is None
    assert (drive.main_bearing.preload.force, drive.load.external[0].force.x) == (2000.0, 1500.0)


def test_seats_lead_their_pins_and_leave_room_for_teeth():
    """A disc reaches 2e beyond R − r; the wall of a seat ends 45° from the radius at the least depth, by the law of cosines."""
    corner = math.hypot(50.0 + 2.0 * math.cos(0.25 * math.pi), 2.0 * math.sin(0.25 * math.pi))
    assert seat_depth(50.0, 2.0, 0.5) == pytest.approx(corner - 50.0, rel=1e-12)
    assert inner_radius(50.0, 2.0, 0.5) == 50.0
    assert inner_radius(50.0, 2.0, 1.2) == pytest.approx(50.0 - 2.0 + 2.4 + 0.2, rel=1e-12)
    ringed, plain = (find_demands(parse_requirements(text)) for text in (RV + SURROUNDED, RV))
    assert [one.name for one in ringed if one.name == "ring_seat"] == ["ring_seat"]
    assert not [one for one in plain if one.name == "ring_seat"]


def test_planets_need_their_place():
    with refused_field("first_stage.plane", "", "must be given with shop.crank_support_stiffness, in mm"):
        parse_requirements(RV + "[first_stage]\nbacklash = 0.03\n")


@cache
def solved(text):
    requirements = parse_requirements(text)
    solution = solve_coarsely(ROW, requirements, find_demands(requirements))
    assert not solution.message
    return solution.values


@pytest.mark.slow
def test_candidates_are_solved_with_all_of_it():
    """Every part that yields makes the output softer; play/r_w of the planets adds to the backlash by their ratio."""
    stage = RV + "[first_stage]\nbacklash = 0.03\nplane = 25.0\n"
    reached = {name: solved(text) for name, text in (("plain", RV), ("stage", stage), ("all", RV + SURROUNDED))}
    assert reached["all"]["stiffness"] < 0.8 * reached["plain"]["stiffness"]
    pitch_radius = 27.5 * 20.0 / 34.0
    i = 1.0 + 56.0 * 20.0 / 14.0  # turns of the sun for one of the output, housing held
    play = 0.03 / pitch_radius * (20.0 / 14.0) / i * 180.0 * 60.0 / np.pi
    more = reached["stage"]["backlash_output"] - reached["plain"]["backlash_output"]
    # Both are the largest of the same few positions.
    assert more == pytest.approx(play, rel=1e-6)


@pytest.mark.slow
def test_candidates_have_a_beam_where_finite_elements_are_asked_for():
    """A ring of finite elements is derived for each shape; those of a search are many."""
    text = RV + SURROUNDED.replace("[ring]", '[ring]\nmodel = "fe"')
    assert drive_of(ROW, parse_requirements(text)).ring.model == "fe"
    assert solved(text) == solved(RV + SURROUNDED)


@pytest.mark.slow
@pytest.mark.nightly
def test_a_design_with_all_of_it_passes_the_check(tmp_path, capsys):
    (tmp_path / "asked.toml").write_text(RV + SURROUNDED, encoding="utf-8")
    out = tmp_path / "found"
    assert main(["design", str(tmp_path / "asked.toml"), "--quick", "--best", "1", "--out", str(out)]) == 0
    with (out / "designs.csv").open(encoding="utf-8") as stream:
        assert any("stiffness" in row[0] for row in csv.reader(stream) if row)
    assert main(["check", str(out / "design-1.toml"), "--out", str(tmp_path / "check")]) == 0
    assert "0 failed" in capsys.readouterr().out
