"""Rollers of a crank bearing in slices: each takes the place and the lean at which its two contacts balance in force and moment.

A roller stands on its cage ray n at the distance s and leans by ψ along it. The race leans by :math:`\\lambda_c` and the bore by
:math:`\\lambda`, so that the two contacts tilt by :math:`\\theta_i = \\lambda_c \\cdot n - \\psi` and
:math:`\\theta_o = \\psi - \\lambda \\cdot n`: between the ray and the normal in the bore nothing is lost but the square of their
angle. s and ψ are where the energy of both contacts is least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.rollers import RollerLaws, RollerState
from ltca.errors import ConvergenceError
from ltca.geometry.pair_motion import RollerRays, cross, dot
from ltca.laws.sliced_line import POINTS, SlicedContact, SlicedLine, slice_heights

MAX_ITERATIONS = 80
SETTLED = 1e-10
"""Largest force and moment (by half the length) left over, by the larger load of the two contacts."""
ROUND_OFF = 1e-7
"""What is left that may be due to what the slices leave over."""
MAX_HALVINGS = 16
STEEPEST = 0.5
"""Largest slope of the energy at the end of a step, by that at its start, that is not shortened."""

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
    inner, outer : array, shape (positions, rollers, slices)
        Loads of the slices, N.
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
    race_lean: FloatArray,
    bore_lean: FloatArray,
    start: RollerStart | None = None,
    given: tuple[FloatArray | float, FloatArray | float] = (0.0, 0.0),
) -> RollerState:
    """Place every roller so that its contacts balance; arguments as for `ltca.compliance.rollers.balance_rollers`.

    `race_lean` and `bore_lean` are the leans of race and bore along the rays, rad, shape (positions, rollers); `start` is what
    stood nearby, and `given` what the bodies take of the approaches in the bore and on the race, mm, shape (positions, rollers).
    """
    shape = rays.direction.shape
    half = 0.5 * laws.outer.length
    total = rays.outermost - rays.touching_distance(displacement)
    highest = slice_heights(laws.outer.length, laws.outer.slices).max()
    pressed = total - (given[0] + given[1]) + highest * np.abs(race_lean - bore_lean) > 0.0
    rows, numbers = np.nonzero(pressed)

    def each(values: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(np.broadcast_to(values, shape)[rows, numbers])

    ray, moved, outermost, play = (each(one) for one in (rays.direction, displacement, rays.outermost, rays.bore_play))
    inner_radius, outer_radius = each(laws.inner_radius), each(laws.outer_radius)
    at_race, at_bore, overlap = each(race_lean), each(bore_lean), each(total)
    from_bore, from_race = (each(np.asarray(one)) for one in given)
    along, lowest = dot(ray, moved), outermost - overlap
    stands = np.stack((along, cross(ray, moved), at_bore, at_race, from_bore, from_race), axis=1)

    def contacts(which: Any, inward: FloatArray, lean: FloatArray, near: _Near) -> _Contacts:
        place = outermost[which] - inward
        arm = place * ray[which] - moved[which]
        length = np.abs(arm)
        # |s n − d| less the bore play as a product, as for rollers that do not lean.
        outer = (overlap[which] - inward) * (place + lowest[which] - 2.0 * along[which]) / (length + play[which])
        first = laws.inner.respond(inward - from_race[which], at_race[which] - lean, inner_radius[which], near[0])
        second = laws.outer.respond(outer - from_bore[which], lean - at_bore[which], outer_radius[which], near[1])
        return first, second, arm / length, length

    inward, lean = from_race + 0.5 * (overlap - from_race - from_bore), 0.5 * (at_race + at_bore)
    near: _Near = (None, None)
    if start is not None:
        known, share = start.inner[rows, numbers].sum(axis=1) > 0.0, start.inward[rows, numbers]
        # One that leaned by more than what presses it now is better begun anew.
        known &= half * np.abs(start.lean[rows, numbers] - lean) <= np.abs(overlap) + half * np.abs(at_race - at_bore)
        # Of a roller that touched at its end alone the overlap in the middle was nothing to go by.
        inward = np.where(known & (np.abs(share - 0.5) < FARTHEST), share * overlap, inward)
        lean = np.where(known, start.lean[rows, numbers], lean)
        change = stands - start.stood[rows, numbers]
        outward, turned = np.einsum("rij,rj->ir", start.follow[rows, numbers], change)
        near_by = np.abs(outward) + half * np.abs(turned) <= 0.5 * (np.abs(overlap) + half * np.abs(at_race - at_bore))
        inward = np.where(known & near_by, start.place[rows, numbers] - outward, inward)
        lean = np.where(known & near_by, start.lean[rows, numbers] + turned, lean)
        near = start.inner[rows, numbers], start.outer[rows, numbers]
    inner, outer, outward, length = contacts(_ALL, inward, lean, near)
    # What round-off of places makes of a load.
    lightest = np.spacing(outermost) * laws.outer.contact_modulus * laws.outer.length / SETTLED
    reach = np.abs(overlap - from_bore - from_race) + half * np.abs(at_race - at_bore)
    history: list[float] = []
    before = np.full(rows.size, np.inf)
    for _ in range(MAX_ITERATIONS):
        force, moment = _imbalance(inner, outer, outward, ray)
        size = np.maximum(np.maximum(inner.load, outer.load), lightest)
        left = np.maximum(np.abs(force), np.abs(moment) / half) / size
        history.append(float(np.max(left, initial=0.0)))
        # Nothing but what the slices leave over is left where steps no longer help.
        going = np.flatnonzero((left > SETTLED) & ~((before < ROUND_OFF) & (left >= 0.5 * before)))
        if not going.size:
            break
        before = left
        there, moved_by = _downhill(contacts, going, inward, lean, inner, outer, outward, length, ray, half, reach)
        inward[going] += moved_by[0]
        lean[going] += moved_by[1]
        for whole, part in zip((inner, outer), there[:2], strict=True):
            whole.put(going, part)
        outward[going], length[going] = there[2:]
    else:
        raise ConvergenceError("leaning rollers do not balance between the races; force left over by the load", history)
    cosine = outward.real * ray.real + outward.imag * ray.imag
    tangent, follow = _eliminated(ray, outward, cosine, length, inner, outer, half)
    found: dict[str, NDArray[Any]] = {
        "share": np.divide(inward, overlap, out=np.full(overlap.shape, 0.5), where=overlap > 0.0),
        "inner_approach": inward,
        "outer_approach": np.abs((outermost - inward) * ray - moved) - play,
        "inner_load": inner.load,
        "outer_load": outer.load,
        "outer_direction": outward,
        "tangent": tangent,
        "stood": stands,
        "follow": follow,
        "outer_moment": outer.moment,
        "inner_moment": inner.moment,
        "lean": lean,
        "inner_tilt": at_race - lean,
        "outer_tilt": lean - at_bore,
        "inner_slices": inner.slice_load,
        "outer_slices": outer.slice_load,
        "inner_lines": inner.line_load,
        "outer_lines": outer.line_load,
    }
    arm = rays.outermost * rays.direction - displacement
    rest = np.abs(arm)
    free: dict[str, NDArray[Any]] = {
        "share": np.full(shape, 0.5), "outer_approach": rest - rays.bore_play, "outer_direction": arm / rest,
        "tangent": np.zeros((*shape, 6, 6)), "stood": np.zeros((*shape, 6)), "follow": np.zeros((*shape, 2, 6)),
        "inner_slices": np.zeros((*shape, laws.inner.slices)), "outer_slices": np.zeros((*shape, laws.outer.slices)),
        "inner_lines": np.zeros((*shape, laws.inner.slices, POINTS)),
        "outer_lines": np.zeros((*shape, laws.outer.slices, POINTS)),
    }  # fmt: skip
    everywhere: dict[str, Any] = {}
    for name, values in found.items():
        full = free[name] if name in free else np.zeros(shape)
        full[rows, numbers] = values
        everywhere[name] = full
    return RollerState(**everywhere)


def _imbalance(
    inner: SlicedContact, outer: SlicedContact, outward: ComplexArray, ray: ComplexArray
) -> tuple[FloatArray, FloatArray]:
    """Slopes of the energy by place inward and lean."""
    return inner.load - outer.load * dot(outward, ray), outer.moment - inner.moment


def _along(slopes: tuple[FloatArray, FloatArray], step: tuple[FloatArray, FloatArray]) -> FloatArray:
    return slopes[0] * step[0] + slopes[1] * step[1]


def _downhill(
    contacts: Callable[..., _Contacts],
    going: NDArray[np.intp],
    inward: FloatArray,
    lean: FloatArray,
    inner: SlicedContact,
    outer: SlicedContact,
    outward: ComplexArray,
    length: FloatArray,
    ray: ComplexArray,
    half: float,
    reach: FloatArray,
) -> tuple[_Contacts, tuple[FloatArray, FloatArray]]:
    """Newton's step of the rollers that go on, shortened where the energy rises again steeply at its end.

    The energy is convex along a step: its slope says how far its least is, also where differences of energies are round-off.
    """
    first, second = inner.take(going), outer.take(going)
    n, towards, arm = ray[going], outward[going], length[going]
    force, moment = _imbalance(first, second, towards, n)
    stiff, mixed, turning = _own_stiffness(first, second, dot(towards, n), arm)
    # A roller that touches at one end alone turns about that end freely.
    turning = turning + 1e-9 * half**2 * stiff
    determinant = np.where(stiff > 0.0, stiff * turning - mixed**2, 1.0)
    # Beyond half of what is pressed together at the end other slices meet than the slopes know of.
    most = 0.5 * reach[going] / half
    turn = np.clip(-(stiff * moment - mixed * force) / determinant, -most, most)
    step = -(force + mixed * turn) / np.where(stiff > 0.0, stiff, 1.0)
    slope = force * step + moment * turn
    fraction = np.ones(step.shape)
    across = dot(towards, n)
    start = (first.ahead(step, -turn), second.ahead(-across * step, turn))
    there = contacts(going, inward[going] + step, lean[going] + turn, start)
    low, high = np.zeros(step.shape), np.full(step.shape, np.inf)
    for _ in range(MAX_HALVINGS):
        ahead, steep = _along(_imbalance(*there[:3], n), (step, turn)), STEEPEST * np.abs(slope)
        far, near = ahead > steep, (ahead < -steep) & np.isfinite(high)
        high[far], low[near] = fraction[far], fraction[near]
        long = np.flatnonzero(far | near)
        if not long.size:
            break
        # Where a slice begins to carry the slope turns within a little: places are halved by their size then.
        cut = np.clip(np.abs(slope[long]) / (np.abs(slope[long]) + np.abs(ahead[long])), 0.1, 0.7)
        between = np.sqrt(low[long] * high[long])
        fraction[long] = np.where(low[long] > 0.0, between, cut * high[long])
        again = going[long]
        part = contacts(
            again,
            inward[again] + fraction[long] * step[long],
            lean[again] + fraction[long] * turn[long],
            (first.slice_load[long], second.slice_load[long]),
        )
        there[0].put(long, part[0])
        there[1].put(long, part[1])
        there[2][long], there[3][long] = part[2:]
    return there, (fraction * step, fraction * turn)


def _own_stiffness(
    inner: SlicedContact, outer: SlicedContact, cosine: FloatArray, length: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Second derivatives of the energy by place inward and lean."""
    bend = outer.load * (1.0 - cosine**2) / length
    stiff = inner.by_approach + outer.by_approach * cosine**2 + bend
    mixed = -(inner.by_tilt + outer.by_tilt * cosine)
    return stiff, mixed, inner.moment_by_tilt + outer.moment_by_tilt


