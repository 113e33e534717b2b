"""Notes on unusual sizes of a drive: proportions outside the span of published drives, diameters given for radii, and printed
flanks without play.

Nothing is judged by it: a note names the proportion, the span of published drives and the radius that may be a diameter. Holes
that do not fit pin and eccentricity are refused anyway, walls that are gone fail.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import pi, sin

from ltca.analysis.verdict.geometry import pin_hollow_margin
from ltca.drive.members.named_materials import FINEST_PRINT, PRINTED, name_of
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.interference import FLANK, drawn_plays

PIN_NUMBER_FACTOR = 1.6
"""Largest ratio between the numbers of pins of drives that are compared: pins stand closer the more there are."""
SPAN_MARGIN = 0.1
"""Relative distance from the published span from which a proportion is reported."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Published:
    source: str
    number_of_pins: int
    pin_circle_radius: float
    pin_radius: float
    eccentricity: float


def odd_proportions(drive: Drive) -> list[str]:
    """Return what looks odd in the sizes of a drive, one sentence each; empty where nothing does.

    Parameters
    ----------
    drive : Drive
        The drive.

    Examples
    --------
    >>> from ltca.reading.changes import with_fields
    >>> from ltca.reading.drive_file import load_drive
    >>> paper = load_drive("paper").cases["CS-1"]
    >>> odd_proportions(paper)
    []
    >>> print(odd_proportions(with_fields(paper, {"pin_wheel.pin_radius": 13.0}, check=False))[0].split(":")[0])
    pin_wheel.pin_radius = 13 mm looks odd
    """
    return [*_odd(drive), *_tight_print(drive)]


def _odd(drive: Drive) -> Iterator[str]:
    wheel = drive.pin_wheel
    own = _Published(
        source="",
        number_of_pins=wheel.number_of_pins,
        pin_circle_radius=wheel.pin_circle_radius,
        pin_radius=wheel.pin_radius,
        eccentricity=drive.crank.eccentricity,
    )
    shortening, each = _shortening(own), [_shortening(one) for one in _published()]
    # Low proportions alone are no mistake, drives of low ratio have them: but half of a true radius has no room for the rest.
    if 2.0 * shortening <= max(each) and _has_room(drive, 0.5 * wheel.pin_circle_radius):
        yield (
            f"pin_wheel.pin_circle_radius = {wheel.pin_circle_radius:g} mm looks odd: bores, holes and pins have room in half of "
            f"it, and eccentricity by rolling circle, e z_P/R_C, is {shortening:.3g}, with {0.5 * wheel.pin_circle_radius:g} mm "
            f"{2.0 * shortening:.3g} (published drives: {min(each):.3g} … {max(each):.3g}): is it a diameter?"
        )
    alike = [
        one
        for one in _published()
        if 1.0 / PIN_NUMBER_FACTOR < one.number_of_pins / wheel.number_of_pins < PIN_NUMBER_FACTOR
    ]
    spacing = [_spacing(one) for one in alike]
    if spacing and (told := _beside(_spacing(own), spacing)):
        yield (
            f"pin_wheel.pin_radius = {wheel.pin_radius:g} mm looks odd: half the distance of neighbouring pins is {told[0]} "
            f"of it, in published drives with about as many pins {told[1]}; with {0.5 * wheel.pin_radius:g} mm it were "
            f"{told[2]}: is it a diameter?"
        )


def _tight_print(drive: Drive) -> Iterator[str]:
    """A printed disc whose flank has no play, with hollows that hold its pins closer than prints are."""
    if PRINTED not in (name_of(drive.materials.disc) or "") or drawn_plays(drive)[FLANK] > 0.0:
        return
    hollow = min(pin_hollow_margin(single) for single in single_discs(drive))
    if hollow < FINEST_PRINT:
        yield (
            f"disc.equidistant_offset = {drive.disc.equidistant_offset:g} mm: the flank of the printed disc has no play, and its "
            f"hollows are rounder than the pins by {hollow:.3f} mm only; prints are off by {FINEST_PRINT:g} mm and more, and "
            "pins may bind without a clearance"
        )


def _has_room(drive: Drive, pin_circle_radius: float) -> bool:
    """Tell whether pins stand apart on this circle and the holes and bores of the discs are within the roots of their flanks."""
    wheel, shaft, cranks = drive.pin_wheel, drive.pin_shaft, drive.crank
    reach = drive.bore_radius + (0.0 if cranks.circle_radius is None else cranks.circle_radius)
    if shaft is not None:
        reach = max(reach, shaft.pin_circle_radius + drive.hole_radius)
    apart = pin_circle_radius * sin(pi / wheel.number_of_pins) > wheel.pin_radius
    return apart and pin_circle_radius - wheel.pin_radius - cranks.eccentricity > reach


def _beside(value: float, published: list[float]) -> tuple[str, str, str] | None:
    """The value, the span and what it were with a radius halved, where it is below the span."""
    low, high = min(published), max(published)
    if value >= (1.0 - SPAN_MARGIN) * low or 2.0 * value > (1.0 + SPAN_MARGIN) * high:  # half of it were odd as well
        return None
    return f"{value:.3g}", f"{low:.3g} … {high:.3g}", f"{2.0 * value:.3g}"


def _shortening(drive: _Published) -> float:
    return drive.eccentricity * drive.number_of_pins / drive.pin_circle_radius


def _spacing(drive: _Published) -> float:
    return drive.pin_circle_radius * sin(pi / drive.number_of_pins) / drive.pin_radius


@cache
def _published() -> tuple[_Published, ...]:
    text = (resources.files("ltca.analysis.verdict") / "published_drives.toml").read_text(encoding="utf-8")
    return tuple(_Published(**one) for one in tomllib.loads(text)["drive"])
