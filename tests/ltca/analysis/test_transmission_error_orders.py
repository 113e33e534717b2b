"""Fit of named orders: recovers what was put in, refuses what it cannot tell apart, names what the drive shows."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from ltca.analysis.drive_curves import known_orders_of
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.pressure_safety import pressure_safety
from ltca.analysis.reduced_model.wind_up import wind_up_orders
from ltca.analysis.transmission_error_orders import Order, fit_orders, known_orders, least_turns
from ltca.commands.program import main
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

PUBLIC = Path(__file__).parents[2] / "literature" / "public_drives"


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


def test_curves_left_out_orders_that_the_export_fits(paper_cases):
    """`export --for json` had 10.333 and 19.667 of rollers past the flank; `curves` had them in its unexplained rest."""
    drive = paper_cases["CS-1"]
    passage = 11.0 * 29.5 / 49.0
    names = {order.name: order.value for order in known_orders_of(drive)}
    assert names["rollers past 1 z_C, difference"] == pytest.approx(13.0 - passage)
    assert names["rollers past 1 z_C, sum"] == pytest.approx(13.0 + passage)
    assert set(wind_up_orders(drive)) <= set(known_orders_of(drive))


@pytest.mark.parametrize("name", ["catalogue_25_to_1", "toolkit_14_to_1", "small_30_teeth", "web_generator_39_to_1"])
def test_one_order_had_two_names(name):
    """32 was "pin holes, 4 z_PS" in `curves` and "flank and holes, 1 z_C + 1 z_PS" in `export --for json`, by their multiples."""
    (drive,) = load_drive(PUBLIC / f"{name}.toml").cases.values()
    fitted = known_orders_of(drive)
    for orders in (wind_up_orders(drive), known_orders(drive, harmonics=1), known_orders(drive)):
        for order in orders:
            nearest = min(fitted, key=lambda one: abs(one.value - order.value))
            assert (nearest.value, nearest.name) == (pytest.approx(order.value, abs=1e-9), order.name)


def test_orders_of_many_teeth_were_fitted_to_more_multiples_by_the_export(paper_cases):
    """Above 320 by the flank `curves` fits two multiples; the third of the export was in the rest there."""
    drive = with_fields(
        paper_cases["CS-1"], {"disc.number_of_teeth": 120, "pin_wheel.number_of_pins": 121}, check=False
    )
    assert set(wind_up_orders(drive)) <= set(known_orders_of(drive))


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


def test_orders_were_named_that_so_few_turns_do_not_tell_apart():
    """`cyclo curves --turns 4` named 2.925 of the wheel pins and 2.917 of the cage, which over 40 turns are not there."""
    names = (Order(8.0, "holes"), Order(8.1667, "rollers"), Order(8.25, "pins"), Order(8.5, "flank"))
    angle = 2.0 * np.pi * np.arange(4 * 600) / 600
    error = 1.0 + 0.9 * np.cos(8.0 * angle) + 0.2 * np.cos(8.1667 * angle - 0.4) + 0.1 * np.cos(8.5 * angle)
    found = fit_orders(angle, error, names)
    assert found.turns == pytest.approx(4.0)
    assert found.groups == ((0, 1, 2), (3,))
    assert found.names == ("holes or rollers or pins",) * 3 + ("flank",)
    shown = found.resolved()
    assert [order.name for order in shown.orders] == ["holes or rollers or pins", "flank"]
    together = 0.9 * np.cos(8.0 * angle) + 0.2 * np.cos(8.1667 * angle - 0.4)
    # √2 of a root mean square over samples; whole periods of twice the orders do not quite fit into the turns
    assert shown.amplitude == pytest.approx([np.sqrt(2.0 * np.mean(together**2)), 0.1], rel=2e-3)
    # Exactly a quarter apart, they have shifted by a whole period over four turns.
    apart = fit_orders(angle, error, names[::2])
    assert apart.groups == ((0,), (1,))
    assert apart.resolved().amplitude == pytest.approx(apart.amplitude, rel=1e-12)
    assert apart.resolved().phase == pytest.approx(apart.phase, abs=1e-9)


@pytest.mark.slow
def test_printed_orders_of_four_turns_are_sums_of_those_not_told_apart(tmp_path, capsys):
    words = [
        "curves",
        "paper",
        "--case",
        "CS-1",
        "--turns",
        "4",
        "--quick",
        "--no-page",
        "--out",
        str(tmp_path / "out"),
    ]
    assert main(words) == 0
    rows = re.findall(r"^ +([\d.]+)  (\S.*?) +[\d.]+″$", capsys.readouterr().out, flags=re.M)
    assert ("13.0000", "flank, 1 z_C or roller passage, 2 n_BR(1 − c)") in rows
    values = sorted(float(value) for value, _ in rows)
    assert min(np.diff(values)) > 0.25
    kept = json.loads((tmp_path / "out" / "curves.json").read_text(encoding="utf-8"))["transmission_error_orders"]
    # c = 0.398 of the cage: 22 · 0.602 / 2 = 6.622, nearer than a quarter to 6.5 = 7 · 13/14, as 13 − 6.622 is
    assert any(entry["orders"] == pytest.approx([6.3776, 6.5, 6.6224], abs=1e-4) for entry in kept["not_told_apart"])


def test_too_few_turns_are_refused_with_the_least_before_the_work(tmp_path, capsys):
    assert main(["curves", "paper", "--turns", "1", "--out", str(tmp_path / "out")]) == 2
    assert "--turns = 1: must be at least 4, or 66 orders" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
