"""Makes the tables of cylinders that ship with the package, from solutions on contact grids.

    OPENBLAS_NUM_THREADS=1 python -m validation.shipped_tables

writes those of `ltca.laws.line_contact`, `ltca.contact.end_pressure` and `ltca.laws.sliced_line` anew;
``tests/validation/test_shipped_tables.py`` compares. That takes some seconds, which every process would spend, and other
processors would find other last digits.

The nodes of the line contact are solutions of `ltca.contact.pressure_cells` on two grids, extrapolated to zero cell size
(Richardson) with the orders measured in ``tests/analytic/test_line_contact_table.py``. The softer ends of contacts in slices
follow from that law: they give an aligned straight line its load, for every number of slices.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable
from dataclasses import asdict
from functools import partial

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact import end_pressure
from ltca.contact.contact_kind import CELLS as TRACKED_CELLS
from ltca.contact.pressure_cells import expected_half_width, extrapolate, solve_cylinder_patch
from ltca.drive.members.width import FEWEST_SLICES, MOST_SLICES
from ltca.laws import line_contact, sliced_contact, sliced_line
from ltca.laws.line_contact import LONGEST, SHORTEST, LineContactLaw, LineContactTable
from ltca.laws.slenderness_curve import SlendernessCurve, quintic_spline_pieces
from ltca.laws.sliced_contact import SlicedContact
from ltca.laws.sliced_line import SlicedLine

NODES = 31
CELLS = 16
NUMBERS = tuple(range(FEWEST_SLICES, MOST_SLICES + 1, 2))
"""Numbers of slices that have a table."""
_END_NODES = 65
_LONGEST_CUT, _SHORTEST_CUT = 5.0e4, 4.0
"""L/√(ρδ) at the ends of the lines that give the softer ends."""
_WIDEST_SLICED = 8.0
"""Half-width by the length of a slice about up to which they are found: loads of narrower slices hardly settle."""
_END_REACH = 0.05
_END_DIGITS = 7
_END_PASSES = 3
# Orders of convergence when both cell counts are doubled, as measured: energy 2.7, half-width and pressure 2.2 to 2.9.
_ENERGY_GAIN = 1.0 / (2.0**2.7 - 1.0)
_FIELD_GAIN = 1.0 / (2.0**2.4 - 1.0)


def tabulate_line_contact(
    cells: int = CELLS, nodes: int = NODES, shortest: float = SHORTEST, longest: float = LONGEST
) -> LineContactTable:
    """Solve the dimensionless table on contact grids.

    `cells` are those over the half-width and over half the length on the finer grid, the coarser has half as many; `nodes` are
    uniform in ln λ between `longest` and `shortest` λ = L/√(ρδ).
    """
    places = np.linspace(-2.0 * np.log(longest), -2.0 * np.log(shortest), nodes)
    rows = np.empty((nodes, 3))
    for row, place in zip(rows, places, strict=True):
        slenderness = float(np.exp(-0.5 * place))
        half_width = expected_half_width(slenderness, 1.0, 1.0)
        for _ in range(2):
            guess = solve_cylinder_patch(slenderness, 1.0, 1.0, 1.0, cells=cells // 2, half_width=half_width)
            half_width = guess.half_width
        solve = partial(solve_cylinder_patch, slenderness, 1.0, 1.0, 1.0)
        energy, _, *fields = extrapolate(solve, cells, half_width, _ENERGY_GAIN, _FIELD_GAIN)
        row[:] = energy / slenderness, *fields
    stored, pressure, half_width_ratio = rows.T
    # A slender contact has δ = q/(π E*) (ln 1/δ + …), so δ E* L/F → −X/π, b² = 4 F ρ/(π E* L) and p = E* b/(2ρ).
    return LineContactTable(
        inverse_energy=_through(places, 1.0 / stored, 2.0 / np.pi),
        inverse_square_pressure=_through(places, pressure**-2, 1.0),
        inverse_square_half_width=_through(places, half_width_ratio**-2, 0.25),
    )


def _through(nodes: FloatArray, values: FloatArray, light_slope: float) -> SlendernessCurve:
    """Curve through positive values at uniform nodes."""
    return SlendernessCurve(float(nodes[0]), float(nodes[1] - nodes[0]), quintic_spline_pieces(values), light_slope)


def tabulate_softer_ends(slices: int, nodes: int = _END_NODES) -> FloatArray:
    """Return by how much the end slices of a line of so many are softer, at `ltca.laws.sliced_line.places`.

    An aligned straight line then has the load of `ltca.laws.line_contact`, found at so many L/√(ρδ) `nodes`.
    """
    from scipy.interpolate import make_interp_spline
    from scipy.optimize import brentq

    law = LineContactLaw(1.0, 1.0)
    relief, knots = np.zeros((slices, sliced_contact.POINTS)), sliced_line.places()
    table = np.full(knots.size, 0.1)
    for _ in range(_END_PASSES):
        # The width of the ends follows the loads, and ε with it: the curve of the last pass is shifted as a whole.
        pieces = quintic_spline_pieces(table)
        found, shift = [], 0.0
        for slenderness in np.geomspace(_LONGEST_CUT, max(_SHORTEST_CUT, slices / _WIDEST_SLICED), nodes):
            approach = np.array(slenderness**-2)
            load = float(law.load_and_stiffness(approach, 1.0)[0])

            def press(by: float, approach: FloatArray = approach, pieces: FloatArray = pieces) -> SlicedContact:
                ends = pieces.copy()
                ends[0] += by
                line = SlicedLine(length=1.0, contact_modulus=1.0, slices=slices, relief=relief, ends=ends)
                return line.respond(approach, np.array(0.0), np.array(1.0))

            def left(by: float, load: float = load, press: Callable[[float], SlicedContact] = press) -> float:
                return float(press(by).load) / load - 1.0

            reach = _END_REACH
            while left(shift - reach) * left(shift + reach) > 0.0:
                reach *= 2.0
            shift = brentq(left, shift - reach, shift + reach, xtol=1e-12)
            carried = press(shift).slice_load
            mean = (carried**2).sum() / carried.sum() * slices
            place = 0.5 * np.log(4.0 * mean / np.pi) + np.log(slices)
            at = (place - knots[0]) / (knots[1] - knots[0])
            piece = int(np.clip(at, 0, knots.size - 2))
            found.append((place, float(np.polyval(pieces[::-1, piece], at - piece)) + shift))
        place, values = np.array(sorted(found)).T
        table = make_interp_spline(place, values, k=3)(knots.clip(place[0], place[-1]))
    return np.asarray(table.round(_END_DIGITS))


def write_tables() -> None:
    """Write the tables into the package."""
    ratio = dict(zip(("nodes", "ratio"), end_pressure.tabulate_cylinder_ratio(TRACKED_CELLS), strict=True))
    contents = {
        line_contact.TABLE: asdict(tabulate_line_contact()),
        end_pressure.TABLE: ratio,
        sliced_line.TABLE: {"softer": {str(slices): tabulate_softer_ends(slices) for slices in NUMBERS}},
    }
    for path, content in contents.items():
        path.write_text(json.dumps(content, indent=0, default=np.ndarray.tolist) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    argparse.ArgumentParser(description="Writes the tables of cylinders that ship with the package anew.").parse_args()
    if os.environ.get("OPENBLAS_NUM_THREADS") != "1":
        raise SystemExit("set OPENBLAS_NUM_THREADS=1: the last digits of the tables depend on it")
    write_tables()
