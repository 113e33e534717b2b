"""Beams and rings: pins between their ends, pins tied at their tips, crankshafts, the ring of the wheel."""

from __future__ import annotations

from math import log, pi

import numpy as np
from scipy.integrate import quad

from ltca.beam import End, PinBeam, shaft_flexibility
from ltca.laws.ring_beam import RingBeam
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure

ROUND_OFF = "round-off of a system of six equations, estimated"
EXACT_BOUND = "closed form against closed form: round-off"


# Timoshenko's beam


def _timoshenko() -> list[Figure]:
    span, diameter, modulus, ratio = 16.0, 5.0, 206e3, 0.3
    bending = modulus * pi * diameter**4 / 64.0
    factor = 6.0 * (1.0 + ratio) / (7.0 + 6.0 * ratio)
    shear = factor * modulus / (2.0 * (1.0 + ratio)) * pi * diameter**2 / 4.0
    bent, sheared = span**3 / bending, span / shear
    cantilever, own, tip = bent / 20.0 + sheared / 3.0, bent / 3.0 + sheared, bent / 8.0 + sheared / 2.0
    figures = []
    held: tuple[tuple[str, tuple[End, End], float], ...] = (
        ("supported at both ends", ("supported", "supported"), bent / 120.0 + sheared / 12.0),
        ("clamped at both ends", ("clamped", "clamped"), bent / 720.0 + sheared / 12.0),
        ("cantilever", ("clamped", "free"), cantilever),
        ("clamped and supported", ("clamped", "supported"), cantilever - tip**2 / own),
    )
    for name, ends, mean in held:
        beam = PinBeam(span=span, ends=ends, diameter=diameter, youngs_modulus=modulus, poisson_ratio=ratio)
        found = float(beam.flexibility([0.5 * span], span)[0, 0])
        figures.append(
            relative_figure(
                f"mean deflection under an even load, {name}", 1e3 * found, 1e3 * mean, "µm/N", 1e-9, EXACT_BOUND,
                numerical_error=1e-10, numerical_origin=ROUND_OFF,
            )
        )  # fmt: skip
    beam = PinBeam(
        span=span, ends=("supported", "supported"), diameter=diameter, youngs_modulus=modulus, poisson_ratio=ratio
    )
    thin = 1e-3
    figures.append(
        relative_figure(
            "deflection under a force at mid-span, supported", 1e3 * beam.deflection(0.5 * span, 0.5 * span, thin),
            1e3 * (bent / 48.0 + sheared / 4.0), "µm/N", 1e-4,
            "the force presses along 1 µm: half of that is missing of the shear at mid-span, 3e-5 of it",
            numerical_error=1e-10, numerical_origin=ROUND_OFF,
        )
    )  # fmt: skip
    return figures


# The handbook's pin


def _handbook_pin() -> list[Figure]:
    pin = PinBeam(span=16.0, ends=("supported", "supported"), diameter=3.0, youngs_modulus=206e3)
    found = 278.5e3 * pin.deflection(4.0, 4.0, 8.0)
    rigidity = 206e3 * pi * 3.0**4 / 64.0
    closed = 278.5e3 * 31.0 * 16.0**3 / (48.0 * 64.0 * rigidity)
    return [
        absolute_figure(
            "deflection at a quarter of the span", found, 14.05, "µm", 0.005, "half a unit of the last printed digit",
            numerical_error=1e-9, numerical_origin=ROUND_OFF, reference_error=0.005, input_error=14.05 * 0.05 / 278.5,
        ),
        relative_figure(
            "the same against 31 F l³/(48 · 64 E J)", found, closed, "µm", 1e-9, EXACT_BOUND,
            numerical_error=1e-10, numerical_origin=ROUND_OFF,
        ),
    ]  # fmt: skip


# Pins whose tips are tied by a ring


def largest_moment_of_tied_pins(tip: End, radius: float, turned: list[float], senses: list[float]) -> float:
    """Return the largest bending moment along six pins clamped in a flange, N·mm for 1 N·m on each disc.

    Parameters
    ----------
    tip : {"free", "supported", "clamped"}
        How a floating ring holds the tips.
    radius : float
        Of the circle of the pins, mm.
    turned : list of float
        Angle of the eccentric of each disc, rad.
    senses : list of float
        Sense of each disc's torque, 1 or −1.
    """
    width, gap, pins = 6.35, 0.5, pi / 3.0 * np.arange(6)
    discs = len(turned)
    span = discs * (width + gap) + gap
    planes = gap + 0.5 * width + (width + gap) * np.arange(discs)
    beam = PinBeam(span=span, ends=("clamped", tip), diameter=4.0, youngs_modulus=2e5)
    # All loads of a disc are across its eccentric, on the pins on one side of it, in proportion to their levers.
    eccentric = np.exp(1j * np.array(turned))[:, None]
    levers = (np.exp(1j * pins) * eccentric.conj()).real
    loads = np.array(senses)[:, None] * 1j * eccentric * np.maximum(0.0, levers) * 1000.0 / (1.5 * radius)
    held, couple = np.zeros(6, dtype=complex), np.zeros(6, dtype=complex)
    if tip != "free":
        tips = np.stack([np.ones(6), np.full(6, 1j), 1j * radius * np.exp(1j * pins)], axis=-1)
        onto = beam.tip_shape(planes.tolist(), 1e-4) @ loads
        ring = beam.tip_stiffness * (tips.conj().T @ tips).real
        sway = tips @ np.linalg.solve(ring, (tips.conj().T @ onto).real)
        held = onto - beam.tip_stiffness * sway
    if tip == "clamped":
        # The couple of a clamped tip, F a² (H − a)/H² less 6 E I v/H² of its sway, is Bernoulli's.
        rigidity = 2e5 * pi * 4.0**4 / 64.0
        couple = planes**2 * (span - planes) / span**2 @ loads - 6.0 * rigidity * sway / span**2
    # Straight between the loads: largest at one of them or at an end.
    at = np.array([0.0, *planes, span])[:, None]
    moment = np.maximum(0.0, planes - at) @ loads - (span - at) * held + couple
    return float(np.abs(moment).max())


