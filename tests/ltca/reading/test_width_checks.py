"""Slices along the width, what needs them, and how far parts may lean: one clear line each."""

from __future__ import annotations

from dataclasses import replace

import pytest
from refusals import error_says, refused_field

from ltca.drive.declaration import declared_fields
from ltca.drive.engine_support import require
from ltca.drive.fields import field_kinds, own_paths, read_field
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.members.width import needs_slices
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.physical_checks import is_sound
from ltca.reading.writing import drive_text
from ltca.studies.optimiser import parse_variable
from ltca.testing.field_changes import sensible_change

SLICES = {"contact.slices": 5}
NEEDING = sorted(path.replace(".N.", ".0.") for path in declared_fields() if needs_slices(path))


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-1"]


def test_the_fields_of_the_width_are_those_of_the_issue():
    parts = ("pin_wheel.pin_errors", "pin_shaft.pin_errors", "disc.hole_errors", "disc.of.0.hole_errors")
    leads = ("lead_crown_drop", "lead_relief_length", "lead_relief_depth", "lead_slope")
    assert (
        sorted(
            [
                *(f"{part}.inclination.{axis}" for part in ("pin_wheel", "pin_shaft", "crank") for axis in "xy"),
                *(f"{part}.inclination_{axis}" for part in parts for axis in "xy"),
                *(f"{table}.{lead}" for table in ("disc", "disc.of.0") for lead in leads),
                "disc.axial_play",
                "main_bearing.tilt_stiffness",
            ]
        )
        == NEEDING
    )


@pytest.mark.parametrize("path", NEEDING)
def test_what_tilts_or_is_crowned_needs_slices(path, paper):
    """Refused by the name of the slices, also where cheap checks look alone; zeros mean the same as leaving it out."""
    given = {"main_bearing.radial_stiffness": 1e6} if path.startswith("main_bearing.") else {}
    base = with_fields(paper, given)
    value = 1e9 if given else 0.1 if path.endswith("play") else sensible_change(base, path)
    said = (f"must be odd, 3 to 65, with {path} = ", ": nothing varies")
    with refused_field("contact.slices", "= 1", *said):
        with_fields(base, {path: value})
    assert not is_sound(with_fields(base, {path: value}, check=False))
    if value != 1e9 and not path.endswith("play"):
        nothing = tuple(0.0 for _ in value) if isinstance(value, tuple) else 0.0
        assert is_sound(with_fields(base, {path: nothing}))


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (
            "[disc.hole_errors]\ninclination_x = [1e-4, 0, 0]",
            "disc.hole_errors.inclination_x has 3 values: must be left out, the drive has no holes without [pin_shaft]",
        ),
        (
            "[disc.hole_errors]\nradial = [1e-4]",
            "disc.hole_errors.radial has 1 value: must be left out, the drive has no holes without [pin_shaft]",
        ),
        (
            "[pin_shaft]\ninclination = {x = 1e-4, y = 0.0}",
            "pin_shaft: number_of_pins, pin_circle_radius, pin_radius and hole_radius are missing; without them the drive has no "
            "pin shaft, and nothing of it is used",
        ),
    ],
)
def test_what_a_drive_without_a_pin_shaft_has_not_got(table, message):
    """Holes of an rv "must have 0, one for each of the holes", and an inclined shaft asked for four fields one by one."""
    with pytest.raises(DriveError) as caught:
        parse_drive(f"{shipped_drive('rv')}\n[contact]\nslices = 5\n{table}\n", "rv")
    assert list(caught.value.problems) == [message]


@pytest.mark.parametrize(
    ("text", "angle"), [("0.5 mrad", 5e-4), ("500 µrad", 5e-4), ("0.5 mm/m", 5e-4), ("2'", 2 * 2.908882086657216e-4)]
)
def test_angles_as_drawings_give_them(text, angle, paper):
    """2.9088820866e-4 rad are a minute of arc."""
    drive = with_fields(paper, SLICES | {"pin_shaft.inclination.x": text, "disc.lead_slope": text})
    assert drive.pin_shaft.inclination.x == pytest.approx(angle, rel=1e-12)
    assert drive.disc.lead_slope == drive.pin_shaft.inclination.x


