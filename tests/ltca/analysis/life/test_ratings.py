"""Ratings of the crank bearing against ISO 281's tables, the integrals behind ISO 16281:2025, and by hand."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.life.ratings import RollerBearing, not_rated
from ltca.reading.changes import with_fields

# ISO 281:2007, Table 7: f_c of radial roller bearings by D_we cos α/D_pw.
TABLE_7 = {
    0.01: 52.1, 0.02: 60.8, 0.03: 66.5, 0.04: 70.7, 0.05: 74.1, 0.06: 76.9, 0.07: 79.2, 0.08: 81.2, 0.09: 82.8,
    0.10: 84.2, 0.12: 86.4, 0.14: 87.7, 0.16: 88.5, 0.18: 88.8, 0.20: 88.7, 0.22: 88.2, 0.24: 87.5, 0.26: 86.4,
    0.28: 85.2, 0.30: 83.8,
}  # fmt: skip


def bearing(slenderness=0.15, rollers=20, pitch_diameter=100.0):
    return RollerBearing(
        rollers=rollers,
        roller_diameter=pitch_diameter * slenderness,
        roller_length=10.0,
        pitch_diameter=pitch_diameter,
    )


def test_fatigue_limit_falls_behind_above_a_hundred_millimetres():
    """(100/D_pw)^0.3, and no step at 100 mm."""
    at, above, large = (bearing(pitch_diameter=size) for size in (100.0, 100.0001, 200.0))
    assert above.fatigue_load_limit == pytest.approx(at.fatigue_load_limit, rel=1e-5)
    assert large.fatigue_load_limit == pytest.approx(large.static_load_rating / 8.2 * 0.5**0.3, rel=1e-12)


def test_rating_of_the_inner_by_that_of_the_outer_race():
    """The printed factor by hand at γ = 0.2; alike races of equal curvature (γ → 0) differ by 1.038 alone."""
    by_hand = 1.038 * (0.8 / 1.2) ** (143.0 / 108.0)
    assert by_hand == pytest.approx(0.6068, abs=1e-4)
    assert bearing(0.2).race_ratio == pytest.approx(by_hand, rel=1e-12)
    assert bearing(1e-9).race_ratio == pytest.approx(1.038, rel=1e-8)
    part = bearing(0.2, rollers=13)
    found = part.race_ratings()
    # Q_ci/Q_ce of ISO 16281:2025, (1.18…): (1 + r^4.5)^(2/9) over (1 + r^−4.5)^(2/9) is r
    assert found.inner / found.outer == pytest.approx(by_hand * 0.364 / 0.378, rel=1e-12)
    # both by hand: C = 1.1 f_c …, shared by 13 rollers, without the allowance for edges
    share = part.dynamic_load_rating / (0.83 * 13 * 0.378)
    assert found.inner == pytest.approx(share * (1.0 + by_hand**4.5) ** (2.0 / 9.0), rel=1e-12)


def test_what_is_no_hardened_steel_is_not_rated(paper_cases):
    """A plastic disc "lived 5492 million turns"."""
    drive = paper_cases["CS-1"]
    assert not_rated(drive) == ()
    (told,) = not_rated(with_fields(drive, {"materials.disc.youngs_modulus": 2000.0}))
    assert told.startswith("materials.disc.youngs_modulus = 2000 MPa")
    soft = with_fields(drive, {"materials.inner_race.hardness": 600.0, "materials.roller.youngs_modulus": 310e3})
    assert [reason.partition(" =")[0] for reason in not_rated(soft)] == [
        "materials.inner_race.hardness",
        "materials.roller.youngs_modulus",
    ]
    hard = {f"materials.{part}.hardness": 700.0 for part in ("disc", "roller", "inner_race")}
    # pins are no rings
    assert not_rated(with_fields(drive, hard | {"materials.wheel_pin.youngs_modulus": 3000.0})) == ()


def test_life_falls_with_the_fourth_power_of_the_load():
    ratings = bearing().race_ratings(20_000.0)
    assert ratings.life(1000.0, 900.0) / ratings.life(2000.0, 1800.0) == pytest.approx(16.0, rel=1e-12)
    # each race alone lives by the fourth power of its load, a million turns at its rating
    assert ratings.life(ratings.inner, 0.0) == pytest.approx(1.0, rel=1e-12)
    assert ratings.life(0.0, 0.5 * ratings.outer) == pytest.approx(16.0, rel=1e-12)
    assert ratings.life(0.0, 0.0) == np.inf
