"""Malformed drives and studies: refused with a short message, or solved.

``malformed`` passes drives to ``cyclo run`` and studies to ``cyclo sweep --sample 0``. A file that is certainly wrong must give
exit status 2 and a few printable lines, any other file the same or a result. Tracebacks and warnings are faults, and so are
refusals that take more than two seconds (without the imports of a process, about half a second on an idle processor).
"""

from __future__ import annotations

import argparse
import contextlib
import io
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

from ltca.commands.program import main as cyclo
from ltca.errors import MOST_TOLD
from ltca.testing.malformed import Malformed, malformed_drives, malformed_studies

LIMIT = 2.0
"""Permitted time of a refusal, s."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("--count", type=int, default=1000, help="number of drives, and of studies; default 1000")
    parser.add_argument("--seed", type=int, default=1, help="seed of the generator; default 1")


def execute(arguments: argparse.Namespace) -> int:
    """Run all files, print counts and faults, and return 1 if there is a fault."""
    tried: Counter[str] = Counter()
    slowest = 0.0
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder) / "file.toml", str(Path(folder) / "out")
        kinds = {
            "drives": (malformed_drives, ["run", str(path), "--positions", "2", "--no-figures", "--out", out]),
            "studies": (malformed_studies, ["sweep", str(path), "--sample", "0", "--out", out]),
        }
        for kind, (generate, words) in kinds.items():
            _run([words[0], str(path), *words[2:]])  # missing file: includes the imports in the first call
            for sample in generate(arguments.seed, arguments.count):
                path.write_bytes(sample.content)
                status, message, seconds = _run(words)
                fault = _fault(sample, status, message, seconds)
                tried[f"{kind} {'wrong' if fault else 'refused' if status == 2 else 'solved or without balance'}"] += 1
                slowest = max(slowest, seconds if status == 2 else 0.0)
                if fault:
                    print(f"{kind}: {sample.about}: {fault}: {message[:300]!r}")
    for name, number in sorted(tried.items()):
        print(f"{number:>6} {name}")
    wrong = sum(number for name, number in tried.items() if name.endswith("wrong"))
    print(f"tried {tried.total()}, right {tried.total() - wrong}, wrong {wrong}; slowest refusal {slowest:.2f} s")
    return 1 if wrong else 0


def _run(words: list[str]) -> tuple[int, str, float]:
    """Return exit status, stderr (including warnings) and duration, s."""
    told, start = io.StringIO(), time.perf_counter()
    with contextlib.redirect_stderr(told), contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("always")
        try:
            status = cyclo(words)
        except SystemExit as stopped:
            status = int(stopped.code or 0)
    return status, told.getvalue(), time.perf_counter() - start


def _fault(sample: Malformed, status: int, message: str, seconds: float) -> str:
    """Return a description of the fault of a response; empty if there is none."""
    lines = message.rstrip("\n").split("\n")
    if sample.wrong and status != 2:
        return f"exit status {status}"
    if status == 0:
        return "told something" if any("Warning" in line for line in lines) else ""
    if "unforeseen" in message or "Traceback" in message or not lines[0].startswith("cyclo: error: "):
        return "not a message for a user"
    if len(lines) > 1 + MOST_TOLD or not all(line.isprintable() and len(line) < 1500 for line in lines):
        return "not a few clear lines"
    return f"took {seconds:.1f} s" if status == 2 and sample.wrong and seconds > LIMIT else ""
