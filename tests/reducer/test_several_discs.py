"""Several discs on one wheel: what symmetry, superposition and springs say of them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.torque_curve import torque_curve
from ltca.drive.single_discs import equal_parts, single_discs
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import build_drive, load_drive, parse_drive, shipped_drive

ANGLES = np.linspace(0.1, 6.2, 7)
# analyse balances to 1e-9 of a load of some 7000 N, over stiffnesses above 1e5 N/mm
LOAD, LENGTH, ANGLE = 2e-5, 1e-9, 1e-9


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-3"]


@pytest.fixture(scope="module")
def joint():
    return parse_drive(shipped_drive("robot-joint"), "robot-joint").cases["nominal"]


@pytest.fixture(scope="module")
def odd(paper):
    """15 pins, 14 teeth, 8 holes: discs half a turn apart mesh half a period apart."""
    return with_fields(paper, {"pin_wheel.number_of_pins": 15, "disc.number_of_teeth": 14, "crank.eccentricity": 3.8})


def prepared(drive):
    return HalfSpace().prepare(drive).model


@pytest.mark.parametrize("held", ["pin-shaft", pytest.param("pin-wheel", marks=pytest.mark.slow)])
def test_two_equal_discs_are_one_at_half_the_torque(paper, held):
    """Half a turn apart with even numbers of pins and holes: all numbers shift by half, rollers keep theirs."""
    one = with_fields(paper, {"installation.held": held, "load.torque": 0.5 * paper.load.torque})
    two = with_fields(paper, {"installation.held": held, "disc.number_of_discs": 2})
    assert equal_parts(two)
    alone, both = analyse(one, ANGLES), analyse(two, ANGLES)
    first, contacts = alone.full.response, [disc.full.response for disc in both.discs]
    np.testing.assert_allclose(both.full.pose[:, WHEEL_ANGLE], alone.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=ANGLE)
    for disc, found in enumerate(contacts):
        shifted = (np.roll(found.pin_load, 7 * disc, axis=1), np.roll(found.hole_load, 4 * disc, axis=1))
        np.testing.assert_allclose(shifted[0], first.pin_load, rtol=0.0, atol=LOAD)
        np.testing.assert_allclose(shifted[1], first.hole_load, rtol=0.0, atol=LOAD)
        np.testing.assert_allclose(found.rollers.outer_load, first.rollers.outer_load, rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(both.bearing_radial, np.repeat(alone.bearing_radial, 2, axis=1), rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(both.torque_share, 0.5, rtol=0.0, atol=1e-8)
    np.testing.assert_allclose(both.disc_torques.sum(axis=1), both.full.wheel_moment, rtol=1e-9)


@pytest.mark.slow
def test_two_equal_discs_are_twice_as_stiff(paper):
    """At equal torque per disc, whichever member is held."""
    for held in ("pin-shaft", "pin-wheel"):
        one = with_fields(paper, {"installation.held": held})
        two = with_fields(one, {"disc.number_of_discs": 2, "load.torque": 2.0 * one.load.torque})
        single, double = (torque_curve(drive, ANGLES[:2], points=2) for drive in (one, two))
        # balanced to 1e-9 of the load over the stiffness, 1e-12 rad of the 1e-4 rad that are divided by
        np.testing.assert_allclose(double.stiffness, 2.0 * single.stiffness, rtol=1e-7)


@pytest.mark.slow
def test_meshes_half_a_period_apart_even_out_the_order_of_the_teeth(odd):
    """z_P odd: of the TE's harmonics of z_C the odd ones cancel between the discs."""
    two = with_fields(odd, {"disc.number_of_discs": 2})
    angles = position_angles(14 * 16)

    def order(drive, torque):
        angle = analyse(drive, angles, torque=torque).transmission_error
        return abs(np.mean(angle * np.exp(-1j * odd.disc.number_of_teeth * angles)))

    assert order(two, odd.load.torque) < 0.1 * order(odd, 0.5 * odd.load.torque)


@pytest.mark.slow
def test_two_models_of_one_disc_put_in_parallel_by_hand(odd):
    """Each disc alone under a part of the torque, parts moved until both turn the wheel alike: no code of several discs."""
    two = with_fields(odd, {"disc.number_of_discs": 2, "disc.of.1.runout.amount": 0.004})
    moment = two.wheel_moment()
    together = analyse(two, ANGLES[:3])
    singles = [prepared(single) for single in single_discs(two)]

    for row, angle in enumerate(ANGLES[:1]):

        def wheel(disc, part, angle=angle):
            return solve_equilibrium(singles[disc], np.array([angle]), part * moment).pose[0, WHEEL_ANGLE]

        share = brentq(lambda part, wheel=wheel: wheel(0, part) - wheel(1, 1.0 - part), 0.3, 0.7, xtol=1e-9)
        assert together.torque_share[row, 0] == pytest.approx(share, abs=1e-6)
        assert together.full.pose[row, WHEEL_ANGLE] == pytest.approx(wheel(0, share), rel=1e-6)
    assert np.ptp(together.torque_share) > 0.01


