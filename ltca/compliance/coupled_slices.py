r"""Contacts in slices that feel each other through the bodies (`fe` and `hybrid` with slices).

Walls and supports of the bodies yield evenly along the width: coefficients of plane bodies know of no other way. What the loads
of all contacts take off the approach of each is

.. math:: y = C F(\delta(q) - y, \theta(q)),

with the loads F of the slices of every contact together, their tilts as they stand, and the body part C of
`ltca.compliance.coefficients` as in the plane (`ltca.compliance.coupled`). A roller has two entries: in the bore and on the race,
which yields under the rollers of its own crank, and the roller between them. Newton's method solves for y at a pose. Loads are
slopes of one energy, :math:`K = -\partial F/\partial y` is symmetric, and the tangent of the disc is that of contacts with y held
less :math:`G^T (C^{-1} + K)^{-1} G`, G being how loads follow the pose.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.compliance.in_slices import ContactsInSlices, roller_start, stacked, warm_rows
from ltca.compliance.near_field import NearFieldLaws, OwnParts
from ltca.compliance.response import DiscResponse, LeaningPairs, PairSlopes, Start
from ltca.compliance.rollers import RollerLaws, RollerState
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, X, Y
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.contact_law import ContactLaw

MAX_ITERATIONS = 60
SETTLED, ROUND_OFF = 1e-13, 1e-11
"""What is left of y, mm; and what round-off of radii of 100 mm may leave."""
MAX_HALVINGS = 12


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


class _State:
    """What all contacts carry when the bodies take `given` off their approaches."""

    def __init__(self, bodies: _Bodies, given: FloatArray, near: list[FloatArray] | None) -> None:
        pins, outer, holes, inner = bodies.split(given)
        here, laws = bodies.here, bodies.laws
        of_pins: Any = bodies.model.near_field.pin
        of_holes: Any = bodies.model.hole_law
        self.given = given
        self.pairs: tuple[LeaningPairs, LeaningPairs] = (
            here.pair(0, of_pins, None if near is None else near[0], pins),
            here.pair(1, of_holes, None if near is None else near[1], holes),
        )
        self.rollers: RollerState = here.rollers(laws, None if near is None else roller_start(near), (outer, inner))
        self.load = np.concatenate(
            (self.pairs[0].contact.load, self.rollers.outer_load, self.pairs[1].contact.load, self.rollers.inner_load),
            axis=1,
        )
        self.left = given - np.matmul(bodies.matrix, self.load[..., None])[..., 0]
        self.size = np.max(np.abs(self.left), axis=1, initial=0.0)

    @property
    def near(self) -> list[FloatArray]:
        """What the same contacts start from elsewhere."""
        found = stacked(warm_rows(self.pairs, self.rollers, self.given))
        assert found is not None
        return found


class _Bodies:
    """The body part between all contacts of a disc at a pose, numbered wheel pins, bores, holes, races."""

    def __init__(self, model: CoupledBodies, here: ContactsInSlices, pose: FloatArray) -> None:
        self.model, self.here = model, here
        flank, holes = here.motions
        place, own, body = model.geometry.placement, model.own, model.coefficients
        self.pins, self.rollers, self.holes = flank.approach.shape[1], model.outer_radius.size, holes.approach.shape[1]
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
        disc = body.disc_matrix(
            flank.parameter,
            at_bore,
            in_hole,
            model.geometry.profile.flank(flank.parameter),
            float(place.bore_radius),
        )
        walls = disc.shape[1]
        self.shape = (pose.shape[0], walls + self.rollers)
        self.matrix = np.zeros((pose.shape[0], self.shape[1], self.shape[1]))
        self.matrix[:, :walls, :walls] = 0.5 * (disc + disc.swapaxes(1, 2))
        diagonal = np.repeat((own.pin, own.outer, own.hole + model.hole_spring), (self.pins, self.rollers, self.holes))
        self.matrix[:, np.arange(walls), np.arange(walls)] += diagonal
        self.matrix[:, walls:, walls:] = model.race
        bores, races = self.pins + np.arange(self.rollers), walls + np.arange(self.rollers)
        self.matrix[:, bores, races] = self.matrix[:, races, bores] = body.roller[0, 1]

    def split(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Values of wheel pins, bores, holes and races."""
        first, second, third, last = np.split(values, np.cumsum((self.pins, self.rollers, self.holes)), axis=1)
        return first, second, third, last

    def stiffness(self, state: _State) -> FloatArray:
        """K = −∂F/∂y, shape (positions, contacts, contacts)."""
        found = np.zeros((*self.shape, self.shape[1]))
        bores = self.pins + np.arange(self.rollers)
        races = bores + self.rollers + self.holes
        holes = self.pins + self.rollers + np.arange(self.holes)
        for places, pair in ((np.arange(self.pins), state.pairs[0]), (holes, state.pairs[1])):
            found[:, places, places] = pair.contact.by_approach
        own = state.rollers.tangent[..., 4:, 4:]
        for i, first in enumerate((bores, races)):
            for j, second in enumerate((bores, races)):
                found[:, first, second] = own[..., i, j]
        return found

    def step(self, state: _State) -> FloatArray:
        """Newton's step of y."""
        system = np.eye(self.shape[1]) + np.matmul(self.matrix, self.stiffness(state))
        return np.asarray(-np.linalg.solve(system, state.left[..., None])[..., 0])

    def with_coupling(self, found: DiscResponse, state: _State) -> DiscResponse:
        """Return the response of contacts with what the bodies give added to the tangent and the slopes."""
        system = np.eye(self.shape[1]) + np.matmul(self.matrix, self.stiffness(state))
        give = np.linalg.solve(system, self.matrix)
        give = 0.5 * (give + give.swapaxes(1, 2))
        pairs = self.here.slopes(state.pairs)
        positions, cranks = self.here.bores.arm.shape
        moved, each = self.here.moved, self.rollers // cranks
        by_bore = state.rollers.tangent[..., 4:, :4].reshape(positions, cranks, each, 2, 4)
        of_rollers = -np.matmul(by_bore, moved[:, :, None]).reshape(positions, self.rollers, 2, -1)
        gradient = np.concatenate(
            (pairs.by_pose[:, : self.pins], of_rollers[:, :, 0], pairs.by_pose[:, self.pins :], of_rollers[:, :, 1]),
            axis=1,
        )
        given = np.matmul(give, gradient)
        tangent = found.tangent - np.matmul(gradient.swapaxes(1, 2), given)
        slopes = None
        if found.slopes is not None:
            kept = np.r_[: self.pins, self.pins + self.rollers : self.pins + self.rollers + self.holes]
            between = give[:, kept[:, None], kept]
            slopes = _coupled_slopes(pairs, between, given[:, kept])
        return replace(found, tangent=tangent, slopes=slopes)


def _coupled_slopes(pairs: PairSlopes, between: FloatArray, given: FloatArray) -> PairSlopes:
    """How loads and moments of wheel pins and shaft pins follow approaches, tilts and pose where contacts feel each other."""
    k, x, m = pairs.by_approach, pairs.by_tilt, pairs.moment_by_tilt
    assert x is not None
    assert m is not None
    assert pairs.moment_by_pose is not None
    one = np.eye(k.shape[1])
    return PairSlopes(
        by_approach=k[:, :, None] * one - k[:, :, None] * between * k[:, None, :],
        by_pose=pairs.by_pose - k[..., None] * given,
        by_tilt=x[:, :, None] * one - k[:, :, None] * between * x[:, None, :],
        moment_by_tilt=m[:, :, None] * one - x[:, :, None] * between * x[:, None, :],
        moment_by_pose=pairs.moment_by_pose - x[..., None] * given,
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
