"""Pins that are left out of an evaluation cannot touch, and those that are not are what they are without that."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.arrays import stack_drives
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.response import Start
from ltca.drive.deviations import PlacementErrors, ProfileErrors, Runout
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pair_motion import KnownPins
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import parse_drive, shipped_drive

ROUND_OFF = 1e-10
"""Of places relative to their size: places on the flank are found to 1e-13 rad from wherever they start, and curvatures,
second derivatives by them, magnify that by the square of the tooth number."""


@pytest.fixture(scope="module")
def drives(paper_cases, random_drives):
    return [paper_cases["CS-6"], *random_drives]


def poses(drive, random, count, size):
    """Poses of some displacement, as a part of the pin circle radius; the angles have that as lever."""
    radius = drive.pin_wheel.pin_circle_radius
    return random.uniform(-size, size, (count, 4)) * np.array([radius, radius, 1.0, 1.0])


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("size", [1e-5, 3e-4, 3e-3])
def test_no_pin_that_touches_is_left_out(drives, size):
    random, left_out = np.random.default_rng(7), []
    for drive in drives:
        geometry = ContactGeometry.of_drive(drive)
        angle = random.uniform(-10.0, 10.0, 40)
        motion = geometry.flank(angle, poses(drive, random, 40, size))
        for _ in range(3):  # what was left out stays known from the pose before
            pose = poses(drive, random, 40, size)
            bent = poses(drive, random, 40, size)[:, :2] @ np.array([[1.0], [1j]]) * np.ones(motion.approach.shape[1])
            everything = geometry.flank(angle, pose, shifts=bent)
            motion = geometry.flank(angle, pose, motion.parameter, bent, KnownPins.of(motion))
            left_out.append(motion.left_out)
            assert np.all(everything.approach[motion.left_out] < 0.0)
            assert np.all(motion.approach[motion.left_out] < 0.0)
            assert_same(motion, everything, ~motion.left_out)
            completed = geometry.complete_flank(angle, pose, motion, bent)
            assert not completed.left_out.any()
            assert_same(completed, everything, np.ones_like(motion.left_out))
            kept = ~motion.left_out
            np.testing.assert_array_equal(completed.approach[kept], motion.approach[kept])
    if size < 1e-3:  # or nothing was shown
        assert np.mean(np.concatenate([each.ravel() for each in left_out])) > 0.2


def assert_same(motion, other, places):
    for item in fields(motion):
        mine, theirs = getattr(motion, item.name)[places], getattr(other, item.name)[places]
        if mine.dtype != bool:
            scale = np.max(np.abs(theirs), initial=1e-3)
            np.testing.assert_allclose(mine, theirs, rtol=0.0, atol=ROUND_OFF * scale, err_msg=item.name)


def with_errors(drive: Drive, random: np.random.Generator, size: float) -> Drive:
    pins = drive.pin_wheel.number_of_pins
    knots = np.linspace(0.0, 6.0, 30)
    errors = {name: tuple(random.uniform(-size, size, pins)) for name in ("radial", "tangential", "diameter")}
    profile = ProfileErrors(
        orders=(2, 5),
        cosine=tuple(random.uniform(-size, size, 2)),
        sine=tuple(random.uniform(-size, size, 2)),
        parameter=tuple(knots),
        deviation=tuple(random.uniform(-size, size, 30)),
    )
    disc = replace(
        drive.disc,
        runout=Runout(amount=random.uniform(-size, size), angle=random.uniform(0.0, 6.0)),
        profile_errors=profile,
        equidistant_offset=drive.disc.equidistant_offset + random.uniform(-size, size),
        shifting_offset=drive.disc.shifting_offset + random.uniform(-size, size),
    )
    crank = replace(drive.crank, eccentricity=drive.crank.eccentricity + 0.1 * random.uniform(-size, size))
    wheel = replace(drive.pin_wheel, pin_errors=PlacementErrors(**errors))
    return replace(drive, disc=disc, crank=crank, pin_wheel=wheel)


def test_pins_of_another_drive_are_bounded_by_what_it_differs_in(drives):
    random, beyond = np.random.default_rng(8), []
    for drive in drives[:4]:
        size = 1e-4 * drive.pin_wheel.pin_radius
        nominal, other = drive, with_errors(drive, random, size)
        angle, pose = random.uniform(-10.0, 10.0, 60), poses(drive, random, 60, 1e-5)
        first, second = ContactGeometry.of_drive(nominal), ContactGeometry.of_drive(other)
        known, actual = first.flank(angle, pose), second.flank(angle, pose)
        bound = second.reach_beyond(first)
        change = actual.approach - known.approach - np.abs(actual.point - known.point)
        assert np.all(change <= bound + 1e-12)
        beyond.append(np.max(change / bound))
    assert max(beyond) > 0.1  # a bound of any use


@pytest.mark.parametrize(
    "changed",
    [{"turn": np.exp(2e-4j)}, {"centre": 3e-3 - 4e-3j}, {"generating_radius": 88.094}, {"eccentricity": 3.996}],
    ids=lambda changed: next(iter(changed)),
)
def test_the_bound_is_how_far_the_trochoids_are_apart(paper_cases, changed):
    """Of flanks that differ in one thing it is the largest distance of their generating curves at the same parameter."""
    geometry = ContactGeometry.of_drive(paper_cases["CS-1"])
    other = replace(geometry, profile=replace(geometry.profile, **changed))
    theta = np.linspace(0.0, 2.0 * np.pi, 13 * 200 + 1)  # tips, where a turn moves most, are among them

    def trochoid(profile):
        radius, e, ratio = profile.generating_radius, profile.eccentricity, profile.reduction_ratio
        return profile.centre + profile.turn * (radius * np.exp(1j * theta) - e * np.exp(1j * ratio * theta))

    apart = np.max(np.abs(trochoid(other.profile) - trochoid(geometry.profile)))
    # An arc of 2e-4 is longer than its chord by a part of 2e-9.
    np.testing.assert_allclose(other.reach_beyond(geometry), apart, rtol=1e-8)


def test_a_batch_is_bounded_drive_by_drive(paper_cases):
    random = np.random.default_rng(9)
    others = [with_errors(paper_cases["CS-1"], random, 0.01) for _ in range(3)]
    nominal = ContactGeometry.of_drive(paper_cases["CS-1"])
    # Measured points are those of all, or no batch.
    points = others[0].disc.profile_errors
    shared = [
        replace(
            each,
            disc=replace(each.disc, profile_errors=replace(each.disc.profile_errors, deviation=points.deviation)),
        )
        for each in others
    ]
    bounds = stack_drives([ContactGeometry.of_drive(each) for each in shared], 2).reach_beyond(nominal)
    for number, each in enumerate(shared):
        alone = ContactGeometry.of_drive(each).reach_beyond(nominal)
        np.testing.assert_allclose(bounds[2 * number : 2 * number + 2], [alone, alone], rtol=1e-12)


def test_balance_without_gaps_is_the_balance_with_them(paper_cases):
    drive = paper_cases["CS-3"]
    model, angle = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), np.linspace(0.0, 6.0, 30)
    found = solve_equilibrium(model, angle, drive.wheel_moment())
    without = solve_equilibrium(model, angle, drive.wheel_moment(), gaps=False)
    np.testing.assert_array_equal(found.pose, without.pose)
    np.testing.assert_array_equal(found.response.pin_load, without.response.pin_load)
    assert np.mean(without.response.flank.left_out) > 0.3
    assert not found.response.flank.left_out.any()
    everything = model.respond(angle, found.pose, Start.after(found.response))
    assert_same(found.response.flank, everything.flank, np.ones_like(found.response.flank.left_out))
    # Loads are those of all pins to round-off of places, times the stiffness of some 1e6 N/mm.
    np.testing.assert_allclose(found.response.pin_load, everything.pin_load, rtol=0.0, atol=1e-6)


def test_pins_that_are_left_out_have_a_radius_of_the_flank():
    """Their stand-in of 1 mm was none that the table of a crowned pin holds."""
    joint = parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]
    model = HalfSpace().prepare(joint).model
    found = solve_at_output(model, [joint], position_angles(12), joint.load.torque, gaps=False).response.flank
    assert found.left_out.any()
    turn = np.linspace(0.0, 2.0 * np.pi / 40.0, 2001)
    radii = FlankProfile.of_drive(single_discs(joint)[0]).effective_radius(turn, joint.pin_wheel.pin_radius)
    assert radii.min() * (1.0 - 1e-6) < found.effective_radius.min()
    assert found.effective_radius.max() < radii.max() * (1.0 + 1e-6)
