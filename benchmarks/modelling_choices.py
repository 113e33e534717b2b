"""Effect of assumptions common to LTCA and full finite elements: ``python benchmarks/modelling_choices.py``.

LTCA ``fe`` and full finite elements support the wheel pins by the same rigid core and the race by the same bore, and both assume
plane strain, so their difference measures precision only. The effect of these assumptions is part of the accuracy and is measured
here on the paper's drive for some positions of a turn:

- ``pin_wheel.core_radius`` and ``crank_bearing.race_bore_radius``, by ``fe`` with coefficients for each,
- plane stress instead of plane strain, and elastic contact of the shaft pins, by full finite elements.

Meshes are coarse, and equal on both sides of a difference.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from ltca.arrays import FloatArray

sys.path[0] = str(Path(__file__).resolve().parents[1])  # the package fem, not the benchmark of that name

from fem.body.elasticity import PlaneState
from fem.coefficients.dataset import derive_coefficients
from fem.options import SolutionOptions
from fem.reducer.series import solve_positions
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficients import load_coefficients
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

CORES = (0.3, 1.0, 3.5)
"""Radii of the rigid core of the wheel pins, compared with the default, mm."""
BORES = (5.0, 15.0)
"""Radii of the fixed bore of the inner race, compared with the default, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """Loads of all contacts, N, largest pressures of flank and holes, MPa, and wheel angle, arc seconds, at every position."""

    load: FloatArray
    flank: FloatArray
    hole: FloatArray
    wheel: FloatArray


def by_coefficients(drive: Drive, angles: FloatArray, size: float, stations: float) -> Answer:
    """Return the results of ``fe`` with coefficients of the drive's own bodies."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "coefficients.nc"
        derive_coefficients(drive, stations=stations, size=size).to_netcdf(path, engine="h5netcdf")
        found = analyse(drive, angles, engine=PlaneStrain(coefficients=load_coefficients(path, drive)))
    contacts = found.full.response
    return Answer(
        load=np.concatenate((contacts.pin_load, contacts.rollers.outer_load, contacts.hole_load), axis=1),
        flank=found.pressures.pins.mid.max(axis=1),
        hole=found.pressures.holes.mid.max(axis=1),
        wheel=ARCSEC * found.transmission_error,
    )


def by_full_solution(drive: Drive, angles: FloatArray, size: float, plane: PlaneState = "strain") -> Answer:
    """Return the results of full finite elements."""
    loads, flank, hole, wheel = [], [], [], []
    for solution in solve_positions(drive, angles.tolist(), SolutionOptions(size=size, plane=plane)):
        (disc,) = solution.discs
        contacts = disc.contacts
        loads.append(np.concatenate((contacts.pin_load, contacts.roller_load, contacts.pin_shaft_load)))
        flank.append(contacts.pin_pressure_mid.max())
        hole.append(contacts.pin_shaft_pressure_mid.max())
        wheel.append(ARCSEC * solution.transmission_error)
    return Answer(load=np.array(loads), flank=np.array(flank), hole=np.array(hole), wheel=np.array(wheel))


def row(name: str, base: Answer, other: Answer) -> str:
    """Return a table row with the largest signed changes over the positions."""

    def farthest(change: FloatArray) -> float:
        return float(change.flat[np.argmax(np.abs(change))])

    loads = 100.0 * farthest((other.load - base.load) / base.load.max(axis=1, keepdims=True))
    flank, hole = (
        100.0 * farthest(new / old - 1.0) for new, old in ((other.flank, base.flank), (other.hole, base.hole))
    )
    turned = farthest(np.abs(other.wheel) - np.abs(base.wheel))
    return f"{name:<44}{loads:>9.2f}{flank:>9.2f}{hole:>9.2f}{turned:>9.2f} of {np.mean(np.abs(base.wheel)):.0f}"


def main() -> None:
    """Print the effect of every assumption."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", default="CS-1", help="case of the paper's drive (default %(default)s)")
    parser.add_argument(
        "--positions", type=int, default=4, help="positions over a turn of the crank (default %(default)s)"
    )
    parser.add_argument(
        "--size",
        type=float,
        default=2.0,
        help="element edge relative to the default, for all meshes (default %(default)s)",
    )
    parser.add_argument(
        "--stations", type=float, default=0.5, help="number of stations relative to the default (default %(default)s)"
    )
    arguments = parser.parse_args()
    drive, angles = load_drive("paper").cases[arguments.case], position_angles(arguments.positions)
    core, bore = drive.pin_wheel.held_core_radius, drive.crank_bearing.held_bore_radius
    start, size, stations = time.process_time(), arguments.size, arguments.stations
    print(
        f"paper {arguments.case}, {drive.load_words()}, {angles.size} positions; meshes of {size:g} times the default edge,"
    )
    print(
        f"{stations:g} times the default stations; largest change over the positions, loads relative to the largest at a position"
    )
    print(f"{'':<44}{'load, %':>9}{'flank, %':>9}{'hole, %':>9}{'wheel, ″':>9}", flush=True)
    base = by_coefficients(drive, angles, size, stations)
    choices = [
        *((f"rigid core of the pins {core:g} -> {one:g} mm", {"pin_wheel.core_radius": one}) for one in CORES),
        *((f"bore of the inner race {bore:g} -> {one:g} mm", {"crank_bearing.race_bore_radius": one}) for one in BORES),
    ]
    for name, chosen in choices:
        changed = with_fields(drive, chosen)
        print(row(f"{name} (fe)", base, by_coefficients(changed, angles, size, stations)), flush=True)
    full = by_full_solution(drive, angles, size)
    print(
        row("plane strain -> stress (full FE)", full, by_full_solution(drive, angles, size, plane="stress")), flush=True
    )
    elastic = with_fields(drive, {"pin_shaft.elastic_contact": True})
    print(row("shaft pins rigid -> elastic (full FE)", full, by_full_solution(elastic, angles, size)), flush=True)
    print(row("the same (fe)", base, by_coefficients(elastic, angles, size, stations)), flush=True)
    print(f"{time.process_time() - start:.0f} s of processor time")


if __name__ == "__main__":
    main()
