"""Limits, verdicts and advice: where limits come from, what fails, what would mend it, stress of pins."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from refusals import reads_as, refused_field

from ltca.analysis.engines import Hybrid
from ltca.analysis.half_width_guard import displacement_warning
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.advice import (
    SIZES,
    Driver,
    _all_sizes,
    _driver,
    _Input,
    _inputs,
    _without_contradictions,
    advise,
)
from ltca.analysis.verdict.drive_check import _at_once
from ltca.analysis.verdict.geometry import pin_hollow_margin, roller_gap, undercut_margin, walls
from ltca.analysis.verdict.pin_stress import pin_stress, worst_cycle
from ltca.analysis.verdict.values import find_values, judge_analysis
from ltca.commands.program import main
from ltca.drive.members.judgement import Check, Value, judge
from ltca.drive.members.limits import Limit, parse_limits
from ltca.drive.members.pins import WheelPinSeat
from ltca.drive.members.verdict_words import part_words, verdict_line, verdict_table
from ltca.drive.parts import Material
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError
from ltca.geometry.coordinates import DISC_PLACE
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

ANGLES = 2.0 * np.pi * np.arange(6) / 6.0 + 0.05


@pytest.fixture(scope="module")
def paper():
    plain = Material()
    drive = load_drive("paper").cases["CS-1"]
    return replace(
        drive,
        materials=replace(
            drive.materials, disc=plain, wheel_pin=plain, roller=plain, inner_race=plain, shaft_pin=plain
        ),
    )


@pytest.fixture(scope="module")
def checked(paper):
    analysis = analyse(paper, ANGLES)
    return analysis, summarise(analysis)


def checks_of(drive, checked, limits):
    analysis, summary = checked
    problems = []
    found = parse_limits(limits, problems)
    assert problems == []
    return judge_analysis(replace(analysis, drive=drive), summary, found)


def named(checks, quantity):
    return [check for check in checks if check.value.quantity == quantity]


@pytest.mark.slow
def test_a_value_without_a_limit_is_said_to_have_none(paper, checked):
    (check,) = named(checks_of(paper, checked, {}), "pin_pressure_mid")
    assert check.verdict == "no limit"
    assert check.safety is None
    assert check.value.value == np.max(checked[0].pressures.pins.mid)


@pytest.mark.slow
def test_limits_of_the_file_stand_before_those_of_materials(paper, checked):
    largest = float(np.max(checked[0].pressures.pins.mid))
    soft = replace(paper, materials=replace(paper.materials, disc=Material(allowable_pressure=0.884 * largest)))
    (check,) = named(checks_of(soft, checked, {}), "pin_pressure_mid")
    assert check.verdict == "fail"
    assert check.safety == pytest.approx(0.884, rel=1e-12)
    assert check.limit.source == "materials.disc.allowable_pressure"
    (check,) = named(
        checks_of(soft, checked, {"max_pin_pressure_mid": {"value": 1.1 * largest, "source": "ours"}}),
        "pin_pressure_mid",
    )
    assert (check.verdict, check.limit.source) == ("pass", "ours")


def test_the_weaker_of_two_materials_counts(paper, checked):
    parts = replace(
        paper.materials, disc=Material(allowable_pressure=2000.0), wheel_pin=Material(allowable_pressure=900.0)
    )
    (check,) = named(checks_of(replace(paper, materials=parts), checked, {}), "pin_pressure_mid")
    assert (check.limit.value, check.limit.source) == (900.0, "materials.wheel_pin.allowable_pressure")


def test_a_body_without_an_allowable_is_not_judged_by_the_other(paper, checked):
    """A plastic disc passed by the 1500 MPa of its steel pins."""
    parts = replace(paper.materials, wheel_pin=Material(allowable_pressure=1500.0))
    (check,) = named(checks_of(replace(paper, materials=parts), checked, {}), "pin_pressure_mid")
    assert (check.verdict, check.value.reason) == (
        "no limit",
        "materials.disc has no allowable_pressure, hardness or yield_strength",
    )
    parts = replace(paper.materials, wheel_pin=Material(allowable_pressure=100.0))  # which is too much in any case
    (check,) = named(checks_of(replace(paper, materials=parts), checked, {}), "pin_pressure_mid")
    assert check.verdict == "fail"


def test_one_yield_of_one_contact_is_one_check(paper, checked):
    """Pressure, shear and strain of one contact failed together, by the same yield strength.

    First yield below a line contact is at p = 1.67 Y: shear 0.3 p = Y/2 and strain p/E = 1.67 Y/E by the same strength.
    """
    largest = float(np.max(checked[0].pressures.pins.mid))
    soft = Material(youngs_modulus=1600.0, yield_strength=0.5 * largest / 1.67)
    checks = checks_of(
        replace(paper, materials=replace(paper.materials, disc=soft, wheel_pin=Material(yield_strength=1700.0))),
        checked,
        {},
    )
    (check,) = named(checks, "pin_pressure_mid")
    assert (check.verdict, check.safety) == ("fail", pytest.approx(0.5, rel=1e-12))
    assert check.limit.source.endswith("Y = materials.disc.yield_strength")
    for quantity in ("disc_shear", "contact_strain"):
        assert [(told.verdict, told.value.value is None) for told in named(checks, quantity)] == [("no limit", False)]
    (strain,) = named(checks, "contact_strain")
    assert strain.value.value == pytest.approx(largest / 1600.0)
    (asked,) = named(checks_of(paper, checked, {"max_contact_strain": 1e-6}), "contact_strain")
    assert asked.verdict == "fail"


def test_hardened_surfaces_yield_by_their_hardness(paper, checked):
    """The strain of a hardened disc was held against its core's strength."""
    hard = Material(yield_strength=590.0, hardness=700.0)
    (check,) = named(
        checks_of(replace(paper, materials=replace(paper.materials, disc=hard, wheel_pin=hard)), checked, {}),
        "pin_pressure_mid",
    )
    assert check.limit.value == pytest.approx(1.67 * 9.81 / 3.0 * 700.0)


