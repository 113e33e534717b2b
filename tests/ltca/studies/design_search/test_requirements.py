"""A requirement file: what is wrong is told once, with field, value, bound and unit."""

from pathlib import Path

import pytest

from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.drive_file import shipped_drive
from ltca.studies.design_search.requirement_file import load_requirements, parse_requirements

EXAMPLES = sorted((Path(__file__).parents[4] / "examples" / "requirements").glob("*.toml"))
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


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ('torque = "400 N"', "torque = '400 N': must have the unit N·mm"),
        ("length = -3.0", "length = -3.0: must be greater than 0 mm"),
        ("ratio = 39.5", "ratio = 39.5: must be a whole number"),
        ('kind = "rw"', "kind = 'rw': must be 'discs' or 'rv'"),
        ("[shop]\nequidistant_offset = [0.02, 0.01]", "shop.equidistant_offset = [0.02, 0.01]: must be a range"),
        ("[shop]\nbearing_clearance = [0.0, 0.01]", "shop.bearing_clearance = [0, 0.01]: must start at 0.001 mm"),
        ("[shop]\nbearing_clearance = -0.01", "shop.bearing_clearance = -0.01: must be at least 0 mm"),
        ("[shop]\nrollers = [[8.0, 30.0]]", "shop.rollers.0 = [8, 30]: length by diameter must be from 0.8 to 2.5"),
        ("[shop]\nrollers = [[4.0, 50.0]]", "shop.rollers.0 = [4, 50]: length by diameter must be from 0.8 to 10"),
        ("discs = 4", "discs.0 = 4: must be less than or equal to 3"),
        ("outer_diametre = 3.0", "outer_diametre: is not a field of such a table; did you mean `outer_diameter`?"),
        ("efficiency = 0.9", "efficiency = 0.9: nothing rubs; give [friction] its coefficients"),
        ("[shop]\nleast_wal = 2.0", "shop.least_wal: is not a field of such a table; did you mean `least_wall`?"),
        ("[shop]\nwheel_pins = [-1.0]", "shop.wheel_pins.0 = -1.0: must be greater than 0 mm"),
        ('[shop]\nstock = "nowhere.toml"', "shop.stock: no such file"),
        ('[materials]\ndisk = "PLA"', "materials.disk: is not a part"),
        (
            'life = 100.0\n[materials]\ndisc = "PLA"',
            "life = 100 h: cannot be rated with materials.disc.youngs_modulus = 3039",
        ),
        ("[ring]\ninner_radius = 60.0", "ring.inner_radius: must be left out of requirements: the ring follows"),
        (
            "[ring]\nbolts = { number = 2, stiffness = 1e6 }",
            "ring.bolts.number = 2: must be greater than or equal to 3",
        ),
        ('[ring]\nflange = "one-side"', 'ring.flange = "one-side": must be "free" or "built-in"'),
        ("[ring]\nwidth = 33.0", "ring.width = 33 mm: must be at most length = 32 mm"),
        ("[ring]\n[shop]\nhousing_wall = 0.0", "shop.housing_wall = 0 mm: must be greater than 0 beside [ring]"),
        ("[carrier]\nflange = [8.0, 8.0]", "carrier.flange = [8, 8] mm: must be left out without carrier.posts"),
        ("[main_bearing]\nradial_stifness = 1e6", "did you mean `radial_stiffness`?"),
        ("[first_stage]\nbacklash = 0.01", 'first_stage: must be left out with kind = "discs"'),
        ("[load]\ntorque = 3.0", "load.torque: must be left out of requirements: the key torque says it"),
        ("[[load.external]]\nforce = { r = 3.0 }", "load.external.0.force.r: is not a field of such a table"),
        ('[materials]\ncarrier = "100Cr6"', "materials.carrier: must be left out without carrier.posts"),
        (
            '[shop]\nlead_crown_drop = "4 µm"',
            "contact.slices = 1: must be odd, 3 to 65, with shop.lead_crown_drop = 0.004 mm: nothing varies",
        ),
        ("[shop]\nlead_crown_drop = [0.0, 0.01]", "with shop.lead_crown_drop = [0, 0.01] mm: nothing varies"),
        (
            "[contact]\nslices = 5\n[shop]\nlead_crown_drop = -0.01",
            "shop.lead_crown_drop = -0.01: must be at least 0 mm",
        ),
        ("[contact]\nslices = 8", "contact.slices = 8: must be odd, 1 for the plane model or 3 to 65"),
        ("[contact]\nslice = 5", "contact.slice: is not a field of such a table; did you mean `slices`?"),
        (
            "[limits]\nmax_disc_tilt = 1e-3",
            "limits.max_disc_tilt: nothing tilts in the plane model (contact.slices = 1)",
        ),
        (
            "[contact]\nslices = 5\n[limits]\nmax_axial_play_taken = 1.0",
            "limits.max_axial_play_taken: designs have no disc.axial_play",
        ),
        ("[limits]\nmax_pin_pressur = 3.0", "did you mean `max_pin_pressure_mid`?"),
    ],
)
def test_one_clear_sentence_for_each_mistake(changed, told):
    key = changed.partition("=")[0].strip()
    text = "\n".join(line for line in SOUND.splitlines() if not line.startswith(f"{key} ")) + "\n" + changed
    with pytest.raises(DriveError) as caught:
        parse_requirements(text)
    assert len(caught.value.problems) == 1
    assert told in str(caught.value)


def test_missing_field_and_its_misspelling_are_one_mistake():
    with pytest.raises(DriveError, match="did you mean `outer_diameter`, which is missing"):
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
    with pytest.raises(DriveError, match=r"shop\.pin_hole_clearance: must be left out"):
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
