"""Half-space compliance: pairs that do not feel each other (the paper's model)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance import sliced
from ltca.compliance.pressures import pressures_in_plane, pressures_in_slices
from ltca.compliance.response import ContactPressures, DiscContacts, DiscResponse
from ltca.contact.contact_kind import ContactKind, ContactKinds
from ltca.drive.hole_contact import hole_modulus, shaft_pins_yield
from ltca.drive.parts import Drive, LengthProfile, PinShaft, PinWheel
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.geometry.flank import FlankProfile
from ltca.geometry.length_profile import lead_relief
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import (
    HALF_SPACE_DATUM,
    back_shaft_pins,
    back_wheel_pins,
    shaft_pin_seat,
    shaft_pin_stiffness,
    sleeve_overlap,
    tip_motion,
    wheel_pin_seat,
)
from ltca.laws.line_contact import LineContactLaw
from ltca.laws.profiled_line_contact import law_for_profile
from ltca.laws.spring import SpringLaw

SAMPLES_PER_LOBE = 180
"""Stations on a lobe at which the range of effective radii is searched."""
REFINEMENTS = 3
"""Searches for that range, each about the last extreme: a tip close to undercut is sharper than a lobe's 180th part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfSpaceCompliance(DiscContacts):
    """Half-space laws for pins and rollers, springs for the pin holes (the paper's model)."""

    coefficients: ClassVar[None] = None

    @classmethod
    def of_drive(
        cls, drive: Drive, *, in_batch: bool = False, kinds: ContactKinds | None = None
    ) -> HalfSpaceCompliance:
        """Return the half-space model of a drive of one disc; in a batch tables of profiled parts are on a ladder of radii."""
        geometry = replace(ContactGeometry.of_drive(drive), **tip_motion(drive))
        place, bearing, wheel, slices = geometry.placement, drive.crank_bearing, drive.pin_wheel, drive.contact.slices
        kinds, rigid, pin_radii = kinds or ContactKinds.of_drive(drive), False, np.ones(1)
        if slices == 1 and not wheel.pin_profile.is_cylinder:
            # A flank without deviations has the same radii on every lobe.
            lobes = 1 if geometry.profile.deviation is None else wheel.number_of_pins
            turn = np.linspace(0.0, 2.0 * np.pi * lobes / wheel.number_of_pins, SAMPLES_PER_LOBE * lobes + 1)
            pin_radii = _effective_radii(geometry.profile, place.wheel_pin_radii, turn)

        def law(
            kind: ContactKind, profile: LengthProfile, radius: float, radii: FloatArray, part: PinWheel | None = None
        ) -> Any:
            if slices > 1:
                return _line(drive, kind, part)
            return law_for_profile(
                profile,
                length=kind.length,
                radius=radius,
                contact_modulus=kind.contact_modulus,
                effective_radii=radii,
                on_ladder=in_batch,
            )

        def rollers(kind: ContactKind, radii: FloatArray) -> Any:
            return law(kind, bearing.roller_profile, bearing.roller_radius, radii)

        pins = law(kinds.pins, wheel.pin_profile, wheel.pin_radius, pin_radii, wheel)
        pins = behind_wheel_pins(drive, pins, place.wheel_pin_plays)
        if slices > 1:
            # The law has the lead, in which drives of a batch may differ.
            kinds = replace(kinds, pins=replace(kinds.pins, lead=None))
        if slices > 1 and shaft_pin_beam(drive) is not None:
            # A beam bends behind its contact, which says how its load lies along the width.
            rigid = not shaft_pins_yield(drive)
            modulus = hole_modulus(drive, rigid_shaft_pins=rigid)
            kinds = replace(kinds, holes=replace(kinds.holes, contact_modulus=modulus))
            hole = hole_in_slices(drive, kinds.holes, place.shaft_pin_plays)
        else:
            hole = shaft_pin_springs(drive, place.shaft_pin_plays)
        return cls(
            geometry=geometry,
            pin_law=pins,
            outer_law=rollers(kinds.outer, place.outer_effective_radii),
            inner_law=rollers(kinds.inner, place.inner_effective_radii),
            hole_law=hole,
            kinds=kinds,
            rigid_shaft_pins=rigid,
        )

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the laws, those of the shaft pins from their loads."""
        place, kinds, rollers = self.geometry.placement, self.kinds, response.rollers
        if response.leaning_pins is not None:
            spring = isinstance(getattr(self.hole_law, "contact", self.hole_law), sliced.SeparateSlices)
            return pressures_in_slices(
                response, kinds, place, rigid_shaft_pins=self.rigid_shaft_pins, shaft_pins_on_springs=spring
            )
        holes = LineContactLaw(kinds.holes.length, kinds.holes.contact_modulus)
        contacts, pins = replace(self, hole_law=holes), response.flank.approach
        return pressures_in_plane(contacts, response, pins, rollers.outer_approach, rollers.inner_approach)


def _line(drive: Drive, kind: ContactKind, part: PinWheel | PinShaft | None = None) -> Any:
    """Law in slices of a kind of contacts with its relief, that of wheel pins with the disc's lead, and sleeves."""
    slices, length, modulus = drive.contact.slices, kind.length, kind.contact_modulus
    heights = sliced.slice_heights(length, slices)
    relief = np.zeros(heights.shape) + (0.0 if kind.generator is None else kind.generator.relief(heights))
    if part is drive.pin_wheel:
        relief = relief + lead_relief(drive.disc, heights)
    found = sliced.SlicedLine(
        length=length, contact_modulus=modulus, slices=slices, relief=relief, free_ends=kind.free_ends
    )
    if part is None or part.seat.kind != "sleeve":
        return found
    twice = sleeve_overlap(drive, part, HALF_SPACE_DATUM * length)
    return replace(found, sleeve=drive.materials.sleeve.plane_strain_compliance * modulus, overlap=twice)


