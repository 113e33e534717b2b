"""Splines on uniform knots: polynomials come back, pieces join, the curve goes on beyond its ends."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.laws.slenderness_curve import SlendernessCurve, quintic_hermite_pieces, quintic_spline_pieces

KNOTS = np.arange(12.0)
VALUES = 3.0 + np.sin(0.7 * KNOTS) + 0.1 * KNOTS
SLOPES = 0.7 * np.cos(0.7 * KNOTS) + 0.1


def derivative_at(pieces, order, place):
    """Derivative of every piece at a place of its local coordinate."""
    return np.array([np.polynomial.Polynomial(column).deriv(order)(place) for column in pieces.T])


def jumps(pieces, order):
    return derivative_at(pieces, order, 1.0)[:-1] - derivative_at(pieces, order, 0.0)[1:]


def test_a_polynomial_of_degree_five_is_reproduced_on_every_piece():
    quintic = np.polynomial.Polynomial([1.0, -0.4, 0.3, 0.02, -0.01, 0.002])
    pieces = quintic_spline_pieces(quintic(KNOTS))
    for order in range(6):
        # differences of six values of size 100 keep 12 digits of them
        np.testing.assert_allclose(derivative_at(pieces, order, 0.5), quintic.deriv(order)(KNOTS[:-1] + 0.5), atol=1e-9)


def test_pieces_join_four_times_differentiably_through_the_values():
    pieces = quintic_spline_pieces(VALUES)
    np.testing.assert_allclose(pieces[0], VALUES[:-1], rtol=1e-14)  # round-off
    np.testing.assert_allclose(derivative_at(pieces, 0, 1.0), VALUES[1:], rtol=1e-14)
    for order in range(1, 5):
        np.testing.assert_allclose(jumps(pieces, order), 0.0, atol=1e-10)  # round-off of fourth derivatives
    fifth = jumps(pieces, 5)
    np.testing.assert_allclose(fifth[[0, 1, -2, -1]], 0.0, atol=1e-10)
    assert np.all(np.abs(fifth[2:-2]) > 1e-5)


def test_pieces_with_slopes_join_three_times_differentiably():
    pieces = quintic_hermite_pieces(VALUES, SLOPES)
    # round-off of values up to 5
    np.testing.assert_allclose(pieces[:2], [VALUES[:-1], SLOPES[:-1]], atol=1e-13)
    np.testing.assert_allclose(derivative_at(pieces, 0, 1.0), VALUES[1:], atol=1e-13)
    np.testing.assert_allclose(derivative_at(pieces, 1, 1.0), SLOPES[1:], atol=1e-12)
    for order in (2, 3):
        np.testing.assert_allclose(jumps(pieces, order), 0.0, atol=1e-11)
    assert pieces[2, 0] == pytest.approx(0.0, abs=1e-12)
    assert jumps(pieces, 4)[-1] == pytest.approx(0.0, abs=1e-10)
    assert np.all(np.abs(jumps(pieces, 4)[:-1]) > 1e-6)


def test_value_and_derivatives_are_those_of_the_pieces_and_of_each_other():
    curve = SlendernessCurve(2.0, 0.5, quintic_spline_pieces(VALUES), 0.3)
    # inside, on a knot, and beyond both ends (at the very ends the third derivative jumps)
    places = np.array([2.3, 3.7, 4.5, 7.49, -3.0, 11.0])
    value, first, second = curve.value_and_derivatives(places)
    np.testing.assert_array_equal(curve.value(places), value)
    # central differences: (1e-4)² of a smooth function, its third derivatives being of order one
    step = 1e-4
    ahead, behind = curve.value_and_derivatives(places + step), curve.value_and_derivatives(places - step)
    np.testing.assert_allclose((ahead[0] - behind[0]) / (2 * step), first, atol=1e-7)
    np.testing.assert_allclose((ahead[1] - behind[1]) / (2 * step), second, atol=1e-7)


def test_too_few_values_are_refused():
    with pytest.raises(ValueError, match="at least 8 values, not 7"):
        quintic_spline_pieces(np.ones(7))
