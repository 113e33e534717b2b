"""Processor time of every test: totals of the quick, the full and the nightly set, and the fifty slowest.

    python benchmarks/suite_times.py [--only "not slow"] [--processes 2] [--write]

The processor time of a test includes the programs that it starts; fixtures count for the first test that uses them.
``--write`` writes the totals and the fifty slowest tests to ``tests/budget.toml``, for reviews; they are not asserted. Arguments
after ``--`` are passed to pytest (files, ``-k``).
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
BUDGET = ROOT / "tests" / "budget.toml"
LISTED = 50
FOLDER = "CYCLO_SUITE_TIMES"
"""Environment variable with the folder for the times; it activates the plugin."""


def processor_seconds() -> float:
    """Return the processor time of this process and its terminated children."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, Any, Any]:
    """Time a test with its set-up and write the time immediately, so that it survives a killed worker."""
    began = processor_seconds()
    try:
        return (yield)
    finally:
        marks = sorted({mark.name for mark in item.iter_markers()} & {"slow", "nightly"})
        path = Path(os.environ[FOLDER]) / f"{os.getpid()}.jsonl"
        with path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps([item.nodeid, processor_seconds() - began, marks]) + "\n")


def set_of(marks: list[str]) -> str:
    """Return the set a test belongs to: quick, slow or nightly."""
    return "nightly" if "nightly" in marks else "slow" if "slow" in marks else "quick"


def measure(only: str, processes: int, words: list[str]) -> tuple[list[tuple[str, float, list[str]]], float, int]:
    """Return name, processor time, s, and marks of all tests, the wall time, s, and the exit status of pytest."""
    with tempfile.TemporaryDirectory(prefix="suite-times-") as folder:
        environment = dict(os.environ, **{FOLDER: folder, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
        environment["PYTHONPATH"] = os.pathsep.join(
            filter(None, [str(Path(__file__).parent), os.environ.get("PYTHONPATH")])
        )
        command = [sys.executable, "-m", "pytest", "-q", "-p", "suite_times", "-n", str(processes)]
        command += ["-m", only] if only else []
        began = time.monotonic()
        status = subprocess.run([*command, *words], cwd=ROOT, env=environment, check=False).returncode
        lasted = time.monotonic() - began
        lines = [
            line for path in Path(folder).glob("*.jsonl") for line in path.read_text(encoding="utf-8").splitlines()
        ]
    found = [json.loads(line) for line in lines]
    return sorted(((name, seconds, marks) for name, seconds, marks in found), key=lambda x: -x[1]), lasted, status


def text_of(found: list[tuple[str, float, list[str]]], lasted: float) -> str:
    """Return totals and the slowest tests as TOML."""
    seconds: defaultdict[str, float] = defaultdict(float)
    count: Counter[str] = Counter()
    for _, spent, marks in found:
        seconds[set_of(marks)] += spent
        count[set_of(marks)] += 1
    lines = [
        "# Processor seconds of the tests; made by python benchmarks/suite_times.py --write, compared by eye in a review.",
        "# The budget: quick set 60 s and full set 360 s on two cores, so 120 and 720 s of processor time.",
        f"clock_seconds = {lasted:.0f}",
    ]
    lines += [
        f"{name} = {{ tests = {count[name]}, processor_seconds = {seconds[name]:.0f} }}"
        for name in ("quick", "slow", "nightly")
        if count[name]
    ]
    lines += ["", "[slowest]"]
    lines += [f"{json.dumps(name)} = {spent:.1f}" for name, spent, _ in found[:LISTED]]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="expression of pytest's -m; default: all but nightly")
    parser.add_argument("--processes", type=int, default=2, help="workers of pytest-xdist; default 2")
    parser.add_argument("--write", action="store_true", help="write tests/budget.toml")
    parser.add_argument("words", nargs="*", help="further arguments of pytest, after --")
    arguments = parser.parse_args()
    found, lasted, status = measure(arguments.only, arguments.processes, arguments.words)
    text = text_of(found, lasted)
    print(text)
    if status not in (0, 1):  # interrupted, or no tests found: the times are incomplete
        print(f"pytest ended with status {status}: the times are incomplete", file=sys.stderr)
        return 2
    if arguments.write:
        BUDGET.write_text(text, encoding="utf-8")
    return status


if __name__ == "__main__":
    sys.exit(main())
