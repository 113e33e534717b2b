"""Metrics on arrays made by hand: every figure can be read off the numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ltca.drive.units.quantities import ARCSEC
from validation.compare.comparison import (
    KINDS,
    KindAnswer,
    PositionAnswer,
    compare_kind,
    compare_positions,
    worst,
)


def kind(load, pressure=None, half_width=None):
    load = np.array(load, dtype=float)
    return KindAnswer(
        load=load,
        pressure=np.sqrt(load) if pressure is None else np.array(pressure, dtype=float),
        half_width=0.01 * np.sqrt(load) if half_width is None else np.array(half_width, dtype=float),
    )


@pytest.fixture
def answer():
    return PositionAnswer(
        kinds={name: kind([0.0, 100.0, 400.0]) for name in KINDS},
        bearing_radial=np.array([300.0]),
        bearing_tangential=np.array([400.0]),
        wheel_angle=-2e-3,
        disc_radial=0.01,
        disc_tangential=-0.02,
        disc_rotation=1e-4,
    )


def test_loads_are_relative_to_the_largest_of_the_reference():
    found = compare_kind(kind([0.0, 104.0, 398.0]), kind([0.0, 100.0, 400.0]))
    np.testing.assert_allclose(found.load, [0.0, 0.01, -0.005], rtol=1e-14)
    assert found.worst_load == (1, pytest.approx(0.01))
    # over the two loaded contacts, not over the open one
    assert found.rms_load == pytest.approx(np.sqrt((0.01**2 + 0.005**2) / 2.0), rel=1e-14)


def test_pressures_are_compared_above_five_per_cent():
    reference = kind([19.0, 21.0, 400.0], pressure=[1.0, 10.0, 100.0])
    found = compare_kind(kind([19.0, 21.0, 400.0], pressure=[2.0, 11.0, 99.0]), reference)
    assert np.isnan(found.pressure[0])
    np.testing.assert_allclose(found.pressure[1:], [0.1, -0.01], rtol=1e-12)
    assert found.worst_pressure == (1, pytest.approx(0.1))
    np.testing.assert_array_equal(found.compared, [False, True, True])


def test_the_reference_says_what_is_compared():
    """A model that underrates a contact cannot take it out of the comparison, nor bring one in that is not there."""
    reference = kind([21.0, 19.0, 400.0, 0.0], pressure=[10.0, 10.0, 100.0, 0.0])
    model = kind([19.0, 21.0, 200.0, 50.0], pressure=[8.0, 11.0, 90.0, 70.0])
    found = compare_kind(model, reference)
    np.testing.assert_array_equal(found.compared, [True, False, True, False])
    np.testing.assert_allclose(found.pressure, [-0.2, np.nan, -0.1, np.nan], rtol=1e-12)
    np.testing.assert_allclose(found.half_width[[0, 2]], np.sqrt([19.0 / 21.0, 0.5]) - 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.load, np.array([-2.0, 2.0, -200.0, 50.0]) / 400.0, rtol=1e-14)
    # an open contact of the model is still compared where the reference carries
    assert compare_kind(kind([0.0, 400.0]), kind([100.0, 400.0])).pressure[0] == -1.0


def test_a_model_without_pressures_has_no_pressure_difference():
    found = compare_kind(kind([0.0, 1.0], pressure=[np.nan, np.nan]), kind([0.0, 1.0]))
    place, difference = found.worst_pressure
    assert place == -1
    assert np.isnan(difference)


@pytest.mark.parametrize(
    ("model", "reference", "missing"),
    [
        ([3.9, 400.0], [0.0, 400.0], ()),  # below 1 % of the largest it may be open in the other
        ([4.1, 400.0], [0.0, 400.0], (0,)),
        ([0.0, 400.0], [4.1, 400.0], (0,)),
        ([0.1, 400.0], [4.1, 400.0], ()),  # loaded in both, however little
    ],
)
def test_same_loaded_contacts(model, reference, missing):
    assert compare_kind(kind(model), kind(reference)).missing == missing


def test_open_reference_is_refused():
    with pytest.raises(ValueError, match="no load at all"):
        compare_kind(kind([1.0]), kind([0.0]))
    assert compare_kind(kind([0.0]), kind([0.0])).rms_load == 0.0
    with pytest.raises(ValueError, match="not the same drive"):
        compare_kind(kind([1.0]), kind([1.0, 2.0]))


def test_positions(answer):
    second = 1.0 / ARCSEC
    other = replace(
        answer,
        kinds=answer.kinds | {"hole": kind([0.0, 100.0, 380.0])},
        bearing_radial=np.array([305.0]),
        wheel_angle=answer.wheel_angle - 0.25 * second,
        disc_radial=0.013,
        disc_tangential=-0.016,
        disc_rotation=answer.disc_rotation + second,
    )
    found = compare_positions(other, answer)
    assert found.worst_load == ("hole", 2, pytest.approx(-0.05))
    assert found.bearing_radial == pytest.approx(0.01)  # of the whole force, 500 N
    assert found.bearing_tangential == 0.0
    assert found.wheel_angle == pytest.approx(-0.25)
    assert found.disc_rotation == pytest.approx(1.0)
    assert found.disc_displacement == pytest.approx(5e-3)  # 3-4-5
    assert found.missing == ()


def test_an_answer_against_itself(answer):
    found = compare_positions(answer, answer)
    assert found.worst_load[2] == 0.0
    assert found.wheel_angle == found.disc_displacement == 0.0


def test_number_of_loaded_contacts(answer):
    assert answer.loaded("pin") == 2


def test_worst_keeps_the_sign():
    assert worst(np.array([0.1, np.nan, -0.2])) == (2, -0.2)