def _tied_pins() -> list[Figure]:
    figures = []
    rows: tuple[tuple[str, float, list[float], list[float], dict[End, float]], ...] = (
        ("one disc", 32.9, [0.0], [1.0], {"free": 74.468085, "supported": 55.075355, "clamped": 40.336879}),
        (
            "two discs on the same pins in opposite senses", 32.3, [0.0, 0.0], [1.0, -1.0],
            {"supported": 93.531433, "clamped": 51.031442},
        ),
        (
            "two discs half a turn apart", 32.3, [0.0, pi], [1.0, 1.0],
            {"supported": 139.221801, "clamped": 83.789835},
        ),
    )  # fmt: skip
    for name, radius, turned, senses, by_tip in rows:
        for tip, printed in by_tip.items():
            figures.append(
                absolute_figure(
                    f"{name}, tips {tip}", largest_moment_of_tied_pins(tip, radius, turned, senses), printed,
                    "N·mm per N·m", 2e-6, "printed to 1e-6; two of the rows follow from its closed form, given so",
                    numerical_error=1e-7, numerical_origin="loads press along 1e-4 mm instead of at a point",
                    reference_error=5e-7,
                )
            )  # fmt: skip
    return figures


# Crankshaft


def _crankshaft() -> list[Figure]:
    a, b, diameter, modulus, k = 7.0, 22.0, 20.0, 206e3, 4e5
    rigidity = modulus * pi * diameter**4 / 64.0
    moved = shaft_flexibility([-a, a], (-b, b), (k, k), diameter, modulus) @ np.array([-1.0, 1.0])
    opposite = a * a * (b - a) ** 2 / (6.0 * rigidity * b) * 2.0 + a * a / (2.0 * k * b * b) * 2.0
    length, c = 40.0, 12.0
    over = shaft_flexibility([length + c], (0.0, length), (1e30, 1e30), diameter, modulus)[0, 0]
    overhang = c**3 / (3.0 * rigidity) + c * c * length / (3.0 * rigidity)
    return [
        relative_figure(
            quantity, 1e3 * float(value), 1e3 * reference, "µm/N", 1e-9, EXACT_BOUND,
            numerical_error=1e-10, numerical_origin=ROUND_OFF,
        )
        for quantity, value, reference in (
            ("two opposite forces at ±7 mm on springs at ±22 mm", moved[1], opposite),
            ("a force 12 mm beyond rigid supports 40 mm apart", over, overhang),
        )
    ]  # fmt: skip


# Ring


RING_MODULUS, RING_POISSON = 206e3, 0.3


def ring_stretch_by_energy(ring: RingBeam) -> float:
    """Return how far a ring stretches under two opposite forces of 1 N, mm.

    Energy of Winkler's curved beam about the centroid, with shear; the couple at the section at right angles to the forces
    makes it least.
    """
    shear = 5.0 * RING_MODULUS / (12.0 + 11.0 * RING_POISSON)
    area, centre = ring.width * ring.height, 0.5 * (ring.inner_radius + ring.outer_radius)
    e = centre - ring.height / log(ring.outer_radius / ring.inner_radius)

    def energy(couple: float, load: float) -> float:
        def density(angle: float) -> float:
            normal, across = 0.5 * load * np.cos(angle), 0.5 * load * np.sin(angle)
            bending = couple - 0.5 * load * centre * (1.0 - np.cos(angle))
            bent = bending**2 / (2.0 * area * RING_MODULUS * e) - bending * normal / (area * RING_MODULUS)
            stretched = centre * normal**2 / (2.0 * area * RING_MODULUS)
            return float(bent + stretched + ring.neutral_radius * across**2 / (2.0 * shear * area))

        return float(4.0 * quad(density, 0.0, 0.5 * pi, epsabs=0.0, epsrel=1e-12)[0])

    # Quadratic in both, so three values determine it exactly.
    own, mixed = energy(1.0, 0.0), energy(1.0, 1.0) - energy(1.0, 0.0) - energy(0.0, 1.0)
    return 2.0 * (energy(0.0, 1.0) - mixed**2 / (4.0 * own))


