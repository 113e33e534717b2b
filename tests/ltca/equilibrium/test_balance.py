"""The balanced pose: unique, independent of the start, convergent at every load, an error where there is none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.engines import HalfSpace
from ltca.arrays import stack_drives
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import _failure, lever_arms, solve_equilibrium
from ltca.equilibrium.output_torque import _hardly_load, solve_at_output
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates
from ltca.geometry.placement import position_angles
from ltca.laws.spring import SpringLaw
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.balance_check import find_imbalance
from ltca.testing.random_drives import COORDINATES, random_drive
from validation.methods.unloaded import unloaded_transmission_error


@pytest.fixture(scope="module")
def models(paper_cases):
    return {name: Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)) for name, drive in paper_cases.items()}


def test_residual_is_that_of_the_response_and_small(models, paper_cases):
    angles = np.linspace(-3.0, 30.0, 25)
    for name, model in models.items():
        moment = paper_cases[name].wheel_moment()
        found = solve_equilibrium(model, angles, moment)
        again = model.respond(angles, found.pose).force - [0.0, 0.0, 0.0, moment]
        residual = np.max(np.abs(again) / np.array([1.0, 1.0, 4.0 * 13, 4.0 * 14]), axis=1)
        # both are sums of cancelled forces of some 1000 N: round-off of stiffness 1e6 N/mm times 1e-14 mm and more
        np.testing.assert_allclose(found.residual, residual, atol=1e-6)
        assert np.max(found.residual) < 1e-6 * 377_300.0 / 56.0
        assert np.all(found.iterations >= 1)


def test_lever_arms(models):
    np.testing.assert_allclose(lever_arms(models["CS-1"]), [1.0, 1.0, 52.0, 56.0])


def test_lever_arms_of_rings_in_a_batch():
    """Rings on circles of several radii, eccentricities alike: the rows of the first did not fit, and a study ended."""
    base = next(iter(parse_drive(shipped_drive("sleeved"), "sleeved").cases.values()))
    drives = [with_fields(base, {"pin_shaft.pin_circle_radius": radius}) for radius in (44.0, 44.01)]
    models = [HalfSpace().model(drive, in_batch=True) for drive in drives]
    arms = lever_arms(stack_drives(models, 2))
    assert models[0].coordinates.ring
    np.testing.assert_array_equal(arms, np.repeat([lever_arms(model) for model in models], 2, axis=0))
    np.testing.assert_allclose(
        arms[:, models[0].coordinates.ring_place.stop - 1], [44.0, 44.0, 44.01, 44.01], rtol=1e-12
    )


@pytest.mark.parametrize("case", ["CS-1", "CS-6"])
def test_start_pose_does_not_matter(models, paper_cases, case):
    """The potential has one minimum: far starts, open or pressed through, end in it."""
    rng = np.random.default_rng(1)
    angles = np.linspace(0.0, 6.0, 12)
    moment = paper_cases[case].wheel_moment()
    plain = solve_equilibrium(models[case], angles, moment)
    for size in (0.02, 0.3):
        start = rng.uniform(-1.0, 1.0, (12, 4)) * size / np.array([1.0, 1.0, 56.0, 56.0])
        other = solve_equilibrium(models[case], angles, moment, start)
        # tolerance 1e-9 of the load over a tangential stiffness above 1e5 N/mm: 1e-10 mm
        np.testing.assert_allclose(other.pose[:, :2], plain.pose[:, :2], atol=1e-9)
        np.testing.assert_allclose(
            other.pose[:, Coordinates().rotations], plain.pose[:, Coordinates().rotations], atol=1e-11
        )
        np.testing.assert_allclose(other.response.pin_load, plain.response.pin_load, atol=1e-4)


def test_given_start_is_not_changed(models, paper_cases):
    start = np.full((2, 4), 1e-3)
    solve_equilibrium(models["CS-3"], np.array([0.1, 0.2]), paper_cases["CS-3"].wheel_moment(), start)
    np.testing.assert_array_equal(start, 1e-3)


def test_positions_do_not_depend_on_each_other(models, paper_cases):
    angles = np.linspace(0.0, 6.0, 9)
    moment = paper_cases["CS-5"].wheel_moment()
    batch = solve_equilibrium(models["CS-5"], angles, moment)
    for row in (0, 4, 8):
        alone = solve_equilibrium(models["CS-5"], angles[row : row + 1], moment)
        np.testing.assert_allclose(alone.pose[0], batch.pose[row], atol=1e-9)


def test_complementarity(models, paper_cases):
    """Load exactly where pressed together; free rollers rest on the inner race."""
    angles = np.linspace(0.0, 30.0, 60)
    for name, model in models.items():
        contacts = solve_equilibrium(model, angles, paper_cases[name].wheel_moment()).response
        rollers = contacts.rollers
        for load, approach in (
            (contacts.pin_load, contacts.flank.approach),
            (contacts.hole_load, contacts.holes.approach),
            (rollers.outer_load, rollers.outer_approach),
            (rollers.inner_load, rollers.inner_approach),
        ):
            assert np.all(load >= 0.0)
            np.testing.assert_array_equal(load > 0.0, approach > 0.0)
        free = rollers.outer_load == 0.0
        assert free.any()
        assert np.all(rollers.inner_approach[free] == 0.0)
        assert np.all(rollers.outer_approach[free] <= 0.0)


def test_light_torque_tends_to_the_geometry(models, paper_cases):
    """CS-1 has no play but the flank's: as the torque falls the wheel angle tends to first contact."""
    angles = np.linspace(0.0, 6.0, 20)
    model = models["CS-1"]
    geometric = unloaded_transmission_error(model.geometries[0], angles)
    away = []
    for torque in (1e4, 1e3, 1e2, 1e1):
        found = solve_equilibrium(model, angles, -torque)
        away.append(np.max(np.abs(found.pose[:, WHEEL_ANGLE] - geometric)))
        assert np.all(found.pose[:, WHEEL_ANGLE] < geometric)  # the load always winds it up further
    # line contacts yield a little less than in proportion to the load, ln(1/F) slower: 7 … 10 for a tenth
    ratio = np.array(away[:-1]) / away[1:]
    assert np.all((ratio > 6.0) & (ratio < 10.5))
    assert away[-1] < 1e-7


