"""A rejected or failed value of a sweep is blamed on the field that was varied, with its value."""

from __future__ import annotations

import pytest

from ltca.analysis.engines import HalfSpace
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies.study import run_batch
from ltca.studies.sweep_file import parse_sweep

QUANTITIES = ["max_pin_load"]
COUNTS = {
    # Path, a number that goes with the rest of the drive, and the next one, which does not.
    "paper": ("pin_shaft.number_of_pins", 12, 13),
    "sleeved": ("disc.number_of_discs", 2, 3),
    "robot-joint": ("pin_shaft.number_of_pins", 19, 20),
}


def messages(drive, factors, **design):
    """Why each sample of a sweep failed."""
    study = parse_sweep(
        {"positions": 2, "quantities": QUANTITIES, "factors": factors, **design}, drive, engine=HalfSpace()
    )
    return run_batch(study, 0).messages


@pytest.mark.parametrize(
    ("drive", "path", "value"),
    [
        ("paper", "pin_wheel.number_of_pins", 28),
        ("paper", "pin_shaft.number_of_pins", 40),
        ("paper", "crank_bearing.number_of_rollers", 40),
        ("paper", "crank.eccentricity", 5.0),
        ("paper", "clearance.bearing", 9.0),
        ("sleeved", "disc.number_of_discs", 3),
        ("sleeved", "disc.gap", 40.0),
    ],
)
def test_a_rejected_value_of_a_sweep_was_blamed_on_another_field(drive, path, value):
    """`pin_shaft.pin_radius = 10.075 mm: must be less than 4.39 mm` was said of a sweep of the number of pins."""
    good, wrong = messages(drive, {path: [load_value(drive, path), value]})
    assert good == ""
    assert wrong.startswith(f"{path} = {value:g}")


def load_value(drive, path):
    part = next(iter(load_drive(drive).cases.values()))
    for name in path.split("."):
        part = getattr(part, name)
    return part


@pytest.mark.parametrize(
    ("path", "value", "shown"),
    [
        ("disc.thickness", 0.02, "disc.thickness = 0.02 mm: "),
        ("pin_wheel.support_stiffness", 1.0, "pin_wheel.support_stiffness = 1 N/mm: "),
        ("materials.disc.youngs_modulus", 1.0, "materials.disc.youngs_modulus = 1 MPa: "),
    ],
)
def test_a_value_that_has_no_answer_was_blamed_on_the_torque_or_on_nothing(path, value, shown):
    (message,) = messages("paper", {path: [value]})
    assert message.startswith(shown)
    assert len(message) > len(shown) + 20


def test_cases_beside_the_field_do_not_hide_it():
    first, second = messages("paper", {"case": ["CS-1", "CS-2"], "disc.thickness": [0.02]})
    assert first.startswith("disc.thickness = 0.02 mm: ")
    assert second.startswith("disc.thickness = 0.02 mm: ")


def test_a_sample_of_several_factors_keeps_its_message():
    """The values of a sample of many factors stand in its row; messages that agree are counted together."""
    factors = {"disc.thickness": [0.02], "clearance.pin_hole": [0.0]}
    (message,) = messages("paper", factors)
    assert message
    assert not message.startswith("disc.thickness")


@pytest.mark.parametrize("drive", COUNTS)
def test_the_bound_of_a_changed_count_is_the_last_that_goes_with_the_rest(drive):
    path, most, wrong = COUNTS[drive]
    base = next(iter(load_drive(drive).cases.values()))
    with_fields(base, {path: most})
    for count in (wrong, wrong + 3):
        with pytest.raises(DriveError) as caught:
            with_fields(base, {path: count})
        (problem,) = caught.value.problems
        assert problem.path == path
        assert problem.startswith(f"{path} = {count}: must be at most {most} for the rest of the drive: ")


def test_a_count_that_others_go_with_has_one_value():
    with pytest.raises(DriveError) as caught:
        with_fields(load_drive("paper").cases["CS-1"], {"pin_wheel.number_of_pins": 28})
    (problem,) = caught.value.problems
    assert problem.startswith(
        "pin_wheel.number_of_pins = 28: must be 14 for the rest of the drive: disc.number_of_teeth = 13: "
    )


def test_a_torque_of_a_sweep_beyond_the_bound_of_a_run_was_searched_for():
    good, wrong = messages("paper", {"load.torque": [377_300.0, 1e12]})
    assert good == ""
    assert wrong.startswith("load.torque = 1e+12 N·mm")
    assert "must be at most 1.08e+08 N·mm" in wrong
