"""A light torque that the file leaves out follows the torque as it is written, and nothing that replaces the torque later."""

from __future__ import annotations

import json
import pickle
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.life.bearing_lives import at_entry
from ltca.analysis.light_torque import at_light_torque, light_torque_lines
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.verdict.values import notes
from ltca.commands.program import main
from ltca.drive.declaration import declared_fields
from ltca.drive.parts import Load
from ltca.drive.unit_mistakes import likely_unit_mistakes, unit_warnings
from ltca.errors import DriveError
from ltca.page.derived import derived_rows
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.studio.answers import CACHED, COARSE, Memory, Question, answer

ANGLE = np.array([0.3])
STATED = "light_torque = 10000.0 "
PAPER = shipped_drive("paper").split("[[case]]")[0]
LEFT_OUT = re.sub(r"\n(?=torque = )", "\n# ", PAPER).replace(STATED, 'torque = "200 N m" ')
"""The paper's drive for 200 N·m, in a file that says nothing of a light torque."""

DUTY = {"torque": 5e3, "speed": 10.0, "share": 1.0}


@pytest.fixture(scope="module")
def drive():
    return parse_drive(LEFT_OUT).cases["nominal"]


def test_a_light_torque_left_out_was_ten_newton_metres_for_every_drive(drive):
    """1 N·m had ten times its torque for a light one; 3 % of 200 N·m are 6 N·m."""
    assert PAPER.count(STATED) == 1
    assert drive.load.light_torque == pytest.approx(6000.0, rel=1e-12)
    stated = parse_drive(LEFT_OUT.replace("[load]\n", '[load]\nlight_torque = "6 N m"\n')).cases["nominal"]
    assert at_light_torque(analyse(drive, ANGLE)).transmission_error == pytest.approx(
        at_light_torque(analyse(stated, ANGLE)).transmission_error, rel=1e-9
    )


def test_every_case_has_three_percent_of_its_own_torque():
    cases = '[[case]]\nname = "a"\n[[case]]\nname = "b"\nload = { torque = "2 N m" }\n'
    cases += (
        '[[case]]\nname = "c"\nload = { light_torque = "0.5 N m" }\n[[case]]\nname = "d"\nload = { speed = 100.0 }\n'
    )
    loads = {name: each.load.light_torque for name, each in parse_drive(f"{LEFT_OUT}\n{cases}").cases.items()}
    assert loads == pytest.approx({"a": 6000.0, "b": 60.0, "c": 500.0, "d": 6000.0}, rel=1e-12)
    stated = parse_drive(f"{PAPER}\n{cases}").cases  # that of the file is that of a case that says nothing
    assert stated["b"].load.light_torque == 10_000.0


@pytest.mark.parametrize(
    "changed",
    [
        lambda drive: drive.with_fields({"load.torque": "5 N m"}),
        lambda drive: drive.with_fields({"load": {"torque": 0.0}}),
        lambda drive: replace(drive, load=replace(drive.load, torque=5e3)),
        lambda drive: (
            pickle.loads(pickle.dumps(drive)).with_fields({"load.torque": 5e3}).with_fields({"load.torque": 2.0})
        ),
        lambda drive: analyse(drive, ANGLE, 2e3).drive,
        lambda drive: at_entry(analyse(drive.with_fields({f"duty.0.{k}": v for k, v in DUTY.items()}), ANGLE), 0).drive,
    ],
    ids=["study", "no torque", "replace", "another process, twice", "--torque", "duty"],
)
def test_a_torque_that_is_changed_later_moves_no_light_torque(changed, drive):
    load = changed(drive).load
    assert load.light_torque == pytest.approx(6000.0, rel=1e-12)
    assert load.leaves_out_light_torque


def test_without_a_torque_it_is_ten_newton_metres():
    load = Load(torque=0.0)
    assert load.light_torque == 10_000.0
    assert load.light_torque_words == "10 N·m: load.light_torque is left out, and load.torque is 0 as written"
    assert replace(load, torque=5e4).light_torque_words == load.light_torque_words
    assert replace(load, torque=50.0).light_torque_words.startswith(
        "10 N·m (load.torque is 0 as written) exceeds the torque 0.05 N·m: "
    )


@pytest.mark.parametrize("value", [float("nan"), 0.0, -1.0, "3 %", None])
def test_a_light_torque_that_is_written_is_checked(value, drive):
    with error_says(DriveError, "load.light_torque = ", ": must "):
        drive.with_fields({"load.light_torque": value})


def test_no_question_about_a_light_torque_that_nobody_wrote(drive):
    """Six of twenty published drives were asked whether two fields are swapped, of which their files have one."""
    assert not any("light" in told for told in analyse(drive, ANGLE).warnings)
    below, above = drive.with_fields({"load.torque": 5e3}), drive.with_fields({"load.torque": 4e8})
    assert not any("light" in told for told in [*analyse(below, ANGLE).warnings, *unit_warnings(above)])
    written = below.with_fields({"load.light_torque": 6e3})
    assert not written.load.leaves_out_light_torque
    assert any("light_torque = 6000 N·mm is more than the torque" in one for one in analyse(written, ANGLE).warnings)


