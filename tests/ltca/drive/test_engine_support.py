"""Fields that an engine cannot represent are refused by name."""

from __future__ import annotations

from dataclasses import replace

import pytest
from refusals import error_says, refused_field

from ltca.drive.declaration import declared_fields, declared_tables
from ltca.drive.engine_support import ENGINES, REFUSALS, refusals, require
from ltca.drive.members.main_bearing import BearingRow
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.testing.field_changes import EXCEPTIONS

PROFILES = ("crank_bearing.roller_profile", "pin_wheel.pin_profile")


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"crown_drop": 0.003}, ["crown_drop = 0.003 mm"]),
        ({"logarithmic_factor": 1.0}, ["logarithmic_factor = 1"]),
        (
            {"end_relief_length": 1.0, "end_relief_depth": 0.01},
            ["end_relief_length = 1 mm", "end_relief_depth = 0.01 mm"],
        ),
    ],
)
def test_crown_and_relief_are_refused(profile, fields, named, paper_cases):
    drive = with_fields(paper_cases["CS-1"], {f"{profile}.{name}": value for name, value in fields.items()})
    with pytest.raises(DriveError) as refused:
        require(drive, "fe")
    (problem,) = refused.value.problems
    told = ", ".join(f"{profile}.{field}" for field in named)
    assert problem.startswith(f"{profile} ({told}): must be left out for compliance fe (the model is two-dimensional")
    assert problem.endswith("; use --compliance hybrid")


def test_shorter_rollers_are_refused(paper_cases):
    drive = with_fields(paper_cases["CS-1"], {"crank_bearing.roller_length": 8.0})
    with refused_field(
        "crank_bearing.roller_length", "= 8 mm", "(disc.thickness)", "use --compliance hybrid", bound=("equal to", 11.8)
    ):
        require(drive, "full FE")


@pytest.mark.parametrize("engine", sorted({engine for row in REFUSALS for engine in row.engines}))
def test_every_problem_is_named_at_once(engine):
    """All rows of an engine, on a drive that has everything: one sentence each, with the path, the engine and the reason."""
    drive = with_fields(
        parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"],
        {
            "pin_wheel.beam.span": 40.0,
            "pin_wheel.beam.ends": "supported",
            "pin_shaft.beam.span": 40.0,
            "pin_shaft.beam.tip": "free",
            "pin_shaft.stiffness": None,
            "first_stage.sun_teeth": 20,
            "first_stage.planet_teeth": 40,
            "first_stage.plane": 40.0,
            "load.external.0.force.x": 100.0,
            "pin_wheel.support_stiffness": 5e5,
            "main_bearing.clearance": 0.01,
            "main_bearing.preload.force": 100.0,
            "main_bearing.tilt_stiffness": 1e9,
            "contact.slices": 5,
            "pin_wheel.axis_offset.y": 0.01,
            "pin_wheel.pin_profile.crown_drop": 0.002,
            "crank_bearing.roller_length": 8.0,
            "crank_bearing.roller_profile.logarithmic_factor": 1.0,
            "crank.support.diameter": 20.0,
            "crank.support.positions": (-20.0, 20.0),
            "crank.support.stiffness": (2e5, 3e5),
            "crank.support.clearance": 0.01,
            "crank.support.preload.force": 100.0,
            "crank.support.torsion": True,
            "carrier.stiffness_torsion": 1e8,
            "carrier.flange": (8.0, 10.0),
            "carrier.posts.number": 4,
            "carrier.posts.radius": 44.0,
            "carrier.posts.size": 10.0,
            "friction.pin": 0.05,
            "ring.inner_radius": 70.0,
            "ring.outer_radius": 90.0,
            "ring.width": 30.0,
            "crank.inclination.x": 1e-4,
            "pin_wheel.inclination.x": 1e-4,
            "pin_wheel.pin_errors.inclination_x.0": 1e-4,
            "pin_wheel.pin_errors.inclination_y.0": 1e-4,
            "pin_shaft.inclination.x": 1e-4,
            "pin_shaft.pin_errors.inclination_x.0": 1e-4,
            "pin_shaft.pin_errors.inclination_y.0": 1e-4,
            "disc.hole_errors.inclination_x.0": 1e-4,
            "disc.hole_errors.inclination_y.0": 1e-4,
            "disc.axial_play": 0.1,
        },
        check=False,
    )
    row = BearingRow(plane=0.0, kind="cylindrical", radial_stiffness=1e5)
    drive = replace(drive, main_bearing=replace(drive.main_bearing, bearings=(row,)))
    of_cranks = ("crank.number", "crank.circle_radius", "crank.angle", "disc.of.", "installation.")
    rows = [row for row in REFUSALS if engine in row.engines and not row.path.startswith(of_cranks)]
    with pytest.raises(DriveError) as refused:
        require(drive, engine)
    for row, problem in zip(rows, refused.value.problems, strict=True):
        path = row.path.replace(".N", ".0")
        assert problem.startswith((f"{path} = ", f"{path} (")), problem
        assert f" ({row.reason})" in problem


