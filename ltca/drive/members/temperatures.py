"""A drive at its temperatures: every length of a part times 1 + α ΔT of its own material, said by the fields there are.

The flank grows with its disc: pin circle, pins and eccentricity that it is generated with by one factor, which is exact. The
pin circle of the wheel grows with the housing, the eccentric with the crank: what is left between them are the offsets of the
flank and the error of the eccentricity. Holes stand on a circle of the disc, shaft pins on one of the carrier, and so do bores
and several cranks: that difference is an error of place, alike for all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ltca.drive.deviations import (
    AxisOffset,
    BoreErrors,
    DiscClearance,
    OneDisc,
    OneEccentric,
    PlacementErrors,
    ProfileErrors,
    RollerErrors,
    Runout,
)
from ltca.drive.materials import LengthProfile, Material
from ltca.drive.members.crank import Crank, CrankBearing
from ltca.drive.members.operation import REFERENCE_TEMPERATURE, Temperature
from ltca.drive.members.pins import PinShaft, PinWheel
from ltca.drive.parts import Clearance, Disc, Drive
from ltca.errors import DriveError


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """By what factor the lengths of each part grow, 1 at 20 °C.

    Attributes
    ----------
    wheel, wheel_pin, wheel_sleeve : float
        Circle and slots of the wheel; its pins; what the flank touches, pins or sleeves.
    disc : float
        Flank, holes, bores, thickness.
    eccentric, race, roller : float
        Eccentricity and crankshaft; inner races; rollers, half as warm as disc and shaft together.
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
    if held == Temperature():
        return replace(drive, temperature=None, materials=_used(drive))
    grown = growth_of(drive)
    return replace(
        drive,
        temperature=None,
        materials=_used(drive),
        crank=_crank(drive.crank, grown),
        pin_wheel=_pin_wheel(drive.pin_wheel, grown),
        disc=_disc(drive, grown),
        crank_bearing=_bearing(drive, grown),
        pin_shaft=None if drive.pin_shaft is None else _pin_shaft(drive.pin_shaft, grown),
        clearance=Clearance(
            bearing=drive.clearance.bearing * grown.disc, pin_hole=drive.clearance.pin_hole * grown.disc
        ),
        friction=None
        if drive.friction is None
        else replace(drive.friction, support_bearing_radius=drive.friction.support_bearing_radius * grown.eccentric),
    )


def growth_of(drive: Drive) -> Growth:
    """Return by what factor the lengths of each part grow.

    Parameters
    ----------
    drive : Drive
        With its temperatures; a drive without them does not grow.

    Raises
    ------
    DriveError
        When a material whose part is not at 20 °C has no expansion.
    """
    held, materials = drive.temperature or Temperature(), drive.materials
    housing, disc, shaft = held.housing, held.disc, held.shaft
    missing: dict[str, str] = {}

    def factor(part: str, temperature: float, table: str) -> float:
        if temperature == REFERENCE_TEMPERATURE:
            return 1.0
        expansion = getattr(materials, part).thermal_expansion
        if expansion is None:
            missing.setdefault(part, f"temperature.{table} = {getattr(held, table):g} °C")
            return 1.0
        return float(1.0 + expansion * (temperature - REFERENCE_TEMPERATURE))

    # What the wheel is made of: that of its slots, which of fixed pins says nothing but the expansion.
    seat = "wheel_seat" if materials.wheel_seat.thermal_expansion is not None else "wheel_pin"
    crank = "crankshaft" if materials.crankshaft.thermal_expansion is not None else "inner_race"
    pins = drive.pin_shaft
    on_wheel = "sleeve" if drive.pin_wheel.seat.kind == "sleeve" else "wheel_pin"
    on_shaft = "sleeve" if pins is not None and pins.seat.kind == "sleeve" else "shaft_pin"
    carrier = factor("shaft_pin" if pins is not None else crank, shaft, "shaft")
    found = Growth(
        wheel=factor(seat, housing, "housing"),
        wheel_pin=factor("wheel_pin", housing, "housing"),
        wheel_sleeve=factor(on_wheel, housing, "housing"),
        disc=factor("disc", disc, "disc"),
        eccentric=factor(crank, shaft, "shaft"),
        race=factor("inner_race", shaft, "shaft"),
        roller=factor("roller", 0.5 * (disc + shaft), "shaft" if shaft != REFERENCE_TEMPERATURE else "disc"),
        carrier=carrier,
        shaft_pin=carrier,
        shaft_sleeve=1.0 if pins is None else factor(on_shaft, shaft, "shaft"),
    )
    if missing:
        raise DriveError(
            [
                f"materials.{part}.thermal_expansion: is missing; {table} is not the {REFERENCE_TEMPERATURE:g} °C that "
                "lengths are given at"
                for part, table in missing.items()
            ]
        )
    return found


