"""What deviations do, against closed forms: one pin, runout, vanishing errors; rigid play against vanishing torque."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.torque_curve import torque_curve
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, first_contact
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import free_play
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.studies.tolerance_study import tolerance_study
from ltca.testing.practical_drives import rigid_poses

FEELER = 0.01  # mm: the pin moved inward by 10 µm


def moved_inward(drive, pin, size=FEELER):
    return with_fields(drive, {f"pin_wheel.pin_errors.radial.{pin}": -size})


def test_one_pin_moved_inward_turns_the_wheel_by_its_closed_form(paper_cases):
    """Rigid limit: the pin that touches gives way by 10 µm along its normal, over the lever about the wheel."""
    drive = paper_cases["CS-1"]
    geometry = ContactGeometry.of_drive(drive)
    angles = np.linspace(0.0, 2.0 * np.pi, 9)
    rotation, pins = first_contact(geometry, angles, WHEEL_ANGLE, -1)
    pose = np.zeros((9, 4))
    pose[:, WHEEL_ANGLE] = rotation
    gradient = geometry.flank(angles, pose).gradient
    for row, (angle, pin) in enumerate(zip(angles, pins, strict=True)):
        out = np.exp(1j * (angle / 14 + rotation[row] + 2.0 * np.pi * pin / 14))
        normal = gradient[row, pin, 0] + 1j * gradient[row, pin, 1]
        # Moving the pin by −h outward presses it by h n·r; the wheel turns back by that over its rate of approach.
        closer = FEELER * (normal * out.conjugate()).real
        expected = -closer / gradient[row, pin, WHEEL_ANGLE]
        moved, touching = first_contact(
            ContactGeometry.of_drive(moved_inward(drive, int(pin))), angles[[row]], WHEEL_ANGLE, -1
        )
        assert touching[0] == pin or expected * -1 < 0  # moved away, another pin may touch first
        if touching[0] == pin:
            # second order: h² over the flank's radius of some 16 mm and over the lever of 56 mm, 6 nm of 10 µm
            assert moved[0] - rotation[row] == pytest.approx(expected, rel=2e-3, abs=1e-9)


def test_one_pin_moved_inward_takes_load_by_the_stiffness_of_the_pairs(paper_cases):
    """dF = k (dh − g·dq), dq = H⁻¹ g k dh: what it takes over follows from stiffnesses at the loaded pose alone."""
    drive = paper_cases["CS-6"]
    angles = np.array([0.3, 1.9])
    model = HalfSpaceCompliance.of_drive(drive)
    before = solve_equilibrium(Reducer(discs=(model,)), angles, drive.wheel_moment())
    law, flank = model.pin_law, before.response.flank
    _, stiffness = law.load_and_stiffness(flank.approach, flank.effective_radius)
    for row in range(2):
        pin = int(np.argmax(before.response.pin_load[row]))
        out = np.exp(1j * (angles[row] / 14 + before.pose[row, WHEEL_ANGLE] + 2.0 * np.pi * pin / 14))
        normal = flank.gradient[row, pin, 0] + 1j * flank.gradient[row, pin, 1]
        share = (normal * out.conjugate()).real
        gradient = flank.gradient[row, pin]
        k = stiffness[row, pin]
        give = np.linalg.solve(before.response.tangent[row], gradient) @ gradient
        moved = moved_inward(drive, pin, 1e-5)
        after = solve_equilibrium(
            Reducer(discs=(HalfSpaceCompliance.of_drive(moved),)), angles[[row]], drive.wheel_moment()
        )
        found = after.response.pin_load[0, pin] - before.response.pin_load[row, pin]
        assert found == pytest.approx(1e-5 * share * k * (1.0 - k * give), rel=2e-3)
        # the moment of all pins still carries the load
        assert after.response.force[0, 3] == pytest.approx(drive.wheel_moment(), rel=1e-8)


@pytest.mark.slow
def test_ten_micrometres_are_the_sum_of_their_small_steps(paper_cases):
    """10 µm is as much as the approaches, other pins lift off on the way: the rates of all steps add up."""
    drive, angle = paper_cases["CS-6"], np.array([0.3])
    pin, sizes = None, np.linspace(0.0, FEELER, 21)
    loads, rates = [], []
    for size in sizes:
        moved = drive if pin is None else moved_inward(drive, pin, float(size))
        model = HalfSpaceCompliance.of_drive(moved)
        found = solve_equilibrium(Reducer(discs=(model,)), angle, drive.wheel_moment())
        flank = found.response.flank
        if pin is None:
            pin = int(np.argmax(found.response.pin_load[0]))
        out = np.exp(1j * (angle[0] / 14 + found.pose[0, WHEEL_ANGLE] + 2.0 * np.pi * pin / 14))
        gradient = flank.gradient[0, pin]
        share = ((gradient[0] + 1j * gradient[1]) * out.conjugate()).real
        k = model.pin_law.load_and_stiffness(flank.approach, flank.effective_radius)[1][0, pin]
        give = np.linalg.solve(found.response.tangent[0], gradient) @ gradient
        rates.append(share * k * (1.0 - k * give))
        loads.append(found.response.pin_load[0, pin])
    step = sizes[1]
    summed = step * (np.sum(rates) - 0.5 * (rates[0] + rates[-1]))
    # trapezia over the kinks where pins lift off
    assert loads[-1] - loads[0] == pytest.approx(summed, rel=0.01)
    assert loads[-1] > loads[0] + 1000.0


RUNOUT = 0.002


def test_loaded_drive_shows_the_same_order_at_vanishing_torque(paper_cases):
    drive = with_fields(paper_cases["CS-1"], {"disc.runout.amount": RUNOUT, "disc.runout.angle": 0.8})
    angles = 2.0 * np.pi * np.arange(52) / 52
    rigid, _ = first_contact(ContactGeometry.of_drive(drive), angles, WHEEL_ANGLE, -1)
    away = []
    for torque in (1e3, 1e2):
        found = solve_equilibrium(Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), angles, -torque)
        away.append(np.max(np.abs(found.pose[:, WHEEL_ANGLE] - rigid)))
    # elastic wind-up falls with the torque: 7 … 10 for a tenth (line contacts)
    assert 6.0 < away[0] / away[1] < 10.5
    assert away[1] < 0.02 * RUNOUT / 56.0


def test_eccentricity_error_moves_the_mean_and_adds_no_order(paper_cases):
    """The same at every mesh: a centred error of the crank has the period of the teeth."""
    drive = with_fields(paper_cases["CS-1"], {"crank.eccentricity_error": 0.01})
    angles = np.array([0.2, 0.2 + 2.0 * np.pi / 13, 0.2 + 10.0 * np.pi / 13])
    rotation, _ = first_contact(ContactGeometry.of_drive(drive), angles, WHEEL_ANGLE, -1)
    np.testing.assert_allclose(rotation, rotation[0], rtol=1e-10)


@pytest.mark.slow
def test_vanishing_errors_follow_the_trend_of_each_quantity():
    """Zero-mean errors of size s, drawn with both signs so that odd terms cancel.

    Means over the turn are smooth: their scatter is ∝ s, their shift falls faster than s. The largest pin load is the
    largest of 14 like pins: while the errors exceed what tells the pins apart it grows ∝ s (never falls); when they are
    smaller than that one pin stays the largest and the shift, too, falls faster than s.
    """
    file = load_drive("paper")
    study = tolerance_study(file, case="CS-6", samples=24, positions=26, seed=3)
    design, drive = study.design, study.cases[0][1]
    centres = np.array(design.factors.centres)
    rows = design.rows(0, 24) - centres
    angle = list(design.names).index("disc.runout.angle")
    settings = BatchSettings(
        crank_angle=2.0 * np.pi * np.arange(26) / 26,
        quantities=("mean_transmission_error", "mean_bearing_load", "max_pin_load"),
    )
    nominal = analyse_samples([drive], settings).values[0]
    shift, scatter = {}, {}
    for size in (0.4, 0.1, 0.00625):
        both = []
        for sign in (1.0, -1.0):
            scaled = sign * size * rows
            scaled[:, angle] = rows[:, angle]  # a direction has no size
            values = analyse_samples([with_fields(drive, design.fields(row + centres)) for row in scaled], settings)
            assert not any(values.messages)
            both.append(values.values - nominal)
        shift[size] = np.mean(0.5 * (both[0] + both[1]), axis=0) / size
        scatter[size] = np.std(both[0], axis=0) / size
    # ∝ s: a sixty-fourth of the size keeps the ratio; what curves is a tenth of it at the largest
    np.testing.assert_allclose(scatter[0.00625][:2], scatter[0.1][:2], rtol=0.03)
    np.testing.assert_allclose(scatter[0.4][:2], scatter[0.1][:2], rtol=0.15)
    # no first-order bias: measured 0.1 … 0.2 % of the scatter at a hundred-and-sixtieth of the tolerances
    assert np.all(np.abs(shift[0.00625][:2]) < 0.01 * scatter[0.00625][:2])
    assert np.all(np.abs(shift[0.00625]) < 0.5 * np.abs(shift[0.1]))
    # extremes in their linear range
    assert shift[0.4][2] == pytest.approx(shift[0.1][2], rel=0.2)
    assert shift[0.1][2] > scatter[0.1][2]


def test_free_play_without_clearances_is_the_backlash(paper_cases):
    geometry = ContactGeometry.of_drive(paper_cases["CS-1"])
    angles = np.linspace(0.0, 6.0, 5)
    np.testing.assert_allclose(free_play([geometry], angles).play, backlash(geometry, angles, WHEEL_ANGLE), rtol=1e-6)


def test_rigid_poses_touch_and_do_not_interfere(paper_cases):
    geometry = ContactGeometry.of_drive(paper_cases["CS-6"])
    angles = np.linspace(0.0, 6.0, 4)
    poses = rigid_poses(geometry, angles, -1)
    flank, holes = geometry.flank(angles, poses), geometry.holes(angles, poses)
    assert np.all(flank.approach < 1e-9)
    assert np.all(holes.approach < 1e-9)
    touching = (flank.approach > -1e-9).sum(axis=1) + (holes.approach > -1e-9).sum(axis=1)
    assert np.all(touching >= 2)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["CS-1", pytest.param("CS-3", marks=pytest.mark.slow), "CS-6"])
def test_torque_curve_tends_to_the_play_of_the_clearances(paper_cases, case):
    """The issue asks for 1 %; at 1e-4 of the torque the elastic wind-up is 1e-4 of the play."""
    angles = np.array([0.1, 1.7])
    curve = torque_curve(paper_cases[case], angles, points=12)
    play = free_play([ContactGeometry.of_drive(paper_cases[case])], angles).play
    smallest = np.argsort(np.abs(curve.torque))[:2]
    branches = np.abs(np.diff(curve.output_angle[:, smallest]))[:, 0]
    np.testing.assert_allclose(branches, play, rtol=1e-3)
    assert np.all(branches > play)
    assert np.all(curve.lost_motion > branches)


@pytest.mark.slow
def test_torque_curve_is_monotone_and_mirrored(paper_cases):
    """A mirrored drive at the mirrored crank angle winds up the other way; φ_C = 0 is its own mirror."""
    drive = paper_cases["CS-6"]
    curve = torque_curve(drive, np.array([0.0]), points=10)
    assert np.all(np.diff(curve.wheel_angle[0]) > 0.0)
    np.testing.assert_allclose(curve.wheel_angle[0], -curve.wheel_angle[0][::-1], rtol=1e-9)
    np.testing.assert_allclose(curve.stiffness[0, 0], curve.stiffness[0, 1], rtol=1e-6)
