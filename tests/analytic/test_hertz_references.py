"""The reference solutions themselves: strains integrated, limits, and numbers from the books."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.contact.subsurface import max_shear_stress, rectangle_stress
from ltca.drive.parts import Material, contact_modulus
from ltca.testing.closed_form_bodies import cylinder_approach, half_plane_approach
from validation import hertz

YOUNG, POISSON = 206e3, 0.3


def test_line_contact_balances_its_load():
    steel = Material(youngs_modulus=YOUNG, poisson_ratio=POISSON)
    modulus = contact_modulus(steel, steel)
    width = float(line_half_width(500.0, 2.0, modulus))
    peak = float(line_peak_pressure(500.0, 2.0, modulus))
    assert np.pi * peak * width / 2 == pytest.approx(500.0, rel=1e-14)  # area of the half ellipse
    assert float(hertz.line_load(width, 2.0, modulus)) == pytest.approx(500.0, rel=1e-14)
    assert peak == pytest.approx(modulus * width / 4.0, rel=1e-14)


def test_steel_roller_on_flat():
    """The usual formula 271 √(F/(D L)) MPa for steel rollers on a flat (DIN/ISO bearing practice)."""
    steel = Material(youngs_modulus=210e3, poisson_ratio=0.3)
    modulus = contact_modulus(steel, steel)
    peak = float(line_peak_pressure(40e3 / 20.0, 10.0, modulus))
    assert peak == pytest.approx(271.0 * np.sqrt(40e3 / (20 * 20)), rel=5e-4)  # 271 is rounded to three digits
    assert peak == pytest.approx(2710.0, abs=1.0)


def depth_strain(depth, width, peak):
    stress = hertz.line_contact_stress(0.0, depth, width, peak)
    plane = (1 - POISSON**2) / YOUNG
    return -plane * (float(stress.depthwise) - POISSON / (1 - POISSON) * float(stress.across))


def test_half_plane_approach_is_the_integral_of_the_strain():
    width, peak = 0.05, 1000.0
    load = np.pi * peak * width / 2
    depth = 5.0
    breaks = np.geomspace(width / 10, depth, 12)
    starts = np.concatenate([[0.0], breaks[:-1]])
    total = sum(
        quad(depth_strain, a, b, args=(width, peak), epsabs=0.0)[0] for a, b in zip(starts, breaks, strict=True)
    )
    # the formula drops terms of (b/d)² = 1e-4
    assert total == pytest.approx(float(half_plane_approach(load, width, depth, YOUNG, POISSON)), rel=1e-4)


def test_cylinder_approach_is_the_integral_of_the_strain_of_a_disc():
    """Hertz strip on top, point load below (Flamant), uniform tension q/(πR): the disc with a free rim."""
    width, peak, radius = 0.05, 1000.0, 5.0
    load = np.pi * peak * width / 2
    plane = (1 - POISSON**2) / YOUNG

    def strain(depth):
        near = hertz.line_contact_stress(0.0, depth, width, peak)
        rim = load / (np.pi * radius)
        depthwise = float(near.depthwise) - 2 * load / (np.pi * (2 * radius - depth)) + rim
        across = float(near.across) + rim
        return -plane * (depthwise - POISSON / (1 - POISSON) * across)

    breaks = np.geomspace(width / 10, radius, 12)
    starts = np.concatenate([[0.0], breaks[:-1]])
    total = sum(quad(strain, a, b, epsabs=0.0)[0] for a, b in zip(starts, breaks, strict=True))
    assert total == pytest.approx(float(cylinder_approach(load, width, radius, YOUNG, POISSON)), rel=2e-4)


def test_strip_approach_is_boussinesq_integrated():
    width, length, load, modulus = 0.1, 20.0, 300.0, 1e5
    mid, mean = hertz.strip_approach(load, width, length, modulus)

    def along(y):
        # ∫ p/r over the strip seen from (0, y), Hertz across: substitution x = b sin t
        def across(t):
            x = width * np.sin(t)
            return np.cos(t) ** 2 * (np.arcsinh((length / 2 + y) / x) + np.arcsinh((length / 2 - y) / x))

        return 2 * quad(across, 0.0, np.pi / 2, epsrel=1e-10)[0] * 2 * load / np.pi / (np.pi * modulus)

    assert float(mid) == pytest.approx(along(0.0), rel=1e-5)  # drops (b/L)²
    average = 2 / length * quad(along, 0.0, length / 2, epsrel=1e-7)[0]
    assert float(mean) == pytest.approx(average, rel=5e-4)  # drops b/L


def test_mid_approach_is_lundbergs():
    mid, _ = hertz.strip_approach(1.0, 1.0, 1000.0, 1.0)
    # δ = 2q/(π E*) (1.1932 + ln(L/b)); Lundberg prints four decimals
    assert float(mid) == pytest.approx(2 / np.pi * (1.1932 + np.log(1000.0)), rel=1e-5)


def test_largest_shear_and_its_depth():
    depth = np.linspace(0.7, 0.9, 2001)
    shear = hertz.line_contact_stress(0.0, depth, 1.0, 1.0).max_shear
    assert shear.max() == pytest.approx(0.300, abs=5e-4)
    assert depth[shear.argmax()] == pytest.approx(0.786, abs=5e-4)


@pytest.mark.parametrize(
    "place", [(0.0, 0.5), (0.5, 0.3), (1.0, 0.4), (-1.6, 0.2), (2.5, 3.0), (0.4, 1e-9), (1.5, 0.0)]
)
def test_line_contact_stress_is_flamant_integrated(place):
    x, z = place
    found = hertz.line_contact_stress(x, z, 1.0, 1.0)
    if z < 1e-6:
        pressure = np.sqrt(max(1 - x * x, 0.0))
        assert float(found.depthwise) == pytest.approx(-pressure, abs=1e-8)
        assert float(found.across) == pytest.approx(-pressure, abs=1e-8)
        assert abs(float(found.shear)) < 1e-8
        return

    def integrate(kernel):
        def f(t):
            offset = x - np.sin(t)
            return np.cos(t) ** 2 * kernel(offset) / (offset**2 + z**2) ** 2

        return -2 / np.pi * quad(f, -np.pi / 2, np.pi / 2, epsrel=1e-11, limit=200)[0]

    assert float(found.across) == pytest.approx(integrate(lambda s: s * s * z), rel=1e-8)
    assert float(found.depthwise) == pytest.approx(integrate(lambda s: z**3), rel=1e-8)
    assert float(found.shear) == pytest.approx(integrate(lambda s: s * z * z), rel=1e-8, abs=1e-12)


def test_point_contact_of_a_sphere():
    contact = hertz.solve_point_contact(0.01, 5.0, 5.0, 1e5)
    assert contact.load == pytest.approx(4 / 3 * 1e5 * np.sqrt(5.0) * 0.01**1.5, rel=1e-12)
    near = hertz.solve_point_contact(0.01, 5.0, 5.0 * (1 + 1e-5), 1e5)
    assert near.load == pytest.approx(contact.load, rel=1e-5)
    assert near.peak_pressure == pytest.approx(contact.peak_pressure, rel=1e-5)


@pytest.mark.parametrize("ratio", [1.5, 10.0, 1e3, 1e5])
def test_point_contact_displaces_the_surface_by_approach_less_separation(ratio):
    """The ellipse's pressure, integrated over the surface, must give δ − x²/2R1 − y²/2R2 at every point."""
    contact = hertz.solve_point_contact(0.01, 5.0, 5.0 * ratio, 1e5)
    a, b = contact.half_axis_long, contact.half_axis_short

    def displacement(x, y):
        # polar coordinates about the point: the integral of √(1 − …) along a chord through it is closed
        def ray(angle):
            c, s = np.cos(angle), np.sin(angle)
            quadratic = (c / b) ** 2 + (s / a) ** 2
            linear = x * c / b**2 + y * s / a**2
            constant = 1 - (x / b) ** 2 - (y / a) ** 2
            return np.pi / 2 * (constant + linear**2 / quadratic) / np.sqrt(quadratic)

        # the ray runs nearly along the long axis where it counts: tan angle = (a/b) tan t levels it
        def levelled(t):
            return ray(np.arctan2(np.sin(t) * a, np.cos(t) * b)) * a * b / ((b * np.cos(t)) ** 2 + (a * np.sin(t)) ** 2)

        half = np.pi / 2
        total = quad(levelled, 0.0, half, epsrel=1e-10, limit=400)[0]
        total += quad(levelled, half, 2 * half, epsrel=1e-10, limit=400)[0]
        return contact.peak_pressure * total / (np.pi * 1e5)

    for x, y in ((0.0, 0.0), (0.5 * b, 0.0), (0.0, 0.7 * a), (-0.4 * b, 0.6 * a)):
        separation = x**2 / 10.0 + y**2 / (10.0 * ratio)
        assert displacement(x, y) == pytest.approx(0.01 - separation, rel=1e-7)
    assert contact.load == pytest.approx(2 / 3 * np.pi * a * b * contact.peak_pressure, rel=1e-12)


