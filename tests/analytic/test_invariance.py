"""What must not change the answer: the frame, the numbering, the units, the sense of the crank."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.geometry.coordinates import Coordinates, disc_displacement
from ltca.reading.drive_file import build_drive

# analyse balances to 1e-9 of the load of some 1000 N, over stiffnesses above 1e5 N/mm
ROTATIONS = Coordinates().rotations
LOAD = 1e-5  # N
LENGTH = 1e-9  # mm
ANGLE = 1e-11  # rad


@pytest.fixture(scope="module")
def symmetric(paper_table):
    """A drive that turned by a hole pitch (60°) lies on itself: z_C = 12, 6 holes, cage speed 0.4, 10 rollers."""

    def build(shift=0):
        """With every part error moved on by `shift` hole pitches: 1 hole, 2 pins, −6·…/… rollers as below."""
        rng = np.random.default_rng(7)

        def errors(count, by, names=("radial", "tangential", "diameter")):
            values = {name: 4e-3 * rng.uniform(-1.0, 1.0, count) for name in names}
            return {name: np.roll(value, by * shift).tolist() for name, value in values.items()}

        return build_drive(
            paper_table(
                pin_wheel={"number_of_pins": 13, "pin_errors": errors(13, 2)},
                disc={"number_of_teeth": 12, "hole_errors": errors(6, 1)},
                pin_shaft={"number_of_pins": 6, "pin_errors": errors(6, 1)},
                crank_bearing={
                    "inner_race_radius": 20.0,
                    "outer_race_radius": 30.0,
                    "number_of_rollers": 10,
                    "roller_errors": errors(10, 1, ("tangential", "diameter")),
                },
                clearance={"bearing": 0.02, "pin_hole": 0.02},
            )
        )

    return build


def test_turning_everything_by_a_hole_pitch(symmetric):
    """Frame and numbering at once, with random errors on every part.

    Turned by 2π/6 the crank is at φ + 2π/6, but the wheel has turned by (2π/6)/13 only: 2 pins further back. The
    cage has turned by 0.4·2π/6, which is 2π/6 less one roller pitch (0.6·10/6 = 1). So hole k → k+1, pin i → i+2,
    roller n → n+1, and components along and across the eccentricity stay.
    """
    angles = np.linspace(0.0, 25.0, 24)
    plain = analyse(symmetric(0), angles)
    turned = analyse(symmetric(1), angles + 2.0 * np.pi / 6.0)
    first, second = plain.full.response, turned.full.response
    np.testing.assert_allclose(np.roll(first.pin_load, 2, axis=1), second.pin_load, atol=LOAD)
    np.testing.assert_allclose(np.roll(first.hole_load, 1, axis=1), second.hole_load, atol=LOAD)
    np.testing.assert_allclose(np.roll(first.rollers.outer_load, 1, axis=1), second.rollers.outer_load, atol=LOAD)
    np.testing.assert_allclose(np.roll(first.rollers.inner_load, 1, axis=1), second.rollers.inner_load, atol=LOAD)
    np.testing.assert_allclose(plain.bearing_radial, turned.bearing_radial, atol=LOAD)
    np.testing.assert_allclose(plain.bearing_tangential, turned.bearing_tangential, atol=LOAD)
    np.testing.assert_allclose(plain.full.pose[:, ROTATIONS], turned.full.pose[:, ROTATIONS], atol=ANGLE)
    displacement = [disc_displacement(a.full.pose) * np.exp(-1j * a.full.crank_angle) for a in (plain, turned)]
    np.testing.assert_allclose(displacement[0], displacement[1], atol=LENGTH)
    # and the errors are felt: without moving them on the answer differs
    unmoved = analyse(symmetric(0), angles + 2.0 * np.pi / 6.0)
    assert np.max(np.abs(unmoved.full.response.hole_load - second.hole_load)) > 1.0


@pytest.mark.slow
def test_true_period_of_the_papers_drive(paper_cases):
    """98 turns of the crank: 39 turns of the cage (98·19.5/49) and 7 of the wheel."""
    angles = np.linspace(0.0, 6.0, 12)
    drive = paper_cases["CS-4"]
    now, later = analyse(drive, angles), analyse(drive, angles + 98.0 * 2.0 * np.pi)
    # arguments of 600 rad carry round-off of 1e-13 rad, on 88 mm 1e-11 mm and some 1e-5 N
    np.testing.assert_allclose(now.full.response.pin_load, later.full.response.pin_load, atol=1e-3)
    np.testing.assert_allclose(now.full.response.rollers.outer_load, later.full.response.rollers.outer_load, atol=1e-3)
    np.testing.assert_allclose(now.full.pose[:, ROTATIONS], later.full.pose[:, ROTATIONS], atol=1e-10)
    # one turn is no period: the rollers stand elsewhere
    once = analyse(drive, angles + 2.0 * np.pi)
    assert np.max(np.abs(once.full.response.rollers.outer_load - now.full.response.rollers.outer_load)) > 100.0


@pytest.mark.parametrize("case", ["CS-1", "CS-6"])
def test_reverse_is_the_mirror_image(vary, paper_cases, case):
    clearance = {"bearing": paper_cases[case].clearance.bearing, "pin_hole": paper_cases[case].clearance.pin_hole}
    angles = np.linspace(0.0, 40.0, 30)
    forward = analyse(vary(clearance=clearance), -angles)
    reverse = analyse(vary(clearance=clearance, load={"direction": "cw"}), angles)
    pins, rollers, holes = (-np.arange(n) % n for n in (14, 11, 8))
    first, second = forward.full.response, reverse.full.response
    np.testing.assert_allclose(first.pin_load[:, pins], second.pin_load, atol=LOAD)
    np.testing.assert_allclose(first.rollers.outer_load[:, rollers], second.rollers.outer_load, atol=LOAD)
    np.testing.assert_allclose(first.hole_load[:, holes], second.hole_load, atol=LOAD)
    np.testing.assert_allclose(forward.bearing_radial, reverse.bearing_radial, atol=LOAD)
    np.testing.assert_allclose(forward.bearing_tangential, -reverse.bearing_tangential, atol=LOAD)
    np.testing.assert_allclose(forward.full.pose, reverse.full.pose * [1.0, -1.0, -1.0, -1.0], atol=LENGTH)
    np.testing.assert_allclose(forward.light.pose, reverse.light.pose * [1.0, -1.0, -1.0, -1.0], atol=LENGTH)


LENGTHS = {
    "eccentricity", "pin_circle_radius", "pin_radius", "thickness", "equidistant_offset", "shifting_offset",
    "inner_race_radius", "outer_race_radius", "roller_radius", "roller_length", "hole_radius", "bearing", "pin_hole",
}  # fmt: skip


def scaled(table, length, stress):
    """Every field in a unit of length 1/length mm and of stress 1/stress MPa."""
    factors = dict.fromkeys(LENGTHS, length)
    factors |= {"youngs_modulus": stress, "stiffness": stress * length}
    factors |= {"torque": stress * length**3, "light_torque": stress * length**3}
    result = copy.deepcopy(table)
    for key, value in table.items():
        if isinstance(value, dict):
            result[key] = scaled(value, length, stress)
        elif key in factors:
            result[key] = value * factors[key]
    return result


@pytest.mark.parametrize(
    ("length", "stress"),
    [*(pytest.param(*one, marks=pytest.mark.slow) for one in [(1e-3, 1.0), (25.4, 1.0), (1.0, 1e-3)]), (0.04, 70.0)],
)
def test_unit_invariance(paper_table, length, stress):
    """A drive in metres, inches, GPa has the same loads in its units: no hidden length or force in the solver."""
    table = paper_table(clearance={"bearing": 0.03, "pin_hole": 0.02})
    angles = np.linspace(0.0, 6.0, 10)
    plain, other = analyse(build_drive(table), angles), analyse(build_drive(scaled(table, length, stress)), angles)
    force = stress * length**2
    first, second = plain.full.response, other.full.response
    # residuals of 1e-9 of the load
    np.testing.assert_allclose(second.pin_load / force, first.pin_load, atol=1e-4)
    np.testing.assert_allclose(second.hole_load / force, first.hole_load, atol=1e-4)
    np.testing.assert_allclose(second.rollers.outer_load / force, first.rollers.outer_load, atol=1e-4)
    np.testing.assert_allclose(other.full.pose[:, :2] / length, plain.full.pose[:, :2], atol=1e-9)
    np.testing.assert_allclose(other.full.pose[:, ROTATIONS], plain.full.pose[:, ROTATIONS], atol=1e-11)
    np.testing.assert_allclose(other.light.pose[:, ROTATIONS], plain.light.pose[:, ROTATIONS], atol=1e-11)
    np.testing.assert_allclose(other.pressures.pins.mid / stress, plain.pressures.pins.mid, atol=1e-5)
    np.testing.assert_allclose(other.pressures.pins.half_width / length, plain.pressures.pins.half_width, atol=1e-9)


def test_zero_error_arrays_change_nothing(vary):
    zeros = {
        "pin_wheel": {"pin_errors": {n: [0.0] * 14 for n in ("radial", "tangential", "diameter")}},
        "disc": {"hole_errors": {n: [0.0] * 8 for n in ("radial", "tangential", "diameter")}},
        "pin_shaft": {"pin_errors": {n: [0.0] * 8 for n in ("radial", "tangential", "diameter")}},
        "crank_bearing": {"roller_errors": {n: [0.0] * 11 for n in ("tangential", "diameter")}},
    }
    angles = np.linspace(0.0, 6.0, 6)
    plain, zeroed = analyse(vary(), angles), analyse(vary(**zeros), angles)
    np.testing.assert_array_equal(plain.full.pose, zeroed.full.pose)
    np.testing.assert_array_equal(plain.full.response.pin_load, zeroed.full.response.pin_load)


def test_all_pins_larger_is_a_smaller_equidistant_offset(vary):
    """A diameter error of every pin by 2ε closes each gap by ε, as Δr_P − ε would with the flank moved instead.

    Moving the flank changes its curvature, so only the unloaded geometry is the same.
    """
    from ltca.geometry.first_contact import first_contact
    from ltca.geometry.pairs import WHEEL_ANGLE, ContactGeometry

    angles = np.linspace(0.0, 6.0, 20)
    errors = {"diameter": [0.02] * 14}
    larger = ContactGeometry.of_drive(vary(pin_wheel={"pin_errors": errors}))
    closer = ContactGeometry.of_drive(vary(disc={"equidistant_offset": 0.14}))
    np.testing.assert_allclose(
        first_contact(larger, angles, WHEEL_ANGLE, 1)[0], first_contact(closer, angles, WHEEL_ANGLE, 1)[0], atol=1e-13
    )
