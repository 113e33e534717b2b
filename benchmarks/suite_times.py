"""Processor time of every test: totals of the quick, the full and the nightly set, and what takes longer than quick tests may.

    python benchmarks/suite_times.py [--only "not slow"] [--processes 2] [--write]
    python benchmarks/suite_times.py --write-nightly

The processor time of a test includes the programs that it starts; fixtures count for the first test that uses them.
``--write`` writes the totals and the seconds of these tests to ``tests/budget.toml``, by which they are slow or nightly
(``tests/conftest.py``); tests that did not run keep what is known of them. Arguments after ``--`` are passed to pytest (files,
``-k``). ``--write-nightly`` runs nothing: it writes there, under ``[nightly]``, the
seconds of each file of the nightly set as the shards kept them under ``build/nightly`` (``pytest -m nightly --shard 1/4``), by
which they are dealt.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[1]
BUDGET = ROOT / "tests" / "budget.toml"
QUICK_SECONDS, FULL_SECONDS = 0.12, 1.2
"""Longest tests of the quick and of the full set, s of processor time."""
SHOWN = 30
FOLDER = "CYCLO_SUITE_TIMES"
"""Environment variable with the folder for the times; it activates the plugin."""


def processor_seconds() -> float:
    """Return the processor time of this process and its terminated children; only the children's is rounded, to 10 ms."""
    times = os.times()
    return time.process_time() + times.children_user + times.children_system


CALLED = pytest.StashKey[bool]()
"""Whether a test was called: one that is skipped has no time."""


def pytest_configure() -> None:
    """Take this folder from what programs inherit: its `fem.py` would hide the package from those that tests start."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in paths if path and Path(path) != Path(__file__).parent)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Remember that a test is called and does not skip itself."""
    try:
        found = yield
    except pytest.skip.Exception:
        raise
    except BaseException:
        item.stash[CALLED] = True
        raise
    item.stash[CALLED] = True
    return found


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, Any, Any]:
    """Time a test with its set-up and write the time immediately, so that it survives a killed worker."""
    began = processor_seconds()
    try:
        return (yield)
    finally:
        if item.stash.get(CALLED, False):
            marks = sorted({mark.name for mark in item.iter_markers()} & {"slow", "nightly"})
            path = Path(os.environ[FOLDER]) / f"{os.getpid()}.jsonl"
            with path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps([item.nodeid, processor_seconds() - began, marks]) + "\n")


def set_of(marks: list[str]) -> str:
    """Return the set a test belongs to: quick, slow or nightly."""
    return "nightly" if "nightly" in marks else "slow" if "slow" in marks else "quick"


class Measured(NamedTuple):
    """What a run took."""

    tests: list[tuple[str, float, list[str]]]
    """Name, processor time, s, and marks of every test, the slowest first."""
    clock: float
    """s."""
    processor: float
    """Of all processes, s: with their start, imports and the collection of the tests."""
    status: int
    """Exit status of pytest."""


