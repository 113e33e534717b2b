r"""Rating life of the crank bearing from the loads of its rollers (ISO 281, ISO/TS 16281).

A point of a race that stands still to the load always carries the same roller load; one that moves against it carries
them all in turn. So the equivalent load of the moving race is the fourth-power mean of the roller loads, that of the
standing race the mean with 4.5 (= 4 · 9/8, the Weibull slope of line contact). In a usual bearing the load stands in
space, the inner race turns and the outer one stands. **Here it is the other way round**: the load turns with the crank,
so the inner race, which is the crank's own surface, stands still to it, and the disc's bore moves against it. The means
change places.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

RACE_WEIBULL = 4.5
"""Exponent of the load in a race that stands still to the load."""
MOVING = 4.0
"""Exponent in a race that moves against it."""
EDGE_ALLOWANCE = 0.83
"""λν of ISO/TS 16281: the part of the rating of ISO 281 that allows for edge stress, taken out where it is reckoned."""
LAMINAE = 31
BEARING_STEEL = 1.1
"""b_m of ISO 281 for radial cylindrical roller bearings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerBearing:
    """A row of cylindrical rollers, as ISO 281 sees it.

    Attributes
    ----------
    rollers : int
        Z.
    roller_diameter, roller_length : float
        D_we and L_we, mm.
    pitch_diameter : float
        D_pw, mm.
    """

    rollers: int
    roller_diameter: float
    roller_length: float
    pitch_diameter: float

    @property
    def slenderness(self) -> float:
        """γ = D_we/D_pw of a radial bearing."""
        return self.roller_diameter / self.pitch_diameter

    @property
    def race_ratio(self) -> float:
        """1.038 ((1 − γ)/(1 + γ))^(143/108), rating of the inner by that of the outer race under a standing load."""
        g = self.slenderness
        return 1.038 * float(((1.0 - g) / (1.0 + g)) ** (143.0 / 108.0))

    @property
    def geometry_factor(self) -> float:
        """f_c of ISO 281 (Table 7 tabulates it), by the formula of ISO/TR 1281-1."""
        g = self.slenderness
        races = 1.04 * ((1.0 - g) / (1.0 + g)) ** (143.0 / 108.0)
        shape = g ** (2.0 / 9.0) * (1.0 - g) ** (29.0 / 27.0) / (1.0 + g) ** 0.25
        return float(207.9 * EDGE_ALLOWANCE * shape * (1.0 + races**4.5) ** (-2.0 / 9.0))

    @property
    def dynamic_load_rating(self) -> float:
        """C_r = b_m f_c L_we^(7/9) Z^(3/4) D_we^(29/27), N (ISO 281, one row, α = 0)."""
        size = self.roller_length ** (7.0 / 9.0) * self.rollers**0.75 * self.roller_diameter ** (29.0 / 27.0)
        return float(BEARING_STEEL * self.geometry_factor * size)


@dataclass(frozen=True, slots=True, kw_only=True)
class RatingLife:
    """Life of the crank bearing.

    Attributes
    ----------
    life : float
        L_10r, millions of turns of the crank against the disc.
    inner_load, outer_load : float
        Equivalent roller loads of the races, N.
    inner_rating, outer_rating : float
        Their ratings Q_ci and Q_ce, N.
    dynamic_load_rating : float
        C_r, N.
    equivalent_load : float
        Radial load whose simple life (C/P)^(10/3) is the same, N.
    """

    life: float
    inner_load: float
    outer_load: float
    inner_rating: float
    outer_rating: float
    dynamic_load_rating: float
    equivalent_load: float


def power_mean(load: FloatArray, exponent: float) -> float:
    """Return (mean of loadᵉ)^(1/e) over everything, N."""
    largest = float(np.max(load))
    return largest * float(np.mean((load / largest) ** exponent)) ** (1.0 / exponent) if largest > 0.0 else 0.0


def edge_factors(laminae: int = LAMINAE) -> FloatArray:
    """Return the stress risers of the laminae of an unrelieved roller (ISO/TS 16281): 1 inside, more at the ends."""
    place = np.abs(2.0 * np.arange(1, laminae + 1) - laminae - 1.0) / (2.0 * laminae)
    factors = np.ones(laminae)
    inside = place > 0.0
    factors[inside] = 1.0 - 0.01 / np.log(1.985 * place[inside])
    return factors


def rating_life(
    bearing: RollerBearing,
    inner_load: FloatArray,
    outer_load: FloatArray,
    *,
    standing: str = "inner",
    relieved: bool = False,
    dynamic_load_rating: float | None = None,
) -> RatingLife:
    """Return the reference rating life from roller loads.

    Parameters
    ----------
    bearing : RollerBearing
        Its size.
    inner_load, outer_load : array, shape (positions, rollers)
        Loads on the races over evenly spaced positions, N.
    standing : {"inner", "outer"}
        The race that stands still to the load: the inner one in a crank bearing, the outer one usually.
    relieved : bool
        Whether crown or relief keeps the ends free of edge stress.
    dynamic_load_rating : float, optional
        C_r of the maker, N; by ISO 281 otherwise.

    Returns
    -------
    RatingLife

    Raises
    ------
    ValueError
        When nothing is loaded.

    Notes
    -----
    ISO/TS 16281:2008 with the load of a roller spread evenly over its laminae: Q_ci and Q_ce by C_r/(0.378 Z) and
    C_r/(0.364 Z), races joined with the slope 9/8. The laminae all carry Q/n_s, so their sum is a factor on the load,
    the 4.5-power mean of the edge factors.
    """
    if standing not in ("inner", "outer"):
        raise ValueError(f"standing must be inner or outer, not {standing}")
    if not (np.max(inner_load) > 0.0 and np.max(outer_load) > 0.0):
        raise ValueError("no roller carries a load")
    capacity = bearing.dynamic_load_rating if dynamic_load_rating is None else dynamic_load_rating
    ratio = bearing.race_ratio
    share = capacity / (EDGE_ALLOWANCE * bearing.rollers)
    inner_rating = share / 0.378 * (1.0 + ratio**4.5) ** (2.0 / 9.0)
    outer_rating = share / 0.364 * (1.0 + ratio**-4.5) ** (2.0 / 9.0)
    edge = 1.0 if relieved else power_mean(edge_factors(), RACE_WEIBULL)
    inner = edge * power_mean(inner_load, RACE_WEIBULL if standing == "inner" else MOVING)
    outer = edge * power_mean(outer_load, RACE_WEIBULL if standing == "outer" else MOVING)
    spent = (inner / inner_rating) ** 4.5 + (outer / outer_rating) ** 4.5
    life = spent ** (-8.0 / 9.0)
    return RatingLife(
        life=life,
        inner_load=inner,
        outer_load=outer,
        inner_rating=inner_rating,
        outer_rating=outer_rating,
        dynamic_load_rating=capacity,
        equivalent_load=capacity * life ** (-0.3),
    )
