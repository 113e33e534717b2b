"""``cyclo export``: files of every format, names, what is refused, in one line each."""

from __future__ import annotations

import pytest

from ltca.commands.program import main
from ltca.output.run_folder import MANIFEST
from ltca.reading.drive_file import shipped_drive


@pytest.fixture
def drives(tmp_path):
    for name in ("robot-joint", "rv", "sleeved"):
        (tmp_path / f"{name}.toml").write_text(shipped_drive(name))
    crowned = shipped_drive("rv").replace("[pin_wheel]\n", "[pin_wheel]\npin_profile = { crown_drop = 0.002 }\n")
    rollers = shipped_drive("rv").replace(
        "[crank_bearing]\n", "[crank_bearing]\nroller_profile = { logarithmic_factor = 1.0 }\n"
    )
    (tmp_path / "crowned.toml").write_text(crowned)
    (tmp_path / "rollers.toml").write_text(rollers)
    return tmp_path


def names_in(folder):
    return {path.name for path in folder.iterdir()} - {MANIFEST}


@pytest.mark.slow
def test_formats_lie_beside_each_other(tmp_path, capfd):
    """Each export adds to the folder; standard output tells the frame and holds nothing of the kernel's chatter."""
    for kind in ("dxf", "step", "stl", "csv"):
        given = [
            "export",
            "paper",
            "--case",
            "CS-3",
            "--format",
            kind,
            "--compensate",
            "0.1 mm",
            "--out",
            str(tmp_path),
        ]
        assert main([*given, *(["--chord", "0.02"] if kind == "stl" else [])]) == 0
    stem = "paper_CS-3_disc_compensated_0.1mm"
    assert names_in(tmp_path) == {
        *(f"{stem}.{kind}" for kind in ("dxf", "step", "stl")), f"{stem}_flank.csv", f"{stem}_circles.csv",
    }  # fmt: skip
    told = capfd.readouterr()
    assert told.err == ""
    assert "frame: origin at the centre of the bore, hole 0 on +x" in told.out
    assert "triangles within 0.02 mm" in told.out
    assert "STEP" not in told.out
    assert "Transfer" not in told.out


def test_a_file_for_each_disc_or_for_one(drives):
    file, out = str(drives / "robot-joint.toml"), drives / "out"
    assert main(["export", file, "--format", "csv", "--disc", "1", "--out", str(out)]) == 0
    assert names_in(out) == {"robot-joint_nominal_disc_1_flank.csv", "robot-joint_nominal_disc_1_circles.csv"}
    assert main(["export", file, "--format", "csv", "--out", str(out)]) == 0
    assert "robot-joint_nominal_disc_0_flank.csv" in names_in(out)


def test_slots_are_told_where_they_are_not(drives, capsys):
    given = ["export", str(drives / "sleeved.toml"), "--part", "pin-wheel", "--out", str(drives / "out")]
    assert main([*given, "--format", "stl"]) == 0
    assert "30 slots bound no body of the drive: they are in DXF, STEP and CSV, not in STL" in capsys.readouterr().out


def test_profiles_along_the_length_are_refused_where_bodies_are_straight(drives, capsys):
    out = ["--out", str(drives / "out")]
    crowned, rollers = str(drives / "crowned.toml"), str(drives / "rollers.toml")
    assert main(["export", crowned, "--part", "pin-wheel", "--format", "step", *out]) == 2
    assert "pin_wheel.pin_profile: crown and relief along the length are not written to STEP" in capsys.readouterr().err
    assert main(["export", rollers, "--part", "assembly", "--format", "stl", *out]) == 2
    assert "crank_bearing.roller_profile: crown and relief" in capsys.readouterr().err
    assert main(["export", crowned, "--part", "assembly", "--format", "dxf", *out]) == 0
    assert main(["export", rollers, "--part", "pin-wheel", "--format", "csv", *out]) == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--format", "dxf", "--chord", "0.1"], "--chord 0.1 mm: is for --format stl, dxf is exact"),
        (["--format", "dxf", "--disc", "1"], "--disc 1: there is no such disc"),
        (["--format", "dxf", "--compensate", "2"], "--compensate = 2: must be at least -1 and at most 1 mm"),
        (["--format", "stp"], "did you mean `step`?"),
        (["--format", "dxf", "--part", "discs"], "did you mean `disc`?"),
        (["--part", "disc"], "--format"),
        (["--format", "csv", "--case", "CS-9"], "case 'CS-9' is not defined"),
    ],
)
def test_wrong_input_is_one_line(tmp_path, capsys, words, told):
    try:
        status = main(["export", "paper", "--out", str(tmp_path / "out"), *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    error = capsys.readouterr().err
    assert error.startswith("cyclo: error: ")
    assert error.count("\n") == 1
    assert told in error
    assert not (tmp_path / "out").exists()