def test_an_allowable_beyond_first_yield_is_not_used(paper, checked):
    """A named plastic with a measured yield strength of half its own kept the allowable pressure of the name."""
    measured = Material(youngs_modulus=1400.0, yield_strength=35.0, allowable_pressure=73.0)
    parts = replace(paper.materials, disc=measured, wheel_pin=Material(allowable_pressure=1500.0))
    (check,) = named(checks_of(replace(paper, materials=parts), checked, {}), "pin_pressure_mid")
    assert check.limit.value == pytest.approx(1.67 * 35.0)
    (check,) = named(
        checks_of(replace(paper, materials=parts), checked, {"max_pin_pressure_mid": 100.0}), "pin_pressure_mid"
    )
    assert (check.limit.value, check.asked) == (pytest.approx(1.67 * 35.0), True)


def test_rollers_are_judged_by_the_bodies_they_press(paper, checked):
    """Steel rollers on a steel race failed by the allowable of a plastic disc."""
    steel = Material(allowable_pressure=4000.0)
    parts = replace(paper.materials, disc=Material(allowable_pressure=70.0), roller=steel, inner_race=steel)
    checks = checks_of(replace(paper, materials=parts), checked, {})
    assert named(checks, "roller_pressure_mid_outer")[0].verdict == "fail"
    assert named(checks, "roller_pressure_mid_inner")[0].verdict == "pass"
    both = checks_of(replace(paper, materials=parts), checked, {"max_roller_pressure_mid": 3000.0})
    assert {named(both, f"roller_pressure_mid_{side}")[0].limit.value for side in ("outer", "inner")} == {3000.0}
    assert not named(both, "roller_pressure_mid")


def test_a_least_value_does_not_lift_what_is_most(paper, checked):
    """``min_pin_pressure_mid = 0`` took the allowable of the materials away, and a limit of ours that of a theory."""
    parts = replace(
        paper.materials, disc=Material(allowable_pressure=100.0), wheel_pin=Material(allowable_pressure=100.0)
    )
    limits = {"min_pin_pressure_mid": 0.0, "max_half_width_ratio": 5.0}
    checks = checks_of(replace(paper, materials=parts), checked, limits)
    assert {check.verdict for check in named(checks, "pin_pressure_mid")} == {"pass", "fail"}
    assert {check.limit.value for check in named(checks, "half_width_ratio")} == {
        0.3
    }  # the theory's, which is stricter


def test_a_limit_that_is_asked_for_and_cannot_be_judged_fails(paper, checked):
    (check,) = named(checks_of(paper, checked, {"max_crank_deflection": 0.01}), "crank_deflection")
    assert (check.verdict, check.fails) == ("not known", True)
    (check,) = named(checks_of(paper, checked, {}), "root_stress")
    assert (check.verdict, check.fails) == ("not known", False)


def test_pins_that_dwarf_the_disc_are_pointed_out(paper):
    from ltca.analysis.verdict.values import notes

    soft = replace(
        paper,
        materials=replace(paper.materials, disc=Material(youngs_modulus=1600.0)),
        load=replace(paper.load, torque=1e4),
    )
    stiff = replace(soft, pin_shaft=replace(soft.pin_shaft, stiffness=1e6))
    assert any("pin_shaft.stiffness = 1e+06 N/mm dwarfs the disc" in note for note in notes(analyse(stiff, ANGLES)))
    assert not any("dwarfs" in note for note in notes(analyse(paper, ANGLES)))
    on_bodies = replace(analyse(stiff, ANGLES), engine=Hybrid())  # which has the walls, and was told to try itself
    assert not any("dwarfs" in note for note in notes(on_bodies))


@pytest.mark.slow
def test_a_small_drive_with_a_large_torque_fails_with_sizes(tmp_path, capsys):
    """A drive of 30 mm at 377 N·m was refused without a word on sizes."""
    found = load_drive("paper").cases["CS-1"]
    small = with_fields(found, _all_sizes(found).changed(30.0 / 176.0), check=False)
    path = tmp_path / "small.toml"
    path.write_text(drive_text(small), encoding="utf-8")
    assert main(["check", str(path), "--positions", "27", "--out", str(tmp_path / "o"), "--no-advice"]) == 1
    told = capsys.readouterr().out
    assert "part of the torque that is carried" in told
    factor = float(re.search(r"All sizes × ([0-9.]+) would", told).group(1))
    assert 1.0 < factor < 176.0 / 30.0


