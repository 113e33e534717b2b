"""Maxwell-slip elements whose strength goes with the load, against what they do by hand."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.reduced_model.hysteresis_elements import fit_elements

RATED, STRENGTH = 200.0, 0.08


def wedge(elastic, slope):
    """Torque beside the elastic one of one Coulomb element: it follows ±c·f, and goes from one to the other with a slope."""
    held, before, found = 0.0, 0.0, []
    for value in elastic:
        most = STRENGTH * abs(value)
        held, before = min(max(held + slope * (value - before), -most), most), value
        found.append(held)
    return np.array(found)


@pytest.mark.parametrize("back", [0.95, 0.8, 0.6])
def test_an_element_slips_back_where_it_should_and_is_found_again(back):
    """From c·f to −c·ρf over (1 − ρ)f: κ = c(1 + ρ)/(1 − ρ); least squares find the one element among all."""
    path = RATED * np.concatenate([np.linspace(0.0, 1.0, 41), np.linspace(1.0, 0.0, 81)[1:]])
    slope = STRENGTH * (1.0 + back) / (1.0 - back)
    beside = wedge(path, slope)
    released = 40 + int(np.argmax(beside[40:] <= -STRENGTH * path[40:] + 1e-9))
    assert path[released] / RATED == pytest.approx(back, abs=0.0126)  # one step of the path
    found = fit_elements([path], [path + beside], RATED, [(1.0, 1.0)])
    assert found.exponent.tolist() == [1.0]
    # Non-negative least squares on exact values: round-off of the normal equations.
    assert found.strength == pytest.approx([STRENGTH], rel=1e-8)
    assert found.stiffness == pytest.approx([slope], rel=1e-8)


def test_a_factor_of_the_strength_is_not_taken_for_strength():
    path = RATED * np.linspace(0.0, 1.0, 21)
    beside = 1.25 * wedge(path, 10.0)
    found = fit_elements([path], [path + beside], RATED, [(1.0, 1.25)])
    assert found.strength.sum() == pytest.approx(STRENGTH, rel=1e-8)
