"""Load–approach law of line contacts that are crowned or relieved along their length, U = E* L δ² exp(−m(X, ln ρ)).

m is a quintic spline along X = ln(ρδ/L²), a polynomial through Chebyshev nodes of ln ρ, and beyond the table straight, a power
law: crowned contacts at light load are points, F ∝ δ^1.5, m' = −1/2. Load and stiffness are derivatives of U at a held radius.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.contact.pressure_cells import PatchSolution, end_grading, extrapolate, solve_cylinder_patch
from ltca.drive.parts import LengthProfile
from ltca.errors import CycloError
from ltca.geometry.length_profile import Relief, generator_profile
from ltca.laws.contact_law import ContactLaw
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.slenderness_curve import quintic, quintic_hermite_pieces, quintic_spline_pieces

LIGHTEST = 2.0e4
HEAVIEST = 2.0
"""λ = L/√(ρδ) at the ends of the table."""
_NODES = 49
_CELLS = 16
# Orders measured with both cell counts doubled: energy 3, fields 2 (smooth ends: no singularity spoils them).
_ENERGY_GAIN = 1.0 / (2.0**3 - 1.0)
_FIELD_GAIN = 1.0 / (2.0**2 - 1.0)
LADDER_RATIO = 1.25
"""Ratio of neighbouring ends of the ranges of radii for which tables of profiled parts are made in a batch."""
# Grading of a contact that ends inside the profile, where pressure falls to zero by itself.
_FREE_GRADING = 1.25


def solve_profiled_patch(
    profile: Relief,
    effective_radius: float,
    contact_modulus: float,
    approach: float,
    *,
    cells: int = 16,
    half_width: float | None = None,
    start: PatchSolution | None = None,
) -> PatchSolution:
    """Return the contact of a profiled cylinder at δ, mm, on a grid over the overlapping length, as `solve_cylinder_patch`."""
    reach = profile.overlap_half_length(approach)
    slenderness = 2.0 * reach / float(np.sqrt(effective_radius * approach))
    # Ends of the body that still carry want the grading of unrelieved ends; the blend keeps the table smooth.
    share = (2.0 * reach / profile.length) ** 8
    grading = _FREE_GRADING + share * (end_grading(slenderness) - _FREE_GRADING)
    return solve_cylinder_patch(
        2.0 * reach,
        effective_radius,
        contact_modulus,
        approach,
        relief=profile.relief,
        cells=cells,
        half_width=half_width,
        grading=grading,
        start=start,
    )


class RadiusRangeError(CycloError):
    """A profiled law was evaluated at an effective radius outside the range of its table."""


@dataclass(frozen=True, slots=True)
class ProfiledTable:
    """Pieces over X of m, ln(p √ρ/(E* √δ)) and ln(b/√(ρδ)) at nodes of ln ρ, shape (radii, 6, pieces)."""

    smallest_radius: float
    largest_radius: float
    start: float
    spacing: float
    log_radii: FloatArray
    exponent: FloatArray
    log_pressure: FloatArray
    log_half_width: FloatArray


@cache
def profiled_table(
    profile: Relief, smallest_radius: float, largest_radius: float, cells: int = _CELLS, nodes: int = _NODES
) -> ProfiledTable:
    """Tabulate a profiled line contact for effective radii between two, mm, kept in the process."""
    if not 0.0 < smallest_radius <= largest_radius:
        raise ValueError(f"need 0 < smallest_radius <= largest_radius, got {smallest_radius}, {largest_radius}")
    low, high = np.log(smallest_radius), np.log(largest_radius)
    # Three nodes per factor of e: the polynomials in ln ρ then err by less than the grids (measured in the tests).
    count = 1 if high - low < 1e-9 else 3 + int(np.ceil(high - low))
    angles = (np.arange(count) + 0.5) * np.pi / count
    log_radii = np.sort(0.5 * (low + high) - 0.5 * (high - low) * np.cos(angles))
    places = np.linspace(-2.0 * np.log(LIGHTEST), -2.0 * np.log(HEAVIEST), nodes)
    length = profile.length
    values = np.empty((count, 4, nodes))
    for radius_values, log_radius in zip(values, log_radii, strict=True):
        radius = float(np.exp(log_radius))
        for column, place in enumerate(places):
            approach = float(length**2 * np.exp(place) / radius)
            guess = solve_profiled_patch(profile, radius, 1.0, approach, cells=cells // 2)
            solve = partial(solve_profiled_patch, profile, radius, 1.0, approach)
            energy, load, pressure, half_width = extrapolate(solve, cells, guess.half_width, _ENERGY_GAIN, _FIELD_GAIN)
            radius_values[0, column] = -np.log(energy / (length * approach**2))
            radius_values[1, column] = np.log(pressure * np.sqrt(radius / approach))
            radius_values[2, column] = np.log(half_width / np.sqrt(radius * approach))
            # F = dU/dδ makes m' = 2 − F δ/U.
            radius_values[3, column] = 2.0 - load * approach / energy
    spacing = float(places[1] - places[0])
    exponent = np.array([quintic_hermite_pieces(rows[0], rows[3] * spacing) for rows in values])
    pieces = np.array([[quintic_spline_pieces(curve) for curve in rows[1:3]] for rows in values])
    return ProfiledTable(
        smallest_radius=smallest_radius,
        largest_radius=largest_radius,
        start=float(places[0]),
        spacing=spacing,
        log_radii=log_radii,
        exponent=exponent,
        log_pressure=np.ascontiguousarray(pieces[:, 0]),
        log_half_width=np.ascontiguousarray(pieces[:, 1]),
    )


def _lagrange_weights(nodes: FloatArray, at: FloatArray) -> list[Any]:
    """Return the weight of every node for interpolation at points."""
    every = nodes.tolist()
    return [np.prod([(at - other) / (node - other) for other in every if other != node], axis=0) for node in every]


@dataclass(frozen=True, slots=True)
class ProfiledLineContactLaw(ContactLaw):
    """Profiled cylinders of a modulus E*, MPa; radii outside the range of the table are refused (`RadiusRangeError`)."""

    profile: Relief
    contact_modulus: float
    table: ProfiledTable

    @classmethod
    def for_radii(
        cls, profile: Relief, contact_modulus: float, smallest_radius: float, largest_radius: float
    ) -> ProfiledLineContactLaw:
        """Return the law for effective radii between two bounds, mm."""
        return cls(profile, contact_modulus, profiled_table(profile, smallest_radius, largest_radius))

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Load and its exact derivative by the approach, N and N/mm."""
        pressed, _, (m, first, second) = self._at(self.table.exponent, approach, effective_radius)
        scale = self.contact_modulus * self.profile.length * np.exp(-m)
        load = scale * pressed * (2.0 - first)
        return load, scale * (2.0 - 3.0 * first + first**2 - second) * (pressed > 0.0)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """∫ F dδ in closed form, N·mm."""
        pressed, _, (m, _, _) = self._at(self.table.exponent, approach, effective_radius)
        return np.asarray(self.contact_modulus * self.profile.length * pressed**2 * np.exp(-m))

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Largest pressure at mid-width, MPa."""
        pressed, radius, (logarithm, _, _) = self._at(self.table.log_pressure, approach, effective_radius)
        return np.asarray(self.contact_modulus * np.sqrt(pressed / radius) * np.exp(logarithm))

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Contact half-width at mid-width, mm."""
        pressed, radius, (logarithm, _, _) = self._at(self.table.log_half_width, approach, effective_radius)
        return np.asarray(np.sqrt(pressed * radius) * np.exp(logarithm))

    def _at(
        self, pieces: FloatArray, approach: ArrayLike, effective_radius: ArrayLike
    ) -> tuple[FloatArray, FloatArray, tuple[FloatArray, FloatArray, FloatArray]]:
        """Approach, zero where open, radius, and a curve with slope and curvature in X, straight beyond the table."""
        delta, radius = np.broadcast_arrays(
            np.asarray(approach, dtype=float), np.asarray(effective_radius, dtype=float)
        )
        table = self.table
        if radius.size and (
            radius.min() < table.smallest_radius * (1.0 - 1e-9) or radius.max() > table.largest_radius * (1.0 + 1e-9)
        ):
            raise RadiusRangeError(
                f"the profiled contact table holds effective radii from {table.smallest_radius:g} to "
                f"{table.largest_radius:g} mm, asked for {radius.min():g} to {radius.max():g} mm"
            )
        closed = delta > 0.0
        place = np.log(np.where(closed, delta * radius / self.profile.length**2, 1e-4))
        h, count = table.spacing, pieces.shape[2]
        s = (place - table.start) / h
        inside = np.clip(s, 0.0, float(count))
        beyond = (s - inside) * h
        piece = np.minimum(inside.astype(np.intp), count - 1)
        value, first, second = np.zeros((3, *s.shape))
        for weight, rows in zip(_lagrange_weights(table.log_radii, np.log(radius)), pieces, strict=True):
            at_node = quintic(rows.take(piece, axis=1), inside - piece)
            value, first, second = (
                total + weight * part for total, part in zip((value, first, second), at_node, strict=True)
            )
        first, second = first / h, second / h**2
        # The curvature decays within about one unit of X, so the load stays continuously differentiable.
        fade = np.exp(-np.abs(beyond))
        run = np.abs(beyond) - 1.0 + fade
        curve = (value + first * beyond + second * run, first + second * np.sign(beyond) * (1.0 - fade), second * fade)
        return np.where(closed, delta, 0.0), radius, curve


def law_for_profile(
    profile: LengthProfile,
    *,
    length: float,
    radius: float,
    contact_modulus: float,
    effective_radii: FloatArray,
    on_ladder: bool = False,
) -> ContactLaw:
    """Return the law of a roller or pin, mm and MPa, for the range of `effective_radii`, outward to a ladder if asked."""
    generator = generator_profile(profile, length, radius)
    if generator is None:
        return LineContactLaw(length, contact_modulus)
    smallest, largest = float(np.min(effective_radii)), float(np.max(effective_radii))
    if on_ladder:
        step = np.log(LADDER_RATIO)
        smallest = float(np.exp(step * np.floor(np.log(smallest) / step)))
        largest = float(np.exp(step * np.ceil(np.log(largest) / step)))
    return ProfiledLineContactLaw.for_radii(generator, contact_modulus, smallest, largest)
