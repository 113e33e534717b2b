"""Mutation testing: break random formulas one at a time and run the tests: ``python benchmarks/mutants.py --count 100``.

Formulas of `ltca`, `fem` and `validation` are changed in copies of the tree, never in place (``mutation/formulas.py``).
Tests are run on a mutant until one fails that passes on the original:

1. quick tests of the nearest files: named after the source file, in the mirrored folder, or importing it;
2. for survivors, all quick tests that execute the mutated line, from a coverage map (``mutation/covered_lines.py``). The map
   takes a few times as long as the tests and is stored per test file until sources or tests change;
3. for survivors, slow tests of the nearest files.

Survivors are printed with their lines; equivalent mutants are listed with a reason in ``mutation/equivalent.toml``. Results
are appended to ``<out>/log.jsonl``, so that an interrupted run can be continued; ``--again`` tests only the survivors again.

Exit status 1 if 3 % or more survive, or if a survivor is not listed as equivalent.
"""

from __future__ import annotations

import argparse
import compileall
import importlib.util
import json
import multiprocessing
import os
import py_compile
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_variable] = "1"
os.environ.setdefault("MPLBACKEND", "Agg")

from mutation.covered_lines import (
    CoverageMap,
    fingerprints,
    map_file,
    nearest_files,
    read_part,
    test_files,
    write_part,
)
from mutation.formulas import PACKAGES, Mutant, draw_mutants
from mutation.processes import PYTEST_WORDS, in_fork, warm_up

ROOT = Path(__file__).resolve().parents[1]
EXPLAINED = Path(__file__).parent / "mutation" / "equivalent.toml"
FIRST_LOOK, SECOND_LOOK = 20.0, 120.0
"""Processor time, s, of the tests in the first and in the second batch of stage 2."""
MAP_SECONDS = 3000.0
NEAREST = 12
"""Number of nearest test files in stages 1 and 3."""
NEAR_SECONDS = 300.0
"""Processor time limit of one of these files, s; ten times as much for slow tests."""
ACCEPTED = 0.03

_tree: Path | None = None


_passed: dict[tuple[str, bool], bool] = {}


class Failures:
    """Plugin of pytest that records failed tests."""

    def __init__(self) -> None:
        self.failed: list[str] = []

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Record a failed test."""
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_collectreport(self, report: Any) -> None:
        """Record a test file that cannot be imported."""
        if report.failed:
            self.failed.append(f"{report.nodeid} (import)")


class Chosen(Failures):
    """Plugin of pytest that selects tests and sets their order."""

    def __init__(self, names: list[str]) -> None:
        super().__init__()
        self.place = {name: number for number, name in enumerate(names)}

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Select and sort the tests."""
        items[:] = sorted((item for item in items if item.nodeid in self.place), key=lambda x: self.place[x.nodeid])


def copy_tree(source: Path, to: Path) -> None:
    """Copy all tracked and unignored files of a tree, so that later edits have no effect."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(words, cwd=source, capture_output=True, text=True, check=True).stdout.splitlines()
    for name in listed:
        if (source / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source / name, to / name)


def prepare(snapshot: Path) -> None:
    """Create a copy of the tree for this process and import third-party packages."""
    global _tree
    _tree = Path(tempfile.mkdtemp(prefix="own-", dir=snapshot.parent))
    shutil.copytree(snapshot, _tree, dirs_exist_ok=True)
    for package in PACKAGES:
        # Invalidate by content: mutated files may have the same time stamp.
        mode = py_compile.PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(_tree / package, quiet=1, invalidation_mode=mode)
    warm_up()


def own_tree() -> Path:
    """Return this process's copy of the tree."""
    assert _tree is not None
    return _tree


def map_one(path: str, *, slow: bool) -> tuple[str, dict[str, Any] | None, str]:
    """Return the part of the coverage map for a test file, or the end of its output."""
    tree = own_tree()
    how, answer = in_fork(partial(map_file, tree, path, slow=slow), tree, seconds=MAP_SECONDS)
    if how != "done":
        return path, None, f"{how}: {answer[-300:]}"
    return path, {"made_of": fingerprints(tree, path, answer["lines"]), "slow": slow, **answer}, ""


def run_tests(names: list[str]) -> dict[str, Any]:
    """Run given tests until one fails; to be called in a fork."""
    import pytest

    chosen = Chosen(names)
    files = list(dict.fromkeys(name.split("::")[0] for name in names))
    code = int(pytest.main([*files, "-x", *PYTEST_WORDS], plugins=[chosen]))
    return {"code": code, "failed": chosen.failed[:1]}


def run_file(path: str, *, slow: bool) -> dict[str, Any]:
    """Run the tests of a file until one fails; to be called in a fork."""
    import pytest

    chosen = Failures()
    code = int(pytest.main([path, "-x", *PYTEST_WORDS, "-m", "slow" if slow else "not slow"], plugins=[chosen]))
    return {"code": code, "failed": chosen.failed[:1]}


