"""Smooth curves over the slenderness of a line contact: quintic splines on uniform knots, fast to evaluate.

The laws of `ltca.laws.line_contact` are evaluated for every contact in every iteration, so a curve is located by one
multiplication and summed by Horner's rule over stored piece coefficients. Quintic pieces joined four times
differentiably (cardinal B-splines, Schoenberg 1946) make loads and stiffnesses derived from them smooth.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_DEGREE = 5


def _cardinal_pieces() -> Array:
    """Powers 0 … 5 of the local coordinate on the six unit pieces of the quintic cardinal B-spline; (piece, power)."""
    pieces = np.zeros((_DEGREE + 1, _DEGREE + 1))
    for piece in range(_DEGREE + 1):
        # B(t) = Σ (−1)^k C(6, k) (t − k)₊⁵ / 5! with t = piece + local coordinate.
        for k in range(piece + 1):
            for power in range(_DEGREE + 1):
                shift = float(piece - k) ** (_DEGREE - power)
                pieces[piece, power] += (-1.0) ** k * comb(6, k) * comb(_DEGREE, power) * shift / factorial(5)
    return pieces


def quintic_spline_pieces(values: Array) -> Array:
    """Piece coefficients of the quintic spline through values at uniform knots.

    Four not-a-knot conditions close it (no jump of the fifth derivative at the two knots next to each end), so
    polynomials up to degree five are reproduced.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Values at the knots, at least 8.

    Returns
    -------
    ndarray, shape (6, n − 1)
        Powers 0 … 5 of the local coordinate 0 … 1 of every piece.

    Raises
    ------
    ValueError
        With fewer than eight values.

    Examples
    --------
    >>> knots = np.arange(9.0)
    >>> pieces = quintic_spline_pieces(knots**4)
    >>> bool(np.isclose(pieces[:, 2].sum(), 81.0))
    True
    """
    count = values.size
    if count < 8:
        raise ValueError(f"a quintic spline needs at least 8 values, not {count}")
    basis = _cardinal_pieces()
    # On piece i the B-splines i … i+5 are alive; coefficient i+j shows its piece 5−j.
    unknowns = count + _DEGREE - 1
    system = np.zeros((unknowns, unknowns))
    right = np.zeros(unknowns)
    right[:count] = values
    at_knot = basis[::-1, 0]
    for i in range(count):
        system[i, i : i + _DEGREE] = at_knot[:_DEGREE]
    sixth_difference = np.array([(-1.0) ** k * comb(6, k) for k in range(7)])
    for row, knot in enumerate((1, 2, count - 3, count - 2), start=count):
        system[row, knot - 1 : knot + 6] = sixth_difference
    weights = np.linalg.solve(system, right)
    windows = np.lib.stride_tricks.sliding_window_view(weights, _DEGREE + 1)
    return np.ascontiguousarray((windows @ basis[::-1]).T)


def quintic_hermite_pieces(values: Array, slopes: Array) -> Array:
    """Piece coefficients of the quintic spline with given values and slopes at uniform knots.

    Three times continuously differentiable; straight (no curvature) at the first knot, and the fourth derivative is
    continuous at the last knot but one. Twice the data of `quintic_spline_pieces` per knot: for curves that bend
    within few knots.

    Parameters
    ----------
    values, slopes : ndarray, shape (n,)
        Values and derivatives per unit of the local coordinate (slope times knot distance), n ≥ 4.

    Returns
    -------
    ndarray, shape (6, n − 1)
        Powers 0 … 5 of the local coordinate 0 … 1 of every piece.

    Examples
    --------
    >>> knots = np.arange(6.0)
    >>> pieces = quintic_hermite_pieces(knots**4, 4.0 * knots**3)
    >>> bool(np.isclose(np.polyval(pieces[::-1, 2], 0.5), 2.5**4))
    True
    """
    count = values.size
    rise = np.diff(values)
    before, after = slopes[:-1], slopes[1:]
    # Third derivative at the ends of a piece: start 60 Δ − 36 y0' − 24 y1' − 9 y0'' + 3 y1'',
    # end 60 Δ − 24 y0' − 36 y1' − 3 y0'' + 9 y1''; equal from both sides of every inner knot.
    system = np.zeros((count, count))
    right = np.zeros(count)
    inner = np.arange(1, count - 1)
    system[inner, inner - 1] = -3.0
    system[inner, inner] = 18.0
    system[inner, inner + 1] = -3.0
    right[inner] = 60.0 * (rise[1:] - rise[:-1]) + 24.0 * (before[:-1] - after[1:])
    system[0, 0] = 1.0
    # Fourth derivative: start −360 Δ + 192 y0' + 168 y1' + 36 y0'' − 24 y1'',
    # end 360 Δ − 168 y0' − 192 y1' − 24 y0'' + 36 y1''; equal at the last knot but one.
    knot = count - 2
    system[-1, knot - 1 : knot + 2] = (-24.0, 0.0, 24.0)
    left_end = 360.0 * rise[knot - 1] - 168.0 * before[knot - 1] - 192.0 * after[knot - 1]
    right_start = -360.0 * rise[knot] + 192.0 * before[knot] + 168.0 * after[knot]
    right[-1] = right_start - left_end
    bends = np.linalg.solve(system, right)
    first, last = bends[:-1], bends[1:]
    return np.array(
        [
            values[:-1],
            before,
            0.5 * first,
            10.0 * rise - 6.0 * before - 4.0 * after - 1.5 * first + 0.5 * last,
            -15.0 * rise + 8.0 * before + 7.0 * after + 1.5 * first - last,
            6.0 * rise - 3.0 * (before + after) - 0.5 * first + 0.5 * last,
        ]
    )


@dataclass(frozen=True, slots=True)
class SlendernessCurve:
    """Smooth curve over X = ln(ρδ/L²) with a sound continuation on both sides.

    Toward X → −∞ (very long or light contacts) it goes on as ``a + b t + c ln(1 + t/T)``, the form the
    logarithmic approach of slender contacts has, with the limiting slope b known and T from the curvature; toward
    X → ∞ as the exponential of an almost linear function. Both continue value, slope and curvature; the curve must
    be positive.

    Parameters
    ----------
    start, spacing : float
        First knot and distance of the knots.
    coefficients : ndarray, shape (6, pieces)
        Powers 0 … 5 of the local coordinate 0 … 1.
    light_slope : float
        Limit of −d/dX for X → −∞.
    """

    start: float
    spacing: float
    coefficients: Array
    light_slope: float

    @classmethod
    def through(cls, nodes: Array, values: Array, light_slope: float) -> SlendernessCurve:
        """Curve through positive values at uniform nodes."""
        return cls(float(nodes[0]), float(nodes[1] - nodes[0]), quintic_spline_pieces(values), light_slope)

    def value(self, x: Array) -> Array:
        """Value at ``x``, any shape."""
        piece, t, inside = self._locate(x)
        c0, c1, c2, c3, c4, c5 = (row.take(piece) for row in self.coefficients)
        value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
        return np.asarray(value if inside else self._beyond(x, value)[0])

    def value_and_derivatives(self, x: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative at ``x``, each of its shape."""
        piece, t, inside = self._locate(x)
        c0, c1, c2, c3, c4, c5 = (row.take(piece) for row in self.coefficients)
        inverse = 1.0 / self.spacing
        fifth = t * c5
        value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + fifth))))
        first = (c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + 5.0 * fifth)))) * inverse
        second = (2.0 * c2 + t * (6.0 * c3 + t * (12.0 * c4 + 20.0 * fifth))) * (inverse * inverse)
        if not inside:
            value, first, second = self._beyond(x, value, first, second)
        return np.asarray(value), np.asarray(first), np.asarray(second)

    def _locate(self, x: Array) -> tuple[NDArray[np.intp], Array, bool]:
        """Piece, local coordinate and whether all points lie on the curve's own range."""
        place = (x - self.start) * (1.0 / self.spacing)
        pieces = self.coefficients.shape[1]
        inside = bool(place.size == 0 or (place.min() >= 0.0 and place.max() < pieces))
        if not inside:
            place = np.clip(place, 0.0, float(pieces))
        piece = np.minimum(place.astype(np.intp), pieces - 1)
        return piece, place - piece, inside

    def _beyond(self, x: Array, *found: Array) -> tuple[Array, ...]:
        """Replace values (and derivatives) of points off the range."""
        h, c = self.spacing, self.coefficients
        end = self.start + h * c.shape[1]
        results = [np.array(item) for item in found]
        low, high = x < self.start, x > end
        if low.any():
            value, first, second = c[0, 0], c[1, 0] / h, 2.0 * c[2, 0] / h**2
            t = self.start - x[low]
            slope = self.light_slope
            # value'(t) = slope + bend/reach and value''(t) = −bend/reach² at t = 0
            reach = (slope + first) / second
            bend = -second * reach**2
            inverse = 1.0 / (reach + t)
            parts = (
                value + slope * t + bend * np.log1p(t / reach),
                -slope - bend * inverse,
                -bend * inverse**2,
            )
            for result, part in zip(results, parts, strict=False):
                result[low] = part
        if high.any():
            powers = np.arange(_DEGREE + 1.0)
            value = c[:, -1].sum()
            rate = float(powers @ c[:, -1]) / (h * value)
            bend = float((powers * (powers - 1.0)) @ c[:, -1]) / (h**2 * value) - rate**2
            t = x[high] - end
            decay = np.exp(-t)
            whole = value * np.exp(rate * t + bend * (t - 1.0 + decay))
            slope = rate + bend * (1.0 - decay)
            parts = (whole, whole * slope, whole * (slope**2 + bend * decay))
            for result, part in zip(results, parts, strict=False):
                result[high] = part
        return tuple(results)
