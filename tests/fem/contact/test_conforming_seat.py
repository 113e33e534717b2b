"""The law of conforming seats against plane-strain finite elements, and that of thin sleeves."""

from __future__ import annotations

import numpy as np
import pytest

from fem.testing.seated_pin import SleeveOnPin, press_pin_into_bore, squeeze_sleeve
from ltca.drive.parts import Material, contact_modulus
from ltca.laws.conforming import ConformingLaw

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
BRONZE = Material(youngs_modulus=110_000.0, poisson_ratio=0.34)
# Pin radius, bore radius, datum radius, load on 12 mm, bore: the slot of the issue, a sleeve on its pin.
SLOT = (4.0, 4.004, 6.0, 1150.0, STEEL)
SMALL_ARC = (4.0, 4.004, 6.0, 10.0, STEEL)
NEARLY_NEAT = (4.0, 4.004, 6.0, 20_000.0, STEEL)
SLEEVE = (5.0, 5.02, 8.0, 4000.0, BRONZE)
WIDE_PLAY = (4.0, 6.0, 9.0, 1150.0, BRONZE)


def both(case, elements):
    """Approach, peak pressure and 2√⟨θ²⟩ by finite elements over those of the law."""
    pin_radius, bore_radius, datum_radius, load, bore = case
    size = {"pin_radius": pin_radius, "bore_radius": bore_radius, "datum_radius": datum_radius, "length": 12.0}
    law = ConformingLaw.of_bodies(pin=STEEL, bore=bore, **size)
    play = bore_radius - pin_radius
    half_angle = float(law.half_angle(load, play))
    found = press_pin_into_bore(
        pin=STEEL, bore=bore, **size, load=load, half_angle=half_angle, elements=elements
    )  # fmt: skip
    approach = found.approach / float(law.approach_and_compliance(load, play)[0])
    return approach, found.largest_pressure / float(law.largest_pressure(load, play)), found, half_angle


@pytest.mark.slow
@pytest.mark.parametrize("case", [SLOT, SMALL_ARC, NEARLY_NEAT, SLEEVE, WIDE_PLAY])
def test_approach_and_pressure_of_coarse_meshes(case):
    """Twelve elements over the arc leave 0.2 % of the approach and 0.4 % of the peak (measured); the issue asks for 1 %."""
    approach, pressure, _, _ = both(case, 12.0)
    assert approach == pytest.approx(1.0, abs=5e-3)
    assert pressure == pytest.approx(1.0, abs=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("case", [SLOT, NEARLY_NEAT])
def test_approach_pressure_and_arc(case):
    """Forty-eight elements: what is left is the play beside the radius, second order, and the ring's fixed outside.

    Nothing near the 1 % of the issue. The arc is measured by the second moment, whose value for Persson's
    pressure belongs to the law's half-angle.
    """
    approach, pressure, found, half_angle = both(case, 48.0)
    assert approach == pytest.approx(1.0, abs=1.5e-3)
    assert pressure == pytest.approx(1.0, abs=2e-3)
    nodes, weights = np.polynomial.legendre.leggauss(400)
    b = np.tan(0.5 * half_angle)
    y = np.tan(0.5 * half_angle * nodes)
    root, edge = np.sqrt(b**2 - y**2), np.sqrt(b**2 + 1.0)
    persson = 2.0 * root / (edge * (1.0 + y**2)) + np.log((edge + root) / (edge - root)) / (2.0 * b**2 * edge**2)
    mean_square = weights @ (persson * nodes**2) / (weights @ persson)
    assert found.effective_half_angle == pytest.approx(2.0 * half_angle * np.sqrt(mean_square), rel=2e-3)


# Pin radius, bore radius, outer radius, load on 12 mm, sleeve: walls of 1, 2 and 1 mm.
THIN = (1.5, 1.51, 2.5, 1150.0, STEEL)
WIDE = (5.0, 5.02, 7.0, 1150.0, BRONZE)
VERY_THIN = (5.0, 5.02, 6.0, 1000.0, BRONZE)
WIDE_SLEEVE = (5.0, 5.5, 8.0, 1150.0, STEEL)


def sleeve_and_law(case, elements):
    """By finite elements and by the law: travel between pin and patch outside, peak pressure of the pin."""
    pin_radius, bore_radius, outer_radius, load, sleeve = case
    bodies = {"pin": STEEL, "sleeve": sleeve, "pin_radius": pin_radius, "bore_radius": bore_radius, "length": 12.0}
    law = ConformingLaw.of_sleeve(**bodies, outer_radius=outer_radius, datum=outer_radius)
    play = bore_radius - pin_radius
    # Half-width of Hertz on a flat.
    width = np.sqrt(4.0 * load / 12.0 * outer_radius / (np.pi * contact_modulus(STEEL, sleeve)))
    seat = SleeveOnPin(
        **bodies,
        outer_radius=outer_radius,
        half_angle=float(law.half_angle(load, play)),
        patch_half_width=width,
    )
    found = squeeze_sleeve(seat, *seat.meshes(elements), load)
    # Mean displacement of a half-plane under a semi-elliptic pressure, down to the datum (ltca.laws.plane_strain).
    outside = 2.0 * load / 12.0 / np.pi * sleeve.plane_strain_compliance * (np.log(2.0 * outer_radius / width) + 0.25)
    expected = outside + float(law.approach_and_compliance(load, play)[0])
    return found, expected, float(law.largest_pressure(load, play))


@pytest.mark.slow
@pytest.mark.parametrize("case", [THIN, WIDE, VERY_THIN, WIDE_SLEEVE])
def test_sleeves(case):
    """Twenty-four elements over the arc, eight over the patch outside: 0.1 % of the travel (measured).

    The peak of sleeves that bend is a small difference: 1.3 % in the thinnest wall, by the play beside the radius.
    """
    found, approach, pressure = sleeve_and_law(case, 24.0)
    assert found.approach == pytest.approx(approach, rel=5e-3)
    assert found.largest_pressure == pytest.approx(pressure, rel=2e-2)
