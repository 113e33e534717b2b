"""Changes of a drive that are refused: one table of fields, values and messages, each message one line that names the field."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from refusals import stands_in

from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive

ROWS = tomllib.loads(Path(__file__).with_name("refused_changes.toml").read_text(encoding="utf-8"))["refused"]
SHAFT_BEAM = 'beam = { span = 24.0, tip = "tied-clamped" }'


def drive_named(name):
    """A shipped drive; on springs, which beams may take the place of, if so."""
    of, _, springs = name.partition(" on ")
    text = shipped_drive(of)
    if springs:
        assert SHAFT_BEAM in text
        text = text.replace(SHAFT_BEAM, "stiffness = 2.0e5")
    return next(iter(parse_drive(text, of).cases.values()))


def fault(drive, row):
    """What is wrong with the answer to a change, None where its message is as it should be."""
    changes = row["changes"] | dict.fromkeys(row.get("left_out", ()))
    try:
        with_fields(drive, changes)
    except DriveError as error:
        problems = error.problems
    else:
        return f"{changes} is accepted"
    pieces, alone = row["message"], row.get("alone", False)
    named = problems[0].startswith(pieces[0]) and len(problems) == 1 if alone else True
    if any("\n" in one for one in problems) or not (named and any(stands_in(pieces, one) for one in problems)):
        return f"{changes}: {problems} for {pieces}"
    return None


@pytest.mark.parametrize("name", sorted({row["drive"] for row in ROWS}))
def test_bad_fields_are_refused_in_a_line_that_names_them(name):
    drive = drive_named(name)
    rows = [row for row in ROWS if row["drive"] == name]
    assert [told for row in rows if (told := fault(with_fields(drive, row.get("before", {})), row))] == []


def test_a_change_that_is_accepted_or_told_otherwise_is_found():
    drive, row = (
        drive_named("rv"),
        {"changes": {"crank.support.diameter": 27.0}, "message": ["at most", "must"]},
    )
    assert "for ['at most', 'must']" in fault(drive, row)
    alone = {"alone": True, "message": ["must be at most 26 mm"]}
    assert "for ['must be at most 26 mm']" in fault(drive, row | alone)
    assert "is accepted" in fault(drive, row | {"changes": {"crank.support.diameter": 25.0}})
