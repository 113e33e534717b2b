"""Physical checks of a drive: contradictions between numbers that are valid by themselves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from math import fsum, pi, sin

import numpy as np

from ltca.drive.members.temperatures import temperature_words, warm_drive
from ltca.drive.parts import Drive, LengthProfile, Material, Temperature
from ltca.drive.single_discs import single_discs, without_own
from ltca.drive.unit_mistakes import kelvin_words
from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile
from ltca.geometry.interference import ROUNDING, drawn_interference, lost_play
from ltca.reading.deviation_checks import (
    deviation_bound,
    find_deviation_problems,
    find_disc_problems,
    find_flank_problems,
    named_in_disc,
)
from ltca.reading.pin_checks import find_pin_problems

ELASTIC = "a tenth of the smallest pin or roller radius, beyond what bodies yield elastically"
"""Bound of overlaps in words: bodies strained by a tenth are no longer linear-elastic; sharper limits need a load."""
SHARE_ROUNDING = 1e-9
"""Round-off accepted in the sum of the shares of a duty."""


def find_contradictions(drive: Drive) -> list[str]:
    """Return every physical contradiction of a drive whose single numbers are valid, one sentence each; empty for a sound
    drive.

    Sentences have field, value, bound and unit.
    """
    problems = [*_installation(drive), *find_disc_problems(drive)]
    if problems:
        return problems
    if drive.temperature is not None:
        return _find_at_temperatures(drive)
    common = single_discs(without_own(drive))[0]
    problems = _find_in_disc(common)
    for number, single in enumerate(single_discs(drive)):
        if single is common:
            continue
        alike = replace(single, disc=replace(single.disc, phases=common.disc.phases, planes=common.disc.planes))
        if alike != common:
            own = [named_in_disc(drive, problem, number) for problem in _find_in_disc(single)]
            problems += [problem for problem in own if problem not in problems]
    return problems


def _find_at_temperatures(drive: Drive) -> list[str]:
    """Contradictions of the drive at 20 °C or, where there are none, at its temperatures."""
    cold = _cold(drive)
    if problems := find_contradictions(cold):
        return problems
    try:
        warm = warm_drive(drive)
    except DriveError as error:
        return [*error.problems]
    problems = find_contradictions(warm)
    if not problems or drive.temperature is None:
        return problems
    at = kelvin_words(drive) or f"temperature: {temperature_words(drive.temperature)}"
    if gone := lost_play(cold, warm):
        return [f"{at}: the drive seizes, {'; '.join(gone)}; parts overlap by more than bodies yield elastically"]
    return [f"{at}: {problem}" for problem in problems]


def _cold(drive: Drive) -> Drive:
    """The drive at 20 °C, without materials that are given for their expansion alone."""
    return warm_drive(replace(drive, temperature=Temperature()))


def _find_in_disc(drive: Drive) -> list[str]:
    """Contradictions of a drive of one disc."""
    problems = [problem for check in FIRST for problem in check(drive)]
    if problems:
        return problems  # the geometry below needs them
    problems += _flank(drive)
    if not problems:
        problems += find_flank_problems(drive)
    return problems + [problem for check in BESIDE for problem in check(drive)]


def is_sound(drive: Drive) -> bool:
    """Tell whether a drive has no contradictions; faster than `find_contradictions`, since cheap checks come first."""
    checks = (*FIRST, *BESIDE, _flank, find_flank_problems)
    if any(next(check(drive), None) is not None for check in (_installation, find_disc_problems)):
        return False
    if drive.temperature is not None:
        try:
            return is_sound(_cold(drive)) and is_sound(warm_drive(drive))
        except DriveError:
            return False
    singles = single_discs(drive)
    if len(singles) > 1:  # of discs that are alike one is enough
        alike = {replace(each, disc=replace(each.disc, phases=(), planes=())): each for each in singles}
        singles = tuple(alike.values())
    return all(next(iter(check(single)), None) is None for single in singles for check in checks)


def _installation(drive: Drive) -> Iterator[str]:
    """Problems of fields that belong to one crank or to several, and of supports, pins and duty."""
    crank, stage = drive.crank, drive.installation.first_stage_ratio
    if crank.number == 1:
        if drive.pin_shaft is None:
            yield "pin_shaft: must be given with one crank (crank.number = 1), which alone cannot hold the disc against turning"
        if crank.circle_radius is not None:
            yield (
                f"crank.circle_radius = {crank.circle_radius:g} mm: must be left out with one crank (crank.number = 1), which "
                "stands in the centre"
            )
        if crank.angle:
            yield (
                f"crank.angle = {crank.angle:g} rad: must be left out with one crank (crank.number = 1), which stands in the "
                "centre"
            )
        if stage is not None:
            yield (
                f"installation.first_stage_ratio = {stage:g}: must be left out with one crank (crank.number = 1), which is "
                "the input itself"
            )
    elif crank.circle_radius is None:
        yield f"crank.circle_radius: must be given with several cranks (crank.number = {crank.number})"
    if drive.pin_shaft is None:
        if drive.clearance.pin_hole:
            yield f"clearance.pin_hole = {drive.clearance.pin_hole:g} mm: must be left out without a pin shaft"
        for number, own in enumerate(drive.disc.of):
            if own.clearance is not None and own.clearance.pin_hole:
                yield (
                    f"disc.of.{number}.clearance.pin_hole = {own.clearance.pin_hole:g} mm: must be left out without a pin shaft"
                )
        if drive.materials.shaft_pin != Material():
            yield "materials.shaft_pin: must be left out without a pin shaft"
    yield from (*_crank_support(drive), *find_pin_problems(drive), *_duty(drive))


def _duty(drive: Drive) -> Iterator[str]:
    total = fsum(entry.share for entry in drive.duty)
    if drive.duty and abs(total - 1.0) > SHARE_ROUNDING:
        named = ", ".join(f"duty.{number}.share = {entry.share:g}" for number, entry in enumerate(drive.duty))
        yield f"{named}: must add up to 1, they add up to {total:.10g}"
    if drive.lubricant is not None and not drive.duty and drive.load.speed is None:
        yield (
            f"lubricant.viscosity = {drive.lubricant.viscosity:g} mm²/s: needs a speed, load.speed or those of [[duty]]; "
            "without one no film can be computed"
        )


def _crank_support(drive: Drive) -> Iterator[str]:
    support = drive.crank.support
    if support is None:
        expands = drive.temperature is not None and drive.materials.crankshaft.thermal_expansion is not None
        if drive.materials.crankshaft != Material() and not expands:
            yield (
                "materials.crankshaft: must be left out without crank.support, where cranks are rigid, but for its "
                "thermal_expansion beside [temperature]"
            )
        return
    start, end = support.positions
    if end <= start:
        yield f"crank.support.positions holds {start:g} and {end:g} mm: must ascend"
        return
    bore = 2.0 * drive.crank_bearing.inner_race_radius
    if support.diameter > bore:
        yield (
            f"crank.support.diameter = {support.diameter:g} mm: must be at most {bore:g} mm, the diameter of the inner race on it"
        )
    planes = drive.disc.disc_planes
    reach = end - start
    for plane in (min(planes), max(planes)):
        if not start - reach <= plane <= end + reach:
            yield (
                f"crank.support.positions holds {start:g} and {end:g} mm: a disc at {plane:g} mm (disc.planes) hangs over by "
                f"more than their distance {reach:g} mm"
            )
            return


def _tooth_numbers(drive: Drive) -> Iterator[str]:
    pins, teeth = drive.pin_wheel.number_of_pins, drive.disc.number_of_teeth
    if pins - teeth != 1:
        yield (
            f"disc.number_of_teeth = {teeth}: must be {pins - 1}, one less than pin_wheel.number_of_pins = {pins} "
            "(other tooth-number differences are not supported)"
        )


def _flank(drive: Drive) -> Iterator[str]:
    wheel, disc, e = drive.pin_wheel, drive.disc, drive.crank.eccentricity
    pitch_radius = e * drive.reduction_ratio
    smallest = min(wheel.pin_circle_radius, wheel.pin_circle_radius + disc.shifting_offset)
    if pitch_radius >= smallest:
        yield (
            f"crank.eccentricity = {e:g} mm: must be less than {smallest / drive.reduction_ratio:.6g} mm "
            "(pin circle radius by number of pins, shifting offset included), or the flank has loops"
        )
        return
    profile = FlankProfile.of_drive(drive)
    if profile.offset <= 0.0:
        yield (
            f"disc.equidistant_offset = {disc.equidistant_offset:g} mm: must be greater than "
            f"{-wheel.pin_radius:g} mm (minus the pin radius)"
        )
        return
    smallest_radius = _smallest_path_radius(wheel.pin_circle_radius + disc.shifting_offset, e, drive.reduction_ratio)
    if smallest_radius <= profile.offset:
        yield (
            f"pin_wheel.pin_radius = {wheel.pin_radius:g} mm: must be less than "
            f"{smallest_radius - disc.equidistant_offset:.6g} mm (smallest radius of the pin-centre path on its "
            "convex side less the equidistant offset), or the flank is undercut"
        )
    if profile.root_radius <= 0.0:
        yield (
            f"pin_wheel.pin_circle_radius = {wheel.pin_circle_radius:g} mm: leaves a root radius of "
            f"{profile.root_radius:.6g} mm, must be greater than 0 mm"
        )
    overlap = drawn_interference(drive).pins
    bound = deviation_bound(drive)
    if overlap > bound + ROUNDING:
        yield (
            f"disc.equidistant_offset = {disc.equidistant_offset:g} mm: must be at least "
            f"{disc.equidistant_offset + overlap - bound:.6g} mm with this shifting offset, or disc and pins overlap by "
            f"more than {bound:g} mm, {ELASTIC}"
        )


@lru_cache(maxsize=64)
def _smallest_path_radius(radius: float, eccentricity: float, ratio: float) -> float:
    """Smallest convex radius of the pin-centre path, mm; cached, since studies check one design thousands of times."""
    path = FlankProfile(generating_radius=radius, eccentricity=eccentricity, reduction_ratio=ratio, offset=0.0)
    largest = float(np.max(path.locus_curvature(np.linspace(0.0, 2.0 * pi / ratio, 4001))))
    return 1.0 / largest if largest > 0.0 else float("inf")


def _pins(drive: Drive) -> Iterator[str]:
    wheel = drive.pin_wheel
    room = wheel.pin_circle_radius * sin(pi / wheel.number_of_pins)
    if wheel.pin_radius >= room:
        yield (
            f"pin_wheel.pin_radius = {wheel.pin_radius:g} mm: must be less than {room:.6g} mm, "
            "or neighbouring pins overlap"
        )
    shaft = drive.pin_shaft
    if shaft is None:
        return
    room = shaft.pin_circle_radius * sin(pi / shaft.number_of_pins)
    if shaft.pin_radius >= room:
        yield (
            f"pin_shaft.pin_radius = {shaft.pin_radius:g} mm: must be less than {room:.6g} mm, "
            "or neighbouring pins overlap"
        )


def _bearing(drive: Drive) -> Iterator[str]:
    bearing = drive.crank_bearing
    space = bearing.outer_race_radius - bearing.inner_race_radius
    if space <= 0.0:
        fitting = bearing.outer_race_radius - 2.0 * bearing.roller_radius
        bound = f"at most {fitting:g} mm" if fitting > 0.0 else f"less than {bearing.outer_race_radius:g} mm"
        yield (
            f"crank_bearing.inner_race_radius = {bearing.inner_race_radius:g} mm: must be {bound}, or the rollers have no "
            f"room below the outer race (outer_race_radius = {bearing.outer_race_radius:g} mm)"
        )
    elif (overlap := drawn_interference(drive).rollers) > (elastic := deviation_bound(drive)) + ROUNDING:
        yield (
            f"crank_bearing.roller_radius = {bearing.roller_radius:g} mm: must be at most "
            f"{bearing.roller_radius - 0.5 * (overlap - elastic):.6g} mm, or it overlaps the races by more than {elastic:g} mm, "
            f"{ELASTIC}"
        )
    elif 2.0 * bearing.roller_radius < 0.9 * space:
        yield (
            f"crank_bearing.roller_radius = {bearing.roller_radius:g} mm: must be at least {0.45 * space:.6g} mm, "
            "or the rollers are loose between the races (give clearance as clearance.bearing)"
        )
    room = (bearing.inner_race_radius + bearing.roller_radius) * sin(pi / bearing.number_of_rollers)
    if bearing.roller_radius >= room:
        yield (
            f"crank_bearing.number_of_rollers = {bearing.number_of_rollers}: rollers of radius "
            f"{bearing.roller_radius:g} mm overlap, their radius must be less than {room:.6g} mm"
        )
    if bearing.roller_length > drive.disc.thickness + ROUNDING:
        yield (
            f"crank_bearing.roller_length = {bearing.roller_length:g} mm: must be at most "
            f"{drive.disc.thickness:g} mm, the thickness of the disc"
        )
    if drive.clearance.bearing > bearing.roller_radius:
        yield (
            f"clearance.bearing = {drive.clearance.bearing:g} mm: must be at most {bearing.roller_radius:g} mm, "
            "the roller radius"
        )


def _holes(drive: Drive) -> Iterator[str]:
    shaft, e = drive.pin_shaft, drive.crank.eccentricity
    if shaft is None:
        return
    play = shaft.hole_radius - shaft.pin_radius
    # Seen from the hole, a sleeve with play is a smaller fixed pin. Pins in tight holes push the disc along the
    # eccentricity: by half of it they would lead it no more.
    most = min(deviation_bound(drive), 0.5 * e)
    smallest = shaft.pin_radius - shaft.seat_play + e - drive.clearance.pin_hole - most
    if shaft.hole_radius < smallest - ROUNDING:
        yield (
            f"pin_shaft.hole_radius = {shaft.hole_radius:g} mm: must be at least {smallest:g} mm, or it overlaps its pin by more "
            f"than {most:g} mm, {ELASTIC} (and half the eccentricity at most)"
        )
    elif play > 1.5 * e:
        yield (
            f"pin_shaft.hole_radius = {shaft.hole_radius:g} mm: must be at most {shaft.pin_radius + 1.5 * e:g} mm, "
            "pin radius plus 1.5 eccentricities, or the pins cannot lead the disc"
        )
    if drive.clearance.pin_hole > 0.5 * e:
        yield (
            f"clearance.pin_hole = {drive.clearance.pin_hole:g} mm: must be at most {0.5 * e:g} mm, "
            "half the eccentricity"
        )
    radius, circle = drive.hole_radius, shaft.pin_circle_radius
    # A hole has to clear its pin by the eccentricity: where it cannot shrink enough, the circle it stands on is wrong.
    fitting = shaft.pin_radius - shaft.seat_play + e

    def hole_or_circle(excess: float, trouble: str, circle_bound: str) -> str:
        bound = shaft.hole_radius - excess
        if bound > fitting or play + shaft.seat_play < e - ROUNDING:
            return f"pin_shaft.hole_radius = {shaft.hole_radius:g} mm: {trouble}; must be less than {max(bound, 0.0):.6g} mm"
        return f"pin_shaft.pin_circle_radius = {circle:g} mm: {trouble}; must be {circle_bound}"

    wall = circle - radius - drive.bore_radius
    if wall <= 0.0 and drive.crank.number == 1:
        yield hole_or_circle(
            -wall, f"holes cut into the bore by {-wall:.6g} mm", f"greater than {circle - wall:.6g} mm"
        )
    sine = sin(pi / shaft.number_of_pins)
    wall = 2.0 * (circle * sine - radius)
    if wall <= 0.0:
        yield hole_or_circle(
            -0.5 * wall,
            f"neighbouring holes cut into each other by {-wall:.6g} mm",
            f"greater than {radius / sine:.6g} mm",
        )
    root = FlankProfile.of_drive(drive).root_radius
    wall = root - circle - radius
    inside = drive.bore_radius if drive.crank.number == 1 else 0.0
    if wall <= 0.0 and root - radius > radius + inside:
        yield hole_or_circle(
            -wall,
            f"holes cut through the root circle of the disc (radius {root:.6g} mm) by {-wall:.6g} mm",
            f"less than {root - radius:.6g} mm",
        )
    elif wall <= 0.0 and drive.pin_wheel.pin_circle_radius + drive.disc.shifting_offset > 0.0:
        # No circle has room for the holes; an offset that leaves no pin circle is reported with the flank.
        wheel = drive.pin_wheel
        yield (
            f"pin_wheel.pin_circle_radius = {wheel.pin_circle_radius:g} mm: holes cut through the root circle of the disc "
            f"(radius {root:.6g} mm) by {-wall:.6g} mm; must be greater than {wheel.pin_circle_radius - wall:.6g} mm"
        )
    if drive.bore_radius >= root > 0.0:
        yield (
            f"crank_bearing.outer_race_radius = {drive.crank_bearing.outer_race_radius:g} mm: must be less than "
            f"{root:.6g} mm, the root radius of the disc"
        )


def _length_profiles(drive: Drive) -> Iterator[str]:
    bearing = drive.crank_bearing
    profiles: list[tuple[str, LengthProfile, float, float]] = [
        (
            "crank_bearing.roller_profile",
            bearing.roller_profile,
            bearing.roller_length,
            bearing.roller_radius,
        ),
        (
            "pin_wheel.pin_profile",
            drive.pin_wheel.pin_profile,
            drive.disc.thickness,
            drive.pin_wheel.pin_radius,
        ),
    ]
    for path, profile, length, radius in profiles:
        if profile.end_relief_length > 0.5 * length:
            yield (
                f"{path}.end_relief_length = {profile.end_relief_length:g} mm: must be at most "
                f"{0.5 * length:g} mm, half the contact length"
            )
        for name in ("crown_drop", "end_relief_depth"):
            if (drop := getattr(profile, name)) > 0.1 * radius:
                yield f"{path}.{name} = {drop:g} mm: must be at most {0.1 * radius:g} mm, a tenth of the radius"
        if profile.logarithmic_factor > 100.0:
            yield f"{path}.logarithmic_factor = {profile.logarithmic_factor:g}: must be at most 100"


def _bores(drive: Drive) -> Iterator[str]:
    """Problems of the walls around the bores of several cranks."""
    crank, radius = drive.crank, drive.bore_radius
    if crank.number == 1 or crank.circle_radius is None:
        return
    circle = crank.circle_radius
    path = f"crank.circle_radius = {circle:g} mm"
    sine = sin(pi / crank.number)
    wall = 2.0 * (circle * sine - radius)
    if wall <= 0.0:
        yield (
            f"{path}: neighbouring bores of {crank.number} cranks cut into each other by {-wall:.6g} mm; must be greater than "
            f"{radius / sine:.6g} mm"
        )
    root = FlankProfile.of_drive(drive).root_radius
    wall = root - circle - radius
    if wall <= 0.0:
        yield (
            f"{path}: bores cut through the root circle of the disc (radius {root:.6g} mm) by {-wall:.6g} mm; must be less "
            f"than {root - radius:.6g} mm"
        )
    shaft = drive.pin_shaft
    if shaft is None:
        return
    holes = shaft.pin_circle_radius * np.exp(2j * np.pi * np.arange(shaft.number_of_pins) / shaft.number_of_pins)
    distance = float(np.min(np.abs(holes[:, None] - np.array(crank.places))))
    wall = distance - drive.hole_radius - radius
    if wall <= 0.0:
        yield (
            f"{path}: a bore and a hole (pin_shaft.pin_circle_radius = {shaft.pin_circle_radius:g} mm) cut into each other by "
            f"{-wall:.6g} mm; other radii or crank.angle must leave a wall"
        )


def _friction(drive: Drive) -> Iterator[str]:
    """Problems of coefficients of absent joints, and of support bearings without radius."""
    friction, shaft = drive.friction, drive.pin_shaft
    if friction is None:
        return
    seats = {drive.pin_wheel.seat.kind} | (set() if shaft is None else {shaft.seat.kind})
    if friction.seat and seats == {"fixed"}:
        yield (
            f"friction.seat = {friction.seat:g}: must be left out, or 0, where no pin lies loose or carries a sleeve "
            "(pin_wheel.seat, pin_shaft.seat)"
        )
    if friction.hole and shaft is None:
        yield f"friction.hole = {friction.hole:g}: must be left out, or 0, without a pin shaft"
    if friction.support_bearing and not friction.support_bearing_radius:
        yield (
            f"friction.support_bearing_radius = 0 mm: must be given, greater than 0 mm, with friction.support_bearing = "
            f"{friction.support_bearing:g}"
        )


FIRST = (find_deviation_problems, _tooth_numbers)
"""Checks that the geometry needs."""
BESIDE = (_pins, _bearing, _holes, _bores, _length_profiles, _friction)
"""Checks that do not depend on the flank."""
