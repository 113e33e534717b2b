"""Pressures of contacts along their width: over the heights, the largest anywhere with its place, and at the ends.

From slices the pressure is p = E* b/(2ρ) of each line load, at ends that carry times the ratio of aligned ends; else of grids.
Pressures are means over a hundredth of the length, as that of half-spaces at an unrelieved end is singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.contact.contact_kind import ContactKind
from ltca.contact.end_pressure import find_cylinder_ratio
from ltca.contact.free_end import FreeEnds, remaining_bulge
from ltca.contact.hertz import line_half_width
from ltca.contact.pressure_cells import PatchPressure
from ltca.laws.sliced_contact import slice_heights, slice_means
from ltca.laws.sliced_line import SlicedLine

NODES = 61
"""Aligned straight lines between which others are interpolated."""
PEAK_BY_BULGE = 1.45
"""Power of what images leave of the bulge at an end with which its peak goes: grids have 1.25 to 1.7."""
_PEAK_BIAS = 0.114
"""Of the first of n cells over a half-width, by 1/n² (`ltca.contact.pressure_cells`)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthPressures:
    """Pressures along the width of contacts, shape (…, heights), zero where open."""

    height: FloatArray  # z above the middle of the width, mm, shape (heights,)
    line_load: FloatArray  # N/mm
    even_line_load: FloatArray  # without the bulge of ends that carry; of grids the line load itself
    pressure: FloatArray  # largest over the profile at each height, MPa
    largest: FloatArray  # anywhere, ends included, MPa, shape (…)
    place: FloatArray  # its height, mm, shape (…)
    end_load: FloatArray  # line load at the lower and upper end, N/mm, shape (…, 2)


