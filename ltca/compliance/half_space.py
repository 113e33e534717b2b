"""Half-space compliance: pairs that do not feel each other (the paper's model)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.pressures import elastic_hole_pressures, pressures_of_law
from ltca.compliance.response import ContactPressures, DiscResponse, Start, assemble_response, split_shifts
from ltca.compliance.rollers import RollerLaws, balance_rollers
from ltca.contact.tracked_grid import ContactKinds
from ltca.drive.parts import Drive, Material, contact_modulus
from ltca.geometry.flank import FlankProfile
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import back_shaft_pins, back_wheel_pins, shaft_pin_stiffness, tip_share
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

    coefficients: ClassVar[None] = None
    grids_can_check: ClassVar[bool] = True

    geometry: ContactGeometry
    pin_law: ContactLaw
    roller_laws: RollerLaws[ContactLaw]
    hole_law: EnergyLaw
    kinds: ContactKinds

    @classmethod
    def of_drive(cls, drive: Drive, *, in_batch: bool = False) -> HalfSpaceCompliance:
        """Return the half-space model of a drive.

        Parameters
        ----------
        drive : Drive
            The drive, of one disc.
        in_batch : bool
            Whether it is stacked with others (`ltca.arrays.stack_drives`): tables of profiled parts are then made for ranges
            of radii on a ladder, so that drives that differ little have the same.
        """
        geometry = replace(ContactGeometry.of_drive(drive), tip_share=tip_share(drive))
        place, bearing, parts = geometry.placement, drive.crank_bearing, drive.materials
        inner_radius, outer_radius = place.inner_effective_radii, place.outer_effective_radii
        rungs = _rungs if in_batch else np.asarray
        pin_radii = np.ones(1)
        if not drive.pin_wheel.pin_profile.is_cylinder:
            # A flank without deviations has the same radii on every lobe.
            lobes = 1 if geometry.profile.deviation is None else drive.pin_wheel.number_of_pins
            turn = np.linspace(0.0, 2.0 * np.pi * lobes / drive.pin_wheel.number_of_pins, SAMPLES * lobes + 1)
            pin_radii = _effective_radii(geometry.profile, place.wheel_pin_radii, turn)

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
            hole_law=back_shaft_pins(drive, SpringLaw(stiffness=shaft_pin_stiffness(drive)), place.shaft_pin_plays),
            kinds=ContactKinds.of_drive(drive),
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
