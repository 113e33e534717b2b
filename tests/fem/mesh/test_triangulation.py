"""Meshes of the bodies: exact boundaries, areas, names, grading, determinism and limits."""

from __future__ import annotations

import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from refusals import error_says
from scipy.spatial import cKDTree
from skfem import Basis, ElementTriP2, Functional

from fem.drive.expected_contacts import expect_contacts
from fem.drive.meshes import disc_refinements, mesh_drive
from fem.errors import MemoryLimitError, MeshError
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from fem.mesh.element_size import Refinement, SizeField
from fem.mesh.gmsh_session import gmsh_model
from fem.mesh.memory_need import require_memory, solution_memory
from fem.mesh.quality import measure_quality
from fem.mesh.triangulation import estimate_unknowns, mesh_circle, mesh_disc, mesh_ring
from fem.options import SolutionOptions
from fem.shapes import CircleShape, DriveShapes, RingShape
from ltca.drive.parts import Drive
from ltca.output.resources import available_memory
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


@Functional
def one(w):
    return 1.0 + 0.0 * w.x[0]


def area_of(body: BodyMesh) -> float:
    return float(one.assemble(Basis(body.mesh, ElementTriP2(), intorder=6)))


def length_of(body: BodyMesh, name: str) -> float:
    """Length of the quadratic edges; FacetBasis cannot invert the map of small curved elements to its 1e-12."""
    first, middle, last = (
        body.mesh.doflocs[0, nodes] + 1j * body.mesh.doflocs[1, nodes] for nodes in body.boundary_nodes(name).T
    )
    s, weights = np.polynomial.legendre.leggauss(6)
    s, weights = 0.5 * (s + 1.0), 0.5 * weights
    speed = np.abs(np.outer(first, 4.0 * s - 3.0) + np.outer(middle, 4.0 - 8.0 * s) + np.outer(last, 4.0 * s - 1.0))
    return float(np.sum(speed @ weights))


@pytest.fixture(scope="module")
def drive() -> Drive:
    return load_drive("paper").cases["CS-3"]


@pytest.fixture(scope="module")
def shapes(drive: Drive) -> DriveShapes:
    return DriveShapes.of_drive(drive)


@pytest.fixture(scope="module")
def disc(drive: Drive, shapes: DriveShapes) -> BodyMesh:
    return mesh_disc(shapes.disc, disc_refinements(expect_contacts(drive, 0.5), 2.0))


def boundary_points(body: BodyMesh, name: str) -> np.ndarray:
    nodes = np.unique(body.boundary_nodes(name))
    return body.mesh.doflocs[0, nodes] + 1j * body.mesh.doflocs[1, nodes]


@pytest.mark.slow
def test_flank_nodes_lie_on_the_exact_flank(drive: Drive, shapes: DriveShapes, disc: BodyMesh) -> None:
    """All nodes, mid-sides too, stand r_P + Δr_P away from the trochoid, found by search on a dense table."""
    theta = np.linspace(0.0, 2.0 * np.pi, 1_000_000, endpoint=False)
    trochoid, _, _ = shapes.disc.flank.profile.locus(theta)
    points = boundary_points(disc, "flank")
    distance, _ = cKDTree(np.column_stack([trochoid.real, trochoid.imag])).query(
        np.column_stack([points.real, points.imag])
    )
    offset = drive.pin_wheel.pin_radius + drive.disc.equidistant_offset
    # The table is 9e-4 mm apart at most: at most 1.5e-8 mm too far. Asked for: 1e-5 mm.
    np.testing.assert_allclose(distance, offset, atol=5e-8)


def test_bore_and_hole_nodes_lie_on_their_circles(shapes: DriveShapes, disc: BodyMesh) -> None:
    for circle in (*shapes.disc.bores, *shapes.disc.holes):
        np.testing.assert_allclose(
            np.abs(boundary_points(disc, circle.name) - circle.centre), circle.radius, atol=1e-12
        )


def test_disc_area_and_bore_length(shapes: DriveShapes, disc: BodyMesh) -> None:
    # Quadratic edges of 15° lie (1 − cos 7.5°)²/15 = 5e-6 of the radius inside their circle in the mean: at most
    # 8·2π·14.1²·5e-6 = 0.05 mm² for the holes and as much again for the tightest parts of the flank, of 13442 mm².
    assert area_of(disc) == pytest.approx(shapes.disc.area, rel=7e-6)
    for circle in (*shapes.disc.bores, *shapes.disc.holes):
        # The length of such an edge is right to (α/2)⁴/180 or so: 2e-6 for 15°.
        assert length_of(disc, circle.name) == pytest.approx(2.0 * np.pi * circle.radius, rel=5e-6)


