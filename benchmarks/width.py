"""Contacts in slices against half-space grids: load, moment and largest pressure of lines that tilt, and how they converge.

    OPENBLAS_NUM_THREADS=1 python benchmarks/width.py [--order]

prints the tables of ``docs/theory/width.md``: one steel contact 12 mm long at three slendernesses, straight and crowned, from the
full line to a corner that carries alone. Errors are those of n slices in % of the grid's load, of its moment (of a sixth of load
times length where that is more) and of its largest pressure; the grid's own is what it changes from 12 to 20 cells.

With `--order` nothing is solved on grids (seconds): the root of the mean square of what load, moment and largest pressure change
from each number of slices to the next, over contacts of one kind whose ends fall anywhere within a slice, in %, and the order of
the length of a slice: the slope of the changes up to 33 slices, on logarithmic scales.
"""

from __future__ import annotations

import argparse
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.tilted_grid import press_tilted
from ltca.errors import ConvergenceError
from ltca.geometry.length_profile import Relief
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.sliced_contact import slice_heights
from ltca.laws.sliced_line import SlicedLine
from ltca.laws.width_pressure import estimate_along_width
from validation.methods.grid_pressures import solve_along_width

LENGTH, MODULUS = 12.0, 115e3
SLICES = (5, 9, 17, 33)
FINER = (5, 9, 17, 33, 65)
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
MEMBERS, LEAST_CHANGE = 40, 0.01
"""Contacts of a kind, and the change in % that counts as none."""
REACHES = {"straight, 1/2 … 9/10 of the line": (0.5, 0.9), "straight, 1/4 … 1/2": (0.25, 0.5)}
"""Least and largest part of the line that carries."""
KINDS = ("aligned", "tilted, both ends carry", *REACHES, "crowned, aligned", "crowned, tilted")


def contact_kind(drop: float, cells: int) -> ContactKind:
    """Return the kind of a contact with a crown drop, mm."""
    profile = None
    if drop > 0.0:
        profile = Relief(length=LENGTH, crown_radius=LENGTH**2 / (8.0 * drop))
    return ContactKind(length=LENGTH, contact_modulus=MODULUS, generator=profile, symmetric=True, cells=cells)


def print_case(name: str, radius: float, drop: float, approach: float, tilt: float) -> None:
    """Print one line of the table."""
    delta, theta, rho = (np.array([value]) for value in (approach, tilt, radius))
    separation = Separation(effective_radius=radius, departure=lambda _, x: x**2 / (2.0 * radius))
    found = {cells: press_tilted(contact_kind(drop, cells), separation, approach, tilt) for cells in (12, 20)}
    coarse, fine = found[12], found[20]
    if coarse is None or fine is None:
        return
    peak = {cells: solve_along_width(contact_kind(drop, cells), delta, theta, rho).largest[0] for cells in (12, 20)}
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
            contact = line.respond(delta, theta, rho)
        except ConvergenceError:
            numbers.append("does not settle")
            continue
        largest = estimate_along_width(kind, contact.line_load, rho).largest[0]
        numbers.append(
            f"{100.0 * (contact.load[0] / fine.load - 1.0):+.2f} {100.0 * (contact.moment[0] - fine.moment) / arm:+.2f} "
            f"{100.0 * (largest / peak[20] - 1.0):+.1f}"
        )
    print(f"| {name} | " + " | ".join(numbers) + " |")


def members(kind: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return drop, approach in the middle and what the tilt adds at the end, all by the approach of the aligned line."""
    part = (np.arange(MEMBERS) + 0.5) / MEMBERS
    none, one = np.zeros(MEMBERS), np.ones(MEMBERS)
    if kind == "aligned":
        return none, 0.5 + part, none
    if kind == "tilted, both ends carry":
        return none, one, 0.1 + 0.8 * part
    if kind.startswith("straight"):  # the deeper end as deep as twice the aligned line, and so much of the line carries
        low, high = REACHES[kind]
        tilt = 1.0 / (low + (high - low) * part)
        return none, 2.0 - tilt, tilt
    if kind == "crowned, aligned":
        return 1.5 + 2.5 * part, one, none
    return 2.0 + 2.0 * part, one, 0.5 + part


def changes(kind: str, radius: float, deep: float) -> FloatArray:
    """Return load, moment and largest pressure of contacts of a kind by numbers of slices, (slices, quantities, members)."""
    drop, approach, tilt = (deep * each for each in members(kind))
    theta, rho, found = 2.0 * tilt / LENGTH, np.full(MEMBERS, radius), []
    for slices in FINER:
        z = slice_heights(LENGTH, slices)
        line = SlicedLine(
            length=LENGTH, contact_modulus=MODULUS, slices=slices, relief=drop[:, None, None] * (2.0 * z / LENGTH) ** 2
        )
        contact = line.respond(approach[:, None], theta[:, None], rho[:, None])
        largest = estimate_along_width(contact_kind(0.0, 12), contact.line_load, rho[:, None]).largest
        found.append(np.stack((contact.load, contact.moment, largest))[..., 0])
    answers = np.array(found)
    load, moment, largest = answers[-1]
    scale = np.stack((load, np.maximum(np.abs(moment), load * LENGTH / 6.0), largest))
    return np.asarray(answers / scale)


def order_of(size: FloatArray) -> str:
    """Return the slope of changes over the number of slices, both as logarithms; a dash where they are nothing or do not fall."""
    if size[0] < LEAST_CHANGE:
        return "–"
    order = -float(np.polyfit(np.log(FINER[: size.size]), np.log(size), 1)[0])
    return f"{order:.1f}" if order > 0.0 else "–"


def print_orders() -> None:
    """Print what changes from one number of slices to the next."""
    steps = [f"{first} → {second}" for first, second in pairwise(FINER)]
    for radius, deep in SLENDER[:3]:
        print(f"\nL/b = {slenderness(radius, deep):.0f}: load, moment, largest pressure, %\n")
        print("| contacts | " + " | ".join(steps) + " | order |")
        print("|---|" + "---|" * (len(steps) + 1))
        for kind in KINDS:
            moved = np.diff(changes(kind, radius, deep), axis=0)
            size = 100.0 * np.sqrt((moved**2).mean(axis=-1))
            cells = [" ".join(f"{value:.2g}" if value > LEAST_CHANGE else "0" for value in row) for row in size]
            told = " ".join(order_of(each) for each in size[:-1].T)
            print(f"| {kind} | " + " | ".join(cells) + f" | {told} |")


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--order", action="store_true", help="changes from one number of slices to the next, without grids"
    )
    if parser.parse_args().order:
        print_orders()
        return
    for radius, deep in SLENDER:
        told = f"L/b = {slenderness(radius, deep):.0f}: load moment largest pressure, %"
        print(f"\nρ = {radius} mm, δ = {1e3 * deep:g} µm, {told}\n")
        print("| case | grid's own | " + " | ".join(f"n = {slices}" for slices in SLICES) + " |")
        print("|---|---|" + "---|" * len(SLICES))
        for name, (middle, tilt) in STRAIGHT.items():
            print_case(name, radius, 0.0, middle * deep, 2.0 * tilt * deep / LENGTH)
        for name, (drop, middle, tilt) in CROWNED.items():
            print_case(name, radius, drop * deep, middle * deep, 2.0 * tilt * deep / LENGTH)


def slenderness(radius: float, deep: float) -> float:
    """Return length by half-width of the aligned line."""
    return LENGTH / float(LineContactLaw(LENGTH, MODULUS).half_width(deep, radius))


if __name__ == "__main__":
    main()
