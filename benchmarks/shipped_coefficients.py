"""Influence coefficients that come with the package: derive those of the shipped drives and compare, or write them anew.

``python benchmarks/shipped_coefficients.py`` derives every shape of the shipped drives but the paper's (some minutes) and prints
by how much a new derivation differs from the shipped file, of the largest entry; exit status 1 beyond 1e-3. ``--write`` replaces
the files, ``--only NAME`` takes one drive. ``--laws`` derives nothing: it prints for each shipped file the processor time of
reading, of the laws checked on every reading and of all laws, and how far its entries are out of line (seconds).
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.coefficients.dataset import derive_coefficients
from ltca.compliance.coefficient_files import SHIPPED, file_name
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.coefficient_file import read_coefficients, write_coefficients
from ltca.reading.coefficient_laws import (
    OUT_OF_LINE,
    check_coefficients,
    check_laws,
    check_quick_laws,
    project_rigid_motions,
    station_resultants,
)
from ltca.reading.drive_file import load_drive

DRIVES = tuple(name for name in SHIPPED_DRIVES if name != "paper")
AGREEMENT = 1e-3
"""Largest difference of approaches of a new derivation, of the largest entry: a fifth of what the mesh leaves
(`convergence_estimate`). Stresses, which other meshes of the same fineness move more, agree within what the shipped file
states of them (`convergence_stress`).
"""


def shapes_of(name: str) -> dict[str, Drive]:
    """Return the drive of one disc of each distinct shape of a shipped drive, by the name of its file."""
    (drive,) = load_drive(name).cases.values()
    return {file_name(single): single for single in reversed(single_discs(drive))}


def differences(name: str, drive: Drive) -> dict[str, float]:
    """Derive a shape and return by how much its matrices differ from those shipped, of the largest entry."""
    shipped, new = read_coefficients(SHIPPED / name), derive_coefficients(drive)
    found = {}
    for variable in ("disc_approach", "disc_stress", "roller_approach", "race_approach", "pin_approach"):
        old, derived = (np.asarray(data[variable].values, dtype=float) for data in (shipped, new))
        if variable == "disc_approach":  # what no load in equilibrium can feel depends on the datum alone
            old, derived = (project_rigid_motions(own, station_resultants(new)) for own in (old, derived))
        found[variable] = float(np.max(np.abs(derived - old)) / np.max(np.abs(old)))
    return found


def laws(name: str) -> str:
    """Return what reading a shipped file and checking its laws takes, and its entries out of line, in words."""
    start, least = time.process_time(), []
    dataset = read_coefficients(SHIPPED / name, lawful=False)
    reading = time.process_time() - start
    for check in (check_quick_laws, check_laws):
        took = []
        for _ in range(3):
            start = time.process_time()
            checks = check(dataset)
            took.append(time.process_time() - start)
        least.append(min(took))
    (ratio,) = (check.value for check in checks if check.name == OUT_OF_LINE)
    return (
        f"{1e3 * reading:.0f} ms of reading, {1e3 * least[0]:.0f} ms of the laws of every reading, "
        f"{1e3 * least[1]:.0f} ms of all laws; entries out of line {ratio:.2g}"
    )


def main() -> int:
    """Compare, check or write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=DRIVES, action="append")
    parser.add_argument("--write", action="store_true")
    parser.add_argument(
        "--laws", action="store_true", help="time of the laws of the shipped files, and their entries out of line"
    )
    arguments = parser.parse_args()
    status, wanted = 0, dict[str, tuple[str, Drive]]()
    for drive in arguments.only or DRIVES:
        wanted |= {file: (drive, shape) for file, shape in shapes_of(drive).items()}
    for file, (drive, shape) in wanted.items():
        start = time.process_time()
        if arguments.laws:
            print(f"{drive}: {file}, {laws(file)}", flush=True)
            continue
        if arguments.write:
            dataset = derive_coefficients(shape)
            if broken := [check.name for check in check_coefficients(dataset) if not check.passed]:
                raise SystemExit(f"{drive}: breaks {', '.join(broken)}")
            size = write_coefficients(dataset, SHIPPED / file).stat().st_size
            print(
                f"{drive}: {file}, {size / 1e6:.2f} MB, {time.process_time() - start:.1f} s of processor time",
                flush=True,
            )
            continue
        found = differences(file, shape)
        stated = float(read_coefficients(SHIPPED / file).attrs["convergence_stress"])
        status |= int(found["disc_stress"] > stated)
        status |= int(max(value for name, value in found.items() if name != "disc_stress") > AGREEMENT)
        told = ", ".join(f"{name} {value:.1e}" for name, value in found.items())
        print(f"{drive}: {told}; {time.process_time() - start:.1f} s of processor time", flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
