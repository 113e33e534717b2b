"""Conforming contacts: a pin in a bore of nearly or exactly its own size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq

from fem.testing.seated_pin import SeatedPin, press_pin_into_bore
from ltca.drive.parts import Material
from ltca.laws.conforming import ConformingLaw
from validation.manual.case import Case, Figure, Reference, relative_figure
from validation.manual.error_bars import HALVED, error_by_size
from validation.seats import persson_load, persson_pressure

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
PIN_RADIUS, DATUM_RADIUS, LENGTH = 4.0, 6.0, 12.0
ELEMENTS = (12.0, 24.0, 48.0)
"""Over the arc of contact, coarsest first."""
BY_ELEMENTS = f"{HALVED} (12, 24, 48 elements over the arc)"
SERIES = "series of the law against the arcs that they are made from, at most 1e-8"
REASON = "asked of conforming seats: second order of the play beside the radius, and the fixed outside of the ring"


def _law(bore_radius: float) -> ConformingLaw:
    return ConformingLaw.of_bodies(
        pin=STEEL, bore=STEEL, pin_radius=PIN_RADIUS, bore_radius=bore_radius, datum_radius=DATUM_RADIUS, length=LENGTH
    )


def _press(bore_radius: float, load: float, half_angle: float) -> list[SeatedPin]:
    """Press the pin by finite elements of all sizes."""
    return [
        press_pin_into_bore(
            pin=STEEL,
            bore=STEEL,
            pin_radius=PIN_RADIUS,
            bore_radius=bore_radius,
            datum_radius=DATUM_RADIUS,
            length=LENGTH,
            load=load,
            half_angle=half_angle,
            elements=elements,
        )
        for elements in ELEMENTS
    ]


def root_mean_square_angle(half_width: float) -> float:
    """Return √⟨θ²⟩ of Persson's pressure at b = tan(α/2), rad."""
    nodes, weights = np.polynomial.legendre.leggauss(400)
    angle = 2.0 * np.arctan(half_width) * nodes
    pressure = persson_pressure(angle, half_width)
    return float(np.sqrt(weights @ (pressure * angle**2) / (weights @ pressure)))


def neat_half_width() -> float:
    """Return b = tan(α/2) of a pin without play: the root of 2 − ln(b² + 1) − 2b⁴."""
    return float(brentq(lambda b: 2.0 - np.log(b**2 + 1.0) - 2.0 * b**4, 0.5, 1.0, xtol=1e-15))


def _by_law_and_elements(bore_radius: float, load: float, half_width: float) -> list[Figure]:
    """Return arc, pressure and approach at a load, whose arc by Persson is given."""
    law, play = _law(bore_radius), bore_radius - PIN_RADIUS
    half_angle = 2.0 * np.arctan(half_width)
    peak = float(persson_pressure(0.0, half_width)) * load / (law.radius * LENGTH)
    found = _press(bore_radius, load, half_angle)
    spread, approach = 2.0 * root_mean_square_angle(half_width), float(law.approach_and_compliance(load, play)[0])

    def of_elements(quantity: str, values: Sequence[float], reference: float, unit: str) -> Figure:
        error = error_by_size(values) / reference
        return relative_figure(
            quantity, values[-1], reference, unit, 1e-2, REASON, numerical_error=error, numerical_origin=BY_ELEMENTS
        )  # fmt: skip

    exact = "the same closed form in a table of the load: 1e-8 measured"
    return [
        relative_figure(
            "half the arc, by the law", float(law.half_angle(load, play)), half_angle, "rad", 1e-6, exact,
            numerical_error=1e-8, numerical_origin=SERIES,
        ),
        relative_figure(
            "largest pressure, by the law", float(law.largest_pressure(load, play)), peak, "MPa", 1e-6, exact,
            numerical_error=1e-8, numerical_origin=SERIES,
        ),
        of_elements("2√⟨θ²⟩ of the pressure, finite elements", [one.effective_half_angle for one in found], spread, "rad"),
        of_elements("largest pressure, finite elements", [one.largest_pressure for one in found], peak, "MPa"),
        of_elements("approach, finite elements against the law", [one.approach for one in found], approach, "mm"),
    ]  # fmt: skip


def _persson() -> list[Figure]:
    play, half_width = 0.004, 0.5
    load = float(persson_load(half_width)) * LENGTH * _law(PIN_RADIUS + play).contact_modulus * play
    return _by_law_and_elements(PIN_RADIUS + play, load, half_width)


def _neat() -> list[Figure]:
    return _by_law_and_elements(PIN_RADIUS, 1000.0, neat_half_width())


PERSSON = Reference(
    source="Persson (1964), closed form by Ciavarella and Decuzzi, *International Journal of Solids and Structures* "
    "38 (2001), "
    "equal materials",
    uncertainty="None beyond round-off. The approach is held against Michell's series (docs/theory/seats.md), summed "
    "to 1e-8.",
)
MODEL = (
    "The law of the LTCA (`ltca.laws.conforming.ConformingLaw`), and plane-strain finite elements with mortar contact "
    "(`fem.testing.seated_pin`): the pin a free body under a body force, the bore in a ring of 360 mm, fixed outside; "
    "the approach is "
    "relative to the mean displacement of a circle of 6 mm about the bore."
)

CASES = (
    Case(
        name="pin_in_bore",
        title="Pin in a slightly larger bore",
        problem="A steel pin of radius 4 mm in a bore of 4.004 mm, 12 mm long, loaded until half the arc is 2 arctan "
        "½ = 53.1°: arc, "
        "largest pressure and approach.",
        references=(PERSSON,),
        model=MODEL,
        model_uncertainty="Pressure acts on one circle of the mean radius: second order of play by radius, 1e-3. The "
        "ring is finite.",
        run=_persson,
    ),
    Case(
        name="neat_fit_pin",
        title="Neat-fit pin",
        problem="A steel pin of radius 4 mm in a bore of exactly its size, 12 mm long, 1000 N: the arc does not "
        "depend on the load, "
        "and pressure and approach are proportional to it.",
        references=(
            PERSSON,
            Reference(
                source="its limit without play, 2 − ln(b² + 1) − 2b⁴ = 0 with b = tan(α/2): α = 84.8°, solved here",
                uncertainty="None beyond round-off.",
            ),
        ),
        model=MODEL,
        model_uncertainty="The ring around the bore is finite.",
        run=_neat,
    ),
)
