"""Harmonics of a sleeve: energy, Lamé, the full circle and the infinite body as limits; the law of a sleeve."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_is

from ltca.drive.parts import Material
from ltca.errors import DriveError
from ltca.laws.conforming import ConformingLaw
from ltca.laws.seats.sleeve_wall import sleeve_wall

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
BRONZE = Material(youngs_modulus=110_000.0, poisson_ratio=0.34)
KAPPA = 1.8
LENGTH, LOAD = 12.0, np.array([10.0, 300.0, 3000.0])


def law_of(outer_radius: float, *, datum: float | None = None, sleeve: Material = STEEL) -> ConformingLaw:
    return ConformingLaw.of_sleeve(
        pin=STEEL, sleeve=sleeve, pin_radius=1.5, bore_radius=1.51, outer_radius=outer_radius,
        datum=outer_radius - 1.5 if datum is None else datum, length=LENGTH,
    )  # fmt: skip


@pytest.mark.parametrize("ratio", [0.2, 0.6, 0.9])
def test_work_of_one_load_on_the_displacement_of_the_other(ratio):
    """Betti: the line force on what the pressure pₙ moves is the pressure on what the line force moves."""
    wall = sleeve_wall(KAPPA, ratio)
    # The force moves by back, F/(aL); ∫ pₙ cos² nθ dθ = π, 2π for n = 0.
    share = np.where(np.arange(len(wall.own)) == 0, 2.0 * np.pi, np.pi)
    np.testing.assert_allclose(-wall.back[2:], wall.across[2:] * share[2:], rtol=1e-7)
    assert -wall.back[0] == pytest.approx(wall.across[0] * share[0], rel=1e-12)


def test_thin_rings():
    """n = 0: hoop stress p a/t, plane strain; n = 2: the ring's bending, u = p a⁴ (1 − ν²)/(9 E I) for both sides' load."""
    thin = 1e-3
    wall = sleeve_wall(KAPPA, 1.0 / (1.0 + thin))
    nu = (3.0 - KAPPA) / 4.0
    # In a/4μ with E = 2μ(1 + ν): u = (1 − ν²) p a²/(E t) → 2 (1 − ν) p a/t.
    assert wall.own[0] + 2.0 == pytest.approx(2.0 * (1.0 - nu) / thin, rel=5e-3)
    # EI w (n² − 1)² = p a⁴ (1 − ν²), I = t³/12.
    bending = 2.0 * (1.0 - nu) * 12.0 / thin**3
    assert wall.own[2] == pytest.approx(bending / 9.0, rel=1e-2)
    assert wall.own[3] == pytest.approx(bending / 64.0, rel=1e-2)


def test_a_wide_sleeve_is_an_infinite_body():
    """Arc and peak pressure go over into the law of a bore in an infinite body, by a/R."""
    bore = ConformingLaw.of_bodies(
        pin=STEEL, bore=STEEL, pin_radius=1.5, bore_radius=1.51, datum_radius=3.0, length=LENGTH
    )
    for outer, share in ((15.0, 2e-2), (150.0, 2e-3)):
        law = law_of(outer)
        assert np.allclose(law.half_angle(LOAD, 0.01), bore.half_angle(LOAD, 0.01), rtol=share)
        assert np.allclose(law.largest_pressure(LOAD, 0.01), bore.largest_pressure(LOAD, 0.01), rtol=share)


def test_a_wide_sleeve_yields_like_a_circle_between_its_middle_and_its_rim():
    """Far outside the bore the sleeve is a full circle under a force in its middle and one on its rim.

    A force in the middle, spread over a circle of radius d in the mean, and the same on the rim: with the
    half-plane's logarithm down to R taken off, the travel between both is the datum's law and, by superposition
    of Michell's line force in the middle and the tractions it leaves on the rim, a constant, found here from the
    harmonics of a full circle alone. The bore itself adds some a/R.
    """
    outer, datum = 15_000.0, 3.0
    kappa, shear = 3.0 - 4.0 * STEEL.poisson_ratio, STEEL.youngs_modulus / 2.6
    bore = ConformingLaw.of_bodies(
        pin=STEEL, bore=STEEL, pin_radius=1.5, bore_radius=1.51, datum_radius=datum, length=LENGTH
    )
    sleeve = law_of(outer, datum=outer)
    found = sleeve.approach_and_compliance(LOAD, 0.01)[0] - bore.approach_and_compliance(LOAD, 0.01)[0]
    # All with F/(4πμL). Line force in the middle: u = K' ((1 − κ ln r) cos θ, κ ln r sin θ), K' = 2/(κ + 1), mean of a
    # circle 1/2 − κ ln r; its tractions on the rim are −(κ + 3)/2 and (κ − 1)/2 of 2μK'/r. The rim has −1/2 − Σ cos nθ
    # of the line force (in F/πRL) instead; only n = 1 is left with shear, balanced by r³ in the middle.
    first = 2.0 / (kappa + 1.0)
    # r³: normal and shear stress 2 r A each cancel the shear of the line force: 2 A R = −(κ − 1)/2 K'/R.
    cubic = -0.25 * (kappa - 1.0) * first
    rim = first * (1.0 - kappa * np.log(outer)) + cubic * (kappa - 2.0)
    middle = first * (0.5 - kappa * np.log(datum))
    # Others: n = 0 shrinks by (κ − 1)/2, n ≥ 2 by κ/(n + 1) + 1/(n − 1), each less (κ + 1)/n of the half-plane.
    constant = 0.5 * (kappa - 1.0) + 1.0 - 0.5 * kappa - (kappa + 1.0)
    expected = LOAD / (4.0 * np.pi * shear * LENGTH) * (constant + middle - rim)
    np.testing.assert_allclose(found, expected, rtol=2e-3)


@pytest.mark.parametrize("sleeve", [STEEL, BRONZE])
@pytest.mark.parametrize("outer_radius", [1.58, 2.5, 5.0])
def test_laws_of_sleeves_are_monotone_and_smooth(outer_radius, sleeve):
    law = law_of(outer_radius, sleeve=sleeve)
    load = np.geomspace(1e-4, 1e7, 600)
    approach, compliance = law.approach_and_compliance(load, 0.01)
    assert np.all(np.diff(approach) > 0.0)
    assert np.all(np.diff(compliance) < 1e-12 * compliance[0])
    step = 1e-5 * load
    ahead, behind = (law.approach_and_compliance(load + side * step, 0.01)[0] for side in (1.0, -1.0))
    np.testing.assert_allclose(compliance, (ahead - behind) / (2.0 * step), rtol=1e-6)


def test_the_datum_of_the_load_outside():
    """What the half-plane's law has more by a larger distance is less here: F/(πL) · 2 (1 − ν²)/E · ln(D₂/D₁)."""
    near, far = (law_of(2.5, datum=datum).approach_and_compliance(LOAD, 0.01)[0] for datum in (1.0, 8.0))
    expected = 2.0 * LOAD * STEEL.plane_strain_compliance / (np.pi * LENGTH) * np.log(8.0)
    np.testing.assert_allclose(near - far, expected, rtol=1e-9)


def test_a_sleeve_needs_a_wall():
    with error_is(DriveError, "outer radius 1.5 mm of a sleeve: must be greater than 1.51 mm, its bore"):
        law_of(1.5, datum=1.0)
