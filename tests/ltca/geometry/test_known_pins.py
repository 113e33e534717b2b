"""Pins whose contacts are followed from another pose touch where they do when they are looked for anew."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from ltca.geometry.pair_motion import KnownPins
from ltca.geometry.pairs import ContactGeometry

ROUND_OFF = 1e-10
"""Of places relative to their size: places on the flank are found to 1e-13 rad from wherever they start, and curvatures,
second derivatives by them, magnify that by the square of the tooth number."""


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("size", [1e-5, 3e-4, 3e-3])
def test_pins_followed_from_another_pose_are_those_found_anew(paper_cases, random_drives, size):
    random = np.random.default_rng(7)
    for drive in [paper_cases["CS-6"], *random_drives]:
        geometry, angle = ContactGeometry.of_drive(drive), random.uniform(-10.0, 10.0, 40)
        lever = drive.pin_wheel.pin_circle_radius * np.array([1.0, 1.0, 0.0, 0.0]) + np.array([0.0, 0.0, 1.0, 1.0])
        motion = geometry.flank(angle, random.uniform(-size, size, (40, 4)) * lever)
        for _ in range(3):
            pose = random.uniform(-size, size, (40, 4)) * lever
            bent = (random.uniform(-size, size, (40, 2)) * lever[:2]) @ np.array([[1.0], [1j]])
            bent = bent * np.ones(motion.approach.shape[1])
            anew = geometry.flank(angle, pose, shifts=bent)
            known = KnownPins(point=motion.point, turning=motion.turning)
            motion = geometry.flank(angle, pose, motion.parameter, bent, known)
            for item in fields(anew):
                mine, theirs = getattr(motion, item.name), getattr(anew, item.name)
                scale = np.max(np.abs(theirs), initial=1e-3)
                np.testing.assert_allclose(mine, theirs, rtol=0.0, atol=ROUND_OFF * scale, err_msg=item.name)
