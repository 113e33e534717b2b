"""Checks of seats and beams of pins: fields that belong together, plays, spans and diameters."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sin

from ltca.drive.materials import Material
from ltca.drive.members.pins import PinShaft, PinWheel, ShaftPinBeam, WheelPinBeam
from ltca.drive.parts import Drive

ROUNDING = 1e-9
"""Difference up to which lengths are equal, mm: round-off of a sum, and less than any real play."""
BELONGS = {"radius": "slot", "pin_radius": "sleeve", "bore_radius": "sleeve"}
"""Fields of a seat, and the kind of seat they belong to."""


def find_pin_problems(drive: Drive) -> Iterator[str]:
    """Yield the problems of seats and beams of pins and of their materials, one sentence each; single numbers are valid
    already.
    """
    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    yield from _seat(wheel, "pin_wheel", 1.0, drive.crank.eccentricity)
    yield from _slots(wheel)
    if wheel.beam is not None:
        yield from _beam(drive, wheel, wheel.beam, "pin_wheel")
    if shaft is not None:
        yield from _seat(shaft, "pin_shaft", 0.5, drive.crank.eccentricity)
        if shaft.beam is not None:
            yield from _beam(drive, shaft, shaft.beam, "pin_shaft")
        yield from _one_compliance(shaft)
        if not shaft.elastic_contact and shaft.seat.kind == "sleeve":
            yield 'pin_shaft.elastic_contact = false: must be true with sleeves (pin_shaft.seat.kind = "sleeve"), which yield'
    kinds = {wheel.seat.kind} | (set() if shaft is None else {shaft.seat.kind})
    if "slot" not in kinds and drive.materials.wheel_seat != Material() and not _expands(drive, "wheel_seat"):
        yield (
            'materials.wheel_seat: must be left out without slots (pin_wheel.seat.kind = "slot"), but for its thermal_expansion '
            "beside [temperature]"
        )
    if "sleeve" not in kinds and drive.materials.sleeve != Material():
        yield 'materials.sleeve: must be left out without sleeves (pin_wheel.seat, pin_shaft.seat: kind = "sleeve")'


def _expands(drive: Drive, part: str) -> bool:
    """Whether a material is used for its thermal expansion, whatever else it is given for."""
    return drive.temperature is not None and getattr(drive.materials, part).thermal_expansion is not None


def _one_compliance(shaft: PinShaft) -> Iterator[str]:
    if shaft.beam is None and shaft.stiffness is None:
        yield "pin_shaft.stiffness: is missing; pins of the shaft need it, or pin_shaft.beam in its place"
    elif shaft.beam is not None and shaft.stiffness is not None:
        yield (
            f"pin_shaft.stiffness = {shaft.stiffness:g} N/mm: must be left out beside pin_shaft.beam, which determines how "
            "the pins bend"
        )


def _seat(part: PinWheel | PinShaft, path: str, most: float, eccentricity: float) -> Iterator[str]:
    """Problems of the fields and radii of a seat; the play is at most the fraction `most` of the eccentricity."""
    kind = part.seat.kind
    given = {name: getattr(part.seat, name, None) for name in BELONGS}
    said = f'{path}.seat.kind = "{kind}"' + (" (the default)" if kind == "fixed" else "")
    sound = True
    for name, value in given.items():
        if value is not None and BELONGS[name] != kind:
            sound = False
            yield f'{path}.seat.{name} = {value:g} mm: must be left out with {said}; it belongs to "{BELONGS[name]}"'
        elif value is None and BELONGS[name] == kind:
            sound = False
            yield f"{path}.seat.{name}: must be given with {said}"
    if kind == "fixed" or not sound:
        return
    errors = part.pin_errors.diameter
    growth, shrinkage = max((*errors, 0.0)), -min((*errors, 0.0))
    play, largest, outer = part.seat_play, most * eccentricity, part.pin_radius
    inner, pin, bore, hole = (
        (outer, f"{path}.pin_radius", given["radius"] or 0.0, "radius")
        if kind == "slot"
        else (given["pin_radius"] or 0.0, f"{path}.seat.pin_radius", given["bore_radius"] or 0.0, "bore_radius")
    )
    what = "slot" if kind == "slot" else "sleeve"
    named = f"{path}.seat.{hole} = {bore:g} mm"
    if play <= ROUNDING:
        yield f"{named}: must be greater than {inner:g} mm ({pin}), or the pin has no play in its {what}"
    elif kind == "slot" and bore >= 2.0 * outer - ROUNDING:
        yield (
            f"{named}: must be less than {2.0 * outer:g} mm, twice {pin}, or the pin is no guide any more (its effective "
            f"radius {2.0 * outer - bore:g} mm is none)"
        )
    elif kind == "sleeve" and bore >= outer - ROUNDING:
        yield f"{named}: must be less than {outer:g} mm ({path}.pin_radius), or the sleeve has no wall"
    elif play > largest + ROUNDING:
        part_of = "the eccentricity" if most == 1.0 else "half the eccentricity"
        yield (
            f"{named}: must be at most {inner + largest:g} mm, {pin} and {part_of}, or the pins cannot lead the disc "
            f"(play {play:g} mm)"
        )
    elif kind == "slot" and 0.5 * growth >= play - ROUNDING:
        yield (
            f"{path}.pin_errors.diameter holds {growth:g} mm: must be less than {2.0 * play:.6g} mm, twice the play of "
            f"{path}.seat.radius, or the pin does not fit its slot"
        )
    elif kind == "slot" and bore >= 2.0 * outer - shrinkage - ROUNDING:
        yield (
            f"{path}.pin_errors.diameter holds {-shrinkage:g} mm: must be greater than {bore - 2.0 * outer:.6g} mm, or the "
            f"slot ({path}.seat.radius) is twice as wide as the pin"
        )
    elif kind == "sleeve" and outer - 0.5 * shrinkage <= bore + ROUNDING:
        yield (
            f"{path}.pin_errors.diameter holds {-shrinkage:g} mm: must be greater than {2.0 * (bore - outer):.6g} mm, or the "
            f"sleeve ({path}.seat.bore_radius) has no wall"
        )


def _slots(wheel: PinWheel) -> Iterator[str]:
    room, radius = wheel.pin_circle_radius * sin(pi / wheel.number_of_pins), wheel.seat.radius or 0.0
    # Pins that overlap, or have no hold in their slots, are reported elsewhere.
    if wheel.seat.kind == "slot" and radius >= room > wheel.pin_radius > 0.5 * radius:
        yield (
            f"pin_wheel.seat.radius = {radius:g} mm: must be less than {room:.6g} mm, or neighbouring slots cut into each other"
        )


def _beam(drive: Drive, part: PinWheel | PinShaft, beam: WheelPinBeam | ShaftPinBeam, path: str) -> Iterator[str]:
    half, thickness, planes = 0.5 * beam.span, drive.disc.thickness, drive.disc.disc_planes
    disc = max(range(len(planes)), key=lambda number: abs(planes[number]))
    reach = abs(planes[disc]) + 0.5 * thickness
    if half < reach - ROUNDING * max(reach, 1.0):
        which = "the disc" if len(planes) == 1 else f"disc {disc}"
        low, high = planes[disc] - 0.5 * thickness, planes[disc] + 0.5 * thickness
        held = "walls" if isinstance(beam, WheelPinBeam) else "flange and tip"
        yield (
            f"{path}.beam.span = {beam.span:g} mm: must be at least {2.0 * reach:.6g} mm, or {which} from {low:.6g} to "
            f"{high:.6g} mm (disc.planes, disc.thickness) is not between the {held} at ±{half:g} mm"
        )
    sleeved = part.seat.kind == "sleeve" and part.seat.bore_radius is not None
    widest = 2.0 * ((part.seat.bore_radius or 0.0) if sleeved else part.pin_radius)
    of = f"the bore of its sleeve ({path}.seat.bore_radius)" if sleeved else f"that of the pin ({path}.pin_radius)"
    if beam.diameter is not None and beam.diameter > widest + ROUNDING:
        yield f"{path}.beam.diameter = {beam.diameter:g} mm: must be at most {widest:g} mm, {of}"
