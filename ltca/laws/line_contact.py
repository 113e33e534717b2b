"""Load–approach law of an uncrowned line contact between two half-spaces, U = ∫ F dδ = E* L δ²/w(X), X = ln(ρδ/L²) = −2 ln λ.

Everything is a function of λ = L/√(ρδ), so one table serves all pins and rollers (docs/theory/contact.md); w is smooth and nearly
linear for long contacts, and load and stiffness are exact derivatives of U. `validation.shipped_tables` makes the table.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.laws.contact_law import ContactLaw
from ltca.laws.slenderness_curve import SlendernessCurve

LONGEST = 1.0e5
SHORTEST = 0.15
"""Range of λ = L/√(ρδ) of the table."""
TABLE = Path(__file__).with_name("line_contact.json")


@dataclass(frozen=True, slots=True)
class LineContactTable:
    """Curves over X = ln(ρδ/L²): E* L δ²/U, E*² δ/(ρ p²) at mid-width and ρδ/b²."""

    inverse_energy: SlendernessCurve
    inverse_square_pressure: SlendernessCurve
    inverse_square_half_width: SlendernessCurve


@cache
def line_contact_table() -> LineContactTable:
    """Return the table that ships with the package, read once: solved again, its last digits would depend on the machine."""
    stored = json.loads(TABLE.read_text(encoding="utf-8"))
    curves = {
        name: SlendernessCurve(**curve | {"coefficients": np.array(curve["coefficients"])})
        for name, curve in stored.items()
    }
    return LineContactTable(**curves)


@dataclass(frozen=True, slots=True)
class LineContactLaw(ContactLaw):
    """Uncrowned cylinders of lengths L, mm, and moduli E*, MPa, numbers or of shape (pairs,); continuously differentiable."""

    length: float | FloatArray
    contact_modulus: float | FloatArray
    table: LineContactTable = field(default_factory=line_contact_table)

    def _place(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Approach, zero where open, and X, that of 1 mm where open."""
        delta = np.asarray(approach, dtype=float)
        product = np.where(delta > 0.0, delta, 1.0) * np.asarray(effective_radius, dtype=float)
        return np.maximum(delta, 0.0), np.log(product / (self.length * self.length))

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Load (Eq. 67–68, 84) and its exact derivative by the approach, N and N/mm."""
        delta = np.asarray(approach, dtype=float)
        product = delta * np.asarray(effective_radius, dtype=float)
        if delta.shape != product.shape:
            delta = np.broadcast_to(delta, product.shape)
        closed = delta > 0.0
        if closed.all():
            return self._closed(delta, product)
        # Most pins of a drive are open: only closed contacts are evaluated.
        load, stiffness = np.zeros(delta.shape), np.zeros(delta.shape)
        load[closed], stiffness[closed] = self.take(closed.shape, closed)._closed(delta[closed], product[closed])
        return load, stiffness

    def take(self, shape: tuple[int, ...], places: Any) -> LineContactLaw:
        """Return the law of some contacts of a batch."""
        if np.ndim(self.length) == 0:
            return self
        columns = places[-1] if isinstance(places, tuple) else np.nonzero(places)[-1]
        length, modulus = (np.asarray(each)[columns] for each in (self.length, self.contact_modulus))
        return LineContactLaw(length, modulus, self.table)

    def _closed(self, pressed: FloatArray, product: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Load and stiffness of contacts that are all closed, from approaches and their products with the radius."""
        place = np.log(product / (self.length * self.length))
        w, first, second = self.table.inverse_energy.value_and_derivatives(place)
        inverse = 1.0 / w
        scale = (self.contact_modulus * self.length) * inverse
        slope = first * inverse
        load = scale * pressed * (2.0 - slope)
        stiffness = scale * (2.0 - slope * (3.0 - 2.0 * slope) - second * inverse)
        return load, stiffness

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """∫ F dδ in closed form, N·mm."""
        pressed, place = self._place(approach, effective_radius)
        scale = self.contact_modulus * self.length
        return np.asarray(scale * pressed**2 / self.table.inverse_energy.value(place))

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Largest pressure at mid-width, MPa."""
        pressed, place = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_pressure.value(place)
        radius = np.asarray(effective_radius, dtype=float)
        return np.asarray(self.contact_modulus * np.sqrt(pressed / (radius * ratio)))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Contact half-width at mid-width, 2 √⟨x²⟩ with the pressure as weight, mm."""
        pressed, place = self._place(approach, effective_radius)
        ratio = self.table.inverse_square_half_width.value(place)
        return np.asarray(np.sqrt(pressed * np.asarray(effective_radius, dtype=float) / ratio))
