"""One count of values that are not known: the sentence of a page, the fold below it and the terminal."""

from __future__ import annotations

import re

import pytest

from ltca.drive.members.judgement import Check, Value
from ltca.drive.members.limits import Limit
from ltca.drive.members.verdict_words import verdict_table
from ltca.page.verdict_tables import verdict_of, verdict_tables


def check_of(quantity, value, bound=None, reason="", asked=False):
    limit = None if bound is None else Limit(quantity=quantity, sense="max", value=bound, source="materials")
    return Check(value=Value(quantity=quantity, value=value, reason=reason), limit=limit, asked=asked)


CASE = [
    check_of("pin_pressure_mid", 900.0, 1000.0),
    check_of("pin_shaft_pressure_mid", 500.0, 1000.0),
    check_of("disc_shear", 300.0),
    check_of("root_stress", None, 600.0, "no walls"),
    check_of("bore_stress", None, 600.0, "no walls"),
    check_of("mean_efficiency", None, None, "nothing rubs"),
]
"""Two kept limits, one value without a limit, three that are not known, two of these with a limit."""


def tables_of(checks):
    return {table.name: table for table in verdict_tables(checks)}


@pytest.mark.parametrize("cases", [1, 6])
def test_a_page_of_six_cases_counted_54_limits_and_the_fold_below_it_9(cases):
    checks = {f"CS-{number}": CASE for number in range(1, cases + 1)}
    sentence, state = verdict_of(checks)
    assert state == "pass"
    every = "" if cases == 1 else " in every case"
    assert sentence == (
        f"All 2 values that can be judged keep their limits{every}. 3 values are not known, 2 of them with a limit: the "
        "reasons are listed below. 1 value is without a limit and only informs."
    )
    tables = tables_of(checks)
    assert [len(tables[name].rows) for name in ("verdict", "not_known", "without_limit")] == [2, 3, 1]
    assert [row[2].text for row in tables["not_known"].rows] == ["no walls", "no walls", "nothing rubs"]
    last = verdict_table(CASE).splitlines()[-1]
    assert last == "  2 passed, 0 failed, 1 without a limit, 3 not known (2 of them with a limit)"


def test_a_value_that_one_case_alone_does_not_know_names_the_case():
    other = [*CASE[:-1], check_of("mean_efficiency", 0.9)]
    tables = tables_of({"CS-1": CASE, "CS-2": other})
    assert [row[2].text for row in tables["not_known"].rows] == ["no walls", "no walls", "CS-1: nothing rubs"]


def test_failed_checks_of_several_cases_are_counted_once_each():
    worse = [check_of("pin_pressure_mid", 1100.0, 1000.0), *CASE[1:]]
    assert verdict_of({"CS-1": worse, "CS-2": worse, "CS-3": CASE}) == (
        "1 of 2 checks fails, in 2 of 3 cases.",
        "fail",
    )


def test_a_limit_of_the_file_that_cannot_be_judged_was_counted_as_not_known_though_it_fails():
    """The terminal counted no failed check above exit status 1."""
    checks = [CASE[0], check_of("crank_deflection", None, 0.01, "no clearance", asked=True)]
    lines = verdict_table(checks).splitlines()
    assert re.fullmatch(r"  deflection of cranks +– +≤ 0\.01 mm +FAIL +no clearance", lines[1])
    assert lines[-1] == "  1 passed, 1 failed, 0 without a limit, 0 not known"
    assert verdict_of({"CS-1": checks})[0] == "1 of 2 checks fails."