def temperature_words(held: Temperature) -> str:
    """Return the temperatures in words."""
    return f"housing {held.housing:g} °C, disc {held.disc:g} °C, shaft {held.shaft:g} °C"


def _used(drive: Drive) -> Any:
    """The materials, without those that were there for their expansion alone."""
    materials = drive.materials
    if drive.pin_wheel.seat.kind != "slot":
        materials = replace(materials, wheel_seat=Material())
    return materials if drive.crank.support is not None else replace(materials, crankshaft=Material())


def _times(values: tuple[float, ...], factor: float) -> tuple[float, ...]:
    return tuple(value * factor for value in values)


def _optional(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _offset(offset: AxisOffset, factor: float) -> AxisOffset:
    return AxisOffset(x=offset.x * factor, y=offset.y * factor)


def _placed(errors: PlacementErrors, place: float, size: float) -> PlacementErrors:
    return PlacementErrors(
        radial=_times(errors.radial, place),
        tangential=_times(errors.tangential, place),
        diameter=_times(errors.diameter, size),
    )


def _profile(profile: LengthProfile, factor: float) -> LengthProfile:
    return replace(
        profile,
        crown_drop=profile.crown_drop * factor,
        end_relief_length=profile.end_relief_length * factor,
        end_relief_depth=profile.end_relief_depth * factor,
    )


def _moved(values: tuple[float, ...], count: int, shift: float) -> tuple[float, ...]:
    """Errors of all parts of a circle, each more by a shift; none where nothing shifts."""
    return tuple(value + shift for value in values or (0.0,) * count) if shift else values


def _crank(crank: Crank, grown: Growth) -> Crank:
    nominal = crank.eccentricity * grown.disc  # of the flank

    def error(own: float) -> float:
        return (crank.eccentricity + own) * grown.eccentric - nominal

    def entry(own: OneEccentric) -> OneEccentric:
        given = own.eccentricity_error
        return own if given is None else replace(own, eccentricity_error=error(given))

    support = crank.support
    return replace(
        crank,
        eccentricity=nominal,
        eccentricity_error=error(crank.eccentricity_error),
        circle_radius=_optional(crank.circle_radius, grown.carrier),
        axis_offset=_offset(crank.axis_offset, grown.carrier),
        of=tuple(entry(own) for own in crank.of),
        support=None
        if support is None
        else replace(
            support,
            diameter=support.diameter * grown.eccentric,
            positions=(support.positions[0] * grown.eccentric, support.positions[1] * grown.eccentric),
        ),
    )


def _pin_wheel(wheel: PinWheel, grown: Growth) -> PinWheel:
    beam, seat = wheel.beam, wheel.seat
    return replace(
        wheel,
        pin_circle_radius=wheel.pin_circle_radius * grown.wheel,
        pin_radius=wheel.pin_radius * grown.wheel_sleeve,
        pin_profile=_profile(wheel.pin_profile, grown.wheel_sleeve),
        pin_errors=_placed(wheel.pin_errors, grown.wheel, grown.wheel_sleeve),
        axis_offset=_offset(wheel.axis_offset, grown.wheel),
        seat=replace(
            seat,
            radius=_optional(seat.radius, grown.wheel),
            pin_radius=_optional(seat.pin_radius, grown.wheel_pin),
            bore_radius=_optional(seat.bore_radius, grown.wheel_sleeve),
        ),
        beam=None
        if beam is None
        else replace(beam, span=beam.span * grown.wheel, diameter=_optional(beam.diameter, grown.wheel_pin)),
    )


def _disc(drive: Drive, grown: Growth) -> Disc:
    disc, wheel, factor = drive.disc, drive.pin_wheel, grown.disc
    # Planes go with the shaft; discs that touch push each other apart where they grow more.
    planes = _times(disc.planes, max(grown.eccentric, factor))
    own = disc.of
    shift = 0.0
    if drive.crank.number > 1 and drive.crank.circle_radius is not None:
        shift = drive.crank.circle_radius * (factor - grown.carrier)
    if shift and not own:
        own = (OneDisc(),) * disc.number_of_discs
    return replace(
        disc,
        thickness=disc.thickness * factor,
        planes=planes,
        equidistant_offset=(wheel.pin_radius + disc.equidistant_offset) * factor
        - wheel.pin_radius * grown.wheel_sleeve,
        shifting_offset=(wheel.pin_circle_radius + disc.shifting_offset) * factor
        - wheel.pin_circle_radius * grown.wheel,
        hole_errors=_placed(disc.hole_errors, factor, factor),
        profile_errors=_deviation(disc.profile_errors, factor),
        runout=_runout(disc.runout, factor),
        of=tuple(_one_disc(entry, grown, drive.crank.number, shift) for entry in own),
    )


def _deviation(errors: ProfileErrors, factor: float) -> ProfileErrors:
    return replace(
        errors,
        cosine=_times(errors.cosine, factor),
        sine=_times(errors.sine, factor),
        deviation=_times(errors.deviation, factor),
    )


def _runout(runout: Runout, factor: float) -> Runout:
    return replace(runout, amount=runout.amount * factor)


def _one_disc(own: OneDisc, grown: Growth, cranks: int, shift: float) -> OneDisc:
    factor, clearance, bores = grown.disc, own.clearance, own.bore_errors
    if shift and bores is None:
        bores = BoreErrors()
    return OneDisc(
        runout=None if own.runout is None else _runout(own.runout, factor),
        profile_errors=None if own.profile_errors is None else _deviation(own.profile_errors, factor),
        hole_errors=None if own.hole_errors is None else _placed(own.hole_errors, factor, factor),
        clearance=None
        if clearance is None
        else DiscClearance(
            bearing=_optional(clearance.bearing, factor), pin_hole=_optional(clearance.pin_hole, factor)
        ),
        roller_errors=None if own.roller_errors is None else _rollers(own.roller_errors, grown.roller),
        bore_errors=None
        if bores is None
        else BoreErrors(
            radial=_moved(_times(bores.radial, factor), cranks, shift), tangential=_times(bores.tangential, factor)
        ),
    )


def _rollers(errors: RollerErrors, factor: float) -> RollerErrors:
    return RollerErrors(tangential=_times(errors.tangential, factor), diameter=_times(errors.diameter, factor))


def _bearing(drive: Drive, grown: Growth) -> CrankBearing:
    bearing = drive.crank_bearing
    # A roller as long as the disc stays so: a ten-thousandth of its length is no end that presses.
    length = bearing.roller_length * grown.roller
    if bearing.roller_length == drive.disc.thickness:
        length = drive.disc.thickness * grown.disc
    elif bearing.roller_length < drive.disc.thickness:
        length = min(length, drive.disc.thickness * grown.disc)
    return replace(
        bearing,
        inner_race_radius=bearing.inner_race_radius * grown.race,
        outer_race_radius=bearing.outer_race_radius * grown.disc,
        roller_radius=bearing.roller_radius * grown.roller,
        roller_length=length,
        roller_profile=_profile(bearing.roller_profile, grown.roller),
        roller_errors=_rollers(bearing.roller_errors, grown.roller),
    )


def _pin_shaft(shaft: PinShaft, grown: Growth) -> PinShaft:
    beam, seat = shaft.beam, shaft.seat
    errors = _placed(shaft.pin_errors, grown.carrier, grown.shaft_sleeve)
    shift = shaft.pin_circle_radius * (grown.carrier - grown.disc)
    return replace(
        shaft,
        pin_circle_radius=shaft.pin_circle_radius * grown.disc,  # of the holes
        pin_errors=replace(errors, radial=_moved(errors.radial, shaft.number_of_pins, shift)),
        pin_radius=shaft.pin_radius * grown.shaft_sleeve,
        hole_radius=shaft.hole_radius * grown.disc,
        seat=replace(
            seat,
            pin_radius=_optional(seat.pin_radius, grown.shaft_pin),
            bore_radius=_optional(seat.bore_radius, grown.shaft_sleeve),
        ),
        beam=None
        if beam is None
        else replace(beam, span=beam.span * grown.carrier, diameter=_optional(beam.diameter, grown.shaft_pin)),
    )
