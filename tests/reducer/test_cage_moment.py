"""Roller cages: with the moment that holds them all forces are in balance, and virtual work closes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, X, Y
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.practical_drives import practical_drive

ANGLES = np.array([0.05, 1.7, 3.9])
CLOSED = 1e-7
"""Of the torque: poses balance to 1e-9 of the load, moments about the axis of the drive to some hundred times that."""


def drive_named(name):
    if name == "paper":
        return load_drive("paper").cases["CS-6"]
    if name == "rv":
        return parse_drive(shipped_drive("rv")).cases["nominal"]
    if name == "two discs, wheel held":
        return with_fields(
            parse_drive(shipped_drive("robot-joint")).cases["nominal"], {"installation.held": "pin-wheel"}
        )
    return practical_drive(int(name.partition(" ")[2]))[0]


NAMES = ["paper", "rv", "two discs, wheel held", *(f"practical {seed}" for seed in (1, 4, 9, 13))]
LONG = pytest.param("practical 21", marks=pytest.mark.nightly)


def moment_of_pin_shaft(found):
    """What holds the pin shaft against the forces on its pins and in the bearings of its cranks, about the axis, N·mm."""
    total = np.zeros(found.full.crank_angle.size)
    for number, (disc, part) in enumerate(zip(found.model.discs, found.full.response.parts, strict=True)):
        place, own = disc.geometry.placement, found.full.pose[:, found.model.coordinates.columns(number)]
        # Forces go through the centres of the holes as they stand, wherever pins have given way to.
        centre = place.races(found.full.crank_angle).middle + own[:, X] + 1j * own[:, Y]
        holes = centre[:, None] + place.hole_centres * np.exp(1j * own[:, DISC_ROTATION, None])
        along = part.holes.gradient[..., DISC_PLACE]
        force = part.hole_load * (along[..., 0] + 1j * along[..., 1])
        total -= (holes.conjugate() * force).imag.sum(axis=1)
        push = place.eccentric_directions(found.full.crank_angle) * (
            found.bearing_radial[:, number] + 1j * found.bearing_tangential[:, number]
        )
        total += (np.conj(place.crank_axes) * push).imag.sum(axis=1)
    return total


@pytest.mark.parametrize("name", [NAMES[0], *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[1:]), LONG])
def test_all_forces_are_in_balance_with_what_holds_the_cages(name):
    """T_W + ΣT_C + (1 − k) ΣM_K + T_PS = 0: `crank_torque` alone read as the moment of the forces."""
    drive = drive_named(name)
    drive = replace(drive, friction=None, temperature=None)
    found = analyse(drive, ANGLES)
    data = build_dataset("drive", {"A": found}).isel(case=0)
    cages = (1.0 - float(data["cage_speed"])) * data["cage_moment"].sum("crank").values
    crank, wheel = data["crank_torque"].sum("crank").values, data["wheel_moment"].values
    shaft = moment_of_pin_shaft(found)
    np.testing.assert_allclose((wheel + crank + cages + shaft) / drive.load.torque, 0.0, atol=CLOSED)
    assert np.max(np.abs(cages)) > 5.0 * CLOSED * drive.load.torque  # without them it would not close
    if drive.wheel_is_held and drive.crank.number == 1:  # the output's is that of virtual work
        output = drive.driving_sign * drive.load.torque
        np.testing.assert_allclose((shaft + cages) / output, 1.0, rtol=0.0, atol=CLOSED)


@pytest.mark.slow
@pytest.mark.family(full=3)
@pytest.mark.parametrize("name", [*NAMES, LONG])
def test_virtual_work_closes_with_the_moment_of_the_cranks(name, unbalanced_work):
    """T_C (1/1) + T_W (1/u + w′) is the change of what is stored: the cages' part of T_C goes with their speed."""
    drive = replace(drive_named(name), friction=None, temperature=None)
    np.testing.assert_allclose(unbalanced_work(drive, ANGLES), 0.0, atol=CLOSED)
