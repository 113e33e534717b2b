"""The closed form of held rings against others': Johnson's cylinder, a thin confined layer, the half-plane's logarithm."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.round_bodies import NARROW, compressed_cylinder, held_ring_approach

KOLOSOV = [3.0 - 4.0 * 0.3, (3.0 - 0.3) / (1.0 + 0.3)]


@pytest.mark.parametrize("kolosov", KOLOSOV)
def test_opposite_loads_on_a_small_core_compress_a_cylinder(kolosov):
    """A core feels opposite loads by the square of its radius (1e-4), a patch its curvature by 0.3 (b/R)² (1e-4)."""
    here, there = held_ring_approach(0.05, 5.0, 0.1, kolosov, np.array([0.0, np.pi]))
    assert here + there == pytest.approx(compressed_cylinder(5.0, 0.1), rel=3e-4)


@pytest.mark.parametrize("kolosov", KOLOSOV)
def test_a_thin_ring_is_a_confined_layer(kolosov):
    """Under a pressure much wider than the layer p h/(λ + 2G) at each place; its ends spread by the thickness, 1/50 of b."""
    outer, half_width, thickness = 100.0, 5.0, 0.1
    (found,) = held_ring_approach(outer - thickness, outer, half_width, kolosov, np.zeros(1))
    # λ + 2G = G (κ + 1)/(κ − 1); the mean of a semi-elliptic pressure, weighted with itself, is 16/(3π²b) of a newton.
    layer = 64.0 * thickness * (kolosov - 1.0) / (3.0 * np.pi * half_width * (kolosov + 1.0) ** 2)
    assert found == pytest.approx(layer, rel=0.02)


def test_narrower_patches_go_with_the_logarithm():
    """On either side of the width below which the logarithm is taken for the series; curvature leaves 0.3 (b/R)²."""
    widths = 6.5 * NARROW * np.array([4.0, 2.0, 1.0, 0.5])
    found = [held_ring_approach(2.0, 6.5, width, 1.8, np.array([0.0, 1.0])) for width in widths]
    assert np.diff([own for own, _ in found]) == pytest.approx(np.full(3, np.log(2.0)), abs=1e-3)
    assert [far for _, far in found] == pytest.approx(np.full(4, found[-1][1]), abs=1e-3)


def test_a_load_is_balanced_by_the_core():
    """Even loads from all sides squeeze evenly, by Lamé's ring held inside."""
    ratio, kolosov = 0.4, 1.8
    angle = 2.0 * np.pi * np.arange(720) / 720
    mean = held_ring_approach(ratio, 1.0, 0.05, kolosov, angle).mean()
    # u = (κ − 1)(1 − a²/R²) p R/(2 + (κ − 1) a²/R²)/(2G) for p = 1/(2πR), in units of (κ + 1)/(4πG).
    lame = (kolosov - 1.0) * (1.0 - ratio**2) / (2.0 + (kolosov - 1.0) * ratio**2) / (kolosov + 1.0)
    assert mean == pytest.approx(lame, rel=2e-3)  # patches pull along their middle's normal: (b/R)²
