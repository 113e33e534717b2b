"""Verdicts beside the loads of a case: plays at temperature, deflections, entries of a duty, odd sizes, the core of a disc."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.verdict import proportions
from ltca.analysis.verdict.advice import _inputs, advise
from ltca.analysis.verdict.proportions import odd_proportions
from ltca.analysis.verdict.values import judge_analysis
from ltca.commands.program import main
from ltca.contact.subsurface import LINE_SHEAR, LINE_SHEAR_DEPTH, line_contact_shear_at
from ltca.drive.members.limits import parse_limits
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Duty
from ltca.geometry.coordinates import DISC_PLACE
from ltca.geometry.interference import drawn_plays
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

ANGLES = 2.0 * np.pi * np.arange(6) / 6.0 + 0.05
PAPER = load_drive("paper").cases["CS-3"]
RADII = (
    "pin_wheel.pin_circle_radius", "pin_wheel.pin_radius", "crank_bearing.inner_race_radius",
    "crank_bearing.outer_race_radius", "crank_bearing.roller_radius", "pin_shaft.pin_circle_radius",
    "pin_shaft.pin_radius", "pin_shaft.hole_radius",
)  # fmt: skip


def checks_of(drive, limits=None):
    analysis = analyse(drive, ANGLES)
    found = judge_analysis(analysis, summarise(analysis), parse_limits(limits or {}, []))
    return {check.value.quantity: check for check in found}


def warm(housing, disc, shaft):
    return {"temperature.housing": housing, "temperature.disc": disc, "temperature.shaft": shaft}


@pytest.mark.slow
def test_play_that_warmth_takes_from_the_holes_fails():
    """A note alone said so. Radius of pin and eccentricity by hand: the carrier stays, the disc grows about its centre."""
    drive = with_fields(PAPER, warm(20.0, 60.0, 20.0))
    check = checks_of(drive)["play_at_temperature"]
    assert (check.verdict, check.fails) == ("fail", True)
    expansion = drive.materials.disc.thermal_expansion * 40.0
    shaft = drive.pin_shaft
    # the hole and its circle grow, the pins and theirs do not; the eccentric of the crank does not
    lost = (shaft.pin_circle_radius - shaft.hole_radius) * expansion
    assert check.value.value == pytest.approx(-lost, rel=1e-6)
    assert check.value.part.startswith("shaft pins and holes")
    assert "temperature" in check.limit.source


@pytest.mark.slow
def test_a_limit_of_the_file_on_that_play_stands_before():
    drive = with_fields(PAPER, warm(20.0, 60.0, 20.0))
    assert checks_of(drive, {"min_play_at_temperature": -0.05})["play_at_temperature"].verdict == "pass"
    assert "play_at_temperature" not in checks_of(PAPER)


@pytest.mark.slow
def test_a_drive_too_hot_for_any_torque_is_judged_and_named(tmp_path, capsys):
    """It was refused by disc.equidistant_offset = 0.178808 mm, which nobody had written."""
    path = tmp_path / "hot.toml"
    path.write_text(drive_text(with_fields(PAPER, warm(20.0, 400.0, 20.0))), encoding="utf-8")
    assert main(["check", str(path), "--positions", "5", "--out", str(tmp_path / "o"), "--no-advice"]) == 1
    told = capsys.readouterr().out
    assert "disc 400 °C" in told
    found = json.loads((tmp_path / "o" / "check.json").read_text(encoding="utf-8"))
    rows = {row["quantity"]: row for row in found["cases"]["nominal"]}
    assert rows["play_at_temperature"]["verdict"] == rows["carried_torque"]["verdict"] == "fail"
    assert main(["run", str(path), "--positions", "5", "--no-figures", "--out", str(tmp_path / "r")]) == 2
    assert "temperature: at housing 20 °C, disc 400 °C" in capsys.readouterr().err


def test_deflection_of_a_bearing_is_what_its_rollers_are_pressed():
    """The disc moves by half the clearance and by what the most loaded rollers yield; they stand within 16.4° of the push.

    cos 16.4° leaves 4 % between them, the race that turns with the disc a little.
    """
    drive, found = PAPER, checks_of(PAPER)
    analysis = analyse(drive, ANGLES)
    place = analysis.full.pose[:, DISC_PLACE]
    moved = np.hypot(*place.T).max() - 0.5 * drive.clearance.bearing
    deflection = found["bearing_deflection"].value.value
    assert deflection == pytest.approx(moved, rel=0.06)
    assert found["bearing_deflection_by_clearance"].value.value == pytest.approx(deflection / 0.015, rel=1e-12)
    tight = checks_of(with_fields(drive, {"clearance.bearing": 0.0}))["bearing_deflection_by_clearance"]
    assert (tight.value.value, tight.verdict) == (None, "not known")
    assert "no clearance" in tight.value.reason


@pytest.mark.slow
def test_deflections_of_supports_stand_against_the_clearance_too():
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    drive = with_fields(drive, {"clearance.bearing": 0.02})
    found = checks_of(drive)
    crank = found["crank_deflection"].value
    assert found["crank_deflection_by_clearance"].value.value == pytest.approx(crank.value / 0.01, rel=1e-12)


@pytest.mark.slow
def test_a_heavier_entry_of_the_duty_is_what_counts():
    """Pressures of entries were judged by nobody. A drive loaded with that torque alone reaches the same."""
    duty = (Duty(torque=1.5 * PAPER.load.torque, speed=100.0, share=0.2), Duty(torque=1e4, speed=900.0, share=0.8))
    found = checks_of(replace(PAPER, duty=duty))
    alone = checks_of(with_fields(PAPER, {"load.torque": 1.5 * PAPER.load.torque}))
    for quantity in ("pin_pressure_mid", "roller_pressure_mid_inner", "disc_shear", "pin_load", "bearing_deflection"):
        value = found[quantity].value
        assert value.part.endswith("in duty.0"), quantity
        # the load's own summary refines its extremes between positions, entries alike
        assert value.value == pytest.approx(alone[quantity].value.value, rel=1e-9), quantity
    assert found["backlash_disc"].value.part == ""
    assert found["pin_pressure_mid"].verdict == "fail"
    light = checks_of(replace(PAPER, duty=duty[1:] and (replace(duty[1], share=1.0),)))
    assert light["pin_pressure_mid"].value == checks_of(PAPER)["pin_pressure_mid"].value


def test_life_by_a_iso_is_judged():
    """[lubricant] was not reached by any limit."""
    angles = 2.0 * np.pi * np.arange(24) / 24.0
    drive = with_fields(PAPER, {"load.speed": 1000.0, "lubricant.viscosity": 60.0, "lubricant.contamination": 0.5})
    analysis = analyse(drive, angles)
    limits = parse_limits({"min_bearing_life_modified_hours": 1e9}, [])
    found = {
        check.value.quantity: check for check in judge_analysis(analysis, summarise(analysis), limits, lives=False)
    }
    check = found["bearing_life_modified_hours"]
    assert check.verdict == "fail"
    assert check.value.value != found["bearing_life_hours"].value.value


@pytest.mark.slow
def test_shear_below_the_case_is_judged_by_the_core():
    """Johnson's closed form; where the case is thinner than the depth of the largest shear, that one counts."""
    drive = with_fields(PAPER, {"materials.disc": "16MnCr5", "materials.disc.hardness_depth": 0.05})
    thin = checks_of(drive)["core_shear"]
    thick = checks_of(with_fields(drive, {"materials.disc.hardness_depth": 2.0}))["core_shear"]
    assert thin.limit.value == pytest.approx(0.5 * drive.materials.disc.yield_strength)
    assert thin.value.value > 3.0 * thick.value.value
    assert thick.verdict == "pass"
    assert "core_shear" not in checks_of(with_fields(PAPER, {"materials.disc": "100Cr6"}))


