"""`ltca.curves`: what ``cyclo curves`` computes, as an object."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import error_says

import ltca
from ltca.analysis import drive_curves, torque_curve
from ltca.analysis.transmission_error_orders import Order
from ltca.commands.program import main
from ltca.drive.single_discs import single_discs
from ltca.drive.units.quantities import ARCMIN
from ltca.errors import DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import play_over_a_turn
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

FILE = load_drive("paper")


@pytest.mark.slow  # lives by slices take seconds
def test_they_are_the_curves_of_the_command(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(torque_curve, "CURVE_ANGLES", 1)
    monkeypatch.setattr(drive_curves, "POSITIONS_PER_TURN", 44)
    monkeypatch.setattr(drive_curves, "fitted_orders", lambda drive, harmonics: (Order(8.0, "a"), Order(13.0, "b")))
    words = ["--turns", "1", "--speed", "1500 rpm", "--pressure-limit", "1.2 GPa", "--lost-motion", "5 %"]
    out = tmp_path / "out"
    assert main(["curves", "paper", "--case", "CS-6", "--no-page", "--out", str(out), *words]) == 0
    printed = capsys.readouterr().out
    kept = json.loads((out / "curves.json").read_text(encoding="utf-8"))
    options = {"speed": "1500 rpm", "pressure_limit": "1.2 GPa", "lost_motion": "5 %"}
    found = ltca.curves(FILE, 1, case="CS-6", **options)
    content = json.loads(json.dumps(found.content))
    assert {name: kept[name] for name in content} == content
    assert kept.keys() - content.keys() == {"drive", "compliance", "method", "contacts"}
    assert printed.startswith(repr(found))
    alone = ltca.curves(FILE.cases["CS-6"], 1, **options)
    assert alone.content == found.content


def test_the_backlash_of_curves_was_that_of_four_angles_without_a_word():
    """24.54 … 24.83′ stood in `curves` beside 24.35 … 25.22′ in `run`: those of four angles over one mesh."""
    drive = FILE.cases["CS-6"]
    curve = SimpleNamespace(backlash=np.array([1.0, 2.0]) / ARCMIN, crank_angle=np.zeros(2))
    kept = {"engine": None, "settings": None, "turns": 1, "positions": 2, "spectrum": None, "lives": None}
    kept |= {"crank_angle": None, "pressure": None, "safety": None}
    found = drive_curves.DriveCurves(drive=drive, curve=curve, play=drive_curves._play_over_a_turn(drive), **kept)
    turn = play_over_a_turn([ContactGeometry.of_drive(single) for single in single_discs(drive)])
    low, high = (abs(drive.output_per_wheel_angle) * ARCMIN * one for one in (turn.least, turn.largest))
    assert found.backlash_words == f"{low:.4g} … {high:.4g}′, sampled over a turn"
    alone = drive_curves.DriveCurves(drive=drive, curve=curve, **kept)
    assert alone.backlash_words == "1 … 2′, sampled at 2 crank angles over one mesh"


def test_limits_of_the_file_judge_the_pressure(monkeypatch):
    """Of one drive alone they are the materials'; what is given replaces both."""
    asked = []
    monkeypatch.setattr("ltca.front.curves.solve_curves", lambda drive, turns, settings, engine: asked.append(settings))
    file = parse_drive(
        shipped_drive("sleeved").replace("[limits]\n", "[limits]\nmax_pin_pressure_mid = 1300\n"), "sleeved"
    )
    ltca.curves(file)
    ltca.curves(file.cases["nominal"])
    ltca.curves(file, pressure_limit="1.1 GPa")
    ltca.curves(file, limits={"max_pin_pressure_mid": 1200})
    materials = file.cases["nominal"].materials
    lowest = min(materials.disc.allowable_pressure, materials.wheel_pin.allowable_pressure)
    assert [one.pressure for one in asked] == [1300.0, lowest, 1100.0, 1200.0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"turns": 0}, "turns = 0: must be a whole number from 1 to 1000"),
        ({"turns": 1}, "turns = 1: must be at least 4, or 66 orders of the transmission error look alike"),
        ({"speed": "3 mm"}, "speed = '3 mm': must have the unit rpm"),
        ({"speed": 0}, "speed = 0: must be greater than 0 rpm"),
        ({"lost_motion": "60 %"}, "lost_motion = '60 %': must be at least 0.001 and at most 0.5"),
        ({"load_rating": "4 mm"}, "load_rating = '4 mm': must have the unit N"),
        ({"pressure_limit": [3]}, "pressure_limit = [3]: must be a number in MPa"),
        ({"case": None}, "case: must be given"),
        ({"drive": "paper", "case": None}, "must be one Drive, not a str"),
        ({"compliance": "soft"}, "compliance = 'soft': is unknown"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(options, message):
    with error_says(DriveError, message):
        ltca.curves(**({"drive": FILE, "case": "CS-1"} | options))


def test_a_duty_has_its_own_speeds():
    text = shipped_drive().partition("\n[tolerances]")[0] + '\n[[duty]]\ntorque = "300 N m"\nspeed = 900\nshare = 1\n'
    with error_says(DriveError, starts="speed: has no effect with [[duty]]"):
        ltca.curves(parse_drive(text, "mine"), speed=1000)
