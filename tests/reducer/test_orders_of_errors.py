"""Orders by turn of the output that errors of an RV drive give its transmission error: where bodies turn against each other.

With the housing held, for one turn of the carrier its cranks turn 40 times in it, 39 times against the pins, and the input 81
times (22/44 teeth, 40 pins). Every order below is a combination of those counts; no amplitude is claimed.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.members.temperatures import warm_drive
from ltca.equilibrium.first_stage import StageMesh
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.drive_file import load_drive

DRIVE = load_drive(Path(__file__).parents[2] / "examples" / "drives" / "rv_errors.toml").cases["nominal"]
POSITIONS = 601
"""Of a turn of the output: what 39 and 40 flanks a crank turn pass (1560, 1600 and multiples) folds to 8, 115, 128 and beyond,
none of them an order or a neighbour below."""
ORDERS = (1, 3, 39, 40, 78, 80, 81)
NEIGHBOURS = (2, 4, 38, 41, 77, 79, 82)
ABOVE = 3.0
"""Factor by which an order stands above the neighbours: ten decibels, which no reader of a measured spectrum doubts."""
GONE = 0.1
"""Part of an order that may be left without its error: sums of the other errors' orders, of second order in micrometres."""


def waves(runout, lobes):
    """Radial errors of the pins of the example by the amplitudes of one and three waves."""
    angle = 2.0 * np.pi * np.arange(40) / 40
    return tuple(runout * np.cos(angle + 0.4) + lobes * np.cos(3.0 * angle + 0.4))


TRUE_TEETH = {"first_stage.sun_runout.amount": 0.0, "first_stage.planet_runout.amount": ()}
WITHOUT = {
    "nothing": {},
    "the runout of the pin circle": {"pin_wheel.pin_errors.radial": waves(0.0, 0.004)},
    "the lobes of the pin circle": {"pin_wheel.pin_errors.radial": waves(0.006, 0.0)},
    "the errors of bores, crank and teeth": {
        "disc.of.0.bore_errors.radial": (),
        "disc.of.0.bore_errors.tangential": (),
        "crank.of.0.eccentricity_error": 0.0,
        **TRUE_TEETH,
    },
}
"""Fields by what they take away."""
MAKES = {
    "the runout of the pin circle": (1, 39, 78, 81),
    "the lobes of the pin circle": (3,),
    "the errors of bores, crank and teeth": (1, 40, 80),
}


@cache
def spectra(without):
    """Amplitudes of the transmission error by order of the output's turn, rad: with the teeth as they are, then of the file.

    Teeth of the first stage move no contact of the cycloid stage, so one balance is that of both.
    """
    drive = warm_drive(DRIVE.with_fields(WITHOUT[without]))
    model = replace(HalfSpace().prepare(drive).model, friction=None)
    models = [replace(model, stage=StageMesh.of_drive(one)) for one in (drive, warm_drive(DRIVE))]
    angle = 2.0 * np.pi * 40 * np.arange(POSITIONS) / POSITIONS
    errors = [[], []]
    for rows in np.array_split(angle, 4):
        found = solve_at_output(model, [drive], rows, drive.load.torque)
        for own, teeth in zip(errors, models, strict=True):
            own.append(
                drive.output_deviation(wheel_angle_of_input(teeth, found), np.full(rows.size, drive.load.torque))
            )
    return [2.0 * np.abs(np.fft.rfft(np.concatenate(own))) / POSITIONS for own in errors]


def amplitudes(without):
    """Amplitudes of the transmission error by order of the output's turn, rad."""
    return spectra(without)[0]


def test_the_example_has_the_stated_waves():
    """The file's errors of the pins are the two waves of its comment, rounded to 10 nm."""
    np.testing.assert_allclose(DRIVE.pin_wheel.pin_errors.radial, waves(0.006, 0.004), rtol=0.0, atol=0.51e-5)


def test_counts_of_turns():
    """The input turns 81 times for one turn of the output, as 1 + z_P z₂/z₁ counts it."""
    assert abs(DRIVE.transmission_ratio) == pytest.approx(1 + 40 * 44 / 22, rel=1e-12)


@pytest.mark.slow
def test_orders_of_errors_stand_above_their_neighbours():
    """With runout and bore errors the orders 1, 3, 39, 40, 78, 80 and 81 stand above the neighbours of all of them."""
    found = amplitudes("nothing")
    for order in ORDERS:
        beside = [n for n in NEIGHBOURS if abs(n - order) <= 2]
        assert found[order] > ABOVE * found[beside].max(), (order, found[order], found[beside])


@pytest.mark.slow
@pytest.mark.parametrize("without", list(MAKES))
def test_an_order_goes_with_its_error(without):
    """Orders vanish with the error that makes them, and those that it has no part in stay."""
    whole, left = amplitudes("nothing"), amplitudes(without)
    for order in MAKES[without]:
        assert left[order] < GONE * whole[order], (order, left[order], whole[order])
    for order in set(ORDERS) - set(MAKES[without]):
        # More than half: what the other errors add to it is of second order.
        assert left[order] > 0.5 * whole[order], (order, left[order], whole[order])


@pytest.mark.slow
def test_orders_of_the_teeth():
    """Without errors of bores and crank: planets that run out make the order 40 by e/r_b of each, a sun none where cranks share.

    The sum of the planets over the three sides from which they see the sun is |5 + 5 e^(−2πi/3)|/3 µm. 5 %: cranks take some per
    cent more or less than a third of more torque; a sun may leave as much of its 8 µm at 80.
    """
    with_teeth = spectra("the errors of bores, crank and teeth")[1]
    base_radius = 28.0 * np.cos(np.pi / 9.0)
    by_radius = 80.0 / 81.0 / 40.0 / base_radius
    planets = 0.005 * abs(1.0 + np.exp(-2j * np.pi / 3.0)) / 3.0
    assert with_teeth[40] == pytest.approx(planets * by_radius, rel=0.05)
    assert with_teeth[80] < 0.05 * 0.008 * by_radius
