"""The law of conforming seats: Persson's closed form, Hertz, the neat fit, dissimilar materials by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from ltca.drive.parts import Material, contact_modulus
from ltca.errors import DriveError
from ltca.laws.conforming import SMALLEST_BREATHING, ConformingLaw
from ltca.laws.seats.arc import solve_arc
from ltca.laws.seats.series import conforming_series

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
BRONZE = Material(youngs_modulus=110_000.0, poisson_ratio=0.34)
POLYMER = Material(youngs_modulus=2_800.0, poisson_ratio=0.42)
PAIRS = {
    "steel": (STEEL, STEEL),
    "bronze sleeve": (STEEL, BRONZE),
    "bronze pin": (BRONZE, STEEL),
    "polymer pin": (POLYMER, STEEL),
    "polymer bore": (STEEL, POLYMER),
}
PIN_RADIUS, PLAY, LENGTH = 4.0, 0.004, 12.0


def law_of(pin: Material = STEEL, bore: Material = STEEL, **changes: float) -> ConformingLaw:
    size = {"pin_radius": PIN_RADIUS, "bore_radius": PIN_RADIUS + PLAY, "datum_radius": 6.0, "length": LENGTH}
    return ConformingLaw.of_bodies(pin=pin, bore=bore, **(size | changes))


def persson_play(b):
    """E* ΔR L/F of equal materials at b = tan(α/2) (Ciavarella and Decuzzi 2001, after Persson 1964)."""
    return (2.0 - np.log(b**2 + 1.0) - 2.0 * b**4) / (2.0 * np.pi * b**2 * (b**2 + 1.0))


def persson_pressure(angle, b):
    """p a L/F of equal materials."""
    y = np.tan(0.5 * angle)
    root, edge = np.sqrt(b**2 - y**2), np.sqrt(b**2 + 1.0)
    logarithm = np.log((edge + root) / (edge - root))
    return (2.0 * root / (edge * (1.0 + y**2)) + logarithm / (2.0 * b**2 * (b**2 + 1.0))) / np.pi


@pytest.mark.parametrize("b", [0.01, 0.1, 0.3, 0.52, 0.8, 0.9])
def test_persson(b):
    """The issue asks for 1 %; the closed form of equal materials is met to round-off, so nothing more is granted."""
    arc = solve_arc(b, 0.0, 1.0)
    assert arc.play == pytest.approx(persson_play(b), rel=1e-10)
    angle = np.linspace(0.0, 2.0 * np.arctan(b), 40, endpoint=False)
    np.testing.assert_allclose(arc.pressure(angle), persson_pressure(angle, b), rtol=1e-9)


def test_persson_through_the_series():
    """Arc and peak pressure of the law at loads from Hertz to nearly the neat fit, both in mm, N and MPa."""
    law = law_of()
    b = np.linspace(0.01, 0.91, 60)
    load = contact_modulus(STEEL, STEEL) * PLAY * LENGTH / persson_play(b)
    np.testing.assert_allclose(law.half_angle(load, PLAY), 2.0 * np.arctan(b), rtol=1e-8)
    radius = np.sqrt(PIN_RADIUS * (PIN_RADIUS + PLAY))
    peak = [float(persson_pressure(0.0, value)) for value in b]
    np.testing.assert_allclose(law.largest_pressure(load, PLAY), peak * load / (radius * LENGTH), rtol=1e-8)


@pytest.mark.parametrize("pair", PAIRS)
def test_hertz_at_small_arcs(pair):
    """Arc and peak of Hertz; what is left falls with the half-angle, 2.5e-3 rad here at most."""
    pin, bore = PAIRS[pair]
    law, modulus = law_of(pin, bore), contact_modulus(pin, bore)
    load = 1e-6 * modulus * PLAY * LENGTH
    radius = PIN_RADIUS * (PIN_RADIUS + PLAY) / PLAY
    half_width = np.sqrt(4.0 * load / LENGTH * radius / (np.pi * modulus))
    assert law.half_angle(load, PLAY) * law.radius == pytest.approx(half_width, rel=2e-3)
    assert law.largest_pressure(load, PLAY) == pytest.approx(2.0 * load / (np.pi * half_width * LENGTH), rel=2e-3)


def test_approach_at_small_arcs():
    """Hertz' logarithm with the constant of this datum.

    Seen from afar the load is a line force on both circles, whose displacement near it is −ln(θ) and a constant,
    given in closed form here for steel on steel; the semi-ellipse adds ½ to ln(2/α).
    """
    law, modulus = law_of(), contact_modulus(STEEL, STEEL)
    load = 1e-7 * modulus * PLAY * LENGTH
    kappa = 3.0 - 4.0 * STEEL.poisson_ratio
    ratio = 2.0 * kappa / (kappa + 1.0) * np.log(6.0 / (PIN_RADIUS + PLAY)) + 0.5 * (kappa - 1.0) + 0.5
    first = ratio / (kappa + 1.0)
    logarithm = np.log(2.0 / law.half_angle(load, PLAY)) + 0.5
    expected = load / (np.pi * modulus * LENGTH) * (2.0 * logarithm - 1.0 + first)
    assert law.approach_and_compliance(load, PLAY)[0] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("pair", PAIRS)
def test_pressure_balances_the_load(pair):
    pin, bore = PAIRS[pair]
    mismatch, breathing = dundurs(pin, bore)
    for b in (0.05, 0.5, 0.75):
        arc = solve_arc(b, mismatch, breathing)
        nodes, weights = np.polynomial.legendre.leggauss(200)
        angle = 2.0 * np.arctan(b) * nodes
        pressure = arc.pressure(angle)
        assert np.all(pressure > 0.0)
        # Gauss' rule leaves 1e-6 at the roots at both ends.
        force = 2.0 * np.arctan(b) * (weights @ (pressure * np.cos(angle)))
        assert force == pytest.approx(1.0, rel=1e-5)
        assert np.argmax(arc.pressure(np.linspace(0.0, 2.0 * np.arctan(b), 50))) == 0


def dundurs(pin: Material, bore: Material) -> tuple[float, float]:
    """η and c₀ from Lamé's parameters, by another way than the law: the pin shrinks by p a (1 − 2ν)/2μ in all."""
    modulus = contact_modulus(pin, bore)
    shear = [part.youngs_modulus / (2.0 * (1.0 + part.poisson_ratio)) for part in (pin, bore)]
    shrinking = [(1.0 - 2.0 * part.poisson_ratio) / (2.0 * mu) for part, mu in zip((pin, bore), shear, strict=True)]
    return 0.5 * modulus * (shrinking[0] - shrinking[1]), modulus * (shrinking[0] + 1.0 / (2.0 * shear[1]))


