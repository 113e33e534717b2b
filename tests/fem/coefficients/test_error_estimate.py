"""The error that a derivation states about itself, from linear elements on its own mesh, against meshes of half the size."""

from __future__ import annotations

import numpy as np
import pytest

from fem.coefficients.bodies import derive_disc, derive_pin, derive_race, derive_roller
from fem.coefficients.stations import DiscStations
from fem.shapes import DriveShapes
from ltca.drive.single_discs import nominal_shape, single_discs
from ltca.reading.coefficient_laws import project_rigid_motions
from ltca.reading.drive_file import load_drive
from ltca.testing.practical_drives import practical_drive

SHIPPED = ("paper", "robot-joint", "rv", "sleeved")


def drive_of(name):
    drive = next(iter(load_drive(name).cases.values())) if isinstance(name, str) else practical_drive(name)[0]
    return nominal_shape(single_discs(drive)[0])


def largest_change(values, finer):
    """Largest difference, of the largest entry of the finer mesh."""
    return np.max(np.abs(values - finer)) / np.max(np.abs(finer))


# Random drives as shops make them: of one to three cranks, few and many teeth, with and without holes.
@pytest.mark.nightly
@pytest.mark.slow
@pytest.mark.parametrize("name", [*SHIPPED, *range(16)])
def test_stated_error_covers_the_true_one(name):
    """A mesh of half the size leaves a tenth of the error or less, so the change to it is the error within that."""
    drive = drive_of(name)
    shape = DriveShapes.of_drive(drive).disc
    stations = DiscStations.of_disc(shape, 0.5)
    options = {"thickness": drive.disc.thickness}
    coarse, disc, finest = (
        derive_disc(shape, stations, drive.materials.disc, size=each, **options) for each in (2.0, 1.0, 0.5)
    )
    for found, finer in ((coarse, disc), (disc, finest)):
        change = largest_change(*(project_rigid_motions(each.approach, each.resultants) for each in (found, finer)))
        assert change < found.error
        assert largest_change(found.stress, finer.stress) < found.stress_error
    # It goes with the fourth power of the size: coarse meshes are told from fine ones.
    assert coarse.error > 4.0 * disc.error


@pytest.mark.parametrize("size", [1.0, 2.0, 4.0])
def test_round_bodies_state_errors_that_cover_the_true_ones(size):
    drive = drive_of("paper")
    shapes, materials = DriveShapes.of_drive(drive), drive.materials
    for derive, shape, material in (
        (derive_pin, shapes.wheel_pins[0], drive.flank_pin),
        (derive_roller, shapes.rollers[0], materials.roller),
        (derive_race, shapes.inner_race, materials.inner_race),
    ):
        found, finer = (derive(shape, material, thickness=11.8, size=each) for each in (size, 0.5 * size))
        change = largest_change(found.approach, finer.approach)
        assert change < found.error < 10.0 * change
