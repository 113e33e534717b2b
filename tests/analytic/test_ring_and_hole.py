"""Elasticity against closed forms: Lamé's ring and Kirsch's hole, with the order of convergence.

Lamé: Timoshenko & Goodier, *Theory of Elasticity*, 28. Kirsch: 35; displacements by Muskhelishvili's
potentials with κ = 3 − 4ν (plane strain).
"""

import numpy as np
import pytest
import scipy.sparse as sp
from skfem import Basis, ElementTriP2, ElementVector

from fem.body.condensation import condense_body
from fem.body.elasticity import area_loads, assemble_stiffness, rigid_modes, traction_load
from fem.body.stress import recover_stress
from fem.mesh.triangulation import mesh_ring
from fem.shapes import RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
NU, MODULUS = STEEL.poisson_ratio, STEEL.youngs_modulus
SHEAR = 0.5 * MODULUS / (1.0 + NU)
KAPPA = 3.0 - 4.0 * NU
THICKNESS = 7.0


def lame(inner, outer, pressure):
    """Displacement and radial, hoop stress of a ring under inner pressure."""
    level = pressure * inner**2 / (outer**2 - inner**2)

    def displacement(x, y):
        r2 = x**2 + y**2
        factor = (1.0 + NU) / MODULUS * level * ((1.0 - 2.0 * NU) + outer**2 / r2)
        return np.stack([factor * x, factor * y])

    return displacement, lambda r: (level * (1.0 - outer**2 / r**2), level * (1.0 + outer**2 / r**2))


def kirsch_stress(x, y, radius, far):
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    q = radius**2 / r**2
    rr = 0.5 * far * ((1.0 - q) + (1.0 - 4.0 * q + 3.0 * q**2) * np.cos(2.0 * theta))
    tt = 0.5 * far * ((1.0 + q) - (1.0 + 3.0 * q**2) * np.cos(2.0 * theta))
    rt = -0.5 * far * (1.0 + 2.0 * q - 3.0 * q**2) * np.sin(2.0 * theta)
    c, s = np.cos(theta), np.sin(theta)
    return (
        rr * c**2 + tt * s**2 - 2.0 * rt * s * c,
        rr * s**2 + tt * c**2 + 2.0 * rt * s * c,
        (rr - tt) * s * c + rt * (c**2 - s**2),
    )


def kirsch_displacement(x, y, radius, far):
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    a, factor = radius, far * radius / (8.0 * SHEAR)
    ux = r / a * (KAPPA + 1.0) * np.cos(theta)
    ux = (
        ux
        + 2.0 * a / r * ((1.0 + KAPPA) * np.cos(theta) + np.cos(3.0 * theta))
        - 2.0 * (a / r) ** 3 * np.cos(3 * theta)
    )
    uy = r / a * (KAPPA - 3.0) * np.sin(theta)
    uy = (
        uy
        + 2.0 * a / r * ((1.0 - KAPPA) * np.sin(theta) + np.sin(3.0 * theta))
        - 2.0 * (a / r) ** 3 * np.sin(3 * theta)
    )
    return np.stack([factor * ux, factor * uy])


def solve_free(body, force):
    stiffness = assemble_stiffness(body, STEEL, thickness=THICKNESS)
    return condense_body(body, stiffness, sp.csc_matrix(force[:, None])).displacement(np.array([1.0]))


def relative_error(body, u, exact):
    """L2 error relative to the L2 norm of the exact displacement, rigid motions taken out of the difference."""
    basis = Basis(body.mesh, ElementVector(ElementTriP2()), intorder=8)
    modes, area = rigid_modes(body), area_loads(body)
    at_nodes = np.empty_like(u)
    at_nodes[0::2], at_nodes[1::2] = exact(*body.mesh.doflocs)
    rigid = np.linalg.solve(modes.T @ area, area.T @ (u - at_nodes))
    found = np.asarray(basis.interpolate(u - modes @ rigid))
    wanted = exact(*np.asarray(basis.global_coordinates()))
    return np.sqrt(np.sum((found - wanted) ** 2 * basis.dx) / np.sum(wanted**2 * basis.dx))