def test_tables_in_a_refused_table_are_told():
    """A ring with a material or bolts ended the paper's method in a TypeError."""
    ring = {"inner_radius": 88.0, "outer_radius": 105.0, "width": 20.0, "material.youngs_modulus": 1.7e5}
    bolts = {"number": 8, "circle_radius": 100.0, "stiffness": 5e5}
    changes = {f"ring.{name}": value for name, value in ring.items()}
    changes |= {f"ring.bolts.{name}": value for name, value in bolts.items()}
    drive = with_fields(load_drive("paper").cases["CS-1"], changes)
    with error_says(DriveError, "ring.material.youngs_modulus = 170000 MPa, ring.bolts.number = 8, ", starts="ring ("):
        require(drive, "paper")


def test_fields_of_several_cranks_are_refused_together():
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    drive = with_fields(drive, {"crank.angle": 0.3, "disc.of.1.bore_errors.radial.0": 0.001})
    with pytest.raises(DriveError) as refused:
        require(drive, "paper")
    told = {problem.partition(" ")[0]: problem for problem in refused.value.problems}
    assert told["crank.number"] == "crank.number = 3: must be 1 for method paper (the model has one crank)"
    assert told["crank.angle"].startswith("crank.angle = 0.3 rad: must be 0 rad")
    assert "disc.of.1.bore_errors.radial = [0.001, 0, 0]" in told["disc.of.1.bore_errors"]
    assert {"crank.circle_radius", "installation.first_stage_ratio", "disc.number_of_discs"} <= set(told)


def test_the_table_names_fields_and_engines():
    declared = {*declared_fields(), *declared_tables()}
    for row in REFUSALS:
        assert row.path in declared, row.path
        assert row.equals == "" or row.equals in declared, row.path
    assert set(ENGINES) == set(EXCEPTIONS) - {"curves", "studies", "dynamics", "time"}
    assert refusals("friction.pin") == {"the model is frictionless": ["direct", "paper", "full FE"]}


@pytest.mark.parametrize(
    "fields",
    [
        {},
        # without a length a depth relieves nothing, nor a length without a depth
        {"crank_bearing.roller_profile.end_relief_depth": 0.01},
        {"pin_wheel.pin_profile.end_relief_length": 1.0},
        # 11.8 mm from a drawing in inches
        {"crank_bearing.roller_length": 11.8 / 25.4 * 25.4 * (1.0 + 1e-15)},
    ],
)
def test_even_drives_are_taken(fields, paper_cases):
    require(with_fields(paper_cases["CS-6"], fields), "fe")


def test_a_file_says_whether_shaft_pins_yield(paper_cases):
    """True where nothing is said; what is written reads back; the shape of the bodies does not know it."""
    assert not paper_cases["CS-1"].pin_shaft.elastic_contact
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]
    assert joint.pin_shaft.elastic_contact
    for value in (True, False):
        own = with_fields(joint, {"pin_shaft.elastic_contact": value})
        assert parse_drive(drive_text(own)).cases["nominal"] == own
        assert single_discs(own)[0].body_shape() == single_discs(joint)[0].body_shape()
