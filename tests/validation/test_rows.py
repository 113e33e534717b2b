"""Rows: what passes, what fails, what informs; and the files made of them."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

from validation.report.headline import COLUMNS, validation_content, write_files
from validation.report.page import _line
from validation.rows import Row, failed_rows, positive_row, range_row, relative_row, rounded

ROW = Row(
    level=5,
    quantity="load",
    value=101.0,
    reference=100.0,
    unit="N",
    difference=0.01,
    limit=0.02,
    reason="made by hand",
    case="CS-1",
    contact="pin 3",
    model="fe",
    against="full FE",
    crank_angle=0.5,
)


@pytest.mark.parametrize(
    ("difference", "limit", "passed"),
    [(0.02, 0.02, True), (-0.02, 0.02, True), (0.0201, 0.02, False), (-5.0, None, True), (math.nan, 0.02, False)],
)
def test_pass_and_fail(difference, limit, passed):
    assert replace(ROW, difference=difference, limit=limit).passed is passed


def test_figures_of_numpy_are_written():
    """A difference that came from an array ended ``cyclo validate --level quick`` in its last step, with an unforeseen error."""
    row = replace(ROW, difference=np.float64(0.01), error_bar=np.float64(0.02))
    assert json.loads(json.dumps(row.content()))["pass"] is True
    assert json.loads(json.dumps(row.content()))["below_error_bar"] is True


def test_a_row_needs_its_level_and_a_reason():
    with pytest.raises(ValueError, match="level 7"):
        replace(ROW, level=7)
    with pytest.raises(ValueError, match="says why"):
        replace(ROW, reason="")


@pytest.mark.parametrize(("value", "passed"), [(-8.0, True), (-8.1, False), (-5.5, True), (-5.4, False), (-6.5, True)])
def test_range_about_a_printed_value(value, passed):
    row = range_row(3, "mean bearing load", value, -6.5, -8.0, -5.5, "%", "read from a print")
    assert row.passed is passed
    assert row.difference == pytest.approx(value + 6.5)


def test_range_must_hold_its_reference():
    with pytest.raises(ValueError, match="outside"):
        range_row(3, "load", 1.0, 3.0, 0.0, 2.0, "N", "no")


@pytest.mark.parametrize(("value", "passed"), [(0.1, True), (0.0, True), (-0.1, False), (math.nan, False)])
def test_positive_row(value, passed):
    assert positive_row(3, "growth", value, "%", "grows").passed is passed


def test_relative_row():
    assert relative_row(1, "width", 1.01, 1.0, "mm", 0.02, "why").difference == pytest.approx(0.01)


def test_figures_that_are_no_numbers_become_null():
    assert rounded(math.nan) is None
    assert rounded(None) is None
    assert rounded(-1234567.89) == -1234570.0


def test_schema_of_the_files(small_study, tmp_path):
    paths = write_files(small_study, tmp_path)
    content = json.loads(paths[0].read_text(encoding="utf-8"))
    rows = content["rows"]
    assert len(rows) == len(small_study.rows) >= 40
    assert {row["level"] for row in rows} == {1, 2, 3, 4, 5, 6}
    needed = {
        "level", "quantity", "case", "angle_rad", "contact", "model", "reference", "value", "unit", "difference", "limit",
        "reason", "pass",
    }  # fmt: skip
    for row in rows:
        assert needed <= set(row)
        assert row["reason"]
        assert isinstance(row["pass"], bool)
        if row["limit"] is None:
            assert row["pass"] is True
        else:
            assert row["pass"] is (
                row["difference"] is not None and abs(row["difference"]) <= row["limit"] * (1 + 1e-6)
            )
    with paths[1].open(encoding="utf-8", newline="") as stream:
        table = list(csv.DictReader(stream))
    assert list(table[0]) == list(COLUMNS)
    assert len(table) == len(rows)


def test_headline(small_study):
    head = validation_content(small_study)["headline"]
    assert set(head["worst_difference_from_full_fe"]) == {"half-space", "fe", "hybrid"}
    half = head["worst_difference_from_full_fe"]["half-space"]
    # full loads are the half-space's times 1.01 in the fixture: −1/101 everywhere, pressures by the root of it
    assert half["load"]["difference"] == pytest.approx(-1.0 / 101.0, rel=1e-5)
    assert half["pressure"]["difference"] == pytest.approx(1.01**-0.5 - 1.0, rel=1e-5)
    assert half["wheel_angle"]["difference_arcsec"] == pytest.approx(0.0, abs=1e-9)
    for changes in head["change_half_space_to_full_fe"].values():
        assert set(changes) == {"pin_load", "roller_load", "pin_shaft_load"}
        for value in changes.values():
            assert value == pytest.approx(0.01, rel=1e-5)
    assert head["failed"] == len(failed_rows(small_study.rows))


def test_error_bars_are_told():
    """A difference below the bar of its reference says so; without a bar nothing is said."""
    below = replace(ROW, difference=1e-3, error_bar=2e-3)
    beyond, silent = replace(below, error_bar=5e-4), replace(below, error_bar=None)
    assert [row.below_error_bar for row in (below, beyond, silent)] == [True, False, None]
    assert below.content()["error_bar"] == 2e-3
    told = [_line(row, 1)["error_bar"] for row in (below, beyond, silent)]
    assert told == ["below its error bar, ±0.2 %", "error bar ±0.05 %", ""]
