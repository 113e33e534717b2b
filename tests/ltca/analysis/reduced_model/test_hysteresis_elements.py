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


def test_the_order_at_which_release_goes_with_the_crank_angle_is_found():
    """Two elements whose shares change as 1 ± cos 8φ: their sum is within the law, so least squares leave round-off alone."""
    path = RATED * np.concatenate([np.linspace(0.0, 1.0, 21), np.linspace(1.0, -1.0, 41)[1:]])
    angle = 2.0 * np.pi * np.mod(0.6180339887 * np.arange(16), 1.0)
    early, late = (wedge(path, STRENGTH * (1.0 + back) / (1.0 - back)) for back in (0.89, 0.7))
    beside = [(1.0 + np.cos(8.0 * one)) * early + (1.0 - np.cos(8.0 * one)) * late for one in angle]
    torque = [path + one for one in beside]
    found = fit_elements([path] * 16, torque, RATED, [(1.0, 1.0)] * 16, angle, (3.0, 8.0, 39.0), judged=4)
    assert set(found.order) == {8.0}
    # Strengths up to LEAST_STRENGTH are left out; the two are found to the round-off of normal equations.
    for flank in (-1.0, 1.0):
        assert np.sort(found.strength[found.flank == flank]) == pytest.approx([STRENGTH, STRENGTH], rel=1e-6)
        assert np.sort(found.phase[found.flank == flank]) == pytest.approx([0.0, np.pi])


def test_each_flank_has_elements_of_its_own():
    """Friction that holds twice as much on one flank, and lets go later there, is found on that flank alone."""
    path = RATED * np.concatenate(
        [np.linspace(0.0, 1.0, 21), np.linspace(1.0, -1.0, 41)[1:], np.linspace(-1.0, 1.0, 41)[1:]]
    )
    early, late = (wedge(path, STRENGTH * (1.0 + back) / (1.0 - back)) for back in (0.92, 0.7))
    beside = np.where(path > 0.0, 2.0 * early, late)
    found = fit_elements([path], [path + beside], RATED, [(1.0, 1.0)])
    assert found.flank.tolist() == [-1.0, 1.0]
    # Least squares on exact values: round-off of the normal equations.
    assert found.strength == pytest.approx([STRENGTH, 2.0 * STRENGTH], rel=1e-8)
    assert found.stiffness / found.strength == pytest.approx([1.7 / 0.3, 1.92 / 0.08], rel=1e-8)


def test_a_factor_of_the_strength_is_not_taken_for_strength():
    path = RATED * np.linspace(0.0, 1.0, 21)
    beside = 1.25 * wedge(path, 10.0)
    found = fit_elements([path], [path + beside], RATED, [(1.0, 1.25)])
    assert found.strength.sum() == pytest.approx(STRENGTH, rel=1e-8)
