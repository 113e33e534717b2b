"""Either member held: moments, ratio, and work at every position."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.torque_curve import torque_curve
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

ANGLES = np.array([0.31, 1.7, 4.4])


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-6"]


@pytest.fixture(scope="module")
def joint():
    return parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]


@pytest.mark.parametrize("direction", ["ccw", "cw"])
def test_held_wheel_is_the_same_drive_described_otherwise(paper, direction):
    """Where the wheel's moment is the same, so is every load; the output's deviation is that of the wheel times −z_P/z_C."""
    held = with_fields(paper, {"installation.held": "pin-wheel", "load.direction": direction})
    free = with_fields(paper, {"load.direction": direction})
    found = analyse(held, ANGLES)
    same = solve_equilibrium(HalfSpace().prepare(free).model, ANGLES, found.full.wheel_moment)
    np.testing.assert_allclose(found.full.response.pin_load, same.response.pin_load, rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(found.full.pose, same.pose, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(found.transmission_error, -14.0 / 13.0 * same.pose[:, WHEEL_ANGLE], rtol=1e-7)
    assert (held.transmission_ratio, free.transmission_ratio) == (-13.0, 14.0)
    # in the mean the housing bears T_out z_P/z_C; at a position what output and crank put on it
    model = HalfSpace().prepare(held).model
    crank = model.crank_moments(ANGLES, found.full.pose, found.full.response.parts).sum(axis=1)
    output = held.driving_sign * held.load.torque
    np.testing.assert_allclose(found.full.wheel_moment + crank + output, 0.0, atol=1e-8 * held.load.torque)
    np.testing.assert_array_equal(np.sign(found.full.wheel_moment), -held.driving_sign)


def test_moments_of_a_held_wheel_have_their_mean(paper):
    """|T_wheel| = T_out z_P/z_C in the mean over a turn: no work is stored over a turn but in rollers and cage."""
    held = with_fields(paper, {"installation.held": "pin-wheel"})
    found = analyse(held, position_angles(97))
    # one turn is no period of the rollers: plain means of sampled positions hold to 2e-4 (design)
    assert np.mean(found.full.wheel_moment) == pytest.approx(held.wheel_moment(), rel=2e-4)
    assert np.ptp(found.full.wheel_moment) > 1e-4 * held.load.torque


@pytest.mark.slow
def test_stiffness_and_play_at_the_output(paper):
    """Seen from the pin shaft: stiffness × (z_C/z_P)², backlash and lost motion × z_P/z_C."""
    held = torque_curve(with_fields(paper, {"installation.held": "pin-wheel"}), ANGLES, points=2)
    free = torque_curve(with_fields(paper, {"load.torque": paper.load.torque * 14.0 / 13.0}), ANGLES, points=2)
    # The wheel's moment is off its mean by w′, the slope of the transmission error: π · 10″ over a thirteenth of a turn, 3e-4.
    # Stiffness feels it whole, lost motion by the wind-up in it (a hundredth), backlash by that at a ten-thousandth of T.
    np.testing.assert_allclose(held.backlash, free.backlash * 14.0 / 13.0, rtol=1e-7)
    np.testing.assert_allclose(held.lost_motion, free.lost_motion * 14.0 / 13.0, rtol=5e-6)
    # a pin shaft that turns ccw turns the wheel cw against it: the two senses change places
    np.testing.assert_allclose(held.stiffness, free.stiffness[:, ::-1] * (13.0 / 14.0) ** 2, rtol=5e-4)
    assert np.all(np.diff(held.output_angle, axis=1) > 0.0)


@pytest.mark.slow
@pytest.mark.family(full=3)
@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
@pytest.mark.parametrize("discs", [1, 2, 3])
def test_virtual_work_at_every_position(joint, discs, held, stored):
    """T_C + T_W (1/u + w′) = U′ − Σ ∂U/∂ρ ρ′ with the cage's moment in T_C."""
    words = {"disc.number_of_discs": discs, "disc.phases": (), "disc.planes": (), "installation.held": held}
    drive = with_fields(joint, words)
    drive = with_fields(drive, {"disc.of.0.runout.amount": 0.003, "clearance.bearing": 0.02})
    model = HalfSpace().prepare(drive).model
    angle = 2.0 * np.pi * np.arange(5) / 5.0 + 0.05
    centre = solve_at_output(model, [drive], angle, drive.load.torque)
    crank = model.crank_moments(angle, centre.pose, centre.response.parts).sum(axis=1)
    slope = stored(model, centre.response, centre.pose)[1]

    def left(step):
        ends = []
        for side in (1.0, -1.0):
            at = angle + side * step
            found = solve_at_output(model, [drive], at, drive.load.torque, centre.pose)
            ends.append(
                (stored(model, found.response, found.pose)[0], found.pose[:, WHEEL_ANGLE], found.response.flank)
            )
        (up, wheel_up, flank_up), (down, wheel_down, flank_down) = ends
        turn = (wheel_up - wheel_down) / (2.0 * step)
        radii = (flank_up.effective_radius - flank_down.effective_radius) / (2.0 * step)
        work = (up - down) / (2.0 * step) - (slope * radii).sum(axis=1)
        return crank + centre.wheel_moment * (1.0 / drive.reduction_ratio + turn) - work

    # differences of second order, taken to fourth by two of them (Richardson)
    closed = (4.0 * left(1e-4) - left(2e-4)) / 3.0
    np.testing.assert_allclose(closed / drive.load.torque, 0.0, atol=1e-7)


