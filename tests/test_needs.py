"""What tests need beyond ``.[test]`` (``tests/plugins/needs.py``): one marker, extras of pyproject.toml, no other skips."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from types import SimpleNamespace

import needs
import pytest
from refusals import error_says

from ltca.export.simulators.functional_mockup_unit import COMPILERS

ROOT = Path(__file__).parents[1]
FILES = [path for path in sorted((ROOT / "tests").rglob("*.py")) if "plugins" not in path.parts]


def item(*names):
    """A test with the marker; it keeps the markers that are added."""
    added = []
    return SimpleNamespace(
        nodeid="test_x.py::test_x", iter_markers=lambda name: [pytest.mark.needs(*names).mark], add_marker=added.append,
        added=added, stash=pytest.Stash(),
    )  # fmt: skip


def config(all_needs=False):
    return SimpleNamespace(option=SimpleNamespace(all_needs=all_needs))


def reasons(*names):
    marked = item(*names)
    needs.pytest_collection_modifyitems(config(), [marked])
    needs.pytest_runtest_setup(marked)
    return [mark.kwargs["reason"] for mark in marked.added]


def test_extras_are_those_of_the_project():
    found = needs.extras()
    assert {"fast", "cluster", "referee", "robotics", "studio", "browser", "docs", "test"} <= set(found)
    assert found["cluster"] == ("dask", "distributed")
    assert found["docs"][:2] == ("sphinx", "pydata-sphinx-theme")
    assert found["cad"] == ()


def test_sphinx_without_its_extensions_is_not_the_extra_docs(monkeypatch):
    """It was there by another way, and tests of the documentation failed in a fresh environment of `.[test]`."""
    monkeypatch.setattr(needs, "is_installed", lambda name: name in ("sphinx", "numpydoc"))
    (reason,) = reasons("docs")
    assert reason == (
        "needs extra docs (pydata-sphinx-theme, sphinx-gallery, myst-parser): pip install --editable '.[docs]'"
    )
    monkeypatch.setattr(needs, "is_installed", lambda name: True)
    assert reasons("docs", "robotics") == []


def test_a_program_that_is_not_there_is_named(monkeypatch):
    monkeypatch.setattr(needs, "program", lambda need: None)
    assert reasons("calculix") == ["needs CalculiX: apt install calculix-ccx"]


def test_a_need_that_the_ci_lacks_was_a_skip(monkeypatch):
    """Its job of tests that need something was green with half of them skipped; `--all-needs` lets them fail."""
    monkeypatch.setattr(needs, "program", lambda need: None)
    lacks, has = item("calculix"), item("test")
    needs.pytest_collection_modifyitems(config(all_needs=True), [lacks, has])
    assert lacks.added == has.added == []
    with error_says(pytest.fail.Exception, "--all-needs: needs CalculiX: apt install calculix-ccx"):
        needs.pytest_runtest_setup(lacks)
    needs.pytest_runtest_setup(has)


@pytest.mark.parametrize("names", [("dosc",), ("docs", "robotic"), ()])
def test_a_need_that_nothing_provides_is_an_error(names):
    with error_says(pytest.UsageError, "test_x: needs('", "'): neither an extra ", " docs"):
        reasons(*names)


def test_compilers_are_those_that_are_looked_for():
    assert needs.PROGRAMS["compiler"][1] == COMPILERS


def test_no_test_looks_by_itself_for_a_package_or_program():
    """Skips by importorskip, find_spec and which differed between tests; one marker says what is needed."""
    wrong = []
    for path in FILES:
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if re.search(r"importorskip|find_spec|which\(|skip", text) else ():
            if not isinstance(node, ast.Call):
                continue
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            texts = " ".join(str(one.value) for one in ast.walk(node) if isinstance(one, ast.Constant))
            if name in ("importorskip", "find_spec", "which") or (name in ("skip", "skipif") and "install" in texts):
                wrong.append(f"{path.relative_to(ROOT).as_posix()}:{node.lineno}: {name}")
    assert wrong == []
