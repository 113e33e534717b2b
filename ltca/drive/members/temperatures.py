"""A drive at its temperatures: every length multiplied by 1 + α ΔT of its part.

How a field grows is part of its type (`ltca.drive.units.quantities.grows`). The flank grows with its disc: pin circle, pins and
eccentricity that it is generated with by one factor, which is exact. The pin circle of the wheel grows with the housing, the
eccentric with the crank: the differences are the offsets of the flank and the error of the eccentricity. Holes stand on a
circle of the disc, shaft pins on one of the carrier, and so do bores and several cranks: the difference is a radial error of
every pin or bore. Sun and planets stand apart by the circle of the cranks, their teeth grow with the shafts: the difference opens
or closes their backlash.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from operator import attrgetter
from typing import Any

from ltca.drive.declaration import ANY, declared_fields
from ltca.drive.deviations import BoreErrors, OneDisc
from ltca.drive.materials import Material, Materials
from ltca.drive.members.operation import REFERENCE_TEMPERATURE, Temperature
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import Grows
from ltca.errors import DriveError, Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """Factors by which the lengths of each part grow, 1 at 20 °C.

    Attributes
    ----------
    wheel, wheel_pin, wheel_sleeve : float
        Circle, slots and ring of the wheel; its pins; what the flank touches, pins or sleeves.
    disc : float
        Flank, holes, bores, thickness.
    eccentric, race, roller : float
        Eccentricity and crankshaft; inner races; rollers, at the mean temperature of disc and shaft.
    carrier, shaft_pin, shaft_sleeve : float
        Circle of the shaft pins, or of several cranks; these pins; what the holes touch, pins or sleeves.
    """

    wheel: float
    wheel_pin: float
    wheel_sleeve: float
    disc: float
    eccentric: float
    race: float
    roller: float
    carrier: float
    shaft_pin: float
    shaft_sleeve: float

    @property
    def planes(self) -> float:
        """Factor of the axial places of the discs: they go with the shaft, unless discs that touch push each other apart."""
        return max(self.eccentric, self.disc)


def warm_drive(drive: Drive) -> Drive:
    """Return the drive at its temperatures, which has none any more: itself where it has none.

    Parameters
    ----------
    drive : Drive
        As written: lengths at 20 °C.

    Returns
    -------
    Drive
        Its lengths are those at temperature. Moduli and stiffnesses are those that were given.

    Raises
    ------
    DriveError
        When a material it needs the expansion of has none.

    Examples
    --------
    >>> from ltca.reading.changes import with_fields
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = with_fields(load_drive("paper").cases["CS-1"], {"temperature.disc": 60.0, "materials.disc": "100Cr6",
    ...     "materials.roller": "100Cr6"})
    >>> print(f"{drive.disc.thickness} {warm_drive(drive).disc.thickness:.6f}")
    11.8 11.805381
    """
    held = drive.temperature
    if held is None:
        return drive
    warm = drive
    if held != Temperature():
        growth = growth_of(drive)
        warm = _with_roller_length(_grown(_with_bore_errors(drive, growth), drive, growth), drive, growth)
        warm = _with_backlash_of_teeth(warm, drive, growth)
    return replace(warm, temperature=None, materials=_mechanical(drive))


def growth_of(drive: Drive) -> Growth:
    """Return the factors by which the lengths of each part grow, 1 for a drive without temperatures.

    DriveError where a material whose part is not at 20 °C has no expansion.
    """
    held, materials = drive.temperature or Temperature(), drive.materials
    housing, disc, shaft = held.housing, held.disc, held.shaft
    missing: dict[str, str] = {}

    def factor(part: str, temperature: float, table: str, own: float | None = None) -> float:
        if temperature == REFERENCE_TEMPERATURE:
            return 1.0
        expansion = own if own is not None else getattr(materials, part).thermal_expansion
        if expansion is None:
            missing.setdefault(part, f"temperature.{table} = {getattr(held, table):g} °C")
            return 1.0
        return float(1.0 + expansion * (temperature - REFERENCE_TEMPERATURE))

    # The material of the slots is that of the wheel; with fixed pins it is given for its expansion alone. A ring is the wheel.
    ring = None if drive.ring is None else drive.ring.material.thermal_expansion
    seat = "wheel_seat" if materials.wheel_seat.thermal_expansion is not None else "wheel_pin"
    crank = "crankshaft" if materials.crankshaft.thermal_expansion is not None else "inner_race"
    pins = drive.pin_shaft
    on_wheel = "sleeve" if drive.pin_wheel.seat.kind == "sleeve" else "wheel_pin"
    on_shaft = "sleeve" if pins is not None and pins.seat.kind == "sleeve" else "shaft_pin"
    shaft_pin = factor("shaft_pin", shaft, "shaft") if pins is not None else factor(crank, shaft, "shaft")
    carrier = shaft_pin
    if materials.carrier.thermal_expansion is not None:
        carrier = factor("carrier", shaft, "shaft")
    found = Growth(
        wheel=factor(seat, housing, "housing", ring),
        wheel_pin=factor("wheel_pin", housing, "housing"),
        wheel_sleeve=factor(on_wheel, housing, "housing"),
        disc=factor("disc", disc, "disc"),
        eccentric=factor(crank, shaft, "shaft"),
        race=factor("inner_race", shaft, "shaft"),
        roller=factor("roller", 0.5 * (disc + shaft), "shaft" if shaft != REFERENCE_TEMPERATURE else "disc"),
        carrier=carrier,
        shaft_pin=shaft_pin,
        shaft_sleeve=1.0 if pins is None else factor(on_shaft, shaft, "shaft"),
    )
    if missing:
        raise DriveError(
            [
                Problem.of(
                    f"materials.{part}.thermal_expansion",
                    "",
                    f"is missing; {table} is not the {REFERENCE_TEMPERATURE:g} °C that lengths are given at",
                )
                for part, table in missing.items()
            ]
        )
    return found


def temperature_words(held: Temperature) -> str:
    """Return the temperatures in words."""
    return f"housing {held.housing:g} °C, disc {held.disc:g} °C, shaft {held.shaft:g} °C"


def _mechanical(drive: Drive) -> Materials:
    """The materials without those that a drive has for their expansion alone."""
    materials = drive.materials
    if drive.pin_wheel.seat.kind != "slot":
        materials = replace(materials, wheel_seat=Material())
    if drive.posts is None:
        materials = replace(materials, carrier=Material())
    return materials if drive.crank.support is not None else replace(materials, crankshaft=Material())


@cache
def _growing() -> dict[str, dict[str, Grows | None]]:
    """Names in each table of what grows: fields with their growth, tables with None."""
    found: dict[str, dict[str, Grows | None]] = {}
    for path, field in declared_fields().items():
        grows: Grows | None = field.grows
        if grows is None:
            continue
        while path:
            path, _, name = path.rpartition(".")
            if name != ANY:
                found.setdefault(path, {}).setdefault(name, grows)
            grows = None
    return found


def _grown(part: Any, drive: Drive, growth: Growth, path: str = "") -> Any:
    """A table with every length in it grown as its declaration says; nominal lengths are those of the cold drive."""
    changes: dict[str, Any] = {}
    for name, grows in _growing()[path].items():
        value, below = getattr(part, name), f"{path}.{name}".lstrip(".")
        if value is None:
            continue
        if grows is not None:
            changes[name] = _grown_value(value, grows, drive, growth)
        elif isinstance(value, tuple):
            changes[name] = tuple(_grown(entry, drive, growth, f"{below}.{ANY}") for entry in value)
        else:
            changes[name] = _grown(value, drive, growth, below)
    return replace(part, **changes)


def _grown_value(value: Any, grows: Grows, drive: Drive, growth: Growth) -> Any:
    """A length, or those of an array, at temperature."""
    factor, nominal = getattr(growth, grows.part), attrgetter(grows.upon)(drive) if grows.upon else None
    if nominal is None:
        return tuple(each * factor for each in value) if isinstance(value, tuple) else value * factor
    own = declared_fields()[grows.upon].grows
    nominal_factor = 1.0 if own is None else getattr(growth, own.part)
    if not isinstance(value, tuple):
        return (nominal + value) * factor - nominal * nominal_factor
    shift = nominal * (factor - nominal_factor)
    grown = tuple(each * factor for each in value)
    return tuple(each + shift for each in grown or (0.0,) * _ON_CIRCLE[grows.upon](drive)) if shift else grown


_ON_CIRCLE: Mapping[str, Callable[[Drive], int]] = {
    "pin_shaft.pin_circle_radius": attrgetter("number_of_holes"),
    "crank.circle_radius": attrgetter("crank.number"),
}
"""Number of parts on a circle, whose errors may be left out where all are zero."""


def _with_bore_errors(drive: Drive, growth: Growth) -> Drive:
    """The drive with an entry of bore errors for each disc, where cranks and bores do not grow alike."""
    if drive.crank.number == 1 or drive.crank.circle_radius is None or growth.disc == growth.carrier:
        return drive
    entries = drive.disc.of or (OneDisc(),) * drive.disc.number_of_discs
    entries = tuple(
        entry if entry.bore_errors is not None else replace(entry, bore_errors=BoreErrors()) for entry in entries
    )
    return replace(drive, disc=replace(drive.disc, of=entries))


def _with_backlash_of_teeth(warm: Drive, cold: Drive, growth: Growth) -> Drive:
    """The warm drive with the backlash that the distance of sun and planets leaves its teeth: 2 tan α_wt of what the carrier
    grows more than the teeth.
    """
    stage, distance = cold.first_stage, cold.crank.circle_radius
    if stage is None or distance is None or growth.carrier == growth.eccentric:
        return warm
    opened = 2.0 * stage.mesh(distance).separating * distance * (growth.carrier - growth.eccentric)
    left = stage.backlash * growth.eccentric + opened
    if left < 0.0:
        closed = -opened / growth.eccentric
        said = (
            f"must be at least {closed:.3g} mm, by which teeth close at these temperatures (the carrier grows less than "
            "its crankshafts), or they jam"
        )
        raise DriveError([_of_backlash(stage.backlash, said, closed)])
    assert warm.first_stage is not None
    teeth = replace(warm.first_stage, backlash=left)
    if teeth.closed_by_runout(distance * growth.carrier) > left:
        needed = (teeth.closed_by_runout(distance * growth.carrier) - opened) / growth.eccentric
        said = (
            f"must be at least {needed:.4g} mm beside first_stage.sun_runout and first_stage.planet_runout at these "
            "temperatures, or teeth jam"
        )
        raise DriveError([_of_backlash(stage.backlash, said, needed)])
    return replace(warm, first_stage=teeth)


def _of_backlash(backlash: float, said: str, least: float) -> Problem:
    return Problem.of("first_stage.backlash", f"= {backlash:g} mm", said, bound=("at least", least))


def _with_roller_length(warm: Drive, cold: Drive, growth: Growth) -> Drive:
    """The warm drive with rollers that stay as long as the disc is thick, or do not become longer than it."""
    # A ten-thousandth of the length would be an end that presses.
    length, thickness = cold.roller_length * growth.roller, warm.disc.thickness
    if cold.roller_length == cold.disc.thickness:
        length = thickness
    elif cold.roller_length < cold.disc.thickness:
        length = min(length, thickness)
    return replace(warm, crank_bearing=replace(warm.crank_bearing, roller_length=length))
