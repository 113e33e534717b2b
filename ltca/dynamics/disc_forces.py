"""Contacts of one disc at one instant: the mechanics of `ltca.compliance.uncoupled` without a batch axis, for runs in time.

A run in time asks for the forces some hundred thousand times, each a hair further on. Contact places and shares of the rollers
start where the last call left them, moved on to first order, and Newton's method ends after a step or two; what does not settle
so is left to the functions that solve equilibria. Answers do not depend on the start beyond their tolerances.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.compliance.rollers import balance_rollers
from ltca.compliance.stored_energy import StoredEnergy
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.flank import CurvePoints, NearestPoint
from ltca.geometry.pair_motion import RollerRays, cross, dot
from ltca.geometry.pairs import MAX_EXTRAPOLATION
from ltca.geometry.rotation import unit

FLATTEST = 0.05
"""Least slope of Newton's function by that on the curve itself: pins nearer to a centre of curvature start anew."""
PLACE_SETTLED = 1e-8
"""Last step of a contact parameter, rad: distances are off by its square then."""
SHARE_SETTLED = 1e-6
"""Last step of the share of a roller; loads are corrected linearly for it, as in `ltca.compliance.rollers`."""
STEPS = 6
"""Newton steps tried before the solvers of equilibria are asked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscForces:
    """Contacts of a disc at one instant; k coordinates of its pose.

    Attributes
    ----------
    force : array, shape (k,)
        Generalised force of the contacts, ∂U/∂q, N and N·mm.
    by_crank : float
        ∂U/∂φ_C at a held pose, with which disc and wheel go along as they nominally do, N·mm.
    nominal : array, shape (k,)
        That nominal motion by the crank angle, mm and rad.
    pin_load, hole_load : array, shape (pairs,)
        N.
    pin_gradient, hole_gradient : array, shape (pairs, k)
        ∂δ/∂q.
    pin_slip, hole_slip : array, shape (pairs, k)
        Slip of the pin against the disc along the tangent by q (`ltca.equilibrium.friction.slip`).
    stiffness : array, shape (k + 1, k + 1)
        Σ k g gᵀ over the contacts, of the pose and, last, the crank angle: without what turns with them.
    crank_moment : array, shape (cranks,)
        Moment that holds each crank against this disc, N·mm.
    push : array of complex, shape (cranks,)
        Force of every crank bearing on the disc, N.
    inner_load, outer_load : array, shape (rollers,)
        N.
    wheel_force : complex
        Sum of the normal forces of the disc on the wheel pins, N.
    wheel_along : array of complex, shape (pairs,)
        Direction of friction on each wheel pin.
    """

    force: FloatArray
    by_crank: float
    nominal: FloatArray
    pin_load: FloatArray
    hole_load: FloatArray
    pin_gradient: FloatArray
    hole_gradient: FloatArray
    pin_slip: FloatArray
    hole_slip: FloatArray
    stiffness: FloatArray
    crank_moment: FloatArray
    push: ComplexArray
    inner_load: FloatArray
    outer_load: FloatArray
    wheel_force: complex
    wheel_along: ComplexArray


class DiscContacts:
    """Contacts of one disc that do not feel each other, followed in time.

    Parameters
    ----------
    model : HalfSpaceCompliance
        Laws of the contacts, in the plane.
    """

    def __init__(self, model: HalfSpaceCompliance) -> None:
        geometry = model.geometry
        self._model, self._geometry, self._place = model, geometry, geometry.placement
        self._profile, self._coordinates = geometry.profile, geometry.coordinates
        place = self._place
        self._arms = place.eccentricity * unit(place.eccentric_phase)
        self._rays = unit(place.roller_cage_angles)
        self._ratio, self._cage = float(place.reduction_ratio), float(place.cage_speed)
        self._outermost = float(place.inner_race_radius) + place.roller_radii
        self._bore_play = float(place.bore_radius) - place.roller_radii
        self._by_ring = geometry._by_ring if self._coordinates.ring else None
        self._crank_of = place.roller_cranks
        self._cusped = bool(np.any(self._profile.has_cusps))
        self._parameter: FloatArray | None = None
        self._point = np.zeros(place.wheel_pin_radii.size, dtype=complex)
        self._turning = self._point
        self._share = np.full(place.roller_radii.size, 0.5)
        self.state: dict[str, FloatArray] = {}

    @property
    def warm_start(self) -> tuple[FloatArray | ComplexArray | None, ...]:
        """Contact parameters, what moves them on to first order, and shares of rollers: where the next call starts."""
        return self._parameter, self._point, self._turning, self._share

    @warm_start.setter
    def warm_start(self, kept: tuple[Any, ...]) -> None:
        """Start the next call from these."""
        # Shares are changed in place.
        self._parameter, self._point, self._turning, self._share = *kept[:3], kept[3].copy()

    def at(self, angle: float, q: FloatArray) -> DiscForces:
        """Return the forces at a crank angle, rad, and a pose of the disc, shape (k,)."""
        place, size = self._place, q.size
        going = complex(np.cos(angle), np.sin(angle))
        levers = self._arms * going
        races = place.crank_axes + levers
        middle, velocity = complex(races.mean()), complex((1j * levers).mean())
        centre = middle + complex(q[X], q[Y])
        turn = complex(np.cos(q[DISC_ROTATION]), np.sin(q[DISC_ROTATION]))
        nominal = np.zeros(size)
        nominal[X], nominal[Y], nominal[WHEEL_ANGLE] = velocity.real, velocity.imag, 1.0 / self._ratio
        force, stiffness = np.zeros(size), np.zeros((size + 1, size + 1))
        pins = self._pins(angle, q, centre, turn)
        holes = self._holes(q, centre, turn)
        for load, stiff, gradient, _ in (pins[:4], holes[:4]):
            force += load @ gradient
            whole = np.column_stack((gradient, gradient @ nominal))
            stiffness += whole.T @ (stiff[:, None] * whole)
        push, displacement, lever, inner, outer = self._bearings(angle, q, middle, races, turn, force, stiffness)
        held = (lever.conjugate() * push).imag + self._cage * (displacement.conjugate() * push).imag
        normal = pins[2][:, X] + 1j * pins[2][:, Y]
        return DiscForces(
            force=force,
            by_crank=float(held.sum() + force @ nominal),
            nominal=nominal,
            pin_load=pins[0],
            hole_load=holes[0],
            pin_gradient=pins[2],
            hole_gradient=holes[2],
            pin_slip=pins[3],
            hole_slip=holes[3],
            stiffness=stiffness,
            crank_moment=held,
            push=push,
            inner_load=inner,
            outer_load=outer,
            wheel_force=complex(pins[0] @ normal),
            wheel_along=-1j * normal,
        )

    def _pins(self, angle: float, q: FloatArray, centre: complex, turn: complex) -> tuple[FloatArray, ...]:
        """Load, stiffness, gradient and slip of wheel pins and flank, as `ContactGeometry._touching`."""
        place, coordinates, profile = self._place, self._coordinates, self._profile
        if coordinates.wheel:
            wheel = coordinates.wheel_place
            centre = centre - complex(q[wheel.start], q[wheel.start + 1])
        turned = angle / self._ratio + q[WHEEL_ANGLE]
        pin = place.wheel_pin_centres * complex(np.cos(turned), np.sin(turned))
        arm = complex(place.wheel_axis) + pin - centre
        point = arm * turn.conjugate()
        most = MAX_EXTRAPOLATION / abs(self._ratio)
        theta, settled = self._parameter, False
        if theta is not None:
            theta = theta + dot(self._turning, point - self._point).clip(-most, most)
            for _ in range(STEPS):
                curve = profile.contact_curve(unit(theta))
                away, tangent, second = curve.point - point, curve.tangent, curve.second
                square = tangent.real**2 + tangent.imag**2
                slope = square + dot(second, away)
                step = dot(tangent, away) / slope
                moved = float(np.abs(step).max())
                # Near a centre of curvature a foot may jump: those are looked for as if nothing were known.
                if not (moved < most and np.all(slope > FLATTEST * square)):
                    break
                theta = theta - step
                if moved < PLACE_SETTLED:
                    settled = True
                    break
        if settled and theta is not None and self._cusped:
            found = profile.nearer_side(point, NearestPoint(theta, curve))
            settled = bool(np.all(found.parameter == theta))
        if not settled:
            nominal = self._geometry.nominal_parameter(np.array([angle]))[0] + q[WHEEL_ANGLE] - q[DISC_ROTATION]
            found = profile.nearest_point(point[None], nominal[None])
            theta = found.parameter[0]
            curve = CurvePoints(*(each[0] for each in found.curve))
            away, tangent, second = curve.point - point, curve.tangent, curve.second
            square = tangent.real**2 + tangent.imag**2
        speed = np.sqrt(square)
        normal = -1j * tangent / speed
        distance = -dot(normal, away)
        curvature = cross(tangent, second) / (square * speed)
        offset = float(profile.contact_offset)
        self._parameter, self._point = theta, point
        self._turning = tangent / (square * (1.0 + curvature * distance))
        reach = place.wheel_pin_radii - place.wheel_pin_plays
        approach = reach - offset - distance
        radius = 1.0 / (1.0 / place.wheel_pin_radii + curvature / (1.0 - offset * curvature))
        load, stiffness = self._model.pin_law.load_and_stiffness(approach, radius)
        outward = normal * turn
        gradient, slip = np.zeros((load.size, q.size)), np.zeros((load.size, q.size))
        gradient[:, X], gradient[:, Y] = outward.real, outward.imag
        gradient[:, DISC_ROTATION], gradient[:, WHEEL_ANGLE] = cross(arm, outward), -cross(pin, outward)
        nearer = reach - np.maximum(approach, 0.0)
        slip[:, X], slip[:, Y] = outward.imag, -outward.real
        slip[:, DISC_ROTATION] = nearer - dot(outward, arm)
        slip[:, WHEEL_ANGLE] = dot(outward, pin) - nearer
        if coordinates.wheel:
            gradient[:, wheel], slip[:, wheel] = -gradient[:, :2], -slip[:, :2]
        self.state["pin_approach"], self.state["pin_radius"] = approach, radius
        return load, stiffness, gradient, slip

    def _holes(self, q: FloatArray, centre: complex, turn: complex) -> tuple[FloatArray, ...]:
        """The same of shaft pins and holes, as `ContactGeometry.holes`."""
        place, coordinates = self._place, self._coordinates
        arm = place.hole_centres * turn
        play = place.shaft_pin_centres - centre - arm
        if self._by_ring is not None:
            play = play + self._by_ring @ q[coordinates.ring_place]
        distance = np.abs(play)
        direction = play / distance
        approach = distance - (place.hole_radii - place.shaft_pin_radii + place.shaft_pin_plays)
        load, stiffness = self._model.hole_law.load_and_stiffness(approach, place.hole_effective_radii)
        gradient, slip = np.zeros((load.size, q.size)), np.zeros((load.size, q.size))
        gradient[:, X], gradient[:, Y] = -direction.real, -direction.imag
        gradient[:, DISC_ROTATION] = -cross(arm, direction)
        slip[:, X], slip[:, Y] = -direction.imag, direction.real
        slip[:, DISC_ROTATION] = dot(direction, arm) + place.hole_radii
        if self._by_ring is not None:
            gradient[:, coordinates.ring_place] = dot(direction[:, None], self._by_ring)
            slip[:, coordinates.ring_place] = cross(self._by_ring, direction[:, None])
        self.state["hole_approach"] = approach
        return load, stiffness, gradient, slip

    def _bearings(
        self,
        angle: float,
        q: FloatArray,
        middle: complex,
        races: ComplexArray,
        turn: complex,
        force: FloatArray,
        stiffness: FloatArray,
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray, FloatArray, FloatArray]:
        """Push, displacement of bores, levers and loads of rollers; adds their force and stiffness in place."""
        place, coordinates = self._place, self._coordinates
        arm = place.bore_centres * turn
        displaced = middle - races + arm + complex(q[X], q[Y])
        gradient = np.zeros((arm.size, q.size), dtype=complex)
        gradient[:, X], gradient[:, Y], gradient[:, DISC_ROTATION] = 1.0, 1j, 1j * arm
        for crank in range(coordinates.cranks):
            x = coordinates.crank(crank)
            displaced[crank] -= complex(q[x], q[x + 1])
            gradient[crank, x], gradient[crank, x + 1] = -1.0, -1j
        if self._by_ring is not None and not coordinates.cranks:
            by_ring = np.atleast_2d(self._geometry.cranks_by_ring)
            displaced = displaced - by_ring @ q[coordinates.ring_place]
            gradient[:, coordinates.ring_place] = -by_ring
        lever, twists = races - place.crank_axes, coordinates.twist_places
        if twists:
            straight = lever
            lever = straight * unit(q[list(twists)])
            displaced = displaced - (lever - straight)
            gradient[np.arange(len(twists)), list(twists)] = -1j * lever
        inner, outer, outward, tangent = self._rollers(angle, displaced)
        cranks = arm.size
        push = (outer * outward).reshape(cranks, -1).sum(axis=1)
        force -= (push.conjugate() @ gradient).real
        each = tangent.reshape(cranks, -1, 4).sum(axis=1).reshape(cranks, 2, 2)
        for crank in range(cranks):
            moved = np.stack((gradient[crank].real, gradient[crank].imag))
            stiffness[:-1, :-1] += moved.T @ each[crank] @ moved
        return push, displaced, lever, inner, outer

    def _rollers(
        self, angle: float, displaced: ComplexArray
    ) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
        """Loads of the rollers in both contacts, directions in the bore and tangents, as `balance_rollers`."""
        turned = self._cage * angle
        direction = self._rays * complex(np.cos(turned), np.sin(turned))
        moved = displaced[self._crank_of]
        along = dot(direction, moved)
        across = (direction.conjugate() * moved).imag
        total = self._outermost - along - np.sqrt(np.maximum(self._bore_play**2 - across**2, 0.0))
        inner, outer = np.zeros(total.size), np.zeros(total.size)
        tangent, outward = np.zeros((total.size, 4)), direction.copy()
        inner_approach, outer_approach = np.zeros(total.size), np.zeros(total.size)
        pressed = np.flatnonzero(total > 0.0)
        laws = self._model.roller_laws
        if pressed.size:
            n, d, whole, a = direction[pressed], moved[pressed], total[pressed], along[pressed]
            outermost, play, share = self._outermost[pressed], self._bore_play[pressed], self._share[pressed]
            inner_radius, outer_radius = laws.inner_radius[pressed], laws.outer_radius[pressed]
            lowest = outermost - whole
            for _ in range(STEPS):
                place = outermost - share * whole
                arm = place * n - d
                length = np.abs(arm)
                out = arm / length
                cosine = dot(out, n)
                near, far = share * whole, (1.0 - share) * whole * (place + lowest - 2.0 * a) / (length + play)
                inner_load, inner_stiff = laws.inner.load_and_stiffness(near, inner_radius)
                outer_load, outer_stiff = laws.outer.load_and_stiffness(far, outer_radius)
                yields = inner_stiff + outer_stiff * cosine**2 + outer_load * (1.0 - cosine**2) / length
                step = -(inner_load - outer_load * cosine) / (yields * whole)
                following = share + step
                if not (np.all(following > 0.0) and np.all(following < 1.0)):
                    return self._balanced(direction, displaced)
                inward, share = step * whole, following
                if np.abs(step).max() <= SHARE_SETTLED:
                    break
            else:
                return self._balanced(direction, displaced)
            self._share[pressed] = share
            inner[pressed] = inner_load + inner_stiff * inward
            outer[pressed] = outer_load - outer_stiff * cosine * inward
            inner_approach[pressed], outer_approach[pressed] = near + inward, far - cosine * inward
            outward[pressed] = out
            soft = 1.0 / (1.0 / inner_stiff + 1.0 / outer_stiff)
            tangent[pressed, 0], tangent[pressed, 3] = soft * out.real**2, soft * out.imag**2
            tangent[pressed, 1] = tangent[pressed, 2] = soft * out.real * out.imag
        self.state["inner_approach"], self.state["outer_approach"] = inner_approach, outer_approach
        return inner, outer, outward, tangent

    def _balanced(
        self, direction: ComplexArray, displaced: ComplexArray
    ) -> tuple[FloatArray, FloatArray, ComplexArray, FloatArray]:
        """The same by the solver of equilibria."""
        rays = RollerRays(direction=direction[None], outermost=self._outermost, bore_play=self._bore_play)
        found = balance_rollers(rays, displaced[self._crank_of][None], self._model.roller_laws)
        self._share = found.share[0].clip(1e-3, 1.0 - 1e-3)
        self.state["inner_approach"] = np.maximum(found.inner_approach[0], 0.0)
        self.state["outer_approach"] = np.maximum(found.outer_approach[0], 0.0)
        return found.inner_load[0], found.outer_load[0], found.outer_direction[0], found.tangent[0].reshape(-1, 4)

    def stored(self) -> StoredEnergy:
        """Return what is stored at the last instant, as one position."""
        model, laws = self._model, self._model.roller_laws
        at = {name: values[None] for name, values in self.state.items()}
        return StoredEnergy.of_laws(
            (model.pin_law, at["pin_approach"], at["pin_radius"]),
            [
                (model.hole_law, at["hole_approach"], self._place.hole_effective_radii),
                (laws.inner, at["inner_approach"], laws.inner_radius),
                (laws.outer, at["outer_approach"], laws.outer_radius),
            ],
        )
