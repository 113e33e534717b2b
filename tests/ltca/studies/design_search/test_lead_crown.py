"""A lead crown as a variable of a design: what `cyclo check` would advise, within what the shop makes and the middle may bear."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.drive.members.judgement import Check, Value
from ltca.drive.members.limits import Limit
from ltca.studies.design_search.demands import find_demands
from ltca.studies.design_search.refinement import Task, _as_judged
from ltca.studies.design_search.requirement_file import parse_requirements
from ltca.studies.design_search.sizes import drive_of
from ltca.studies.design_search.solution import with_lead_crown

ASKED = """
discs = 1
held = "pin-shaft"
ratio = 14
torque = "377.3 N m"
speed = "100 rpm"
outer_diameter = "189 mm"
length = "12 mm"
[contact]
slices = 5
[materials]
disc = "100Cr6"
wheel_pin = "100Cr6"
shaft_pin = "100Cr6"
[shop]
housing_wall = 0.0
equidistant_offset = 0.15
shifting_offset = 0.09
"""
# The sizes of the paper's drive; its shaft pins are beams here, which the discs tilt on.
ROW = {
    "discs": 1.0, "pins": 14.0, "stage": 1.0, "sun": 0.0, "planet": 0.0, "eccentricity": 4.0, "pin_circle": 88.0,
    "pin_radius": 6.5, "thickness": 11.8, "bore": 29.5, "roller_radius": 5.0, "roller_length": 11.8, "rollers": 11.0,
    "holes": 8.0, "hole_circle": 56.0, "hole_pin": 10.075, "torque": 377_300.0, "equidistant_offset": 0.15,
    "shifting_offset": 0.09, "bearing_clearance": 0.002, "pin_hole_clearance": 0.002, "lead_crown_drop": 0.0,
}  # fmt: skip
ANGLES = 2.0 * np.pi * np.arange(12) / 12.0 + 1e-3


def pressed(drop, text=ASKED):
    """Largest flank pressures anywhere and at mid-width of a candidate with a crown."""
    found = analyse(drive_of(ROW | {"lead_crown_drop": drop}, parse_requirements(text)), ANGLES).pressures.pins
    return float(found.largest.max()), float(np.nanmax(found.mid))


def test_a_crowned_flank_that_hardly_touches_was_told_not_to_settle():
    """In slices it is open up to a depth, which was counted as a correction for ever: no crown balanced at the light torque."""
    found = analyse(drive_of(ROW | {"lead_crown_drop": 0.018}, parse_requirements(ASKED)), ANGLES[:3])
    assert found.light.residual.max() < 1e-6 * found.light.response.pin_load.max()


@pytest.mark.slow
def test_a_candidate_has_the_crown_that_takes_the_load_off_its_ends():
    """As much as the advice tells (`tests/ltca/analysis/test_width.py`); what the middle may have and the shop makes bound it."""
    requirements = parse_requirements(ASKED)
    free = with_lead_crown(ROW, requirements)
    drop = free["lead_crown_drop"]
    assert {name: value for name, value in free.items() if name != "lead_crown_drop"} == {
        name: value for name, value in ROW.items() if name != "lead_crown_drop"
    }
    assert drop == round(drop, 3)
    straight, here = pressed(0.0), pressed(drop)
    assert here[0] < 0.8 * straight[0]
    # Crowns press the middle more: allowed half of what this one adds there, a smaller one is taken.
    most = 0.5 * (straight[1] + here[1])
    bounded = with_lead_crown(ROW, requirements, most)["lead_crown_drop"]
    assert 0.0 < bounded < drop
    # Rounding to 1 µm is not told of by the middle.
    assert pressed(bounded - 5e-4)[1] <= most
    shop = parse_requirements(ASKED + "lead_crown_drop = [0.001, 0.002]\n")
    assert with_lead_crown(ROW, shop)["lead_crown_drop"] == 0.002


@pytest.mark.parametrize("text", ["", "lead_crown_drop = 0.003\n"], ids=["plane", "held"])
def test_a_crown_that_is_held_is_not_searched(text, monkeypatch):
    monkeypatch.setattr("ltca.studies.design_search.solution.best_lead_crown", None)
    asked = ASKED + text if text else ASKED.replace("[contact]\nslices = 5\n", "")
    requirements = parse_requirements(asked)
    row = ROW | {"lead_crown_drop": requirements.asked.lead_crowns[0]}
    assert with_lead_crown(row, requirements) == row
    assert drive_of(row, requirements).disc.lead_crown_drop == (0.003 if text else 0.0)


def test_a_pressure_anywhere_that_fails_is_demanded_by_the_limit_it_failed():
    """Where contacts end within their width the allowable pressure holds, else first yield: the solution says which."""
    requirements = parse_requirements(ASKED)
    demands = find_demands(requirements)
    task = Task(requirements=requirements, demands=demands, row=ROW)
    before = {one.quantity: one.value for one in demands if one.sense == "max"}
    assert before["pin_pressure_max"] > 3000.0  # first yield of hardened steel
    limit = Limit(quantity="pin_pressure_max", sense="max", value=1500.0, source="materials.disc.allowable_pressure")
    check = Check(value=Value(quantity="pin_pressure_max", value=1600.0), limit=limit)
    judged = _as_judged(task, SimpleNamespace(checks=(check,)))
    after = {one.quantity: one.value for one in judged.demands if one.sense == "max"}
    assert after == before | {"pin_pressure_max": 1500.0}
    assert len(judged.demands) == len(demands)
    margin = next(one for one in judged.demands if one.quantity == "pin_pressure_max").margin(1600.0)
    assert float(margin) == pytest.approx(math.log(1500.0 / 1600.0), rel=1e-12)


@pytest.mark.slow
@pytest.mark.nightly
def test_a_design_with_a_crown_passes_the_check(tmp_path, capsys):
    (tmp_path / "asked.toml").write_text(
        ASKED.replace('"189 mm"', '"200 mm"')
        + "[limits]\nmax_pin_pressure_mid = 1600.0\nmax_pin_pressure_max = 1700.0\n",
        encoding="utf-8",
    )
    out = tmp_path / "found"
    assert main(["design", str(tmp_path / "asked.toml"), "--quick", "--best", "1", "--out", str(out)]) == 0
    text = (out / "design-1.toml").read_text(encoding="utf-8")
    assert "lead_crown_drop = 0.00" in text
    assert "slices = 5" in text
    assert "lead crown drop of the flank, mm" in (out / "designs.csv").read_text(encoding="utf-8")
    assert main(["check", str(out / "design-1.toml"), "--no-advice", "--out", str(tmp_path / "check")]) == 0
    assert "0 failed" in capsys.readouterr().out
