"""Values in a unit nobody meant are pointed out by every command, not by `run` and `check` alone."""

import re

import pytest

from ltca.commands.program import main
from ltca.drive.unit_mistakes import impossible_torque
from ltca.reading.drive_file import load_drive, shipped_drive

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
    assert line.startswith("cyclo: error: torque = 1e+12 N·mm is 1e+09 N·m and would press the wheel pins with some ")
    assert not (tmp_path / "out").exists()


def test_a_torque_beyond_any_of_the_file_is_refused_by_its_field(capsys, tmp_path):
    path = tmp_path / "drive.toml"
    path.write_text(re.sub(r"(?m)^torque = .*$", "torque = 1e12", shipped_drive("paper")), encoding="utf-8")
    for command in ("run", "check", "curves"):
        assert main([command, str(path), "--case", "CS-1", "--quick", "--out", str(tmp_path / "out")]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("cyclo: error: load.torque = 1e+12 N·mm is 1e+09 N·m and would press the wheel pins")
    # where the command gives one, that of the file is not asked about
    assert impossible_torque(load_drive(path).cases["CS-1"], 377_300.0) == ""
