"""A ring of finite length on a coarse mesh."""

import pytest

from validation.manual.solid_bodies import RING_INNER, RING_LENGTH, RING_OUTER, RING_PRESSURE, STEEL, inflate_ring


def test_a_ring_under_inner_pressure_widens_and_shortens():
    """Lamé's ring with free ends, and between flats in plane strain; elements of 4 mm on a wall of 10 mm."""
    a, b, e, nu = RING_INNER, RING_OUTER, STEEL.youngs_modulus, STEEL.poisson_ratio
    share = RING_PRESSURE * a**2 / (b**2 - a**2) / e
    widened, shortened = inflate_ring(4.0, "symmetric", held=False)
    assert widened == pytest.approx(share * ((1.0 - nu) * a + (1.0 + nu) * b**2 / a), rel=5e-3)
    assert shortened == pytest.approx(2.0 * nu * share * RING_LENGTH, rel=5e-3)
    widened, shortened = inflate_ring(4.0, "symmetric", held=True)
    assert widened == pytest.approx(share * (1.0 + nu) * ((1.0 - 2.0 * nu) * a + b**2 / a), rel=5e-3)
    assert shortened == pytest.approx(0.0, abs=1e-12)
