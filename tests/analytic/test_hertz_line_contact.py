"""Long rollers against Hertz at mid-width, and long strips against their closed-form approach."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.contact.pressure_cells import solve_cylinder_patch
from ltca.contact.subsurface import find_subsurface_shear, patch_stress
from ltca.drive.parts import Material, contact_modulus
from ltca.laws.line_contact import LineContactLaw
from validation import hertz

STEEL = Material(youngs_modulus=206e3, poisson_ratio=0.3)
MODULUS = contact_modulus(STEEL, STEEL)


@pytest.mark.parametrize("cells", [8, 16])
@pytest.mark.parametrize(("length", "radius", "approach"), [(11.8, 2.0, 5e-3), (40.0, 2.0, 5e-3), (200.0, 5.0, 1e-3)])
def test_mid_width_of_a_long_roller_is_hertz(length, radius, approach, cells):
    solution = solve_cylinder_patch(length, radius, MODULUS, approach, cells=cells)
    x, pressure = solution.mid_profile
    line_load = 2.0 * float(np.sum(pressure)) * (x[1] - x[0])
    # required 0.3 %; half-width and peak are corrected for the cells, without that 8 of them err by 0.2 %
    assert solution.mid_pressure == pytest.approx(float(line_peak_pressure(line_load, radius, MODULUS)), rel=4e-4)
    assert solution.half_width == pytest.approx(float(line_half_width(line_load, radius, MODULUS)), rel=4e-4)
    shape = solution.mid_pressure * np.sqrt(np.maximum(1.0 - (x / solution.half_width) ** 2, 0.0))
    inside = x < solution.half_width - 2 * (x[1] - x[0])
    # two cells from the edge's square root constant cells follow the profile within 0.1 %
    np.testing.assert_allclose(pressure[inside], shape[inside], rtol=2e-3)


def test_tabulated_pressure_and_half_width_belong_together():
    """p = E* b/(2ρ) holds for Hertz whatever the load: the two curves of the table are tied for long contacts."""
    law = LineContactLaw(11.8, MODULUS)
    for slenderness, tolerance in ((300.0, 3e-4), (3e3, 2e-4), (3e4, 2e-4)):
        approach = 11.8**2 / (2.0 * slenderness**2)
        expected = MODULUS * law.half_width(approach, 2.0) / 4.0
        # both curves are accurate to 1e-4 each; below λ = 300 the ends are felt at mid-width
        assert float(law.mid_pressure(approach, 2.0)) == pytest.approx(float(expected), rel=tolerance)


def test_approach_lies_between_the_two_strip_formulas():
    """Even load along the strip: approach at mid-length below, its mean above what a contact needs."""
    law = LineContactLaw(11.8, MODULUS)
    for approach in (1e-7, 1e-5, 1e-4, 1e-3, 5e-3):
        load, _ = law.load_and_stiffness(approach, 2.0)
        line_load = float(load) / 11.8
        width = line_half_width(line_load, 2.0, MODULUS)
        mid, mean = hertz.strip_approach(line_load, width, 11.8, MODULUS)
        assert approach < mean
        # the load evens out over the length: δ stays within 1.5/v² … of the mean, v = π E* δ/q
        v = np.pi * MODULUS * approach / line_load
        assert abs(approach / float(mean) - 1.0) < 1.5 / v**2 + 1e-3
        assert abs(approach / float(mid) - 1.0) < 1.0 / v


def test_light_load_limit_of_the_approach_is_the_mean_of_the_strip():
    law = LineContactLaw(11.8, MODULUS)
    gaps = []
    for approach in (1e-3, 1e-8, 1e-12, 1e-60):
        load, _ = law.load_and_stiffness(approach, 2.0)
        width = line_half_width(float(load) / 11.8, 2.0, MODULUS)
        _, mean = hertz.strip_approach(float(load) / 11.8, width, 11.8, MODULUS)
        gaps.append(1.0 - approach / float(mean))
    assert all(gap > 0 for gap in gaps)
    assert gaps == sorted(gaps, reverse=True)
    # far beyond the table, where the gap tends to zero: the continuation keeps constant and slope to 4e-4
    assert gaps[-1] < 6e-4


def test_subsurface_shear_of_a_long_roller():
    solution = solve_cylinder_patch(40.0, 2.0, MODULUS, 5e-3, cells=16)
    found = find_subsurface_shear(solution, 0.3)
    # Hertz line contact: 0.300 p0 at 0.786 b; 40 mm are 360 half-widths, so plane strain within 0.3 %
    assert found.max_shear == pytest.approx(0.3003 * solution.mid_pressure, rel=3e-3)
    assert found.depth == pytest.approx(0.786 * solution.half_width, rel=5e-3)
    depth = solution.half_width * np.array([0.3, 0.786, 1.5])
    place = 0.6 * solution.half_width
    stress = patch_stress(solution, place, 0.0, depth, 0.3)
    plane = hertz.line_contact_stress(place, depth, solution.half_width, solution.mid_pressure)
    np.testing.assert_allclose(stress[:, 0], plane.across, rtol=5e-3)
    np.testing.assert_allclose(stress[:, 2], plane.depthwise, rtol=2e-3)
    np.testing.assert_allclose(stress[:, 4], plane.shear, rtol=2e-3)
    np.testing.assert_allclose(stress[:, 1], 0.3 * (plane.across + plane.depthwise), rtol=5e-3)
