"""Sizes that patches of load on a body are small against."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.coefficients.stations import smallest_radius


@pytest.mark.parametrize("place", [0.0, 0.4, 3.0, 6.2])
def test_the_smallest_radius_is_found_wherever_it_is(place):
    """A dent of 1 mm in walls of 3 and 5 mm: all around the curve."""

    def radius(theta):
        away = np.angle(np.exp(1j * (theta - place)))
        return 3.0 - 2.0 * np.exp(-((away / 0.1) ** 2))

    curves = (
        SimpleNamespace(samples=64, curvature_radius=lambda theta: np.full(theta.shape, 5.0)),
        SimpleNamespace(samples=64, curvature_radius=radius),
    )
    # 256 places, the nearest within 0.0123 rad: 2 (1 − exp(−0.015)) mm
    assert smallest_radius(curves) == pytest.approx(1.0, abs=0.031)
