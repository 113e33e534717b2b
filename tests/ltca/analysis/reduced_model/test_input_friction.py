"""Friction at the input: which sense of motion drives and which is driven, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.reduced_model.input_friction import InputFriction


@pytest.mark.parametrize("size", [1e-3, 0.5, 1.0, 1e6])
@pytest.mark.parametrize("ratio", [-5.0, 5.0])
def test_the_sense_of_the_load_decides_and_not_its_size(size, ratio):
    """A load that turns the output ccw turns the input by the sign of the ratio: that way it drives, the other way not."""
    table = InputFriction(
        torque=size * np.array([-1.0, 0.0, 1.0]),
        ccw=np.array([1.0, 2.0, 3.0]),
        cw=np.array([10.0, 20.0, 30.0]),
        locked=np.zeros(3, dtype=bool),
        ratio=ratio,
    )
    along, against = ([1.0, 20.0, 30.0], [10.0, 2.0, 3.0]) if ratio < 0.0 else ([10.0, 20.0, 3.0], [1.0, 2.0, 30.0])
    np.testing.assert_array_equal(table.driven_back, along)
    np.testing.assert_array_equal(table.driving, against)


def test_efficiency_is_that_of_the_torques_at_the_input():
    """By hand: 100 N·mm at the output are 20 at an input of five turns for one; friction of 5 there leaves 20/25 and 15/20."""
    table = InputFriction(
        torque=np.array([0.0, 100.0]),
        ccw=np.array([0.0, 5.0]),
        cw=np.array([0.0, 5.0]),
        locked=np.zeros(2, dtype=bool),
        ratio=5.0,
    )
    np.testing.assert_allclose(table.efficiency, [0.0, 0.8], rtol=1e-15)
    np.testing.assert_allclose(table.efficiency_driven_back, [0.0, 0.75], rtol=1e-15)
