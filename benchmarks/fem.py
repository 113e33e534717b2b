"""Time and memory of the full finite-element solution against the number of unknowns.

``python benchmarks/fem.py [--sizes 4 2 1 0.7 0.4] [--ccx] [--out FILE]``: one position from nothing for each
size, each in a process of its own (peak memory is that of the process), then a further load and a further position at
the default size; with ``--ccx`` CalculiX solves the deck of the default size in the same run.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

# This file's folder would hide the package of the same name.
sys.path[0] = str(Path(__file__).resolve().parents[1])
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

CASE, ANGLE = "CS-1", 0.5
STAGES = ("guess", "coarse", "mesh", "assembly and factorisation", "contact and pose", "check")


def measure(size: float, further: bool, ccx: bool) -> dict:
    """Solve in this process and return unknowns, seconds (wall and CPU) and peak memory."""
    import resource
    import time

    from fem.drive.solution import solve_drive, solve_load
    from ltca.reading.drive_file import load_drive

    drive = load_drive("paper").cases[CASE]
    cpu = time.process_time()
    solution = solve_drive(drive, ANGLE, scale=size)
    row = {
        "size": size,
        "unknowns": solution.unknowns,
        "pressure_unknowns": solution.model.unknown_count,
        "pose_iterations": solution.pose_iterations,
        "seconds": solution.seconds,
        "cpu_seconds": time.process_time() - cpu,
    }
    row["memory_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    if further:
        for name, torque in (("further load", 1.05), ("another load", 0.9)):
            start, cpu = time.perf_counter(), time.process_time()
            more = solve_load(solution, torque * drive.load.torque)
            row[name] = {
                "seconds": time.perf_counter() - start,
                "cpu_seconds": time.process_time() - cpu,
                "same_meshes": more.model is solution.model,
            }
        start, cpu = time.perf_counter(), time.process_time()
        solve_drive(drive, ANGLE + 0.3, scale=size)
        row["further position"] = {"seconds": time.perf_counter() - start, "cpu_seconds": time.process_time() - cpu}
    if ccx:
        import tempfile

        from fem.referee.calculix import compare_with_calculix
        from fem.referee.calculix_deck import find_calculix

        with tempfile.TemporaryDirectory() as folder:
            row["calculix"] = compare_with_calculix(solution, Path(folder), find_calculix())
    return row


def main() -> None:
    """Measure every size in a process of its own and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=float, nargs="+", default=[6.0, 2.0, 1.0, 0.5, 0.38])
    parser.add_argument("--ccx", action="store_true", help="CalculiX on the deck of size 1")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--worker", type=float, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker is not None:
        print(json.dumps(measure(arguments.worker, arguments.worker == 1.0, arguments.ccx)))
        return
    rows = []
    print(f"{'unknowns':>9}{'total s':>9}{'CPU s':>8}{'MB':>7}   " + "".join(f"{stage[:13]:>15}" for stage in STAGES))
    for size in arguments.sizes:
        words = [sys.executable, __file__, "--worker", str(size)]
        words += ["--ccx"] if arguments.ccx and size == 1.0 else []
        done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True)
        row = json.loads(done.stdout.splitlines()[-1])
        rows.append(row)
        seconds = row["seconds"]
        print(
            f"{row['unknowns']:>9,}{seconds['total']:>9.2f}{row['cpu_seconds']:>8.2f}{row['memory_MB']:>7.0f}   "
            + "".join(f"{seconds.get(stage, 0.0):>15.2f}" for stage in STAGES),
            flush=True,
        )
        for name in ("further load", "another load", "further position"):
            if name in row:
                print(f"  {name}: {row[name]}")
        for line in row.get("calculix", []):
            print(f"  {line}")
    if arguments.out:
        arguments.out.write_text(json.dumps({"load_average": os.getloadavg(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