def test_area_converges_with_the_fourth_power() -> None:
    shape = RingShape(inner_radius=5.0, outer_radius=10.0)
    errors, edges = [], []
    for size in (1.2, 0.6, 0.3):
        body = mesh_ring(shape, coarse_size=size)
        errors.append(abs(area_of(body) / shape.area - 1.0))
        edges.append(len(body.mesh.boundaries["outer"]))
    orders = np.log(np.array(errors[:-1]) / errors[1:]) / np.log(np.array(edges[1:]) / edges[:-1])
    # Numbers of edges are whole and the two circles share the error: the order is 4 to within 0.3.
    assert np.all(np.abs(orders - 4.0) < 0.3), (orders, errors)


@pytest.mark.parametrize("order", [1, 2])
def test_boundaries_are_complete_disjoint_and_closed(shapes: DriveShapes, order: int) -> None:
    body = mesh_disc(shapes.disc, coarse_size=4.0, order=order)
    assert set(body.boundary_names) == {"flank", "bore", *(f"hole_{k}" for k in range(8))}
    facets = np.concatenate([body.mesh.boundaries[name] for name in body.boundary_names])
    assert len(np.unique(facets)) == len(facets)
    np.testing.assert_array_equal(np.sort(facets), np.sort(body.mesh.boundary_facets()))
    for curve in shapes.disc.curves:
        nodes = body.boundary_nodes(curve.name)
        np.testing.assert_array_equal(nodes[:, -1], np.roll(nodes[:, 0], -1))
        places = body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]
        along = places[nodes[:, -1]] - places[nodes[:, 0]]
        middle = 0.5 * (places[nodes[:, -1]] + places[nodes[:, 0]])
        # Body on the left: the right-hand normal of each edge is the outward normal of the curve.
        outward = curve.normals(curve.parameter_of(middle))
        assert np.all((-1j * along * outward.conjugate()).real > 0.9 * np.abs(along))
        facets = np.sort(body.mesh.facets[:, body.mesh.boundaries[curve.name]].T, axis=1)
        assert sorted(facets.tolist()) == sorted(np.sort(nodes[:, [0, -1]], axis=1).tolist())


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("first", [0, 1, 2])
def test_boundary_lines_do_not_depend_on_which_corner_comes_first(order: int, first: int) -> None:
    ring = mesh_ring(RingShape(inner_radius=5.0, outer_radius=10.0), order=1)
    edges = {name: ring.boundary_nodes(name) for name in ring.boundary_names}
    turned = np.roll(ring.mesh.t, first, axis=0)
    body = BodyMesh(name="ring", mesh=triangle_mesh(ring.mesh.p, turned, edges, order=order))
    for name, sign in (("outer", 1.0), ("inner", -1.0)):
        nodes = body.boundary_nodes(name)
        np.testing.assert_array_equal(nodes[:, [0, -1]], edges[name])
        x, y = body.mesh.doflocs[:, nodes[:, 0]]
        # Body on the left: counter-clockwise outside, clockwise about the hole.
        assert np.sign(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) == sign


def test_other_bodies_have_their_boundaries(drive: Drive) -> None:
    shapes = DriveShapes.of_drive(with_fields(drive, {"pin_shaft.elastic_contact": True}))
    assert DriveShapes.of_drive(drive).shaft_pins == ()  # rigid in the paper's drive
    assert set(mesh_circle(shapes.wheel_pins[0]).boundary_names) == {"surface", "core"}
    assert set(mesh_circle(shapes.rollers[0]).boundary_names) == {"surface"}
    assert set(mesh_circle(shapes.shaft_pins[0]).boundary_names) == {"surface"}
    assert set(mesh_ring(shapes.inner_race).boundary_names) == {"inner", "outer"}


def test_nodes_are_compact_and_triangles_counter_clockwise(disc: BodyMesh) -> None:
    mesh = disc.mesh
    assert disc.node_count == mesh.nvertices + mesh.nfacets
    np.testing.assert_array_equal(np.unique(mesh.t), np.arange(mesh.nvertices))
    a, b, c = np.moveaxis(mesh.doflocs[:, mesh.t], 1, 0)
    assert np.all((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0] > 0.0)
    # Euler: V − E + F = 1 − holes for a disc with bore and eight holes.
    assert mesh.nvertices - mesh.nfacets + mesh.nelements == 1 - 9


def test_mid_side_numbering_is_that_of_scikit_fem(disc: BodyMesh) -> None:
    """Node ``nvertices + f`` is the unknown of facet f of a quadratic basis, as `BodyMesh` promises."""
    basis = Basis(disc.mesh, ElementTriP2(), intorder=2)
    np.testing.assert_array_equal(basis.facet_dofs[0], disc.mesh.nvertices + np.arange(disc.mesh.nfacets))
    np.testing.assert_allclose(basis.doflocs, disc.mesh.doflocs, atol=1e-12)


