r"""Contacts in slices that feel each other through the bodies (`fe` and `hybrid` with slices).

Of walls and supports of the bodies coefficients know how they yield under loads even and, of solid bodies, linear along the
width. What the loads F and moments M of all contacts take off the approach and off the tilt of each is

.. math:: y = C F(\delta(q) - y, \theta(q) - \tau), \qquad \tau = C' M(\delta(q) - y, \theta(q) - \tau),

those of the slices of every contact together, with the body parts C and C' of `ltca.compliance.coefficients`; even and linear
loads do not feel each other, by the symmetry of bodies along the width. Plane bodies yield evenly, C' = 0: there is no τ. A
roller has two entries: in the bore and on the race, which yields under the rollers of its own crank, and the roller between them.

Newton's method solves for g = (y, τ) at a pose. Loads and moments are slopes of one energy,
:math:`K = -\partial (F, M)/\partial g` is symmetric, and the tangent of the disc is that of contacts with g held less
:math:`G^T (B^{-1} + K)^{-1} G`, B being C and C' and G how loads and moments follow the pose. Tilts are kept as displacements at
half the width and moments as loads there, so that all are of one unit.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.in_slices import ContactsInSlices, roller_start, stacked, stored_in_slices, warm_rows
from ltca.compliance.near_field import NearFieldLaws, OwnParts
from ltca.compliance.response import DiscResponse, LeaningPairs, PairSlopes, Start
from ltca.compliance.rollers import RollerLaws, RollerState
from ltca.compliance.stored_energy import StoredEnergy
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, X, Y
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.contact_law import ContactLaw

MAX_ITERATIONS = 60
SETTLED, ROUND_OFF = 1e-13, 1e-11
"""What is left of y and of τ at half the width, mm; and what round-off of radii of 100 mm may leave."""
MAX_HALVINGS = 12

_Kinds = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Of wheel pins, bores, holes and races."""


class CoupledBodies(Protocol):
    """What contacts in slices need to know of bodies by which they feel each other (`ltca.compliance.coupled`)."""

    @property
    def geometry(self) -> ContactGeometry:
        """Of the disc."""
        ...

    @property
    def coefficients(self) -> InfluenceCoefficients:
        """The body part C."""
        ...

    @property
    def near_field(self) -> NearFieldLaws:
        """Laws of the contacts."""
        ...

    @property
    def hole_law(self) -> ContactLaw:
        """That of shaft pins and holes."""
        ...

    @property
    def hole_spring(self) -> float:
        """What a shaft pin yields behind it, mm/N."""
        ...

    @property
    def race(self) -> FloatArray:
        """Between the inner contacts of the rollers, mm/N."""
        ...

    @property
    def race_tilting(self) -> FloatArray | None:
        """Tilts by moments there, rad/(N·mm); None of plane bodies."""
        ...

    @property
    def outer_radius(self) -> FloatArray:
        """Effective radii in the bore, mm."""
        ...

    @property
    def inner_radius(self) -> FloatArray:
        """Those on the race, mm."""
        ...

    @property
    def own(self) -> OwnParts:
        """What is added to the diagonal of C."""
        ...


def respond_in_slices(
    model: CoupledBodies,
    crank_angle: FloatArray,
    pose: FloatArray,
    start: Start | None,
    shifts: ComplexArray | None,
    leans: ComplexArray | None,
    pin_shifts: ComplexArray | None,
) -> DiscResponse:
    """Return the contact forces at the poses of a batch of positions, as `ltca.compliance.coupled` in the plane.

    `pin_shifts` are those of `shifts` that concern wheel pins.
    """
    flank = model.geometry.flank(crank_angle, pose, None if start is None else start.parameter, pin_shifts)
    here = ContactsInSlices(model.geometry, crank_angle, pose, flank, shifts, leans)
    bodies = _Bodies(model, here, pose)
    near = stacked(None if start is None else start.warm_start)
    # Contacts found by tables know nothing of the bodies.
    begin = np.zeros(bodies.shape) if near is None or near[-1].shape != bodies.shape else near[-1]
    state = _settled(bodies, begin, near)
    found = here.response(state.pairs, state.rollers, warm_rows(state.pairs, state.rollers, state.given))
    return bodies.with_coupling(found, state)


