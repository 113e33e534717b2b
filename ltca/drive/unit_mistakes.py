"""Plain numbers that were probably meant in another unit.

Nothing is refused for it. Values that no drive has, and values a hundred times from the rest of the drive, give a warning
(`unit_warnings`). A small drive is told apart by its own sizes and materials: a torque is compared with what this drive
carries, a length with the lengths beside it, never with those of other drives. A soft drive under a light torque is sound
(printed plastics have some 3000 MPa, TPU 30 MPa). Where no equilibrium exists, a modulus like that of rubber, a torque beyond
the strength of steel or a pin deflection larger than its hole is a likelier cause than slipping teeth (`explain_failure`).
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from math import cos, floor, log10, pi, sin, sqrt
from typing import ParamSpec, TypeVar

from ltca.drive.declaration import declared_fields
from ltca.drive.engine_support import given
from ltca.drive.least_torque import least_torque
from ltca.drive.members.limits import Limit
from ltca.drive.members.main_bearing import ROLLER
from ltca.drive.members.operation import LIGHT_SHARE
from ltca.drive.members.width import needs_slices
from ltca.drive.parts import Drive, Material, Materials, Preload, contact_modulus
from ltca.drive.units.table import range_of
from ltca.errors import ConvergenceError, CycloError, DriveError, OverloadError
from ltca.quantities import LIMITED

P = ParamSpec("P")
R = TypeVar("R")

SOFT = 1000.0
"""Young's modulus below that of the softest rigid plastics (polyethylene, some 1000 MPa), MPa."""
DIAMOND, STIFF = 1.2e6, 2e6
"""Young's modulus of diamond, and one above that of any material, MPa."""
METALS = 40e3, 700e3
"""Young's moduli of magnesium and of cemented carbide, MPa."""
SMALLEST, LARGEST = 1.0, 5000.0
"""Pin circle radii smaller and larger than those of all existing drives, mm: micro drives have some 3, the largest 1000."""
HOTTEST = 200.0
"""Temperature at which bearing steel softens, °C; a cold room in kelvin is beyond it."""
BORNE = 10_000.0
"""Pressure beyond the strength of any gear: bearing steel yields below 6000 MPa, MPa."""
CRUSHED = 0.2
"""Pressure of a wheel pin by the contact modulus beyond which no contact is answered: its half-width, twice that by the pin
radius, is beyond 0.3 of it even where the estimate of the load is off by a factor of two."""
UNLOADED = 1.0 / 500.0
"""Fraction of the torque that a drive carries (`carried_torque`) below which its torque is likely in newton metres: rated
torques are a quarter of it and more, a hundredth of them is above; newton metres read as N·mm are about a thousandth."""
OVERLOADED = 250.0
"""Multiple of it above which a torque is likely a thousandfold: of a rated torque that is a quarter of it."""
UNANSWERED = 200.0
"""Multiple of the torque that a drive carries by the strength of its kind of materials beyond which none is answered: of shipped
and published drives some are at 120 times it, none at 250. With a weaker material given, a drive carries less than it bears."""
LIGHTEST = 1.0 / 5000.0
"""Fraction of the torque below which the light torque is likely in newton metres: usual ones are 1/100 to 1/10."""
PLAIN_TORQUE = 'a plain number is N·mm, newton metres are written "377.3 N m"'
PHASES = 4
"""Places of the wheel pins between two teeth at which the torque of `carried_torque` is taken, the least of them."""
STRENGTH = 0.0075, 0.03
"""Allowable flank pressure by Young's modulus of metals and of plastics without a given one: 1500 of 206000 MPa for bearing
steel, 75 of 3000 MPa for PLA."""
STRENGTHS = ("allowable_pressure", "yield_strength", "bending_fatigue_limit")
"""Fields of a material that are pressures or stresses."""
STRONGEST = 0.05
"""Largest allowable pressure by Young's modulus: of polyamide."""
WEAKEST, STRONGER = 5e-5, 100.0
"""Strengths, and limits of pressures and stresses, by Young's modulus that no material has, even one given for its modulus alone.
In GPa bearing steel has 7e-6 and plastics 2e-5, in Pa thousands."""
SPRINGY = 1.0 / 2000.0
"""Stiffness of a shaft pin, bearing or support by Young's modulus times thickness of the disc below which it is likely in N/µm:
practical ones have from a fiftieth to five of it, a thousandth of the usual ones is below."""
SHORT, LONG = 0.01, 100.0
"""Ratios of a length to the one beside it that no drive has; metres read as mm are at 0.001 of a usual ratio."""
FINEST, FINE = 3e-4, 5e-5
"""Offset or clearance below what machines hold: in mm, a third of a micrometre, and by the pin radius, for micro drives. A
thousandth of it is a number of its own."""
FAINT = 1.0 / 5000.0
"""Preload or force from outside by the load of a crank at the torque that a drive carries below which it is likely in kN: usual
ones are from a hundredth to ten of it, the weight of a small arm a thousandth."""
PRESSED_IN = 0.03
"""Displacement of a row by its preload, in eccentricities, beyond that of any bearing: usual ones are some micrometres."""
POOREST = 0.02
"""Load rating by an estimate from the rollers' sizes below which it is likely in kN; makers differ by a factor of two."""
FASTEST = 1.5e6
"""Speed by the mean diameter of the crank bearing, mm/min, that no roller bearing of a drive reaches: the fastest have 1e6."""
TWISTED = 0.03
"""Twist of the carrier under the torque beyond that of any reducer, rad: precision reducers wind up by some 3e-4 as a whole."""
STEEP = 3e-3
"""Inclination or slope beyond that of any part, rad: pins under load lean by tenths of a milliradian, drawings allow less."""
DEEP = 0.01
"""Crown or relief by the thickness of the disc beyond any: usual ones are some micrometres."""
SLOW_INPUT, SLOW_OUTPUT = 60.0, 5.0
"""Speeds of input and output, rpm, below which a speed is likely in Hz: motors make 10 to 100 turns a second."""


