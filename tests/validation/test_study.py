"""What a validation keeps between runs: other codes' answers are used again only where they fit."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

import validation.study as study
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from validation.compare.finite_element_positions import Settings
from validation.rows import Row

ROWS = [
    Row(
        level=2, quantity="load of a contact", value=1234.5, reference=1234.0, unit="N", difference=4e-4, limit=5e-3,
        reason="made by hand", case="CS-1", contact="pin 3", crank_angle=0.5, model="full FE", against="CalculiX",
    ),
    Row(
        level=2, quantity="wheel angle", value=-400.1, reference=-400.2, unit='"', difference=0.1, limit=0.6,
        reason="made by hand", difference_unit='"',
    ),
]  # fmt: skip


def test_kept_answers_come_back_as_they_were(tmp_path):
    study._write_rows(tmp_path / "kept.json", ROWS)
    assert study._read_rows(tmp_path / "kept.json") == ROWS
    assert study._read_rows(tmp_path / "none.json") == []


def test_answers_kept_under_another_key_are_not_used(tmp_path, monkeypatch):
    """Rows of another version, or rows whose key was altered, are asked for again."""
    path = tmp_path / "kept.json"
    study._write_rows(path, ROWS)
    content = json.loads(path.read_text(encoding="utf-8"))
    for key in ({**content["key"], "version": "0.0.0"}, {}, None):
        path.write_text(json.dumps({**content, "key": key}), encoding="utf-8")
        assert study._read_rows(path) == [], key
    study._write_rows(path, ROWS)
    monkeypatch.setattr(study, "_KEY", {"version": "99"})
    assert study._read_rows(path) == []


@pytest.mark.parametrize("damage", ["", "[]", "{", '{"rows": []}'])
def test_damaged_answers_are_not_used(damage, tmp_path):
    path = tmp_path / "kept.json"
    study._write_rows(path, ROWS)
    path.write_text(damage, encoding="utf-8")
    assert study._read_rows(path) == []


def test_what_full_fe_cannot_say_is_refused_before_any_work():
    file = load_drive("paper")
    short = with_fields(file.cases["CS-1"], {"crank_bearing.roller_length": 8.0})
    with pytest.raises(DriveError, match=r"crank_bearing.roller_length = 8 mm: must be 11.8 mm"):
        study.plan_study(replace(file, cases={"short": short}), None, None, "quick", Settings())
