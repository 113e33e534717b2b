"""Drive files: reading, cases, defaults, and every mistake told at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from refusals import error_is, error_says, refused_field

import ltca
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

BASE = shipped_drive().split("[[case]]")[0]


def refuse(text, source="my.toml"):
    with pytest.raises(DriveError) as caught:
        parse_drive(text, source)
    return caught.value


def test_paper_ships_with_its_six_cases():
    file = load_drive("paper")
    assert file.name == "paper"
    assert list(file.cases) == ["CS-1", "CS-2", "CS-3", "CS-4", "CS-5", "CS-6"]


def test_units_in_texts():
    text = BASE.replace("377300.0", '"377.3 N m"').replace("= 4.0 ", '= "0.004 m" ').replace("1.0e6", '"1000 N/um"')
    drive = parse_drive(text).cases["nominal"]
    assert drive.load.torque == pytest.approx(377_300.0, rel=1e-14)
    assert drive.crank.eccentricity == pytest.approx(4.0, rel=1e-14)
    assert drive.pin_shaft.stiffness == pytest.approx(1e6, rel=1e-14)


def test_without_cases_the_drive_itself_is_nominal_and_named_after_its_file():
    file = parse_drive(BASE.replace('name = "paper"\n', ""), "folder/robot_joint.toml")
    assert file.name == "robot_joint"
    assert list(file.cases) == ["nominal"]


def test_cases_override_single_fields_deeply():
    file = parse_drive(
        BASE + '[[case]]\nname = "thick"\ndisc = { thickness = 14.0 }\n[[case]]\nname = "soft"\n'
        "[case.materials.roller]\nyoungs_modulus = 1e5\n[case.load]\ntorque = '100 N m'\n"
    )
    thick, soft = file.cases["thick"], file.cases["soft"]
    assert thick.disc.thickness == 14.0
    assert thick.disc.equidistant_offset == 0.15  # the rest of the table stays
    assert soft.materials.roller.youngs_modulus == 1e5
    assert soft.materials.roller.poisson_ratio == 0.3
    assert soft.load.torque == 100_000.0
    assert soft.load.direction == "ccw"
    assert soft.disc.thickness == 11.8


def test_what_single_discs_have_of_their_own():
    """Entries of disc.of and crank.of take the place of what all discs have; what they leave out stays."""
    text = BASE.replace("number_of_discs = 1", 'number_of_discs = 2\nphases = ["0 deg", "170 deg"]').replace(
        "[crank_bearing]",
        "[[disc.of]]\n[[disc.of]]\nrunout = { amount = 0.004, angle = '90 deg' }\nclearance = { pin_hole = 0.02 }\n"
        "[[crank.of]]\neccentricity_error = 0.003\n[[crank.of]]\nphase_error = '1 arcmin'\n[crank_bearing]",
        1,
    )
    drive = parse_drive(text).cases["nominal"]
    first, second = single_discs(drive)
    assert (first.disc.runout, first.clearance) == (drive.disc.runout, drive.clearance)
    assert second.disc.runout.amount == 0.004
    assert (second.clearance.bearing, second.clearance.pin_hole) == (drive.clearance.bearing, 0.02)
    assert (first.crank.eccentricity_error, second.crank.eccentricity_error) == (0.003, 0.0)
    assert (first.crank.eccentric(0).phase_error, second.disc.phases) == (0.0, (np.radians(170.0),))
    assert second.disc.phase + second.crank.eccentric(0).phase_error == pytest.approx(
        np.radians(170.0) + np.radians(1.0 / 60.0), abs=1e-15
    )
    assert second.flank_turn == pytest.approx(-np.radians(170.0) / 13.0, abs=1e-15)
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive


def test_error_arrays_are_read():
    text = BASE.replace(
        "pin_radius = 6.5 ", 'pin_errors = { radial = ["5 um", ' + "0.0, " * 13 + "] }\npin_radius = 6.5 "
    )
    assert parse_drive(text).cases["nominal"].pin_wheel.pin_errors.radial[0] == pytest.approx(0.005)


def test_several_mistakes_are_told_together():
    text = BASE.replace("eccentricity = 4.0", "eccentricity = -4.0").replace("thickness = 11.8", "thicknes = 11.8")
    error = refuse(text.replace("377300.0", '"1 mm"'))
    assert len(error.problems) == 3  # negative, misspelt (and so missing), wrong unit
    assert "3 mistakes" in str(error)


def test_mistakes_of_cases_carry_their_names():
    error = refuse(
        BASE
        + '[[case]]\nname = "A"\nclearance = { bearing = -1.0 }\n[[case]]\nname = "B"\nclearance = { pin_hole = 3.0 }'
    )
    assert error.problems[0].startswith("case A: clearance.bearing")
    assert error.problems[1].startswith("case B: clearance.pin_hole = 3 mm: must be at most 2 mm")


def test_a_contradiction_of_the_common_part_is_told_once():
    text = shipped_drive().replace("number_of_rollers = 11", "number_of_rollers = 16")
    error = refuse(text)
    assert len(error.problems) == 1
    assert "number_of_rollers = 16" in error.problems[0]
    assert "case" not in error.problems[0]


@pytest.mark.parametrize(
    ("cases", "message"),
    [
        ('[[case]]\nname = "A"\n[[case]]\nname = "A"', "case A: name is used twice"),
        ("[[case]]\nclearance = { bearing = 0.0 }", "case 0: name is missing"),
        ('[[case]]\nname = "a/b"', "case 0: name"),
        ('[case]\nname = "A"', "written [[case]]"),
    ],
)
def test_case_names(cases, message):
    assert message in str(refuse(BASE + cases))


def test_unknown_case_names_the_known_ones():
    file = load_drive("paper")
    with error_says(DriveError, "case 'CS-7' is not defined; the cases are CS-1, CS-2"):
        file.select(["CS-1", "CS-7"])
    assert list(file.select(["CS-3", "CS-1", "CS-3"])) == ["CS-3", "CS-1"]
    assert list(file.select(None)) == list(file.cases)


def test_every_shipped_drive_is_loaded_by_its_name():
    """`load_drive("robot-joint")` said that there was no such file."""
    folder = Path(ltca.__file__).parent / "drives"
    assert sorted(path.stem for path in folder.glob("*.toml")) == sorted(SHIPPED_DRIVES)
    for name in SHIPPED_DRIVES:
        assert load_drive(name).name == name
        assert load_drive(name).cases == load_drive(folder / f"{name}.toml").cases


@pytest.mark.parametrize(("name", "meant"), [("robotjoint", "robot-joint"), ("papper", "paper"), ("anything", None)])
def test_a_wrong_name_lists_the_shipped_drives(name, meant):
    with error_says(DriveError, "shipped drive, paper, robot-joint, rv, sleeved") as caught:
        load_drive(name)
    assert ("did you mean" in str(caught.value)) == (meant is not None)
    assert meant is None or f"did you mean `{meant}`?" in str(caught.value)


def test_only_names_are_loaded():
    with error_is(DriveError, "source = 3: must be the name of a file or of a shipped drive"):
        load_drive(3)


def test_files_that_cannot_be_read(tmp_path):
    with error_says(DriveError, "no such file; give a TOML file or a shipped drive"):
        load_drive(tmp_path / "none.toml")
    with pytest.raises(DriveError, match="cannot be read"):
        load_drive(tmp_path)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DriveError, match="cannot be read"):
        load_drive(tmp_path / "binary.toml")
    (tmp_path / "broken.toml").write_text("[crank\n")
    with pytest.raises(DriveError, match="is not valid TOML"):
        load_drive(tmp_path / "broken.toml")


@pytest.mark.parametrize("text", ["", "name = 3\n", 'case = "x"\n', "[crank]\n", "crank = []\ndisc = 1\n"])
def test_nonsense_is_a_drive_error_not_a_traceback(text):
    refuse(text)


def test_name_that_would_leave_the_output_folder():
    refuse(BASE.replace('name = "paper"', 'name = "../elsewhere"'))


def test_build_drive_reports_problems_without_a_source(paper_table):
    with refused_field("disc.thickness", "= -1.0", "must be greater than 0 mm", alone=True):
        build_drive(paper_table(disc={"thickness": -1.0}))