def test_every_field_is_written_and_read_back(paper):
    sizes = {path: sensible_change(paper, path) for path in NEEDING if not path.startswith(("main_", "disc.axial"))}
    drive = with_fields(paper, SLICES | sizes | {"disc.axial_play": 0.2, "disc.lead_relief_length": 2.0})
    assert parse_drive(drive_text(drive)).cases["nominal"] == drive


def test_each_disc_may_have_a_lead_of_its_own(paper):
    two = with_fields(
        paper, SLICES | {"disc.number_of_discs": 2, "disc.lead_slope": 1e-4, "disc.of.1.lead_slope": -1e-4}
    )
    two = with_fields(two, {"disc.of.0.lead_crown_drop": 0.004})
    first, second = single_discs(two)
    assert (first.disc.lead_slope, second.disc.lead_slope) == (1e-4, -1e-4)
    assert (first.disc.lead_crown_drop, second.disc.lead_crown_drop) == (0.004, 0.0)
    assert read_field(two, "disc.of.0.lead_slope") == 1e-4
    assert own_paths(two, "disc.lead_slope") == ("disc.of.0.lead_slope", "disc.of.1.lead_slope")


def test_leads_grow_with_their_disc_and_angles_do_not(paper):
    lead = {
        "disc.lead_crown_drop": 0.01,
        "disc.lead_relief_length": 2.0,
        "disc.lead_relief_depth": 0.02,
        "disc.lead_slope": 1e-4,
    }
    warmth = {
        f"materials.{part}.thermal_expansion": 1e-5
        for part in ("disc", "roller", "wheel_pin", "inner_race", "shaft_pin")
    }
    drive = with_fields(paper, SLICES | lead | warmth | {"pin_wheel.inclination.x": 1e-4, "temperature.disc": 120.0})
    warm = warm_drive(drive)
    for path, value in lead.items():
        factor = 1.0 if path.endswith("slope") else 1.001  # 100 K at 1e-5/K
        assert read_field(warm, path) == pytest.approx(factor * value, rel=1e-12), path
    assert warm.pin_wheel.inclination == drive.pin_wheel.inclination


@pytest.mark.parametrize(
    ("engine", "words"),
    [
        ("paper", "method paper (discs do not tilt in the model); use --method tables"),
        ("full FE", "full finite elements (the model is two-dimensional: "),
    ],
)
def test_engines_of_one_plane_refuse_slices_by_name(engine, words, paper):
    drive = with_fields(paper, SLICES)
    with pytest.raises(DriveError) as refused:
        require(drive, engine)
    assert refused.value.problems[0].startswith(f"contact.slices = 5: must be 1 for {words}")
    require(replace(drive, contact=paper.contact), engine)
    for other in ("direct", "hybrid", "fe"):
        require(drive, other)


def test_a_misspelt_lead_is_told_in_a_plane_drive(paper):
    """What needs slices is a field of a plane drive too: its name is found."""
    with error_says(DriveError, "did you mean `disc.lead_slope`"):
        with_fields(paper, {"disc.lead_slop": 1e-4})


def test_shipped_drives_are_plane():
    for name in ("paper", "robot-joint", "rv", "sleeved"):
        for drive in parse_drive(shipped_drive(name), name).cases.values():
            assert drive.contact.slices == 1
    assert all(kind.unit in ("rad", "mm", "N*mm/rad") for path, kind in field_kinds().items() if needs_slices(path))


def test_nothing_of_the_width_is_varied_in_a_plane_drive(paper):
    """An optimisation ended with "none of 87 candidates is sound"."""
    with error_says(DriveError, starts="--vary disc.lead_crown_drop: needs slices along the width, contact.slices = 3"):
        parse_variable("disc.lead_crown_drop=0:0.01", paper)
    found = parse_variable("lead_crown_drop=0:10 um", with_fields(paper, SLICES))
    assert (found.path, found.low, found.high) == ("disc.lead_crown_drop", 0.0, 0.01)
