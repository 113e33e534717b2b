"""What is read from the dataset of a study, on datasets written by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from ltca.drive.tolerances import Factors
from ltca.reading.drive_file import load_drive
from ltca.studies.designs import SweepDesign, SweepFactor, ToleranceDesign
from ltca.studies.sensitivity import factor_groups, is_chance, rank, sobol_indices, sobol_of, together_words
from ltca.studies.study_results import PERCENTILES, read_quantity, summarise_quantity


def written(path, factors, values, failed):
    """Write factors (samples, factors) and values by quantity the way a study does."""
    xr.Dataset(
        {
            "factor_value": (("sample", "factor"), factors),
            "failed": ("sample", failed.astype("i1")),
            **{name: ("sample", np.where(failed, np.nan, own)) for name, own in values.items()},
        }
    ).to_netcdf(path, engine="h5netcdf")
    return path


def test_scalars_of_a_quantity():
    values = np.array([4.0, np.nan, 1.0, 9.0, 6.0])
    found = summarise_quantity(values)
    assert (found.mean, found.smallest, found.largest) == (5.0, 1.0, 9.0)
    assert (found.smallest_sample, found.largest_sample) == (2, 3)
    # deviations −1, −4, 4, 1: 34 over three
    assert found.standard_deviation == pytest.approx(np.sqrt(34.0 / 3.0))
    assert found.percentiles[PERCENTILES.index(50.0)] == 5.0
    # of 0, 1, …, 1000 each percentile is ten times itself
    thousand = summarise_quantity(np.arange(1001.0)).percentiles
    np.testing.assert_allclose(thousand, [1.0, 10.0, 50.0, 500.0, 950.0, 990.0, 999.0], rtol=1e-12)
    assert summarise_quantity(np.array([np.nan])) is None
    assert summarise_quantity(np.array([2.0])).standard_deviation == 0.0


def test_ranking_of_a_sweep_by_its_factors(tmp_path):
    """y = 3 x₁ + x₃ on factors of like spread: 9/10 and 1/10 of the variance, x₂ nothing; failed samples left out."""
    rng = np.random.default_rng(2)
    factors = rng.normal(size=(3000, 3))
    failed = np.zeros(3000, dtype=bool)
    failed[::7] = True
    load = 3.0 * factors[:, 0] + factors[:, 2] + np.where(failed, 1e6, 0.0)
    names = ("disc.thickness", "clearance.bearing", "load.torque")
    design = SweepDesign(
        factors=tuple(SweepFactor(path=name, low=0.0, high=1.0) for name in names), kind="latin-hypercube", number=3000
    )
    study = SimpleNamespace(design=design, quantities=("max_pin_load",))
    assert factor_groups(study) == tuple((name, slice(k, k + 1)) for k, name in enumerate(names))
    path = written(tmp_path / "results.nc", factors, {"max_pin_load": load}, failed)
    np.testing.assert_array_equal(np.isnan(read_quantity(path, "max_pin_load")), failed)
    told = rank(path, study)
    assert "SRC²" in told["method"]
    found = told["quantities"]["max_pin_load"]
    # a linear law without noise is explained whole; chance correlations of 1/√2600 move shares by 0.02
    assert found["explained"] == pytest.approx(1.0, abs=1e-9)
    assert list(found["shares"]) == [names[0], names[2], names[1]]
    assert list(found["shares"].values()) == pytest.approx([0.9, 0.1, 0.0], abs=0.03)
    few = written(tmp_path / "few.nc", factors[:7], {"max_pin_load": load[:7]}, failed[:7])
    assert rank(few, study) == {"method": "none: fewer than two samples for each factor and the mean", "quantities": {}}


def test_one_field_of_6_percent_stood_beside_0_percent_of_all_fields_together(tmp_path):
    """A field explains a tenth of the variance; the noise of 40 others takes more off adjusted R² than that, in some samples."""
    names = [f"pin_wheel.pin_errors.radial.{number}" for number in range(41)]
    design = SweepDesign(
        factors=tuple(SweepFactor(path=name, low=0.0, high=1.0) for name in names), kind="latin-hypercube", number=100
    )
    study = SimpleNamespace(design=design, quantities=("max_pin_load",))
    below = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        factors = rng.normal(size=(100, 41))
        load = factors[:, 0] + 3.0 * rng.normal(size=100)
        path = written(tmp_path / f"{seed}.nc", factors, {"max_pin_load": load}, np.zeros(100, dtype=bool))
        entry = rank(path, study)["quantities"]["max_pin_load"]
        columns = np.column_stack([np.ones(100), factors])
        left = load - columns @ np.linalg.lstsq(columns, load, rcond=None)[0]
        adjusted = 1.0 - left @ left / 58.0 / load.var(ddof=1)
        parts = sum(share for name, share in entry["shares"].items() if not is_chance(entry, name))
        below += adjusted < min(parts, 1.0) - 1e-12
        assert entry["explained"] >= max(0.0, min(parts, 1.0), adjusted - 1e-9)
    assert below >= 3  # the case is among them
    assert together_words({"explained": 0.066, "shares": {}}) == "all fields together, linearly: 7 %"


def test_a_sum_of_first_orders_of_minus_175_percent_was_printed():
    """Its standard error is that of the mean over blocks: of many designs of an additive function, whose sum is 1."""
    rng = np.random.default_rng(7)
    sums, errors = [], []
    for _ in range(400):
        a, b = rng.normal(size=(2, 60, 4))
        mixed = np.repeat(a[:, None], 4, axis=1)
        for group in range(4):
            mixed[:, group, group] = b[:, group]
        blocks = np.concatenate([a[:, None], b[:, None], mixed], axis=1).sum(axis=2)[:, :, None]
        found = sobol_indices(blocks)
        sums.append(float(found.first.sum()))
        errors.append(float(found.together_error[0]))
    # a deviation from 400 is known to 3.5 %; the variance in the denominator is fixed within one design
    assert np.mean(errors) == pytest.approx(np.std(sums), rel=0.25)
    assert np.mean(sums) == pytest.approx(1.0, abs=0.05)
    told = "all fields together, without interactions: "
    for explained, error, words in (
        (-1.75, 0.6, "not known from so few blocks"), (0.4, 0.5, "not known from so few blocks"),
        (0.4, 0.1, "20 … 60 %"), (1.13, 0.1, "93 … 100 %"), (-0.05, 0.1, "0 … 15 %"),
    ):  # fmt: skip
        assert together_words({"explained": explained, "explained_error": error}) == told + words


def test_ranking_of_saltelli_blocks_leaves_broken_ones_out(tmp_path):
    """y is the sum over the elements of one field: its total index is 1, that of all others 0."""
    file = load_drive("paper")
    factors = Factors.of_tolerances(file.cases["CS-6"], file.tolerances)
    groups = ToleranceDesign(factors=factors, samples=60, seed=3, sequence="saltelli").groups
    size = len(groups) + 2
    design = ToleranceDesign(factors=factors, samples=40 * size, seed=3, sequence="saltelli")
    study = SimpleNamespace(design=design, quantities=("max_pin_load",))
    rows = design.rows(0, design.samples)
    name, columns = groups[1]
    failed = np.zeros(len(rows), dtype=bool)
    failed[5 * size + 3] = True
    path = written(tmp_path / "results.nc", rows, {"max_pin_load": rows[:, columns].sum(axis=1)}, failed)
    found = sobol_of(path, study)
    assert found.blocks == 39
    told = rank(path, study)["quantities"]["max_pin_load"]
    assert next(iter(told["shares"])) == name
    assert told["shares"][name] == pytest.approx(1.0, abs=0.35)  # 39 blocks
    assert all(share == 0.0 for other, share in told["shares"].items() if other != name)
    assert told["explained"] == pytest.approx(sum(told["first_order"].values()))
    short = SimpleNamespace(
        design=ToleranceDesign(factors=factors, samples=7 * size, seed=3, sequence="saltelli"),
        quantities=("max_pin_load",),
    )
    assert sobol_of(path, short) is None  # seven blocks