def test_elements_near_a_refinement_have_the_size_asked_for() -> None:
    size, radius = 0.02, 0.2
    body = mesh_circle(CircleShape(name="roller", radius=5.0), [Refinement.polar(5.0, 1.0, size=size, radius=radius)])
    mesh = body.mesh
    ends = mesh.p[0, mesh.facets] + 1j * mesh.p[1, mesh.facets]
    away = np.abs(ends - 5.0 * np.exp(1j)).max(axis=0)
    lengths = np.abs(ends[1] - ends[0])[away < 0.95 * radius]
    assert lengths.size > 200
    # Frontal Delaunay keeps single edges within some 40 % of the size, their mean within 10 %.
    assert lengths.mean() == pytest.approx(size, rel=0.1)
    assert lengths.max() < 1.5 * size
    assert lengths.min() > 0.5 * size


def test_a_turned_mesh_keeps_its_connectivity_and_shape() -> None:
    body = mesh_circle(CircleShape(name="pin_0", radius=6.5, core_radius=2.0), [Refinement(6.5, 0.0, 0.05, 0.3)])
    turned = body.turned(1.2, "pin_7")
    assert turned.name == "pin_7"
    np.testing.assert_array_equal(turned.mesh.t, body.mesh.t)
    np.testing.assert_array_equal(turned.mesh.boundaries["surface"], body.mesh.boundaries["surface"])
    before = body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]
    after = turned.mesh.doflocs[0] + 1j * turned.mesh.doflocs[1]
    np.testing.assert_allclose(after, before * np.exp(1.2j), atol=1e-13)
    assert area_of(turned) == pytest.approx(area_of(body), rel=1e-13)


@pytest.mark.slow
def test_the_same_input_gives_the_same_mesh_in_another_process(
    drive: Drive, shapes: DriveShapes, tmp_path: Path
) -> None:
    # Options a user keeps for gmsh must not matter either.
    for name in (".gmshrc", ".gmsh-options"):
        (tmp_path / name).write_text("Mesh.ElementOrder = 2;\n")
    code = (
        "import hashlib\n"
        "from fem.drive.meshes import disc_refinements\n"
        "from fem.drive.expected_contacts import expect_contacts\n"
        "from fem.shapes import DriveShapes\n"
        "from fem.mesh.triangulation import mesh_disc\n"
        "from ltca.reading.drive_file import load_drive\n"
        "drive = load_drive('paper').cases['CS-3']\n"
        "mesh = mesh_disc(DriveShapes.of_drive(drive).disc, disc_refinements(expect_contacts(drive, 0.3), 3.0)).mesh\n"
        "print(hashlib.sha256(mesh.doflocs.tobytes() + mesh.t.tobytes()).hexdigest())\n"
    )
    child = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "HOME": str(tmp_path)},
    )
    # Other meshes before this one must leave no trace in gmsh.
    mesh_ring(shapes.inner_race)
    mesh = mesh_disc(shapes.disc, disc_refinements(expect_contacts(drive, 0.3), 3.0)).mesh
    assert hashlib.sha256(mesh.doflocs.tobytes() + mesh.t.tobytes()).hexdigest() == child.stdout.strip()


@pytest.mark.slow
@pytest.mark.family(full=1)
@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_drive_meshes_are_good_and_of_the_estimated_size(drive: Drive, shapes: DriveShapes, angle: float) -> None:
    contacts = expect_contacts(drive, angle)
    meshes = mesh_drive(shapes, contacts, SolutionOptions(size=1.5))
    assert [body.name for body in meshes.bodies][:2] == ["disc", "pin_0"]
    for body in meshes.bodies:
        quality = measure_quality(body)
        # Measured over many drives and sizes: 28° and 0.82.
        assert np.degrees(quality.smallest_angle) > 25.0
        assert quality.scaled_jacobian > 0.75
        assert quality.mean_shape > 0.93
    spots = disc_refinements(contacts, 1.5)
    estimate = estimate_unknowns(shapes.disc, spots, coarse_size=1.5 * shapes.disc.narrowest_wall / 3.0)
    assert 0.9 < estimate / meshes.disc.unknowns < 1.6


