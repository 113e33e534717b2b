"""Break random formulas one at a time and see whether a test notices: ``python benchmarks/mutants.py --count 100``.

Formulas of `ltca`, `fem` and `validation` are broken in copies of the tree, never in place (``mutation/formulas.py``).
Every mutant meets tests until one fails that passes on the original:

1. quick tests of the files nearest to its own: the file named after it, its folder's, those that import it;
2. what survives, all quick tests that run its line. Which do, tells a map (``mutation/covered_lines.py``) that takes a few
   times the tests themselves and is kept, test file by test file, until sources or tests change;
3. what survives, slow tests of the nearest files.

Survivors are printed with their lines; those that no answer can tell from the original are explained in
``mutation/equivalent.toml``. Answers are kept line by line in ``<out>/log.jsonl``: a run that was stopped goes on where it
was, and ``--again`` asks only the survivors once more.

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
"""Processor seconds of the tests a mutant meets first, and of those it meets when it survives them."""
MAP_SECONDS = 3000.0
NEAREST = 12
"""Files of tests that a mutant meets before the map is asked."""
NEAR_SECONDS = 300.0
"""Processor seconds of one of them; ten times as much where slow tests are asked."""
ACCEPTED = 0.03

_tree: Path | None = None


_passed: dict[tuple[str, bool], bool] = {}


class Failures:
    """Plugin of pytest that remembers what failed."""

    def __init__(self) -> None:
        self.failed: list[str] = []

    def pytest_runtest_logreport(self, report: Any) -> None:
        """Remember who noticed."""
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_collectreport(self, report: Any) -> None:
        """A file that cannot be imported any more has noticed, too."""
        if report.failed:
            self.failed.append(f"{report.nodeid} (import)")


class Chosen(Failures):
    """Plugin of pytest that keeps some tests, in their order."""

    def __init__(self, names: list[str]) -> None:
        super().__init__()
        self.place = {name: number for number, name in enumerate(names)}

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Keep and sort."""
        items[:] = sorted((item for item in items if item.nodeid in self.place), key=lambda x: self.place[x.nodeid])


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


def run_file(path: str, *, slow: bool) -> dict[str, Any]:
    """Run the tests of a file until one fails; to be called in a fork."""
    import pytest

    chosen = Failures()
    code = int(pytest.main([path, "-x", *PYTEST_WORDS, "-m", "slow" if slow else "not slow"], plugins=[chosen]))
    return {"code": code, "failed": chosen.failed[:1]}


def try_nearest(job: tuple[Mutant, list[str]], *, slow: bool) -> dict[str, Any]:
    """Return what the tests of some files say of a mutant."""
    mutant, files = job
    tree, began = own_tree(), time.monotonic()
    seconds = NEAR_SECONDS * (10.0 if slow else 1.0)
    outcome, noticed, met = "survived", "", 0
    for path in files:
        with broken(tree, mutant):
            how, answer = in_fork(partial(run_file, path, slow=slow), tree, seconds=seconds)
        met += 1
        if how == "done" and answer["code"] in (0, 5):  # all passed, or none is that slow
            continue
        if not passes(tree, path, answer["failed"][0] if how == "done" and answer["failed"] else "", slow=slow):
            continue
        outcome = "killed" if how == "done" else f"killed by {how}"
        noticed = f"{'slow: ' if slow else ''}{''.join(answer['failed']) if how == 'done' else path}"
        break
    return answer_on(mutant, outcome, noticed, met, began)


@contextmanager
def broken(tree: Path, mutant: Mutant) -> Iterator[None]:
    """Break a formula of this process's tree for a while."""
    place = tree / mutant.path
    original = place.read_text(encoding="utf-8")
    place.write_text(mutant.apply(tree), encoding="utf-8")
    try:
        yield
    finally:
        place.write_text(original, encoding="utf-8")


def passes(tree: Path, path: str, name: str, *, slow: bool) -> bool:
    """Whether a test, or all of its file, passes on the original: asked once."""
    key = (name or path, slow)
    if key not in _passed:
        work = partial(run_tests, [name]) if "::" in name else partial(run_file, path, slow=slow)
        how, answer = in_fork(work, tree, seconds=NEAR_SECONDS * (10.0 if slow else 1.0))
        _passed[key] = how == "done" and answer["code"] in (0, 5)
    return _passed[key]


def answer_on(mutant: Mutant, outcome: str, noticed: str, met: int, began: float) -> dict[str, Any]:
    """Return the entry of the log on a mutant."""
    fields = {
        name: value for name, value in asdict(mutant).items() if name in ("path", "line", "before", "after", "text")
    }
    seconds = round(time.monotonic() - began, 1)
    return {"key": mutant.key, **fields, "outcome": outcome, "by": noticed, "tests": met, "seconds": seconds}


def try_mutant(job: tuple[Mutant, list[tuple[str, float]]]) -> dict[str, Any]:
    """Return what the tests that run its line say of a mutant."""
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
    return {
        entry["mutant"]: entry["why"] for entry in tomllib.loads(EXPLAINED.read_text(encoding="utf-8")).get("same", [])
    }


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
    parser.add_argument("--slow", action="store_true", help="slow tests in the map, too: a longer map, fewer survivors")
    parser.add_argument(
        "--near-only", action="store_true", help="no map: the nearest files alone, quick tests, then slow"
    )
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
            """Return those that survive and have not met the tests of a stage."""
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
