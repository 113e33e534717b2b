"""Shards of the nightly set (``tests/plugins/shards.py``): dealing, kept outcomes, resumed runs."""

from __future__ import annotations

import ast
import gc
import importlib.util
import json
import os
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import pytest
import shards

ROOT = Path(__file__).parents[1]


def test_files_are_dealt_longest_first_to_the_shard_with_the_least():
    seconds = {"a": 10.0, "b": 7.0, "c": 5.0, "d": 4.0, "e": 1.0}
    # a | b | b+c = 12 > a, so d to the first: 10+4, 7+5, and e to the second
    assert shards.deal(seconds, 2) == {"a": 1, "b": 2, "c": 2, "d": 1, "e": 2}
    assert set(shards.deal(seconds, 5).values()) == {1, 2, 3, 4, 5}
    assert shards.deal(dict(reversed(seconds.items())), 3) == shards.deal(seconds, 3)
    assert shards.deal({}, 3) == {}


def test_a_file_of_unknown_time_counts_by_its_tests():
    counts = shards.Counter({"known": 100, "new": 3})
    assert shards.seconds_of(counts, {"known": 2.0, "gone": 9.0}) == {"known": 2.0, "new": 3 * shards.SECONDS_PER_TEST}


def test_every_known_file_is_there():
    gone = [name for name in shards.known_seconds(ROOT) if not (ROOT / name).is_file()]
    assert gone == []


def test_a_test_among_the_slowest_had_got_parameters_and_another_name():
    """Every test listed is there, and named with parameters where its function is parametrized."""

    @cache
    def functions_of(file):
        """The test functions of a file by their names, with the text of their marks."""
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8")) if (ROOT / file).is_file() else ast.Module()
        nodes = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
        return {node.name: "".join(map(ast.unparse, node.decorator_list)) for node in nodes}

    gone = []
    for name in tomllib.loads((ROOT / "tests" / "budget.toml").read_text(encoding="utf-8"))["seconds"]:
        file, _, test = name.partition("::")
        if not file.startswith("tests/"):  # an example of a docstring
            continue
        function, bracket, _ = test.partition("[")
        marks = functions_of(file).get(function)
        if marks is None or ("parametrize(" in marks and not bracket):
            gone.append(name)
    assert gone == []


@pytest.mark.parametrize("text", ["0/4", "5/4", "1", "1/0", "a/b", "1/4/2", "-1/4"])
def test_a_shard_that_is_none_is_refused(text):
    with pytest.raises(ValueError, match="1 <= K <= N"):
        shards.shard_of(text)
    assert shards.shard_of("4/4") == (4, 4)


@pytest.fixture
def suite(tmp_path):
    """Four files in a folder of their own, and a function that runs a shard: exit status, files run, output."""
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers =\n    nightly: long\n", encoding="utf-8")
    (tmp_path / "tests").mkdir()
    table = '[nightly]\n"test_a.py" = 100\n"test_b.py" = 60\n"test_c.py" = 50\n'
    (tmp_path / "tests" / "budget.toml").write_text(table, encoding="utf-8")
    for letter in "abcd":
        body = "" if letter != "c" else "    assert Path('mended').exists()\n"
        text = (
            "import pytest\nfrom pathlib import Path\n\n@pytest.mark.nightly\n@pytest.mark.parametrize('case', [1, 2])\n"
            f"def test_{letter}(case):\n    with open('ran', 'a') as log: log.write('{letter}')\n{body}"
        )
        (tmp_path / f"test_{letter}.py").write_text(text, encoding="utf-8")
    path = os.pathsep.join([str(ROOT / "tests" / "plugins"), str(ROOT)])
    environment = {key: text for key, text in os.environ.items() if not key.startswith("PYTEST_")}
    environment |= {"PYTHONPATH": path, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}

    def run(*words, workers=0):
        log = tmp_path / "ran"
        log.unlink(missing_ok=True)
        command = [sys.executable, "-m", "pytest", "-p", "xdist", "-p", "shards", "-n", str(workers), "--dist=loadfile"]
        done = subprocess.run(
            [*command, *words, "-m", "nightly", "-q", "-p", "no:cacheprovider"], cwd=tmp_path, env=environment,
            capture_output=True, text=True, check=False, timeout=300,
        )  # fmt: skip
        ran = "".join(sorted(log.read_text(encoding="utf-8"))) if log.exists() else ""
        return done.returncode, ran, done.stdout + done.stderr

    run.folder = tmp_path
    return run


@pytest.mark.slow
@pytest.mark.parametrize("workers", [0, 2])
def test_shards_run_each_test_once_and_go_on_with_what_has_not_passed(suite, workers):
    status, ran, text = suite("--shard", "1/2", workers=workers)
    assert (status, ran) == (0, "aadd"), text  # 100 and 16 s of 8 s a test; 60 + 50
    status, ran, text = suite("--shard", "2/2", workers=workers)
    assert (status, ran) == (1, "bbcc"), text
    lines = [json.loads(line) for line in (suite.folder / "build/nightly/shard-2-of-2.jsonl").read_text().splitlines()]
    told = {line["test"]: line["outcome"] for line in lines if "test" in line}
    assert told == {
        "test_b.py::test_b[1]": "passed", "test_b.py::test_b[2]": "passed", "test_c.py::test_c[1]": "failed",
        "test_c.py::test_c[2]": "failed",
    }  # fmt: skip
    (suite.folder / "mended").touch()
    status, ran, text = suite("--shard", "2/2", workers=workers)
    assert (status, ran) == (0, "cc"), text
    status, ran, text = suite("--shard", "2/2", workers=workers)
    assert (status, ran) == (0, ""), text
    assert "shard 2/2: nothing left to run; 8 passed in earlier runs of any shard" in text


