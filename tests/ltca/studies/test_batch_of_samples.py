"""Samples that are solved as one batch: each has what its drive has alone, whichever others stand beside it."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from refusals import error_says, reads_as

from ltca.analysis.engines import HalfSpace
from ltca.analysis.friction.losses import losses
from ltca.analysis.loaded_analysis import analyse
from ltca.arrays import stack_drives
from ltca.commands.program import main
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import DriveError
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.studies.batch_analysis import BatchSettings, analyse_samples, solve_nominal
from ltca.studies.quantities import OF_FRICTION, OF_THE_PIN_SHAFT
from ltca.studies.study import run_batch
from ltca.studies.sweep_file import parse_sweep

ANGLES = position_angles(2)
RUBS = {"friction.pin": 0.05, "friction.hole": 0.04, "friction.no_load_torque": 20.0, "load.speed": 1500.0}


def shipped(name):
    return next(iter(parse_drive(shipped_drive(name), name).cases.values()))


def solved(drives, quantities, nominal=None, angles=ANGLES):
    found = analyse_samples(drives, BatchSettings(crank_angle=angles, quantities=quantities, nominal=nominal))
    assert not any(found.messages)
    return found.values


def losses_alone(drive):
    """Mean efficiency, mean input torque and mean power lost of a drive, from its analysis."""
    found = analyse(drive, ANGLES).losses
    return [found.mean_efficiency, found.input_torque.mean(), found.watts(found.total).mean()]


def same_losses(drives):
    # Every sample balances to 1e-9 of its load.
    np.testing.assert_allclose(solved(drives, OF_FRICTION), [losses_alone(drive) for drive in drives], rtol=1e-7)


@pytest.mark.slow
def test_seals_and_oil_take_what_they_take_in_each_sample():
    """Efficiency, input torque and power of a batch were those of its first sample's no-load torque."""
    base = with_fields(load_drive("paper").cases["CS-2"], RUBS)
    drives = [with_fields(base, {"friction.no_load_torque": value}) for value in (20.0, 1500.0, 3000.0)]
    same_losses(drives)
    torque = solved(drives, ("mean_input_torque",))[:, 0]
    # Nothing else differs, and it is added whole at the input of a central crank.
    np.testing.assert_allclose(np.diff(np.abs(torque)), [1480.0, 1500.0], rtol=1e-7)


@pytest.mark.slow
def test_each_sample_is_driven_at_its_side_and_held_at_its_member():
    """An efficiency of 1.33: the second sample's losses were those of a drive that is driven and held like the first."""
    base = with_fields(shipped("robot-joint"), RUBS)
    samples = [
        {"load.driven_by": side, "load.direction": sense, "installation.held": held}
        for side, sense, held in (
            ("input", "ccw", "pin-wheel"),
            ("output", "cw", "pin-wheel"),
            ("output", "cw", "pin-shaft"),
        )
    ]
    same_losses([with_fields(base, sample) for sample in samples])


@pytest.mark.slow
def test_each_sample_has_its_first_stage():
    base = with_fields(shipped("rv"), {**RUBS, "friction.hole": 0.0})
    same_losses([with_fields(base, {"installation.first_stage_ratio": value}) for value in (3.0, None)])


def test_pins_slip_in_the_seats_of_each_sample():
    """Pins that slip on the disc and pins that slip in their slots may rub alike, and share a batch."""
    seat = {"pin_wheel.seat.kind": "slot", "pin_wheel.seat.radius": 6.52}
    rolls = with_fields(load_drive("paper").cases["CS-2"], {**RUBS, **seat, "friction.seat": 0.02})
    slips = with_fields(rolls, {"friction.pin": 0.02, "friction.seat": 0.05})
    model = stack_drives([HalfSpace().model(drive) for drive in (rolls, slips)], 1)
    found = solve_at_output(model, [rolls, slips], np.zeros(2), rolls.load.torque)
    lost = losses(model, [rolls, slips], found, rolls.load.torque)
    assert lost.pins.rolls.tolist() == [True, False]
    # As far on the disc as in a slot, with the same coefficient.
    np.testing.assert_allclose(lost.by_kind["seat"], [lost.by_kind["pin"][1], 0.0], rtol=1e-9)
    np.testing.assert_allclose(lost.by_kind["pin"], [0.0, lost.by_kind["seat"][0]], rtol=1e-9)
    np.testing.assert_allclose(lost.pins.seat_slip[:, 0], lost.pins.slip[:, 1], rtol=1e-9)
    assert not lost.pins.slip[:, 0].any()
    assert not lost.pins.seat_slip[:, 1].any()


