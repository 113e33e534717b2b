r"""Contacts of a disc that feel each other through the bodies (`fe` and `hybrid`): their laws and what the bodies yield.

Every approach is the sum of the contact's own law and what the loads on the bodies add,

.. math:: \delta_i(q) = w_i(F_i) + \sum_j C_{ij} F_j ,

with the law of the near field w (`ltca.compliance.near_field`: half-spaces with the lengths and profiles of the parts for
`hybrid`, plane strain with a datum for `fe`) and the body part C of `ltca.compliance.coefficients`, in which pins and race
are as thick as the disc and rollers as long as they are. `ltca.mechanics.contacts` solves for the loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.compliance.coefficients import SOLID, BodyPlaces, InfluenceCoefficients
from ltca.compliance.half_space import shaft_pin_springs
from ltca.compliance.near_field import NearField, OwnParts, near_field_contacts, plane_strain_datum
from ltca.compliance.pressures import pressures_in_slices, pressures_of_law
from ltca.compliance.response import (
    ContactLaws,
    ContactPressures,
    DiscContacts,
    DiscResponse,
    KindPressures,
)
from ltca.contact.contact_kind import ContactKind
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.errors import DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import HALF_SPACE_DATUM, back_shaft_pins, shaft_pin_stiffness
from ltca.laws.contact_law import ContactLaw


@dataclass(frozen=True)
class BodyFlexibility:
    """What bodies yield at the contacts of a disc under the loads of some of them, or by moments at half the width.

    Attributes
    ----------
    coefficients : InfluenceCoefficients
        Of the bodies.
    own : OwnParts
        What each contact's own body parts add to its own.
    race : array, shape (rollers, rollers)
        Between the rollers on the races.
    behind : float
        What stands behind shaft pins in their holes, mm/N.
    unit : float
        Of what is taken and of the loads, by mm/N.
    places : BodyPlaces
        Of all contacts.
    counts : tuple of int
        Numbers of wheel pins, rollers and holes.
    loaded : tuple of array of int, shape (positions, chosen)
        Wheel pins, rollers and holes that carry.
    """

    coefficients: InfluenceCoefficients
    own: OwnParts
    race: FloatArray
    behind: float
    unit: float
    places: BodyPlaces
    counts: tuple[int, int, int]
    loaded: tuple[NDArray[np.intp], ...]

    @cached_property
    def among(self) -> FloatArray:
        """What loaded pins, rollers in the bores and holes take by each other's loads, shape (positions, n, n), mm/N."""
        first = np.cumsum((0, *self.counts[:2]))
        columns = np.concatenate([at + some for at, some in zip(first, self.loaded, strict=True)], axis=1)
        found, place = self.coefficients.disc_matrix(self.places.take(columns)), np.arange(columns.shape[1])
        found[:, place, place] += np.repeat(self._alone, [some.shape[1] for some in self.loaded])
        found *= self.unit
        return found

    @property
    def _alone(self) -> tuple[float, float, float]:
        """What a pin, a roller in its bore and a hole yield alone, beyond the coefficients."""
        return self.own.pin, self.own.outer, self.own.hole + self.behind

    @property
    def on_race(self) -> FloatArray:
        """What rollers take on the races by each other's loads there, shape (positions, rollers, rollers)."""
        some = self.loaded[1]
        return np.asarray(self.unit * self.race[some[:, :, None], some[:, None, :]])

    @property
    def across_roller(self) -> float:
        """What a roller yields at one of its contacts under the load of the other."""
        return self.unit * float(self.coefficients.roller[0, 1])

    def taken(self, load: FloatArray) -> FloatArray:
        """What pins, rollers in the bores and holes take by the loads of all of them, shape (positions, contacts)."""
        together = self.coefficients.disc_approach(self.places, load)
        return np.asarray(self.unit * (together + np.repeat(self._alone, self.counts) * load))


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledCompliance:
    """Compliance of contacts coupled through the bodies.

    Attributes
    ----------
    contacts : DiscContacts
        With the laws of the near fields.
    coefficients : InfluenceCoefficients
        Body parts, rollers as long as they are.
    has_ends : bool
        Whether contacts end somewhere: in plane strain they do not.
    hole_law : ContactLaw
        Near field of the hole's wall, or the spring of the shaft pin where the wall does not yield.
    hole_spring : float
        What the spring of the shaft pin yields behind the near field, mm/N; zero where it is the law.
    race : array, shape (rollers, rollers)
        Coefficients between the inner contacts of the rollers, which feel those on their own race alone, mm/N.
    own : OwnParts
        What each contact's own body parts add to the diagonal of C.
    race_tilting : array, shape (rollers, rollers), or None
        Tilts by moments between the inner contacts, rad/(N·mm), of solid bodies in slices.
    """

    grids_can_check: ClassVar[bool] = False

    contacts: DiscContacts
    coefficients: InfluenceCoefficients
    has_ends: bool
    hole_law: Any
    hole_spring: float
    race: FloatArray
    own: OwnParts
    race_tilting: FloatArray | None = None

    @classmethod
    def of_drive(
        cls,
        drive: Drive,
        coefficients: InfluenceCoefficients,
        near_field: NearField,
        *,
        hole_near_field: bool = True,
    ) -> CoupledCompliance:
        """Return the coupled model of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        coefficients : InfluenceCoefficients
            Of this drive.
        near_field : {"plane-strain", "half-space"}
            Plane strain, or half-spaces of finite length with the profiles of rollers and pins.
        hole_near_field : bool
            Whether holes and shaft pins yield like a Hertz contact; else the springs of the pins stand for all.

        Raises
        ------
        DriveError
            When the coefficients are those of other bodies, or plane strain cannot say what the drive has.
        """
        fingerprint = drive.shape_fingerprint(coefficients.bodies)
        if coefficients.fingerprint != fingerprint:
            raise DriveError(
                [
                    f"influence coefficients of the shape {coefficients.fingerprint}: must be those of {drive.name}, shape "
                    f"{fingerprint}"
                ]
            )
        yields = hole_near_field and shaft_pins_yield(drive)
        contacts = near_field_contacts(
            drive,
            near_field,
            rigid_shaft_pins=hole_near_field and not yields,
            solid=coefficients.plane == SOLID,
        )
        geometry, place = contacts.geometry, contacts.geometry.placement
        body = coefficients.placed_in(drive).with_roller_length(drive.roller_length)
        slices, has_ends = drive.contact.slices, near_field == "half-space"
        # In slices a beam bends behind its contact, under the forces of all discs (`ltca.compliance.pin_flexibility`).
        bends_behind = slices > 1 and shaft_pin_beam(drive) is not None
        at_hole = contacts.hole_law
        if not hole_near_field and not bends_behind:
            at_hole = shaft_pin_springs(drive, place.shaft_pin_plays)
        elif slices == 1:
            depth = HALF_SPACE_DATUM * drive.disc.thickness if has_ends else plane_strain_datum(drive)
            at_hole = back_shaft_pins(drive, at_hole, place.shaft_pin_plays, depth)
        # A sleeve's own law has all that it yields (`ltca.laws.backed`).
        bare = drive.pin_shaft is not None and drive.pin_shaft.seat.kind == "fixed"
        own = OwnParts.of_drive(drive, geometry, body, near_field, elastic_shaft_pins=yields and bare)
        on_race = place.roller_cage_angles, float(place.inner_race_radius)
        race, tilting = body.race_matrix(*on_race), None
        if body.tilting is not None and own.tilting is not None:
            tilting = body.tilting.race_matrix(*on_race) + own.tilting.inner * np.eye(race.shape[0])
        return cls(
            contacts=contacts,
            coefficients=body,
            has_ends=has_ends,
            hole_law=at_hole,
            hole_spring=1.0 / shaft_pin_stiffness(drive) if hole_near_field and not bends_behind else 0.0,
            race=race + own.inner * np.eye(race.shape[0]),
            own=own,
            race_tilting=tilting,
        )

    @property
    def geometry(self) -> ContactGeometry:
        """The contact geometry of the drive."""
        return self.contacts.geometry

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts: near fields, and what is behind those of the holes."""
        return replace(self.contacts, hole_law=self.hole_law).contact_laws

    def body_flexibility(self, places: BodyPlaces, loaded: Sequence[NDArray[np.intp]]) -> list[BodyFlexibility]:
        """Return what the bodies of a disc yield of approaches by loads and, of solid bodies in slices, of tilts by moments.

        `loaded` are the wheel pins, rollers and holes that carry.
        """
        whole, place = self.coefficients, self.geometry.placement
        counts = place.wheel_pin_radii.shape[-1], place.roller_radii.shape[-1], place.hole_radii.shape[-1]
        at = places, counts, tuple(loaded)
        found = [BodyFlexibility(whole, self.own, self.race, self.hole_spring, 1.0, *at)]
        if self.race_tilting is not None and whole.tilting is not None and self.own.tilting is not None:
            # What a pin stands on behind its contact is rigid against moments.
            unit = (0.5 * whole.thickness) ** 2
            found.append(BodyFlexibility(whole.tilting, self.own.tilting, self.race_tilting, 0.0, unit, *at))
        return found

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the near fields, of contacts in slices from their line loads."""
        laws, kinds, place, rollers = self.contacts, self.contacts.kinds, self.geometry.placement, response.rollers
        rigid = laws.rigid_shaft_pins
        if response.leaning_pins is not None:
            return pressures_in_slices(response, kinds, place, has_ends=self.has_ends, rigid_shaft_pins=rigid)
        assert response.deformation is not None
        pins, bores = response.pin_load.shape[1], rollers.outer_load.shape[1]
        near = response.deformation[:, 0]
        _, outer_radius, hole_radius, inner_radius = laws.contact_laws
        inner, _ = laws.inner_law.approach_at_load(rollers.inner_load, inner_radius)
        hole, _ = laws.hole_law.approach_at_load(response.hole_load, hole_radius)

        def read(law: ContactLaw, kind: ContactKind, approach: FloatArray, radius: FloatArray) -> KindPressures:
            return pressures_of_law(law, kind if self.has_ends else None, approach, radius)

        return ContactPressures(
            pins=read(laws.pin_law, kinds.pins, near[:, :pins], response.flank.effective_radius),
            outer=read(laws.outer_law, kinds.outer, near[:, pins : pins + bores], outer_radius),
            inner=read(laws.inner_law, kinds.inner, inner, inner_radius),
            holes=read(laws.hole_law, kinds.holes, hole, hole_radius),
            rigid_shaft_pins=rigid,
        )
