"""The bodies of one disc as rigid ones at a crank angle: places, approaches, gaps.

The guess of the contacts (`fem.drive.expected_contacts`) and the grading of the meshes (`fem.drive.grading`) start from them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement

# Places of the coordinates in a pose.
X, Y, DISC_ROTATION, WHEEL_ANGLE = range(4)


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidGaps:
    """Contacts of rigid bodies at a pose; arrays over pins, rollers, holes.

    Attributes
    ----------
    pins, rollers, holes : array of float
        Gap, mm, negative where the rigid bodies overlap; that of a roller is its play along the cage ray.
    flank_parameters : array of float, shape (z_P,)
        θ of the contact points.
    pin_normals : array of complex, shape (z_P,)
        Out of the disc, fixed axes.
    bore_points : array of complex, shape (cranks · n_BR,)
        Where rollers that touch their bore touch it, about the bore centre, fixed axes, mm.
    hole_directions : array of complex, shape (z_PS,)
        From the hole centre to the contact, fixed axes.
    """

    pins: FloatArray
    rollers: FloatArray
    holes: FloatArray
    flank_parameters: FloatArray
    pin_normals: ComplexArray
    bore_points: ComplexArray
    hole_directions: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBodies:
    """Disc, pins and rollers of one disc as rigid bodies at a crank angle.

    Attributes
    ----------
    profile : FlankProfile
        Of the disc.
    placement : Placement
        Nominal places of the parts.
    crank_angle : float
        φ_C, rad.
    cranks_moved : array of complex, shape (cranks,), or None
        Displacement of each crank, mm; None of rigid ones.
    """

    profile: FlankProfile
    placement: Placement
    crank_angle: float
    cranks_moved: ComplexArray | None = None

    @classmethod
    def of_drive(cls, drive: Drive, crank_angle: float) -> RigidBodies:
        """Return the bodies of a drive of one disc."""
        return cls(
            profile=FlankProfile.of_drive(drive), placement=Placement.of_drive(drive), crank_angle=float(crank_angle)
        )

    def moved(self, wheel_pins: ComplexArray, shaft_pins: ComplexArray, cranks: ComplexArray) -> RigidBodies:
        """Return the bodies with wheel pins displaced in the wheel, shaft pins and cranks displaced, mm."""
        place = replace(
            self.placement,
            wheel_pin_centres=self.placement.wheel_pin_centres + wheel_pins,
            shaft_pin_centres=self.placement.shaft_pin_centres + shaft_pins,
        )
        return replace(self, placement=place, cranks_moved=cranks)

    def gaps(self, displacement: complex, rotation: float, wheel_angle: float) -> RigidGaps:
        """Return all gaps at a pose, exact, from flank and circles.

        `displacement` (mm) and `rotation` (rad) are those of the disc from its nominal place, fixed axes; `wheel_angle` is
        the deviation of the wheel from φ_C/u, rad.
        """
        profile, place = self.profile, self.placement
        turn, wheel = np.exp(1j * rotation), self.crank_angle / place.reduction_ratio + wheel_angle
        centre = complex(place.races(np.asarray(self.crank_angle)).middle) + displacement
        pins = (self.wheel_pins(wheel_angle) - centre) / turn
        start = np.angle(place.wheel_pin_centres) + wheel - rotation
        theta = profile.nearest_point(pins, _on_turned_flank(profile, start)).parameter
        rays = self.roller_rays()
        bores = bore_displacements(place, self.crank_angle, displacement, rotation)
        bores = (bores if self.cranks_moved is None else bores - self.cranks_moved)[place.roller_cranks]
        inward, across = (bores * rays.conjugate()).real, (bores * rays.conjugate()).imag
        # Distance of the rollers' centres along their cage rays where they touch the bore.
        reach = inward + np.sqrt((place.bore_radius - place.roller_radii) ** 2 - across**2)
        from_bore_centre = reach * rays - bores
        holes = place.shaft_pin_centres - (centre + place.hole_centres * turn)
        return RigidGaps(
            pins=profile.distance(pins, theta) - place.wheel_pin_radii,
            rollers=reach - place.roller_radii - place.inner_race_radius,
            holes=place.hole_radii - place.shaft_pin_radii - np.abs(holes),
            flank_parameters=theta,
            pin_normals=profile.normal(theta) * turn,
            bore_points=place.bore_radius * from_bore_centre / np.abs(from_bore_centre),
            hole_directions=holes / np.maximum(np.abs(holes), 1e-300),
        )

    def wheel_pins(self, wheel_angle: float) -> ComplexArray:
        """Return the centres of the wheel pins, fixed frame, mm."""
        turn = self.crank_angle / self.placement.reduction_ratio + wheel_angle
        return np.asarray(self.placement.wheel_axis + self.placement.wheel_pin_centres * np.exp(1j * turn))

    def flank_parameters(self, pose: FloatArray) -> FloatArray:
        """Return θ of the point of the flank nearest to each wheel pin at a pose (x, y, disc rotation, wheel angle)."""
        centre = self.disc_centre(pose)
        in_disc = (self.wheel_pins(pose[WHEEL_ANGLE]) - centre) * np.exp(-1j * pose[DISC_ROTATION])
        count = len(self.placement.wheel_pin_radii)
        start = self.crank_angle / self.placement.reduction_ratio + 2.0 * np.pi * np.arange(count) / count
        return self.profile.nearest_point(in_disc, _on_turned_flank(self.profile, start)).parameter

    def disc_centre(self, pose: FloatArray) -> complex:
        """Return the centre of the disc, fixed frame, mm."""
        return complex(self.placement.races(np.asarray(self.crank_angle)).middle) + complex(pose[X], pose[Y])

    def roller_rays(self) -> ComplexArray:
        """Return unit vectors of the cage rays."""
        return np.asarray(np.exp(1j * self.placement.roller_angles(np.asarray(self.crank_angle))))

    def hole_rays(self, pose: FloatArray) -> ComplexArray:
        """Vectors from hole centres to shaft-pin centres."""
        centres = self.disc_centre(pose) + self.placement.hole_centres * np.exp(1j * pose[DISC_ROTATION])
        return np.asarray(self.placement.shaft_pin_centres - centres)

    def approaches(self, pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return approaches (pins, rollers, holes in a row) and their gradients, shape (contacts, 4)."""
        place, centre, turn = self.placement, self.disc_centre(pose), np.exp(1j * pose[DISC_ROTATION])
        pins = self.wheel_pins(pose[WHEEL_ANGLE])
        theta = self.flank_parameters(pose)
        in_disc = (pins - centre) / turn
        n = self.profile.normal(theta) * turn
        flank = place.wheel_pin_radii - self.profile.distance(in_disc, theta)
        about_axis = -(n.conjugate() * 1j * (pins - place.wheel_axis)).real
        flank_gradient = np.column_stack([n.real, n.imag, (n.conjugate() * 1j * (pins - centre)).real, about_axis])
        d = self.roller_rays()
        play = place.bore_radius - place.inner_race_radius - 2.0 * place.roller_radii
        shift = complex(pose[X], pose[Y])
        bores = bore_displacements(place, self.crank_angle, shift, pose[DISC_ROTATION])[place.roller_cranks]
        bearing = -(bores.real * d.real + bores.imag * d.imag) - play
        arm = (1j * place.bore_centres * turn)[place.roller_cranks]
        bearing_gradient = np.column_stack([-d.real, -d.imag, -(d.conjugate() * arm).real, np.zeros(len(d))])
        ray = self.hole_rays(pose)
        m = ray / np.abs(ray)
        hole = np.abs(ray) + place.shaft_pin_radii - place.hole_radii
        arm = 1j * place.hole_centres * turn
        zero = np.zeros(len(m))
        hole_gradient = np.column_stack([-m.real, -m.imag, -(m.conjugate() * arm).real, zero])
        return (
            np.concatenate([flank, bearing, hole]),
            np.vstack([flank_gradient, bearing_gradient, hole_gradient]),
        )


def bore_displacements(
    placement: Placement, crank_angle: float, displacement: complex, rotation: float
) -> ComplexArray:
    """Return the displacement of the centre of each bore from that of the inner race in it, fixed axes, mm, shape (cranks,).

    `displacement` (mm) and `rotation` (rad) are those of the disc from its nominal place, in fixed axes.
    """
    races = placement.races(np.asarray(crank_angle)).centre
    return np.asarray(races.mean() - races + displacement + placement.bore_centres * np.exp(1j * rotation))


def _on_turned_flank(profile: FlankProfile, direction: FloatArray) -> FloatArray:
    """Return roughly the θ of the flank in a direction of the disc frame (polar angle, rad).

    θ counts from a root, which may be turned.
    """
    return np.asarray(direction - np.angle(profile.turn))
