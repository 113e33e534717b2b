"""Break random formulas one at a time and see whether a test notices: ``python benchmarks/mutants.py --count 100``.

Formulas of `ltca`, `fem` and `validation` are broken in copies of the tree, never in place (``mutation/formulas.py``).
First a map is made of the lines that every test runs (``mutation/covered_lines.py``; it takes a few times the tests
themselves and is kept until sources or tests change). Then every mutant meets the tests that run its line, those of its
own file and quick ones first, until one fails. Survivors are printed with their lines; those that no answer can tell
from the original are explained in ``mutation/equivalent.toml``. Answers are kept line by line in ``<out>/log.jsonl``: a
run that was stopped goes on where it was, and ``--again`` asks only the survivors once more.

Exit status 1 when 3 % survive or more, or one survives without an explanation.
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
from collections.abc import Iterable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_variable] = "1"
os.environ.setdefault("MPLBACKEND", "Agg")

from mutation.covered_lines import CoverageMap, fingerprints, map_file, read_part, test_files, write_part
from mutation.formulas import PACKAGES, Mutant, draw_mutants
from mutation.processes import PYTEST_WORDS, in_fork, warm_up

ROOT = Path(__file__).resolve().parents[1]
EXPLAINED = Path(__file__).parent / "mutation" / "equivalent.toml"
FIRST_LOOK, SECOND_LOOK = 20.0, 120.0
"""Processor seconds of the tests a mutant meets first, and of those it meets when it survives them."""
MAP_SECONDS = 3000.0
ACCEPTED = 0.03

_tree: Path | None = None


class Chosen:
    """Plugin of pytest that keeps some tests, in their order."""

    def __init__(self, names: list[str]) -> None:
        self.place = {name: number for number, name in enumerate(names)}
        self.failed: list[str] = []

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Keep and sort."""
        items[:] = sorted((item for item in items if item.nodeid in self.place), key=lambda x: self.place[x.nodeid])

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Remember who noticed."""
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_collectreport(self, report: Any) -> None:
        """A file that cannot be imported any more has noticed, too."""
        if report.failed:
            self.failed.append(f"{report.nodeid} (import)")


def copy_tree(source: Path, to: Path) -> None:
    """Copy what git knows or would know of a tree: what is edited meanwhile changes nothing."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(words, cwd=source, capture_output=True, text=True, check=True).stdout.splitlines()
    for name in listed:
        if (source / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source / name, to / name)


def prepare(snapshot: Path) -> None:
    """Give this process a tree of its own and import what every run needs."""
    global _tree
    _tree = Path(tempfile.mkdtemp(prefix="own-", dir=snapshot.parent))
    shutil.copytree(snapshot, _tree, dirs_exist_ok=True)
    for package in PACKAGES:
        # By content: a broken file differs from its neighbour in time by nothing.
        mode = py_compile.PycInvalidationMode.CHECKED_HASH
        compileall.compile_dir(_tree / package, quiet=1, invalidation_mode=mode)
    warm_up()


def own_tree() -> Path:
    """Return this process's copy of the tree."""
    assert _tree is not None
    return _tree


def map_one(path: str, *, slow: bool) -> tuple[str, dict[str, Any] | None, str]:
    """Return the part of the map that a test file gives, or its last words."""
    tree = own_tree()
    how, answer = in_fork(partial(map_file, tree, path, slow=slow), tree, seconds=MAP_SECONDS)
    if how != "done":
        return path, None, f"{how}: {answer[-300:]}"
    return path, {"made_of": fingerprints(tree, path, answer["lines"]), "slow": slow, **answer}, ""


def run_tests(names: list[str]) -> dict[str, Any]:
    """Run some tests until one fails; to be called in a fork."""
    import pytest

    chosen = Chosen(names)
    files = list(dict.fromkeys(name.split("::")[0] for name in names))
    code = int(pytest.main([*files, "-x", *PYTEST_WORDS], plugins=[chosen]))
    return {"code": code, "failed": chosen.failed[:1]}


