"""Contact of two half-spaces over a rectangular patch, |y| ≤ length/2 along the width: grid, solution, loads and pressures.

Pressure is constant in each cell, displacement and separation are cell means (Galerkin): the error of the energy is quadratic in
that of the pressures. x cells are uniform, with the expected edge on a cell edge; y cells shrink toward singular ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.contact.influence import assemble_influence_matrix
from ltca.contact.unilateral import solve_unilateral_contact

ReliefFunction = Callable[[FloatArray], FloatArray]

GRID_ROOM = 1.6
"""Width of the grid by the expected half-width: unrelieved ends are up to 1.56 times as wide as mid-width."""
# The edge of a short patch lies beyond 2√⟨x²⟩ by this over λ (measured for λ from 0.25 to 1; negligible above).
_SHORT_EDGE = 0.007
# Errors of constant cells for a Hertz profile whose edge lies on a cell edge, per (cell width/half-width)², measured
# with 6 to 64 cells: 2√⟨x²⟩ is too large, the pressure of the first cell too small compared with the peak.
_HALF_WIDTH_BIAS = 0.150
_PEAK_BIAS = 0.114
_GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)


def gauss_points(edges: FloatArray) -> FloatArray:
    """Return the Gauss points of `GAUSS_WEIGHTS` in cells between edges, shape (cells, 4)."""
    return np.asarray(0.5 * (edges[1:] + edges[:-1])[:, None] + 0.5 * np.diff(edges)[:, None] * _GAUSS_POINTS)


def graded_edges(length: float, cells: int, grading: float) -> FloatArray:
    """Return edges 0 … length/2, mm, the last cell length/2 · cells^−grading; 1 is uniform, 4 resolves unrelieved ends."""
    step = np.linspace(0.0, 1.0, cells + 1)
    return np.asarray(0.5 * length * (1.0 - (1.0 - step) ** grading))


def mirrored(edges: FloatArray) -> FloatArray:
    """Return the edges of a whole patch from those of its positive half, which begin at 0."""
    return np.concatenate([-edges[:0:-1], edges])


def end_grading(slenderness: float) -> float:
    """Return the grading exponent for a patch of length/√(ρδ) = ``slenderness``: longer ones need smaller end cells."""
    return 2.5 + 0.25 * float(np.log(max(slenderness, 1.0)))


@dataclass(frozen=True)
class PatchGrid:
    """Tensor grid over a patch, or its positive half in symmetric directions, by its edges along profile and width, mm."""

    x_edges: FloatArray
    y_edges: FloatArray
    symmetric_x: bool = True
    symmetric_y: bool = True
    end_factor: float = 0.0  # weight of images in free ends at those of the patch

    @classmethod
    def fitted(
        cls, length: float, half_width: float, *, cells: int, grading: float, end_factor: float = 0.0
    ) -> PatchGrid:
        """Return a quarter grid: `cells` over the expected half-width, with room for bulging ends, and over half the length."""
        count = int(np.ceil(GRID_ROOM * cells))
        return cls(
            x_edges=np.asarray(half_width / cells * np.arange(count + 1.0)),
            y_edges=graded_edges(length, cells, grading),
            end_factor=end_factor,
        )

    def scaled(self, size: float) -> PatchGrid:
        """Return the same grid so many times as large."""
        return replace(self, x_edges=self.x_edges * size, y_edges=self.y_edges * size)

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        return self.x_edges.size - 1, self.y_edges.size - 1

    @property
    def images(self) -> int:
        """Number of images of the grid in the whole patch: 1, 2 or 4."""
        return (2 if self.symmetric_x else 1) * (2 if self.symmetric_y else 1)

    @cached_property
    def areas(self) -> FloatArray:
        """Cell areas, mm², shape (nx, ny)."""
        return np.outer(np.diff(self.x_edges), np.diff(self.y_edges))

    @cached_property
    def x_centres(self) -> FloatArray:
        """Centres of the cells along x, mm."""
        return np.asarray(0.5 * (self.x_edges[1:] + self.x_edges[:-1]))

    @cached_property
    def y_centres(self) -> FloatArray:
        """Centres of the cells along y, mm."""
        return np.asarray(0.5 * (self.y_edges[1:] + self.y_edges[:-1]))

    @cached_property
    def influence(self) -> FloatArray:
        """Area-weighted influence matrix without its factor 1/(π E*), see `ltca.contact.influence`."""
        return assemble_influence_matrix(
            self.x_edges,
            self.y_edges,
            symmetric_x=self.symmetric_x,
            symmetric_y=self.symmetric_y,
            end_factor=self.end_factor,
        )

    def cell_means(self, function: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """Return the mean of f(x, y) over every cell by 4 × 4 Gauss points, shape (nx, ny)."""
        x, y = gauss_points(self.x_edges), gauss_points(self.y_edges)
        values = np.broadcast_to(function(x[:, :, None, None], y[None, None]), x.shape + y.shape)
        return np.asarray(np.einsum("iajb,a,b->ij", values, GAUSS_WEIGHTS, GAUSS_WEIGHTS) / 4.0)


@dataclass(frozen=True, kw_only=True)
class PatchPressure:
    """Mean pressure of each cell of a grid over a patch, MPa, shape (nx, ny)."""

    grid: PatchGrid
    pressure: FloatArray

    @property
    def load(self) -> float:
        """Normal load of the whole patch, N."""
        return self.grid.images * float(self.pressure.ravel() @ self.grid.areas.ravel())

    @property
    def contact(self) -> BoolArray:
        """Cells in contact, shape (nx, ny)."""
        return self.pressure > 0.0

    @property
    def mid_profile(self) -> tuple[FloatArray, FloatArray]:
        """Cell centres along x and the pressure there at mid-width y = 0, mm and MPa."""
        return self.grid.x_centres, self._at_mid_width(self.pressure)

    def unfolded(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the edges of the cells along x and y and the pressure over the whole patch, images included; mm, mm, MPa."""
        x, y, pressure = self.grid.x_edges, self.grid.y_edges, self.pressure
        if self.grid.symmetric_x:
            x, pressure = mirrored(x), np.concatenate([pressure[::-1], pressure])
        if self.grid.symmetric_y:
            y, pressure = mirrored(y), np.concatenate([pressure[:, ::-1], pressure], axis=1)
        return x, y, pressure

    @property
    def half_width(self) -> float:
        """Contact half-width at mid-width, mm: 2 √⟨x²⟩ about the centre, with the pressure as weight (exact for Hertz)."""
        x, p = self.grid.x_edges, self._at_mid_width(self.pressure)
        total = float(np.sum(p))
        if total <= 0.0:
            return 0.0
        first = 0.0 if self.grid.symmetric_x else float(np.sum(p * self.grid.x_centres)) / total
        second = (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / 3.0
        raw = 2.0 * float(np.sqrt(max(np.sum(p * second) / total - first**2, 0.0)))
        return raw / (1.0 + _HALF_WIDTH_BIAS * (float(x[1] - x[0]) / raw) ** 2)

    @property
    def mid_pressure(self) -> float:
        """Largest pressure at mid-width, MPa: the cell mean corrected for the curvature of a Hertz profile."""
        p = self._at_mid_width(self.pressure)
        half_width = self.half_width
        if half_width == 0.0:
            return 0.0
        width = float(self.grid.x_edges[1] - self.grid.x_edges[0])
        if self.grid.symmetric_x:
            return float(p[0] * (1.0 + _PEAK_BIAS * (width / half_width) ** 2))
        top = int(np.clip(np.argmax(p), 1, p.size - 2))
        before, centre, after = p[top - 1 : top + 2]
        bend = before - 2.0 * centre + after
        crest = 0.0 if bend >= 0.0 else (after - before) ** 2 / (8.0 * -bend)
        # A cell's value stands for its centre, half a cell from the edge, up to the same bias as above.
        return float(centre + (0.125 - _PEAK_BIAS) * bend + crest)

    def _at_mid_width(self, field: FloatArray) -> FloatArray:
        """Values at y = 0 from the cell means next to it, by a parabola across mid-width."""
        y = self.grid.y_edges
        if self.grid.symmetric_y:
            if y.size < 3:
                return np.asarray(field[:, 0])
            moments = (y[1:3] ** 2 + y[1:3] * y[:2] + y[:2] ** 2) / 3.0
            values = (field[:, 0] * moments[1] - field[:, 1] * moments[0]) / (moments[1] - moments[0])
            return np.asarray(np.maximum(values, 0.0))
        count = field.shape[1]
        first = int(np.clip(np.searchsorted(y, 0.0) - 2, 0, max(count - 4, 0)))
        cells = slice(first, min(first + 4, count))
        edges = y[first : cells.stop + 1] / (y[-1] - y[0])
        # the polynomial with these cell means, at y = 0: weights that give the means of 1, y, y², … their values there
        powers = np.arange(1.0, edges.size)[:, None]
        means = (edges[1:] ** powers - edges[:-1] ** powers) / (powers * np.diff(edges))
        weights = np.linalg.solve(means, np.eye(edges.size - 1)[0])
        return np.asarray(np.maximum(field[:, cells] @ weights, 0.0))


@dataclass(frozen=True, kw_only=True)
class PatchSolution(PatchPressure):
    """Pressure over a patch at a given approach, with its energy ∫ F dδ, N·mm."""

    energy: float


def solve_patch(
    grid: PatchGrid, separation: FloatArray, contact_modulus: float, approach: float, *, start: BoolArray | None = None
) -> PatchSolution:
    """Return the pressure over a patch at an approach, mm, from the mean separations of its cells, mm, (nx, ny), and E*, MPa."""
    penetration = (approach - separation.ravel()) * grid.areas.ravel()
    solution = solve_unilateral_contact(
        grid.influence, penetration / (1.0 / (np.pi * contact_modulus)), start=None if start is None else start.ravel()
    )
    pressure = solution.pressure
    energy = 0.5 * grid.images * float(pressure @ penetration)
    return PatchSolution(grid=grid, pressure=pressure.reshape(grid.shape), energy=energy)


def expected_half_width(length: float, effective_radius: float, approach: float) -> float:
    """Return a first guess of the half-width of an uncrowned contact, mm: 1 to 4 % high for λ > 3, 16 % at λ = 0.3."""
    scale = float(np.sqrt(effective_radius * approach))
    slenderness = length / scale
    # b²/(ρδ) = 4/(2 ln(2λ/b̂) + 1), iterated; short patches tend to the footprint of the undeformed bodies, √2.
    ratio = 0.7
    for _ in range(20):
        ratio = float(np.sqrt(4.0 / (2.0 * np.log1p(2.0 * slenderness / ratio) + 1.0 + 1.0 / (1.0 + slenderness))))
    return min(ratio, 1.3) * scale


def solve_cylinder_patch(
    length: float,
    effective_radius: float,
    contact_modulus: float,
    approach: float,
    *,
    relief: ReliefFunction | None = None,
    cells: int = 16,
    half_width: float | None = None,
    grading: float | None = None,
    end_factor: float = 0.0,
    start: PatchSolution | None = None,
) -> PatchSolution:
    """Return the contact of two cylinders, symmetric in x and y, on a quarter grid fitted to the half-width; mm and MPa.

    By default the half-width is that of a grid of half as many `cells`, whose solution may be given as `start`; `relief` is even
    along the width, `end_factor` weighs images in free ends at ±length/2.
    """
    slenderness = length / float(np.sqrt(effective_radius * approach))
    exponent = end_grading(slenderness) if grading is None else grading

    def solve_on(edge: float, count: int, before: PatchSolution | None) -> PatchSolution:
        fitted = edge * (1.0 + _SHORT_EDGE / slenderness)
        grid = PatchGrid.fitted(length, fitted, cells=count, grading=exponent, end_factor=end_factor)
        x = grid.x_edges
        means = (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / (6.0 * effective_radius)
        along = np.zeros(count) if relief is None else relief(gauss_points(grid.y_edges)) @ GAUSS_WEIGHTS / 2.0
        guess = None if before is None else np.repeat(np.repeat(before.contact, 2, axis=0), 2, axis=1)
        if guess is not None and guess.shape != grid.shape:
            guess = None
        return solve_patch(grid, means[:, None] + along[None, :], contact_modulus, approach, start=guess)

    if half_width is None:
        half_width = expected_half_width(length, effective_radius, approach)
        for _ in range(3):
            start = solve_on(half_width, max(cells // 2, 6), None)
            if start.half_width <= 0.0:
                break
            settled = abs(start.half_width / half_width - 1.0) < 2e-3
            half_width = start.half_width
            if settled:
                break
    return solve_on(half_width, cells, start)


def extrapolate(
    solve: Callable[..., PatchSolution], cells: int, half_width: float, energy_gain: float, field_gain: float
) -> tuple[float, ...]:
    """Return energy, load, mid-width pressure and half-width on cells of no size: Richardson's gains 1/(2ᵖ − 1), two grids."""
    coarse = solve(cells=cells // 2, half_width=half_width)
    fine = solve(cells=cells, half_width=half_width, start=coarse)
    gains = {"energy": energy_gain, "load": energy_gain, "mid_pressure": field_gain, "half_width": field_gain}
    pairs = ((getattr(fine, name), getattr(coarse, name), gain) for name, gain in gains.items())
    return tuple(value + gain * (value - before) for value, before, gain in pairs)
