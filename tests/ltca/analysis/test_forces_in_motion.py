"""Forces in motion against those at rest, the balance of a disc by orders, and a run in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import ltca
from ltca.analysis.engines import HalfSpace
from ltca.analysis.force_orders import BEARING_RADIAL, BEARING_TANGENTIAL, SHAFT_PIN, WHEEL_PIN, single_forces
from ltca.analysis.forced_vibration import _force, _nominal_forces, _orders, _quasi_static, _system, forced_vibration
from ltca.analysis.forces_in_motion import departures, force_slopes, forces_in_motion
from ltca.analysis.vibration import vibration
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

NEAR = 1e-2
"""Part of a motion by which normals are differenced."""
PAPER = load_drive("paper").cases["CS-1"]
RV = next(iter(load_drive("rv").cases.values()))


def shaken(drive):
    return vibration(drive, engine=HalfSpace(), positions=4, turns=4, torque_parts=())


@pytest.fixture(scope="module")
def usual():
    return shaken(with_fields(PAPER, {"inertia.output": 0.5, "damping.ratio": 0.05}))


def model_of(found):
    return replace(found.engine.prepare(found.drive).model, friction=None)


def answer(found, speed):
    """System, speed of the crank, orders, forces and departure at a speed of the input, turns a minute."""
    system, orders = _system(found), _orders(found)
    crank = abs(found.drive.crank_turns_per_input) * speed * 2.0 * np.pi / 60.0
    force = _force(system, crank, orders, _quasi_static(found), _nominal_forces(found))
    return system, crank, orders, force, system.respond(crank, orders, force)


def test_slow_motion_has_the_spectra_at_rest(usual):
    """Departures go with the square of the speed: at 1 rpm against modes of 200 Hz they are some 1e-5 of the error."""
    found = forced_vibration(usual, fastest=1.0, speeds=3)
    assert found.told_speed[0] == 0.0
    for resting, moving in zip(usual.forces, found.forces, strict=True):
        assert moving.kind == resting.kind
        scale = np.abs(resting.amplitude).max()
        assert moving.at(0).amplitude == pytest.approx(resting.amplitude, rel=0.0, abs=1e-9 * scale)
        assert moving.at(-1).amplitude == pytest.approx(resting.amplitude, rel=0.0, abs=1e-4 * scale)
        assert not np.array_equal(moving.at(-1).amplitude, resting.amplitude)


@pytest.mark.parametrize("which", ["paper", pytest.param("rv", marks=[pytest.mark.slow, pytest.mark.nightly])])
def test_forces_on_a_disc_balance_its_inertia_order_by_order(which, usual):
    """Sum of what all contacts add on disc 0 in motion, against the forces of inertia and damping there, by whole orders."""
    found = usual if which == "paper" else shaken(with_fields(RV, {"damping.ratio": 0.05, "inertia.output": 0.5}))
    system, crank, orders, force, moved = answer(found, 900.0)
    # Orders between whole ones answer by the mean stiffness alone, and do not end after the turns.
    whole = found.stiffness.orders
    moved[whole + 1 :] = 0.0
    model, by = model_of(found), departures(found, orders, moved[None])
    contacts = replace(model, stage=None, friction=None, external=None)
    added, carried = [], []
    for here in force_slopes(found, model):
        angle, pose = found.walked_angle[here.places], found.walked_pose[here.places]
        displaced, disc = by.at(here.places)[:, :, 0], contacts.respond(angle, pose).parts[0]

        def of_disc(kind, here=here, displaced=displaced):
            return np.einsum("p...n,pn->p...", here.slopes[kind][:, 0], displaced) if kind in here.slopes else 0.0

        ends = []
        for sense in (-NEAR, NEAR):
            near = contacts.respond(
                angle + sense * displaced[:, found.motion.crank], pose + sense * displaced[:, : pose.shape[1]]
            ).parts[0]
            ends.append((near.flank.gradient[..., :2], near.holes.gradient[..., :2]))
        pins = np.zeros((angle.size, 2))
        for kind, motion, load, low, high in zip(
            (WHEEL_PIN, SHAFT_PIN), (disc.flank, disc.holes), (disc.pin_load, disc.hole_load), *ends, strict=True
        ):
            if kind in here.slopes:
                pins += np.einsum("pi,pij->pj", of_disc(kind), motion.gradient[..., :2])
                pins += np.einsum("pi,pij->pj", load, (high - low) / (2.0 * NEAR))
        ahead = contacts.discs[0].geometry.placement.eccentric_directions(angle)
        bearing = (of_disc(BEARING_RADIAL) + 1j * of_disc(BEARING_TANGENTIAL)) * ahead
        pushed = bearing.sum(axis=1) * np.exp(-1j * angle)
        added.append((pins[:, 0] + 1j * pins[:, 1]) * np.exp(-1j * angle) - pushed)
        carried.append(pushed)
    over_turn, by_bearing = (
        np.concatenate(one).reshape(-1, len(found.stiffness.over_turn)).mean(axis=0) for one in (added, carried)
    )
    scale = 2.0 * np.abs(np.fft.fft(by_bearing, norm="forward"))[1:].max()
    rates = 1j * crank * np.arange(whole + 1.0)[:, None, None] * np.eye(found.motion.size) + crank * system.spin
    moving = system.mass @ rates @ rates + 1j * crank * np.arange(whole + 1.0)[:, None, None] * system.damping
    needed = force[: whole + 1] - np.einsum("oij,oj->oi", moving, moved[: whole + 1])
    for got, expected in ((over_turn.real, needed[:, 0]), (over_turn.imag, needed[:, 1])):
        orders_got = 2.0 * np.fft.rfft(got, norm="forward")[: whole + 1]
        # The tangent of the motion leaves out how radii of curvature follow the pose: differences of the whole force depart
        # from it by 1.8e-3 of what the bearing takes at single positions of the paper's drive, in orders by less.
        assert orders_got[1:] == pytest.approx(expected[1:], rel=0.0, abs=1e-3 * scale)


def test_slopes_are_differences_of_the_forces_found(usual):
    model, motion = model_of(usual), usual.motion
    here = next(iter(force_slopes(usual, model)))
    angle, pose = usual.walked_angle[here.places], usual.walked_pose[here.places]
    rng, step = np.random.default_rng(2), 1e-5
    way = step * rng.normal(size=motion.size) / np.array([1.0, 1.0, 80.0, 80.0, 80.0])
    contacts = replace(model, stage=None, friction=None, external=None)
    ends = []
    for sense in (-1.0, 1.0):
        at, moved = angle + sense * way[motion.crank], pose + sense * way[: pose.shape[1]]
        ends.append(single_forces(contacts, at, moved, contacts.respond(at, moved)))
    for kind, slopes in here.slopes.items():
        expected = 0.5 * (ends[1][kind] - ends[0][kind])
        # Loads go with powers of 1.1 of approaches of micrometres; ends of the load zone open and close within the step.
        assert slopes @ way == pytest.approx(expected, rel=0.0, abs=2e-3 * np.abs(expected).max())


@pytest.mark.slow
def test_small_errors_move_orders_in_proportion():
    """Twice the error of one pin makes twice the change of the forces of all parts at rest, and of the wheel pins in motion:
    loads go with powers of 1.1 of approaches of 5 µm, so that 0.1 µm is straight to some thousandths. In motion the stiffness
    of single positions jumps where a contact opens before the next, which a small error may or may not make.
    """
    found = []
    for size in (0.0, 5e-5, 1e-4):
        errors = [0.0] * PAPER.pin_wheel.number_of_pins
        errors[3] = size
        fields = {"damping.ratio": 0.05, "inertia.output": 0.5, "pin_wheel.pin_errors.radial": errors}
        one = shaken(with_fields(PAPER, fields))
        pins = next(each for each in forced_vibration(one, fastest=500.0, speeds=2).forces if each.kind == WHEEL_PIN)
        found.append([*(each.amplitude for each in one.forces), pins.at(-1).amplitude])
    for none, once, twice in zip(*found, strict=True):
        assert twice - none == pytest.approx(2.0 * (once - none), rel=0.0, abs=2e-2 * np.abs(twice - none).max())
        assert np.abs(twice - none).max() > 0.0


@pytest.mark.slow
@pytest.mark.nightly
def test_forces_in_motion_are_those_of_a_run_in_time():
    """Between resonances and well damped, what motion adds to the forces at rest is that of a run on the contacts' own laws, in
    the second of two turns. Orders of the lobes are told to a tenth: 5 % were found, near a mode. Beside them contacts that open
    and close make spikes at single positions, so that forces are compared as a whole, by root mean square (0.13 was found).
    """
    speed = 2000.0
    found = shaken(with_fields(PAPER, {"damping.ratio": 0.2}))
    *_, orders, _, moved = answer(found, speed)
    run = ltca.motion(found.drive, "60 ms", speed=speed, compliance="half-space")
    each, motion = len(found.stiffness.over_turn), found.motion
    second, by = np.arange(each - 2, 2 * each - 2), departures(found, orders, moved[None])
    angle = found.walked_angle[second]
    turned = np.abs(run.samples.place[:, motion.crank])
    wheel = CubicSpline(turned, run.samples.place[:, motion.wheel_angle])(angle)
    wheel -= found.walked_pose[second, motion.wheel_angle]
    in_time, told = (2.0 * np.fft.rfft(one, norm="forward") for one in (wheel, by.at(second)[:, motion.wheel_angle, 0]))
    lobes = PAPER.disc.number_of_teeth
    for order in lobes * np.arange(1, 6):
        assert in_time[order] == pytest.approx(told[order], rel=0.1)
    at_rest, added = [], []
    for here in force_slopes(found, model_of(found)):
        at_rest.append(here.at_rest[WHEEL_PIN][:, 0])
        added.append(np.einsum("ptn,pn->pt", here.slopes[WHEEL_PIN][:, 0], by.at(here.places)[:, :, 0]))
    resting, adding = np.concatenate(at_rest)[second], np.concatenate(added)[second]
    left = CubicSpline(turned, run.samples.pin_load[:, 0])(angle) - resting
    assert np.std(left) > 10.0  # N; at rest nothing is added
    assert np.sqrt(np.mean((left - adding) ** 2)) < 0.25 * np.sqrt(np.mean(left**2))


def test_forces_are_those_of_the_response(usual):
    """The largest of all parts over the walked turns, by the largest at rest, is the dynamic factor."""
    _, _, orders, _, moved = answer(usual, 900.0)
    found = forces_in_motion(usual, model_of(usual), orders, moved[None], np.array([0]))
    largest = resting = 0.0
    by = departures(usual, orders, moved[None])
    for here in force_slopes(usual, model_of(usual)):
        added = np.einsum("pdin,pn->pdi", here.slopes[WHEEL_PIN], by.at(here.places)[:, :, 0])
        loads = here.at_rest[WHEEL_PIN] + added
        largest, resting = max(largest, loads.max()), max(resting, here.at_rest[WHEEL_PIN].max())
    assert found.factors["wheel pins"][0] == pytest.approx(largest / resting, rel=1e-12)


def test_a_motion_turned_round_takes_as_much_torque(usual):
    """The largest departure of the torque is one of either sense."""
    _, _, orders, _, moved = answer(usual, 900.0)
    moved[0] = 1e-3 * np.abs(moved[1:]).max()  # a mean beside the waves: the largest departures of both senses differ
    both = np.stack((moved, -moved))
    one, other = forces_in_motion(usual, model_of(usual), orders, both, np.array([0])).torque_ratio
    assert one > 0.0
    assert one == pytest.approx(other, rel=1e-12)
