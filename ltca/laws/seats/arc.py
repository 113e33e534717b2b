"""Contact of a conforming seat over a given arc |θ| < α: pressure, play and approach in units of the load.

d²/dθ² + 1 takes δ out of the condition: −2 Σ n pₙ cos nθ + 2η p + (c₀ − 2η) p₀ + 2 (1 − η) p₁ cos θ = −E* ΔR/a. In t = tan(θ/2) =
b s the sum is a hypersingular integral with the eigenfunctions √(1 − s²) U_k(s) (docs/theory/seats.md); sleeves add smooth terms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.laws.seats.sleeve_wall import sleeve_wall

FUNCTIONS = 20
"""Pressure functions of even order for one arc: the error is below 1e-6 where ν differs by 0.3, else below 1e-9."""
QUADRATURE = 80


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcSolution:
    """Contact over a given arc, b = tan(α/2), in units of the load: p in F/(aL), displacements in F/(L E*)."""

    half_width: float  # b
    play: float  # ΔR at which this arc is in contact, negative beyond the neat fit
    approach: float  # without the first harmonic
    coefficients: FloatArray  # of √(1 − s²) U_2k(s) in the pressure

    def pressure(self, angle: ArrayLike) -> FloatArray:
        """Return the pressure at angles (rad) from the line of load, in F/(aL); zero off the arc."""
        s = np.tan(0.5 * np.asarray(angle, dtype=float)) / self.half_width
        inside = np.abs(s) < 1.0
        return np.where(inside, _functions(np.where(inside, s, 0.0)) @ self.coefficients, 0.0)


def _functions(s: FloatArray) -> FloatArray:
    """√(1 − s²) U_k(s) = sin((k + 1) arccos s), k = 0, 2, …, on an additional last axis."""
    return np.asarray(np.sin(np.arccos(s)[..., None] * (2.0 * np.arange(FUNCTIONS) + 1.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Points:
    """Places s and weights of ∫ … ds over the half arc, and the pressure functions there."""

    s: FloatArray
    weights: FloatArray
    functions: FloatArray

    def on_arc(self, b: float) -> tuple[FloatArray, FloatArray]:
        """Angles and weights of ∫ … dθ over the whole arc, of even functions."""
        return 2.0 * np.arctan(b * self.s), self.weights * 4.0 * b / (1.0 + (b * self.s) ** 2)


@lru_cache(maxsize=1)
def _points() -> tuple[_Points, _Points, _Points]:
    """Points of integrals of the pressure, of those with its logarithm at s = 0, and of collocation."""
    turn = 0.5 * np.pi * (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    s = np.cos(turn)
    plain = _Points(s=s, weights=np.sin(turn) * (0.5 * np.pi / QUADRATURE), functions=_functions(s))
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE)
    v = 0.5 * (nodes + 1.0)
    # s = sin(π v⁴/2): the logarithm at s = 0 and the root at s = 1 become smooth.
    turn = 0.5 * np.pi * v**4
    s = np.sin(turn)
    logarithmic = _Points(s=s, weights=np.cos(turn) * np.pi * v**3 * weights, functions=_functions(s))
    s = np.cos(0.5 * np.pi * (np.arange(FUNCTIONS) + 0.5) / FUNCTIONS)
    return plain, logarithmic, _Points(s=s, weights=np.empty(0), functions=_functions(s))


def solve_arc(
    half_width: float, mismatch: float, breathing: float, sleeve: tuple[float, float, float] | None = None
) -> ArcSolution:
    """Return the contact over the arc of b = tan(α/2) for η (0 of equal materials), c₀ (1) and a sleeve's κ, a/R and E*/4μ."""
    b = half_width
    plain, logarithmic, points = _points()
    angle, weights = plain.on_arc(b)
    mean = weights @ plain.functions / (2.0 * np.pi)
    first = (weights * np.cos(angle)) @ plain.functions / np.pi
    # Σ n p_n cos nθ of each function: the hypersingular integral, in closed form.
    s = points.s[:, None]
    orders = 2.0 * np.arange(FUNCTIONS) + 1.0
    sums = (1.0 + (b * s) ** 2) / (2.0 * b * np.sqrt(1.0 - s**2)) * orders * points.functions
    cosine = (1.0 - (b * s) ** 2) / (1.0 + (b * s) ** 2)
    system = np.zeros((FUNCTIONS + 1, FUNCTIONS + 1))
    system[:-1, :-1] = (
        -2.0 * sums
        + 2.0 * mismatch * points.functions
        + (breathing - 2.0 * mismatch) * mean
        + 2.0 * (1.0 - mismatch) * cosine * first
    )
    system[:-1, -1] = 1.0
    # The force: ∫ p cos θ dθ = π p₁ = 1.
    system[-1, :-1] = np.pi * first
    right = np.zeros(FUNCTIONS + 1)
    right[-1] = 1.0
    if sleeve is not None:
        kappa, ratio, part = sleeve
        wall = sleeve_wall(kappa, ratio)
        n = np.arange(len(wall.own), dtype=float)[:, None]
        harmonics = (weights * np.cos(n * angle)) @ plain.functions / np.pi
        harmonics[0] *= 0.5
        waves = part * (1.0 - n**2) * np.cos(n * 2.0 * np.arctan(b * points.s))
        system[:-1, :-1] += (waves * wall.own[:, None]).T @ harmonics
        right[:-1] = -wall.across @ waves
    solved = np.asarray(np.linalg.solve(system, right), dtype=float)
    angle, weights = logarithmic.on_arc(b)
    # Σ over n ≥ 2 of (1 + η)/(n + 1) + (1 − η)/(n − 1) times cos nθ, and half the harmonic n = 0.
    kernel = (
        -2.0 * np.log(2.0 * np.sin(0.5 * angle)) * np.cos(angle)
        + mismatch * (np.pi - angle) * np.sin(angle)
        - (1.0 + mismatch) * (1.0 + 0.5 * np.cos(angle))
        + 0.5 * breathing
    )
    approach = (weights * kernel) @ (logarithmic.functions @ solved[:-1]) / np.pi
    if sleeve is not None:
        # Less the first harmonic, which does not know the arc.
        moved = np.where(n[:, 0] == 1.0, 0.0, wall.own - wall.back) @ harmonics
        approach += part * (moved @ solved[:-1] + wall.across.sum() + wall.outside)
    return ArcSolution(half_width=b, play=float(solved[-1]), approach=float(approach), coefficients=solved[:-1])
