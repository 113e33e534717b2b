"""Approach of each pair at a pose and its derivatives by the pose (Eq. 45–64); conventions as in `ltca.geometry.pair_motion`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.parts import Drive
from ltca.geometry.coordinates import (
    DISC_PLACE,
    DISC_ROTATION,
    RIGID,
    WHEEL_ANGLE,
    Coordinates,
    X,
    Y,
    disc_displacement,
)
from ltca.geometry.flank import FlankProfile
from ltca.geometry.length_profile import ACROSS, lead_relief, profile_across
from ltca.geometry.pair_motion import (
    BoreMotion,
    FlankMotion,
    KnownPins,
    PairMotion,
    PairTilt,
    RollerRays,
    Turns,
    cross,
    dot,
)
from ltca.geometry.placement import Placement, Races
from ltca.geometry.rotation import unit

MAX_EXTRAPOLATION = 0.1
"""Largest change of θ by which a first guess is extrapolated, rad, times the tooth number."""
_RIGID_MEMBERS = Coordinates()


class DiscPlace(NamedTuple):
    """Inner races of a disc, its centre in the fixed frame, mm, and unit vector of its rotation, shape (positions, 1)."""

    races: Races
    centre: ComplexArray
    turn: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class ContactGeometry:
    """Places of the contact pairs of a drive and their approaches at crank angles φ_C, rad, (positions,), and poses q."""

    placement: Placement
    profile: FlankProfile
    coordinates: Coordinates  # of a pose in which every member moves that can
    plane: float | FloatArray = by_drive(0, default=0.0)  # axial place of the middle of the disc, mm
    half_width: float | FloatArray = by_drive(0, default=1.0)  # half the thickness of the disc, mm
    tip_share: float | FloatArray = by_drive(0, default=0.0)  # displacement of a shaft pin at the disc by its tip's
    tip_slope: float | FloatArray = by_drive(0, default=0.0)  # lean by the same in slices, 1/mm
    seat_share: float | FloatArray = by_drive(0, default=0.0)  # of a straight crank by its far bearing's
    wheel_gap: float | FloatArray = by_drive(0, default=0.0)  # free distance of the wheel in its main bearing, mm
    crank_gaps: FloatArray = by_drive(1, default_factory=lambda: np.zeros(2))  # of a crank in each bearing, mm
    crank_shares: FloatArray = by_drive(1, default_factory=lambda: np.zeros(2))  # its displacement by one there
    crank_slopes: FloatArray = by_drive(1, default_factory=lambda: np.zeros(2))  # its lean by the same, 1/mm
    flank_drop: FloatArray = by_drive(1, default_factory=lambda: np.zeros(0))  # from straight at `ACROSS`, mm
    roller_drop: FloatArray = by_drive(1, default_factory=lambda: np.zeros(0))  # of roller and both races
    roller_half_length: float | FloatArray = by_drive(0, default=1.0)  # mm

    @classmethod
    def of_drive(cls, drive: Drive) -> ContactGeometry:
        """Return the contact geometry of a drive of one disc."""
        bearing, support = drive.main_bearing, drive.crank.support
        wide, long = drive.disc.thickness, drive.roller_length
        own: dict[str, Any] = {}
        if drive.crank_supports is not None:
            near, far = drive.crank_supports
            share = (drive.disc.disc_planes[0] - near) / (far - near)
            if support is not None:
                own["crank_gaps"] = np.full(2, 0.5 * max(support.clearance or 0.0, 0.0))
                own["crank_shares"] = np.array([1.0 - share, share])
                own["crank_slopes"] = np.array([-1.0, 1.0]) / (far - near)
            if drive.posts is not None:
                own["seat_share"] = share
        if drive.contact.slices > 1:
            wheel, rollers = drive.pin_wheel, drive.crank_bearing
            of_pin = profile_across(wheel.pin_profile, wide, wheel.pin_radius)
            own["flank_drop"] = of_pin + lead_relief(drive.disc, 0.5 * wide * ACROSS)
            own["roller_drop"] = 2.0 * profile_across(rollers.roller_profile, long, rollers.roller_radius)
        return cls(
            placement=Placement.of_drive(drive),
            profile=FlankProfile.of_drive(drive),
            coordinates=Coordinates.of_drive(drive),
            plane=drive.disc.disc_planes[0],
            half_width=0.5 * wide,
            wheel_gap=0.0 if bearing is None else 0.5 * max(bearing.clearance or 0.0, 0.0),
            roller_half_length=0.5 * long,
            **own,
        )

    @property
    def has_loose_supports(self) -> bool:
        """Whether wheel or cranks are free in their bearings."""
        return bool(np.any(self.wheel_gap) or np.any(self.crank_gaps))

    @property
    def stands_askew(self) -> bool:
        """Whether contacts in slices close elsewhere than in their middle: parts lean, or flanks slope along their width."""
        place = self.placement
        sloping = self.flank_drop != self.flank_drop[..., ::-1]
        leans = (place.wheel_pin_leans, place.hole_leans, place.shaft_pin_leans, place.wheel_lean, place.crank_lean)
        return self.coordinates.leans and any(np.any(each) for each in (sloping, *leans))

    @property
    def tips_by_ring(self) -> ComplexArray:
        """Displacement of the tips of the shaft pins by x, y and rotation of the ring that ties them, shape (…, z_PS, 3)."""
        # At the zero of the planes, alike for all discs: inclined pins stand beside there at a disc.
        return _moved_rigidly(self.placement.shaft_pin_centres - self.plane * self.placement.shaft_pin_leans)

    @property
    def seats_by_ring(self) -> ComplexArray:
        """Displacement of the bearings of the cranks in the far flange by its x, y and rotation, shape (…, cranks, 3)."""
        return _moved_rigidly(self.placement.crank_axes - self.plane * np.asarray(self.placement.crank_lean))

    def moved_by_ring(self, pose: FloatArray) -> ComplexArray | None:
        """Return the displacement of the shaft pins at the disc by the ring, shape (positions, z_PS), mm; None without ring."""
        coordinates = self.coordinates_of(pose)
        return _moved(pose[:, coordinates.ring_place], self._by_ring) if coordinates.ring else None

    @property
    def _by_ring(self) -> ComplexArray:
        """Displacement of the shaft pins at the disc by the coordinates of the ring, shape (…, z_PS, 3)."""
        return np.asarray(np.asarray(self.tip_share)[..., None] * self.tips_by_ring)

    def coordinates_of(self, pose: FloatArray) -> Coordinates:
        """Return the coordinates of a pose: those of rigid members where it has no more than four."""
        return _RIGID_MEMBERS if pose.shape[-1] == RIGID else self.coordinates

    def nominal_parameter(self, crank_angle: FloatArray) -> FloatArray:
        """Return θ of each pin's contact at the nominal pose, rad: (φ_C + 2πi)/z_P for Δz = 1 on a flank that is not turned."""
        pins = np.angle(self.placement.wheel_pin_centres) - np.angle(self.profile.turn)
        return np.asarray(crank_angle)[:, None] / self.placement.reduction_ratio + pins

    def flank(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: FloatArray | None = None,
        shifts: ComplexArray | None = None,
        known: KnownPins | None = None,
        at: DiscPlace | None = None,
    ) -> FlankMotion:
        """Return the pairs of wheel pin and flank (Eq. 60–64, 85–87, 89) next to θ = `start`, followed from `known` pins."""
        place, coordinates, profile = self.placement, self.coordinates_of(pose), self.profile
        disc = at or self.disc_place(crank_angle, pose)
        centre, arm = self._pins(crank_angle, pose, shifts, disc)
        point = arm * disc.turn.conjugate()
        nominal = self.nominal_parameter(crank_angle) + pose[:, WHEEL_ANGLE, None] - pose[:, DISC_ROTATION, None]
        if start is None:
            start = nominal
        elif known is not None:
            turned = dot(known.turning, point - known.point)
            # Where a pin has gone far nothing that was known there is of use.
            near = np.abs(turned).max(axis=1, keepdims=True) <= MAX_EXTRAPOLATION / abs(profile.reduction_ratio)
            start = np.where(near, start + turned, nominal)
        parameter, curve = profile.nearest_point(point, start)
        tangent = curve.tangent
        square = tangent.real**2 + tangent.imag**2
        speed = np.sqrt(square)
        normal = tangent * (-1j / speed)
        distance = dot(normal, point - curve.point)
        curvature = cross(tangent, curve.second) / (square * speed)
        spread = 1.0 + curvature * distance
        offset = profile.contact_offset
        flank_curvature = curvature / (1.0 - offset * curvature)

        # Distance = f(point(q)): its gradient is n·∂point, its Hessian n·∂²point + κ (t·∂point)(t·∂point), κ of the
        # parallel curve through the pin centre; ∂point = (−1, −i, −i arm, i pin) in the fixed frame.
        outward = normal * disc.turn
        inward = outward.conjugate()
        by_disc, by_wheel = arm * inward, centre * inward  # scalar and, negative, vector products
        moved = np.zeros((*point.shape, coordinates.size), dtype=complex)  # ∂δ/∂q and, imaginary, the slip
        moved[..., X], moved[..., Y] = outward, -1j * outward
        moved[..., DISC_ROTATION], moved[..., WHEEL_ANGLE] = -1j * by_disc.conjugate(), 1j * by_wheel.conjugate()
        if coordinates.wheel:
            moved[..., coordinates.wheel_place] = -moved[..., DISC_PLACE]
        if coordinates.wheel_leans:
            moved[..., coordinates.wheel_lean_place] = -np.asarray(self.plane)[..., None] * moved[..., DISC_PLACE]
        return FlankMotion(
            approach=place.wheel_pin_radii - place.wheel_pin_plays - offset - distance,
            gradient=moved.real.copy(),
            along=moved.imag.copy(),
            bending=curvature / spread,
            parameter=parameter,
            effective_radius=1.0 / (1.0 / place.wheel_pin_radii + flank_curvature),
            point=point,
            turning=tangent / (square * spread),
        )

    def _pins(
        self, crank_angle: FloatArray, pose: FloatArray, shifts: ComplexArray | None, disc: DiscPlace
    ) -> tuple[ComplexArray, ComplexArray]:
        """Centres of the wheel pins from the axis of the wheel and from that of the disc, fixed frame (Eq. 49, 60, 62–63)."""
        place, coordinates = self.placement, self.coordinates_of(pose)
        disc_centre = disc.centre
        if coordinates.wheel:  # a displacement of the wheel is one of the disc in the opposite direction
            disc_centre = disc_centre - _vector(pose, coordinates.wheel_place)
        if coordinates.wheel_leans:
            disc_centre = disc_centre - self.plane * self.wheel_lean(pose)
        turned = place.wheel_rotation(crank_angle)[:, None] + pose[:, WHEEL_ANGLE, None]
        centres = place.wheel_pin_centres if shifts is None else place.wheel_pin_centres + shifts
        pin = centres * unit(turned)
        return pin, place.wheel_axis + pin - disc_centre

    def disc_place(self, crank_angle: FloatArray, pose: FloatArray) -> DiscPlace:
        """Return where the disc stands (Eq. 46); arguments as for `flank`."""
        races = self.placement.races(crank_angle)
        centre = (races.middle + disc_displacement(pose))[:, None]
        return DiscPlace(races, centre, unit(pose[:, DISC_ROTATION, None]))

    def holes(
        self, crank_angle: FloatArray, pose: FloatArray, shifts: ComplexArray | None = None, at: DiscPlace | None = None
    ) -> PairMotion:
        """Return the pairs of shaft pin and hole (Eq. 51, 59, 78–83, 88); arguments as for `flank`."""
        place = self.placement
        disc = at or self.disc_place(crank_angle, pose)
        arm = place.hole_centres * disc.turn
        play = place.shaft_pin_centres - disc.centre - arm
        coordinates = self.coordinates_of(pose)
        by_ring = self._by_ring if coordinates.ring else None
        if by_ring is not None:
            play = play + _moved(pose[:, coordinates.ring_place], by_ring)
        if shifts is not None:
            play = play + shifts
        distance = np.sqrt(play.real**2 + play.imag**2)
        direction = play / distance
        moved = np.zeros((*distance.shape, coordinates.size), dtype=complex)  # ∂δ/∂q and, imaginary, the slip
        moved[..., X], moved[..., Y] = -direction, 1j * direction
        moved[..., DISC_ROTATION] = 1j * (arm * direction.conjugate()).conjugate()
        if by_ring is not None:
            ahead = direction[..., None]
            moved[..., coordinates.ring_place] = dot(ahead, by_ring) + 1j * cross(by_ring, ahead)
        approach = distance - (place.hole_radii - place.shaft_pin_radii + place.shaft_pin_plays)
        return PairMotion(
            approach=approach, gradient=moved.real.copy(), along=moved.imag.copy(), bending=1.0 / distance
        )

    def lean(self, pose: FloatArray) -> ComplexArray:
        """Return the lean of the disc, rad, shape (positions, 1)."""
        return _vector(pose, self.coordinates_of(pose).lean_place)

    def wheel_lean(self, pose: FloatArray) -> ComplexArray:
        """Return what the wheel leans by in its bearing, rad, shape (positions, 1); zero where it does not."""
        return _vector(pose, self.coordinates_of(pose).wheel_lean_place)

    def journal_leans(self, pose: FloatArray) -> ComplexArray:
        """Return the lean of every crank in the plane of the disc, rad, shape (positions, cranks)."""
        coordinates, place = self.coordinates_of(pose), self.placement
        found: ComplexArray = np.zeros((pose.shape[0], place.cranks), dtype=complex)
        found += np.asarray(place.crank_lean)  # of a batch a column
        for crank in range(coordinates.cranks):
            first = coordinates.crank_lean(crank)
            found[:, crank] += pose[:, first] + 1j * pose[:, first + 1]
        return found

    def flank_tilt(self, crank_angle: FloatArray, pose: FloatArray, flank: FlankMotion) -> PairTilt:
        """Return the tilt of wheel pins and flank."""
        return flank.leaning(*self.flank_lean(crank_angle, pose), self.coordinates_of(pose))

    def flank_lean(
        self, crank_angle: FloatArray, pose: FloatArray, leans: ComplexArray | None = None
    ) -> tuple[ComplexArray, Turns]:
        """Return the lean of the disc at each wheel pin less that of the pin, with `leans` by bending, and how it turns, rad."""
        place = self.placement
        turned = unit(place.wheel_rotation(crank_angle)[:, None] + pose[:, WHEEL_ANGLE, None])
        own = (place.wheel_pin_leans if leans is None else place.wheel_pin_leans + leans) * turned
        return self.lean(pose) - place.wheel_lean - self.wheel_lean(pose) - own, {WHEEL_ANGLE: -1j * own}

    def hole_tilt(self, pose: FloatArray, holes: PairMotion) -> PairTilt:
        """Return the tilt of shaft pins and holes; arguments as for `holes`."""
        return holes.leaning(*self.hole_lean(pose), self.coordinates_of(pose))

    def hole_lean(self, pose: FloatArray, leans: ComplexArray | None = None) -> tuple[ComplexArray, Turns]:
        """Return the lean of the disc at each hole less that of the pin, with `leans` by bending, and how it follows the pose."""
        place, coordinates = self.placement, self.coordinates_of(pose)
        own = place.hole_leans * unit(pose[:, DISC_ROTATION, None])
        lean = self.lean(pose) + own - place.shaft_pin_leans
        turns: Turns = {DISC_ROTATION: 1j * own}
        if leans is not None:
            lean = lean - leans
        if coordinates.ring and np.any(self.tip_slope):
            by_ring = np.asarray(self.tip_slope)[..., None] * self.tips_by_ring
            ring = coordinates.ring_place
            lean = lean - _moved(pose[:, ring], by_ring)
            turns |= {ring.start + number: -by_ring[..., number] for number in range(3)}
        return lean, turns

    def roller_tilt(self, pose: FloatArray, bores: BoreMotion, rays: RollerRays) -> PairTilt:
        """Return the tilt of race and bore, by which the sum of both approaches of a roller grows with its height."""
        coordinates, arm = self.coordinates_of(pose), rays.resting(bores)
        count, length = arm.shape[1], np.abs(arm)
        normal = (arm / length)[..., None]
        lean = bores.each(self.journal_leans(pose) - self.lean(pose), count)[..., None]
        # The lean of each crank less that of the disc, by the pose.
        by_lean = np.zeros(bores.gradient.shape, dtype=complex)
        by_lean[..., coordinates.lean_place] = (-1.0, -1j)
        for crank in range(coordinates.cranks):
            place = coordinates.crank_lean(crank)
            by_lean[:, crank, place : place + 2] = (1.0, 1j)
        # The normal turns as the bore moves across it.
        turned = -dot(1j * normal, lean) * dot(1j * normal, bores.each(bores.gradient, count)) / length[..., None]
        return PairTilt(tilt=dot(normal, lean)[..., 0], gradient=dot(normal, bores.each(by_lean, count)) + turned)

    def bores(self, crank_angle: FloatArray, pose: FloatArray, at: DiscPlace | None = None) -> BoreMotion:
        """Return the displacements of the bores; arguments as for `flank`."""
        place, coordinates = self.placement, self.coordinates_of(pose)
        disc = at or self.disc_place(crank_angle, pose)
        races, arm = disc.races, place.bore_centres * disc.turn
        moved = races.middle[:, None] - races.centre + arm + disc_displacement(pose)[:, None]
        gradient = np.zeros((*moved.shape, coordinates.size), dtype=complex)
        gradient[..., X], gradient[..., Y], gradient[..., DISC_ROTATION] = 1.0, 1j, 1j * arm
        for crank in range(coordinates.cranks):
            x = coordinates.crank(crank)
            moved[:, crank] -= pose[:, x] + 1j * pose[:, x + 1]
            gradient[:, crank, x], gradient[:, crank, x + 1] = -1.0, -1j
        if coordinates.ring and not coordinates.cranks:  # rigid cranks go with their bearing in the far flange
            by_ring = np.asarray(self.seat_share)[..., None] * self.seats_by_ring
            moved = moved - _moved(pose[:, coordinates.ring_place], by_ring)
            gradient[..., coordinates.ring_place] = -by_ring
        lever, twists = races.lever, coordinates.twist_places
        if twists:
            lever = races.lever * unit(pose[:, twists])
            moved -= lever - races.lever
            gradient[:, np.arange(len(twists)), twists] = -1j * lever
        return BoreMotion(displacement=moved, arm=arm, gradient=gradient, lever=lever, twists=twists)

    def rollers(self, crank_angle: FloatArray) -> RollerRays:
        """Return the cage rays of the rollers (Eq. 48), which depend on the crank angle alone."""
        place = self.placement
        return RollerRays(
            direction=place.roller_rays(crank_angle),
            outermost=place.inner_race_radius + place.roller_radii,
            bore_play=place.bore_radius - place.roller_radii,
        )


def _vector(pose: FloatArray, place: slice) -> ComplexArray:
    """Displacement or lean of a part at two places of poses, shape (positions, 1); zero where there are none."""
    both = pose[:, place]
    return both[:, :1] + 1j * both[:, 1:] if both.size else np.zeros((pose.shape[0], 1), dtype=complex)


def _moved(ring: FloatArray, by_ring: ComplexArray) -> ComplexArray:
    """Displacements at coordinates of the ring, shape (positions, 3), from those at unit coordinates."""
    return np.asarray(np.matmul(ring[:, None], by_ring.swapaxes(-1, -2))[:, 0])


def _moved_rigidly(places: ComplexArray) -> ComplexArray:
    """Displacement of places of a body by its x, y and rotation, shape (…, places, 3)."""
    return np.stack((np.ones_like(places), np.full_like(places, 1j), 1j * places), axis=-1)
