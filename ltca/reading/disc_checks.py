"""Checks of a drive of one disc: tooth numbers, flank, pins, bearing, holes and bores, and their deviations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache
from math import floor, isfinite, log10, pi, sin

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.deviations import BoreErrors
from ltca.drive.members.width import LARGEST_SLOPE
from ltca.drive.parts import Drive, LengthProfile, PlacementErrors, RollerErrors
from ltca.errors import Problem, counted
from ltca.geometry.flank import CurveFrame, FlankProfile, trochoid_curvature
from ltca.geometry.interference import ROUNDING, drawn_interference
from ltca.geometry.rotation import unit
from ltca.reading.alternatives import Bound, bounded
from ltca.reading.width_checks import find_lead_problems, slope_bound

ELASTIC = "a tenth of the smallest pin or roller radius, beyond what bodies yield elastically"
"""Bound of overlaps in words: bodies strained by a tenth are no longer linear-elastic; sharper limits need a load."""
MOST_HOLE_PLAY = 1.5
"""Largest difference of hole and pin radius, by the eccentricity, at which the pins still lead the disc."""
ROUND_FLANK = 0.1
"""Least convex radius of a flank that is suggested, by that of the pins: with less, contacts are wider than the flank goes on."""
POINTS_PER_WAVE = 24
"""Points at which the flank is checked, per wave of the highest order."""


def find_disc_problems(drive: Drive) -> list[Problem]:
    """Contradictions of a drive of one disc."""
    problems = [problem for check in FIRST for problem in check(drive)]
    if problems:
        return problems  # the geometry below needs them
    problems += _flank(drive)
    if not problems:
        problems += find_flank_problems(drive)
    return problems + [problem for check in BESIDE for problem in check(drive)]


def _tooth_numbers(drive: Drive) -> Iterator[Problem]:
    pins, teeth = drive.pin_wheel.number_of_pins, drive.disc.number_of_teeth
    if pins - teeth != 1:
        yield Problem.of(
            "disc.number_of_teeth",
            f"= {teeth}",
            f"must be {pins - 1}, one less than pin_wheel.number_of_pins = {pins} (other tooth-number "
            "differences are not supported)",
        )


def _flank(drive: Drive) -> Iterator[Problem]:
    wheel, disc, e = drive.pin_wheel, drive.disc, drive.crank.eccentricity
    if has_loops(drive):
        yield _loops(drive)
        return
    profile = FlankProfile.of_drive(drive)
    if profile.offset <= 0.0:
        yield Problem.of(
            "disc.equidistant_offset",
            f"= {disc.equidistant_offset:g} mm",
            f"must be greater than {-wheel.pin_radius:g} mm (minus the pin radius)",
            bound=("greater than", -wheel.pin_radius),
        )
        return
    smallest_radius = _smallest_path_radius(wheel.pin_circle_radius + disc.shifting_offset, e, drive.reduction_ratio)
    if smallest_radius <= profile.offset:
        of_pins = Bound(
            "less than",
            smallest_radius - disc.equidistant_offset,
            " (smallest radius of the pin-centre path on its convex side less the equidistant offset)",
        )
        rounder = rounded_down((smallest_radius - disc.equidistant_offset) / (1.0 + ROUND_FLANK))
        otherwise = f"the flank is undercut{_rounder_words(drive, ('pin_wheel.pin_radius', rounder))}"
        yield _or_eccentricity_and_hole(drive, "pin_wheel.pin_radius", of_pins, otherwise)
    if profile.root_radius <= 0.0:
        yield Problem.of(
            "pin_wheel.pin_circle_radius",
            f"= {wheel.pin_circle_radius:g} mm",
            f"leaves a root radius of {profile.root_radius:.6g} mm, must be greater than 0 mm",
        )
    overlap = drawn_interference(drive).pins
    bound = deviation_bound(drive)
    if overlap > bound + ROUNDING:
        yield Problem.of(
            "disc.equidistant_offset",
            f"= {disc.equidistant_offset:g} mm",
            f"must be at least {disc.equidistant_offset + overlap:.6g} mm with this shifting offset",
            otherwise=f"disc and pins overlap by {overlap:.4g} mm, more than {bound:g} mm, {ELASTIC}",
            bound=("at least", disc.equidistant_offset + overlap),
        )


def largest_eccentricity(drive: Drive, least_radius: float = 0.0) -> float:
    """Return the largest eccentricity at which the flank of a drive has neither loops nor an undercut, mm; 0 without any.

    `least_radius` is the radius that the flank keeps on its convex side, mm; with none it comes to an edge there.

    The pin circle and the pins are those of the drive: the path of the pin centres over the disc may bend on its convex side
    no more than the equidistant to it (pin radius and equidistant offset) allows. It bends the more the larger the eccentricity.
    """
    return _last_sound(
        lambda e: _has_plain_flank(drive, drive.pin_wheel.pin_circle_radius, e, least_radius), drive.crank.eccentricity
    )


def _smallest_pin_circle(drive: Drive, least_radius: float = 0.0) -> float:
    """Smallest radius of the pin circle at which the flank has neither loops nor an undercut, mm; infinite without any."""
    most = _last_sound(
        lambda part: _has_plain_flank(
            drive, drive.pin_wheel.pin_circle_radius / part, drive.crank.eccentricity, least_radius
        )
    )
    return drive.pin_wheel.pin_circle_radius / most if most > 0.0 else float("inf")


def _last_sound(is_sound: Callable[[float], bool], wrong: float = 1.0) -> float:
    """Largest sound value below a wrong one, by bisection: of zero and all values up to the largest, sound ones; else 0."""
    sound = 0.0
    for _ in range(30):
        middle = 0.5 * (sound + wrong)
        sound, wrong = (middle, wrong) if is_sound(middle) else (sound, middle)
    return sound


def _has_plain_flank(drive: Drive, pin_circle_radius: float, eccentricity: float, least_radius: float) -> bool:
    """Tell whether the flank on another pin circle, with another eccentricity, is rounder than a radius all along."""
    shifted = pin_circle_radius + drive.disc.shifting_offset
    if _crosses_itself(pin_circle_radius, shifted, eccentricity * drive.reduction_ratio):
        return False
    offset = drive.pin_wheel.pin_radius + drive.disc.equidistant_offset
    return _smallest_path_radius(shifted, eccentricity, drive.reduction_ratio) > offset + least_radius


def has_loops(drive: Drive) -> bool:
    """Tell whether the path of the pin centres over the disc crosses itself, so that the flank has loops."""
    radius = drive.pin_wheel.pin_circle_radius
    return _crosses_itself(
        radius, radius + drive.disc.shifting_offset, drive.crank.eccentricity * drive.reduction_ratio
    )


def _crosses_itself(pin_circle_radius: float, shifted_radius: float, pitch_radius: float) -> bool:
    """Tell whether the path of the pin centres crosses itself, as designed or shifted."""
    return pitch_radius >= min(pin_circle_radius, shifted_radius)


def _loops(drive: Drive) -> Problem:
    """Message about a flank with loops: bounds of eccentricity and pin circle, and the hole radius that goes with them."""
    most, circle = rounded_down(largest_eccentricity(drive)), _smallest_pin_circle(drive)
    bounds = {"crank.eccentricity": Bound("at most", most, _with_hole(drive, most))}
    rounder = "pin_wheel.pin_circle_radius", _rounded_up(_smallest_pin_circle(drive, _round(drive)))
    if isfinite(circle):
        bounds["pin_wheel.pin_circle_radius"] = Bound("at least", _rounded_up(circle))
    return bounded(drive, bounds, f"the flank has loops{_rounder_words(drive, rounder)}")


def _round(drive: Drive) -> float:
    """Convex radius of a flank that contacts find room on, mm."""
    return ROUND_FLANK * drive.pin_wheel.pin_radius


def _rounder_words(drive: Drive, other: tuple[str, float]) -> str:
    """Eccentricity, or value of another field, that leave the flank a radius: at its bounds it comes to an edge."""
    path, value = other
    eccentricity = rounded_down(largest_eccentricity(drive, _round(drive)))
    values = [f"crank.eccentricity = {eccentricity:.6g} mm{_with_hole(drive, eccentricity)}"] if eccentricity else []
    values += [f"{path} = {value:.6g} mm"] if isfinite(value) and value > 0.0 else []
    if not values:
        return ""
    values_words = " or ".join(values)
    return f"; there the flank comes to an edge, {values_words} leaves a radius, {ROUND_FLANK:g} of that of the pins"


def hole_that_fits(drive: Drive, eccentricity: float) -> float:
    """Return the hole radius that holds pins, or sleeves on them, without play or overlap at an eccentricity, mm; 0 without."""
    shaft = drive.pin_shaft
    return 0.0 if shaft is None else shaft.pin_radius - shaft.seat_play + eccentricity


def _leads(drive: Drive, eccentricity: float) -> bool:
    """Tell whether the holes of a drive neither overlap their pins at another eccentricity nor are too large for it."""
    shaft = drive.pin_shaft
    if shaft is None:
        return True
    fits = hole_that_fits(drive, eccentricity) <= drive.hole_radius + ROUNDING
    return fits and shaft.hole_radius - shaft.pin_radius <= MOST_HOLE_PLAY * eccentricity


def _or_eccentricity(drive: Drive, path: str, bound: Bound, largest: float, otherwise: str) -> Problem:
    """Message about a length and its bound, or the largest eccentricity, unless that is zero or holes would have to change."""
    bounds, most = {path: bound}, rounded_down(largest)
    if most > 0.0 and _leads(drive, most):
        bounds["crank.eccentricity"] = Bound("at most", most)
    return bounded(drive, bounds, otherwise)


def _or_eccentricity_and_hole(drive: Drive, path: str, bound: Bound, otherwise: str) -> Problem:
    """Message about a length and its bound, or the eccentricity that mends it as well with the hole radius that goes with it."""
    bounds, most = {path: bound}, rounded_down(largest_eccentricity(drive))
    if most > 0.0:
        bounds["crank.eccentricity"] = Bound("at most", most, _with_hole(drive, most))
    return bounded(drive, bounds, otherwise)


def _with_hole(drive: Drive, eccentricity: float) -> str:
    """The hole radius that goes with an eccentricity, in brackets; empty where that of the drive does."""
    if _leads(drive, eccentricity):
        return ""
    return f" (with pin_shaft.hole_radius = {hole_that_fits(drive, eccentricity):.6g} mm)"


def rounded_down(value: float) -> float:
    """Return a number with its digits behind the fourth cut off, so that a bound from above stays one; minus it, from below."""
    if value == 0.0:
        return 0.0
    step = 10.0 ** (floor(log10(abs(value))) - 3)
    return floor(value / step + 1e-6) * step


def _rounded_up(value: float) -> float:
    """Return a number rounded up to its fourth digit, so that a bound from below stays one; infinite as it is."""
    return -rounded_down(-value) if isfinite(value) else value


def _smallest_path_radius(radius: float, eccentricity: float, ratio: float) -> float:
    """Smallest convex radius of the pin-centre path, mm.

    Its curvature is stationary at the ends of c = cos ψ and where 3 (1 + z K² − K (1 + z) c) = (1 + z) (1 + K² − 2 K c).
    """
    shortening = eccentricity * ratio / radius
    inside = (2.0 - ratio + (2.0 * ratio - 1.0) * shortening**2) / (shortening * (1.0 + ratio))
    cosines = np.array([-1.0, 1.0, *([inside] if abs(inside) < 1.0 else [])])
    largest = float(trochoid_curvature(radius, eccentricity, ratio, cosines).max())
    return 1.0 / largest if largest > 0.0 else float("inf")


def _pins(drive: Drive) -> Iterator[Problem]:
    wheel = drive.pin_wheel
    room = wheel.pin_circle_radius * sin(pi / wheel.number_of_pins)
    if wheel.pin_radius >= room:
        yield Problem.of(
            "pin_wheel.pin_radius",
            f"= {wheel.pin_radius:g} mm",
            f"must be less than {room:.6g} mm",
            otherwise="neighbouring pins overlap",
            bound=("less than", room),
        )
    shaft = drive.pin_shaft
    if shaft is None:
        return
    room = shaft.pin_circle_radius * sin(pi / shaft.number_of_pins)
    if shaft.pin_radius >= room:
        yield Problem.of(
            "pin_shaft.pin_radius",
            f"= {shaft.pin_radius:g} mm",
            f"must be less than {room:.6g} mm",
            otherwise="neighbouring pins overlap",
            bound=("less than", room),
        )


def _bearing(drive: Drive) -> Iterator[Problem]:
    bearing = drive.crank_bearing
    space = bearing.outer_race_radius - bearing.inner_race_radius
    if space <= 0.0:
        fitting = bearing.outer_race_radius - 2.0 * bearing.roller_radius
        largest = Bound("at most", fitting) if fitting > 0.0 else Bound("less than", bearing.outer_race_radius)
        yield Problem.of(
            "crank_bearing.inner_race_radius",
            f"= {bearing.inner_race_radius:g} mm",
            f"must be {largest}",
            otherwise="the rollers have no room below the outer race (outer_race_radius = "
            f"{bearing.outer_race_radius:g} mm)",
            bound=largest[:2],
        )
    elif (overlap := drawn_interference(drive).rollers) > (elastic := deviation_bound(drive)) + ROUNDING:
        yield Problem.of(
            "crank_bearing.roller_radius",
            f"= {bearing.roller_radius:g} mm",
            f"must be at most {0.5 * space:.6g} mm",
            otherwise=f"the rollers overlap the races by {overlap:.4g} mm, more than {elastic:g} mm, {ELASTIC}",
            bound=("at most", 0.5 * space),
        )
    elif 2.0 * bearing.roller_radius < 0.9 * space:
        yield Problem.of(
            "crank_bearing.roller_radius",
            f"= {bearing.roller_radius:g} mm",
            f"must be at least {0.45 * space:.6g} mm",
            otherwise="the rollers are loose between the races (give clearance as clearance.bearing)",
            bound=("at least", 0.45 * space),
        )
    room = (bearing.inner_race_radius + bearing.roller_radius) * sin(pi / bearing.number_of_rollers)
    if bearing.roller_radius >= room:
        yield Problem.of(
            "crank_bearing.number_of_rollers",
            f"= {bearing.number_of_rollers}",
            f"rollers of radius {bearing.roller_radius:g} mm overlap, their radius must be less than {room:.6g} mm",
        )
    if drive.roller_length > drive.disc.thickness + ROUNDING:
        yield Problem.of(
            "crank_bearing.roller_length",
            f"= {drive.roller_length:g} mm",
            f"must be at most {drive.disc.thickness:g} mm, the thickness of the disc, which it is when left out",
            bound=("at most", drive.disc.thickness),
        )
    if drive.clearance.bearing > bearing.roller_radius:
        yield Problem.of(
            "clearance.bearing",
            f"= {drive.clearance.bearing:g} mm",
            f"must be at most {bearing.roller_radius:g} mm, the roller radius",
            bound=("at most", bearing.roller_radius),
        )


def _holes(drive: Drive) -> Iterator[Problem]:
    shaft, e = drive.pin_shaft, drive.crank.eccentricity
    if shaft is None:
        return
    play = shaft.hole_radius - shaft.pin_radius
    # Seen from the hole, a sleeve with play is a smaller fixed pin. Pins in tight holes push the disc along the
    # eccentricity: by half of it they would lead it no more.
    most = min(deviation_bound(drive), 0.5 * e)
    fitting = hole_that_fits(drive, e)
    overlap = fitting - drive.hole_radius
    if overlap > most + ROUNDING:
        play_of_sleeve = " - the play of its sleeve" if shaft.seat_play else ""
        bound = Bound(
            "at least",
            fitting,
            f" (pin_shaft.pin_radius + crank.eccentricity{play_of_sleeve}, and half the clearance unless clearance.pin_hole "
            "has it)",
        )
        otherwise = (
            f"the hole overlaps its pin by {overlap:.4g} mm, more than {most:g} mm, {ELASTIC} "
            "(and half the eccentricity at most)"
        )
        largest = shaft.hole_radius + shaft.seat_play - shaft.pin_radius
        yield _or_eccentricity(drive, "pin_shaft.hole_radius", bound, largest, otherwise)
    elif play > MOST_HOLE_PLAY * e:
        yield Problem.of(
            "pin_shaft.hole_radius",
            f"= {shaft.hole_radius:g} mm",
            f"must be at most {shaft.pin_radius + MOST_HOLE_PLAY * e:g} mm, pin radius plus 1.5 eccentricities",
            otherwise="the pins cannot lead the disc",
            bound=("at most", shaft.pin_radius + MOST_HOLE_PLAY * e),
        )
    if drive.clearance.pin_hole > 0.5 * e:
        yield Problem.of(
            "clearance.pin_hole",
            f"= {drive.clearance.pin_hole:g} mm",
            f"must be at most {0.5 * e:g} mm, half the eccentricity",
            bound=("at most", 0.5 * e),
        )
    radius, circle = drive.hole_radius, shaft.pin_circle_radius
    # A hole has to clear its pin by the eccentricity: where it cannot shrink enough, the circle it stands on is wrong.

    def hole_or_circle(excess: float, trouble: str, circle_bound: Bound) -> Problem:
        largest = shaft.hole_radius - excess
        path, value, bound = "pin_shaft.pin_circle_radius", circle, circle_bound
        if largest > fitting or play + shaft.seat_play < e - ROUNDING:
            path, value, bound = "pin_shaft.hole_radius", shaft.hole_radius, Bound("less than", max(largest, 0.0))
        return Problem.of(path, f"= {value:g} mm", f"must be {bound}", trouble=trouble, bound=bound[:2])

    wall = circle - radius - drive.bore_radius
    if wall <= 0.0 and drive.crank.number == 1:
        yield hole_or_circle(-wall, f"holes cut into the bore by {-wall:.6g} mm", Bound("greater than", circle - wall))
    sine = sin(pi / shaft.number_of_pins)
    wall = 2.0 * (circle * sine - radius)
    if wall <= 0.0:
        yield hole_or_circle(
            -0.5 * wall,
            f"neighbouring holes cut into each other by {-wall:.6g} mm",
            Bound("greater than", radius / sine),
        )
    root = FlankProfile.of_drive(drive).root_radius
    wall = root - circle - radius
    inside = drive.bore_radius if drive.crank.number == 1 else 0.0
    if wall <= 0.0 and root - radius > radius + inside:
        yield hole_or_circle(
            -wall,
            f"holes cut through the root circle of the disc (radius {root:.6g} mm) by {-wall:.6g} mm",
            Bound("less than", root - radius),
        )
    elif wall <= 0.0 and drive.pin_wheel.pin_circle_radius + drive.disc.shifting_offset > 0.0:
        # No circle has room for the holes; an offset that leaves no pin circle is reported with the flank.
        wheel = drive.pin_wheel
        yield Problem.of(
            "pin_wheel.pin_circle_radius",
            f"= {wheel.pin_circle_radius:g} mm",
            f"must be greater than {wheel.pin_circle_radius - wall:.6g} mm",
            trouble=f"holes cut through the root circle of the disc (radius {root:.6g} mm) by {-wall:.6g} mm",
            bound=("greater than", wheel.pin_circle_radius - wall),
        )
    if drive.bore_radius >= root > 0.0:
        yield Problem.of(
            "crank_bearing.outer_race_radius",
            f"= {drive.crank_bearing.outer_race_radius:g} mm",
            f"must be less than {root:.6g} mm, the root radius of the disc",
            bound=("less than", root),
        )


def _length_profiles(drive: Drive) -> Iterator[Problem]:
    bearing = drive.crank_bearing
    profiles: list[tuple[str, LengthProfile, float, float]] = [
        (
            "crank_bearing.roller_profile",
            bearing.roller_profile,
            drive.roller_length,
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
            yield Problem.of(
                f"{path}.end_relief_length",
                f"= {profile.end_relief_length:g} mm",
                f"must be at most {0.5 * length:g} mm, half the contact length",
                bound=("at most", 0.5 * length),
            )
        for name in ("crown_drop", "end_relief_depth"):
            if (drop := getattr(profile, name)) > 0.1 * radius:
                yield Problem.of(
                    f"{path}.{name}",
                    f"= {drop:g} mm",
                    f"must be at most {0.1 * radius:g} mm, a tenth of the radius",
                    bound=("at most", 0.1 * radius),
                )
        if profile.logarithmic_factor > 100.0:
            yield Problem.of(
                f"{path}.logarithmic_factor",
                f"= {profile.logarithmic_factor:g}",
                "must be at most 100",
                bound=("at most", 100.0),
            )


def _bores(drive: Drive) -> Iterator[Problem]:
    """Problems of the walls around the bores of several cranks."""
    crank, radius = drive.crank, drive.bore_radius
    if crank.number == 1 or crank.circle_radius is None:
        return
    circle = crank.circle_radius
    path, value = "crank.circle_radius", f"= {circle:g} mm"
    sine = sin(pi / crank.number)
    wall = 2.0 * (circle * sine - radius)
    if wall <= 0.0:
        yield Problem.of(
            path,
            value,
            f"must be greater than {radius / sine:.6g} mm",
            trouble=f"neighbouring bores of {crank.number} cranks cut into each other by {-wall:.6g} mm",
            bound=("greater than", radius / sine),
        )
    root = FlankProfile.of_drive(drive).root_radius
    wall = root - circle - radius
    if wall <= 0.0:
        yield Problem.of(
            path,
            value,
            f"must be less than {root - radius:.6g} mm",
            trouble=f"bores cut through the root circle of the disc (radius {root:.6g} mm) by {-wall:.6g} mm",
            bound=("less than", root - radius),
        )
    shaft = drive.pin_shaft
    if shaft is None:
        return
    holes = shaft.pin_circle_radius * np.exp(2j * np.pi * np.arange(shaft.number_of_pins) / shaft.number_of_pins)
    distance = float(np.min(np.abs(holes[:, None] - np.array(crank.places))))
    wall = distance - drive.hole_radius - radius
    if wall <= 0.0:
        yield Problem.of(
            path,
            value,
            f"a bore and a hole (pin_shaft.pin_circle_radius = {shaft.pin_circle_radius:g} mm) cut into each "
            f"other by {-wall:.6g} mm; other radii or crank.angle must leave a wall",
        )


def _friction(drive: Drive) -> Iterator[Problem]:
    """Problems of coefficients of absent joints, and of support bearings without radius."""
    friction, shaft = drive.friction, drive.pin_shaft
    if friction is None:
        return
    seats = {drive.pin_wheel.seat.kind} | (set() if shaft is None else {shaft.seat.kind})
    if friction.seat and seats == {"fixed"}:
        yield Problem.of(
            "friction.seat",
            f"= {friction.seat:g}",
            "must be left out, or 0, where no pin lies loose or carries a sleeve (pin_wheel.seat, pin_shaft.seat)",
        )
    if friction.hole and shaft is None:
        yield Problem.of("friction.hole", f"= {friction.hole:g}", "must be left out, or 0, without a pin shaft")
    if friction.support_bearing and not friction.support_bearing_radius:
        yield Problem.of(
            "friction.support_bearing_radius",
            "= 0 mm",
            f"must be given, greater than 0 mm, with friction.support_bearing = {friction.support_bearing:g}",
        )


def deviation_bound(drive: Drive) -> float:
    """Return the largest deviation accepted, mm: beyond a tenth of the smallest radius it is a different design."""
    radii = [drive.pin_wheel.pin_radius, drive.crank_bearing.roller_radius]
    return 0.1 * min(radii if drive.pin_shaft is None else [*radii, drive.pin_shaft.pin_radius])


def find_deviation_problems(drive: Drive) -> Iterator[Problem]:
    """Yield the problems of numbers and sizes of the deviations, one sentence each."""
    pins, holes = drive.pin_wheel.number_of_pins, drive.number_of_holes
    rollers = drive.crank_bearing.number_of_rollers
    parts: list[tuple[str, PlacementErrors | RollerErrors, int, str]] = [
        ("pin_wheel.pin_errors", drive.pin_wheel.pin_errors, pins, "pins"),
        ("disc.hole_errors", drive.disc.hole_errors, holes, "holes"),
        ("crank_bearing.roller_errors", drive.crank_bearing.roller_errors, rollers, "rollers"),
    ]
    if drive.pin_shaft is not None:
        parts.append(("pin_shaft.pin_errors", drive.pin_shaft.pin_errors, holes, "pins"))
    bound = deviation_bound(drive)
    for path, errors, count, things in parts:
        yield from part_errors(path, errors, count, things, bound)
    lengths = {
        "crank.eccentricity_error": drive.crank.eccentricity_error,
        "crank.axis_offset.x": drive.crank.axis_offset.x,
        "crank.axis_offset.y": drive.crank.axis_offset.y,
        "pin_wheel.axis_offset.x": drive.pin_wheel.axis_offset.x,
        "pin_wheel.axis_offset.y": drive.pin_wheel.axis_offset.y,
        "disc.runout.amount": drive.disc.runout.amount,
    }
    limit = min(bound, 0.5 * drive.crank.eccentricity)
    for path, value in lengths.items():
        if abs(value) > limit:
            yield Problem.of(
                path,
                f"= {value:g} mm",
                f"must be at most {limit:g} mm in size, a tenth of the smallest pin or roller radius and half the "
                "eccentricity",
                bound=("at most in size", limit),
            )
    yield from find_lead_problems(drive.disc, bound)
    yield from _profile_errors(drive, bound)


def part_errors(
    path: str, errors: PlacementErrors | RollerErrors | BoreErrors, count: int, things: str, bound: float
) -> Iterator[Problem]:
    """Problems of numbers and sizes of the errors of single pins, holes, rollers or bores."""
    for name in ("radial", "tangential", "diameter"):
        values = getattr(errors, name, ())
        if values and len(values) != count:
            yield Problem.of(f"{path}.{name}", f"has {counted(len(values), 'values')}", _needed(count, things))
        worst = max(values, key=abs, default=0.0)
        if abs(worst) > bound:
            yield Problem.of(
                f"{path}.{name}",
                f"holds {worst:g} mm",
                f"must be at most {bound:g} mm in size, a tenth of the smallest pin or roller radius",
                bound=("at most in size", bound),
            )
    for name in ("inclination_x", "inclination_y"):
        values = getattr(errors, name, ())
        if values and len(values) != count:
            yield Problem.of(f"{path}.{name}", f"has {counted(len(values), 'values')}", _needed(count, things))
        worst = max(values, key=abs, default=0.0)
        if abs(worst) > LARGEST_SLOPE:
            yield Problem.of(f"{path}.{name}", f"holds {worst:g} rad", slope_bound())


def _needed(count: int, things: str) -> str:
    """How many values a part has to have; a drive without a pin shaft has no holes."""
    if not count:
        return f"must be left out, the drive has no {things}" + (" without [pin_shaft]" if things == "holes" else "")
    return f"must have {count}, one for each of the {things}"


def _profile_errors(drive: Drive, bound: float) -> Iterator[Problem]:
    errors = drive.disc.profile_errors
    path = "disc.profile_errors"
    if len(set(errors.orders)) != len(errors.orders):
        yield Problem.of(f"{path}.orders", "", "must name each order once")
    for name in ("cosine", "sine"):
        values = getattr(errors, name)
        if values and len(values) != len(errors.orders):
            yield Problem.of(
                f"{path}.{name}", f"has {counted(len(values), 'values')}", _needed(len(errors.orders), "orders")
            )
    if len(errors.deviation) != len(errors.parameter):
        yield Problem.of(
            f"{path}.deviation",
            f"has {counted(len(errors.deviation), 'values')}",
            f"must have {len(errors.parameter)}, one for each measured parameter",
        )
    if errors.parameter:
        at = np.array(errors.parameter)
        if at.size < 3 or at[0] < 0.0 or at[-1] >= 2.0 * pi or not np.all(np.diff(at) > 0.0):
            yield Problem.of(
                f"{path}.parameter",
                "",
                "must be at least 3 angles ascending from 0 rad or more to less than 2π rad",
                bound=("at least", 3.0),
            )
    size = sum(abs(value) for value in (*errors.cosine, *errors.sine)) + max(map(abs, errors.deviation), default=0.0)
    if size > bound:
        yield Problem.of(
            path,
            f"reaches {size:g} mm",
            f"must be at most {bound:g} mm, a tenth of the smallest pin or roller radius",
            bound=("at most", bound),
        )


def find_flank_problems(drive: Drive) -> Iterator[Problem]:
    """Yield the problem of a flank, designed or deviated, that folds or is more hollow than its pins are round."""
    profile = FlankProfile.of_drive(drive)
    # As designed the flank is hollowest in its roots: the curvature of the trochoid falls toward them as long as it
    # is hollow at all.
    designed = _hollow_radius(float(profile.locus(np.zeros(1)).curvature[0]), float(profile.offset))
    theta, actual = 0.0, designed
    if profile.deviation is not None:
        waves = max(
            (drive.pin_wheel.number_of_pins, *profile.deviation.orders, len(drive.disc.profile_errors.parameter))
        )
        places, direction, frame = _looked_at(
            float(profile.generating_radius), float(profile.eccentricity), profile.reduction_ratio, waves
        )
        # Without rotation and runout, which do not change its shape.
        flank = replace(profile, turn=1.0, centre=0.0).deviated(frame, direction)
        forward = (flank.tangent * frame.tangent.conjugate()).real
        if np.min(forward) <= 0.0:
            worst = float(places[np.argmin(forward)])
            yield Problem.of(
                "disc.profile_errors",
                "",
                f"the flank folds back on itself at θ = {worst:.4g} rad; reduce amplitude or order",
            )
            return
        hollowest = np.argmin(curvature := flank.curvature)
        theta, actual = (
            float(places[hollowest]),
            _hollow_radius(float(curvature[hollowest]), float(profile.contact_offset)),
        )
    yield from _hollow(drive, designed, actual, theta)


def _hollow(drive: Drive, designed: float, actual: float, theta: float) -> Iterator[Problem]:
    """A pin rounder than a hollow of the flank touches it at two points."""
    nominal = drive.pin_wheel.pin_radius
    growth = max(drive.pin_wheel.pin_errors.diameter, default=0.0)
    largest = nominal + 0.5 * max(growth, 0.0)
    if actual > largest:
        return
    if designed <= nominal:
        path, value = "disc.equidistant_offset", f"= {drive.disc.equidistant_offset:g} mm"
    elif actual <= nominal:
        path, value = "disc.profile_errors", ""
    else:
        path, value = "pin_wheel.pin_errors.diameter", f"holds {growth:g} mm"
    yield Problem.of(
        path,
        value,
        f"the flank has a hollow of radius {actual:.6g} mm at θ = {theta:.4g} rad, must be greater than "
        f"{largest:g} mm, the radius of the largest pin",
        otherwise="pins touch it at two points at once",
        bound=("greater than", largest),
    )


def _hollow_radius(curvature: float, offset: float) -> float:
    """Radius of curvature where a flank is hollow, infinite elsewhere, mm; `curvature` is that of its parallel at an
    offset.
    """
    return 1.0 / max(-curvature / (1.0 - offset * curvature), 1e-300)


@lru_cache(maxsize=8)
def _looked_at(
    radius: float, eccentricity: float, ratio: float, waves: int
) -> tuple[FloatArray, ComplexArray, CurveFrame]:
    """Parameters θ at which a deviated flank is checked, e^{iθ} and the designed frame there.

    They resolve every wave, and the roots however sharp. They are cached, since studies check one design thousands of
    times.
    """
    even = np.linspace(0.0, 2.0 * pi, POINTS_PER_WAVE * waves, endpoint=False)
    # |c′|² = (R − e u)² + 2 R e u (1 − cos (u − 1)θ): what is special in a root is so within this of it.
    pitch_radius, teeth = eccentricity * ratio, round(ratio) - 1
    sharp = (radius - pitch_radius) / (np.sqrt(radius * pitch_radius) * (ratio - 1.0))
    about = sharp * np.linspace(-3.0, 3.0, POINTS_PER_WAVE + 1)
    roots = 2.0 * pi * np.arange(teeth)[:, None] / teeth + about
    places = np.mod(np.concatenate([even, roots.ravel()]), 2.0 * pi)
    direction = unit(places)
    design = FlankProfile(generating_radius=radius, eccentricity=eccentricity, reduction_ratio=ratio, offset=0.0)
    frame = design.frame(direction)
    for kept in (places, direction, *frame):
        kept.setflags(write=False)
    return places, direction, frame


FIRST = (find_deviation_problems, _tooth_numbers)
"""Checks that the geometry needs."""
BESIDE = (_pins, _bearing, _holes, _bores, _length_profiles, _friction)
"""Checks that do not depend on the flank."""
CHECKS = (*FIRST, *BESIDE, _flank, find_flank_problems)
"""All of them, the cheap ones first."""