def try_nearest(job: tuple[Mutant, list[str]], *, slow: bool) -> dict[str, Any]:
    """Return the result of the tests of given files for a mutant."""
    mutant, files = job
    tree, began = own_tree(), time.monotonic()
    seconds = NEAR_SECONDS * (10.0 if slow else 1.0)
    outcome, noticed, met = "survived", "", 0
    for path in files:
        with broken(tree, mutant):
            how, answer = in_fork(partial(run_file, path, slow=slow), tree, seconds=seconds)
        met += 1
        if how == "done" and answer["code"] in (0, 5):  # all passed, or no test selected
            continue
        if not passes(tree, path, answer["failed"][0] if how == "done" and answer["failed"] else "", slow=slow):
            continue
        outcome = "killed" if how == "done" else f"killed by {how}"
        noticed = f"{'slow: ' if slow else ''}{''.join(answer['failed']) if how == 'done' else path}"
        break
    return answer_on(mutant, outcome, noticed, met, began)


@contextmanager
def broken(tree: Path, mutant: Mutant) -> Iterator[None]:
    """Apply a mutant to the tree of this process within the context."""
    place = tree / mutant.path
    original = place.read_text(encoding="utf-8")
    place.write_text(mutant.apply(tree), encoding="utf-8")
    try:
        yield
    finally:
        place.write_text(original, encoding="utf-8")


def passes(tree: Path, path: str, name: str, *, slow: bool) -> bool:
    """Return whether a test, or a whole file, passes on the original; cached."""
    key = (name or path, slow)
    if key not in _passed:
        work = partial(run_tests, [name]) if "::" in name else partial(run_file, path, slow=slow)
        how, answer = in_fork(work, tree, seconds=NEAR_SECONDS * (10.0 if slow else 1.0))
        _passed[key] = how == "done" and answer["code"] in (0, 5)
    return _passed[key]


def answer_on(mutant: Mutant, outcome: str, noticed: str, met: int, began: float) -> dict[str, Any]:
    """Return the log entry of a mutant."""
    fields = {
        name: value for name, value in asdict(mutant).items() if name in ("path", "line", "before", "after", "text")
    }
    seconds = round(time.monotonic() - began, 1)
    return {"key": mutant.key, **fields, "outcome": outcome, "by": noticed, "tests": met, "seconds": seconds}


def try_mutant(job: tuple[Mutant, list[tuple[str, float]]]) -> dict[str, Any]:
    """Return the result of the tests that execute the line of a mutant."""
    mutant, tests = job
    tree, began = own_tree(), time.monotonic()
    outcome, noticed, met = ("survived" if tests else "no test runs it"), "", 0
    for names, seconds in _looks(tests):
        with broken(tree, mutant):
            how, answer = in_fork(partial(run_tests, names), tree, seconds=30.0 + 4.0 * seconds)
        met += len(names)
        if how == "done" and answer["code"] == 0:
            continue
        if how == "done" and answer["code"] not in (1, 2):  # a test failed, or a file could not be imported
            outcome, noticed = "error", f"pytest ended with {answer['code']}"
            break
        outcome = "killed" if how == "done" else f"killed by {how}"
        noticed = "".join(answer["failed"]) if how == "done" else ""
        break
    return answer_on(mutant, outcome, noticed, met, began)


def _looks(tests: list[tuple[str, float]]) -> Iterable[tuple[list[str], float]]:
    """Divide the tests into a first and a second batch."""
    looks: list[tuple[list[str], float]] = [([], 0.0), ([], 0.0)]
    for name, seconds in tests:
        for number, bound in enumerate((FIRST_LOOK, SECOND_LOOK)):
            names, spent = looks[number]
            if spent + seconds <= bound or (number == 0 and not names):
                names.append(name)
                looks[number] = names, spent + seconds
                break
    return [look for look in looks if look[0]]


def make_map(tree: Path, folder: Path, pool: Any, *, slow: bool) -> CoverageMap:
    """Return the coverage map; missing or outdated parts are computed."""
    found = {path: read_part(folder, tree, path, slow=slow) for path in test_files(tree)}
    parts = {path: part for path, part in found.items() if part is not None}
    left = [path for path in found if path not in parts]
    for number, (path, part, trouble) in enumerate(pool.imap_unordered(partial(map_one, slow=slow), left), start=1):
        if part is None:
            print(f"map {number}/{len(left)}: {path} did not run ({trouble})", flush=True)
            continue
        bad = [name for name, (_, outcome) in part["tests"].items() if outcome == "failed"]
        print(f"map {number}/{len(left)}: {path}{f' FAILS unbroken: {bad}' if bad else ''}", flush=True)
        parts[path] = part
        write_part(folder, path, part)
    return CoverageMap.of_parts(parts.values())


def read_log(path: Path) -> dict[str, dict[str, Any]]:
    """Return the last result of every mutant tested so far."""
    if not path.exists():
        return {}
    entries = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    return {entry["key"]: entry for entry in entries}


