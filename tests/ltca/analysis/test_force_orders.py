"""Spectra of single forces against the balance of a disc, a Fourier transform over the whole period, and a made-up force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.analysis.force_orders import force_orders, single_forces
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
    found = solve_at_output(model, [PAPER], angle, PAPER.load.torque, gaps=False)
    return angle, single_forces(model, found), found.response.pin_load


def of(found, name):
    return next(one for one in found if one.name.startswith(name))


def test_orders_of_a_known_force():
    """A force of three stated orders is told by its amplitudes, to round-off of the fit."""
    angle = 2.0 * np.pi * np.arange(8 * 60) / 60
    passage = PAPER.disc.number_of_teeth / PINS
    force = 5.0 + 3.0 * np.cos(passage * angle - 0.3) + 0.7 * np.sin(4.0 * passage * angle)
    (found,) = force_orders(PAPER, angle, {"wheel pin 0 on disc 0": force})
    assert found.mean == pytest.approx(5.0, rel=1e-9)
    expected = np.zeros(found.amplitude.size)
    expected[[0, 3]] = 3.0, 0.7
    np.testing.assert_allclose(found.amplitude, expected, rtol=0.0, atol=1e-9)
    assert found.rest < 1e-6


def test_pin_carries_its_share_of_all_pins(walked):
    """Pins without errors meet the same loads one after the other: the mean of one is that of all of them. Rollers that pass do
    not close in this period: the mean of their ripple (a thirteenth of the mean load) over 14 turns is less than a thousandth.
    """
    angle, forces, loads = walked
    found = of(force_orders(PAPER, angle, forces), "wheel pin")
    assert found.passage == pytest.approx(13 / 14, rel=1e-12)
    assert found.mean == pytest.approx(loads[:, :PINS].mean(), rel=1e-3)


def test_orders_are_those_of_a_fourier_transform_over_the_period(walked):
    """Over the whole period multiples of the passage are whole waves, which a transform tells without any fit."""
    angle, forces, _ = walked
    found = of(force_orders(PAPER, angle, forces), "wheel pin")
    waves = 2.0 * np.abs(np.fft.rfft(forces[found.name])) / angle.size
    places = 13 * np.arange(1, found.amplitude.size + 1)
    np.testing.assert_allclose(found.amplitude, waves[places], rtol=0.0, atol=1e-9 * found.amplitude[0])


def test_mean_tangential_force_turns_the_crank(walked):
    """Virtual work over whole turns: the moment e F_t of the bearing is that of the wheel by the ratio u, disc by disc; rollers
    that the period does not close leave less than a thousandth of it.
    """
    angle, forces, _ = walked
    found = of(force_orders(PAPER, angle, forces), "crank bearing 0 on disc 0, tangential")
    moment = abs(found.mean) * PAPER.crank.eccentricity * PAPER.disc.number_of_discs
    assert moment == pytest.approx(PAPER.load.torque / abs(PAPER.reduction_ratio), rel=1e-3)
