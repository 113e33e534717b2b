"""The condensed compliance against plain solves of the whole system."""

import builtins

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from fem.body.condensation import condense_body
from fem.body.elasticity import area_loads, assemble_stiffness, rigid_modes, unknowns_of_boundary
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_ring
from fem.shapes import RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)


@pytest.fixture(scope="module")
def ring():
    shape = RingShape(inner_radius=10.0, outer_radius=20.0, name="ring")
    body = mesh_ring(shape, [Refinement(20.0, 0.0, 0.3, 0.5)], coarse_size=4.0)
    stiffness = assemble_stiffness(body, STEEL, thickness=11.8)
    nodes = body.boundary_nodes("outer")[::3, 0]
    loaded = np.concatenate([2 * nodes, 2 * nodes[::2] + 1])
    loads = sp.csc_matrix((np.ones(len(loaded)), (loaded, np.arange(len(loaded)))), shape=(body.unknowns, len(loaded)))
    return body, stiffness, loads


def test_clamped_body_matches_plain_solves(ring):
    body, stiffness, loads = ring
    fixed = unknowns_of_boundary(body, "inner")
    free = np.setdiff1d(np.arange(body.unknowns), fixed)
    plain = np.zeros(loads.shape)
    plain[free] = spla.spsolve(stiffness[free][:, free], loads[free].toarray())
    condensed = condense_body(body, stiffness, loads, fixed=fixed)
    scale = np.abs(plain).max()
    # The condition number of K is about 1e5; nothing else is lost.
    np.testing.assert_allclose(condensed.compliance, loads.T @ plain, atol=1e-10 * scale)
    np.testing.assert_allclose(condensed.displacement(np.eye(loads.shape[1])), plain, atol=1e-10 * scale)


def test_free_body_is_balanced_by_body_forces(ring):
    """The displacement solves K u = f − spread reaction, has no mean rigid motion, and S is what it says."""
    body, stiffness, loads = ring
    condensed = condense_body(body, stiffness, loads)
    modes, area = rigid_modes(body), area_loads(body)
    amounts = np.random.default_rng(5).normal(size=loads.shape[1])
    u = condensed.displacement(amounts)
    force = loads @ amounts
    balanced = force - area @ np.linalg.solve(modes.T @ area, modes.T @ force)
    assert np.max(np.abs(stiffness @ u - balanced)) < 1e-9 * np.max(np.abs(force))
    assert np.max(np.abs(area.T @ u)) < 1e-10 * np.abs(u).max() * np.abs(area).sum()
    np.testing.assert_allclose(loads.T @ u, condensed.compliance @ amounts, rtol=1e-9)


def test_compliance_is_symmetric_and_positive(ring):
    body, stiffness, loads = ring
    compliance = condense_body(body, stiffness, loads).compliance
    assert np.array_equal(compliance, compliance.T)
    # Three rigid motions are taken out of the measured displacement, nothing else.
    values = np.linalg.eigvalsh(compliance)
    assert np.all(values[:3] > -1e-12 * values[-1])
    assert values[3] > 1e-6 * values[-1]


def test_orders_of_elimination_agree(ring, monkeypatch):
    body, stiffness, loads = ring
    with_metis = condense_body(body, stiffness, loads).compliance
    plain_import = builtins.__import__

    def without_metis(name, *args, **kwargs):
        if name == "pymetis":
            raise ImportError(name)
        return plain_import(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without_metis)
    without = condense_body(body, stiffness, loads).compliance
    np.testing.assert_allclose(without, with_metis, atol=1e-11 * np.abs(with_metis).max())


@pytest.mark.needs("fast")
def test_a_mesh_that_metis_gives_up_on_is_ordered_without_it(ring, monkeypatch):
    """A slender wall ended as "unforeseen RuntimeError: Caught an unknown exception!" of its C++."""
    import pymetis

    body, stiffness, loads = ring
    expected = condense_body(body, stiffness, loads).compliance
    asked = []

    def gives_up(graph):
        asked.append(graph)
        raise RuntimeError("Caught an unknown exception!")

    monkeypatch.setattr(pymetis, "nested_dissection", gives_up)
    found = condense_body(body, stiffness, loads).compliance
    assert len(asked) == 1
    # Another order of the same elimination: round-off, as above.
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())


def test_resultants_are_forces_and_moments(ring):
    body, stiffness, loads = ring
    condensed = condense_body(body, stiffness, loads, centre=2.0 - 1.0j)
    x, y = body.mesh.doflocs
    column = loads[:, -1].toarray().ravel()
    fx, fy = column[0::2], column[1::2]
    expected = [fx.sum(), fy.sum(), ((x - 2.0) * fy - (y + 1.0) * fx).sum()]
    np.testing.assert_allclose(condensed.resultants[:, -1], expected, atol=1e-12)


def test_a_displacement_asked_for_again_is_that_of_its_own_loads(ring):
    """The last one is remembered: other amounts in between, and a caller that writes into it, must not change it."""
    body, stiffness, loads = ring
    condensed = condense_body(body, stiffness, loads, fixed=unknowns_of_boundary(body, "inner"))
    first, second = np.eye(loads.shape[1])[:2]
    found = condensed.displacement(first).copy()
    assert condensed.displacement(first) is condensed.displacement(first)
    with pytest.raises(ValueError, match="read-only"):
        condensed.displacement(first)[0] = 1.0
    # Linear in the amounts; several load cases at once are solved without the memory.
    columns = condensed.displacement(np.column_stack([first, second]))
    np.testing.assert_allclose(condensed.displacement(second), columns[:, 1], atol=1e-12 * np.abs(columns).max())
    np.testing.assert_array_equal(condensed.displacement(first), found)
