"""Rating life against ISO 281's tables, the integrals behind ISO/TS 16281, and the swapped means of a crank bearing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.rating_life import MOVING, RACE_WEIBULL, RollerBearing, edge_factors, power_mean, rating_life
from ltca.geometry.coordinates import DISC_ROTATION

# ISO 281:2007, Table 7: f_c of radial roller bearings by D_we cos α/D_pw.
TABLE_7 = {
    0.01: 52.1, 0.02: 60.8, 0.03: 66.5, 0.04: 70.7, 0.05: 74.1, 0.06: 76.9, 0.07: 79.2, 0.08: 81.2, 0.09: 82.8,
    0.10: 84.2, 0.12: 86.4, 0.14: 87.7, 0.16: 88.5, 0.18: 88.8, 0.20: 88.7, 0.22: 88.2, 0.24: 87.5, 0.26: 86.4,
    0.28: 85.2, 0.30: 83.8,
}  # fmt: skip


def bearing(slenderness=0.15, rollers=20):
    return RollerBearing(rollers=rollers, roller_diameter=100.0 * slenderness, roller_length=10.0, pitch_diameter=100.0)


@pytest.mark.parametrize(("slenderness", "factor"), TABLE_7.items())
def test_geometry_factor_against_the_published_table(slenderness, factor):
    # the table has three digits; its own smoothing is another tenth
    assert bearing(slenderness).geometry_factor == pytest.approx(factor, abs=0.11)


def test_dynamic_load_rating_of_the_papers_crank_bearing():
    """By hand from the printed factors: 11 rollers 10 × 11.8 on 49 mm, f_c = 88.7 at γ = 0.204 (Table 7)."""
    found = RollerBearing(rollers=11, roller_diameter=10.0, roller_length=11.8, pitch_diameter=49.0)
    by_hand = 1.1 * 88.65 * 11.8 ** (7 / 9) * 11**0.75 * 10 ** (29 / 27)
    assert found.dynamic_load_rating == pytest.approx(by_hand, rel=1e-3)


def test_rating_of_the_inner_by_that_of_the_outer_race():
    """The printed factor by hand at γ = 0.2; alike races of equal curvature (γ → 0) differ by 1.038 alone."""
    by_hand = 1.038 * (0.8 / 1.2) ** (143.0 / 108.0)
    assert by_hand == pytest.approx(0.6068, abs=1e-4)
    assert bearing(0.2).race_ratio == pytest.approx(by_hand, rel=1e-12)
    assert bearing(1e-9).race_ratio == pytest.approx(1.038, rel=1e-8)
    part = bearing(0.2, rollers=13)
    loads = np.ones((1, 13))
    found = rating_life(part, loads, loads)
    # Q_ci/Q_ce of ISO/TS 16281, (1.18…): (1 + r^4.5)^(2/9) over (1 + r^−4.5)^(2/9) is r
    assert found.inner_rating / found.outer_rating == pytest.approx(by_hand * 0.364 / 0.378, rel=1e-12)
    # both by hand: C = 1.1 f_c …, shared by 13 rollers, without the allowance for edges
    share = part.dynamic_load_rating / (0.83 * 13 * 0.378)
    assert found.inner_rating == pytest.approx(share * (1.0 + by_hand**4.5) ** (2.0 / 9.0), rel=1e-12)


def zone(rollers, exponent=1.1):
    """Roller loads of a standing load on rigid races without clearance, Q ∝ cos^1.1 ψ over 180° (ISO/TR 1281-1)."""
    angle = 2.0 * np.pi * np.arange(rollers) / rollers
    return np.maximum(np.cos(angle), 0.0) ** exponent, angle


def test_race_constants_are_the_integrals_of_that_load():
    """0.378 and 0.364 of ISO/TS 16281 are J_r/J_1 and J_r/J_2: means of the loads with 4 and 4.5."""

    def mean(power):
        return quad(lambda psi: np.cos(psi) ** power, -np.pi / 2, np.pi / 2)[0] / (2.0 * np.pi)

    radial = mean(2.1)
    # 1/J_r: the largest roller load is 4.08 F/Z, as catalogues print it (NSK CAT. E728g, Sect. 5.1, ε = 0.5)
    assert 1.0 / radial == pytest.approx(4.08, abs=0.005)
    # the standard's constants come from tabulated J of three digits: 0.3 %, against 4 % between the two
    assert radial / mean(1.1 * 4.0) ** (1 / 4.0) == pytest.approx(0.378, rel=4e-3)
    assert radial / mean(1.1 * 4.5) ** (1 / 4.5) == pytest.approx(0.364, rel=4e-3)


def test_life_at_the_rating_without_edge_stress_is_one_turn_of_a_million():
    """Usual bearing: at F = C/λν the joined races live 10⁶ turns when no edge is reckoned, by how Q_c are defined."""
    part = bearing(rollers=200)
    loads, angle = zone(200)
    force = part.dynamic_load_rating / 0.83
    loads = loads * force / np.sum(loads * np.cos(angle))
    found = rating_life(part, loads[None], loads[None], standing="outer", relieved=True)
    # those 0.3 % of the constants to the fourth power
    assert found.life == pytest.approx(1.0, rel=0.015)


def test_life_falls_with_the_fourth_power_of_the_load():
    loads, _ = zone(20)
    part = bearing()
    one, two = (rating_life(part, size * loads[None], size * loads[None]).life for size in (1000.0, 2000.0))
    assert one / two == pytest.approx(16.0, rel=1e-12)


def test_means_change_places_when_the_load_turns_with_the_inner_race():
    """A crank: the inner race stands still to the load and takes the 4.5 mean, the disc's race the 4 mean."""
    loads, _ = zone(20)
    loads = 1000.0 * loads[None]
    crank = rating_life(bearing(), loads, loads, relieved=True)
    usual = rating_life(bearing(), loads, loads, standing="outer", relieved=True)
    assert crank.inner_load == pytest.approx(power_mean(loads, RACE_WEIBULL), rel=1e-14)
    assert crank.outer_load == pytest.approx(power_mean(loads, MOVING), rel=1e-14)
    assert (crank.inner_load, crank.outer_load) == (usual.outer_load, usual.inner_load)
    # the inner race is the weaker one, so the life of the crank bearing is shorter
    assert crank.life < usual.life


