r"""Error of a figure by the size of the elements, from solutions on at least three meshes.

With :math:`\varphi_1` on the finest mesh, :math:`\varphi_2, \varphi_3` on coarser ones, ratios of their edges
:math:`r_{21} = h_2/h_1, r_{32} = h_3/h_2` and changes :math:`\varepsilon_{21} = \varphi_2 - \varphi_1`,
:math:`\varepsilon_{32} = \varphi_3 - \varphi_2`, the observed order p solves (Celik et al. 2008; ASME V&V 20-2009)

.. math:: p = \frac{1}{\ln r_{21}} \left| \ln\left|\frac{\varepsilon_{32}}{\varepsilon_{21}}\right|
          + \ln\frac{r_{21}^p - 1}{r_{32}^p - 1} \right|,

and the bar of the finest value, the grid convergence index as a length in the figure's own unit, is

.. math:: U = F_s \frac{|\varepsilon_{21}|}{r_{21}^{p} - 1}, \qquad F_s = 1.25 .

The bar is half the width of an interval about the finest value that holds the value on infinitely fine meshes in about 95 % of
cases (V&V 20). What does not converge evenly has no order; its bar is a multiple of the spread
:math:`\Delta_M = \max |\varphi_i - \varphi_j|` of the three values:

===========  ===========================================================  ======================================================
state        when                                                         bar
===========  ===========================================================  ======================================================
monotone     changes keep their sign and shrink, p ≥ 0.5; an order above  U
             that of theory is chance and counts as that of theory
             (Oberkampf & Roy 2010, 8.6)
slow         likewise, but p < 0.5                                        1.25 Δ_M (Eça & Hoekstra 2006)
oscillating  changes alternate and shrink                                 Δ_M (Stern et al. 2001 take half of it)
unsettled    changes do not shrink                                        3 Δ_M (Eça & Hoekstra 2006)
===========  ===========================================================  ======================================================

Literature: I. B. Celik et al., J. Fluids Eng. 130 (2008) 078001; ASME V&V 20-2009; W. L. Oberkampf, C. J. Roy, *Verification
and Validation in Scientific Computing*, 2010; L. Eça, M. Hoekstra, *2nd Workshop on CFD Uncertainty Analysis*, Lisbon 2006;
F. Stern et al., J. Fluids Eng. 123 (2001) 793.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import expm1, inf, isfinite, log, nan
from typing import Literal

from scipy.optimize import brentq

SAFETY_FACTOR = 1.25
"""F_s for three or more meshes (ASME V&V 20-2009)."""
UNSETTLED_FACTOR = 3.0
"""Multiple of the spread where changes do not shrink (Eça & Hoekstra 2006)."""
SLOWEST_ORDER = 0.5
"""Observed order below which Richardson's value is not used (Eça & Hoekstra 2006: the bar is then a multiple of the spread)."""

State = Literal["monotone", "slow", "oscillating", "unsettled"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorEstimate:
    """Value of a figure on nested meshes, with its error by the size of the elements.

    Attributes
    ----------
    values : tuple of float
        From the coarsest to the finest mesh.
    state : {"monotone", "slow", "oscillating", "unsettled"}
        How the last three of them converge.
    order : float
        Observed order p; not a number unless the changes keep their sign and shrink.
    extrapolated : float
        Value on infinitely fine meshes by Richardson's extrapolation, with the order used in the bar; not a number likewise.
    bar : float
        Half the width of the interval about the finest value, in its unit.
    """

    values: tuple[float, ...]
    state: State
    order: float
    extrapolated: float
    bar: float

    @property
    def value(self) -> float:
        """On the finest mesh."""
        return self.values[-1]

    def bar_at(self, mesh: int) -> float:
        """Return the bar of the value on one of the meshes: its distance from the finest value and the bar of that."""
        return abs(self.values[mesh] - self.value) + self.bar

    @property
    def relative_bar(self) -> float:
        """The bar as a part of the finest value, infinite where that is zero."""
        return self.bar / abs(self.value) if self.value else (inf if self.bar else 0.0)


def estimate_error(
    values: Sequence[float], formal_order: float = inf, ratios: Sequence[float] | None = None
) -> ErrorEstimate:
    """Return the error of the last of some values.

    Parameters
    ----------
    values : sequence of float
        On at least three meshes, from the coarsest to the finest; the last three decide.
    formal_order : float
        Order that theory allows; infinite for none.
    ratios : sequence of float, optional
        Edge of each mesh by that of the next finer one, one less than values; 2 by default.

    Returns
    -------
    ErrorEstimate
        Value, order and bar.

    Raises
    ------
    ValueError
        For fewer than three values, a number that is not finite, and ratios that are not greater than 1.

    Examples
    --------
    >>> cells = [4500.0, 8000.0, 18000.0]  # in the plane, of Celik et al. 2008, Table 1
    >>> ratios = [(fine / coarse) ** 0.5 for coarse, fine in zip(cells, cells[1:])]
    >>> found = estimate_error([5.863, 5.972, 6.063], ratios=ratios)
    >>> round(found.order, 2), round(100 * found.relative_bar, 1)
    (1.53, 2.2)
    """
    known = tuple(float(value) for value in values)
    steps = [2.0] * (len(known) - 1) if ratios is None else [float(ratio) for ratio in ratios]
    if len(known) < 3 or not all(isfinite(value) for value in known):
        raise ValueError(f"values {known}: must be at least three finite numbers")
    if len(steps) != len(known) - 1 or not all(1.0 < ratio < inf for ratio in steps):
        raise ValueError(f"ratios {steps}: must be {len(known) - 1} finite numbers greater than 1")
    third, second, finest = known[-3:]
    fine, coarse = second - finest, third - second
    spread = max(known[-3:]) - min(known[-3:])
    order = extrapolated = nan
    state: State
    if spread == 0.0:
        state, bar = "monotone", 0.0
    elif abs(coarse) * log(steps[-1]) <= abs(fine) * log(steps[-2]):
        state, bar = "unsettled", UNSETTLED_FACTOR * spread
    elif fine * coarse < 0.0:
        state, bar = "oscillating", spread
    elif fine == 0.0:
        state, bar, extrapolated = "monotone", 0.0, finest
    else:
        order = observed_order(coarse / fine, steps[-1], steps[-2])
        if order < SLOWEST_ORDER:
            state, bar = "slow", SAFETY_FACTOR * spread
        else:
            step = fine / (steps[-1] ** min(order, formal_order) - 1.0)
            state, bar, extrapolated = "monotone", SAFETY_FACTOR * abs(step), finest - step
    return ErrorEstimate(values=known, state=state, order=order, extrapolated=extrapolated, bar=bar)


def observed_order(change_ratio: float, fine_ratio: float, coarse_ratio: float) -> float:
    r"""Return the observed order from ε₃₂/ε₂₁ > ln r₃₂/ln r₂₁ and the ratios r₂₁, r₃₂ of the edges.

    The equation of Celik et al. 2008 as :math:`r_{21}^p (r_{32}^p - 1)/(r_{21}^p - 1) = \varepsilon_{32}/\varepsilon_{21}`, whose
    left side grows with p: bracketed, because their fixed point leaves for infinity where the ratios are far apart.
    """
    if fine_ratio == coarse_ratio:
        return log(change_ratio) / log(fine_ratio)

    def beyond(order: float) -> float:
        return expm1(order * log(coarse_ratio)) / -expm1(-order * log(fine_ratio)) - change_ratio

    highest = 1.0
    while beyond(highest) < 0.0:
        highest *= 2.0
    return float(brentq(beyond, 1e-9, highest, xtol=1e-13, rtol=1e-13))