@pytest.mark.slow
def test_contacts_of_the_turned_meshes_meet_the_expected_places(drive: Drive, shapes: DriveShapes) -> None:
    """The smallest edges of every loaded pin and roller lie where the contact is expected."""
    contacts = expect_contacts(drive, 1.0)
    meshes = mesh_drive(shapes, contacts, SolutionOptions(size=2.0))
    for bodies, group in ((meshes.wheel_pins, contacts.pins), (meshes.rollers, contacts.rollers_outer)):
        assert np.any(group.half_width > 0.0)
        for body, width, direction in zip(bodies, group.half_width, group.direction, strict=True):
            if width == 0.0:
                continue
            nodes = body.boundary_nodes("surface")
            places = body.mesh.doflocs[0] + 1j * body.mesh.doflocs[1]
            lengths = np.abs(places[nodes[:, 2]] - places[nodes[:, 0]])
            contact = np.abs(places[nodes[0, 0]]) * np.exp(1j * direction)
            near = np.abs(places[nodes[:, 1]] - contact) < width
            assert np.sum(near) >= 6  # 2 b in edges of b/4, of which those at the ends lie half outside
            assert lengths[near].max() < 1.3 * 2.0 * width / 8.0
            # The zone, some 2 b to each side, is centred on the contact to within half an edge or so.
            zone = np.abs(places[nodes[:, 1]] - contact) < 4.0 * width
            weights = lengths[zone] ** -4.0  # nothing but the smallest edges counts
            centre = np.sum(weights * places[nodes[zone, 1]]) / np.sum(weights)
            assert abs(centre - contact) < 0.3 * width


def test_size_field_closed_form_against_quadrature() -> None:
    field = SizeField(balls=(Refinement(0.0, 0.0, 0.05, 0.4),), coarse_size=2.0, growth=0.3)
    r = np.linspace(0.0, 40.0, 400_001)
    excess = np.pi * np.trapezoid((field.at(r + 0j) ** -2 - 2.0**-2) * r, r)
    area = 1000.0
    empty = SizeField(balls=(), coarse_size=2.0, growth=0.3)
    per_area = empty.estimate_triangles(area) / (area / 2.0**2)
    # Both counts are rounded up, of some 2800.
    assert field.estimate_triangles(area) - empty.estimate_triangles(area) == pytest.approx(per_area * excess, abs=3.0)


def test_a_mesh_too_large_for_memory_is_refused_with_the_number(drive: Drive, shapes: DriveShapes) -> None:
    said = (" unknowns and need about ", " GB ", " are available")
    for mesh in (
        lambda: mesh_disc(shapes.disc, [Refinement(60.0, 60.0, 1e-6, 1.0)]),
        lambda: mesh_drive(shapes, expect_contacts(drive, 0.0), SolutionOptions(size=1e-4)),
    ):
        with error_says(MemoryLimitError, *said) as caught:
            mesh()
        assert caught.value.needed > caught.value.available > 0.0
        assert caught.value.unknowns > 1e9


def test_memory_limit_compares_with_what_is_given() -> None:
    require_memory(1000, 10.0, "it", available=11.0)
    with error_says(MemoryLimitError, "it would have about 1,000 unknowns"):
        require_memory(1000, 12.0, "it", available=11.0)
    assert available_memory() > 0.0
    # The two measurements it is made of: the factor, and the mesh within its rounding.
    assert solution_memory(400_000) == pytest.approx(787e6 + 400_000 * 405.0, rel=0.05)
    assert solution_memory(2_000_000) > 5.0 * solution_memory(400_000)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda s: mesh_disc(s.disc, coarse_size=0.0), "coarse element size 0 mm"),
        (lambda s: mesh_disc(s.disc, coarse_size=float("nan")), "coarse element size nan"),
        (lambda s: mesh_disc(s.disc, growth=0.0), "growth 0 of the element size"),
        (lambda s: mesh_disc(s.disc, order=3), "element order 3 of the mesh of disc"),
        (lambda s: Refinement(0.0, 0.0, -1.0, 1.0), "the size must be greater than 0"),
        (lambda s: Refinement(0.0, float("nan"), 1.0, 1.0), "the size must be greater than 0"),
    ],
)
def test_wrong_sizes_are_refused(shapes: DriveShapes, make, message: str) -> None:
    with error_says(MeshError, message):
        make(shapes)


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), float("inf")])
def test_wrong_scales_are_refused(drive: Drive, shapes: DriveShapes, scale: float) -> None:
    with pytest.raises(MeshError, match="element size"):
        mesh_drive(shapes, expect_contacts(drive, 0.0), SolutionOptions(size=scale))


def test_a_missing_boundary_is_named(disc: BodyMesh) -> None:
    with error_says(MeshError, "mesh of disc has no boundary 'hole_8'; its boundaries are: flank, bore"):
        disc.boundary_nodes("hole_8")


def test_sigterm_is_still_heard_beside_gmsh():
    """gmsh took SIGTERM away when it started: `cyclo fem` and `derive` ended without cleaning up."""
    heard = []
    before = signal.signal(signal.SIGTERM, lambda *_: heard.append(True))
    try:
        with gmsh_model("any"):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.01)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert heard
