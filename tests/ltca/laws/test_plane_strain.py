"""The plane-strain law: its inverse, derivative and energy, and the self-energy of a semi-elliptic pressure."""

import numpy as np
import pytest
from scipy.integrate import dblquad

from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.laws.plane_strain import SELF_ENERGY, PlaneContactLaw

LAW = PlaneContactLaw(thickness=11.8, contact_modulus=113_187.0, datum=11.8)


def test_inverse_derivative_and_energy_belong_together():
    approach, radius = np.array([1e-9, 1e-4, 3e-3, 0.02]), np.array([2.0, 4.0, 6.0, 30.0])
    load, stiffness = LAW.load_and_stiffness(approach, radius)
    # Newton's last step is below 1e-7 of the load and convergence quadratic: 1e-13 is left.
    np.testing.assert_allclose(LAW.approach_at_load(load, radius)[0], approach, rtol=1e-12)
    step = 1e-5 * approach
    up, down = (LAW.load_and_stiffness(approach + sign * step, radius)[0] for sign in (1, -1))
    # Central differences of a function like δ^1.1: (1e-5)² and round-off over the step, 1e-10.
    np.testing.assert_allclose((up - down) / (2 * step), stiffness, rtol=1e-8)
    energies = [LAW.energy(approach + sign * step, radius) for sign in (1, -1)]
    np.testing.assert_allclose((energies[0] - energies[1]) / (2 * step), load, rtol=1e-6)


def test_open_contacts_carry_nothing():
    load, stiffness = LAW.load_and_stiffness(np.array([-0.01, 0.0]), 4.0)
    assert not load.any()
    assert not stiffness.any()


def test_pressure_and_half_width_are_hertz():
    approach = np.array([2e-3, 8e-3])
    line_load = LAW.load_and_stiffness(approach, 4.0)[0] / LAW.thickness
    np.testing.assert_allclose(LAW.half_width(approach, 4.0), line_half_width(line_load, 4.0, LAW.contact_modulus))
    np.testing.assert_allclose(LAW.mid_pressure(approach, 4.0), line_peak_pressure(line_load, 4.0, LAW.contact_modulus))


@pytest.mark.slow
def test_self_energy_of_a_semi_elliptic_pressure():
    """−⟨ln|x − x′|⟩ over √(1−x²) on both axes is −ln(1/2) + 1/4, by quadrature in the angle (x = cos)."""

    def integrand(t, s):
        return -np.log(abs(np.cos(s) - np.cos(t)) + 1e-300) * np.sin(t) ** 2 * np.sin(s) ** 2 * (2.0 / np.pi) ** 2

    value = 0.0
    for a, b in ((0.0, 1.0), (1.0, 2.0)):  # the logarithm sits on t = s: split there
        value += dblquad(
            integrand, 0.0, np.pi, (lambda s: 0.0) if a == 0.0 else (lambda s: s), (lambda s: s) if b == 1.0 else np.pi
        )[0]
    # The integrable singularity at the ends of the inner integral costs quad about 1e-6.
    assert value == pytest.approx(np.log(2.0) + SELF_ENERGY, rel=1e-5)
