"""The first screen of ``cyclo run``: what decides, then loads, pressures, error, backlash, stiffness and life, at 80 columns."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.commands.actions.run_table import lives_told, run_table
from ltca.commands.program import main
from ltca.drive.members.judgement import Value
from ltca.drive.members.verdict_words import with_unit
from ltca.drive.units.quantities import ARCMIN
from ltca.geometry.placement import position_angles
from ltca.page.derived import derived_rows
from ltca.page.tables import number
from ltca.quantities import printed, scalar_named
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

HEADINGS = (
    "largest load", "parts that carry at once", "largest pressure", "transmission error", "backlash", "stiffness", "life",
)  # fmt: skip


def solved(drive, name="nominal", positions=9):
    analysis = analyse(drive, position_angles(positions))
    return {name: analysis}, {name: summarise(analysis)}, {name: bearing_lives(analysis)}


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-1"]


@pytest.fixture(scope="module")
def answers(paper):
    return solved(paper)


def side_by_side(answers, count):
    """The table of as many equal cases."""
    return run_table(*({f"CS-{n + 1}": part["nominal"] for n in range(count)} for part in answers), {}).splitlines()


def test_what_decides_comes_first_and_files_last(tmp_path, capsys):
    assert main(["run", "paper", "--case", "CS-1", "--positions", "9", "--no-page", "--out", str(tmp_path / "o")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1].startswith("verdict")
    assert re.match(r"  CS-1  pass  flank pressure 1[34]\d\d MPa \(≤ 1500 MPa\), safety 1\.0\d$", lines[2])
    # How far half-spaces are off, and which way, stood in the last lines without a direction.
    assert lines[3].startswith(
        "  half-spaces: about 34 % too stiff here (measured on the shipped drive paper, case CS-1, "
    )
    found = [next(place for place, line in enumerate(lines) if line.startswith(heading)) for heading in HEADINGS]
    assert found == sorted(found)
    assert found[0] > 2
    assert lines[-1].startswith("results: ")


def test_six_cases_fit_eighty_columns(monkeypatch, answers):
    """The table had 129."""
    monkeypatch.delenv("COLUMNS", raising=False)
    table = side_by_side(answers, 6)
    assert table[0].split() == [f"CS-{number}" for number in range(1, 7)]
    assert max(map(len, table)) <= 80
    (flank,) = (line for line in table if line.startswith("  flank "))
    told = answers[1]["nominal"]["refined_max_pin_pressure_mid_MPa"]
    assert flank.split()[1:] == 6 * [f"{told:.1f}"]


def test_cases_that_find_no_room_go_on_below(monkeypatch, answers):
    monkeypatch.setenv("COLUMNS", "60")
    table = side_by_side(answers, 5)
    heads = [line for line in table if "CS-" in line]
    assert len(heads) > 1
    assert " ".join(heads).split() == [f"CS-{number}" for number in range(1, 6)]
    assert max(map(len, table)) <= 60


@pytest.mark.slow
def test_a_drive_without_shaft_pins_has_no_row_of_them():
    """Seven rows of dashes."""
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    analysis = analyse(drive, position_angles(1))
    table = run_table({"rv": analysis}, {"rv": summarise(analysis)}, {"rv": "one position"}, {})
    assert "shaft pin" not in table
    assert "hole" not in table
    for crank in range(3):
        assert f"  crank bearing, crank {crank}" in table
        assert f"  crank {crank} " in table


@pytest.mark.slow
@pytest.mark.usefixtures("positions_alone")
def test_loose_and_bent_pins_have_rows_of_their_own():
    drive = parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"]
    analyses, summaries, lives = solved(drive, positions=2)
    rows = {line[:26].strip(): line[26:].strip() for line in run_table(analyses, summaries, lives, {}).splitlines()}
    assert {"wheel-pin seat", "shaft-pin sleeve", "disc 0", "disc 1"} <= set(rows)
    assert rows["wheel-pin seat"] == f"{summaries['nominal']['max_pin_seat_pressure_MPa']:.1f}"


def test_stiffness_is_that_of_the_largest_wind_up(paper, answers):
    """By hand from the transmission errors at both torques, N·m by minute of arc."""
    analyses, summaries, lives = answers
    analysis = analyses["nominal"]
    wound = np.degrees(np.abs(analysis.transmission_error - analysis.transmission_error_light)).max() * 60.0
    by_hand = (paper.load.torque - paper.load.light_torque) / 1e3 / wound
    (row,) = (line for line in run_table(analyses, summaries, lives, {}).splitlines() if "from light torque" in line)
    assert float(row.split()[-1]) == pytest.approx(by_hand, abs=0.005)  # half a digit


def test_pressures_of_rollers_stand_on_both_races(paper):
    """A plastic bore failed at 76 MPa beside a row that said 638, that of the steel race."""
    soft = replace(paper.materials.disc, youngs_modulus=2000.0)
    drive = replace(
        paper, materials=replace(paper.materials, disc=soft), load=replace(paper.load, torque=2e4, light_torque=1e3)
    )
    analyses, summaries, lives = solved(drive, positions=2)
    rows = {line[:26].strip(): line[26:].strip() for line in run_table(analyses, summaries, lives, {}).splitlines()}
    assert float(rows["roller in the bore"]) == pytest.approx(analyses["nominal"].pressures.outer.mid.max(), abs=0.05)
    assert float(rows["roller in the bore"]) < 0.5 * float(rows["roller on inner race"])


@pytest.mark.slow
def test_lives_that_are_not_rated_say_why(paper):
    plastic = replace(paper.materials.disc, youngs_modulus=2000.0)
    drive = replace(
        paper, materials=replace(paper.materials, disc=plastic), load=replace(paper.load, torque=2e4, light_torque=1e3)
    )
    _, _, lives = solved(drive, positions=9)
    (told,) = lives_told(lives)
    assert "no bearing steel" in told
    assert lives_told({"one": "positions cover no whole turns", "two": "positions cover no whole turns"}) == [
        "no life of the crank bearings: positions cover no whole turns"
    ]


def test_nothing_is_printed_as_nothing():
    """A play without clearances was −1.16e-11′, a change −0 %; what a residual is stays."""
    assert printed(-1.16e-11, "{:.5g}", "arcmin") == "0"
    assert printed(-1e-12, "{:.4f}", "mm") == "0.0000"
    assert printed(-0.2, "{:+.0f}", "%") == "0"
    assert printed(3.2e-9, "{:.2g}", "N") == "3.2e-09"
    play = Value(quantity="backlash_output", value=-1.16e-11)
    assert with_unit(play.value, play, 5) == "0′"
    assert number(-1.16e-11, "{:.2f}", "arcmin").text == "0.00′"


def test_a_drive_without_offsets_had_plays_of_minus_nothing(paper):
    """`cyclo show` printed "-0.0000 … 0.0000 mm" and "0.00′ (-0.00′ … 0.00′)"."""
    plain = paper.with_fields({"disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0})
    rows = dict(derived_rows(plain, plain))
    assert rows["gap between pins and flank, nominal position"] == "0.0000 … 0.0000 mm"
    assert rows["flank: backlash at the disc, wheel held"] == "0.00′ (0.00′ … 0.00′)"
    assert not [value for value in rows.values() if re.search(r"-0\.0*(?!\d)", value)]


def test_the_stiffness_of_a_small_drive_had_two_digits(answers):
    """0.27 and 0.25 N·m/′ of a drive of 1 N·m; larger ones have two decimals as before."""
    _, summaries, lives = answers
    (case,) = summaries.values()
    key = scalar_named("cycloid_stage_stiffness").key
    for sizes, texts in {
        (0.27123, 0.25): ["0.271", "0.250"], (0.0123456,): ["0.0123"], (5.3619, 61.5): ["5.36", "61.50"], (0.0,): ["0.00"],
    }.items():  # fmt: skip
        some = {f"{size}": {**case, key: size * ARCMIN * 1e3} for size in sizes}
        table = run_table(dict.fromkeys(some, answers[0]["nominal"]), some, dict.fromkeys(some, lives["nominal"]), {})
        (row,) = (line for line in table.splitlines() if "from light torque" in line)
        assert row.split()[-len(texts) :] == texts


@pytest.mark.slow
def test_long_names_leave_the_numbers_of_studies_under_their_heads(tmp_path, monkeypatch, capsys):
    """The names of pressures anywhere are longer than the columns were: numbers began 8 places further to the right."""
    monkeypatch.chdir(tmp_path)
    name = "max_pin_pressure_max"
    text = shipped_drive("paper").replace("[limits]", f"[limits]\n{name} = 5000", 1)
    (tmp_path / "own.toml").write_text(text if "[limits]" in text else f"{text}\n[limits]\n{name} = 5000\n", "utf-8")
    few = ["--samples", "2", "--positions", "2", "--quick", "--no-figures", "--no-page"]
    assert main(["tolerance", "own.toml", *few, "--quantities", name, "max_pin_load"]) == 0
    lines = capsys.readouterr().out.splitlines()
    first = next(number for number, line in enumerate(lines) if line.split()[:2] == ["nominal", "mean"])
    heads = [match.end() for match in re.finditer(r"nominal|mean|[0-9]+ %|largest", lines[first])]
    for line in lines[first + 1 : first + 3]:
        numbers = [match.end() for match in re.finditer(r"\S+", line)][-7:-1]
        assert numbers == heads, line
    shares = [line for line in lines if "≤" in line]
    assert shares
    assert all(re.search(r"  [0-9.]+ % \(", line) for line in shares)
