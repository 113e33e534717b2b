"""Losses of a drive that turns: what seals and oil take at the input."""

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.drive.parts import Friction
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

NO_LOAD = 60.0


@pytest.mark.parametrize("direction", ["ccw", "cw"])
@pytest.mark.parametrize("name", ["paper", "robot-joint"])
def test_no_load_torque_is_added_at_the_input(name, direction):
    """It moves no contact: the input torque grows by it in the direction in which the input turns, and the lost power with it."""
    drive = next(iter(load_drive(name).cases.values()))
    drive = with_fields(replace(drive, friction=None), {"load.direction": direction})
    with_seals, without = (
        analyse(replace(drive, friction=Friction(pin=0.05, no_load_torque=torque)), np.array([0.4])).losses
        for torque in (NO_LOAD, 0.0)
    )
    turns = np.sign(without.input_torque)
    np.testing.assert_allclose(with_seals.input_torque - without.input_torque, turns * NO_LOAD, rtol=1e-9)
    put_in = with_seals.at_input - without.at_input
    np.testing.assert_allclose(put_in, NO_LOAD * np.abs(without.input_turns), rtol=1e-9)
    np.testing.assert_allclose(with_seals.total - without.total, put_in, rtol=1e-9)
