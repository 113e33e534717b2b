"""Rows of level 5 from answers made by hand: what is compared with what, in which unit, against which limit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from validation.compare.comparison import KINDS, KindAnswer, PositionAnswer, compare_positions
from validation.levels.positions import _body_rows, _contact_rows, _faint, _interpolation_row, shared_file_rows

LOADS = np.array([0.0, 100.0, 400.0, 3.0, 0.2])
SECOND = np.pi / 648_000.0


def answer(load=LOADS):
    kind = KindAnswer(load=load, pressure=50.0 * np.sqrt(load), half_width=0.01 * np.sqrt(load))
    return PositionAnswer(
        kinds=dict.fromkeys(KINDS, kind), bearing_radial=np.array([300.0]), bearing_tangential=np.array([400.0]),
        wheel_angle=-400.0 * SECOND,
        disc_radial=0.003, disc_tangential=-0.004, disc_rotation=80.0 * SECOND,
    )  # fmt: skip


def compared(paper_cases, model, reference=None):
    reference = answer() if reference is None else reference
    difference = compare_positions(model, reference)
    return SimpleNamespace(
        drive=paper_cases["CS-1"],
        full=SimpleNamespace(case="CS-1", crank_angle=0.5, answer=reference),
        answers={"fe": model, "half-space": model},
        differences={"fe": difference, "half-space": difference},
        station_distance={"pin": np.array([0.5, 0.1, 0.3, 0.0, 0.0])},
    )


def test_faint_contacts_are_those_between_nothing_and_one_per_cent():
    assert _faint(answer(), "pin") == 2  # 3 and 0.2 of 400
    assert _faint(answer(np.array([0.0, 400.0, 4.0, 4.1])), "pin") == 1


def test_rows_of_contacts(paper_cases):
    model = answer(LOADS + np.array([0.0, 2.0, -4.0, 0.0, 0.0]))
    rows = [row for row in _contact_rows(compared(paper_cases, model), "fe") if row.contact.startswith("pin ")]
    by_name = {(row.quantity, row.contact): row for row in rows}
    load = by_name["load", "pin 1"]
    assert (load.value, load.reference, load.unit, load.limit) == (102.0, 100.0, "N", 5e-3)
    assert load.difference == pytest.approx(2.0 / 400.0)  # of the largest load
    pressure = by_name["peak pressure at mid-width", "pin 2"]
    assert (pressure.value, pressure.unit, pressure.limit) == (pytest.approx(50.0 * np.sqrt(396.0)), "MPa", 2e-2)
    assert pressure.difference == pytest.approx(np.sqrt(0.99) - 1.0)
    assert by_name["half-width", "pin 2"].difference == pytest.approx(np.sqrt(0.99) - 1.0)
    # every loaded contact has its load, those over 5 % pressure and half-width, too
    assert sorted(by_name) == sorted(
        [("load", f"pin {k}") for k in (1, 2, 3, 4)]
        + [(name, f"pin {k}") for name in ("peak pressure at mid-width", "half-width") for k in (1, 2)]
    )
    informing = _contact_rows(compared(paper_cases, model), "half-space")
    assert {row.limit for row in informing} == {None}


def test_rows_of_bodies(paper_cases):
    model = replace(
        answer(), wheel_angle=-400.2 * SECOND, disc_radial=0.0035, disc_tangential=-0.0052,
        disc_rotation=80.3 * SECOND, bearing_radial=np.array([301.0]), bearing_tangential=np.array([402.0]),
    )  # fmt: skip
    rows = {row.quantity: row for row in _body_rows(compared(paper_cases, model), "fe")}
    wheel = rows["wheel angle"]
    assert (wheel.value, wheel.reference, wheel.limit) == (pytest.approx(-400.2), pytest.approx(-400.0), 0.3)
    assert wheel.difference == pytest.approx(-0.2)
    disc = rows["disc displacement"]
    # lengths in µm: 3-4-5, and the difference (0.5, −1.2): 5-12-13
    assert (disc.reference, disc.difference) == (pytest.approx(5.0), pytest.approx(1.3))
    assert disc.value == pytest.approx(1e3 * np.hypot(0.0035, 0.0052))
    assert disc.limit == pytest.approx(0.3 * SECOND * 88.0 * 1e3)  # 0.3″ at the pin circle of 88 mm
    rotation = rows["disc rotation"]
    assert rotation.difference == pytest.approx(0.3)
    assert rotation.limit == pytest.approx(0.3 * 88.0 / paper_cases["CS-1"].pin_shaft.pin_circle_radius)
    assert rows["bearing force, radial"].difference == pytest.approx(1.0 / 500.0)
    assert rows["bearing force, tangential"].difference == pytest.approx(2.0 / 500.0)
    number = rows["number of loaded wheel pins"]
    assert (number.value, number.reference, number.difference) == (3.0, 3.0, 0.0)  # 0.2 of 400 does not count
    assert number.limit == 4.0  # two faint ones on either side
    assert rows["contacts loaded in one answer only"].difference == 0.0


def test_root_mean_square_is_that_of_the_worst_kind(paper_cases):
    other = KindAnswer(load=1.01 * LOADS, pressure=LOADS, half_width=LOADS)
    model = replace(answer(), kinds={**answer().kinds, "hole": other})
    rows = {row.quantity: row for row in _body_rows(compared(paper_cases, model), "fe")}
    rms = 0.01 * np.sqrt(np.mean(LOADS[1:] ** 2)) / 400.0
    assert rows["load differences, root mean square, worst kind"].value == pytest.approx(rms)


def test_the_interpolated_contact_is_the_worst_far_from_stations(paper_cases):
    """Pin 1 is 1.5 % off but a tenth of a spacing from a station; pin 2, 0.8 % off, three tenths: that one counts."""
    model = answer(LOADS + np.array([0.0, 6.0, -3.2, 0.0, 0.0]))
    row = _interpolation_row(compared(paper_cases, model))
    assert (row.contact, row.limit) == ("pin 2", 1e-2)
    assert row.difference == pytest.approx(-3.2 / 400.0)
    assert (row.value, row.reference) == (pytest.approx(396.8), 400.0)
    nothing = compared(paper_cases, model)
    nothing.station_distance = {"pin": np.zeros(5)}
    row = _interpolation_row(nothing)
    assert (row.contact, row.difference) == ("", 0.0)


def test_shared_coefficients_are_told_by_their_worst_contacts(paper_cases):
    model = replace(answer(LOADS + np.array([0.0, 6.0, -3.2, 0.0, 0.0])), wheel_angle=-401.5 * SECOND)
    load, pressure, wheel = shared_file_rows([compared(paper_cases, model)])
    assert (load.contact, load.difference, load.value) == ("pin 1", pytest.approx(6.0 / 400.0), 106.0)
    assert pressure.difference == pytest.approx(np.sqrt(1.06) - 1.0)
    assert (pressure.contact, pressure.value) == ("pin 1", pytest.approx(50.0 * np.sqrt(106.0)))
    assert wheel.difference == pytest.approx(-1.5)
    assert {row.limit for row in (load, pressure, wheel)} == {None}
