"""Solid bodies: closed forms of plates and long bodies, plane strain and plane stress on either side, meshes of their own."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp

from fem.body.elasticity import area_loads, rigid_modes, traction_load
from fem.body.free_body import boundary_motion_loads
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.pieces import Pieces
from fem.coefficients.solid_bodies import SolidOptions, Support, Wall, solid_differences, solve_plane, solve_solid
from fem.coefficients.wall_strain import wall_strain_measures, wall_values
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleShape, RingShape
from fem.solid.section import Section, integrate_section
from ltca.drive.parts import Material
from ltca.reading.coefficient_laws import project_rigid_motions

STEEL = Material(youngs_modulus=206e3, poisson_ratio=0.3)
CORK = Material(youngs_modulus=30.0, poisson_ratio=0.0)
RING = RingShape(inner_radius=3.0, outer_radius=6.0)
HALF_WIDTH = 0.3
ANGLES = 2.0 * np.pi * np.arange(24) / 24


def quiet(text):
    assert text


def options(thickness, layers=2):
    return SolidOptions(thickness=thickness, layers=layers, tell=quiet, pieces=Pieces(folder=None))


def held_ring(coarse=1.0, refinements=()):
    body = mesh_ring(RING, refinements, coarse_size=coarse)
    support = Support(held=np.unique(body.boundary_nodes("inner")), balance=None)
    return body, support, patch_loads(body, RING.curves[0], ANGLES, HALF_WIDTH)


def free_cylinder(coarse=1.5, radius=5.0):
    shape = CircleShape(name="roller", radius=radius)
    body = mesh_circle(shape, coarse_size=coarse)
    support = Support(held=np.zeros(0, dtype=np.int64), balance=area_loads(body))
    return body, support, patch_loads(body, shape.curves[0], np.array([np.pi, 0.0]), 0.25)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("make", [held_ring, free_cylinder])
def test_without_lateral_strain_even_loads_know_no_ends(make):
    # ν = 0: nothing strains along the axis, so plane strain, plane stress and the solid are one, on any mesh.
    body, support, loads = make()
    found = solid_differences("cork", body, support, loads, loads, CORK, options(7.0))
    strain = solve_plane(
        body,
        integrate_section(Section.of_body(body)),
        support,
        loads,
        loads,
        material=CORK,
        thickness=7.0,
        state="strain",
    )
    # Round-off of two factorisations of stiffness with a condition of some 1e5.
    assert np.max(np.abs(found.even)) < 1e-9 * np.max(np.abs(strain))
    assert np.max(np.abs(found.flat)) < 1e-12 * np.max(np.abs(strain))


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("layers", [1, 2])
def test_thin_ring_under_linear_loads_bends_like_a_clamped_plate(layers):
    """Kirchhoff's annular plate, clamped inside: u_r = zφ, φ = C(r − a²/r), M_r = D(φ' + νφ/r) (Timoshenko, Plates, § 17)."""
    thickness, nu = 0.3, STEEL.poisson_ratio
    body, support, _ = held_ring(coarse=0.6)
    even = traction_load(body, "outer", lambda x, n: (-n[0], -n[1]), thickness=1.0)
    load = sp.csc_matrix(even[:, None])
    inner, outer = RING.inner_radius, RING.outer_radius
    measured = solve_solid(
        body, support, load, load, material=STEEL, thickness=thickness, layers=layers, parity="antisymmetric"
    )
    # A moment of 1 N mm for each mm of the edge.
    rigidity = STEEL.youngs_modulus * thickness**3 / (12.0 * (1.0 - nu**2))
    ratio = (inner / outer) ** 2
    slope = outer * (1.0 - ratio) / (rigidity * ((1.0 + nu) + (1.0 - nu) * ratio))
    # The square of t/(b − a) = 1/10, and the mesh of the plate: 0.4 % (measured; 0.5 % at half of the thickness).
    assert float(measured[0, 0]) / (2.0 * np.pi * outer) == pytest.approx(slope, rel=1e-2)


@pytest.mark.slow
@pytest.mark.family(full=1)
@pytest.mark.parametrize("material", [STEEL, replace(STEEL, poisson_ratio=0.45)])
def test_long_bodies_are_in_plane_strain_but_for_their_ends(material):
    body, support, loads = held_ring(coarse=1.5)
    strain = solve_plane(
        body,
        integrate_section(Section.of_body(body)),
        support,
        loads,
        loads,
        material=material,
        thickness=1.0,
        state="strain",
    )
    even, linear = {}, {}
    for length in (60.0, 120.0):
        found = solid_differences("long", body, support, loads, loads, material, options(length, 5))
        even[length] = np.max(np.abs(found.even)) / np.max(np.abs(strain)) * length
        linear[length] = np.max(np.abs(found.linear)) / np.max(np.abs(strain)) * length**3 / 12.0
    # Each end adds what a length of about the ring's wall, 3 mm, yields beyond plane strain, a tenth to a fifth of it: of 120 mm
    # less than a hundredth; linear loads are three times their mean at the ends.
    assert even[120.0] < 0.01
    assert linear[120.0] < 0.03
    # The same ends on twice the length: half as much. Layers of 4 to 8 mm there and of twice that hold the ends to some 10 %.
    assert even[120.0] == pytest.approx(0.5 * even[60.0], rel=0.25)
    assert linear[120.0] == pytest.approx(0.5 * linear[60.0], rel=0.25)


@pytest.mark.family(quick=1)
@pytest.mark.parametrize("thickness", [1.0, 6.0, 40.0])
def test_solid_lies_between_plane_strain_and_plane_stress(thickness):
    body, support, loads = held_ring(coarse=0.8)
    found = solid_differences("ring", body, support, loads, loads, STEEL, options(thickness))
    for energy in (found.even, found.flat - found.even):
        eigenvalues = np.linalg.eigvalsh(0.5 * (energy + energy.T))
        # Plane strain is a constraint of the same elements, exactly; plane stress lies above but for the error of the mesh.
        assert eigenvalues[0] > -1e-3 * np.max(np.abs(found.flat))
    assert np.linalg.eigvalsh(found.even)[0] > -1e-9 * np.max(np.abs(found.flat))
    share = np.trace(found.even) / np.trace(found.flat)
    assert {1.0: share > 0.6, 6.0: 0.2 < share < 0.9, 40.0: share < 0.2}[thickness]


def test_walls_of_a_ring_under_pressure_have_the_stress_of_lame():
    # Lamé's σ_θ at the unloaded wall is that of plane strain and of free ends alike, whose ends leave σ_z = 0: what the solid
    # has beyond plane strain, ε_t + ν ε_z, is nothing, although both strains differ.
    body = mesh_ring(RING, coarse_size=0.6)
    outer, inner = RING.curves
    assert (outer.name, inner.name) == ("outer", "inner")
    load = sp.csc_matrix(traction_load(body, "outer", lambda x, n: (-n[0], -n[1]), thickness=1.0)[:, None])
    support = Support(held=np.zeros(0, dtype=np.int64), balance=area_loads(body))
    wall = Wall(strains=wall_strain_measures(body, inner, ANGLES, 0.3), values=wall_values(body, inner, ANGLES))
    found = solid_differences("ring", body, support, load, load, STEEL, options(5.0, 1), wall)
    strain = solve_plane(
        body,
        integrate_section(Section.of_body(body)),
        support,
        load,
        wall.strains,
        material=STEEL,
        thickness=5.0,
        state="strain",
    )
    pressure = 1.0 / 5.0
    stress = STEEL.youngs_modulus / (1.0 - 0.3**2) * (strain + found.strain)
    lame = -2.0 * pressure * RING.outer_radius**2 / (RING.outer_radius**2 - RING.inner_radius**2)
    # The mesh: 0.1 % with three elements across the ring (quadratic).
    np.testing.assert_allclose(stress, lame, rtol=5e-3)
    assert np.max(np.abs(found.strain)) < 2e-3 * np.max(np.abs(strain))


@pytest.mark.slow
def test_differences_on_a_coarse_section_are_those_of_a_mesh_that_is_fine_at_the_patch():
    """The answer of a file, plane strain on a fine mesh and the rest on a coarse one, against the solid on the fine mesh."""
    spot = [Refinement(float(RING.outer_radius), 0.0, 0.4 * HALF_WIDTH, 1.2 * HALF_WIDTH)]
    body, support, loads = held_ring(coarse=1.0, refinements=spot)
    load = loads[:, [0]]
    coarse = held_ring(coarse=1.0)
    added = solid_differences("coarse", *coarse[:2], coarse[2][:, [0]], coarse[2], STEEL, options(6.0, 2))
    found = integrate_section(Section.of_body(body))
    strain = solve_plane(body, found, support, load, loads, material=STEEL, thickness=6.0, state="strain")
    for parity, more, scale in (("symmetric", added.even, 1.0), ("antisymmetric", added.linear, 12.0 / 36.0)):
        direct = solve_solid(body, support, load, loads, material=STEEL, thickness=6.0, layers=4, parity=parity)
        # Ends within the patch's own width are not resolved by layers of 1 mm: some tenth of the unit over b/t, 0.5 % of
        # approaches of eight units; the strain of plane strain alone is off by 4 % and more.
        assert np.max(np.abs(scale * strain + more - direct)) < 5e-3 * np.max(direct)
        assert np.max(np.abs(scale * strain - direct)) > 2e-2 * np.max(direct)


@pytest.mark.slow
def test_more_layers_change_less_and_less():
    body, support, loads = held_ring()
    answers = [
        solve_solid(body, support, loads, loads, material=STEEL, thickness=6.0, layers=layers, parity="symmetric")
        for layers in (1, 2, 4)
    ]
    first, second = (np.max(np.abs(one - other)) for one, other in pairwise(answers))
    # Quadratic elements at a free edge with a singular load: measured 4 to 10 for each halving on discs; more than 2 asked.
    assert second < 0.5 * first
    # A body that may strain in more ways gives way more (nested spaces where layers are halved evenly; nearly so graded).
    assert np.trace(answers[2]) > np.trace(answers[0])


def test_answers_are_reciprocal():
    body, support, loads = free_cylinder()
    found = solid_differences("roller", body, support, loads, loads, STEEL, options(8.0))
    for matrix in (found.even, found.linear):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-10 * np.max(np.abs(matrix)))
    # Both ends of a cylinder are alike: a mesh without that symmetry leaves its error.
    assert found.even[0, 0] == pytest.approx(found.even[1, 1], rel=2e-2)


@pytest.mark.parametrize("parity", ["symmetric", "antisymmetric"])
def test_balanced_loads_know_no_datum(parity):
    # Three rigid motions under even loads, two tilts under linear ones: projected out, datums of area and of wall agree.
    body, _, loads = held_ring()
    force = np.asarray(rigid_modes(body).T @ loads)
    resultants = force if parity == "symmetric" else np.stack([-force[1], force[0]])
    found = []
    for balance in (area_loads(body), boundary_motion_loads(body, "inner").toarray()):
        free = Support(held=np.zeros(0, dtype=np.int64), balance=balance)
        own = solve_solid(body, free, loads, loads, material=STEEL, thickness=5.0, layers=1, parity=parity)
        found.append(project_rigid_motions(own, resultants))
    # Round-off of two solutions of one factorisation each, condition some 1e5.
    np.testing.assert_allclose(found[0], found[1], atol=1e-9 * np.max(np.abs(found[0])))


def test_pieces_that_are_there_are_not_computed_again(tmp_path):
    pieces = Pieces(folder=tmp_path / "kept")
    values = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(pieces.get("disc-even", lambda: values), values)
    np.testing.assert_array_equal(pieces.get("disc-even", lambda: pytest.fail("computed")), values)
    path = tmp_path / "kept" / "disc-even.npz"
    path.write_bytes(path.read_bytes()[:40])
    np.testing.assert_array_equal(pieces.get("disc-even", lambda: 2.0 * values), 2.0 * values)
    pieces.forget()
    assert not (tmp_path / "kept").exists()
