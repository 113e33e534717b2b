"""Designs give the same numbers however they are cut; sensitivity against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.drive.tolerances import Factors
from ltca.reading.drive_file import load_drive
from ltca.studies.designs import SweepDesign, SweepFactor, ToleranceDesign, random_rows
from ltca.studies.sensitivity import regress, sobol_indices


@pytest.fixture(scope="module")
def factors():
    file = load_drive("paper")
    return Factors.of_tolerances(file.cases["CS-6"], file.tolerances)


def tolerance_design(factors, sequence, samples=60):
    return ToleranceDesign(factors=factors, samples=samples, seed=11, sequence=sequence)


@pytest.mark.slow
@pytest.mark.parametrize("sequence", ["random", "sobol", "saltelli"])
def test_rows_do_not_depend_on_where_they_are_cut(factors, sequence):
    design = tolerance_design(factors, sequence)
    whole = design.rows(0, 60)
    cut = np.concatenate([design.rows(first, min(first + 7, 60)) for first in range(0, 60, 7)])
    np.testing.assert_array_equal(whole, cut)
    # more samples leave the first ones as they are
    np.testing.assert_array_equal(tolerance_design(factors, sequence, 600).rows(0, 60), whole)


def test_seeds_and_samples_differ(factors):
    first = tolerance_design(factors, "random").rows(0, 5)
    other = ToleranceDesign(factors=factors, samples=5, seed=12).rows(0, 5)
    assert not np.any(first == other)
    assert len(np.unique(first[:, 0])) == 5


def test_random_rows_are_uniform_and_independent():
    rows = random_rows(3, 0, 4000, 6)
    assert rows.min() > 0.0
    assert rows.max() < 1.0
    # 4000 samples: standard errors 0.0046 of the mean and 0.016 of a correlation, times four
    np.testing.assert_allclose(rows.mean(axis=0), 0.5, atol=0.0185)
    correlation = np.corrcoef(rows.T) - np.eye(6)
    assert np.abs(correlation).max() < 0.063


def test_saltelli_blocks_exchange_one_field_each(factors):
    design = tolerance_design(factors, "saltelli")
    groups = design.groups
    rows = design.rows(0, len(groups) + 2)
    a, b = rows[0], rows[1]
    for number, (_, columns) in enumerate(groups):
        row = rows[2 + number]
        np.testing.assert_array_equal(row[columns], b[columns])
        np.testing.assert_array_equal(np.delete(row, np.r_[columns]), np.delete(a, np.r_[columns]))


def test_grid_list_and_ranges():
    levels = SweepFactor(path="disc.thickness", levels=(10.0, 11.0))
    names = SweepFactor(path="load.direction", levels=("ccw", "cw"))
    counts = SweepFactor(path="pin_shaft.number_of_pins", levels=(6, 8))
    grid = SweepDesign(factors=(levels, names, counts), kind="grid")
    assert grid.samples == 8
    np.testing.assert_array_equal(grid.rows(0, 8)[:4], [[10, 0, 6], [10, 0, 8], [10, 1, 6], [10, 1, 8]])
    np.testing.assert_array_equal(grid.rows(5, 7), grid.rows(0, 8)[5:7])
    fields = grid.fields(grid.rows(7, 8)[0])
    assert fields == {"disc.thickness": 11.0, "load.direction": "cw", "pin_shaft.number_of_pins": 8}
    assert isinstance(fields["pin_shaft.number_of_pins"], int)
    side = SweepDesign(factors=(levels, counts), kind="list")
    np.testing.assert_array_equal(side.rows(0, 2), [[10, 6], [11, 8]])
    span = SweepFactor(path="load.torque", low=1e3, high=1e5, logarithmic=True)
    cube = SweepDesign(factors=(span, levels), kind="latin-hypercube", number=40, seed=1)
    rows = cube.rows(0, 40)
    np.testing.assert_array_equal(np.concatenate([cube.rows(0, 13), cube.rows(13, 40)]), rows)
    # one sample in each of the forty strata
    assert sorted(np.floor(40.0 * np.log(rows[:, 0] / 1e3) / np.log(100.0))) == list(range(40))


def test_places_of_a_range():
    """From end to end in proportion, or in proportion of logarithms."""
    share = np.array([0.0, 0.25, 0.5, 1.0])
    even = SweepFactor(path="disc.thickness", low=10.0, high=18.0).at(share)
    np.testing.assert_allclose(even, [10.0, 12.0, 14.0, 18.0], rtol=1e-15)
    ratio = SweepFactor(path="load.torque", low=1e3, high=1.6e4, logarithmic=True).at(share)
    np.testing.assert_allclose(ratio, [1e3, 2e3, 4e3, 1.6e4], rtol=1e-14)


def test_regression_finds_the_shares_of_a_linear_law():
    """y = Σ c x + noise: shares c² σ² of the whole variance."""
    rng = np.random.default_rng(5)
    x = rng.normal(size=(6000, 4)) * np.array([1.0, 2.0, 0.5, 1.0])
    c = np.array([1.0, 1.0, 0.0, -3.0])
    y = (x @ c + rng.normal(size=6000))[:, None]
    found = regress(lambda: ((x[cut : cut + 1000], y[cut : cut + 1000]) for cut in range(0, 6000, 1000)))
    variance = 1.0 + 4.0 + 0.0 + 9.0 + 1.0
    # standard error of a share, 2 c/σ · 1/√6000
    np.testing.assert_allclose(found.shares[:, 0], np.array([1.0, 4.0, 0.0, 9.0]) / variance, atol=0.03)
    assert found.explained[0] == pytest.approx(14.0 / variance, abs=0.01)
    assert regress(lambda: iter([(x[:8], y[:8])])) is None


def test_regression_with_few_samples_is_adjusted():
    """Pure noise: R² is f/(n − 1) in the mean, adjusted R² is nothing; against residuals of a plain least-squares fit."""
    rng = np.random.default_rng(8)
    count, factors, quantities = 30, 10, 2000
    x, y = rng.normal(size=(count, factors)), rng.normal(size=(count, quantities))
    found = regress(lambda: iter([(x[:17], y[:17]), (x[17:], y[17:])]))
    columns = np.column_stack([np.ones(count), x])
    left = y - columns @ np.linalg.lstsq(columns, y, rcond=None)[0]
    per_freedom = (left**2).sum(axis=0) / (count - factors - 1)
    np.testing.assert_allclose(found.explained, 1.0 - per_freedom / y.var(axis=0, ddof=1), atol=1e-10)
    # standard error √(2 f/(n − f − 1)/(n + 1)/2000)·… about 0.004; the plain R² would be 0.345
    assert abs(found.explained.mean()) < 0.02
    # a share of noise is what chance gives: nothing in the mean of SRC² less chance
    spread = x.std(axis=0)[:, None] / y.std(axis=0)
    slopes = np.linalg.lstsq(columns, y, rcond=None)[0][1:]
    np.testing.assert_allclose(found.coefficients, slopes * spread, rtol=1e-9, atol=1e-12)
    # the covariance of least squares, σ² (XᵀX)⁻¹; it was taken for that of factors without any correlation, a third too small
    inverse = np.diag(np.linalg.inv(columns.T @ columns))[1:, None]
    chance = inverse * (left**2).sum(axis=0) / (count - factors - 1) * spread**2
    np.testing.assert_allclose(found.shares, found.coefficients**2 - chance, atol=1e-10)
    # 20000 shares of deviation √2/20
    assert abs(found.shares.mean()) < 0.002


@pytest.mark.slow
def test_sobol_indices_of_ishigami():
    """a = 7, b = 0.1: S = 0.3139, 0.4424, 0; S_T = 0.5576, 0.4424, 0.2437 (Ishigami and Homma 1990)."""

    def ishigami(x):
        return np.sin(x[..., 0]) + 7.0 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0])

    base = (2.0 * random_rows(1, 0, 20000, 6) - 1.0) * np.pi
    a, b = base[:, :3], base[:, 3:]
    blocks = [ishigami(a), ishigami(b)]
    for column in range(3):
        mixed = a.copy()
        mixed[:, column] = b[:, column]
        blocks.append(ishigami(mixed))
    found = sobol_indices(np.stack(blocks, axis=1)[..., None])
    # standard error about 0.01 with 20000 blocks
    np.testing.assert_allclose(found.first[:, 0], [0.3139, 0.4424, 0.0], atol=0.03)
    np.testing.assert_allclose(found.total[:, 0], [0.5576, 0.4424, 0.2437], atol=0.03)


def test_true_and_false_are_levels_of_their_own():
    """They came back as 1 and 0, which no field takes for them."""
    factor = SweepFactor(path="pin_shaft.elastic_contact", levels=(True, False))
    assert [factor.value(number) for number in factor.column().tolist()] == [True, False]
    assert all(isinstance(factor.value(number), bool) for number in factor.column().tolist())