def stored_by_bodies(
    model: CoupledBodies, crank_angle: FloatArray, pose: FloatArray, response: DiscResponse
) -> StoredEnergy:
    """Return what the contacts of a response and the bodies between them store, its angles and poses given."""
    here = ContactsInSlices(model.geometry, crank_angle, pose, response.flank, response.shifts, response.leans)
    bodies, rollers = _Bodies(model, here, pose), response.rollers
    pins, holes = response.leaning_pins, response.leaning_holes
    near = stacked(response.warm_start)
    assert near is not None
    assert pins is not None
    assert holes is not None
    given, tilts = bodies.split(near[-1])
    of_pins: Any = model.near_field.pin
    of_holes: Any = model.hole_law
    alone = stored_in_slices(
        response, (of_pins, of_holes), bodies.laws, here.radii[1], given, tilts or (0.0, 0.0, 0.0, 0.0)
    )
    load = bodies.joined(
        (response.pin_load, rollers.outer_load, response.hole_load, rollers.inner_load),
        (pins.contact.moment, rollers.outer_moment, holes.contact.moment, rollers.inner_moment),
    )
    whole = bodies.whole
    yields = 0.5 * np.einsum("bi,bij,bj->b", load, whole, load)
    return replace(alone, energy=alone.energy + yields, load=load, coefficients=whole)


class _State:
    """What all contacts carry when the bodies take `given` off their approaches and tilts."""

    def __init__(self, bodies: _Bodies, given: FloatArray, near: list[FloatArray] | None) -> None:
        (pins, outer, holes, inner), tilts = bodies.split(given)
        here, laws = bodies.here, bodies.laws
        of_pins: Any = bodies.model.near_field.pin
        of_holes: Any = bodies.model.hole_law
        self.given = given
        self.pairs: tuple[LeaningPairs, LeaningPairs] = (
            here.pair(0, of_pins, None if near is None else near[0], pins, None if tilts is None else tilts[0]),
            here.pair(1, of_holes, None if near is None else near[1], holes, None if tilts is None else tilts[2]),
        )
        self.rollers: RollerState = here.rollers(
            laws,
            None if near is None else roller_start(near),
            (outer, inner),
            None if tilts is None else (tilts[1], tilts[3]),
        )
        self.load = bodies.joined(
            (self.pairs[0].contact.load, self.rollers.outer_load, self.pairs[1].contact.load, self.rollers.inner_load),
            (
                self.pairs[0].contact.moment,
                self.rollers.outer_moment,
                self.pairs[1].contact.moment,
                self.rollers.inner_moment,
            ),
        )
        self.left = given - bodies.under(self.load)
        self.size = np.max(np.abs(self.left), axis=1, initial=0.0)

    @property
    def near(self) -> list[FloatArray]:
        """What the same contacts start from elsewhere."""
        found = stacked(warm_rows(self.pairs, self.rollers, self.given))
        assert found is not None
        return found


