"""The page of the paper's equations has each by its number, with a function that is there and names the equation."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "theory" / "equations.md"
FIRST, LAST = 45, 94
"""Equations of the paper's model with clearances."""
NUMBERS = re.compile(r"Eqs?\. (\d+(?:–\d+)?(?:(?:, | and )\d+(?:–\d+)?)*)(?!\d|\.\d)")
FILE = re.compile(r"[\w/]+\.py")


class Row(NamedTuple):
    """Equations of a row, the functions that hold them as pairs of file and name, and what else the row says."""

    equations: list[int]
    functions: list[tuple[str, str]]
    says: str
    difference: str


def numbers_in(text):
    """Equations named in a text: `Eq. 59, 78–81` has five; `Eq. 4.18` is of another book."""
    parts = [part for found in NUMBERS.findall(text) for part in re.split(r", | and ", found)]
    return [number for part in parts for number in span(part)]


def span(part):
    first, _, last = part.partition("–")
    return range(int(first), int(last or first) + 1)


def rows_of(text):
    """Rows of the table."""
    return [row_of(line) for line in text.splitlines() if line.startswith("| Eq.")]


def row_of(line):
    equation, says, where, difference = (cell.strip() for cell in line.strip("|").split("|"))
    functions, file = [], ""
    for code in re.findall(r"`([^`]+)`", where):
        if FILE.fullmatch(code):
            file = code
        else:
            functions.append((file, code))
    return Row(numbers_in(equation), functions, says, difference)


@cache
def tree_of(file):
    return ast.parse((ROOT / file).read_text(encoding="utf-8"))


def docstring_of(file, name):
    """Docstring of a function with that of its class; None where it is not there."""
    node, texts = tree_of(file), []
    for part in name.split("."):
        kinds = (ast.FunctionDef, ast.ClassDef)
        node = next((one for one in node.body if isinstance(one, kinds) and one.name == part), None)
        if node is None:
            return None
        texts.append(ast.get_docstring(node) or "")
    return "\n".join(texts)


def faults_of(text):
    """What is wrong with the table."""
    rows = rows_of(text)
    listed = [number for row in rows for number in row.equations]
    faults = [f"Eq. {n}: {listed.count(n)} times" for n in range(FIRST, LAST + 1) if listed.count(n) != 1]
    faults += [f"Eq. {number} is not of this model" for number in listed if not FIRST <= number <= LAST]
    faults += [f"{file}: no such file" for file in FILE.findall(text) if not (ROOT / file).is_file()]
    for row in rows:
        if not row.says or not row.difference or not row.functions:
            faults.append(f"Eq. {row.equations}: empty cell")
        for file, name in row.functions:
            docstring = docstring_of(file, name) if (ROOT / file).is_file() else ""
            if docstring is None:
                faults.append(f"{file}: no {name}")
            elif missing := sorted(set(row.equations) - set(numbers_in(docstring))):
                faults.append(f"{name}: docstring lacks Eq. {missing}")
    return faults


def test_every_equation_stands_once_with_a_function_that_names_it():
    assert faults_of(PAGE.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    ("row", "broken", "fault"),
    [
        ("| Eq. 61 |", "| Eq. 62 |", ["Eq. 61: 0 times", "Eq. 62: 2 times"]),
        ("| Eq. 94 |", "| Eq. 94–95 |", ["Eq. 95 is not of this model"]),
        ("`ltca/laws/spring.py`", "`ltca/laws/springs.py`", ["ltca/laws/springs.py: no such file"]),
        ("`FlankProfile.nearest_point`", "`FlankProfile.nearest`", ["ltca/geometry/flank.py: no FlankProfile.nearest"]),
        ("`FlankProfile.nearest_point`", "`FlankProfile.curvature`", ["FlankProfile.curvature: docstring lacks Eq. [61]"]),
    ],
)  # fmt: skip
def test_the_check_of_the_table_can_fail(row, broken, fault):
    text = PAGE.read_text(encoding="utf-8")
    assert text.count(row) == 1
    assert set(fault) <= set(faults_of(text.replace(row, broken)))


def test_numbers_of_other_books_are_not_the_papers():
    text = "Eq. 59, 78–81 and 88 of the paper; Johnson, Eq. 4.46 and 4.47, Eqs. 5.57; Eq. 90–91."
    assert numbers_in(text) == [59, 78, 79, 80, 81, 88, 90, 91]


@pytest.mark.parametrize("page", ["balance.md", "index.md"])
def test_the_page_is_found_from_the_theory(page):
    assert "](equations.md)" in (PAGE.parent / page).read_text(encoding="utf-8")
