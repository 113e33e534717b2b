"""Refinement of one candidate: what solutions shift of closed forms, and when a candidate is given up."""

import math

import pytest

from ltca.studies.design_search import refinement
from ltca.studies.design_search.closed_forms import Setting, closed_forms
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.refinement import Task, refine
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.sizes import Sizes
from ltca.studies.design_search.solution import Solution

REQUIREMENTS = parse_requirements("""
discs = 1
held = "pin-shaft"
ratio = 14
torque = "377.3 N m"
speed = 107.14
outer_diameter = 200.0
length = 12.0
[shop]
equidistant_offset = 0.15
shifting_offset = 0.09
bearing_clearance = 0.0
pin_hole_clearance = 0.0
shaft_pin_stiffness = 1.0e6
[materials]
disc = "100Cr6"
wheel_pin = "100Cr6"
roller = "100Cr6"
inner_race = "100Cr6"
shaft_pin = "100Cr6"
""")
ROW = {
    "discs": 1.0, "pins": 14.0, "stage": 1.0, "sun": 0.0, "planet": 0.0, "eccentricity": 4.0, "pin_circle": 88.0,
    "pin_radius": 6.5, "thickness": 11.8, "bore": 29.5, "roller_radius": 5.0, "roller_length": 11.8, "rollers": 11.0,
    "holes": 8.0, "hole_circle": 56.0, "hole_pin": 10.075, "torque": 377_300.0, "equidistant_offset": 0.15,
    "shifting_offset": 0.09, "bearing_clearance": 0.0, "pin_hole_clearance": 0.0, "lead_crown_drop": 0.0,
}  # fmt: skip
TASK = Task(requirements=REQUIREMENTS, demands=find_demands(REQUIREMENTS), row=ROW)


def by_closed_forms(row):
    values = closed_forms(Sizes.of_rows([row]), Setting.of(REQUIREMENTS))
    return {name: float(value[0]) for name, value in values.items()}


def test_shifts_are_logarithms_of_what_solutions_find_beside_closed_forms(monkeypatch):
    """A pressure a tenth higher leaves ln 1.1 less of its margin; what is no closed form of a size does not shift."""
    more = {"pin_pressure_mid": 1.1, "roller_pressure_mid_outer": 0.8}

    def solved(row, *_):
        return Solution(values={name: value * more.get(name, 1.0) for name, value in by_closed_forms(row).items()})

    monkeypatch.setattr(refinement, "solve_coarsely", solved)
    shifts = refine(TASK, most=1).shifts
    assert shifts.pop("pin_pressure_mid") == pytest.approx(-math.log(1.1), rel=1e-9)
    assert shifts.pop("roller_pressure_mid_outer") == pytest.approx(math.log(1.25), rel=1e-9)
    assert "pin_shaft_pressure_mid" in shifts
    assert set(shifts.values()) == {0.0}


@pytest.mark.parametrize(
    ("violations", "solved"),
    [
        ((0.5, 0.3, 0.12, 0.05), 4),  # each less than 0.7 of the one before
        ((0.5, 0.45, 0.1, 0.05), 2),
        ((0.02, 0.019, 0.018, 0.017), 4),  # less than 0.03: the next step may remove it
    ],
    ids=["falls", "stays", "small"],
)
def test_candidates_are_given_up_where_their_violations_stay(violations, solved, monkeypatch):
    left = list(violations)

    def violated(row, *_):
        limit = next(one.value for one in TASK.demands if one.quantity == "pin_pressure_mid")
        return Solution(values=by_closed_forms(ROW) | {"pin_pressure_mid": limit * math.exp(left.pop(0))})

    monkeypatch.setattr(refinement, "solve_coarsely", violated)
    monkeypatch.setattr(refinement, "with_lead_crown", lambda row, *_: row)
    monkeypatch.setattr(refinement, "_improve", lambda row, *_: row | {"pin_circle": 1.01 * row["pin_circle"]})
    found = refine(TASK, most=4)
    assert not found.fits
    assert found.solved == solved