def test_shear_at_a_depth_by_quadrature():
    """Half of σx − σz on the axis of p0 √(1 − s²), every strip by Flamant. Midpoint rule with 4000 strips: 1e-4."""
    width, strips = 0.2, 4000
    s = (np.arange(strips) + 0.5) / strips * 2.0 - 1.0
    pressure = 1000.0 * np.sqrt(1.0 - s**2)
    for depth in (0.2, 0.35, 1.0):
        x, z = s * width, depth
        each = 2.0 / np.pi * pressure * (2.0 * width / strips) * z / (x**2 + z**2) ** 2
        shear = 0.5 * abs(np.sum(each * (x**2 - z**2)))
        assert line_contact_shear_at(1000.0, width, depth) == pytest.approx(shear, rel=1e-4)
    assert line_contact_shear_at(1000.0, width, 0.01) == pytest.approx(1000.0 * LINE_SHEAR)
    at_peak = line_contact_shear_at(1.0, 1.0, LINE_SHEAR_DEPTH * (1.0 + 1e-9))
    assert at_peak == pytest.approx(LINE_SHEAR, rel=1e-6)


def test_diameters_entered_as_radii_look_odd():
    """Everything doubled but the eccentricity passed in silence: its holes no longer fit pins and eccentricity."""
    assert odd_proportions(PAPER) == []
    values = {path: 2.0 * getattr(getattr(PAPER, path.split(".")[0]), path.split(".")[1]) for path in RADII}
    circle = with_fields(PAPER, {"pin_wheel.pin_circle_radius": 176.0})
    (told,) = odd_proportions(circle)
    assert "pin_wheel.pin_circle_radius = 176 mm looks odd" in told
    assert "0.318, with 88 mm 0.636" in told  # 4 · 14/176
    with refused_field("pin_shaft.hole_radius", "= 28.15 mm"):
        with_fields(PAPER, values)
    one = with_fields(PAPER, {"pin_wheel.pin_radius": 13.0}, check=False)
    assert "pin_wheel.pin_radius = 13 mm looks odd" in odd_proportions(one)[0]


