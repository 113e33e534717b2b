"""Time of the parts of ``cyclo run paper``, positions per second, and cost against number of positions.

    python benchmarks/run_paper.py [--rounds 3]

Times are wall times; compare ratios within one run.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np


def cold_run(extra: list[str]) -> float:
    """Return the wall time, s, of a fresh process that runs the six cases."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "ltca.commands.program", "run", "paper", "--out", folder, *extra]
        start = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return time.perf_counter() - start


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--rounds", type=int, default=3, help="number of rounds, of which the fastest is used; default 3"
    )
    rounds = parser.parse_args().rounds
    print("cold start, six cases x 360 positions, full and light torque")
    for name, extra in (
        ("results and summary", ["--no-figures", "--no-page"]),
        ("with the page", ["--no-figures"]),
        ("with page and ten figures", ["--figures"]),
    ):
        print(f"  {name:<34}{min(cold_run(extra) for _ in range(rounds)):8.2f} s")

    print("\ntime of the parts, warm process")
    start = time.perf_counter()
    import ltca.analysis.loaded_analysis
    import ltca.analysis.results
    import ltca.geometry.placement
    from ltca.laws.line_contact import line_contact_table
    from ltca.reading.drive_file import load_drive

    print(f"  {'imports (numpy, scipy, xarray …)':<34}{time.perf_counter() - start:8.2f} s")
    start = time.perf_counter()
    line_contact_table()
    print(f"  {'line-contact table, read':<34}{time.perf_counter() - start:8.2f} s")
    cases = load_drive("paper").cases
    angles = ltca.geometry.placement.position_angles(360)
    start = time.perf_counter()
    analyses = {name: ltca.analysis.loaded_analysis.analyse(drive, angles) for name, drive in cases.items()}
    solved = time.perf_counter() - start
    print(f"  {'equilibrium, 4320 positions':<34}{solved:8.2f} s   {4320 / solved:8.0f} positions/s")
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        ltca.analysis.results.build_dataset("paper", analyses).to_netcdf(Path(folder) / "results.nc", engine="h5netcdf")
    print(f"  {'dataset and results.nc':<34}{time.perf_counter() - start:8.2f} s")

    print("\ncost against positions (CS-6, full and light torque)")
    print(f"  {'positions':>10}{'s':>10}{'µs/position':>14}{'iterations':>12}")
    for positions in (90, 360, 1440, 5760):
        best = np.inf
        for _ in range(rounds):
            start = time.perf_counter()
            analysis = ltca.analysis.loaded_analysis.analyse(
                cases["CS-6"], ltca.geometry.placement.position_angles(positions)
            )
            best = min(best, time.perf_counter() - start)
        mean = analysis.full.iterations.mean()
        print(f"  {positions:>10}{best:>10.3f}{1e6 * best / positions:>14.0f}{mean:>12.1f}")


if __name__ == "__main__":
    main()
