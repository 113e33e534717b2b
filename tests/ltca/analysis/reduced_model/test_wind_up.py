"""Orders of the wind-up table: those that the drive has bear their names, what the fit may make of its residual does not."""

from __future__ import annotations

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.analysis.reduced_model import wind_up as wind_up_module
from ltca.analysis.reduced_model.wind_up import WindUp, frictionless, scattered_angles, wind_up
from ltca.analysis.transmission_error_orders import Order, fit_several, known_orders, named_orders

TOO_WEAK = {
    "flank -1 wheel pins",
    "flank -2 wheel pins",
    "flank +2 wheel pins",
    "flank -1 cage",
    "wheel pins, 1 z_C/z_P",
}
"""Orders below 0.003″ in `cyclo curves paper --case CS-1`, at the torque of the drive."""


def test_a_fit_named_orders_that_its_residual_alone_made(paper_cases):
    """One order of the drive beside one that no motion of it has: the others are parts of the second."""
    orders = known_orders(paper_cases["CS-1"], harmonics=3)
    angle = scattered_angles(paper_cases["CS-1"], len(orders))
    error = 1.3 * np.cos(13.0 * angle - 0.4) + 0.06 * np.cos(52.3 * angle)
    (fit,) = fit_several(angle, error[None], orders)
    assert np.sort(fit.amplitude)[-2] > 0.003  # some 0.06 √(2/N) of nothing
    named = named_orders(orders, fit.amplitude[:, None], np.array([fit.residual]))
    assert [order.name for order in named if order.name] == ["flank, 1 z_C"]
    assert [order.value for order in named] == [order.value for order in orders]


def test_the_export_named_orders_that_the_drive_has_not(paper_cases, monkeypatch):
    """31 orders fitted to 356 positions: "12.07 flank - 1 wheel pins" of 0.114″ at one torque, where `curves` has 0.002″."""
    monkeypatch.setattr(wind_up_module, "TORQUE_PARTS", (0.06, 0.5, 1.0))
    drive = paper_cases["CS-1"]
    table = wind_up(drive, frictionless(HalfSpace().prepare(drive).model), drive.load.torque)
    names = {order.name for order in table.orders} - {""}
    assert {"flank, 1 z_C", "pin holes, 1 z_PS", "roller passage, 1 n_BR(1 − c)"} <= names
    assert not names & TOO_WEAK
    amplitude = np.hypot(table.cosine, table.sine)
    for order, row in zip(table.orders, amplitude, strict=True):
        assert order.name or np.all(row <= table.residual), order


def test_orders_below_the_residual_stood_among_the_named_ones_without_a_sum():
    """Amplitudes of 5 and 12 µrad have the rms √((5² + 12²)/2) µrad; the named order is not in it."""
    table = WindUp(
        torque=np.array([1.0]),
        mean=np.zeros(1),
        orders=(Order(13.0, "flank, 1 z_C"), Order(12.07, ""), Order(2.5, "")),
        cosine=1e-6 * np.array([[100.0], [3.0], [12.0]]),
        sine=1e-6 * np.array([[0.0], [4.0], [0.0]]),
        residual=np.array([2e-5]),
        turns=1,
        positions=8,
    )
    np.testing.assert_allclose(table.unidentified, 1e-6 * np.sqrt(84.5), rtol=1e-12)
