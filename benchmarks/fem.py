"""Time and memory of the full finite-element solution against the number of unknowns.

``python benchmarks/fem.py [--sizes 4 2 1 0.7 0.4] [--ccx [6 4 3 2 1]] [--out FILE]``: one position from nothing for each
size, each in a process of its own (peak memory is that of the process), then a further load and a further position at
the default size; with ``--ccx`` CalculiX solves the decks of these sizes (the default one) in the same run.

``--sizes --series 12 [--series-size 1] [--refereed 12]``: a whole turn of the crank in so many positions, each taking from the
one before what it can; CalculiX solves the decks of the refereed ones (evenly spread), and its mean stands for the others.

``--sizes --ccx 6 4 3 2`` (no timing) shows what coarse meshes do to the wheel's angle: ours, ours on the same mesh with
every other pressure alone (both ways to choose them), CalculiX's. With every other pressure the mesh of size 3 has as few of
them as that of size 6 (1.3 for each half-width) and its displacements stay: what then moves, the pressures move.
``--penalty 25 50 100`` shows what CalculiX's penalty gives way.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

# This file's folder would hide the package of the same name.
sys.path[0] = str(Path(__file__).resolve().parents[1])
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

if TYPE_CHECKING:
    from fem.drive.full_solution import FullSolution

CASE, ANGLE = "CS-1", 0.5
STAGES = ("guess", "coarse", "mesh", "assembly and factorisation", "contact and pose", "check")


def measure(size: float, further: bool) -> dict:
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
        solve_drive(drive, ANGLE + 0.3, scale=size, rounds=solution.rounds)
        row["further position"] = {"seconds": time.perf_counter() - start, "cpu_seconds": time.process_time() - cpu}
    return row


def solve_series(size: float, positions: int, refereed: int) -> dict:
    """Solve a turn of the crank in this process and let CalculiX solve some positions; return the seconds of both."""
    import math
    import resource
    import tempfile
    import time

    from fem.reducer.series import solve_positions
    from fem.referee.calculix import ask_calculix
    from fem.referee.calculix_deck import find_calculix, write_deck
    from ltca.errors import CycloError
    from ltca.reading.drive_file import load_drive

    angles = [ANGLE + 2.0 * math.pi * position / positions for position in range(positions)]
    chosen = {round(place * positions / refereed) for place in range(refereed)}
    row: dict = {
        "size": size,
        "memory_MB": 0.0,
        "unknowns": [],
        "seconds": [],
        "cpu_seconds": [],
        "ccx_seconds": {},
        "ccx_cpu_seconds": {},
        "ours_less_ccx": {},
    }
    solutions = solve_positions(load_drive("paper").cases[CASE], angles, scale=size)
    with tempfile.TemporaryDirectory() as folder:
        for position in range(positions):
            start, cpu = time.perf_counter(), time.process_time()
            solution = next(solutions)
            row["seconds"].append(time.perf_counter() - start)
            row["cpu_seconds"].append(time.process_time() - cpu)
            row["unknowns"].append(solution.unknowns)
            if position in chosen:
                (disc,) = solution.discs
                deck = write_deck(disc, Path(folder) / "deck.inp")
                start = time.perf_counter()
                try:
                    answer = ask_calculix(disc, deck, find_calculix())
                    row["ours_less_ccx"][position] = arcseconds(solution.wheel_angle - answer.wheel_angle)
                    row["ccx_seconds"][position] = answer.seconds
                except CycloError as error:
                    # It took its time, whatever came of it.
                    print(f"position {position}: {error}", file=sys.stderr, flush=True)
                    row["ccx_seconds"][position] = time.perf_counter() - start
                used = resource.getrusage(resource.RUSAGE_CHILDREN)
                before = sum(row["ccx_cpu_seconds"].values())
                row["ccx_cpu_seconds"][position] = used.ru_utime + used.ru_stime - before
    row["memory_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return row


def compare(size: float, penalties: list[float]) -> dict:
    """Solve one position, let CalculiX solve it, and return both tables and wheel angles (arc seconds)."""
    import tempfile

    from fem.drive.solution import solve_drive
    from fem.referee.calculix import ask_calculix, tabulate_answers
    from fem.referee.calculix_deck import PENALTY_FACTOR, find_calculix, write_deck
    from ltca.reading.drive_file import load_drive

    solution = solve_drive(load_drive("paper").cases[CASE], ANGLE, scale=size)
    row: dict = {"size": size, "ours": arcseconds(solution.pose.wheel_angle)}
    row["half_the_pressures"] = [arcseconds(halve_pressures(solution, first)) for first in (1, 2)]
    with tempfile.TemporaryDirectory() as folder:
        for penalty in penalties or [PENALTY_FACTOR]:
            deck = write_deck(solution, Path(folder) / "deck.inp", penalty=penalty)
            answer = ask_calculix(solution, deck, find_calculix())
            row.setdefault("theirs", {})[f"{penalty:g}"] = arcseconds(answer.wheel_angle)
            row["table"] = tabulate_answers(solution, answer)
    return row


def arcseconds(angle: float) -> float:
    """Return an angle in arc seconds."""
    import math

    return math.degrees(angle) * 3600.0


def halve_pressures(solution: FullSolution, first: int) -> float:
    """Return the wheel's angle, rad, with pressures at every other vertex alone, linear between: `first` is 1 or 2.

    Meshes, compliances and gaps stay; pressures are a subspace of what they were, so only the contact is coarser.
    """
    import numpy as np

    from fem.contact.unilateral import ContactProblem, solve_floating_contact

    model = solution.model
    columns = []
    for pair in model.pairs:
        arc = pair.zone.arc
        left = np.unique(np.r_[0, np.arange(first, len(arc) - 1, 2), len(arc) - 1])
        for vertex in left[1:-1]:
            column = np.zeros(model.unknown_count)
            column[pair.unknowns] = np.interp(arc, arc[left], (left == vertex).astype(float))[1:-1]
            columns.append(column)
    basis = np.array(columns).T
    integrals = [model.integrate(pair, solution.pose) for pair in model.pairs]
    whole = model.contact_problem(solution.pose, integrals, solution.state.wheel_moment)
    part = ContactProblem(
        compliance=basis.T @ whole.compliance @ basis,
        gap=basis.T @ whole.gap,
        motions=basis.T @ whole.motions,
        external=whole.external,
    )
    found = solve_floating_contact(part, basis.T @ solution.state.contact.pressure > 0.0)
    # The fourth motion is the turn of the wheel from the pose.
    return float(solution.pose.wheel_angle + found.motion[3])


def main() -> None:
    """Measure every size in a process of its own and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=float, nargs="*", default=[6.0, 2.0, 1.0, 0.5, 0.38])
    parser.add_argument("--ccx", type=float, nargs="*", metavar="SIZE", help="CalculiX on decks of these sizes (1)")
    parser.add_argument("--penalty", type=float, nargs="+", default=[], help="its penalty factors (the deck's)")
    parser.add_argument("--series", type=int, metavar="N", help="a turn of the crank in N positions")
    parser.add_argument("--series-size", type=float, default=1.0, help="their element edge (1)")
    parser.add_argument(
        "--refereed", type=int, default=0, metavar="N", help="how many of them CalculiX solves, too (0)"
    )
    parser.add_argument("--out", type=Path)
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker is not None:
        task, size = arguments.worker.split(":")
        if task == "series":
            done = solve_series(float(size), arguments.series, arguments.refereed)
        else:
            done = (
                compare(float(size), arguments.penalty) if task == "ccx" else measure(float(size), float(size) == 1.0)
            )
        print(json.dumps(done))
        return
    rows = time_sizes(arguments.sizes) if arguments.sizes else []
    compared = [] if arguments.ccx is None else compare_sizes(arguments.ccx or [1.0], arguments.penalty)
    series = time_series(arguments.series_size, arguments.series, arguments.refereed) if arguments.series else None
    if arguments.out:
        content = {"load_average": os.getloadavg(), "rows": rows, "calculix": compared, "series": series}
        arguments.out.write_text(json.dumps(content, indent=1) + "\n")


