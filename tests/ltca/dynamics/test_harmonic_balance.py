"""Hill's equation against its continued fraction, direct integration in time, and Floquet's multipliers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_is
from scipy.integrate import solve_ivp

from ltca.dynamics.harmonic_balance import HillSystem, PulsatingStiffness, unstable_ranges
from ltca.errors import ConvergenceError

POSITIONS = 64
ANGLE = 2.0 * np.pi * np.arange(POSITIONS) / POSITIONS
ORDERS = np.arange(1.0, POSITIONS // 2)


def system_of(over_turn, damping_ratio=0.05, mass=None, spin=None):
    """Masses of 1 t on a pulsating stiffness, damped by the diagonal of its mean."""
    size = over_turn.shape[1]
    mean = over_turn.mean(axis=0)
    mass = np.eye(size) if mass is None else mass
    return HillSystem(
        mass=mass,
        damping=2.0 * damping_ratio * np.diag(np.sqrt(np.diag(mean) * np.diag(mass))),
        spin=np.zeros((size, size)) if spin is None else spin,
        loss_factor=0.0,
        stiffness=PulsatingStiffness(over_turn=over_turn),
        basis=np.eye(size),
        steady=np.eye(size),
    )


def mathieu(depth, order=1):
    """1 + depth·cos(order·φ) of one coordinate."""
    return (1.0 + depth * np.cos(order * ANGLE))[:, None, None]


def in_time(system, speed, stiffness, force, turns):
    """Motion after some turns from rest, at the positions of one turn, of a system without spin."""
    size, inverse = system.mass.shape[0], np.linalg.inv(system.mass)

    def rates(time, state):
        angle = speed * time
        moved, moving = state[:size], state[size:]
        return np.concatenate((moving, inverse @ (force(angle) - system.damping @ moving - stiffness(angle) @ moved)))

    times = (2.0 * np.pi * turns + ANGLE) / speed
    found = solve_ivp(rates, (0.0, times[-1]), np.zeros(2 * size), t_eval=times, rtol=1e-9, atol=1e-12, method="DOP853")
    return found.y[:size].T


def at_positions(answer):
    waves = np.exp(1j * np.multiply.outer(ANGLE, ORDERS))
    return answer[0].real + (waves @ answer[1:]).real


@pytest.mark.parametrize("speed", [0.05, 0.3, 0.7])
def test_a_steady_force_on_mathieus_spring_is_a_continued_fraction(speed):
    """Orders couple to their neighbours alone: c₁/c₀ = −(ε/2)/(Z₁ − (ε/2)²/(Z₂ − …))."""
    depth, damping = 0.4, 0.05
    force = np.zeros((ORDERS.size + 1, 1), dtype=complex)
    force[0] = 1.0
    found = system_of(mathieu(depth), damping).respond(speed, ORDERS, force)[:, 0]
    fraction = 0j
    for order in range(60, 0, -1):
        own = 1.0 - (order * speed) ** 2 + 2j * damping * order * speed
        fraction = 0.5 * depth / (own - 0.5 * depth * fraction)
    # c₀ + ε/2 (c₁ + c̄₁) = 1 with c₁ = −fraction c₀; amplitudes are 2 c. The balance leaves 1e-9 of the force.
    mean = 1.0 / (1.0 - depth * fraction.real)
    assert found[0].real == pytest.approx(mean, rel=1e-7)
    assert found[1] == pytest.approx(-2.0 * fraction * mean, rel=1e-7)


@pytest.mark.slow
def test_two_coupled_masses_follow_direct_integration():
    """Both directions pulse, coupled, with an inertia that couples them, under a force of two orders."""

    def stiffness(angle):
        return np.array(
            [
                [1.0 + 0.3 * np.cos(angle), 0.2 * np.sin(2.0 * angle)],
                [0.2 * np.sin(2.0 * angle), 5.0 + 1.5 * np.cos(3.0 * angle + 0.4)],
            ]
        )

    def force(angle):
        return np.array([0.3 + np.cos(angle + 0.2), 2.0 * np.cos(4.0 * angle)])

    system = system_of(np.array([stiffness(angle) for angle in ANGLE]), mass=np.array([[1.0, 0.1], [0.1, 0.5]]))
    amplitudes = np.zeros((ORDERS.size + 1, 2), dtype=complex)
    amplitudes[0, 0], amplitudes[1, 0], amplitudes[4, 1] = 0.3, np.exp(0.2j), 2.0
    speed = 0.55
    found = at_positions(system.respond(speed, ORDERS, amplitudes))
    expected = in_time(system, speed, stiffness, force, turns=40)  # e^(−0.05·457): the start is 1e-10
    assert np.max(np.abs(found - expected)) < 1e-6 * np.max(np.abs(expected))  # asked for: 1e-3
    # The mean stiffness alone is far off, so that the pulsation is what was checked.
    mean = at_positions(system.respond(speed, ORDERS, amplitudes, pulsates=False))
    assert np.max(np.abs(mean - expected)) > 0.1 * np.max(np.abs(expected))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize(("depth", "speed", "order"), [(0.6, 0.02, 20), (0.6, 0.02, 50)])
def test_a_spring_that_pulses_slowly_follows_direct_integration(depth, speed, order):
    """The mass swings 50 times while its spring pulses once, by 60 %: an iteration about the mean spring stalls there."""
    angle, damping = 2.0 * np.pi * np.arange(256) / 256, 0.03
    system = system_of((1.0 + depth * np.cos(angle))[:, None, None], damping)
    orders, force = np.arange(1.0, 128.0), np.zeros((128, 1), dtype=complex)
    force[order] = 1.0
    found = system.respond(speed, orders, force)[:, 0]

    def rates(time, state):
        pushed = np.cos(order * speed * time) - (1.0 + depth * np.cos(speed * time)) * state[0]
        return np.array([state[1], pushed - 2.0 * damping * state[1]])

    times = (2.0 * np.pi * 3.0 + angle) / speed  # e^(−0.03·942): the start is 1e-12
    expected = solve_ivp(rates, (0.0, times[-1]), np.zeros(2), t_eval=times, rtol=1e-9, atol=1e-12, method="DOP853").y[
        0
    ]
    got = found[0].real + (np.exp(1j * np.multiply.outer(angle, orders)) @ found[1:]).real
    # The spring is 1.6 at most: √1.6 swings 63 times a turn, and orders from 128 on are cut off.
    assert np.max(np.abs(got - expected)) < 1e-6 * np.max(np.abs(expected))


def test_a_constant_stiffness_answers_order_by_order():
    """All but no pulsation goes through the balance, none through the mean: both are one to what GMRES leaves."""
    stiffness = np.array([[2.0, 0.3], [0.3, 1.0]])
    spin = np.array([[0.0, -1.0], [1.0, 0.0]])
    rng = np.random.default_rng(4)
    force = rng.normal(size=(ORDERS.size + 1, 2)) + 1j * rng.normal(size=(ORDERS.size + 1, 2))
    force[0] = force[0].real
    over_turn = np.broadcast_to(stiffness, (POSITIONS, 2, 2)).copy()
    exact = system_of(over_turn, spin=spin).respond(0.3, ORDERS, force)
    over_turn[0, 0, 0] += 1e-14
    assert system_of(over_turn, spin=spin).respond(0.3, ORDERS, force) == pytest.approx(exact, rel=1e-7, abs=1e-8)
    rates = 0.3 * (1j * 5.0 * np.eye(2) + spin)
    own = rates @ rates + 0.3 * 5j * system_of(over_turn).damping + stiffness
    assert exact[5] == pytest.approx(np.linalg.solve(own, force[5]), rel=1e-12)


def multiplier(stiffness, mass, damping, speed):
    """Largest of Floquet's multipliers of one turn."""
    size = mass.shape[0]

    def rates(time, state):
        values = state.reshape(2 * size, -1)
        pushed = -damping @ values[size:] - stiffness(speed * time) @ values[:size]
        return np.concatenate((values[size:], np.linalg.solve(mass, pushed))).ravel()

    found = solve_ivp(rates, (0.0, 2.0 * np.pi / speed), np.eye(2 * size).ravel(), rtol=1e-9, atol=1e-12)
    return float(np.max(np.abs(np.linalg.eigvals(found.y[:, -1].reshape(2 * size, -1)))))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("pair", [(0, 0), (0, 1), (1, 1)])
