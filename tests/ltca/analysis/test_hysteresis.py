"""The loop of a locked input: sliders behind springs, turning branches as its bounds, small cycles, lost motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_is, error_says

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.hysteresis import hysteresis_loop, locked_path
from ltca.analysis.torque_curve import torque_curve
from ltca.drive.parts import Friction
from ltca.equilibrium.friction.sticking import stick_or_slip
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import DriveError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

ANGLE = np.array([0.3])


@pytest.fixture(scope="module")
def paper():
    return replace(load_drive("paper").cases["CS-1"], friction=Friction(pin=0.05, hole=0.05))


def test_one_contact_is_a_slider_on_a_spring():
    """A cycle of ± u_0 under constant load: sticks up to F/k, then slips; the loop's area is 4 F (u_0 − F/k)."""
    stiffness, bound, most = 250.0, 4.0, 0.05
    path = np.concatenate(
        [np.linspace(0.0, most, 60), np.linspace(most, -most, 121)[1:], np.linspace(-most, most, 121)[1:]]
    )
    force, forces = np.zeros(1), []
    for before, after in zip(np.r_[0.0, path[:-1]], path, strict=True):
        force, _ = stick_or_slip(force, np.array(stiffness), np.array(after - before), np.array(bound))
        forces.append(force[0])
    forces = np.array(forces)
    up = forces[:60]
    np.testing.assert_allclose(up, np.minimum(stiffness * path[:60], bound), atol=1e-12)
    down = forces[60:180]
    expected = np.maximum(bound - stiffness * (most - path[60:180]), -bound)
    np.testing.assert_allclose(down, expected, atol=1e-12)
    loop = slice(59, None)
    area = np.trapezoid(forces[loop], path[loop])
    # corners lie between points of the path: at most half a step by the slope's change
    assert area == pytest.approx(4.0 * bound * (most - bound / stiffness), rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper", pytest.param("robot-joint", marks=pytest.mark.nightly)])
def test_the_loop_lies_between_the_turning_branches(paper, name):
    """Where the drive turns one way or the other every contact rubs with all it has; locked, with no more."""
    drive = paper
    if name != "paper":
        drive = parse_drive(shipped_drive(name), name).cases["nominal"]
        drive = replace(drive, friction=paper.friction)
    parts = np.array([0.01, 0.1, 0.3, 0.6, 1.0])
    path = drive.load.torque * np.r_[parts, parts[::-1][1:], parts[1:]]
    found = locked_path(drive, ANGLE, path)[0] / drive.output_per_wheel_angle
    model = HalfSpace().prepare(drive).model
    ways = [model.friction, model.friction.reversed()]
    ends = [
        [
            solve_at_output(replace(model, friction=way), [drive], ANGLE, float(value)).pose[0, WHEEL_ANGLE]
            for value in path
        ]
        for way in ways
    ]
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    # contacts that stick, and slide another way than in the turning drive, lie within: a hundredth of the width is room
    room = 0.01 * (high - low)
    assert np.all((found > low - room) & (found < high + room))
    # and the loop fills what is between them: it loads on one branch and unloads on the other
    rise, fall = found[2], found[6]
    assert abs(rise - fall) > 0.8 * (high - low)[2]


@pytest.mark.slow
def test_small_cycles_stick(paper):
    """A small part of the torque back and forth ends in contacts that stick: one line, there and back, and no energy."""
    torque = paper.load.torque
    path = torque * np.array([0.3, 0.6, 1.0, *[0.995, 1.0] * 8])
    found = locked_path(paper, ANGLE, path)[0]
    there, back = found[3::2], found[4::2]
    swing = abs(back[-1] - there[-1])
    # what slips is less each time, by two thirds: after eight cycles thousandths of the swing
    assert abs(back[-1] - back[-2]) < 2e-3 * swing
    assert abs(there[-1] - there[-2]) < 2e-3 * swing
    # contacts that stick hold the output stiffer than those that slip let it be
    whole = abs(found[2] - found[1]) / 0.4 * 0.005
    assert swing < 0.9 * whole


@pytest.mark.slow
def test_lost_motion_is_read_in_the_middle_of_the_loop(paper):
    loop = hysteresis_loop(paper, ANGLE, lost_motion=0.05, points=8)
    plain = torque_curve(replace(paper, friction=None), ANGLE, points=8, lost_motion=0.05)
    curve = torque_curve(paper, ANGLE, points=8, lost_motion=0.05)
    here = [int(np.argmin(np.abs(loop.torque - side * 0.05 * paper.load.torque))) for side in (1.0, -1.0)]
    middle = 0.5 * (loop.rising + loop.falling)
    np.testing.assert_allclose(loop.lost_motion, middle[:, here[0]] - middle[:, here[1]], rtol=1e-12)
    # friction opens the loop to either side of what bodies yield: the middle stays near it
    np.testing.assert_allclose(loop.lost_motion, plain.lost_motion, rtol=1e-3)
    np.testing.assert_array_equal(curve.output_angle, plain.output_angle)
    assert curve.lost_motion_part == 0.05
    assert plain.loop is None
    assert np.all(loop.energy > 0.0)
    # more torque winds further, either way
    assert np.all(np.diff(loop.rising, axis=1) > 0.0)
    assert np.all(np.diff(loop.falling, axis=1) > 0.0)
    assert np.all(loop.falling >= loop.rising - 1e-12)


@pytest.mark.slow
def test_a_part_of_the_torque_is_the_torque_of_a_lighter_drive(paper):
    """Half of the rated torque and back is the loop of the same drive rated at half: the amplitude is a part of the torque."""
    half = replace(paper, load=replace(paper.load, torque=0.5 * paper.load.torque))
    part = hysteresis_loop(paper, ANGLE, amplitude=0.5, lost_motion=0.05, points=5)
    whole = hysteresis_loop(half, ANGLE, lost_motion=0.1, points=5)
    np.testing.assert_allclose(part.torque, whole.torque, rtol=1e-12)
    assert part.torque[-1] == pytest.approx(0.5 * paper.load.torque, rel=1e-12)
    # Both walk the same torques; balance holds to 1e-9 of the load.
    for name in ("rising", "falling", "energy", "lost_motion", "width"):
        np.testing.assert_allclose(getattr(part, name), getattr(whole, name), rtol=1e-6, err_msg=name)


def test_no_friction_no_loop(paper):
    with error_says(DriveError, starts="friction: must be given"):
        locked_path(replace(paper, friction=None), ANGLE, [1e5, 2e5])
    with error_is(DriveError, "lost_motion = 1.5: must be greater than 0 and less than 1"):
        hysteresis_loop(paper, ANGLE, lost_motion=1.5)
    with error_is(DriveError, "lost_motion = 0.7: must be from 0.001 to 0.5 of the rated torque"):
        torque_curve(paper, ANGLE, lost_motion=0.7)
