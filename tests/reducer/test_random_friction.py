"""Reducers whose joints rub: every one is answered, either way it moves, and confirmed apart from the code that balances."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.losses import losses
from ltca.drive.parts import Friction
from ltca.equilibrium.friction.slip import Slip
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance, friction_at, potential_of
from ltca.testing.pin_drives import friction_drive


def answer(seed, reverse=False):
    """A drive, the model that answers, and its answer; its motion reversed if so wanted."""
    drive, angle = friction_drive(seed)
    model = HalfSpace().prepare(drive).model
    if reverse:
        other = {"input": "output", "output": "input"}[drive.load.driven_by]
        drive = replace(drive, load=replace(drive.load, driven_by=other))
        model = replace(model, friction=model.friction.reversed())
    return drive, model, solve_at_output(model, [drive], np.array([angle]), drive.load.torque)


def confirm(seed, reverse=False, told=True):
    """Look at the answer and, where so wanted, at what is told of its losses."""
    drive, model, found = answer(seed, reverse)
    torque = drive.load.torque
    assert find_imbalance(drive, model, found, torque=torque) == [], seed
    if not told:
        return
    lost, (rubbed, moment) = losses(model, [drive], found, torque), independent(drive, model, found)
    assert np.isfinite(lost.efficiency).all()
    turns, part, oil = (
        1.0 / drive.crank_turns_per_input,
        drive.input_per_crank_moment or 1.0,
        drive.friction.no_load_torque,
    )
    # Bearings' forces are slopes of energies, by differences: good to some 1e-5, but for kinks of a ten-thousandth of a load.
    each = torque / abs(drive.reduction_ratio)
    assert lost.total[0] == pytest.approx(rubbed + oil * abs(turns), rel=1e-4, abs=1e-6 * each), seed
    wanted = drive.motion_sign * turns * part * moment + oil * abs(turns)
    # The moment of cranks is a difference of energies that are kinked where rollers of a light disc open.
    assert lost.at_input[0] == pytest.approx(wanted, abs=3e-4 * each), seed


def independent(drive, model, found):
    """Energy lost by radian of the crank but for seals and oil, and the moment of all cranks, N·mm."""
    potential = potential_of(drive, model, found, 0)
    rubbed = friction_at(potential, found, 0)
    return rubbed.lost, potential.crank_moment(found.pose[0]) + rubbed.at_cranks


def test_drives_that_rub_quick():
    confirm(0)


@pytest.mark.slow
def test_a_drive_that_rubs_the_other_way():
    confirm(1, reverse=True)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(0, 3), pytest.param(3, 97, marks=pytest.mark.nightly)])
def test_a_hundred_drives_that_rub(first, count):
    """Half of them driven by their outputs; ``benchmarks/random_drives.py --friction`` runs a thousand both ways."""
    for seed in range(first, first + count):
        confirm(seed, told=seed % 3 == 0)


@pytest.mark.slow
def test_every_kind_of_friction_is_drawn():
    drives = [friction_drive(seed)[0] for seed in range(60)]
    rubs = [drive.friction for drive in drives]
    assert {drive.load.driven_by for drive in drives} == {"input", "output"}
    assert {drive.load.speed for drive in drives} == {None, 1500.0}
    assert {drive.pin_wheel.seat.kind for drive in drives} == {"fixed", "slot", "sleeve"}
    assert {drive.pin_shaft.seat.kind for drive in drives if drive.pin_shaft} == {"fixed", "sleeve"}
    assert {drive.installation.held for drive in drives} == {"pin-shaft", "pin-wheel"}
    assert {drive.installation.first_stage_ratio is None for drive in drives} == {True, False}
    assert {drive.disc.number_of_discs for drive in drives} == {1, 2, 3}
    assert all(0.0 in {getattr(rub, name) for rub in rubs} for name in ("pin", "seat", "hole", "roller"))
    assert 0.15 in {rub.pin for rub in rubs}
    assert any(rub.pin == rub.hole == rub.seat > 0.0 for rub in rubs)
    assert {rub.support_bearing > 0.0 for rub in rubs} == {rub.no_load_torque > 0.0 for rub in rubs} == {True, False}


@pytest.mark.slow
def test_loose_pins_slip_where_they_have_given_way_to():
    """The flank was taken to lie where pins in the middle of their slots would touch it: losses were off by up to 0.4 %."""
    drive, model, found = answer(4)
    assert drive.pin_wheel.seat.kind == "slot"
    checked = friction_at(potential_of(drive, model, found, 0), found, 0).contacts
    for number, (disc, part, own) in enumerate(zip(model.discs, found.response.parts, checked, strict=True)):
        pose, loaded = found.pose[:, model.coordinates.columns(number)], own.most > 0.0
        slip = Slip.of_disc(disc.geometry, found.crank_angle, pose, part).by_crank[0]
        # normals by differences are good to some 1e-9
        np.testing.assert_allclose(
            np.abs(slip)[loaded], np.abs(own.slip)[loaded], rtol=0.0, atol=1e-7 * drive.crank.eccentricity
        )


@pytest.mark.slow
def test_a_disc_that_friction_does_not_let_rest_carries_nothing():
    """At μ = 0.15 a disc that carries next to nothing was caught between three contacts: its load is the other's."""
    drive, angle = friction_drive(17)
    # on springs alone: the disc floats otherwise
    springs = replace(drive.crank.support, stiffness=(1e6, 1e6), contact_angle=None, load_constant=None, preload=None)
    wheel = replace(drive.pin_wheel, support_stiffness=1e6)
    drive = replace(drive, main_bearing=None, crank=replace(drive.crank, support=springs), pin_wheel=wheel)
    friction = replace(drive.friction, pin=0.15, hole=0.15, roller=0.0015)
    drive = replace(drive, friction=friction, load=replace(drive.load, driven_by="output"))
    model, torque = HalfSpace().prepare(drive).model, drive.load.torque
    found = solve_at_output(model, [drive], np.array([angle + 10.0 * np.pi / 7.0]), torque)
    assert find_imbalance(drive, model, found, torque=torque) == []
    first, second = (part.pin_load.sum() for part in found.response.parts)
    assert first < 1e-3 * second


