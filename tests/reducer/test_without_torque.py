"""Drives without a torque: tight ones are answered, drives with play are refused; from loose to tight nothing jumps."""

from __future__ import annotations

from importlib.resources import files

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.torque_curve import torque_curve
from ltca.commands.program import main
from ltca.drive.units.quantities import ARCMIN
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text
from ltca.studies.batch_analysis import BatchSettings, solve_batch

ANGLES = np.array([0.31, 1.7])
TIGHT = {"disc.equidistant_offset": -0.01, "disc.shifting_offset": 0.0}
RUBS = {"friction.pin": 0.05, "friction.roller": 1e-3, "load.speed": 1500.0}


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper").cases["CS-1"]


def drives(paper):
    """The paper's drive, two discs with the wheel held, a plastic disc, cranks that yield; all 5 to 10 µm too tight."""
    joint, rv = (load_drive(files("ltca.drives") / f"{name}.toml").cases["nominal"] for name in ("robot-joint", "rv"))
    soft = with_fields(paper, TIGHT | {"materials.disc.youngs_modulus": 2500.0, "load.light_torque": 1e3})
    tight = {"disc.equidistant_offset": -0.005, "disc.shifting_offset": 0.0}
    teeth = {
        "first_stage.sun_teeth": 20,
        "first_stage.planet_teeth": 40,
        "first_stage.plane": 40.0,
        "first_stage.mesh_stiffness": 3e5,
    }
    closed = {"clearance.bearing": 0.0, "clearance.pin_hole": 0.0}
    return {
        "paper": with_fields(paper, TIGHT),
        "held": with_fields(paper, TIGHT | {"installation.held": "pin-wheel"}),
        "plastic": soft,
        "two discs": with_fields(joint, tight | closed),
        "cranks": with_fields(rv, tight | teeth | {"clearance.bearing": 0.0}),
    }


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(
    "name",
    ["paper", "held", "plastic", *(pytest.param(name, marks=pytest.mark.slow) for name in ("two discs", "cranks"))],
)
def test_tight_drives_are_answered_without_a_torque(paper, name):
    """Loads are those of preload: what they are under ever smaller torques of either sense comes down to them, in first order."""
    drive = drives(paper)[name]
    none = analyse(drive, ANGLES, 0.0)
    assert none.full.response.pin_load.max() > 10.0
    light = drive.load.light_torque
    below, above = (analyse(drive, ANGLES, part * light) for part in (0.02, 0.01))
    far, near = (one.full.response.pin_load - none.full.response.pin_load for one in (below, above))
    # a hundredth of the light torque turns contacts on by less than their approaches: what is of second order is small
    np.testing.assert_allclose(far, 2.0 * near, rtol=0.0, atol=0.05 * np.abs(far).max())
    assert np.abs(near).max() < 0.05 * none.full.response.pin_load.max()
    np.testing.assert_allclose(
        below.transmission_error - none.transmission_error,
        2.0 * (above.transmission_error - none.transmission_error), rtol=0.05,
    )  # fmt: skip


def test_moments_of_a_held_wheel_close_without_a_torque(paper):
    """T_W + T_in = 0: what holds the wheel is what holds the crank, which a preloaded drive needs from place to place."""
    found = analyse(drives(paper)["held"], ANGLES, 0.0)
    left = found.full.wheel_moment + found.crank_torques.sum(axis=1)
    np.testing.assert_allclose(left, 0.0, atol=1e-9 * found.drive.load.light_torque)


def test_play_without_a_torque_is_refused_by_name(paper):
    with refused_field("load.torque", "= 0 N·mm", "without a torque the output has a ", bound=("greater than", 0.0)):
        analyse(with_fields(paper, {"load.torque": 0.0}), ANGLES)
    with refused_field("torque", "= 0 N·mm", " free play of ", "′ at crank angle ", " (2 of 2 positions)", alone=True):
        analyse(paper, ANGLES, 0.0)


def test_backlash_of_teeth_beside_tight_discs_is_refused(paper):
    """It was answered by the sign of round-off: the transmission error of the RV drive changed sides, ± 2.73″.

    0.03 mm on 28 mm by u = 40 turn the wheel, 80/81 of it the carrier.
    """
    told = 0.03 / 28.0 / 40.0 * 80.0 / 81.0 * ARCMIN
    drive = with_fields(drives(paper)["cranks"], {"first_stage.backlash": 0.03, "load.torque": 0.0})
    said = (f" free play of {told:.3g}′ at crank angle ", " (2 of 2 positions)")
    with refused_field("load.torque", "= 0 N·mm", *said, alone=True):
        analyse(drive, ANGLES)
    with refused_field("load.torque", "= 0 N·mm", *said, alone=True):
        solve_batch([drive], BatchSettings(quantities=("mean_transmission_error",), crank_angle=ANGLES))