def test_the_race_that_stands_sees_one_point_loaded(paper_cases):
    """From the analysis itself: at a point of the inner race the load stays, at one of the bore it comes and goes."""
    drive = paper_cases["CS-3"]
    angles = 2.0 * np.pi * np.arange(72) / 72
    found = analyse(drive, angles)
    rollers = found.full.response.rollers
    push = (rollers.outer_load * rollers.outer_direction).sum(axis=1)
    in_crank = np.angle(push * np.exp(-1j * angles))
    in_disc = np.unwrap(np.angle(push * np.exp(-1j * found.full.pose[:, DISC_ROTATION])))
    assert np.ptp(in_crank) < np.radians(10.0)  # turns with the crank
    assert in_disc[-1] - in_disc[0] > np.radians(340.0)  # goes round in the disc


def test_edge_factors_and_relief():
    factors = edge_factors(31)
    assert factors[15] == 1.0
    assert np.all(np.diff(factors[15:]) > 0.0)
    np.testing.assert_array_equal(factors, factors[::-1])
    loads, _ = zone(20)
    assert (
        rating_life(bearing(), loads[None], loads[None]).life
        < rating_life(bearing(), loads[None], loads[None], relieved=True).life
    )


def test_wrong_input_is_refused():
    loads, _ = zone(20)
    with pytest.raises(ValueError, match="standing must be inner or outer"):
        rating_life(bearing(), loads[None], loads[None], standing="both")
    with pytest.raises(ValueError, match="no roller carries"):
        rating_life(bearing(), 0.0 * loads[None], loads[None])
