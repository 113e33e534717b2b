"""A roller between two laws: against minimum energy found by root finding, and finite differences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.errors import ConvergenceError
from ltca.geometry.pair_motion import RollerRays
from ltca.laws.contact_law import ContactLaw
from ltca.testing.bearing_alone import RollerLaws, bearing_alone, roller_laws


@dataclass(frozen=True)
class PowerLaw(ContactLaw):
    """F = K δⁿ, a law as simple as a bearing book's."""

    factor: float
    exponent: float

    def load_and_stiffness(self, approach, effective_radius):
        pressed = np.maximum(approach, 0.0) + 0.0 * effective_radius
        slope = np.where(
            pressed > 0.0, self.factor * self.exponent * np.maximum(pressed, 1e-300) ** (self.exponent - 1), 0
        )
        return self.factor * pressed**self.exponent, slope

    def energy(self, approach, effective_radius):
        pressed = np.maximum(approach, 0.0) + 0.0 * effective_radius
        return self.factor * pressed ** (self.exponent + 1.0) / (self.exponent + 1.0)


def responded(case, displacement, laws, share=None):
    return bearing_alone(case, displacement.ravel(), laws, share)


def balance_rollers(case, displacement, laws, share=None):
    return responded(case, displacement, laws, share).parts[0].rollers


def power_laws(rollers):
    radius = np.full(rollers, 4.0)
    return RollerLaws(
        inner=PowerLaw(8e5, 10.0 / 9.0), outer=PowerLaw(1.1e6, 1.3), inner_radius=radius, outer_radius=radius
    )


def rays(rng, positions=5, rollers=9, clearance=0.0, roller_errors=0.0):
    angles = rng.uniform(0.0, 2.0 * np.pi, (positions, 1)) + 2.0 * np.pi * np.arange(rollers) / rollers
    radius = 5.0 + roller_errors * rng.uniform(-1.0, 1.0, rollers)
    return RollerRays(direction=np.exp(1j * angles), outermost=19.5 + radius, bore_play=29.5 + 0.5 * clearance - radius)


def total_energy(case, laws, displacement, roller, row, place):
    """U_i + U_o of one roller at the distance `place` on its ray, from plain geometry."""
    centre = place * case.direction[row, roller]
    outer = abs(centre - displacement) - case.bore_play[roller]
    inner = case.outermost[roller] - place
    return float(
        laws.inner.energy(np.array(inner), laws.inner_radius[roller])
        + laws.outer.energy(np.array(outer), laws.outer_radius[roller])
    )


def balanced_by_root_finding(case, laws, displacement, roller, row):
    """Return inner and outer approach and loads of one roller, or None when it is free."""
    n, resting = case.direction[row, roller], case.outermost[roller]

    def outer_approach(place):
        return abs(place * n - displacement) - case.bore_play[roller]

    if outer_approach(resting) <= 0.0:
        return None

    def imbalance(place):
        arm = place * n - displacement
        cosine = (arm / abs(arm) * n.conjugate()).real
        inner = laws.inner.load_and_stiffness(np.array(resting - place), laws.inner_radius[roller])[0]
        outer = laws.outer.load_and_stiffness(np.array(outer_approach(place)), laws.outer_radius[roller])[0]
        return float(inner - outer * cosine)

    place = brentq(imbalance, resting - 2.0 * outer_approach(resting), resting, xtol=1e-15, rtol=1e-15)
    return resting - place, outer_approach(place)


@pytest.fixture(scope="module")
def half_space_laws(paper_cases):
    return roller_laws(HalfSpaceCompliance.of_drive(paper_cases["CS-1"]))


