"""Plane closed forms that finite elements are held against: what their source says of hole and far field."""

import numpy as np

from fem.body.plane_references import kirsch_hoop_stress, kirsch_traction

TENSION, RADIUS = 80.0, 5.0
ANGLE = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)


def traction(radius):
    return np.array(kirsch_traction(TENSION, RADIUS, radius * np.stack((np.cos(ANGLE), np.sin(ANGLE)))))


def test_the_wall_of_kirschs_hole_is_free():
    np.testing.assert_allclose(traction(RADIUS), 0.0, atol=1e-12 * TENSION)


def test_far_from_kirschs_hole_the_plate_is_pulled_evenly():
    far = traction(1e6 * RADIUS)
    np.testing.assert_allclose(far, [TENSION * np.cos(ANGLE), np.zeros(60)], atol=1e-10 * TENSION)


def test_a_ring_about_kirschs_hole_is_in_balance_with_the_stress_across_it():
    """Half of the plate, y > 0: the hoop stress over the section θ = 0 balances the traction on the arc, by quadrature."""
    outer = 4.0 * RADIUS
    nodes, weights = np.polynomial.legendre.leggauss(40)
    theta = 0.5 * np.pi * (nodes + 1.0)
    x, y = kirsch_traction(TENSION, RADIUS, outer * np.stack((np.cos(theta), np.sin(theta))))
    on_arc = outer * 0.5 * np.pi * (weights @ y)
    r = 0.5 * (outer - RADIUS) * (nodes + 1.0) + RADIUS
    q = (RADIUS / r) ** 2
    hoop = 0.5 * TENSION * ((1.0 + q) - (1.0 + 3.0 * q**2))  # at θ = 0 and π, Timoshenko and Goodier (61)
    np.testing.assert_allclose(on_arc, 2.0 * 0.5 * (outer - RADIUS) * (weights @ hoop), rtol=1e-9)
    np.testing.assert_allclose(hoop[np.argmin(r)], kirsch_hoop_stress(TENSION, np.array(0.0)), rtol=0.02)
    assert abs(weights @ x) < 1e-12 * TENSION
