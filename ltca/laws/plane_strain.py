"""Load–approach law of a line contact in plane strain, δ = 2q/(π E*) (ln(2D/b) + 1/2), b² = 4 q ρ/(π E*), with a datum D.

A half-plane alone has no approach: D is where the rest of the body takes over. The approach is the pressure-weighted mean
displacement over the patch and the mean separation b²/(8ρ), a quarter of the bracket each.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.errors import ConvergenceError
from ltca.laws.contact_law import ContactLaw

SELF_ENERGY = 0.25
"""Of a semi-elliptic pressure of half-width b: −⟨ln|x − x′|⟩ = −ln(b/2) + 1/4."""


_LIGHTEST, _HEAVIEST, _KNOTS = -46.0, -0.3, 4097
"""ln X at the ends of the curve and its knots; beyond the heavier end, a half-width of 0.8 datums, there is no law."""
_PER_KNOT = (_KNOTS - 1) / (_HEAVIEST - _LIGHTEST)


@cache
def _pieces() -> FloatArray:
    """Cubic pieces of Q/X over ln X from its values and slopes: of loads 2e-13 is left."""
    value, slope = _ratio(np.linspace(_LIGHTEST, _HEAVIEST, _KNOTS))
    slope = slope / _PER_KNOT
    before, after, rise = slope[:-1], slope[1:], np.diff(value)
    return np.stack((value[:-1], before, 3.0 * rise - 2.0 * before - after, before + after - 2.0 * rise))


def _ratio(place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Q/X at ln X and its derivative, by Lambert's function: (ln(4/Q) + 1) exp(−ln(4/Q) − 1) = X/2e."""
    from scipy.special import lambertw  # 0.1 s to import

    level = -0.5 * lambertw(-np.exp(place - 1.0) / 2.0, -1).real
    return 1.0 / level, 0.5 / (level * (level - 0.5))


def plane_load(place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Q/X = 2q/(π E* δ) and its derivative by ln X, X = 2 δρ/D² = Q (ln(4/Q) + 1)/2, Q = (b/D)², overwriting ln X."""
    light = heavy = None
    if place.size and not (place.min() >= _LIGHTEST and place.max() < _HEAVIEST):
        light, heavy = place < _LIGHTEST, place >= _HEAVIEST
        exact, further = _ratio(place[light]), place[heavy] - _HEAVIEST
        place[light | heavy] = _LIGHTEST
    place -= _LIGHTEST
    place *= _PER_KNOT
    piece = place.astype(np.intp)
    place -= piece
    value, slope, third, last = _pieces().take(piece, axis=1)
    # c0 + t (c1 + t (c2 + t c3)) and c1 + t (2 c2 + 3 t c3), by c2 + t c3 and t c3.
    last *= place
    third += last
    last += third
    third *= place
    last *= place
    last += third
    third += slope
    third *= place
    value += third
    slope += last
    slope *= _PER_KNOT
    if light is not None:
        value[light], slope[light] = exact
        last_value, last_slope = _ratio(np.full(1, _HEAVIEST))
        value[heavy] = last_value * np.exp(last_slope / last_value * further)
        slope[heavy] = last_slope / last_value * value[heavy]
    return value, slope


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneContactLaw(ContactLaw):
    """Plane-strain law of one line contact: thickness, mm, E*, MPa, and datum D, mm, large compared with every half-width."""

    thickness: float
    contact_modulus: float
    datum: float

    def approach_at_load(self, load: FloatArray, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N, in closed form; zero where there is no load."""
        force, radius = np.broadcast_arrays(np.asarray(load, dtype=float), np.asarray(effective_radius, dtype=float))
        loaded = force > 0.0
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        half_width = self._half_width(np.maximum(force, 1e-300), radius)
        logarithm = np.log(2.0 * self.datum / half_width)
        return np.where(loaded, scale * force * (logarithm + 0.5), 0.0), np.where(loaded, scale * logarithm, 0.0)

    def _load(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load and ln(2D/b)."""
        delta, radius = np.broadcast_arrays(np.asarray(approach, dtype=float), effective_radius)
        closed = delta > 0.0
        product = (2.0 / self.datum**2) * radius * np.where(closed, delta, 1e-6 * self.datum)
        place = np.log(product)
        if place.size and not place.max() < _HEAVIEST:
            raise ConvergenceError(
                f"approach beyond what the plane-strain law holds for (half-width against datum {self.datum:g} mm); "
                "ln(2 δρ/D²)",
                [float(place.max())],
            )
        ratio, _ = plane_load(place)
        load = (0.5 * np.pi * self.contact_modulus * self.thickness) * delta * ratio
        return np.where(closed, load, 0.0), 0.5 * np.log(4.0 / (ratio * product))

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm; zero where open."""
        load, logarithm = self._load(approach, effective_radius)
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        return load, np.where(load > 0.0, 1.0 / (scale * logarithm), 0.0)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ = F δ − ∫ δ dF, N·mm."""
        return self.energy_of_load(self._load(approach, effective_radius)[0], effective_radius)

    def energy_of_load(self, load: FloatArray, effective_radius: ArrayLike) -> FloatArray:
        """Return the same from the load, N, with δ by F in closed form."""
        # ∫₀^F F′ (ln(2D/b) + 1/2) dF′ = F²/2 (ln(2D/b) + 3/4), since ln b grows like ln(F)/2.
        logarithm = np.log(2.0 * self.datum / self._half_width(np.maximum(load, 1e-300), effective_radius))
        scale = 2.0 / (np.pi * self.contact_modulus * self.thickness)
        return np.asarray(scale * load**2 * (0.5 * logarithm + 0.125))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the contact half-width, mm."""
        return self._half_width(self._load(approach, effective_radius)[0], effective_radius)

    def _half_width(self, load: FloatArray, effective_radius: ArrayLike) -> FloatArray:
        return line_half_width(load / self.thickness, effective_radius, self.contact_modulus)

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the peak pressure, MPa."""
        line_load = self._load(approach, effective_radius)[0] / self.thickness
        return line_peak_pressure(line_load, effective_radius, self.contact_modulus)
