"""Parts of a long set of tests that run one after the other and can be resumed: ``pytest -m nightly --shard 1/4``.

Whole files are dealt to the shards by the seconds that ``tests/budget.toml`` lists under ``[nightly]``, so that the shards last
about equally long. The dealing depends on the selected tests and on that table alone.

The outcome of every test is appended to ``build/nightly/shard-1-of-4.jsonl`` as soon as it is known, with a hash of the code and
of the files that tests read (`READ_BY_TESTS`: documents, data, plugins). A later run skips the tests that passed with the same
hash, in whichever shard, and continues with the others; ``--kept`` changes which outcomes count.
"""

from __future__ import annotations

import hashlib
import json
import re
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

PACKAGES = ("ltca", "fem", "validation", "benchmarks", "examples")
"""Packages whose code an outcome depends on, beside the file of the test and the conftest files above it."""
READ_BY_TESTS = (
    "pyproject.toml", "*.md", ".ci/*", "docs/**/*.md", "docs/**/*.rst", "docs/*.py", "examples/**/*.md",
    "tests/**/*.toml", "tests/**/*.csv", "tests/**/*.json", "tests/**/*.py",
)  # fmt: skip
"""Files that tests read or that plugins of pytest are made of: an outcome of any test depends on all of them."""
NOT_READ = re.compile(
    r"(test_\w+|conftest)\.py$|tests/budget\.toml$|CHANGELOG\.md$|docs/(gallery|build|reference/generated)/"
)
"""Except what each test has for itself, what only deals the tests out, what releases alone read, what is built."""
SECONDS_PER_TEST = 8.0
"""Assumed for a file that the table of seconds does not list."""
FOLDER = Path("build", "nightly")
PHASES = ("setup", "call", "teardown")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the options."""
    group = parser.getgroup("shards")
    group.addoption(
        "--shard", type=shard_of, metavar="K/N", help="run the K-th of N parts of the selected tests, resumable"
    )
    group.addoption(
        "--kept", choices=("same-code", "any-code", "none"), default="same-code",
        help="with --shard: passed tests of earlier runs that are not run again; none deletes what this shard kept",
    )  # fmt: skip


def shard_of(text: str) -> tuple[int, int]:
    """Return the number of a shard, from 1, and the number of shards."""
    match = re.fullmatch(r"([1-9][0-9]*)/([1-9][0-9]*)", text)
    if match is None or int(match[1]) > int(match[2]):
        raise ValueError(f"{text}: must be K/N with 1 <= K <= N")  # argparse names option and value
    return int(match[1]), int(match[2])


def pytest_configure(config: pytest.Config) -> None:
    """Read what earlier runs kept, once, in the process that collects the outcomes of all workers."""
    if config.option.shard is not None:
        config.pluginmanager.register(
            _Worker(config) if hasattr(config, "workerinput") else _Recorder(config), "shard of the tests"
        )


def file_of(nodeid: str) -> str:
    """Return the file of a test."""
    return nodeid.partition("::")[0]


def seconds_of(counts: Counter[str], known: dict[str, float]) -> dict[str, float]:
    """Return the seconds that each file is assumed to take, from its number of tests where no time is known."""
    return {name: known.get(name, SECONDS_PER_TEST * number) for name, number in counts.items()}


def deal(seconds: dict[str, float], shards: int) -> dict[str, int]:
    """Return the shard of each file, from 1: the longest file first, each to the shard with the least so far."""
    sums = [0.0] * shards
    dealt = {}
    for name in sorted(seconds, key=lambda name: (-seconds[name], name)):
        least = min(range(shards), key=sums.__getitem__)
        sums[least] += seconds[name]
        dealt[name] = least + 1
    return dealt


def known_seconds(root: Path) -> dict[str, float]:
    """Return the seconds of files of earlier runs, as reviewed."""
    path = root / "tests" / "budget.toml"
    table = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return dict(table.get("nightly", {}))


def outcomes(folder: Path) -> Iterator[dict[str, Any]]:
    """Yield the outcomes that are kept in a folder, those of the shard that ran last at the end; a line that was cut is none."""
    for path in sorted(folder.glob("shard-*.jsonl"), key=lambda path: (path.stat().st_mtime, path.name)):
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                yield json.loads(line)
            except ValueError:
                continue


class _Code:
    """Hashes of the code, and of the files read by tests, that the outcome of a test depends on."""

    def __init__(self, root: Path) -> None:
        from ltca.output.provenance import code_hash

        self._root = root
        self._common = hashlib.sha256(code_hash(*PACKAGES).encode())
        for path in sorted({path for pattern in READ_BY_TESTS for path in root.glob(pattern)}):
            name = path.relative_to(root).as_posix()
            if path.is_file() and not NOT_READ.search(name):
                content = path.read_bytes()
                self._common.update(f"{name}\0{len(content)}\0".encode() + content)
        self.of = cache(self._of)

    def _of(self, name: str) -> str:
        """Return the hash for the tests of a file."""
        digest = self._common.copy()
        path = self._root / name
        conftests = [folder / "conftest.py" for folder in path.parents if folder.is_relative_to(self._root)]
        for source in (path, *conftests):
            digest.update(source.read_bytes() if source.is_file() else b"-")
        return digest.hexdigest()[:16]


class _Worker:
    """Selection of the tests of a shard, in a process that runs tests."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.passed: set[str] = set(getattr(config, "workerinput", {}).get("passed_before", ()))

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Keep the tests of this shard that have not passed yet, those of the longest file first."""
        number, shards = self.config.option.shard
        seconds = seconds_of(Counter(file_of(item.nodeid) for item in items), known_seconds(self.config.rootpath))
        dealt = deal(seconds, shards)
        mine = [item for item in items if dealt[file_of(item.nodeid)] == number]
        kept = [item for item in mine if item.nodeid not in self.passed]
        kept.sort(key=lambda item: -seconds[file_of(item.nodeid)])
        self.config.hook.pytest_deselected(items=[item for item in items if item not in set(kept)])
        items[:] = kept


class _Recorder(_Worker):
    """Collection of the outcomes of all workers, and the tests of a run without workers."""

    def __init__(self, config: pytest.Config) -> None:
        super().__init__(config)
        number, shards = config.option.shard
        self.path = config.rootpath / FOLDER / f"shard-{number}-of-{shards}.jsonl"
        self.code = _Code(config.rootpath)
        self.began = time.monotonic()
        self.reports: defaultdict[str, list[pytest.TestReport]] = defaultdict(list)
        self.counts: Counter[str] = Counter()
        if self.path.is_file() and not self.path.read_bytes().endswith(
            b"\n"
        ):  # cut: the next outcome gets its own line
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write("\n")
        wanted = config.option.kept
        if wanted == "none":
            self.path.unlink(missing_ok=True)
        else:
            last = {line["test"]: line for line in outcomes(self.path.parent) if "test" in line}
            self.passed = {
                test for test, line in last.items()
                if line["outcome"] == "passed" and (wanted == "any-code" or line["code"] == self.code.of(file_of(test)))
            }  # fmt: skip

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        """Hand the tests that passed before to a worker of pytest-xdist: all workers must select the same ones."""
        node.workerinput["passed_before"] = sorted(self.passed)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Append the outcome of a test that has ended; of one whose worker died there is no end."""
        reports = self.reports[report.nodeid]
        reports.append(report)
        if report.when in PHASES[:2]:
            return
        del self.reports[report.nodeid]
        outcome = outcome_of(reports)
        self.counts[outcome] += 1
        seconds = round(sum(one.duration for one in reports), 2)
        code = self.code.of(file_of(report.nodeid))
        self._append({"test": report.nodeid, "outcome": outcome, "seconds": seconds, "code": code})

    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Write how long the run took; a shard with nothing left to run is a success."""
        if session.exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and self.passed:
            session.exitstatus = pytest.ExitCode.OK
        if self.counts:
            self._append({"clock_seconds": round(time.monotonic() - self.began), **self.counts})

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Say where the outcomes are."""
        number, shards = self.config.option.shard
        parts = [f"{count} {outcome}" for outcome, count in sorted(self.counts.items())] or ["nothing left to run"]
        terminalreporter.write_line(
            f"shard {number}/{shards}: {', '.join(parts)}; {len(self.passed)} passed in earlier runs of any shard; "
            f"kept in {self.path.relative_to(self.config.rootpath).as_posix()}"
        )

    def _append(self, line: dict[str, Any]) -> None:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps(line) + "\n")


def outcome_of(reports: Iterable[pytest.TestReport]) -> str:
    """Return the outcome of a test from those of its phases; an expected failure passes."""
    reports = list(reports)
    if any(report.failed for report in reports):
        return "failed"
    return "skipped" if any(report.skipped and not hasattr(report, "wasxfail") for report in reports) else "passed"
