"""Arc, pressure and approach of a conforming seat over the load, from Hertz to the neat fit: one Chebyshev series each.

With q = F/(L E* ΔR) and z² = q/(q + π b₁²), b₁ of the neat fit, they are analytic in z, the approach less its logarithm.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from ltca.arrays import FloatArray, freeze
from ltca.laws.seats.arc import solve_arc

DEGREE = 20
"""Degree of the Chebyshev series over b and over z."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConformingSeries:
    """Chebyshev series over z, from Hertz (z = 0) to the neat fit (z = 1)."""

    load_scale: float  # π b₁² of the neat fit
    half_width: FloatArray  # b/z
    pressure: FloatArray  # z times the peak pressure in F/(aL)
    approach: FloatArray  # in F/(L E*), without −2/π ln z and the first harmonic
    slope: FloatArray  # its derivative by z
    complement: FloatArray  # ∫ δ dF in F²/(L E*), without the same

    def evaluate(self, series: FloatArray, z: FloatArray) -> FloatArray:
        """Return one of the series at z, 0 … 1."""
        return np.asarray(chebyshev.chebval(2.0 * z - 1.0, series, tensor=False))


def _neat_fit(mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None) -> float:
    """Return b of the neat fit, where the play is negligible beside the approach."""
    from scipy.optimize import brentq  # 0.2 s to import, for seats alone

    def left(b: float) -> float:
        """Play times b², 1/π for small arcs."""
        return b**2 * solve_arc(b, mismatch, breathing, sleeve).play

    # In small steps: sleeves thin enough to bend away have more such arcs, far beyond the first.
    high = 0.3 if sleeve is None else 0.002
    while left(high) > 0.0:
        high *= 1.2
    return float(brentq(left, high / 1.2, high, xtol=1e-15))


def _fit(nodes: FloatArray, values: FloatArray) -> FloatArray:
    return np.asarray(chebyshev.chebfit(nodes, values, DEGREE), dtype=float)


def _complement(z: FloatArray, approach: FloatArray) -> FloatArray:
    """Return ∫ δ dF in F²/(L E*) at places z, from the series of the approach, less its logarithm."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    # Parts u = v⁴ of the load; z² goes with it as u z²/(1 − (1 − u) z²).
    v = 0.5 * (nodes + 1.0)
    u, weights = v**4, 2.0 * v**3 * weights
    at = np.sqrt(u / (1.0 - (1.0 - u) * z[:, None] ** 2))
    level = chebyshev.chebval(2.0 * z[:, None] * at - 1.0, approach) - 2.0 / np.pi * np.log(at)
    return np.asarray(level @ (weights * u))


@lru_cache(maxsize=256)
def conforming_series(
    mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None = None
) -> ConformingSeries:
    """Return the series of two materials, η (0 of equal ones) and c₀ (1), and of a sleeve's κ, a/R and E*/4μ, if there is one."""
    widest = _neat_fit(mismatch, breathing, sleeve)
    nodes = chebyshev.chebpts1(DEGREE + 1)
    place = 0.5 * (nodes + 1.0)
    arcs = [solve_arc(float(b), mismatch, breathing, sleeve) for b in widest * place]
    b = np.array([arc.half_width for arc in arcs])
    # Analytic in b: b² times the play, b times the peak pressure, the approach without its logarithm.
    play = _fit(nodes, b**2 * [arc.play for arc in arcs])
    pressure = _fit(nodes, b * [float(arc.pressure(0.0)) for arc in arcs])
    approach = _fit(nodes, 2.0 / np.pi * np.log(b) + [arc.approach for arc in arcs])
    # 1/z² = 1 + π b₁² ΔR: the place x = b/b₁ of every z by Newton's method from x = z.
    slope = chebyshev.chebder(play)
    z, x = place, place.copy()
    for _ in range(50):
        found = chebyshev.chebval(2.0 * x - 1.0, play) * np.pi
        miss = x**2 * (1.0 - z**2) - z**2 * found
        step = miss / (2.0 * x * (1.0 - z**2) - 2.0 * z**2 * np.pi * chebyshev.chebval(2.0 * x - 1.0, slope))
        x = np.clip(x - step, 0.25 * x, 1.0)
        if np.max(np.abs(step)) < 1e-14:
            break
    at = 2.0 * x - 1.0
    series = (
        x * widest / z,
        chebyshev.chebval(at, pressure) * z / (x * widest),
        chebyshev.chebval(at, approach) - 2.0 / np.pi * np.log(x * widest / z),
    )
    half_width, peak, closing = (_fit(nodes, values) for values in series)
    return freeze(
        ConformingSeries(
            load_scale=float(np.pi * widest**2),
            half_width=half_width,
            pressure=peak,
            approach=closing,
            slope=np.asarray(2.0 * chebyshev.chebder(closing), dtype=float),
            complement=_fit(nodes, _complement(place, closing)),
        )
    )
