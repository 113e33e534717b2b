"""The range of effective radii that the table of crowned wheel pins is made for: the actual extremes, from within."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.half_space import SAMPLES_PER_LOBE, _effective_radii
from ltca.drive.single_discs import single_discs
from ltca.geometry.flank import FlankProfile
from ltca.reading.drive_file import parse_drive, shipped_drive


def crowned(eccentricity):
    text = shipped_drive("robot-joint")
    text = text.replace("eccentricity = 1.0 ", f"eccentricity = {eccentricity} ")
    text = text.replace("hole_radius = 6.0 ", f"hole_radius = {5 + eccentricity} ")
    text = text.replace("pin_radius = 2.5 ", "pin_radius = 2.5\npin_profile.crown_drop = 0.001 ")
    return parse_drive(text).cases["nominal"]


@pytest.mark.parametrize(
    "eccentricity", [0.5, 1.4086, *(pytest.param(one, marks=pytest.mark.slow) for one in (1.0, 1.2, 1.35, 1.4))]
)
def test_the_range_of_effective_radii(eccentricity):
    """Where e z/R is 0.8 and more the largest second difference was taken off the smallest radius: −0.86 mm."""
    drive = single_discs(crowned(eccentricity))[0]
    profile, wheel = FlankProfile.of_drive(drive), drive.pin_wheel
    pitch = 2.0 * np.pi / wheel.number_of_pins
    found = _effective_radii(profile, np.array([wheel.pin_radius]), np.linspace(0.0, pitch, SAMPLES_PER_LOBE + 1))
    # A million places of a pitch: the sharpest of these tips is five hundred of them wide.
    all_radii = profile.effective_radius(np.linspace(0.0, pitch, 1_000_001), wheel.pin_radius)
    smallest, largest = all_radii.min(), all_radii.max()
    assert 0.0 < found[0] <= smallest * (1.0 + 1e-9)
    assert found[1] >= largest * (1.0 - 1e-9)
    # Outward by the first look at a lobe's 180 places: 6 % of the radius at a tip next to undercut, 0.05 % usually.
    assert found[0] == pytest.approx(smallest, rel=0.06 if eccentricity > 1.35 else 0.003)
    assert found[1] == pytest.approx(largest, rel=1e-4)


@pytest.mark.slow
@pytest.mark.nightly
def test_crowned_pins_on_sharp_lobes_are_answered():
    """`robot-joint`, eccentricity 1.35, crown 1 µm: "unforeseen ValueError: need 0 < smallest_radius …, got −0.86"."""
    assert analyse(crowned(1.35), np.array([0.3])).is_complete
