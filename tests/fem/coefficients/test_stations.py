"""Sizes that patches of load on a body are small against, and the memory that a disc with them takes."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fem.coefficients import bodies
from fem.coefficients.stations import DiscStations, smallest_radius
from fem.errors import MemoryLimitError
from fem.shapes import DriveShapes


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


def test_measured_arcs_are_no_wider_than_any_patch_on_their_wall(paper_cases):
    shape = DriveShapes.of_drive(paper_cases["CS-1"]).disc
    stations = DiscStations.of_disc(shape)
    narrow = 1.0 - 0.5 * (np.arange(stations.count) % 7) / 6.0 * (stations.boundary % 2)  # by half, on every other wall
    uneven = replace(stations, half_width=stations.half_width * narrow)
    fine = uneven.refined(shape)
    for wall in np.unique(stations.boundary):
        patches, arcs = uneven.half_width[uneven.boundary == wall], fine.half_width[fine.boundary == wall]
        assert 0.0 < arcs.max() <= patches.min()
    np.testing.assert_array_equal(fine.half_width[fine.boundary == 0], stations.half_width[stations.boundary == 0])


def test_derivations_side_by_side_share_the_memory(paper_cases, monkeypatch):
    """What is enough for one is not for two at once."""
    shape = DriveShapes.of_drive(paper_cases["CS-1"]).disc
    stations = DiscStations.of_disc(shape)
    monkeypatch.setattr(bodies, "available_memory", lambda: 1.0)
    with pytest.raises(MemoryLimitError) as refused:
        bodies.require_disc_memory(shape, stations)
    monkeypatch.setattr(bodies, "available_memory", lambda: 1.6 * refused.value.needed)
    bodies.require_disc_memory(shape, stations)
    with pytest.raises(MemoryLimitError):
        bodies.require_disc_memory(shape, stations, processes=2)
