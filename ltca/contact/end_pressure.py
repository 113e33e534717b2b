"""The largest pressure of a contact, the largest mean over a hundredth of the length, and its ratio to that at mid-width.

The half-space pressure at the end of an unrelieved roller is singular and would depend on the end cell.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact.contact_kind import CELLS, ContactKind
from ltca.contact.fitted_grid import solve_fitted
from ltca.contact.pressure_cells import PatchPressure, expected_half_width

TABLE = Path(__file__).with_name("end_pressure.json")
_NODES = 19
_LONGEST, _SHORTEST = 3.0e3, 1.0
_APPROACHES, _RADII = 9, 3
_LIGHTEST = 1e-2  # by the largest approach: lighter contacts take the ratio there


def largest_pressure(solved: PatchPressure, stretch: float) -> float:
    """Return the largest mean pressure over a stretch along the width, mm, of a patch symmetric about mid-width, MPa."""
    edges = solved.grid.y_edges
    end = float(edges[-1])
    stretch = min(stretch, end)
    # ∫ p dy from mid-width is piecewise linear: its differences over the stretch are exact means.
    sums = np.zeros((solved.pressure.shape[0], edges.size))
    np.cumsum(solved.pressure * np.diff(edges), axis=1, out=sums[:, 1:])
    starts = np.unique(np.clip(np.concatenate([edges, edges - stretch]), 0.0, end - stretch))
    means = [(np.interp(starts + stretch, edges, row) - np.interp(starts, edges, row)) / stretch for row in sums]
    return max(float(np.max(means)), solved.mid_pressure)


def _ratio(kind: ContactKind, approach: float, radius: float) -> float:
    solved = solve_fitted(kind, approach, radius, lambda x: x**2 / (2.0 * radius))
    return largest_pressure(solved, kind.end_cell) / solved.mid_pressure


def tabulate_cylinder_ratio(cells: int) -> tuple[FloatArray, FloatArray]:
    """Return ascending nodes of ln(L/√(ρδ)) and the ratio of cylinders there, on grids of `cells` over half-width and length."""
    kind = ContactKind(length=1.0, contact_modulus=1.0, generator=None, symmetric=True, cells=cells)
    nodes = np.linspace(np.log(_SHORTEST), np.log(_LONGEST), _NODES)
    return nodes, np.array([_ratio(kind, float(np.exp(-node)), float(np.exp(-node))) for node in nodes])


@cache
def _cylinder_ratio(cells: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and ratio as they ship with the package (made by `validation.shipped_tables`); solved for other numbers of cells."""
    if cells != CELLS:
        return tabulate_cylinder_ratio(cells)
    stored = json.loads(TABLE.read_text(encoding="utf-8"))
    return np.array(stored["nodes"]), np.array(stored["ratio"])


def find_cylinder_ratio(kind: ContactKind, half_width: FloatArray) -> FloatArray:
    """Return the ratio of the largest pressure of an end to that of its line, by the half-width of the line, mm; 1 where open."""
    nodes, values = _cylinder_ratio(kind.cells)
    # The half-width of every node by the length: that of a line with the length as datum, as long lines have.
    slenderness = np.exp(nodes)
    by_length = np.array([expected_half_width(1.0, 1.0 / each, 1.0 / each) for each in slenderness])
    width = np.maximum(half_width, 1e-300) / kind.length
    return np.asarray(np.where(half_width > 0.0, np.interp(-np.log(width), -np.log(by_length), values), 1.0))


def largest_pressure_ratio(kind: ContactKind, approach: FloatArray, effective_radius: FloatArray) -> FloatArray:
    """Return the ratio of the largest pressure to that at mid-width, 1 where open, by δ, mm, (positions, pairs), and ρ, mm."""
    ratio, closed = np.ones(approach.shape), approach > 0.0
    if not np.any(closed):
        return ratio
    delta, rho = approach[closed], np.broadcast_to(effective_radius, approach.shape)[closed]
    if kind.generator is None:
        nodes, values = _cylinder_ratio(kind.cells)
        ratio[closed] = np.interp(np.log(kind.length) - 0.5 * np.log(rho * delta), nodes, values)
        return ratio
    approaches = np.linspace(np.log(_LIGHTEST * delta.max()), np.log(delta.max()), _APPROACHES)
    count = _RADII if rho.max() / rho.min() > 1.01 else 1
    radii = np.linspace(np.log(rho.min()), np.log(rho.max()), count)
    table = np.array([[_ratio(kind, float(np.exp(d)), float(np.exp(r))) for d in approaches] for r in radii])
    along = np.array([np.interp(np.log(delta), approaches, row) for row in table])
    place = np.interp(np.log(rho), radii, np.arange(count))
    lower = place.astype(np.intp).clip(0, max(count - 2, 0))
    part, columns = place - lower, np.arange(delta.size)
    upper = np.minimum(lower + 1, count - 1)
    ratio[closed] = (1.0 - part) * along[lower, columns] + part * along[upper, columns]
    return ratio
