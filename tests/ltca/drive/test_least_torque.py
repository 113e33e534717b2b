"""The least torque that can be balanced, and values so small or large that questions about units divided by zero."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from refusals import error_says, refused_field

import ltca
from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.drive.declaration import declared_fields
from ltca.drive.least_torque import least_torque
from ltca.drive.members.limits import parse_limits
from ltca.drive.unit_mistakes import likely_unit_mistakes, limit_warnings, unit_warnings
from ltca.drive.units.quantities import parse_quantity
from ltca.errors import CycloError, DriveError
from ltca.quantities import LIMITED
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

EXTREME = (5e-324, 1e-320, 1e-200, 1e-30, 1e-9, 1e9, 1e200, 1e300)


@cache
def drive_of(name):
    path = Path(__file__).parents[3] / "examples" / "drives" / f"{name}.toml"
    return next(iter(load_drive(path if path.exists() else name).cases.values()))


def test_the_least_torque_of_the_paper_by_hand():
    """4 ε R π E*/10 t: 8.88e-16 · 88 mm · 4.2e5 N/mm is 3.3e-8 N, 1e-5 of 3.3 mN; on the lever e u of 56 mm 0.18 N·mm."""
    drive = drive_of("paper")
    modulus = 206e3 / (1.0 - 0.3**2) / 2.0
    stiffness = np.pi * modulus * drive.disc.thickness / 10.0
    load = 4.0 * 2.0**-52 * 88.0 * stiffness / 1e-5
    assert least_torque(drive) == pytest.approx(load * 4.0 * 14.0, rel=1e-12)


@pytest.mark.parametrize("name", ["paper", "robot-joint", "rv", "sleeved", "plastic", "whole_reducer"])
def test_the_least_torque_is_far_below_every_light_torque(name):
    """Light torques down to 1e-5 of the torque of a drive are sound."""
    drive = drive_of(name)
    assert least_torque(drive) < 1e-6 * drive.load.torque
    assert with_fields(drive, {"load.light_torque": 1e-5 * drive.load.torque}).load.light_torque > 0.0


@pytest.mark.slow
def test_a_light_torque_of_a_hundred_thousandth_is_solved(positions_alone):
    drive = drive_of("paper")
    found = ltca.analyse(with_fields(drive, {"load.light_torque": 1e-5 * drive.load.torque}), 4)
    assert np.all(found.dataset["status_light"].values == 0)


@pytest.mark.slow
def test_a_micro_drive_of_a_millionth_of_a_newton_metre_is_solved(positions_alone):
    drive = drive_of("seven_lobes")
    small = with_fields(drive, {"load.torque": 1e-3, "load.light_torque": 3e-4})
    assert least_torque(small) < 3e-4
    found = ltca.analyse(small, 4)
    assert np.all(found.dataset["status"].values == 0)
    assert np.all(found.dataset["status_light"].values == 0)


@pytest.mark.parametrize("name", ["micro", "tied", "paper", "rv"])
@pytest.mark.parametrize("factor", [1.0, 10.0, 1000.0])
def test_a_torque_above_the_stated_bound_had_no_equilibrium_or_took_minutes(name, factor, positions_alone):
    """A clearance is a million approaches long: from first contact the steps along the flank were too short for it."""
    drive = drive_of("paper" if name == "tied" else "seven_lobes" if name == "micro" else name)
    if name == "tied":
        beam = {"pin_shaft.stiffness": None, "pin_shaft.beam.tip": "tied-clamped"}
        drive = with_fields(drive, {"materials.disc.youngs_modulus": 3000.0, "clearance.bearing": 0.05} | beam)
    torque = factor * least_torque(drive)
    light = with_fields(drive, {"load.torque": torque, "load.light_torque": torque})
    found = analyse(light, np.array([0.1, 2.3]), engine=HalfSpace())
    assert np.all(found.balanced)
    assert np.all(found.full.iterations < 50)


def test_shaft_pins_that_are_tied_add_their_stiffness_to_the_round_off():
    """Thick steel pins in a printed disc had no equilibrium up to ten times the stated bound."""
    drive = drive_of("paper")
    tied = with_fields(drive, {"pin_shaft.stiffness": None, "pin_shaft.beam.tip": "tied-clamped"})
    line = np.pi * 206e3 / (1.0 - 0.3**2) / 2.0 * drive.disc.thickness / 10.0
    diameter, span = 2.0 * drive.pin_shaft.pin_radius, tied.shaft_pin_span
    beam = 12.0 * 206e3 * np.pi * diameter**4 / 64.0 / span**3
    assert least_torque(tied) == pytest.approx((1.0 + beam / line) * least_torque(drive), rel=1e-12)
    free = with_fields(drive, {"pin_shaft.stiffness": None, "pin_shaft.beam.tip": "free"})
    assert least_torque(free) == least_torque(drive)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("load.torque", 5e-324, "load.torque = 5e-324: must be 0 or at least 1e-09 N·mm"),
        ("load.torque", 1e-200, "load.torque = 1e-200: must be 0 or at least 1e-09 N·mm"),
        ("load.torque", 0.01, "load.torque = 0.01 N·mm: must be 0 or at least 0.18 N·mm in this drive"),
        ("load.light_torque", 1e-6, "load.light_torque = 1e-06 N·mm: must be at least 0.18 N·mm in this drive"),
    ],
)
def test_a_torque_below_round_off_is_refused_in_the_file(field, value, words):
    """5e-324 ended in a division by zero, 1e-200 in 800 iterations and "no equilibrium"."""
    with pytest.raises(DriveError) as caught:
        with_fields(drive_of("paper"), {field: value})
    (problem,) = caught.value.problems
    assert problem.startswith(words)


def test_a_torque_of_a_duty_below_round_off_is_refused():
    with refused_field(
        "duty.0.torque",
        "= 0.01 N·mm",
        "at least 0.18 N·mm in this drive",
        bound=("at least", least_torque(drive_of("paper"))),
        alone=True,
    ):
        with_fields(drive_of("paper"), {"duty.0.torque": 0.01, "duty.0.speed": 1.0, "duty.0.share": 1.0})


@pytest.mark.parametrize("torque", [5e-324, 1e-200, 1e-5])
def test_a_torque_below_round_off_is_refused_as_an_argument(torque):
    with error_says(DriveError, ": must be ", "N·mm", starts="torque = "):
        ltca.analyse(drive_of("paper"), 1, torque=torque)


@pytest.mark.parametrize("words", [["run"], ["check"]], ids=str)
@pytest.mark.parametrize("torque", ["5e-324", "1e-200", "1e-5"])
def test_a_torque_below_round_off_is_refused_as_an_option_with_a_line(words, torque, tmp_path, capsys):
    out = tmp_path / "out"
    assert main([*words, "paper", "--compliance", "half-space", "--torque", torque, "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert f"torque = {torque}" in said.replace("1e-05", "1e-5")
    assert "N·mm" in said
    assert said.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize("name", ["paper", "whole_reducer"])
def test_no_field_of_extreme_size_divides_by_zero(name):
    """A force from outside of 5e-324 N, a plane of a bearing, a thickness whose span is out of range: three faults more."""
    drive, accepted = drive_of(name), 0
    for path, field in declared_fields().items():
        if field.kind != "quantity" or field.is_array:
            continue
        for value in EXTREME:
            try:
                changed = with_fields(drive, {path.replace(".N.", ".0."): value})
            except CycloError:
                continue
            accepted += 1
            for told in (*unit_warnings(changed), *likely_unit_mistakes(changed)):
                assert "\n" not in told
    assert accepted > 20


def test_a_span_that_follows_from_the_discs_is_bounded():
    """A ValidationError of pydantic was raised for pins whose span is left out."""
    said = ("pin_shaft.beam.span = ", " mm, from the first disc to the last: must be at most 1e+06 mm")
    with refused_field("disc.thickness", "= 1e+06 mm", *said, bound=("at most", pytest.approx(0.5e6, rel=1e-3))):
        with_fields(drive_of("leaning_pins"), {"disc.thickness": 1e6})


@pytest.mark.parametrize("value", [0, 5e-324, 1e-200])
def test_a_limit_of_no_pressure_is_refused(value):
    """`max_pin_pressure_mid = 0` ended in a division by zero."""
    problems = []
    assert not parse_limits({"max_pin_pressure_mid": value}, problems)
    (problem,) = problems
    assert problem in {
        "limits.max_pin_pressure_mid = 0: must be greater than 0 MPa",
        f"limits.max_pin_pressure_mid = {value}: must be at least 1e-06 MPa",
    }


def test_limits_of_extreme_size_are_told_or_refused():
    drive, accepted = drive_of("paper"), 0
    for name in LIMITED:
        for sense in ("max", "min"):
            for value in (0.0, *EXTREME):
                limits = parse_limits({f"{sense}_{name}": value}, [])
                accepted += len(limits)
                for told in limit_warnings(drive, limits.values()):
                    assert "\n" not in told
    assert accepted > 100


def test_a_tiny_torque_is_no_torque_but_zero_is():
    assert parse_quantity("0", "N*mm", "--torque", ge=0.0) == 0.0
    with pytest.raises(DriveError, match="must be 0 or at least 1e-09 N·mm"):
        parse_quantity("1e-10", "N*mm", "--torque", ge=0.0)


def test_a_light_torque_that_nobody_wrote_is_named_as_left_out():
    """Of a torque some ten times the least one the message named a field that is not in the file."""
    lines = [line for line in shipped_drive("paper").splitlines() if not line.startswith("light_torque")]
    torque = 10.0 * least_torque(drive_of("paper"))
    text = "\n".join(f"torque = {torque!r}" if line.startswith("torque = ") else line for line in lines)
    with error_says(DriveError, "load.light_torque, left out and so 3 % of load.torque as written, = ") as refused:
        parse_drive(text)
    assert "load.torque = " not in str(refused.value)
