"""Malformed drives end in one clear message naming field, value, bound and unit, with exit status 2."""

import tomllib
from pathlib import Path

import pytest
from refusals import error_says

from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive, shipped_drive

BASE = shipped_drive().partition("[[case]]")[0]
ROWS = tomllib.loads(Path(__file__).with_name("malformed_drives.toml").read_text(encoding="utf-8"))


def test_there_are_forty_or_more():
    assert len(ROWS["malformed"]) >= 40
    assert len({row["changed"] for row in ROWS["malformed"]}) == len(ROWS["malformed"])


def test_the_base_is_sound():
    assert list(parse_drive(BASE).cases) == ["nominal"]


QUICK = 5
"""Of the impossible geometries; the others are slow."""


def walk():
    for number, row in enumerate([*ROWS["impossible"], *ROWS["malformed"]]):
        marks = [pytest.mark.slow] if QUICK <= number < len(ROWS["impossible"]) else []
        yield pytest.param(row, id=row["changed"][:48] or "(removed)", marks=marks)


@pytest.mark.parametrize("row", list(walk()))
def test_malformed_drive_says_what_is_wrong(row, tmp_path, capsys):
    assert row["written"] in BASE
    path = tmp_path / "bad.toml"
    path.write_text(BASE.replace(row["written"], row["changed"], 1), encoding="utf-8")
    assert main(["run", str(path), "--positions", "1", "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"cyclo: error: {path}")
    assert "Traceback" not in err
    for part in row["message"]:
        assert part in err
    assert not (tmp_path / "out").exists()


def test_several_mistakes_come_together():
    """Five mistakes in five places, one message."""
    text = BASE
    for old, new in (
        ("eccentricity = 4.0", "eccentricity = -4.0"),
        ("thickness = 11.8", 'thickness = "11.8 N"'),
        ("number_of_rollers = 11", "number_of_rollers = 0"),
        ("hole_radius = ", "hole_radus = "),
        ("bearing = 0.0", "bearing = nan"),
    ):
        text = text.replace(old, new, 1)
    with pytest.raises(DriveError) as caught:
        parse_drive(text, "bad.toml")
    told = str(caught.value)
    for part in (
        "-4.0",
        "'11.8 N'",
        "number_of_rollers = 0",
        "hole_radus",
        "`hole_radius`, which is missing",
        "bearing = nan",
    ):
        assert part in told
    assert told.startswith("bad.toml: 5 mistakes\n")


def test_a_contradiction_of_one_case_names_the_case():
    text = BASE + '[[case]]\nname = "A"\n[[case]]\nname = "B"\nclearance = { pin_hole = 3.0 }\n'
    with error_says(DriveError, "case B: clearance.pin_hole = 3 mm: must be at most 2 mm") as caught:
        parse_drive(text)
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("method", ["tables", "direct"])
def test_torque_beyond_the_half_width_bound(method, tmp_path, capsys):
    """A half-width beyond 0.3 of the smallest radius: the torque cannot be carried, no number is written."""
    command = ["run", "paper", "--case", "CS-1", "--positions", "2", "--torque", "1e8", "--method", method]
    assert main([*command, "--out", str(tmp_path)]) == 2
    err = capsys.readouterr().err
    assert "load.torque = 1e+08 N·mm cannot be carried: contact half-width" in err
    assert "must be at most" in err
    assert "mm (0.3 of the smallest radius in contact)" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--positions", "0"], "--positions = 0: must be from 1 to 1000000"),
        (["--torque", "-1"], "--torque = -1: must be at least 0 N·mm"),
        (["--torque", "5 N"], "--torque = '5 N'"),
        (["--angles", "nan"], "--angles = 'nan': must be finite in rad"),
        (["--pressure", "here"], "--pressure = 'here'"),
        (["--case", "CS-9"], "case 'CS-9' is not defined; the cases are CS-1"),
        (["--method", "direct", "--contacts", "tables"], "method direct runs on grids"),
    ],
)
def test_wrong_arguments(arguments, told, tmp_path, capsys):
    assert main(["run", "paper", *arguments, "--out", str(tmp_path / "out")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
