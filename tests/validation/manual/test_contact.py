"""Cases of contact on coarse meshes."""

import numpy as np
import pytest

from validation.manual.contact import ROLLER_DEPTH, ROLLER_LINE_LOAD, ROLLER_RADIUS, STEEL, squeeze_roller


def test_a_roller_between_flats_on_a_coarse_mesh():
    """Approach of points 2 mm deep in both flats (Johnson 5.57, 5.58), by 1.5 elements for the half-width to 2 %."""
    nu, modulus = STEEL.poisson_ratio, STEEL.youngs_modulus
    plane = ROLLER_LINE_LOAD * (1.0 - nu**2) / (np.pi * modulus)
    width = np.sqrt(8.0 * plane * ROLLER_RADIUS)
    in_flat = plane * (2.0 * np.log(2.0 * ROLLER_DEPTH / width) - nu / (1.0 - nu))
    in_roller = 4.0 * plane * (np.log(4.0 * ROLLER_RADIUS / width) - 0.5)
    assert squeeze_roller(1.5) == pytest.approx(2.0 * in_flat + in_roller, rel=0.02)
