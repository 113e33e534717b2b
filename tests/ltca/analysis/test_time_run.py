"""What drives a run in time."""

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.time_run import Course, prepare_run, run_in_time
from ltca.dynamics.contact_forces import ContactForces
from ltca.dynamics.motion import Equation
from ltca.errors import ConvergenceError
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


INERTIAS = {"inertia.output": 0.5, "inertia.input": "1.2 kg cm²"}


def test_a_state_tried_far_from_the_contacts_ended_a_run(monkeypatch):
    """Behind an impact a solver tries states whose contacts find no loads: their rate is NaN, and the step shorter, from what
    was known before.
    """
    drive = with_fields(load_drive("paper").cases["CS-1"], INERTIAS)
    equation = prepare_run(drive, HalfSpace(), Course.of_values("steady", 1e-3, 1500.0, "speed")).equation
    state = np.zeros(2 * equation.freedoms + 4)
    equation.rates(0.0, state)
    near = equation.rates(0.0, state)
    at = ContactForces.at

    def lost(self, x, rate):
        at(self, x + 0.01, rate)
        raise ConvergenceError("found no loads", [])

    with monkeypatch.context() as patched:
        patched.setattr(ContactForces, "at", lost)
        assert np.isnan(equation.rates(0.0, state)).all()
    assert [str(problem) for problem in equation.refused] == ["found no loads"]
    np.testing.assert_array_equal(equation.rates(0.0, state), near)
    assert not equation.refused


def test_refused_states_shorten_steps_and_the_cause_is_told_where_none_is_left(monkeypatch):
    """States refused now and then change a run by its tolerance; where all are, the run stops with what refused them."""
    drive = with_fields(load_drive("paper").cases["CS-1"], INERTIAS)
    course = Course.of_values("steady", 2e-5, 1500.0, "speed")
    plain = run_in_time(prepare_run(drive, HalfSpace(), course), samples=3)
    solved, calls, last = Equation.solved, [0], [1e9]

    def refusing(self, time, state):
        calls[0] += 1
        if calls[0] in (20, 45) or time > last[0]:
            raise ConvergenceError("found no loads", [])
        return solved(self, time, state)

    monkeypatch.setattr(Equation, "solved", refusing)
    cut = run_in_time(prepare_run(drive, HalfSpace(), course), samples=3)
    assert cut.evaluations > plain.evaluations
    np.testing.assert_allclose(cut.samples.pin_load, plain.samples.pin_load, rtol=1e-4, atol=1e-4)
    last[0] = 1e-5
    with pytest.raises(ConvergenceError, match="the run stops at 1e-05 s: found no loads"):
        run_in_time(prepare_run(drive, HalfSpace(), course), samples=3)
