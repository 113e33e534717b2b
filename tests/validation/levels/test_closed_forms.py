"""Closed forms of the first level."""

import pytest

from ltca.reading.drive_file import load_drive
from validation.levels.closed_forms import cylinder_rows, power_rows


def test_mean_tangential_load_of_the_paper_is_torque_by_ratio_and_eccentricity():
    """T/(u e) = 377.3 N·m/(14 · 4 mm): the mean over whole periods of the flank, of 13 teeth by 26 positions."""
    (row,) = power_rows(load_drive("paper").cases["CS-1"], positions=26)
    assert row.reference == pytest.approx(377_300.0 / (14.0 * 4.0), rel=1e-12)
    assert row.value == pytest.approx(row.reference, rel=row.limit)


def test_cylinders_on_coarse_meshes_are_those_of_hertz():
    """The load is carried exactly, half-width and pressure by three elements for the half-width to a tenth."""
    width, peak, load = cylinder_rows(3.0)
    for row, tolerance in ((width, 0.1), (peak, 0.1), (load, 1e-9)):
        assert row.value == pytest.approx(row.reference, rel=tolerance)