def explanations() -> dict[str, str]:
    """Return the reasons of equivalent mutants by key."""
    return {
        entry["mutant"]: entry["why"] for entry in tomllib.loads(EXPLAINED.read_text(encoding="utf-8")).get("same", [])
    }


def report(entries: list[dict[str, Any]]) -> int:
    """Print survivors and counts; return the exit status."""
    why = explanations()
    alive = [entry for entry in entries if not entry["outcome"].startswith("killed")]
    for entry in sorted(alive, key=lambda entry: (entry["path"], entry["line"])):
        told = why.get(entry["key"])
        print(f"\n{entry['path']}:{entry['line']}  {entry['outcome']} {entry['tests']} tests")
        print(f"    {entry['text']}\n    {entry['before']}  →  {entry['after']}")
        print(f"    {'same answers: ' + told if told else 'NOT EXPLAINED'}")
    unexplained = sum(entry["key"] not in why for entry in alive)
    part = len(alive) / max(len(entries), 1)
    print(
        f"\n{len(entries)} mutants: {len(entries) - len(alive)} noticed, {len(alive)} survived ({100 * part:.1f} %), "
        f"{unexplained} of them unexplained"
    )
    return int(part >= ACCEPTED or unexplained > 0)


def main() -> int:
    """Run the mutation tests and print the report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="number of mutants; default 100")
    parser.add_argument("--seed", type=int, default=1, help="seed of the selection; default 1")
    parser.add_argument("--package", choices=PACKAGES, action="append", help="default: all three")
    parser.add_argument("--processes", type=int, default=2, help="default 2")
    parser.add_argument("--slow", action="store_true", help="include slow tests in the map")
    parser.add_argument("--near-only", action="store_true", help="use only the nearest files, quick tests, then slow")
    parser.add_argument("--again", action="store_true", help="test survivors of the log again")
    parser.add_argument("--map-only", action="store_true", help="compute the map only")
    parser.add_argument("--out", type=Path, default=Path("out/mutants"), help="map and log; default out/mutants")
    arguments = parser.parse_args()
    if importlib.util.find_spec("coverage") is None:
        parser.exit(2, "the map of lines and tests needs coverage: pip install 'cyclo-ltca[mutants]'\n")
    arguments.out.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped; the log goes on from here"))
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        tree = Path(folder) / "tree"
        copy_tree(ROOT, tree)
        entries = break_one_by_one(tree, arguments)
    return 0 if entries is None else report(entries)


def break_one_by_one(tree: Path, arguments: argparse.Namespace) -> list[dict[str, Any]] | None:
    """Return the results for the selected mutants; None if only the map was requested."""
    drawn = draw_mutants(tree, tuple(arguments.package or PACKAGES), arguments.count, arguments.seed)
    context = multiprocessing.get_context("spawn")
    with context.Pool(arguments.processes, initializer=prepare, initargs=(tree,)) as pool:
        if arguments.map_only:
            make_map(tree, arguments.out / "map", pool, slow=arguments.slow)
            return None
        known = read_log(arguments.out / "log.jsonl")
        if arguments.again:
            known = {key: entry for key, entry in known.items() if entry["outcome"].startswith("killed")}

        def alive(stage: int) -> list[Mutant]:
            """Return survivors that have not been tested in a stage."""
            entries = [(mutant, known.get(mutant.key, {"outcome": "", "stage": 0})) for mutant in drawn]
            return [m for m, entry in entries if not entry["outcome"].startswith("killed") and entry["stage"] < stage]

        def ask(stage: int, work: Callable[[Any], dict[str, Any]], jobs: list[Any]) -> None:
            with (arguments.out / "log.jsonl").open("a", encoding="utf-8") as stream:
                for number, entry in enumerate(pool.imap_unordered(work, jobs), start=1):
                    known[entry["key"]] = entry | {"stage": stage}
                    stream.write(json.dumps(known[entry["key"]], ensure_ascii=False) + "\n")
                    stream.flush()
                    print(
                        f"{number}/{len(jobs)} {entry['outcome']:<10} {entry['seconds']:>6.1f} s {entry['path']}:{entry['line']} "
                        f"{entry['before']!r} → {entry['after']!r} {entry['by']}",
                        flush=True,
                    )

        near = {mutant.key: nearest_files(tree, mutant.path, NEAREST) for mutant in drawn}
        ask(1, partial(try_nearest, slow=False), [(mutant, near[mutant.key]) for mutant in alive(1)])
        if alive(2) and not arguments.near_only:
            covered = make_map(tree, arguments.out / "map", pool, slow=arguments.slow)
            tests = {m.key: [(name, covered.seconds[name]) for name in covered.tests_of(m, tree)] for m in alive(2)}
            ask(2, try_mutant, [(mutant, tests[mutant.key]) for mutant in alive(2)])
        ask(3, partial(try_nearest, slow=True), [(mutant, near[mutant.key]) for mutant in alive(3)])
    return [known[mutant.key] for mutant in drawn if mutant.key in known]


if __name__ == "__main__":
    sys.exit(main())
