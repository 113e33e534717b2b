"""The generator of a roller as the drive states it: terms add up, the drop at the end is the one stated."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.drive.parts import LengthProfile
from ltca.geometry.length_profile import Relief, generator_profile

LENGTH, RADIUS = 11.8, 5.0
ALL = LengthProfile(crown_drop=0.004, logarithmic_factor=1.2, end_relief_length=1.5, end_relief_depth=0.02)


def by_hand(y):
    """Parabola of 4 µm at the end, 1.2 · 0.00035 D ln(1/(1 − (2y/L)²)), parabola of 20 µm over the last 1.5 mm."""
    beyond = np.maximum(np.abs(y) - (0.5 * LENGTH - 1.5), 0.0)
    share = 2.0 * y / LENGTH
    return 0.004 * share**2 + 1.2 * 0.00035 * 2.0 * RADIUS * np.log(1.0 / (1.0 - share**2)) + 0.02 * (beyond / 1.5) ** 2


def test_terms_add_up():
    profile = generator_profile(ALL, LENGTH, RADIUS)
    y = np.linspace(-5.85, 5.85, 41)
    np.testing.assert_allclose(profile.relief(y), by_hand(y), rtol=1e-9, atol=1e-15)
    assert profile.length == LENGTH


ENDS = {"end_length", "end_depth"}


@pytest.mark.parametrize(
    ("fields", "terms"),
    [
        ({"crown_drop": 0.004}, {"crown_radius"}),
        ({"logarithmic_factor": 1.2}, {"logarithm"}),
        ({"end_relief_length": 1.5, "end_relief_depth": 0.02}, ENDS),
        ({"crown_drop": 0.004, "end_relief_length": 1.5, "end_relief_depth": 0.02}, {"crown_radius", *ENDS}),
    ],
)
def test_what_is_stated_is_there_and_nothing_else(fields, terms):
    profile, none = generator_profile(LengthProfile(**fields), LENGTH, RADIUS), Relief(length=LENGTH)
    names = ("crown_radius", "logarithm", *ENDS)
    assert {name for name in names if getattr(profile, name) != getattr(none, name)} == terms


def test_a_cylinder_has_no_profile():
    assert generator_profile(LengthProfile(), LENGTH, RADIUS) is None


def test_crown_drops_by_what_is_stated_at_the_end():
    profile = generator_profile(LengthProfile(crown_drop=0.004), LENGTH, RADIUS)
    assert float(profile.relief(0.5 * LENGTH)) == pytest.approx(0.004, rel=1e-9)


@pytest.mark.parametrize("approach", [1e-4, 3e-3, 1.2e-2])
def test_overlap_ends_where_the_relief_is_the_approach(approach):
    profile = generator_profile(ALL, LENGTH, RADIUS)
    expected = brentq(lambda y: by_hand(y) - approach, 0.0, 0.5 * LENGTH * (1.0 - 1e-12), xtol=1e-13)
    assert profile.overlap_half_length(approach) == pytest.approx(expected, rel=1e-9)


def test_overlap_is_the_whole_length_under_a_deep_approach():
    crowned = LengthProfile(crown_drop=0.004, end_relief_length=1.5, end_relief_depth=0.02)
    assert generator_profile(crowned, LENGTH, RADIUS).overlap_half_length(0.03) == pytest.approx(0.5 * LENGTH)


def test_a_cylinder_overlaps_along_its_whole_length():
    assert Relief(length=LENGTH).overlap_half_length(0.01) == 0.5 * LENGTH