def test_public_drives_do_not_look_odd_beside_the_others(monkeypatch):
    """Four of 18 were asked "is it a diameter?" about a radius: none is, with itself left out of what it stands beside."""
    published = proportions._published()
    (own,) = {one.source.rpartition("/")[0] for one in published if one.source.endswith(".toml")}
    names = [one.source.rpartition("/")[2] for one in published if one.source.startswith(own)]
    assert len(names) == 15
    for name in names:
        monkeypatch.setattr(
            proportions,
            "_published",
            lambda name=name: [one for one in published if not one.source.endswith(f"/{name}")],
        )
        (drive,) = load_drive(Path(__file__).parents[2] / "literature" / "public_drives" / name).cases.values()
        assert not any("odd" in told for told in odd_proportions(drive)), name


def test_a_low_ratio_alone_does_not_look_odd():
    """The shipped example of a plastic disc, e z_P/R_C = 0.375, was asked whether its pin circle is a diameter."""
    drive = next(iter(load_drive(Path(__file__).parents[3] / "examples" / "drives" / "plastic.toml").cases.values()))
    assert odd_proportions(drive) == []


def test_a_printed_flank_without_play_is_pointed_out():
    """Its hollows of 1.0400 mm hold pins of 1.00138 mm without play: nothing said so. With a play of 0.1 mm nothing is to say."""
    path = Path(__file__).parents[2] / "literature" / "public_drives" / "printed_40_pins_no_clearance.toml"
    (drive,) = load_drive(path).cases.values()
    (told,) = odd_proportions(drive)
    assert "has no play, and its hollows are rounder than the pins by 0.039 mm only" in told
    assert odd_proportions(with_fields(drive, {"disc.equidistant_offset": 0.1})) == []
    assert odd_proportions(with_fields(drive, {"materials.disc": "100Cr6"})) == []


