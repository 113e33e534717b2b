"""Smooth curves over the slenderness of a line contact: quintic splines on uniform knots, four times differentiable.

Laws are evaluated for every contact in every iteration: locating pieces by one product and Horner's rule for value, slope and
curvature together take half the time of scipy's evaluation, which makes the splines.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from ltca.arrays import FloatArray

_DEGREE = 5


def quintic_spline_pieces(values: FloatArray) -> FloatArray:
    """Return the coefficients, powers 0 … 5 of 0 … 1, of the not-a-knot quintic spline through uniform knots, (6, n − 1).

    >>> bool(np.isclose(quintic_spline_pieces(np.arange(9.0) ** 4)[:, 2].sum(), 81.0))
    True
    """
    from scipy.interpolate import make_interp_spline  # 0.2 s to import, for curves that are not read from a file

    count = values.size
    if count < 8:
        raise ValueError(f"a quintic spline needs at least 8 values, not {count}")
    knots = np.arange(float(count))
    spline = make_interp_spline(knots, values, k=_DEGREE)
    # The pieces at the ends span the knots that not-a-knot leaves out: every interval between knots gets its coefficients.
    return np.array([spline(knots[:-1], nu=power) / factorial(power) for power in range(_DEGREE + 1)])


def quintic_hermite_pieces(values: FloatArray, slopes: FloatArray) -> FloatArray:
    """Return the coefficients of the quintic spline with values and slopes (by knot distance) at uniform knots, n ≥ 4.

    Three times continuously differentiable, without curvature at the first knot: for curves that bend within few knots.

    >>> knots = np.arange(6.0)
    >>> pieces = quintic_hermite_pieces(knots**4, 4.0 * knots**3)
    >>> bool(np.isclose(np.polyval(pieces[::-1, 2], 0.5), 2.5**4))
    True
    """
    from scipy.interpolate import BSpline

    count = values.size
    knots = np.arange(float(count))
    # Double knots leave the fourth derivative free, the single one at the last but one keeps it continuous there.
    inner = np.repeat(knots[1:-1], 2)[:-1]
    every = np.concatenate((np.zeros(_DEGREE + 1), inner, np.full(_DEGREE + 1, knots[-1])))
    basis = BSpline(every, np.eye(2 * count + 1), _DEGREE)
    system = np.concatenate((basis(knots), basis(knots, 1), basis(knots[:1], 2)))
    spline = BSpline(every, np.linalg.solve(system, np.concatenate((values, slopes, [0.0]))), _DEGREE)
    return np.array([spline(knots[:-1], nu=power) / factorial(power) for power in range(_DEGREE + 1)])


def quintic(coefficients: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return values, slopes and curvatures by the local coordinate t of pieces with coefficients of t⁰ … t⁵, shape (6, …)."""
    c0, c1, c2, c3, c4, c5 = coefficients
    fifth = t * c5
    value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + fifth))))
    first = c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + 5.0 * fifth)))
    return value, first, 2.0 * c2 + t * (6.0 * c3 + t * (12.0 * c4 + 20.0 * fifth))


@dataclass(frozen=True, slots=True)
class SlendernessCurve:
    """Smooth positive curve over X = ln(ρδ/L²), continued beyond its knots with value, slope and curvature.

    Toward X → −∞ as a + b t + c ln(1 + t/T), as slender contacts approach; toward ∞ as the exponential of nearly a line.
    """

    start: float  # first knot
    spacing: float  # of the knots
    coefficients: FloatArray  # powers 0 … 5 of the local coordinate 0 … 1, shape (6, pieces)
    light_slope: float  # limit of −d/dX for X → −∞

    def value(self, x: FloatArray) -> FloatArray:
        """Value at ``x``, any shape."""
        return self.value_and_derivatives(x)[0]

    def value_and_derivatives(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Value, first and second derivative at ``x``, each of its shape."""
        place = (x - self.start) * (1.0 / self.spacing)
        pieces = self.coefficients.shape[1]
        inside = place.size == 0 or (place.min() >= 0.0 and place.max() < pieces)
        if not inside:
            place = place.clip(0.0, float(pieces))
        piece = np.minimum(place.astype(np.intp), pieces - 1)
        value, first, second = map(np.asarray, quintic(self.coefficients.take(piece, axis=1), place - piece))
        inverse = 1.0 / self.spacing
        first *= inverse
        second *= inverse * inverse
        if not inside:
            self._beyond(x, value, first, second)
        return value, first, second

    def _beyond(self, x: FloatArray, *results: FloatArray) -> None:
        """Replace values and derivatives of points beyond the knots."""
        h, c = self.spacing, self.coefficients
        end = self.start + h * c.shape[1]
        low, high = x < self.start, x > end
        if low.any():
            value, first, second = c[0, 0], c[1, 0] / h, 2.0 * c[2, 0] / h**2
            t = self.start - x[low]
            # value'(t) = light_slope + bend/reach and value''(t) = −bend/reach² at t = 0
            reach = (self.light_slope + first) / second
            bend = -second * reach**2
            inverse = 1.0 / (reach + t)
            results[0][low] = value + self.light_slope * t + bend * np.log1p(t / reach)
            results[1][low] = -self.light_slope - bend * inverse
            results[2][low] = -bend * inverse**2
        if high.any():
            powers = np.arange(_DEGREE + 1.0)
            value = c[:, -1].sum()
            rate = float(powers @ c[:, -1]) / (h * value)
            bend = float((powers * (powers - 1.0)) @ c[:, -1]) / (h**2 * value) - rate**2
            t = x[high] - end
            decay = np.exp(-t)
            whole = value * np.exp(rate * t + bend * (t - 1.0 + decay))
            slope = rate + bend * (1.0 - decay)
            results[0][high] = whole
            results[1][high] = whole * slope
            results[2][high] = whole * (slope**2 + bend * decay)
