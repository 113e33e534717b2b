"""Reducers of all kinds (`crank_drives`) with loose, sleeved or bending pins, or with friction.

Plain choices are frequent: fixed pins, equal plays, a beam just as long as the discs need, a diameter that is given although
it is that of the pin. With friction (`friction_drive`) pins do not bend.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.random import Generator

from ltca.drive.materials import Material
from ltca.drive.members.pins import PinShaft, PinWheel, ShaftPinBeam, ShaftPinSeat, WheelPinBeam, WheelPinSeat
from ltca.drive.parts import Drive, Friction
from ltca.reading.physical_checks import is_sound
from ltca.testing.crank_drives import crank_drive, with_carrier
from ltca.testing.practical_drives import with_ring
from ltca.testing.random_drives import with_width
from ltca.testing.yielding_pins import beam_stiffness

PLAYS = (0.001, 0.004, 0.01, 0.01, 0.02, 0.05)
"""Radial plays, mm."""
COEFFICIENTS = (0.0, 0.0, 0.01, 0.03, 0.05, 0.05, 0.08, 0.1, 0.15)
"""Usual values of μ of joints."""
OTHERS = (
    Material(),
    Material(),
    Material(youngs_modulus=110e3, poisson_ratio=0.34),
    Material(youngs_modulus=2.6e3, poisson_ratio=0.38),
)
"""Materials of slots and sleeves: steel, bronze or plastic."""
SOFTEST = 1.0
"""Largest deflection of a pin when a quarter of all carry the torque of a disc, in eccentricities: teeth slip where pins move
by more than half their height."""


def pin_drive(seed: int) -> tuple[Drive, float]:
    """Return a reducer of any kind with seats and beams of its pins, and a crank angle in rad, by a seed (not negative).

    Wheel pins are fixed, loose in slots or under sleeves, shaft pins fixed or under sleeves; either kind is rigid or bends.
    """
    random, of_carrier = np.random.default_rng((seed, 3)), np.random.default_rng((seed, 6))
    while True:
        number = int(random.integers(2**32))
        drive, angle = crank_drive(number)
        drive = replace(drive, ring=None)  # drawn again around the pins as they sit
        play = float(random.choice(PLAYS))
        drive = replace(drive, pin_wheel=_bent_wheel_pins(random, drive, _seated_wheel_pins(random, drive, play)))
        if drive.pin_shaft is not None:
            # Plays of both kinds are equal as often as not.
            play = play if random.uniform() < 0.5 else float(random.choice(PLAYS))
            drive = replace(drive, pin_shaft=_bent_shaft_pins(random, drive, _seated_shaft_pins(random, drive, play)))
        drive = _made_of(random, drive)
        drive = drive if drive.carrier is not None else with_carrier(of_carrier, drive)
        if largest_deflection(drive) < SOFTEST * drive.crank.eccentricity and is_sound(drive):
            return with_ring(number, drive), angle


def sloping_drive(seed: int) -> tuple[Drive, float]:
    """Return a reducer of any kind with contacts in slices, leads and inclinations, and a crank angle in rad, by a seed.

    Its pins bend or are rigid, cranks stand on bearings that yield, and half of the main bearings yield in tilt. Pins are fixed,
    the ring of the wheel and the carrier rigid, and first stages without teeth.
    """
    return _in_slices(seed, seated=False)


def seated_drive(seed: int) -> tuple[Drive, float]:
    """Return the same with wheel pins loose in slots or under sleeves, shaft pins under sleeves, or both."""
    return _in_slices(seed, seated=True)


def _in_slices(seed: int, *, seated: bool) -> tuple[Drive, float]:
    random = np.random.default_rng((seed, 32 if seated else 31))
    while True:
        number = int(random.integers(2**32))
        drive, angle = pin_drive(number)
        wheel, shaft, bearing, materials = drive.pin_wheel, drive.pin_shaft, drive.main_bearing, drive.materials
        installation = drive.installation
        if drive.first_stage is not None and installation.first_stage_ratio is None:
            installation = replace(installation, first_stage_ratio=drive.first_stage.ratio)
        if not seated:
            wheel, materials = (
                replace(wheel, seat=WheelPinSeat()),
                replace(materials, wheel_seat=Material(), sleeve=Material()),
            )
            shaft = None if shaft is None else replace(shaft, seat=ShaftPinSeat())
        if bearing is not None and not bearing.bearings and random.uniform() < 0.5:
            arm = drive.pin_wheel.pin_circle_radius * float(random.choice([0.3, 1.0]))
            radial = bearing.radial_stiffness or wheel.support_stiffness or 0.0
            bearing = replace(bearing, tilt_stiffness=radial * arm**2)
        drive = replace(
            drive, pin_wheel=wheel, pin_shaft=shaft, main_bearing=bearing, installation=installation, materials=materials,
            ring=None, carrier=None, first_stage=None,
        )  # fmt: skip
        drive = with_width(number, drive)
        seats = {wheel.seat.kind, "fixed" if shaft is None else shaft.seat.kind}
        if is_sound(drive) and (not seated or seats != {"fixed"}):
            return drive, angle


def friction_drive(seed: int) -> tuple[Drive, float]:
    """Return a reducer of any kind with friction in its joints, and a crank angle in rad, by a seed (not negative).

    Wheel pins are fixed, loose in slots or under sleeves, shaft pins fixed or under sleeves, none of them beams; the drive
    is driven by its input or its output.
    """
    random = np.random.default_rng((seed, 4))
    while True:
        number = int(random.integers(2**32))
        drive, angle = crank_drive(number)
        drive = replace(drive, ring=None)  # drawn again around the pins as they sit
        play = float(random.choice(PLAYS))
        drive = replace(drive, pin_wheel=_seated_wheel_pins(random, drive, play))
        if drive.pin_shaft is not None:
            drive = replace(drive, pin_shaft=_seated_shaft_pins(random, drive, play))
        drive = _made_of(random, drive)
        seats = {drive.pin_wheel.seat.kind, "fixed" if drive.pin_shaft is None else drive.pin_shaft.seat.kind}
        # All coefficients are equal as often as not.
        pin, seat, hole = (
            random.choice(COEFFICIENTS, 3) if random.uniform() < 0.5 else [random.choice(COEFFICIENTS)] * 3
        )
        turning = float(random.choice([0.0, 0.002]))
        friction = Friction(
            pin=float(pin),
            seat=0.0 if seats == {"fixed"} else float(seat),
            hole=0.0 if drive.pin_shaft is None else float(hole),
            roller=float(random.choice([0.0, 0.001, 0.0015])),
            support_bearing=turning,
            support_bearing_radius=_bearing_radius(drive) if turning else 0.0,
            no_load_torque=float(random.choice([0.0, 50.0])),
        )
        driven: Any = str(random.choice(["input", "output"]))
        speed = [None, 1500.0][int(random.integers(2))]
        drive = replace(drive, friction=friction, load=replace(drive.load, driven_by=driven, speed=speed))
        if is_sound(drive):
            return with_ring(number, drive), angle


def _bearing_radius(drive: Drive) -> float:
    """Radius of the inner races, rounded to a millimetre."""
    return max(round(drive.crank_bearing.inner_race_radius), 1.0)


def largest_deflection(drive: Drive) -> float:
    """Return the largest deflection of bending pins when a quarter of them carry the torque of a disc, mm."""
    discs, found = drive.disc.number_of_discs, [0.0]
    wheel, shaft, materials = drive.pin_wheel, drive.pin_shaft, drive.materials
    at_wheel = drive.crank.eccentricity * wheel.number_of_pins
    for part, moment, lever, material in (
        (wheel, drive.wheel_moment(), at_wheel, materials.wheel_pin),
        (shaft, drive.load.torque, shaft.pin_circle_radius if shaft else 1.0, materials.shaft_pin),
    ):
        stiffness = None if part is None else beam_stiffness(drive, part, material)
        if part is not None and stiffness is not None:
            yielding = np.max(np.diagonal(np.linalg.inv(stiffness[:discs, :discs])))
            found.append(float(yielding) * 4.0 * abs(moment) / (lever * discs * part.number_of_pins))
    return max(found)


def _inner(random: Generator, radius: float) -> float:
    """Radius of the pin under a sleeve, rounded."""
    step = 0.25 if radius > 1.0 else 0.05
    return max(round(float(random.choice([0.5, 0.6, 0.75])) * radius / step), 1) * step


def _seated_wheel_pins(random: Generator, drive: Drive, play: float) -> PinWheel:
    wheel = drive.pin_wheel
    play = min(play, 0.2 * drive.crank.eccentricity)
    kind: Any = str(random.choice(["fixed", "slot", "sleeve"]))
    seat = WheelPinSeat()
    if kind == "slot":
        seat = WheelPinSeat(kind=kind, radius=wheel.pin_radius + play)
    elif kind == "sleeve":
        pin = _inner(random, wheel.pin_radius)
        seat = WheelPinSeat(kind=kind, pin_radius=pin, bore_radius=pin + play)
    wheel = replace(wheel, seat=seat)
    if random.uniform() < 0.3:
        size = min(0.004, 0.002 * wheel.pin_radius, *([0.5 * play] if kind == "slot" else []))
        scatter = size * random.choice([-1.0, 0.0, 0.0, 0.5, 1.0], wheel.number_of_pins)
        wheel = replace(wheel, pin_errors=replace(wheel.pin_errors, diameter=tuple(scatter.tolist())))
    return wheel


def _seated_shaft_pins(random: Generator, drive: Drive, play: float) -> PinShaft:
    shaft = drive.pin_shaft
    assert shaft is not None
    if random.uniform() < 0.5:
        return shaft
    play = min(play, 0.2 * drive.crank.eccentricity)
    pin = _inner(random, shaft.pin_radius)
    return replace(shaft, seat=ShaftPinSeat(kind="sleeve", pin_radius=pin, bore_radius=pin + play))


def _span(random: Generator, drive: Drive) -> float:
    """Span that the discs need, or a longer one."""
    reach = 2.0 * max(abs(plane) for plane in drive.disc.disc_planes) + drive.disc.thickness
    return reach * float(random.choice([1.0, 1.0, 1.25, 2.0]))


def _diameter(random: Generator, part: PinWheel | PinShaft) -> float | None:
    """Diameter left out, that of the pin, or less, for a pin that is thinner between its ends."""
    own = 2.0 * (part.seat.pin_radius or part.pin_radius)
    return [None, own, 0.8 * own][int(random.integers(3))]


def _bent_wheel_pins(random: Generator, drive: Drive, wheel: PinWheel) -> PinWheel:
    if random.uniform() < 0.4:
        return wheel
    ends: Any = str(random.choice(["supported", "clamped"]))
    beam = WheelPinBeam(span=_span(random, drive), ends=ends, diameter=_diameter(random, wheel))
    return replace(wheel, beam=beam)


def _bent_shaft_pins(random: Generator, drive: Drive, shaft: PinShaft) -> PinShaft:
    if random.uniform() < 0.3:
        return shaft
    tip: Any = str(random.choice(["free", "tied-clamped", "tied-pinned"]))
    beam = ShaftPinBeam(span=_span(random, drive), tip=tip, diameter=_diameter(random, shaft))
    return replace(shaft, beam=beam, stiffness=None)


def _made_of(random: Generator, drive: Drive) -> Drive:
    """The drive with materials of slots and sleeves."""
    materials, shaft = drive.materials, drive.pin_shaft
    slot, sleeve = (OTHERS[int(random.integers(len(OTHERS)))] for _ in range(2))
    kinds = {drive.pin_wheel.seat.kind, "fixed" if shaft is None else shaft.seat.kind}
    if "slot" in kinds:
        materials = replace(materials, wheel_seat=slot)
    if "sleeve" in kinds:
        materials = replace(materials, sleeve=sleeve)
    return replace(drive, materials=materials)
