"""Levels one and three: they pass as they are, and fail when a formula behind them is broken."""

from __future__ import annotations

import pytest

import validation.levels.closed_forms as closed_forms
import validation.levels.printed_results as printed_results
from validation.rows import failed_rows

pytestmark = pytest.mark.slow


def test_closed_forms(paper_cases):
    rows = closed_forms.check_closed_forms(paper_cases["CS-1"])
    assert len(rows) >= 12
    assert not failed_rows(rows)
    assert {row.model for row in rows} == {"finite elements", "half-space"}


def test_a_wrong_closed_form_fails(monkeypatch):
    right = closed_forms.line_half_width
    monkeypatch.setattr(closed_forms, "line_half_width", lambda *words: 1.01 * right(*words))
    failed = {row.quantity for row in failed_rows([*closed_forms.cylinder_rows(), *closed_forms.roller_rows()])}
    assert "half-width of two cylinders pressed together" in failed
    assert "half-width of a long roller at mid-width" in failed


@pytest.fixture(scope="module")
def printed_rows():
    return printed_results.compare_printed_results()


def test_printed_results(printed_rows):
    rows = printed_rows
    assert not failed_rows(rows)
    informing = [row for row in rows if row.limit is None]
    assert {row.quantity for row in informing} == {
        "largest flank pressure against CS-1",
        "transmission error, peak to peak",
        "transmission error from geometry alone",
    }
    by_name = {(row.quantity, row.case): row for row in rows}
    assert by_name["largest pin-shaft load", "CS-3"].reference == 6256.0
    assert by_name["mean bearing load", "CS-1"].reference == 8460.0


# As printed, or read from the print, and the range that counts as agreement; level 3 states no others.
PRINTED = {
    ("backlash at the wheel, disc held", "CS-1"): (10.0, "9.8 … 10.1 '"),
    ("mean bearing load", "CS-1"): (8460.0, "8375.4 … 8544.6 N"),
    ("mean bearing load against CS-1", "CS-3"): (-6.5, "-8 … -5.5 %"),
    ("mean radial bearing load against CS-1", "CS-3"): (-20.0, "-23 … -18 %"),
    ("tangential bearing load, peak to peak", "CS-6"): (45.0, "30 … 55 N"),
    ("largest pin load against CS-1", "CS-3"): (-3.0, "-4.5 … -2 %"),
    ("largest pin-shaft load", "CS-1"): (5252.0, "5173.22 … 5330.78 N"),
    ("largest pin-shaft load", "CS-3"): (6256.0, "6193.44 … 6318.56 N"),
    ("largest pin-shaft load against CS-3", "CS-6"): (3.0, "1.5 … 4 %"),
    ("range of crank angle with a pin-shaft pin loaded", "CS-1"): (98.0, "96.5 … 99.5 °"),
    ("range of crank angle with a pin-shaft pin loaded", "CS-6"): (62.0, "60 … 64 °"),
    ("shift of the meshing range against CS-1", "CS-3"): (10.0, "6 … 12 °"),
    ("shift of the meshing range against CS-1", "CS-2"): (2.0, "1 … 4 °"),
    ("transmission error, CS-6 over CS-3", "CS-6"): (2.0, "1.4 … 2.2 times"),
    ("transmission error, CS-3 less CS-1", "CS-3"): (0.5, '0 … 3 "'),
    **{("mean tangential bearing load", f"CS-{k}"): (6737.5, "6734.13 … 6740.87 N") for k in range(1, 7)},
    **{("mean bearing load against CS-3", f"CS-{k}"): (0.0, "-1 … 1 %") for k in (4, 5, 6)},
    **{("largest pin load against CS-3", f"CS-{k}"): (0.0, "-0.5 … 0.5 %") for k in (4, 5, 6)},
    **{("largest roller load against CS-3", f"CS-{k}"): (0.0, "-1 … 1 %") for k in (4, 5, 6)},
}
INFORMING = {
    ("largest flank pressure against CS-1", "CS-3"): 1.0,
    ("transmission error, peak to peak", "CS-1"): 3.2,
    ("transmission error, peak to peak", "CS-3"): 3.7,
    ("transmission error from geometry alone", "CS-1"): 3.2,
}


def test_printed_figures_and_their_ranges_stay_what_they_are(printed_rows):
    """A figure copied wrong, or a range that grew, is neither noticed by rows that pass."""
    rows = printed_rows
    ranged = {(row.quantity, row.case): row for row in rows if row.reason.startswith("within ")}
    assert ranged.keys() == PRINTED.keys()
    for key, (printed, bounds) in PRINTED.items():
        row = ranged[key]
        assert row.reference == printed, key
        assert row.reason.startswith(f"within {bounds}: "), key
        low, high = (float(word) for word in bounds.rsplit(" ", 1)[0].split(" … "))
        assert row.limit == pytest.approx(high - printed if row.value >= printed else printed - low, rel=1e-3, abs=2e-3)
    informing = {(row.quantity, row.case): row.reference for row in rows if row.limit is None}
    assert informing == INFORMING
    positive = [row for row in rows if row.limit == 0.0]
    assert len(positive) == len(rows) - len(PRINTED) - len(INFORMING)
    for row in positive:
        assert (row.value > 0.0, row.difference) == (True, 0.0)


def test_a_wrong_drive_fails_the_printed_results(monkeypatch, paper_cases):
    """With the bearing clearance read as radial (twice as much) the printed changes are not met."""
    from dataclasses import replace

    wrong = {
        name: replace(drive, clearance=replace(drive.clearance, bearing=2.0 * drive.clearance.bearing))
        for name, drive in paper_cases.items()
    }
    row = "mean bearing load against CS-1"
    monkeypatch.setattr(printed_results, "POSITIONS", 12)  # a mean of few positions is enough for both answers
    assert row not in {item.quantity for item in failed_rows(printed_results.compare_printed_results())}
    monkeypatch.setattr(printed_results, "load_drive", lambda name: type("File", (), {"cases": wrong})())
    assert row in {item.quantity for item in failed_rows(printed_results.compare_printed_results())}