@pytest.mark.slow
def test_a_drive_that_jams_says_so():
    """At μ = 0.5 this one's loads grow by the inverse of what friction leaves of their moment, without end at 80 % of it."""
    drive, angle = friction_drive(2)
    drive = replace(drive, friction=Friction(pin=0.5, seat=0.5), load=replace(drive.load, driven_by="input"))
    model, torque, loads = HalfSpace().prepare(drive).model, drive.load.torque, []
    strengths = np.array([0.0, 0.25, 0.5, 0.75])
    for strength in strengths:
        part = replace(model, friction=model.friction.scaled(strength))
        loads.append(solve_at_output(part, [drive], np.array([angle]), torque).response.pin_load.sum())
    left = 1.0 / np.array(loads)
    # What is left of a unit load's moment falls to nothing, in a line but for the directions that loads turn to.
    slope, none = np.polyfit(strengths, left, 1)
    np.testing.assert_allclose(none + slope * strengths, left, rtol=0.0, atol=0.03 * left[0])
    assert 0.75 < -none / slope < 0.9
    with pytest.raises(ConvergenceError, match="the drive jams") as caught:
        solve_at_output(model, [drive], np.array([angle]), torque)
    least, most = (
        float(part) for part in re.search(r"friction.pin = (\S+) to (\S+) of 0.5", str(caught.value)).groups()
    )
    # Where that line ends, but for the directions that loads turn to on the way there, as above.
    assert least < most < least + 0.01
    assert abs(0.5 * (least + most) / 0.5 + none / slope) < 0.1


@pytest.mark.slow
@pytest.mark.nightly
def test_a_drive_that_jams_is_told_at_which_coefficient():
    """It was 'the teeth slip': at three quarters of μ loads did not tell yet that they would end before the whole of it."""
    shipped = parse_drive(shipped_drive("rv")).cases["nominal"]
    torque, angle = shipped.load.torque, np.array([0.3])

    def at(pin):
        drive = replace(shipped, friction=Friction(pin=pin))
        return solve_at_output(HalfSpace().prepare(drive).model, [drive], angle, torque)

    with pytest.raises(ConvergenceError, match="the drive jams between") as caught:
        at(0.6)
    least, most = (
        float(part) for part in re.search(r"friction.pin = (\S+) to (\S+) of 0.6", str(caught.value)).groups()
    )
    assert 0.0 < most - least < 0.01 * 0.6 + 0.001  # the promised hundredth of the whole, both rounded to three digits
    assert at(least).response.pin_load.sum() > 5.0 * at(0.0).response.pin_load.sum()  # loads grow without bound
    with pytest.raises(ConvergenceError, match="the drive jams"):
        at(most)


