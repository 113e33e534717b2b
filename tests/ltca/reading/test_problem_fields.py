"""The field of a contradiction is data: it was read from the first word of its English sentence."""

from __future__ import annotations

import pickle
import tomllib
from pathlib import Path

import pytest

from ltca.drive.fields import field_kind, field_kinds
from ltca.errors import DriveError, Problem
from ltca.reading.changes import with_fields
from ltca.reading.contradictions import explain_contradictions, find_cause
from ltca.reading.drive_file import load_drive
from ltca.reading.physical_checks import find_contradictions

PAPER = load_drive("paper").cases["CS-1"]
ROWS = tomllib.loads(Path(__file__).with_name("refused_changes.toml").read_text(encoding="utf-8"))["refused"]
# What one field explains, and the field.
EXPLAINED = {
    "pin_wheel.pin_circle_radius": {"pin_wheel.pin_circle_radius": 40.0},
    "crank_bearing.inner_race_radius": {
        "crank_bearing.inner_race_radius": 29.5, "crank_bearing.outer_race_radius": 19.5
    },
    "pin_shaft.number_of_pins": {"pin_shaft.number_of_pins": 18},
    "crank.eccentricity": {"crank.eccentricity": 0.04},
}  # fmt: skip


def in_german(problem):
    """A contradiction in other words, fields aside: they begin with the verb, and have neither colon nor "or"."""
    words = Problem("Es muss sich etwas aendern, nicht wahr")
    for name in ("path", "subject", "said", "consequence", "trouble"):
        setattr(words, name, getattr(problem, name))
    return words


@pytest.mark.parametrize("field", EXPLAINED)
def test_the_cause_of_contradictions_was_looked_for_by_words(field):
    drive = with_fields(PAPER, EXPLAINED[field], check=False)
    problems = find_contradictions(drive)
    (told,) = explain_contradictions(drive, problems)
    assert told.path == field
    assert explain_contradictions(drive, [in_german(problem) for problem in problems]) == [told]


def test_a_sentence_without_its_field_has_no_cause():
    """A sentence of another kind, of which the field is not known, is passed on as it is."""
    problems = [Problem("crank.eccentricity = 4 mm: is mentioned by chance")]
    assert find_cause(PAPER, problems)[0] == problems
    assert problems[0].path == ""
    assert problems[0].reason("crank.eccentricity") == problems[0]
    assert not problems[0].is_about("crank.eccentricity")


def test_every_contradiction_names_its_field_as_data():
    """Fields, and tables that are missing or too much; what pydantic refuses is no contradiction."""
    tables = {".".join(path.split(".")[:end]) for path in field_kinds() for end in range(1, path.count(".") + 1)}
    found = set()
    for row in ROWS:
        if " on " in row["drive"] or row.get("before") or row.get("left_out"):
            continue
        base = next(iter(load_drive(row["drive"]).cases.values()))
        try:
            changed = with_fields(base, row["changes"], check=False)
        except DriveError:
            continue
        for problem in find_contradictions(changed):
            known = field_kind(problem.path) is not None or problem.path in tables
            assert known, problem
            assert problem == f"{problem.subject}: {problem.said}"
            found.add(problem.path)
    assert len(found) > 30


def test_the_bound_of_a_contradiction_is_the_number_that_it_says():
    """Tests read it in place of the sentence; a number is printed with two digits at least."""
    found = set()
    for row in ROWS:
        if " on " in row["drive"] or row.get("before") or row.get("left_out"):
            continue
        base = next(iter(load_drive(row["drive"]).cases.values()))
        try:
            with_fields(base, row["changes"])
        except DriveError as error:
            problems = [problem for problem in error.problems if getattr(problem, "bound", None)]
        for problem in problems:
            relation, number = problem.bound
            words = {"equal to": "must equal ", "": ""}.get(relation, f"{relation.partition(' in ')[0]} ")
            numbers = [text.split()[0].rstrip(",:;") for text in problem.said.split(words)[1:]]
            assert any(float(text) == pytest.approx(number, rel=0.05) for text in numbers if text[0] in "-0123456789"), (
                problem, problem.bound,
            )  # fmt: skip
            found.add(problem.path)
    assert len(found) > 25, len(found)


def test_an_error_carries_the_fields_of_its_mistakes_to_another_process():
    with pytest.raises(DriveError) as caught:
        PAPER.with_fields({"pin_shaft.hole_radius": 5.0, "clearance.bearing": 9.0})
    again = pickle.loads(pickle.dumps(caught.value.problems))
    assert {problem.path for problem in again} >= {"pin_shaft.hole_radius", "clearance.bearing"}
    assert [problem.said for problem in again] == [problem.said for problem in caught.value.problems]


def test_the_subject_of_what_goes_wrong_was_it():
    """`crank.eccentricity = 2.3 mm: …: the flank has loops; it overlaps its pin by 1.15 mm` was said of a hole."""
    for changes in ({"crank.eccentricity": 7.0}, {"crank_bearing.outer_race_radius": 26.0}):
        with pytest.raises(DriveError) as caught:
            PAPER.with_fields(changes)
        for problem in caught.value.problems:
            assert " it " not in problem.reason(""), problem
            assert "overlap" in str(caught.value)