@pytest.mark.slow
def test_what_is_advised_can_be_built(paper, checked):
    largest = float(np.max(checked[0].pressures.pins.mid))
    checks = checks_of(paper, checked, {"max_pin_pressure_mid": 0.6 * largest})
    drivers = advise(paper, checks, ANGLES)["pin_pressure_mid"]
    assert any(driver.change for driver in drivers)
    thickness = next(driver for driver in drivers if driver.input == "disc.thickness")
    assert not thickness.change or "with crank_bearing.roller_length" in thickness.change
    eccentricity = next(driver for driver in drivers if driver.input == "crank.eccentricity")
    assert eccentricity.factor is None  # larger ones undercut the flank


def test_where_and_when(paper, checked):
    analysis = checked[0]
    position, pin = np.unravel_index(np.argmax(analysis.full.response.pin_load), analysis.full.response.pin_load.shape)
    (check,) = named(checks_of(paper, checked, {}), "pin_load")
    assert check.value.part == f"wheel pin {pin}"
    assert check.value.crank_angle == ANGLES[position]


def test_a_range_is_two_checks(paper, checked):
    low, high = named(
        checks_of(paper, checked, {"max_backlash_output": "9 arcmin", "min_backlash_output_arcmin": 3.0}),
        "backlash_output",
    )
    assert {low.verdict, high.verdict} == {"pass", "fail"}


def test_a_limit_on_what_is_not_there_is_said(paper, checked):
    (check,) = named(checks_of(paper, checked, {"max_pin_seat_pressure": 100.0}), "pin_seat_pressure")
    assert (check.verdict, check.value.value) == ("not known", None)
    assert check.value.reason


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"max_pin_presure_mid": 3.0}, "did you mean `max_pin_pressure_mid`"),
        ({"max_pin_load": "3 mm"}, "must have the unit N"),
        ({"max_wall": {"value": 1.0, "origin": "x"}}, "table of value and source"),
        ({"min_wall": 3.0, "max_wall": 2.0}, "limits.min_wall = 3: must be at most 2"),
        ({"max_pin_load": 3.0, "max_pin_load_N": 2.0}, "given twice"),
        (7, "must be a table"),
    ],
)
def test_wrong_limits_are_refused_by_name(table, told):
    problems = []
    parse_limits(table, problems)
    assert len(problems) == 1
    assert told in problems[0]


def test_cases_may_have_limits_of_their_own():
    text = shipped_drive("paper")
    head, case, tail = text.partition("[[case]]")
    head = re.sub(r"\[limits\]\nmax_roller[^\n]*\n", "", head)
    text = (
        head
        + "[limits]\nmax_pin_load = 5000.0\n"
        + case
        + tail.replace("\n", "\nlimits = { max_pin_load = 4000.0 }\n", 1)
    )
    file = parse_drive(text, "paper")
    first, *others = file.cases
    assert file.limits[first]["max_pin_load"].value == 4000.0
    assert file.limits[others[0]]["max_pin_load"].value == 5000.0
    with pytest.raises(DriveError, match=r"limits\.max_pin_laod"):
        parse_drive(text.replace("max_pin_load = 5000.0", "max_pin_laod = 5000.0"), "paper")


def test_margins_of_the_shape(paper):
    """By hand: the flank of the paper's drive is generated with pins of r_P + Δr_P."""
    assert undercut_margin(paper) > 0.0
    larger = with_fields(paper, {"pin_wheel.pin_radius": paper.pin_wheel.pin_radius + 0.1}, check=False)
    assert undercut_margin(larger) == pytest.approx(undercut_margin(paper) - 0.1, abs=1e-9)
    # the hollow of an offset curve is larger by what the pin grows, as the flank is generated with it
    assert pin_hollow_margin(larger) == pytest.approx(pin_hollow_margin(paper), abs=1e-6)
    bearing = paper.crank_bearing
    pitch = bearing.inner_race_radius + bearing.roller_radius
    chord = abs(pitch - pitch * np.exp(2j * np.pi / bearing.number_of_rollers))
    assert roller_gap(paper) == pytest.approx(chord - 2.0 * bearing.roller_radius, rel=1e-12)
    shaft = paper.pin_shaft
    between = abs(shaft.pin_circle_radius - 0.0) - paper.hole_radius - paper.bore_radius
    assert dict(walls(paper))["between hole and bore"] == pytest.approx(between, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("pins", "end"), [("wheel", "supported"), ("shaft", "free"), ("shaft", "tied-pinned")])
