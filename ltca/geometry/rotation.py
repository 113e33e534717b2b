"""Points of the unit circle, by products instead of trigonometry where possible: e^{iφ}, its integer powers and small turns."""

from __future__ import annotations

from math import factorial

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import ComplexArray, FloatArray


def unit(angle: ArrayLike) -> ComplexArray:
    """Return e^{iφ}; cosine and sine cost a third less than the complex exponential."""
    angle = np.asarray(angle, dtype=float)
    result = np.empty(angle.shape, dtype=complex)
    result.real, result.imag = np.cos(angle), np.sin(angle)
    return result


def integer_power(base: ComplexArray, exponent: int) -> ComplexArray:
    """Return the n-th power, n ≥ 0, by repeated squaring: e^{inφ} of e^{iφ}.

    >>> bool(np.isclose(integer_power(unit(0.3), 13), unit(3.9)))
    True
    """
    result: ComplexArray | None = None
    while exponent:
        if exponent & 1:
            result = base if result is None else result * base
        exponent >>= 1
        if exponent:
            base = base * base
    return np.ones_like(base) if result is None else result


def small_turn(angle: FloatArray) -> ComplexArray:
    """Return e^{iφ} for |φ| ≤ 0.4 by its power series, to round-off (0.4¹⁴/14! < 1e-16), shorter for smaller angles.

    >>> bool(abs(small_turn(np.array(0.4)) - unit(0.4)) < 2e-16), bool(abs(small_turn(np.array(1e-3)) - unit(1e-3)) < 2e-16)
    (True, True)
    """
    square = angle * angle
    largest, order = float(np.max(square, initial=0.0)), 12
    while order > 2 and largest ** (order // 2) < 1e-17 * factorial(order):
        order -= 2
    cosine, sine = np.ones_like(angle), np.ones_like(angle)
    for n in range(order, 0, -2):
        cosine *= square
        cosine *= -1.0 / (n * (n - 1))
        cosine += 1.0
        sine *= square
        sine *= -1.0 / (n * (n + 1))
        sine += 1.0
    result = np.empty(np.shape(angle), dtype=complex)
    result.real, result.imag = cosine, sine * angle
    return result
