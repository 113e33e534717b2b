"""Sizes that patches of load on a body are small against, and the memory that a disc with them takes."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fem.coefficients import bodies
from fem.coefficients.stations import DiscStations, root_clustering, smallest_radius
from fem.errors import MemoryLimitError
from fem.shapes import DriveShapes
from ltca.drive.single_discs import nominal_shape, single_discs
from ltca.geometry.boundary_stations import Boundary
from ltca.reading.drive_file import load_drive

PUBLIC = Path(__file__).parents[2] / "literature" / "public_drives"


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


def shape_of_public_drive(name):
    (drive,) = load_drive(PUBLIC / f"{name}.toml").cases.values()
    return DriveShapes.of_drive(nominal_shape(single_discs(drive)[0])).disc


@pytest.mark.parametrize(
    ("name", "ratio"),
    [
        ("printed_19_to_1_50_newton_metres", 0.92),  # 2.3 · 20 / 50
        ("printed_21_rollers_1_newton_metre", 0.875),  # 0.75 · 21 / 18
        ("compact_29_to_1", 0.8),  # 0.8 · 30 / 30
    ],
)
def test_stations_follow_normals_in_the_roots_of_nearly_cusped_flanks(name, ratio):
    """At 0.92 the normal turned by 58° between two stations, and interpolated ones were off by 0.18: clustering knew no λ."""
    shape = shape_of_public_drive(name)
    profile, flank = shape.flank.profile, DiscStations.of_disc(shape)
    assert profile.eccentricity * profile.reduction_ratio / profile.generating_radius == pytest.approx(ratio, rel=1e-12)
    teeth = round(profile.reduction_ratio) - 1
    count = int(np.count_nonzero(flank.boundary == 0))
    assert count == 16 * teeth
    walls = Boundary(first=0, count=count, clustering=root_clustering(shape), teeth=teeth)
    np.testing.assert_allclose(walls.parameters(), flank.parameter[:count], atol=1e-12)
    between = walls.parameters(8)[: 8 * 16]
    # The trochoid R e^{iθ} − e e^{iuθ} has its normals along e^{iθ} (1 − λ e^{i(u − 1)θ}).
    along = np.exp(1j * between) * (1.0 - ratio * np.exp(1j * teeth * between))
    stations, weights = walls.weights(between)
    off = np.abs((flank.normals[stations] * weights).sum(axis=-1) - along / np.abs(along))
    assert off.max() < 0.01
    assert np.degrees(np.abs(np.angle(flank.normals[1:17] / flank.normals[:16]))).max() < 38.0


def test_shipped_drives_keep_their_stations():
    """Their coefficients are in the package: e u/R is 0.667 at most."""
    for name in ("paper", "robot-joint", "rv", "sleeved"):
        drive = next(iter(load_drive(name).cases.values()))
        assert root_clustering(DriveShapes.of_drive(nominal_shape(single_discs(drive)[0])).disc) == 0.6
