"""Processor time of common commands in fresh processes: ``cyclo run paper``, ``check``, ``fem``, imports.

Every value is the median of user plus system time, with bytecode compiled before. Two checkouts are measured alternately
(A B A B), so that other load of the machine affects both equally.

    python benchmarks/startup.py
    python benchmarks/startup.py --runs 5 --against ../before
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
CYCLO = ["-m", "ltca.commands.program"]
COMMANDS = {
    "cyclo run paper": [*CYCLO, "run", "paper"],
    "cyclo run paper --no-page --no-figures": [*CYCLO, "run", "paper", "--no-page", "--no-figures"],
    "cyclo check paper": [*CYCLO, "check", "paper"],
    "cyclo fem paper, one position, coarse": [
        *CYCLO, "fem", "paper", "--case", "CS-1", "--angle", "0.1", "--size", "4",
    ],
    "import ltca": ["-c", "import ltca"],
    "cyclo --help": [*CYCLO, "--help"],
}  # fmt: skip


def processor_time(checkout: Path, words: list[str]) -> float:
    """Return user plus system time, s, of a fresh process of a checkout and its children."""
    own = checkout / ".venv" / "bin" / "python"
    python = str(own) if own.exists() else sys.executable
    environment = os.environ | {"PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryDirectory() as folder:
        out = ["--out", f"{folder}/out"] if words[:2] == CYCLO and words[-1] != "--help" else []
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        # Run in another folder: the folder of a script is first on the path and would hide modules of the same name.
        subprocess.run([python, *words, *out], cwd=folder, env=environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _median(values: list[float]) -> float:
    ordered = sorted(values)
    return 0.5 * (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", metavar="N", type=int, default=3, help="processes per command; default 3")
    parser.add_argument("--against", metavar="PATH", type=Path, help="another checkout, measured alternately")
    parser.add_argument("--only", metavar="TEXT", default="", help="only commands that contain this text")
    arguments = parser.parse_args()
    checkouts = [HERE] if arguments.against is None else [HERE, arguments.against.resolve()]
    chosen = {name: words for name, words in COMMANDS.items() if arguments.only in name}
    heads = ["processor s"] if len(checkouts) == 1 else ["processor s", "other", "ratio"]
    print(f"{'':<42}" + "".join(f"{head:>13}" for head in heads))
    for name, words in chosen.items():
        for checkout in checkouts:
            processor_time(checkout, words)  # writes bytecode and fills the cache
        taken: list[list[float]] = [[] for _ in checkouts]
        for _ in range(arguments.runs):
            for own, checkout in zip(taken, checkouts, strict=True):
                own.append(processor_time(checkout, words))
        medians = [_median(own) for own in taken]
        cells = medians if len(medians) == 1 else [*medians, medians[0] / medians[1]]
        print(f"{name:<42}" + "".join(f"{cell:>13.2f}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
