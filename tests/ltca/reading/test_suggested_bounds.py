"""What a message suggests works: applied, the drive is accepted and its parts do not overlap."""

from __future__ import annotations

import re
from pathlib import Path
from unittest.mock import ANY

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile
from ltca.geometry.interference import drawn_plays
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.disc_checks import largest_eccentricity, rounded_down
from ltca.reading.drive_file import build_drive, load_drive, parse_drive

FOLDER = Path(__file__).parents[2] / "literature" / "public_drives"
PAPER = load_drive("paper").cases["CS-1"]


def public(name, **changes):
    """A public drive with some numbers of its file written otherwise."""
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    for field, value in changes.items():
        text, count = re.subn(rf"(?m)^{field} = \S+", f"{field} = {value}", text, count=1)
        assert count == 1, field
    (drive,) = parse_drive(text).cases.values()
    return drive


def refusal(name, **changes):
    with pytest.raises(DriveError) as caught:
        public(name, **changes)
    (problem,) = caught.value.problems
    return problem


def suggested(problem, relation):
    """The number that a message suggests, as it is printed there."""
    assert problem.bound[0] == relation
    printed = f"{problem.bound[1]:g}"
    assert f"{relation} {printed} mm" in problem
    return printed


def test_a_suggested_hole_still_overlapped_its_pin():
    """2.4 mm was suggested where pin radius and eccentricity are 2.5 mm; the eccentricity was not named at all."""
    problem = refusal("holes_of_pin_diameter_plus_eccentricity")
    assert (problem.path, problem.other) == ("pin_shaft.hole_radius", "crank.eccentricity")
    hole, eccentricity = suggested(problem, "at least"), suggested(problem.other_first, "at most")
    assert (float(hole), float(eccentricity)) == (2.0 + 0.5, 2.25 - 2.0)
    for change in ({"hole_radius": hole}, {"eccentricity": eccentricity}):
        drive = public("holes_of_pin_diameter_plus_eccentricity", **change)
        assert drawn_plays(drive)["shaft pins and holes"] == 0.0


def test_a_flank_with_loops_names_the_eccentricity_that_has_none():
    """A larger pin circle alone was named. What is suggested for the eccentricity needs another hole, which is named as well."""
    problem = refusal("flank_with_loops")
    assert (problem.path, problem.other) == ("crank.eccentricity", "pin_wheel.pin_circle_radius")
    eccentricity, circle = suggested(problem, "at most"), suggested(problem.other_first, "at least")
    hole = problem.partition(f"at most {eccentricity} mm (with pin_shaft.hole_radius = ")[2].partition(" mm) or ")[0]
    assert float(hole) == pytest.approx(3.0 + float(eccentricity), abs=1e-9)
    assert public("flank_with_loops", eccentricity=eccentricity, hole_radius=hole).crank.eccentricity == float(
        eccentricity
    )
    # The first circle of the file is that of the wheel pins.
    assert public("flank_with_loops", pin_circle_radius=circle).pin_wheel.pin_circle_radius == float(circle)
    # Smaller pins leave the flank a larger eccentricity, e z_P < R_C = 50 mm.
    smaller = refusal("flank_with_loops", pin_radius=1.0)
    larger = float(suggested(smaller, "at most"))
    assert float(eccentricity) < larger < 50.0 / 50.0


@pytest.mark.parametrize("name", ["flank_with_loops"])
def test_suggested_values_left_the_flank_an_edge(name):
    """Exactly at the bounds the drive was taken, with contacts wider than the flank goes on."""
    problem = refusal(name)
    told = problem.partition("; there the flank comes to an edge, ")[2]
    eccentricity, hole, circle = re.fullmatch(
        r"crank\.eccentricity = (\S+) mm \(with pin_shaft\.hole_radius = (\S+) mm\) or "
        r"pin_wheel\.pin_circle_radius = (\S+) mm leaves a radius, 0\.1 of that of the pins",
        told,
    ).groups()
    for changes in ({"eccentricity": eccentricity, "hole_radius": hole}, {"pin_circle_radius": circle}):
        drive = public(name, **changes)
        parameter = np.linspace(0.0, 2.0 * np.pi / drive.reduction_ratio, 20_001)
        sharpest = 1.0 / FlankProfile.of_drive(drive).curvature(parameter).max()
        assert sharpest == pytest.approx(0.1 * drive.pin_wheel.pin_radius, rel=0.1)
        found = analyse(drive, position_angles(4))
        assert not [line for line in found.warnings if "than the flank goes on" in line]


