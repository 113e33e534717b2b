"""Contradictions that either of two fields resolves carry both fields as data."""

from __future__ import annotations

import pickle

import pytest
from refusals import refused_field

from ltca.reading.alternatives import Alternatives, Bound
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.physical_checks import find_contradictions

PAPER = load_drive("paper").cases["CS-1"]
BOUNDS = {"crank.eccentricity": Bound("at most", 3.0), "pin_shaft.hole_radius": Bound("at least", 15.0)}


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        ({"pin_shaft.hole_radius": 13.0}, ("pin_shaft.hole_radius", "crank.eccentricity")),
        ({"pin_wheel.pin_circle_radius": 55.0}, ("crank.eccentricity", "pin_wheel.pin_circle_radius")),
        (
            {"crank.eccentricity": 6.2, "pin_shaft.hole_radius": 16.275},
            ("pin_wheel.pin_radius", "crank.eccentricity"),
        ),
    ],
)
def test_the_two_fields_of_a_contradiction_were_read_from_its_words(changes, fields):
    problem = find_contradictions(with_fields(PAPER, changes, check=False))[0]
    assert isinstance(problem, Alternatives)
    assert (problem.path, problem.other) == fields
    assert problem.startswith(f"{fields[0]} = ")
    assert problem.other_first.startswith(f"{fields[1]} = ")


def test_other_words_do_not_change_which_field_was_changed(monkeypatch):
    """A reworded message, as one in another language, lost the field of the change."""
    monkeypatch.setattr(
        "ltca.reading.changes.find_contradictions",
        lambda drive: [Alternatives.between(drive, BOUNDS, "").reworded(lambda text: text.replace("must be", "soll"))],
    )
    with refused_field("pin_shaft.hole_radius", "= 14 mm", "soll at least 15 mm or crank.eccentricity", alone=True):
        with_fields(PAPER, {"pin_shaft.hole_radius": 14.0})


def test_fields_go_with_a_contradiction_to_another_process():
    problem = Alternatives.between(PAPER, BOUNDS, "else")
    again = pickle.loads(pickle.dumps(problem))
    assert (again, again.path, again.other, again.other_first) == (
        problem, problem.path, problem.other, problem.other_first,
    )  # fmt: skip


def test_the_word_clearance_of_a_sentence_was_taken_for_a_path_of_one_disc():
    """It read "half the disc.of.0.clearance"."""
    changes = {"pin_shaft.hole_radius": 13.0, "disc.of.0.clearance.pin_hole": 0.01}
    problem = find_contradictions(with_fields(PAPER, changes, check=False))[-1]
    assert isinstance(problem, Alternatives)
    assert "half the clearance unless disc.of.0.clearance.pin_hole has it" in problem
    assert "half the clearance unless disc.of.0.clearance.pin_hole has it" in problem.other_first
