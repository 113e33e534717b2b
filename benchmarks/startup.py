"""Processor time of common commands in fresh processes on one core, beside the aim of each: runs, check, imports, ``--fem``.

Every value is the median of user plus system time, with bytecode compiled and caches filled before. Two checkouts are measured
alternately (A B A B), so that other load of the machine affects both equally; ratios are those of the first to the second.

    python benchmarks/startup.py
    python benchmarks/startup.py --fem                       # full finite elements as well: some minutes
    python benchmarks/startup.py --runs 5 --against ../before

``check`` on coefficients has those of one case of the paper's drive, derived before by each checkout.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent.parent
CYCLO = ["-m", "ltca.commands.program"]
COEFFICIENTS = "{coefficients}"
NEEDED_BY_RUN = (
    "import ltca.commands.program, ltca.commands.run, ltca.reading.drive_file, ltca.commands.actions.run, h5py"
)
POSITIONS = """
import sys
import time
sys.path[0] = ""  # not beside this script, where a benchmark is called fem
from fem.drive.solution import solve_drive
from fem.options import SolutionOptions
from ltca.reading.drive_file import load_drive

drive = load_drive("paper").cases["CS-1"]
start = time.process_time()
first = solve_drive(drive, 0.5, SolutionOptions())
print(time.process_time() - start)
start = time.process_time()
solve_drive(drive, 0.8, SolutionOptions(), rounds=first.rounds)
print(time.process_time() - start)
"""
"""Prints the processor time of two positions in one process."""


class Row(NamedTuple):
    """What is measured: words of the interpreter, and the aim of each time, s.

    Attributes
    ----------
    words : list of str
        Arguments of the interpreter.
    aims : dict of str to (float or None)
        By the names of the rows: one for the process, or one for each line that it prints.
    of_process : bool
        Whether the time is that of the process, not what it prints.
    fem : bool
        Whether finite elements are solved.
    """

    words: list[str]
    aims: dict[str, float | None]
    of_process: bool = True
    fem: bool = False


ROWS = (
    Row([*CYCLO, "run", "paper"], {"cyclo run paper": 2.5}),
    Row([*CYCLO, "run", "paper", "--no-page", "--no-figures"], {"cyclo run paper --no-page --no-figures": 1.2}),
    Row(
        [*CYCLO, "check", "paper", "--case", "CS-1", "--compliance", "hybrid", "--coefficients", COEFFICIENTS],
        {"cyclo check, one case on coefficients": 3.0},
    ),
    Row([*CYCLO, "check", "paper"], {"cyclo check paper, six cases": None}),
    Row(["-c", NEEDED_BY_RUN], {"import of what run needs": 0.45}),
    Row(["-c", "import ltca"], {"import ltca": 0.04}),
    Row([*CYCLO, "--help"], {"cyclo --help": 0.09}),
    Row([*CYCLO, "fem", "paper", "--case", "CS-1", "--angle", "0.1"], {"cyclo fem, one position": 6.0}, fem=True),
    Row(["-c", POSITIONS], {"full FE, first position": 3.0, "full FE, next position": 1.5}, of_process=False, fem=True),
)
"""Commands, and what they may take."""


def run(checkout: Path, words: list[str]) -> tuple[float, str]:
    """Return user plus system time, s, of a fresh process of a checkout and its children, and what it printed."""
    own = checkout / ".venv" / "bin" / "python"
    python = str(own) if own.exists() else sys.executable
    environment = os.environ | {"PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        writes = words[:2] == CYCLO and words[-1] != "--help" and "--out" not in words
        out = ["--out", f"{folder}/out"] if writes else []
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        # Run in another folder: the folder of a script is first on the path and would hide modules of the same name.
        done = subprocess.run([python, *words, *out], cwd=folder, env=environment, check=False, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode > 1:  # a check that fails has been made, too
        sys.exit(f"{' '.join(words)}: {done.stderr.decode(errors='replace')[-400:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime, done.stdout.decode(errors="replace")


def times(checkout: Path, row: Row, words: list[str]) -> list[float]:
    """Return the times of a row, s."""
    taken, told = run(checkout, words)
    return [taken] if row.of_process else [float(line) for line in told.split()]


def median(values: list[float]) -> float:
    """Return the median."""
    ordered = sorted(values)
    return 0.5 * (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2])


def measure(row: Row, checkouts: list[Path], coefficients: dict[Path, str], runs: int) -> list[list[float]]:
    """Return the medians of each checkout, one for each aim."""
    words = {
        checkout: [coefficients.get(checkout, word) if word == COEFFICIENTS else word for word in row.words]
        for checkout in checkouts
    }
    taken: dict[Path, list[list[float]]] = {checkout: [] for checkout in checkouts}
    for number in range(runs + (not row.fem)):
        for checkout in checkouts:
            found = times(checkout, row, words[checkout])
            if number or row.fem:  # the first writes bytecode and fills the cache
                taken[checkout].append(found)
    return [[median(list(each)) for each in zip(*taken[checkout], strict=True)] for checkout in checkouts]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", metavar="N", type=int, default=3, help="processes per command; default 3")
    parser.add_argument("--against", metavar="PATH", type=Path, help="another checkout, measured alternately")
    parser.add_argument("--only", metavar="TEXT", default="", help="only rows whose names contain this text")
    parser.add_argument("--fem", action="store_true", help="full finite elements as well")
    arguments = parser.parse_args()
    checkouts = [HERE] if arguments.against is None else [HERE, arguments.against.resolve()]
    chosen = [
        row for row in ROWS if (arguments.fem or not row.fem) and any(arguments.only in name for name in row.aims)
    ]
    heads = ["processor s", "aim"] + (["other", "ratio"] if len(checkouts) > 1 else [])
    with tempfile.TemporaryDirectory() as folder:
        coefficients = dict[Path, str]()
        if any(COEFFICIENTS in row.words for row in chosen):
            for number, checkout in enumerate(checkouts):
                coefficients[checkout] = f"{folder}/{number}.nc"
                run(checkout, [*CYCLO, "derive", "paper", "--case", "CS-1", "--out", coefficients[checkout]])
        print(f"{'':<42}" + "".join(f"{head:>13}" for head in heads))
        for row in chosen:
            found = measure(row, checkouts, coefficients, arguments.runs)
            for place, (name, aim) in enumerate(row.aims.items()):
                cells = [f"{found[0][place]:.2f}", "" if aim is None else f"{aim:.2f}"]
                if len(found) > 1:
                    cells += [f"{found[1][place]:.2f}", f"{found[0][place] / found[1][place]:.2f}"]
                print(f"{name:<42}" + "".join(f"{cell:>13}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