def _parts(drive: Drive) -> list[str]:
    """Parts whose material is under contact pressure: without cranks, carrier, and slots and sleeves where there are none."""
    seats = {drive.pin_wheel.seat.kind} | (set() if drive.pin_shaft is None else {drive.pin_shaft.seat.kind})
    counts = {"crankshaft": False, "carrier": False, "wheel_seat": "slot" in seats, "sleeve": "sleeve" in seats}
    counts["shaft_pin"] = drive.pin_shaft is not None
    return [item.name for item in fields(Materials) if counts.get(item.name, True)]


def materials_of_bodies(drive: Drive) -> dict[str, Material]:
    """Return the materials of all parts that yield, by path: under contact pressure, and cranks, carrier and ring that bend."""
    found = {f"materials.{part}": getattr(drive.materials, part) for part in _parts(drive)}
    if drive.crank.support is not None:
        found["materials.crankshaft"] = drive.materials.crankshaft
    if drive.carrier is not None and drive.carrier.posts is not None:
        found["materials.carrier"] = drive.materials.carrier
    if drive.ring is not None:
        found["ring.material"] = drive.ring.material
    return found


def _together(paths: list[str]) -> str:
    """Paths of materials in one: "materials.disc, wheel_pin, ring.material"."""
    own = [path.removeprefix("materials.") for path in paths if path.startswith("materials.")]
    told = [f"materials.{', '.join(own)}"] if own else []
    return ", ".join([*told, *(path for path in paths if not path.startswith("materials."))])


def likely_unit_mistakes(drive: Drive, torque: float | None = None) -> list[str]:
    """Return values of a drive whose solution failed that look like numbers in another unit, one sentence each, the
    likeliest first.

    `torque` is the output torque, N·mm; that of the load by default.
    """
    used = drive.load.torque if torque is None else torque
    if beyond := _impossible(drive):
        return beyond
    modulus = _modulus(drive)
    if modulus:
        return modulus  # the others follow from it
    share = used / drive.disc.number_of_discs
    if lengths := [*_odd_lengths(drive)]:
        return _yielding(drive, share) or lengths
    load = drive.load
    named = "load.torque" if used == load.torque else "torque"
    torques = [(named, used, used, ""), ("load.light_torque", load.light_torque, load.light_torque, "")]
    if load.leaves_out_light_torque:
        light = f": the light torque, left out and so {100.0 * LIGHT_SHARE:g} % of it as written, is solved too"
        torques[1] = ("load.torque", load.light_torque / LIGHT_SHARE, load.light_torque, light)
    for named, value, solved, share_of_it in torques:
        pressure = _pressure(drive, solved / drive.disc.number_of_discs)
        if pressure > BORNE:
            return [_crushing(named, value, pressure, share_of_it)]
    return _yielding(drive, share)


def impossible_torque(drive: Drive, torque: float | None = None, *, duty: bool = False, in_parts: bool = False) -> str:
    """Return what is wrong with an output torque, N·mm, or that of the load, under which no drive is answered; else nothing.

    With `duty` the torques of its entries are asked as well. Nothing is said where other values look like numbers in another
    unit: the load of a pin follows from them. The bound is where `unit_warnings` begin to ask, or above it where the given
    strength of a material is below that of its kind. What is answered `in_parts`, at the part of a torque that is carried, has a
    larger one: where pins are crushed.
    """
    used = drive.load.torque if torque is None else torque
    asked = {"load.torque" if used == drive.load.torque else "torque": used}
    asked |= {f"duty.{number}.torque": entry.torque for number, entry in enumerate(drive.duty) if duty}
    if not any(asked.values()):
        return ""
    bound, told = _torque_bound(drive, in_parts=in_parts)
    beyond = [name for name, value in asked.items() if value > bound]
    if not beyond or _impossible(drive) or _modulus(drive) or any(_odd_lengths(drive)):
        return ""
    return f"{_newton_metres(beyond[0], asked[beyond[0]])}: must be at most {bound:g} N·mm, {told}; {PLAIN_TORQUE}"


def _torque_bound(drive: Drive, *, in_parts: bool) -> tuple[float, str]:
    """Output torque beyond which a drive is not answered, to three figures, N·mm, and what it is."""
    crushed = CRUSHED * contact_modulus(drive.materials.disc, drive.flank_pin)
    # The pressure goes with the root of the torque.
    crushing, carried = drive.disc.number_of_discs * (crushed / _pressure(drive, 1.0)) ** 2, carried_torque(drive)
    overload = max(OVERLOADED * carried, UNANSWERED * _torque_of_kind(drive))
    bound = _floored(crushing if in_parts else min(crushing, overload))
    if in_parts or crushing < overload:
        return (
            bound,
            f"where the wheel pins are pressed with some {crushed:.2g} MPa, {CRUSHED:g} of the modulus of contact",
        )
    return bound, _times_carried(bound, carried)