def test_a_pin_pushed_in_is_felt_by_the_disc_that_it_stands_on(paper):
    """One pin of the wheel, inward: the disc that loads it carries more, the other, half a turn on, less."""
    errors = [0.0] * 14
    two = with_fields(paper, {"disc.number_of_discs": 2})
    angle = np.array([0.7])
    pin = int(np.argmax(analyse(two, angle).discs[0].full.response.pin_load))
    errors[pin] = -0.005
    share = analyse(with_fields(two, {"pin_wheel.pin_errors.radial": errors}), angle).torque_share[0]
    assert share[0] > 0.51
    assert share.sum() == pytest.approx(1.0, abs=1e-12)


@dataclass(frozen=True)
class HeldRadius:
    """A contact law at the effective radii of one pose: what ρ changes along the flank is no part of the tangent."""

    law: object
    radius: np.ndarray

    def load_and_stiffness(self, approach, _):
        return self.law.load_and_stiffness(approach, self.radius)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("discs", [1, 2, 3])
def test_tangent_is_the_slope_of_the_force(joint, discs):
    drive = with_fields(joint, {"disc.number_of_discs": discs, "disc.phases": (), "disc.planes": ()})
    drive = with_fields(drive, {"disc.of.0.runout.amount": 0.003})
    balanced = solve_equilibrium(prepared(drive), ANGLES[:2], drive.wheel_moment())
    parts = zip(prepared(drive).discs, balanced.response.parts, strict=True)
    held = [replace(m, pin_law=HeldRadius(m.pin_law, part.flank.effective_radius)) for m, part in parts]
    model, pose = Reducer(discs=tuple(held)), balanced.pose
    size = pose.shape[1]
    assert size == 3 * discs + 1
    tangent, step = balanced.response.tangent, 1e-8
    for column in range(size):
        moved = [pose + side * step * (np.arange(size) == column) for side in (1.0, -1.0)]
        up, down = (model.respond(ANGLES[:2], each).force for each in moved)
        # a step of 1e-8 mm (or rad, 6e-7 mm at the pins) of laws that bend over some 1e-3 mm where contacts are just closed
        scale = np.max(np.abs(tangent[:, :, column]), axis=1, keepdims=True)
        np.testing.assert_allclose(
            tangent[:, :, column] / scale, (up - down) / (2.0 * step) / scale, rtol=0.0, atol=2e-6
        )


