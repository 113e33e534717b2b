"""Start commands as processes and compare their output folders."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from ltca.output.process_pools import remove_stale_folders
from ltca.output.run_folder import MANIFEST

# Commands with small problem sizes; {out} is the output folder or file.
COMMANDS = {
    "run": "run paper --case CS-1 --positions 28 --no-figures --out {out}",
    "tolerance": "tolerance paper --samples 400 --positions 4 --out {out}",
    "optimise": "optimise paper --vary eccentricity=3.9:4.1 --minimise max_pin_load --positions 8 --generations 1 "
    "--no-figures --out {out}",
    "derive": "derive paper --case CS-3 --stations 0.25 --size 2 --out {out}/c.nc",
    "fem": "fem paper --case CS-3 --angle 0.5 --size 4 --no-pictures --out {out}",
    "validate": "validate paper --case CS-3 --angles 0.5 --size 4 --out {out}",
}
# Folders kept between runs.
BESIDE = ("kept", "batches")


def start(words: str, out: Path, scratch: Path) -> subprocess.Popen[str]:
    """Start a command in a new session with a separate folder for temporary files."""
    scratch.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "TMPDIR": str(scratch), "MPLBACKEND": "Agg"}
    resume = ["--resume"] if (out / "study.json").exists() and any(out.glob("batches/*.npz")) else []
    arguments = [sys.executable, "-m", "ltca.commands.program", *words.format(out=out).split(), *resume]
    return subprocess.Popen(
        arguments,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
        start_new_session=True,
    )


def content(folder: Path) -> dict[str, bytes]:
    """Return the files of a run by name, without kept folders and without times."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name.partition("/")[0] not in BESIDE and path.name != MANIFEST:
            found[name] = path.read_bytes()
            if path.suffix == ".json":
                found[name] = json.dumps(_timeless(json.loads(found[name]))).encode()
    return found


def _timeless(value: object) -> object:
    if isinstance(value, dict):
        return {name: _timeless(item) for name, item in value.items() if not name.startswith("seconds")}
    return value


def left_over(scratch: Path, seconds: float = 15.0) -> str:
    """Return processes and temporary files that remain after a program has ended; empty if there are none."""
    end = time.monotonic() + seconds
    while True:
        remove_stale_folders(scratch, 0.0)  # as at the start of the next pool
        processes = []
        for path in Path("/proc").glob("[0-9]*"):
            try:
                state = (path / "stat").read_text().rpartition(")")[2].split()[0]
                if state != "Z" and str(scratch).encode() in (path / "environ").read_bytes():
                    processes.append(path.name)
            except OSError:
                continue
        files = [path.name for path in scratch.iterdir()]
        if not processes and not files:
            return ""
        if time.monotonic() > end:
            return f"left: processes {processes}, files {files}"
        time.sleep(0.1)


def is_one_line(said: str) -> bool:
    """Return whether the output has exactly one error line and no traceback."""
    lines = [line for line in said.splitlines() if line.startswith("cyclo: ")]
    return len(lines) == 1 and "Traceback" not in said


class Counts:
    """Counts of trials and failures by name."""

    def __init__(self) -> None:
        self._tried: Counter[str] = Counter()
        self._wrong: Counter[str] = Counter()

    def add(self, name: str, complaint: str) -> None:
        """Record a trial; an empty complaint means success."""
        self._tried[name] += 1
        if complaint:
            self._wrong[name] += 1
            print(f"{name}: WRONG: {complaint}", flush=True)

    def close(self) -> int:
        """Print the counts and return the exit status."""
        for name, tried in self._tried.items():
            print(f"{name:<40} tried {tried:>4}, right {tried - self._wrong[name]:>4}, wrong {self._wrong[name]:>4}")
        return 1 if self._wrong else 0
