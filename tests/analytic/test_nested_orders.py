"""Orders of the elements on nested meshes against closed forms, and whether error bars hold the true error.

Theory (Brenner & Scott, *The Mathematical Theory of Finite Element Methods*, 5.4, 5.7): smooth solutions by quadratic elements
converge in energy norm by 2, hence in energy and in displacements measured by smooth loads by 4; nodal stress at a boundary by 2.
"""

import numpy as np
import pytest
import scipy.sparse as sp

from fem.body.condensation import condense_body
from fem.body.elasticity import assemble_stiffness, traction_load
from fem.body.plane_references import kirsch_hoop_stress, kirsch_traction, lame_hoop_stress, pulled_ring_stress
from fem.discretisation_error import estimate_error
from fem.mesh.triangulation import mesh_ring
from fem.mesh.uniform_refinement import refine_uniformly
from fem.reducer.wall_references import wall_references
from fem.shapes import DiscShape, RingShape
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
INNER, OUTER, PRESSURE = 10.0, 20.0, 100.0


def compliances(boundary, traction, count=3):
    """Work of a load on nested meshes of a free ring, N·mm for 1 mm of thickness."""
    shape = RingShape(inner_radius=INNER, outer_radius=OUTER)
    body, found = mesh_ring(shape, coarse_size=5.0), []
    for number in range(count):
        body = refine_uniformly(body, shape.curves) if number else body
        load = traction_load(body, boundary, traction, thickness=1.0)
        stiffness = assemble_stiffness(body, STEEL, thickness=1.0)
        found.append(float(condense_body(body, stiffness, sp.csc_matrix(load[:, None])).compliance[0, 0]))
    return found


@pytest.mark.slow
def test_energy_of_lames_ring_converges_by_four():
    """To the work p·u(a)·2πa; u(a) of plane strain (Timoshenko & Goodier, 28)."""
    found = compliances("inner", lambda x, n: (-PRESSURE * n[0], -PRESSURE * n[1]))
    level = PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
    nu = STEEL.poisson_ratio
    moved = (1.0 + nu) / STEEL.youngs_modulus * level * ((1.0 - 2.0 * nu) * INNER + OUTER**2 / INNER)
    exact = PRESSURE * moved * 2.0 * np.pi * INNER
    errors = np.abs(np.array(found) - exact)
    orders = np.log2(errors[:-1] / errors[1:])
    # Coarse meshes of three edges across the wall are a third of an order off; the last pair of orders is within a tenth.
    assert orders[-1] == pytest.approx(4.0, abs=0.15)
    estimate = estimate_error(found, 4.0)
    assert estimate.order == pytest.approx(4.0, abs=0.3)
    assert abs(estimate.value - exact) <= estimate.bar


@pytest.mark.slow
def test_bars_of_wall_stress_hold_the_closed_forms(paper_cases):
    """Kirsch, Lamé and the thin ring on edges as those of the paper's disc: each true error within its bar, order about 2."""
    shape = DiscShape.of_drive(paper_cases["CS-1"])
    found = wall_references(shape, STEEL, "strain", size=4.0, meshes=3)
    assert [reference.source for reference in found] == ["Kirsch", "Lamé", "Timoshenko"]
    for reference in found:
        assert reference.held, reference
        # 1 % of a stress where three edges of the coarsest mesh follow a quarter of a hole; no bar so wide that it says nothing.
        assert abs(reference.error) < 0.01 * abs(reference.exact)
        assert reference.estimate.bar < 0.02 * abs(reference.exact)


def test_closed_forms_themselves():
    """Kirsch: 3 S beside the hole, −S before it. Lamé: the wall carries the pressure, ∫σ dr = p a. Ring: forces balance."""
    assert kirsch_hoop_stress(2.0, np.array([0.5 * np.pi, 0.0])) == pytest.approx([6.0, -2.0])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    radii, weights = 15.0 + 5.0 * nodes, 5.0 * weights
    assert weights @ lame_hoop_stress(PRESSURE, INNER, OUTER, radii) == pytest.approx(PRESSURE * INNER)
    radii, weights = 10.5 + 0.5 * nodes, 0.5 * weights / 5.0
    stress = np.array([pulled_ring_stress(7.0, 10.0, 11.0, float(radius), 0.3) for radius in radii])
    assert weights @ stress == pytest.approx(0.5 * 7.0 * np.cos(0.3))  # the force across the section
    # Tractions of the infinite plate on a circle balance.
    angle = 2.0 * np.pi * np.arange(64) / 64
    x, y = kirsch_traction(5.0, 1.0, 3.0 * np.stack([np.cos(angle), np.sin(angle)]))
    assert np.abs([x.sum(), y.sum(), (np.cos(angle) * y - np.sin(angle) * x).sum()]).max() < 1e-12
