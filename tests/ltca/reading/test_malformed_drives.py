"""Malformed drives end in one clear message naming field, value, bound and unit, with exit status 2."""

import pytest

from ltca.commands.program import main
from ltca.errors import DriveError
from ltca.reading.drive_file import parse_drive, shipped_drive

BASE = shipped_drive().partition("[[case]]")[0]
STEEL = 'disc = { like = "100Cr6", youngs_modulus = 206000.0, poisson_ratio = 0.3 }'
ROLLER_PROFILE = "# roller_profile = { logarithmic_factor = 1.0 }"
ROLLER_ERRORS = "# roller_errors = { tangential = […], diameter = […] }"
PIN_ERRORS = "# pin_errors = { radial = [0.01, 0.0, …], tangential = […], diameter = […] }"

# What is written, what it is changed to, and what the message must hold: field, value, bound, unit.
MALFORMED = [
    # signs, zeros, and numbers that are none
    ("eccentricity = 4.0", "eccentricity = -4.0", ["crank.eccentricity = -4.0", "greater than 0 mm"]),
    ("eccentricity = 4.0", "eccentricity = 0", ["crank.eccentricity = 0", "greater than 0 mm"]),
    ("eccentricity = 4.0", "eccentricity = nan", ["crank.eccentricity = nan", "finite in mm"]),
    ("eccentricity = 4.0", "eccentricity = inf", ["crank.eccentricity = inf", "finite in mm"]),
    ("eccentricity = 4.0", "eccentricity = true", ["crank.eccentricity = True", "a number in mm"]),
    ("eccentricity = 4.0", "eccentricity = [4.0]", ["crank.eccentricity = [4.0]", "a number in mm"]),
    ("eccentricity = 4.0", 'eccentricity = "four"', ["crank.eccentricity = 'four'", "a number in mm"]),
    ("pin_radius = 6.5", "pin_radius = 0.0", ["pin_wheel.pin_radius = 0.0", "greater than 0 mm"]),
    ("thickness = 11.8", "thickness = -1.0", ["disc.thickness = -1.0", "greater than 0 mm"]),
    ("stiffness = 1.0e6", "stiffness = 0.0", ["pin_shaft.stiffness = 0.0", "greater than 0 N/mm"]),
    ("torque = 377300.0", "torque = -1.0", ["load.torque = -1.0", "at least 0 N·mm"]),
    ("light_torque = 10000.0", "light_torque = -5", ["load.light_torque = -5", "greater than 0 N·mm"]),
    ("bearing = 0.0", "bearing = -0.01", ["clearance.bearing = -0.01", "at least 0 mm"]),
    ("pin_hole = 0.0", "pin_hole = -0.01", ["clearance.pin_hole = -0.01", "at least 0 mm"]),
    ("# phases = [", "torque_share = 0.55 # [", ["disc.torque_share", "computed"]),
    ("# phases = [", "phases = [0.0, 3.14] # [", ["disc.phases has 2 entries", "must have 1"]),
    (
        "number_of_discs = 1",
        "number_of_discs = 2\nplanes = [0.0, 20.0]",
        ["disc.planes has the mean 10 mm", "must be 0 mm"],
    ),
    (
        "number_of_discs = 1 ",
        "number_of_discs = 2\nplanes = [-5, 5] # ",
        ["disc.planes holds -5 and 5 mm", "at least 11.8 mm"],
    ),
    # wrong units
    ("eccentricity = 4.0", 'eccentricity = "4 N"', ["crank.eccentricity = '4 N'", "unit mm"]),
    ("pin_circle_radius = 88.0", 'pin_circle_radius = "88 MPa"', ["pin_circle_radius = '88 MPa'", "unit mm"]),
    ("thickness = 11.8", 'thickness = "11.8 deg"', ["disc.thickness = '11.8 deg'", "unit mm"]),
    ("stiffness = 1.0e6", 'stiffness = "1e6 N"', ["pin_shaft.stiffness = '1e6 N'", "unit N/mm"]),
    ("torque = 377300.0", 'torque = "377.3 N"', ["load.torque = '377.3 N'", "unit N·mm"]),
    ("bearing = 0.0", 'bearing = "0.01 °C"', ["clearance.bearing = '0.01 °C'", "mm"]),
    # counts
    ("number_of_pins = 14", "number_of_pins = 0", ["pin_wheel.number_of_pins = 0", "4"]),
    ("number_of_pins = 14", "number_of_pins = 14.5", ["pin_wheel.number_of_pins = 14.5", "whole number"]),
    ("number_of_pins = 14", 'number_of_pins = "14 mm"', ["number_of_pins = '14 mm'", "whole number"]),
    ("number_of_pins = 14", "number_of_pins = 15", ["disc.number_of_teeth = 13", "must be 14", "number_of_pins = 15"]),
    ("number_of_teeth = 13", "number_of_teeth = 12", ["disc.number_of_teeth = 12", "must be 13"]),
    ("number_of_teeth = 13", "number_of_teeth = 2", ["disc.number_of_teeth = 2", "3"]),
    ("number_of_discs = 1", "number_of_discs = 0", ["disc.number_of_discs = 0", "1"]),
    ("number_of_rollers = 11", "number_of_rollers = 0", ["crank_bearing.number_of_rollers = 0", "3"]),
    ("number_of_rollers = 11", "number_of_rollers = 40", ["number_of_rollers = 40", "overlap", "1.92225 mm"]),
    ("number_of_pins = 8", "number_of_pins = 2", ["pin_shaft.number_of_pins = 2", "3"]),
    # missing and unknown fields, wrong kinds
    ("eccentricity = 4.0", "", ["crank.eccentricity: is missing"]),
    ("[crank]\n", "[kurbel]\n", ["crank: is missing", "kurbel: is not a field"]),
    ("eccentricity = 4.0", "excentricity = 4.0", ["crank.excentricity: is not a field; did you mean `eccentricity`"]),
    (STEEL, 'disc = "steel"', ["materials.disc = 'steel'", "is no named material"]),
    ('direction = "ccw"', 'direction = "left"', ["load.direction = 'left'", "'ccw' or 'cw'"]),
    ("[crank]\n", "[crank\n", ["not valid TOML", "line 8"]),
    # materials
    (STEEL, "disc = { youngs_modulus = -1.0 }", ["materials.disc.youngs_modulus = -1.0", "greater than 0 MPa"]),
    (STEEL, "disc = { poisson_ratio = 0.5 }", ["materials.disc.poisson_ratio = 0.5", "less than 0.5"]),
]
# Geometry that cannot be: the field that mends it is looked for, which takes a while.
IMPOSSIBLE = [
    ("eccentricity = 4.0", "eccentricity = 7.0", ["crank.eccentricity = 7 mm", "at most 4 mm", "loops"]),
    ("pin_radius = 6.5", "pin_radius = 25.0", ["pin_wheel.pin_radius = 25 mm", "at most 13.86 mm", "undercut"]),
    ("equidistant_offset = 0.15", "equidistant_offset = -0.45", ["equidistant_offset = -0.45 mm", "at least 0.09 mm"]),
    ("equidistant_offset = 0.15", "equidistant_offset = -7.0", ["equidistant_offset = -7 mm", "than -6.5 mm"]),
    ("shifting_offset = 0.09", "shifting_offset = 0.9", ["equidistant_offset = 0.15 mm", "at least 0.9 mm"]),
    ("inner_race_radius = 19.5", "inner_race_radius = 22.0", ["roller_radius = 5 mm", "at most 3.75 mm"]),
    ("inner_race_radius = 19.5", "inner_race_radius = 10.0", ["inner_race_radius = 10 mm", "at least 18.39 mm"]),
    (
        "outer_race_radius = 29.5",
        "outer_race_radius = 50.0",
        ["outer_race_radius = 50 mm", "at most 30.61 mm", "bore by 8.075 mm"],
    ),
    ("roller_radius = 5.0", "roller_radius = 6.0", ["crank_bearing.roller_radius = 6 mm", "at most 5 mm"]),
    ("roller_length = 11.8", "roller_length = 20.0", ["crank_bearing.roller_length = 20 mm", "at most 11.8 mm"]),
    (
        "pin_circle_radius = 56.0",
        "pin_circle_radius = 75.0",
        ["pin_shaft.pin_circle_radius = 75 mm", "root circle", "less than 63.365 mm"],
    ),
    ("pin_radius = 10.075", "pin_radius = 12.0", ["hole_radius = 14.075 mm", "at least 16 mm"]),
    ("hole_radius = 14.075", "hole_radius = 13.0", ["pin_shaft.hole_radius = 13 mm", "at least 14.075 mm"]),
    ("bearing = 0.0", "bearing = 20.0", ["clearance.bearing = 20 mm", "at most 5 mm"]),
    ("pin_hole = 0.0", "pin_hole = 3.0", ["clearance.pin_hole = 3 mm", "at most 2 mm"]),
]
# Profiles and errors of single parts.
MALFORMED += [
    (ROLLER_PROFILE, "roller_profile = { logarithmic_factor = -1.0 }", ["logarithmic_factor = -1.0", "at least 0"]),
    (ROLLER_PROFILE, "roller_profile = { crown_drop = 2.0 }", ["crown_drop = 2 mm", "at most 0.5 mm"]),
    (
        ROLLER_PROFILE,
        "roller_profile = { end_relief_length = 9.0, end_relief_depth = 0.01 }",
        ["end_relief_length = 9 mm", "at most 5.9 mm"],
    ),
    (ROLLER_ERRORS, "roller_errors = { diameter = [0.001, 0.002] }", ["has 2 values", "must have 11"]),
    (ROLLER_ERRORS, f"roller_errors = {{ diameter = {[1.0] + [0.0] * 10} }}", ["holds 1 mm", "at most 0.5 mm"]),
    (ROLLER_ERRORS, f"roller_errors = {{ radial = {[0.0] * 11} }}", ["roller_errors.radial", "not a field"]),
    (PIN_ERRORS, "pin_errors = { radial = 0.01 }", ["pin_wheel.pin_errors.radial = 0.01", "array of numbers in mm"]),
]


def test_there_are_forty_or_more():
    assert len(MALFORMED) >= 40
    assert len({change for _, change, _ in MALFORMED}) == len(MALFORMED)


def test_the_base_is_sound():
    assert list(parse_drive(BASE).cases) == ["nominal"]


QUICK = 5
"""Of the impossible geometries; the others are slow."""


def walk():
    for number, row in enumerate([*IMPOSSIBLE, *MALFORMED]):
        marks = [pytest.mark.slow] if QUICK <= number < len(IMPOSSIBLE) else []
        yield pytest.param(*row, id=row[1][:48] or "(removed)", marks=marks)


@pytest.mark.parametrize(("old", "new", "told"), list(walk()))
def test_malformed_drive_says_what_is_wrong(old, new, told, tmp_path, capsys):
    assert old in BASE
    path = tmp_path / "bad.toml"
    path.write_text(BASE.replace(old, new, 1), encoding="utf-8")
    assert main(["run", str(path), "--positions", "1", "--out", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"cyclo: error: {path}")
    assert "Traceback" not in err
    for part in told:
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
    with pytest.raises(DriveError, match=r"case B: clearance.pin_hole = 3 mm: must be at most 2 mm") as caught:
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