def test_parts_that_only_just_touch_are_refused(paper):
    """Without any clearance and any overlap nothing presses: a disc between contacts without load stands nowhere."""
    exact = {
        "disc.equidistant_offset": 0.0,
        "disc.shifting_offset": 0.0,
        "clearance.bearing": 0.0,
        "clearance.pin_hole": 0.0,
    }
    with refused_field("torque", "= 0 N·mm", "without a torque the output "):
        analyse(with_fields(paper, exact), ANGLES, 0.0)


@pytest.mark.slow
def test_drag_is_what_friction_takes(paper):
    """All that is put in is lost: mean moment of the input by virtual work over a turn against Σ μF slip, and no efficiency."""
    drive = with_fields(paper, TIGHT | RUBS | {"load.torque": 0.0})
    found = analyse(drive, position_angles(13))
    summary = summarise(found)
    assert summary["drag_torque_Nmm"] == pytest.approx(found.losses.total.mean(), rel=1e-12)
    # stored energy comes and goes over the turn: the mean of 13 positions of 13 teeth sees one phase of it
    assert summary["mean_input_torque_Nmm"] == pytest.approx(summary["drag_torque_Nmm"], rel=2e-3)
    assert summary["mean_efficiency"] is None
    assert summary["backlash_output_arcmin"] == pytest.approx(0.0, abs=1e-3)
    assert summary["preloaded_part_of_turn"] == 1.0


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("torque", [20e3, pytest.param(400e3, marks=pytest.mark.slow)])
def test_from_loose_to_tight_nothing_jumps(paper, torque):
    """Pins from 10 µm too thin to 10 µm too thick, 2 µm a step: loads and angle follow, their second differences are small."""
    found, angles = [], []
    for step in np.arange(-5, 6):
        fields = {
            "disc.equidistant_offset": 0.0,
            "disc.shifting_offset": 0.0,
            "pin_wheel.pin_radius": 6.5 + 0.002 * step,
        }
        thick = with_fields(paper, fields)
        # the flank stays as it is for pins of 6.5 mm
        thick = with_fields(thick, {"disc.equidistant_offset": -0.002 * float(step)})
        one = analyse(thick, ANGLES, torque)
        found.append(one.full.response.pin_load.sum(axis=1))
        angles.append(one.full.pose[:, WHEEL_ANGLE])
    loads, turned = np.stack(found), np.stack(angles)
    for values in (loads, turned):
        first, second = np.diff(values, axis=0), np.diff(values, 2, axis=0)
        # a jump of one step would be a second difference as large as the whole way
        assert np.abs(second).max() < 0.3 * np.abs(first).sum(axis=0).max()
    assert np.all(np.diff(loads[5:], axis=0) > 0.0)


def test_preload_rises_from_nothing(paper):
    """Without a torque loads start at zero with the overlap, as a contact's do: more than in proportion, without a step."""
    total = []
    for overlap in (1e-4, 2e-4, 1e-3, 1e-2):
        fields = {"disc.equidistant_offset": -overlap, "disc.shifting_offset": 0.0}
        total.append(analyse(with_fields(paper, fields), ANGLES[:1], 0.0).full.response.pin_load.sum())
    assert 0.0 < total[0] < 0.6 * total[1]
    assert total[0] < 0.02 * total[3]
    assert np.all(np.diff(total) > 0.0)


def test_curves_need_a_torque(paper):
    with refused_field("load.torque", "= 0 N·mm", "for torque curves", bound=("greater than", 0.0)):
        torque_curve(with_fields(paper, TIGHT | {"load.torque": 0.0}), ANGLES)


@pytest.mark.slow
def test_programs_take_no_torque(paper, tmp_path, capsys):
    """Run and check of a tight drive end as usual, those of a loose one with one line and nothing written."""
    tight, loose = tmp_path / "tight.toml", tmp_path / "loose.toml"
    tight.write_text(drive_text(with_fields(paper, TIGHT | RUBS | {"load.torque": 0.0})), encoding="utf-8")
    loose.write_text(drive_text(with_fields(paper, {"load.torque": 0.0})), encoding="utf-8")
    common = ["--compliance", "half-space", "--positions", "9"]
    assert main(["run", str(tight), *common, "--out", str(tmp_path / "run")]) == 0
    assert "drag at the input [N·mm]" in capsys.readouterr().out
    assert main(["check", str(tight), *common, "--no-advice", "--out", str(tmp_path / "check")]) == 1
    assert "no torque goes through (load.torque = 0)" in capsys.readouterr().out
    for command in ("run", "check"):
        assert main([command, str(loose), *common, "--out", str(tmp_path / "none")]) == 2
        assert capsys.readouterr().err.startswith("cyclo: error: load.torque = 0 N·mm: must be greater than 0: without")
        assert not (tmp_path / "none").exists()