def brute_force(pin, bore, approach, play, radius, datum, cells=240):
    """Force by length, half-angle and peak by cells of constant pressure, 6000 harmonics and an active set.

    The harmonics of the displacement are those of Michell's stress functions, here in Lamé's terms.
    """
    edge = np.linspace(0.0, 0.62 * np.pi, cells + 1)
    middle, width = 0.5 * (edge[1:] + edge[:-1]), edge[1] - edge[0]
    n = np.arange(2.0, 6001.0)
    compliance = [np.zeros(n.size), 0.0, 0.0]
    for part, inside in ((pin, True), (bore, False)):
        nu, mu = part.poisson_ratio, part.youngs_modulus / (2.0 * (1.0 + part.poisson_ratio))
        kappa = 3.0 - 4.0 * nu
        one, other = (kappa, 1.0) if inside else (1.0, kappa)
        compliance[0] += (one / (n + 1.0) + other / (n - 1.0)) / (4.0 * mu)
        compliance[1] += (1.0 - 2.0 * nu if inside else 1.0) / (2.0 * mu)
        if inside:
            compliance[2] += (1.0 - 2.0 * nu) / (4.0 * mu)
        else:
            compliance[2] += ((3.0 - 4.0 * nu) / (2.0 - 2.0 * nu) * np.log(datum / radius) + 0.5) / (4.0 * mu)
    # Cosine coefficient of a symmetric pair of cells, and the mean of the displacement over a cell.
    mean = np.sin(0.5 * n * width) / (0.5 * n * width) * np.cos(middle[:, None] * n)
    first = np.sin(0.5 * width) / (0.5 * width) * np.cos(middle)
    matrix = (mean * compliance[0]) @ mean.T * 2.0 * width / np.pi
    matrix += compliance[2] * np.outer(first, first) * 2.0 * width / np.pi + compliance[1] * width / np.pi
    closing = (play + approach) * first - play
    active = closing > 0.0
    for _ in range(50):
        pressure = np.zeros(cells)
        pressure[active] = np.linalg.solve(matrix[np.ix_(active, active)], closing[active])
        wrong = (active & (pressure < 0.0)) | (~active & (closing - matrix @ pressure > 0.0))
        if not wrong.any():
            break
        active ^= wrong
    assert not wrong.any()
    return 2.0 * width * pressure @ first, edge[np.count_nonzero(active)], pressure[0] / radius


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("closing", [0.15, 1.5])
def test_dissimilar_materials_against_brute_force(pair, closing):
    """The law at the force that brute force finds for an approach; 240 cells leave a few parts in a thousand.

    Brute force has one radius: the play is so small that the logarithms of both are the same.
    """
    pin, bore = PAIRS[pair]
    play = 0.01 * PLAY
    law = law_of(pin, bore, bore_radius=PIN_RADIUS + play)
    force, half_angle, peak = brute_force(pin, bore, closing * play, play, law.radius, 6.0)
    load = force * LENGTH
    assert law.approach_and_compliance(load, play)[0] == pytest.approx(closing * play, rel=1e-3)
    assert law.largest_pressure(load, play) == pytest.approx(peak, rel=2e-3)
    assert law.half_angle(load, play) == pytest.approx(half_angle, abs=0.62 * np.pi / 240)


