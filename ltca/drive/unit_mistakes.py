"""Likely mistakes of units behind a drive that cannot carry its load: looked for when a solution fails, never before.

A soft drive under a light torque is sound (printed plastics have some 3000 MPa, TPU 30 MPa), so no modulus is refused, and
values that no drive has give a warning (`unit_warnings`). Where no equilibrium exists, a modulus like that of rubber, a torque
beyond the strength of steel or a pin deflection larger than its hole is a likelier cause than slipping teeth.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from dataclasses import fields
from math import pi, sqrt
from typing import ParamSpec, TypeVar

from ltca.drive.parts import Drive, Material, Materials, contact_modulus
from ltca.errors import ConvergenceError, CycloError, DriveError

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


def _parts(drive: Drive) -> list[str]:
    """Parts whose material is under contact pressure: without crankshafts, and slots and sleeves where there are none."""
    seats = {drive.pin_wheel.seat.kind} | (set() if drive.pin_shaft is None else {drive.pin_shaft.seat.kind})
    counts = {"crankshaft": False, "wheel_seat": "slot" in seats, "sleeve": "sleeve" in seats}
    return [item.name for item in fields(Materials) if counts.get(item.name, True)]


def likely_unit_mistakes(drive: Drive, torque: float | None = None) -> list[str]:
    """Return values of a drive whose solution failed that look like numbers in another unit, one sentence each, the
    likeliest first.

    `torque` is the output torque, N·mm; that of the load by default.
    """
    used = drive.load.torque if torque is None else torque
    if beyond := unit_warnings(drive):
        return beyond
    modulus = _modulus(drive)
    if modulus:
        return modulus  # the others follow from it
    share = used / drive.disc.number_of_discs
    for named, value in (
        ("load.torque" if used == drive.load.torque else "torque", used),
        ("load.light_torque", drive.load.light_torque),
    ):
        pressure = _pressure(drive, value / drive.disc.number_of_discs)
        if pressure > BORNE:
            return [
                f"{named} = {value:g} N·mm is {value / 1000.0:g} N·m and would press the wheel pins with some "
                f'{pressure:.2g} MPa, which no steel bears; a plain number is N·mm, newton metres are written "377.3 N m"'
            ]
    return _yielding(drive, share)


def _yielding(drive: Drive, share: float) -> list[str]:
    """Problems of pins so soft, or so long, that they would leave their place."""
    wheel, shaft = drive.pin_wheel, drive.pin_shaft
    if wheel.beam is not None:
        bending = 48.0 * _bending_stiffness(drive.materials.wheel_pin, wheel.beam_diameter) / wheel.beam.span**3
        load = _pin_load(drive, share)
        if load / bending > 0.5 * wheel.pin_radius:
            return [_too_long("pin_wheel.beam", wheel.beam.span, wheel.beam_diameter, load / bending)]
    if shaft is None:
        return []
    # Some third of the pins carry, on a lever of about two thirds of their circle.
    load = share / (0.2 * shaft.number_of_pins * shaft.pin_circle_radius)
    if shaft.beam is not None:
        # In the middle of the span, half of it from the flange.
        bending = 24.0 * _bending_stiffness(drive.materials.shaft_pin, shaft.beam_diameter) / shaft.beam.span**3
        if load / bending > 0.5 * shaft.hole_radius:
            return [_too_long("pin_shaft.beam", shaft.beam.span, shaft.beam_diameter, load / bending)]
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
    for part in _parts(drive):
        values.setdefault(getattr(drive.materials, part).youngs_modulus, []).append(part)
    return [
        f"materials.{', '.join(names)}: youngs_modulus = {value:g} MPa is softer than any rigid plastic (some {SOFT:g} MPa) "
        f'and does not carry this torque; {value:g} GPa are written {1000.0 * value:g} or "{value:g} GPa"'
        for value, names in values.items()
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
    carried = isinstance(error, DriveError) and any("cannot be carried" in problem for problem in error.problems)
    if not carried and not isinstance(error, ConvergenceError):
        return error
    found = likely_unit_mistakes(drive, torque)
    if not found:
        return error
    told = f"; {error.problems[0]}" if isinstance(error, DriveError) else ""
    return DriveError([*found[:-1], f"{found[-1]}{told}"])


def names_unit_mistakes(solve: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function with parameters ``drive`` and perhaps ``torque`` so that its errors name a likely mistake of
    units.
    """
    signature = inspect.signature(solve)

    @functools.wraps(solve)
    def explained(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return solve(*args, **kwargs)
        except (ConvergenceError, DriveError) as error:
            given = signature.bind(*args, **kwargs).arguments
            raised = explain_failure(error, given["drive"], given.get("torque"))
            if raised is error:
                raise
            raise raised from error

    return explained


def stiffness_warning(drive: Drive) -> str | None:
    """Return a warning where a modulus is likely in pascals or gigapascals, None elsewhere.

    Beyond that of any material pascals are likely; a value that would be a metal in GPa, beside a part a hundred times
    stiffer, is likely in GPa: a soft shaft pin alone lets every solution succeed.
    """
    parts = _parts(drive)
    for part in parts:
        modulus = getattr(drive.materials, part).youngs_modulus
        if modulus > STIFF:
            return (
                f"materials.{part}.youngs_modulus = {modulus:g} MPa is stiffer than diamond ({DIAMOND:g} MPa); a plain "
                f'number is MPa, not Pa: {modulus:g} Pa are written {1e-6 * modulus:g} or "{1e-9 * modulus:g} GPa"'
            )
    stiffest = max(getattr(drive.materials, part).youngs_modulus for part in parts)
    for part in parts:
        modulus = getattr(drive.materials, part).youngs_modulus
        if METALS[0] <= 1000.0 * modulus <= METALS[1] and stiffest >= 100.0 * modulus:
            return (
                f"materials.{part}.youngs_modulus = {modulus:g} MPa, beside {stiffest:g} MPa of another part; a plain number "
                f'is MPa: write "{modulus:g} GPa" for a metal'
            )
    return None


def unit_warnings(drive: Drive) -> list[str]:
    """Return values that no drive has, with the values that were probably meant, one sentence each; of the drive as
    written.
    """
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
