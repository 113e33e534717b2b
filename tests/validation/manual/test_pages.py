"""The manual: every case is within its bounds, and its committed page is what the command writes today."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from validation.manual.case import Outcome, relative_figure, solve_case
from validation.manual.error_bars import error_by_size
from validation.manual.page import index, index_row, page
from validation.manual.register import HEADINGS, PLANE, SOLID, all_cases

COMMITTED = Path(__file__).parents[3] / "docs" / "validation" / "manual"
NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]\d+)?")
QUICK = ("Beams and rings", "Geometry", "Roller bearings", "Friction")
"""Headings whose cases mesh nothing and take fractions of a second."""


def marks(heading, case):
    if case.long:
        return [pytest.mark.slow, pytest.mark.nightly]
    return [] if heading in QUICK else [pytest.mark.slow]


CASES = [
    pytest.param(case, id=case.name, marks=marks(heading, case))
    for heading, cases in HEADINGS.items()
    for case in cases
]


def unit_of_the_last_digit(number):
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def same_but_for_the_last_digit(written, committed):
    """Whether two texts agree, numbers to one unit of their last printed digit: where round-off falls on the edge of rounding."""
    if NUMBER.split(written) != NUMBER.split(committed):
        return False
    pairs = zip(NUMBER.findall(written), NUMBER.findall(committed), strict=True)
    # 1.001: differences of decimals leave round-off of their own.
    return all(
        abs(float(one) - float(two)) <= 1.001 * max(unit_of_the_last_digit(one), unit_of_the_last_digit(two))
        for one, two in pairs
    )


@pytest.mark.parametrize("case", CASES)
def test_case_and_its_page(case):
    outcome = solve_case(case)
    assert [
        f"{one.quantity}: {one.difference:g}{one.difference_unit} beyond {one.bound:g}" for one in outcome.failed
    ] == []
    how = "cyclo validate --manual --out docs/validation/manual"
    assert same_but_for_the_last_digit(page(outcome), (COMMITTED / f"{case.name}.md").read_text(encoding="utf-8")), how
    row = "| " + " | ".join(index_row(outcome)) + " |"
    lines = (COMMITTED / "index.md").read_text(encoding="utf-8").splitlines()
    assert any(same_but_for_the_last_digit(row, line) for line in lines), how


def test_index_lists_every_case_in_order():
    text = (COMMITTED / "index.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| \[.*\]\((\w+)\.md\)", text, flags=re.MULTILINE) == list(all_cases())
    assert re.findall(r"^## (.*)", text, flags=re.MULTILINE) == [
        heading for heading, cases in HEADINGS.items() if cases
    ]
    assert {path.stem for path in COMMITTED.glob("*.md")} == {"index", *all_cases()}


def test_registered_cases():
    listed = [case.name for cases in HEADINGS.values() for case in cases]
    assert len(listed) == len(set(listed))
    assert all(re.fullmatch(r"[a-z0-9_]+", name) and name != "index" for name in listed)
    assert sum(len(cases) for cases in PLANE.values()) >= 25
    for register, bodies in ((PLANE, "plane"), (SOLID, "solid")):
        assert {case.bodies for cases in register.values() for case in cases} <= {bodies}


def test_numbers_may_differ_in_their_last_digit_only():
    assert same_but_for_the_last_digit("load 6.1926 mm, −0.35 %", "load 6.1927 mm, −0.36 %")
    assert same_but_for_the_last_digit("< 1e-09", "< 1e-09")
    assert not same_but_for_the_last_digit("load 6.1926 mm", "load 6.1929 mm")
    assert not same_but_for_the_last_digit("load 6.1926 mm", "force 6.1926 mm")
    assert not same_but_for_the_last_digit("1e-09", "1e-08 mm")


@pytest.fixture
def patch_test():
    return solve_case(all_cases()["patch_test"])


def test_a_missed_bound_fails_figure_case_page_and_index(patch_test):
    first = patch_test.figures[0]
    wrong = relative_figure(
        first.quantity, 1.02 * first.reference, first.reference, first.unit, 1e-2, "a reason", numerical_error=1e-3,
        numerical_origin="an origin",
    )  # fmt: skip
    assert wrong.beyond_error_bar
    failed = replace(patch_test, figures=(wrong, *patch_test.figures[1:]))
    assert patch_test.passed
    assert failed.failed == (wrong,)
    text = page(failed)
    assert (
        f"**FAILED**: 1 of {len(patch_test.figures)} figures miss their bounds: {wrong.quantity}: +2 % beyond 1 %."
        in text
    )
    assert "1 of 6 differences are beyond the error bars" in text
    assert "| FAILED |" in index([failed])
    assert "**0 of 1 cases pass**" in index([failed])


def test_what_is_not_a_number_fails(patch_test):
    figure = patch_test.figures[0]
    assert not replace(figure, difference=float("nan")).passed
    assert replace(figure, difference=float("nan")).beyond_error_bar
    with pytest.raises(ValueError, match="numerical_error"):
        replace(figure, numerical_error=float("nan"))
    with pytest.raises(ValueError, match="how its error bar was found"):
        replace(figure, numerical_origin="")


def test_a_case_holds_something(patch_test):
    informing = replace(patch_test.case, run=lambda: [replace(patch_test.figures[0], bound=None)])
    with pytest.raises(ValueError, match="no figure has a bound"):
        solve_case(informing)
    assert Outcome(case=informing, figures=patch_test.figures).passed


@pytest.mark.parametrize("order", [1, 2])
def test_error_by_size_covers_what_is_left(order):
    """Of errors C hᵖ the index is 1.25 of what is left."""
    values = [1.0 + 0.3 * 2.0 ** (-order * level) for level in range(3)]
    assert error_by_size(values) == pytest.approx(1.25 * (values[-1] - 1.0), rel=1e-9)


def test_of_two_values_the_change_counts():
    assert error_by_size([1.3, 1.1]) == pytest.approx(0.2)
