"""Random but valid drives, to test the analysis on unforeseen combinations.

A drive is a point of the unit cube: each coordinate moves one property between bounds that the others allow, so
nearly every point is a valid drive. Zeros give the plainest one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.random import Generator

from ltca.drive.deviations import DiscClearance, OneDisc, OneEccentric, PlacementErrors, RollerErrors, Runout
from ltca.drive.members.width import LARGEST_SLOPE
from ltca.drive.parts import Contact, Drive, Inclination, Installation
from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile
from ltca.reading.drive_file import build_drive
from ltca.reading.physical_checks import find_contradictions
from ltca.testing.practical_drives import with_ring

COORDINATES = 34
REFERENCE_PRESSURE = 2000.0
"""Hertz pressure of two fully loaded wheel pins at the largest torque, MPa."""
PROFILED = 0.999
"""Coordinate above which rollers are crowned or relieved; only few, since a table of such a law takes a second."""


def _between(low: float, high: float, part: float) -> float:
    return low + (high - low) * part


def _logarithmic(low: float, high: float, part: float) -> float:
    return float(low * (high / low) ** part)


def _often_zero(part: float) -> float:
    """Map the lower third to zero and the rest to (0, 1]."""
    return max(0.0, (part - 1.0 / 3.0) * 1.5)


def random_drive(point: Sequence[float]) -> tuple[Drive, float] | None:
    """Return a drive and a crank angle in rad for a point of the unit cube, None where no drive fits.

    The coordinates (`COORDINATES` numbers between 0 and 1) are tooth number (6 to 120), size, e z_P/R_C (0.2 to 0.95), pin
    radius, offsets, bearing, holes, clearances, modulus, errors of single parts, torque (four decades), direction and crank
    angle, crown and relief, then eccentricity, both axes, runout, flank (harmonics, measured points). A third of the range
    of each deviation is zero.
    """
    if len(point) != COORDINATES:
        raise ValueError(f"a random drive needs {COORDINATES} numbers, got {len(point)}")
    u = iter(point)
    pins = round(_logarithmic(6.0, 120.0, next(u)))
    circle = _logarithmic(20.0, 300.0, next(u))
    eccentricity = _between(0.2, 0.95, next(u)) * circle / pins
    # The largest pin before neighbours overlap or the flank is undercut (convex side of the pin-centre path).
    path = (
        FlankProfile(generating_radius=circle, eccentricity=eccentricity, reduction_ratio=float(pins), offset=1.0)
        .locus(np.linspace(0.0, 2.0 * np.pi / pins, 2001))
        .curvature
    )
    room = min(circle * float(np.sin(np.pi / pins)), 1.0 / float(np.max(path)))
    pin_radius = room * _between(0.2, 0.85, next(u))
    shift = 0.01 * pin_radius * (2.0 * _often_zero(next(u)) - _often_zero(next(u)))
    # Not less than what leaves a gap everywhere: equal offsets, or negative ones with a negative shift.
    steepest = float(np.sqrt(1.0 - (eccentricity * pins / (circle + shift)) ** 2))
    equidistant = max(shift, shift * steepest) + 0.02 * pin_radius * _often_zero(next(u))
    root = circle + shift - eccentricity - pin_radius - equidistant
    if root <= 0.0:
        return None
    bore = root * _between(0.3, 0.55, next(u))
    roller_radius = bore * _between(0.08, 0.2, next(u))
    inner = bore - 2.0 * roller_radius
    fitting = int(np.pi / np.arcsin(1.02 * roller_radius / (inner + roller_radius)))
    rollers = max(3, round(_between(6.0, float(fitting), next(u))))
    holes = round(_between(3.0, 16.0, next(u)))
    hole_circle = 0.5 * (bore + root) * _between(0.97, 1.03, next(u))
    hole_room = 0.93 * min(hole_circle - bore, root - hole_circle, hole_circle * float(np.sin(np.pi / holes)))
    if hole_room < 1.3 * eccentricity:
        return None
    hole_radius = _between(1.3 * eccentricity, hole_room, next(u))
    thickness = circle * _between(0.05, 0.4, next(u))
    roller_length = thickness * _between(1.0, 0.5, next(u))
    bearing_play = 0.05 * roller_radius * _often_zero(next(u)) ** 3
    hole_play = 0.05 * eccentricity * _often_zero(next(u)) ** 3
    modulus = _between(206e3, 70e3, next(u))
    stiffness = _logarithmic(1e4, 1e7, next(u)) * thickness / 10.0
    line_load = np.pi * REFERENCE_PRESSURE**2 * pin_radius / modulus
    largest = 2.0 * line_load * thickness * eccentricity * pins
    torque = _logarithmic(largest, 1e-4 * largest, next(u))
    scatter = 2e-3 * pin_radius * _often_zero(next(u)) ** 2
    errors = np.random.default_rng(round(1e6 * next(u)))
    direction = "ccw" if next(u) < 0.7 else "cw"
    angle = 2.0 * np.pi * next(u)
    offset_hole = _often_zero(next(u))
    profile = next(u)
    shaft_radius = hole_radius - eccentricity * (1.0 + 0.02 * offset_hole)
    # A third of what a drive may deviate by before it is refused.
    bound = 0.03 * min(pin_radius, roller_radius, max(shaft_radius, 0.0))
    lengths = _Lengths(u, errors, size=min(2e-3 * pin_radius, bound, 0.1 * eccentricity))
    scattered = _Scattered(errors, scatter=min(scatter, bound))
    table: dict[str, Any] = {
        "crank": {
            "eccentricity": eccentricity,
            "eccentricity_error": lengths.signed(),
            "axis_offset": lengths.place(),
        },
        "pin_wheel": {
            "number_of_pins": pins,
            "pin_circle_radius": circle,
            "pin_radius": pin_radius,
            "pin_errors": scattered.errors(pins),
            "axis_offset": lengths.place(),
        },
        "disc": {
            "number_of_teeth": pins - 1,
            "thickness": thickness,
            "equidistant_offset": equidistant,
            "shifting_offset": shift,
            "hole_errors": scattered.errors(holes),
            "runout": {"amount": lengths.signed(), "angle": errors.uniform(0.0, 2.0 * np.pi)},
            "profile_errors": {
                **_harmonics(errors, pins, lengths.amount(), pin_radius / circle**2),
                **_measured_points(errors, lengths.amount()),
            },
        },
        "crank_bearing": {
            "inner_race_radius": inner,
            "outer_race_radius": bore,
            "number_of_rollers": rollers,
            "roller_radius": roller_radius,
            "roller_length": roller_length,
            "roller_profile": _roller_profile(profile, roller_radius, roller_length),
            "roller_errors": scattered.errors(rollers, "tangential", "diameter"),
        },
        "pin_shaft": {
            "number_of_pins": holes,
            "pin_circle_radius": hole_circle,
            "pin_radius": shaft_radius,
            "hole_radius": hole_radius,
            "stiffness": stiffness,
            "pin_errors": scattered.errors(holes),
        },
        "load": {"torque": torque, "light_torque": 0.1 * torque, "direction": direction},
        "clearance": {"bearing": bearing_play, "pin_hole": hole_play},
        "materials": {
            part: {"youngs_modulus": modulus} for part in ("disc", "wheel_pin", "roller", "inner_race", "shaft_pin")
        },
    }
    try:
        return build_drive(table), angle
    except DriveError:
        return None


def random_reducer(seed: int) -> tuple[Drive, float] | None:
    """Return a random drive of one to three discs with either member held, half of them with an elastic ring, and a crank
    angle in rad; None where none fits.

    The seed determines the point of `random_drive` and the values per disc.
    """
    random = np.random.default_rng(seed)
    drawn = random_drive(random.random(COORDINATES).tolist())
    if drawn is None:
        return None
    drive, angle = drawn
    discs = int(random.choice([1, 1, 2, 3]))
    spread = 2.0 * np.pi * np.arange(discs) / discs
    away = random.choice([0.0, 0.3]) * random.uniform(-1.0, 1.0, discs)
    phases = () if random.uniform() < 0.5 else tuple((spread + away).tolist())
    size = float(random.choice([0.0, 1e-3])) * drive.pin_wheel.pin_radius
    size = min(size, 0.03 * drive.crank.eccentricity)
    disc, crank = replace(drive.disc, number_of_discs=discs, phases=phases), drive.crank
    if size > 0.0:
        own = [_own_errors(random, drive, size) for _ in range(discs)]
        eccentrics = [_own_eccentric(random, drive, size) for _ in range(discs)]
        disc, crank = replace(disc, of=tuple(own)), replace(crank, of=tuple(eccentrics))
    load = replace(drive.load, torque=discs * drive.load.torque)
    held: Any = str(random.choice(["pin-shaft", "pin-wheel"]))
    found = replace(drive, disc=disc, crank=crank, load=load, installation=Installation(held=held))
    return None if find_contradictions(found) else (with_ring(seed, found), angle)


def tilted_reducer(seed: int) -> tuple[Drive, float] | None:
    """Return a random reducer (`random_reducer`) with a rigid ring and contacts in slices, and a crank angle in rad; None where
    none fits.
    """
    drawn = random_reducer(seed)
    if drawn is None:
        return None
    return with_width(seed, replace(drawn[0], ring=None)), drawn[1]


def with_width(seed: int, drive: Drive) -> Drive:
    """Return a drive with contacts in slices, and with leads and inclinations by a seed (not negative).

    A third of the inclinations and leads are zero; edges move by up to a thousandth of the pin radius, a few times what contacts
    approach. A tenth of the drives are as drawn, in another tenth all that leans has the inclination of the wheel, so that
    nothing tilts against anything else but the crank. Flanks slope and pins lean alike in some.
    """
    random = np.random.default_rng((seed, 30))
    contact = Contact(slices=int(random.choice([3, 5, 9, 9])))
    kind = random.uniform()
    size = 1e-3 * drive.pin_wheel.pin_radius * float(random.choice([0.3, 1.0]))
    slope = min(2.0 * size / drive.disc.thickness, 0.3 * LARGEST_SLOPE)
    if kind < 0.1:
        return replace(drive, contact=contact)

    def angle() -> float:
        return 0.0 if random.uniform() < 1.0 / 3.0 else float(slope * random.uniform(-1.0, 1.0))

    def drop() -> float:
        return 0.0 if random.uniform() < 1.0 / 3.0 else float(size * random.uniform())

    def leaning(errors: PlacementErrors, count: int) -> PlacementErrors:
        rows = [() if random.uniform() < 1.0 / 3.0 else tuple(angle() for _ in range(count)) for _ in range(2)]
        return replace(errors, inclination_x=rows[0], inclination_y=rows[1])

    wheel, shaft, disc, crank = drive.pin_wheel, drive.pin_shaft, drive.disc, drive.crank
    own = Inclination(x=angle(), y=angle())
    wheel, crank = replace(wheel, inclination=own), replace(crank, inclination=Inclination(x=angle(), y=angle()))
    disc = replace(disc, lead_crown_drop=drop(), lead_slope=angle(), axial_play=2.0 * size)
    if relief := drop():
        length = float(random.choice([0.1, 0.3, 0.5])) * disc.thickness
        disc = replace(disc, lead_relief_length=length, lead_relief_depth=relief)
    if disc.of and random.uniform() < 0.5:
        disc = replace(disc, of=tuple(replace(entry, lead_slope=angle(), lead_crown_drop=drop()) for entry in disc.of))
    if shaft is not None and kind < 0.2:
        shaft, disc = replace(shaft, inclination=own), replace(disc, lead_slope=0.0, of=())
    elif shaft is not None:
        shaft = replace(shaft, inclination=Inclination(x=angle(), y=disc.lead_slope if kind < 0.4 else angle()))
        shaft = replace(shaft, pin_errors=leaning(shaft.pin_errors, shaft.number_of_pins))
        disc = replace(disc, hole_errors=leaning(disc.hole_errors, shaft.number_of_pins))
        wheel = replace(wheel, pin_errors=leaning(wheel.pin_errors, wheel.number_of_pins))
    return replace(drive, contact=contact, pin_wheel=wheel, pin_shaft=shaft, disc=disc, crank=crank)


def _own_errors(random: Generator, drive: Drive, size: float) -> OneDisc:
    """Values of one disc: none, or some of runout, clearances and errors of its holes and rollers."""
    given = random.uniform(size=4) < 0.5
    holes, rollers = drive.number_of_holes, drive.crank_bearing.number_of_rollers
    scattered = _Scattered(random, scatter=size / 3.0)
    return OneDisc(
        runout=Runout(amount=size * random.uniform(), angle=2.0 * np.pi * random.uniform()) if given[0] else None,
        clearance=DiscClearance(bearing=size * random.uniform()) if given[1] else None,
        hole_errors=PlacementErrors(**_tuples(scattered.errors(holes))) if given[2] else None,
        roller_errors=(
            RollerErrors(**_tuples(scattered.errors(rollers, "tangential", "diameter"))) if given[3] else None
        ),
    )


def _own_eccentric(random: Generator, drive: Drive, size: float) -> OneEccentric:
    """An eccentric with errors, or without."""
    if random.uniform() < 0.5:
        return OneEccentric()
    error, ahead = (size * random.uniform(-1.0, 1.0, 2)).tolist()
    return OneEccentric(eccentricity_error=error, phase_error=ahead / drive.crank.eccentricity)


def _tuples(errors: dict[str, list[float]]) -> dict[str, Any]:
    return {name: tuple(values) for name, values in errors.items()}


class _Lengths:
    """Deviations of single lengths: their size from a coordinate of the point, their direction from random numbers."""

    def __init__(self, point: Iterator[float], random: Generator, *, size: float) -> None:
        self.point, self.random, self.size = point, random, size

    def amount(self) -> float:
        return self.size * _often_zero(next(self.point)) ** 2

    def signed(self) -> float:
        return self.amount() * float(self.random.choice([-1.0, 1.0]))

    def place(self) -> dict[str, float]:
        amount, angle = self.amount(), self.random.uniform(0.0, 2.0 * np.pi)
        return {"x": float(amount * np.cos(angle)), "y": float(amount * np.sin(angle))}


class _Scattered:
    """Errors of the parts of a circle; those of each kind are zero a third of the time."""

    def __init__(self, random: Generator, *, scatter: float) -> None:
        self.random, self.scatter = random, scatter

    def errors(self, count: int, *kinds: str) -> dict[str, list[float]]:
        found = {}
        for kind in kinds or ("radial", "tangential", "diameter"):
            values = self.scatter * np.clip(self.random.normal(size=count), -3.0, 3.0)
            found[kind] = [] if self.random.uniform() < 1.0 / 3.0 or self.scatter == 0.0 else values.tolist()
        return found


def _harmonics(random: Generator, pins: int, size: float, sharpness: float) -> dict[str, list[Any]]:
    """Up to three waves of the flank; those of high order have at most a fifth of the curvature of the pins."""
    orders = random.choice([1, 2, 3, pins - 1, pins, 2 * pins, 3 * pins], size=random.integers(1, 4), replace=False)
    if size == 0.0:
        return {}
    largest = np.minimum(size, 0.2 / (sharpness * orders**2)) / orders.size
    return {
        "orders": orders.tolist(),
        "cosine": (largest * random.uniform(-1.0, 1.0, orders.size)).tolist(),
        "sine": (largest * random.uniform(-1.0, 1.0, orders.size)).tolist(),
    }


def _measured_points(random: Generator, size: float) -> dict[str, list[float]]:
    count = int(random.integers(5, 30))
    places = (np.arange(count) + random.uniform(0.0, 0.7, count)) / count * 2.0 * np.pi
    values = random.uniform(-1.0, 1.0, count)
    return {} if size == 0.0 else {"parameter": places.tolist(), "deviation": (size * values).tolist()}


def _roller_profile(part: float, radius: float, length: float) -> dict[str, float]:
    """Crown, logarithmic profile or end relief of a small part of the drives."""
    if part <= PROFILED:
        return {}
    which = 3.0 * (part - PROFILED) / (1.0 - PROFILED)
    if which < 1.0:
        return {"crown_drop": 1e-3 * radius}
    if which < 2.0:
        return {"logarithmic_factor": 1.0}
    return {"end_relief_length": 0.2 * length, "end_relief_depth": 2e-3 * radius}
