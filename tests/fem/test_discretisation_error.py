"""Observed order and grid convergence index: the example of the literature, exact power laws, and what does not converge."""

import math

import pytest
from refusals import error_says

from fem.discretisation_error import estimate_error


def test_example_of_celik():
    """Celik et al., J. Fluids Eng. 130 (2008) 078001, Table 1, first column: 18000, 8000 and 4500 cells, r = 1.5, 1.333."""
    found = estimate_error([5.863, 5.972, 6.063], ratios=[math.sqrt(8000 / 4500), 1.5])
    # Half of the last printed digit: p 1.53, φ_ext 6.1685, GCI 2.2 %.
    assert found.order == pytest.approx(1.53, abs=5e-3)
    assert found.extrapolated == pytest.approx(6.1685, abs=5e-4)
    assert 100.0 * found.relative_bar == pytest.approx(2.2, abs=0.05)
    assert found.state == "monotone"


@pytest.mark.parametrize("order", [0.7, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("ratios", [(2.0, 2.0), (1.4, 1.9), (2.5, 1.3)])
def test_power_laws_are_found_exactly(order, ratios):
    """φ = 7 + 0.3 h^p: the order, the limit, and a bar of 1.25 times the error; round-off of the fixed point remains."""
    edges = (ratios[0] * ratios[1], ratios[1], 1.0)
    found = estimate_error([7.0 + 0.3 * edge**order for edge in edges], ratios=ratios)
    assert found.order == pytest.approx(order, rel=1e-8)
    assert found.extrapolated == pytest.approx(7.0, rel=1e-10)
    assert found.bar == pytest.approx(1.25 * 0.3, rel=1e-7)
    assert found.bar_at(0) == pytest.approx(0.3 * (edges[0] ** order - 1.0) + found.bar, rel=1e-7)


def test_orders_above_theory_count_as_theory():
    """Changes 0.16 and 0.01 have the order 4; with 3 allowed the bar is 1.25 · 0.01/7."""
    found = estimate_error([1.17, 1.01, 1.0], 3.0)
    assert found.order == pytest.approx(4.0)
    assert found.bar == pytest.approx(1.25 * 0.01 / 7.0, rel=1e-9)


@pytest.mark.parametrize(
    ("values", "state", "bar"),
    [
        ((1.0, 1.2, 1.1), "oscillating", 0.2),  # the whole spread
        ((1.0, 1.1, 1.25), "unsettled", 0.75),  # three times
        ((1.0, 1.1, 0.9), "unsettled", 0.6),
        ((1.0, 1.1, 1.19), "slow", 1.25 * 0.19),  # p = log2(10/9) = 0.15
        ((1.0, 1.0, 1.0), "monotone", 0.0),
        ((9.9, 1.0, 1.2, 1.1), "oscillating", 0.2),  # the last three decide
    ],
)
def test_what_does_not_converge_evenly(values, state, bar):
    found = estimate_error(values)
    assert found.state == state
    assert found.bar == pytest.approx(bar, rel=1e-9)
    assert math.isnan(found.extrapolated) == (state != "monotone" or bar == 0.0)


def test_bars_join_at_the_slowest_order():
    """With p a little above and below 0.5 the bars are alike: 1.25 ε/(√2 − 1) is 1.25 times the spread ε (1 + √2)."""
    above, below = (estimate_error([1.0 + 2.0**order, 1.0, 0.0]) for order in (0.5001, 0.4999))
    assert (above.state, below.state) == ("monotone", "slow")
    # The order differs by 2e-4, so do the bars, times ln 2/(1 − 2^−p) at most.
    assert above.bar == pytest.approx(below.bar, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "ratios", "word"),
    [
        ((1.0, 2.0), None, "at least three"),
        ((1.0, math.nan, 2.0), None, "finite"),
        ((1.0, 2.0, 3.0), (2.0,), "must be 2"),
        ((1.0, 2.0, 3.0), (2.0, 1.0), "greater than 1"),
    ],
)
def test_refusals(values, ratios, word):
    with error_says(ValueError, word):
        estimate_error(values, ratios=ratios)
