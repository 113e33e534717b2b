"""Discs in parts: copies of cells and the core together are the disc, node by node."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fem.body.elasticity import area_loads
from fem.coefficients.bodies import disc_size_field
from fem.coefficients.stations import DiscStations
from fem.mesh.body_mesh import BodyMesh
from fem.mesh.disc_parts import SAME_NODE, lobes_alike, mesh_disc_parts
from fem.shapes import DiscShape, DriveShapes
from ltca.drive.single_discs import nominal_shape, single_discs
from ltca.reading.drive_file import load_drive


def disc_of(name: str) -> DiscShape:
    drive = next(iter(load_drive(name).cases.values()))
    return DriveShapes.of_drive(nominal_shape(single_discs(drive)[0])).disc


@pytest.fixture(scope="module", params=["paper", "rv"])
def divided(request):
    """One bore and holes; three bores and no holes."""
    shape = disc_of(request.param)
    stations = DiscStations.of_disc(shape)
    return shape, stations, mesh_disc_parts(shape, disc_size_field(shape, stations, 1.5), stations.cells(shape))


def moved(part):
    """The mesh of each copy."""
    for turn, shift in zip(part.turns, part.shifts, strict=True):
        places = turn * part.mesh.places + shift
        yield BodyMesh(name="copy", mesh=replace(part.mesh.mesh, doflocs=np.vstack([places.real, places.imag])))


def test_walls_of_each_kind_are_made_of_cells(divided):
    shape, _, parts = divided
    walls = [wall for part in parts.parts for wall in part.cells.walls]
    assert sorted(walls) == list(range(len(shape.curves)))
    assert parts.core.node_count + sum(part.mesh.node_count for part in parts.parts) < 5e4


def test_parts_fill_the_disc(divided):
    """Area, and its first moments, which are zero about the centre."""
    shape, _, parts = divided
    bodies = [parts.core, *(copy for part in parts.parts for copy in moved(part))]
    found = sum(area_loads(body)[0::2, [0]].sum() for body in bodies)
    # Quadratic edges follow the walls to 1e-5 of their turn.
    assert found == pytest.approx(shape.area, rel=1e-6)
    about = sum(area_loads(body)[1::2, 2].sum() for body in bodies)
    assert abs(about) < 1e-6 * shape.area * shape.flank.profile.tip_radius


def test_copies_meet_node_by_node(divided):
    """A shared node is one of the core, or of one other copy; and the core is free nowhere but on a wall of its own."""
    shape, _, parts = divided
    apart = SAME_NODE * shape.flank.profile.tip_radius
    placed = [parts.core.places]
    for part in parts.parts:
        placed += [
            turn * part.mesh.places[part.shared] + shift for turn, shift in zip(part.turns, part.shifts, strict=True)
        ]
    every = np.concatenate(placed)
    tree = cKDTree(np.column_stack([every.real, every.imag]))
    alike = [len(near) for near in tree.query_ball_point(tree.data, apart)]
    assert min(alike[len(placed[0]) :]) == 2
    outside = np.unique(np.concatenate([parts.core.boundary_nodes(name).ravel() for name in parts.core.boundary_names]))
    assert min(alike[node] for node in outside) == 2
    assert max(np.delete(alike[: len(placed[0])], outside)) == 1


def test_walls_are_exact(divided):
    """All nodes on a wall of a copy lie on the curve of its own wall."""
    shape, _, parts = divided
    for part in parts.parts:
        nodes = part.mesh.boundary_nodes(shape.curves[part.cells.walls[0]].name)[part.wall_edges].ravel()
        for number, copy in enumerate(moved(part)):
            curve = shape.curves[part.cells.walls[number // part.cells.count]]
            places = copy.places[nodes]
            away = np.abs(curve.points(curve.parameter_of(places)) - places)
            assert np.max(away) < 1e-10 * shape.flank.profile.tip_radius


def test_each_station_is_in_one_cell_and_no_patch_across_a_cut(divided):
    shape, stations, _ = divided
    places = stations.refined(shape)
    for cells in stations.cells(shape):
        times = 2 if cells.walls[0] else 1
        for every, each in ((stations, 1), (places, times)):
            found = np.concatenate([every.of_cell(cells, copy, each) for copy in range(cells.count * len(cells.walls))])
            assert sorted(found) == np.flatnonzero(np.isin(every.boundary, cells.walls)).tolist()
            curve, own = shape.curves[cells.walls[0]], every.of_cell(cells, 0, each)
            ends = curve.points(cells.cut + 2.0 * np.pi / cells.count * np.arange(2))
            distance = np.abs(every.points[own][:, None] - ends)
            # A chord is shorter than the arc, by less than one per cent over half the distance of two stations.
            assert np.all(distance > 0.99 * every.half_width[own][:, None])


def test_lobes_that_differ_belong_to_the_core():
    shape = disc_of("paper")
    assert lobes_alike(shape)
    dented = replace(shape, flank=_Dented(profile=shape.flank.profile))
    assert not lobes_alike(dented)
    assert 0 not in {wall for cells in DiscStations.of_disc(shape).cells(dented) for wall in cells.walls}


class _Dented(type(disc_of("paper").flank)):
    """A flank with one lobe lower by 10 nm."""

    def points(self, parameter):
        dent = 1e-5 * np.exp(-((np.angle(np.exp(1j * (parameter - 0.3))) / 0.05) ** 2))
        return super().points(parameter) - dent * self.normals(parameter)


def test_patches_of_other_widths_make_no_cells():
    shape = disc_of("paper")
    stations = DiscStations.of_disc(shape)
    uneven = replace(stations, half_width=stations.half_width * np.linspace(0.9, 1.0, stations.count))
    assert uneven.cells(shape) == []


def test_collars_narrower_than_elements_are_left_out():
    """With a quarter of the stations and coarse elements a collar would be meshed by slivers."""
    shape = disc_of("robot-joint")
    stations = DiscStations.of_disc(shape, 0.25)
    cells = stations.cells(shape)
    parts = mesh_disc_parts(shape, disc_size_field(shape, stations, 4.0), cells)
    assert len(parts.parts) < len(cells)
