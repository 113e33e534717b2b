"""What drives a run in time."""

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.time_run import Course, prepare_run
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


@pytest.mark.parametrize("frame", ["housing", "output"])
def test_under_an_arm_the_input_has_the_mean_torque_of_a_whole_turn(frame):
    """A force displaces the wheel once a turn of the crank: over half of it the mean torque is some thousandths beside."""
    arm = {"load.external.0.force.x": 3000.0, "load.external.0.force.y": 1000.0, "load.external.0.frame": frame}
    masses = {"inertia.output": 0.5, "inertia.input": "1.2 kg cm²", "main_bearing.radial_stiffness": 1e5}
    drive = with_fields(load_drive("paper").cases["CS-1"], arm | masses)
    run = prepare_run(drive, HalfSpace(), Course.of_values("steady", 1e-3, 1500.0, "torque"))
    torque = analyse(drive, position_angles(72)).crank_torques.sum(axis=1)
    assert run.equation.input_torque == pytest.approx(torque.mean(), rel=1e-6)
    assert abs(np.mean(torque[:36]) / torque.mean() - 1.0) > 1e-3
