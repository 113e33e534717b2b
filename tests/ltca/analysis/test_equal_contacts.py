"""Of equal contacts the first is named, whatever their last bits are."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.force_orders import ForceSpectrum
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_safety import pressure_safety
from ltca.analysis.verdict.places import largest_value
from ltca.arrays import place_of_largest
from ltca.reading.drive_file import load_drive

ANGLES = np.array([0.1, 0.2, 0.3])


@pytest.fixture(scope="module")
def analysis():
    return analyse(load_drive("paper").cases["CS-1"], ANGLES)


@pytest.mark.parametrize("seed", range(5))
def test_round_off_decided_which_of_equal_contacts_was_named(analysis, seed):
    """Another machine, with other last bits, named another roller at another angle."""
    rollers = analysis.drive.crank_bearing.number_of_rollers
    pressure = np.full((3, rollers), 500.0)
    pressure[1, 4] = pressure[1, 7] = pressure[2, 2] = 1000.0
    pressure *= 1.0 + 1e-15 * np.random.default_rng(seed).integers(-3, 4, pressure.shape)
    value = largest_value(analysis, "roller_pressure_max_outer", pressure, "roller")
    assert (value.part, value.crank_angle) == ("roller 4", 0.2)
    assert value.value == pressure.max()
    safety = pressure_safety(pressure, 1600.0)
    assert (safety.position, safety.pin) == (1, 4)


def test_a_contact_that_is_larger_by_more_than_round_off_is_named(analysis):
    pressure = np.ones((3, 11))
    pressure[2, 5] += 1e-6
    assert place_of_largest(pressure) == (2, 5)
    assert place_of_largest(-pressure) == (0, 0)
    assert place_of_largest(np.array([np.nan, -2.0, -1.0])) == (2,)
    assert place_of_largest(np.array([1.0, np.inf, np.inf])) == (1,)
    assert place_of_largest(np.zeros((2, 2))) == (0, 0)


def test_orders_of_forces_of_equal_parts_were_those_of_any_of_them():
    amplitude = np.zeros((2, 1, 3), dtype=complex)
    amplitude[0, 0] = 1.0, 2.0, 2.0 * (1.0 + 1e-15)
    amplitude[1, 0] = 3.0 * (1.0 - 1e-15), 3.0, 1.0
    none, orders = np.zeros((1, 3)), np.array([1.0, 2.0])
    spectrum = ForceSpectrum(kind="pin", passage=1.0, mean=none, orders=orders, amplitude=amplitude, rest=none)
    sizes, parts = spectrum.largest()
    assert parts == ((0, 1), (0, 0))
    assert sizes.tolist() == np.abs(amplitude).max(axis=(1, 2)).tolist()
    assert spectrum.strongest == (0, 1)
