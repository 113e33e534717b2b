"""Random but valid drives, to try the analysis on what nobody thought of.

A drive is a point of the unit cube: each coordinate moves one property between bounds that the others allow, so
nearly every point is a valid drive. Zeros give the plainest one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.random import Generator

from ltca.drive.parts import Drive
from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile
from ltca.reading.drive_file import build_drive

COORDINATES = 34
REFERENCE_PRESSURE = 2000.0
"""Hertz pressure of two fully loaded wheel pins at the largest torque, MPa."""
PROFILED = 0.999
"""Coordinate above which rollers are crowned or relieved: a table of such a law takes a second, so few are."""


def _between(low: float, high: float, part: float) -> float:
    return low + (high - low) * part


def _logarithmic(low: float, high: float, part: float) -> float:
    return float(low * (high / low) ** part)


def _often_zero(part: float) -> float:
    """Map the lower third to zero and the rest to (0, 1]."""
    return max(0.0, (part - 1.0 / 3.0) * 1.5)


def random_drive(point: Sequence[float]) -> tuple[Drive, float] | None:
    """Return a drive and a crank angle in rad for a point of the unit cube, None where no drive fits.

    Parameters
    ----------
    point : sequence of float, length `COORDINATES`
        Each between 0 and 1: tooth number (6 to 120), size, e z_P/R_C (0.2 to 0.95), pin radius, offsets, bearing,
        holes, clearances, modulus, errors of single parts, torque (four decades), direction and crank angle, crown
        and relief, then eccentricity, both axes, runout, flank (harmonics, measured points). A third of each
        deviation's range is zero.
    """
    if len(point) != COORDINATES:
        raise ValueError(f"a random drive needs {COORDINATES} numbers, got {len(point)}")
    u = iter(point)
    pins = round(_logarithmic(6.0, 120.0, next(u)))
    circle = _logarithmic(20.0, 300.0, next(u))
    eccentricity = _between(0.2, 0.95, next(u)) * circle / pins
    # The largest pin before neighbours overlap or the flank is undercut (convex side of the pin-centre path).
    path = FlankProfile(
        generating_radius=circle, eccentricity=eccentricity, reduction_ratio=float(pins), offset=1.0
    ).locus_curvature(np.linspace(0.0, 2.0 * np.pi / pins, 2001))
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


class _Lengths:
    """Deviations of one length each: how large by a coordinate of the point, which way by random numbers."""

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
    """Errors of the parts of a circle; those of each kind are left out a third of the time."""

    def __init__(self, random: Generator, *, scatter: float) -> None:
        self.random, self.scatter = random, scatter

    def errors(self, count: int, *kinds: str) -> dict[str, list[float]]:
        found = {}
        for kind in kinds or ("radial", "tangential", "diameter"):
            values = self.scatter * np.clip(self.random.normal(size=count), -3.0, 3.0)
            found[kind] = [] if self.random.uniform() < 1.0 / 3.0 or self.scatter == 0.0 else values.tolist()
        return found


def _harmonics(random: Generator, pins: int, size: float, sharpness: float) -> dict[str, list[Any]]:
    """Up to three waves of the flank, those of high order no rounder than a fifth of the pins are."""
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
    """Crown, logarithmic profile or end relief of a few drives."""
    if part <= PROFILED:
        return {}
    which = 3.0 * (part - PROFILED) / (1.0 - PROFILED)
    if which < 1.0:
        return {"crown_drop": 1e-3 * radius}
    if which < 2.0:
        return {"logarithmic_factor": 1.0}
    return {"end_relief_length": 0.2 * length, "end_relief_depth": 2e-3 * radius}
