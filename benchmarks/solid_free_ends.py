"""Free ends of a straight line: solid bodies against half-spaces and images, flush and with one body that goes on.

``python benchmarks/solid_free_ends.py`` presses the roller of the manual's page ``solid_free_end`` on a flat, once with both ends
flush and once with a flat that is 8 mm longer at either end, and prints pressures by that in the middle at places inside the end.
One longer body is held against images with half the factor, its share of the compliance.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

sys.path[0] = str(Path(__file__).resolve().parents[1])

from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.solved_pair import PairLoad, PairMeshes, solve_pair
from ltca.contact.free_end import guilbault_factor
from ltca.contact.pressure_cells import PatchSolution, solve_cylinder_patch
from validation.manual.solid_pairs import (
    INSIDE,
    LINE_LENGTH,
    LINE_LOAD,
    LINE_RADIUS,
    MODULUS,
    STEEL,
    ends_of_images,
    ends_of_solids,
)

BEYOND = 8.0
"""By how much the longer body goes on at either end, mm."""


def press_grid(end_factor: float, cells: int) -> PatchSolution:
    """Press the line on half-spaces with images of a factor, 0 for none."""

    def at(approach: float) -> PatchSolution:
        return solve_cylinder_patch(LINE_LENGTH, LINE_RADIUS, MODULUS, approach, cells=cells, end_factor=end_factor)

    return at(float(brentq(lambda each: at(each).load - LINE_LOAD, 3e-3, 2e-2, xtol=1e-7)))


def press_solids(carrier_length: float, size: float) -> list[float]:
    """Press the line on a flat of a length, mm."""
    pair = SolidPair.round_bodies(LINE_RADIUS, 0.0, STEEL, LINE_LENGTH, carrier_length=carrier_length)
    return ends_of_solids(solve_pair(pair, PairLoad(load=LINE_LOAD), PairMeshes(size=size, block=12.0)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--size", type=float, default=2.0, help="element edge by an eighth of the half-width; default 2"
    )
    parser.add_argument("--cells", type=int, default=24, help="cells of the grids over the half-width; default 24")
    arguments = parser.parse_args()
    print(f"{'':<26}" + "".join(f"{f'{place:g} b':>8}" for place in INSIDE) + f"{'K_Hβ':>8}")

    def row(name: str, values: list[float]) -> None:
        print(f"{name:<26}" + "".join(f"{value:>8.3f}" for value in np.asarray(values)), flush=True)

    law = guilbault_factor(STEEL.poisson_ratio)
    for name, factor in (
        ("half-spaces", 0.0),
        ("images, 1", 1.0),
        ("images, law", law),
        ("images, half the law", 0.5 * law),
    ):
        row(name, ends_of_images(press_grid(factor, arguments.cells)))
    row("solid, both flush", press_solids(LINE_LENGTH, arguments.size))
    row("solid, one goes on", press_solids(LINE_LENGTH + 2.0 * BEYOND, arguments.size))


if __name__ == "__main__":
    main()