def test_pins_bend_under_the_forces_of_all_discs(pins, end):
    """Moments of single pins by quadrature of the load about every section: two supports by statics, a free tip from the tip.

    Tips tied by a floating ring go where the mean of their free deflections w, and of the turns that these are, takes the ring:
    each is held by the tip's own stiffness times what it lacks, and all that holds is in balance with itself.
    """
    drive = parse_drive(shipped_drive("sleeved"), "sleeved").cases["nominal"]
    if pins == "wheel":
        drive = replace(drive, pin_wheel=replace(drive.pin_wheel, beam=replace(drive.pin_wheel.beam, ends=end)))
        beam, d = drive.pin_wheel.beam, drive.pin_wheel.beam_diameter
    else:
        drive = replace(drive, pin_shaft=replace(drive.pin_shaft, beam=replace(drive.pin_shaft.beam, tip=end)))
        beam, d = drive.pin_shaft.beam, drive.pin_shaft.beam_diameter
    analysis = analyse(drive, ANGLES[:2])
    found = pin_stress(analysis, pins)
    planes, width = np.array(drive.disc.disc_planes) + 0.5 * beam.span, drive.disc.thickness
    forces = []
    for part in analysis.full.response.parts:
        motion, load = (part.flank, part.pin_load) if pins == "wheel" else (part.holes, part.hole_load)
        push = load[..., None] * motion.gradient[..., DISC_PLACE]
        forces.append(push[..., 0] + 1j * push[..., 1])
    z = np.linspace(0.0, beam.span, 401)
    s = (np.arange(400) + 0.5) / 400.0 * width - 0.5 * width
    moments = np.zeros((z.size, *forces[0].shape), dtype=complex)
    for moment, at in zip(moments, z, strict=True):
        for force, plane in zip(forces, planes, strict=True):
            places = plane + s
            beyond = np.clip(places - at, 0.0, None).mean()
            if pins == "shaft":  # from the free tip
                moment += force * beyond
            else:
                reaction = force * plane / beam.span  # of the far support
                moment += reaction * (beam.span - at) - force * beyond
    tip = np.zeros(forces[0].shape, dtype=complex)
    if end == "tied-pinned":
        steel, arm = drive.materials.shaft_pin, (beam.span - z)[:, None, None]
        bent, nu = steel.youngs_modulus * np.pi * d**4 / 64.0, steel.poisson_ratio
        # κ G A by Cowper (1966) of a round section
        sheared = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu) * steel.youngs_modulus / (2.0 * (1.0 + nu)) * np.pi * d**2 / 4.0
        free = np.trapezoid(moments * arm, z, axis=0) / bent + moments[0] / sheared  # virtual work; ∫ V dz is M(0)
        yields = beam.span**3 / (3.0 * bent) + beam.span / sheared
        centres = np.exp(2j * np.pi * np.arange(drive.pin_shaft.number_of_pins) / drive.pin_shaft.number_of_pins)
        turned = (centres.conj() * free).imag.mean(axis=1, keepdims=True)
        tip = (free.mean(axis=1, keepdims=True) + 1j * turned * centres - free) / yields
        assert np.abs(tip).max() > 0.2 * np.abs(forces[0]).max()
        moments += tip * arm
    expected = 32.0 * np.abs(moments).max(axis=0) / (np.pi * d**3)
    assert expected.max() > 10.0
    # largest between 400 sections and 200 of the beam's own: the moment is flat there
    np.testing.assert_allclose(found.bending, expected, rtol=2e-3, atol=1e-3 * expected.max())
    if pins == "wheel":  # at the support that carries more
        ends = [
            sum(force * part for force, part in zip(forces, side, strict=True))
            for side in (planes / beam.span, 1.0 - planes / beam.span)
        ]
        shear = np.maximum(*np.abs(ends))
    else:  # in the flange, between the discs where the forces on them oppose each other, or beyond them
        shear = np.abs([forces[0] + forces[1] + tip, forces[1] + tip, tip]).max(axis=0)
    # 401 sections of a trapezoid say where a tied tip would go to 1e-5
    np.testing.assert_allclose(
        found.shear, 16.0 * shear / (3.0 * np.pi * d**2), rtol=1e-9 if end != "tied-pinned" else 1e-4, atol=1e-9
    )


def test_fixed_pins_are_no_beams(checked):
    assert pin_stress(checked[0], "wheel") is None


@pytest.mark.slow
def test_advice_is_about_what_mends_it(paper, checked):
    """A line contact's pressure goes with the root of the load and of the length: what is said is tried."""
    largest = float(np.max(checked[0].pressures.pins.mid))
    checks = checks_of(paper, checked, {"max_pin_pressure_mid": 0.9 * largest})
    drivers = {driver.input: driver for driver in advise(paper, checks, ANGLES)["pin_pressure_mid"]}
    torque = drivers["load.torque"]
    assert 0.3 < torque.elasticity < 0.6
    mended = analyse(with_fields(paper, {"load.torque": torque.factor * paper.load.torque}), ANGLES)
    assert np.max(mended.pressures.pins.mid) == pytest.approx(0.9 * largest, rel=0.02)
    assert drivers["all sizes"].elasticity < -1.0
    assert drivers["disc.thickness"].factor > 1.0
    assert "materials.disc.youngs_modulus" not in drivers  # another modulus is another material, of another strength


def test_nothing_drives_what_has_no_limit(paper, checked):
    checks = checks_of(paper, checked, {})
    assert "pin_pressure_mid" not in advise(
        replace(paper), [check for check in checks if check.value.quantity == "pin_pressure_mid"], ANGLES
    )


