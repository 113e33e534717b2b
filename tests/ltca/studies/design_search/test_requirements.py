"""A requirement file: what is wrong is told once, with field, value, bound and unit."""

import tomllib
from pathlib import Path

import pytest
from refusals import error_says, refused_field

from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.drive_file import shipped_drive
from ltca.studies.design_search.requirement_file import load_requirements, parse_requirements

EXAMPLES = sorted((Path(__file__).parents[4] / "examples" / "requirements").glob("*.toml"))
ROWS = tomllib.loads(Path(__file__).with_name("refused_requirements.toml").read_text(encoding="utf-8"))["refused"]
SOUND = """
ratio = 39
torque = "400 N m"
speed = "15 rpm"
outer_diameter = "140 mm"
length = 32.0
"""


def test_there_are_six_possible_and_four_impossible_ones():
    assert [sum(path.stem.startswith(kind) for path in EXAMPLES) for kind in ("possible", "impossible")] == [6, 4]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_read(path):
    assert load_requirements(path).asked.torque > 0.0


def test_texts_carry_units():
    asked = parse_requirements(SOUND).asked
    assert (asked.torque, asked.speed, asked.outer_diameter) == (400_000.0, 15.0, 140.0)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["changed"][:48])
def test_one_clear_sentence_for_each_mistake(row):
    changed = row["changed"]
    key = changed.partition("=")[0].strip()
    text = "\n".join(line for line in SOUND.splitlines() if not line.startswith(f"{key} ")) + "\n" + changed
    with pytest.raises(DriveError) as caught:
        parse_requirements(text)
    assert len(caught.value.problems) == 1
    assert row["message"] in str(caught.value)


def test_missing_field_and_its_misspelling_are_one_mistake():
    with error_says(DriveError, "did you mean `outer_diameter`, which is missing"):
        parse_requirements(SOUND.replace("outer_diameter", "outer_diametre"))


def test_own_sizes_stand_before_the_typical_ones():
    stock = parse_requirements(SOUND + "[shop]\neccentricities = [1.1]\n").stock
    assert stock.eccentricities == (1.1,)
    assert len(stock.rollers) > 10


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (SOUND + "cranks = 3\n", "cranks = 3: has no effect"),
        (SOUND.replace("140 mm", "8 mm"), "shop.housing_wall = 4 mm: must be less"),
    ],
)
def test_what_has_no_effect_or_leaves_no_room_is_refused(text, told):
    """A number of cranks was ignored with discs on one; walls of 80 mm in 55 were searched."""
    with pytest.raises(DriveError) as error:
        parse_requirements(text)
    assert told in str(error.value)


def test_an_rv_reducer_has_two_discs_where_nothing_is_said():
    """`kind = "rv"` alone was refused for the one disc that `discs` has by default."""
    asked = parse_requirements(SOUND + 'kind = "rv"\n').asked
    assert asked.numbers_of_discs == (2,)
    assert parse_requirements(SOUND).asked.numbers_of_discs == (1, 2)
    with refused_field("shop.pin_hole_clearance", "", "must be left out"):
        parse_requirements(SOUND + 'kind = "rv"\n[shop]\npin_hole_clearance = 0.01\n')


def test_a_number_is_held_and_a_range_is_searched():
    shop = parse_requirements(
        SOUND + '[shop]\nequidistant_offset = ["8 µm", 0.03]\nbearing_clearance = "5 µm"\n'
    ).asked.shop
    assert shop.range_of("equidistant_offset") == pytest.approx((0.008, 0.03), rel=1e-12)
    assert shop.range_of("bearing_clearance") == (0.005, 0.005)
    assert shop.tightest["equidistant_offset"] == pytest.approx(0.008, rel=1e-12)


def test_a_crown_is_searched_with_slices_alone():
    """Left out it is a variable with slices and none in the plane; a number is held, as clearances are."""
    assert parse_requirements(SOUND).asked.lead_crowns == (0.0, 0.0)
    assert parse_requirements(SOUND + "[contact]\nslices = 5\n").asked.lead_crowns == (0.0, 0.02)
    held = parse_requirements(SOUND + '[contact]\nslices = 5\n[shop]\nlead_crown_drop = "4 µm"\n').asked
    assert held.lead_crowns == pytest.approx((0.004, 0.004), rel=1e-12)
    assert held.starting["lead_crown_drop"] == pytest.approx(0.004, rel=1e-12)


@pytest.mark.parametrize(
    ("command", "kind", "told"),
    [
        ("design", "drive", "is a drive file, which cyclo show, check and run take; must be a requirement file"),
        ("design", "study", "is a study file, which cyclo sweep takes; must be a requirement file"),
        ("sweep", "drive", "is a drive file, which cyclo show, check and run take; must be a study file"),
        ("sweep", "requirements", "is a requirement file, which cyclo design takes; must be a study file"),
        ("show", "requirements", "is a requirement file, which cyclo design takes; must be a drive file"),
        ("check", "study", "is a study file, which cyclo sweep takes; must be a drive file"),
    ],
)
def test_a_file_of_another_kind_had_ten_mistakes(command, kind, told, tmp_path, capsys):
    """`cyclo design` of a drive file told of 18 mistakes, and not that the file is a drive."""
    text = {
        "drive": shipped_drive("paper"),
        "study": 'drive = "paper"\n[factors]\n"load.torque" = ["300 N m", "310 N m"]\n',
        "requirements": 'ratio = 29\ntorque = "200 N m"\nspeed = "30 rpm"\nouter_diameter = "130 mm"\nlength = "40 mm"\n',
    }
    path = tmp_path / "file.toml"
    path.write_text(text[kind], encoding="utf-8")
    assert main([command, str(path)]) == 2
    assert capsys.readouterr().err == f"cyclo: error: {path}: {told}\n"
