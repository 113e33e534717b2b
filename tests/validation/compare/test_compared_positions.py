"""How far contacts lie from the stations of the coefficients, by angles made by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from validation.compare.compared_positions import _station_distances


def boundary(count, offset=0.0):
    return SimpleNamespace(count=count, offset=offset)


def test_distances_are_parts_of_a_spacing_in_the_frame_of_the_disc():
    """Forty stations on the flank, ten in the bore, twenty in a hole; the disc turned by 0.02 rad."""
    turn = 0.02
    flank = 2.0 * np.pi * np.array([[3.0, 3.4, 39.8]]) / 40
    rollers = np.exp(1j * (2.0 * np.pi * np.array([[0.0, 2.5]]) / 10 + turn))
    holes = 2.0 * np.pi * np.array([[7.0, 7.25]]) / 20 + turn
    gradient = np.stack([2.0 * np.cos(holes), 2.0 * np.sin(holes), 0.0 * holes, 0.0 * holes], axis=-1)
    response = SimpleNamespace(
        flank=SimpleNamespace(parameter=flank),
        rollers=SimpleNamespace(outer_direction=rollers),
        holes=SimpleNamespace(gradient=gradient),
    )
    analysis = SimpleNamespace(full=SimpleNamespace(response=response, pose=np.array([[0.0, 0.0, turn, 0.0]])))
    coefficients = SimpleNamespace(flank=boundary(40), bores=(boundary(10),), holes=(boundary(20), boundary(20)))
    found = _station_distances(analysis, coefficients)
    np.testing.assert_allclose(found["pin"], [[0.0, 0.4, 0.2]], atol=1e-12)
    np.testing.assert_allclose(found["roller_outer"], [[0.0, 0.5]], atol=1e-12)
    np.testing.assert_allclose(found["hole"], [[0.0, 0.25]], atol=1e-12)
