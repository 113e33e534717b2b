"""Stress along walls by measures of their strain, against Kirsch's hole, Lamé's ring and the disc under balanced loads.

Kirsch, Lamé: Timoshenko & Goodier, *Theory of Elasticity*, 35 and 28. A solid disc under normal loads in balance has no
stress along its edge but right under the loads (41): every load sends a simple radial distribution −2F cos/(π r t), which at
the edge is −2F/(π D t) along a chord that meets the edge at half the angle between load and place; with the uniform
tension ΣF/(π D t) that frees the edge, −Σ F cos(φ − α)/(π D t) is left along it, which balance makes zero.
"""

import numpy as np
import pytest
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, rigid_modes
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.wall_strain import continue_under_patches, wall_modulus, wall_strain_measures
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle, mesh_ring
from fem.shapes import CircleShape, RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
THICKNESS = 7.0
PLACES = 24
ANGLES = 2.0 * np.pi * np.arange(PLACES) / PLACES


def stress_matrix(body, curves, width, state="strain"):
    """Stress at 24 places of each boundary by a newton on a patch at each, and the resultants of the patches."""
    patches = sp.hstack([patch_loads(body, curve, ANGLES, width, along_normals=True) for curve in curves])
    measures = sp.hstack([wall_strain_measures(body, curve, ANGLES, width) for curve in curves])
    stiffness = assemble_stiffness(body, STEEL, thickness=THICKNESS, state=state)
    condensed = condense_body(body, stiffness, sp.hstack([patches, wall_modulus(STEEL, state) * measures]))
    count = patches.shape[1]
    return condensed.compliance[count:, :count], condensed.resultants


def spots(points, width):
    return [Refinement(point.real, point.imag, 0.4 * width, 1.2 * width) for point in points]


@pytest.mark.slow
@pytest.mark.parametrize("state", ["strain", "stress"])
def test_lame_ring_by_patches(state):
    """Even pressure by 24 patches on one wall: the wall opposite, and this one but for the pressure right under it."""
    inner, outer, width = 10.0, 20.0, 0.5
    shape = RingShape(inner_radius=inner, outer_radius=outer, name="ring")
    points = np.concatenate([curve.points(ANGLES) for curve in shape.curves])
    body = mesh_ring(shape, spots(points, width), growth=0.4)
    stress, resultants = stress_matrix(body, shape.curves, width, state)
    # What measures a strain balances itself.
    assert np.max(np.abs(resultants[:, 2 * PLACES :])) < 1e-9 * wall_modulus(STEEL, state)
    smooth = continue_under_patches(stress, *[np.repeat([0, 1], PLACES)] * 2)
    pressure, between = 100.0, outer**2 - inner**2
    for radius, own, inside in ((outer, slice(0, PLACES), False), (inner, slice(PLACES, None), True)):
        loads = np.zeros(2 * PLACES)
        loads[own] = pressure * 2.0 * np.pi * radius / PLACES * THICKNESS
        found = (smooth @ loads).reshape(2, PLACES)
        hoop_outer = 2.0 * inner**2 / between if inside else -(outer**2 + inner**2) / between
        hoop_inner = (outer**2 + inner**2) / between if inside else -2.0 * outer**2 / between
        expected = pressure * np.array([hoop_outer, hoop_inner])
        # −p along the pressed wall is left out: added, it is no part of what remains.
        expected[1 if inside else 0] += pressure
        # Mesh 0.1 %; patches short of an even pressure and the polynomial through the gap of each 0.2 %.
        np.testing.assert_allclose(
            found, np.broadcast_to(expected[:, None], found.shape), atol=4e-3 * np.abs(expected).max()
        )


def test_solid_disc_under_balanced_loads():
    width = 0.4
    shape = CircleShape(name="disc", radius=10.0)
    body = mesh_circle(shape, spots(shape.curves[0].points(ANGLES), width), growth=0.4)
    stress, _ = stress_matrix(body, shape.curves, width)
    smooth = continue_under_patches(stress, *[np.zeros(PLACES, dtype=int)] * 2)
    loads = np.zeros(PLACES)
    # 3, 4 and 5 kN at the angles of their triangle; and two opposite ones.
    for angle, force in ((0.0, 3e3), (90.0, 4e3), (180.0, 3e3), (270.0, 4e3), (45.0, 1e3), (165.0, 1e3), (285.0, 1e3)):
        loads[round(angle / 15.0)] += force
    unit = 2.0 * loads.max() / (np.pi * 20.0 * THICKNESS)
    # Of the chords' 18 MPa each nothing is left but the mesh, 0.1 %. (Patches that press along one direction instead of
    # their normals leave 2.4 %.)
    assert np.max(np.abs(smooth @ loads)) < 4e-3 * unit


def test_kirsch_hole_and_rigid_motions():
    """The exact displacement on the nodes: the measure reads the exact hoop stress σ (1 − 2 cos 2θ)."""
    radius, far = 3.0, 80.0
    shape = RingShape(inner_radius=radius, outer_radius=5.0 * radius, name="plate")
    body = mesh_ring(shape, coarse_size=0.2 * radius)
    x, y = body.mesh.doflocs
    r, theta, kappa = np.hypot(x, y), np.arctan2(y, x), 3.0 - 4.0 * 0.3
    factor = far * radius / (8.0 * 206_000.0 / 2.6)
    u = np.empty(2 * len(x))
    a = radius
    u[0::2] = r / a * (kappa + 1.0) * np.cos(theta) + 2.0 * a / r * (
        (1.0 + kappa) * np.cos(theta) + np.cos(3.0 * theta)
    )
    u[0::2] -= 2.0 * (a / r) ** 3 * np.cos(3.0 * theta)
    u[1::2] = r / a * (kappa - 3.0) * np.sin(theta) + 2.0 * a / r * (
        (1.0 - kappa) * np.sin(theta) + np.sin(3.0 * theta)
    )
    u[1::2] -= 2.0 * (a / r) ** 3 * np.sin(3.0 * theta)
    width = 0.2 * radius
    measures = wall_modulus(STEEL) * wall_strain_measures(body, shape.curves[1], ANGLES, width)
    # Its mean over the arc, ε″ b²/14 off: cos 2θ falls by 4 (b/R)²/14.
    expected = far * (1.0 - 2.0 * np.cos(2.0 * ANGLES) * (1.0 - 4.0 / 14.0 * (width / radius) ** 2))
    # Quadratic edges of a fifth of the radius: 0.2 %.
    np.testing.assert_allclose(measures.T @ (factor * u), expected, atol=3e-3 * 3.0 * far)
    assert np.max(np.abs(measures.T @ rigid_modes(body))) < 1e-10 * wall_modulus(STEEL)