@pytest.mark.parametrize(("pins", "circle", "pin"), [(14, 88.0, 6.5), (50, 50.0, 1.5708), (8, 100.0, 15.0)])
def test_the_largest_eccentricity_is_where_the_path_bends_as_the_equidistant_does(pins, circle, pin):
    """By sampled curvatures of the path of the pin centres: no more than 1/r just below it, more just above."""
    values = {
        "pin_wheel.number_of_pins": pins, "disc.number_of_teeth": pins - 1, "pin_wheel.pin_circle_radius": circle,
        "pin_wheel.pin_radius": pin, "disc.equidistant_offset": 0.0, "disc.shifting_offset": 0.0,
    }  # fmt: skip
    largest = largest_eccentricity(with_fields(PAPER, {**values, "crank.eccentricity": circle / pins}, check=False))

    def sharpest(eccentricity):
        path = FlankProfile(generating_radius=circle, eccentricity=eccentricity, reduction_ratio=pins, offset=0.0)
        return path.locus(np.linspace(0.0, 2.0 * np.pi / pins, 100_001)).curvature.max()

    # Bisections leave 1e-9 of the eccentricity, samples 1e-9 of the curvature.
    assert sharpest(largest * (1.0 - 1e-6)) < 1.0 / pin < sharpest(largest * (1.0 + 1e-6))


@pytest.mark.parametrize(
    ("values", "path", "bound", "other"),
    [
        (
            {"crank.eccentricity": 4.6},
            "crank.eccentricity",
            ("at most", pytest.approx(4.0)),
            "pin_shaft.hole_radius at least 14.675 mm",
        ),
        (
            {"pin_shaft.hole_radius": 13.9, "crank.eccentricity": 4.6},
            "crank.eccentricity",
            ("at most", pytest.approx(3.825)),
            "pin_shaft.hole_radius at least 14.675 mm",
        ),
        (
            {"crank.eccentricity": 4.6, "pin_shaft.hole_radius": 13.9},
            "pin_shaft.hole_radius",
            ("at least", pytest.approx(14.675)),
            "crank.eccentricity at most 3.825 mm",
        ),
        (
            {"pin_shaft.hole_radius": 13.0},
            "pin_shaft.hole_radius",
            ("at least", pytest.approx(14.075)),
            "crank.eccentricity at most ",
        ),
        (
            {"pin_wheel.pin_circle_radius": 55.0, "pin_shaft.pin_circle_radius": 44.0},
            "pin_wheel.pin_circle_radius",
            ("at least", ANY),
            "crank.eccentricity at most ",
        ),
    ],
)
def test_the_field_that_a_study_changed_is_named(values, path, bound, other):
    """A sweep over the eccentricity was told of the holes, which it had not touched."""
    with pytest.raises(DriveError) as caught:
        with_fields(PAPER, values)
    problem = caught.value.problems[0]
    assert (problem.path, problem.subject) == (path, f"{path} = {values[path]:g} mm")
    assert problem.bound == bound
    assert f" or {other}" in problem.said


@pytest.mark.parametrize(
    ("part", "field", "value", "side"),
    [
        ("disc", "equidistant_offset", -0.45, "least"), ("crank_bearing", "roller_radius", 5.6, "most"),
        ("pin_shaft", "hole_radius", 13.0, "least"), ("crank", "eccentricity", 4.6, "most"),
    ],
)  # fmt: skip
def test_suggested_values_leave_no_overlap(part, field, value, side, paper_table):
    """Bounds were those up to which bodies yield elastically: the drive was taken, preloaded, with a warning."""
    with pytest.raises(DriveError) as caught:
        build_drive(paper_table(**{part: {field: value}}))
    (problem,) = caught.value.problems
    if problem.path != f"{part}.{field}":  # a bound of either of two fields
        problem = problem.other_first
    assert problem.path == f"{part}.{field}"
    drive = build_drive(paper_table(**{part: {field: float(suggested(problem, f"at {side}"))}}))
    assert min(drawn_plays(drive).values()) >= -1e-9


def test_bounds_are_cut_off_to_their_sound_side():
    assert [rounded_down(value) for value in (1.23456, 0.25, 2.925, 4.0, 0.0)] == pytest.approx(
        [1.234, 0.25, 2.925, 4.0, 0.0]
    )
    assert -rounded_down(-80.01234) == pytest.approx(80.02)
