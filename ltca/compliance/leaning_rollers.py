"""Rollers of a crank bearing in slices: each takes the place and the lean at which its two contacts balance in force and moment.

A roller stands on its cage ray n at the distance s and leans by ψ along it. The race leans by :math:`\\lambda_c` and the bore by
:math:`\\lambda`, so that the two contacts tilt by :math:`\\theta_i = \\lambda_c \\cdot n - \\psi` and
:math:`\\theta_o = \\psi - \\lambda \\cdot n`: between the ray and the normal in the bore nothing is lost but the square of their
angle. s and ψ are where the energy of both contacts is least.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.rollers import RollerLaws, RollerState
from ltca.errors import ConvergenceError
from ltca.geometry.pair_motion import RollerRays, cross, dot
from ltca.laws.between_contacts import SETTLED, PartStiffness, newton_step, shorten_steps, unbalanced
from ltca.laws.sliced_contact import EXACT, LAST_STEP_ERROR, Exactness, SlicedContact, slice_heights
from ltca.laws.sliced_line import SlicedLine

FARTHEST = 1.5
"""Place of a roller from the middle of its overlap, as a part of the overlap, up to which it is where to start elsewhere."""

_Near = tuple[FloatArray | None, FloatArray | None]
_Contacts = tuple[SlicedContact, SlicedContact, ComplexArray, FloatArray]
_ALL = slice(None)


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerStart:
    """Rollers of a neighbouring solution.

    Attributes
    ----------
    inward, lean : array, shape (positions, rollers)
        Place inward from where the roller rests in the bore alone, as a part of the overlap, and lean, rad.
    inner, outer : array, shape (positions, rollers, 2 + 3 slices) or (…, 0)
        Contacts on the race and in the bore (`ltca.laws.sliced_contact.SlicedContact.near`).
    place : array, shape (positions, rollers)
        Place inward, mm.
    stood : array, shape (positions, rollers, 6)
        What placed them: displacement of the bore along and across the ray, mm, leans of bore and race along it, rad, and what
        the bodies took of both approaches, mm.
    follow : array, shape (positions, rollers, 2, 6)
        How place outward and lean follow that.
    """

    inward: FloatArray
    lean: FloatArray
    inner: FloatArray
    outer: FloatArray
    place: FloatArray
    stood: FloatArray
    follow: FloatArray


def balance_leaning_rollers(
    rays: RollerRays,
    displacement: ComplexArray,
    laws: RollerLaws[SlicedLine],
    leans: tuple[FloatArray, FloatArray],
    start: RollerStart | None = None,
    given: tuple[FloatArray | float, FloatArray | float] = (0.0, 0.0),
    exactness: Exactness = EXACT,
    given_tilts: tuple[FloatArray, FloatArray] | None = None,
) -> RollerState:
    """Place every roller so that its contacts balance; arguments as for `ltca.compliance.rollers.balance_rollers`.

    `leans` are those of race and bore along the rays, rad, shape (positions, rollers); `start` is what stood nearby, and `given`
    what the bodies take of the approaches in the bore and on the race, mm, shape (positions, rollers), as `given_tilts` of the
    tilts, rad, where they yield unevenly along the width.
    """
    if given_tilts is not None:
        # A wall that gives way under a moment leans: what it takes of a tilt is a lean of bore or race more.
        leans = leans[0] - given_tilts[1], leans[1] + given_tilts[0]
    shape = rays.direction.shape
    pressed = _PressedRollers(rays, displacement, laws, leans, given, exactness)
    pressed.begin(start)
    pressed.balance()
    rows, numbers, ray = pressed.rows, pressed.numbers, pressed.ray
    inner, outer, outward, inward, lean = pressed.inner, pressed.outer, pressed.outward, pressed.inward, pressed.lean
    overlap = pressed.overlap
    tangent, follow = _eliminated(pressed, tilts=given_tilts is not None)
    found: dict[str, NDArray[Any]] = {
        "share": np.divide(inward, overlap, out=np.full(inward.shape, 0.5), where=overlap > 0.0),
        "inner_approach": inward,
        "outer_approach": np.abs((pressed.outermost - inward) * ray - pressed.moved) - pressed.play,
        "inner_load": inner.load,
        "outer_load": outer.load,
        "outer_direction": outward,
        "tangent": tangent,
        "stood": pressed.stands,
        "follow": follow,
        "outer_moment": outer.moment,
        "inner_moment": inner.moment,
        "lean": lean,
        "inner_tilt": pressed.at_race - lean,
        "outer_tilt": lean - pressed.at_bore,
        "left": pressed.left,
        "inner_near": inner.near,
        "outer_near": outer.near,
        "inner_slices": inner.slice_load,
        "outer_slices": outer.slice_load,
        "inner_lines": inner.line_load,
        "outer_lines": outer.line_load,
    }
    arm = rays.outermost * rays.direction - displacement
    rest = np.abs(arm)
    # Of rollers that nothing presses.
    free = {"share": 0.5, "outer_approach": rest - rays.bore_play, "outer_direction": arm / rest}
    everywhere: dict[str, Any] = {}
    for name, values in found.items():
        full = np.zeros((*shape, *values.shape[1:]), dtype=values.dtype)
        full[...] = free.get(name, 0.0)
        full[rows, numbers] = values
        everywhere[name] = full
    return RollerState(**everywhere)


class _PressedRollers:
    """Rollers between race and bore that may be pressed, in a row, where they stand and what they carry.

    ``inward`` and ``lean`` are their places, mm, and leans, rad; ``inner`` and ``outer`` their contacts, ``outward`` the
    direction of the load in the bore and ``length`` its arm, mm.
    """

    def __init__(
        self,
        rays: RollerRays,
        displacement: ComplexArray,
        laws: RollerLaws[SlicedLine],
        leans: tuple[FloatArray, FloatArray],
        given: tuple[FloatArray | float, FloatArray | float],
        exactness: Exactness,
    ) -> None:
        self.alike = _are_alike(laws.inner, laws.outer)
        """Whether one law says what the contacts on race and in bore carry, both asked at once."""
        self.laws, self.half, self.exactness = laws, 0.5 * laws.outer.length, exactness
        total = rays.outermost - rays.touching_distance(displacement)
        highest = slice_heights(laws.outer.length, laws.outer.slices).max()
        pressed = total - (given[0] + given[1]) + highest * np.abs(leans[0] - leans[1]) > 0.0
        self.rows, self.numbers = np.nonzero(pressed)

        def each(values: NDArray[Any] | float) -> NDArray[Any]:
            return np.asarray(np.broadcast_to(values, pressed.shape)[self.rows, self.numbers])

        self.ray, self.moved, self.outermost = each(rays.direction), each(displacement), each(rays.outermost)
        self.inner_radius, self.outer_radius = each(laws.inner_radius), each(laws.outer_radius)
        self.at_race, self.at_bore, self.overlap, self.play = (each(one) for one in (*leans, total, rays.bore_play))
        self.from_bore, self.from_race = (each(one) for one in given)
        self.along, self.lowest = dot(self.ray, self.moved), self.outermost - self.overlap
        across = cross(self.ray, self.moved)
        self.stands = np.stack((self.along, across, self.at_bore, self.at_race, self.from_bore, self.from_race), axis=1)
        # What leans of race and bore press together at the end.
        apart = self.half * np.abs(self.at_race - self.at_bore)
        self.spread, self.reach = (
            np.abs(self.overlap) + apart,
            np.abs(self.overlap - self.from_bore - self.from_race) + apart,
        )
        # What round-off of places makes of a load.
        self.last_step = np.zeros(self.rows.size)
        self.lightest = np.spacing(self.outermost) * laws.outer.contact_modulus * laws.outer.length / SETTLED

    def begin(self, start: RollerStart | None) -> None:
        """Place the rollers where they stood nearby, moved on by what has changed; otherwise half way."""
        inward = self.from_race + 0.5 * (self.overlap - self.from_race - self.from_bore)
        lean = 0.5 * (self.at_race + self.at_bore)
        near: _Near = (None, None)
        if start is not None:
            place, leaned, share, stood, follow, inner, outer = (
                values[self.rows, self.numbers]
                for values in (
                    start.place,
                    start.lean,
                    start.inward,
                    start.stood,
                    start.follow,
                    start.inner,
                    start.outer,
                )
            )
            # One that leaned by more than what presses it now is better begun anew.
            known = follow.any(axis=(1, 2)) & (self.half * np.abs(leaned - lean) <= self.spread)
            # Of a roller that touched at its end alone the overlap in the middle was nothing to go by.
            inward = np.where(known & (np.abs(share - 0.5) < FARTHEST), share * self.overlap, inward)
            lean = np.where(known, leaned, lean)
            outward, turned = np.einsum("rij,rj->ir", follow, self.stands - stood)
            close = known & (np.abs(outward) + self.half * np.abs(turned) <= 0.5 * self.spread)
            inward, lean = np.where(close, place - outward, inward), np.where(close, leaned + turned, lean)
            near = inner, outer
        self.inward, self.lean = inward, lean
        self.inner, self.outer, self.outward, self.length = self.contacts(_ALL, inward, lean, near)

    def placed(self, which: Any, inward: FloatArray) -> tuple[FloatArray, ComplexArray, FloatArray]:
        """Approach in the bore, direction and arm of its load with some rollers at other places."""
        place = self.outermost[which] - inward
        arm = place * self.ray[which] - self.moved[which]
        length = np.abs(arm)
        # |s n − d| less the bore play as a product, as for rollers that do not lean.
        beyond = place + self.lowest[which] - 2.0 * self.along[which]
        outer = (self.overlap[which] - inward) * beyond / (length + self.play[which])
        return outer - self.from_bore[which], arm / length, length

    def contacts(self, which: Any, inward: FloatArray, lean: FloatArray, near: _Near) -> _Contacts:
        """Contacts of some rollers at other places and leans."""
        outer, outward, length = self.placed(which, inward)
        at_race = inward - self.from_race[which], self.at_race[which] - lean, self.inner_radius[which], near[0]
        in_bore = outer, lean - self.at_bore[which], self.outer_radius[which], near[1]
        if self.alike:
            approach, tilt, radius = (
                np.stack((one, other)) for one, other in zip(at_race[:3], in_bore[:3], strict=True)
            )
            begin = None if near[0] is None or near[1] is None else np.stack((near[0], near[1]))
            contacts = self.laws.inner.respond(approach, tilt, radius, begin, self.exactness).halves
        else:
            contacts = (
                self.laws.inner.respond(*at_race, self.exactness),
                self.laws.outer.respond(*in_bore, self.exactness),
            )
        return (*contacts, outward, length)

    def balance(self) -> None:
        """Move the rollers until the forces and moments of their contacts balance."""
        history: list[float] = []
        before = np.full(self.rows.size, np.inf)
        for step in range(self.exactness.steps + 1):
            force, moment = _imbalance(self.inner, self.outer, self.outward, self.ray)
            size = np.maximum(np.maximum(self.inner.load, self.outer.load), self.lightest)
            left = np.maximum(np.abs(force), np.abs(moment) / self.half) / size
            history.append(float(np.max(left, initial=0.0)))
            going = unbalanced(left, before)
            if not going.size:
                return
            if step == self.exactness.steps:
                break
            before = left
            near = left[going] < self.exactness.rollers
            far = np.concatenate((going[~near], self.along_slopes(going[near])))
            self.last_step[going] += LAST_STEP_ERROR * left[going] ** 2 * size[going]
            self.last_step[far] = 0.0
            if far.size:
                self.downhill(np.sort(far))
        if self.exactness is EXACT:
            raise ConvergenceError(
                "leaning rollers do not balance between the races; force left over by the load", history
            )
        self.last_step[going] += left[going] * size[going]

    @property
    def left(self) -> FloatArray:
        """Force that may be left over, N."""
        inner, outer = (0.0 if contact.left is None else contact.left for contact in (self.inner, self.outer))
        return np.maximum(self.last_step, np.maximum(inner, outer))

    @property
    def stands_at(self) -> _Contacts:
        """Contacts of all rollers, directions and arms of their loads in the bore."""
        return self.inner, self.outer, self.outward, self.length

    def newton(self, which: NDArray[np.intp]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Newton's step of the places and leans of some rollers, and the slope of the energy along it."""
        force, moment = (values[which] for values in _imbalance(self.inner, self.outer, self.outward, self.ray))
        stiffness = _own_stiffness(self.stands_at, self.ray, self.half).take(which)
        # Beyond half of what is pressed together at the end other slices meet than the slopes know of.
        return newton_step(force, moment, stiffness, 0.5 * self.reach[which] / self.half)

    def along_slopes(self, which: NDArray[np.intp]) -> NDArray[np.intp]:
        """Take Newton's step of some rollers along the slopes of their contacts; return those whose contacts change in it."""
        if not which.size or self.inner.steady is None or self.outer.steady is None:
            return which
        step, turn, _ = self.newton(which)
        before, _, _ = self.placed(which, self.inward[which])
        after, outward, length = self.placed(which, self.inward[which] + step)
        bent = self.half * np.abs(turn)
        part = self.exactness.steady
        steady = np.abs(step) + bent <= part * self.inner.steady[which]
        steady &= np.abs(after - before) + bent <= part * self.outer.steady[which]
        some = which[steady]
        self.inner.shift(some, step[steady], -turn[steady], 2.0 * self.half)
        self.outer.shift(some, (after - before)[steady], turn[steady], 2.0 * self.half)
        self.inward[some] += step[steady]
        self.lean[some] += turn[steady]
        self.outward[some], self.length[some] = outward[steady], length[steady]
        return which[~steady]

    def downhill(self, going: NDArray[np.intp]) -> None:
        """Take Newton's step of some rollers, shortened where the energy rises again steeply at its end."""
        near = self.inner.near[going], self.outer.near[going]
        step, turn, slope = self.newton(going)
        inward, lean = self.inward[going], self.lean[going]

        def move(some: NDArray[np.intp], fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
            rows, by, round_by = going[some], step[some], turn[some]
            self.inward[rows], self.lean[rows] = inward[some] + fraction * by, lean[some] + fraction * round_by
            there = self.contacts(rows, self.inward[rows], self.lean[rows], (near[0][some], near[1][some]))
            self.inner.put(rows, there[0])
            self.outer.put(rows, there[1])
            self.outward[rows], self.length[rows] = there[2:]
            force, moment = _imbalance(*there[:3], self.ray[rows])
            bend = _own_stiffness(there, self.ray[rows], self.half).along(by, round_by)
            return force * by + moment * round_by, bend

        shorten_steps(slope, move)


def _are_alike(inner: Any, outer: Any) -> bool:
    """Whether two laws say the same of contacts of the same radii."""
    return isinstance(inner, SlicedLine) and isinstance(outer, SlicedLine) and inner.is_like(outer)


def _imbalance(
    inner: SlicedContact, outer: SlicedContact, outward: ComplexArray, ray: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Slopes of the energy by place inward and lean."""
    return inner.load - outer.load * dot(outward, ray), outer.moment - inner.moment


def _own_stiffness(contacts: _Contacts, ray: ComplexArray, half: float) -> PartStiffness:
    """Second derivatives of the energy by place inward and lean."""
    inner, outer, outward, length = contacts
    cosine = dot(outward, ray)
    bend = outer.load * (1.0 - cosine**2) / length
    return PartStiffness(
        inner.by_approach + outer.by_approach * cosine**2 + bend,
        -(inner.by_tilt + outer.by_tilt * cosine),
        inner.moment_by_tilt + outer.moment_by_tilt,
        half,
    )


def _eliminated(rollers: _PressedRollers, *, tilts: bool) -> tuple[FloatArray, FloatArray]:
    """Second derivative of the eliminated energy by displacement (x, y) and lean (x, y) of the bore and what the bodies take of
    the approaches in the bore and on the race, with `tilts` of the tilts there as well, shape (rollers, 6, 6) or (…, 8, 8); and
    how place outward and lean follow what places the roller (`RollerStart`).
    """
    ray, outward, inner, outer = rollers.ray, rollers.outward, rollers.inner, rollers.outer
    cosine = dot(outward, ray)
    slant = ray.imag * outward.real - ray.real * outward.imag
    bend = outer.load / rollers.length
    normal = np.stack((outward.real, outward.imag), axis=-1)
    across = np.stack((-outward.imag, outward.real), axis=-1)
    n = np.stack((ray.real, ray.imag), axis=-1)
    k, x, m = (each[:, None] for each in (outer.by_approach, outer.by_tilt, outer.moment_by_tilt))
    # By place outward and lean of the roller, for displacement and lean of the bore and what is taken of the approaches.
    first, second = (
        np.stack((one, other), axis=1)
        for one, other in ((outer.by_approach * cosine, -inner.by_approach), (outer.by_tilt, -inner.by_tilt))
    )
    by_place = np.concatenate(
        (-k * cosine[:, None] * normal - (bend * slant)[:, None] * across, -x * cosine[:, None] * n, -first), axis=1
    )
    by_lean = np.concatenate((-x * normal, -m * n, -second), axis=1)
    size = 8 if tilts else 6
    direct = np.zeros((ray.size, size, size))
    direct[:, :2, :2] = (
        k[..., None] * normal[:, :, None] * normal[:, None] + bend[:, None, None] * across[:, :, None] * across[:, None]
    )
    direct[:, :2, 2:4] = x[..., None] * normal[:, :, None] * n[:, None]
    direct[:, 2:4, 2:4] = m[..., None] * n[:, :, None] * n[:, None]
    direct[:, :2, 4], direct[:, 2:4, 4] = k * normal, x * n
    direct[:, 4, 4], direct[:, 5, 5] = outer.by_approach, inner.by_approach
    direct[:, 2:4, :2], direct[:, 4, :4] = direct[:, :2, 2:4].swapaxes(1, 2), direct[:, :4, 4]
    # By place outward and lean.
    stiffness = _own_stiffness(rollers.stands_at, ray, rollers.half)
    own = stiffness._replace(mixed=-stiffness.mixed).matrix
    both = np.stack((by_place, by_lean), axis=1)
    local = np.empty((ray.size, 2, 6))
    local[:, :, 0] = np.matmul(both[:, :, :2], n[..., None])[..., 0]
    local[:, :, 1] = np.matmul(both[:, :, :2], np.stack((-n[:, 1], n[:, 0]), axis=-1)[..., None])[..., 0]
    local[:, :, 2] = np.matmul(both[:, :, 2:4], n[..., None])[..., 0]
    local[:, 0, 3], local[:, 1, 3] = -inner.by_tilt, -inner.moment_by_tilt
    local[:, :, 4:] = both[:, :, 4:]
    if tilts:
        # What is taken of a tilt acts as a lean of bore or race along the ray.
        by_tilts = np.stack((local[:, :, 2], -local[:, :, 3]), axis=2)
        both = np.concatenate((both, by_tilts), axis=2)
        direct[:, :2, 6], direct[:, 2:4, 6] = x * normal, m * n
        direct[:, 4, 6], direct[:, 5, 7] = outer.by_tilt, inner.by_tilt
        direct[:, 6, 6], direct[:, 7, 7] = outer.moment_by_tilt, inner.moment_by_tilt
        direct[:, 6:, :6] = direct[:, :6, 6:].swapaxes(1, 2)
    solved = np.linalg.solve(own, np.concatenate((both, local), axis=2))
    tangent = direct - np.matmul(both.swapaxes(1, 2), solved[:, :, :size])
    return np.asarray(tangent), np.asarray(-solved[:, :, size:], dtype=float)