class _Bodies:
    """The body part between all contacts of a disc at a pose, numbered wheel pins, bores, holes, races; of solid bodies once for
    approaches by loads and, behind these, once for tilts by moments, both at half the width.
    """

    def __init__(self, model: CoupledBodies, here: ContactsInSlices, pose: FloatArray) -> None:
        self.model, self.here = model, here
        flank, holes = here.motions
        self.pins, self.rollers, self.holes = flank.approach.shape[1], model.outer_radius.size, holes.approach.shape[1]
        self.count = self.pins + 2 * self.rollers + self.holes
        self.laws = RollerLaws(
            inner=model.near_field.inner,
            outer=model.near_field.outer,
            inner_radius=model.inner_radius,
            outer_radius=model.outer_radius,
        )
        turn = pose[:, DISC_ROTATION, None]
        displacement = here.bores.each(here.bores.displacement, self.rollers)
        at_bore = np.angle(here.rays.outermost * here.rays.direction - displacement) - turn
        in_hole = np.angle(-(holes.gradient[..., X] + 1j * holes.gradient[..., Y])) - turn
        at_pin = model.geometry.profile.flank(flank.parameter)
        self.places = flank.parameter, at_bore, in_hole, at_pin, float(model.geometry.placement.bore_radius)
        body, own = model.coefficients, model.own
        self.parts = [self._between(body, own, model.race, model.hole_spring)]
        self.half = 0.5 * body.thickness
        # Plane bodies take nothing of a tilt: no unknowns for it.
        self.tilts = body.tilting is not None
        if body.tilting is not None and own.tilting is not None and model.race_tilting is not None:
            # What a pin stands on behind its contact is rigid against moments.
            tilting = self._between(body.tilting, own.tilting, model.race_tilting, 0.0)
            self.parts.append(self.half**2 * tilting)
        self.shape = pose.shape[0], len(self.parts) * self.count

    def _between(self, body: InfluenceCoefficients, own: OwnParts, race: FloatArray, hole_spring: float) -> FloatArray:
        """Matrix of approaches by loads or of tilts by moments."""
        disc = body.disc_matrix(*self.places)
        walls = disc.shape[1]
        matrix = np.zeros((disc.shape[0], self.count, self.count))
        matrix[:, :walls, :walls] = 0.5 * (disc + disc.swapaxes(1, 2))
        diagonal = np.repeat((own.pin, own.outer, own.hole + hole_spring), (self.pins, self.rollers, self.holes))
        matrix[:, np.arange(walls), np.arange(walls)] += diagonal
        matrix[:, walls:, walls:] = race
        bores, races = self.pins + np.arange(self.rollers), walls + np.arange(self.rollers)
        matrix[:, bores, races] = matrix[:, races, bores] = body.roller[0, 1]
        return matrix

    def split(self, given: FloatArray) -> tuple[_Kinds, _Kinds | None]:
        """What is taken of approaches, mm, and of tilts, rad, of wheel pins, bores, holes and races."""
        ends = np.cumsum((self.pins, self.rollers, self.holes))
        approaches = tuple(np.split(given[:, : self.count], ends, axis=1))
        tilts = tuple(np.split(given[:, self.count :] / self.half, ends, axis=1)) if self.tilts else None
        return approaches, tilts  # type: ignore[return-value]

    def joined(self, loads: tuple[FloatArray, ...], moments: tuple[FloatArray | None, ...]) -> FloatArray:
        """Loads, and moments by half the width where bodies yield to them, in the order of the unknowns."""
        turning = [np.asarray(moment) / self.half for moment in moments] if self.tilts else []
        return np.concatenate([*loads, *turning], axis=1)

    def under(self, load: FloatArray) -> FloatArray:
        """What bodies take under loads and moments, B f, of the same shape with any axes behind."""
        every = load.reshape(load.shape[0], len(self.parts), self.count, -1)
        found = [np.matmul(part, every[:, number]) for number, part in enumerate(self.parts)]
        return np.stack(found, axis=1).reshape(load.shape)

    @property
    def whole(self) -> FloatArray:
        """B, shape (positions, unknowns, unknowns)."""
        found = np.zeros((*self.shape, self.shape[1]))
        for number, part in enumerate(self.parts):
            own = slice(number * self.count, (number + 1) * self.count)
            found[:, own, own] = part
        return found

    def stiffness(self, state: _State) -> FloatArray:
        """K = −∂f/∂g, shape (positions, unknowns, unknowns)."""
        found = np.zeros((*self.shape, self.shape[1]))
        bores = self.pins + np.arange(self.rollers)
        races = bores + self.rollers + self.holes
        holes = self.pins + self.rollers + np.arange(self.holes)
        for places, pair in ((np.arange(self.pins), state.pairs[0]), (holes, state.pairs[1])):
            found[:, places, places] = pair.contact.by_approach
            if self.tilts:
                turned = places + self.count
                found[:, places, turned] = found[:, turned, places] = pair.contact.by_tilt / self.half
                found[:, turned, turned] = pair.contact.moment_by_tilt / self.half**2
        own = state.rollers.tangent[..., 4:, 4:]
        of_rollers = [(bores, 1.0), (races, 1.0)]
        if self.tilts:
            of_rollers += [(bores + self.count, self.half), (races + self.count, self.half)]
        for i, (first, arm) in enumerate(of_rollers):
            for j, (second, other) in enumerate(of_rollers):
                found[:, first, second] = own[..., i, j] / (arm * other)
        return found

    def system(self, stiffness: FloatArray) -> FloatArray:
        """1 + B K."""
        return np.eye(self.shape[1]) + self.under(stiffness)

    def step(self, state: _State) -> FloatArray:
        """Newton's step of g."""
        return np.asarray(-np.linalg.solve(self.system(self.stiffness(state)), state.left[..., None])[..., 0])

    def with_coupling(self, found: DiscResponse, state: _State) -> DiscResponse:
        """Return the response of contacts with what the bodies give added to the tangent and the slopes."""
        stiffness = self.stiffness(state)
        give = np.linalg.solve(self.system(stiffness), self.whole)
        give = 0.5 * (give + give.swapaxes(1, 2))
        pairs = self.here.slopes(state.pairs)
        positions, cranks = self.here.bores.arm.shape
        moved, each = self.here.moved, self.rollers // cranks
        rows = state.rollers.tangent.shape[-1] - 4
        by_bore = state.rollers.tangent[..., 4:, :4].reshape(positions, cranks, each, rows, 4)
        of_rollers = -np.matmul(by_bore, moved[:, :, None]).reshape(positions, self.rollers, rows, -1)

        def by_pose(of_pairs: FloatArray, first: int) -> tuple[FloatArray, ...]:
            outer, inner = of_rollers[:, :, first], of_rollers[:, :, first + 1]
            return of_pairs[:, : self.pins], outer, of_pairs[:, self.pins :], inner

        turned: tuple[FloatArray | None, ...] = ()
        if self.tilts:
            assert pairs.moment_by_pose is not None
            turned = by_pose(pairs.moment_by_pose, 2)
        gradient = self.joined(by_pose(pairs.by_pose, 0), turned)
        given = np.matmul(give, gradient)
        tangent = found.tangent - np.matmul(gradient.swapaxes(1, 2), given)
        slopes = None if found.slopes is None else self._slopes(pairs, stiffness, give, given)
        return replace(found, tangent=tangent, slopes=slopes)

    def _slopes(self, pairs: PairSlopes, stiffness: FloatArray, give: FloatArray, given: FloatArray) -> PairSlopes:
        """How loads and moments of wheel pins and shaft pins follow approaches, tilts and pose where contacts feel each other.

        What bodies take of approaches and tilts works on loads and moments as both follow approaches and tilts: f = K (g − B f).
        """
        k, x, m = pairs.by_approach, pairs.by_tilt, pairs.moment_by_tilt
        assert x is not None
        assert m is not None
        assert pairs.moment_by_pose is not None
        kept = np.r_[: self.pins, self.pins + self.rollers : self.pins + self.rollers + self.holes]
        one = np.eye(k.shape[1])
        # Rows of K of these pairs: loads and moments by what is taken of approaches and, of solid bodies, tilts.
        follow = [((k, x), kept)]
        if self.tilts:
            follow.append(((x / self.half, m / self.half), kept + self.count))

        def less(first: int, second: int) -> FloatArray:
            found = np.zeros((k.shape[0], kept.size, kept.size))
            for rows, at in follow:
                for columns, beside in follow:
                    found += rows[first][:, :, None] * give[:, at[:, None], beside] * columns[second][:, None, :]
            return found

        def by_pose(of_pairs: FloatArray, which: int) -> FloatArray:
            return of_pairs - sum(rows[which][..., None] * given[:, at] for rows, at in follow)

        return PairSlopes(
            by_approach=k[:, :, None] * one - less(0, 0),
            by_pose=by_pose(pairs.by_pose, 0),
            by_tilt=x[:, :, None] * one - less(0, 1),
            moment_by_tilt=m[:, :, None] * one - less(1, 1),
            moment_by_pose=by_pose(pairs.moment_by_pose, 1),
        )


def _settled(bodies: _Bodies, given: FloatArray, near: list[FloatArray] | None) -> _State:
    """Solve for what the bodies take off the approaches, by Newton's method from `given`."""
    state = _State(bodies, given, near)
    history: list[float] = []
    for _ in range(MAX_ITERATIONS):
        history.append(float(np.max(state.size, initial=0.0)))
        if history[-1] <= SETTLED:
            return state
        if len(history) > 3 and history[-1] < ROUND_OFF and history[-1] >= 0.5 * history[-2]:
            return state
        step, fraction = bodies.step(state), np.ones(state.size.shape)
        for _ in range(MAX_HALVINGS):
            there = _State(bodies, state.given + fraction[:, None] * step, state.near)
            worse = (there.size > state.size) & (there.size > ROUND_OFF)
            if not worse.any():
                break
            fraction = np.where(worse, 0.5 * fraction, fraction)
        state = there
    raise ConvergenceError(
        "what the bodies yield under contacts in slices does not settle; largest residual in mm", history
    )
