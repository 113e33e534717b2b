"""Deviations of real parts in the geometry: brute force, derivatives, and that none of them at zero changes a bit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import stack_drives
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import DISC_ROTATION
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies.tolerance_study import tolerance_study

MEASURED = tuple(np.linspace(0.1, 6.1, 9).tolist())

DEVIATED = {
    "crank.eccentricity_error": 0.02,
    "crank.axis_offset.x": 0.03,
    "crank.axis_offset.y": -0.02,
    "pin_wheel.axis_offset.x": -0.01,
    "pin_wheel.axis_offset.y": 0.025,
    "disc.runout.amount": 0.03,
    "disc.runout.angle": 0.7,
    "disc.profile_errors.orders": (2, 13),
    "disc.profile_errors.cosine": (0.01, -0.004),
    "disc.profile_errors.sine": (-0.006, 0.003),
    "disc.profile_errors.parameter": MEASURED,
    "disc.profile_errors.deviation": (0.004, -0.003, 0.0, 0.002, 0.005, -0.004, 0.001, -0.002, 0.003),
    "pin_wheel.pin_errors.radial.3": -0.01,
    "disc.hole_errors.tangential.2": 0.008,
}


@pytest.fixture(scope="module")
def deviated(paper_cases):
    return with_fields(paper_cases["CS-6"], DEVIATED)


def spline(theta):
    from scipy.interpolate import CubicSpline

    values = DEVIATED["disc.profile_errors.deviation"]
    curve = CubicSpline([*MEASURED, MEASURED[0] + 2.0 * np.pi], [*values, values[0]], bc_type="periodic")
    return curve(np.mod(theta - MEASURED[0], 2.0 * np.pi) + MEASURED[0])


def flank_by_definition(theta):
    """Eq. 1 with its own angle ψ, moved along the normal and off the bore; nothing taken from the package."""
    z, e, R, r = 14, 4.0, 88.09, 6.65
    psi = np.arctan2(np.sin((1 - z) * theta), R / (e * z) - np.cos((1 - z) * theta))
    delta = (
        0.01 * np.cos(2 * theta) - 0.006 * np.sin(2 * theta) - 0.004 * np.cos(13 * theta) + 0.003 * np.sin(13 * theta)
    )
    delta = delta + spline(theta)
    nominal = R * np.exp(1j * theta) - e * np.exp(1j * z * theta) - r * np.exp(1j * (theta + psi))
    return nominal + delta * np.exp(1j * (theta + psi)) + 0.03 * np.exp(0.7j)


def test_flank_against_its_definition(deviated):
    theta = np.linspace(-3.0, 9.0, 400)
    np.testing.assert_allclose(FlankProfile.of_drive(deviated).flank(theta), flank_by_definition(theta), atol=1e-12)


def test_tangent_and_curvature_of_the_deviated_flank(deviated):
    """By finite differences of the flank: the curvature holds δ″, so a dropped term shows."""
    profile = FlankProfile.of_drive(deviated)
    theta, h = np.linspace(0.0, 6.2, 150), 2e-5
    ahead, here, behind = (profile.flank(theta + shift) for shift in (h, 0.0, -h))
    first, second = (ahead - behind) / (2.0 * h), (ahead - 2.0 * here + behind) / h**2
    # h²/6 of the third derivative, 4e5 mm at the sharpest root
    np.testing.assert_allclose(profile.flank_tangent(theta), first, atol=1e-4)
    curvature = (first.conjugate() * second).imag / np.abs(first) ** 3
    # knots of the spline bend a little between the three points
    np.testing.assert_allclose(profile.curvature(theta), curvature, rtol=2e-4, atol=2e-5)
    np.testing.assert_allclose((first.conjugate() * profile.normal(theta)).real, 0.0, atol=1e-4)


def test_approach_against_brute_force(deviated):
    geometry = ContactGeometry.of_drive(deviated)
    rng = np.random.default_rng(2)
    angles = rng.uniform(-9.0, 9.0, 3)
    poses = rng.uniform(-1.0, 1.0, (3, 4)) * np.array([0.03, 0.03, 3e-4, 3e-4])
    found, holes = geometry.flank(angles, poses).approach, geometry.holes(angles, poses).approach
    for row, (angle, pose) in enumerate(zip(angles, poses, strict=True)):
        disc = 0.03 - 0.02j + 4.02 * np.exp(1j * angle) + pose[0] + 1j * pose[1]
        for pin in range(0, 14, 3):
            radial = -0.01 if pin == 3 else 0.0
            centre = -0.01 + 0.025j + (88.0 + radial) * np.exp(1j * (angle / 14 + pose[3] + 2 * np.pi * pin / 14))

            def distance(theta, disc=disc, pose=pose, centre=centre):
                return np.abs(disc + np.exp(1j * pose[2]) * flank_by_definition(theta) - centre)

            grid = np.linspace(0.0, 2.0 * np.pi, 4200, endpoint=False)
            best = grid[np.argmin(distance(grid))]
            least = minimize_scalar(
                distance, bounds=(best - 2e-3, best + 2e-3), method="bounded", options={"xatol": 1e-12}
            )
            assert found[row, pin] == pytest.approx(6.5 - least.fun, abs=1e-11)
        for hole in range(8):
            ray = np.exp(2j * np.pi * hole / 8)
            place = disc + np.exp(1j * pose[2]) * (56.0 + (0.008j if hole == 2 else 0.0)) * ray
            assert holes[row, hole] == pytest.approx(abs(56.0 * ray - place) - 4.03, abs=1e-12)


def test_derivatives_against_finite_differences(deviated):
    geometry = ContactGeometry.of_drive(deviated)
    rng = np.random.default_rng(3)
    angles = rng.uniform(-9.0, 9.0, 6)
    poses = rng.uniform(-1.0, 1.0, (6, 4)) * np.array([0.03, 0.03, 3e-4, 3e-4])
    lever = np.array([1.0, 1.0, 88.0, 88.0])
    load = rng.uniform(0.0, 5000.0, (6, 14))
    here = geometry.flank(angles, poses)
    for column in range(4):
        move = np.zeros(4)
        move[column] = 1e-4 / lever[column]
        ahead, behind = geometry.flank(angles, poses + move), geometry.flank(angles, poses - move)
        slope = (ahead.approach - behind.approach) / (2.0 * move[column])
        np.testing.assert_allclose(here.gradient[..., column] / lever[column], slope / lever[column], atol=1e-7)
        force_ahead = np.einsum("bi,bij->bj", load, ahead.gradient)
        force_behind = np.einsum("bi,bij->bj", load, behind.gradient)
        bend = (force_ahead - force_behind) / (2.0 * move[column]) / lever / lever[column]
        size = np.abs(here.bend(load) / lever[:, None] / lever).max()
        # h² by the third derivative where the flank is sharpest: (1e-4/1.5)² ~ 1e-8 … and knots of the spline
        np.testing.assert_allclose(here.bend(load)[..., column] / lever / lever[column], bend, atol=1e-4 * size)


@pytest.mark.slow
def test_zero_deviations_change_nothing_to_the_last_bit(paper_cases):
    zeros = {
        "crank.eccentricity_error": 0.0,
        "crank.axis_offset.x": 0.0,
        "disc.runout.amount": 0.0,
        "disc.runout.angle": 1.0,
        "disc.profile_errors.orders": (3,),
        "disc.profile_errors.cosine": (0.0,),
        "pin_wheel.pin_errors.radial": (0.0,) * 14,
    }
    angles = np.linspace(0.0, 6.0, 7)
    for drive in paper_cases.values():
        plain = analyse(drive, angles)
        zeroed = analyse(with_fields(drive, zeros), angles)
        np.testing.assert_array_equal(plain.full.pose, zeroed.full.pose)
        np.testing.assert_array_equal(plain.full.response.pin_load, zeroed.full.response.pin_load)


def test_offset_of_every_axis_together_is_no_deviation(paper_cases):
    """Crank and wheel moved alike against the pin shaft act like shaft pins moved the other way."""
    drive = paper_cases["CS-3"]
    x, y = 0.012, -0.007
    both = {
        "crank.axis_offset.x": x,
        "crank.axis_offset.y": y,
        "pin_wheel.axis_offset.x": x,
        "pin_wheel.axis_offset.y": y,
    }
    rays = np.exp(2j * np.pi * np.arange(8) / 8)
    shift = (-x - 1j * y) * rays.conjugate()
    pins = {
        "pin_shaft.pin_errors.radial": tuple(shift.real.tolist()),
        "pin_shaft.pin_errors.tangential": tuple(shift.imag.tolist()),
    }
    angles = np.linspace(0.0, 6.0, 5)
    one, other = analyse(with_fields(drive, both), angles), analyse(with_fields(drive, pins), angles)
    # both balance to 1e-9 of the load
    np.testing.assert_allclose(one.full.response.pin_load, other.full.response.pin_load, atol=1e-4)
    np.testing.assert_allclose(one.full.pose, other.full.pose, atol=1e-9)


def test_runout_along_the_bore_offset(paper_cases):
    """A flank off the bore is a bore, holes and all off the flank: hole errors and another crank place undo it."""
    drive = paper_cases["CS-3"]
    amount, angle = 0.01, 0.4
    moved = with_fields(drive, {"disc.runout.amount": amount, "disc.runout.angle": angle})
    geometry, plain = ContactGeometry.of_drive(moved), ContactGeometry.of_drive(drive)
    angles, pose = np.array([0.3, 2.0]), np.array([[0.01, 0.0, 2e-4, 1e-4], [0.0, -0.01, -1e-4, 0.0]])
    shifted = pose.copy()
    step = amount * np.exp(1j * (angle + pose[:, DISC_ROTATION]))
    shifted[:, 0] += step.real
    shifted[:, 1] += step.imag
    np.testing.assert_allclose(geometry.flank(angles, pose).approach, plain.flank(angles, shifted).approach, atol=1e-13)


def _together_and_alone(drives, angles):
    model = stack_drives([HalfSpaceCompliance.of_drive(each, in_batch=True) for each in drives], angles.size)
    moment = drives[0].wheel_moment()
    everywhere, series = np.tile(angles, len(drives)), len(drives)
    together = solve_equilibrium(Reducer(discs=(model,)), everywhere, moment, series=series)
    pressures = model.pressures(together.response.parts[0])
    for number, drive in enumerate(drives):
        own = HalfSpaceCompliance.of_drive(drive)
        alone = solve_equilibrium(Reducer(discs=(own,)), angles, moment)
        rows = slice(angles.size * number, angles.size * (number + 1))
        yield alone, together, rows, own.pressures(alone.response.parts[0]).pins.mid, pressures.pins.mid[rows]


@pytest.mark.slow
def test_batch_of_real_drives_against_one_by_one():
    """Samples of the paper's tolerances: the same iteration on stacked arrays, so they agree to round-off."""
    file = load_drive("paper")
    design = tolerance_study(file, case="CS-6", samples=4, positions=6, seed=5)
    drives = [design.sample_drive(number) for number in range(4)]
    for alone, together, rows, own_pressure, pressure in _together_and_alone(drives, np.linspace(0.0, 6.0, 6)):
        np.testing.assert_array_equal(alone.iterations, together.iterations[rows])
        # places are known to 1e-14 of 88 mm, stiffnesses are some 1e6 N/mm
        np.testing.assert_allclose(together.pose[rows], alone.pose, atol=1e-12)
        for name in ("pin_load", "hole_load"):
            np.testing.assert_allclose(getattr(together.response, name)[rows], getattr(alone.response, name), atol=1e-6)
        np.testing.assert_allclose(pressure, own_pressure, atol=1e-5)