@pytest.mark.parametrize("name", ["robot-joint", "rv", "sleeved"])
def test_usual_drives_do_not_look_odd(name):
    assert odd_proportions(parse_drive(shipped_drive(name), name).cases["nominal"]) == []


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"max_pin_pressure_mid": -1500.0}, "must be greater than 0 MPa"),
        ({"min_mean_efficiency": 80.0}, "and at most 1"),
        ({"max_bearing_deflection": -1e-3}, "must be at least 0 mm"),
    ],
)
def test_limits_that_nothing_can_keep_are_refused(table, told):
    """Negative limits and efficiencies of 80 were taken; units stood twice in some messages."""
    problems = []
    parse_limits(table, problems)
    assert len(problems) == 1
    assert told in problems[0]
    for unit in ("MPa", "mm"):
        assert problems[0].count(f" {unit}") + problems[0].count(f"({unit})") <= 1
    parse_limits({"min_wall": -0.1, "min_play_at_temperature": -0.02}, problems)
    assert len(problems) == 1


def test_counts_are_advised_in_whole_numbers():
    found = {one.name: one for one in _inputs(PAPER, PAPER.load.torque)}
    rollers = found["crank_bearing.number_of_rollers"]
    assert rollers.changed(1.0 + rollers.steps[0]) == {"crank_bearing.number_of_rollers": 12}
    assert "pin_wheel.pin_circle_radius" in found
    assert "pin_wheel.number_of_pins" not in found  # that is the ratio


def test_a_soft_disc_is_not_judged_by_the_limit_of_bearing_steel():
    """Its bore passed by the 4000 MPa of ISO 76 that shipped files carry for rollers between hardened races."""
    limits = {"max_roller_pressure_mid": 4000.0}
    analysis = analyse(with_fields(PAPER, {"materials.disc": "42CrMo4"}), ANGLES)
    found = judge_analysis(analysis, summarise(analysis), parse_limits(limits, []))
    (bore,) = [
        check for check in found if check.value.quantity == "roller_pressure_mid_outer"
    ]  # and once, by the lower one
    assert (bore.limit.source, bore.asked) == ("materials.disc.allowable_pressure", True)
    assert bore.limit.value == analysis.drive.materials.disc.allowable_pressure
    race = [check for check in found if check.value.quantity == "roller_pressure_mid_inner"]
    assert len(race) == 1
    own = judge_analysis(analysis, summarise(analysis), parse_limits({"max_roller_pressure_mid_outer": 4000.0}, []))
    assert len([check for check in own if check.value.quantity == "roller_pressure_mid_outer"]) == 1


def test_bores_that_move_off_their_cranks_take_the_play_of_the_bearings():
    """An RV whose bearings seized was passed: 42 mm of disc and carrier grow apart by more than the rollers' play."""
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    warmer = with_fields(drive, warm(100.0, 100.0, 20.0))
    plays = drawn_plays(warm_drive(warmer))
    expansion = drive.materials.disc.thermal_expansion * 80.0
    bearing = drive.crank_bearing
    play = drive.bore_radius * (1.0 + expansion) - bearing.inner_race_radius
    play -= 2.0 * bearing.roller_radius * (1.0 + 0.5 * expansion)
    by_hand = play - drive.crank.circle_radius * expansion
    assert by_hand < -0.01
    assert plays["rollers and races"] == pytest.approx(by_hand, abs=1e-6)


def test_an_upper_limit_does_not_take_the_lower_one_of_a_play():
    drive = with_fields(PAPER, warm(20.0, 60.0, 20.0))
    analysis = analyse(drive, ANGLES)
    limits = parse_limits({"max_play_at_temperature": 0.5}, [])
    found = [
        c for c in judge_analysis(analysis, summarise(analysis), limits) if c.value.quantity == "play_at_temperature"
    ]
    assert sorted(check.verdict for check in found) == ["fail", "pass"]
    assert all(check.safety is None for check in found)


def test_an_eccentric_that_does_not_grow_with_its_disc_takes_play_from_the_flank():
    drive = with_fields(PAPER, {"crank.eccentricity_error": -0.02})
    assert drawn_plays(drive)["wheel pins and flank"] == pytest.approx(
        drawn_plays(PAPER)["wheel pins and flank"] - 0.02
    )