@pytest.mark.parametrize("clearance", [0.0, 0.03])
@pytest.mark.parametrize("law", ["power", "half-space"])
def test_balance_against_root_finding_roller_by_roller(law, clearance, half_space_laws):
    rng = np.random.default_rng(1)
    rollers = 9 if law == "power" else 11
    case = rays(rng, rollers=rollers, clearance=clearance, roller_errors=0.003)
    laws = power_laws(rollers) if law == "power" else half_space_laws
    displacement = 0.04 * (rng.uniform(-1, 1, 5) + 1j * rng.uniform(-1, 1, 5))
    found = balance_rollers(case, displacement[:, None], laws)
    free = 0
    for row in range(5):
        for roller in range(rollers):
            expected = balanced_by_root_finding(case, laws, displacement[row], roller, row)
            if expected is None:
                free += 1
                # a free roller rests on the inner race
                gap = abs(case.outermost[roller] * case.direction[row, roller] - displacement[row])
                assert found.inner_approach[row, roller] == 0.0
                assert found.outer_approach[row, roller] == pytest.approx(gap - case.bore_play[roller], abs=1e-14)
                assert found.inner_load[row, roller] == 0.0
                assert found.outer_load[row, roller] == 0.0
                continue
            # place known to round-off of 24.5 mm
            assert found.inner_approach[row, roller] == pytest.approx(expected[0], abs=2e-14)
            assert found.outer_approach[row, roller] == pytest.approx(expected[1], abs=2e-14)
    assert 0 < free < 5 * rollers


def test_loads_follow_approaches_and_balance_on_the_ray(half_space_laws):
    rng = np.random.default_rng(2)
    case = rays(rng, rollers=11, clearance=0.02)
    displacement = 0.03 * np.exp(1j * rng.uniform(0.0, 6.0, 5))
    found = balance_rollers(case, displacement[:, None], half_space_laws)
    cosine = (found.outer_direction * case.direction.conjugate()).real
    scale = found.outer_load.max()
    # 1e-11 of the share of 20 µm at a stiffness of 1e6 N/mm is 2e-7 N of some thousand
    np.testing.assert_allclose(found.inner_load, found.outer_load * cosine, atol=1e-9 * scale)
    assert np.array_equal(found.outer_load > 0.0, found.outer_approach > 0.0)
    assert np.array_equal(found.inner_load > 0.0, found.inner_approach > 0.0)


def test_balance_is_the_minimum_of_the_energy():
    rng = np.random.default_rng(3)
    case, laws = rays(rng, clearance=0.01), power_laws(9)
    displacement = 0.04 * np.exp(1j * rng.uniform(0.0, 6.0, 5))
    found = balance_rollers(case, displacement[:, None], laws)
    for row, roller in zip(*np.nonzero(found.outer_load > 0.0), strict=True):
        place = case.outermost[roller] - found.inner_approach[row, roller]
        least = total_energy(case, laws, displacement[row], roller, row, place)
        for move in (-1e-5, 1e-5):
            assert total_energy(case, laws, displacement[row], roller, row, place + move) > least


def test_eliminated_energy_its_gradient_and_tangent():
    """Force on the disc = −∂U/∂d with the roller's place following; tangent = ∂²U/∂d², by differences."""
    rng = np.random.default_rng(4)
    case, laws = rays(rng, clearance=0.01), power_laws(9)
    displacement = 0.04 * np.exp(1j * rng.uniform(0.0, 6.0, 5))

    def energy(d):
        state = balance_rollers(case, d[:, None], laws)
        return laws.inner.energy(state.inner_approach, laws.inner_radius) + laws.outer.energy(
            state.outer_approach, laws.outer_radius
        )

    def force(d):
        state = balance_rollers(case, d[:, None], laws)
        return state.outer_load * state.outer_direction

    here = balance_rollers(case, displacement[:, None], laws)
    clear = np.abs(here.outer_approach) > 1e-4  # steps must not cross first contact
    tangent = responded(case, displacement, laws).tangent[:, :2, :2]
    h = 1e-6
    push = force(displacement)
    scale = np.abs(push).max()
    for axis, move in enumerate((h, 1j * h)):
        slope = (energy(displacement + move) - energy(displacement - move)) / (2.0 * h)
        part = push.real if axis == 0 else push.imag
        # h² U‴ ~ (h/δ)² F ~ 1e-8 F; round-off 1e-16 · 24.5 mm · F/h ~ 1e-9 F
        np.testing.assert_allclose(slope[clear], -part[clear], atol=1e-6 * scale)
        bend = -(force(displacement + move) - force(displacement - move)) / (2.0 * h)
        rows = clear.all(axis=1)
        size = np.abs(tangent).max()
        np.testing.assert_allclose(bend.sum(axis=1).real[rows], tangent[rows, 0, axis], atol=1e-6 * size)
        np.testing.assert_allclose(bend.sum(axis=1).imag[rows], tangent[rows, 1, axis], atol=1e-6 * size)
    assert rows.any()


