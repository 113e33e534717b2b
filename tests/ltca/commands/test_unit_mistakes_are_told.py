"""Values in a unit nobody meant are pointed out by every command, not by `run` and `check` alone."""

import re

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.drive.unit_mistakes import carried_torque, impossible_torque, unit_warnings
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import load_drive, shipped_drive

MOST = dict.fromkeys(("run", "curves", "fem"), "1.08e+08") | {"check": "2.85e+08"}
"""Largest torque of the paper's drive that is answered; a check answers at the part that is carried, unless pins are crushed."""
COMMANDS = {
    "curves": ["--turns", "1", "--quick", "--no-page"],
    "tolerance": ["--samples", "2", "--positions", "2", "--quick", "--no-page"],
    "export": ["--format", "csv", "--part", "disc"],
}


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_degrees_as_radians_are_pointed_out(command, tmp_path, capsys):
    """`tolerance` took phases = [0, 180] without a word."""
    path = tmp_path / "drive.toml"
    text = shipped_drive("robot-joint")
    changed = re.sub(r"# phases = .*", "phases = [0.0, 180.0]", text)
    assert changed != text
    path.write_text(changed, encoding="utf-8")
    main([command, str(path), *COMMANDS[command], "--out", str(tmp_path / "out")])
    out = capsys.readouterr()
    assert (out.err + out.out).count("phases") >= 1


@pytest.mark.slow
def test_run_tells_them_before_it_works_and_once(tmp_path, capsys):
    """A stiffness in N/µm took half a minute of searching before a word was said of it."""
    path = tmp_path / "drive.toml"
    path.write_text(re.sub(r"# phases = .*", "phases = [0.0, 180.0]", shipped_drive("robot-joint")), encoding="utf-8")
    assert main(["run", str(path), "--quick", "--positions", "2", "--no-page", "--out", str(tmp_path / "out")]) == 0
    out = capsys.readouterr()
    assert out.err.startswith("warning: disc.phases: 180 rad are")
    assert "disc.phases" not in out.out


@pytest.mark.parametrize("command", ["run", "check", "fem"])
def test_a_question_about_a_torque_came_before_its_refusal(command, capsys, tmp_path):
    """`did you mean "1e+06 N m"?` was asked about a torque that the next line refused."""
    words = [command, "paper", "--case", "CS-1", "--torque", "1e12", "--out", str(tmp_path / "out")]
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"cyclo: error: torque = 1e+12 N·mm is 1e+09 N·m: must be at most {MOST[command]} N·mm, ")
    assert not (tmp_path / "out").exists()


def test_a_torque_beyond_any_of_the_file_is_refused_by_its_field(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    path.write_text(re.sub(r"(?m)^torque = .*$", "torque = 1e12", shipped_drive("paper")), encoding="utf-8")
    for command in ("run", "check", "curves"):
        assert main([command, str(path), "--case", "CS-1", "--quick", "--out", str(tmp_path / "out")]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith(
            f"cyclo: error: load.torque = 1e+12 N·mm is 1e+09 N·m: must be at most {MOST[command]} N·mm, "
        )
    # where the command gives one, that of the file is not asked about
    assert impossible_torque(load_drive(path).cases["CS-1"], 377_300.0) == ""


@pytest.mark.parametrize(
    "words",
    [
        ["run"],
        ["curves"],
        ["dynamics", "--speed", "1500"],
        ["tolerance", "--samples", "2"],
        ["optimise", "--vary", "eccentricity", "--minimise", "max_pin_load"],
        ["export", "--for", "json"],
        ["fem"],
    ],
    ids=lambda words: words[0],
)
def test_a_torque_just_above_the_bound_was_asked_about_and_then_refused(words, capsys, tmp_path):
    """`340 times what this drive carries …, did you mean "150 N m"?` and then, after the work, an error about a half-width."""
    path = tmp_path / "drive.toml"
    path.write_text(re.sub(r"(?m)^torque = .*$", "torque = 1.1e8", shipped_drive("paper")), encoding="utf-8")
    command, *options = words
    assert main([command, str(path), *options, "--case", "CS-1", "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == (
        "cyclo: error: load.torque = 1.1e+08 N·mm is 110000 N·m: must be at most 1.08e+08 N·mm, 250 times what this drive "
        'carries (some 440 N·m by the pressure of its flank); a plain number is N·mm, newton metres are written "377.3 N m"'
    )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("command", ["run", "curves"])
def test_a_torque_of_a_duty_beyond_the_bound_was_asked_about_and_then_blamed_on_a_stiffness(command, capsys, tmp_path):
    """`pin_shaft.stiffness = …: a shaft pin would yield by 48 mm` was the error, after half a minute."""
    path = tmp_path / "drive.toml"
    duty = '\n[[duty]]\ntorque = "300 N m"\nspeed = 100.0\nshare = 0.5\n\n[[duty]]\ntorque = 2e8\nspeed = 100.0\nshare = 0.5\n'
    path.write_text(shipped_drive("paper").partition("[[case]]")[0] + duty, encoding="utf-8")
    assert main([command, str(path), "--quick", "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert (
        "duty.1.torque = 2e+08 N·mm is 200000 N·m: must be at most 1.08e+08 N·mm, 250 times what this drive carries"
        in line
    )


@pytest.mark.slow
@pytest.mark.parametrize("torque", ["1.5e8", "2.5e8"])
def test_a_check_asked_about_a_torque_and_ended_in_an_error(torque, capsys, tmp_path):
    """It says which part is carried, and what size would carry the whole; at 2.5e8 N·mm it had no answer."""
    words = ["check", "paper", "--case", "CS-1", "--quick", "--positions", "8", "--torque", torque, "--no-advice"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr()
    assert "part of the torque that is carried" in told.out
    assert "times what this drive carries" in told.err


@pytest.mark.parametrize("name", SHIPPED_DRIVES)
def test_no_torque_is_asked_about_below_the_bound_and_none_is_answered_above(name):
    drive = next(iter(load_drive(name).cases.values()))
    carried = carried_torque(drive)
    for part in (1.0, 50.0, 120.0, 200.0, 240.0, 249.0, 251.0, 300.0, 1e3, 1e6):
        asked = any("times what this drive carries" in words for words in unit_warnings(drive, part * carried))
        assert asked <= bool(impossible_torque(drive, part * carried)), part
    assert not impossible_torque(drive, 0.0)


def test_a_drive_of_a_weak_material_is_asked_about_and_solved():
    """A bronze disc of 300 MPa carries a tenth of a hardened one, and is not crushed by 250 times that."""
    weak = load_drive("paper").cases["CS-1"].with_fields({"materials.disc.allowable_pressure": 300.0})
    torque = 300.0 * carried_torque(weak)
    assert any("times what this drive carries" in words for words in unit_warnings(weak, torque))
    assert not impossible_torque(weak, torque)
    loads = analyse(weak, np.array([0.1]), torque=torque).pressures
    assert 2_000.0 < loads.pins.mid.max() < 10_000.0
