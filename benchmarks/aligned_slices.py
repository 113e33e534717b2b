"""Aligned contacts in slices against the law of finite length: ``python benchmarks/aligned_slices.py [--count 50]``.

Practical drives (`ltca.testing.practical_drives`) without anything along the width are balanced with one slice and with n:
loads of wheel pins and rollers by the largest of their kind, the wheel angle, and the pressure in the middle of the heaviest
pin (Hertz at the line load there; with one slice that of the law). The table has the worst drive and the median for every n,
and the drift from each n to the finest, from which the order of convergence is told.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.drive.parts import Contact, Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError
from ltca.testing.practical_drives import practical_drive
from ltca.testing.width_check import contact_moduli

SLICES = (5, 9, 17, 33)


def answer(drive: Drive, angle: float, slices: int) -> tuple[dict[str, np.ndarray], float, float]:
    """Return loads by kind, the wheel angle in arcseconds and the pressure in the middle of the heaviest pin, MPa."""
    drive = replace(drive, contact=Contact(slices=slices))
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], np.array([angle]), drive.load.torque)
    response = found.response
    loads = {"pins": response.pin_load[0], "rollers": response.rollers.outer_load[0]}
    disc = int(np.argmax([each.pin_load.max() for each in response.parts]))
    part = response.parts[disc]
    pin = int(np.argmax(part.pin_load[0]))
    if slices == 1:
        pressure = float(model.discs[disc].pressures(part).pins.mid[0, pin])
    else:
        assert part.leaning_pins is not None
        # The middle of the middle slice, between two of its four points.
        line = float(part.leaning_pins.contact.line_load[0, pin, slices // 2, 1:3].mean())
        radius = float(part.flank.effective_radius[0, pin])
        pressure = float(np.sqrt(line * contact_moduli(drive)["flank"] / (np.pi * radius)))
    return loads, float(found.pose[0, -1]) * ARCSEC, pressure


def compare(drive: Drive, angle: float, slices: tuple[int, ...]) -> list[tuple[float, float, float]]:
    """Return load and pressure off, parts, and the wheel angle off, arcseconds, for each number of slices."""
    loads, wheel, pressure = answer(drive, angle, 1)
    rows = []
    for n in slices:
        own, turned, pressed = answer(drive, angle, n)
        off = max(float(np.max(np.abs(own[kind] - load)) / np.max(load)) for kind, load in loads.items())
        rows.append((off, abs(turned - wheel), abs(pressed / pressure - 1.0)))
    return rows


def aligned_drive(seed: int) -> tuple[Drive, float]:
    """Return a practical drive with a rigid ring, and a crank angle in rad."""
    drive, angle = practical_drive(seed)
    return replace(drive, ring=None), angle


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50, help="number of drives; default 50")
    parser.add_argument("--slices", type=int, nargs="+", default=SLICES)
    arguments = parser.parse_args()
    slices, rows = tuple(arguments.slices), []
    for seed in range(arguments.count):
        try:
            rows.append(compare(*aligned_drive(seed), slices))
        except ConvergenceError as error:
            print(f"seed {seed}: {error}")
    table = 100.0 * np.array(rows)
    table[..., 1] /= 100.0
    print("slices | load off, %: median, worst (seed) | wheel angle off, arcsec | pressure in the middle off, %")
    for number, n in enumerate(slices):
        cells = []
        for kind in range(3):
            values = table[:, number, kind]
            cells.append(f"{np.median(values):8.4f} {values.max():8.4f} ({int(np.argmax(values))})")
        print(f"{n:6d} | " + " | ".join(cells))


if __name__ == "__main__":
    main()
