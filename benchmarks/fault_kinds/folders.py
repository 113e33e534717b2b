"""Two runs in one folder: one completes, the other is refused with a one-line message."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from fault_kinds.programs import COMMANDS, Counts, content, is_one_line, start


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the kind."""
    parser.add_argument("--pairs", type=int, default=5, help="pairs per command; default 5")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS), help="default all")


def execute(arguments: argparse.Namespace) -> int:
    """Start every command twice at the same time."""
    counts = Counts()
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        for command in arguments.commands:
            alone = folder / f"{command}-alone"
            with start(COMMANDS[command], alone, folder / "scratch") as process:
                process.communicate()
            for pair in range(arguments.pairs):
                out = folder / f"{command}-{pair}"
                both = [start(COMMANDS[command], out, folder / f"scratch-{number}") for number in range(2)]
                said = [process.communicate()[1] for process in both]
                status = sorted(process.returncode for process in both)
                refused = [text for text, process in zip(said, both, strict=True) if process.returncode == 2]
                complaint = ""
                if len(refused) != 1 or status[0] not in (0, 1) or not is_one_line(refused[0]):
                    complaint = f"exit status {status}: {said}"
                elif content(out) != content(alone):
                    complaint = "other files than alone"
                counts.add(f"{command}, two in one folder", complaint)
    return counts.close()
