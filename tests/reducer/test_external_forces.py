"""Forces from outside on the output: where the main bearing yields, where it does not, what it carries."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.reactions import reaction_values, relieved_rows_warning
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.drive.parts import Material
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium import newton
from ltca.page.studies.curves import torque_section
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text

ANGLES = np.array([0.31, 1.7, 4.4])
PUSHED = {"load.external.0.force.x": 800.0, "load.external.0.force.y": -300.0}
STIFF = 1e9
WHOLE = Path(__file__).parents[2] / "examples" / "drives" / "whole_reducer.toml"


@pytest.fixture(scope="module")
def joint():
    return load_drive("robot-joint").cases["nominal"]


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-1"]


@pytest.fixture(scope="module")
def whole():
    return load_drive(WHOLE).cases["pins 4 mm"]


def wheel(analysis):
    return analysis.full.pose[:, analysis.model.coordinates.wheel_place] @ np.array([1.0, 1j])


def test_an_arm_moves_the_wheel_by_its_spring(paper):
    """Forces on a wheel whose bearing is a spring of 1e9 N/mm, stiff against all contacts: F/k beside what discs press."""
    soft = with_fields(paper, {"pin_wheel.support_stiffness": STIFF})
    plain, pushed = analyse(soft, ANGLES), analyse(with_fields(soft, PUSHED), ANGLES)
    # contacts give way by 1e-6 mm of the wheel's way: 1e-3 of it
    np.testing.assert_allclose(wheel(pushed) - wheel(plain), complex(800.0, -300.0) / STIFF, rtol=2e-3)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
@pytest.mark.parametrize("frame", ["housing", "output"])
def test_frames_turn_by_hand(paper, held, frame):
    """u = 14: the housing, or the output, turns by φ_C/14 against the other; what acts on the shaft moves it, not the wheel."""
    soft = with_fields(paper, {"pin_wheel.support_stiffness": STIFF, "installation.held": held})
    plain = analyse(soft, ANGLES)
    pushed = analyse(with_fields(soft, PUSHED | {"load.external.0.frame": frame}), ANGLES)
    turned = np.exp(1j * ANGLES / 14.0)
    by_hand = {
        ("pin-shaft", "housing"): np.ones(3),
        ("pin-shaft", "output"): turned,
        ("pin-wheel", "housing"): -turned,
        ("pin-wheel", "output"): -np.ones(3),
    }[held, frame]
    force = complex(800.0, -300.0) * by_hand
    np.testing.assert_allclose(wheel(pushed) - wheel(plain), force / STIFF, rtol=0.0, atol=2e-3 * abs(force[0]) / STIFF)


@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
@pytest.mark.parametrize("frame", ["housing", "output"])
def test_an_arm_does_work_on_what_it_moves(paper, held, frame, unbalanced_work):
    """5 kN on a main bearing of 200 N/µm: its moment about the axis of the displaced wheel was missing where the wheel is held.

    The power of crank, output and arm in the frame of the housing was up to 3e-5 of the torque beside the energy's change.
    """
    arm = {"force.x": 4000.0, "force.y": -3000.0, "frame": frame}
    yielding = {"main_bearing.radial_stiffness": 2e5, "installation.held": held}
    drive = with_fields(paper, yielding | {f"load.external.0.{name}": value for name, value in arm.items()})
    np.testing.assert_allclose(unbalanced_work(drive, ANGLES), 0.0, atol=1e-7)


@pytest.mark.slow
def test_the_sun_does_work_on_what_it_moves(unbalanced_work):
    """What it presses on the planets displaces the carrier on its main bearing, and has a moment about the wheel's axis."""
    rv = load_drive("rv").cases["nominal"]
    teeth = {
        "first_stage.sun_teeth": 20,
        "first_stage.planet_teeth": 40,
        "first_stage.plane": 40.0,
        "main_bearing.radial_stiffness": 2e5,
    }
    drive = replace(with_fields(rv, teeth | PUSHED), crank=replace(rv.crank, support=None))
    drive = replace(drive, materials=replace(drive.materials, crankshaft=Material()))
    np.testing.assert_allclose(unbalanced_work(drive, ANGLES), 0.0, atol=1e-7)