def test_moment_of_every_position_is_its_own(models):
    angles = np.array([0.3, 0.3, 0.3])
    found = solve_equilibrium(models["CS-3"], angles, np.array([-1e5, 2e5, -3e5]))
    np.testing.assert_array_equal(np.sign(found.pose[:, WHEEL_ANGLE]), [-1.0, 1.0, -1.0])
    moments = found.response.force[:, WHEEL_ANGLE]
    np.testing.assert_allclose(moments, [-1e5, 2e5, -3e5], rtol=1e-8)


def test_loads_that_are_no_numbers_do_not_pass_for_balanced(models):
    broken = replace(models["CS-1"].discs[0], hole_law=SpringLaw(stiffness=float("nan")))
    with pytest.raises(ConvergenceError):
        solve_equilibrium(Reducer(discs=(broken,)), np.array([0.1]), -1e5)


@pytest.mark.slow
def test_stagnation_is_an_error_with_its_history(models):
    """A bearing whose push turns round at every look: nothing balances, and the error says where."""

    looks = []

    class Stubborn(Reducer):
        def evaluate(self, crank_angle, pose, start=None, **how):
            found = super().evaluate(crank_angle, pose, start, **how)
            looks.append(pose)
            return replace(found, force=found.force + np.array([0.0, 1e5 * (-1.0) ** len(looks), 0.0, 0.0]))

    with error_says(ConvergenceError, "crank angle 0.1 rad ", "residual in N") as caught:
        solve_equilibrium(Stubborn(discs=models["CS-1"].discs), np.array([0.1]), -1e5)
    assert len(caught.value.history) == 100


@pytest.mark.slow
def test_a_light_torque_is_followed_down_from_a_heavier_one():
    """Started at rest the disc wanders between contacts that take turns: it was "no equilibrium" of a sound drive."""
    drive, angle = random_drive(np.random.default_rng(107).random(COORDINATES))
    model, angles = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), angle + np.linspace(0.0, 6.28, 7)
    moment = 0.003 * drive.wheel_moment()
    found = solve_equilibrium(model, angles, moment)
    assert find_imbalance(drive, model, found) == []
    # The same minimum as from the pose under full load, by another way: loads agree to what counts as balance.
    other = solve_equilibrium(
        model,
        angles,
        moment,
        solve_equilibrium(model, angles, drive.wheel_moment()).pose,
    )
    size = np.max(other.response.pin_load)
    np.testing.assert_allclose(found.response.pin_load, other.response.pin_load, rtol=0.0, atol=1e-5 * size)