@pytest.mark.slow
def test_half_widths_are_bounded_by_the_radii_of_each_sample(vary):
    """The first sample's rollers bounded all: one with rollers as small as a pin's contact passed, or refused its neighbours."""
    plain = with_fields(vary(), {"materials.disc.youngs_modulus": 3000.0, "materials.disc.poisson_ratio": 0.38})
    race = plain.crank_bearing.inner_race_radius
    thin = with_fields(plain, {"crank_bearing.roller_radius": 0.5, "crank_bearing.outer_race_radius": race + 1.0})
    with pytest.raises(DriveError, match="roller"):
        analyse(thin, ANGLES)
    settings = BatchSettings(crank_angle=ANGLES, quantities=("max_pin_load",))
    for drives, wide in (([plain, thin], 1), ([thin, plain], 0)):
        found = analyse_samples(drives, settings)
        assert not found.messages[1 - wide]
        assert f"load.torque = {thin.load.torque:g} N·mm cannot be carried: contact half-width" in found.messages[wide]


@pytest.mark.slow
def test_one_disc_of_several_scatters():
    """A disc with rows and one without were joined near a nominal solution: the study ended in a traceback."""
    waves = {
        "disc.profile_errors.orders": (2,),
        "disc.profile_errors.cosine": (1e-4,),
        "disc.profile_errors.sine": (0.0,),
    }
    base, quantities = with_fields(shipped("robot-joint"), waves), ("max_pin_load",)
    nominal = solve_nominal(base, BatchSettings(crank_angle=ANGLES, quantities=quantities))
    for field in ("disc.of.0.runout.amount", "disc.of.1.profile_errors.cosine.0"):
        drives = [with_fields(base, {field: value}) for value in (0.001, 0.002)]
        near, alone = (
            solved(drives, quantities, nominal),
            np.concatenate([solved([each], quantities) for each in drives]),
        )
        np.testing.assert_allclose(near, alone, rtol=1e-7)


@pytest.mark.slow
def test_a_ring_lies_on_the_circle_of_each_sample():
    """Shaft pins that a ring ties on circles of several radii, eccentricities alike: the study ended in a traceback."""
    base = shipped("sleeved")
    fields = [{"pin_shaft.pin_circle_radius": 44.01}, {"pin_shaft.pin_errors.radial.0": 0.002}]
    drives = [with_fields(base, change) for change in fields]
    few = ANGLES[:1]
    alone = [analyse(drive, few).full.response.pin_load.max() for drive in drives]
    np.testing.assert_allclose(solved(drives, ("max_pin_load",), angles=few)[:, 0], alone, rtol=1e-7)


def test_samples_of_loose_bearings_are_those_alone():
    """Main bearing and crank bearings from tight to loose, as one batch with the plays, and each drive alone."""
    base, few = load_drive("paper").cases["CS-2"], ANGLES[:1]
    bearings = {
        "main_bearing.radial_stiffness": 5e5, "crank.support.diameter": 20.0,
        "crank.support.positions": (-20.0, 20.0), "crank.support.stiffness": (3e5, 4e5),
    }  # fmt: skip
    drives = [
        with_fields(base, bearings | {"main_bearing.clearance": clearance, "crank.support.clearance": clearance})
        for clearance in (-0.004, 0.0, 0.01, 0.02)
    ]
    alone = [analyse(drive, few).full.response.pin_load.max() for drive in drives]
    np.testing.assert_allclose(solved(drives, ("max_pin_load",), angles=few)[:, 0], alone, rtol=1e-7)
    plays = solved(drives, ("max_backlash_output",), angles=few)[:, 0]
    np.testing.assert_allclose(plays[0], plays[1], rtol=1e-6)  # tight ones add none
    assert np.all(np.diff(plays[1:]) > 0.0)