def behind_wheel_pins(drive: Drive, law: Any, play: FloatArray, depth: float | None = None) -> Any:
    """Return the law of wheel pins and flank with what is behind the contacts (`ltca.laws.backed`); in slices beams are not."""
    if drive.contact.slices == 1:
        return back_wheel_pins(drive, law, play, depth)
    return sliced.back_line(law, wheel_pin_seat(drive), play)


def shaft_pin_springs(drive: Drive, play: FloatArray) -> Any:
    """Return the law of shaft pins on springs that stand for all that yields there, sleeves behind them, with a play, mm."""
    spring, slices, width = SpringLaw(stiffness=shaft_pin_stiffness(drive)), drive.contact.slices, drive.disc.thickness
    if slices == 1:
        return back_shaft_pins(drive, spring, play)
    relief = np.zeros(sliced.slice_heights(width, slices).shape)
    springs = sliced.SeparateSlices(law=spring, length=width, slices=slices, relief=relief)
    return sliced.back_line(springs, shaft_pin_seat(drive), play)


def hole_in_slices(drive: Drive, kind: ContactKind, play: FloatArray) -> Any:
    """Return the law of shaft pins and holes in slices, sleeves of a radial play, mm, behind it."""
    line = _line(drive, kind, drive.pin_shaft)
    return sliced.back_line(line, shaft_pin_seat(drive), play)


def _effective_radii(profile: FlankProfile, pin_radii: FloatArray, turn: FloatArray) -> FloatArray:
    """Smallest and largest effective radius that pins of these radii meet on a flank, mm, outward by what samples miss."""
    ends = []
    for outermost, power in ((np.min, -1.0), (np.max, 1.0)):
        radius, places, found = outermost(pin_radii, axis=-1, keepdims=True), turn, []
        for _ in range(REFINEMENTS):
            # Tops are looked for, of the curvature and of the radius: outward of either is a positive radius.
            values = profile.effective_radius(places, radius) ** power
            # Between three samples of a parabola its top is higher than they are by an eighth of their second difference.
            values[..., 1:-1] += np.abs(np.diff(values, 2, axis=-1)) / 8.0
            found.append(np.max(values))
            top = np.take_along_axis(places, np.argmax(values, axis=-1)[..., None], axis=-1)
            spacing = places[..., 1:2] - places[..., :1]
            places = top + spacing * np.linspace(-1.0, 1.0, SAMPLES_PER_LOBE + 1)
        ends.append(np.max(found) ** power)
    return np.array(ends)
