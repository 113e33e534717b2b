"""Compare ``tables`` with ``direct``: cost per position and differences, in one run.

    python benchmarks/methods.py [--positions 360]

Both methods solve the same positions in the same process: tables in one batch; direct, with contact grids in every
iteration, from the solution on tables (included in its time) and from first contact (cold start).
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import time

sys.path[0] = ""  # not beside this script, where a benchmark is called fem

import numpy as np

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import load_drive
from validation.methods.grids import GridCompliance


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--positions", type=int, default=360, help="number of positions for tables; default 360")
    parser.add_argument("--every", type=int, default=30, help="interval of the positions solved by direct; default 30")
    arguments = parser.parse_args()
    cases = load_drive("paper").cases
    angles = position_angles(arguments.positions)
    few = angles[:: arguments.every]
    solve_equilibrium(
        Reducer(discs=(HalfSpaceCompliance.of_drive(cases["CS-1"]),)), few, cases["CS-1"].wheel_moment()
    )  # builds the table
    print("case   tables  direct  cold start   ratios        largest difference, % of the largest")
    print("       ms/pos  ms/pos      ms/pos                 load     mid pressure   of either start")
    for name, drive in cases.items():
        moment = drive.wheel_moment()
        tables, grids = (
            Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)),
            Reducer(discs=(GridCompliance.of_drive(drive),)),
        )
        solve_equilibrium(grids, few[:1], moment)  # fills the cache of grid matrices
        start = time.perf_counter()
        balanced = solve_equilibrium(tables, angles, moment)
        tabled = (time.perf_counter() - start) / angles.size
        start = time.perf_counter()
        near = solve_equilibrium(tables, few, moment)
        direct = solve_equilibrium(grids, few, moment, near.pose)
        warm = (time.perf_counter() - start) / few.size
        start = time.perf_counter()
        alone = solve_equilibrium(grids, few, moment)
        cold = (time.perf_counter() - start) / few.size
        rows = slice(None, None, arguments.every)
        first, second = balanced.response, direct.response
        loads = [
            np.max(np.abs(a[rows] - b)) / np.max(a)
            for a, b in (
                (first.pin_load, second.pin_load),
                (first.rollers.outer_load, second.rollers.outer_load),
                (first.hole_load, second.hole_load),
            )
        ]
        flat, solid = tables.pressures(near.response), grids.pressures(second)
        pressures = [
            np.max(np.abs(a.mid - b.mid)) / np.max(a.mid)
            for a, b in ((flat.pins, solid.pins), (flat.outer, solid.outer), (flat.inner, solid.inner))
        ]
        apart = np.max(np.abs(alone.response.pin_load - second.pin_load)) / np.max(second.pin_load)
        print(
            f"{name:<6}{1e3 * tabled:7.3f}{1e3 * warm:8.1f}{1e3 * cold:12.1f}"
            f"{warm / tabled:8.0f} {cold / tabled:6.0f}"
            f"{100.0 * max(loads):12.4f}{100.0 * max(pressures):15.4f}{100.0 * apart:16.5f}"
        )


if __name__ == "__main__":
    main()
