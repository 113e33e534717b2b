"""Kinds of contacts of a drive, and the separation of their surfaces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.contact.free_end import FreeEnds, free_ends_of
from ltca.drive.hole_contact import hole_modulus
from ltca.drive.parts import Disc, Drive, Material, contact_modulus
from ltca.geometry.length_profile import Relief, generator_profile, has_lead, lead_relief

Departure = Callable[[FloatArray], FloatArray]

CELLS = 12

END_STRETCH = 0.01
"""Fraction of the length over which the largest pressure is averaged, see `ltca.contact.end_pressure`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactKind:
    """Data shared by all contacts of one kind."""

    length: float  # of the contact line, mm
    contact_modulus: float  # E*, MPa
    generator: Relief | None = None  # crown and relief along the length; None where straight
    symmetric: bool = True  # whether the separation is even along the profile (circles) or not (flanks)
    cells: int = CELLS  # over the half-width and over half the length
    lead: Disc | None = None  # whose flank has a lead; None where straight
    free_ends: tuple[FreeEnds, ...] = ()  # of the bodies, for the law in slices; none of half-spaces

    def aligned_relief(self, z: ArrayLike) -> FloatArray:
        """Return by how much the profile alone falls short at heights above mid-width, mm."""
        height = np.asarray(z, dtype=float)
        return np.zeros(height.shape) if self.generator is None else self.generator.relief(height)

    def relief(self, z: ArrayLike) -> FloatArray:
        """Return by how much profile and lead fall short at heights above mid-width, mm."""
        relief = self.aligned_relief(z)
        return relief if self.lead is None else relief + lead_relief(self.lead, np.asarray(z, dtype=float))

    @property
    def end_cell(self) -> float:
        """Length over which the largest pressure is averaged, mm: at an unrelieved end the pressure is singular."""
        return END_STRETCH * self.length


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactKinds:
    """The kinds of half-space contacts of a drive: flank and pins, rollers on the inner race and in the bore, holes."""

    pins: ContactKind
    inner: ContactKind
    outer: ContactKind
    holes: ContactKind

    @classmethod
    def of_drive(cls, drive: Drive, cells: int = CELLS) -> ContactKinds:
        """Return the kinds of contact of a drive, with `cells` over each half-width and over half of each length."""
        bearing, wheel, parts, wide = drive.crank_bearing, drive.pin_wheel, drive.materials, drive.disc.thickness
        roller = generator_profile(bearing.roller_profile, drive.roller_length, bearing.roller_radius)

        def kind(length: float, bodies: tuple[Material, Material], **own: Any) -> ContactKind:
            return ContactKind(length=length, contact_modulus=contact_modulus(*bodies), cells=cells, **own)

        pin = generator_profile(wheel.pin_profile, wide, wheel.pin_radius)
        lead = drive.disc if has_lead(drive.disc) else None
        return cls(
            pins=kind(wide, (parts.disc, drive.flank_pin), generator=pin, symmetric=False, lead=lead),
            inner=kind(drive.roller_length, (parts.inner_race, parts.roller), generator=roller),
            outer=kind(drive.roller_length, (parts.disc, parts.roller), generator=roller),
            holes=kind(wide, (parts.disc, drive.hole_pin)),
        )

    def with_free_ends(self, drive: Drive, *, rigid_shaft_pins: bool) -> ContactKinds:
        """Return the kinds with the ends of their bodies; pins are as long as their beams, or as wide as the disc."""
        parts, wide, long = drive.materials, drive.disc.thickness, drive.roller_length
        wheel, shaft = drive.pin_wheel, drive.pin_shaft
        disc, flank_pin, hole_pin = (wide, parts.disc), (wide, drive.flank_pin), (wide, drive.hole_pin)
        if wheel.beam is not None:
            flank_pin = (_length_about(drive, drive.wheel_pin_span), drive.flank_pin)
        if shaft is not None and shaft.beam is not None:
            hole_pin = (_length_about(drive, drive.shaft_pin_span), drive.hole_pin)
        # What is under a sleeve has no part in the contact, and slices of a sleeve do not feel each other.
        sleeved = wheel.seat.kind == "sleeve", shaft is not None and shaft.seat.kind == "sleeve"

        def ending(kind: ContactKind, modulus: float, *bodies: tuple[float, Material] | None) -> ContactKind:
            given = [(own, part.plane_strain_compliance, part.poisson_ratio) for own, part in filter(None, bodies)]
            return replace(kind, free_ends=free_ends_of(kind.length, 1.0 / modulus, given))

        in_holes = hole_modulus(drive, rigid_shaft_pins=rigid_shaft_pins)
        return ContactKinds(
            pins=ending(self.pins, self.pins.contact_modulus, disc, None if sleeved[0] else flank_pin),
            inner=ending(self.inner, self.inner.contact_modulus, (wide, parts.inner_race), (long, parts.roller)),
            outer=ending(self.outer, self.outer.contact_modulus, disc, (long, parts.roller)),
            holes=ending(self.holes, in_holes, disc, None if rigid_shaft_pins or sleeved[1] else hole_pin),
        )


def _length_about(drive: Drive, span: float) -> float:
    """Length of a pin of a span that is as long to either side of the disc as to the nearer one, mm."""
    return span - 2.0 * float(np.max(np.abs(drive.disc.disc_planes)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Separation:
    """Separation of two surfaces about the point where they touch, interpolated between one of some fixed places and the next."""

    effective_radius: float  # ρ, mm, by which the width is expected
    departure: Callable[[int, FloatArray], FloatArray]  # at a numbered place, over the distance along the tangent, mm
    place: int = 0
    part: float = 0.0  # fraction of the way from `place` to the next one

    @property
    def weights(self) -> FloatArray:
        """Weights of the one or two places."""
        return np.array([1.0 - self.part, self.part]) if self.part > 0.0 else np.ones(1)