def test_point_contact_needs_ordered_radii():
    with pytest.raises(ValueError, match="radius_small"):
        hertz.solve_point_contact(0.01, 5.0, 4.0, 1e5)


def boussinesq_stress(x, y, z):
    """Unit point load in cylindrical components (Johnson Eq. 3.19), turned to x, y, z."""
    radius, distance = np.hypot(x, y), np.sqrt(x * x + y * y + z * z)
    slack = 1 - 2 * POISSON
    radial = (slack * (1 / radius**2 - z / (distance * radius**2)) - 3 * z * radius**2 / distance**5) / (2 * np.pi)
    hoop = -slack * (1 / radius**2 - z / (distance * radius**2) - z / distance**3) / (2 * np.pi)
    depthwise = -3 * z**3 / distance**5 / (2 * np.pi)
    shear = -3 * radius * z**2 / distance**5 / (2 * np.pi)
    c, s = x / radius, y / radius
    return np.array(
        [
            radial * c * c + hoop * s * s,
            radial * s * s + hoop * c * c,
            depthwise,
            (radial - hoop) * c * s,
            shear * c,
            shear * s,
        ]
    )


@pytest.mark.parametrize("place", [(1.3, 2.5, 0.4), (0.2, 0.1, 2.0), (-0.9, 0.5, 1.0), (0.0, 3.0, 0.7)])
def test_rectangle_stress_is_boussinesq_integrated(place):
    x, y, z = place
    a, b = 0.7, 1.9
    found = rectangle_stress(x, y, z, a, b, POISSON)
    for component in range(6):
        reference, _ = dblquad(
            lambda eta, xi, k=component: boussinesq_stress(x - xi + 1e-13, y - eta, z)[k], -a, a, -b, b, epsabs=1e-9
        )
        assert found[component] == pytest.approx(reference, abs=1e-7)


def test_rectangle_stress_of_a_wide_patch_is_uniform_pressure():
    stress = rectangle_stress(0.0, 0.0, 1e-6, 1.0, 1.0, POISSON)
    assert stress[2] == pytest.approx(-1.0, abs=1e-9)
    assert stress[0] == pytest.approx(-0.5 - POISSON, abs=1e-5)  # square: (1+2ν)/2, Johnson section 3.3
    assert float(max_shear_stress(stress)) == pytest.approx((0.5 - POISSON) / 2, abs=1e-5)
