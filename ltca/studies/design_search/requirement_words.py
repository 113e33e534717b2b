"""What is told of requirements before the search: materials that they leave open, and numbers that look like another unit."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

from pydantic import TypeAdapter

from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import (
    FASTEST,
    LARGEST,
    LONG,
    SHORT,
    SMALLEST,
    UNLOADED,
    carried_torque,
    fraction,
    rounded,
)
from ltca.studies.design_search.requirements import Requirements
from ltca.studies.design_search.sizes import Sizes, drive_table

REACH = 0.6
"""Shortening e z_P/R_C of the drive that fills a room: published drives have 0.5 to 0.8."""
BEYOND = 20.0
"""Multiple of the torque that it carries which no drive of the room carries: pressures go with the root."""
MEAN_BEARING = 0.5
"""Mean diameter of its crank bearing by the pin circle radius."""


def assumed_words(requirements: Requirements) -> str:
    """Return which parts have a material that requirements leave out; empty where they name all."""
    parts: dict[str, list[str]] = {}
    for path, name in requirements.assumed_materials.items():
        parts.setdefault(name, []).append(path.removeprefix("materials."))
    told = " and ".join(f"{name} for {', '.join(own)}" for name, own in parts.items())
    return f"materials that the requirements do not name: {told}" if told else ""


def requirement_warnings(requirements: Requirements) -> list[str]:
    """Return what is likely a mistake in requirements, one sentence each.

    A flank that nothing judges; lengths and torques in another unit, a speed of the input given for that of the output.
    """
    return [
        *_unjudged_flank(requirements),
        *([*_odd_room(requirements)] or [*_odd_torque(requirements), *_odd_speed(requirements)]),
    ]


def _unjudged_flank(requirements: Requirements) -> Iterator[str]:
    if any(limit.quantity == "pin_pressure_mid" for limit in requirements.limits.values()):
        return
    own = {part: getattr(requirements.materials, part) for part in ("disc", "wheel_pin")}
    lacking = [
        f"materials.{part}"
        for part, given in own.items()
        if given.allowable_pressure is None and given.hardness is None and given.yield_strength is None
    ]
    if lacking:
        example = lacking[0].removeprefix("materials.")
        yield (
            f"the flank is not judged: {' and '.join(lacking)} {'has' if len(lacking) == 1 else 'have'} no allowable_pressure, "
            f'hardness or yield_strength; name a material ({example} = "100Cr6"), or write allowable_pressure in MPa beside '
            "youngs_modulus"
        )


def _odd_room(requirements: Requirements) -> Iterator[str]:
    """Envelopes larger or smaller than any drive, or of two lengths in different units."""
    outer, length = requirements.asked.outer_diameter, requirements.asked.length
    if outer > 2.0 * LARGEST:
        yield (
            f"outer_diameter = {outer:g} mm is {0.001 * outer:g} m, larger than any drive that is built, beside "
            f"length = {length:g} mm; is it in another unit? A plain number is mm"
        )
    elif outer < 2.0 * SMALLEST:
        yield f'outer_diameter = {outer:g} mm is smaller than any drive that is built; did you mean "{outer:g} m"?'
    elif length < SHORT * outer:
        yield (
            f"length = {length:g} mm is {fraction(length / outer)} of outer_diameter = {outer:g} mm; "
            f'did you mean "{length:g} m"?'
        )
    elif length > LONG * outer:
        yield (
            f"length = {length:g} mm is {rounded(length / outer)} times outer_diameter = {outer:g} mm; did you mean "
            f'"{0.001 * length:g} mm" or an outer diameter of "{outer:g} m"?'
        )


def _odd_torque(requirements: Requirements) -> Iterator[str]:
    """A torque in newton metres that was read as N·mm, or the other way round, by what a drive that fills the room carries."""
    torque, carried = requirements.asked.torque, carried_torque(_filling(requirements))
    of_it = f"what a drive of this room carries (some {rounded(carried / 1000.0)} N·m by the pressure of its flank)"
    told = f"torque = {torque:g} N·mm is {torque / 1000.0:g} N·m"
    if torque < UNLOADED * carried:
        yield f'{told}, {fraction(torque / carried)} of {of_it}; did you mean "{torque:g} N m"?'
    elif torque > BEYOND * carried:
        yield (
            f"{told}, {rounded(torque / carried)} times {of_it}; a plain number is N·mm and mm, did you mean "
            f'"{torque / 1e6:g} N m", or a larger room?'
        )


def _odd_speed(requirements: Requirements) -> Iterator[str]:
    """A speed of the input given for that of the output, by what crank bearings of a drive that fills the room run."""
    asked = requirements.asked
    turned = asked.ratio * asked.speed
    turns = asked.speed * (_teeth(requirements) if asked.kind == "rv" else asked.ratio)
    mean = MEAN_BEARING * 0.5 * asked.outer_diameter
    if turns * mean > FASTEST:
        yield (
            f"speed = {asked.speed:g} rpm at the output: the input would turn at {turned:,.0f} rpm. Is speed that of the output? "
            f"With {asked.speed:g} rpm at the input write speed = {asked.speed / asked.ratio:.4g}"
        )


def _teeth(requirements: Requirements) -> int:
    """Wheel pins of the drive that fills the room; an RV reducer, whose stage takes its part, has some 40."""
    asked = requirements.asked
    return min(round(asked.ratio), 40) if asked.kind == "rv" else round(asked.ratio) + (asked.held == "pin-wheel")


def _filling(requirements: Requirements) -> Drive:
    """A drive that fills the room, of usual proportions; nothing of it is checked."""
    asked, shop = requirements.asked, requirements.asked.shop
    pins, discs = max(_teeth(requirements), 3), max(asked.numbers_of_discs)
    # Pins take half of their circle.
    share = 0.5 * pi / pins
    circle = (0.5 * asked.outer_diameter - shop.housing_wall) / (1.0 + share)
    free = asked.length - shop.flanges - (discs - 1) * shop.disc_gap
    thickness = (free if free > 0.0 else asked.length) / discs
    row = dict.fromkeys(Sizes.__dataclass_fields__, 0.1 * circle) | {
        "pins": float(pins), "discs": float(discs), "rollers": 10.0, "holes": 8.0, "stage": 2.0, "sun": 20.0, "planet": 40.0,
        "pin_circle": circle, "pin_radius": share * circle, "eccentricity": REACH * circle / pins, "thickness": thickness,
        "bore": 0.5 * circle, "hole_circle": 0.7 * circle, "torque": asked.torque, **asked.starting,
    }  # fmt: skip
    return TypeAdapter(Drive).validate_python(drive_table(row, requirements, "filling"))
