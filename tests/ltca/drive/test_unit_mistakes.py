"""A drive that cannot carry its load names the number in a wrong unit; a soft drive under a light torque is sound."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.unit_mistakes import explain_failure, likely_unit_mistakes, stiffness_warning
from ltca.errors import ConvergenceError, CycloError, DriveError
from ltca.reading.changes import with_fields

ANGLE = np.array([0.5])


def all_of(modulus):
    return {part: {"youngs_modulus": modulus} for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")}


@pytest.mark.slow
def test_gigapascals_as_plain_number(vary):
    """E = 206 ended in 'the teeth slip'."""
    with pytest.raises(DriveError) as caught:
        analyse(vary(materials=all_of(206.0)), ANGLE)
    assert "youngs_modulus = 206 MPa is softer" in str(caught.value)
    assert '206000 or "206 GPa"' in str(caught.value)
    assert "slip" not in str(caught.value)


@pytest.mark.slow
def test_a_torque_a_thousand_times_too_large(vary):
    with pytest.raises(
        DriveError, match=r"^load.torque = 3.773e\+08 N·mm is 377300 N·m and would press .*\"377.3 N m\""
    ):
        analyse(vary(load={"torque": 377.3e6}), ANGLE)
    with pytest.raises(DriveError, match=r"^torque = 3.773e\+08 N·mm is"):
        analyse(vary(), ANGLE, 377.3e6)


def test_a_light_torque_beyond_reason(vary):
    """It was 'no equilibrium … the teeth slip': only the torque itself was looked at."""
    with pytest.raises(DriveError, match=r"^load.light_torque = 1e\+09 N·mm is 1e\+06 N·m and would press"):
        analyse(vary(load={"light_torque": 1e9}), ANGLE)


@pytest.mark.slow
def test_a_stiffness_in_another_unit(vary):
    with pytest.raises(DriveError, match=r"pin_shaft.stiffness = 1 N/mm: a shaft pin would yield by"):
        analyse(vary(pin_shaft={"stiffness": 1.0}), ANGLE)


@pytest.mark.parametrize(("modulus", "torque"), [(3000.0, 20_000.0), (30.0, 300.0)])
def test_printed_plastics_are_sound(modulus, torque, vary):
    """PLA has some 3000 MPa, TPU 30 MPa: the drive balances, and its bearing carries T/(u e)."""
    found = analyse(vary(materials=all_of(modulus), load={"torque": torque, "light_torque": 0.1 * torque}), ANGLE)
    # One position about the mean over the turn, which is exact: they swing by less than 1 %, a wrong unit by 1000.
    assert found.bearing_tangential[0] == pytest.approx(torque / (14 * 4.0), rel=0.01)


def test_what_is_in_order_is_not_explained(vary):
    drive = vary()
    assert likely_unit_mistakes(drive) == []
    lost = ConvergenceError("no equilibrium")
    assert explain_failure(lost, drive) is lost
    other = CycloError("a file is missing")
    assert explain_failure(other, vary(materials=all_of(206.0))) is other


@pytest.mark.parametrize(
    ("pins", "beam"), [("pin_wheel", {"ends": "clamped"}), ("pin_shaft", {"tip": "free", "diameter": 4.0})]
)
def test_pins_that_bend_out_of_their_place(pins, beam, vary):
    """A span typed in micrometres makes a pin that bends by metres."""
    changes = {f"{pins}.beam.span": 24_000.0} | {f"{pins}.beam.{name}": value for name, value in beam.items()}
    changes |= {"pin_shaft.stiffness": None} if pins == "pin_shaft" else {}
    (told,) = likely_unit_mistakes(with_fields(vary(), changes))
    assert told.startswith(f"{pins}.beam.span = 24000 mm: a pin of")
    assert not likely_unit_mistakes(with_fields(vary(), changes | {f"{pins}.beam.span": 24.0}))


def test_pascals_are_warned_about(vary):
    assert stiffness_warning(vary()) is None
    assert "stiffer than diamond" in stiffness_warning(vary(materials={"disc": {"youngs_modulus": 206e9}}))


def test_one_part_in_gigapascals_is_warned_of(vary):
    """E = 206 of the shaft pins alone passed: everything balances, their pressure reads a twentieth."""
    told = stiffness_warning(vary(materials={"shaft_pin": {"youngs_modulus": 206.0}}))
    assert "materials.shaft_pin.youngs_modulus = 206 MPa, beside 206000 MPa of another part" in told
    assert '"206 GPa"' in told
    # a disc of plastic, a rubber drive, one part of TPU: no metal in GPa, or nothing beside it
    for materials in ({"disc": {"youngs_modulus": 2600.0}}, all_of(206.0), {"disc": {"youngs_modulus": 30.0}}):
        assert stiffness_warning(vary(materials=materials)) is None
