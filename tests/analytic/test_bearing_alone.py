"""The crank bearing alone, its races displaced rigidly, against the load integral of Sjövall and Harris.

Sources
-------
[1] T. A. Harris, M. N. Kotzalas, *Essential Concepts of Bearing Technology* (Rolling Bearing Analysis, 5th ed.),
    ch. 7: F_r = Z K_n δ_max^n J_r(ε), ε = ½(1 − P_d/(2 δ_r)), J_r(ε) = 1/(2π) ∮ [1 − (1 − cos ψ)/(2ε)]₊^n cos ψ dψ.
    J_r for line contact, table 7.1: 0.2055, 0.2286, 0.2453, 0.2568 at ε = 0.3, 0.4, 0.5, 0.6 (the table was made
    with n = 1.1; 10/9 gives 5e-4 less), and
    Q_max = 4.08 F_r/Z for rollers without clearance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq

from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.laws.line_contact import LineContactLaw
from ltca.testing.bearing_alone import bearing_alone, roller_laws


def balanced(model, crank, displacement):
    laws = roller_laws(model)
    rays = model.geometry.rollers(np.array([crank]))
    return bearing_alone(rays, np.array([displacement]), laws).parts[0].rollers


def bearing_force(state):
    return (state.outer_load * state.outer_direction).sum(axis=1)


@pytest.mark.parametrize("clearance", [0.0, 0.03])
def test_discrete_sum_with_our_own_law(vary, clearance):
    """Books let both contacts of a roller act along its ray; the exact normals differ by d/R ~ 1e-3 of an angle."""
    drive = vary(clearance={"bearing": clearance})
    model = HalfSpaceCompliance.of_drive(drive)
    steel = 206_000.0 / (2.0 * (1.0 - 0.3**2))
    law = LineContactLaw(11.8, steel)
    inner_radius, outer_radius = 5.0 * 19.5 / 24.5, 5.0 * (29.5 + 0.5 * clearance) / (24.5 + 0.5 * clearance)

    def series(interference):
        """Load of one roller squeezed by this much: F_i(a) = F_o(interference − a)."""
        if interference <= 0.0:
            return 0.0

        def difference(inner):
            first = law.load_and_stiffness(inner, inner_radius)[0]
            return float(first - law.load_and_stiffness(interference - inner, outer_radius)[0])

        inner = brentq(difference, 0.0, interference, xtol=1e-16)
        return float(law.load_and_stiffness(inner, inner_radius)[0])

    for displacement, crank in ((0.02, 0.0), (0.045, 0.7), (0.06, 2.0)):
        toward = 1.1
        state = balanced(model, crank, -displacement * np.exp(1j * toward))
        force = bearing_force(state)[0]
        # place of the rollers from the convention, independent of the code: cage at r_i/(r_i + r_o) of the crank
        psi = 19.5 / 49.0 * crank + 2.0 * np.pi * np.arange(11) / 11 - toward
        loads = np.array([series(displacement * np.cos(angle) - 0.5 * clearance) for angle in psi])
        expected = (loads * np.exp(1j * (psi + toward))).sum()
        assert np.count_nonzero(loads) >= 3
        # obliquity: the outer approach and direction change by (d sin ψ)²/(2·24.5 mm), 5e-5 of 0.06 mm and twice
        # that of a share of it, and d/24.5 in direction, which mirror rollers almost cancel
        assert abs(force - expected) < 2e-3 * abs(expected)
        np.testing.assert_allclose(state.outer_load[0], loads, atol=3e-3 * loads.max())


def test_obliquity_is_what_is_left(vary):
    """The same with the exact normals: F_i = F_o (n_o·n), each roller by root finding; agrees to round-off."""
    clearance, displacement, crank = 0.03, 0.05 * np.exp(2.2j), 4.0
    drive = vary(clearance={"bearing": clearance})
    model = HalfSpaceCompliance.of_drive(drive)
    law = LineContactLaw(11.8, 206_000.0 / (2.0 * (1.0 - 0.3**2)))
    radius = (5.0 * 19.5 / 24.5, 5.0 * 29.515 / 24.515)
    total = 0.0
    for number in range(11):
        ray = np.exp(1j * (19.5 / 49.0 * crank + 2.0 * np.pi * number / 11))

        def parts(place, ray=ray):
            arm = place * ray - displacement
            outer = law.load_and_stiffness(abs(arm) + 5.0 - 29.515, radius[1])[0]
            inner = law.load_and_stiffness(24.5 - place, radius[0])[0]
            return float(inner), float(outer), arm / abs(arm)

        if parts(24.5)[1] == 0.0:
            continue
        place = brentq(
            lambda s, ray=ray: parts(s, ray)[0] - parts(s, ray)[1] * (parts(s, ray)[2] * ray.conjugate()).real,
            24.3,
            24.5,
            xtol=1e-15,
            rtol=1e-15,
        )
        total += parts(place)[1] * parts(place)[2]
    state = balanced(model, crank, displacement)
    assert abs(bearing_force(state)[0] - total) < 1e-8 * abs(total)


@dataclass(frozen=True)
class PowerLaw:
    factor: float
    exponent: float = 1.1

    def load_and_stiffness(self, approach, effective_radius):
        pressed = np.maximum(approach, 0.0) + 0.0 * effective_radius
        return self.factor * pressed**self.exponent, self.factor * self.exponent * pressed ** (self.exponent - 1.0)