def _times_carried(torque: float, carried: float) -> str:
    """A large torque as a multiple of the one that a drive carries, N·mm."""
    return f"{rounded(torque / carried)} times {_carried_words(carried)}"


def _carried_words(carried: float) -> str:
    return f"what this drive carries (some {rounded(carried / 1000.0)} N·m by the pressure of its flank)"


def _crushing(named: str, value: float, pressure: float, share_of_it: str = "") -> str:
    return (
        f"{_newton_metres(named, value)}{share_of_it} and would press the wheel pins with some {pressure:.2g} MPa, which no "
        f"steel bears; {PLAIN_TORQUE}"
    )


def _yielding(drive: Drive, share: float) -> list[str]:
    """Problems of pins so soft, or so long, that they would leave their place."""
    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    if wheel.beam is not None:
        bending = 48.0 * _bending_stiffness(drive.materials.wheel_pin, wheel.beam_diameter) / drive.wheel_pin_span**3
        load = _pin_load(drive, share)
        if load / bending > 0.5 * wheel.pin_radius:
            return [_too_long("pin_wheel.beam", drive.wheel_pin_span, wheel.beam_diameter, load / bending)]
    if shaft is None:
        return []
    # Some third of the pins carry, on a lever of about two thirds of their circle.
    load = share / (0.2 * shaft.number_of_pins * shaft.pin_circle_radius)
    if shaft.beam is not None:
        # In the middle of the span, half of it from the flange.
        bending = 24.0 * _bending_stiffness(drive.materials.shaft_pin, shaft.beam_diameter) / drive.shaft_pin_span**3
        if load / bending > 0.5 * shaft.hole_radius:
            return [_too_long("pin_shaft.beam", drive.shaft_pin_span, shaft.beam_diameter, load / bending)]
    if shaft.stiffness is not None and load / shaft.stiffness > 0.5 * shaft.hole_radius:
        return [
            f"pin_shaft.stiffness = {shaft.stiffness:g} N/mm: a shaft pin would yield by {load / shaft.stiffness:.3g} mm "
            'under its load; a plain number is N/mm, a thousand newtons a micrometre are 1e6 or "1000 N/µm"'
        ]
    return []


def _bending_stiffness(material: Material, diameter: float) -> float:
    """E I of a round bar, N·mm²."""
    return material.youngs_modulus * pi * diameter**4 / 64.0


def _too_long(path: str, span: float, diameter: float, bent: float) -> str:
    return (
        f"{path}.span = {span:g} mm: a pin of {diameter:g} mm would bend by {bent:.3g} mm under its load; a plain number is mm, "
        'micrometres are written "16000 µm"'
    )


def _modulus(drive: Drive) -> list[str]:
    values: dict[float, list[str]] = {}
    for path, material in materials_of_bodies(drive).items():
        values.setdefault(material.youngs_modulus, []).append(path)
    return [
        f"{_together(paths)}: youngs_modulus = {value:g} MPa is softer than any rigid plastic (some {SOFT:g} MPa) "
        f'and does not carry this torque; {value:g} GPa are written {1000.0 * value:g} or "{value:g} GPa"'
        for value, paths in values.items()
        if value < SOFT
    ]


def _pin_load(drive: Drive, share: float) -> float:
    """Load of a wheel pin under its share of the torque, if a third of the pins carry, N."""
    lever = drive.crank.eccentricity * drive.reduction_ratio
    return share / (lever * drive.pin_wheel.number_of_pins / 3.0)


def _pressure(drive: Drive, share: float) -> float:
    """Hertz pressure of a wheel pin under this load, MPa."""
    load = _pin_load(drive, share)
    modulus = contact_modulus(drive.materials.disc, drive.flank_pin)
    return sqrt(load * modulus / (pi * drive.disc.thickness * drive.pin_wheel.pin_radius))


def explain_failure(error: CycloError, drive: Drive, torque: float | None = None) -> CycloError:
    """Return an error that names the likely mistake of units in place of a failed solution of a drive.

    The error itself is returned where no value looks like a mistake, or where it is about something else. `torque` is the
    output torque, N·mm; that of the load by default.
    """
    if not isinstance(error, OverloadError | ConvergenceError):
        return error
    found = likely_unit_mistakes(drive, torque)
    if not found:
        return error
    if isinstance(error, OverloadError):
        return OverloadError([*found[:-1], f"{found[-1]}; {error.problems[0]}"])
    used = drive.load.torque if torque is None else torque
    return OverloadError(found) if used > OVERLOADED * carried_torque(drive) else DriveError(found)


@contextmanager
def unit_mistakes_named(drive: Drive, torque: float | None = None) -> Iterator[None]:
    """Let errors of a block that solves a drive name a likely mistake of units (`explain_failure`)."""
    try:
        yield
    except (ConvergenceError, DriveError) as error:
        raised = explain_failure(error, drive, torque)
        if raised is error:
            raise
        raise raised from error


