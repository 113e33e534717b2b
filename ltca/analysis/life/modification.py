"""Lubricant and contamination: the life modification factor a_ISO of radial roller bearings (ISO 281:2007)."""

from __future__ import annotations

import math

MAX_LIFE_FACTOR = 50.0
"""Bound of a_ISO."""
FULL_FILM = 4.0
"""Viscosity ratio above which more gives no more."""
LEAST_FILM = 0.1
"""Viscosity ratio below which ISO 281 tells no factor."""
_BRANCHES = ((0.4, 1.3993, 0.054381), (1.0, 1.2348, 0.19087), (math.inf, 1.2348, 0.071739))
"""Viscosity ratio below which each holds, factor and exponent."""


def reference_viscosity(speed: float, pitch_diameter: float) -> float:
    """Return ν₁, the kinematic viscosity that parts the surfaces, mm²/s (ISO 281, Eq. 28 and 29).

    Parameters
    ----------
    speed : float
        Of the bearing, turns a minute.
    pitch_diameter : float
        D_pw, mm.
    """
    if speed < 1000.0:
        return float(45_000.0 * speed**-0.83 * pitch_diameter**-0.5)
    return float(4500.0 * (speed * pitch_diameter) ** -0.5)


def life_modification_factor(viscosity_ratio: float, contamination: float, limit_ratio: float) -> float | None:
    """Return a_ISO of a radial roller bearing; None below a viscosity ratio of 0.1, where ISO 281 tells none.

    Parameters
    ----------
    viscosity_ratio : float
        κ = ν/ν₁.
    contamination : float
        e_C, 0 … 1.
    limit_ratio : float
        C_u/P.

    Examples
    --------
    >>> life_modification_factor(1.0, 0.0, 0.2)
    0.1
    """
    if viscosity_ratio < LEAST_FILM:
        return None
    ratio = min(viscosity_ratio, FULL_FILM)
    factor, exponent = next(row[1:] for row in _BRANCHES if ratio < row[0])
    left = 1.0 - (1.5859 - factor * ratio**-exponent) * (contamination * limit_ratio) ** 0.4
    if left <= 0.0:
        return MAX_LIFE_FACTOR
    return float(min(0.1 * left**-9.185, MAX_LIFE_FACTOR))
