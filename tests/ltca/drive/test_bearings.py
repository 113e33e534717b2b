"""Bought bearings: their data against catalogues and the laws of rating, names, refusals, contradictions."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from refusals import error_says

import ltca
from ltca.analysis.life.ratings import RollerBearing
from ltca.analysis.loaded_analysis import analyse
from ltca.drive.declaration import find_fields
from ltca.drive.members.bearings import CLASSES, clearance_range, designation_of, named_bearing, named_bearings
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.studies.optimiser import parse_variable
from ltca.studies.sweep_file import load_sweep

DOCUMENT = Path(ltca.__file__).parents[1] / "docs" / "reference" / "bearings.md"
BEARINGS = named_bearings()
EXPLORER = "SKF Explorer"


def rated(bearing):
    return RollerBearing(
        rollers=bearing.number_of_rollers,
        roller_diameter=bearing.roller_diameter,
        roller_length=bearing.roller_length,
        pitch_diameter=bearing.pitch_diameter,
    )


def drive(bearing, more="", clearance="", case=""):
    """The drive of a robot joint with thicker discs and a bought bearing."""
    text = re.sub(
        r"\[crank_bearing\]\n(.+\n)*", f'[crank_bearing]\nbearing = "{bearing}"\n{more}\n', shipped_drive("robot-joint")
    )
    text = text.replace("thickness = 10.0", "thickness = 14.0").replace("planes = [-5.5, 5.5]", "planes = [-8.0, 8.0]")
    text = re.sub(r"\nbearing = 0.005.*", f"\n{clearance}", text)
    return parse_drive(f"{text}\n{case}\n").cases


def mistakes(*arguments, **named):
    with pytest.raises(DriveError) as caught:
        drive(*arguments, **named)
    return caught.value.problems


# Figures of the catalogues: NBS needle bearings, pages 40 and 44; SKF general catalogue 6000, pages 522 to 525.
@pytest.mark.parametrize(
    ("name", "inner", "outer", "dynamic", "static"),
    [
        ("K20x26x12", 20.0, 26.0, 13_100.0, 15_700.0),
        ("K55x63x25", 55.0, 63.0, 49_500.0, 99_500.0),
        ("RN205", 31.5, 46.5, 28_600.0, 27_000.0),
        ("RN306", 40.5, 62.5, 58_500.0, 48_000.0),
    ],
)
def test_figures_are_those_of_the_catalogue(name, inner, outer, dynamic, static):
    found = BEARINGS[name]
    assert (found.inner_race_diameter, found.outer_race_diameter) == (inner, outer)
    assert (found.dynamic_load_rating, found.static_load_rating) == (dynamic, static)


@pytest.mark.parametrize("name", BEARINGS)
def test_rollers_fit_and_give_the_ratings_of_the_maker(name):
    found = BEARINGS[name]
    assert not found.problems()
    assert found.inner_race_diameter + 2.0 * found.roller_diameter == pytest.approx(found.outer_race_diameter)
    assert 0.45 < found.fill <= 0.86
    assert found.source
    assert rated(found).static_load_rating == pytest.approx(found.static_load_rating, rel=0.02)
    ratio = rated(found).dynamic_load_rating / found.dynamic_load_rating
    # The maker's factor of SKF Explorer bearings raises C by a seventh.
    assert (0.85 < ratio < 0.89) if EXPLORER in found.source else (0.99 < ratio < 1.06)
    if found.series == "K":
        sizes = re.fullmatch(r"K(\d+)x(\d+)x(\d+)", name).groups()
        assert [float(size) for size in sizes] == [found.inner_race_diameter, found.outer_race_diameter, found.width]


def test_a_published_number_of_rollers_follows_from_the_static_rating():
    """NU 330: 14 rollers by its defect frequencies (f_o = Z f_c: 93.4 Hz, 6.67 Hz), C_0 = 965 kN, F = 193 mm, E = 283 mm."""
    length = 965e3 / (44.0 * (1.0 - 45.0 / 238.0) * 14 * 45.0)
    assert 0.92 * 45.0 < length < 0.98 * 45.0  # a roller of 45 x 45 mm less its rounded ends
    bearing = RollerBearing(rollers=14, roller_diameter=45.0, roller_length=length, pitch_diameter=238.0)
    assert bearing.dynamic_load_rating == pytest.approx(900e3 / 1.15, rel=0.02)


@pytest.mark.parametrize(
    "name", ["HK2020", "BK2020", "N 205", "NU206", "NJ 2205 ECP", "6205", "6205-2RS", "NA4905", "30205"]
)
def test_bearings_that_bring_an_outer_ring_are_refused_with_the_reason(name):
    with pytest.raises(DriveError, match="needle cage"):
        named_bearing(name)


def test_unknown_names_are_answered_by_the_nearest():
    with pytest.raises(DriveError, match="K30x37x18"):
        named_bearing("K30x37x17")
    with pytest.raises(DriveError, match="RN205"):
        named_bearing("RN2005")
    assert named_bearing("rn 205") is BEARINGS["RN205"]
    assert named_bearing("K 20×26×12") is BEARINGS["K20x26x12"]


def test_clearance_classes_are_those_of_the_standard():
    """ISO 5753-1, cylindrical roller bearings, bores over 40 to 50 mm."""
    found = [clearance_range(BEARINGS["RN210"], name) for name in CLASSES]
    expected = [(5, 35), (30, 60), (50, 80), (70, 100), (95, 125)]
    assert [tuple(1e3 * end for end in each) for each in found] == [pytest.approx(each) for each in expected]


def test_a_drive_with_a_bought_bearing_is_that_with_its_numbers():
    bought = drive("K30x37x18", 'clearance_class = "CN"')["nominal"]
    part = bought.crank_bearing
    assert (part.inner_race_radius, part.outer_race_radius, part.roller_radius) == (15.0, 18.5, 1.75)
    assert bought.clearance.bearing == pytest.approx(0.0325)
    assert bought.clearance.pin_hole == 0.005
    assert analyse(bought, [0.0]) is not None


def test_what_contradicts_the_name_is_refused_by_its_field():
    (problem,) = mistakes("K30x37x18", "roller_radius = 2.0")
    assert problem.startswith("crank_bearing.roller_radius = 2.0: must be left out, or 1.75")
    (problem,) = mistakes("K30x37x18", 'clearance_class = "C3"', "bearing = 0.005")
    assert problem.startswith("clearance.bearing = 0.005: must be left out, or 0.0475 mm")
    (problem,) = mistakes("HK3020")
    assert problem.startswith("crank_bearing.bearing = 'HK3020': is a drawn cup needle bearing")
    (problem,) = mistakes("K30x37x18", 'clearance_class = "C9"')
    assert "must be C2, CN, C3, C4 or C5" in problem
    assert drive("K30x37x18", 'roller_radius = "1750 µm"')


def test_cases_take_another_bearing_or_class():
    cases = '[[case]]\nname = "a"\ncrank_bearing.clearance_class = "C5"\n[[case]]\nname = "b"\ncrank_bearing.bearing = "RN204"'
    found = drive("K30x37x18", 'clearance_class = "C3"', case=cases)
    assert found["a"].clearance.bearing == pytest.approx(0.0825)
    assert found["b"].crank_bearing.inner_race_radius == 13.25
    assert found["b"].clearance.bearing == pytest.approx(0.0475)


def test_own_bearings_are_checked():
    table = '[bearings."MY 30"]\ninner_race_diameter = 30\nouter_race_diameter = "40 mm"\n'
    table += "roller_length = {}\nnumber_of_rollers = {}"
    assert drive("MY 30", case=table.format(10, 17))["nominal"].crank_bearing.roller_radius == 2.5
    found = mistakes("MY 30", case=table.format(70, 37))
    assert any("number_of_rollers = 37: must be at most 21" in problem for problem in found)
    assert any("roller_length = 70 mm" in problem for problem in found)


def test_the_fields_are_found():
    assert "crank_bearing.bearing" in {field.path for field in find_fields("bearing")}
    assert find_fields("clearance_class")
    assert {field.table for field in find_fields("bearings")} == {"bearings.NAME"}


def test_the_makers_ratings_come_with_the_name():
    part = drive("K30x37x18")["nominal"].crank_bearing
    assert (part.dynamic_load_rating, part.static_load_rating) == (25_500.0, 38_000.0)
    assert designation_of(part) == "K30x37x18"
    (problem,) = mistakes("K30x37x18", 'dynamic_load_rating = "30 kN"')
    assert "must be left out, or 25500" in problem


def test_ratings_of_another_bearing_do_not_stay():
    """The case names a bearing of its own without ratings: those of the common part are not its."""
    own = "[bearings.MY]\ninner_race_diameter = 30\nouter_race_diameter = 40\nroller_length = 10\nnumber_of_rollers = 15\n"
    found = drive("K30x37x18", case=f'{own}[[case]]\nname = "a"\ncrank_bearing.bearing = "MY"')["a"].crank_bearing
    assert (found.outer_race_radius, found.dynamic_load_rating, found.static_load_rating) == (20.0, None, None)


def test_a_case_cannot_change_a_size_of_a_named_bearing():
    """It replaced the length in silence, and the name said another."""
    (problem,) = mistakes("K30x37x18", case='[[case]]\nname = "a"\ncrank_bearing.roller_length = 10.0')
    assert problem.startswith("case a: crank_bearing.roller_length = 10.0: must be left out, or 13.8")


@pytest.mark.slow
def test_messages_on_sizes_that_nobody_wrote_name_the_bearing():
    with pytest.raises(DriveError) as caught:
        drive("K30x40x30")
    (problem,) = caught.value.problems
    assert problem.startswith('crank_bearing.roller_length = 27.8 mm (of bearing "K30x40x30"): must be at most 14 mm')


def test_studies_take_names_and_refuse_sizes_of_rated_bearings():
    bought = drive("K30x37x18")["nominal"]
    other = with_fields(bought, {"crank_bearing.bearing": "K28x33x17"})
    assert designation_of(other.crank_bearing) == "K28x33x17"
    with pytest.raises(DriveError, match="needle cage"):
        with_fields(bought, {"crank_bearing.bearing": "HK3020"})
    with pytest.raises(DriveError, match="stands for other fields in a drive file"):
        with_fields(bought, {"crank_bearing.clearance_class": "C3"})
    with pytest.raises(DriveError, match="cannot vary, the ratings of K30x37x18"):
        parse_variable("roller_length=9:10", bought)


def test_sweeps_take_names_and_refuse_sizes_of_rated_bearings(tmp_path):
    text = drive_text(drive("K30x37x18")["nominal"])
    (tmp_path / "drive.toml").write_text(text, encoding="utf-8")
    path = tmp_path / "study.toml"
    study = 'drive = "drive.toml"\npositions = 2\n[factors]\n'
    path.write_text(f'{study}"crank_bearing.bearing" = ["K30x37x18", "K28x33x17"]', encoding="utf-8")
    found = load_sweep(path)
    assert [designation_of(found.sample_drive(number).crank_bearing) for number in range(2)] == [
        "K30x37x18",
        "K28x33x17",
    ]
    path.write_text(f"{study}crank_bearing.roller_length = [9.0, 10.0]", encoding="utf-8")
    with pytest.raises(DriveError, match="cannot vary, the ratings of K30x37x18"):
        load_sweep(path)


def test_the_document_shows_the_data():
    text = DOCUMENT.read_text(encoding="utf-8")
    for name, entry in BEARINGS.items():
        row = f"| `{name}` | {entry.inner_race_diameter:g} | {entry.outer_race_diameter:g} | {entry.width:g} | "
        row += (
            f"{entry.dynamic_load_rating / 1e3:g} | {entry.static_load_rating / 1e3:g} | {entry.number_of_rollers} | "
        )
        assert row + f"{entry.roller_length:g} |" in text


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("RN 206 ECP", "RN206"), ("RN206-E-TVP2", "RN206"), ("RN206E.TVP2", "RN206"), ("SKF RN206 ECM", "RN206"),
        ("K 18 × 24 × 20", "K18x24x20"), ("k18*24*20", "K18x24x20"), ("K18-24-20", "K18x24x20"),
        ("K18X24X20-TV", "K18x24x20"), ("INA K 18,0x24x20 TN", "K18x24x20"),
    ],
)  # fmt: skip
def test_ways_of_writing_a_name_and_its_cage_do_not_matter(written, meant):
    """A catalogue's own name, ``RN 206 ECP``, was not known."""
    assert named_bearing(written) is named_bearings()[meant]


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("K18x24x13", r"the nearest are K18x24x20, "),  # the races first
        ("RN1006", r"the nearest are RN206, RN306, "),  # a bore of 30 mm
        ("RN206ECP/C3", r'holds a class of clearance; write bearing = "RN206", clearance_class = "C3"'),
        ("K18x24x20ZW", r"is not known by name; the nearest are K18x24x20, "),  # two rows
        ("xyz", r"is not known by name; take a needle cage"),
        ("SKF NU 206 ECP", r"is a cylindrical roller bearing with its own outer ring"),
    ],
)
def test_names_that_are_none_lead_to_near_ones(written, told):
    with error_says(DriveError, told):
        named_bearing(written)