@pytest.mark.slow
def test_of_two_limits_the_one_that_fails_is_advised_on():
    """The last limit of a quantity counted: a backlash in a range had "no single change"."""
    analysis = analyse(PAPER, ANGLES)
    limits = parse_limits({"max_backlash_output": 5.0, "min_backlash_output": 1.0}, [])
    checks = [c for c in judge_analysis(analysis, summarise(analysis), limits) if c.value.quantity == "backlash_output"]
    drivers = {one.input: one for one in advise(PAPER, checks, ANGLES)["backlash_output"]}
    offset = drivers["disc.equidistant_offset"].factor * PAPER.disc.equidistant_offset
    mended = with_fields(PAPER, {"disc.equidistant_offset": offset})
    assert 1.0 < summarise(analyse(mended, ANGLES))["backlash_output_arcmin"] < 5.0


@pytest.mark.slow
def test_torque_drives_pressures():
    """An explicitly given torque left it out of every change."""
    analysis = analyse(PAPER, ANGLES)
    limits = parse_limits({"max_bearing_load": 1000.0}, [])
    checks = [c for c in judge_analysis(analysis, summarise(analysis), limits) if c.value.quantity == "bearing_load"]
    drivers = {one.input: one for one in advise(PAPER, checks, ANGLES, 0.5 * PAPER.load.torque)["bearing_load"]}
    # forces of the bearing go with the torque but for what clearances shift
    assert drivers["load.torque"].elasticity == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_static_safety_is_of_the_load_and_its_duty():
    """A light duty beside a heavy load had the S0 of the duty."""
    angles = 2.0 * np.pi * np.arange(12) / 12.0
    light = (Duty(torque=0.25 * PAPER.load.torque, speed=100.0, share=1.0),)
    found = {}
    for name, drive in {"alone": PAPER, "duty": replace(PAPER, duty=light)}.items():
        analysis = analyse(drive, angles)
        checks = judge_analysis(analysis, summarise(analysis), {})
        found[name] = next(c.value.value for c in checks if c.value.quantity == "static_safety_S0")
    assert found["duty"] == pytest.approx(found["alone"], rel=1e-12)


def test_an_entry_that_bodies_cannot_carry_fails():
    """It ended the command without a verdict on the rest."""
    duty = (Duty(torque=400.0 * PAPER.load.torque, speed=100.0, share=1.0),)
    found = checks_of(replace(PAPER, duty=duty))
    assert found["carried_torque"].verdict == "fail"
    assert found["carried_torque"].value.value == pytest.approx(1.0 / 400.0)
    assert found["pin_pressure_mid"].verdict in ("pass", "fail")


def test_a_race_is_judged_between_the_positions_too():
    """A race of 1496 MPa at twelve positions passed at 1500 MPa beside a table with 1534 MPa, found between them."""
    analysis = analyse(PAPER, position_angles(6))
    summary = summarise(analysis)
    checks = {check.value.quantity: check.value.value for check in judge_analysis(analysis, summary, {})}
    assert checks["roller_pressure_mid_inner"] == summary["refined_max_roller_pressure_mid_MPa"]
    assert checks["roller_pressure_mid_inner"] > summary["max_roller_pressure_mid_MPa"]
    assert checks["roller_pressure_mid_outer"] < checks["roller_pressure_mid_inner"]


def test_no_size_of_a_bought_bearing_is_advised():
    """The reader refuses another roller beside the name of a bearing, and its clearance is a class."""
    bought = with_fields(PAPER, {"crank_bearing.dynamic_load_rating": 3e4, "crank_bearing.static_load_rating": 4e4})
    free, held = ({one.name for one in _inputs(drive, 1.0)} for drive in (PAPER, bought))
    assert "crank_bearing.roller_radius" in free
    assert not [name for name in held if name.startswith(("crank_bearing.", "clearance.bearing"))]


def test_a_radius_that_were_as_odd_halved_is_no_diameter():
    """e z_P/R_C of 0.448, 0.896 with half the radius: published drives have 0.565 to 0.778."""
    drive = with_fields(PAPER, {"crank.eccentricity": 0.448 * 88.0 / 14.0}, check=False)
    assert not [told for told in odd_proportions(drive) if "diameter" in told and "pin_circle_radius" in told]
