"""Commands killed at random times and restarted: identical output, no remaining processes or temporary files."""

from __future__ import annotations

import argparse
import random
import shutil
import signal
import tempfile
import time
from pathlib import Path

from fault_kinds.programs import COMMANDS, Counts, content, left_over, start


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the kind."""
    parser.add_argument("--kills", type=int, default=20, help="kills per command; default 20")
    parser.add_argument("--commands", nargs="+", choices=COMMANDS, default=list(COMMANDS), help="default all")
    parser.add_argument("--signal", choices=("KILL", "TERM"), default="KILL", help="default KILL")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random times; default 1")


def execute(arguments: argparse.Namespace) -> int:
    """Kill and restart every command."""
    counts, number = Counts(), signal.Signals[f"SIG{arguments.signal}"]
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = Path(name)
        for command in arguments.commands:
            rng = random.Random(f"{arguments.seed} {command}")
            began = time.monotonic()
            said = _whole(command, folder / f"{command}-whole", folder / "scratch")
            took = time.monotonic() - began
            if said:
                counts.add(command, f"does not run at all: {said}")
                continue
            wanted = content(folder / f"{command}-whole")
            print(f"{command}: {took:.1f} s, {len(wanted)} files", flush=True)
            for trial in range(arguments.kills):
                out = folder / f"{command}-{trial}"
                delay = rng.uniform(0.2, 1.0) * took
                complaint = _killed(command, out, folder / f"scratch-{command}-{trial}", delay, number)
                complaint = complaint or _whole(command, out, folder / "scratch")
                if not complaint and content(out) != wanted:
                    have = content(out)
                    other = [name for name in {*have, *wanted} if have.get(name) != wanted.get(name)]
                    complaint = f"other bytes after a kill at {delay:.2f} s: {sorted(other)}"
                counts.add(f"{command}, SIG{arguments.signal}", complaint)
                shutil.rmtree(out, ignore_errors=True)
    return counts.close()


def _whole(command: str, out: Path, scratch: Path) -> str:
    with start(COMMANDS[command], out, scratch) as process:
        said = process.communicate()[1]
    # Status 1 is a failed check: coarse meshes do not meet the limits.
    return "" if process.returncode in (0, 1) and "cyclo: error" not in said else f"{process.returncode}: {said[-300:]}"


def _killed(command: str, out: Path, scratch: Path, delay: float, number: signal.Signals) -> str:
    with start(COMMANDS[command], out, scratch) as process:
        time.sleep(delay)
        running = process.poll() is None
        process.send_signal(number)
        said = process.communicate()[1]
    if running and number == signal.SIGTERM and process.returncode not in (0, 1, 143, -signal.SIGTERM):
        return f"exit status {process.returncode} at {delay:.2f} s: {said[-300:]}"
    if "Traceback" in said:
        return f"traceback at {delay:.2f} s: {said[-600:]}"
    return left_over(scratch)