SOUND = "inner_race_diameter = 30.0\nouter_race_diameter = 40.0\nnumber_of_rollers = 17\nroller_length = 8.0\n"


@pytest.mark.parametrize(
    ("entry", "told"),
    [
        (SOUND.replace("inner_race_diameter = 30.0\n", ""), "inner_race_diameter: is missing"),
        (SOUND + "C0 = 3\n", "C0: is not a field of such a table; did you mean `static_load_rating`?"),
        (SOUND + "roller_diameter = 5.0\n", "roller_diameter: is not a field of such a table; half the difference of"),
        (
            SOUND + 'clearance_class = "C3"\n',
            "clearance_class: is not a field of such a table; it stands beside the name",
        ),
        (SOUND + "bore = 35.0\n", "bore = 35 mm: must be less than inner_race_diameter = 30 mm"),
        (SOUND.replace("17", "60"), "number_of_rollers = 60: must be at most 21"),
    ],
)
def test_an_own_entry_with_a_mistake_is_not_unknown_besides(entry, told):
    """It was, and the message asked to give the numbers in the very table that held them."""
    text = re.sub(
        r"(?ms)^\[crank_bearing\].*?(?=^\[)", '[crank_bearing]\nbearing = "MY 30"\n\n', shipped_drive("robot-joint")
    )
    with pytest.raises(DriveError) as caught:
        parse_drive(f'{text}\n[bearings."MY 30"]\n{entry}', "own")
    (problem,) = caught.value.problems
    assert problem.startswith("bearings.MY 30." + told)
