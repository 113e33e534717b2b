"""How far contacts lie from the stations of the coefficients, by angles made by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.reading.drive_file import load_drive
from validation.compare.compared_positions import _station_distances
from validation.compare.model_positions import answers_of


def boundary(count, offset=0.0):
    return SimpleNamespace(count=count, offset=offset)


def test_distances_are_parts_of_a_spacing_in_the_frame_of_the_disc():
    """Forty stations on the flank, ten in the bore, twenty in a hole; the disc turned by 0.02 rad."""
    turn = 0.02
    flank = 2.0 * np.pi * np.array([[3.0, 3.4, 39.8]]) / 40
    rollers = np.exp(1j * (2.0 * np.pi * np.array([[0.0, 2.5]]) / 10 + turn))
    holes = 2.0 * np.pi * np.array([[7.0, 7.25]]) / 20 + turn
    gradient = np.stack([2.0 * np.cos(holes), 2.0 * np.sin(holes), 0.0 * holes, 0.0 * holes], axis=-1)
    response = SimpleNamespace(
        flank=SimpleNamespace(parameter=flank),
        rollers=SimpleNamespace(outer_direction=rollers),
        holes=SimpleNamespace(gradient=gradient),
    )
    analysis = SimpleNamespace(full=SimpleNamespace(response=response, pose=np.array([[0.0, 0.0, turn, 0.0]])))
    coefficients = SimpleNamespace(flank=boundary(40), bores=(boundary(10),), holes=(boundary(20), boundary(20)))
    found = _station_distances(analysis, coefficients)
    np.testing.assert_allclose(found["pin"], [[0.0, 0.4, 0.2]], atol=1e-12)
    np.testing.assert_allclose(found["roller_outer"], [[0.0, 0.5]], atol=1e-12)
    np.testing.assert_allclose(found["hole"], [[0.0, 0.25]], atol=1e-12)


def test_the_wheel_angle_of_tied_pins_was_a_place_of_their_ring():
    """It was told as the fourth number of the pose, which beams with tied tips have something else in: 400″ beside."""
    joint = load_drive("robot-joint").cases["nominal"].with_fields({"pin_shaft.beam": {"tip": "tied-clamped"}})
    answer = analyse(joint, np.array([0.5]))
    for disc in answer.discs:
        (found,) = answers_of(disc)
        assert joint.output_deviation(found.wheel_angle, joint.load.torque) == pytest.approx(
            float(answer.transmission_error[0]), rel=1e-12
        )
