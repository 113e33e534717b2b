r"""A contact backed by what carries its part: the seat of a loose pin or sleeve, and the bending of the pin.

Contact, seat and beam carry the same load F in series,

.. math:: \delta = \epsilon + s(F) + c F, \qquad F = f(\epsilon),

with the contact's own law f, the approach s of the seat and the flexibility c of the pin. A pin that yields along the common
normal leaves the place of the contact where it is, so this is exact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.arrays import FloatArray, by_drive
from ltca.drive.parts import Drive, PinShaft, PinWheel
from ltca.errors import ConvergenceError
from ltca.laws.beam import End, PinBeam
from ltca.laws.conforming import ConformingLaw
from ltca.laws.contact_law import ContactLaw, EnergyLaw
from ltca.laws.series import SpringLaw

SLOT_DATUM = 3.0
"""Radius, in radii of the slot, of the circle in the wheel against which a slot's yielding is measured."""
MOST, SHARPNESS = 0.6, 8.0
"""Part of a contact's approach that may be taken off, and how sharply what is more is bounded."""
NEAR = 1e-7
"""Last step, as a part of the contact's own approach, of contacts in series: loads are right to its square."""
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(16)
HALF_SPACE_DATUM = 0.7
"""Depth, in lengths of the contact, down to which a half-space of finite length counts: 0.68 to 0.72 (docs/theory/seats.md)."""