def test_unstable_ranges_end_where_floquets_multipliers_pass_one(pair):
    """To first order: the ends are off by the square of the pulsation, 1 % of it here."""
    ratio, frequency = 0.01, np.array([1.0, 1.7])
    couple = np.array([[0.0, 0.12], [0.12, 0.0]]) if pair == (0, 1) else np.diag([0.1, 0.1 * 1.7**2])
    constant, damping = np.diag(frequency**2), np.diag(2.0 * ratio * frequency)

    def stiffness(angle):
        return constant + couple * np.cos(3.0 * angle)

    over_turn = np.array([stiffness(angle) for angle in ANGLE])
    ranges = unstable_ranges(PulsatingStiffness(over_turn=over_turn), frequency, np.eye(2), ratio, 10.0)
    one = next(each for each in ranges if each.modes == pair)
    assert one.order == 3
    wide = one.fastest - one.slowest
    for end, inside in ((one.slowest, 1.0), (one.fastest, -1.0)):
        assert multiplier(stiffness, np.eye(2), damping, end + 0.2 * inside * wide) > 1.0
        assert multiplier(stiffness, np.eye(2), damping, end - 0.2 * inside * wide) < 1.0


def test_damping_of_a_quarter_of_the_depth_ends_the_resonance():
    """Mathieu's equation with damping: ε > 4ζ."""
    one = np.ones((1, 1))
    for depth, unstable in ((0.079, False), (0.081, True)):
        stiffness = PulsatingStiffness(over_turn=mathieu(depth, order=2))
        assert bool(unstable_ranges(stiffness, np.ones(1), one, 0.02, 10.0)) == unstable


def test_a_balance_that_does_not_converge_is_told(monkeypatch):
    monkeypatch.setattr("ltca.dynamics.harmonic_balance.DIRECTIONS", 1)  # twice
    force = np.ones((ORDERS.size + 1, 1), dtype=complex)
    with error_is(ConvergenceError, "no periodic motion found at 0.31 rad/s of the crank"):
        system_of(mathieu(0.8)).respond(0.31, ORDERS, force)


def test_a_lossy_spring_takes_power():
    """One mass on k (1 + iη): x/F = 1/(k (1 + iη) − m ω² + i ω c), which lags behind the force; at order 0 it is 1/k."""
    stiffness, loss, speed = 3.0, 0.2, 0.7
    system = replace(system_of(np.full((POSITIONS, 1, 1), stiffness), damping_ratio=0.03), loss_factor=loss)
    orders = np.array([0.0, 1.0, 2.0, 5.0])
    found = system.compliance(speed, orders)[:, 0, 0]
    omega = speed * orders[1:]
    damped = 1j * omega * 2.0 * 0.03 * np.sqrt(stiffness)
    np.testing.assert_allclose(found[1:], 1.0 / (stiffness * (1.0 + 1j * loss) - omega**2 + damped), rtol=1e-12)
    assert found[0] == pytest.approx(1.0 / stiffness, rel=1e-12)