@pytest.mark.slow
def test_batch_of_far_off_drives_against_one_by_one(paper_cases, deviated):
    """Parts that interfere in their nominal place, orders, axes and design differing: equal to the residuals' 1e-9."""
    form = {name: value for name, value in DEVIATED.items() if "profile_errors" in name}
    drives = [
        with_fields(paper_cases["CS-6"], form),
        deviated,
        with_fields(deviated, {"disc.runout.angle": 2.0, "disc.equidistant_offset": 0.16, "pin_shaft.stiffness": 5e5}),
    ]
    for alone, together, rows, own_pressure, pressure in _together_and_alone(drives, np.linspace(0.0, 6.0, 5)):
        for name in ("pin_load", "hole_load"):
            np.testing.assert_allclose(getattr(together.response, name)[rows], getattr(alone.response, name), atol=1e-4)
        np.testing.assert_allclose(pressure, own_pressure, atol=1e-4)


def test_flanks_of_a_batch_are_the_flanks_of_its_drives(paper_cases):
    """Each with waves of its own: amplitudes belong to positions, not to pins."""
    waves = ((0.01, -0.004), (-0.02, 0.007), (0.0, 0.003))
    named = ("disc.profile_errors.cosine", "disc.profile_errors.sine")
    drives = [
        with_fields(paper_cases["CS-1"], {"disc.profile_errors.orders": (2, 13), named[0]: wave, named[1]: wave[::-1]})
        for wave in waves
    ]
    angles, pose = np.array([0.2, 4.0]), np.zeros((6, 4))
    batch = stack_drives([ContactGeometry.of_drive(each) for each in drives], angles.size).flank(
        np.tile(angles, len(drives)), pose
    )
    for number, drive in enumerate(drives):
        own = slice(number * angles.size, (number + 1) * angles.size)
        alone = ContactGeometry.of_drive(drive).flank(angles, pose[own])
        # the same sums in another order of arrays
        np.testing.assert_allclose(batch.approach[own], alone.approach, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(batch.effective_radius[own], alone.effective_radius, rtol=1e-11)
