"""Shapes of the contact grids, in steps of half-width and reach.

Half-width and reach of a contact are rounded to steps of 5 % (rungs), so one small set of influence matrices serves all
contacts. The rung follows from the half-width *expected* at the approach, never from earlier solutions.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from ltca.arrays import BoolArray, freeze
from ltca.contact.pressure_cells import PatchGrid, expected_half_width, graded_edges
from ltca.contact.unilateral import solve_unilateral_contact
from ltca.geometry.length_profile import SummedProfile

RUNG = 0.05
"""Step of the ladder in ln(half-width)."""
BLEND = 0.05
"""Part of a rung about each boundary over which the grids on both sides are blended for a load that is continuous with its slope:
their loads differ by 1e-4, so blending adds 1 % to the slope, and one contact in twenty costs two grids."""
SHADES = 5
"""Steps per rung of the half-width by which initial contact cells of cylinders are cached."""

END_GRADING = 2.5
"""Grading of the cells along an unrelieved length (`ltca.contact.pressure_cells.graded_edges`): the singular end then
errs by 1e-4 in the load with 12 cells."""
_ROOM = 1.6  # an unrelieved end bulges by up to 1.56 of the half-width at mid-width (ltca.contact.pressure_cells)
FREE_GRADING = 1.25
"""The same of contacts that end within a profile, where pressure falls to zero by itself."""


class GridRung(NamedTuple):
    """Shape of a grid, see `unit_grid`."""

    rung: int
    reach_rung: int


@cache
def unit_grid(rung: int, reach_rung: int, *, cells: int, symmetric: bool) -> PatchGrid:
    """Return the grid of unit length on a rung; its influence matrix is kept with it.

    `rung` is ln(half-width/length) in steps of `RUNG`; `reach_rung` is ln(body length/patch length) in such steps, for a
    profiled contact that ends before the body does. `cells` are those over the half-width and over half the length; `symmetric`
    grids have the positive half in x only.
    """
    half_width = float(np.exp(rung * RUNG))
    share = float(np.exp(-8.0 * reach_rung * RUNG))
    grading = FREE_GRADING + share * (END_GRADING - FREE_GRADING)
    count = int(np.ceil(_ROOM * cells))
    x = half_width / cells * np.arange(count + 1.0)
    return PatchGrid(
        x_edges=x if symmetric else np.concatenate([-x[:0:-1], x]),
        y_edges=graded_edges(1.0, cells, grading),
        symmetric_x=symmetric,
    )


def smooth_step(part: float) -> float:
    """Return 0 below 0, 1 above 1, and 3 t² − 2 t³ between."""
    part = min(max(part, 0.0), 1.0)
    return part * part * (3.0 - 2.0 * part)


def find_reach_place(length: float, generator: SummedProfile | None, approach: float) -> float:
    """Return ln(body length/overlap) in rungs: how far a profiled contact ends before the body does."""
    if generator is None:
        return 0.0
    return max(0.0, float(np.log(0.5 * length / generator.overlap_half_length(approach))) / RUNG)


def find_width_place(length: float, reach_rung: int, effective_radius: float, approach: float) -> float:
    """Return ln(expected half-width/patch length) in rungs."""
    patch = find_patch_length(length, reach_rung)
    return float(np.log(expected_half_width(patch, effective_radius, approach) / patch)) / RUNG


def find_patch_length(length: float, reach_rung: int) -> float:
    """Return the length of the patch on a rung of its reach, mm."""
    return length * float(np.exp(-reach_rung * RUNG))


@cache
def find_cylinder_cells(width: int, rung: int, cells: int, symmetric: bool) -> BoolArray:
    """Return the contact cells of a cylinder on the grid of `unit_grid`, to start from.

    `width` is ln(expected half-width/length) in steps of `RUNG` / `SHADES`.
    """
    half_width = float(np.exp(width * RUNG / SHADES))
    size = half_width  # √(ρδ)
    for _ in range(10):
        size *= half_width / expected_half_width(1.0, size, size)
    grid = unit_grid(rung, 0, cells=cells, symmetric=True)
    x = grid.x_edges
    separation = (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / (6.0 * size)
    found = solve_unilateral_contact(
        grid.influence,
        ((size - separation)[:, None] * grid.areas).ravel(),
        start=np.repeat(grid.x_centres < half_width, grid.shape[1]),
    ).active.reshape(grid.shape)
    return freeze((found if symmetric else np.concatenate([found[::-1], found])).ravel())