@pytest.fixture(scope="module")
def pressed_rings():
    """A ring under 100 MPa inside, on meshes halved twice: bodies and displacements."""
    shape = RingShape(inner_radius=10.0, outer_radius=20.0, name="ring")
    bodies = [mesh_ring(shape, coarse_size=size) for size in (2.0, 1.0, 0.5)]
    loads = [
        traction_load(body, "inner", lambda x, n: (-100.0 * n[0], -100.0 * n[1]), thickness=THICKNESS)
        for body in bodies
    ]
    return [(body, solve_free(body, load)) for body, load in zip(bodies, loads, strict=True)]


@pytest.mark.slow
def test_lame_ring(pressed_rings):
    displacement, stresses = lame(10.0, 20.0, 100.0)
    errors = [relative_error(body, u, displacement) for body, u in pressed_rings]
    body, u = pressed_rings[-1]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert errors[0] < 5e-3
    assert orders[-1] >= 2.5
    stress = recover_stress(body, u, STEEL)
    x, y = body.mesh.doflocs
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    radial, hoop = stresses(r)
    c, s = np.cos(theta), np.sin(theta)
    found = stress.xx * s**2 + stress.yy * c**2 - 2.0 * stress.xy * s * c
    # 0.5 % of the largest stress everywhere, boundary nodes included.
    assert np.max(np.abs(found - hoop)) < 5e-3 * np.max(hoop)
    np.testing.assert_allclose(stress.zz, NU * (stress.xx + stress.yy))
    assert np.max(np.abs(stress.zz - NU * (radial + hoop))) < 5e-3 * np.max(hoop)


@pytest.mark.slow
def test_recovered_stress_converges(pressed_rings):
    _, stresses = lame(10.0, 20.0, 100.0)
    errors = []
    for body, u in pressed_rings:
        stress = recover_stress(body, u, STEEL)
        radial, hoop = stresses(np.hypot(*body.mesh.doflocs))
        von_mises = np.sqrt(
            0.5 * ((radial - hoop) ** 2 + (hoop - NU * (radial + hoop)) ** 2 + (NU * (radial + hoop) - radial) ** 2)
        )
        errors.append(np.sqrt(np.mean((stress.von_mises - von_mises) ** 2)) / np.max(von_mises))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # Linear stresses inside an element would give 2 for exact samples; 1.8 leaves room for the mesh's chance.
    assert np.all(orders > 1.8)
    assert errors[-1] < 1e-3


@pytest.mark.parametrize("radius", [1.0, pytest.param(3.0, marks=pytest.mark.nightly)])
@pytest.mark.slow
def test_kirsch_hole(radius):
    """The exact tractions of the infinite plate act on a ring about the hole."""
    outer, far = 5.0 * radius, 80.0
    shape = RingShape(inner_radius=radius, outer_radius=outer, name="plate")

    def traction(x, n):
        xx, yy, xy = kirsch_stress(x[0], x[1], radius, far)
        return xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]

    errors = []
    for size in (0.24, 0.12):  # below 1/12 of a half turn, where the curvature would keep the size
        body = mesh_ring(shape, coarse_size=size * radius)
        u = solve_free(body, traction_load(body, "outer", traction, thickness=THICKNESS))
        errors.append(relative_error(body, u, lambda x, y: kirsch_displacement(x, y, radius, far)))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert errors[0] < 5e-3
    assert np.min(orders) >= 2.5
    x, y = body.mesh.doflocs
    stress = recover_stress(body, u, STEEL)
    side = np.argmin(np.abs(x + 1j * y - 1j * radius))
    assert stress.xx[side] == pytest.approx(3.0 * far, rel=5e-3)
    assert stress.principal[0].max() == pytest.approx(3.0 * far, rel=5e-3)
