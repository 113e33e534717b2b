"""Full and read-only disks (temporary file systems): a one-line message, no incomplete files.

Exit status 1 if the disk fills up, 2 if this is foreseen or the disk is read-only, 0 if the space is sufficient.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fault_kinds.programs import COMMANDS, Counts, content, is_one_line, start


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the kind."""
    parser.add_argument("--sizes", nargs="+", default=["4k", "64k", "256k"], help="sizes of the small disks")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS), help="default all")


def execute(arguments: argparse.Namespace) -> int:
    """Run the commands on disks that are too small, and on a read-only disk."""
    counts = Counts()
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        place = Path(name) / "disc"
        place.mkdir()
        for command in arguments.commands:
            for size in arguments.sizes:
                with _mounted(place, f"size={size}") as there:
                    if not there:
                        print("skipped: file systems cannot be mounted here (needs root)")
                        return 0
                    counts.add(
                        f"{command}, full disc", _tried(command, place / "out", Path(name) / "scratch", {0, 1, 2})
                    )
            with _mounted(place, "ro"):
                counts.add(f"{command}, read-only", _tried(command, place / "out", Path(name) / "scratch", {2}))
    return counts.close()


@contextmanager
def _mounted(place: Path, options: str) -> Iterator[bool]:
    words = ["mount", "-t", "tmpfs", "-o", options, "none", str(place)]
    done = subprocess.run(words, capture_output=True, check=False)
    try:
        yield done.returncode == 0
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", "--lazy", str(place)], check=True)


def _tried(command: str, out: Path, scratch: Path, allowed: set[int]) -> str:
    with start(COMMANDS[command], out, scratch) as process:
        said = process.communicate()[1]
    parts = [name for name in (content(out) if out.exists() else {}) if ".part" in name or name.endswith(".lock")]
    if parts:
        return f"left {parts}"
    if process.returncode not in allowed:
        return f"exit status {process.returncode}: {said[-400:]}"
    small_enough = process.returncode == 0 or (process.returncode == 1 and not said.count("cyclo: "))
    return "" if small_enough or is_one_line(said) else said[-400:]
