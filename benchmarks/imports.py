"""Start-up time of program and package: processor and wall time of fresh processes.

    python benchmarks/imports.py [--rounds 5]

Values are the smallest of several rounds; compare with the bare interpreter and numpy in the first rows. For the import time
of single modules: ``python -X importtime -m ltca.commands.program --help``.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time

ROWS = {
    "python": ["-c", "pass"],
    "import numpy": ["-c", "import numpy"],
    "import xarray": ["-c", "import xarray"],
    "import ltca": ["-c", "import ltca"],
    "ltca.load_drive, ltca.analyse": ["-c", "import ltca; ltca.load_drive, ltca.analyse"],
    "cyclo --version": ["-m", "ltca.commands.program", "--version"],
    "cyclo --help": ["-m", "ltca.commands.program", "--help"],
    "cyclo run --help": ["-m", "ltca.commands.program", "run", "--help"],
    "cyclo run paper, one position": ["-m", "ltca.commands.program", "run", "paper", "--angles", "0", "--no-figures"],
}


def spent(words: list[str]) -> tuple[float, float]:
    """Return processor and wall time, s, of a fresh interpreter."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, *words, *(["--out", f"{folder}/run"] if "--no-figures" in words else [])]
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
        wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="number of rounds; default 5")
    rounds = parser.parse_args().rounds
    print(f"{'':<34}{'processor s':>12}{'wall s':>9}")
    for name, words in ROWS.items():
        processor, wall = (min(times) for times in zip(*(spent(words) for _ in range(rounds)), strict=True))
        print(f"{name:<34}{processor:>12.2f}{wall:>9.2f}")


if __name__ == "__main__":
    main()