def paper_with(tmp_path, limits, name="mine.toml"):
    head, case, tail = shipped_drive("paper").partition("[[case]]")
    head = re.sub(r"\[limits\]\nmax_roller[^\n]*\n", "", head)
    path = tmp_path / name
    path.write_text(f"{head}\n[limits]\n{limits}\n{case}{tail}", encoding="utf-8")
    return path


def test_check_ends_with_1_where_something_fails(tmp_path, capsys):
    path = paper_with(tmp_path, "max_pin_pressure_mid = 1300.0\nmin_backlash_output = '1 arcmin'")
    out = tmp_path / "out"
    assert main(["check", str(path), "--case", "CS-1", "--positions", "27", "--out", str(out), "--no-advice"]) == 1
    found = json.loads((out / "check.json").read_text(encoding="utf-8"))
    assert found["verdict"] == "fail"
    (row,) = [row for row in found["cases"]["CS-1"] if row["quantity"] == "pin_pressure_mid"]
    assert row["verdict"] == "fail"
    assert row["safety"] == pytest.approx(1300.0 / row["value"])
    assert row["part"].startswith("wheel pin")
    assert row["source"] == "[limits], no source given"
    assert "FAIL" in capsys.readouterr().out


def test_check_ends_with_0_where_nothing_fails(tmp_path):
    path = paper_with(
        tmp_path,
        "max_pin_pressure_mid = 3000.0\nmax_roller_pressure_mid = 3000.0\nmax_pin_shaft_pressure_mid = 3e3",
    )
    assert (
        main(["check", str(path), "--case", "CS-1", "--positions", "27", "--out", str(tmp_path / "o"), "--no-advice"])
        == 0
    )


@pytest.mark.slow
def test_run_shows_the_verdict_first_and_ends_with_0(tmp_path, capsys):
    path = paper_with(tmp_path, "max_pin_pressure_mid = 1300.0")
    assert (
        main(["run", str(path), "--case", "CS-1", "--positions", "27", "--out", str(tmp_path / "o"), "--no-figures"])
        == 0
    )
    told = capsys.readouterr().out
    assert told.index("FAIL") < told.index("largest load [N]")


def moved_to(stress, **how):
    """The worst cycle of one section of one pin, its moments as vectors, MPa."""
    return worst_cycle(np.asarray(stress, dtype=complex)[:, None, None], **{"alike": False, "rolls": False, **how})


def test_the_equivalent_amplitude_of_what_can_be_said_by_hand():
    """√(σ_max σ_a): reversed the amplitude itself, pulsating 1/√2 of the largest, about a mean by both."""
    turn = np.exp(2j * np.pi * np.arange(360) / 360)
    reversed_, pulsating = moved_to([100.0, -100.0, 0.0]), moved_to([0.0, 100.0])
    assert (reversed_.equivalent_amplitude, reversed_.ratio) == pytest.approx((100.0, -1.0))
    assert (pulsating.equivalent_amplitude, pulsating.ratio) == pytest.approx((100.0 / np.sqrt(2.0), 0.0))
    assert moved_to([50.0, 100.0]).equivalent_amplitude == pytest.approx(np.sqrt(100.0 * 25.0))
    assert moved_to([50.0, 100.0]).ratio == pytest.approx(0.5)
    assert moved_to([-100.0, -50.0]).equivalent_amplitude == pytest.approx(50.0)  # the fibre opposite is pulled
    # A force that goes around the pin, and one that does so while it presses, half a turn: some fibre sees both signs.
    for swept in (turn, turn[:181]):
        found = moved_to(100.0 * swept)
        assert (found.equivalent_amplitude, found.ratio) == pytest.approx((100.0, -1.0), rel=1e-12)
    # Fibres stand by 5°: of a pulsating moment between two of them 0.1 % is lost.
    for degrees in np.arange(2.5, 360.0, 5.0):
        between = moved_to([0.0, 100.0 * np.exp(1j * np.radians(degrees))]).equivalent_amplitude
        assert between == pytest.approx(100.0 * np.cos(np.radians(2.5)) / np.sqrt(2.0), rel=1e-12)
    assert moved_to([0.0, 100.0], rolls=True).equivalent_amplitude == 100.0


def test_pins_that_take_each_others_places_have_one_history():
    """What one pin sees at one position another sees at the next: +100 and −100 on two pins is reversed bending of both."""
    stress = np.array([[100.0, -100.0], [100.0, -100.0]], dtype=complex)[..., None]
    assert worst_cycle(stress, alike=False, rolls=False).equivalent_amplitude == 0.0  # each still
    assert worst_cycle(stress, alike=True, rolls=False).equivalent_amplitude == pytest.approx(100.0)
    for still in ([100.0, -50.0], [-50.0, 100.0]):  # from −50 to 100 on either
        found = worst_cycle(np.array([still], dtype=complex)[..., None], alike=True, rolls=False)
        assert (found.equivalent_amplitude, found.ratio) == pytest.approx((np.sqrt(100.0 * 75.0), -0.5))


