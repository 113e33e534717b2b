"""The page of ``cyclo design``: designs compared, their outlines, relaxations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.flank import FlankProfile
from ltca.page.tables import Table, minus, word
from ltca.page.writing import page_text, write_page
from ltca.studies.design_search.designs import named_design, refused_words
from ltca.studies.design_search.refinement import Refined
from ltca.studies.design_search.requirement_words import assumed_words, requirement_warnings
from ltca.studies.design_search.search import Found
from ltca.studies.design_search.sizes import LEAST_DISTANCE

POINTS = 24
"""Of the outline of a lobe."""


def write_design_page(found: Found, shown: Sequence[tuple[str, Refined]], rows: list[list[str]], path: Path) -> Path:
    """Write the page of a search with the table (`rows`) and outlines of the named designs that are compared."""
    requirements = found.requirements
    table = Table(
        name="designs", caption="", columns=rows[0], rows=[[word(minus(cell)) for cell in row] for row in rows[1:]]
    )
    content = {
        "title": f"{requirements.asked.name}: designs",
        "name": requirements.asked.name,
        "ratio": f"{requirements.asked.ratio:g}",
        "fits": bool(found.designs),
        "table": table,
        "in_the_way": [minus(one.words) for one in found.relaxations],
        "outlines": [(name, outline(named_design(one, requirements, "outline"))) for name, one in shown],
        "requirements": requirements.text,
        "combinations": found.combinations,
        "solved": found.solved,
        "refused": refused_words(found),
        "assumed": assumed_words(requirements),
        "warnings": requirement_warnings(requirements),
        "least_distance": f"{LEAST_DISTANCE:g}",
    }
    return write_page(path, page_text("design.html", content, styles=("design",)))


def outline(drive: Drive) -> dict[str, object]:
    """Return the first disc of a drive with pins, holes and bores as shapes of an SVG, mm, y downwards."""
    single = single_discs(replace(drive, temperature=None))[0]
    wheel, shaft, e = single.pin_wheel, single.pin_shaft, single.crank.eccentricity
    count = POINTS * single.disc.number_of_teeth
    # A turn of the disc takes the parameter once around the pins of the wheel.
    parameter = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    flank = FlankProfile.of_drive(single).flank(parameter) + e
    path = " ".join(f"{point.real:.3f},{-point.imag:.3f}" for point in flank)
    pins = wheel.pin_circle_radius * _circle(wheel.number_of_pins)
    circles = [(pin.real, -pin.imag, wheel.pin_radius, "pin") for pin in pins]
    if shaft is not None:
        for place in shaft.pin_circle_radius * _circle(shaft.number_of_pins):
            circles.append((place.real + e, -place.imag, single.hole_radius, "hole"))
            circles.append((place.real, -place.imag, shaft.pin_radius, "pin"))
    for place in single.crank.places:
        circles.append((place.real + e, -place.imag, single.bore_radius, "hole"))
        circles.append((place.real + e, -place.imag, single.crank_bearing.inner_race_radius, "race"))
    return {"path": path, "circles": circles, "half": wheel.pin_circle_radius + wheel.pin_radius + 1.0}


def _circle(count: int) -> NDArray[np.complex128]:
    return np.asarray(np.exp(2j * np.pi * np.arange(count) / count))
