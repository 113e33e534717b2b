"""Closed forms of the unmodified cycloid: the pitch point, and the load sharing of equal linear springs."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import carrying_pins
from ltca.geometry.pairs import ContactGeometry


@pytest.fixture(scope="module")
def unmodified(vary):
    return vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0})


def test_contact_normals_meet_in_the_pitch_point(unmodified):
    """On the eccentricity line, e z_P from the crank axis (centre of the wheel), on the eccentric side.

    There the disc (translating at e φ̇) and the wheel (turning at φ̇/z_P) have the same velocity, so contact
    normals of conjugate profiles pass through it.
    """
    geometry = ContactGeometry.of_drive(unmodified)
    angles = np.random.default_rng(1).uniform(-30.0, 30.0, 50)
    motion = geometry.flank(angles, np.zeros((50, 4)))
    e, z = unmodified.crank.eccentricity, unmodified.pin_wheel.number_of_pins
    pitch_point = e * z * np.exp(1j * angles)[:, None]
    disc = e * np.exp(1j * angles)[:, None]
    contact = disc + geometry.profile.flank(motion.parameter)
    normal = geometry.profile.normal(motion.parameter)
    miss = (normal.conjugate() * (pitch_point - contact)).imag
    # round-off of sums of 88 mm with arguments z_P θ up to 60 rad
    np.testing.assert_allclose(miss, 0.0, atol=1e-11)
    # the point on the other side of the crank is missed by the lever arm, tens of mm
    assert np.max(np.abs((normal.conjugate() * (-pitch_point - contact)).imag)) > 30.0


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


def test_sum_of_squared_lever_arms_of_loaded_pins(unmodified):
    """Disc centre held, equal linear springs, no offsets: z_P (e z_P)²/4 in the mean over the mesh.

    ∮ (p R sin β)²/(R² + p² − 2 p R cos β) dβ/2π = p²/2 for p < R, and half the pins carry.
    """
    angles = np.linspace(0.0, 2.0 * np.pi / 13.0, 64, endpoint=False)
    geometry = ContactGeometry.of_drive(unmodified)
    lever = geometry.flank(angles, np.zeros((64, 4))).gradient[..., WHEEL_ANGLE]
    loaded = carrying_pins(geometry, angles)
    total = np.where(loaded, lever**2, 0.0).sum(axis=1)
    # forward and backward pins swap at −φ, so the mean is half of a smooth periodic sum: round-off
    assert total.mean() == pytest.approx(14 * (4.0 * 14) ** 2 / 4.0, rel=1e-10)
    assert np.ptp(total) > 1.0  # and it does swing: the mean is a mean


def test_largest_pin_load_of_linear_springs(unmodified):
    """F = k l α, T = k α Σ l²: the largest load averages 0.992 × 4T/(e z_P²) over the mesh of the paper's drive."""
    angles = np.linspace(0.0, 2.0 * np.pi / 13.0, 2000, endpoint=False)
    geometry = ContactGeometry.of_drive(unmodified)
    lever = -geometry.flank(angles, np.zeros((2000, 4))).gradient[..., WHEEL_ANGLE]
    carried = np.where(carrying_pins(geometry, angles), lever, 0.0)
    largest = carried.max(axis=1) / (carried**2).sum(axis=1)
    # the figure is printed with three digits
    assert largest.mean() / (4.0 / (4.0 * 14**2)) == pytest.approx(0.992, abs=0.0005)