@pytest.fixture(scope="module")
def bent():
    """Pins that bend, over a whole turn; wheel pins fixed in the wheel."""
    drive = parse_drive(shipped_drive("sleeved")).cases["nominal"]
    parts = replace(drive.materials, wheel_seat=Material())
    drive = replace(drive, pin_wheel=replace(drive.pin_wheel, seat=WheelPinSeat()), materials=parts)
    drive = with_fields(drive, {"materials.wheel_pin": "42CrMo4", "materials.shaft_pin": "100Cr6"})
    return analyse(drive, position_angles(24))


@pytest.mark.slow
@pytest.mark.usefixtures("positions_alone")
def test_bending_of_pins_is_judged_by_fatigue(bent):
    """It was judged by the yield strength, 'safety 1.85', though pins bend every turn."""
    summary = summarise(bent)
    judged = {check.value.quantity: check for check in judge_analysis(bent, summary, {}, lives=False)}
    for pins, limit in (("wheel", 450.0), ("shaft", 858.0)):
        fatigue, static = judged[f"{pins}_pin_bending_amplitude"], judged[f"{pins}_pin_bending_stress"]
        assert (fatigue.limit.value, fatigue.limit.source) == (limit, f"materials.{pins}_pin.bending_fatigue_limit")
        assert 0.3 * static.value.value < fatigue.value.value <= static.value.value
        assert "stress ratio" in fatigue.value.part
        assert "(static)" in static.title
    # Wheel pins are pressed from one side as the disc rolls by: seen in the wheel they pulsate, in the fixed frame reversed.
    cycle = pin_stress(bent, "wheel").cycle
    assert -0.4 < cycle.ratio < 0.1
    plain = replace(bent, drive=with_fields(bent.drive, {"materials.wheel_pin.bending_fatigue_limit": None}))
    found = [one for one in judge_analysis(plain, summary, {}, lives=False) if one.value.quantity[:11] == "wheel_pin_b"]
    told = next(one for one in found if one.value.quantity == "wheel_pin_bending_amplitude")
    assert (told.verdict, told.value.reason) == (
        "no limit",
        "not judged: materials.wheel_pin has no bending_fatigue_limit",
    )


@pytest.mark.slow
def test_bending_fatigue_is_that_of_whole_turns(bent):
    """A few positions do not hold what a fibre sees."""
    some = analyse(bent.drive, ANGLES[:3])
    values = {one.quantity: one for one in find_values(some, summarise(some), lives=False)}
    assert values["shaft_pin_bending_amplitude"].value is None
    assert values["shaft_pin_bending_amplitude"].reason == "positions cover no whole turns"


def test_displacements_are_told_from_a_tenth_of_the_eccentricity():
    """Directions turn by 0.1 rad there. Of several positions the largest counts, whatever has no answer."""
    unknown = np.full(3, np.nan)
    below, above = np.array([0.1, np.nan, 0.2399]), np.array([0.2401, np.nan, 0.1])
    assert displacement_warning(2.4, {"the wheel moves": ("a field", below), "cranks yield": ("b", unknown)}) is None
    warning = displacement_warning(2.4, {"the wheel moves": ("a field", below), "cranks yield": ("b", above)})
    assert "cranks yield by 0.24 mm, 0.1 eccentricities (b)" in warning
    assert "the wheel" not in warning


@pytest.mark.slow
@pytest.mark.parametrize(
    ("like", "changes", "told"),
    [
        ("sleeved", {"materials.shaft_pin.youngs_modulus": 300.0}, "…shaft pins bend by … mm, 1.8 eccentricities…"),
        ("paper", {"pin_shaft.stiffness": 3e3}, "…shaft pins yield by … mm, 0.2… eccentricities…"),
        ("paper", {"pin_wheel.support_stiffness": 3e3}, "…the wheel moves by … mm…"),
        ("sleeved", {"materials.wheel_pin.youngs_modulus": 1500.0}, "…wheel pins bend by … mm…"),
        ("rv", {"crank.support.stiffness": (2e4, 2e4)}, "…cranks yield by … mm…"),
    ],
)
def test_yielding_that_is_no_small_displacement_is_told(like, changes, told):
    """Shaft pins of rubber that bend by 0.8 to 4.5 eccentricities were answered without a word."""
    drive = next(iter(parse_drive(shipped_drive(like)).cases.values()))
    assert not [warning for warning in analyse(drive, ANGLES[:2]).warnings if "displacement" in warning]
    (warning,) = (w for w in analyse(with_fields(drive, changes), ANGLES[:2]).warnings if "displacement" in w)
    assert reads_as(told, warning)
    assert f"from 0.1 eccentricities ({0.1 * drive.crank.eccentricity:.3g} mm) on" in warning


def rv():
    return parse_drive(shipped_drive("rv"), "rv").cases["nominal"]


@pytest.mark.slow
def test_nothing_is_said_of_shaft_pins_that_are_not_there():
    """An RV had "materials.shaft_pin has no yield_strength" three times, and a limit on the stress along its holes."""
    analysis = analyse(rv(), ANGLES[:1])
    checks = judge_analysis(analysis, summarise(analysis), parse_limits({}, []), lives=False)
    told = [f"{check.value.quantity} {check.title} {check.value.reason} {check.value.part}" for check in checks]
    assert not [line for line in told if re.search("shaft|hole", line)]
    asked = parse_limits({"max_pin_shaft_pressure_mid": 1500.0, "max_hole_stress": 100.0}, [])
    limited = [check for check in judge_analysis(analysis, summarise(analysis), asked, lives=False) if check.asked]
    assert [check.value.reason for check in limited] == 2 * ["this drive has no shaft pins"]
    assert all(check.fails for check in limited)


