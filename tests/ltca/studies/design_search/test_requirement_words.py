"""What a newcomer's requirements leave open or say in another unit is told before the search, and in what it writes."""

from pathlib import Path

import pytest
from refusals import refused_field

from ltca.drive.unit_mistakes import materials_of_bodies
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive
from ltca.reading.writing import drive_text
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.refinement import Refined
from ltca.studies.design_search.requirement_file import load_requirements, parse_requirements
from ltca.studies.design_search.requirement_words import assumed_words, requirement_warnings
from ltca.studies.design_search.requirements import REQUIRED
from ltca.studies.design_search.search import Relaxation
from ltca.studies.design_search.sizes import drive_of
from ltca.studies.design_search.solution import Solution

EXAMPLES = sorted((Path(__file__).parents[4] / "examples" / "requirements").glob("*.toml"))
JOINT = """
ratio = 59
torque = "200 N m"
speed = "34 rpm"
outer_diameter = "130 mm"
length = "45 mm"
discs = 2
"""
ROW = {
    "discs": 2.0, "pins": 60.0, "stage": 1.0, "sun": 0.0, "planet": 0.0, "eccentricity": 0.65, "pin_circle": 51.208,
    "pin_radius": 1.25, "thickness": 7.373, "bore": 17.841, "roller_radius": 2.5, "roller_length": 5.0, "rollers": 12.0,
    "holes": 12.0, "hole_circle": 34.379, "hole_pin": 6.0, "equidistant_offset": 0.01, "shifting_offset": 0.0,
    "bearing_clearance": 0.005, "pin_hole_clearance": 0.005, "lead_crown_drop": 0.0, "torque": 200_000.0,
}  # fmt: skip
"""Sizes of a found joint, but for a bore from which binary fractions leave 12.841000000000001."""


def test_requirements_without_materials_were_judged_by_nothing():
    """Designs of generic steel had 2034 MPa at the flank, "0 failed", and no density for a simulator."""
    requirements = parse_requirements(JOINT)
    demands = {(one.quantity, one.kind): one.value for one in find_demands(requirements)}
    assert demands["pin_pressure_mid", "material"] == 1500.0  # ISO 281:2007, fatigue load limit
    assert assumed_words(requirements).endswith("100Cr6 for disc, wheel_pin, roller, inner_race, shaft_pin")
    for held in (
        "",
        '[carrier]\nposts = { number = 6, size = "6 mm" }\n[ring]\n',
        "[shop]\ncrank_support_stiffness = 1e5\n",
    ):
        kind = 'kind = "rv"\n' if "crank" in held else ""
        drive = drive_of(
            {**ROW, "stage": 1.5, "hole_circle": 28.0} if kind else ROW, parse_requirements(kind + JOINT + held)
        )
        assert all(body.density and body.allowable_pressure for body in materials_of_bodies(drive).values())


def test_a_named_material_stays():
    requirements = parse_requirements(JOINT + '[materials]\ndisc = "PA12"\n')
    assert requirements.materials.disc.youngs_modulus == 1600.0
    assert "disc" not in assumed_words(requirements).replace("discs", "")


def test_a_material_by_numbers_alone_says_that_the_flank_is_not_judged():
    text = JOINT + "[materials]\ndisc = { youngs_modulus = 206000.0 }\n"
    (told,) = requirement_warnings(parse_requirements(text))
    assert told.startswith("the flank is not judged: materials.disc has no allowable_pressure")
    assert 'disc = "100Cr6"' in told
    assert requirement_warnings(parse_requirements(text + "[limits]\nmax_pin_pressure_mid = 1200.0\n")) == []


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_sound_requirements_are_not_asked_about(path):
    assert requirement_warnings(load_requirements(path)) == []


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"torque": "200"}, 'torque = 200 N·mm is 0.2 N·m, .* by the pressure of its flank); did you mean "200 N m"?'),
        ({"torque": '"200 kN m"'}, 'mean "200 N m", or a larger room?'),
        ({"speed": "2000"}, "the input would turn at 118,000 rpm. Is speed that of the output? .* write speed = 33.9"),
        (
            {"outer_diameter": '"13 m"'},
            "outer_diameter = 13000 mm is 13 m, larger than any drive that is built, beside length = 45 mm",
        ),
        ({"length": '"45 m"'}, 'mean "45 mm" or an outer diameter of "130 m"?'),
        ({"length": "0.045"}, 'did you mean "0.045 m"?'),
    ],
)
def test_numbers_in_another_unit_went_to_the_search_without_a_word(changed, told):
    lines = [line for line in JOINT.splitlines() if line.partition(" ")[0] not in changed]
    lines += [f"{key} = {value}" for key, value in changed.items()]
    (found,) = requirement_warnings(parse_requirements("\n".join(lines)))
    first, _, last = told.partition(" .* ")
    assert first in found
    assert last in found


def test_a_missing_key_says_what_it_means():
    """ "speed: is missing" left open of which shaft, and in what unit."""
    with pytest.raises(DriveError) as caught:
        parse_requirements("discs = 2")
    assert [told.partition(":")[0] for told in caught.value.problems] == list(REQUIRED)
    assert 'speed of the output (not of the motor), in rpm or as a text with its unit: speed = "30 rpm"' in str(
        caught.value
    )
    # Examples are values as the file takes them.
    asked = parse_requirements("\n".join(told.rpartition(": ")[2] for told in REQUIRED.values())).asked
    assert (asked.ratio, asked.torque, asked.length) == (59.0, 200_000.0, 40.0)


@pytest.mark.parametrize("ratio", ["59", '"1:59"', '"59 : 1"'])
def test_a_ratio_may_be_written_with_a_colon(ratio):
    assert parse_requirements(JOINT.replace("59", ratio, 1)).asked.ratio == 59.0


def test_a_held_housing_says_which_member_that_is():
    with refused_field("held", "= 'housing'", "a housing with the wheel pins in it is 'pin-wheel'"):
        parse_requirements(JOINT + 'held = "housing"\n')


def test_a_written_drive_has_its_own_parts_and_round_numbers():
    """Materials of a crankshaft, slots and sleeves that it has not, ``gap = 0.0`` beside planes, 12.841000000000001."""
    drive = drive_of(ROW, parse_requirements(JOINT))
    text = drive_text(drive)
    assert parse_drive(text).cases["nominal"] == drive
    tables = {line[11:-1] for line in text.splitlines() if line.startswith("[materials.")}
    assert tables == {"disc", "wheel_pin", "roller", "inner_race", "shaft_pin"}
    assert "inner_race_radius = 12.841\n" in text
    assert "\ngap = 1.0\n" in text
    assert drive.disc.disc_planes == pytest.approx((-4.1865, 4.1865), rel=1e-12)
    for line in text.splitlines():
        name, _, value = line.partition(" = ")
        assert len(value.partition(".")[2]) <= 12 or value[0] in "[{\"'", (name, value)


def test_hours_that_are_not_reached_say_at_which_speed_they_are():
    """At a speed of the input for the output nothing said that the speed stands in the way. Hours are turns by speed."""
    demands = find_demands(parse_requirements(JOINT + 'life = "6000 h"\n'))
    life = tuple(one for one in demands if one.name == "life")
    refined = Refined(
        row=ROW, solution=Solution(values={"bearing_life_hours": 1500.0}), fits=True, given=1.4, broken={}, relaxed=("life",),
        solved=1, shifts={},
    )  # fmt: skip
    told = Relaxation(demands=life, refined=refined, combinations=1, broken=0.0, speed=34.0).words
    assert told.endswith("would do, as would 8.5 rpm at the output")
