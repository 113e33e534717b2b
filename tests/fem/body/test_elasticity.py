"""Stiffness of curved triangles: patch test, rigid modes, energy, and the parts a load is spread by."""

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, LinearForm
from skfem.models.elasticity import linear_elasticity

from fem.body.elasticity import (
    area_loads,
    assemble_stiffness,
    curved_elements,
    plane_lame_parameters,
    rigid_modes,
    strain_energy,
    traction_load,
    unknowns_of_boundary,
)
from fem.body.stress import recover_stress
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_ring
from fem.shapes import RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)


@pytest.fixture(scope="module")
def ring():
    shape = RingShape(inner_radius=10.0, outer_radius=20.0, name="ring")
    return mesh_ring(shape, [Refinement(20.0, 0.0, 0.5, 0.5)], coarse_size=4.0)


def linear_field(body, gradient):
    x, y = body.mesh.doflocs
    u = np.zeros(2 * len(x))
    u[0::2] = gradient[0][0] * x + gradient[0][1] * y + 0.3
    u[1::2] = gradient[1][0] * x + gradient[1][1] * y - 0.2
    return u


@pytest.mark.parametrize("state", ["strain", "stress"])
def test_patch(ring, state):
    """A linear displacement leaves no force inside and gives one stress everywhere, on curved elements too."""
    gradient = np.array([[1.0e-3, 2.0e-3], [-0.5e-3, -0.7e-3]])
    stiffness = assemble_stiffness(ring, STEEL, thickness=11.8, state=state)
    u = linear_field(ring, gradient)
    force = stiffness @ u
    inside = np.ones(len(u), dtype=bool)
    for name in ("inner", "outer"):
        inside[unknowns_of_boundary(ring, name)] = False
    # Round-off: entries of K are 1e6, displacements 1e-2, and some tens of terms cancel.
    assert np.max(np.abs(force[inside])) < 1e-10 * np.max(np.abs(force))
    strain = 0.5 * (gradient + gradient.T)
    nu, modulus = STEEL.poisson_ratio, STEEL.youngs_modulus
    compliance = (1.0 + nu) / modulus * np.array([[1.0 - nu, -nu], [-nu, 1.0 - nu]])
    if state == "stress":
        compliance = np.array([[1.0, -nu], [-nu, 1.0]]) / modulus
    xx, yy = np.linalg.solve(compliance, np.diag(strain))
    xy = modulus / (1.0 + nu) * strain[0, 1]
    stress = recover_stress(ring, u, STEEL, state=state)
    for found, expected in ((stress.xx, xx), (stress.yy, yy), (stress.xy, xy)):
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    np.testing.assert_allclose(stress.zz, nu * (xx + yy) if state == "strain" else 0.0, rtol=1e-9)


@pytest.mark.parametrize("state", ["strain", "stress"])
@pytest.mark.parametrize("order", [1, 2])
def test_stiffness_and_area_loads_are_those_of_the_weak_forms(order, state):
    """Element by element in scikit-fem: straight and curved triangles, either order."""
    shape = RingShape(inner_radius=10.0, outer_radius=20.0, name="ring")
    body = mesh_ring(shape, [Refinement(20.0, 0.0, 0.5, 0.5)], coarse_size=4.0, order=order)
    assert 0 < curved_elements(body).sum() < body.mesh.t.shape[1] or order == 1
    lam, mu = plane_lame_parameters(STEEL, state)
    basis = Basis(body.mesh, ElementVector(ElementTriP2() if order == 2 else ElementTriP1()), intorder=4)
    expected = linear_elasticity(11.8 * lam, 11.8 * mu).assemble(basis)
    found = assemble_stiffness(body, STEEL, thickness=11.8, state=state)
    # The same integrals summed in another order.
    assert abs(found - expected).max() < 1e-11 * abs(expected).max()

    def moment(v, w):
        return -(w.x[1] - 1.0) * v[0] + (w.x[0] - 2.0) * v[1]

    turned = LinearForm(moment).assemble(basis)
    np.testing.assert_allclose(area_loads(body, 2.0 + 1.0j)[:, 2], turned, atol=1e-12 * np.abs(turned).max())


def test_rigid_modes_are_free(ring):
    stiffness = assemble_stiffness(ring, STEEL, thickness=1.0)
    modes = rigid_modes(ring, centre=3.0 + 1.0j)
    scale = np.abs(stiffness.data).max() * np.abs(modes).max()
    assert np.max(np.abs(stiffness @ modes)) < 1e-12 * scale
    assert abs(stiffness - stiffness.T).max() < 1e-12 * np.abs(stiffness.data).max()


def test_area_loads_know_area_and_moment(ring):
    gram = rigid_modes(ring).T @ area_loads(ring)
    area, polar = np.pi * (20.0**2 - 10.0**2), 0.5 * np.pi * (20.0**4 - 10.0**4)
    # The isoparametric boundary leaves the circle by 2e-6 of the radius at most.
    np.testing.assert_allclose(np.diag(gram), [area, area, polar], rtol=2e-5)


def test_energy_is_half_the_work(ring):
    stiffness = assemble_stiffness(ring, STEEL, thickness=2.0)
    u = linear_field(ring, np.array([[1.0e-3, 0.0], [0.0, 0.0]]))
    lam_2mu = STEEL.youngs_modulus * 0.7 / (1.3 * 0.4)
    expected = 0.5 * lam_2mu * 1.0e-6 * 2.0 * np.pi * 300.0
    assert strain_energy(stiffness, u) == pytest.approx(expected, rel=2e-5)


def test_traction_sums_to_its_resultant(ring):
    force = traction_load(ring, "outer", lambda x, n: (0.0 * x[0], 5.0 + 0.0 * x[0]), thickness=3.0)
    assert force[1::2].sum() == pytest.approx(5.0 * 3.0 * 2.0 * np.pi * 20.0, rel=1e-5)
    assert abs(force[0::2].sum()) < 1e-9


def test_missing_boundary_is_named(ring):
    with pytest.raises(MeshError, match="no boundary 'flank'"):
        unknowns_of_boundary(ring, "flank")
