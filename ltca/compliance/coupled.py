"""Contacts of a disc that feel each other through the bodies (`fe` and `hybrid`): δ_i(q) = w_i(F_i) + Σ_j C_ij F_j.

w is the law of the near field (`ltca.compliance.near_field`), C is in `ltca.compliance.coefficients`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.compliance.coefficients import SOLID, BodyPlaces, InfluenceCoefficients
from ltca.compliance.half_space import shaft_pin_springs
from ltca.compliance.near_field import BodyParts, NearField, near_field_contacts, near_field_depth
from ltca.compliance.pressures import pressures_in_plane, pressures_in_slices
from ltca.compliance.response import ContactLaws, ContactPressures, DiscContacts, DiscResponse
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.errors import DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import back_shaft_pins, shaft_pin_stiffness


@dataclass(frozen=True)
class BodyFlexibility:
    """Yield of the bodies at the contacts of a disc under the loads of some of them, or by moments at half the width."""

    parts: BodyParts
    places: BodyPlaces  # of all contacts
    counts: tuple[int, int, int]  # of wheel pins, rollers and holes
    loaded: tuple[NDArray[np.intp], ...]  # numbers of pins, rollers and holes that carry, (positions, chosen)

    @cached_property
    def among(self) -> FloatArray:
        """What loaded pins, rollers in the bores and holes take by each other's loads, shape (positions, n, n), mm/N."""
        first = np.cumsum((0, *self.counts[:2]))
        columns = np.concatenate([at + some for at, some in zip(first, self.loaded, strict=True)], axis=1)
        found, own = self.parts.coefficients.disc_matrix(self.places.take(columns)), np.arange(columns.shape[1])
        found[:, own, own] += np.repeat(self.parts.alone, [some.shape[1] for some in self.loaded])
        found *= self.parts.unit
        return found

    @property
    def on_race(self) -> FloatArray:
        """What rollers take on the races by each other's loads there, shape (positions, rollers, rollers)."""
        some = self.loaded[1]
        return np.asarray(self.parts.unit * self.parts.race[some[:, :, None], some[:, None, :]])

    @property
    def across_roller(self) -> float:
        """What a roller yields at one of its contacts under the load of the other."""
        return self.parts.unit * float(self.parts.coefficients.roller[0, 1])

    def taken(self, load: FloatArray) -> FloatArray:
        """What pins, rollers in the bores and holes take by the loads of all of them, shape (positions, contacts)."""
        together = self.parts.coefficients.disc_approach(self.places, load)
        return np.asarray(self.parts.unit * (together + np.repeat(self.parts.alone, self.counts) * load))


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledCompliance:
    """Compliance of contacts coupled through the bodies."""

    contacts: DiscContacts  # with the laws of the near fields
    has_ends: bool  # whether contacts end somewhere: in plane strain they do not
    hole_law: Any  # of the hole's wall, or the spring of the shaft pin where it is rigid
    bodies: tuple[BodyParts, ...]  # of approaches by loads and, of solid bodies, of tilts by moments

    @classmethod
    def of_drive(
        cls, drive: Drive, coefficients: InfluenceCoefficients, near_field: NearField, *, hole_near_field: bool = True
    ) -> CoupledCompliance:
        """Return the model of a drive of one disc; without `hole_near_field` the springs of the shaft pins stand for all."""
        fingerprint = drive.shape_fingerprint(coefficients.bodies)
        if coefficients.fingerprint != fingerprint:
            other = f"influence coefficients of the shape {coefficients.fingerprint}"
            raise DriveError([f"{other}: must be those of {drive.name}, shape {fingerprint}"])
        yields = hole_near_field and shaft_pins_yield(drive)
        contacts = near_field_contacts(
            drive, near_field, rigid_shaft_pins=hole_near_field and not yields, solid=coefficients.plane == SOLID
        )
        geometry, place = contacts.geometry, contacts.geometry.placement
        body = coefficients.placed_in(drive).with_roller_length(drive.roller_length)
        slices = drive.contact.slices
        # In slices a beam bends behind its contact, under the forces of all discs (`ltca.compliance.pin_flexibility`).
        bends_behind = slices > 1 and shaft_pin_beam(drive) is not None
        at_hole = contacts.hole_law
        if not hole_near_field and not bends_behind:
            at_hole = shaft_pin_springs(drive, place.shaft_pin_plays)
        elif slices == 1:
            at_hole = back_shaft_pins(drive, at_hole, place.shaft_pin_plays, near_field_depth(drive, near_field))
        # A sleeve's own law has all that it yields (`ltca.laws.backed`).
        bare = drive.pin_shaft is not None and drive.pin_shaft.seat.kind == "fixed"
        spring = 1.0 / shaft_pin_stiffness(drive) if hole_near_field and not bends_behind else 0.0
        bodies = [
            BodyParts.of_drive(
                drive, geometry, each, near_field, elastic_shaft_pins=yields and bare, hole_spring=spring, tilts=tilts
            )
            for each, tilts in ((body, False), (body.tilting, True))
            if each is not None
        ]
        return cls(contacts=contacts, has_ends=near_field == "half-space", hole_law=at_hole, bodies=tuple(bodies))

    @property
    def geometry(self) -> ContactGeometry:
        """The contact geometry of the drive."""
        return self.contacts.geometry

    @property
    def coefficients(self) -> InfluenceCoefficients:
        """Coefficients by which the contacts of the disc feel each other."""
        return self.bodies[0].coefficients

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts: near fields, and what is behind those of the holes."""
        return replace(self.contacts, hole_law=self.hole_law).contact_laws

    def body_flexibility(self, places: BodyPlaces, loaded: Sequence[NDArray[np.intp]]) -> list[BodyFlexibility]:
        """Return the yield of the bodies under the wheel pins, rollers and holes `loaded`, and of solid ones in tilts."""
        place = self.geometry.placement
        counts = place.wheel_pin_radii.shape[-1], place.roller_radii.shape[-1], place.hole_radii.shape[-1]
        return [BodyFlexibility(parts, places, counts, tuple(loaded)) for parts in self.bodies]

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the near fields, of contacts in slices from their line loads."""
        contacts, place, rollers = self.contacts, self.geometry.placement, response.rollers
        if response.leaning_pins is not None:
            rigid = contacts.rigid_shaft_pins
            return pressures_in_slices(response, contacts.kinds, place, has_ends=self.has_ends, rigid_shaft_pins=rigid)
        assert response.deformation is not None
        pins, bores, _ = np.split(
            response.deformation[:, 0], np.cumsum((response.pin_load.shape[1], rollers.outer_load.shape[1])), axis=1
        )
        inner, _ = contacts.inner_law.approach_at_load(rollers.inner_load, place.inner_effective_radii)
        return pressures_in_plane(contacts, response, pins, bores, inner, ends=self.has_ends)
