"""A contact in series with the seat of a loose pin or sleeve and with the bending of the pin: δ = ε + s(F) + c F, F = f(ε).

A pin that yields along the common normal leaves the place of the contact where it is, so this is exact (docs/theory/seats.md).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray, by_drive
from ltca.beam import PinBeam
from ltca.drive.parts import Drive, Material, PinShaft, PinWheel, WheelPinSeat
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.errors import ConvergenceError
from ltca.laws.conforming import ConformingLaw
from ltca.laws.contact_law import ContactLaw

SLOT_DATUM = 3.0
"""Radius, in radii of the slot, of the circle in the wheel relative to which the displacement of a slot is measured."""
MAX_OVERLAP = 0.6
"""Largest share of a contact's approach that is subtracted as counted twice."""
OVERLAP_SHARPNESS = 8.0
"""Exponent of the smooth bound by `MAX_OVERLAP`: the larger, the sharper its corner."""
MAX_ITERATIONS = 80
"""Newton steps of contact, seat and beam in series."""
SETTLED = 1e-7
"""Last step, relative to the contact's approach, at which they end: loads are accurate to its square."""
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)
HALF_SPACE_DATUM = 0.7
"""Depth, in lengths of the contact, down to which a half-space of finite length counts: 0.68 to 0.72 (docs/theory/seats.md)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BackedLaw(ContactLaw):
    """Contacts of one kind in series with the seats of their pins, or their sleeves, and the bending of these."""

    contact: ContactLaw
    seat: ConformingLaw | None = None
    play: FloatArray = by_drive(1)  # radial, of the seats, mm, shape (pairs,) or (positions, pairs)
    flexibility: float = 0.0  # c of the pin's bending, mm/N
    overlap: float = 0.0  # compliance counted twice, mm/N: of a sleeve below half its wall (`counted_twice`)

    def behind(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return s + c F and its derivative, mm and mm/N."""
        given, slope = self.flexibility * load, np.zeros_like(load) + self.flexibility
        if self.seat is not None:
            approach, compliance = self.seat.approach_and_compliance(load, np.broadcast_to(self.play, load.shape))
            given, slope = given + approach, slope + compliance
        return given, slope

    def counted_twice(self, near: FloatArray, load: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the smoothly bounded part to subtract of the approach of the surfaces, mm, and its derivative by that."""
        if not self.overlap:
            return np.zeros_like(near), np.zeros_like(near)
        most, whole = MAX_OVERLAP * near, self.overlap * np.maximum(load, 1e-300)
        part = (whole / most) ** OVERLAP_SHARPNESS
        bounded = whole * (1.0 + part) ** (-1.0 / OVERLAP_SHARPNESS)
        slope = self.overlap * stiffness / whole + MAX_OVERLAP * part / most
        return bounded, bounded * slope / (1.0 + part)

    def surface(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[ContactLaw, FloatArray]:
        """Return the law of the surfaces in contact and their approach ε, mm; that of open contacts is the whole."""
        return self.contact, self._solve(np.asarray(approach, dtype=float), effective_radius)[0]

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm; zero where open."""
        _, load, stiffness = self._solve(np.asarray(approach, dtype=float), effective_radius)
        return load, stiffness

    def take(self, shape: tuple[int, ...], places: Any) -> BackedLaw:
        """Return the law of some contacts of a batch."""
        play = np.asarray(np.broadcast_to(self.play, shape)[places])
        return replace(self, contact=self.contact.take(shape, places), play=play)

    def _solve(self, delta: FloatArray, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Approach of the surfaces, load, and stiffness of the whole; ConvergenceError where Newton's method does not settle."""
        closed = delta > 0.0
        solved = delta.copy(), np.zeros_like(delta), np.zeros_like(delta)
        if closed.any():
            radius = np.broadcast_to(np.asarray(effective_radius, dtype=float), delta.shape)[closed]
            law = self.take(closed.shape, closed)
            for values, part in zip(solved, law._of_closed(delta[closed], radius), strict=True):
                values[closed] = part
        return solved

    def _of_closed(self, delta: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The same for closed contacts, in a loop of its own that every equilibrium runs, with Halley's step from two slopes."""
        near, last, slope_before = 0.5 * delta, np.zeros_like(delta), np.zeros_like(delta)
        history: list[float] = []
        # Every evaluation moves one of these bounds. The approach may exceed the whole where an overlap is subtracted.
        low, high = np.zeros_like(delta), np.full_like(delta, np.inf)
        for iteration in range(MAX_ITERATIONS):
            load, stiffness = self.contact.load_and_stiffness(near, radius)
            given, slope = self.behind(load)
            off, off_slope = self.counted_twice(near, load, stiffness)
            left, steep = near - off + given - delta, 1.0 - off_slope + stiffness * slope
            high, low = np.where(left > 0.0, near, high), np.where(left < 0.0, near, low)
            step = left / steep
            if iteration:
                bend = np.divide(steep - slope_before, last, out=np.zeros_like(delta), where=last != 0.0)
                step = step / (1.0 - (0.5 * step * bend / steep).clip(-0.3, 0.3))
            following = near - step
            # Next to the root a bound may be wrong by round-off.
            outside = ((following <= 0.0) | (following < low) | (following > high)) & (np.abs(step) > SETTLED * near)
            following = np.where(outside, 0.5 * (low + np.minimum(high, 4.0 * near)), following)
            last, slope_before = following - near, steep
            history.append(float(np.max(np.abs(last) / following)))
            near = following
            if history[-1] < SETTLED:
                # Linearised about the last evaluation: the error is of the square of the step.
                return near, load + stiffness * last, stiffness / steep
        raise ConvergenceError("contact and seat in series do not settle; relative change", history)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ of contact, seat and beam, N·mm."""
        near, load, _ = self._solve(np.asarray(approach, dtype=float), effective_radius)
        held = 0.5 * self.flexibility * load**2
        if self.seat is not None:
            held = held + self.seat.energy(load, np.broadcast_to(self.play, load.shape))
        if self.overlap:
            # ∫ F d(off) = F off − ∫ off dF
            held = held - load * self.counted_twice(near, load, np.zeros_like(load))[0]
            for point, weight in zip(0.5 * (1.0 + GAUSS_POINTS), 0.5 * GAUSS_WEIGHTS, strict=True):
                at = np.maximum(near, 0.0) * point**2
                force, stiffness = self.contact.load_and_stiffness(at, effective_radius)
                off, _ = self.counted_twice(np.maximum(at, 1e-300), force, stiffness)
                held = held + 2.0 * weight * point * np.maximum(near, 0.0) * off * stiffness
        return np.asarray(self.contact.energy(near, effective_radius) + held)


def back_wheel_pins(drive: Drive, contact: ContactLaw, play: FloatArray, depth: float | None = None) -> ContactLaw:
    """Return the law of wheel pins of a drive of one disc, seats and beams behind `contact`, which counts sleeves to `depth`."""
    beam, seat = wheel_pin_beam(drive), wheel_pin_seat(drive)
    if beam is None and seat is None:
        return contact
    overlap = sleeve_overlap(drive, drive.pin_wheel, depth or HALF_SPACE_DATUM * drive.disc.thickness)
    return BackedLaw(contact=contact, seat=seat, play=play, flexibility=own_flexibility(drive, beam), overlap=overlap)


def back_shaft_pins(drive: Drive, contact: ContactLaw, play: FloatArray, depth: float | None = None) -> ContactLaw:
    """Return the law of shaft pins and holes of a drive of one disc, sleeves behind it; `depth` None for springs."""
    seat, shaft = shaft_pin_seat(drive), drive.pin_shaft
    if seat is None or shaft is None:
        return contact
    overlap = 0.0 if depth is None else sleeve_overlap(drive, shaft, depth)
    return BackedLaw(contact=contact, seat=seat, play=play, overlap=overlap)


def _datum(drive: Drive, part: PinWheel | PinShaft) -> float:
    """Depth below which the law of a sleeve begins, mm: half its wall; less in thin discs."""
    wall = part.pin_radius - (part.seat.bore_radius or 0.0)
    return min(0.5 * wall, HALF_SPACE_DATUM * drive.disc.thickness)


def sleeve_overlap(drive: Drive, part: PinWheel | PinShaft, depth: float) -> float:
    """Return the compliance of the sleeve's half-plane from its law's datum to a depth, 2 (1 − ν²) ln(D/d)/(π E L), mm/N."""
    if part.seat.kind != "sleeve":
        return 0.0
    compliance = drive.materials.sleeve.plane_strain_compliance
    return float(2.0 * compliance * np.log(depth / _datum(drive, part)) / (np.pi * drive.disc.thickness))


def shaft_pin_stiffness(drive: Drive) -> float:
    """Return the stiffness of a shaft pin against one disc alone, N/mm: of its spring, or of the beam at the disc's plane."""
    beam = shaft_pin_beam(drive)
    return drive.hole_stiffness if beam is None else 1.0 / own_flexibility(drive, beam)


def tip_motion(drive: Drive) -> dict[str, Any]:
    """Return `tip_share` and `tip_slope` of `ltca.geometry.pairs.ContactGeometry`, the latter in slices; nothing without ring."""
    beam = shaft_pin_beam(drive)
    if beam is None or beam.ends[1] == "free":
        return {}
    share, slope = beam.tip_shape(from_start(beam, drive).tolist(), drive.disc.thickness, slopes=True)[:2]
    return {"tip_share": float(share), "tip_slope": 0.0 if drive.contact.slices == 1 else float(slope)}


def own_flexibility(drive: Drive, beam: PinBeam | None) -> float:
    """Return the deflection of the pin of a drive of one disc under unit load of that disc alone, mm/N; 0 without beam."""
    return (
        0.0 if beam is None else float(beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)[0, 0])
    )


def shaft_pin_seat(drive: Drive) -> ConformingLaw | None:
    """Return the law of the sleeves on the shaft pins of a drive of one disc; None without sleeves."""
    return None if drive.pin_shaft is None else _seat(drive, drive.pin_shaft, drive.materials.shaft_pin)


def wheel_pin_seat(drive: Drive) -> ConformingLaw | None:
    """Return the law of the wheel pins in their slots, or of their sleeves, of a drive of one disc; None for fixed pins."""
    return _seat(drive, drive.pin_wheel, drive.materials.wheel_pin)


def _seat(drive: Drive, part: PinWheel | PinShaft, pin: Material) -> ConformingLaw | None:
    """Law of pins of a material in slots of the wheel, or in sleeves."""
    seat, length = part.seat, drive.disc.thickness
    if isinstance(seat, WheelPinSeat) and seat.kind == "slot":
        radius = seat.radius or 0.0
        return ConformingLaw.of_bodies(
            pin=pin,
            bore=drive.materials.wheel_seat,
            pin_radius=part.pin_radius,
            bore_radius=radius,
            datum_radius=SLOT_DATUM * radius,
            length=length,
        )
    if seat.kind == "fixed":
        return None
    return ConformingLaw.of_sleeve(
        pin=pin,
        sleeve=drive.materials.sleeve,
        pin_radius=seat.pin_radius or 0.0,
        bore_radius=seat.bore_radius or 0.0,
        outer_radius=part.pin_radius,
        datum=_datum(drive, part),
        length=length,
    )
