"""Positions between known ones: what a cubic path is, what uneven spacings and ends give, and what a start costs."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.equilibrium.neighbours import between, pose_between
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import load_drive


def test_a_cubic_path_is_followed_exactly():
    known, wanted = np.array([0.9, 0.1, 0.5, 0.3, 0.7]), np.array([0.11, 0.42, 0.66, 0.9])
    turning, straight = (np.polynomial.Polynomial(c) for c in ([0.2, -1.0, 0.5, 3.0], [1.0, 2.0, -1.0, 0.7]))

    def poses(angle):
        place = (turning(angle) + 1j * straight(angle)) * np.exp(1j * angle)
        return np.stack((place.real, place.imag, straight(angle), turning(angle)), axis=1)

    found = pose_between(known, poses(known), wanted, Coordinates())
    np.testing.assert_allclose(found, poses(wanted), rtol=0.0, atol=1e-13)


def test_uneven_spacings_are_followed_in_line_and_ends_are_kept():
    known = np.array([0.0, 0.1, 1.0, 1.1])
    around, weights = between(known, np.array([0.55, -1.0, 9.0]))
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=0.0, atol=1e-15)
    there = np.einsum("wk,wk->w", weights, known[around])
    np.testing.assert_allclose(there, [0.55, 0.0, 1.1], rtol=0.0, atol=1e-15)
    assert np.count_nonzero(weights[0]) == 2
    np.testing.assert_array_equal(between(np.zeros(1), np.array([0.3]))[1], 1.0)


def test_the_moment_of_a_held_wheel_is_found_in_the_search():
    """Secants behind the search cost two evaluations of every position: one iteration is more than with the shaft held now."""
    drive = load_drive("rv").cases["nominal"]
    model, angle = HalfSpace().prepare(drive).model, position_angles(90)
    held = solve_at_output(model, [drive], angle, drive.load.torque)
    free = drive.with_fields({"installation.held": "pin-shaft"})
    other = solve_at_output(HalfSpace().prepare(free).model, [free], angle, drive.load.torque)
    assert held.iterations.mean() < other.iterations.mean() + 1.0
    assert np.ptp(held.wheel_moment) > 1e-9 * abs(held.wheel_moment.mean())


@pytest.mark.parametrize("positions", [12, 36])
def test_one_position_leads_few_others(positions):
    """Of positions too far apart to lie between others each began at first contact: 6.4 iterations for 3.2."""
    drive = load_drive("paper").cases["CS-1"]
    found = solve_at_output(HalfSpace().prepare(drive).model, [drive], position_angles(positions), drive.load.torque)
    assert np.mean(found.iterations[1:]) < 0.7 * found.iterations[0]
