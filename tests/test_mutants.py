"""The program that breaks formulas: what it breaks, that lines stay, which tests it asks. It runs no tests here."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = '''"""A module with 3 formulas."""

LIMIT = 0.5  # mm


def law(x, y, *, factor: float = 2.0):
    """Return something of 1.0."""
    if x < 0.0 or not y:
        raise ValueError(f"{x + 1} is less than {0}")
    total = (
        x * y
        - factor
    )
    total += min(x, 1e-9)
    return -total
'''


@pytest.fixture
def mutation(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import mutation.covered_lines
    import mutation.formulas

    yield mutation
    for name in [name for name in sys.modules if name.split(".")[0] == "mutation"]:
        del sys.modules[name]


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "ltca" / "figures").mkdir(parents=True)
    (tmp_path / "ltca" / "law.py").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "ltca" / "figures" / "picture.py").write_text("WIDTH = 7.2\n", encoding="utf-8")
    return tmp_path


def test_formulas_are_broken_and_nothing_else(mutation, tree):
    found = mutation.formulas.all_mutants(tree, ("ltca",))
    assert {mutant.path for mutant in found} == {"ltca/law.py"}
    changes = {(" ".join(mutant.before.split()), mutant.after.strip()) for mutant in found}
    assert changes == {
        ("0.5", "0.51"),
        ("2.0", "2.04"),
        ("x < 0.0 or not y", "(x < 0.0 and (not y))"),
        ("x < 0.0", "(x >= 0.0)"),
        ("0.0", "1.0"),
        ("not y", "(y)"),
        ("x * y - factor", "(x * y + factor)"),
        ("x * y - factor", "(x * y)"),
        ("x * y - factor", "(factor)"),
        ("x * y", "(x / y)"),
        ("x * y", "(x)"),
        ("total += min(x, 1e-9)", "total -= min(x, 1e-09)"),
        ("min(x, 1e-9)", "max(x, 1e-09)"),
        ("1e-9", "1e-06"),  # a tolerance: a thousand times as much
        ("-total", "(total)"),
    }


@pytest.mark.slow
def test_broken_sources_compile_and_keep_their_lines(mutation, tree):
    for mutant in mutation.formulas.all_mutants(tree, ("ltca",)):
        broken = mutant.apply(tree)
        assert broken.count("\n") == SOURCE.count("\n")
        assert ast.dump(ast.parse(broken)) != ast.dump(ast.parse(SOURCE))
    real = mutation.formulas.draw_mutants(ROOT, ("validation",), 25, 3)
    assert len({(mutant.path, mutant.line) for mutant in real}) == 25
    for mutant in real:
        compile(mutant.apply(ROOT), mutant.path, "exec")
    again = mutation.formulas.draw_mutants(ROOT, ("validation",), 25, 3)
    assert [mutant.key for mutant in again] == [mutant.key for mutant in real]


def test_tests_of_a_line_are_asked_quick_ones_first(mutation, tree):
    names = ["tests/test_other.py::test_slow", "tests/test_other.py::test_quick", "tests/test_law.py::test_own"]
    part = {
        "tests": {
            names[0]: (3.0, "passed"),
            names[1]: (0.1, "passed"),
            names[2]: (5.0, "passed"),
            "broken": (0.0, "failed"),
        },
        "lines": {"ltca/law.py": {"10": [0, 1, 2, 3], "14": [1]}},
    }
    covered = mutation.covered_lines.CoverageMap.of_parts([part])
    by_change = {mutant.after.strip(): mutant for mutant in mutation.formulas.all_mutants(tree, ("ltca",))}
    # a test of the file's own may take three times as long and still comes first
    assert covered.tests_of(by_change["(x * y + factor)"], tree) == [names[1], names[2], names[0]]
    assert covered.tests_of(by_change["max(x, 1e-09)"], tree) == [names[1]]
    # a default runs at import: whatever runs the function may see it
    assert covered.tests_of(by_change["2.04"], tree) == [names[1], names[2], names[0]]
    # a constant that no line names: all tests of the file
    assert set(covered.tests_of(by_change["0.51"], tree)) == set(names)
