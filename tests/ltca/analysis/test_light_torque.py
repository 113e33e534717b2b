"""An analysis at its light torque is the analysis at that torque."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.light_torque import at_light_torque
from ltca.analysis.loaded_analysis import analyse
from ltca.reading.drive_file import load_drive


@pytest.mark.parametrize("name", ["paper", "rv"])
def test_loads_forces_and_pressures_are_those_of_a_run_at_that_torque(name):
    drive, angle = next(iter(load_drive(name).cases.values())), np.array([0.05, 2.1])
    light = drive.load.light_torque
    found = at_light_torque(analyse(drive, angle))
    alone = analyse(replace(drive, load=replace(drive.load, torque=light)), angle)
    assert found.torque == light
    largest = float(alone.full.response.pin_load.max())
    np.testing.assert_allclose(found.full.response.pin_load, alone.full.response.pin_load, atol=1e-6 * largest)
    for which in ("bearing_radial", "bearing_tangential"):
        force = getattr(alone, which)
        np.testing.assert_allclose(getattr(found, which), force, atol=1e-6 * np.abs(alone.bearing_tangential).max())
    pressure = alone.pressures.pins.mid
    np.testing.assert_allclose(found.pressures.pins.mid, pressure, atol=1e-6 * np.nanmax(pressure))
