"""Extruded bodies against exact states: rigid motions, linear displacements, classes of half a body, a bar under its weight."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says
from skfem import MeshQuad, MeshQuad2

from fem.body.condensation import order_nodes
from fem.errors import MeshError
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleShape, RingShape
from fem.solid.extruded import ExtrudedBody
from fem.solid.factor import SymmetricFactor, _superlu
from fem.solid.layers import Layers, graded_layers
from fem.solid.section import Section
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)
CLASSES = ("symmetric", "antisymmetric", "whole")
# Sums of some thousand products of numbers of the size of the stiffness, each rounded to 1e-16.
ROUND_OFF = 1e-12


def cylinder(parity, *, number=2, coarse=2.5):
    body = mesh_circle(CircleShape(name="roller", radius=5.0), coarse_size=coarse)
    return body, ExtrudedBody(section=Section.of_body(body), layers=graded_layers(8.0, number, parity, finest=0.5))


def square(parity):
    mesh = MeshQuad2.from_mesh(MeshQuad().refined(1))
    section = Section.of_quadrilaterals("block", mesh)
    return ExtrudedBody(section=section, layers=graded_layers(2.0, 1, parity))


def field(body, gradient):
    """Nodal values of u = G x, G by component and axis, of a class that can hold it."""
    x, y = body.section.places
    heights = body.layers.heights
    columns = []
    for component in range(3):
        z = heights[body.layers.free_along_axis if component == 2 else body.layers.free_in_plane]
        g = gradient[component]
        columns.append(g[0] * x[:, None] + g[1] * y[:, None] + g[2] * z[None, :])
    return np.concatenate(columns, axis=1).ravel()


def energy_density(gradient, material):
    strain = 0.5 * (gradient + gradient.T)
    e, nu = material.youngs_modulus, material.poisson_ratio
    lam, mu = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    return 0.5 * lam * np.trace(strain) ** 2 + mu * np.sum(strain**2)


@pytest.mark.parametrize("parity", CLASSES)
@pytest.mark.parametrize("make", [lambda parity: cylinder(parity)[1], square], ids=["triangles", "quadrilaterals"])
def test_stiffness_is_symmetric_and_knows_nothing_of_rigid_motions(parity, make):
    body = make(parity)
    stiffness = body.assemble_stiffness(STEEL)
    size = abs(stiffness).max()
    assert abs(stiffness - stiffness.T).max() <= ROUND_OFF * size
    motions = body.rigid_motions()
    assert motions.shape[1] == {"whole": 6}.get(parity, 3)
    assert np.abs(stiffness @ motions).max() <= ROUND_OFF * size * np.abs(motions).max()


@pytest.mark.parametrize(
    ("parity", "which"),
    [
        ("symmetric", [(0, 0), (0, 1), (1, 1), (2, 2)]),
        ("antisymmetric", [(0, 2), (1, 2), (2, 0), (2, 1)]),
        ("whole", [(a, b) for a in range(3) for b in range(3)]),
    ],
)
def test_linear_displacements_have_the_energy_of_their_strain_and_load_the_surface_alone(parity, which):
    # Patch test: quadratic elements hold linear displacements exactly, on any mesh.
    _, body = cylinder(parity)
    gradient = np.zeros((3, 3))
    for number, entry in enumerate(which):
        gradient[entry] = 1e-3 * (1.0 + 0.37 * number)
    u = field(body, gradient)
    force = body.assemble_stiffness(STEEL) @ u
    # The mesh's own volume: that of its curved triangles.
    volume = (
        float(np.ones(body.unknowns) @ body.mass_times(np.ones(body.unknowns)[:, None])[:, 0])
        if parity == "whole"
        else None
    )
    area = np.pi * 25.0
    expected = energy_density(gradient, STEEL) * (volume / 3.0 if volume else area * 8.0)
    # Quadratic edges of 2.5 mm on a circle of 5 mm miss some 1e-4 of its area; the volume of "whole" is exact.
    assert 0.5 * u @ force == pytest.approx(expected, rel=ROUND_OFF * 100 if volume else 2e-3)
    radius = np.hypot(*body.section.places)
    inner = np.flatnonzero(radius < 3.0)
    middle = body.unknowns_of(inner, 0)[:, 1:-1] if parity == "whole" else body.unknowns_of(inner, 0)[:, 1:2]
    assert np.abs(force[middle]).max() <= ROUND_OFF * np.abs(force).max()


@pytest.mark.slow
def test_classes_of_half_a_body_are_the_solutions_of_the_whole_one():
    # A load even along z and one linear in z at the same place: nodes of both meshes are the same, so answers are.
    plane = None
    found = {}
    for parity, density in (
        ("symmetric", lambda z: 0.0 * z + 1.0 / 8.0),
        ("antisymmetric", lambda z: 12.0 * z / 8.0**3),
        ("whole", None),
    ):
        mesh = mesh_ring(RingShape(inner_radius=2.0, outer_radius=5.0), coarse_size=2.0)
        body = ExtrudedBody(section=Section.of_body(mesh), layers=graded_layers(8.0, 2, parity, finest=0.6))
        core = np.unique(mesh.boundary_nodes("inner"))
        outer = mesh.boundary_nodes("outer")[:3].ravel()
        plane = np.zeros((2 * mesh.node_count, 1))
        plane[2 * outer, 0], plane[2 * outer + 1, 0] = -1.0, 0.3
        order = order_nodes(mesh)
        unknowns = (order[:, None] * body.per_node + np.arange(body.per_node)).ravel()
        held = np.zeros(body.unknowns, dtype=bool)
        for component in range(3):
            held[body.unknowns_of(core, component).ravel()] = True
        factor = SymmetricFactor(body.assemble_stiffness(STEEL), unknowns[~held[unknowns]])
        densities = [density] if density else [lambda z: 0.0 * z + 1.0 / 8.0, lambda z: 12.0 * z / 8.0**3]
        for name, each in zip([parity] if density else ["symmetric", "antisymmetric"], densities, strict=True):
            load = body.spread(plane, each)
            found[parity, name] = float((load.T @ factor.solve(load))[0, 0])
    for name in ("symmetric", "antisymmetric"):
        # Round-off of two factorisations of stiffness with a condition of some 1e4.
        assert found["whole", name] == pytest.approx(found[name, name], rel=1e-10)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("solver", ["SuperLU", pytest.param("CHOLMOD", marks=pytest.mark.needs("fast"))])
def test_a_hanging_bar_stretches_as_by_hand(solver, monkeypatch):
    # Under its own weight along the axis a bar has σ_z = ρ g z': with ν = 0 quadratic elements hold w exactly.
    if solver == "SuperLU":
        monkeypatch.setattr("fem.solid.factor.cholmod_is_there", lambda: False)
    soft = Material(youngs_modulus=1000.0, poisson_ratio=0.0)
    mesh, body = cylinder("whole")
    weight = 2.5  # N/mm³
    motion = np.zeros((body.unknowns, 1))
    motion[body.unknowns_of(np.arange(mesh.node_count), 2).ravel(), 0] = -weight
    order = order_nodes(mesh)
    unknowns = (order[:, None] * body.per_node + np.arange(body.per_node)).ravel()
    held = np.zeros(body.unknowns, dtype=bool)
    everywhere = np.arange(mesh.node_count)
    held[body.unknowns_of(everywhere, 2)[:, -1]] = True
    # u and v hang free: with ν = 0 nothing moves them.
    held[body.statically_determinate((0, 40, 80))[:3]] = True
    answer = SymmetricFactor(body.assemble_stiffness(soft), unknowns[~held[unknowns]]).solve(body.mass_times(motion))
    lowest = answer[body.unknowns_of(everywhere, 2)[:, 0], 0]
    np.testing.assert_allclose(lowest, -weight * 8.0**2 / (2.0 * 1000.0), rtol=1e-9)


@pytest.mark.needs("fast")
def test_factor_by_superlu_and_by_cholmod_agree():
    mesh, body = cylinder("symmetric")
    order = order_nodes(mesh)
    unknowns = (order[:, None] * body.per_node + np.arange(body.per_node)).ravel()
    held = np.zeros(body.unknowns, dtype=bool)
    held[body.statically_determinate((0, 40, 80))] = True
    kept = unknowns[~held[unknowns]]
    stiffness = body.assemble_stiffness(STEEL)
    right = np.random.default_rng(3).normal(size=(body.unknowns, 20))
    inner = stiffness[kept][:, kept].tocsc()
    # Residuals of both by a condition of some 1e5.
    np.testing.assert_allclose(
        SymmetricFactor(stiffness, kept).solve(right)[kept], _superlu(inner)(right[kept]), rtol=1e-8, atol=1e-12
    )


def test_layers_become_thinner_and_end_where_they_are_told_to():
    layers = graded_layers(12.0, 3, "symmetric", finest=0.25, marks=(5.0,))
    assert layers.vertices[[0, -1]].tolist() == [0.0, 6.0]
    assert 5.0 in layers.vertices
    assert layers.thickness == 12.0
    assert graded_layers(12.0, 3, "whole").vertices.size == 7


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: graded_layers(0.0, 2, "whole"), "thickness 0 mm"),
        (lambda: graded_layers(1.0, 0, "whole"), "0 layers"),
        (lambda: graded_layers(1.0, 2, "whole", finest=1.5), "in (0, 1]"),
        (lambda: graded_layers(1.0, 2, "whole", marks=(0.7,)), "height 0.7 mm"),
        (lambda: Layers(vertices=np.array([0.0, 0.0]), parity="whole"), "ascending"),
        (lambda: Layers(vertices=np.array([1.0, 2.0]), parity="symmetric"), "must be 0"),
    ],
)
def test_layers_that_cannot_be_are_refused(make, words):
    with error_says(MeshError, words):
        make()