@pytest.mark.slow
@pytest.mark.parametrize("discs", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_order_of_the_discs_is_a_matter_of_names(joint, discs):
    """Discs in another order: the same loads under other numbers."""
    phases = tuple(2.0 * np.pi * k / discs + 0.1 * k for k in range(discs))
    base = with_fields(joint, {"disc.number_of_discs": discs, "disc.phases": phases, "disc.planes": ()})
    first = with_fields(base, {"disc.of.0.runout.amount": 0.003, "crank.of.1.eccentricity_error": 0.002})
    order = [*range(1, discs), 0]
    other = replace(
        first,
        disc=replace(first.disc, phases=tuple(phases[k] for k in order), of=tuple(first.disc.of[k] for k in order)),
        crank=replace(first.crank, of=tuple(first.crank.of[k] for k in order)),
    )
    before, after = analyse(first, ANGLES[:3]), analyse(other, ANGLES[:3])
    np.testing.assert_allclose(after.full.pose[:, WHEEL_ANGLE], before.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=ANGLE)
    np.testing.assert_allclose(after.torque_share, before.torque_share[:, order], rtol=0.0, atol=1e-8)
    for number, disc in enumerate(order):
        loads = [each.full.response.parts[k].pin_load for each, k in ((after, number), (before, disc))]
        np.testing.assert_allclose(*loads, rtol=0.0, atol=LOAD)


@pytest.mark.parametrize("discs", [2, *(pytest.param(discs, marks=pytest.mark.slow) for discs in (1, 3))])
def test_reverse_is_the_mirror_image_of_all_discs(joint, discs):
    """result(φ_C, reverse) mirrors result(−φ_C, forward): phases change their sign as every angle does."""
    phases = tuple(2.0 * np.pi * k / discs + 0.1 for k in range(discs))
    words = {"disc.number_of_discs": discs, "disc.planes": ()}
    forward = with_fields(joint, {**words, "disc.phases": phases})
    reverse = with_fields(joint, {**words, "disc.phases": tuple(-p for p in phases), "load.direction": "cw"})
    plain, mirrored = analyse(forward, -ANGLES[:3]), analyse(reverse, ANGLES[:3])
    np.testing.assert_allclose(plain.full.wheel_moment, -mirrored.full.wheel_moment, rtol=1e-8)
    np.testing.assert_allclose(plain.torque_share, mirrored.torque_share, rtol=0.0, atol=1e-8)
    for number in range(discs):
        poses = [each.full.pose[:, Coordinates(discs=discs).columns(number)] for each in (plain, mirrored)]
        np.testing.assert_allclose(poses[0], poses[1] * [1.0, -1.0, -1.0, -1.0], rtol=0.0, atol=LENGTH)


@pytest.mark.parametrize("discs", [2, *(pytest.param(discs, marks=pytest.mark.slow) for discs in (1, 3))])
def test_turning_the_whole_drive_by_a_phase(joint, discs):
    """A disc at the phase ζ is at φ_C what one at phase 0 is at φ_C + ζ, turned: all phases ζ on is the crank ζ on.

    With ζ a whole number of hole pitches the pin shaft lies on itself; the wheel is taken ζ/u back. Rollers are alike at
    every ζ, for they stand at ζ + their place in the cage, at the cage's own angle of φ_C: so φ_C stays, frame and all.
    """
    turn = 2.0 * np.pi / 8.0  # a hole pitch; z_P/8 = 5 pins
    words = {"disc.number_of_discs": discs, "disc.planes": ()}
    phases = tuple(2.0 * np.pi * k / discs for k in range(discs))
    plain = analyse(with_fields(joint, {**words, "disc.phases": phases}), ANGLES[:3])
    turned = analyse(with_fields(joint, {**words, "disc.phases": tuple(p + turn for p in phases)}), ANGLES[:3])
    np.testing.assert_allclose(turned.full.pose[:, WHEEL_ANGLE], plain.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=ANGLE)
    for before, after in zip(plain.discs, turned.discs, strict=True):
        first, second = before.full.response, after.full.response
        np.testing.assert_allclose(np.roll(first.pin_load, 5, axis=1), second.pin_load, rtol=0.0, atol=LOAD)
        np.testing.assert_allclose(np.roll(first.hole_load, 1, axis=1), second.hole_load, rtol=0.0, atol=LOAD)
        np.testing.assert_allclose(first.rollers.outer_load, second.rollers.outer_load, rtol=0.0, atol=LOAD)


LENGTHS = {
    "eccentricity", "pin_circle_radius", "pin_radius", "thickness", "equidistant_offset", "shifting_offset", "planes",
    "inner_race_radius", "outer_race_radius", "roller_radius", "roller_length", "hole_radius", "bearing", "pin_hole", "amount",
}  # fmt: skip


def in_other_units(table, length, stress):
    """Every field in a unit of length 1/length mm and of stress 1/stress MPa."""
    factors = dict.fromkeys(LENGTHS, length) | {"youngs_modulus": stress, "stiffness": stress * length}
    factors |= dict.fromkeys(("torque", "light_torque"), stress * length**3)

    def changed(key, value):
        if isinstance(value, dict):
            return {name: changed(name, own) for name, own in value.items()}
        if isinstance(value, list):
            return [changed(key, own) for own in value]
        return value * factors[key] if key in factors else value

    return changed("", table)


@pytest.mark.parametrize("discs", [2, pytest.param(3, marks=pytest.mark.nightly)])
@pytest.mark.parametrize(("length", "stress"), [pytest.param(25.4, 1.0, marks=pytest.mark.slow), (1e-2, 1e-3)])
def test_units_are_a_matter_of_names(discs, length, stress):
    """In inches or GPa a reducer has the same loads in its units, whichever member is held."""
    table = tomllib.loads(shipped_drive("robot-joint"))
    del table["tolerances"]
    table["load"] = {"torque": 4e5, "light_torque": 1e4}
    table["disc"] |= {"number_of_discs": discs, "phases": [], "planes": []}
    table["disc"]["of"] = [{"runout": {"amount": 0.003, "angle": 1.0}}, *[{}] * (discs - 1)]
    plain, other = (analyse(build_drive(one), ANGLES[:2]) for one in (table, in_other_units(table, length, stress)))
    # residuals of 1e-9 of the load
    loads = other.full.response.pin_load / (stress * length**2)
    np.testing.assert_allclose(loads, plain.full.response.pin_load, rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(other.full.pose[:, WHEEL_ANGLE], plain.full.pose[:, WHEEL_ANGLE], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(other.torque_share, plain.torque_share, rtol=0.0, atol=1e-8)