def test_parts_are_told_by_disc_and_crank(paper):
    """Rollers were counted over all cranks: roller 37 of 3 times 14."""
    drive = rv()
    assert part_words(drive, "roller", 37, 42, 1) == "disc 1, crank 2, roller 9"
    assert part_words(drive, "below roller", 0, 42, 0) == "disc 0, crank 0, below roller 0"
    assert part_words(drive, "wheel pin", 7, 40, 1) == "disc 1, wheel pin 7"
    assert part_words(drive, "wheel pin", 7, 40) == "wheel pin 7"
    assert part_words(drive, "crank", 2, 3, 0) == "disc 0, crank 2"
    assert part_words(drive, "bore", 0, 1, 1) == "disc 1, bore"
    assert part_words(paper, "roller", 5, 11, 0) == "roller 5"
    assert part_words(paper, "", 0, 1, 0) == ""


def check_of(quantity, value, limit, sense="max"):
    return Check(
        value=Value(quantity=quantity, value=value), limit=Limit(quantity=quantity, sense=sense, value=limit, source="")
    )


def driver_of(name, elasticity, factor):
    return Driver(input=name, elasticity=elasticity, change="" if factor is None else f"× {factor}", factor=factor)


@pytest.mark.slow
def one_input(name):
    """An input that changes nothing: what is asked is the factor."""
    return _Input(name=name, start=None, unit="", changed=lambda factor: {})


def test_what_holds_the_contacts_goes_with_the_sizes(monkeypatch):
    """A larger pin circle left the ring where it was, all sizes left ring, posts, module and supports, and each trial derived a
    ring of finite elements anew."""
    monkeypatch.setattr("ltca.compliance.ring.derivation", lambda name: pytest.fail("a ring is derived"))
    rv = load_drive("rv").cases["nominal"]
    circle = rv.crank.circle_radius
    changes = {
        "ring.inner_radius": 80.0, "ring.outer_radius": 110.0, "ring.width": 60.0, "ring.model": "fe",
        "ring.bolts": {"number": 12, "circle_radius": 97.0, "stiffness": 1e6},
        "carrier.posts": {"number": 6, "radius": circle, "size": 16.0}, "carrier.flange": (10.0, 8.0),
    }  # fmt: skip
    drive = with_fields(rv, changes)
    drivers = advise(drive, [check_of("pin_pressure_mid", 1200.0, 1000.0)], np.array([0.1, 0.5]))["pin_pressure_mid"]
    found = {driver.input: driver.elasticity for driver in drivers}
    assert found["all sizes"] < -1.0
    assert found["ring.outer_radius"] > 0.0  # a stiffer ring spreads the load less
    each = {one.name: one for one in _inputs(drive, 1.0)}
    larger = with_fields(drive, each["pin_wheel.pin_circle_radius"].changed(81.0 / 80.0))
    assert (larger.ring.inner_radius, larger.ring.outer_radius, larger.ring.bolts.circle_radius) == (81.0, 111.0, 98.0)
    double = with_fields(drive, each["all sizes"].changed(2.0))
    ring, posts, support = double.ring, double.carrier.posts, double.crank.support
    assert (ring.inner_radius, ring.outer_radius, ring.width, ring.bolts.circle_radius) == (160.0, 220.0, 120.0, 194.0)
    assert (posts.radius, posts.size, double.carrier.flange) == (2.0 * circle, 32.0, (20.0, 16.0))
    assert (support.diameter, support.positions) == (40.0, (-44.0, 44.0))


@pytest.mark.parametrize(
    ("quantity", "value", "elasticity"), [("wall", -0.2, 5.0), ("wall", -0.2, -2.0), ("backlash_output", 0.1, 3.0)]
)
def test_a_margin_is_brought_to_its_limit_along_its_tangent(paper, quantity, value, elasticity):
    """Closed form: v (1 + E (f − 1)) is the limit."""
    driver = _driver(paper, one_input("disc.thickness"), elasticity, check_of(quantity, value, 0.3, "min"), 1.0)
    assert value * (1.0 + elasticity * (driver.factor - 1.0)) == pytest.approx(0.3, rel=1e-12)


def test_sizes_are_told_for_the_whole_torque(paper):
    """At equal stress the torque grows with the cube of the sizes: carried in an eighth, they have to be twice as large again."""
    check = check_of("pin_pressure_mid", 1210.0, 1000.0)
    whole, eighth = (_driver(paper, one_input(SIZES), -2.0, check, part).factor for part in (1.0, 0.125))
    assert whole == pytest.approx(1.1, rel=1e-12)  # 1.21 by the square root
    assert eighth == pytest.approx(2.0 * 1.1, rel=1e-12)
    assert _driver(paper, one_input("disc.thickness"), -2.0, check, 0.125).factor is None


