"""Signs without load, and which pairs can carry, against loaded answers."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.geometry.pairs import ContactGeometry
from validation.methods.unloaded import carrying_holes, carrying_pins, carrying_rollers, unloaded_transmission_error


def test_unloaded_transmission_error_has_the_sign_of_the_convention(paper_cases):
    geometry = ContactGeometry.of_drive(paper_cases["CS-1"])
    angles = np.linspace(0.0, 6.0, 25)
    forward = unloaded_transmission_error(geometry, angles)
    # a crank driving ccw winds the drive up: the wheel stays behind
    assert np.all(forward < 0.0)
    np.testing.assert_allclose(unloaded_transmission_error(geometry, -angles, -1), -forward, atol=1e-13)
    # without part errors its period is one tooth of the disc, 360°/13 of crank
    later = unloaded_transmission_error(geometry, angles + 2.0 * np.pi / 13.0)
    np.testing.assert_allclose(later, forward, atol=1e-13)


@pytest.mark.parametrize("direction", ["ccw", "cw"])
def test_every_loaded_pair_is_one_that_can_carry(vary, direction):
    drive = vary(load={"direction": direction}, clearance={"bearing": 0.03, "pin_hole": 0.03})
    angles = np.linspace(0.0, 6.2, 31)
    analysis = analyse(drive, angles)
    geometry, contacts = ContactGeometry.of_drive(drive), analysis.full.response
    sign = drive.driving_sign
    pins = carrying_pins(geometry, angles, sign)
    assert not np.any((contacts.pin_load > 0.0) & ~pins)
    holes = carrying_holes(geometry, angles, sign)
    assert not np.any((contacts.hole_load > 0.0) & ~holes)
    push = (contacts.rollers.outer_load * contacts.rollers.outer_direction).sum(axis=1)
    rollers = carrying_rollers(geometry, angles, np.angle(push))
    assert not np.any((contacts.rollers.outer_load > 0.0) & ~rollers)
    # a turned predicate (ahead for behind) would name the other half
    assert np.all(pins.sum(axis=1) >= 6)
    assert np.all(pins.sum(axis=1) <= 7)
    assert np.all((holes & (contacts.hole_load > 0.0)).any(axis=1))


def test_loaded_holes_lie_ahead_of_the_crank(paper_cases):
    geometry = ContactGeometry.of_drive(paper_cases["CS-1"])
    # crank at 10°: holes at 45°, 90°, 135° and 180° are ahead, in the half turn counter-clockwise of it
    found = carrying_holes(geometry, np.radians([10.0]), 1)[0]
    np.testing.assert_array_equal(np.nonzero(found)[0], [1, 2, 3, 4])
    found = carrying_holes(geometry, np.radians([10.0]), -1)[0]
    np.testing.assert_array_equal(np.nonzero(found)[0], [0, 5, 6, 7])