@pytest.mark.parametrize("held", ["pin-shaft", pytest.param("pin-wheel", marks=pytest.mark.slow)])
def test_the_main_bearing_holds_all_of_it(joint, held):
    """Forces and moments by cross products in three dimensions; of a rigid bearing nothing else changes, bit for bit."""
    entries = PUSHED | {"load.external.0.force.z": 500.0, "load.external.0.at.z": 60.0, "load.external.0.moment.y": 7e3}
    plain = with_fields(joint, {"installation.held": held})
    drive = with_fields(plain, entries)
    alone, found = analyse(plain, ANGLES), analyse(drive, ANGLES)
    np.testing.assert_array_equal(found.full.pose, alone.full.pose)
    told = reaction_values(found)
    force, moment = np.zeros((3, 3)), np.zeros((3, 3))
    given = np.array([800.0, -300.0, 500.0])
    force += given
    moment += np.cross([0.0, 0.0, 60.0], given) + np.array([0.0, 7e3, 0.0])
    pins = drive.pin_wheel.number_of_pins
    turned = np.exp(-1j * ANGLES / drive.reduction_ratio) if held == "pin-wheel" else np.ones(3)
    sign = -1.0 if held == "pin-wheel" else 1.0  # discs push the wheel, and so the shaft the other way
    for plane, part in zip(drive.disc.disc_planes, found.full.response.parts, strict=True):
        pushed = sign * part.pin_forces[:, :pins].sum(axis=1) * turned
        each = np.stack([pushed.real, pushed.imag, np.zeros(3)], axis=1)
        force += each
        moment += np.cross([0.0, 0.0, plane], each)
    size = np.abs(force).max()
    for axis, name in enumerate("xyz"):
        np.testing.assert_allclose(told[f"main_bearing_{name}"], -force[:, axis], atol=1e-9 * size)
    for axis, name in enumerate("xy"):
        np.testing.assert_allclose(told[f"main_bearing_moment_{name}"], -moment[:, axis], atol=1e-9 * 60.0 * size)
    summary = summarise(found)
    assert summary["max_main_bearing_axial_N"] == pytest.approx(500.0, rel=1e-12)
    assert summary["max_main_bearing_radial_N"] == pytest.approx(np.hypot(force[:, 0], force[:, 1]).max(), rel=1e-9)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
@pytest.mark.parametrize("given", ["main_bearing.radial_stiffness", "pin_wheel.support_stiffness"])
def test_a_main_bearing_tells_what_it_carries_of_the_drive_alone(paper, held, given):
    """Its force was told beside forces from outside only. It is that of its spring, k u, from the other side of the balance."""
    drive = with_fields(paper, {"installation.held": held, given: 2e5})
    found = analyse(drive, ANGLES)
    told = reaction_values(found)
    force = told["main_bearing_x"] + 1j * told["main_bearing_y"]
    turned = -1.0 if held == "pin-shaft" else np.exp(-1j * ANGLES / drive.reduction_ratio)
    by_spring = 2e5 * wheel(found) * turned
    np.testing.assert_allclose(force, by_spring, atol=1e-6 * np.abs(by_spring).max())  # the balance of the wheel
    assert np.abs(by_spring).min() > 1.0
    assert summarise(found)["max_main_bearing_radial_N"] == pytest.approx(np.abs(force).max(), rel=1e-12)
    assert "main_bearing_x" not in reaction_values(analyse(paper, ANGLES[:1]))


@pytest.mark.slow
@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
def test_the_output_moves_along_the_axis(paper, held, monkeypatch):
    """−500 N by 2e5 N/mm are −2.5 µm; by two rows of 45° of 1e5 N/mm each the same, whatever preload; of rows with clearance it
    is not known. No contact feels it.

    Balanced to 1e-12 of the load: the 1e-9 of an answer are 4e-11 mm on such a bearing.
    """
    monkeypatch.setattr(newton, "TOLERANCE", 1e-12)
    rows = {
        f"main_bearing.bearings.{number}.{name}": value
        for number, plane in enumerate((-30.0, 30.0))
        for name, value in {
            "plane": plane, "kind": "tapered roller", "contact_angle": np.pi / 4.0, "axial_stiffness": 1e5
        }.items()
    }  # fmt: skip
    plain = with_fields(paper, {"installation.held": held, "main_bearing.radial_stiffness": 1e5})
    pushed = {"load.external.0.force.z": -500.0}
    by_rows = {"main_bearing.radial_stiffness": None, **rows, **pushed}
    name, alone = "main_bearing_axial_displacement", analyse(plain, ANGLES)
    for changes in (pushed | {"main_bearing.axial_stiffness": 2e5}, by_rows, by_rows | {"main_bearing.preload": 1e9}):
        found = analyse(with_fields(plain, changes), ANGLES)
        np.testing.assert_allclose(reaction_values(found)[name], -0.0025, rtol=1e-12)
        assert summarise(found)[f"max_{name}_mm"] == pytest.approx(0.0025, rel=1e-12)
        # 1e5 N/mm radially in another way
        np.testing.assert_allclose(found.full.pose, alone.full.pose, rtol=0.0, atol=1e-11)
    for changes in (pushed, by_rows | {"main_bearing.clearance": 0.0}):
        found = analyse(with_fields(plain, changes), ANGLES[:1])
        assert name not in reaction_values(found)
        assert f"max_{name}_mm" not in summarise(found)