def test_no_advice_fails_another_check():
    """Pressure and strain of one contact were to be mended by a lower modulus and by a higher one.

    By hand: pins thicker by 1.2 lower the pressure to 1000, and take 1.2 · 3 = 3.6 mm from a wall of 2 mm.
    """
    checks = {
        "pin_pressure_mid": check_of("pin_pressure_mid", 1200.0, 1000.0),
        "wall": check_of("wall", 2.0, 0.0, "min"),
        "backlash_output": check_of("backlash_output", 4.0, 3.0),
    }
    found = _without_contradictions(
        {
            "pin_pressure_mid": [
                driver_of("radius", -1.0, 1.2),
                driver_of("torque", 0.5, 0.7),
                driver_of("offset", -0.2, 2.5),
            ],
            "wall": [driver_of("radius", -6.0, None)],
            "backlash_output": [driver_of("offset", 1.0, 0.75)],
        },
        checks,
    )
    radius, torque, offset = found["pin_pressure_mid"]
    assert (radius.change, radius.factor, radius.breaks) == ("", None, ("thinnest wall",))
    assert (torque.factor, torque.breaks) == (0.7, ())
    assert (offset.factor, offset.breaks) == (None, ("backlash at the output, all clearances",))
    (narrower,) = found["backlash_output"]  # which raises the pressure that fails
    assert (narrower.factor, narrower.breaks) == (None, ("flank pressure",))


def test_a_change_that_mends_every_failed_check_is_told_once():
    failed = [check_of("pin_pressure_mid", 1200.0, 1000.0), check_of("pin_load", 150.0, 100.0)]
    each = {
        "pin_pressure_mid": [driver_of("torque", 0.5, 0.7), driver_of("radius", -1.0, 1.2)],
        "pin_load": [driver_of("torque", 1.0, 0.67)],
    }
    assert _at_once(failed, each) == ["  all of them at once: torque: × 0.67"]
    assert _at_once(failed[:1], each) == []


def test_failed_checks_stand_first_and_what_is_not_known_is_grouped():
    checks = [
        check_of("wall", 2.0, 0.0, "min"),
        check_of("pin_load", 90.0, 100.0),
        check_of("pin_pressure_mid", 1200.0, 1000.0),
        Check(value=Value(quantity="root_stress", value=None, reason="no walls"), limit=None),
        Check(value=Value(quantity="bore_stress", value=None, reason="no walls"), limit=None),
        Check(value=Value(quantity="disc_shear", value=3.0), limit=None),
    ]
    lines = verdict_table(checks).splitlines()
    assert [line.split("  ")[1] for line in lines[1:5]] == [
        "flank pressure", "largest load of a wheel pin", "thinnest wall", "shear below the surface of the disc",
    ]  # fmt: skip
    assert lines[5] == "  not known (no walls): stress along lobe roots; stress along bores"


def test_few_positions_fail_no_drive():
    """A run of one angle ended with "FAIL  different places in a mesh period 1 (≥ 8)"."""
    few = check_of("distinct_mesh_phases", 1.0, 8.0, "min")
    assert few.fails
    line = verdict_line([check_of("pin_pressure_mid", 900.0, 1000.0), few])
    assert line.startswith(
        "pass at these positions  flank pressure 900 MPa (≤ 1000 MPa), safety 1.11; too few positions"
    )
    assert verdict_line([check_of("pin_pressure_mid", 1200.0, 1000.0), few]).startswith("FAIL  flank pressure")
    assert verdict_line([few]).startswith("not judged")


def test_a_case_is_judged_once_by_shear_of_the_core_or_by_depth(paper):
    """Both judged the case of one disc: by the core's shear where its strength is known, by the depth of the shear otherwise."""
    values = [Value(quantity="core_shear", value=200.0), Value(quantity="shear_depth", value=0.2)]
    for material, limits in (
        (Material(hardness_depth=0.6, yield_strength=590.0), [295.0, None]),
        (Material(hardness_depth=0.6), [None, 0.6]),
    ):
        drive = replace(paper, materials=replace(paper.materials, disc=material))
        found = judge(drive, values, {})
        assert [None if check.limit is None else check.limit.value for check in found] == limits


def test_the_wall_of_a_ring_is_that_behind_its_seats():
    """Seats that end at 62.5 mm in a ring of 62.51 mm were told to leave walls of millimetres."""
    ring = {"inner_radius": 60.0, "outer_radius": 62.51, "width": 20.0}
    drive = with_fields(load_drive("robot-joint").cases["nominal"], {"ring": ring})
    name, wall = min(walls(single_discs(drive)[0]), key=lambda found: found[1])
    assert (name, wall) == ("of the ring behind the wheel pins", pytest.approx(0.01))


def test_bolts_stand_on_the_ring():
    ring = {"inner_radius": 60.0, "outer_radius": 98.0, "width": 20.0}
    ring["bolts"] = {"number": 8, "circle_radius": 1050.0, "stiffness": 5e5}
    with refused_field("ring.bolts.circle_radius", "= 1050 mm", "1.5 times ring.outer", bound=("at most", 1.5 * 98.0)):
        with_fields(load_drive("robot-joint").cases["nominal"], {"ring": ring})
