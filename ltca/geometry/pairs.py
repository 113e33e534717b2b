r"""How far each pair is pressed together at a pose, and how that changes with the pose (Eq. 45–64).

A pose q is that of `ltca.geometry.coordinates`; one of four coordinates says that cranks and wheel stay where they are.
All arrays carry the position on axis 0 and the pair on axis 1. Approaches are positive where the bodies are pressed
together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ltca.drive.parts import Drive
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, RIGID, WHEEL_ANGLE, Coordinates, X, Y
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.geometry.rotation import unit

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


def _dot(first: ComplexArray, second: ComplexArray) -> FloatArray:
    return first.real * second.real + first.imag * second.imag


def _cross(first: ComplexArray, second: ComplexArray) -> FloatArray:
    return first.real * second.imag - first.imag * second.real


@dataclass(frozen=True, slots=True, kw_only=True)
class PairMotion:
    """Approach of pairs of one kind, with first and second derivatives by the pose.

    The second derivatives of a pair have few terms: κ s sᵀ with s = `along`, the slip of the contact along its
    tangent, and turning terms made of s again. They are only formed summed over the pairs, see `bend`.

    Attributes
    ----------
    approach : array, shape (positions, pairs)
        δ, mm.
    gradient : array, shape (positions, pairs, coordinates)
        ∂δ/∂q, in mm/mm and mm/rad.
    along : array, shape (positions, pairs, coordinates)
        Slip along the tangent by the pose, in mm/mm and mm/rad.
    bending : array, shape (positions, pairs)
        κ of the path of equal approach, 1/mm.
    """

    approach: FloatArray
    gradient: FloatArray
    along: FloatArray
    bending: FloatArray

    def bend(self, load: FloatArray) -> FloatArray:
        """Return Σ F ∂²δ/∂q² over the pairs, the geometric part of the tangent, shape (positions, coordinates, coordinates).

        Parameters
        ----------
        load : array, shape (positions, pairs)
            F, N.
        """
        return self._sum(load, self.bending, self.along)

    @property
    def curvature(self) -> FloatArray:
        """∂²δ/∂q² of every pair, shape (positions, pairs, coordinates, coordinates)."""
        one = np.ones((*self.bending.shape, 1))
        return self._sum(one, self.bending[..., None], self.along[..., None, :])

    @staticmethod
    def _sum(load: FloatArray, bending: FloatArray, along: FloatArray) -> FloatArray:
        """Pins in holes: κ s sᵀ + s₂ e₂e₂ᵀ, the disc rotation being coordinate 2."""
        total = np.matmul(along.swapaxes(-1, -2), (load * bending)[..., None] * along)
        total[..., DISC_ROTATION, DISC_ROTATION] += (load * along[..., DISC_ROTATION]).sum(axis=-1)
        return np.asarray(total)


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

    @staticmethod
    def _sum(load: FloatArray, bending: FloatArray, along: FloatArray) -> FloatArray:
        """Pins on the flank: −(κ s sᵀ + e₂ sᵀ + s e₂ᵀ − s₂ e₂e₂ᵀ − s_W e_W e_Wᵀ), the wheel angle being the last coordinate."""
        total = np.matmul(along.swapaxes(-1, -2), (load * bending)[..., None] * along)
        slip = np.matmul(load[..., None, :], along)[..., 0, :]
        total[..., DISC_ROTATION, :] += slip
        total[..., :, DISC_ROTATION] += slip
        for turn in (DISC_ROTATION, WHEEL_ANGLE):
            total[..., turn, turn] -= slip[..., turn]
        return np.asarray(-total)


@dataclass(frozen=True, slots=True, kw_only=True)
class BoreMotion:
    """Bores of the disc against the centres of the inner races in them.

    Attributes
    ----------
    displacement : array of complex, shape (positions, cranks)
        Bore centre from inner-race centre in the fixed frame, mm.
    arm : array of complex, shape (positions, cranks)
        Bore centre from the centre of the disc in the fixed frame, mm: zero for a central crank. The second derivative of
        `displacement` by the rotation of the disc is −`arm`, and there is no other.
    gradient : array of complex, shape (positions, cranks, coordinates)
        ∂ displacement/∂q, in mm/mm and mm/rad.
    """

    displacement: ComplexArray
    arm: ComplexArray
    gradient: ComplexArray

    def each(self, values: ComplexArray, rollers: int) -> ComplexArray:
        """Return values of the bores as those of their rollers, shape (positions, rollers, …).

        Parameters
        ----------
        values : array, shape (positions, cranks, …)
            One of the attributes.
        rollers : int
            All of them.
        """
        return values if values.shape[1] == 1 else np.repeat(values, rollers // values.shape[1], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerRays:
    """Rollers on their cage rays about the inner-race centres, crank after crank.

    Attributes
    ----------
    direction : array of complex, shape (positions, rollers)
        Unit vector n of each ray in the fixed frame.
    outermost : array, shape (rollers,)
        Distance s of the roller centre from the race centre when it rests on the inner race, mm.
    bore_play : array, shape (rollers,)
        Bore radius less roller radius: distance from the bore centre at which it touches the bore, mm.
    """

    direction: ComplexArray
    outermost: FloatArray
    bore_play: FloatArray

    def touching_distance(self, displacement: ComplexArray) -> FloatArray:
        """Return the distance s at which each roller just touches the bore, mm, shape (positions, rollers).

        Parameters
        ----------
        displacement : array of complex, shape (positions, rollers) or (positions, 1)
            Bore centre from inner-race centre, mm.
        """
        along = _dot(self.direction, displacement)
        across = (self.direction.conjugate() * displacement).imag
        # A disc displaced sideways by more than the bore play touches nowhere on the ray: nearest point instead.
        return np.asarray(along + np.sqrt(np.maximum(self.bore_play**2 - across**2, 0.0)))


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactGeometry:
    """The drive as its contact pairs see it.

    Attributes
    ----------
    placement, profile : Placement, FlankProfile
        Where the parts stand, and the flank.
    coordinates : Coordinates
        Of a pose in which every member moves that can.
    tip_share : float or array, shape (positions, 1, 1)
        Displacement of a shaft pin at the disc by that of its tip, where a ring ties the tips.
    """

    placement: Placement
    profile: FlankProfile
    coordinates: Coordinates
    tip_share: float | FloatArray = 0.0

    @classmethod
    def of_drive(cls, drive: Drive) -> ContactGeometry:
        """Return the contact geometry of a drive of one disc."""
        place, profile = Placement.of_drive(drive), FlankProfile.of_drive(drive)
        return cls(placement=place, profile=profile, coordinates=Coordinates.of_drive(drive))

    @classmethod
    def of_drives(cls, drives: Sequence[Drive], positions: int) -> ContactGeometry:
        """Return the contact geometry of a batch: every drive at the same number of positions, drive by drive."""
        places = [Placement.of_drive(drive) for drive in drives]
        place, profile = Placement.stack(places, positions), FlankProfile.stack(drives, positions)
        return cls(placement=place, profile=profile, coordinates=Coordinates.of_drive(drives[0]))

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> ContactGeometry:
        """Return the geometry of some positions: itself for one drive, these rows of a batch."""
        if not self.placement.is_batch:
            return self
        tips = self.tip_share[rows] if isinstance(self.tip_share, np.ndarray) else self.tip_share
        return replace(self, placement=self.placement.take(rows), profile=self.profile.take(rows), tip_share=tips)

    @property
    def tips_by_ring(self) -> ComplexArray:
        """Displacement of the tips of the shaft pins by x, y and rotation of the ring that ties them, shape (…, z_PS, 3)."""
        places = self.placement.shaft_pin_centres
        return np.stack((np.ones_like(places), np.full_like(places, 1j), 1j * places), axis=-1)

    def moved_by_ring(self, pose: FloatArray) -> ComplexArray | None:
        """Return how far the ring moves the shaft pins at the disc, shape (positions, z_PS), mm; None without ring."""
        coordinates = self.coordinates_of(pose)
        if not coordinates.ring:
            return None
        by_ring = self.tip_share * self.tips_by_ring
        return np.asarray(np.matmul(pose[:, None, coordinates.ring_place], by_ring.swapaxes(-1, -2))[:, 0])

    def coordinates_of(self, pose: FloatArray) -> Coordinates:
        """Return the coordinates that a pose has: those of rigid members where it has no more than four."""
        return Coordinates() if pose.shape[-1] == RIGID else self.coordinates

    def nominal_parameter(self, crank_angle: FloatArray) -> FloatArray:
        """Return θ of each pin's contact at the nominal pose: (φ_C + 2πi)/z_P for Δz = 1, on a flank that is not turned, rad.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        """
        pins = np.angle(self.placement.wheel_pin_centres)
        if self.profile.is_turned:
            pins = pins - np.angle(self.profile.turn)
        return np.asarray(crank_angle)[:, None] / self.placement.reduction_ratio + pins

    def flank(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: FloatArray | None = None,
        shifts: ComplexArray | None = None,
    ) -> FlankMotion:
        """Return the pairs of wheel pin and flank (Eq. 60–64).

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, coordinates)
            q.
        start : array, shape (positions, z_P), optional
            First guess of the contact parameters; the nominal ones by default.
        shifts : array of complex, shape (positions, z_P), optional
            Displacements of the pins in the fixed frame, mm.
        """
        place, coordinates = self.placement, self.coordinates_of(pose)
        rotation, wheel_angle = pose[:, DISC_ROTATION, None], pose[:, WHEEL_ANGLE, None]
        disc_centre = (place.race_centre(crank_angle) + pose[:, X] + 1j * pose[:, Y])[:, None]
        wheel = coordinates.wheel_place
        if coordinates.wheel:  # a wheel that moves is a disc that moves the other way
            disc_centre = disc_centre - (pose[:, wheel.start] + 1j * pose[:, wheel.start + 1])[:, None]
        pin = place.wheel_pin_centres * unit(place.wheel_rotation(crank_angle)[:, None] + wheel_angle)
        arm = place.wheel_axis + pin - disc_centre
        if shifts is not None:
            arm = arm + shifts
        turn = unit(rotation)
        point = arm * turn.conjugate()
        if start is None:
            start = self.nominal_parameter(crank_angle) + wheel_angle - rotation
        parameter, curve = self.profile.nearest_point(point, start)
        tangent, second = curve.tangent, curve.second
        speed = np.sqrt(tangent.real**2 + tangent.imag**2)
        normal = -1j * tangent / speed
        distance = _dot(normal, point - curve.point)
        curvature = _cross(tangent, second) / speed**3
        offset = self.profile.contact_offset
        approach = place.wheel_pin_radii - place.wheel_pin_plays - offset - distance
        flank_curvature = curvature / (1.0 - offset * curvature)
        effective_radius = 1.0 / (1.0 / place.wheel_pin_radii + flank_curvature)

        # Distance = f(point(q)): its gradient is n·∂point, its Hessian n·∂²point + κ (t·∂point)(t·∂point), κ of the
        # parallel curve through the pin centre; ∂point = (−1, −i, −i arm, i pin) in the fixed frame.
        outward = normal * turn
        gradient, along = (np.zeros((*approach.shape, coordinates.size)) for _ in range(2))
        gradient[..., X], gradient[..., Y] = outward.real, outward.imag
        gradient[..., DISC_ROTATION], gradient[..., WHEEL_ANGLE] = _cross(arm, outward), -_cross(pin, outward)
        along[..., X], along[..., Y] = outward.imag, -outward.real
        along[..., DISC_ROTATION], along[..., WHEEL_ANGLE] = -_dot(outward, arm), _dot(outward, pin)
        if coordinates.wheel:
            gradient[..., wheel], along[..., wheel] = -gradient[..., DISC_PLACE], -along[..., DISC_PLACE]
        return FlankMotion(
            approach=approach,
            gradient=gradient,
            along=along,
            bending=curvature / (1.0 + curvature * distance),
            parameter=parameter,
            effective_radius=effective_radius,
        )

    def holes(self, crank_angle: FloatArray, pose: FloatArray, shifts: ComplexArray | None = None) -> PairMotion:
        """Return the pairs of shaft pin and hole (Eq. 59, 78–81); arguments as for `flank`."""
        place = self.placement
        disc_centre = (place.race_centre(crank_angle) + pose[:, X] + 1j * pose[:, Y])[:, None]
        arm = place.hole_centres * unit(pose[:, DISC_ROTATION, None])
        play = place.shaft_pin_centres - disc_centre - arm
        coordinates = self.coordinates_of(pose)
        ring, tips = self.tip_share * self.tips_by_ring, self.moved_by_ring(pose)
        if tips is not None:
            play = play + tips
        if shifts is not None:
            play = play + shifts
        distance = np.sqrt(play.real**2 + play.imag**2)
        direction = play / distance
        gradient, along = (np.zeros((*distance.shape, coordinates.size)) for _ in range(2))
        gradient[..., X], gradient[..., Y] = -direction.real, -direction.imag
        gradient[..., DISC_ROTATION] = -_cross(arm, direction)
        along[..., X], along[..., Y] = -direction.imag, direction.real
        along[..., DISC_ROTATION] = _dot(direction, arm)
        if tips is not None:
            gradient[..., coordinates.ring_place] = _dot(direction[..., None], ring)
            along[..., coordinates.ring_place] = _cross(ring, direction[..., None])
        approach = distance - (place.hole_radii - place.shaft_pin_radii + place.shaft_pin_plays)
        return PairMotion(approach=approach, gradient=gradient, along=along, bending=1.0 / distance)

    def bores(self, crank_angle: FloatArray, pose: FloatArray) -> BoreMotion:
        """Return where the bores stand; arguments as for `flank`."""
        place, coordinates = self.placement, self.coordinates_of(pose)
        arm = place.bore_centres * unit(pose[:, DISC_ROTATION, None])
        moved = place.race_centre(crank_angle)[:, None] - place.race_centres(crank_angle) + arm
        moved = moved + (pose[:, X] + 1j * pose[:, Y])[:, None]
        gradient = np.zeros((*moved.shape, coordinates.size), dtype=complex)
        gradient[..., X], gradient[..., Y], gradient[..., DISC_ROTATION] = 1.0, 1j, 1j * arm
        for crank in range(coordinates.cranks):
            x = coordinates.crank(crank)
            moved[:, crank] -= pose[:, x] + 1j * pose[:, x + 1]
            gradient[:, crank, x], gradient[:, crank, x + 1] = -1.0, -1j
        return BoreMotion(displacement=moved, arm=arm, gradient=gradient)

    def rollers(self, crank_angle: FloatArray) -> RollerRays:
        """Return the cage rays of the rollers (Eq. 48); they depend on the crank angle alone."""
        place = self.placement
        return RollerRays(
            direction=place.roller_rays(crank_angle),
            outermost=place.inner_race_radius + place.roller_radii,
            bore_play=place.bore_radius - place.roller_radii,
        )
