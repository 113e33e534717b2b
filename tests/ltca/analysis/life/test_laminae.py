"""Slices of rollers: continuous in the profile, against Hertz's ellipse and against a thousand slices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator

from ltca.analysis.life.laminae import (
    APPROACH_RATIO,
    LAMINAE,
    RUNGS,
    SolvedLaminae,
    monotone_cubic,
    solve_laminae,
    straight_rollers,
)
from ltca.drive.parts import LengthProfile
from ltca.geometry.length_profile import generator_profile
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import solve_profiled_patch
from validation.hertz import solve_point_contact

LENGTH, RADIUS, RHO, MODULUS = 11.8, 5.0, 1.0 / (1.0 / 5.0 + 1.0 / 19.5), 113_187.0


def laminae(**profile):
    relief = generator_profile(LengthProfile(**profile), LENGTH, RADIUS)
    return SolvedLaminae(profile=relief, length=LENGTH, effective_radius=RHO, contact_modulus=MODULUS)


def factor(of, load):
    """4.5-power mean of the shares at a load."""
    return float(of.shares(np.array([load]))[0] ** 4.5 @ of.weights) ** (1.0 / 4.5)


def test_a_crown_of_a_nanometre_is_a_straight_roller():
    """It raised the life by 19 %: edge factors went away at once. Now it moves shares as far as the approach moves: 1e-7."""

    def at(**profile):
        of = laminae(**profile)
        return solve_laminae(of.profile, LENGTH, RHO, 0.01)[1]

    straight = at()
    np.testing.assert_allclose(at(crown_drop=1e-9), straight, rtol=1e-6)
    # and then on evenly: every further quarter of a micrometre takes of the peaks, by less than the one before
    means = [float(row**4.5 @ laminae().weights) for row in (straight, *(at(crown_drop=2.5e-4 * n) for n in (1, 2, 3)))]
    falls = -np.diff(means)
    assert np.all(falls > 0.0)
    assert np.all(np.diff(falls) < 0.0)
    assert falls[0] < 2.0 * falls[2]


@pytest.mark.slow
def test_shares_are_those_of_the_load():
    for of in (laminae(), laminae(logarithmic_factor=1.0), laminae(end_relief_length=2.0, end_relief_depth=0.005)):
        loads = np.array([10.0, 200.0, 2999.0, 3000.0])
        shares = of.shares(loads)
        assert shares.shape == (4, LAMINAE // 2 + 1)
        np.testing.assert_allclose(shares @ of.weights, 1.0, rtol=1e-12)
        assert np.all(shares >= 0.0)


def test_a_straight_roller_peaks_at_its_ends():
    """In the contact itself, with no factor on top; the load is that of the table of straight contacts."""
    load, row = solve_laminae(None, LENGTH, RHO, 0.01)
    law, _ = LineContactLaw(LENGTH, MODULUS).load_and_stiffness(0.01, RHO)
    assert MODULUS * load == pytest.approx(float(law), rel=2e-3)  # 8 cells over the half-width
    assert np.all(np.diff(row) > 0.0)
    assert row[0] < 1.0 < row[-2] < 1.2 < row[-1]


def test_straight_rollers_of_all_sizes_are_one():
    """Each bore and each modulus solved its own contacts: half of what a check of six cases cost. Here at its own size."""
    of = laminae()
    height = LENGTH**2 / RHO
    number = round(np.log(0.01 / height) / np.log(APPROACH_RATIO))
    part, row = solve_laminae(None, LENGTH, RHO, height * APPROACH_RATIO**number)
    # at the load of a rung nothing is interpolated; differences of cubes over the grid leave 1e-7 of round-off
    found = of.shares(np.array([MODULUS * part]))[0]
    np.testing.assert_allclose(found, row, rtol=1e-6)


@pytest.mark.slow
def test_heavy_crown_against_the_ellipse_of_hertz():
    """A contact that ends inside: q = ¾ Q/a (1 − y²/a²), whose 4.5-power mean over the length is known."""
    crown = 0.05  # mm at the ends: a radius of 348 mm along the length
    point = solve_point_contact(0.005, RHO, (0.5 * LENGTH) ** 2 / (2.0 * crown), MODULUS)
    a, load = point.half_axis_long, point.load
    assert a < 0.4 * LENGTH
    integral = quad(lambda t: (1.0 - t * t) ** 4.5, 0.0, 1.0)[0]
    by_hand = (a / (0.5 * LENGTH) * (0.75 * LENGTH / a) ** 4.5 * integral) ** (1.0 / 4.5)
    # slices of a sixth of the ellipse average over it: half a percent
    assert factor(laminae(crown_drop=crown), load) == pytest.approx(by_hand, rel=0.01)


@pytest.mark.parametrize(
    "profile",
    [
        {"logarithmic_factor": 1.0},
        pytest.param({"crown_drop": 0.02}, marks=pytest.mark.slow),
        pytest.param({"end_relief_length": 4.0, "end_relief_depth": 0.02}, marks=pytest.mark.slow),
    ],
)
def test_against_a_thousand_slices(profile):
    """Profiles whose load ends inside: the patch behind the load law, on its own grid, cut into a thousand slices."""
    relief = generator_profile(LengthProfile(**profile), LENGTH, RADIUS)
    patch = solve_profiled_patch(relief, RHO, MODULUS, 0.01, cells=24)
    y = patch.grid.y_edges
    upto = np.concatenate([[0.0], np.cumsum((patch.pressure * patch.grid.areas).sum(axis=0))])
    edges = np.linspace(0.0, 0.5 * LENGTH, 501)
    cut = np.diff(PchipInterpolator(y, upto)(np.minimum(edges, y[-1])))
    fine = np.mean((500.0 * cut / upto[-1]) ** 4.5) ** (1.0 / 4.5)
    # 31 slices and 8 cells against 1000 and 24; the mean of a straight roller would be off by more than 5 %
    assert factor(laminae(**profile), patch.load) == pytest.approx(fine, rel=2e-3)


@pytest.mark.slow
def test_between_solved_loads_nothing_is_lost():
    """Shares at a load by interpolation against a contact solved at that load."""
    of = laminae(crown_drop=0.005)
    for approach in (0.004, 0.0093, 0.0117):
        part, row = solve_laminae(of.profile, LENGTH, RHO, approach)
        load = MODULUS * part
        found = of.shares(np.array([load, 4000.0]))[0]
        # a slice where the contact ends is an edge in the load, and little of the damage
        np.testing.assert_allclose(found, row, atol=0.02)
        assert factor(of, load) == pytest.approx(float(row**4.5 @ of.weights) ** (1.0 / 4.5), rel=1e-3)


@pytest.mark.parametrize("count", [2, 3, 4, 9])
def test_interpolation_is_that_of_scipy(count):
    """Falling, rising and level values, evenly and unevenly spaced; both are some ten operations, so round-off is 1e-15."""
    rng = np.random.default_rng(count)
    place = np.sort(rng.random(count)) + 0.01 * np.arange(count)
    at = np.append(rng.uniform(place[0], place[-1], 50), place)
    for values in (
        rng.random((count, 16)),
        np.round(3.0 * rng.random((count, 16))),
        np.sort(rng.random((count, 16)), axis=0),
    ):
        theirs = PchipInterpolator(place, values, axis=0)(at)
        np.testing.assert_allclose(monotone_cubic(place, values, at), theirs, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("number", [RUNGS[0], -27, RUNGS[-1]])
def test_straight_rollers_of_the_package_are_those_solved(number):
    """Other processors find other last digits, as of tests/validation/test_shipped_tables.py."""
    load, row = straight_rollers()[number]
    solved, found = solve_laminae(None, 1.0, 1.0, APPROACH_RATIO**number)
    assert load == pytest.approx(solved, rel=1e-9)
    np.testing.assert_allclose(row, found, rtol=1e-8)


def test_a_rung_beyond_those_shipped_is_solved():
    beyond = RUNGS[-1] + 1
    of = SolvedLaminae(profile=None, length=1.0, effective_radius=1.0, contact_modulus=1.0)
    assert beyond not in straight_rollers()
    np.testing.assert_array_equal(of._at(beyond)[1], solve_laminae(None, 1.0, 1.0, APPROACH_RATIO**beyond)[1])


def test_slices_are_asked_for_at_the_loads_alone():
    """With 65 slices contacts far beyond any load, 8 mm wide, were solved as well, which slices so narrow do not settle under."""
    of, load = laminae(), np.array([50.0, 1500.0])
    found = of.slice_shares(load, 65)
    np.testing.assert_allclose(found.sum(axis=1), 1.0, atol=1e-4)  # of interpolation between loads
    # Those of another load in between change nothing.
    np.testing.assert_allclose(of.slice_shares(np.array([50.0, 300.0, 1500.0]), 65)[[0, 2]], found, rtol=1e-12)
