r"""Load–approach law of an uncrowned line contact between two half-spaces.

With the parabolic separation x²/(2ρ) over the length L nothing but λ = L/√(ρδ) is left in the dimensionless
problem: load F/(E* δ L), mid-width pressure p √ρ/(E* √δ) and half-width b/√(ρδ) are functions of λ, so one table
serves every pin and roller. The table holds the energy U = ∫F dδ = E* L δ² / w(X), X = ln(ρδ/L²) = −2 ln λ: w
is smooth and nearly linear in X for long contacts, the load and the stiffness are exact derivatives of one
function (what an equilibrium solver by minimum potential needs), and the energy is closed.

The nodes are solutions of `ltca.contact.pressure_cells` on two grids, extrapolated to zero cell size (Richardson) with the orders
measured in ``tests/analytic/test_line_contact_table.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.contact.pressure_cells import expected_half_width, solve_cylinder_patch
from ltca.laws.slenderness_curve import SlendernessCurve

FloatArray = NDArray[np.float64]

LONGEST = 1.0e5
SHORTEST = 0.15
_NODES = 31
_CELLS = 16
# Orders of convergence when both cell counts are doubled, as measured: energy 2.7, half-width and pressure 2.2 to 2.9.
_ENERGY_GAIN = 1.0 / (2.0**2.7 - 1.0)
_FIELD_GAIN = 1.0 / (2.0**2.4 - 1.0)


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
            guess = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells // 2, half_width=half_width)
            half_width = guess.half_width
        # Both grids must cut the contact at the same place for their difference to extrapolate.
        coarse = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells // 2, half_width=half_width)
        fine = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells, half_width=half_width, start=coarse)
        row[0] = (fine.energy + _ENERGY_GAIN * (fine.energy - coarse.energy)) / slenderness
        row[1] = fine.mid_pressure + _FIELD_GAIN * (fine.mid_pressure - coarse.mid_pressure)
        row[2] = fine.half_width + _FIELD_GAIN * (fine.half_width - coarse.half_width)
    energy, pressure, half_width_ratio = rows.T
    # A slender contact has δ = q/(π E*) (ln 1/δ + …), so δ E* L/F → −X/π, b² = 4 F ρ/(π E* L) and p = E* b/(2ρ).
    return LineContactTable(
        inverse_energy=SlendernessCurve.through(places, 1.0 / energy, 2.0 / np.pi),
        inverse_square_pressure=SlendernessCurve.through(places, pressure**-2, 1.0),
        inverse_square_half_width=SlendernessCurve.through(places, half_width_ratio**-2, 0.25),
    )


@dataclass(frozen=True, slots=True)
class LineContactLaw:
    """Load, stiffness, energy, pressure and half-width of uncrowned cylinders of one length and modulus.

    Every method takes approach and effective radius in mm, broadcasts them and returns arrays; an open contact
    (approach ≤ 0) gives zeros. The load is continuously differentiable where the approach is positive.

    Parameters
    ----------
    length : float
        Length of the line contact, mm.
    contact_modulus : float
        E* = 1/((1−ν1²)/E1 + (1−ν2²)/E2), MPa.
    table : LineContactTable, optional
        The dimensionless law; default `line_contact_table`.
    """

    length: float
    contact_modulus: float
    table: LineContactTable = field(default_factory=line_contact_table)

    def _place(
        self, approach: ArrayLike, effective_radius: ArrayLike
    ) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
        """Approach (zero where open), X (harmless where open) and the mask of closed contacts."""
        delta = np.asarray(approach, dtype=float)
        radius = np.asarray(effective_radius, dtype=float)
        closed = delta > 0.0
        pressed = np.where(closed, delta, 0.0)
        square = self.length * self.length
        return pressed, np.log(np.where(closed, delta, 1.0) * radius / square), closed

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Load and its exact derivative by the approach, N and N/mm."""
        pressed, place, closed = self._place(approach, effective_radius)
        w, first, second = self.table.inverse_energy.value_and_derivatives(place)
        inverse = 1.0 / w
        scale = (self.contact_modulus * self.length) * inverse
        slope = first * inverse
        load = scale * pressed * (2.0 - slope)
        stiffness = scale * (2.0 - slope * (3.0 - 2.0 * slope) - second * inverse) * closed
        return load, stiffness

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """∫ F dδ in closed form, N·mm."""
        pressed, place, _ = self._place(approach, effective_radius)
        scale = self.contact_modulus * self.length
        return np.asarray(scale * pressed**2 / self.table.inverse_energy.value(place))

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Largest pressure at mid-width, MPa."""
        pressed, place, _ = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_pressure.value(place)
        radius = np.asarray(effective_radius, dtype=float)
        return np.asarray(self.contact_modulus * np.sqrt(pressed / (radius * ratio)))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Contact half-width at mid-width, 2 √⟨x²⟩ with the pressure as weight, mm."""
        pressed, place, _ = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_half_width.value(place)
        return np.asarray(np.sqrt(pressed * np.asarray(effective_radius, dtype=float) / ratio))