def measure(only: str, processes: int, words: list[str]) -> Measured:
    """Run the tests and return what they took."""
    with tempfile.TemporaryDirectory(prefix="suite-times-") as folder:
        environment = dict(os.environ, **{FOLDER: folder, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"})
        environment["PYTHONPATH"] = os.pathsep.join(
            filter(None, [str(Path(__file__).parent), os.environ.get("PYTHONPATH")])
        )
        command = [sys.executable, "-m", "pytest", "-q", "-p", "suite_times", "-n", str(processes)]
        command += ["-m", only] if only else []
        began, before = time.monotonic(), processor_seconds()
        status = subprocess.run([*command, *words], cwd=ROOT, env=environment, check=False).returncode
        lasted, spent = time.monotonic() - began, processor_seconds() - before
        lines = [
            line for path in Path(folder).glob("*.jsonl") for line in path.read_text(encoding="utf-8").splitlines()
        ]
    found = [json.loads(line) for line in lines]
    tests = sorted(((name, seconds, marks) for name, seconds, marks in found), key=lambda x: -x[1])
    return Measured(tests=tests, clock=lasted, processor=spent, status=status)


def text_of(run: Measured, known: dict[str, float]) -> str:
    """Return totals and the seconds of tests that are not quick as TOML; `known` are those of tests that may not have run."""
    seconds: defaultdict[str, float] = defaultdict(float)
    count: Counter[str] = Counter()
    for _, spent, marks in run.tests:
        seconds[set_of(marks)] += spent
        count[set_of(marks)] += 1
    lines = [
        "# Processor seconds of the tests; made by python benchmarks/suite_times.py --write, compared by eye in a review.",
        "# The budget: quick set 60 s and full set 360 s on two cores, so 120 and 720 s of processor time. What takes longer",
        "# than quick_seconds is slow, longer than full_seconds nightly (tests/conftest.py), whatever its marks.",
        f"quick_seconds = {QUICK_SECONDS}",
        f"full_seconds = {FULL_SECONDS}",
        f"clock_seconds = {run.clock:.0f}",
        f"processor_seconds = {run.processor:.0f}",
    ]
    lines += [
        f"{name}_set = {{ tests = {count[name]}, processor_seconds = {seconds[name]:.0f} }}"
        for name in ("quick", "slow", "nightly")
        if count[name]
    ]
    lasted = known | {name: spent for name, spent, _ in run.tests}
    slowest = sorted(lasted.items(), key=lambda item: -item[1])
    lines += ["", "[seconds]"]
    lines += [f"{json.dumps(name)} = {spent:.2f}" for name, spent in slowest if spent > QUICK_SECONDS]
    return "\n".join(lines) + "\n"


NIGHTLY = "\n[nightly]\n"


def nightly_text(folder: Path) -> str:
    """Return the seconds of each file of the nightly set, as its shards kept them, as TOML; the last outcome of a test counts."""
    sys.path.insert(0, str(ROOT / "tests" / "plugins"))
    from shards import outcomes

    last = {kept["test"]: kept["seconds"] for kept in outcomes(folder) if kept.get("outcome") in ("passed", "failed")}
    seconds: Counter[str] = Counter()
    for name, spent in last.items():
        seconds[name.partition("::")[0]] += spent
    lines = [
        "# Seconds of whole files of the nightly set on one worker: pytest --shard deals by them. Made by --write-nightly.",
        *(f"{json.dumps(name)} = {max(spent, 1):.0f}" for name, spent in seconds.most_common()),
    ]
    return NIGHTLY + "\n".join(lines) + "\n"


def main() -> int:
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="expression of pytest's -m; default: all but nightly")
    parser.add_argument("--processes", type=int, default=2, help="workers of pytest-xdist; default 2")
    parser.add_argument("--write", action="store_true", help="write tests/budget.toml")
    parser.add_argument(
        "--write-nightly", action="store_true", help="write [nightly] of tests/budget.toml from build/nightly"
    )
    parser.add_argument("words", nargs="*", help="further arguments of pytest, after --")
    arguments = parser.parse_args()
    budget = BUDGET.read_text(encoding="utf-8")
    slowest, _, nightly = budget.partition(NIGHTLY)
    if arguments.write_nightly:
        BUDGET.write_text(slowest + nightly_text(ROOT / "build" / "nightly"), encoding="utf-8")
        return 0
    run = measure(arguments.only, arguments.processes, arguments.words)
    text = text_of(run, tomllib.loads(budget)["seconds"])
    print("\n".join(text.splitlines()[: text.splitlines().index("[seconds]") + SHOWN]))
    if run.status not in (0, 1):  # interrupted, or no tests found: the times are incomplete
        print(f"pytest ended with status {run.status}: the times are incomplete", file=sys.stderr)
        return 2
    if arguments.write:
        BUDGET.write_text(text + NIGHTLY + nightly, encoding="utf-8")
    return run.status


if __name__ == "__main__":
    sys.exit(main())
