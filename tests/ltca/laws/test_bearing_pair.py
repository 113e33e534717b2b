"""Stiffness of rows and pairs against sums over rolling elements and against hand calculations."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.drive.members.main_bearing import BALL, ROLLER, axial_preload
from ltca.laws.bearing_pair import (
    RollingRow,
    SideLaw,
    bearing_matrix,
    facing_of,
)

CLOSED_FORM = 1e-12
"""Round-off of sums over some twenty rolling elements."""


@pytest.mark.parametrize("facing", [1, -1])
@pytest.mark.parametrize("elements", [3, 8, 21])
def test_a_row_is_the_sum_over_its_rolling_elements(elements, facing):
    """k_n Σ g gᵀ, g = (n, p × n), element by element: Z cos²α/2, Z sin²α and the places of the pressure centre."""
    angle, radius, plane, normal = 0.6, 43.0, 17.0, 2.5e4
    whole = np.zeros((5, 5))
    for around in 0.3 + 2.0 * np.pi * np.arange(elements) / elements:
        pressing = np.array([np.cos(angle) * np.cos(around), np.cos(angle) * np.sin(around), facing * np.sin(angle)])
        at = np.array([radius * np.cos(around), radius * np.sin(around), plane])
        lever = np.concatenate([pressing, np.cross(at, pressing)])[:5]
        whole += normal * np.outer(lever, lever)
    axial = elements * normal * np.sin(angle) ** 2
    row = RollingRow.of_axial(axial, angle, plane=plane, pitch_radius=radius, facing=facing)
    np.testing.assert_allclose(row.matrix, whole, rtol=CLOSED_FORM, atol=CLOSED_FORM * whole.max())


def test_a_pair_by_hand():
    """Two rows of 1e5 N/mm axially at ±20 mm, α = 45°, R = 30 mm: radial 2·½·1e5; O tilts on 50 mm, X on −10 mm."""
    for arrangement, reach in (("O", 50.0), ("X", -10.0)):
        rows = [
            RollingRow.of_axial(
                1e5, np.pi / 4.0, plane=plane, pitch_radius=30.0, facing=facing_of(arrangement, plane, 0.0)
            )
            for plane in (-20.0, 20.0)
        ]
        expected = np.diag([1e5, 1e5, 2e5, 1e5 * reach**2, 1e5 * reach**2])
        np.testing.assert_allclose(bearing_matrix(rows), expected, rtol=1e-9, atol=1e-9 * expected.max())


@pytest.mark.parametrize("arrangement", ["O", "X"])
def test_pairs_are_symmetric_and_positive(arrangement):
    rows = [
        RollingRow.of_axial(stiffness, 0.4, plane=plane, pitch_radius=60.0, facing=facing_of(arrangement, plane, 3.0))
        for stiffness, plane in ((1e5, -22.0), (3e5, 28.0))
    ]
    found = bearing_matrix(rows)
    np.testing.assert_array_equal(found, found.T)
    assert np.linalg.eigvalsh(found).min() > 0.0
    # one row alone may turn about its pressure centre
    assert np.linalg.eigvalsh(rows[0].matrix).min() == pytest.approx(0.0, abs=1e-9 * found.max())


@pytest.mark.parametrize(
    ("power", "expected"), [(BALL, 1.5e6 * 0.004**0.5), (ROLLER, 1e7 / 9.0 * 0.004 ** (1.0 / 9.0))]
)
def test_axial_stiffness_at_a_preload(power, expected):
    """dF/dδ of 1e6 δⁿ at 4 µm, from the displacement and from the force there."""
    force = 1e6 * 0.004**power
    assert axial_preload(power, None, 1e6, force=None, displacement=0.004) == pytest.approx((force, 0.004), rel=1e-12)
    assert axial_preload(power, None, 1e6, force=force, displacement=None) == pytest.approx((force, 0.004), rel=1e-12)
    assert power * force / 0.004 == pytest.approx(expected, rel=1e-12)
    # the same row by its stiffness there
    assert axial_preload(power, expected, None, force=None, displacement=0.004) == pytest.approx(
        (force, 0.004), rel=1e-12
    )
    assert axial_preload(power, expected, None, force=force, displacement=None) == pytest.approx(
        (force, 0.004), rel=1e-12
    )


def test_loose_and_tight_meet():
    """A side of 1e5 N/mm: no clearance yields F/1e5; 10 µm of it 5 µm more; as tight half as much until a side lifts off."""
    loose, none, tight = (SideLaw.of_clearance(1e5, clearance) for clearance in (0.01, 0.0, -0.01))
    assert (loose.gap, none.gap, tight.gap) == (0.005, 0.0, 0.0)
    assert (loose.stiffness, none.stiffness, tight.stiffness) == (1e5, 1e5, 2e5)
    # two sides pressed by 5 µm each, 500 N: one is free when the other carries 1000 N, and yields by 1/1e5 from there
    assert tight.lift_off == 1000.0
    assert 1.0 / tight.stiffness + tight.beyond == pytest.approx(1e-5, rel=1e-15)
    given = SideLaw.of_preload(2e5, 500.0, None)
    assert given == tight
    assert SideLaw.of_preload(2e5, None, 0.005) == tight
