"""Spectra of single forces against the balance of a disc, a Fourier transform over the whole period, and a made-up force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.force_orders import BEARING_TANGENTIAL, WHEEL_PIN, ForceFit, single_forces
from ltca.drive.members.temperatures import warm_drive
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.drive_file import load_drive

PAPER = warm_drive(load_drive("paper").cases["CS-1"])
PINS = PAPER.pin_wheel.number_of_pins
PERIOD = 60
"""Positions of a turn: with 13 lobes and 14 pins a pin meets its load after 14/13 of a turn, all motions but the rollers' end
after 14 turns.
"""


@pytest.fixture(scope="module")
def walked():
    """Angles, forces, and loads of all pins over the 14 turns after which pins and lobes stand as before."""
    angle = 2.0 * np.pi * np.arange(PINS * PERIOD) / PERIOD
    model = replace(HalfSpace().prepare(PAPER).model, friction=None)
    found = solve_at_output(model, [PAPER], angle, PAPER.load.torque)
    return angle, single_forces(model, angle, found.pose, found.response), found.response.pin_load


def spectrum(angle, kind, force):
    """Spectra of the forces of one kind."""
    fit = ForceFit(PAPER, angle)
    fit.add(angle, {kind: force})
    (found,) = fit.solve()
    return found


def test_orders_of_a_known_force():
    """A force of stated orders, of its passage and of holes that pass seen through it, is told by its amplitudes and phases, to
    round-off of the fit, and stands in its own part.
    """
    angle = 2.0 * np.pi * np.arange(8 * 60) / 60
    passage = PAPER.disc.number_of_teeth / PINS
    force = np.zeros((angle.size, 1, PINS))
    force[:, 0, 3] = 5.0 + 3.0 * np.cos(passage * angle - 0.3) + 0.7 * np.sin(4.0 * passage * angle)
    force[:, 0, 3] += 0.2 * np.cos((PAPER.number_of_holes - 2.0 * passage) * angle)
    found = spectrum(angle, WHEEL_PIN, force)
    assert found.mean[0, 3] == pytest.approx(5.0, rel=1e-9)
    stated = {passage: 3.0 * np.exp(-0.3j), 4.0 * passage: -0.7j, PAPER.number_of_holes - 2.0 * passage: 0.2}
    expected = np.zeros(found.orders.size, dtype=complex)
    for order, amplitude in stated.items():
        place = int(np.argmin(np.abs(found.orders - order)))
        assert found.orders[place] == pytest.approx(order, rel=1e-12)
        expected[place] = amplitude
    np.testing.assert_allclose(found.amplitude[:, 0, 3], expected, rtol=0.0, atol=1e-9)
    assert found.rest[0, 3] < 1e-6
    assert found.strongest == (0, 3)
    assert found.name(found.strongest) == "wheel pin 3 on disc 0"
    others = np.delete(np.abs(found.amplitude[:, 0]), 3, axis=1)
    assert others.max() == 0.0


def test_orders_that_the_turns_do_not_tell_apart_are_left_out():
    """Lines are one by the number of turns away from each other at least, and the more turns the more lines."""
    counts = []
    for turns in (4, 14):
        angle = 2.0 * np.pi * np.arange(turns * 60) / 60
        orders = spectrum(angle, WHEEL_PIN, np.zeros((angle.size, 1, PINS))).orders
        assert np.min(np.diff(orders)) >= (1.0 - 1e-6) / turns
        assert orders[-1] <= 30.0
        counts.append(orders.size)
    assert counts[1] > 1.5 * counts[0]


def test_pin_carries_its_share_of_all_pins(walked):
    """Pins without errors meet the same loads one after the other: the mean of one is that of all of them. Rollers that pass do
    not close in this period: the mean of their ripple (a thirteenth of the mean load) over 14 turns is less than a thousandth.
    """
    angle, forces, loads = walked
    found = spectrum(angle, WHEEL_PIN, forces[WHEEL_PIN])
    assert found.passage == pytest.approx(13 / 14, rel=1e-12)
    assert found.mean[0, 0] == pytest.approx(loads[:, :PINS].mean(), rel=1e-3)


def test_orders_are_those_of_a_fourier_transform_over_the_period(walked):
    """Over the whole period multiples of the passage and of what passes beside it but rollers are whole waves: least squares
    leaves nothing of them, so that a transform tells them of the force less the other orders.
    """
    angle, forces, _ = walked
    found, force = spectrum(angle, WHEEL_PIN, forces[WHEEL_PIN]), forces[WHEEL_PIN][:, 0, 0]
    places = found.orders * PINS
    whole = np.abs(places - np.round(places)) < 1e-6
    assert 30 < np.count_nonzero(whole) < whole.size
    beside = np.exp(1j * np.multiply.outer(angle, found.orders[~whole])) @ found.amplitude[~whole, 0, 0]
    waves = 2.0 * np.abs(np.fft.rfft(force - beside.real)) / angle.size
    got = np.abs(found.amplitude[whole, 0, 0])
    np.testing.assert_allclose(got, waves[np.round(places[whole]).astype(int)], rtol=0.0, atol=1e-9 * got.max())


def test_mean_tangential_force_turns_the_crank(walked):
    """Virtual work over whole turns: the moment e F_t of the bearing is that of the wheel by the ratio u, disc by disc; rollers
    that the period does not close leave less than a thousandth of it.
    """
    angle, forces, _ = walked
    found = spectrum(angle, BEARING_TANGENTIAL, forces[BEARING_TANGENTIAL])
    moment = abs(float(found.mean[0, 0])) * PAPER.crank.eccentricity * PAPER.disc.number_of_discs
    assert moment == pytest.approx(PAPER.load.torque / abs(PAPER.reduction_ratio), rel=1e-3)
