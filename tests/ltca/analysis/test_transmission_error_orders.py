"""Fit of named orders: recovers what was put in, refuses what it cannot tell apart, names what the drive shows."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_safety import pressure_safety
from ltca.analysis.transmission_error_orders import Order, fit_orders, known_orders, least_turns
from ltca.commands.program import main
from ltca.geometry.coordinates import WHEEL_ANGLE


def test_orders_put_in_come_out():
    angle = 2.0 * np.pi * np.arange(14 * 64) / 64
    orders = (Order(1.0, "crank"), Order(6.6224, "rollers"), Order(13.0, "flank"), Order(13 / 14, "pins"))
    sizes, phases = (1e-5, 3e-6, 2e-5, 7e-7), (0.3, -2.0, 1.0, 3.0)
    error = -3e-3 + sum(a * np.cos(o.value * angle - p) for a, p, o in zip(sizes, phases, orders, strict=True))
    found = fit_orders(angle, error, orders)
    np.testing.assert_allclose(found.amplitude, sizes, rtol=1e-9)
    np.testing.assert_allclose(found.phase, phases, atol=1e-8)
    assert found.mean == pytest.approx(-3e-3, rel=1e-12)
    assert found.residual < 1e-15


def test_too_few_turns_cannot_tell_orders_apart():
    angle = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    with pytest.raises(ValueError, match="cannot tell 2 orders apart"):
        fit_orders(angle, np.zeros(100), (Order(13.0, "flank"), Order(13.0 + 1e-4, "pins")))


def test_orders_of_the_papers_drive(paper_cases):
    orders = {order.name: order.value for order in known_orders(paper_cases["CS-6"])}
    assert orders["flank, 1 z_C"] == 13.0
    assert orders["pin holes, 2 z_PS"] == 16.0
    assert orders["wheel pins, 1 z_C/z_P"] == pytest.approx(13.0 / 14.0)
    cage = 19.5 / 49.0
    assert orders["roller passage, 1 n_BR(1 − c)"] == pytest.approx(11.0 * (1.0 - cage))
    values = [order.value for order in known_orders(paper_cases["CS-6"])]
    assert values == sorted(values)
    assert len(set(np.round(values, 9))) == len(values)


@pytest.mark.slow
def test_clearances_bring_the_holes_and_a_single_pin_its_own_order(paper_cases, vary):
    """CS-1 meshes with its flank; CS-6 with its holes; one pin out of place shows at multiples of 13/14."""
    turns = 14
    angle = 2.0 * np.pi * np.arange(turns * 64) / 64

    def spectrum(drive):
        return fit_orders(angle, analyse(drive, angle).full.pose[:, WHEEL_ANGLE], known_orders(drive, harmonics=2))

    close, loose = spectrum(paper_cases["CS-1"]), spectrum(paper_cases["CS-6"])
    assert loose.of(8.0) > 2.5 * close.of(8.0)
    assert loose.of(8.0) > loose.of(13.0)
    assert close.of(13.0) > close.of(8.0)
    single = spectrum(vary(pin_wheel={"pin_errors": {"radial": [-0.005] + [0.0] * 13}}))
    assert single.of(13.0 / 14.0) > 20.0 * close.of(13.0 / 14.0)
    assert single.of(13.0 / 14.0) > single.of(1.0)


def test_pressure_safety():
    pressure = np.array([[700.0, 0.0, 100.0], [900.0, 0.0, 400.0]])
    found = pressure_safety(pressure, 1350.0)
    assert (found.safety, found.load_factor, found.position, found.pin) == (1.5, 2.25, 1, 0)
    np.testing.assert_array_equal(found.per_pin, [1.5, np.inf, 3.375])
    with pytest.raises(ValueError, match="greater than 0"):
        pressure_safety(pressure, 0.0)
    with pytest.raises(ValueError, match="no pin"):
        pressure_safety(0.0 * pressure, 1.0)


def test_as_few_turns_as_tell_the_orders_apart(paper_cases):
    """`cyclo curves --turns 1` said that turns were too few, and not how many are enough."""
    orders = known_orders(paper_cases["CS-1"], harmonics=7)
    least = least_turns(orders, 192, 14)
    for turns in range(1, least + 2):
        angle = 2.0 * np.pi * np.arange(192 * turns) / 192
        if turns < least:
            with pytest.raises(ValueError, match="orders apart"):
                fit_orders(angle, np.cos(angle), orders)
        else:
            assert max(fit_orders(angle, np.cos(angle), orders).amplitude) == pytest.approx(1.0)
    assert least_turns(orders, 192, 2) == 2


def test_too_few_turns_are_refused_with_the_least_before_the_work(tmp_path, capsys):
    assert main(["curves", "paper", "--turns", "1", "--out", str(tmp_path / "out")]) == 2
    assert "--turns = 1: must be at least 4, or 60 orders" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
