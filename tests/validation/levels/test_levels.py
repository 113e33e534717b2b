"""Levels one and three: they pass as they are, and fail when a formula behind them is broken."""

from __future__ import annotations

import validation.levels.closed_forms as closed_forms
import validation.levels.printed_results as printed_results
from validation.rows import failed_rows


def test_closed_forms(paper_cases):
    rows = closed_forms.check_closed_forms(paper_cases["CS-1"])
    assert len(rows) >= 12
    assert not failed_rows(rows)
    assert {row.model for row in rows} == {"finite elements", "half-space"}


def test_a_wrong_closed_form_fails(monkeypatch):
    right = closed_forms.line_half_width
    monkeypatch.setattr(closed_forms, "line_half_width", lambda *words: 1.01 * right(*words))
    failed = {row.quantity for row in failed_rows([*closed_forms._two_cylinders(), *closed_forms._rollers()])}
    assert "half-width of two cylinders pressed together" in failed
    assert "half-width of a long roller at mid-width" in failed


def test_printed_results():
    rows = printed_results.compare_printed_results()
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


def test_a_wrong_drive_fails_the_printed_results(monkeypatch, paper_cases):
    """With the bearing clearance read as radial (twice as much) the printed changes are not met."""
    from dataclasses import replace

    wrong = {
        name: replace(drive, clearance=replace(drive.clearance, bearing=2.0 * drive.clearance.bearing))
        for name, drive in paper_cases.items()
    }
    row = "mean bearing load against CS-1"
    monkeypatch.setattr(printed_results, "POSITIONS", 24)  # a mean of few positions is enough for both answers
    assert row not in {item.quantity for item in failed_rows(printed_results.compare_printed_results())}
    monkeypatch.setattr(printed_results, "load_drive", lambda name: type("File", (), {"cases": wrong})())
    assert row in {item.quantity for item in failed_rows(printed_results.compare_printed_results())}