def _ring() -> list[Figure]:
    origin = "sums over 512 orders; e of the thin ring is a difference that leaves 1e-11"
    figures = []
    for name, inner, outer, width in (("60 to 90 mm", 60.0, 90.0, 50.0), ("79 to 81 mm", 79.0, 81.0, 20.0)):
        ring = RingBeam(
            inner_radius=inner,
            outer_radius=outer,
            width=width,
            youngs_modulus=RING_MODULUS,
            poisson_ratio=RING_POISSON,
        )
        moved = ring.free(np.array([0.0, 0.5, 1.0, 1.5]) * pi, 71.0)
        stretch = 2.0 * float(moved[0, 0, 0, 0] - moved[0, 0, 2, 0])
        figures.append(
            relative_figure(
                f"ring of {name}: stretch under two opposite forces", 1e3 * stretch, 1e3 * ring_stretch_by_energy(ring),
                "µm/N", 1e-9, EXACT_BOUND, numerical_error=1e-10, numerical_origin=origin, reference_error=1e-11,
            )
        )  # fmt: skip
    return figures


CASES = (
    Case(
        name="timoshenko_beams",
        title="Timoshenko beams: pins between their ends",
        problem="A round steel pin, span 16 mm, diameter 5 mm (E 206 000 MPa, ν 0.3): mean deflection under a force "
        "spread evenly over "
        "the span for four ways to hold the ends, and deflection under a force at mid-span.",
        references=(
            Reference(
                source="Timoshenko's beam by Castigliano's theorem: ∫M²/2EI + ∫V²/2κGA, e.g. supported F (L³/120EI + "
                "L/12κGA)",
                uncertainty="None: closed forms.",
            ),
            Reference(
                source="Cowper, *Journal of Applied Mechanics* 33 (1966): κ = 6(1 + ν)/(7 + 6ν) of a round section",
                uncertainty="A choice of the model, the same on both sides.",
            ),
        ),
        model="`ltca.beam.PinBeam`: fundamental solutions and a rigid motion.",
        run=_timoshenko,
    ),
    Case(
        name="handbook_pin",
        title="The handbook's bending pin",
        problem="A steel pin of diameter 3 mm, span 16 mm, supported at both ends, 278.5 N spread over one half of "
        "the span: deflection "
        "in the middle of that half.",
        references=(
            Reference(
                source="Li Lixing, Guan Tianmin (Chinese handbook method), also patent CN105404737A: 14.05 µm = 31 F "
                "l³/(48 · 64 E J)",
                uncertainty="Half a unit of the last printed digit, 0.005 µm.",
            ),
        ),
        model="`ltca.beam.PinBeam` without shear, which the handbook leaves out.",
        input_uncertainty="The force is printed as 278.5 N: 0.05 N, 0.0025 µm.",
        run=_handbook_pin,
    ),
    Case(
        name="tied_pins",
        title="Output pins tied by a floating ring",
        problem="Six pins clamped in a flange, discs 6.35 mm thick with gaps of 0.5 mm, tips free, supported or "
        "clamped in a floating ring: "
        "largest bending moment along a pin for 1 N·m on each disc, whose forces are in proportion to their levers.",
        references=(
            Reference(
                source="ka1e27/Cycloidal-Gearbox-Simulator, scripts/parity/standoff/README.md: closed form, equal to "
                "its finite elements "
                "to 4e-10; pins on a circle of 32.9 mm (one disc) and 32.3 mm (two discs)",
                uncertainty="Half a unit of the last printed digit, 5e-7 N·mm. Rows of discs half a turn apart are "
                "not printed; they "
                "follow from the closed form.",
            ),
        ),
        model="`ltca.beam.PinBeam`: shares of the tips by `tip_shape`, `tip_stiffness`; balance of the ring.",
        run=_tied_pins,
    ),
    Case(
        name="crankshaft",
        title="Crankshaft on two supports",
        problem="A steel shaft of diameter 20 mm: two opposite forces between springs of 4·10⁵ N/mm, and a force "
        "beyond rigid supports.",
        references=(
            Reference(
                source="Euler–Bernoulli: F a (b − a)²/(6 E I b) with springs' F a/(2 k b²), times the lever; c²(c + L)/3EI",
                uncertainty="None: closed forms.",
            ),
        ),
        model="`ltca.beam.shaft_flexibility`.",
        run=_crankshaft,
    ),
    Case(
        name="ring_two_forces",
        title="Ring under two opposite forces",
        problem="A thick and a thin steel ring, stretched by two opposite forces of 1 N on a diameter of 142 mm: how "
        "far the seats move apart.",
        references=(
            Reference(
                source="Winkler's curved beam by Castigliano's theorem (Timoshenko, *Strength of Materials* II, "
                "section 80), with shear",
                uncertainty="Quadrature to 1e-12; the eccentricity of the thin ring is a difference that leaves 1e-11.",
            ),
        ),
        model="`ltca.laws.ring_beam.RingBeam`: Fourier series of the free ring.",
        model_uncertainty="None between the two: both are curved beams. What beams leave out is shown by finite elements "
        "(docs/theory/ring_elements.md).",
        run=_ring,
    ),
)
