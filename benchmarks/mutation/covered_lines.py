"""Coverage map from lines to tests, computed per test file and stored until a source or the test file changes.

Lines executed by a fixture of module or session scope count for all tests that use the fixture. Every test file runs in a
separate process, so that caches of the packages (tables, grids) are built again.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections import defaultdict
from collections.abc import Generator, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from mutation.formulas import PACKAGES, Mutant
from mutation.processes import PYTEST_WORDS


def processor_seconds() -> float:
    """Return the processor time of this process and its children."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


class LineWatch:
    """Plugin of pytest that passes the name of the running test to `coverage`."""

    def __init__(self, watch: Any) -> None:
        self.watch = watch
        self.current = ""
        self.tests: dict[str, tuple[float, str]] = {}
        self.uses: dict[str, list[str]] = defaultdict(list)

    @staticmethod
    def fixture_name(definition: pytest.FixtureDef[Any]) -> str:
        """Return the coverage context of a fixture."""
        return f"fixture {definition.baseid}::{definition.argname}"

    def _switch(self, context: str) -> str:
        before, self.current = self.current, context
        self.watch.switch_context(context)
        return before

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        """Time a test and record its fixtures."""
        for definitions in getattr(item, "_fixtureinfo", None).name2fixturedefs.values():  # type: ignore[union-attr]
            for definition in definitions:
                if definition.scope != "function":
                    self.uses[self.fixture_name(definition)].append(item.nodeid)
        self._switch(item.nodeid)
        began = processor_seconds()
        try:
            return (yield)
        finally:
            _, outcome = self.tests.get(item.nodeid, (0.0, "passed"))
            self.tests[item.nodeid] = (processor_seconds() - began, outcome)
            self._switch("")

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Generator[None, object, object]:
        """Use a separate context for a shared fixture."""
        if fixturedef.scope == "function":
            return (yield)
        before = self._switch(self.fixture_name(fixturedef))
        try:
            return (yield)
        finally:
            self._switch(before)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Record tests that do not pass on the original."""
        if report.outcome != "passed":
            self.tests[report.nodeid] = (0.0, report.outcome)


def map_file(tree: Path, path: str, *, slow: bool) -> dict[str, Any]:
    """Run one file of tests and return its part of the map; to be called in a fork.

    Returns
    -------
    dict
        ``tests``: seconds and outcome by name; ``lines``: for each source file and line, numbers of tests in that order.
    """
    import coverage

    watch = coverage.Coverage(data_file=None, source=[str(tree / name) for name in PACKAGES], messages=False)
    watch.start()
    plugin = LineWatch(watch)
    code = int(pytest.main([path, *PYTEST_WORDS, *([] if slow else ["-m", "not slow"])], plugins=[plugin]))
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.NO_TESTS_COLLECTED):
        raise RuntimeError(f"pytest ended with {code}")
    watch.stop()
    names = list(plugin.tests)
    numbers = {name: number for number, name in enumerate(names)}
    data = watch.get_data()
    lines: dict[str, dict[int, list[int]]] = {}
    for measured in data.measured_files():
        if not measured.endswith(".py"):  # templates of pages
            continue
        own: dict[int, list[int]] = {}
        for line, contexts in data.contexts_by_lineno(measured).items():
            users = {user for context in contexts for user in plugin.uses.get(context, [context])}
            found = sorted(numbers[user] for user in users if user in numbers)
            if found:
                own[line] = found
        if own:
            lines[str(Path(measured).relative_to(tree))] = own
    return {"tests": plugin.tests, "lines": lines}


def test_files(tree: Path) -> list[str]:
    """Return the test files: those of `tests` and modules with doctests."""
    found = [str(path.relative_to(tree)) for path in sorted((tree / "tests").rglob("test_*.py"))]
    for package in PACKAGES:
        sources = sorted((tree / package).rglob("*.py"))
        found += [str(path.relative_to(tree)) for path in sources if ">>> " in path.read_text(encoding="utf-8")]
    return found


def nearest_files(tree: Path, path: str, count: int) -> list[str]:
    """Return at most `count` test files nearest to a source: named after it, in the mirrored folder, or importing it.

    Within these groups smaller files, which are faster, come first.
    """
    source = Path(path)
    module = ".".join(source.with_suffix("").parts)
    imports = re.compile(
        rf"\b{re.escape(module)}\b|from {re.escape(module.rpartition('.')[0])} import [^\n]*\b{source.stem}\b"
    )
    ranked = []
    for name in test_files(tree):
        place, text = Path(name), (tree / name).read_text(encoding="utf-8")
        kinds = (
            name == path or place.name == f"test_{source.stem}.py",
            place.is_relative_to("tests") and place.parent == Path("tests") / source.parent,
            imports.search(text) is not None,
            place.is_relative_to("tests")
            and place.parent.is_relative_to(Path("tests") / source.parts[0] / source.parts[1]),
        )
        if any(kinds):
            ranked.append((-8 * kinds[0] - 4 * kinds[2] - 2 * kinds[1] - kinds[3], len(text), name))
    return [name for _, _, name in sorted(ranked)[:count]]


def fingerprints(tree: Path, path: str, ran: Iterable[str]) -> dict[str, str]:
    """Return hashes of all files that a part of the map depends on: test file, conftest files, executed sources."""
    folders = list(Path(path).parents)
    shared = [str(folder / "conftest.py") for folder in folders if (tree / folder / "conftest.py").exists()]
    return {
        name: hashlib.sha256((tree / name).read_bytes()).hexdigest() if (tree / name).exists() else ""
        for name in sorted({path, *shared, *ran})
    }


@dataclass
class CoverageMap:
    """Coverage map of all test files.

    Attributes
    ----------
    seconds : dict
        Processor time of all passing tests, s.
    lines : dict
        Names of tests by source file and line.
    """

    seconds: dict[str, float] = field(default_factory=dict)
    lines: dict[str, dict[int, set[str]]] = field(default_factory=lambda: defaultdict(lambda: defaultdict(set)))

    @classmethod
    def of_parts(cls, parts: Iterable[dict[str, Any]]) -> CoverageMap:
        """Join the parts of the test files, without tests that fail on the original."""
        found = cls()
        for part in parts:
            names = list(part["tests"])
            for name, (seconds, outcome) in part["tests"].items():
                if outcome == "passed":
                    found.seconds[name] = seconds
            for path, lines in part["lines"].items():
                for line, numbers in lines.items():
                    found.lines[path][int(line)] |= {names[number] for number in numbers} & found.seconds.keys()
        return found

    def tests_of(self, mutant: Mutant, tree: Path) -> list[str]:
        """Return the tests that can detect a mutant: those of the mirrored test file first, then by run time."""
        chosen = self._on_lines(mutant.path, range(mutant.line, mutant.end_line + 1))
        if not chosen and mutant.scope != (0, 0):  # default of an argument: use the lines of the function
            chosen = self._on_lines(mutant.path, range(mutant.scope[0], mutant.scope[1] + 1))
        if mutant.scope == (0, 0):  # executed at import, before any test
            chosen = self._users_of(mutant, tree)
        mirrored = f"test_{Path(mutant.path).stem}.py"
        return sorted(chosen, key=lambda name: ((0.3 if mirrored in name else 1.0) * self.seconds[name], name))

    def _on_lines(self, path: str, lines: Iterable[int]) -> set[str]:
        own = self.lines.get(path, {})
        return {name for line in lines for name in own.get(line, ())}

    def _users_of(self, mutant: Mutant, tree: Path) -> set[str]:
        """Return the tests of lines that use a name bound at import; of the whole file if there are none."""
        words = re.findall(r"\w+", mutant.name)
        chosen: set[str] = set()
        if words:
            pattern = re.compile(r"\b(" + "|".join(words) + r")\b")
            for path, lines in self.lines.items():
                text = (tree / path).read_text(encoding="utf-8").splitlines()
                chosen |= self._on_lines(path, [line for line in lines if pattern.search(text[line - 1])])
        return chosen or self._on_lines(mutant.path, self.lines.get(mutant.path, {}))


def read_part(folder: Path, tree: Path, path: str, *, slow: bool) -> dict[str, Any] | None:
    """Return a stored part of the map that is still valid."""
    try:
        part: dict[str, Any] = json.loads(_place(folder, path).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    holds = part["made_of"] == fingerprints(tree, path, part["lines"]) and (part["slow"] or not slow)
    return part if holds else None


def write_part(folder: Path, path: str, part: dict[str, Any]) -> None:
    """Store a part of the map."""
    folder.mkdir(parents=True, exist_ok=True)
    _place(folder, path).write_text(json.dumps(part), encoding="utf-8")


def _place(folder: Path, path: str) -> Path:
    return folder / f"{path.replace('/', '.')}.json"