@pytest.fixture(scope="module")
def rubbing():
    """One with everything: pin shaft, friction on both kinds of pins, in seats, rollers and bearings; the wheel held.

    On a rigid ring: on its own, of plastic, it takes ninety steps to balance instead of seven.
    """
    drive, angle = friction_drive(81)
    drive, rubs = replace(drive, ring=None), drive.friction
    assert drive.pin_shaft is not None
    assert drive.pin_wheel.seat.kind != "fixed"
    assert drive.wheel_is_held
    assert len({rubs.pin, rubs.hole, 0.0}) == 3
    assert rubs.seat * rubs.roller * rubs.support_bearing > 0.0
    model, torque = HalfSpace().prepare(drive).model, drive.load.torque
    found = solve_at_output(model, [drive], np.array([angle]), torque)
    assert find_imbalance(drive, model, found, torque=torque) == []
    return drive, model, found


def spoilt(found, change):
    """The answer with other friction forces."""
    response = found.response
    parts = tuple(replace(part, friction=change(part.friction)) for part in response.parts)
    return replace(found, response=replace(response, parts=parts))


def flipped(forces):
    """The largest of them the other way."""
    forces = forces.copy()
    forces[0, np.argmax(np.abs(forces[0]))] *= -1.0
    return forces


@pytest.mark.slow
@pytest.mark.parametrize(
    "change", [flipped, *(pytest.param(partial(np.multiply, part), marks=pytest.mark.slow) for part in (1.02, 0.0))]
)
def test_the_check_sees_wrong_friction_forces(rubbing, change):
    drive, model, found = rubbing
    assert any("instead of" in problem for problem in find_imbalance(drive, model, spoilt(found, change)))


def rebalanced(rubbing, **changes):
    """The same drive balanced with other friction, the check told of the drive's own."""
    drive, model, found = rubbing
    other = replace(model, friction=replace(model.friction, **changes))
    torque = drive.load.torque
    return find_imbalance(drive, other, solve_at_output(other, [drive], found.crank_angle, torque), torque=torque)


@pytest.mark.slow
def test_the_check_sees_the_coefficient_of_another_joint(rubbing):
    friction = rubbing[1].friction
    assert any("wheel pin" in problem for problem in rebalanced(rubbing, pin=friction.hole))
    assert any("shaft pin" in problem for problem in rebalanced(rubbing, hole=friction.pin))


@pytest.mark.slow
def test_the_check_sees_the_other_motion(rubbing):
    assert any("instead of" in problem for problem in rebalanced(rubbing, motion=-rubbing[1].friction.motion))


@pytest.mark.slow
def test_the_check_sees_a_pose_that_friction_does_not_hold(rubbing):
    """Told forces that are right do not help where they do not balance."""
    drive, model, found = rubbing
    smooth = solve_at_output(replace(model, friction=None), [drive], found.crank_angle, drive.load.torque)
    own = Reducer.respond(model, smooth.crank_angle, smooth.pose)
    assert any("slope" in problem for problem in find_imbalance(drive, model, replace(smooth, response=own)))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rolling", "support"])
def test_the_check_sees_bearings_that_rub_not(rubbing, name):
    """Ten times the resistance of bearings, so that it is more than what the check leaves: a thousandth of the load."""
    drive, model, found = rubbing
    rough = replace(drive.friction, roller=0.015, support_bearing=0.02)
    drive = replace(drive, friction=rough)
    friction = type(model.friction).of_drive(drive)
    model = replace(model, friction=friction)
    torque = drive.load.torque
    assert find_imbalance(drive, model, solve_at_output(model, [drive], found.crank_angle, torque), torque=torque) == []
    assert rebalanced((drive, model, found), **{name: 0.0})