class SeatLaw(Protocol):
    """Law of a round part in a bore that is a little wider."""

    def approach_and_compliance(self, load: FloatArray, play: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N, for bores wider by `play` in radius, mm."""
        ...

    def energy(self, load: FloatArray, play: FloatArray) -> FloatArray:
        """Return ∫ F ds up to a load, N·mm."""
        ...

    def half_angle(self, load: FloatArray, play: FloatArray) -> FloatArray:
        """Return half the angle of the arc under pressure, rad."""
        ...

    def largest_pressure(self, load: FloatArray, play: FloatArray) -> FloatArray:
        """Return the largest pressure, MPa."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class BackedLaw:
    """Contacts of one kind with what is behind each.

    Attributes
    ----------
    contact : EnergyLaw
        Of the contact itself.
    seat : SeatLaw or None
        What the seats yield.
    play : array
        Play of each seat, shape (pairs,) or (positions, pairs), mm.
    flexibility : float
        c of the pin's bending, mm/N; drives of one batch have the same.
    overlap : float
        What the contact's law counts of a sleeve below half its wall, where the sleeve's own law begins, mm/N: it is taken
        off, up to `MOST` of the contact's approach. Where it would be more the contact is as wide as the wall, and no law holds.
    """

    contact: EnergyLaw
    seat: SeatLaw | None
    play: FloatArray = by_drive(1)
    flexibility: float = 0.0
    overlap: float = 0.0

    def behind(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return s + c F and its derivative, mm and mm/N."""
        given, slope = self.flexibility * load, np.zeros_like(load) + self.flexibility
        if self.seat is not None:
            approach, compliance = self.seat.approach_and_compliance(load, np.broadcast_to(self.play, load.shape))
            given, slope = given + approach, slope + compliance
        return given, slope

    def counted_twice(self, near: FloatArray, load: FloatArray, stiffness: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what is taken off the approach of a contact, mm, and its derivative by that: bounded smoothly."""
        if not self.overlap:
            return np.zeros_like(near), np.zeros_like(near)
        most, whole = MOST * near, self.overlap * np.maximum(load, 1e-300)
        part = (whole / most) ** SHARPNESS
        bounded = whole * (1.0 + part) ** (-1.0 / SHARPNESS)
        slope = self.overlap * stiffness / whole + MOST * part / most
        return bounded, bounded * slope / (1.0 + part)

    def contact_approach(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the approach ε of the contacts themselves; that of open ones is the whole, mm.

        Raises
        ------
        ConvergenceError
            When Newton's method does not settle.
        """
        return self._solve(np.asarray(approach, dtype=float), effective_radius)[0]

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm; zero where open."""
        _, load, stiffness = self._solve(np.asarray(approach, dtype=float), effective_radius)
        return load, stiffness

    def _solve(self, delta: FloatArray, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Contact approach, load, and stiffness of the whole."""
        closed = delta > 0.0
        found = delta.copy(), np.zeros_like(delta), np.zeros_like(delta)
        if closed.any():
            radius = np.broadcast_to(np.asarray(effective_radius, dtype=float), delta.shape)[closed]
            for all_pairs, part in zip(found, self._of_pairs(closed)._of_closed(delta[closed], radius), strict=True):
                all_pairs[closed] = part
        return found

    def _of_pairs(self, chosen: NDArray[np.bool_]) -> BackedLaw:
        """Law of some pairs of some positions, as one row."""

        def of(values: float | FloatArray) -> FloatArray:
            return np.asarray(np.broadcast_to(values, chosen.shape)[chosen])

        law = self.contact
        if isinstance(law, SpringLaw) and isinstance(law.stiffness, np.ndarray):
            law = SpringLaw(stiffness=of(law.stiffness))
        return replace(self, contact=law, play=of(self.play))

    def _of_closed(self, delta: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The same of closed pairs: Newton's method between bounds, with the bend of the last two slopes (Halley)."""
        near, last, slope_before = 0.5 * delta, np.zeros_like(delta), np.zeros_like(delta)
        history: list[float] = []
        # The approach lies between these two, and every evaluation moves one of them. It may be more than the whole where
        # something is taken off.
        low, high = np.zeros_like(delta), np.full_like(delta, np.inf)
        for iteration in range(80):
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
            # Next to the root round-off may have taken it for a bound.
            outside = ((following <= 0.0) | (following < low) | (following > high)) & (np.abs(step) > NEAR * near)
            following = np.where(outside, 0.5 * (low + np.minimum(high, 4.0 * near)), following)
            last, slope_before = following - near, steep
            history.append(float(np.max(np.abs(last) / following)))
            near = following
            if history[-1] < NEAR:
                # A tangent's length away from there: what is left is its square.
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

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the largest pressure of the contacts at mid-width, MPa."""
        return self.known_contact.mid_pressure(self.contact_approach(approach, effective_radius), effective_radius)

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the contact half-width at mid-width, mm."""
        return self.known_contact.half_width(self.contact_approach(approach, effective_radius), effective_radius)

    @property
    def outside(self) -> EnergyLaw:
        """The law of the contact down to half the wall of a sleeve: overlap taken off, nothing behind."""
        return replace(self, seat=None, flexibility=0.0) if self.overlap else self.contact

    @property
    def known_contact(self) -> ContactLaw:
        """The law of the contact itself, that knows its pressures; TypeError where it knows loads alone."""
        if not isinstance(self.contact, ContactLaw):
            raise TypeError("the law of the contacts knows loads alone, no pressures")
        return self.contact


def of_pairs(law: EnergyLaw, chosen: NDArray[np.intp]) -> EnergyLaw:
    """Return the law of some pairs of one drive, shape (positions, chosen)."""
    return replace(law, play=law.play[chosen]) if isinstance(law, BackedLaw) else law


def back_wheel_pins(drive: Drive, contact: ContactLaw, play: FloatArray, depth: float | None = None) -> ContactLaw:
    """Return the law of the wheel pins of a drive of one disc with what is behind them.

    Parameters
    ----------
    drive : Drive
        Of one disc, at its own plane (`ltca.drive.single_discs`).
    contact : ContactLaw
        Of pins, or their sleeves, and flank.
    play : array, shape (z_P,) or (positions, z_P)
        Of each in its seat, mm.
    depth : float, optional
        Down to which `contact` counts a sleeve, mm; that of a half-space as long as the disc is thick by default.

    Returns
    -------
    ContactLaw
        That of the contact itself for fixed pins that do not bend.
    """
    beam, seat = wheel_pin_beam(drive), wheel_pin_seat(drive)
    if beam is None and seat is None:
        return contact
    overlap = 0.0
    if drive.pin_wheel.seat.kind == "sleeve":
        overlap = _overlap(drive, drive.pin_wheel, depth or HALF_SPACE_DATUM * drive.disc.thickness)
    return BackedLaw(contact=contact, seat=seat, play=play, flexibility=own_flexibility(drive, beam), overlap=overlap)


def back_shaft_pins(drive: Drive, contact: EnergyLaw, play: FloatArray, depth: float | None = None) -> EnergyLaw:
    """Return the law of shaft pins and holes with the sleeves behind it.

    Parameters
    ----------
    drive : Drive
        Of one disc.
    contact : EnergyLaw
        Of pins, or their sleeves, and holes.
    play : array, shape (z_PS,) or (positions, z_PS)
        Of the sleeves on their pins, mm.
    depth : float, optional
        Down to which `contact` counts a sleeve, mm; nowhere by default, where a spring stands for all outside.
    """
    seat, shaft = shaft_pin_seat(drive), drive.pin_shaft
    if seat is None or shaft is None:
        return contact
    overlap = 0.0 if depth is None else _overlap(drive, shaft, depth)
    return BackedLaw(contact=contact, seat=seat, play=play, overlap=overlap)


def _datum(drive: Drive, part: PinWheel | PinShaft) -> float:
    """Depth below which the law of a sleeve itself begins, mm: half its wall, from where on any yields; less in thin discs."""
    wall = part.pin_radius - (part.seat.bore_radius or 0.0)
    return min(0.5 * wall, HALF_SPACE_DATUM * drive.disc.thickness)


def _overlap(drive: Drive, part: PinWheel | PinShaft, depth: float) -> float:
    """What a half-plane of the sleeve yields between that depth and another, 2 (1 − ν²) ln(D/d)/(π E L), mm/N."""
    compliance = drive.materials.sleeve.plane_strain_compliance
    return float(2.0 * compliance * np.log(depth / _datum(drive, part)) / (np.pi * drive.disc.thickness))


def shaft_pin_stiffness(drive: Drive) -> float:
    """Return the stiffness of a shaft pin against one disc alone, N/mm: of its spring, or of the beam at the disc's plane."""
    beam = shaft_pin_beam(drive)
    return drive.hole_stiffness if beam is None else 1.0 / own_flexibility(drive, beam)


def wheel_pin_beam(drive: Drive) -> PinBeam | None:
    """Return a wheel pin as a beam, its middle at the zero of the planes; None where it does not bend."""
    wheel = drive.pin_wheel
    if wheel.beam is None:
        return None
    material = drive.materials.wheel_pin
    return PinBeam(
        span=wheel.beam.span,
        ends=(wheel.beam.ends, wheel.beam.ends),
        diameter=wheel.beam_diameter,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
    )


def shaft_pin_beam(drive: Drive) -> PinBeam | None:
    """Return a shaft pin as a beam, its middle at the zero of the planes; None where it is a spring or there is none."""
    shaft = drive.pin_shaft
    if shaft is None or shaft.beam is None:
        return None
    tips: dict[str, End] = {"free": "free", "tied-clamped": "clamped", "tied-pinned": "supported"}
    material = drive.materials.shaft_pin
    return PinBeam(
        span=shaft.beam.span,
        ends=("clamped", tips[shaft.beam.tip]),
        diameter=shaft.beam_diameter,
        youngs_modulus=material.youngs_modulus,
        poisson_ratio=material.poisson_ratio,
    )


def tip_share(drive: Drive) -> float:
    """Return how far a shaft pin moves at the disc of a drive of one disc where a ring moves its tip by one; 0 without ring."""
    beam = shaft_pin_beam(drive)
    if beam is None or beam.ends[1] == "free":
        return 0.0
    return float(beam.tip_shape(from_start(beam, drive).tolist(), drive.disc.thickness)[0])


def from_start(beam: PinBeam, drive: Drive) -> FloatArray:
    """Return the planes of the discs from the start of a beam whose middle is at their zero, mm."""
    return np.asarray(drive.disc.disc_planes) + 0.5 * beam.span


def own_flexibility(drive: Drive, beam: PinBeam | None) -> float:
    """Return what the pin of a drive of one disc yields by that disc alone, mm/N; 0 for no beam."""
    if beam is None:
        return 0.0
    return float(beam.flexibility(from_start(beam, drive).tolist(), drive.disc.thickness)[0, 0])


def shaft_pin_seat(drive: Drive) -> ConformingLaw | None:
    """Return the law of the sleeves on the shaft pins of a drive of one disc; None without sleeves."""
    shaft, parts = drive.pin_shaft, drive.materials
    if shaft is None or shaft.seat.kind == "fixed":
        return None
    return ConformingLaw.of_sleeve(
        pin=parts.shaft_pin,
        sleeve=parts.sleeve,
        pin_radius=shaft.seat.pin_radius or 0.0,
        bore_radius=shaft.seat.bore_radius or 0.0,
        outer_radius=shaft.pin_radius,
        datum=_datum(drive, shaft),
        length=drive.disc.thickness,
    )


def wheel_pin_seat(drive: Drive) -> ConformingLaw | None:
    """Return the law of the wheel pins in their slots, or of their sleeves, of a drive of one disc; None for fixed pins."""
    wheel, parts, length = drive.pin_wheel, drive.materials, drive.disc.thickness
    if wheel.seat.kind == "slot":
        radius = wheel.seat.radius or 0.0
        return ConformingLaw.of_bodies(
            pin=parts.wheel_pin,
            bore=parts.wheel_seat,
            pin_radius=wheel.pin_radius,
            bore_radius=radius,
            datum_radius=SLOT_DATUM * radius,
            length=length,
        )
    if wheel.seat.kind == "sleeve":
        return ConformingLaw.of_sleeve(
            pin=parts.wheel_pin,
            sleeve=parts.sleeve,
            pin_radius=wheel.seat.pin_radius or 0.0,
            bore_radius=wheel.seat.bore_radius or 0.0,
            outer_radius=wheel.pin_radius,
            datum=_datum(drive, wheel),
            length=length,
        )
    return None