@pytest.mark.parametrize("pair", PAIRS)
def test_series_meet_the_arcs_they_were_made_from(pair):
    """Between the nodes: 1e-6 (measured 1e-7, from the ends of the arc of dissimilar materials)."""
    pin, bore = PAIRS[pair]
    law = law_of(pin, bore)
    neat = np.sqrt(law.series.load_scale / np.pi)
    for b in np.geomspace(1e-3, 0.999, 9) * neat:
        arc = solve_arc(float(b), *dundurs(pin, bore))
        load = law.contact_modulus * PLAY * LENGTH / arc.play
        scale = load / (LENGTH * law.contact_modulus)
        approach = law.approach_and_compliance(load, PLAY)[0]
        assert approach == pytest.approx((arc.approach + law.first_harmonic) * scale, rel=1e-6)
        assert law.half_angle(load, PLAY) == pytest.approx(2.0 * np.arctan(b), rel=1e-6)


@pytest.mark.parametrize("pair", PAIRS)
def test_monotone_and_smooth(pair):
    """The approach rises, the contact stiffens, and the compliance is the derivative over twelve decades of load."""
    law = law_of(*PAIRS[pair])
    load = np.geomspace(1e-4, 1e8, 3000)
    approach, compliance = law.approach_and_compliance(load, PLAY)
    assert np.all(np.diff(approach) > 0.0)
    # At the neat fit the compliance is constant: round-off.
    assert np.all(np.diff(compliance) < 1e-12 * compliance[0])
    step = 1e-5 * load
    ahead, behind = (law.approach_and_compliance(load + side * step, PLAY)[0] for side in (1.0, -1.0))
    np.testing.assert_allclose(compliance, (ahead - behind) / (2.0 * step), rtol=1e-7)
    for measure in (law.half_angle, law.largest_pressure):
        # The arc stays at that of the neat fit once the play is nothing.
        assert np.all(np.diff(measure(load, PLAY)) > -1e-13)


@pytest.mark.parametrize("pair", PAIRS)
def test_energy(pair):
    """Its derivative by the load is F dδ/dF, and it starts at zero; differences of 1e-4 leave 1e-7."""
    law = law_of(*PAIRS[pair])
    load = np.geomspace(1e-4, 1e8, 300)
    ahead, behind = law.energy(1.0001 * load, PLAY), law.energy(0.9999 * load, PLAY)
    _, compliance = law.approach_and_compliance(load, PLAY)
    np.testing.assert_allclose((ahead - behind) / (2e-4 * load), load * compliance, rtol=1e-6)
    assert law.energy(0.0, PLAY) == pytest.approx(0.0, abs=1e-100)
    # Linear without play: half of F δ.
    assert law.energy(10.0, 0.0) == pytest.approx(5.0 * law.approach_and_compliance(10.0, 0.0)[0], rel=1e-7)


def test_no_load():
    law = law_of()
    approach, compliance = law.approach_and_compliance(np.array([0.0, 1.0]), PLAY)
    assert approach[0] == 0.0
    assert approach[1] > 0.0
    assert np.all(np.isfinite(compliance))
    assert compliance[0] > compliance[1]
    assert law.half_angle(0.0, PLAY) == pytest.approx(0.0, abs=1e-100)
    assert law.largest_pressure(0.0, PLAY) == pytest.approx(0.0, abs=1e-100)