def run_worker(task: str, size: float, penalties: list[float], *options: str) -> dict:
    """Do one task in a process of its own."""
    words = [sys.executable, __file__, "--worker", f"{task}:{size}", *options]
    words += ["--penalty", *map(str, penalties)] if penalties else []
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def time_sizes(sizes: list[float]) -> list[dict]:
    """Measure every size and print the table."""
    rows = []
    print(f"{'unknowns':>9}{'total s':>9}{'CPU s':>8}{'MB':>7}   " + "".join(f"{stage[:13]:>15}" for stage in STAGES))
    for size in sizes:
        row = run_worker("time", size, [])
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
    return rows


def time_series(size: float, positions: int, refereed: int) -> dict:
    """Time a series and print it, with the ratio to CalculiX where that solved some of it."""
    row = run_worker("series", size, [], "--series", str(positions), "--refereed", str(refereed))
    ours, theirs = row["seconds"], row["ccx_seconds"]
    each = " ".join(f"{seconds:.1f}" for seconds in ours)
    print(
        f"\n{positions} positions of size {size:g}, {min(row['unknowns']):,} to {max(row['unknowns']):,} unknowns: "
        f"{sum(ours):.1f} s (CPU {sum(row['cpu_seconds']):.1f} s), {row['memory_MB']:.0f} MB: {each}"
    )
    if theirs:
        mean = sum(theirs.values()) / len(theirs)
        processor = positions * sum(row["ccx_cpu_seconds"].values()) / len(theirs) / sum(row["cpu_seconds"])
        print(
            f"CalculiX: {mean:.1f} s a position (of {len(theirs)}), {positions * mean:.0f} s for {positions}: "
            f"{positions * mean / sum(ours):.0f} times ours "
            f"({processor:.0f} in processor time); wheel angles, ours less theirs: "
            + ", ".join(f"{value:+.3f}″" for value in row["ours_less_ccx"].values())
        )
    return row


def compare_sizes(sizes: list[float], penalties: list[float]) -> list[dict]:
    """Compare every size with CalculiX and print the tables, wheel angles last."""
    rows = []
    for size in sizes:
        rows.append(run_worker("ccx", size, penalties))
        print(f"\nsize {size:g}")
        for line in rows[-1]["table"]:
            print(f"  {line}")
    print(
        f"\nwheel angle, ″\n{'size':>5}{'ours':>10}{'every other pressure':>22}{'penalty':>9}{'ccx':>10}{'ours − ccx':>12}"
    )
    for row in rows:
        first, second = row["half_the_pressures"]
        for penalty, theirs in row["theirs"].items():
            print(
                f"{row['size']:>5g}{row['ours']:>10.3f}{first:>12.3f}{second:>10.3f}{penalty:>9}{theirs:>10.3f}"
                f"{row['ours'] - theirs:>+12.3f}"
            )
    return rows


if __name__ == "__main__":
    main()