def test_tangent_where_the_normals_differ_much():
    """Rays and outer normals at 20° and more, loads that bend: every term of the eliminated tangent counts."""
    rng = np.random.default_rng(7)
    angles = rng.uniform(0.0, 2.0 * np.pi, (1, 40))
    case = RollerRays(direction=np.exp(1j * angles), outermost=np.full(40, 2.0), bore_play=np.full(40, 1.6))
    law = PowerLaw(50.0, 1.5)
    laws = RollerLaws(inner=law, outer=PowerLaw(80.0, 1.2), inner_radius=np.ones(40), outer_radius=np.ones(40))
    displacement = np.array([0.6 - 0.4j])
    here = balance_rollers(case, displacement[:, None], laws)
    tangent = responded(case, displacement, laws).tangent[0, :2, :2]
    pressed = here.outer_approach > 0.0
    cosine = (here.outer_direction * case.direction.conjugate()).real
    assert np.min(np.abs(here.outer_approach)) > 3e-5  # no step crosses first contact
    assert np.min(cosine[pressed]) < 0.94
    h = 1e-5
    for axis, move in enumerate((h, 1j * h)):
        ahead, behind = (balance_rollers(case, (displacement + sign * move)[:, None], laws) for sign in (1, -1))
        bend = -(ahead.outer_load * ahead.outer_direction - behind.outer_load * behind.outer_direction) / (2.0 * h)
        # h² times third derivatives: (1e-5/0.01)² of some per cent
        np.testing.assert_allclose(
            tangent[0, axis] + 1j * tangent[1, axis], bend.sum(), atol=1e-6 * np.abs(tangent).max()
        )


def test_start_does_not_matter(half_space_laws):
    rng = np.random.default_rng(5)
    case = rays(rng, rollers=11, clearance=0.02)
    displacement = 0.03 * np.exp(1j * rng.uniform(0.0, 6.0, 5))
    plain = balance_rollers(case, displacement[:, None], half_space_laws)
    for start in (np.full((5, 11), 0.02), np.full((5, 11), 0.98), rng.uniform(0.0, 1.0, (5, 11))):
        other = balance_rollers(case, displacement[:, None], half_space_laws, start)
        np.testing.assert_allclose(other.outer_approach, plain.outer_approach, atol=2e-14)


def test_barely_touching_roller_keeps_its_digits():
    """Interference of 1e-12 mm: loads from a difference of places would be noise."""
    case = RollerRays(direction=np.array([[1.0 + 0.0j]]), outermost=np.array([24.5]), bore_play=np.array([24.5]))
    law = PowerLaw(1e6, 1.0)
    laws = RollerLaws(inner=law, outer=law, inner_radius=np.ones(1), outer_radius=np.ones(1))
    found = balance_rollers(case, np.array([-1e-12 + 0j]), laws)
    # the interference itself, 24.5 + 1e-12 − 24.5, is only known to 4e-15
    assert found.outer_load[0, 0] == pytest.approx(0.5e-6, rel=1e-2)
    assert found.inner_load[0, 0] == pytest.approx(found.outer_load[0, 0], rel=1e-9)


def test_law_without_a_number_is_refused():
    class NoNumber(ContactLaw):
        def load_and_stiffness(self, approach, effective_radius):
            return np.full(np.shape(approach), np.nan), np.ones(np.shape(approach))

    case = rays(np.random.default_rng(6))
    laws = RollerLaws(inner=NoNumber(), outer=PowerLaw(1.0, 1.0), inner_radius=np.ones(9), outer_radius=np.ones(9))
    with pytest.raises(ConvergenceError, match="do not settle"):
        balance_rollers(case, np.full((5, 1), 0.03 + 0j), laws)