def test_axial_forces_beyond_the_preload_are_told(paper):
    """Rows keep the stiffness that they have at their preload."""
    rows = {
        f"main_bearing.bearings.{number}.{name}": value
        for number, plane in enumerate((-30.0, 30.0))
        for name, value in {
            "plane": plane, "kind": "tapered roller", "contact_angle": 0.5, "axial_stiffness": 1e5
        }.items()
    } | {"main_bearing.preload": 1e3}  # fmt: skip
    found = [
        relieved_rows_warning(analyse(with_fields(paper, rows | {"load.external.0.force.z": force}), ANGLES[:1]))
        for force in (900.0, -1100.0)
    ]
    assert found[0] is None
    assert "1100 N on rows of main_bearing.preload = 1000 N; one row is relieved" in found[1]
    # helical planets: tapered crank bearings of 20 N
    teeth = {"first_stage.sun_teeth": 20, "first_stage.planet_teeth": 40, "first_stage.helix_angle": 0.3}
    teeth["first_stage.plane"] = 40.0
    tapered = {"contact_angle": 0.25, "load_constant": 2e5, "stiffness": ()}
    drive = with_fields(
        load_drive("rv").cases["nominal"],
        teeth | {f"crank.support.{k}": v for k, v in tapered.items()} | {"crank.support.preload": 20.0},
    )
    told = relieved_rows_warning(analyse(drive, ANGLES[:1]))
    assert "N on rows of crank.support.preload = 20 N" in told


def test_planets_push_the_carrier(joint):
    """The carrier of a held wheel is the output: what the sun presses on its planets passes through the main bearing."""
    rv = load_drive("rv").cases["nominal"]
    teeth = {
        "first_stage.sun_teeth": 20,
        "first_stage.planet_teeth": 40,
        "first_stage.plane": 40.0,
        "first_stage.helix_angle": 0.2,
    }
    drive = with_fields(rv, teeth | {"load.external.0.force.z": 100.0})
    found = analyse(drive, ANGLES)
    axial = -found.crank_torques.sum(axis=1) / 28.0 * np.tan(0.2)  # a right-handed planet
    np.testing.assert_allclose(reaction_values(found)["main_bearing_z"], -(100.0 + axial), rtol=1e-12)


def test_entries_add_up(paper):
    soft = with_fields(paper, {"pin_wheel.support_stiffness": 3e5})
    one = analyse(with_fields(soft, PUSHED), ANGLES)
    two = {"load.external.0.force.x": 800.0, "load.external.1.force.y": -300.0}
    parts = with_fields(with_fields(soft, {"load.external.0.force.x": 800.0}), {"load.external.1.force.y": -300.0})
    np.testing.assert_array_equal(analyse(parts, ANGLES).full.pose, one.full.pose)
    assert len(with_fields(soft, two).load.external) == 2


