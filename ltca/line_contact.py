r"""Load–approach law of an uncrowned line contact between two half-spaces.

With the parabolic separation x²/(2ρ) over the length L nothing but λ = L/√(ρδ) is left in the dimensionless
problem: load F/(E* δ L), mid-width pressure p √ρ/(E* √δ) and half-width b/√(ρδ) are functions of λ, so one table
serves every pin and roller. The table holds the energy U = ∫F dδ = E* L δ² / w(X), X = ln(ρδ/L²) = −2 ln λ: w
is smooth and nearly linear in X for long contacts, the load and the stiffness are exact derivatives of one
function (what an equilibrium solver by minimum potential needs), and the energy is closed.

The nodes are solutions of `ltca.patch` on two grids, extrapolated to zero cell size (Richardson) with the orders
measured in ``tests/analytic/test_line_contact_table.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline, make_interp_spline

from ltca.patch import expected_half_width, solve_cylinder_patch

Array = NDArray[np.float64]

LONGEST = 1.0e5
SHORTEST = 0.25
_NODES = 27
_PIECES = 256
_CELLS = 16
# Orders of convergence when both cell counts are doubled, as measured: energy 2.7, half-width and pressure 2.
_ENERGY_GAIN = 1.0 / (2.0**2.7 - 1.0)
_FIELD_GAIN = 1.0 / (2.0**2 - 1.0)


@dataclass(frozen=True, slots=True)
class SlendernessCurve:
    """Smooth positive function of X on uniform knots: cubic pieces, twice differentiable, sound beyond its ends.

    Toward X → −∞ (very long or light contacts) it goes on as ``a + b t + c ln(1 + t/T)``, the form the
    logarithmic approach of slender contacts has; toward X → ∞ as an exponential of an almost linear function. Both
    continue value, slope and curvature.

    Parameters
    ----------
    start, spacing : float
        First knot and distance of the knots.
    coefficients : ndarray, shape (4, pieces)
        Powers 0 … 3 of the local coordinate 0 … 1.
    """

    start: float
    spacing: float
    coefficients: Array

    @classmethod
    def through(cls, nodes: Array, values: Array, pieces: int = _PIECES) -> SlendernessCurve:
        """Curve through values at uniform nodes: a quintic spline, resampled to fine uniform cubics."""
        quintic = make_interp_spline(nodes, values, k=5)
        knots = np.linspace(nodes[0], nodes[-1], pieces + 1)
        slope = quintic.derivative()
        ends = ((1, float(slope(knots[0]))), (1, float(slope(knots[-1]))))
        fine = CubicSpline(knots, quintic(knots), bc_type=ends)
        spacing = float(knots[1] - knots[0])
        powers = spacing ** np.arange(4.0)
        return cls(float(nodes[0]), spacing, np.ascontiguousarray(fine.c[::-1] * powers[:, None]))

    def value(self, x: Array) -> Array:
        """Value at ``x``."""
        piece, t, inside = self._locate(x)
        c0, c1, c2, c3 = (row.take(piece) for row in self.coefficients)
        value = c0 + t * (c1 + t * (c2 + t * c3))
        return value if inside else self._beyond(x, value)[0]

    def value_and_derivatives(self, x: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative at ``x``."""
        piece, t, inside = self._locate(x)
        c0, c1, c2, c3 = (row.take(piece) for row in self.coefficients)
        inverse = 1.0 / self.spacing
        cubic = t * c3
        value = c0 + t * (c1 + t * (c2 + cubic))
        first = (c1 + t * (2.0 * c2 + 3.0 * cubic)) * inverse
        second = (2.0 * c2 + 6.0 * cubic) * (inverse * inverse)
        return (value, first, second) if inside else self._beyond(x, value, first, second)

    def _locate(self, x: Array) -> tuple[NDArray[np.intp], Array, bool]:
        """Piece, local coordinate and whether all points lie on the table."""
        place = (x - self.start) * (1.0 / self.spacing)
        last = self.coefficients.shape[1] - 1
        inside = bool(place.size == 0 or (place.min() >= 0.0 and place.max() <= last + 1.0))
        piece = place.astype(np.intp)
        if not inside or place.max() > last:
            np.clip(piece, 0, last, out=piece)
        return piece, place - piece, inside

    def _beyond(self, x: Array, *found: Array) -> tuple[Array, ...]:
        """Replace values (and derivatives) of points off the table."""
        h, c = self.spacing, self.coefficients
        end = self.start + h * c.shape[1]
        results = [np.array(item) for item in found]
        low, high = x < self.start, x > end
        if low.any():
            value, first, second = c[0, 0], c[1, 0] / h, 2.0 * c[2, 0] / h**2
            t = self.start - x[low]
            reach = -self.start
            bend = -second * reach**2
            slope = -first - bend / reach
            inverse = 1.0 / (reach + t)
            parts = (
                value + slope * t + bend * np.log1p(t / reach),
                -slope - bend * inverse,
                -bend * inverse**2,
            )
            for result, part in zip(results, parts, strict=False):
                result[low] = part
        if high.any():
            value = c[:, -1].sum()
            first = (c[1, -1] + 2.0 * c[2, -1] + 3.0 * c[3, -1]) / h
            second = (2.0 * c[2, -1] + 6.0 * c[3, -1]) / h**2
            t = x[high] - end
            rate = first / value
            bend = second / value - rate**2
            decay = np.exp(-t)
            whole = value * np.exp(rate * t + bend * (t - 1.0 + decay))
            slope = rate + bend * (1.0 - decay)
            for result, part in zip(results, (whole, whole * slope, whole * (slope**2 + bend * decay)), strict=False):
                result[high] = part
        return tuple(results)