def names_unit_mistakes(solve: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function with parameters ``drive`` and perhaps ``torque`` so that its errors name a likely mistake of
    units.
    """
    signature = inspect.signature(solve)

    @functools.wraps(solve)
    def explained(*args: P.args, **kwargs: P.kwargs) -> R:
        given = signature.bind(*args, **kwargs).arguments
        with unit_mistakes_named(given["drive"], given.get("torque")):
            return solve(*args, **kwargs)

    return explained


def stiffness_warning(drive: Drive) -> str | None:
    """Return a warning where a modulus is likely in pascals or gigapascals, None elsewhere.

    Beyond that of any material pascals are likely; a value that would be a metal in GPa, beside a part a hundred times
    stiffer, is likely in GPa: a soft shaft pin alone lets every solution succeed.
    """
    moduli = {path: material.youngs_modulus for path, material in materials_of_bodies(drive).items()}
    for path, modulus in moduli.items():
        if modulus > STIFF:
            return (
                f"{path}.youngs_modulus = {modulus:g} MPa is stiffer than diamond ({DIAMOND:g} MPa); a plain "
                f'number is MPa, not Pa: {modulus:g} Pa are written {1e-6 * modulus:g} or "{1e-9 * modulus:g} GPa"'
            )
    stiffest = max(moduli.values())
    for path, modulus in moduli.items():
        if METALS[0] <= 1000.0 * modulus <= METALS[1] and stiffest >= 100.0 * modulus:
            return (
                f"{path}.youngs_modulus = {modulus:g} MPa, beside {stiffest:g} MPa of another part; a plain number "
                f'is MPa: write "{modulus:g} GPa" for a metal'
            )
    return None


def unit_warnings(drive: Drive, torque: float | None = None) -> list[str]:
    """Return values that were probably meant in another unit, with what was meant, one sentence each; of the drive as
    written.

    First values that no drive has; where there are none, those far from the rest of the drive. `torque` is the output
    torque, N·mm; that of the load by default.
    """
    # What a drive carries follows from its lengths.
    found = _impossible(drive) or [*_odd_lengths(drive)] or [*_odd_strengths(drive)]
    return found or [
        *_odd_torques(drive, torque),
        *_odd_stiffnesses(drive),
        *_odd_forces(drive),
        *_odd_ratings(drive),
        *_odd_speeds(drive),
        *_odd_leads(drive),
        *_soft_carrier(drive, torque),
    ]


def limit_warnings(drive: Drive, limits: Iterable[Limit]) -> list[str]:
    """Return limits of pressures and stresses of a drive that were probably meant in another unit, one sentence each."""
    moduli = [getattr(drive.materials, part).youngs_modulus for part in _parts(drive)]
    told = (
        _odd_strength(f"limits.{limit.key}", limit.value, min(moduli), max(moduli))
        for limit in limits
        if limit.sense == "max" and LIMITED[limit.quantity].unit == "MPa"
    )
    return [words for words in told if words]


def carried_torque(drive: Drive) -> float:
    """Return the output torque at which the most pressed wheel pin reaches the allowable pressure, N·mm.

    An estimate, good to a factor of two: the pressure goes with the root of the torque. Lines of contact of stiffness π E* t/10
    (Palmgren) share the load by levers and gaps of the flank, and the pressure is Hertz's with the curvature of the flank
    (docs/how-to/design.md, closed forms); bodies, bearings and holes are rigid, and discs share evenly.
    """
    pair = (drive.materials.disc, drive.flank_pin)
    known = [part.allowable_pressure for part in pair if part.allowable_pressure is not None]
    softest = min(part.youngs_modulus for part in pair)
    allowed = min(*known, STRONGEST * softest) if known else _strength_of_kind(softest)
    return _torque_of_discs(drive, allowed)


def _torque_of_kind(drive: Drive) -> float:
    """Torque that a drive carries (`carried_torque`) by the strength of its kind of materials, whatever is given, N·mm."""
    softest = min(part.youngs_modulus for part in (drive.materials.disc, drive.flank_pin))
    return _torque_of_discs(drive, _strength_of_kind(softest))


def _strength_of_kind(softest: float) -> float:
    """Allowable flank pressure of a body of this Young's modulus without a given one, MPa."""
    return STRENGTH[softest < METALS[0]] * softest


def _torque_of_discs(drive: Drive, allowed: float) -> float:
    """Torque of all discs at which the first of the pins has the allowed pressure, N·mm."""
    modulus = contact_modulus(drive.materials.disc, drive.flank_pin)
    of_wheel = min(_torque_at_pressure(drive, allowed, modulus, phase / PHASES) for phase in range(PHASES))
    return drive.disc.number_of_discs * of_wheel


def _torque_at_pressure(drive: Drive, allowed: float, modulus: float, phase: float) -> float:
    """Torque of one disc on the wheel at which the first of the pins has the allowed pressure, N·mm; the first pin stands `phase`
    steps of pins from the eccentricity.
    """
    z, R, r = drive.pin_wheel.number_of_pins, drive.pin_wheel.pin_circle_radius, drive.pin_wheel.pin_radius
    u, t = abs(drive.reduction_ratio), drive.disc.thickness
    reach = drive.crank.eccentricity * u
    c = pi * modulus * t / 10.0
    pins: list[tuple[float, float, float]] = []
    for pin in range(z):
        angle = 2.0 * pi * (pin + phase) / z
        sine, cosine = sin(angle), cos(angle)
        if sine < 1e-9:
            continue
        d = sqrt(R**2 + reach**2 - 2.0 * R * reach * cosine)
        lever = reach * R * sine / d
        gap = drive.disc.equidistant_offset - drive.disc.shifting_offset * (R - reach * cosine) / d
        # Curvature of the path of the pin centres, and of the flank beside it.
        path = (R**2 + reach**2 * u - reach * R * (1.0 + u) * cosine) / d**3
        offset = 1.0 - path * (r + drive.disc.equidistant_offset)
        curvature = max(1.0 / r + path / (offset or 1e-12), 1e-12)
        pins.append((lever, gap, pi * t * allowed**2 / (modulus * curvature)))
    turned = min((load / c + gap) / lever for lever, gap, load in pins)
    return sum(c * max(turned * lever - gap, 0.0) * lever for lever, gap, _ in pins)


def _odd_torques(drive: Drive, torque: float | None) -> Iterator[str]:
    """Torques in newton metres that were read as N·mm, by what the drive carries."""
    load, carried = drive.load, carried_torque(drive)
    used = [("load.torque", load.torque) if torque is None or torque == load.torque else ("torque", torque)]
    if drive.duty:
        largest = max(range(len(drive.duty)), key=lambda entry: drive.duty[entry].torque)
        used.append((f"duty.{largest}.torque", drive.duty[largest].torque))
    beyond = False
    for path, value in used:
        if least_torque(drive) <= value < UNLOADED * carried:
            share = fraction(value / carried)
            yield f'{_newton_metres(path, value)}, {share} of {_carried_words(carried)}; did you mean "{value:g} N m"?'
        elif value > OVERLOADED * carried:
            beyond = True
            yield (
                f"{_newton_metres(path, value)}, {_times_carried(value, carried)}; a plain number is N·mm, did you mean "
                f'"{value / 1e6:g} N m"?'
            )
    if not beyond and not load.leaves_out_light_torque and load.light_torque < LIGHTEST * load.torque:
        yield (
            f"{_newton_metres('load.light_torque', load.light_torque)}, {fraction(load.light_torque / load.torque)} of "
            f'load.torque; did you mean "{load.light_torque:g} N m"?'
        )


def _odd_strengths(drive: Drive) -> Iterator[str]:
    """Strengths in GPa or Pa that were read as MPa, by the modulus of their own material: each value once, with its parts."""
    found: dict[tuple[str, float, float], list[str]] = {}
    for path, own in materials_of_bodies(drive).items():
        for name in STRENGTHS:
            if (value := getattr(own, name)) is not None:
                found.setdefault((name, value, own.youngs_modulus), []).append(path)
    for (name, value, modulus), paths in found.items():
        if told := _odd_strength(f"{_together(paths)}: {name}", value, modulus, modulus):
            yield told


def _odd_strength(path: str, value: float, softest: float, stiffest: float) -> str:
    """What to say of a strength or a limit, MPa, between bodies of these moduli; empty where there is nothing to say."""
    if value < WEAKEST * softest:
        return (
            f"{path} = {value:g} MPa is {fraction(value / softest)} of Young's modulus ({softest:g} MPa), less than any "
            f'material bears; a plain number is MPa, did you mean "{value:g} GPa" ({1000.0 * value:g} MPa)?'
        )
    if value > STRONGER * stiffest:
        return (
            f"{path} = {value:g} MPa is {rounded(value / stiffest)} times Young's modulus ({stiffest:g} MPa); a plain number is "
            f'MPa, did you mean "{value:g} Pa" ({1e-6 * value:g} MPa)?'
        )
    return ""


def _odd_stiffnesses(drive: Drive) -> Iterator[str]:
    """Stiffnesses in N/µm that were read as N/mm, by what the body of the disc or of the pin yields over its thickness."""
    parts, shaft, support = drive.materials, drive.pin_shaft, drive.crank.support
    softest = min(parts.disc.youngs_modulus, parts.wheel_pin.youngs_modulus, parts.shaft_pin.youngs_modulus)
    body = softest * drive.disc.thickness
    given: dict[str, float | None] = {
        "pin_shaft.stiffness": None if shaft is None else shaft.stiffness,
        "pin_wheel.support_stiffness": drive.pin_wheel.support_stiffness,
        "main_bearing.radial_stiffness": None if drive.main_bearing is None else drive.main_bearing.radial_stiffness,
    }
    if drive.main_bearing is not None:
        given["main_bearing.axial_stiffness"] = drive.main_bearing.axial_stiffness
    if drive.ring is not None and drive.ring.bolts is not None:
        given["ring.bolts.stiffness"] = drive.ring.bolts.stiffness
    if drive.first_stage is not None:
        given["first_stage.mesh_stiffness"] = drive.first_stage.mesh_stiffness
    for number, row in enumerate(() if drive.main_bearing is None else drive.main_bearing.bearings):
        path = f"main_bearing.bearings.{number}"
        given |= {f"{path}.radial_stiffness": row.radial_stiffness, f"{path}.axial_stiffness": row.axial_stiffness}
    if support is not None:
        given |= {f"crank.support.stiffness[{number}]": one for number, one in enumerate(support.stiffness)}
    for path, value in given.items():
        if value is not None and value < SPRINGY * body:
            yield (
                f"{path} = {value:g} N/mm is {fraction(value / body)} of Young's modulus times thickness of the disc "
                f'({body:.3g} N/mm): softer than any part of it; a plain number is N/mm, did you mean "{value:g} N/µm" '
                f"({1000.0 * value:g} N/mm)?"
            )


def _odd_forces(drive: Drive) -> Iterator[str]:
    """Preloads and forces from outside in kN that were read as N, by the load of the crank that the drive carries, and load
    constants of rows by how far their preload presses them in.
    """
    carried = carried_torque(drive) / (drive.crank.eccentricity * abs(drive.reduction_ratio))
    preloads = _preloads(drive)
    given = {f"{path}.force": one.force for path, one in preloads.items() if one.force is not None}
    for number, entry in enumerate(drive.load.external):
        parts = {f"load.external.{number}.force.{axis}": getattr(entry.force, axis) for axis in "xyz"}
        largest = max(parts, key=lambda path: abs(parts[path]))
        given[largest] = parts[largest]
    for path, value in given.items():
        if range_of("N")[0] <= abs(value) < FAINT * carried:  # less is as good as zero
            yield (
                f"{path} = {value:g} N is {fraction(abs(value) / carried)} of the load of a crank that this drive carries (some "
                f'{rounded(1e-3 * carried)} kN); a plain number is N, did you mean "{value:g} kN"?'
            )
    bearing, support = drive.main_bearing, drive.crank.support
    rows = [
        (f"main_bearing.bearings.{number}", row.load_constant, row.power, row.preload or bearing.preload)
        for number, row in enumerate(() if bearing is None else bearing.bearings)
        if bearing is not None
    ]
    if support is not None:
        rows.append(("crank.support", support.load_constant, ROLLER, support.preload))
    for path, constant, power, preload in rows:
        if constant is None or preload is None:
            continue
        if preload.force is not None:
            pressed = (preload.force / constant) ** (1.0 / power)
            told = f"would be pressed in by {pressed:.3g} mm by its preload of {preload.force:g} N"
            odd = pressed > PRESSED_IN * drive.crank.eccentricity
        else:
            force = constant * (preload.displacement or 0.0) ** power
            told = f"would press with {force:.3g} N at its preload of {preload.displacement:g} mm"
            odd = force < FAINT * carried
        if odd:
            yield (
                f"{path}.load_constant = {constant:g} N/mmⁿ: the row {told}; a plain number is N/mmⁿ, did you mean "
                f"{1000.0 * constant:.10g} (kN by mmⁿ)?"
            )


def _odd_ratings(drive: Drive) -> Iterator[str]:
    """Load ratings in kN that were read as N, by sizes and number of the rollers: ISO 281 and 76 of steel in round numbers."""
    part = drive.crank_bearing
    number, length, diameter = part.number_of_rollers, drive.roller_length, 2.0 * part.roller_radius
    about = {
        "dynamic_load_rating": 80.0 * length**0.78 * number**0.75 * diameter**1.07,
        "static_load_rating": 40.0 * length * number * diameter,
    }
    for name, estimate in about.items():
        if (value := getattr(part, name)) is not None and value < POOREST * estimate:
            yield (
                f"crank_bearing.{name} = {value:g} N is {fraction(value / estimate)} of what its rollers bear (some "
                f'{rounded(1e-3 * estimate)} kN); a plain number is N, did you mean "{value:g} kN"?'
            )


def _newton_metres(path: str, value: float) -> str:
    return f"{path} = {value:g} N·mm is {value / 1000.0:g} N·m"


def fraction(ratio: float) -> str:
    """Return a small ratio in words: "a thousandth", or "1/4200"."""
    return "a thousandth" if 0.8e-3 < ratio < 1.25e-3 else f"1/{rounded(1.0 / ratio)}"


def _floored(value: float) -> float:
    """A positive number to three figures, not above it."""
    step = 10.0 ** (floor(log10(value)) - 2)
    return floor(value / step) * step


def rounded(value: float) -> str:
    """Return a number to two figures, without an exponent up to a million."""
    return f"{float(f'{value:.2g}'):g}"


def _odd_lengths(drive: Drive) -> Iterator[str]:
    """Lengths in metres or micrometres that were read as mm, by the lengths beside them, and offsets finer than any made."""
    for path, value, beside, what in _lengths_beside(drive):
        if abs(value) < SHORT * beside:
            yield (
                f"{path} = {value:g} mm is {fraction(abs(value) / beside)} of {what} ({beside:.3g} mm); did you mean "
                f'"{value:g} m", {1000.0 * value:g} mm?'
            )
        elif abs(value) > LONG * beside:
            yield (
                f"{path} = {value:g} mm is {rounded(abs(value) / beside)} times {what} ({beside:.3g} mm); did you mean "
                f'"{value:g} µm", {value / 1000.0:g} mm?'
            )
    fine = {
        "disc.equidistant_offset": drive.disc.equidistant_offset,
        "disc.shifting_offset": drive.disc.shifting_offset,
        "clearance.bearing": drive.clearance.bearing,
        "clearance.pin_hole": drive.clearance.pin_hole,
        **_plays(drive),
    }
    finest = min(FINEST, FINE * drive.pin_wheel.pin_radius)
    for path, value in fine.items():
        if 1e-3 * finest <= abs(value) < finest:
            yield (
                f"{path} = {value:g} mm is {1000.0 * value:g} µm, finer than machines hold; did you mean "
                f'"{value:g} m", {1000.0 * value:g} mm?'
            )


def _odd_leads(drive: Drive) -> Iterator[str]:
    """Inclinations and leads in degrees, millimetres a metre or micrometres that were read as rad and mm."""
    if drive.contact.slices == 1:
        return
    thickness, finest = drive.disc.thickness, min(FINEST, FINE * drive.pin_wheel.pin_radius)
    for declared, field in declared_fields().items():
        if not needs_slices(declared) or declared.startswith("main_bearing."):
            continue
        for path, given_value, _ in given(drive, declared.split(".")):
            values = given_value if isinstance(given_value, tuple) else (given_value or 0.0,)
            value = max(values, key=abs, default=0.0)
            if field.unit == "rad" and abs(value) > STEEP:
                yield (
                    f"{path} = {value:g} rad is {1e3 * value * thickness:.3g} µm over the width of a disc, more than any part "
                    f'leans; a plain number is in rad, others are written "{value:g}°", "{value:g} mrad" or "{value:g} mm/m"'
                )
            elif field.name.endswith(("_drop", "_depth")) and value > DEEP * thickness:
                yield (
                    f"{path} = {value:g} mm is {1e3 * value:g} µm on a disc {thickness:g} mm thick, more than any relief; "
                    f'a plain number is in mm, micrometres are written "{value:g} µm"'
                )
            elif field.name.endswith(("_drop", "_depth")) and 1e-3 * finest <= value < finest:
                yield (
                    f"{path} = {value:g} mm is {1e3 * value:g} µm, finer than machines hold; did you mean "
                    f'"{value:g} m", {1e3 * value:g} mm?'
                )


def _plays(drive: Drive) -> dict[str, float]:
    """Clearances, preloads by displacement and backlash of what holds the contacts, by path, mm."""
    found = {} if drive.first_stage is None else {"first_stage.backlash": drive.first_stage.backlash}
    bearing, support = drive.main_bearing, drive.crank.support
    held = (("main_bearing", bearing), ("crank.support", support))
    found |= {f"{path}.clearance": one.clearance or 0.0 for path, one in held if one is not None}
    return found | {f"{path}.displacement": one.displacement or 0.0 for path, one in _preloads(drive).items()}


def _preloads(drive: Drive) -> dict[str, Preload]:
    """Preloads of bearings by path."""
    bearing, support = drive.main_bearing, drive.crank.support
    found = {
        "main_bearing.preload": None if bearing is None else bearing.preload,
        "crank.support.preload": None if support is None else support.preload,
    }
    for number, row in enumerate(() if bearing is None else bearing.bearings):
        found[f"main_bearing.bearings.{number}.preload"] = row.preload
    return {path: one for path, one in found.items() if one is not None}


def _axial_places(drive: Drive) -> dict[str, float | None]:
    """Places along the axis of what holds and loads the discs, by path, mm."""
    support, stage, bearing = drive.crank.support, drive.first_stage, drive.main_bearing
    found: dict[str, float | None] = {"first_stage.plane": None if stage is None else stage.plane}
    if support is not None:
        found["crank.support.spline_plane"] = support.spline_plane
        found |= {f"crank.support.positions[{number}]": one for number, one in enumerate(support.positions)}
    for number, row in enumerate(() if bearing is None else bearing.bearings):
        found[f"main_bearing.bearings.{number}.plane"] = row.plane
    for number, entry in enumerate(drive.load.external):
        found[f"load.external.{number}.at.z"] = entry.at.z
    return found


def _lengths_beside(drive: Drive) -> Iterator[tuple[str, float, float, str]]:
    """Path and value of lengths with a length beside them, and what that is."""
    wheel, shaft, bearing = drive.pin_wheel, drive.pin_shaft, drive.crank_bearing
    circle, thickness = wheel.pin_circle_radius, drive.disc.thickness
    half = circle * sin(pi / wheel.number_of_pins)
    yield "pin_wheel.pin_radius", wheel.pin_radius, half, "half the distance of neighbouring pins"
    rolling = circle / wheel.number_of_pins
    yield "crank.eccentricity", drive.crank.eccentricity, rolling, "the pin circle radius by the number of pins"
    half_circle = 0.5 * circle
    yield "disc.thickness", thickness, half_circle, "half the pin circle radius"
    if not SHORT * half_circle <= thickness <= LONG * half_circle:
        return  # the others stand beside it
    yield "crank_bearing.roller_length", drive.roller_length, thickness, "the thickness of the disc"
    support, stack = drive.crank.support, drive.disc.number_of_discs * thickness
    if support is not None:
        inner = 2.0 * bearing.inner_race_radius
        yield "crank.support.diameter", support.diameter, inner, "the diameter of the inner race on it"
    for path, place in _axial_places(drive).items():
        if place is not None and abs(place) >= range_of("mm")[0]:  # less is as good as zero
            yield path, place, stack, "the thickness of all discs"
    ring = drive.ring
    if ring is not None:
        yield "ring.outer_radius", ring.outer_radius, half_circle, "half the pin circle radius"
        yield "ring.width", ring.width, stack, "the thickness of all discs"
        if ring.bolts is not None:
            yield "ring.bolts.circle_radius", ring.bolts.circle_radius, half_circle, "half the pin circle radius"
    for number, row in enumerate(() if drive.main_bearing is None else drive.main_bearing.bearings):
        if row.pitch_radius is not None:
            path = f"main_bearing.bearings.{number}.pitch_radius"
            yield path, row.pitch_radius, half_circle, "half the pin circle radius"
    posts = None if drive.carrier is None else drive.carrier.posts
    if posts is not None:
        yield "carrier.posts.radius", posts.radius, half_circle, "half the pin circle radius"
        yield "carrier.posts.size", posts.size, posts.radius, "the radius of the circle of the posts"
        yield "carrier.posts.length", drive.post_length, stack, "the thickness of all discs"
        for number, flange in enumerate(() if drive.carrier is None else drive.carrier.flange or ()):
            yield f"carrier.flange.{number}", flange, stack, "the thickness of all discs"
    for name, part, span in (
        ("pin_wheel", wheel, drive.wheel_pin_span),
        ("pin_shaft", shaft, drive.shaft_pin_span),
    ):
        if part is not None and part.beam is not None:
            yield f"{name}.beam.diameter", part.beam_diameter, 2.0 * part.pin_radius, f"twice {name}.pin_radius"
            yield f"{name}.beam.span", span, stack, "the thickness of all discs"


def _odd_speeds(drive: Drive) -> Iterator[str]:
    """A speed in Hz or rad/s, or in deg/s, that was read as rpm; of a duty its fastest entry."""
    speeds = {} if drive.load.speed is None else {"load.speed": drive.load.speed}
    if drive.duty:
        fastest = max(range(len(drive.duty)), key=lambda entry: drive.duty[entry].speed)
        speeds[f"duty.{fastest}.speed"] = drive.duty[fastest].speed
    for path, value in speeds.items():
        if value < SLOW_INPUT and value / abs(drive.transmission_ratio) < SLOW_OUTPUT:
            yield (
                f"{path} = {value:g} rpm at the input is less than a turn a second; did you mean "
                f'"{value:g} Hz" ({60.0 * value:g} rpm) or "{value:g} rad/s" ({30.0 / pi * value:.3g} rpm)?'
            )
        mean = 2.0 * (drive.crank_bearing.inner_race_radius + drive.crank_bearing.roller_radius)
        turns = abs(drive.crank_turns_per_input) * value
        if turns * mean > FASTEST:
            yield (
                f"{path} = {value:g} rpm turns the crank bearing of {mean:.3g} mm mean diameter at {turns * mean:.2g} mm/min: "
                f'faster than roller bearings run (some 1e6); a plain number is rpm, did you mean "{value:g} deg/s" '
                f"({value / 6.0:g} rpm) or {value / 60.0:g} rpm?"
            )


def _soft_carrier(drive: Drive, torque: float | None) -> Iterator[str]:
    """A torsional stiffness in N·m/rad, or by the minute, that was read as N·mm/rad."""
    twist, carrier = (drive.load.torque if torque is None else torque) * drive.carrier_compliance, drive.carrier
    if carrier is None or carrier.stiffness_torsion is None or twist < TWISTED:
        return
    value = carrier.stiffness_torsion
    yield (
        f"carrier.stiffness_torsion = {value:g} N·mm/rad would let the output turn by {rounded(twist * 180.0 / pi)}° under its "
        f'torque; did you mean "{value:g} N·m/rad" or "{value:g} N·m/arcmin"?'
    )


def _impossible(drive: Drive) -> list[str]:
    """Values that no drive has, with the values that were probably meant."""
    stiff, size = stiffness_warning(drive), drive.pin_wheel.pin_circle_radius
    found = [] if stiff is None else [stiff]
    named = f"pin_wheel.pin_circle_radius = {size:g} mm"
    if size < SMALLEST:
        meant = f'lengths in metres are written "{size:g} m" or {1000.0 * size:g}'
        stiffest = max(getattr(drive.materials, part).youngs_modulus for part in _parts(drive))
        if stiffest > STIFF:
            found = []
            named += f" and youngs_modulus = {stiffest:g} MPa look like a file in SI units (m, Pa, N·m)"
            meant = (
                f"plain numbers are mm, MPa and N·mm: {1000.0 * size:g}, {1e-6 * stiffest:g}, torques a thousandfold"
            )
        else:
            named += " is smaller than any drive that is built"
        found.append(f"{named}; {meant}")
    elif size > LARGEST:
        found.append(
            f"{named} is {0.001 * size:g} m, larger than any drive that is built; a plain number is mm: "
            f'was {0.001 * size:g} mm meant, "{0.001 * size:g} mm"?'
        )
    angles = [("disc.phases", angle) for angle in drive.disc.phases] + [("crank.angle", drive.crank.angle)]
    angles += [(f"crank.of.{number}.phase_error", one.phase_error) for number, one in enumerate(drive.crank.of)]
    for path, angle in angles:
        if abs(angle) > TURN:
            found.append(
                f"{path}: {angle:g} rad are {angle / (2.0 * pi):.3g} turns; a plain number is rad, degrees are written "
                f'"{angle:g} deg"'
            )
            break
    if told := kelvin_words(drive):
        found.append(told)
    return found


TURN = 2.0 * pi * (1.0 + 1e-6)
"""Largest sensible angle of a disc or crank, rad: one turn, with the rounding of 2π."""


def kelvin_words(drive: Drive) -> str:
    """Return the temperatures of a drive, as written, that are probably in kelvin; empty where none is."""
    if drive.temperature is None:
        return ""
    hot = {
        part: value for part in ("housing", "disc", "shaft") if (value := getattr(drive.temperature, part)) > HOTTEST
    }
    if not hot:
        return ""
    value = next(iter(hot.values()))
    told = ", ".join(f"temperature.{name} = {each:g} °C" for name, each in hot.items())
    return (
        f'{told}: beyond {HOTTEST:g} °C bearing steel softens; a plain number is °C, kelvin are written "{value:g} K" '
        f"({value - 273.15:g} °C)"
    )
