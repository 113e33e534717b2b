"""Crowned and relieved contacts: Hertz in the limit, calculus of the law, accuracy of its table."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.errors import CycloError
from ltca.geometry.length_profile import LOGARITHMIC, Relief
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import ProfiledLineContactLaw, profiled_table, solve_profiled_patch
from validation.hertz import solve_point_contact

MODULUS = 113_187.0
CROWN = Relief(length=11.8, crown_radius=3000.0)
ROUNDED = Relief(length=11.8, logarithm=LOGARITHMIC * 5.0)
RELIEVED = Relief(length=11.8, end_length=1.0, end_depth=0.01)


def law_at(profile, radius=2.0):
    return ProfiledLineContactLaw.for_radii(profile, MODULUS, radius, radius)


@pytest.mark.parametrize("profile", [CROWN, ROUNDED, RELIEVED])
def test_profiles_are_even_start_at_zero_and_know_their_overlap(profile):
    y = np.linspace(-5.8, 5.8, 41)
    assert np.array_equal(profile.relief(y), profile.relief(-y))
    assert profile.relief(0.0) == 0.0
    assert np.all(np.diff(profile.relief(y[20:])) >= 0.0)
    for approach in (1e-5, 1e-3):
        reach = profile.overlap_half_length(approach)
        assert float(profile.relief(reach)) == pytest.approx(approach, rel=1e-9)
    assert profile.overlap_half_length(1.0) == pytest.approx(5.9, rel=1e-9)


@pytest.mark.parametrize("ratio", [1.0, 3.0, 100.0, 1e4])
def test_crowned_patch_is_hertz_point_contact(ratio):
    crown = Relief(length=1e3, crown_radius=2.0 * ratio)
    reference = solve_point_contact(1e-3, 2.0, 2.0 * ratio, MODULUS)
    solution = solve_profiled_patch(crown, 2.0, MODULUS, 1e-3, cells=24)
    # 24 cells per half axis: energy 1e-4, load 1e-4, fields h² = 5e-4 (measured 4e-5, 6e-5, 4e-4)
    assert solution.energy == pytest.approx(reference.energy, rel=2e-4)
    assert solution.load == pytest.approx(reference.load, rel=2e-4)
    assert solution.mid_pressure == pytest.approx(reference.peak_pressure, rel=1e-3)
    assert solution.half_width == pytest.approx(reference.half_axis_short, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("approach", [1e-9, 1e-7, 1e-5, 1e-3])
def test_crowned_law_is_hertz_at_light_load(approach):
    law = law_at(CROWN)
    reference = solve_point_contact(approach, 2.0, 3000.0, MODULUS)
    load, stiffness = law.load_and_stiffness(approach, 2.0)
    # the lowest is below the table: there the slope of the last piece goes on
    tolerance = 2e-3 if approach < 2e-7 else 2e-4
    assert float(load) == pytest.approx(reference.load, rel=tolerance)
    assert float(law.energy(approach, 2.0)) == pytest.approx(reference.energy, rel=tolerance)
    assert float(stiffness) == pytest.approx(1.5 * reference.load / approach, rel=1e-2)
    assert float(law.mid_pressure(approach, 2.0)) == pytest.approx(reference.peak_pressure, rel=tolerance)
    assert float(law.half_width(approach, 2.0)) == pytest.approx(reference.half_axis_short, rel=tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("profile", [CROWN, ROUNDED, RELIEVED])
def test_load_and_stiffness_are_exact_derivatives(profile):
    law = law_at(profile)
    approach = np.geomspace(1e-9, 30.0, 300)
    step = 1e-5 * approach
    slope = (law.energy(approach + step, 2.0) - law.energy(approach - step, 2.0)) / (2 * step)
    load, stiffness = law.load_and_stiffness(approach, 2.0)
    np.testing.assert_allclose(slope, load, rtol=1e-8)
    ahead, behind = (law.load_and_stiffness(approach + s, 2.0)[0] for s in (step, -step))
    # the third derivative jumps where the continuation begins
    np.testing.assert_allclose((ahead - behind) / (2 * step), stiffness, rtol=1e-5)
    assert np.all(load > 0)
    assert np.all(stiffness > 0)


@pytest.mark.slow
@pytest.mark.family(full=4)
@pytest.mark.parametrize(
    ("profile", "approach"),
    [
        (CROWN, 2e-3),
        (ROUNDED, 8e-3),
        (RELIEVED, 1e-3),
        (CROWN, 2e-2),
        (CROWN, 8e-3),
        (ROUNDED, 1e-3),
        (RELIEVED, 8e-3),
    ],
)
def test_law_against_a_refined_grid(profile, approach):
    law = law_at(profile)
    fine = solve_profiled_patch(profile, 2.0, MODULUS, approach, cells=32)
    load, _ = law.load_and_stiffness(approach, 2.0)
    # 1e-4 where profile and load are smooth; up to 1e-3 while a crown's contact runs out to the ends: the law bends
    tolerance = 1.5e-3 if profile is CROWN else 3e-4
    assert float(load) == pytest.approx(fine.load, rel=tolerance)
    assert float(law.energy(approach, 2.0)) == pytest.approx(fine.energy, rel=tolerance)
    assert float(law.mid_pressure(approach, 2.0)) == pytest.approx(fine.mid_pressure, rel=1e-3)
    assert float(law.half_width(approach, 2.0)) == pytest.approx(fine.half_width, rel=3e-3)


@pytest.mark.slow
def test_no_relief_is_the_uncrowned_law():
    flat = Relief(length=11.8, crown_radius=1e12)
    approach = np.geomspace(1e-5, 1e-1, 9)
    found, _ = law_at(flat).load_and_stiffness(approach, 2.0)
    expected, _ = LineContactLaw(11.8, MODULUS).load_and_stiffness(approach, 2.0)
    np.testing.assert_allclose(found, expected, rtol=1e-4)  # both tables are good to some 1e-5


@pytest.mark.nightly
@pytest.mark.slow
def test_radii_between_the_nodes():
    law = ProfiledLineContactLaw.for_radii(ROUNDED, MODULUS, 1.0, 6.0)
    for radius in (1.0, 1.7, 3.3, 6.0):
        load, _ = law.load_and_stiffness(4e-3, radius)
        single, _ = law_at(ROUNDED, radius).load_and_stiffness(4e-3, radius)
        assert float(load) == pytest.approx(float(single), rel=2e-4)
    for radius in (0.9, 9.0):
        with pytest.raises(CycloError, match="effective radii"):
            law.load_and_stiffness(4e-3, radius)


@pytest.mark.slow
def test_radii_outside_the_table_are_refused():
    law = law_at(ROUNDED)
    for radius in (1.9, 2.1):
        with pytest.raises(CycloError, match="effective radii"):
            law.load_and_stiffness(1e-3, radius)
    with pytest.raises(ValueError, match="smallest_radius"):
        profiled_table(ROUNDED, 3.0, 2.0)


def test_open_contacts_give_zeros(coarse_tables):
    law = law_at(ROUNDED)
    approach = np.array([-1e-3, 0.0])
    for value in (*law.load_and_stiffness(approach, 2.0), law.energy(approach, 2.0), law.mid_pressure(approach, 2.0)):
        assert np.array_equal(value, np.zeros(2))


def test_relief_removes_the_end_peak():
    plain = solve_profiled_patch(Relief(length=11.8, crown_radius=1e12), 2.0, MODULUS, 4e-3)
    relieved = solve_profiled_patch(ROUNDED, 2.0, MODULUS, 4e-3)
    assert plain.pressure.max() > 3 * plain.mid_pressure
    assert relieved.pressure.max() < 1.01 * relieved.mid_pressure