@dataclass(frozen=True, slots=True)
class LineContactTable:
    """The dimensionless law of uncrowned line contact, as curves over X = ln(ρδ/L²).

    Attributes
    ----------
    inverse_energy : SlendernessCurve
        E* L δ² / U.
    inverse_square_pressure : SlendernessCurve
        E*² δ / (ρ p²) of the mid-width pressure.
    inverse_square_half_width : SlendernessCurve
        ρδ / b².
    """

    inverse_energy: SlendernessCurve
    inverse_square_pressure: SlendernessCurve
    inverse_square_half_width: SlendernessCurve


@cache
def line_contact_table(
    cells: int = _CELLS, nodes: int = _NODES, shortest: float = SHORTEST, longest: float = LONGEST
) -> LineContactTable:
    """Build the dimensionless table from patch solutions (cached in the process).

    Parameters
    ----------
    cells : int
        Cells over the half-width and over half the length on the finer grid; the coarser has half as many.
    nodes : int
        Number of nodes, uniform in ln λ.
    shortest, longest : float
        Range of λ = L/√(ρδ).

    Returns
    -------
    LineContactTable
    """
    places = np.linspace(-2.0 * np.log(longest), -2.0 * np.log(shortest), nodes)
    rows = np.empty((nodes, 3))
    for row, place in zip(rows, places, strict=True):
        slenderness = float(np.exp(-0.5 * place))
        half_width = expected_half_width(slenderness, 1.0, 1.0)
        for _ in range(2):
            coarse = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells // 2, half_width=half_width)
            half_width = coarse.half_width
        # Both grids must cut the contact at the same place for their difference to extrapolate.
        coarse = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells // 2, half_width=half_width)
        fine = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells, half_width=half_width)
        row[0] = (fine.energy + _ENERGY_GAIN * (fine.energy - coarse.energy)) / slenderness
        row[1] = fine.mid_pressure + _FIELD_GAIN * (fine.mid_pressure - coarse.mid_pressure)
        row[2] = fine.half_width + _FIELD_GAIN * (fine.half_width - coarse.half_width)
    energy, pressure, half_width_ratio = rows.T
    return LineContactTable(
        inverse_energy=SlendernessCurve.through(places, 1.0 / energy),
        inverse_square_pressure=SlendernessCurve.through(places, pressure**-2),
        inverse_square_half_width=SlendernessCurve.through(places, half_width_ratio**-2),
    )


@dataclass(frozen=True, slots=True)
class LineContactLaw:
    """Load, stiffness, energy, pressure and half-width of uncrowned cylinders of one length and modulus.

    Every method takes approach and effective radius [mm], broadcasts them and returns arrays; an open contact
    (approach ≤ 0) gives zeros. The load is continuously differentiable where the approach is positive.

    Parameters
    ----------
    length : float
        Length of the line contact [mm].
    contact_modulus : float
        E* = 1/((1−ν1²)/E1 + (1−ν2²)/E2) [MPa].
    table : LineContactTable, optional
        The dimensionless law; default `line_contact_table`.
    """

    length: float
    contact_modulus: float
    table: LineContactTable = field(default_factory=line_contact_table)

    def _place(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[Array, Array, NDArray[np.bool_]]:
        """Approach (zero where open), X (harmless where open) and the mask of closed contacts."""
        delta = np.asarray(approach, dtype=float)
        radius = np.asarray(effective_radius, dtype=float)
        closed = delta > 0.0
        pressed = np.where(closed, delta, 0.0)
        square = self.length * self.length
        return pressed, np.log(np.where(closed, delta, 1.0) * radius / square), closed

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[Array, Array]:
        """Load [N] and its exact derivative by the approach [N/mm]."""
        pressed, place, closed = self._place(approach, effective_radius)
        w, first, second = self.table.inverse_energy.value_and_derivatives(place)
        inverse = 1.0 / w
        scale = (self.contact_modulus * self.length) * inverse
        slope = first * inverse
        load = scale * pressed * (2.0 - slope)
        stiffness = scale * (2.0 - slope * (3.0 - 2.0 * slope) - second * inverse) * closed
        return load, stiffness

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> Array:
        """∫ F dδ [N·mm], closed."""
        pressed, place, _ = self._place(approach, effective_radius)
        scale = self.contact_modulus * self.length
        return np.asarray(scale * pressed**2 / self.table.inverse_energy.value(place))

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> Array:
        """Largest pressure at mid-width [MPa]."""
        pressed, place, _ = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_pressure.value(place)
        radius = np.asarray(effective_radius, dtype=float)
        return np.asarray(self.contact_modulus * np.sqrt(pressed / (radius * ratio)))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> Array:
        """Contact half-width at mid-width [mm], 2 √⟨x²⟩ with the pressure as weight."""
        pressed, place, _ = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_half_width.value(place)
        return np.asarray(np.sqrt(pressed * np.asarray(effective_radius, dtype=float) / ratio))