@pytest.mark.slow
def test_every_position_balances_at_every_load_both_ways(paper_cases, vary):
    """360 positions × 6 cases × 1, 10, 100, 300 %, both directions; the reverse is the mirror image."""
    angles = 2.0 * np.pi * np.arange(360) / 360
    for drive in paper_cases.values():
        clearance = {"bearing": drive.clearance.bearing, "pin_hole": drive.clearance.pin_hole}
        reverse = vary(clearance=clearance, load={"direction": "cw"})
        forward_model, reverse_model = (Reducer(discs=(HalfSpaceCompliance.of_drive(d),)) for d in (drive, reverse))
        for part in (0.01, 0.1, 1.0, 3.0):
            torque = 377_300.0 * part
            forward = solve_equilibrium(forward_model, -angles, drive.wheel_moment(torque))
            back = solve_equilibrium(reverse_model, angles, reverse.wheel_moment(torque))
            for found in (forward, back):
                assert np.max(found.residual) < 1e-6 * torque / 56.0
            np.testing.assert_allclose(back.pose, forward.pose * [1.0, -1.0, -1.0, -1.0], atol=1e-8)
            pins, holes, rollers = (-np.arange(n) % n for n in (14, 8, 11))
            # loads differ by what a residual of 1e-9 of the load lets pass
            size = torque / 56.0
            first, second = forward.response, back.response
            np.testing.assert_allclose(second.pin_load, first.pin_load[:, pins], atol=1e-6 * size)
            np.testing.assert_allclose(second.hole_load, first.hole_load[:, holes], atol=1e-6 * size)
            np.testing.assert_allclose(
                second.rollers.outer_load, first.rollers.outer_load[:, rollers], atol=1e-6 * size
            )


def test_contacts_are_those_of_their_positions(models, paper_cases):
    """They are kept as positions balance, leading ones first, and stand in the order asked for."""
    angles = np.random.default_rng(3).permutation(np.linspace(0.0, 6.2, 150))
    found = solve_equilibrium(models["CS-2"], angles, paper_cases["CS-2"].wheel_moment())
    again = models["CS-2"].respond(angles, found.pose)
    # the same pose from another start of the inner unknowns: stiffness 1e6 N/mm times round-off of 1e-11 mm
    np.testing.assert_allclose(found.response.pin_load, again.pin_load, atol=1e-5)
    np.testing.assert_allclose(found.response.rollers.outer_load, again.rollers.outer_load, atol=1e-5)


def test_the_position_farthest_from_balance_is_named_by_its_own_load():
    """2 N left of 10 N are more than 50 N of 100 kN: drives of a batch have loads of their own."""
    load, residual = np.array([1e5, 10.0, 1e3]), np.array([50.0, 2.0, 1e-3])
    search = SimpleNamespace(
        history=[np.full(3, np.inf), residual],
        angle=np.array([0.1, 0.2, 0.3]),
        slipped=np.zeros(3, dtype=bool),
        load=load,
        moment=56.0 * load,
        iterations=np.full(3, 30),
        pose=np.zeros((3, 4)),
        evaluate=lambda *_: None,
        round_off=lambda rows, _: np.zeros(len(rows)),
    )
    told = _failure(search, np.arange(3))
    assert str(told).startswith("no equilibrium at crank angle 0.2 rad (position 1 of 3, 3 unbalanced)")
    assert "against a load of 10 N" in str(told)


def test_hardly_loaded_means_the_size_of_a_torque():
    """Torques of the other sense counted as hardly any, and what was known near them was thrown away."""
    drive = load_drive("paper").cases["CS-1"]
    assert not _hardly_load([drive], np.array([-drive.load.torque]))
    assert _hardly_load([drive], np.array([-1e-6, 1e-6]))


def test_moments_beside_a_held_wheel_stay():
    """Of a batch whose first drive holds its wheel, torques of one that holds its shaft were put between neighbours."""
    held = with_fields(load_drive("paper").cases["CS-1"], {"installation.held": "pin-wheel"})
    free = load_drive("paper").cases["CS-1"]
    angle = np.tile(position_angles(12), 2)
    torque = np.concatenate((np.full(12, held.load.torque), free.load.torque * np.linspace(0.5, 1.0, 12)))
    model = stack_drives([HalfSpace().prepare(each).model for each in (held, free)], 12)
    found = solve_at_output(model, [held, free], angle, torque)
    np.testing.assert_array_equal(found.wheel_moment[12:], free.wheel_moment(1.0) * torque[12:])
