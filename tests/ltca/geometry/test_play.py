"""How far the wheel turns while no body gives: every sound drive has an answer, and it is the farthest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from ltca.drive.parts import Clearance, PlacementErrors
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.first_contact import first_contact
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import free_play
from ltca.testing.practical_drives import light_limit, pair_approaches, rigid_poses

CASES = ("CS-1", "CS-2", "CS-3", "CS-4", "CS-5", "CS-6")


def assert_farthest(drive, angles, senses=(1, -1)):
    """No pair interferes, and contact forces balance a torque on the wheel with next to no gap to go for any of them.

    By the duality of linear programmes that is the same as that no movement, however large, turns the wheel on against gaps
    taken as straight (`light_limit`). A programme ends where it promises less than 1e-7 mm of the wheel's way (`GAIN`) in its box
    and with the tangents of earlier poses; here is neither box nor tangent, and the most of all these drives is 3e-8 mm.
    """
    geometry = ContactGeometry.of_drive(drive)
    for sense in senses:
        approach, _ = pair_approaches(geometry, angles, rigid_poses(geometry, angles, sense))
        assert np.max(approach) < 1e-9  # mm; a thousandth of what tells a clearance from none
        limit, free = light_limit(geometry, angles, sense)
        further = sense * (limit - free) * drive.crank.eccentricity * drive.reduction_ratio
        assert np.all(further < 1e-7)


@pytest.mark.parametrize(
    "case", [case if case in ("CS-1", "CS-5") else pytest.param(case, marks=pytest.mark.slow) for case in CASES]
)
def test_poses_of_the_paper_are_the_farthest(paper_cases, case):
    assert_farthest(paper_cases[case], np.linspace(0.0, 6.2, 9))


@pytest.mark.slow
def test_rigid_poses_of_cs3_and_cs5_do_not_interfere(paper_cases):
    """The linear programme kept its bounds to 1e-7 mm only: "parts interfere by 9.67e-08 mm in every rigid pose"."""
    angles = 2.0 * np.pi * np.arange(90) / 90
    for case in ("CS-3", "CS-5"):
        geometry = ContactGeometry.of_drive(paper_cases[case])
        for at, sense in ((angles, 1), (np.append(angles, 4.886921905584122), -1)):
            assert np.max(pair_approaches(geometry, at, rigid_poses(geometry, at, sense))[0]) < 1e-10


def test_a_wide_play_is_walked_to_its_end(vary):
    """Steps were halved after eight rounds whether it was reached or not: what was returned was no farthest pose."""
    drive = vary(disc={"equidistant_offset": 2.0, "shifting_offset": 0.0})
    geometry, angles = ContactGeometry.of_drive(drive), np.array([0.3, 2.0])
    for sense in (1, -1):
        turned = rigid_poses(geometry, angles, sense)[:, WHEEL_ANGLE]
        # Without other clearances the disc stays on its place and the wheel turns to first contact.
        np.testing.assert_allclose(turned, first_contact(geometry, angles, WHEEL_ANGLE, sense)[0], rtol=1e-9)
        assert np.all(np.abs(turned) * 56.0 > 0.8)  # mm; 2e-3 of e z_P a round, eight rounds: 0.9


@pytest.mark.slow
def test_drives_of_other_kinds_have_an_answer(vary, paper_cases):
    """A flank as designed with pins all round, plastic clearances, deviations of every part."""
    angles = np.array([0.1, 1.7, 4.0])
    unmodified = vary(disc={"equidistant_offset": 0.0, "shifting_offset": 0.0})
    assert_farthest(unmodified, angles)
    np.testing.assert_allclose(free_play([ContactGeometry.of_drive(unmodified)], angles).play, 0.0, atol=1e-10)
    bearing = replace(unmodified, clearance=Clearance(bearing=0.05, pin_hole=0.0))
    assert_farthest(bearing, angles)
    plastic = vary(
        disc={"equidistant_offset": 0.5, "shifting_offset": 0.2}, clearance={"bearing": 0.6, "pin_hole": 0.8}
    )
    assert_farthest(plastic, angles)
    rng = np.random.default_rng(4)
    deviated = vary(
        crank={"eccentricity_error": 0.01, "axis_offset": {"x": 0.01, "y": -0.02}},
        pin_wheel={
            "pin_errors": {
                "radial": rng.normal(0.0, 0.01, 14).tolist(),
                "diameter": rng.normal(0.0, 0.01, 14).tolist(),
            },
            "axis_offset": {"x": -0.01, "y": 0.01},
        },
        disc={
            "runout": {"amount": 0.01, "angle": 1.0},
            "profile_errors": {"orders": [3], "cosine": [0.01]},
            "hole_errors": {"tangential": rng.normal(0.0, 0.01, 8).tolist()},
        },
        clearance={"bearing": 0.1, "pin_hole": 0.15},
    )
    assert_farthest(deviated, angles)


@pytest.mark.slow
def test_random_drives_without_preload_have_an_answer(random_drives):
    """Clearances of their own, errors taken out: what is left can be put together without force."""
    for drive in random_drives:
        none = PlacementErrors()
        sound = replace(
            drive,
            pin_wheel=replace(drive.pin_wheel, pin_errors=none),
            disc=replace(drive.disc, hole_errors=none),
            pin_shaft=replace(drive.pin_shaft, pin_errors=none),
            crank_bearing=replace(drive.crank_bearing, roller_errors=type(drive.crank_bearing.roller_errors)()),
        )
        assert_farthest(sound, np.array([0.2, 3.3]))


def test_parts_that_do_not_go_together_are_told(vary):
    """Rollers 2 µm too thick in a bearing without clearance."""
    drive = vary(crank_bearing={"roller_errors": {"diameter": [0.002] * 11}}, clearance={"bearing": 0.0})
    with error_says(ConvergenceError, "parts interfere in every rigid pose at crank angle 0.5 rad, by 0.002") as told:
        rigid_poses(ContactGeometry.of_drive(drive), np.array([0.5]), 1)
    assert told.value.history == pytest.approx([0.002], rel=1e-6)  # by positions
