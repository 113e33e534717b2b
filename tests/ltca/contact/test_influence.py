"""Influence coefficients against numerical quadrature, and the properties the solver relies on."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from scipy.integrate import quad

import ltca.contact.influence
from ltca.contact.influence import assemble_influence_matrix, lagged_influence


def love_displacement(x, y, half_length_x, half_length_y):
    """Integral of 1/r over a rectangle centred on the origin, from points of the surface (Love 1929; Johnson Eq. 3.25), mm."""
    x, y, a, b = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (x, y, half_length_x, half_length_y)))
    total = np.zeros(x.shape)
    # Sum of signed corner terms X asinh(Y/|X|) + Y asinh(X/|Y|), paired so that far points do not cancel:
    # asinh differences are formed from one quotient instead of two large logarithms.
    for near, far, half_near, half_far in ((x, y, a, b), (y, x, b, a)):
        for sign in (1.0, -1.0):
            edge = near + sign * half_near
            size = np.abs(edge)
            safe = np.where(size > 0.0, size, 1.0)
            upper, lower = (far + half_far) / safe, (far - half_far) / safe
            total += sign * np.where(
                size > 0.0, edge * _inverse_sinh_difference(upper, lower, 2.0 * half_far / safe), 0.0
            )
    return total


def _inverse_sinh_difference(upper, lower, difference):
    """asinh(upper) − asinh(lower), upper − lower given exactly: no cancellation when both are large or close."""
    root_upper, root_lower = np.hypot(1.0, upper), np.hypot(1.0, lower)
    same_side = upper * lower > 0.0
    # asinh u − asinh v = asinh(u √(1+v²) − v √(1+u²)); on the same side u²−v² over the sum avoids the difference.
    total = upper * root_lower + lower * root_upper
    argument = np.where(
        same_side,
        difference * (upper + lower) / np.where(same_side, total, 1.0),
        upper * root_lower - lower * root_upper,
    )
    return np.asarray(np.arcsinh(argument))


def integrate_inverse_distance(x, y, a, b):
    """Integral of 1/r over the rectangle, one direction closed, the other by adaptive quadrature."""

    def inner(xi):
        distance = abs(x - xi)
        return np.arcsinh((b + y) / distance) + np.arcsinh((b - y) / distance)

    breaks = [x] if -a < x < a else None
    return quad(inner, -a, a, points=breaks, limit=400, epsabs=0.0, epsrel=1e-11)[0]


@pytest.mark.parametrize("half_lengths", [(1.0, 1.0), (0.01, 3.0), (2.0, 1e-4), (1e-5, 1.0)])
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.3, 0.4), (1.7, 0.2), (0.2, 5.0), (30.0, 40.0)])
def test_love_is_the_integral_of_inverse_distance(half_lengths, place):
    a, b = half_lengths
    x, y = place[0] * a, place[1] * b
    # the closed form is exact; 1e-9 is what the quadrature reaches at its logarithmic end points
    assert love_displacement(x, y, a, b) == pytest.approx(integrate_inverse_distance(x, y, a, b), rel=1e-9)


def test_love_on_corners_edges_and_far_away():
    a, b = 0.7, 1.9
    # a corner sees a rectangle as a quarter of one of twice the size seen from its centre
    assert love_displacement(a, b, a, b) == pytest.approx(love_displacement(0, 0, 2 * a, 2 * b) / 4, rel=1e-14)
    # the middle of an edge sees half of one
    assert love_displacement(a, 0, a, b) == pytest.approx(love_displacement(0, 0, 2 * a, b) / 2, rel=1e-14)
    # far away it is area/distance up to (size/distance)²; 1e6 half sides away round-off alone must be left
    assert love_displacement(1e6, 1e6, a, b) == pytest.approx(4 * a * b / np.hypot(1e6, 1e6), rel=1e-9)


@pytest.mark.parametrize(
    "slenderness",
    [1.0, *(pytest.param(ratio, marks=pytest.mark.slow) for ratio in (0.1, 30.0, 1e3, 1e5))],
)
def test_mean_coefficients_match_love_averaged_by_quadrature(slenderness):
    width = 1.0 / 24.0
    step = np.linspace(0.0, 1.0, 13)
    edges = slenderness / 2 * (1 - (1 - step) ** 3)
    found = lagged_influence(width, 24, edges, mirrored=False)
    nodes, weights = np.polynomial.legendre.leggauss(48)
    generator = np.random.default_rng(7)
    for _ in range(60):
        lag = int(generator.integers(24))
        i, j = generator.integers(12, size=2)
        send_half = (edges[j + 1] - edges[j]) / 2
        send_centre = (edges[j + 1] + edges[j]) / 2

        def across(y, lag=lag, send_half=send_half, send_centre=send_centre):
            # receiving points over x: Gauss on both halves, whose ends are where the kernel has its kinks
            x = np.concatenate([(nodes - 1) / 4, (nodes + 1) / 4]) * width + lag * width
            values = love_displacement(x, y - send_centre, width / 2, send_half)
            return float(np.concatenate([weights, weights]) @ values) * width / 4

        breaks = [e for e in (edges[j], edges[j + 1]) if edges[i] < e < edges[i + 1]]
        reference = quad(across, edges[i], edges[i + 1], points=breaks or None, limit=200, epsrel=1e-8)[0]
        # far pairs use three-point quadrature, accurate to 4e-6 (stated in the module); the rest is round-off
        assert found[lag, i, j] == pytest.approx(reference, rel=2e-5)


@pytest.mark.parametrize("slenderness", [0.1, 3.0, 100.0, 1e5])
@pytest.mark.parametrize("end_factor", [0.0, 1.39])
def test_matrix_is_symmetric_positive_definite(slenderness, end_factor):
    x = np.linspace(0.0, 1.2, 13)
    y = slenderness / 2 * (1 - (1 - np.linspace(0.0, 1.0, 13)) ** 4)
    matrix = assemble_influence_matrix(x, y, symmetric_x=True, symmetric_y=True, end_factor=end_factor)
    assert np.array_equal(matrix, matrix.T)
    scale = np.sqrt(np.diag(matrix))
    # well away from zero against the round-off of a unit-diagonal matrix of this size
    assert np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0] > 1e-8


def test_quarter_matrix_is_the_whole_one_seen_by_symmetric_pressures():
    x = np.linspace(0.0, 0.6, 4)
    y = np.array([0.0, 1.0, 1.7, 2.0])
    quarter = assemble_influence_matrix(x, y, symmetric_x=True, symmetric_y=True)
    whole = assemble_influence_matrix(np.concatenate([-x[:0:-1], x]), np.concatenate([-y[:0:-1], y]))
    tensor = whole.reshape(6, 6, 6, 6)
    folded = sum(
        tensor[3:, 3:, sx, sy] for sx in (slice(3, 6), slice(2, None, -1)) for sy in (slice(3, 6), slice(2, None, -1))
    )
    # both hold the far-pair quadrature error of 4e-6 on different pairs
    np.testing.assert_allclose(quarter, folded.reshape(9, 9), rtol=1e-5)


def test_edges_are_checked():
    with pytest.raises(ValueError, match="uniform"):
        assemble_influence_matrix(np.array([0.0, 1.0, 3.0]), np.array([0.0, 1.0]))
    with pytest.raises(ValueError, match="start at 0"):
        assemble_influence_matrix(np.array([0.1, 1.1]), np.array([0.0, 1.0]), symmetric_x=True)


def test_series_for_distant_cells_agrees_with_the_closed_form(monkeypatch):
    lags = 0.1 * np.arange(5.0)
    distance = np.array([[-9.0, -2.5, 2.0, 7.0]])
    closed = ltca.contact.influence._mean_line_potential(lags, 0.1, distance)
    monkeypatch.setattr(ltca.contact.influence, "_SERIES_RATIO", 3.0)
    series = ltca.contact.influence._mean_line_potential(lags, 0.1, distance)
    # near enough that the terms kept matter (1e-6 and more); the first one left out is of the order (x/Y)⁸/200
    np.testing.assert_allclose(series, closed, atol=1e-7)
    assert not np.array_equal(series, closed)


def test_a_matrix_takes_little_more_memory_than_itself():
    """Gathered at once and turned over it took twice as much."""
    edges = np.linspace(-1.0, 1.0, 41), np.linspace(-3.0, 3.0, 31)
    tracemalloc.start()
    try:
        matrix = assemble_influence_matrix(*edges)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 1.3 * matrix.nbytes
