"""Stock: diameters and lengths of pins and rollers, available eccentricities; typical ones are data."""

from __future__ import annotations

from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from ltca.drive.deviations import STRICT, PositiveLength
from ltca.drive.mistakes import describe_mistakes
from ltca.errors import DriveError
from ltca.reading.toml_text import parse_toml, read_text

Lengths = Annotated[tuple[PositiveLength, ...], Field(min_length=1)]
TYPICAL = "stock_sizes.toml"
ROLLER_ASPECTS = 0.8, 2.5
"""Least and largest length of a cylindrical roller by its diameter: shorter ones tilt in their cage, longer ones are needles."""
NEEDLE_DIAMETER, NEEDLE_ASPECT = 6.0, 10.0
"""Largest diameter of needles, mm, and their largest length by it: typical ones."""


@dataclass(frozen=True, slots=True, kw_only=True, config=STRICT)
class Stock:
    """Sizes to choose from.

    Attributes
    ----------
    eccentricities : tuple of float
        That the grinder offers, mm.
    wheel_pins, shaft_pins : tuple of float
        Diameters, mm.
    rollers : tuple of (float, float)
        Diameters and lengths of the rollers of crank bearings, mm.
    """

    eccentricities: Lengths
    wheel_pins: Lengths
    shaft_pins: Lengths
    rollers: Annotated[tuple[tuple[PositiveLength, PositiveLength], ...], Field(min_length=1)]


def stock_table(path: Path | None = None) -> dict[str, Any]:
    """Return the table of a stock file; the typical sizes of the package by default."""
    if path is None:
        text = (resources.files("ltca") / "studies" / "design_search" / TYPICAL).read_text(encoding="utf-8")
        return parse_toml(text, TYPICAL)
    return parse_toml(read_text(path, "shop.stock: no such file"), str(path))


def build_stock(table: dict[str, Any], source: str = "shop") -> Stock:
    """Return the stock of the table of a stock file; `DriveError` names every mistake.

    Examples
    --------
    >>> build_stock(stock_table()).eccentricities[0]
    0.65
    """
    try:
        found = TypeAdapter(Stock).validate_python(table)
    except ValidationError as error:
        known = tuple(Stock.__dataclass_fields__)
        raise DriveError(describe_mistakes(first_mistakes(error), (source,), known)) from error
    problems = []
    for number, (diameter, length) in enumerate(found.rollers):
        most = NEEDLE_ASPECT if diameter <= NEEDLE_DIAMETER else ROLLER_ASPECTS[1]
        if not ROLLER_ASPECTS[0] <= length / diameter <= most:
            problems.append(
                f"{source}.rollers.{number} = [{diameter:g}, {length:g}]: length by diameter must be from "
                f"{ROLLER_ASPECTS[0]:g} to {most:g} for a roller of {diameter:g} mm"
            )
    if problems:
        raise DriveError(problems)
    return found


def first_mistakes(error: ValidationError) -> list[Any]:
    """Return the mistakes of a validation error, without arrays that are too short because an entry is wrong."""
    found = error.errors()
    places = [detail["loc"] for detail in found]

    def inner(place: tuple[int | str, ...]) -> bool:
        return any(len(other) > len(place) and other[: len(place)] == place for other in places)

    return [detail for detail in found if detail["type"] != "too_short" or not inner(detail["loc"])]