def test_scaling():
    """Same load by E* ΔR L, same arc; approach goes with the play and pressure with E* ΔR/a."""
    load = np.geomspace(1.0, 1e5, 7)
    base = law_of()
    soft = Material(youngs_modulus=103_000.0, poisson_ratio=0.3)
    for factor, law in {
        3.0 * 0.5: law_of(soft, soft),
        3.0 * 2.0: law_of(length=2.0 * LENGTH),
        3.0 * 1.0: law_of(pin_radius=8.0, bore_radius=8.008, datum_radius=12.0),
    }.items():
        np.testing.assert_allclose(law.half_angle(factor * load, 3.0 * PLAY), base.half_angle(load, PLAY), rtol=1e-12)
        found, expected = (
            law.approach_and_compliance(factor * load, 3.0 * PLAY),
            base.approach_and_compliance(load, PLAY),
        )
        np.testing.assert_allclose(found[0], 3.0 * expected[0], rtol=1e-12)
        np.testing.assert_allclose(found[1], 3.0 / factor * expected[1], rtol=1e-12)
        pressure = 3.0 * law.contact_modulus / law.radius / (base.contact_modulus / base.radius)
        np.testing.assert_allclose(
            law.largest_pressure(factor * load, 3.0 * PLAY), pressure * base.largest_pressure(load, PLAY), rtol=1e-12
        )


def test_plays_broadcast_and_may_vanish():
    """Many pins of their own play at once; without play the contact is linear."""
    law = law_of()
    load, play = np.array([[100.0], [1000.0]]), np.array([0.003, 0.004, 0.0])
    approach, compliance = law.approach_and_compliance(load, play)
    assert approach.shape == compliance.shape == (2, 3)
    for (row, column), value in np.ndenumerate(approach):
        assert value == law.approach_and_compliance(load[row, 0], play[column])[0]
    np.testing.assert_allclose(approach[:, 2], load[:, 0] * compliance[:, 2], rtol=1e-12)
    assert compliance[0, 2] == pytest.approx(compliance[1, 2], rel=1e-12)
    assert np.all(approach[:, 0] < approach[:, 1])


def test_the_datum_adds_a_spring():
    """Between two datum circles the infinite body yields as under a line force, κ ln(d₂/d₁) F/(2πμ(κ+1)L) (Kelvin)."""
    kappa, shear = 3.0 - 4.0 * BRONZE.poisson_ratio, BRONZE.youngs_modulus / (2.0 * (1.0 + BRONZE.poisson_ratio))
    near, far = (law_of(STEEL, BRONZE, datum_radius=datum) for datum in (5.0, 15.0))
    load = np.array([10.0, 1000.0])
    spring = kappa * np.log(3.0) / (2.0 * np.pi * shear * (kappa + 1.0) * LENGTH)
    found = [law.approach_and_compliance(load, PLAY) for law in (near, far)]
    np.testing.assert_allclose(found[1][0] - found[0][0], spring * load, rtol=1e-10)
    np.testing.assert_allclose(found[1][1] - found[0][1], spring, rtol=1e-10)


def test_nearly_incompressible_pins_have_a_law():
    """A rubber pin in steel would touch all round; it is taken a little softer in bulk and stays finite and monotone."""
    rubber = Material(youngs_modulus=10.0, poisson_ratio=0.4999)
    law = law_of(rubber, STEEL)
    assert law.series is conforming_series(round(dundurs(rubber, STEEL)[0], 12), SMALLEST_BREATHING)
    load = np.geomspace(1e-6, 1e6, 200)
    approach, compliance = law.approach_and_compliance(load, PLAY)
    assert np.all(np.diff(approach) > 0.0)
    assert np.all(compliance > 0.0)
    assert np.all(law.half_angle(load, PLAY) < np.pi)


def test_laws_of_the_same_materials_share_their_series():
    assert law_of().series is law_of(length=1.0, pin_radius=2.0, bore_radius=2.5).series
    with pytest.raises(ValueError, match="read-only"):
        law_of().series.approach[0] = 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pin_radius": 4.1}, "pin radius 4.1 mm: must be greater than 0 mm and at most 4.004 mm, its bore"),
        ({"datum_radius": 4.0}, "datum radius 4 mm: must be at least 4.004 mm, the bore"),
        ({"length": 0.0}, "length 0 mm of a seat: must be greater than 0 mm"),
    ],
)
def test_bodies_that_cannot_be(changes, message):
    with error_says(DriveError, message):
        law_of(**changes)
