"""Contacts in slices against half-space grids: load, moment and largest pressure of lines that tilt, and how they converge.

    OPENBLAS_NUM_THREADS=1 python benchmarks/width.py

prints the tables of ``docs/theory/width.md``: one steel contact 12 mm long at three slendernesses, straight and crowned, from the
full line to a corner that carries alone. Errors are those of n slices in % of the grid's load, of its moment (of a sixth of load
times length where that is more) and of its largest pressure; the grid's own is what it changes from 12 to 20 cells.
"""

from __future__ import annotations

import numpy as np

from ltca.contact.length_profile import CircularCrown, SummedProfile
from ltca.contact.tilted_grid import press_tilted
from ltca.contact.tracked_grid import ContactKind, Separation
from ltca.errors import ConvergenceError
from ltca.laws.sliced_line import SlicedLine, slice_heights
from ltca.laws.width_pressure import estimate_along_width, solve_along_width

LENGTH, MODULUS = 12.0, 115e3
SLICES = (5, 9, 17, 33)
SLENDER = ((3.0, 3e-3), (20.0, 3e-3), (20.0, 0.02), (60.0, 0.05))
"""Effective radius and approach of the aligned line, mm: L/b of 232, 83, 30 and 9."""
STRAIGHT = {
    "aligned": (1.0, 0.0), "one end half as deep": (1.0, 1.0 / 3.0), "one end just out": (1.0, 1.0),
    "3/4 of the line": (1.0, 2.0), "1/2": (0.0, 1.0), "3/8": (-0.5, 2.0), "1/4": (-1.0, 2.0), "1/8": (-1.5, 2.0),
}  # fmt: skip
"""Approach in the middle and what the tilt adds at the end, both by the approach of the aligned line."""
CROWNED = {
    "drop = δ, aligned": (1.0, 1.0, 0.0), "drop = δ, tilted": (1.0, 1.0, 0.5), "drop = δ, on its end": (1.0, 1.0, 2.0),
    "drop = 4 δ, aligned": (4.0, 1.0, 0.0), "drop = 4 δ, tilted": (4.0, 1.0, 2.0),
}  # fmt: skip
"""Crown drop, approach and tilt likewise."""


def contact_kind(drop: float, cells: int) -> ContactKind:
    """Return the kind of a contact with a crown drop, mm."""
    profile = None
    if drop > 0.0:
        profile = SummedProfile(
            length=LENGTH, parts=(CircularCrown(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * drop)),)
        )
    return ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=profile, symmetric=True, cells=cells)


def print_case(name: str, radius: float, drop: float, approach: float, tilt: float) -> None:
    """Print one line of the table."""
    given = [np.array([value]) for value in (approach, tilt, radius)]
    separation = Separation(effective_radius=radius, departure=lambda _, x: x**2 / (2.0 * radius))
    found = {cells: press_tilted(contact_kind(drop, cells), separation, approach, tilt) for cells in (12, 20)}
    coarse, fine = found[12], found[20]
    if coarse is None or fine is None:
        return
    peak = {cells: solve_along_width(contact_kind(drop, cells), *given).largest[0] for cells in (12, 20)}
    arm = max(abs(fine.moment), fine.load * LENGTH / 6.0)
    numbers = [
        f"{100.0 * (coarse.load / fine.load - 1.0):+.2f} {100.0 * (coarse.moment - fine.moment) / arm:+.2f} "
        f"{100.0 * (peak[12] / peak[20] - 1.0):+.1f}"
    ]
    kind = contact_kind(drop, 12)
    for slices in SLICES:
        line = SlicedLine(
            length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=kind.relief(slice_heights(LENGTH, slices))
        )
        try:
            contact = line.respond(*given)
        except ConvergenceError:
            numbers.append("does not settle")
            continue
        largest = estimate_along_width(kind, contact, given[2]).largest[0]
        numbers.append(
            f"{100.0 * (contact.load[0] / fine.load - 1.0):+.2f} {100.0 * (contact.moment[0] - fine.moment) / arm:+.2f} "
            f"{100.0 * (largest / peak[20] - 1.0):+.1f}"
        )
    print(f"| {name} | " + " | ".join(numbers) + " |")


def main() -> None:
    """Print the tables."""
    for radius, deep in SLENDER:
        half_width = 0.5 * np.sum(np.diff(_active_width(radius, deep)))
        print(
            f"\nρ = {radius} mm, δ = {1e3 * deep:g} µm, L/b = {LENGTH / half_width:.0f}: load moment largest pressure, %\n"
        )
        print("| case | grid's own | " + " | ".join(f"n = {slices}" for slices in SLICES) + " |")
        print("|---|---|" + "---|" * len(SLICES))
        for name, (middle, tilt) in STRAIGHT.items():
            print_case(name, radius, 0.0, middle * deep, 2.0 * tilt * deep / LENGTH)
        for name, (drop, middle, tilt) in CROWNED.items():
            print_case(name, radius, drop * deep, middle * deep, 2.0 * tilt * deep / LENGTH)


def _active_width(radius: float, deep: float) -> np.ndarray:
    """Edges of the contact of the aligned line, mm."""
    from ltca.laws.line_contact import LineContactLaw

    half = float(LineContactLaw(LENGTH, MODULUS).half_width(deep, radius))
    return np.array([-half, half])


if __name__ == "__main__":
    main()
