"""A roller between the races: two contact laws in series, its radial place eliminated (Eq. 52, 57, 66).

The roller stands at the distance s from the inner-race centre on its cage ray n. It balances when the inner
load equals the outer load projected on the ray, F_i = F_o (n_o·n), which is the minimum of
U_i(δ_i(s)) + U_o(δ_o(s, d)) over s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.errors import ConvergenceError
from ltca.geometry.pair_motion import RollerRays
from ltca.laws.contact_law import ContactLaw

MAX_ITERATIONS = 60
NEWTON_TOLERANCE = 1e-6
"""Last Newton change of a share: loads are corrected linearly for it, and the error left is of its square."""
BISECTION_TOLERANCE = 1e-11
"""Last change of a share where the step was a bisection."""

Law = TypeVar("Law", bound=ContactLaw)
AnyLaw = TypeVar("AnyLaw")


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerLaws(Generic[AnyLaw]):
    """Load laws of the two contacts of every roller.

    Attributes
    ----------
    inner, outer : ContactLaw
        Laws on the inner race and in the bore.
    inner_radius, outer_radius : array, shape (rollers,)
        Effective radii of curvature, mm.
    by_place : bool
        Whether the laws know their contacts by their places, shape (positions, rollers), as grids do.
    """

    inner: AnyLaw
    outer: AnyLaw
    inner_radius: FloatArray = by_drive(1)
    outer_radius: FloatArray = by_drive(1)
    by_place: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerState:
    """Balanced rollers, crank after crank.

    Attributes
    ----------
    share : array, shape (positions, rollers)
        Part of the total interference taken by the inner contact; the start of the next solution.
    inner_approach, outer_approach : array, shape (positions, rollers)
        mm, negative where open; a free roller rests on the inner race.
    inner_load, outer_load : array, shape (positions, rollers)
        N.
    outer_direction : array of complex, shape (positions, rollers)
        Unit vector from the bore centre to the roller, the direction of the load on the disc.
    tangent : array, shape (positions, rollers, 2, 2)
        Second derivative of the eliminated energy by the displacement (x, y) of the bore, N/mm; of leaning rollers
        (`ltca.compliance.leaning_rollers`) by its displacement, its lean and what is taken of both approaches, shape (…, 6, 6),
        and of both tilts where bodies take of these, (…, 8, 8).
    inner_moment, outer_moment : array, shape (positions, rollers), or None
        Of leaning rollers about mid-length, N·mm; that on the disc acts along the ray.
    lean : array, shape (positions, rollers), or None
        Of leaning rollers along their rays, rad.
    inner_tilt, outer_tilt : array, shape (positions, rollers), or None
        Tilts of their contacts, rad, positive presses positive z.
    stood, follow : array, shape (positions, rollers, 6) and (…, 2, 6), or None
        Of leaning rollers, what placed them and how they follow it (`ltca.compliance.leaning_rollers.RollerStart`).
    inner_slices, outer_slices : array, shape (positions, rollers, slices), or None
        Loads of the slices of leaning rollers, N.
    inner_near, outer_near : array, shape (positions, rollers, …), or None
        What their contacts start from nearby (`ltca.laws.sliced_contact.SlicedContact.near`).
    left : array, shape (positions, rollers), or None
        Force that may be left over of leaning rollers, N.
    inner_lines, outer_lines : array, shape (positions, rollers, slices, points), or None
        Their line loads at the points of the slices, N/mm.
    """

    share: FloatArray
    inner_approach: FloatArray
    outer_approach: FloatArray
    inner_load: FloatArray
    outer_load: FloatArray
    outer_direction: ComplexArray
    tangent: FloatArray
    inner_moment: FloatArray | None = None
    outer_moment: FloatArray | None = None
    lean: FloatArray | None = None
    inner_tilt: FloatArray | None = None
    outer_tilt: FloatArray | None = None
    stood: FloatArray | None = None
    follow: FloatArray | None = None
    inner_slices: FloatArray | None = None
    outer_slices: FloatArray | None = None
    inner_near: FloatArray | None = None
    outer_near: FloatArray | None = None
    left: FloatArray | None = None
    inner_lines: FloatArray | None = None
    outer_lines: FloatArray | None = None

    @property
    def kept(self) -> RollerState:
        """The rollers without what a search alone asks for."""
        return self if self.inner_near is None else replace(self, inner_near=None, outer_near=None, left=None)


def balance_rollers(
    rays: RollerRays,
    displacement: ComplexArray,
    laws: RollerLaws[Law],
    start: FloatArray | None = None,
) -> RollerState:
    """Place every roller so that its two contacts balance.

    Parameters
    ----------
    rays : RollerRays
        Cage rays of the positions.
    displacement : array of complex, shape (positions, rollers) or (positions, 1)
        Bore centre from inner-race centre, mm.
    laws : RollerLaws
        Laws of the inner and the outer contacts.
    start : array, shape (positions, rollers), optional
        Shares of a neighbouring solution.

    Returns
    -------
    RollerState
        Loads, approaches and tangent.

    Raises
    ------
    ConvergenceError
        When a law gives no number or a roller does not settle.
    """
    direction = rays.direction
    interference = rays.outermost - rays.touching_distance(displacement)
    share = np.full(direction.shape, 0.5) if start is None else np.array(start)
    # Half of the rollers are free: only those pressed between the races are balanced.
    pressed = np.flatnonzero(interference > 0.0)
    balanced = _balance_pressed(rays, displacement, laws, pressed, interference.take(pressed), share.take(pressed))
    # A free roller rests on the inner race; its outer gap follows from there.
    arm = rays.outermost * direction - displacement
    length = np.abs(arm)
    outward, outer_approach = arm / length, length - rays.bore_play
    inner_approach, inner_load, outer_load = (np.zeros(direction.shape) for _ in range(3))
    tangent = np.zeros((*direction.shape, 2, 2))
    for values, found in zip(
        (share, inner_approach, outer_approach, inner_load, outer_load, outward, tangent), balanced, strict=True
    ):
        values.reshape(direction.size, *values.shape[2:])[pressed] = found
    return RollerState(
        share=share,
        inner_approach=inner_approach,
        outer_approach=outer_approach,
        inner_load=inner_load,
        outer_load=outer_load,
        outer_direction=outward,
        tangent=tangent,
    )


def _balance_pressed(
    rays: RollerRays,
    displacement: ComplexArray,
    laws: RollerLaws[Law],
    pressed: NDArray[np.intp],
    total: FloatArray,
    share: FloatArray,
) -> tuple[NDArray[Any], ...]:
    """Balance the rollers that interfere by `total`, one row: the arrays of `RollerState` in its order, tangent last.

    They are counted through all positions.
    """
    shape = rays.direction.shape
    rows, numbers = np.divmod(pressed, shape[1])

    def each(values: NDArray[Any]) -> NDArray[Any]:
        if values.shape == shape:
            return values.take(pressed)
        return values[numbers] if values.shape == shape[1:] else np.broadcast_to(values, shape)[rows, numbers]

    direction, moved = each(rays.direction), each(displacement)
    outermost, bore_play = each(rays.outermost), each(rays.bore_play)
    inner_radius, outer_radius = each(laws.inner_radius), each(laws.outer_radius)

    def loads(law: Law, approach: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        if not laws.by_place:
            return law.load_and_stiffness(approach, radius)
        # Open ones cost it nothing.
        everywhere, radii = np.zeros(rays.direction.size), np.ones(rays.direction.size)
        everywhere[pressed], radii[pressed] = approach, radius
        load, stiffness = law.load_and_stiffness(everywhere.reshape(shape), radii.reshape(shape))
        return load.take(pressed), stiffness.take(pressed)

    lowest = outermost - total
    along = direction.real * moved.real + direction.imag * moved.imag
    low, high = np.zeros_like(total), np.ones_like(total)
    history: list[float] = []
    for _ in range(MAX_ITERATIONS):
        place = outermost - share * total
        arm = place * direction - moved
        length = np.abs(arm)
        outward = arm / length
        cosine = outward.real * direction.real + outward.imag * direction.imag
        inner_approach = share * total
        # |s n − d| less the bore play as a product: no cancellation for rollers that barely touch.
        outer_approach = (1.0 - share) * total * (place + lowest - 2.0 * along) / (length + bore_play)
        inner_load, inner_stiffness = loads(laws.inner, inner_approach, inner_radius)
        outer_load, outer_stiffness = loads(laws.outer, outer_approach, outer_radius)
        bend = outer_load * (1.0 - cosine**2) / length
        stiffness = inner_stiffness + outer_stiffness * cosine**2 + bend
        imbalance = inner_load - outer_load * cosine
        if np.isnan(imbalance).any():  # bisection would settle on it all the same
            raise ConvergenceError("rollers do not balance between the races: a load is not a number", history)
        low = np.where(imbalance < 0.0, share, low)
        high = np.where(imbalance > 0.0, share, high)
        safe = np.where(stiffness > 0.0, stiffness, 1.0)
        newton = share - imbalance / (safe * total)
        # Newton within the bracket, bisection where it leaves it.
        following = np.where((newton >= low) & (newton <= high), newton, 0.5 * (low + high))
        following = np.where(imbalance != 0.0, following, share)
        change = np.abs(following - share)
        history.append(float(np.max(change, initial=0.0)))
        if np.all(change <= np.where(following == newton, NEWTON_TOLERANCE, BISECTION_TOLERANCE)):
            break
        share = following
    else:
        raise ConvergenceError("rollers do not balance between the races; change of their share", history)
    inward = (following - share) * total
    inner_approach, inner_load = inner_approach + inward, inner_load + inner_stiffness * inward
    outer_approach, outer_load = outer_approach - cosine * inward, outer_load - outer_stiffness * cosine * inward
    tangent = _eliminated_tangent(direction, outward, cosine, length, outer_load, outer_stiffness, safe)
    return following, inner_approach, outer_approach, inner_load, outer_load, outward, tangent


def _eliminated_tangent(
    direction: ComplexArray,
    outward: ComplexArray,
    cosine: FloatArray,
    length: FloatArray,
    load: FloatArray,
    outer_stiffness: FloatArray,
    place_stiffness: FloatArray,
) -> FloatArray:
    """Schur complement of the roller's place in the Hessian of U_i + U_o over (d, s)."""
    slant = direction.imag * outward.real - direction.real * outward.imag
    normal, across = (outward.real, outward.imag), (-outward.imag, outward.real)
    bend = load / length
    mixed = [-(outer_stiffness * cosine) * n - (bend * slant) * a for n, a in zip(normal, across, strict=True)]
    tangent = np.empty((*load.shape, 2, 2))
    for i, j in ((0, 0), (0, 1), (1, 1)):
        direct = outer_stiffness * normal[i] * normal[j] + bend * across[i] * across[j]
        tangent[..., i, j] = tangent[..., j, i] = direct - mixed[i] * mixed[j] / place_stiffness
    return tangent
