"""Time and memory of the full finite-element solution against the number of unknowns.

``python benchmarks/fem.py [--sizes 4 2 1 0.7 0.4] [--ccx [6 4 3 2 1]] [--out FILE]``: one position for each element
size, in separate processes (for the peak memory), then a further load and a further position at
the default size; with ``--ccx`` CalculiX solves the decks of these sizes (default size 1) in the same run.

``--sizes --series 12 [--series-size 1] [--refereed 12] [--keep FOLDER]``: a series of positions over a turn of the crank,
which reuses data of the previous position; CalculiX solves the decks of the refereed positions (evenly spaced). Its
solutions are stored in the folder by deck, so that an interrupted series can be continued; the series itself is solved again.

Both print the processor time of the two codes, their ratio, and the differences of loads and wheel angle.

``--sizes --ccx 6 4 3 2`` (without timing) shows the effect of coarse meshes on the wheel angle: for `fem`, for `fem` on the same
mesh with every other pressure unknown (both choices), and for CalculiX. With every other unknown the mesh of size 3 has as few
pressures as that of size 6 (1.3 per half-width) but the same displacements, which separates the effect of the pressure
discretisation. ``--penalty 50 100 200`` shows the effect of the penalty of CalculiX.
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
HEADINGS = f"{'ratio':>8}{'loads, %':>10}{'wheel, ″':>10}"
STAGES = ("guess", "coarse", "mesh", "assembly and factorisation", "contact and pose", "check")


def measure(size: float, further: bool) -> dict:
    """Solve in this process and return unknowns, wall and processor time, s, and peak memory."""
    import resource
    import time

    from fem.drive.solution import solve_drive, solve_load
    from fem.options import SolutionOptions
    from ltca.reading.drive_file import load_drive

    drive = load_drive("paper").cases[CASE]
    cpu = time.process_time()
    solution = solve_drive(drive, ANGLE, SolutionOptions(size=size))
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
        solve_drive(drive, ANGLE + 0.3, SolutionOptions(size=size), rounds=solution.rounds)
        row["further position"] = {"seconds": time.perf_counter() - start, "cpu_seconds": time.process_time() - cpu}
    return row


def solve_series(size: float, positions: int, refereed: int, keep: Path | None) -> dict:
    """Solve a turn of the crank in this process and some positions by CalculiX; return times and differences."""
    import math
    import resource
    import tempfile
    import time

    from fem.options import SolutionOptions
    from fem.reducer.series import solve_positions
    from ltca.errors import CycloError
    from ltca.reading.drive_file import load_drive

    angles = [ANGLE + 2.0 * math.pi * position / positions for position in range(positions)]
    chosen = {round(place * positions / refereed) for place in range(refereed)}
    rows: list[dict] = []
    solutions = solve_positions(load_drive("paper").cases[CASE], angles, SolutionOptions(size=size))
    with tempfile.TemporaryDirectory() as folder:
        for position in range(positions):
            start, cpu = time.perf_counter(), time.process_time()
            solution = next(solutions)
            row: dict = {"position": position, "unknowns": solution.unknowns, "seconds": time.perf_counter() - start}
            row["cpu_seconds"] = time.process_time() - cpu
            if position in chosen:
                (disc,) = solution.discs
                try:
                    row["ccx"] = ask_referee(disc, Path(folder), keep)
                except CycloError as error:
                    row["ccx_failed"] = str(error)
            rows.append(row)
            # The last line of stdout is the result; progress goes to stderr.
            print(describe_position(row), file=sys.stderr, flush=True)
    return {"size": size, "memory_MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, "rows": rows}


def describe_position(row: dict) -> str:
    """Return the table row of one position of a series."""
    line = f"{row['position']:>4}{row['unknowns']:>10,}{row['cpu_seconds']:>9.2f}"
    if "ccx_failed" in row:
        return f"{line}  CalculiX: {row['ccx_failed']}"
    return line + (describe_referee(row) if "ccx" in row else "")


def describe_referee(row: dict) -> str:
    """Return columns with the processor time of CalculiX, its ratio to that of `fem`, and the differences."""
    ccx = row["ccx"]
    return (
        f"{ccx['cpu_seconds']:>10.1f}{ccx['cpu_seconds'] / row['cpu_seconds']:>8.0f}"
        f"{100.0 * ccx['load_difference']:>10.3f}{ccx['wheel_difference']:>+10.3f}"
    )


def ask_referee(solution: FullSolution, folder: Path, keep: Path | None, penalty: float | None = None) -> dict:
    """Solve the position of a solution by CalculiX, or read its stored solution of the same deck.

    Returns
    -------
    dict
        Processor and wall time, s; largest difference of a load relative to the largest of its kind; difference of the
        wheel angle, `fem` minus CalculiX, arc seconds; solution of CalculiX.
    """
    import hashlib
    import resource
    from dataclasses import asdict

    from fem.referee.calculix import RefereeAnswer, ask_calculix, load_differences
    from fem.referee.calculix_deck import PENALTY_FACTOR, find_calculix, write_deck
    from ltca.output.files import write_json

    deck = write_deck(solution, folder / "deck.inp", penalty=penalty or PENALTY_FACTOR)
    kept = (keep or folder) / f"{hashlib.sha256(deck.read_bytes()).hexdigest()[:16]}.json"
    if not kept.exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        found = ask_calculix(solution, deck, find_calculix())
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        write_json(kept, {"cpu_seconds": spent, "answer": asdict(found)})
    content = json.loads(kept.read_text(encoding="utf-8"))
    answer = RefereeAnswer(**content["answer"])
    return {
        "cpu_seconds": content["cpu_seconds"],
        "seconds": answer.seconds,
        "load_difference": max(map(abs, load_differences(solution, answer).values())),
        "wheel_difference": arcseconds(solution.pose.wheel_angle - answer.wheel_angle),
        "answer": content["answer"],
    }


def compare(size: float, penalties: list[float], keep: Path | None) -> dict:
    """Solve one position by both codes; return times, differences, table and wheel angles (arc seconds)."""
    import tempfile
    import time

    from fem.drive.solution import solve_drive
    from fem.options import SolutionOptions
    from fem.referee.calculix import RefereeAnswer, tabulate_answers
    from fem.referee.calculix_deck import PENALTY_FACTOR
    from ltca.reading.drive_file import load_drive

    cpu = time.process_time()
    solution = solve_drive(load_drive("paper").cases[CASE], ANGLE, SolutionOptions(size=size))
    row: dict = {"size": size, "unknowns": solution.unknowns, "cpu_seconds": time.process_time() - cpu}
    row["ours"] = arcseconds(solution.pose.wheel_angle)
    row["half_the_pressures"] = [arcseconds(halve_pressures(solution, first)) for first in (1, 2)]
    with tempfile.TemporaryDirectory() as folder:
        for penalty in penalties or [PENALTY_FACTOR]:
            ccx = ask_referee(solution, Path(folder), keep, penalty)
            row.setdefault("by_penalty", {})[f"{penalty:g}"] = ccx
            row["table"] = tabulate_answers(solution, RefereeAnswer(**ccx["answer"]))
    return row


def arcseconds(angle: float) -> float:
    """Return an angle in arc seconds."""
    import math

    return math.degrees(angle) * 3600.0


def halve_pressures(solution: FullSolution, first: int) -> float:
    """Return the wheel angle, rad, with pressure unknowns at every other vertex, linear in between; `first` is 1 or 2.

    Meshes, compliances and gaps are unchanged; only the space of the pressures is coarser.
    """
    import numpy as np

    from fem.contact.unilateral import ContactProblem, solve_floating_contact
    from fem.drive.pose import joint_problem
    from fem.drive.supports import Supports

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
    supports = Supports.of_drive(model.drive)
    whole = joint_problem([model], supports, [solution.pose], [integrals], solution.state.wheel_moment)
    part = ContactProblem(
        compliance=basis.T @ whole.compliance @ basis,
        gap=basis.T @ whole.gap,
        motions=basis.T @ whole.motions,
        external=whole.external,
    )
    found = solve_floating_contact(part, basis.T @ solution.state.contact.pressure > 0.0)
    # The fourth motion is the rotation of the wheel relative to the pose.
    return float(solution.pose.wheel_angle + found.motion[3])


def main() -> None:
    """Run the measurements in separate processes and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=float, nargs="*", default=[6.0, 2.0, 1.0, 0.5, 0.38])
    parser.add_argument("--ccx", type=float, nargs="*", metavar="SIZE", help="element sizes of decks for CalculiX (1)")
    parser.add_argument(
        "--penalty", type=float, nargs="+", default=[], help="penalty factors of CalculiX (that of the deck)"
    )
    parser.add_argument("--series", type=int, metavar="N", help="number of positions over a turn of the crank")
    parser.add_argument("--series-size", type=float, default=1.0, help="element size of the series (1)")
    parser.add_argument(
        "--refereed", type=int, default=0, metavar="N", help="number of these positions solved by CalculiX (0)"
    )
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="store the solutions of CalculiX here and reuse them"
    )
    parser.add_argument("--out", type=Path)
    parser.add_argument("--worker", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    keep = arguments.keep
    if arguments.worker is not None:
        from ltca.errors import CycloError

        task, size = arguments.worker.split(":")
        try:
            if task == "series":
                done = solve_series(float(size), arguments.series, arguments.refereed, keep)
            elif task == "ccx":
                done = compare(float(size), arguments.penalty, keep)
            else:
                done = measure(float(size), float(size) == 1.0)
        except CycloError as error:
            raise SystemExit(f"{task} of size {size}: {error}") from error
        print(json.dumps(done))
        return
    kept = [] if keep is None else ["--keep", str(keep.resolve())]
    penalties = ["--penalty", *map(str, arguments.penalty)] if arguments.penalty else []
    rows = time_sizes(arguments.sizes) if arguments.sizes else []
    compared = [] if arguments.ccx is None else compare_sizes(arguments.ccx or [1.0], [*penalties, *kept])
    series = None
    if arguments.series:
        counts = ["--series", str(arguments.series), "--refereed", str(arguments.refereed)]
        series = time_series(arguments.series_size, [*counts, *kept])
    if arguments.out:
        content = {"load_average": os.getloadavg(), "rows": rows, "calculix": compared, "series": series}
        arguments.out.write_text(json.dumps(content, indent=1) + "\n")
    if series and any("ccx_failed" in row for row in series["rows"]):
        raise SystemExit(1)


def run_worker(task: str, size: float, *options: str) -> dict:
    """Run one task in a separate process."""
    words = [sys.executable, __file__, "--worker", f"{task}:{size}", *options]
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        # The worker has printed the reason.
        raise SystemExit(done.returncode)
    return json.loads(done.stdout.splitlines()[-1])


def time_sizes(sizes: list[float]) -> list[dict]:
    """Measure every size and print the table."""
    rows = []
    print(f"{'unknowns':>9}{'total s':>9}{'CPU s':>8}{'MB':>7}   " + "".join(f"{stage[:13]:>15}" for stage in STAGES))
    for size in sizes:
        row = run_worker("time", size)
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


def time_series(size: float, options: list[str]) -> dict:
    """Time a series and print it, with the ratio to CalculiX for the positions that it solved."""
    done = run_worker("series", size, *options)
    rows = done["rows"]
    solved = [row for row in rows if "ccx" in row]
    failed = [row["position"] for row in rows if "ccx_failed" in row]
    print(f"\n{'':>4}{'unknowns':>10}{'CPU s':>9}" + (f"{'ccx CPU s':>10}{HEADINGS}" if solved or failed else ""))
    for row in rows:
        print(describe_position(row))
    own = sum(row["cpu_seconds"] for row in rows)
    print(
        f"{len(rows)} positions of size {size:g}: CPU {own:.1f} s, "
        f"{sum(row['seconds'] for row in rows):.1f} s wall time, {done['memory_MB']:.0f} MB"
    )
    if solved:
        theirs = sum(row["ccx"]["cpu_seconds"] for row in solved)
        same = sum(row["cpu_seconds"] for row in solved)
        print(
            f"CalculiX, {len(solved)} of them: CPU {theirs:.0f} s, {theirs / same:.0f} times that of fem; largest "
            f"difference of a load {100.0 * max(row['ccx']['load_difference'] for row in solved):.3f} % of the largest of its "
            f"kind, of the wheel angle {max(abs(row['ccx']['wheel_difference']) for row in solved):.3f}″"
        )
    if failed:
        print(f"CalculiX failed at {', '.join(map(str, failed))}")
    return done


def compare_sizes(sizes: list[float], options: list[str]) -> list[dict]:
    """Compare with CalculiX for all sizes and print tables, times and differences."""
    rows = []
    for size in sizes:
        rows.append(run_worker("ccx", size, *options))
        print(f"\nsize {size:g}")
        for line in rows[-1]["table"]:
            print(f"  {line}")
    print(
        f"\n{'size':>5}{'unknowns':>10}{'penalty':>9}{'CPU s':>9}{'ccx CPU s':>10}{HEADINGS}"
        f"{'wheel, ″':>12}{'half the pressures':>22}"
    )
    for row in rows:
        first, second = row["half_the_pressures"]
        for penalty, ccx in row["by_penalty"].items():
            print(
                f"{row['size']:>5g}{row['unknowns']:>10,}{penalty:>9}{row['cpu_seconds']:>9.2f}"
                f"{describe_referee(row | {'ccx': ccx})}{row['ours']:>12.3f}{first:>12.3f}{second:>10.3f}"
            )
    return rows


if __name__ == "__main__":
    main()
