"""The [tolerances] table: read and validated, drawn from as said, and nothing to a run."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import refused_field

from ltca.drive.fields import element_count, field_kinds
from ltca.drive.members.width import needs_slices
from ltca.drive.tolerances import Distribution, Factors
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

DEVIATIONS = ("_errors.", "eccentricity_error", "axis_offset", "runout")


def with_table(text):
    base = shipped_drive()
    before, after = base.split("\n[tolerances]\n")
    return f"{before}\n[tolerances]\n{text}\n# Cases override{after.split('# Cases override')[1]}"


def test_paper_drive_has_an_entry_for_every_deviation():
    found = set(load_drive("paper").tolerances)
    expected = {path for path in field_kinds() if any(mark in path for mark in DEVIATIONS) and ".N." not in path}
    # what is measured is no tolerance, and orders are no lengths
    expected -= {f"disc.profile_errors.{name}" for name in ("orders", "parameter", "deviation")}
    # a plane drive of one crank, in which these are refused
    expected = {path for path in expected if not needs_slices(path) and not path.startswith("first_stage.")}
    assert found == expected


def test_tolerances_are_nothing_to_the_drive():
    with_them, without = load_drive("paper"), parse_drive(with_table(""), "paper")
    assert without.tolerances == {}
    assert with_them.cases == without.cases


def test_units_and_flat_names():
    file = parse_drive(with_table('"disc.runout.amount" = { distribution = "uniform", tolerance = "4 um" }'), "paper")
    assert file.tolerances["disc.runout.amount"].tolerance == pytest.approx(0.004)


PROBABILITY = (np.arange(20000) + 0.5) / 20000


@pytest.mark.parametrize(
    ("distribution", "mean", "deviation"),
    [
        (Distribution(distribution="normal", tolerance=0.012, cpk=1.33), 0.0, 0.012 / 3.99),
        (Distribution(distribution="normal", tolerance=0.012, cpk=1.0, mean=0.003), 0.003, 0.003),
        (Distribution(distribution="uniform", tolerance=0.012), 0.0, 0.012 / np.sqrt(3.0)),
        # cut at ±1σ: σ² (1 − 2 φ(1)/(Φ(1) − Φ(−1)))
        (Distribution(distribution="truncated-normal", tolerance=0.012, cpk=1.0 / 3.0), 0.0, 0.012 * np.sqrt(0.29112)),
    ],
)
def test_moments_of_the_distributions(distribution, mean, deviation):
    drawn = distribution.quantile(PROBABILITY)
    # 20000 strata: the tails of the last one, 1e-3 of σ
    assert drawn.mean() == pytest.approx(mean, abs=1e-6)
    assert drawn.std() == pytest.approx(deviation, rel=1e-3)
    if distribution.distribution != "normal":
        assert np.abs(drawn).max() <= distribution.tolerance


def test_capability_is_what_is_out_of_tolerance():
    """Cpk = 1: 0.135 % beyond each limit."""
    drawn = Distribution(distribution="normal", tolerance=0.01, cpk=1.0).quantile(PROBABILITY)
    assert np.mean(drawn > 0.01) == pytest.approx(0.00135, abs=5e-5)


def test_factors_scatter_about_the_drive(paper_cases):
    file = load_drive("paper")
    drive = file.cases["CS-6"]
    factors = Factors.of_tolerances(drive, {"clearance.bearing": Distribution(distribution="uniform", tolerance=0.01)})
    drawn = factors.draw(np.array([[0.0], [0.5], [1.0]]))
    np.testing.assert_allclose(drawn[:, 0], [0.02, 0.03, 0.04])
    whole = Factors.of_tolerances(drive, file.tolerances)
    assert len(whole.paths) == sum(element_count(drive, path) or 1 for path in file.tolerances)
    values = whole.values(np.arange(float(len(whole.paths))))
    assert values["pin_wheel.pin_errors.radial"] == tuple(range(5, 19))


def test_harmonics_without_orders_are_refused():
    text = shipped_drive().replace("profile_errors = { orders = [2, 3, 13, 26] }\n", "", 1)
    file = parse_drive(text, "paper")
    with refused_field("tolerances.disc.profile_errors.cosine", "", "has no elements"):
        Factors.of_tolerances(file.cases["CS-1"], file.tolerances)