@pytest.mark.slow
def test_samples_of_other_coordinates_start_from_first_contact():
    """A nominal solution without the wheel's displacement, or of other numbers of parts, was started from."""
    base, quantities = load_drive("paper").cases["CS-2"], ("max_pin_load",)
    nominal = solve_nominal(base, BatchSettings(crank_angle=ANGLES, quantities=quantities))
    for change in (
        {"pin_wheel.support_stiffness": 1e5},
        {"crank_bearing.number_of_rollers": 10},
        {"pin_shaft.number_of_pins": 6},
        {"disc.number_of_discs": 2},
    ):
        drive = with_fields(base, change)
        # Without a start that suits, the answer is that without any.
        np.testing.assert_array_equal(solved([drive], quantities, nominal), solved([drive], quantities))


CASES = """
[[case]]
name = "rubs"
friction.pin = 0.05
load.speed = 1000.0
[[case]]
name = "smooth"
[[case]]
name = "at rest"
friction.pin = 0.05
"""


def case_file(folder):
    path = folder / "drive.toml"
    path.write_text(shipped_drive("robot-joint") + CASES, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("quantities", "cases", "told"),
    [
        (
            ["max_pin_load", "mean_efficiency"],
            ["rubs", "smooth"],
            "…mean_efficiency: … has no friction …: case smooth…",
        ),
        (["power_loss"], ["at rest", "rubs"], "…power_loss: … has no speed (load.speed): case at rest…"),
    ],
)
def test_a_quantity_that_a_case_has_not_is_refused_by_name(tmp_path, capsys, quantities, cases, told):
    """Judged on the first case alone the study ended in a traceback, or a power was no number without a word."""
    case_file(tmp_path)
    study = tmp_path / "study.toml"
    study.write_text(
        f'drive = "drive.toml"\npositions = 2\nquantities = {quantities}\nfactors.case = {cases}\n', encoding="utf-8"
    )
    assert main(["sweep", str(study), "--out", str(tmp_path / "out")]) == 2
    assert any(reads_as(told, line) for line in capsys.readouterr().err.splitlines())
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_cases_share_the_default_quantities_that_all_have(tmp_path):
    path = str(case_file(tmp_path))
    for cases, has in ((["rubs", "smooth"], False), (["smooth", "rubs"], False), (["rubs", "at rest"], True)):
        study = parse_sweep(tomllib.loads(f"positions = 2\nfactors.case = {cases}"), path)
        assert ("mean_efficiency" in study.quantities) is has
        assert "power_loss" not in study.quantities
    # The first case of the file, which is not swept, has nothing to say.
    table = tomllib.loads('positions = 2\nquantities = ["power_loss"]\nfactors.case = ["rubs"]')
    assert np.isfinite(run_batch(parse_sweep(table, path), 0).values).all()


SHAFTS = """
[[case]]
name = "with"
pin_shaft = { number_of_pins = 3, pin_circle_radius = 42.0, pin_radius = 4.0, hole_radius = 5.3, stiffness = 1e5 }
crank.angle = "60 deg"
[[case]]
name = "without"
"""


def test_cases_with_and_without_pin_shaft_share_what_both_have(tmp_path):
    """The largest load of no shaft pins at all: the sweep ended in a traceback."""
    path = tmp_path / "rv.toml"
    path.write_text(shipped_drive("rv") + SHAFTS, encoding="utf-8")
    table = tomllib.loads('positions = 1\nfactors.case = ["with", "without"]')
    study = parse_sweep(table, str(path), engine=HalfSpace())
    assert not set(OF_THE_PIN_SHAFT) & set(study.quantities)
    assert np.isfinite(run_batch(study, 0).values).all()
    with error_says(DriveError, "max_pin_shaft_load: ", " no pin shaft ", ": case without"):
        parse_sweep({**table, "quantities": ["max_pin_shaft_load"]}, str(path))


def test_a_sample_without_what_a_quantity_needs_says_so():
    """Whoever asks for samples without a study is told as well, and the other samples have their values."""
    paper = load_drive("paper").cases["CS-2"]
    found = analyse_samples(
        [paper, with_fields(paper, RUBS)], BatchSettings(crank_angle=ANGLES, quantities=("max_pin_load", *OF_FRICTION))
    )
    assert "mean_efficiency: " in found.messages[0]
    assert "has no friction" in found.messages[0]
    assert not found.messages[1]
    assert np.isfinite(found.values[1]).all()
