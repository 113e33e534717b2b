r"""How far each pair is pressed together at a pose, and how that changes with the pose (Eq. 45–64).

A pose of the disc and the wheel at a held crank angle is q = (x, y, disc rotation, wheel angle): x and y in
mm are the displacement of the disc centre from the inner-race centre in the fixed frame, the angles in rad;
the wheel angle is its deviation from φ_C/u. All arrays carry the position on axis 0 and the pair on axis 1.
Approaches are positive where the bodies are pressed together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.drive import Drive
from ltca.placement import Placement
from ltca.profile import FlankProfile

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def _dot(first: ComplexArray, second: ComplexArray) -> FloatArray:
    return first.real * second.real + first.imag * second.imag


@dataclass(frozen=True, slots=True, kw_only=True)
class PairMotion:
    """Approach of pairs of one kind, with first and second derivatives by the pose.

    Attributes
    ----------
    approach : array, shape (positions, pairs)
        δ, mm.
    gradient : array, shape (positions, pairs, 4)
        ∂δ/∂q, in mm/mm and mm/rad.
    curvature : array, shape (positions, pairs, 4, 4)
        ∂²δ/∂q², the geometric part of the tangent.
    """

    approach: FloatArray
    gradient: FloatArray
    curvature: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankMotion(PairMotion):
    """Pairs of wheel pin and flank.

    Attributes
    ----------
    parameter : array, shape (positions, z_P)
        Place θ of the contact on the flank, rad.
    effective_radius : array, shape (positions, z_P)
        ρ of pin and flank there, mm.
    """

    parameter: FloatArray
    effective_radius: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerRays:
    """Rollers on their cage rays about the inner-race centre.

    Attributes
    ----------
    direction : array of complex, shape (positions, n_BR)
        Unit vector n of each ray in the fixed frame.
    outermost : array, shape (n_BR,)
        Distance s of the roller centre from the race centre when it rests on the inner race, mm.
    bore_play : array, shape (n_BR,)
        Bore radius less roller radius: distance from the disc centre at which it touches the bore, mm.
    """

    direction: ComplexArray
    outermost: FloatArray
    bore_play: FloatArray

    def touching_distance(self, displacement: ComplexArray) -> FloatArray:
        """Return the distance s at which each roller just touches the bore, mm, shape (positions, n_BR).

        Parameters
        ----------
        displacement : array of complex, shape (positions,)
            Disc centre from inner-race centre, mm.
        """
        along = _dot(self.direction, displacement[:, None])
        across = (self.direction.conjugate() * displacement[:, None]).imag
        # A disc displaced sideways by more than the bore play touches nowhere on the ray: nearest point instead.
        return np.asarray(along + np.sqrt(np.maximum(self.bore_play**2 - across**2, 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactGeometry:
    """The drive as its contact pairs see it."""

    placement: Placement
    profile: FlankProfile

    @classmethod
    def of_drive(cls, drive: Drive) -> ContactGeometry:
        """Return the contact geometry of a drive."""
        return cls(placement=Placement.of_drive(drive), profile=FlankProfile.of_drive(drive))

    def nominal_parameter(self, crank_angle: FloatArray) -> FloatArray:
        """Return θ of each pin's contact at the nominal pose: (φ_C + 2πi)/z_P for Δz = 1, rad.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        """
        pins = np.angle(self.placement.wheel_pin_centres)
        return np.asarray(crank_angle)[:, None] / self.placement.reduction_ratio + pins

    def flank(self, crank_angle: FloatArray, pose: FloatArray, start: FloatArray | None = None) -> FlankMotion:
        """Return the pairs of wheel pin and flank (Eq. 60–64).

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, 4)
            q.
        start : array, shape (positions, z_P), optional
            First guess of the contact parameters; the nominal ones by default.
        """
        place = self.placement
        rotation, wheel_angle = pose[:, 2, None], pose[:, 3, None]
        disc_centre = (place.race_centre(crank_angle) + pose[:, 0] + 1j * pose[:, 1])[:, None]
        turned = np.exp(1j * (place.wheel_rotation(crank_angle)[:, None] + wheel_angle))
        pin = place.wheel_pin_centres * turned
        arm = pin - disc_centre
        back = np.exp(-1j * rotation)
        point = arm * back
        if start is None:
            start = self.nominal_parameter(crank_angle) + wheel_angle - rotation
        parameter = self.profile.nearest_parameter(point, start)
        centre, tangent, second = self.profile.locus(parameter)
        speed = np.abs(tangent)
        normal = -1j * tangent / speed
        locus_distance = _dot(normal, point - centre)
        locus_curvature = (tangent.conjugate() * second).imag / speed**3
        offset = self.profile.offset
        approach = place.wheel_pin_radii - offset - locus_distance
        flank_curvature = locus_curvature / (1.0 - offset * locus_curvature)
        effective_radius = 1.0 / (1.0 / place.wheel_pin_radii + flank_curvature)

        # Distance = f(point(q)): its Hessian is n·∂²point + κ (t·∂point)(t·∂point), κ of the parallel curve
        # through the pin centre. Vectors are taken in the fixed frame.
        outward = normal / back
        sideways = 1j * outward
        kappa = locus_curvature / (1.0 + locus_curvature * locus_distance)
        by_pose = np.stack(np.broadcast_arrays(-1.0 + 0j, -1j, -1j * arm, 1j * pin), axis=-1)
        gradient = -_dot(outward[..., None], by_pose)
        along = _dot(sideways[..., None], by_pose)
        hessian = kappa[..., None, None] * along[..., :, None] * along[..., None, :]
        turning = _dot(outward[..., None], np.stack(np.broadcast_arrays(1j, -1.0 + 0j, pin), axis=-1))
        for column, index in enumerate((0, 1, 3)):
            hessian[..., index, 2] += turning[..., column]
            hessian[..., 2, index] += turning[..., column]
        hessian[..., 2, 2] -= _dot(outward, arm)
        hessian[..., 3, 3] -= _dot(outward, pin)
        return FlankMotion(
            approach=approach,
            gradient=gradient,
            curvature=-hessian,
            parameter=parameter,
            effective_radius=effective_radius,
        )

    def holes(self, crank_angle: FloatArray, pose: FloatArray) -> PairMotion:
        """Return the pairs of shaft pin and hole (Eq. 59, 78–81); arguments as for `flank`."""
        place = self.placement
        disc_centre = (place.race_centre(crank_angle) + pose[:, 0] + 1j * pose[:, 1])[:, None]
        arm = place.hole_centres * np.exp(1j * pose[:, 2, None])
        play = place.shaft_pin_centres - disc_centre - arm
        distance = np.abs(play)
        direction = play / distance
        by_pose = np.stack(np.broadcast_arrays(1.0 + 0j, 1j, 1j * arm), axis=-1)
        positions, pairs = distance.shape
        gradient = np.zeros((positions, pairs, 4))
        gradient[..., :3] = -_dot(direction[..., None], by_pose)
        across = _dot(1j * direction[..., None], by_pose)
        curvature = np.zeros((positions, pairs, 4, 4))
        curvature[..., :3, :3] = across[..., :, None] * across[..., None, :] / distance[..., None, None]
        curvature[..., 2, 2] += _dot(direction, arm)
        approach = distance - (place.hole_radii - place.shaft_pin_radii)
        return PairMotion(approach=approach, gradient=gradient, curvature=curvature)

    def rollers(self, crank_angle: FloatArray) -> RollerRays:
        """Return the cage rays of the rollers (Eq. 48); they depend on the crank angle alone."""
        place = self.placement
        return RollerRays(
            direction=np.exp(1j * place.roller_angles(crank_angle)),
            outermost=place.inner_race_radius + place.roller_radii,
            bore_play=place.bore_radius - place.roller_radii,
        )