def try_mutant(job: tuple[Mutant, list[tuple[str, float]]]) -> dict[str, Any]:
    """Return what the tests say of a mutant."""
    mutant, tests = job
    tree = own_tree()
    began = time.monotonic()
    place = tree / mutant.path
    original = place.read_text(encoding="utf-8")
    outcome, noticed, met = ("survived" if tests else "no test runs it"), "", 0
    place.write_text(mutant.apply(tree), encoding="utf-8")
    try:
        for names, seconds in _looks(tests):
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
    finally:
        place.write_text(original, encoding="utf-8")
    fields = {
        name: value for name, value in asdict(mutant).items() if name in ("path", "line", "before", "after", "text")
    }
    seconds = round(time.monotonic() - began, 1)
    return {"key": mutant.key, **fields, "outcome": outcome, "by": noticed, "tests": met, "seconds": seconds}


def _looks(tests: list[tuple[str, float]]) -> Iterable[tuple[list[str], float]]:
    """Cut the tests into those of the first and of the second look."""
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
    """Return the map of covered lines, made where it is missing or no longer holds."""
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
    """Return the last answer on every mutant met so far."""
    if not path.exists():
        return {}
    entries = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    return {entry["key"]: entry for entry in entries}


def explanations() -> dict[str, str]:
    """Return why mutants give the same answers, by their keys."""
    if not EXPLAINED.exists():
        return {}
    return {entry["mutant"]: entry["why"] for entry in tomllib.loads(EXPLAINED.read_text(encoding="utf-8"))["same"]}


def report(entries: list[dict[str, Any]]) -> int:
    """Print what survived and the counts; return the exit status."""
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
    """Map, break, report."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="formulas to break; default 100")
    parser.add_argument("--seed", type=int, default=1, help="of the choice; default 1")
    parser.add_argument("--package", choices=PACKAGES, action="append", help="default: all three")
    parser.add_argument("--processes", type=int, default=2, help="default 2")
    parser.add_argument("--slow", action="store_true", help="slow tests, too: a longer map, fewer survivors")
    parser.add_argument("--again", action="store_true", help="ask survivors of the log once more")
    parser.add_argument("--map-only", action="store_true", help="make the map and stop")
    parser.add_argument("--out", type=Path, default=Path("out/mutants"), help="map and log; default out/mutants")
    arguments = parser.parse_args()
    if importlib.util.find_spec("coverage") is None:
        sys.exit("the map of lines and tests needs coverage: pip install 'cyclo-ltca[mutants]'")
    arguments.out.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped; the log goes on from here"))
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        tree = Path(folder) / "tree"
        copy_tree(ROOT, tree)
        entries = break_one_by_one(tree, arguments)
    return 0 if entries is None else report(entries)


def break_one_by_one(tree: Path, arguments: argparse.Namespace) -> list[dict[str, Any]] | None:
    """Return what the tests say of the mutants drawn; None when only the map was wanted."""
    log = arguments.out / "log.jsonl"
    drawn = draw_mutants(tree, tuple(arguments.package or PACKAGES), arguments.count, arguments.seed)
    context = multiprocessing.get_context("spawn")
    with context.Pool(arguments.processes, initializer=prepare, initargs=(tree,)) as pool:
        covered = make_map(tree, arguments.out / "map", pool, slow=arguments.slow)
        if arguments.map_only:
            return None
        known = read_log(log)
        if arguments.again:
            known = {key: entry for key, entry in known.items() if entry["outcome"].startswith("killed")}
        left = [mutant for mutant in drawn if mutant.key not in known]
        jobs = [(mutant, [(name, covered.seconds[name]) for name in covered.tests_of(mutant, tree)]) for mutant in left]
        with log.open("a", encoding="utf-8") as stream:
            for number, entry in enumerate(pool.imap_unordered(try_mutant, jobs), start=1):
                stream.write(json.dumps(entry, ensure_ascii=False) + "\n")
                stream.flush()
                known[entry["key"]] = entry
                print(
                    f"{number}/{len(jobs)} {entry['outcome']:<10} {entry['seconds']:>6.1f} s {entry['path']}:{entry['line']} "
                    f"{entry['before']!r} → {entry['after']!r} {entry['by']}",
                    flush=True,
                )
    return [known[mutant.key] for mutant in drawn if mutant.key in known]


if __name__ == "__main__":
    sys.exit(main())