PAGE = Path(__file__).parents[2] / "docs" / "theory" / "conventions.md"
DRIVES = {
    "one, central": ("robot-joint", {}),
    "several, turned in the carrier": ("rv", {"installation.first_stage_ratio": None}),
    "several, behind a first stage": ("rv", {}),
}


@pytest.mark.parametrize("cranks", DRIVES)
def test_conventions_had_the_formulas_of_a_central_crank_alone(cranks):
    """Its factor f by case: the output deviates by −f `wheel_angle`, the mean moment on the held wheel is −f T_out; its ratio."""
    table = re.findall(r"^  \| (one.*|several.*) \| (.*) \| (.*) \|$", PAGE.read_text(encoding="utf-8"), flags=re.M)
    assert [row[0] for row in table] == [*DRIVES]
    ((_, factor, ratio),) = [row for row in table if row[0] == cranks]
    name, changed = DRIVES[cranks]
    drive = with_fields(next(iter(load_drive(name).cases.values())), changed)
    pins, teeth = drive.pin_wheel.number_of_pins, drive.disc.number_of_teeth
    known = {"z_P": pins, "z_C": teeth, "Δz": pins - teeth, "u": pins / (pins - teeth)}
    if cranks.endswith("stage"):
        known |= {"i₁": 2.0, "i": 1.0 + 2.0 * known["u"]}

    def value(text):
        text = text.partition(",")[0].rpartition("= ")[2].replace("−", "-").replace("i₁ u", "i₁*u")
        text = re.sub(r"i₁|z_P|z_C|Δz|[ui]", lambda one: repr(float(known[one[0]])), text)
        return eval(text, {"__builtins__": {}})

    f = value(factor)
    assert drive.transmission_ratio == pytest.approx(value(ratio), rel=1e-12)
    angles = position_angles(drive.pin_wheel.number_of_pins + 1)
    found = analyse(drive, angles, None, HalfSpace())
    wheel = found.full.pose[:, WHEEL_ANGLE]
    np.testing.assert_allclose(found.transmission_error, -f * wheel, rtol=1e-12)
    # By the work of a turn; what is stored in the contacts at its ends differs, where rollers have come to other places.
    assert np.mean(found.full.wheel_moment) == pytest.approx(-f * drive.load.torque, rel=2e-4)
