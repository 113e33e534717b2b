"""Rigid gaps of the drive against independent geometry, and the contacts to grade for."""

import numpy as np
import pytest

from fem.drive.expected_contacts import expect_contacts
from fem.drive.grading import grade_contacts, measure_gaps
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.reading.drive_file import load_drive


@pytest.fixture(scope="module")
def drive():
    return load_drive("paper").cases["CS-4"]


def test_nominal_gaps(drive):
    gaps = measure_gaps(drive, 0.4, 0j, 0.0, 0.0)
    # Tip, root and flank of the modified profile: 0.060 to 0.081 mm (notes on the paper).
    assert gaps.pins.min() > 0.059
    assert gaps.pins.max() < 0.082
    np.testing.assert_allclose(gaps.rollers, 0.015, atol=1e-12)
    np.testing.assert_allclose(gaps.holes, 0.01, atol=1e-12)


def test_gaps_at_a_pose_by_sampling(drive):
    """The nearest of many flank points, bore and hole distances by hand."""
    displacement, rotation, wheel = 0.012 - 0.02j, -4e-4, -2e-3
    gaps = measure_gaps(drive, 0.7, displacement, rotation, wheel)
    place, profile = Placement.of_drive(drive), FlankProfile.of_drive(drive)
    centre = 4.0 * np.exp(0.7j) + displacement
    flank = centre + profile.flank(np.linspace(0.0, 2.0 * np.pi, 400_001)) * np.exp(1j * rotation)
    for index in (0, 3, 9):
        pin = place.wheel_pin_centres[index] * np.exp(1j * (0.7 / 14.0 + wheel))
        assert gaps.pins[index] == pytest.approx(np.abs(flank - pin).min() - 6.5, abs=1e-6)
    ray = np.exp(1j * place.roller_angles(np.asarray(0.7)))
    for index in (1, 6):
        distances = np.linspace(24.4, 24.6, 200_001)
        touches = np.abs(distances * ray[index] - displacement) - (place.bore_radius - 5.0)
        assert gaps.rollers[index] == pytest.approx(distances[np.argmin(np.abs(touches))] - 24.5, abs=2e-6)
    hole = centre + 56.0 * np.exp(2j * np.pi * 3 / 8 + 1j * rotation)
    pin = 56.0 * np.exp(2j * np.pi * 3 / 8)
    assert gaps.holes[3] == pytest.approx(drive.hole_radius - 10.075 - abs(hole - pin), abs=1e-12)


def test_candidates_and_their_half_widths(drive):
    guess = expect_contacts(drive, 0.7)
    loads = (guess.pins.load, guess.rollers_outer.load, guess.holes.load)
    pose = (complex(guess.disc_x, guess.disc_y), guess.disc_rotation, guess.wheel_angle)
    graded = grade_contacts(drive, 0.7, *pose, loads, margin=0.0, smallest_share=0.05)
    loaded = guess.pins.load > 0.05 * guess.pins.load.max()
    np.testing.assert_allclose(graded.pins.half_width[loaded], guess.pins.half_width[loaded], rtol=1e-9)
    assert np.all((graded.pins.half_width > 0.0) == (guess.pins.load > 0.0))
    wide = grade_contacts(drive, 0.7, *pose, loads, margin=10.0, smallest_share=0.05)
    assert np.all(wide.pins.half_width > 0.0)
    assert np.all(wide.rollers_inner.half_width > 0.0)
    # The guess puts the bore contact on the cage ray; seen from the bore's own centre it is off by the displacement.
    off = np.abs(graded.bore_points - guess.bore_points)
    assert off.max() < 1.3 * abs(pose[0])
    np.testing.assert_allclose(np.abs(graded.bore_points), drive.bore_radius, rtol=1e-12)
    soft = grade_contacts(drive, 0.7, *pose, loads, margin=0.0, smallest_share=0.05, elastic_shaft_pins=True)
    on = guess.holes.load > 0.0
    np.testing.assert_allclose(soft.holes.half_width[on] / graded.holes.half_width[on], np.sqrt(2.0), rtol=1e-12)
