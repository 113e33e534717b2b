"""Contact grids that fit: shapes in steps of half-width and reach, and the pressure of a contact on the one that fits it best.

Influence matrices depend on the shape of a grid alone: half-width and reach are rounded to steps of 5 % (rungs), so that few
serve all contacts of a drive. The rung follows from the half-width expected at the approach, not from earlier solutions.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.contact.contact_kind import ContactKind, Departure, Separation
from ltca.contact.pressure_cells import (
    GAUSS_WEIGHTS,
    PatchGrid,
    PatchPressure,
    ReliefFunction,
    expected_half_width,
    gauss_points,
    mirrored,
    solve_patch,
)
from ltca.geometry.length_profile import Relief

RUNG = 0.05
"""Step of the ladder in ln(half-width)."""
BLEND = 0.05
"""Part of a rung about each boundary over which grids are blended: loads, which differ by 1e-4, keep a continuous slope."""
SHADES = 5
"""Steps per rung of the half-width by which initial contact cells of cylinders are kept."""
END_GRADING = 2.5
"""Grading of the cells along an unrelieved length (`graded_edges`): the singular end errs by 1e-4 in the load with 12 cells."""
FREE_GRADING = 1.25
"""The same of contacts that end within a profile, where pressure falls to zero by itself."""
FIT = 0.08
"""Largest error of ln(half-width) of the rung on which `solve_fitted` accepts a contact."""


class GridRung(NamedTuple):
    """Shape of a grid in steps of `RUNG`: ln(half-width/length), and ln(body length/patch length) of profiles that end before."""

    rung: int
    reach_rung: int


@cache
def unit_grid(rung: GridRung, cells: int, symmetric: bool) -> PatchGrid:
    """Return the grid of unit length on a rung for contacts of a kind; its influence matrix is kept with it."""
    half_width = float(np.exp(rung.rung * RUNG))
    share = float(np.exp(-8.0 * rung.reach_rung * RUNG))
    grading = FREE_GRADING + share * (END_GRADING - FREE_GRADING)
    grid = PatchGrid.fitted(1.0, half_width, cells=cells, grading=grading)
    return grid if symmetric else replace(grid, x_edges=mirrored(grid.x_edges), symmetric_x=False)


def smooth_step(part: float) -> float:
    """Return 0 below 0, 1 above 1, and 3 t² − 2 t³ between."""
    part = min(max(part, 0.0), 1.0)
    return part * part * (3.0 - 2.0 * part)


def find_reach_place(length: float, generator: Relief | None, approach: float) -> float:
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


def expected_cells(kind: ContactKind, rung: GridRung, effective_radius: float, approach: float) -> BoolArray:
    """Return contact cells to start from on the grid of a rung, shape (nx, ny): of a cylinder of the expected half-width."""
    if kind.generator is None:
        width = round(SHADES * find_width_place(kind.length, rung.reach_rung, effective_radius, approach))
        return _cylinder_cells(width, rung, kind.cells, kind.symmetric)
    grid = unit_grid(rung, kind.cells, kind.symmetric)
    return np.repeat(np.abs(grid.x_centres) < np.exp(rung.rung * RUNG), grid.shape[1]).reshape(grid.shape)


@cache
def _cylinder_cells(width: int, rung: GridRung, cells: int, symmetric: bool) -> BoolArray:
    grid, half_width = unit_grid(rung, cells, True), float(np.exp(width * RUNG / SHADES))
    size = half_width  # √(ρδ)
    for _ in range(10):
        size *= half_width / expected_half_width(1.0, size, size)
    x = grid.x_edges
    separation = np.repeat((x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / (6.0 * size), grid.shape[1])
    start = np.repeat(np.abs(grid.x_centres) < half_width, grid.shape[1])
    found = solve_patch(grid, separation, 1.0, size, start=start).contact
    return found if symmetric else np.concatenate([found[::-1], found])


def unit_separations(
    grid: PatchGrid, separation: Separation, length: float, relief: ReliefFunction, middle: float = 0.0
) -> FloatArray:
    """Return the mean separation of every cell of a patch of a length about `middle`, by the length, shape (cells, places)."""
    points = gauss_points(grid.x_edges)
    units = np.empty((*grid.shape, separation.weights.size))
    for number in range(units.shape[2]):
        along_x = separation.departure(separation.place + number, points * length) @ GAUSS_WEIGHTS / (2.0 * length)
        units[..., number] = along_x[:, None]
    heights = middle + length * gauss_points(grid.y_edges)
    units += (relief(heights) @ GAUSS_WEIGHTS / (2.0 * length))[None, :, None]
    return units.reshape(-1, units.shape[2])


def solve_fitted(kind: ContactKind, approach: float, effective_radius: float, departure: Departure) -> PatchPressure:
    """Return the pressure over a contact on the grid that fits its half-width; approach, effective radius and departure in mm."""
    separation = Separation(effective_radius=effective_radius, departure=lambda _, x: departure(x))
    reach = int(np.floor(find_reach_place(kind.length, kind.generator, approach)))
    length = find_patch_length(kind.length, reach)
    rung = GridRung(round(find_width_place(kind.length, reach, effective_radius, approach)), reach)
    start = expected_cells(kind, rung, effective_radius, approach)
    for trial in range(2):
        grid = unit_grid(rung, kind.cells, kind.symmetric)
        unit = unit_separations(grid, separation, length, kind.aligned_relief).reshape(grid.shape)
        solved = solve_patch(grid, unit, 1.0, approach / length, start=start)
        place = float(np.log(max(solved.half_width, 1e-300))) / RUNG
        if trial or solved.half_width <= 0.0 or abs(place - rung.rung) * RUNG <= FIT:
            break
        rung, start = GridRung(round(place), reach), solved.contact
    return PatchPressure(grid=grid.scaled(length), pressure=kind.contact_modulus * solved.pressure)
