r"""All contacts of a reducer at poses, with everything elastic that couples them: one system for every engine.

With approaches d, deformations e, loads f(e), coefficients C of bodies, flexibility S of beams and ring, places x of rollers
(and leans) and displacements u of pins,

.. math:: e + C f(e) = d(q, x, u), \qquad u = -S L^T f, \qquad T^T f = 0 .

With the derivatives T and N of d by x and u, L (N with friction), K = ∂f/∂e and W = C + N S Lᵀ, Newton's step is

.. math:: (1 + W K)\, de = G\,dq + T\,dx - r, \qquad r = e - d + C f + N (u + S L^T f) .

Derivatives of C and of radii of curvature by the pose are left out, which keeps the tangent symmetric. Contacts are numbered
disc after disc: wheel pins, rollers in the bores, shaft pins in their holes, rollers on the races. Arrays have the shape
(positions, components, contacts); components are the approach and, in slices, the tilt times half the thickness.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import cached_property, partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, take_positions
from ltca.compliance.coefficients import BodyPlaces
from ltca.compliance.coupled import BodyFlexibility
from ltca.compliance.response import ContactLaws, Inner, Start
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, X, Y
from ltca.geometry.pair_motion import KnownPins
from ltca.mechanics.displaced_pins import PinMembers
from ltca.mechanics.elimination import (
    ROUGHLY_SETTLED,
    eliminate_by_disc,
    eliminate_coupled,
    eliminate_rollers,
    loads_of,
)
from ltca.mechanics.laws import PlaneLaws, SlicedLaws
from ltca.mechanics.places import DiscPlaces, Indices, State, beside, mixed, padded, places_of, reach_of, with_crank
from ltca.mechanics.pressing import BySlope, Pressing, pressing_of

if TYPE_CHECKING:
    from ltca.laws.sliced_contact import SlicedContact

WORKING_MEMORY = 1e8
"""Memory for the largest array of a block of positions, bytes: the linear system of contacts, of which a few are held."""
CANDIDATE_MARGIN = 0.25
"""Gap by the largest overlap of its position within which an open contact may carry as loads of others move it."""
SETTLED = 1e-7
"""Largest correction of a deformation by the largest approach in an answer; the error of loads is of its square."""
SETTLED_IN_MOTION = 1e-5
"""The same in a run in time, whose step leaves a hundred times as much as the 1e-11 of loads that follow from it."""
FAR_OFF = 0.2
"""Residual of the deformations by the largest approach beyond which a start is compared with none at all."""
MAX_CORRECTIONS = 60
TOGETHER = 4
"""Positions that are corrected together though most of them have settled."""
MAX_HALVINGS = 12
LEFT_WEIGHT = 100.0
"""Weight of the residual of the inner unknowns: moments of the cranks are balanced more closely than forces."""
ROUND_OFF = 1e-13
"""Round-off of places, mm."""
LEAST_CHANGE = 1e-13
"""Least change of a load, by the largest of its position, that counts."""
LEAST_ROUGHLY = 5e-3
"""The same for a step of a search: `Linearised.left` counts what is smaller."""


class ContactSystem:
    """Contacts of all discs of a `ltca.equilibrium.reducer.Reducer`."""

    def __init__(self, model: Any) -> None:
        self.model, self.coordinates = model, model.coordinates
        self.geometries = model.geometries
        place = self.geometries[0].placement
        self.pins, self.rollers = place.wheel_pin_radii.shape[-1], place.roller_radii.shape[-1]
        self.holes, self.discs = place.hole_radii.shape[-1], len(model.discs)
        self.each = self.pins + 2 * self.rollers + self.holes
        self.contacts = self.discs * self.each
        self.components = 1 + self.coordinates.leans
        self.laws: list[ContactLaws] = [disc.contact_laws for disc in model.discs]
        self.coupled = any(disc.coefficients is not None for disc in model.discs)
        self.deforms = self.coupled or model.pins is not None
        ends = np.cumsum((0, self.pins, self.rollers, self.holes, self.rollers))
        self.of_kind = [
            [slice(disc * self.each + first, disc * self.each + last) for first, last in pairwise(ends)]
            for disc in range(self.discs)
        ]
        self.columns = [self.coordinates.columns(disc) for disc in range(self.discs)]
        self.one = replace(self.coordinates, discs=1)
        self.cage_speed = place.cage_speed
        self.plain = not self.deforms and self.components == 1 and model.friction is None
        self.contact_laws = (PlaneLaws, SlicedLaws)[self.coordinates.leans](self.laws, self.of_kind)

    @property
    def half(self) -> FloatArray:
        """Half the thickness of the discs, by which tilts are measured, mm, shape (…,) of one number or (positions, 1)."""
        return np.asarray(self.geometries[0].half_width, dtype=float)

    @property
    def positions_at_once(self) -> int:
        """Number of positions whose largest array takes `WORKING_MEMORY`."""
        entries = self.components * self.contacts
        if self.model.pins is not None:
            entries += self.components * self.discs * (self.pins + self.holes)
        return max(1, int(WORKING_MEMORY / (8.0 * entries * (entries if self.deforms else self.coordinates.size))))

    @cached_property
    def every_contact(self) -> tuple[list[list[Indices]], list[list[slice]], list[slice], list[list[slice]]]:
        """All contacts of every disc and kind as chosen ones, of one position for all, and `places_of` them."""
        sizes = self.pins, self.rollers, self.holes, self.rollers
        chosen = [[np.arange(size)[None] for size in sizes] for _ in range(self.discs)]
        return chosen, *places_of(chosen)

    def respond(self, angle: FloatArray, pose: FloatArray, start: Start | None, **how: bool) -> Linearised:
        """Return the contacts at poses in one group; arguments as for `in_groups`."""
        return self.in_groups(angle, pose, start, apart=False, **how)[0][1]

    def in_groups(
        self,
        angle: FloatArray,
        pose: FloatArray,
        start: Start | None,
        *,
        roughly: bool,
        everything: bool = False,
        by_crank: bool = False,
        apart: bool = True,
    ) -> list[tuple[Indices, Linearised]]:
        """Return contacts at poses, to first order in what inner unknowns leave: all in the first group, those that settle later
        once more in further ones, `apart`, which replace their rows.

        Contacts far from touching that others move are left out unless `everything` counts or, if not `roughly`, one of them
        turns out to be pressed. With `by_crank` the crank angle is a coordinate by which cages turn, discs and wheel move
        nominally; the tangent then is Σ k g gᵀ, without forces that turn.
        """
        state = self._begin(with_crank(pose, angle) if by_crank else pose, start)
        known = None if start is None else start.known
        for margin in (np.inf,) if everything else (CANDIDATE_MARGIN, np.inf):
            at = Linearised(self, angle, pose, state, known, roughly=roughly, margin=margin, by_crank=by_crank)
            groups = self._settled(at, state, apart)
            if roughly or not any(at.leaves_out.any() for _, at in groups):
                break
        return groups

    def _settled(
        self, at: Linearised, begin: State | None, apart: bool, history: tuple[FloatArray, ...] = ()
    ) -> list[tuple[Indices, Linearised]]:
        """Correct the inner unknowns of each position until they settle; `begin` is None once compared with no start."""
        every, others = np.arange(at.angle.size), list[tuple[Indices, Linearised]]()
        gone = np.zeros(every.size, dtype=bool)

        def leave(
            at: Linearised, some: NDArray[np.bool_], begin: State | None, history: tuple[FloatArray, ...]
        ) -> bool:
            """Correct some positions by themselves where they are few."""
            if not (apart and every.size > TOGETHER and 0 < 2 * np.count_nonzero(some) < every.size):
                return False
            rows = np.nonzero(some)[0]
            system, mine = ContactSystem(self.model.take(rows)), take_positions((begin, history), rows)
            groups = system._settled(at.of_rows(system, rows), mine[0], apart, mine[1])
            others.extend((rows[each], group) for each, group in groups)
            gone[rows] = True
            return True

        history = (*history, at.moved)
        while not (settled := at.settled(at.roughly) | gone).all():
            if len(history) > MAX_CORRECTIONS:
                largest = [float(np.max(moved)) for moved in history]
                raise ConvergenceError("deformations of contacts do not settle; largest correction in mm", largest)
            if leave(at, ~settled, begin, history[:-1]):
                break
            if begin is not None:
                if self.coupled and leave(at, self._far_off(at) & ~gone, begin, history[:-1]):
                    begin = None
                    continue
                at, begin = self._begun(at, begin), None
                history = (at.moved,)
                continue
            part = np.where(settled, 0.0, 1.0)
            if len(history) > 4:  # contacts that take turns as pins move are met half way
                part = np.where(history[-1] > 0.5 * history[-3], 0.5 * part, part)
            at = at.corrected(part, partial(leave, at, begin=None, history=history[:-1]))
            history = (*history, at.moved)
        return [(every, at), *others]

    def _far_off(self, at: Linearised) -> NDArray[np.bool_]:
        """Positions whose start may be farther off than none."""
        unsettled = ~at.settled(roughly=True)
        return unsettled & (at.off > FAR_OFF * at.deepest) if self.coupled else unsettled

    def _begun(self, at: Linearised, begin: State) -> Linearised:
        """Begin anew where the start is farther off than none."""
        far = self._far_off(at)
        if self.deforms and far.any():
            shifts = None if begin.shifts is None else begin.shifts * 0.0
            anew = at.again(begin._replace(approach=None, shifts=shifts))
            better = (anew.off < at.off) & far
            if better.all():
                return anew
            if better.any():
                return at.again(mixed(at.here, anew.here, better))
        return at

    def _begin(self, pose: FloatArray, start: Start | None) -> State:
        """Inner unknowns to start from; NaN where they are not known."""
        rows, rollers = pose.shape[0], self.discs * self.rollers
        place = lean = None
        parameter = approach = None
        share: FloatArray | None = None
        near: tuple[FloatArray, ...] = ()
        shifts = None if self.model.pins is None else self.model.pins.unmoved(rows)
        if start is not None:
            parameter, share = start.parameter, start.share
            if start.inner is not None:
                near = start.inner.near
                place, lean, approach, expected = start.inner.at(pose)
                shifts = shifts if expected is None else expected
        if place is None or lean is None:
            place, lean = np.full((rows, rollers), np.nan), np.full((rows, self.components - 1, rollers), np.nan)
        if share is None:
            share = np.full((rows, rollers), 0.5)
        return State(parameter, place, share, lean, approach, shifts, near)


class Linearised:
    """Contacts at poses and near-by inner unknowns, and how everything follows the pose to first order.

    `before` has the same contacts at the same places; `known` excludes pins that cannot touch, and open contacts are taken
    within `margin`. ``force`` and ``tangent``, its derivative, are those once the inner unknowns have settled, to first order.
    """

    force: FloatArray
    tangent: FloatArray
    dx: FloatArray
    """Corrections of places and leans of the chosen rollers, mm, shape (positions, rollers, components)."""
    dx_by_pose: FloatArray
    by_own: list[FloatArray]
    """Derivatives of these by the coordinates of each disc, where nothing else deforms."""
    bodies: list[list[BodyFlexibility]]
    members: PinMembers
    by_slope: BySlope | None = None
    """Additions to the tangent of a search (`ltca.mechanics.full_tangent`)."""

    def __init__(
        self,
        system: ContactSystem,
        angle: FloatArray,
        pose: FloatArray,
        state: State,
        known: KnownPins | None,
        *,
        roughly: bool,
        before: Linearised | None = None,
        margin: float = CANDIDATE_MARGIN,
        by_crank: bool = False,
    ) -> None:
        self.before, self.roughly = before, roughly
        self.by_crank, self.size = by_crank, pose.shape[1] + by_crank
        self.system, self.angle, self.pose, self.known, self.margin = system, angle, pose, known, margin
        self.row = np.arange(angle.size)[:, None]
        self.half = system.half
        self.off = np.zeros(angle.size)
        self._moved_slices: dict[int, list[SlicedContact]] = {}
        self.held = before is not None
        # Rollers are placed in them: those of another evaluation stay as they are.
        self.discs: list[DiscPlaces] = self._placed(state) if before is None else [copy(disc) for disc in before.discs]
        self._approach(state)
        self._carry(state)
        self._choose()
        self.de_by_pose: FloatArray | None = None
        self.aside: FloatArray | None = None
        self.sticking: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self.rubs: list[FloatArray] = []
        self.rubs_leaning: list[FloatArray] = []
        self.linearise()
        self.before = None

    def _placed(self, state: State) -> list[DiscPlaces]:
        """Places of the contacts of every disc, pins displaced."""
        system, found = self.system, []
        for disc, (geometry, own) in enumerate(zip(system.geometries, system.columns, strict=True)):
            first, last = disc * system.pins, (disc + 1) * system.pins
            known = self.known
            if known is not None:
                known = KnownPins(point=known.point[:, first:last], turning=known.turning[:, first:last])
            shifts = leans = None
            if state.shifts is not None:
                shifts = state.shifts[:, disc]
                if system.coordinates.leans:
                    leans = state.shifts[:, system.discs + disc] / self.half
            parameter = None if state.parameter is None else state.parameter[:, first:last]
            found.append(DiscPlaces(geometry, self.angle, self.pose[:, own], parameter, known, shifts, leans))
        return found

    def _approach(self, state: State) -> None:
        """Place the rollers, and find approaches d and deformations e of all contacts."""
        system, (rows,) = self.system, self.angle.shape
        shape = (rows, system.components, system.contacts)
        self.overlap, e = np.zeros(shape), state.approach
        self.place, self.share = state.place.copy(), state.share
        self.lean = state.lean.copy()
        given = system.deforms and e is not None
        e = e.copy() if given and e is not None else None
        for disc, at in enumerate(self.discs):
            own = slice(disc * system.rollers, (disc + 1) * system.rollers)
            _, bores, _, races = system.of_kind[disc]
            place, lean = self.place[:, own], self.lean[:, :, own]
            unplaced = np.isnan(place)
            middle = 0.5 * (at.at_race + at.at_bore)
            if unplaced.any():
                place = np.where(unplaced, state.share[:, own] * at.total, place)
                # One that touches with an end alone leans half as far as bore and race do against each other.
                ends = (unplaced & (at.total <= 0.0))[:, None]
                place, lean = np.where(ends[:, 0], 0.5 * at.total, place), np.where(ends, middle, lean)
            # Moments in both contacts press the same way: a roller leans between race and bore, or little beside.
            room = 0.5 * (np.abs(at.at_race - at.at_bore) + at.room[:, None])
            lean = np.where(np.isnan(lean), middle, np.clip(lean, middle - room, middle + room))
            if e is not None and system.coupled:
                in_bore, on_race = (e[:, :, kind] for kind in (bores, races))
                loose = (reach_of(in_bore) <= 0.0) | (reach_of(on_race) <= 0.0)
                by = np.where(loose[:, None], 0.5 * (in_bore - on_race), 0.0)
                place, lean = place + by[:, 0], lean - by[:, 1:]
                on_race += by
                in_bore -= by
            else:
                in_bore = at.total - place + np.abs(lean - at.at_bore).sum(axis=1)
                loose = (in_bore <= 0.0) | (place + np.abs(at.at_race - lean).sum(axis=1) <= 0.0)
                place, lean = np.where(loose, 0.5 * at.total, place), np.where(loose[:, None], middle, lean)
            at.place_rollers(place)
            self.place[:, own], self.lean[:, :, own] = place, lean
            approaches = at.flank.approach, at.outer, at.holes.approach, place
            tilts = at.pin_tilts, lean - at.at_bore, at.hole_tilts, at.at_race - lean
            for kind, approach, tilt in zip(system.of_kind[disc], approaches, tilts, strict=True):
                self.overlap[:, 0, kind], self.overlap[:, 1:, kind] = approach, tilt
        if e is None:
            e = self.overlap
            if system.coupled:  # a fair share of a rigid overlap
                e = e.copy()
                e[:, 0] *= np.where(e[:, 0] > 0.0, 0.5, 1.0)
        elif system.deforms and (system.coupled or not self.held):
            e = np.where((self._within() | (e[:, 0] > 0.0))[:, None], e, self.overlap)
        if not system.coupled and system.deforms:  # nothing but the two contacts of a roller deforms
            e = e.copy()
            for _, bores, _, races in system.of_kind:
                e[:, :, bores], e[:, :, races] = self.overlap[:, :, bores], self.overlap[:, :, races]
        self.deformation = e

    def _within(self) -> NDArray[np.bool_]:
        """Contacts near enough to carry when the bodies yield under others."""
        if not np.isfinite(self.margin):
            return np.ones(self.overlap[:, 0].shape, dtype=bool)
        reach = reach_of(self.overlap)
        most = np.max(reach, axis=1, initial=0.0)[:, None]
        return np.asarray((reach > 0.0) | (reach > -self.margin * most))

    def stand(self, pose: FloatArray, state: State) -> None:
        """Move the parts while the contacts stay deformed as they are: places and loads follow."""
        self.pose, self.known = pose, None
        self.discs = self._placed(state)
        self._carry(state)

    def _carry(self, state: State) -> None:
        """Loads of all contacts at their deformations, and their derivatives."""
        laws = self.system.contact_laws
        self.load, self.stiffness, self.law_left, self.sliced = laws.carried(
            self.discs, self.deformation, self.half, state.near, roughly=self.roughly
        )

    def _choose(self) -> None:
        """Choose the contacts of the linear system: those that carry, and open ones that others may press."""
        system = self.system
        self.every = not system.deforms
        if self.every:
            self.chosen, self.at, self.of_rollers, self.local = system.every_contact
            self.count = system.contacts
            return
        carries = np.any(self.stiffness != 0.0, axis=0) | (self.load[:, 0] > 0.0) | self._within()
        if self.before is not None:
            carries[self.row, self.before.contacts] = True
        self.chosen = []
        for disc in range(system.discs):
            pins, bores, holes, races = (carries[:, kind] for kind in system.of_kind[disc])
            rollers = padded(bores | races)
            self.chosen.append([padded(pins), rollers, padded(holes), rollers])
        parts = [
            first.start + some
            for kinds, chosen in zip(system.of_kind, self.chosen, strict=True)
            for first, some in zip(kinds, chosen, strict=True)
        ]
        self.contacts: Indices = np.concatenate(parts, axis=1)
        self.rollers: Indices = np.concatenate(
            [disc * system.rollers + chosen[1] for disc, chosen in enumerate(self.chosen)], axis=1
        )
        self.count = self.contacts.shape[1]
        self.at, self.of_rollers, self.local = places_of(self.chosen)

    def of_chosen(self, values: FloatArray) -> FloatArray:
        """Values of all contacts, shape (…, positions, components, contacts), of the chosen ones."""
        if self.every:
            return values
        return np.asarray(np.take_along_axis(values, self.contacts[:, None], axis=-1))

    def of_all(self, values: FloatArray) -> FloatArray:
        """Values of the chosen contacts, shape (positions, components, chosen, …), of all: zero of the others."""
        if self.every:
            return values
        found = np.zeros((*values.shape[:2], self.system.contacts, *values.shape[3:]))
        found[self.row, :, self.contacts] = values.swapaxes(1, 2)
        return found

    def of_all_rollers(self, values: FloatArray) -> FloatArray:
        """Values of the chosen rollers, shape (positions, rollers, …), of all: zero of the others."""
        if self.every:
            return values
        found = np.zeros((*self.place.shape, *values.shape[2:]))
        found[self.row, self.rollers] = values
        return found

    def picked(self, values: NDArray[Any], some: Indices) -> NDArray[Any]:
        """Values by contact of a kind, shape (positions, contacts, …), of the chosen ones."""
        return values if self.every else values[self.row, some]

    @cached_property
    def columns(self) -> list[Indices]:
        """Coordinates of each disc, with the crank angle where that is one."""
        own = self.system.columns
        return [np.append(each, self.size - 1) for each in own] if self.by_crank else own

    @cached_property
    def pressing(self) -> list[Pressing]:
        """Generalised forces of the chosen contacts of every disc."""
        self.chosen_load = self.of_chosen(self.load)
        self.chosen_stiffness = self.of_chosen(self.stiffness.swapaxes(0, 1)).swapaxes(0, 1)
        return [pressing_of(self, disc) for disc in range(self.system.discs)]

    @cached_property
    def de(self) -> FloatArray:
        """Corrections of the deformations of the chosen contacts, mm, shape (positions, components, chosen)."""
        found = np.zeros(self.load.shape)
        for disc, (at, (_, bores, _, races)) in enumerate(zip(self.discs, self.system.of_kind, strict=True)):
            step = self.dx[:, disc * self.system.rollers : (disc + 1) * self.system.rollers, 0]
            found[:, 0, bores], found[:, 0, races] = -at.cosine * step, step
        return found

    @cached_property
    def change(self) -> FloatArray:
        """Corrections of their loads, N."""
        return np.asarray(self.stiffness[0][:, None] * self.de)

    @cached_property
    def left(self) -> FloatArray:
        """Force that the second order may amount to, N, shape (positions,)."""
        deep = np.abs(self.of_chosen(self.deformation)).sum(axis=1) + 1e-300
        moved = np.abs(self.de).sum(axis=1)
        error = np.abs(self.change).sum(axis=1) * np.minimum(1.0, moved / deep)
        left = np.maximum(LEFT_WEIGHT * np.max(error, axis=1, initial=0.0), self.law_left)
        return np.asarray(left if self.shifts is None else np.maximum(left, self._left_of_pins))

    @property
    def _left_of_pins(self) -> FloatArray:
        """Loads by the second-order change of gaps as pins move along curved contacts, N."""
        found = np.zeros(self.angle.size)
        assert self.shifts is not None
        assert self.shifts_after is not None
        moved = np.abs(self.shifts_after - self.shifts)[:, : self.system.discs] ** 2
        for disc, (at, kinds) in enumerate(zip(self.discs, self.system.of_kind, strict=True)):
            curved = np.abs(np.concatenate((at.flank.bending, at.holes.bending), axis=1))
            stiff = np.concatenate((self.stiffness[0][:, kinds[0]], self.stiffness[0][:, kinds[2]]), axis=1)
            found = np.maximum(found, np.max(0.5 * stiff * curved * moved[:, disc], axis=1, initial=0.0))
        return found

    def bodies_between(self) -> list[list[BodyFlexibility]]:
        """Flexibility of the bodies between the chosen contacts, by disc and component."""
        return [
            []
            if model.coefficients is None
            else model.body_flexibility(self.body_places(disc), self.chosen[disc][:3])[: self.system.components]
            for disc, model in enumerate(self.system.model.discs)
        ]

    def linearise(self) -> None:
        """Eliminate deformations, displacements of pins and places of rollers."""
        if self.system.plain:
            eliminate_rollers(self)
            return
        if self.system.deforms:
            eliminate_coupled(self)
        else:
            eliminate_by_disc(self)
        stiffness = self.chosen_stiffness
        self.change = loads_of(stiffness, self.de[..., None])[..., 0]
        moved = np.abs(self.de).sum(axis=1)
        # A roller that hardly touches may go on for ever in a direction that changes no load.
        changed = np.abs(self.change).sum(axis=1)
        least = LEAST_ROUGHLY if self.roughly else LEAST_CHANGE
        matters = changed > least * self.load[:, 0].max(axis=1, initial=0.0)[:, None]
        self.moved = np.max(np.where(matters & (stiffness[0] > 0.0), moved, 0.0), axis=1, initial=0.0)
        if self.system.deforms:
            self.moved = np.maximum(self.moved, self._closed)

    @property
    def _closed(self) -> FloatArray:
        """Depth to which the correction presses open contacts, mm; for a roller its whole play counts."""
        after = self.deformation[:, 0].copy()
        if not self.held:  # where pins are held, what they will press is found by those that are not
            after += self.moved_by_pins[:, 0]
        after[self.row, self.contacts] = self.of_chosen(self.deformation)[:, 0] + self.de[:, 0]
        before = self.deformation[:, 0].copy()
        for _, bores, _, races in self.system.of_kind:
            for each in (before, after):
                each[:, bores] = each[:, races] = 0.5 * (each[:, bores] + each[:, races])
        # Crowned ones in slices are open up to a depth: only what is deeper than where they were found open counts.
        pressed = np.minimum(after, after - before)
        return np.asarray(np.max(np.where(self.stiffness[0] > 0.0, 0.0, pressed), axis=1, initial=0.0))

    @cached_property
    def moved_by_pins(self) -> FloatArray:
        """Change of approaches and tilts as pins go where loads press them, mm, shape (positions, components, contacts)."""
        if self.shifts is None or self.shifts_after is None:
            return np.zeros(self.overlap.shape)
        return self.members.approaches(self.shifts_after - self.shifts)

    @property
    def onward(self) -> Start:
        """Start for a position that is nearby in pose and crank angle: no pin is left out."""
        motions = [each.flank for each in self.discs]
        return Start(
            parameter=beside([motion.parameter for motion in motions]),
            share=self.share,
            known=KnownPins(
                point=beside([motion.point for motion in motions]),
                turning=beside([motion.turning for motion in motions]),
            ),
            inner=self.inner,
        )

    def pin_loads(self, disc: int) -> FloatArray:
        """Return loads of wheel pins and shaft pins, N, and in slices moments by `half`, shape (positions, components, pairs)."""
        pins, _, holes, _ = self.system.of_kind[disc]
        return np.concatenate((self.corrected_load[..., pins], self.corrected_load[..., holes]), axis=-1)

    def pushes(self, disc: int) -> ComplexArray:
        """Return the force of every crank bearing on a disc in the fixed frame, N, shape (positions, cranks)."""
        at, bores = self.discs[disc], self.system.of_kind[disc][1]
        return _by_crank(self.corrected_load[:, 0, bores] * at.outward, at.bores.arm.shape[1])

    def bearing_moments(self, disc: int) -> ComplexArray:
        """Return the generalised force of crank bearings on the lean of a disc, none in the plane, N·mm, (positions, cranks)."""
        at, bores = self.discs[disc], self.system.of_kind[disc][1]
        moments = self.half * self.corrected_load[:, 1:, bores].sum(axis=1)
        return _by_crank(moments * at.rays.direction, at.bores.arm.shape[1])

    @cached_property
    def shifts(self) -> ComplexArray | None:
        """Displacements of the pins, mm."""
        if self.system.model.pins is None:
            return None
        each = [at.shifts for at in self.discs]
        each += [None if at.leans is None else at.leans * self.half for at in self.discs]
        return np.stack([one for one in each if one is not None], axis=1)

    def body_places(self, disc: int) -> BodyPlaces:
        """Places of the contacts of a disc on its body."""
        at = self.discs[disc]
        place = at.geometry.placement
        turn, holes = at.pose[:, DISC_ROTATION, None], at.holes.gradient
        in_bore = np.angle(at.rays.outermost * at.rays.direction - at.displacement) - turn
        in_hole = np.angle(-(holes[..., X] + 1j * holes[..., Y])) - turn
        on_flank = at.geometry.profile.flank(at.flank.parameter)
        return BodyPlaces.on_walls(
            at.flank.parameter, on_flank, in_bore, float(place.bore_radius), in_hole, place.cranks
        )

    def settled(self, roughly: bool) -> NDArray[np.bool_]:
        """Positions whose inner unknowns are close enough for a step of the pose, or for an answer."""
        return self.are_small(
            self.moved, ROUGHLY_SETTLED if roughly else SETTLED_IN_MOTION if self.by_crank else SETTLED
        )

    def are_small(self, moved: FloatArray, part: float) -> NDArray[np.bool_]:
        """Positions where corrections, mm, are a small part of the largest approach."""
        return np.asarray(moved <= part * self.deepest + ROUND_OFF)

    @cached_property
    def deepest(self) -> FloatArray:
        """Largest approach of a loaded contact, mm, shape (positions,)."""
        return np.asarray(np.max(np.abs(self.overlap[:, 0]) * (self.load[:, 0] > 0.0), axis=1, initial=0.0))

    def again(self, state: State, before: Linearised | None = None) -> Linearised:
        """Return the contacts at the same poses with other inner unknowns, at the same places as `before`."""
        known, how = None if self.by_crank else self.known, {"roughly": self.roughly, "by_crank": self.by_crank}
        return Linearised(self.system, self.angle, self.pose, state, known, margin=self.margin, before=before, **how)

    def of_rows(self, system: ContactSystem, rows: Indices) -> Linearised:
        """Return some positions as those of another system."""
        angle, pose, state, known = take_positions((self.angle, self.pose, self.here, self.known), rows)
        return Linearised(
            system, angle, pose, state, known, roughly=self.roughly, margin=self.margin, by_crank=self.by_crank
        )

    @property
    def here(self) -> State:
        """Inner unknowns without the correction."""
        return self._state(np.zeros(self.angle.size))

    def _state(self, fraction: FloatArray | None = None) -> State:
        """Inner unknowns after the correction, or a fraction of it."""
        approach, shifts = self.after if self.system.deforms else None, self.shifts_after
        place, lean = self.place_after, self.lean_after
        if fraction is not None and not np.all(fraction == 1.0):
            part = fraction[:, None]
            place = self.place + part * (place - self.place)
            lean = self.lean + part[..., None] * (lean - self.lean)
            if approach is not None:
                approach = self.deformation + part[..., None] * (approach - self.deformation)
        if fraction is not None and shifts is not None and self.shifts is not None:
            shifts = self.shifts + fraction[:, None, None] * (shifts - self.shifts)
        return State(
            parameter=beside([at.flank.parameter for at in self.discs]),
            place=place,
            share=self.share,
            lean=lean,
            approach=approach,
            shifts=shifts,
            near=tuple(one.near for found in self.sliced for one in found),
        )

    @cached_property
    def after(self) -> FloatArray:
        """Deformations of all contacts after the correction."""
        return self.deformation + self.of_all(self.de)

    @cached_property
    def place_after(self) -> FloatArray:
        """Places of the rollers after the correction, inward of where they only touch the race, mm."""
        return self.place + self.of_all_rollers(self.dx)[..., 0]

    @cached_property
    def lean_after(self) -> FloatArray:
        """Leans of the rollers after the correction, by half the thickness of the disc, mm."""
        return self.lean + self.of_all_rollers(self.dx)[..., 1:].swapaxes(1, 2)

    def slices_after(self, disc: int) -> list[SlicedContact]:
        """Return the contacts of a disc in slices, by kind, moved along their slopes by the correction; none in the plane."""
        if disc not in self._moved_slices:
            found = []
            for one, kind in zip(self.sliced[disc], self.system.of_kind[disc], strict=False):
                change = self.after[:, :, kind] - self.deformation[:, :, kind]
                found.append(
                    one.moved(change[:, 0], change[:, 1] / self.half, self.corrected_load[:, :, kind], self.half)
                )
            self._moved_slices[disc] = found
        return self._moved_slices[disc]

    @cached_property
    def shifts_after(self) -> ComplexArray | None:
        """Displacements of the pins under the corrected loads."""
        pins = self.system.model.pins
        if pins is None:
            return None
        aside = None if self.aside is None else self.aside[..., -1]
        return np.asarray(-pins.under(self.members.forces(self.corrected_load, aside)))

    @cached_property
    def corrected_load(self) -> FloatArray:
        """Loads of all contacts, to first order in the residual of the inner unknowns."""
        load = self.load + self.of_all(self.change)
        return np.where(load[:, :1] > 0.0, load, 0.0)

    def corrected(self, part: FloatArray, leave: Callable[[NDArray[np.bool_]], bool] | None = None) -> Linearised:
        """Return the contacts with inner unknowns corrected at positions whose `part` is not zero.

        Deformations settle at pins that stand, gaps taken as linear; then pins move by `part` to where loads press them.
        `leave` takes away positions that go back, where they are few.
        """
        moves = part > 0.0
        at = self._stepped(moves, None if self.shifts is not None else leave)
        if self.shifts is None:
            return at
        for _ in range(MAX_CORRECTIONS):
            going, before = moves & ~at.settled(roughly=True), at.off
            if not going.any():
                break
            at = at._stepped(going)
            if not np.any(at.off[going] < before[going]):
                break
        state = at._state()
        assert state.shifts is not None
        state = state._replace(shifts=self.shifts + part[:, None, None] * (state.shifts - self.shifts))
        return self.again(state if moves.all() else mixed(self.here, state, moves))

    def _stepped(
        self, moves: NDArray[np.bool_], leave: Callable[[NDArray[np.bool_]], bool] | None = None
    ) -> Linearised:
        """The contacts with deformations of some positions a step on, which is halved as long as their residual grows."""
        fraction = moves.astype(float)
        for _ in range(MAX_HALVINGS):
            found = self.again(self._state(fraction), self)
            if not self.system.deforms:
                break
            # A first step leads from what was expected to deformations that follow from loads, wherever that is.
            if not (self.held or self.system.coupled):
                break
            far = (found.off > self.off) & moves & (found.off > ROUND_OFF * 100.0)
            if not far.any() or (leave is not None and leave(far)):
                break
            fraction = np.where(far, 0.5 * fraction, fraction)
        return found

    @cached_property
    def yielding(self) -> list[list[FloatArray]]:
        """Deformations of the bodies at pins, bores and holes by disc and component."""
        found: list[list[FloatArray]] = []
        for disc, bodies in enumerate(self.bodies):
            pins, _, holes, _ = self.system.of_kind[disc]
            walls = self.corrected_load[:, :, pins.start : holes.stop]
            found.append([body.taken(walls[:, component]) for component, body in enumerate(bodies)])
        return found

    @cached_property
    def leaves_out(self) -> NDArray[np.bool_]:
        """Positions where a contact that was left out is pressed together after all."""
        found = np.zeros(self.angle.size, dtype=bool)
        if not self.system.deforms or not np.isfinite(self.margin):
            return found
        reach = reach_of(self.overlap + self.moved_by_pins)
        for disc, (kinds, yielding) in enumerate(zip(self.system.of_kind, self.yielding, strict=True)):
            pressed = reach[:, kinds[0].start : kinds[2].stop] > (yielding[0] if yielding else 0.0)
            for some, kind in zip(self.chosen[disc][:3], kinds[:3], strict=True):
                pressed[self.row, some + kind.start - kinds[0].start] = False
            found |= pressed.any(axis=1)
        return found

    @property
    def inner(self) -> Inner:
        """Inner unknowns beside the pose, and how they follow it."""
        state = self._state()
        shifts = None
        if self.shifts is not None and self.de_by_pose is not None:
            pins = self.system.model.pins
            assert pins is not None
            change = loads_of(self.chosen_stiffness, self.de_by_pose)
            if self.by_slope is not None:
                change += self.by_slope.load
            each = np.moveaxis(change, -1, 0)
            aside = [None] * self.size if self.aside is None else np.moveaxis(self.aside[..., :-1], -1, 0)
            shifts = np.stack(
                [
                    -pins.under(self.members.forces(self.of_all(one), turned, changes=True))
                    for one, turned in zip(each, aside, strict=True)
                ],
                axis=-1,
            )
        columns: tuple[tuple[int, ...], ...] = ()
        if self.system.coupled:
            by_pose = self.of_all_rollers(self.dx_by_pose)
        else:
            by_own = self.by_own
            if not self.every:
                shape = self.angle.size, self.system.rollers
                by_own = [np.zeros((*shape, *own.shape[2:])) for own in self.by_own]
                for found, own, some in zip(by_own, self.by_own, self.chosen, strict=True):
                    found[self.row, some[1]] = own
            by_pose = np.concatenate(by_own, axis=1) if len(by_own) > 1 else by_own[0]
            if len(self.by_own) > 1:
                columns = tuple(tuple(own.tolist()) for own in self.columns)
        by_approach = None
        if self.de_by_pose is not None:
            by_approach = np.zeros((*self.load.shape, self.size))
            of_approach = by_approach[:, 0]
            for at, own, (pins, _, holes, _) in zip(self.discs, self.system.columns, self.system.of_kind, strict=True):
                of_approach[:, pins, own], of_approach[:, holes, own] = at.flank.gradient, at.holes.gradient
            by_approach[self.row, :, self.contacts] = self.de_by_pose.swapaxes(1, 2)
        return Inner(
            pose=with_crank(self.pose, self.angle) if self.by_crank else self.pose,
            place=state.place,
            lean=state.lean,
            approach=state.approach,
            shifts=state.shifts,
            near=state.near,
            by_pose=by_pose,
            approach_by_pose=by_approach,
            shifts_by_pose=shifts,
            columns=columns,
        )


def _by_crank(values: NDArray[Any], cranks: int) -> NDArray[Any]:
    """Sums over the rollers of every crank."""
    return np.asarray(values.reshape(values.shape[0], cranks, -1).sum(axis=2))