def test_the_bearing_of_the_wheel_rubs_under_an_arm_as_well(paper):
    """f times its load times its radius, by hand from the forces of discs and arm together."""
    rubs = {"friction.support_bearing": 0.01, "friction.support_bearing_radius": 30.0}
    drive = with_fields(paper, rubs | PUSHED)
    found = analyse(drive, ANGLES)
    pressed = found.full.response.parts[0].pin_forces[:, :14].sum(axis=1) + complex(800.0, -300.0)
    at_crank = 0.01 * 30.0 * np.abs(found.bearing_radial + 1j * found.bearing_tangential)[:, 0, 0]
    lost = found.losses.by_kind["support_bearing"]
    np.testing.assert_allclose(lost, 0.01 * 30.0 * np.abs(pressed) / 14.0 + at_crank, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.family(quick=1)
@pytest.mark.parametrize("held", ["pin-shaft", pytest.param("pin-wheel", marks=pytest.mark.slow)])
def test_an_arm_takes_its_part_of_the_play(paper, held):
    """Lost motion stood below the backlash: the curve was of a wheel that an arm holds aside, its backlash of one that floats.

    Towards vanishing torque the arm alone displaces the wheel, by half the clearance and F/k: the play is that of a rigid drive
    whose wheel stands off axis by as much. What 1e-6 of the torque yields is some 3e-5′.
    """
    clearance, stiffness, force = 0.03, 2e5, 2000.0
    pushed = {"load.external.0.force.x": force, "load.external.0.frame": "housing" if held == "pin-shaft" else "output"}
    bearing = {"main_bearing.radial_stiffness": stiffness, "main_bearing.clearance": clearance}
    drive, angles = with_fields(paper, {"installation.held": held} | bearing | pushed), np.array([0.35, 1.7])
    found = torque_curve(drive, angles, points=0)
    aside = (0.5 * clearance + force / stiffness) * (1.0 if held == "pin-shaft" else -1.0)
    off_axis = with_fields(paper, {"installation.held": held, "pin_wheel.axis_offset.x": aside})
    by_hand = torque_curve(off_axis, angles, points=0).backlash
    np.testing.assert_allclose(found.backlash, by_hand, rtol=0.0, atol=1e-4 / ARCMIN)
    assert np.all(found.lost_motion > found.backlash)
    assert found.displaced
    free = torque_curve(with_fields(paper, {"installation.held": held} | bearing), angles, points=0)
    assert np.all(free.backlash > found.backlash + 1.0 / ARCMIN)
    # a rigid bearing does not let it through, and a moment or a force along the axis displaces nothing
    rigid = torque_curve(with_fields(paper, {"installation.held": held} | pushed), angles, points=0)
    axial = {"installation.held": held, "load.external.0.force.z": force}
    for curve in (rigid, torque_curve(with_fields(paper, axial | bearing), angles, points=0)):
        assert not curve.displaced


@pytest.mark.nightly
def test_the_gap_is_found_where_a_millionth_of_the_torque_is_round_off(whole):
    """A load of 0.02 N beside an arm of 2.9 kN on a preloaded bearing is no balance: the least torque of the curve is taken."""
    drive = with_fields(whole, {"load.external.0.force.x": 2870.0})
    pushed, free = (torque_curve(one, np.array([0.35]), points=0) for one in (drive, whole))
    near = torque_curve(with_fields(whole, {"load.external.0.force.x": 2800.0}), np.array([0.35]), points=0)
    assert 0.8 * free.backlash[0] < pushed.backlash[0] < free.backlash[0]
    # the arm moves the wheel by 7 µm more for each kN: 0.1′ of play for 2.9 kN, 0.002′ for the difference
    assert pushed.backlash[0] == pytest.approx(near.backlash[0], abs=0.005 / ARCMIN)


def test_screen_and_page_say_that_an_arm_takes_play(paper):
    arm = {"main_bearing.radial_stiffness": 2e5, "main_bearing.clearance": 0.03, "load.external.0.force.x": 2e3}
    curve = torque_curve(with_fields(paper, arm), np.array([0.35]), points=0)
    told = "acklash is what the forces from outside leave of the play"
    assert any(told in note for note in torque_section({"": curve}).notes)
    plain = torque_curve(paper, np.array([0.35]), points=0)
    assert not any(told in note for note in torque_section({"": plain}).notes)


def test_files_keep_every_entry(paper):
    drive = with_fields(paper, PUSHED | {"load.external.0.moment.x": 5.0, "load.external.0.frame": "output"})
    assert parse_drive(drive_text(drive)).cases["nominal"] == replace(drive, case="nominal")
    head, _, rest = shipped_drive("rv").partition("[clearance]")
    written = f'{head}[[load.external]]\nforce = {{ x = "1 kN" }}\nat = {{ z = 40.0 }}\n\n[clearance]{rest}'
    (entry,) = parse_drive(written).cases["nominal"].load.external
    assert (entry.force.x, entry.at.z, entry.frame) == (1000.0, 40.0, "housing")
