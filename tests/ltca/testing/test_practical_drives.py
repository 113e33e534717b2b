"""Drives as people draw them: every one is answered, and confirmed by energies alone."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import ConvergenceError
from ltca.geometry.interference import drawn_interference
from ltca.testing.balance_check import find_imbalance
from ltca.testing.crank_drives import crank_drive
from ltca.testing.practical_drives import practical_drive, preloaded_drive


def check_seeds(first, count, draw=practical_drive):
    for seed in range(first, first + count):
        drive, angle = draw(seed)
        model = HalfSpace().prepare(drive).model
        balanced = solve_at_output(model, [drive], np.array([angle]), drive.load.torque)
        assert find_imbalance(drive, model, balanced, torque=drive.load.torque) == [], seed


def test_practical_drives_quick():
    check_seeds(0, 1)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(1, 11), pytest.param(12, 488, marks=pytest.mark.nightly)])
def test_five_hundred_practical_drives(first, count):
    """``benchmarks/random_drives.py --practical`` runs 10,000."""
    check_seeds(first, count)


def test_a_pin_that_just_touches_was_told_to_carry_while_open():
    """Approaches on displaced pins were those before the last correction, loads those after it: 7e-11 N at −4e-15 mm."""
    check_seeds(380, 1)


def test_preloaded_drives_quick():
    check_seeds(0, 1, preloaded_drive)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(1, 3), pytest.param(4, 36, marks=pytest.mark.nightly)])
def test_forty_preloaded_drives(first, count):
    """``benchmarks/random_drives.py --preloaded`` runs thousands."""
    check_seeds(first, count, preloaded_drive)


def test_reducers_of_all_kinds_quick():
    check_seeds(0, 1, crank_drive)


@pytest.mark.slow
def test_a_disc_that_rolls_in_the_wheel_is_followed_along_its_valley():
    """Pressed by 226 pins all around it rolls almost freely: "no equilibrium" after 700 steps that each fell by 0.6 %."""
    check_seeds(833, 1, crank_drive)


@pytest.mark.slow
def test_displacements_of_a_soft_ring_end_at_their_round_off():
    """A plastic ring 5 mm wide: residuals of 3e-13 … 2e-12 mm were asked to fall below 5e-14 and 1e-12 of the largest."""
    check_seeds(20401, 1, crank_drive)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "count"), [(1, 6), pytest.param(7, 193, marks=pytest.mark.nightly)])
def test_two_hundred_reducers_of_all_kinds(first, count):
    """``benchmarks/random_drives.py --cranks`` runs thousands."""
    check_seeds(first, count, crank_drive)


@pytest.mark.slow
def test_every_kind_of_reducer_is_drawn():
    drives = [crank_drive(seed)[0] for seed in range(100)]
    assert {drive.crank.number for drive in drives} == {1, 2, 3, 4, 5}
    assert {drive.crank.support is None for drive in drives} == {True, False}
    assert {drive.pin_wheel.support_stiffness is None for drive in drives} == {True, False}
    assert {drive.installation.first_stage_ratio for drive in drives} == {None, 1.0, 2.0, 2.5}
    assert any(drive.crank.number > 1 and drive.pin_shaft is not None for drive in drives)
    assert any(drive.crank.number > 1 and drive.crank.of for drive in drives)
    assert any(own.bore_errors for drive in drives for own in drive.disc.of)
    teeth = [drive.first_stage for drive in drives if drive.first_stage is not None]
    assert {one.module is None for one in teeth} == {one.helix_angle == 0.0 for one in teeth} == {True, False}
    assert {one.backlash == 0.0 for one in teeth} == {one.mesh_stiffness is None for one in teeth} == {True, False}
    assert {entry.frame for drive in drives for entry in drive.load.external} == {"housing", "output"}


@pytest.mark.slow
def test_preload_of_every_kind_is_drawn():
    found = [drawn_interference(preloaded_drive(seed)[0]) for seed in range(40)]
    for kind in ("pins", "rollers", "holes"):
        assert any(getattr(overlaps, kind) > 5e-4 for overlaps in found)
    assert all(max(overlaps.pins, overlaps.rollers, overlaps.holes) > 0.0 for overlaps in found)


@pytest.mark.slow
def test_zeros_and_equalities_are_drawn():
    """They are what people type, and what a generator of real numbers never meets."""
    drives = [practical_drive(seed)[0] for seed in range(120)]
    offsets = [(drive.disc.equidistant_offset, drive.disc.shifting_offset) for drive in drives]
    assert any(offset == (0.0, 0.0) for offset in offsets)
    assert any(first == second != 0.0 for first, second in offsets)
    assert any(drive.clearance.bearing == drive.clearance.pin_hole == 0.0 for drive in drives)
    assert any(drive.crank_bearing.roller_length == drive.disc.thickness for drive in drives)
    assert {drive.load.direction for drive in drives} == {"ccw", "cw"}
    assert {drive.disc.number_of_discs for drive in drives} == {1, 2, 3}
    assert {drive.installation.held for drive in drives} == {"pin-shaft", "pin-wheel"}
    assert any(drive.disc.of for drive in drives)
    assert {drive.materials.disc.youngs_modulus for drive in drives} == {206e3, 70e3, 2.6e3}
    assert min(drive.pin_wheel.number_of_pins for drive in drives) <= 8
    assert max(drive.pin_wheel.number_of_pins for drive in drives) >= 100


@pytest.mark.slow
def test_a_ridge_is_no_balance():
    """At 1e-5 of its torque seed 280 was told to balance 3.4° on, between all pins, under 2.7 MN: long steps ended on a ridge."""
    drive, angle = practical_drive(280)
    model = HalfSpace().prepare(drive).model
    try:
        found = solve_at_output(model, [drive], np.array([angle]), -1e-5 * drive.load.torque)
    except ConvergenceError:
        return
    stiffness = np.linalg.eigvalsh(found.response.tangent[0])
    # Discs that float have none; that of a symmetric matrix is known to round-off by its largest.
    assert stiffness[0] >= -np.finfo(float).eps * stiffness.size * stiffness[-1]
    assert found.response.pin_load.max() < 1.0  # N
