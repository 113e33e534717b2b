"""Half-space compliance: pairs that do not feel each other (the paper's model)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.pressures import elastic_hole_pressures, pressures_of_law
from ltca.compliance.response import ContactPressures, DiscResponse, Start, assemble_response, split_shifts
from ltca.compliance.rollers import RollerLaws, balance_rollers
from ltca.contact.tracked_grid import ContactKinds
from ltca.drive.parts import Drive, Material, contact_modulus
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import back_shaft_pins, back_wheel_pins, law_at, shaft_pin_stiffness, tip_share
from ltca.laws.contact_law import ContactLaw, EnergyLaw
from ltca.laws.generator_law import law_for_profile
from ltca.laws.series import SpringLaw

SAMPLES = 180
"""Places of each lobe at which the range of effective radii is looked for."""
ZOOMS = 3
"""Times they are looked for, from the second time between the neighbours of the outermost: a tip close to undercut is sharper
than a lobe's 180th part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HalfSpaceCompliance:
    """Half-space laws for pins and rollers, springs for the pin holes (the paper's model).

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    pin_law : ContactLaw
        Law of wheel pin and flank.
    roller_laws : RollerLaws
        Laws of the rollers.
    hole_law : EnergyLaw
        Law of shaft pins and holes: springs k_PS, with what is before them.
    kinds : ContactKinds
        The contacts as grids see them, for what no table holds.
    """

    geometry: ContactGeometry
    pin_law: ContactLaw
    roller_laws: RollerLaws[ContactLaw]
    hole_law: EnergyLaw
    kinds: ContactKinds

    @classmethod
    def of_drive(cls, drive: Drive) -> HalfSpaceCompliance:
        """Return the half-space model of a drive."""
        geometry = replace(ContactGeometry.of_drive(drive), tip_share=tip_share(drive))
        pin_radii = np.ones(1)
        if not drive.pin_wheel.pin_profile.is_cylinder:
            # A flank without deviations has the same radii on every lobe.
            lobes = 1 if geometry.profile.deviation is None else drive.pin_wheel.number_of_pins
            turn = np.linspace(0.0, 2.0 * np.pi * lobes / drive.pin_wheel.number_of_pins, SAMPLES * lobes + 1)
            pin_radii = _effective_radii(geometry.profile, geometry.placement.wheel_pin_radii, turn)
        return cls._of_geometry(geometry, drive, pin_radii, shaft_pin_stiffness(drive))

    @classmethod
    def of_drives(cls, drives: Sequence[Drive], positions: int) -> HalfSpaceCompliance:
        """Return the model of a batch: every drive at the same number of positions, drive by drive.

        Parameters
        ----------
        drives : sequence of Drive
            Drives that agree in what `batch_signature` tells.
        positions : int
            Positions of each drive; drive s takes the rows s·positions … (s + 1)·positions − 1.
        """
        tips = np.repeat([[[tip_share(drive)]] for drive in drives], positions, axis=0)
        geometry = replace(ContactGeometry.of_drives(drives, positions), tip_share=tips)
        stiffness = np.repeat([[shaft_pin_stiffness(drive)] for drive in drives], positions, axis=0)
        each = geometry.take(np.arange(len(drives)) * positions)
        pin_radii = np.ones(1)
        if not drives[0].pin_wheel.pin_profile.is_cylinder:
            # One row for each drive: deviations of the flanks are summed row by row.
            turn = np.linspace(0.0, 2.0 * np.pi, SAMPLES * drives[0].pin_wheel.number_of_pins + 1)
            pin_radii = _effective_radii(each.profile, each.placement.wheel_pin_radii, np.tile(turn, (len(drives), 1)))
        return cls._of_geometry(geometry, drives[0], pin_radii, stiffness)

    @classmethod
    def _of_geometry(
        cls, geometry: ContactGeometry, drive: Drive, pin_radii: FloatArray, hole_stiffness: float | FloatArray
    ) -> HalfSpaceCompliance:
        place, bearing, parts = geometry.placement, drive.crank_bearing, drive.materials
        inner_radius, outer_radius = place.inner_effective_radii, place.outer_effective_radii
        # Batches differ little from each other: on a ladder they share the tables of profiled parts.
        rungs = _rungs if place.is_batch else np.asarray

        def roller_law(race: Material, effective_radii: FloatArray) -> ContactLaw:
            return law_for_profile(
                bearing.roller_profile,
                length=bearing.roller_length,
                radius=bearing.roller_radius,
                contact_modulus=contact_modulus(race, parts.roller),
                effective_radii=rungs(effective_radii),
            )

        on_flank = law_for_profile(
            drive.pin_wheel.pin_profile,
            length=drive.disc.thickness,
            radius=drive.pin_wheel.pin_radius,
            contact_modulus=contact_modulus(parts.disc, drive.flank_pin),
            effective_radii=rungs(pin_radii),
        )
        return cls(
            geometry=geometry,
            pin_law=back_wheel_pins(drive, on_flank, place.wheel_pin_plays),
            roller_laws=RollerLaws(
                inner=roller_law(parts.inner_race, inner_radius),
                outer=roller_law(parts.disc, outer_radius),
                inner_radius=inner_radius,
                outer_radius=outer_radius,
            ),
            hole_law=back_shaft_pins(drive, SpringLaw(stiffness=hole_stiffness), place.shaft_pin_plays),
            kinds=ContactKinds.of_drive(drive),
        )

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> HalfSpaceCompliance:
        """Return the model of some positions: itself for one drive, these rows of a batch."""
        if not self.geometry.placement.is_batch:
            return self
        laws = self.roller_laws
        return HalfSpaceCompliance(
            geometry=self.geometry.take(rows),
            pin_law=cast(ContactLaw, law_at(self.pin_law, rows)),
            roller_laws=RollerLaws(
                inner=laws.inner,
                outer=laws.outer,
                inner_radius=laws.inner_radius[rows],
                outer_radius=laws.outer_radius[rows],
            ),
            hole_law=law_at(self.hole_law, rows),
            kinds=self.kinds,
        )

    def respond(
        self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None, shifts: ComplexArray | None = None
    ) -> DiscResponse:
        """Return the contact forces at the poses of a batch of positions.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, coordinates)
            q of `ltca.geometry.coordinates`.
        start : Start, optional
            Inner unknowns of a neighbouring pose.
        shifts : array of complex, shape (positions, z_P + z_PS), optional
            Displacements of the pins in the fixed frame, mm.

        Returns
        -------
        DiscResponse
            Generalised force, tangent and every pair's load.

        Notes
        -----
        A load depends on its place through ρ(θ) as well. That derivative is left out of the tangent, and the
        force it would add to the gradient of the energy (about 1e-5 of the load, along the flank) is no contact
        force without friction: the force acts along the common normal.
        """
        moved = split_shifts(shifts, self.geometry)
        places, known = (None, None) if start is None else (start.parameter, start.known)
        flank = self.geometry.flank(crank_angle, pose, places, moved[0], known)
        pin_load, pin_stiffness = self.pin_law.load_and_stiffness(flank.approach, flank.effective_radius)
        holes = self.geometry.holes(crank_angle, pose, moved[1])
        hole_load, hole_stiffness = self.hole_law.load_and_stiffness(
            holes.approach, self.geometry.placement.hole_effective_radii
        )
        bores, rays = self.geometry.bores(crank_angle, pose), self.geometry.rollers(crank_angle)
        rollers = balance_rollers(
            rays,
            bores.each(bores.displacement, rays.direction.shape[1]),
            self.roller_laws,
            None if start is None else start.share,
        )
        return assemble_response(
            flank,
            pin_load,
            pin_stiffness,
            holes,
            hole_load,
            hole_stiffness,
            rollers,
            bores,
            shifts=shifts,
        )

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return the pressures from the laws."""
        flank, rollers, laws, kinds = response.flank, response.rollers, self.roller_laws, self.kinds
        return ContactPressures(
            pins=pressures_of_law(self.pin_law, kinds.pins, flank.approach, flank.effective_radius),
            outer=pressures_of_law(laws.outer, kinds.outer, rollers.outer_approach, laws.outer_radius),
            inner=pressures_of_law(laws.inner, kinds.inner, rollers.inner_approach, laws.inner_radius),
            holes=elastic_hole_pressures(kinds.holes, response.hole_load, self.geometry.placement),
            rigid_shaft_pins=False,
        )


def batch_signature(drive: Drive) -> tuple[object, ...]:
    """Return what drives of one batch have in common: numbers of parts, contact laws, shape of the deviations."""
    wheel, disc, bearing, errors = drive.pin_wheel, drive.disc, drive.crank_bearing, drive.disc.profile_errors
    # A logarithmic profile scales with the diameter of its part.
    pin = None if wheel.pin_profile.is_cylinder else (wheel.pin_profile, wheel.pin_radius)
    roller = None if bearing.roller_profile.is_cylinder else (bearing.roller_profile, bearing.roller_radius)
    numbers = (wheel.number_of_pins, disc.number_of_teeth, bearing.number_of_rollers, drive.number_of_holes)
    lengths = (disc.thickness, bearing.roller_length)
    yields = (drive.crank.number, drive.crank.support is None, wheel.support_stiffness is None)
    # Laws behind the contacts are those of one drive: what they are made of is the same for all of a batch.
    behind: tuple[object, ...] = (wheel.seat, wheel.beam)
    if wheel.seat.kind != "fixed" or wheel.beam is not None:
        behind += (wheel.pin_radius, disc.disc_planes)
    shaft = drive.pin_shaft
    if shaft is not None and shaft.seat.kind != "fixed":
        behind += (shaft.seat, shaft.pin_radius)
    if drive.friction is not None:
        behind += (drive.friction, drive.motion_sign, drive.load.driven_by, drive.installation)
        behind += (disc.disc_planes, drive.crank.support)
        behind += (wheel.seat, None if shaft is None else shaft.seat, wheel.pin_radius, shaft and shaft.pin_radius)
        behind += (bearing.inner_race_radius, bearing.roller_radius)
    return (
        *numbers,
        *lengths,
        *yields,
        *behind,
        None if shaft is None or shaft.beam is None else shaft.beam.tip,
        pin,
        roller,
        drive.materials,
        errors.orders,
        errors.parameter,
        errors.deviation,
    )


def _effective_radii(profile: FlankProfile, pin_radii: FloatArray, turn: FloatArray) -> FloatArray:
    """Smallest and largest effective radius that pins of these radii meet on a flank, mm, outward by what samples miss."""
    ends = []
    for outermost, power in ((np.min, -1.0), (np.max, 1.0)):
        radius, places, found = outermost(pin_radii, axis=-1, keepdims=True), turn, []
        for _ in range(ZOOMS):
            # Tops are looked for, of the curvature and of the radius: outward of either is a positive radius.
            values = profile.effective_radius(places, radius) ** power
            # Between three samples of a parabola its top is higher than they are by an eighth of their second difference.
            values[..., 1:-1] += np.abs(np.diff(values, 2, axis=-1)) / 8.0
            found.append(np.max(values))
            top = np.take_along_axis(places, np.argmax(values, axis=-1)[..., None], axis=-1)
            spacing = places[..., 1:2] - places[..., :1]
            places = top + spacing * np.linspace(-1.0, 1.0, SAMPLES + 1)
        ends.append(np.max(found) ** power)
    return np.array(ends)


def _rungs(radii: FloatArray) -> FloatArray:
    """Range of radii rounded outward to powers of 1.25."""
    step = np.log(1.25)
    ends = np.log([np.min(radii), np.max(radii)]) / step
    return np.asarray(np.exp(step * np.array([np.floor(ends[0]), np.ceil(ends[1])])))