def test_an_impossible_torque_is_named_and_no_light_torque_that_follows_it():
    huge = build_drive({**tomllib.loads(PAPER), "load": {"torque": 1e12}, "tolerances": {}})
    (told,) = likely_unit_mistakes(huge, 1e3)
    assert told.startswith("load.torque = 1e+12 N·mm is 1e+09 N·m: the light torque, left out and so 3 % of it")


def test_a_torque_that_is_not_solved_was_blamed_where_the_light_torque_is_left_out():
    """Solved are 1 N·m and 3 % of the torque as written: the load is judged by what is solved."""

    def first_refused(mistakes):
        return next(
            torque for torque in np.geomspace(1e6, 1e14, 81).tolist() if "would press" in "".join(mistakes(torque))
        )

    def of_torque(torque):
        return build_drive({**tomllib.loads(PAPER), "load": {"torque": torque}, "tolerances": {}})

    written = first_refused(lambda torque: likely_unit_mistakes(of_torque(torque), 1e3))
    solved = first_refused(lambda torque: likely_unit_mistakes(of_torque(1e6), torque))
    assert written / solved == pytest.approx(1.0 / 0.03, rel=0.27)  # one step between torques is 1.26


WORDS = "6 N·m: load.light_torque is left out, 3 % of load.torque as written"


def test_a_light_torque_left_out_is_a_row_of_the_derived_values(drive):
    assert ("light torque", WORDS) in derived_rows(drive, drive, plays=False)
    stated = parse_drive(PAPER).cases["nominal"]
    assert "light torque" not in dict(derived_rows(stated, stated, plays=False))


@pytest.mark.slow
def test_a_light_torque_left_out_is_printed(tmp_path, capsys):
    path = tmp_path / "small.toml"
    path.write_text(LEFT_OUT, encoding="utf-8")
    assert main(["show", str(path), "--out", str(tmp_path / "s")]) == 0
    assert f"  {'light torque':<47} {WORDS}\n" in capsys.readouterr().out
    run = [
        "run",
        str(path),
        "--compliance",
        "half-space",
        "--positions",
        "2",
        "--no-page",
        "--out",
        str(tmp_path / "r"),
    ]
    assert main([*run, "--torque", "300 N m"]) == 0
    assert f"\nlight torque {WORDS}\n" in capsys.readouterr().out


def test_fields_state_the_default_of_the_light_torque(capsys):
    assert declared_fields()["load.light_torque"].default == "3 % of load.torque"
    assert main(["fields", "light_torque"]) == 0
    assert "default 3 % of load.torque" in capsys.readouterr().out


def test_a_drive_written_again_keeps_its_light_torque(drive):
    """Written with another torque, a file that left it out would have given 3 % of that one."""
    changed = drive.with_fields({"load.torque": 7e3})
    assert parse_drive(drive_text(changed)).cases["nominal"] == changed


def test_hashes_of_drives_that_state_ten_newton_metres_stay():
    """Hashes from before the light torque followed the torque: files of coefficients, studies and referees hold them."""
    cases = load_drive("paper").cases
    assert cases["CS-1"].fingerprint() == "7f209deb5911bb17"
    assert load_drive("sleeved").cases["nominal"].fingerprint() == "02f147d624b0f529"
    assert json.dumps(cases["CS-1"].load.light_torque) == "10000.0"


def test_a_torque_whose_three_percent_are_ten_newton_metres_was_told_to_be_0():
    """3 % of 1e4/0.03 N·mm are the 10 N·m of a load of 0."""
    load = Load(torque=1e4 / 0.03)
    assert load.light_torque == pytest.approx(1e4)
    assert load.light_torque_words == "10 N·m: load.light_torque is left out, 3 % of load.torque as written"
    assert pickle.loads(pickle.dumps(Load(torque=0.0))).light_torque_words.endswith("load.torque is 0 as written")


def test_no_line_told_that_a_derived_light_torque_exceeds_the_torque(drive):
    """`--torque` below the light torque, which keeps following the torque of the file."""
    analysis = analyse(drive, ANGLE, 5e3)
    (line,) = light_torque_lines({"nominal": analysis.drive}, analysis.torque)
    assert line.startswith("light torque 6 N·m (3 % of load.torque as written) exceeds the torque 5 N·m: ")
    assert line in notes(analysis)  # of `check`


def test_only_run_and_show_told_of_a_light_torque_left_out(drive):
    line = f"light torque {WORDS}"
    assert light_torque_lines({"a": drive, "b": drive}) == [line]
    stated = drive.with_fields({"load.light_torque": 6e3})
    assert light_torque_lines({"a": drive, "b": stated}) == [f"case a: light torque {WORDS}"]
    assert light_torque_lines({"a": stated}) == []
    assert line in notes(analyse(drive, ANGLE))
    found = answer(Question(text=LEFT_OUT, source="x", case="nominal", quality=COARSE, compliance=CACHED), Memory())
    assert line in found["warnings"]


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        ["check", "--positions", "4", "--no-advice"],
        ["curves"],
        ["tolerance", "--samples", "8", "--positions", "2"],
    ],
)
def test_commands_with_results_at_the_light_torque_print_it(command, tmp_path, capsys):
    path = tmp_path / "small.toml"
    path.write_text(LEFT_OUT, encoding="utf-8")
    main([command[0], str(path), *command[1:], "--compliance", "half-space", "--no-page", "--out", str(tmp_path / "o")])
    assert f"light torque {WORDS}\n" in capsys.readouterr().out
