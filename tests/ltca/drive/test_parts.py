"""The drive's own quantities and its identity."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import pytest

from ltca.drive.parts import LengthProfile, Material, contact_modulus


def test_paper_drive(paper_cases):
    drive = paper_cases["CS-1"]
    assert drive.reduction_ratio == 14.0
    assert drive.tooth_number_difference == 1
    assert drive.wheel_moment() == -377_300.0
    assert drive.wheel_moment(10.0) == -10.0
    clearances = [(d.clearance.bearing, d.clearance.pin_hole) for d in paper_cases.values()]
    # Table 2 of the paper
    assert clearances == [(0.0, 0.0), (0.01, 0.0), (0.03, 0.0), (0.03, 0.01), (0.03, 0.02), (0.03, 0.03)]


def test_load_opposes_the_crank_and_is_shared(vary):
    assert vary(load={"direction": "cw"}).wheel_moment() == 377_300.0
    assert vary(disc={"number_of_discs": 2}).wheel_moment() == -188_650.0
    assert vary(disc={"number_of_discs": 3, "torque_share": 0.4}).wheel_moment(1000.0) == -400.0


def test_contact_modulus_of_steel_on_steel():
    steel = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
    # Johnson (4.18): 206000/(2·0.91)
    assert contact_modulus(steel, steel) == pytest.approx(113_186.813, rel=1e-8)
    rigid = Material(youngs_modulus=1e15, poisson_ratio=0.0)
    assert contact_modulus(steel, rigid) == pytest.approx(206_000.0 / 0.91, rel=1e-8)


def test_frozen_and_fingerprinted(vary):
    drive = vary()
    with pytest.raises(FrozenInstanceError):
        drive.crank.eccentricity = 3.0
    assert drive.fingerprint() == vary().fingerprint()
    assert drive.fingerprint() != vary(clearance={"bearing": 1e-6}).fingerprint()
    assert drive.fingerprint() != vary(materials={"roller": {"youngs_modulus": 205_999.0}}).fingerprint()


def test_length_profile_of_a_cylinder():
    assert LengthProfile().is_cylinder
    assert LengthProfile(end_relief_length=1.0).is_cylinder  # without depth it relieves nothing
    for profile in (
        LengthProfile(crown_drop=1e-3),
        LengthProfile(logarithmic_factor=1.0),
        LengthProfile(end_relief_length=1.0, end_relief_depth=1e-3),
    ):
        assert not profile.is_cylinder
