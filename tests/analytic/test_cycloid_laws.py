"""Closed forms of the unmodified cycloid: the pitch point, and the load sharing of equal linear springs."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.pairs import ContactGeometry


@pytest.fixture(scope="module")
def unmodified(vary):
    return vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0})


def lever_arms(drive, angles):
    """Levers of the contact normals about the wheel axis from the pitch-point property: |P × n| by vectors."""
    e, z, radius = drive.crank.eccentricity, drive.pin_wheel.number_of_pins, drive.pin_wheel.pin_circle_radius
    pins = radius * np.exp(1j * (angles[:, None] / z + 2.0 * np.pi * np.arange(z) / z))
    pitch = e * z * np.exp(1j * angles)[:, None]
    towards = (pitch - pins) / np.abs(pitch - pins)
    return (pins.conjugate() * towards).imag


def test_lever_arms_of_the_pairs_are_those_through_the_pitch_point(unmodified):
    angles = np.linspace(0.0, 6.0, 31)
    motion = ContactGeometry.of_drive(unmodified).flank(angles, np.zeros((31, 4)))
    # the outward normal of the disc at a root points away from the pitch point: only the size has to agree
    np.testing.assert_allclose(
        np.abs(motion.gradient[..., WHEEL_ANGLE]), np.abs(lever_arms(unmodified, angles)), atol=1e-10
    )
    # disc and wheel levers differ by e/(e z_P) of it: e z_C about the disc centre for e z_P about the wheel's
    np.testing.assert_allclose(
        motion.gradient[..., DISC_ROTATION] / 13.0, -motion.gradient[..., WHEEL_ANGLE] / 14.0, atol=1e-11
    )