@pytest.mark.slow
def test_half_of_the_printed_commands_waited_for_the_other_half(tmp_path):
    """One worker ran all of them, 21 minutes, while the other had nothing left: files alone were dealt out."""
    spec = importlib.util.spec_from_file_location("dealing", ROOT / "conftest.py")
    dealing = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(dealing)
    gc.enable()  # which it does after a collection
    (apart,) = dealing.APART
    file, _, test = apart.partition("::")
    name, _, kind = test.removesuffix("]").partition("[")
    assert f"def {name}(kind" in (ROOT / file).read_text(encoding="utf-8")
    (tmp_path / "tests").mkdir()
    source = (ROOT / "conftest.py").read_text(encoding="utf-8")
    (tmp_path / "conftest.py").write_text(source.replace("pytest_plugins", "no_plugins"), encoding="utf-8")
    (tmp_path / file).write_text(
        "import os, pytest\n\ndef ran(test):\n    with open('ran', 'a') as log:\n"
        "        log.write(f\"{test} {os.environ['PYTEST_XDIST_WORKER']}\\n\")\n\ndef test_a():\n    ran('a')\n\n"
        f"def test_b():\n    ran('b')\n\n@pytest.mark.parametrize('kind', ['one', '{kind}', 'two'])\n"
        f"def {name}(kind):\n    ran(kind)\n",
        encoding="utf-8",
    )
    environment = {key: text for key, text in os.environ.items() if not key.startswith("PYTEST_")}
    environment |= {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    command = [sys.executable, "-m", "pytest", "-p", "xdist", "-n", "2", "--dist=loadfile", "-p", "no:cacheprovider"]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    workers = dict(line.split() for line in (tmp_path / "ran").read_text(encoding="utf-8").splitlines())
    assert workers.pop(kind) not in workers.values()
    assert len(workers) == 4
    assert len(set(workers.values())) == 1


@pytest.mark.parametrize(
    "changed",
    [
        "README.md", "pyproject.toml", ".ci/run", "docs/start/index.md", "docs/conf.py", "examples/notes.md",
        "tests/plugins/needs.py", "tests/portability/sitecustomize.py", "tests/contract/drive.toml",
        "tests/contract/measured.csv", "tests/regression/fields.json", "tests/conftest.py", "tests/contract/test_a.py",
    ],
)  # fmt: skip
def test_a_change_of_documents_data_or_plugins_was_skipped_as_the_same_code(changed, tmp_path):
    """The hash was that of packages, test and conftest files alone: a printed command that was wrong counted as passed."""
    path, test = tmp_path / changed, "tests/contract/test_a.py"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"before")
    before = shards._Code(tmp_path).of(test)
    assert shards._Code(tmp_path).of(test) == before
    path.write_bytes(b"after")
    assert shards._Code(tmp_path).of(test) != before


@pytest.mark.parametrize(
    "changed",
    [
        "tests/budget.toml",
        "tests/contract/test_b.py",
        "CHANGELOG.md",
        "docs/gallery/a.md",
        "docs/reference/generated/a.md",
    ],
)
def test_what_deals_tests_out_or_is_built_changes_no_hash(changed, tmp_path):
    path = tmp_path / changed
    before = shards._Code(tmp_path).of("tests/contract/test_a.py")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"after")
    assert shards._Code(tmp_path).of("tests/contract/test_a.py") == before


@pytest.mark.slow
def test_outcomes_of_other_code_count_only_where_asked_for(suite):
    assert suite("--shard", "1/2")[1] == "aadd"
    changed = suite.folder / "test_a.py"
    changed.write_text(changed.read_text(encoding="utf-8") + "\n# changed\n", encoding="utf-8")
    assert suite("--shard", "1/2", "--kept", "any-code")[1] == ""
    assert suite("--shard", "1/2")[1] == "aa"
    assert suite("--shard", "1/2", "--kept", "none")[1] == "aadd"
    # a run that was killed in the middle of a line
    kept = suite.folder / "build/nightly/shard-1-of-2.jsonl"
    kept.write_text('{"test": "test_a.py::test_a[1]", "outc', encoding="utf-8")
    assert suite("--shard", "1/2")[1] == "aadd"
    assert suite("--shard", "1/2")[1] == ""  # the outcome behind the cut line was lost with it


def test_a_cut_line_stopped_the_table_of_nightly_seconds(tmp_path, monkeypatch):
    """Seconds of each file, 2 + 3 and 7; of a test that ran twice those of the shard that ran last."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    from suite_times import nightly_text

    def line(test, seconds, outcome="passed"):
        return json.dumps({"test": test, "outcome": outcome, "seconds": seconds, "code": "0"}) + "\n"

    later, earlier = tmp_path / "shard-1-of-2.jsonl", tmp_path / "shard-2-of-2.jsonl"
    later.write_text(
        line("a.py::x", 2.0) + line("a.py::y", 3.0, "failed") + '{"test": "a.py::z", "outc', encoding="utf-8"
    )
    earlier.write_text(
        line("b.py::x", 7.0) + line("a.py::x", 100.0) + line("c.py::x", 0.1, "skipped"), encoding="utf-8"
    )
    os.utime(earlier, (1.0, 1.0))
    table = tomllib.loads(nightly_text(tmp_path))
    assert table == {"nightly": {"a.py": 5, "b.py": 7}}
