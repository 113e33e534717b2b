"""The flank against its own definition: the envelope of the generating pins, brute force, finite differences."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import ltca.geometry.flank
from ltca.errors import ConvergenceError
from ltca.geometry.flank import FlankProfile, trochoid_curvature


def flank_of_equation_1(drive, theta):
    """Eq. 1 with the pressure-angle term of the offset pin wheel, written from the reading notes."""
    wheel, e = drive.pin_wheel, drive.crank.eccentricity
    z = wheel.number_of_pins
    R = wheel.pin_circle_radius + drive.disc.shifting_offset
    r = wheel.pin_radius + drive.disc.equidistant_offset
    psi = np.arctan2(np.sin((1 - z) * theta), R / (e * z) - np.cos((1 - z) * theta))
    x = R * np.cos(theta) - r * np.cos(theta + psi) - e * np.cos(z * theta)
    y = R * np.sin(theta) - r * np.sin(theta + psi) - e * np.sin(z * theta)
    return x + 1j * y, theta + psi


@pytest.fixture(scope="module")
def drives(paper_cases, random_drives):
    return [paper_cases["CS-1"], *random_drives]


def test_flank_and_normal_are_those_of_equation_1(drives):
    theta = np.linspace(-7.0, 7.0, 501)
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        point, normal_angle = flank_of_equation_1(drive, theta)
        radius = drive.pin_wheel.pin_circle_radius
        # round-off of sums of the size of the pin circle radius, magnified by z_P θ in the argument of the cosine
        np.testing.assert_allclose(profile.flank(theta), point, rtol=0.0, atol=1e-13 * radius)
        np.testing.assert_allclose(profile.normal(theta), np.exp(1j * normal_angle), rtol=0.0, atol=1e-12)


def test_a_flank_of_which_nothing_else_is_said_is_centred_and_its_first_root_lies_ahead():
    """Eq. 1 at θ = 0: R − r − e; the roots are a regular polygon, whose centre is that of the disc."""
    profile = FlankProfile(generating_radius=51.5, eccentricity=3.0, reduction_ratio=14.0, offset=5.0)
    roots = profile.flank(2.0 * np.pi * np.arange(13) / 13)
    np.testing.assert_allclose(roots[0], 51.5 - 5.0 - 3.0, rtol=1e-13)
    np.testing.assert_allclose(np.mean(roots), 0.0, atol=1e-12)
    # As for every model (tests/ltca/test_arrays.py): what may differ by drive is declared with the axes that it has.
    declared = {item.name: item.metadata["axes"] for item in fields(profile) if "axes" in item.metadata}
    assert declared == {name: np.ndim(getattr(profile, name)) for name in declared}


def test_generating_pins_touch_the_flank_and_never_overlap_it(drives):
    """Envelope: pins of radius r_P + Δr_P on R_C + ΔR_C, rolled about the disc through a whole revolution."""
    for drive in drives[:4]:
        profile = FlankProfile.of_drive(drive)
        wheel, e = drive.pin_wheel, drive.crank.eccentricity
        z, radius = wheel.number_of_pins, wheel.pin_radius + drive.disc.equidistant_offset
        flank = profile.flank(np.linspace(0.0, 2.0 * np.pi, 12_000, endpoint=False))
        step = np.max(np.abs(np.diff(flank)))
        # The distance to a sample exceeds that to the curve by at most s²/2 (1/r + κ) with s half a step; κ < 2/r.
        discretisation = (0.5 * step) ** 2 / 2.0 * 3.0 / radius
        for crank in np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False) + 0.123:
            # The disc translates on the crank circle without turning, the pin wheel turns at 1/z of the crank.
            pins = (wheel.pin_circle_radius + drive.disc.shifting_offset) * np.exp(
                1j * (crank / z + 2.0 * np.pi * np.arange(z) / z)
            )
            disc_centre = e * np.exp(1j * crank)
            distance = np.abs(pins[:, None] - disc_centre - flank[None, :]).min(axis=1)
            assert np.min(distance) >= radius - 1e-12 * wheel.pin_circle_radius  # no sample inside a pin: exact
            assert np.max(distance) <= radius + discretisation


def test_normal_is_perpendicular_to_the_flank_and_points_out(drives):
    theta = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 200)
    h = 1e-6
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        chord = profile.flank(theta + h) - profile.flank(theta - h)
        normal = profile.normal(theta)
        np.testing.assert_allclose(np.abs(normal), 1.0, rtol=1e-14)
        # central difference: h² by the bend of a tooth (z_P² h² ~ 1e-9) and round-off of 1e-14/h
        np.testing.assert_allclose((normal.conjugate() * chord).real / np.abs(chord), 0.0, atol=1e-6)
        # ccw parameter: the disc lies to the left of the tangent, its outside to the right
        assert np.all((normal.conjugate() * chord).imag > 0.0)


def test_curvature_is_that_of_the_circle_through_three_points(drives):
    theta = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 200)
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        # 1e-3 of a tooth: Menger's curvature has a relative error of order h² z_P² = 1e-5 … 1e-6 of the largest
        h = 1e-3 / drive.pin_wheel.number_of_pins
        for curve, curvature in (
            (profile.flank, profile.curvature),
            (lambda t, p=profile: p.locus(t)[0], lambda t, p=profile: p.locus(t).curvature),
        ):
            a, b, c = curve(theta - h), curve(theta), curve(theta + h)
            cross = ((b - a).conjugate() * (c - b)).imag
            menger = 2.0 * cross / (np.abs(b - a) * np.abs(c - b) * np.abs(c - a))
            scale = np.max(np.abs(menger))
            np.testing.assert_allclose(curvature(theta), menger, rtol=0.0, atol=5e-5 * scale)


def test_derivatives_of_the_locus(drives):
    theta = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, 100)
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        z = drive.pin_wheel.number_of_pins
        h = 1e-4 / z
        before, now, after = (profile.locus(theta + k * h) for k in (-1, 0, 1))
        # central differences: relative error (z h)²/6 ~ 2e-9, round-off 1e-16/(z h) ~ 1e-11 of z R
        for order in (0, 1):
            difference = (after[order] - before[order]) / (2.0 * h)
            np.testing.assert_allclose(difference, now[order + 1], rtol=0.0, atol=1e-8 * np.max(np.abs(now[order + 1])))


def test_effective_radius_of_pin_and_flank(drives):
    """1/ρ is the rate at which the gap between two circles that touch opens: gap = x²/(2ρ)."""
    for drive in drives[:2]:
        profile = FlankProfile.of_drive(drive)
        theta = np.linspace(0.1, 0.9, 7) * 2.0 * np.pi / drive.pin_wheel.number_of_pins
        pin = drive.pin_wheel.pin_radius
        contact, normal = profile.flank(theta), profile.normal(theta)
        # A pin touching at θ: the gap of a neighbouring flank point to it, against x²/(2ρ)
        centre = contact + pin * normal
        # 1e-5 of a tooth pitch sideways keeps cubic terms (1e-5) and round-off (1e-14/1e-7) small
        h = 1e-3 / drive.pin_wheel.number_of_pins
        gaps, places = [], []
        for sign in (-1, 1):
            point = profile.flank(theta + sign * h)
            gaps.append(np.abs(point - centre) - pin)
            places.append(np.abs(point - contact))
        opening = 0.5 * sum(2.0 * gap / place**2 for gap, place in zip(gaps, places, strict=True))
        np.testing.assert_allclose(1.0 / profile.effective_radius(theta, pin), opening, rtol=1e-4, atol=1e-5 / pin)


def test_nearest_point_against_brute_force(drives):
    """Points about a pin radius away, as far off as play and errors ever put a pin centre."""
    rng = np.random.default_rng(4)
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        z = drive.pin_wheel.number_of_pins
        theta = rng.uniform(0.0, 2.0 * np.pi, 12)
        off = 2e-3 * drive.pin_wheel.pin_circle_radius
        point = profile.locus(theta)[0] + off * (rng.uniform(-1, 1, 12) + 1j * rng.uniform(-1, 1, 12))
        found = profile.nearest_point(point, theta + rng.uniform(-0.1, 0.1, 12) / z).parameter
        for p, parameter in zip(point, found, strict=True):
            grid = np.linspace(0.0, 2.0 * np.pi, 400 * z, endpoint=False)
            best = grid[np.argmin(np.abs(profile.flank(grid) - p))]
            width = 2.0 * np.pi / (400 * z)
            answer = minimize_scalar(
                lambda t, p=p, profile=profile: abs(complex(profile.flank(np.array(t))) - p),
                bounds=(best - width, best + width),
                method="bounded",
                options={"xatol": 1e-12},
            )
            distance = float(profile.distance(np.array(p), np.array(parameter)))
            # at a minimum the distance is quadratic in the parameter: 1e-8 in θ leaves 1e-14 in the distance
            assert distance == pytest.approx(answer.fun, abs=1e-11 * drive.pin_wheel.pin_circle_radius)
            assert np.angle(np.exp(1j * (parameter - answer.x))) == pytest.approx(0.0, abs=1e-6)


def test_nearest_point_says_when_it_fails(monkeypatch):
    monkeypatch.setattr(ltca.geometry.flank, "MAX_ITERATIONS", 2)
    profile = FlankProfile(generating_radius=88.09, eccentricity=4.0, reduction_ratio=14.0, offset=6.65)
    with pytest.raises(ConvergenceError, match="contact points on the flank") as caught:
        profile.nearest_point(np.array([80.0 + 5.0j]), np.array([1.0]))
    assert len(caught.value.history) == 2


def test_root_and_tip_radius(drives):
    for drive in drives:
        profile = FlankProfile.of_drive(drive)
        radius = np.abs(profile.flank(np.linspace(0.0, 2.0 * np.pi, 20_001)))
        # an extremum sampled at 1/700 of a tooth or finer is met to 1e-5 of the height of a tooth, 2e
        assert radius.min() == pytest.approx(profile.root_radius, abs=2e-5 * profile.eccentricity)
        assert radius.max() == pytest.approx(profile.tip_radius, abs=2e-4 * profile.eccentricity)
        assert np.argmin(radius) == 0 or radius[0] == pytest.approx(radius.min(), rel=1e-12)


@pytest.mark.parametrize(("radius", "eccentricity", "pins"), [(60.0, 1.0, 40), (88.0, 4.0, 14)])
def test_the_curvature_of_the_trochoid_was_written_three_times(radius, eccentricity, pins):
    """At the ends (1 ± z K)/(R (1 ± K)²) by hand, on a circle 1/R."""
    shortening = eccentricity * pins / radius
    ends = [(1.0 + way * pins * shortening) / (radius * (1.0 + way * shortening) ** 2) for way in (-1.0, 1.0)]
    found = trochoid_curvature(radius, eccentricity, pins, np.array([1.0, -1.0]))
    np.testing.assert_allclose(found, ends, rtol=1e-12)
    np.testing.assert_allclose(trochoid_curvature(radius, 0.0, pins, np.array([0.3])), 1.0 / radius, rtol=1e-15)


def test_a_flank_followed_by_its_derivatives_over_the_last_step_is_the_flank_there(drives):
    """Of turned flanks beside the root as elsewhere: 1e-11 of the least radius of curvature, here of c″ = u² e, as it is said."""
    theta, step = np.linspace(0.0, 2.0 * np.pi, 41), ltca.geometry.flank.NEARLY
    for drive in drives:
        for turn in (1.0, np.exp(0.3j)):
            flank = replace(FlankProfile.of_drive(drive), turn=turn, deviation=None)
            moved = flank._moved(flank.contact_curve(np.exp(1j * theta)), np.full(theta.shape, step))
            there = flank.contact_curve(np.exp(1j * (theta - step)))
            for found, expected in zip(moved, there, strict=True):
                assert found == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())
