"""Torque against wind-up: a spring system with a closed form, rigid play, and the balance of single torques."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from ltca.analysis.engines import Hybrid
from ltca.analysis.torque_curve import LEAST_TORQUE_RATIO, LOST_MOTION, STIFF_FROM, torque_curve
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import free_play
from ltca.reading.changes import with_fields
from ltca.testing.closed_form_bodies import without_coupling

ANGLES = np.array([0.1, 0.35])


class Prepared:
    """An engine with one model, whatever the drive."""

    def __init__(self, model):
        self.model = model

    def prepare(self, drive):
        return self


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsWithPlay(Reducer):
    """The wheel on two springs, one for each sense, with play between them; the disc on springs of its own."""

    ccw: float
    clockwise: float
    play: float

    def evaluate(self, crank_angle, pose, start=None, **how):
        found = Reducer.evaluate(self, crank_angle, pose, start, **how)
        wheel = pose[:, WHEEL_ANGLE]
        beyond = np.sign(wheel) * np.maximum(np.abs(wheel) - 0.5 * self.play, 0.0)
        stiffness = np.where(wheel > 0.0, self.ccw, self.clockwise)
        force = 1e5 * pose
        force[:, WHEEL_ANGLE] = stiffness * beyond
        tangent = np.tile(1e5 * np.eye(4), (len(pose), 1, 1))
        tangent[:, WHEEL_ANGLE, WHEEL_ANGLE] = np.where(beyond == 0.0, 0.0, stiffness)
        held = np.einsum("bii->bi", tangent)
        return replace(found, force=force, tangent=tangent, contact_stiffness=held, left=np.zeros(len(pose)))


def test_springs_with_play(paper_cases):
    """θ = ±(play/2 + |T|/k): every figure of the curve in closed form, the two senses apart."""
    drive = paper_cases["CS-1"]
    rated, ccw, clockwise, play = 377_300.0, 6e8, 4e8, 3e-3
    discs = (HalfSpaceCompliance.of_drive(drive),)
    springs = SpringsWithPlay(discs=discs, ccw=ccw, clockwise=clockwise, play=play)
    found = torque_curve(drive, ANGLES, points=2, engine=Prepared(springs))
    expected = np.where(found.torque > 0.0, 0.5 * play + found.torque / ccw, -0.5 * play + found.torque / clockwise)
    # the balance closes to 1e-9 of the load: 1e-12 rad here
    np.testing.assert_allclose(found.wheel_angle, np.tile(expected, (2, 1)), rtol=0.0, atol=1e-11)
    both = rated * (1.0 / ccw + 1.0 / clockwise)
    geometry = ContactGeometry.of_drive(drive)
    np.testing.assert_array_equal(
        found.backlash, free_play([geometry], ANGLES).play
    )  # of the parts, whatever springs there are
    np.testing.assert_allclose(found.lost_motion, play + 0.03 * both, rtol=1e-8)
    np.testing.assert_allclose(found.stiffness, [[clockwise, ccw]] * 2, rtol=1e-7)
    assert np.all(np.diff(found.torque) > 0.0)
    np.testing.assert_allclose(found.torque, -found.torque[::-1], rtol=1e-15)
    for part in (1e-4, 0.03, 0.5, 1.0):  # what is read off is solved for, not read beside
        assert np.min(np.abs(found.torque - part * rated)) < 1e-9 * rated
    np.testing.assert_array_equal(found.crank_angle, ANGLES)


@pytest.mark.slow
def test_figures_are_those_of_single_torques(paper_cases):
    """Lost motion and stiffness against balances found one torque at a time, away from any curve."""
    drive = paper_cases["CS-3"]
    model = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),))
    found = torque_curve(drive, ANGLES, points=3)

    def wheel(part):
        return solve_equilibrium(model, ANGLES, part * 377_300.0).pose[:, WHEEL_ANGLE]

    # both end at 1e-9 of the load over the stiffness, 1e-12 rad; wind-up from half to full load is 2e-4 rad
    np.testing.assert_allclose(found.lost_motion, wheel(0.03) - wheel(-0.03), rtol=1e-8)
    clockwise, ccw = 0.5 * 377_300.0 / (wheel(-0.5) - wheel(-1.0)), 0.5 * 377_300.0 / (wheel(1.0) - wheel(0.5))
    np.testing.assert_allclose(found.stiffness, np.stack([clockwise, ccw], axis=1), rtol=1e-7)


@pytest.mark.slow
def test_stiffness_is_that_of_the_whole_drive(paper_cases):
    """Each of two equal discs half a turn apart carries half: dT/dφ is that of one disc twice, by two separate balances.

    At twice the torque each disc does what one disc alone did: the same wind-up, twice the stiffness, play unchanged.
    """
    one = paper_cases["CS-3"]
    two = with_fields(one, {"disc.number_of_discs": 2})
    found = torque_curve(two, ANGLES, points=2)
    model = Reducer(discs=(HalfSpaceCompliance.of_drive(one),))
    half, full = (solve_equilibrium(model, ANGLES, 0.5 * part * 377_300.0).pose[:, WHEEL_ANGLE] for part in (0.5, 1.0))
    # balanced to 1e-9 of the load over the stiffness, 1e-12 rad of 1e-4 rad
    np.testing.assert_allclose(found.stiffness[:, 1], 0.5 * 377_300.0 / (full - half), rtol=1e-7)
    assert found.torque[-1] == pytest.approx(377_300.0)
    heavy = torque_curve(with_fields(two, {"load.torque": 754_600.0}), ANGLES, points=2)
    alone = torque_curve(one, ANGLES, points=2)
    np.testing.assert_allclose(heavy.wheel_angle, alone.wheel_angle, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(heavy.stiffness, 2.0 * alone.stiffness, rtol=1e-7)
    np.testing.assert_allclose(heavy.torque, 2.0 * alone.torque, rtol=1e-14)


@pytest.mark.slow
def test_compliance_is_passed_on(paper_cases):
    """Hybrid without coupling is the half-space; bodies that yield make the drive softer."""
    drive = paper_cases["CS-3"]
    plain = torque_curve(drive, ANGLES[:1], points=2)
    nothing = without_coupling(drive)
    alone = torque_curve(drive, ANGLES[:1], points=2, engine=Hybrid(coefficients=nothing, hole_near_field=False))
    np.testing.assert_allclose(alone.wheel_angle, plain.wheel_angle, rtol=0.0, atol=1e-11)
    walls = torque_curve(drive, ANGLES[:1], points=2, engine=Hybrid(coefficients=nothing))
    assert np.all(walls.stiffness < plain.stiffness)


@pytest.mark.slow
def test_backlash_is_the_play_of_rigid_parts(paper_cases):
    """A linear programme over the gaps knows nothing of loads; 1e-4 of the torque winds the drive up by 3e-7 rad."""
    drive = paper_cases["CS-6"]
    found = torque_curve(drive, ANGLES, points=2)
    np.testing.assert_array_equal(found.backlash, free_play([ContactGeometry.of_drive(drive)], ANGLES).play)
    smallest = np.argsort(np.abs(found.torque))[:2]
    branches = np.abs(np.diff(found.output_angle[:, smallest]))[:, 0]
    assert np.all(branches > found.backlash)
    np.testing.assert_allclose(branches, found.backlash, atol=1e-6)


def test_parts_of_the_rated_torque():
    """Makers of precision reducers read lost motion at ±3 %; stiffness is the slope over the upper half."""
    assert (LOST_MOTION, STIFF_FROM) == (0.03, 0.5)
    assert LEAST_TORQUE_RATIO <= 1e-3


@pytest.mark.slow
def test_both_senses_mirror_each_other(paper_cases):
    """At φ_C = 0 the drive, rollers included, is its own mirror image."""
    found = torque_curve(paper_cases["CS-6"], np.array([0.0]), points=4)
    # 1e-9 of the load over the stiffness is 1e-12 rad, of 1e-4 rad between half and full load
    np.testing.assert_allclose(found.wheel_angle[0], -found.wheel_angle[0, ::-1], rtol=0.0, atol=1e-11)
    assert found.stiffness[0, 0] == pytest.approx(found.stiffness[0, 1], rel=1e-6)