def estimate_along_width(kind: ContactKind, line_load: FloatArray, effective_radius: FloatArray) -> WidthPressures:
    """Return pressures at the middles of slices from line loads, N/mm, (…, slices, points), and effective radii, mm, (…)."""
    line = line_load
    radius = np.broadcast_to(effective_radius, line.shape[:-2])
    z = slice_heights(kind.length, line.shape[-2])
    even = slice_means(line)

    def pressure_of(load: FloatArray, more: int) -> FloatArray:
        return np.asarray(np.sqrt(kind.contact_modulus * load / (np.pi * radius[(..., *(None,) * more)])))

    inner = pressure_of(line, 2)
    # What the two slices at an end carry beyond the line is the bulge there, by aligned lines of as many slices.
    nodes, bulges = _end_bulges(line.shape[-2], kind.free_ends)
    size = kind.length / line.shape[-2]
    last, beside, curved = even[..., [0, -1]], even[..., [1, -2]], radius[..., None]
    outermost = np.stack((line[..., 0, 0], line[..., -1, -1]), axis=-1)
    own, second = last, beside
    for _ in range(3):
        wide = np.log(np.maximum(line_half_width(own, curved, kind.contact_modulus) / size, 1e-300))
        own, second = last / np.interp(wide, nodes, bulges[0]), beside / np.interp(wide, nodes, bulges[1])
    ends = np.where(outermost > 0.0, np.maximum(own + 0.5 * (own - second), 0.0), 0.0)
    # An end carries as one of a line that is even and long has its peak by the half-width there.
    half_width = line_half_width(ends, curved, kind.contact_modulus)
    peak = find_cylinder_ratio(kind, half_width) - 1.0
    if kind.free_ends:
        peak = peak * remaining_bulge(kind.free_ends, (half_width + kind.end_cell) / kind.length) ** PEAK_BY_BULGE
    at_ends = pressure_of(ends, 1) * (1.0 + peak)
    flat = inner.reshape(*radius.shape, line.shape[-2] * line.shape[-1])
    every = np.concatenate((flat, at_ends), axis=-1)
    places = np.concatenate((z.ravel(), (-0.5 * kind.length, 0.5 * kind.length)))
    top = np.argmax(every, axis=-1)
    closed = (even > 0.0).any(axis=-1)
    return WidthPressures(
        height=z.mean(axis=1),
        line_load=even,
        even_line_load=even / _bulges(kind, even, radius, ends > 0.0),
        pressure=pressure_of(even, 1),
        largest=np.take_along_axis(every, top[..., None], axis=-1)[..., 0],
        place=np.where(closed, places[top], 0.0),
        end_load=ends,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PatchAlongWidth:
    """A contact by its cells along the width: line load and largest pressure over the profile of each."""

    edges: FloatArray
    line_load: FloatArray
    peak: FloatArray
    half: float
    stretch: float

    @classmethod
    def of_patch(cls, patch: PatchPressure, kind: ContactKind) -> PatchAlongWidth:
        """Return those of a patch."""
        grid = patch.grid
        images = 2.0 if grid.symmetric_x else 1.0
        return cls(
            edges=grid.y_edges,
            line_load=images * float(grid.x_edges[1] - grid.x_edges[0]) * patch.pressure.sum(axis=0),
            peak=_peaks(patch.pressure, grid.symmetric_x),
            half=0.5 * kind.length,
            stretch=kind.end_cell,
        )

    def means(self, values: FloatArray, heights: FloatArray) -> FloatArray:
        """Return means over the stretch about heights, within the width."""
        start = (heights - 0.5 * self.stretch).clip(-self.half, self.half - self.stretch)
        sums = np.concatenate(([0.0], np.cumsum(values * np.diff(self.edges))))
        # Beyond the patch nothing carries.
        within = np.interp(start + self.stretch, self.edges, sums) - np.interp(start, self.edges, sums)
        return np.asarray(within / self.stretch)

    def largest(self) -> tuple[float, float]:
        """Return the largest mean over the stretch and the height of the largest; of equal ends the upper one."""
        starts = np.concatenate(
            (self.edges, self.edges - self.stretch, 0.5 * (self.edges[1:] + self.edges[:-1] - self.stretch))
        )
        middles = starts.clip(-self.half, self.half - self.stretch) + 0.5 * self.stretch
        means = self.means(self.peak, middles)
        top, ends = float(np.max(means)), self.means(self.peak, np.array((-self.half, self.half)))
        if np.max(ends) >= (1.0 - 1e-9) * top:
            return top, self.half if ends[1] > (1.0 - 1e-9) * top else -self.half
        # A parabola through the cells next to the largest.
        centres = 0.5 * (self.edges[1:] + self.edges[:-1])
        cell = int(np.argmax(self.peak).clip(1, self.peak.size - 2))
        bend, slope, _ = np.polyfit(centres[cell - 1 : cell + 2] - centres[cell], self.peak[cell - 1 : cell + 2], 2)
        away = -0.5 * slope / bend if bend < 0.0 else 0.0
        return top, float((centres[cell] + away).clip(self.edges[0], self.edges[-1]))


def _peaks(pressure: FloatArray, symmetric: bool) -> FloatArray:
    """Largest pressure over the profile in each column of cells, from cell means: those of a Hertz profile fall short of it."""
    if symmetric:
        # Cells over the half-width of each column, by its load and its peak: q = π p b/2.
        peak = pressure[0]
        cells = np.divide(4.0 * pressure.sum(axis=0), np.pi * peak, out=np.ones(peak.shape), where=peak > 0.0)
        return np.asarray(np.where(peak > 0.0, peak * (1.0 + _PEAK_BIAS / np.maximum(cells, 1.0) ** 2), 0.0))
    top = np.argmax(pressure, axis=0).clip(1, pressure.shape[0] - 2)
    columns = np.arange(pressure.shape[1])
    before, centre, after = (pressure[top + step, columns] for step in (-1, 0, 1))
    bend = before - 2.0 * centre + after
    crest = np.divide((after - before) ** 2, -8.0 * bend, out=np.zeros(bend.shape), where=bend < 0.0)
    return np.asarray(np.maximum(centre + (0.125 - _PEAK_BIAS) * bend + crest, pressure.max(axis=0)))


@cache
def _aligned_loads(slices: int, free_ends: tuple[FreeEnds, ...] = ()) -> tuple[FloatArray, FloatArray]:
    """ln(b/L) of the mean line load, and loads of the slices by their mean, of aligned straight lines, shape (nodes, slices)."""
    line = SlicedLine.straight(1.0, 1.0, slices, free_ends)
    # Up to lines four half-widths long, or slices a quarter of one.
    approach = np.geomspace(1e-8, min(1.0 / 16.0, 16.0 / slices**2), NODES)
    found = line.respond(approach, np.zeros(NODES), np.ones(NODES))
    return 0.5 * np.log(4.0 * found.load / np.pi), found.slice_load / found.load[:, None] * slices


@cache
def _end_bulges(slices: int, free_ends: tuple[FreeEnds, ...] = ()) -> tuple[FloatArray, FloatArray]:
    """Nodes of ln(b/l) in the middle, and loads of the two slices at an end by the middle one, (2, nodes)."""
    place, shares = _aligned_loads(slices, free_ends)
    middle = shares[:, slices // 2]
    return place + 0.5 * np.log(middle) + np.log(slices), shares[:, :2].T / middle


def _bulges(kind: ContactKind, line_load: FloatArray, radius: FloatArray, carries: BoolArray) -> FloatArray:
    """Load of slices of aligned lines of the same mean by the middle one; one towards ends that do not carry."""
    slices = line_load.shape[-1]
    nodes, shares = _aligned_loads(slices, kind.free_ends)
    mean = line_load.mean(axis=-1)
    wide = np.maximum(line_half_width(mean, radius, kind.contact_modulus) / kind.length, 1e-300)
    at = np.log(wide).clip(nodes[0], nodes[-1])
    before = np.clip(np.searchsorted(nodes, at) - 1, 0, nodes.size - 2)
    part = ((at - nodes[before]) / (nodes[before + 1] - nodes[before]))[..., None]
    bulge = (1.0 - part) * shares[before] + part * shares[before + 1]
    bulge /= bulge[..., slices // 2, None]
    upper = np.arange(slices) > slices // 2
    return np.where(np.where(upper, carries[..., 1:], carries[..., :1]), bulge, 1.0)
