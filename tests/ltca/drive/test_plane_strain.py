"""What two dimensions cannot say is refused by name."""

from __future__ import annotations

import pytest

from ltca.drive.plane_strain import require_plane_strain
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.writing import drive_text

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
        require_plane_strain(drive, "compliance fe")
    assert len(refused.value.problems) == len(named)
    for problem, start in zip(refused.value.problems, named, strict=True):
        assert problem == f"{profile}.{start}: must be 0 in two dimensions (compliance fe); use --compliance hybrid"


def test_shorter_rollers_are_refused(paper_cases):
    drive = with_fields(paper_cases["CS-1"], {"crank_bearing.roller_length": 8.0})
    with pytest.raises(
        DriveError,
        match=r"crank_bearing.roller_length = 8 mm: must be 11.8 mm, the thickness .*use --compliance hybrid",
    ):
        require_plane_strain(drive, "full finite elements")


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
    require_plane_strain(with_fields(paper_cases["CS-6"], fields), "compliance fe")


def test_a_file_says_whether_shaft_pins_yield(paper_cases):
    """True where nothing is said; what is written reads back; the shape of the bodies does not know it."""
    assert not paper_cases["CS-1"].pin_shaft.elastic_contact
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]
    assert joint.pin_shaft.elastic_contact
    for value in (True, False):
        own = with_fields(joint, {"pin_shaft.elastic_contact": value})
        assert parse_drive(drive_text(own)).cases["nominal"] == own
        assert single_discs(own)[0].body_shape() == single_discs(joint)[0].body_shape()
