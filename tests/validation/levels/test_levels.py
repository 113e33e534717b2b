"""Levels one to three: they pass as they are, and fail when a formula behind them is broken."""

from __future__ import annotations

import json
from importlib import resources

import numpy as np
import pytest

import validation.levels.closed_forms as closed_forms
import validation.levels.other_codes as other_codes
import validation.levels.printed_results as printed_results
from ltca.errors import CycloError
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


def test_stored_figures_are_marked_with_their_command(monkeypatch):
    monkeypatch.setattr(other_codes, "_has_calculix", lambda: False)
    monkeypatch.setattr(other_codes, "_has_tamaas", lambda: False)
    with other_codes.asked_codes() as answers:
        rows = answers()
    assert len(rows) >= 15
    assert not failed_rows(rows)
    for row in rows:
        assert "stored, python -m validation.levels.other_codes" in row.against
    assert {row.against.split(" ")[0] for row in rows} == {"CalculiX", "tamaas"}
    assert {row.quantity for row in rows} >= {"wheel angle", "load of a contact of the whole drive"}


def test_stored_answers_of_the_half_space_are_still_ours():
    """Ours are stored beside theirs: a change of the code that moves them asks for the command to be run again."""
    stored = json.loads((resources.files("validation.levels") / other_codes.STORED).read_text(encoding="utf-8"))
    from ltca.drive.parts import Material, contact_modulus
    from ltca.laws.line_contact import LineContactLaw
    from ltca.laws.series import approach_at_load

    steel = Material(youngs_modulus=210e3, poisson_ratio=0.3)
    law = LineContactLaw(11.8, contact_modulus(steel, steel))
    ours = {item["quantity"]: item["ours"] for item in stored["tamaas"]}
    approach = float(approach_at_load(law, np.array([1500.0]), 2.0)[0][0])
    assert ours["approach, uncrowned roller"] == pytest.approx(approach, rel=1e-6)


def test_a_code_that_fails_is_one_error(monkeypatch):
    monkeypatch.setattr(other_codes, "_has_tamaas", lambda: False)
    monkeypatch.setattr(other_codes, "_has_calculix", lambda: True)
    monkeypatch.setenv("PATH", "/nowhere")  # found here, gone in the process that runs it
    with other_codes.asked_codes() as answers, pytest.raises(CycloError, match="CalculiX failed"):
        answers()


def test_leaving_early_ends_the_other_process(monkeypatch):
    monkeypatch.setattr(other_codes, "_has_tamaas", lambda: False)
    monkeypatch.setattr(other_codes, "_has_calculix", lambda: True)
    started = []
    real = other_codes.subprocess.Popen

    def start(*words, **options):
        started.append(real(*words, **options))
        return started[0]

    monkeypatch.setattr(other_codes.subprocess, "Popen", start)

    def leave():
        with other_codes.asked_codes():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        leave()
    assert started[0].returncode is not None