def _eliminated(
    ray: ComplexArray,
    outward: ComplexArray,
    cosine: FloatArray,
    length: FloatArray,
    inner: SlicedContact,
    outer: SlicedContact,
    half: float,
) -> tuple[FloatArray, FloatArray]:
    """Second derivative of the eliminated energy by displacement (x, y) and lean (x, y) of the bore and what the bodies take of
    the approaches in the bore and on the race, shape (rollers, 6, 6); and how place outward and lean follow what places the
    roller (`RollerStart`).
    """
    slant = ray.imag * outward.real - ray.real * outward.imag
    bend = outer.load / length
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
    direct = np.zeros((ray.size, 6, 6))
    direct[:, :2, :2] = (
        k[..., None] * normal[:, :, None] * normal[:, None] + bend[:, None, None] * across[:, :, None] * across[:, None]
    )
    direct[:, :2, 2:4] = x[..., None] * normal[:, :, None] * n[:, None]
    direct[:, 2:4, 2:4] = m[..., None] * n[:, :, None] * n[:, None]
    direct[:, :2, 4], direct[:, 2:4, 4] = k * normal, x * n
    direct[:, 4, 4], direct[:, 5, 5] = outer.by_approach, inner.by_approach
    direct[:, 2:4, :2], direct[:, 4, :4] = direct[:, :2, 2:4].swapaxes(1, 2), direct[:, :4, 4]
    stiff, mixed, turning = _own_stiffness(inner, outer, cosine, length)
    turning = turning + 1e-9 * half**2 * stiff
    own = np.empty((ray.size, 2, 2))
    own[:, 0, 0], own[:, 1, 1] = stiff, turning
    own[:, 0, 1] = own[:, 1, 0] = -mixed
    own[stiff <= 0.0] = np.eye(2)
    both = np.stack((by_place, by_lean), axis=1)
    local = np.empty((ray.size, 2, 6))
    local[:, :, 0] = np.matmul(both[:, :, :2], n[..., None])[..., 0]
    local[:, :, 1] = np.matmul(both[:, :, :2], np.stack((-n[:, 1], n[:, 0]), axis=-1)[..., None])[..., 0]
    local[:, :, 2] = np.matmul(both[:, :, 2:4], n[..., None])[..., 0]
    local[:, 0, 3], local[:, 1, 3] = -inner.by_tilt, -inner.moment_by_tilt
    local[:, :, 4:] = both[:, :, 4:]
    solved = np.linalg.solve(own, np.concatenate((both, local), axis=2))
    tangent = direct - np.matmul(both.swapaxes(1, 2), solved[:, :, :6])
    return np.asarray(tangent), np.asarray(-solved[:, :, 6:], dtype=float)
