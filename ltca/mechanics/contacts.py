r"""All contacts of a reducer at poses, with everything elastic that couples them: one system for every engine.

A contact is a place and a local law. It approaches by d and, in slices, tilts; its deformation e carries the load f(e), and what
all loads take of d is

.. math:: e + C f(e) = d(q, x, u), \qquad u = -S L^T f, \qquad T^T f = 0,

with the pose q, the places x of the rollers between their races (and their leans), the displacements u of the pins, the influence
coefficients C of the bodies and the flexibility S of beams and ring. T and N are the derivatives of d by x and u, L is N with
friction. Newton's step solves for all of them at once: with K = ∂f/∂e and W = C + N S Lᵀ

.. math:: (1 + W K)\, de = G\,dq + T\,dx - r, \qquad r = e - d + C f + N (u + S L^T f),

e and u are eliminated contact by contact, then x roller by roller; what is left is a force and a tangent of the pose alone. The
derivatives of C and of the radii of curvature by the pose are left out, which keeps the tangent symmetric.

A run in time asks for the crank angle as one more coordinate behind the pose, with which the cages turn and discs and wheel go
along as they nominally do (`by_crank`). Its tangent is Σ k g gᵀ of contacts with their rollers and bodies alone: without what
forces add as they turn.

Contacts are numbered disc after disc: wheel pins, rollers in the bores, shaft pins in their holes, rollers on the races. Arrays
have the shape (positions, components, contacts), with the approach and, in slices, the tilt times half the thickness of the disc
as components.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance import sliced
from ltca.compliance.contact_laws import ContactLaws
from ltca.compliance.coupled import BodyFlexibility
from ltca.compliance.inner_unknowns import Following, Inner
from ltca.compliance.response import Start
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, X, Y
from ltca.geometry.pair_motion import KnownPins, PairTilt, dot
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.line_contact import LineContactLaw
from ltca.mechanics.displaced_pins import PinBlocks, PinMembers, solved

if TYPE_CHECKING:
    from ltca.laws.sliced_contact import SlicedContact

Indices = NDArray[np.intp]

CANDIDATE_MARGIN = 0.25
"""Gap within which an open contact of coupled bodies may carry, by the largest overlap of its position."""
ROUGHLY_SETTLED = 0.02
"""Largest correction of a deformation, by the largest approach, with which a step of the pose is judged."""
SETTLED = 1e-7
"""The same of an answer: loads are corrected to first order, and the error left is of its square."""
SETTLED_IN_MOTION = 1e-5
"""The same of a run in time, whose step leaves a hundred times as much as the 1e-11 of loads that these leave."""
MAX_CORRECTIONS = 60
MAX_HALVINGS = 12
STEEPEST = 0.3
"""Largest slope of the energy at the end of a correction by that at its start."""
LEFT_WEIGHT = 100.0
"""What is left of the inner unknowns counts so many times: moments of the cranks are balanced more closely than forces."""
ROUND_OFF = 1e-13
"""Correction that is nothing but round-off of places, mm."""
LEAST_CHANGE = 1e-13
"""Change of a load by the largest of its position that is none."""
LEAST_ROOM = 1e-7
"""Correction of a roller that is always allowed, mm: one that is hardly pressed would go on by less for ever."""
LEAST_TURNING = 1e-9
"""Stiffness against leaning by that of the place and the square of half the width: what touches at one end alone turns freely."""


class _Disc:
    """Places of the contacts of one disc at poses."""

    def __init__(
        self,
        geometry: ContactGeometry,
        angle: FloatArray,
        pose: FloatArray,
        parameter: FloatArray | None,
        known: KnownPins | None,
        shifts: ComplexArray | None,
        leans: ComplexArray | None,
    ) -> None:
        self.geometry, self.angle, self.pose, self.shifts, self.leans = geometry, angle, pose, shifts, leans
        pins = geometry.placement.wheel_pin_radii.shape[-1]
        on_pins, on_holes = (None, None) if shifts is None else (shifts[:, :pins], shifts[:, pins:])
        at = geometry.disc_place(angle, pose)
        self.races = at.races
        self.flank = geometry.flank(angle, pose, parameter, on_pins, known, at)
        self.holes = geometry.holes(angle, pose, on_holes, at)
        self.bores, self.rays = geometry.bores(angle, pose, at), geometry.rollers(angle)
        self.rollers = self.rays.direction.shape[1]
        self.displacement = self.bores.each(self.bores.displacement, self.rollers)
        # Along and across the rays.
        self.displaced = self.rays.direction.conjugate() * self.displacement
        self.total = self.rays.outermost - self.rays.touching(self.displaced)
        self.tilts: tuple[PairTilt, PairTilt] | None = None
        if geometry.coordinates_of(pose).leans:
            lean_pins, lean_holes = (None, None) if leans is None else (leans[:, :pins], leans[:, pins:])
            self.tilts = (
                geometry.flank_tilt(angle, pose, self.flank, lean_pins),
                geometry.hole_tilt(pose, self.holes, lean_holes),
            )
            journals = self.bores.each(geometry.journal_leans(pose), self.rollers)
            self.at_race, self.at_bore = (dot(self.rays.direction, lean) for lean in (journals, geometry.lean(pose)))

    @property
    def room(self) -> FloatArray:
        """How far rollers are pressed together, or stand apart, where bore and race do not tilt against each other, mm."""
        return np.abs(self.total)

    @cached_property
    def nominal(self) -> FloatArray:
        """Nominal motion of disc and wheel by the crank angle, mm and rad, shape (positions, coordinates, 1)."""
        place, found = self.geometry.placement, np.zeros((*self.pose.shape, 1))
        velocity = self.races.velocity
        found[:, X, 0], found[:, Y, 0], found[:, WHEEL_ANGLE, 0] = (
            velocity.real,
            velocity.imag,
            1.0 / place.reduction_ratio,
        )
        return found

    @cached_property
    def seen_from_cages(self) -> FloatArray:
        """Motion of the bores against the cages by the crank angle, x and y, mm/rad, shape (positions, cranks, 2)."""
        place, bores = self.geometry.placement, self.bores
        seen = self.races.velocity[:, None] - 1j * (bores.lever + place.cage_speed * bores.displacement)
        return np.asarray(seen.view(float).reshape(*seen.shape, 2))

    def place_rollers(self, inward: FloatArray) -> None:
        """Put the rollers inward of where they only touch the race, mm (Eq. 52, 57, 69)."""
        rays = self.rays
        place = rays.outermost - inward
        arm = place - self.displaced
        self.length = np.abs(arm)
        turn = arm / self.length
        self.outward, self.cosine, self.slant = turn * rays.direction, turn.real, -turn.imag
        # |s n − d| less the bore play as a product: no cancellation for rollers that barely touch.
        beyond = place + (rays.outermost - self.total) - 2.0 * self.displaced.real
        self.inward, self.outer = inward, (self.total - inward) * beyond / (self.length + rays.bore_play)


class ContactSystem:
    """Contacts of all discs of a reducer.

    Parameters
    ----------
    model : ltca.equilibrium.reducer.Reducer
        Discs with their laws and bodies, what displaces pins, and friction.
    """

    def __init__(self, model: Any) -> None:
        self.model, self.coordinates = model, model.coordinates
        self.geometries = model.geometries
        place = self.geometries[0].placement
        self.pins, self.rollers = place.wheel_pin_radii.shape[-1], place.roller_radii.shape[-1]
        self.holes, self.discs = place.hole_radii.shape[-1], len(model.discs)
        self.each = self.pins + 2 * self.rollers + self.holes
        self.contacts = self.discs * self.each
        self.components = 1 + self.coordinates.leans
        bodies: tuple[Any, ...] = model.discs
        self.bodies = bodies
        self.laws: list[ContactLaws] = [disc.contact_laws for disc in bodies]
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
        alike = all(type(laws) is ContactLaws for laws in self.laws)
        self.law_groups = _law_groups(self) if self.components == 1 and alike else []
        self.radii = _radii(self)
        self.never_left_out = np.full((1, self.discs * self.pins), np.inf)

    @property
    def half(self) -> FloatArray:
        """Half the thickness of the discs, by which tilts are measured, mm, shape (…,) of one number or (positions, 1)."""
        return np.asarray(self.geometries[0].half_width, dtype=float)

    @cached_property
    def every_contact(self) -> tuple[list[list[Indices]], list[list[slice]], list[slice], list[list[slice]]]:
        """All contacts of every disc and kind as chosen ones, of one position for all, and `_places_of` them."""
        sizes = self.pins, self.rollers, self.holes, self.rollers
        chosen = [[np.arange(size)[None] for size in sizes] for _ in range(self.discs)]
        return chosen, *_places_of(chosen)

    def respond(
        self,
        angle: FloatArray,
        pose: FloatArray,
        start: Start | ContactStart | None,
        *,
        roughly: bool,
        everything: bool = False,
        by_crank: bool = False,
    ) -> Linearised:
        """Return contacts at poses, found to first order in what is left of the inner unknowns.

        Contacts of coupled bodies that are far from touching are left out of the linear system unless `everything` is asked for;
        `Linearised.leaves_out` tells where one of them is pressed after all, which is looked at here unless `roughly`. With
        `by_crank` the crank angle is a coordinate behind the pose.
        """
        state = self._begin(with_crank(pose, angle) if by_crank else pose, start)
        known = None if start is None or (not by_crank and (self.deforms or self.components > 1)) else start.known
        for margin in (np.inf,) if everything else (CANDIDATE_MARGIN, np.inf):
            at = Linearised(self, angle, pose, state, known, roughly=roughly, margin=margin, by_crank=by_crank)
            at = self._settle(at, state)
            if roughly or not at.leaves_out.any():
                break
        return at

    def _settle(self, at: Linearised, begin: _State) -> Linearised:
        """Correct the inner unknowns, each position for itself, until they have settled."""
        if self.deforms and not at.settled(roughly=True).all():
            # What was expected may be farther off than nothing at all.
            shifts = None if begin.shifts is None else begin.shifts * 0.0
            anew = at.again(begin._replace(approach=None, shifts=shifts))
            better = (anew.off < at.off) & ~at.settled(roughly=True)
            if better.all():
                at = anew
            elif better.any():
                at = at.again(_mixed(at.here, anew.here, better))
        history = [at.moved]
        while not (settled := at.settled(at.roughly)).all():
            if len(history) > MAX_CORRECTIONS:
                largest = [float(np.max(moved)) for moved in history]
                raise ConvergenceError("deformations of contacts do not settle; largest correction in mm", largest)
            part = np.where(settled, 0.0, 1.0)
            if len(history) > 4:  # contacts that take turns as pins move are met half way
                part = np.where(history[-1] > 0.5 * history[-3], 0.5 * part, part)
            at = at.corrected(part)
            history.append(at.moved)
        return at

    def _begin(self, pose: FloatArray, start: Start | ContactStart | None) -> _State:
        """Inner unknowns to start from; NaN where nothing is known."""
        rows, rollers = pose.shape[0], self.discs * self.rollers
        place = lean = None
        parameter = approach = None
        share: FloatArray | None = None
        near: tuple[FloatArray, ...] = ()
        shifts = None if self.model.pins is None else self.model.pins.unmoved(rows)
        if start is not None:
            parameter, share = start.parameter, start.share
            if start.inner is not None:
                if self.deforms and start.inner.approach is not None:
                    fits = start.inner.approach.shape[1:] == (self.components, self.contacts)
                    approach = start.inner.approach if fits else None
                if self.components > 1:
                    near = start.inner.near
                    lean = start.inner.lean if start.inner.lean.shape == (rows, rollers) else None
            if start.follow is not None:
                place, lean, approach, shifts = start.follow.at(pose)
        if place is None or lean is None:
            unknown = np.full((rows, rollers), np.nan)
            place, lean = unknown if place is None else place, unknown if lean is None else lean
        if share is None:
            share = np.full((rows, rollers), 0.5)
        return _State(parameter, place, share, lean, approach, shifts, near)


class _State(NamedTuple):
    """Inner unknowns at poses: contact parameters, places and leans of rollers, deformations, displacements of pins, and what
    laws start from.
    """

    parameter: FloatArray | None
    place: FloatArray
    share: FloatArray
    lean: FloatArray
    approach: FloatArray | None
    shifts: ComplexArray | None
    near: tuple[FloatArray, ...]


class ContactStart(NamedTuple):
    """Inner unknowns of a neighbouring position, to start from."""

    parameter: FloatArray
    share: FloatArray
    known: KnownPins
    follow: Following
    inner: Inner


def _mixed(first: _State, second: _State, rows: NDArray[np.bool_]) -> _State:
    """Inner unknowns of the first but for some positions, which have those of the second."""

    def of_both(mine: Any, other: Any) -> Any:
        if mine is None or other is None:
            return mine
        if isinstance(mine, tuple):
            return tuple(of_both(*each) for each in zip(mine, other, strict=True))
        return _by_rows(rows, other, mine)

    return _State(*(of_both(*each) for each in zip(first, second, strict=True)))


class _Pressing(NamedTuple):
    """What chosen contacts press coordinates with.

    Attributes
    ----------
    g : array, shape (positions, components, chosen, coordinates)
        ∂d/∂q.
    force_map : array, of the same shape
        The same with friction along the tangents.
    load : array, shape (positions, components, chosen)
        f.
    stiffness : array, shape (1 or 3, positions, chosen)
        K.
    presses : tuple of array, shape (positions, components, rollers)
        How places and leans of rollers press their contacts in bores and on races.
    unbalanced : array, shape (positions, rollers, components)
        What presses the rollers' places.
    placed : array, shape (positions, rollers, components, coordinates)
        How that follows the coordinates where contacts do not.
    own_bend : array, shape (positions, rollers)
        How it follows the places likewise.
    force, tangent : array, shapes (positions, coordinates) and (positions, coordinates, coordinates)
        What presses the coordinates, and how that follows them where loads do not.
    """

    g: FloatArray
    force_map: FloatArray
    load: FloatArray
    stiffness: FloatArray
    presses: tuple[FloatArray, FloatArray]
    unbalanced: FloatArray
    placed: FloatArray
    own_bend: FloatArray
    force: FloatArray
    tangent: FloatArray


class _Eliminated(NamedTuple):
    """Force and tangent of the pose with everything else eliminated, corrections of places and deformations, and how these follow
    the pose.
    """

    force: FloatArray
    tangent: FloatArray
    dx: FloatArray
    dx_by_pose: FloatArray
    de: FloatArray
    de_by_pose: FloatArray


class Linearised:
    """Contacts at poses and near-by inner unknowns, and how everything follows the pose to first order.

    Parameters
    ----------
    system : ContactSystem
        The contacts.
    angle : array, shape (positions,)
        φ_C, rad.
    pose : array, shape (positions, coordinates)
        q.
    state : _State
        Inner unknowns.
    known : KnownPins, optional
        Pins that cannot touch are left out by.
    roughly : bool
        Whether laws that iterate may come as close as a search needs.
    before : Linearised, optional
        The same contacts at the same places, where only the inner unknowns have changed.
    margin : float
        Gap by the largest overlap within which open contacts of coupled bodies are taken.
    by_crank : bool
        Whether the crank angle is a coordinate behind the pose.

    Notes
    -----
    ``force`` and ``tangent`` are the generalised force of the contacts once the inner unknowns have settled, to first order, and
    its derivative, shapes (positions, coordinates) and (positions, coordinates, coordinates); ``left`` is the force that the
    second order may amount to, N, shape (positions,).
    """

    def __init__(
        self,
        system: ContactSystem,
        angle: FloatArray,
        pose: FloatArray,
        state: _State,
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
        self.discs: list[_Disc] = self._placed(state) if before is None else [copy(disc) for disc in before.discs]
        self._approach(state)
        if system.components == 1:
            self._carry_in_plane()
        else:
            self._carry(state, roughly)
        self._choose()
        self.de_by_pose: FloatArray | None = None
        self.sticking: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self.rubs: list[FloatArray] = []
        self.rubs_leaning: list[FloatArray] = []
        if system.plain:
            self._linearise_plain()
        else:
            self._linearise()
        self.before = None

    def _placed(self, state: _State) -> list[_Disc]:
        """Places of the contacts of every disc with the pins displaced as the state says."""
        system, found = self.system, []
        for disc, (geometry, own) in enumerate(zip(system.geometries, system.columns, strict=True)):
            first, last = disc * system.pins, (disc + 1) * system.pins
            known = self.known
            if known is not None:
                known = KnownPins(
                    approach=known.approach[:, first:last],
                    point=known.point[:, first:last],
                    turning=known.turning[:, first:last],
                )
            shifts = leans = None
            if state.shifts is not None:
                shifts = state.shifts[:, disc]
                if system.components > 1:
                    leans = state.shifts[:, system.discs + disc] / self.half
            parameter = None if state.parameter is None else state.parameter[:, first:last]
            found.append(_Disc(geometry, self.angle, self.pose[:, own], parameter, known, shifts, leans))
        return found

    def _approach(self, state: _State) -> None:
        """Place the rollers, and find approaches d and deformations e of all contacts."""
        system, (rows,) = self.system, self.angle.shape
        shape = (rows, system.components, system.contacts)
        self.overlap, e = np.zeros(shape), state.approach
        self.place, self.share = state.place.copy(), state.share
        self.lean = np.zeros(self.place.shape) if system.components == 1 else state.lean.copy()
        given = system.deforms and e is not None
        e = e.copy() if given and e is not None else None
        for disc, at in enumerate(self.discs):
            own = slice(disc * system.rollers, (disc + 1) * system.rollers)
            _, bores, _, races = system.of_kind[disc]
            place, lean = self.place[:, own], self.lean[:, own]
            unplaced = np.isnan(place)
            if unplaced.any():
                place = np.where(unplaced, state.share[:, own] * at.total, place)
            at_race = at_bore = middle = lean
            if at.tilts is not None:
                at_race, at_bore = self.half * at.at_race, self.half * at.at_bore
                middle = 0.5 * (at_race + at_bore)
                # Moments in both contacts press the same way: a roller leans between race and bore, or little beside.
                room = 0.5 * (np.abs(at_race - at_bore) + at.room)
                lean = np.where(np.isnan(lean), middle, np.clip(lean, middle - room, middle + room))
            if e is not None and system.coupled:
                reach = e[:, 0] + (np.abs(e[:, 1]) if at.tilts is not None else 0.0)
                loose = (reach[:, bores] <= 0.0) | (reach[:, races] <= 0.0)
                by = np.where(loose, 0.5 * (e[:, 0, bores] - e[:, 0, races]), 0.0)
                place = place + by
                e[:, 0, races] += by
                e[:, 0, bores] -= by
                if at.tilts is not None:
                    by = np.where(loose, 0.5 * (e[:, 1, races] - e[:, 1, bores]), 0.0)
                    lean = lean + by
                    e[:, 1, races] -= by
                    e[:, 1, bores] += by
            else:
                in_bore, on_race = at.total - place, place
                if at.tilts is not None:
                    in_bore, on_race = in_bore + np.abs(lean - at_bore), on_race + np.abs(at_race - lean)
                loose = (in_bore <= 0.0) | (on_race <= 0.0)
                place = np.where(loose, 0.5 * at.total, place)
                if at.tilts is not None:
                    lean = np.where(loose, middle, lean)
            at.place_rollers(place)
            self.place[:, own] = place
            if at.tilts is not None:
                self.lean[:, own] = lean
            for kind, values in zip(
                system.of_kind[disc], (at.flank.approach, at.outer, at.holes.approach, place), strict=True
            ):
                self.overlap[:, 0, kind] = values
            if at.tilts is not None:
                tilts = (self.half * at.tilts[0].tilt, lean - at_bore, self.half * at.tilts[1].tilt, at_race - lean)
                for kind, values in zip(system.of_kind[disc], tilts, strict=True):
                    self.overlap[:, 1, kind] = values
        if e is None:
            e = self.overlap
            if system.coupled:  # a fair share of a rigid overlap
                e = e.copy()
                e[:, 0] *= np.where(e[:, 0] > 0.0, 0.5, 1.0)
        else:
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
        reach = self.overlap[:, 0] + (np.abs(self.overlap[:, 1]) if self.system.components > 1 else 0.0)
        most = np.max(reach, axis=1, initial=0.0)[:, None]
        return np.asarray((reach > 0.0) | (reach > -self.margin * most))

    def _carry_in_plane(self) -> None:
        """Loads of all contacts at their deformations, and their derivatives."""
        system, e = self.system, self.deformation[:, 0]
        self.load, self.stiffness = np.zeros(self.deformation.shape), np.zeros((1, *e.shape))
        self.sliced: list[list[SlicedContact]] = []
        self.law_left = np.zeros(e.shape[0])
        radius = np.empty(e.shape)
        radius[...] = system.radii
        for at, kinds in zip(self.discs, system.of_kind, strict=True):
            radius[:, kinds[0]] = at.flank.effective_radius
        for law, contacts in system.law_groups:
            load, stiffness = law.load_and_stiffness(e[:, contacts], radius[:, contacts])
            self.load[:, 0, contacts], self.stiffness[0][:, contacts] = load, stiffness
        if system.law_groups:
            return
        # Laws that know where on the flank a pin touches are asked for closed contacts alone.
        for at, laws, kinds in zip(self.discs, system.laws, system.of_kind, strict=True):
            for law, kind in zip(laws.placed(at.flank), kinds, strict=True):
                closed = e[:, kind] > 0.0
                found = law.take(closed.shape, closed).load_and_stiffness(e[:, kind][closed], radius[:, kind][closed])
                self.load[:, 0, kind][closed], self.stiffness[0][:, kind][closed] = found

    def _carry(self, state: _State, roughly: bool) -> None:
        """The same with tilts, moments and their derivatives."""
        system, e = self.system, self.deformation
        self.load = np.zeros(e.shape)
        self.stiffness = np.zeros((3, e.shape[0], e.shape[2]))
        self.sliced = []
        self.law_left = np.zeros(e.shape[0])
        exactness = sliced.ROUGH if roughly else sliced.EXACT
        for disc, (at, laws) in enumerate(zip(self.discs, system.laws, strict=True)):
            radii = at.flank.effective_radius, laws.outer_radius, laws.hole_radius, laws.inner_radius
            found = []
            here = laws.placed(at.flank)
            for number, (kind, law, radius) in enumerate(zip(system.of_kind[disc], here, radii, strict=True)):
                pressed = e[:, 0, kind]
                near = state.near[4 * disc + number] if state.near else None
                one = law.respond(
                    pressed, e[:, 1, kind] / self.half, np.broadcast_to(radius, pressed.shape), near, exactness
                )
                self.load[:, 0, kind], self.load[:, 1, kind] = one.load, one.moment / self.half
                for values, mine in zip(
                    self.stiffness,
                    (one.by_approach, one.by_tilt / self.half, one.moment_by_tilt / self.half**2),
                    strict=True,
                ):
                    values[:, kind] = mine
                if one.left is not None and one.left.size:
                    self.law_left = np.maximum(self.law_left, one.left.max(axis=1))
                found.append(one)
            self.sliced.append(found)

    def _choose(self) -> None:
        """Choose the contacts of the linear system: those that carry, and of coupled bodies open ones that may."""
        system = self.system
        self.every = not system.coupled
        if self.every:
            self.chosen, self.at, self.of_rollers, self.local = system.every_contact
            self.count = system.contacts
            return
        carries = np.any(self.stiffness != 0.0, axis=0) | (self.load[:, 0] > 0.0) | self._within()
        self.chosen = []
        for disc in range(system.discs):
            pins, bores, holes, races = (carries[:, kind] for kind in system.of_kind[disc])
            rollers = _padded(bores | races)
            self.chosen.append([_padded(pins), rollers, _padded(holes), rollers])
        parts = [
            first.start + some
            for kinds, own in zip(system.of_kind, self.chosen, strict=True)
            for first, some in zip(kinds, own, strict=True)
        ]
        self.contacts: Indices = np.concatenate(parts, axis=1)
        self.rollers: Indices = np.concatenate(
            [disc * system.rollers + own[1] for disc, own in enumerate(self.chosen)], axis=1
        )
        self.count = self.contacts.shape[1]
        self.at, self.of_rollers, self.local = _places_of(self.chosen)

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

    def _gradients(self, disc: int) -> tuple[FloatArray, FloatArray]:
        """∂d/∂q of the chosen contacts of a disc by its own coordinates, shape (positions, components, chosen, coordinates), and
        how the tangents of its rollers in the bores turn with the pose, Im(n̄ ∂), shape (positions, rollers, coordinates).
        """
        system, at, some, row = self.system, self.discs[disc], self.chosen[disc], self.row
        pins, bores, holes, races = self.local[disc]
        size = self.columns[disc].size
        g = np.zeros((self.angle.size, system.components, races.stop, size))
        by_approach = g[:, 0]
        by_approach[:, pins] = self._with_crank(at, self.picked(at.flank.gradient, some[0]))
        by_approach[:, holes] = self._with_crank(at, self.picked(at.holes.gradient, some[2]))
        moved = at.bores.gradient
        if self.by_crank:
            both = self._bores_moved(at)
            moved = both[:, :, 0] + 1j * both[:, :, 1]
        if moved.shape[1] > 1:
            moved = moved[row, some[1] // (system.rollers // moved.shape[1])]
        turned = self.picked(at.outward, some[1]).conjugate()[..., None] * moved
        np.negative(turned.real, out=by_approach[:, bores])
        if at.tilts is not None:
            half = self._thick
            by_tilt = g[:, 1]
            by_tilt[:, pins] = half * self._with_crank(at, self.picked(at.tilts[0].gradient, some[0]))
            by_tilt[:, holes] = half * self._with_crank(at, self.picked(at.tilts[1].gradient, some[2]))
            ray = self.picked(at.rays.direction, some[1])
            both = half * np.stack((ray.real, ray.imag), axis=-1)
            by_tilt[:, bores, system.one.lean_place] = -both
            crank_of = some[1] // (system.rollers // at.bores.arm.shape[1])
            for crank in range(system.one.cranks):
                first = system.one.crank_lean(crank)
                by_tilt[:, races, first : first + 2] = both * (crank_of == crank)[..., None]
            if self.by_crank:  # rays turn with the cages
                with_cage = 1j * at.geometry.placement.cage_speed * ray
                journals = at.bores.each(at.geometry.journal_leans(at.pose), system.rollers)
                journal = self.picked(np.broadcast_to(journals, at.total.shape), some[1])
                by_tilt[:, bores, -1] = -self.half * dot(with_cage, at.geometry.lean(at.pose))
                by_tilt[:, races, -1] = self.half * dot(with_cage, journal)
        return g, turned.imag

    def _with_crank(self, at: _Disc, gradient: FloatArray) -> FloatArray:
        """Derivatives of pins by the pose of a disc, and by the crank angle where that is a coordinate."""
        return np.concatenate((gradient, np.matmul(gradient, at.nominal)), axis=-1) if self.by_crank else gradient

    def _linearise_plain(self) -> None:
        """Force and tangent where nothing deforms but the contacts, in the plane: each roller is condensed by itself.

        With the stiffnesses k of its two contacts, the cosine c between ray and normal n in the bore, and the load F there, which
        turns by its place as s (n across the ray), a roller yields along its ray with k_i + c² k_o + F s²/l. The rollers of a
        crank are one spring then between bore and race, Σ a n nᵀ + b t tᵀ + m (n tᵀ + t nᵀ). Equations of the paper: balance of
        the rollers (Eq. 66) and of the disc (Eq. 70–72).
        """
        system, (rows, size) = self.system, (self.pose.shape[0], self.size)
        load, stiffness = self.load[:, 0], self.stiffness[0]
        self.force, self.tangent = np.zeros((rows, size)), np.zeros((rows, size, size))
        self.dx, self.by_own = np.zeros((rows, system.discs * system.rollers, 1)), []
        for disc, (at, own) in enumerate(zip(self.discs, self.columns, strict=True)):
            pins, bores, holes, races = system.of_kind[disc]
            n, carried, k_bore, k_race = at.outward, load[:, bores], stiffness[:, bores], stiffness[:, races]
            held = k_bore * at.cosine
            by_place, unbalanced = k_race + held * at.cosine, load[:, races] - at.cosine * carried
            if not self.by_crank:
                bend = carried / at.length
                slanted = bend * at.slant
                by_place = by_place + slanted * at.slant
            by_place = np.where(by_place != 0.0, by_place, np.inf)
            share, step = held / by_place, unbalanced / by_place
            cranks = at.bores.arm.shape[1]
            shape = rows, cranks, -1, 1
            normal = n.view(float).reshape(rows, cranks, -1, 2)
            basis, pressed = normal, (k_bore - held * share).reshape(shape) * normal
            loads, follow = (carried + held * step).reshape(shape), share.reshape(shape) * normal
            if not self.by_crank:
                across, aside = (1j * n).view(float).reshape(normal.shape), slanted / by_place
                mixed, turning = (held * aside).reshape(shape), (bend - slanted * aside).reshape(shape)
                basis = np.concatenate((normal, across), axis=2)
                pressed = np.concatenate((pressed - mixed * across, turning * across - mixed * normal), axis=2)
                loads = np.concatenate((loads, (slanted * step).reshape(shape)), axis=2)
                follow = follow + aside.reshape(shape) * across
            moved = self._bores_moved(at)
            springs, pushes = (np.matmul(basis.swapaxes(2, 3), each) for each in (pressed, loads))
            gradient = self._with_crank(at, np.concatenate((at.flank.gradient, at.holes.gradient), axis=1))
            of_bores = moved.reshape(rows, 2 * cranks, -1)
            back = np.concatenate((gradient, of_bores), axis=1).swapaxes(1, 2)
            stiff = np.concatenate((stiffness[:, pins], stiffness[:, holes]), axis=1)[..., None]
            pressed = np.concatenate((stiff * gradient, np.matmul(springs, moved).reshape(of_bores.shape)), axis=1)
            pushes = -pushes.reshape(rows, -1)
            force = np.matmul(back, np.concatenate((load[:, pins], load[:, holes], pushes), axis=1)[..., None])[..., 0]
            tangent = np.matmul(back, pressed)
            if not self.by_crank:
                tangent += self._bends(disc)
            else:
                turned = system.cage_speed * (pushes.view(complex) * -1j).view(float)
                _turn_with_cages(tangent, turned, of_bores)
            of_rollers = slice(disc * system.rollers, (disc + 1) * system.rollers)
            followed = np.matmul(-follow.view(float).reshape(rows, cranks, -1, 2), moved).reshape(
                rows, system.rollers, -1
            )
            if system.discs > 1:
                self.force[:, own] += force
                self.tangent[:, own[:, None], own] += tangent
            else:
                self.force, self.tangent = force, tangent
            self.by_own.append(followed[:, :, None])
            self.dx[:, of_rollers, 0] = -step
        self.moved = np.abs(self.dx[..., 0]).max(axis=1, initial=0.0)

    def _bores_moved(self, at: _Disc) -> FloatArray:
        """Displacements of the bores, x and y, by the pose of a disc, and by the crank angle where that is a coordinate, shape
        (positions, cranks, 2, coordinates).
        """
        by_pose = at.bores.gradient
        found = np.empty((*by_pose.shape[:2], 2, by_pose.shape[2] + self.by_crank))
        found[:, :, 0, : by_pose.shape[2]], found[:, :, 1, : by_pose.shape[2]] = by_pose.real, by_pose.imag
        if self.by_crank:
            found[..., -1] = at.seen_from_cages
        return found

    @cached_property
    def pressing(self) -> list[_Pressing]:
        """What the chosen contacts of every disc press its coordinates with."""
        self.chosen_load = self.of_chosen(self.load)
        self.chosen_stiffness = self.of_chosen(self.stiffness.swapaxes(0, 1)).swapaxes(0, 1)
        return [self._pressing(disc) for disc in range(self.system.discs)]

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
        """What pins that move along curved contacts alter of gaps in the second order, times the stiffness, N."""
        found = np.zeros(self.angle.size)
        assert self.shifts is not None
        assert self.shifts_after is not None
        moved = np.abs(self.shifts_after - self.shifts)[:, : self.system.discs] ** 2
        for disc, (at, kinds) in enumerate(zip(self.discs, self.system.of_kind, strict=True)):
            curved = np.abs(np.concatenate((at.flank.bending, at.holes.bending), axis=1))
            stiff = np.concatenate((self.stiffness[0][:, kinds[0]], self.stiffness[0][:, kinds[2]]), axis=1)
            found = np.maximum(found, np.max(0.5 * stiff * curved * moved[:, disc], axis=1, initial=0.0))
        return found

    def _pressing(self, disc: int) -> _Pressing:
        """What the chosen contacts of a disc press its own coordinates with, rollers where they stand (Eq. 66, 70–72)."""
        at, some, (_, bores, _, races) = self.discs[disc], self.chosen[disc], self.local[disc]
        own = slice(self.at[disc][0].start, self.at[disc][3].stop)
        g, across = self._gradients(disc)
        load, stiffness = self.chosen_load[:, :, own], self.chosen_stiffness[:, :, own]
        slant = self.picked(at.slant, some[1])
        bend = load[:, 0, bores] / self.picked(at.length, some[1])
        if self.by_crank:
            bend = np.zeros(bend.shape)
        rows, components, _, size = g.shape
        # Directions in which a roller's own place and lean press its two contacts.
        outward, inward = np.ones((2, rows, components, slant.shape[1]))
        np.negative(self.picked(at.cosine, some[1]), out=outward[:, 0])
        inward[:, 1:] = -1.0
        placed = np.zeros((rows, slant.shape[1], components, size))
        np.multiply((bend * slant)[..., None], across, out=placed[:, :, 0])
        if self.by_crank:
            tangent = np.zeros((rows, size, size))
            _turn_with_cages(tangent, load[:, 0, bores] * self.system.cage_speed, across)
        else:
            tangent = self._bends(disc) + np.matmul(across.swapaxes(1, 2), bend[..., None] * across)
        found = _Pressing(
            g=g,
            force_map=self._rub(disc, g),
            load=load,
            stiffness=stiffness,
            presses=(outward, inward),
            unbalanced=(outward * load[:, :, bores] + inward * load[:, :, races]).swapaxes(1, 2),
            placed=placed,
            own_bend=bend * slant**2,
            force=np.zeros((rows, size)),
            tangent=tangent,
        )
        flat = found.force_map.reshape(rows, -1, size).swapaxes(1, 2)
        found.force[:] = np.matmul(flat, load.reshape(rows, -1, 1))[..., 0]
        if self.sticking:
            by_slip, slip, held = self.sticking[disc]
            found.force[:] += np.einsum("bpj,bp->bj", slip, held)
            tangent += np.matmul(slip.swapaxes(1, 2), by_slip[..., None] * slip)
        return found

    def _linearise(self) -> None:
        """Eliminate deformations, displacements of pins and places of rollers."""
        if self.system.coupled:
            self._linearise_coupled()
        else:
            self._linearise_alone()
        stiffness = self.chosen_stiffness
        self.change = _pressed(stiffness, self.de[..., None])[..., 0]
        moved = np.abs(self.de).sum(axis=1)
        # A roller that hardly touches may go on for ever in a direction that changes no load.
        changed = np.abs(self.change).sum(axis=1)
        matters = changed > LEAST_CHANGE * self.load[:, 0].max(axis=1, initial=0.0)[:, None]
        self.moved = np.max(np.where(matters & (stiffness[0] > 0.0), moved, 0.0), axis=1, initial=0.0)

    def _linearise_alone(self) -> None:
        """The same where nothing deforms but the contacts: disc by disc, roller by roller."""
        system, (rows, size) = self.system, (self.pose.shape[0], self.size)
        force, tangent = np.zeros((rows, size)), np.zeros((rows, size, size))
        dx, by_own = [], []
        pressing = self.pressing
        on_pins = None if system.model.pins is None else self._on_displaced_pins()
        for disc, (part, own) in enumerate(zip(pressing, self.columns, strict=True)):
            _, bores, _, races = self.local[disc]
            outward, inward = part.presses
            rollers, components, count = part.placed.shape[1:]
            pressed = _pressed(part.stiffness, part.g)
            if on_pins is None:
                mine = [part.force_map, pressed]
            else:  # those of pins and holes are found together
                mine = [np.concatenate((each[:, :, bores], each[:, :, races]), axis=2) for each in (part.g, pressed)]
            flat, along = (each.reshape(rows, -1, count) for each in mine)
            held_by = part.tangent + np.matmul(flat.swapaxes(1, 2), along)
            pushed = outward[..., None] * pressed[:, :, bores] + inward[..., None] * pressed[:, :, races]
            right = np.empty((rows, rollers, components, count + 1))
            np.add(part.placed, pushed.swapaxes(1, 2), out=right[..., :-1])
            right[..., -1] = part.unbalanced
            held = _own_stiffness(part.stiffness[..., bores], outward)
            held += _own_stiffness(part.stiffness[..., races], inward)
            held[:, :, 0, 0] += part.own_bend
            _hold_turning(held)
            placing = _solved_blocks(held, right)
            back = right[..., :-1].reshape(rows, rollers * components, count).swapaxes(1, 2)
            taken = np.matmul(back, placing.reshape(rows, rollers * components, count + 1))
            held_by -= taken[..., :-1]
            if system.discs == 1:
                force, tangent = part.force - taken[..., -1], held_by
            else:
                force[:, own] += part.force - taken[..., -1]
                tangent[:, own[:, None], own] += held_by
            dx.append(-placing[..., -1])
            by_own.append(-placing[..., :-1])
        self.dx, self.by_own = self._bounded(np.concatenate(dx, axis=1) if len(dx) > 1 else dx[0]), by_own
        self.de = np.zeros(self.load.shape)
        if on_pins is not None:
            self.de_by_pose = np.zeros((*self.load.shape, size))
            force, tangent = force + on_pins[0], tangent + on_pins[1]
            if not self.sticking and system.model.friction is None:
                tangent = 0.5 * (tangent + tangent.swapaxes(1, 2))
        for disc, part in enumerate(pressing):
            pins, bores, holes, races = system.of_kind[disc]
            outward, inward = part.presses
            moved = self.dx[:, self.of_rollers[disc]].swapaxes(1, 2)
            self.de[:, :, bores], self.de[:, :, races] = outward * moved, inward * moved
            if on_pins is None or self.de_by_pose is None:
                continue
            own = self.columns[disc]
            _, at_bores, _, at_races = self.local[disc]
            by_place = by_own[disc].swapaxes(1, 2)
            for kind, local, press in ((bores, at_bores, outward), (races, at_races, inward)):
                self.de_by_pose[:, :, kind, own] = part.g[:, :, local] + press[..., None] * by_place
            for kind, some in ((pins, slice(0, system.pins)), (holes, slice(system.pins, None))):
                self.de[:, :, kind] = on_pins[2][:, :, disc, some]
                self.de_by_pose[:, :, kind] = on_pins[3][:, :, disc, some]
        self.force, self.tangent = force, tangent

    def _on_displaced_pins(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Force and tangent that contacts on displaced pins add, and corrections of their deformations at the pose and by it."""
        pins, shifts = self.system.model.pins, self.shifts
        assert pins is not None
        assert shifts is not None
        members = self.members = PinMembers(self)
        left = self.deformation - self.overlap
        left += members.approaches(members.unsettled(shifts))
        self.off_by = left
        wanted = np.abs(left).sum(axis=1)
        matters = (self.stiffness[0] > 0.0) | (self.deformation[:, 0] - left[:, 0] > 0.0)
        self.off = np.max(wanted * matters, axis=1, initial=0.0)
        for disc, part in enumerate(self.pressing):
            _, bores, _, races = self.local[disc]
            stiff = part.stiffness[0][:, bores] + part.stiffness[0][:, races]
            apart = np.abs(part.unbalanced).sum(axis=-1) / np.where(stiff > 0.0, stiff, np.inf)
            self.off = np.maximum(self.off, np.max(apart, axis=1, initial=0.0))
        blocks, moves = PinBlocks(members), not self.held
        found = blocks.eliminated(self.pressing, left, turning=moves)
        if moves:
            change = np.zeros(self.load.shape)
            for disc, kinds in enumerate(self.system.of_kind):
                change[:, :, kinds[0]] = found[2][:, :, disc, : self.system.pins]
                change[:, :, kinds[2]] = found[2][:, :, disc, self.system.pins :]
            near = self._is_near(change, self.stiffness)
            if not near.all():
                # Far off loads may turn with soft pins more than these hold against.
                still = blocks.eliminated(self.pressing, left, turning=False)
                force, tangent, de, de_by_pose = (_by_rows(near, *each) for each in zip(found, still, strict=True))
                found = force, tangent, de, de_by_pose
        return found

    def _assembled(self) -> _Pressing:
        """What contacts of all discs press all coordinates with."""
        system, (rows, size) = self.system, (self.pose.shape[0], self.size)
        if system.discs == 1:
            return self.pressing[0]
        components, rollers = system.components, self.of_rollers[-1].stop
        g, force_map = np.zeros((2, rows, components, self.count, size))
        placed, force = np.zeros((rows, rollers, components, size)), np.zeros((rows, size))
        tangent = np.zeros((rows, size, size))
        for disc, (part, own) in enumerate(zip(self.pressing, self.columns, strict=True)):
            mine = slice(self.at[disc][0].start, self.at[disc][3].stop)
            g[:, :, mine, own], force_map[:, :, mine, own] = part.g, part.force_map
            placed[:, self.of_rollers[disc], :, own] = part.placed
            force[:, own] += part.force
            tangent[:, own[:, None], own] += part.tangent
        outward, inward = (np.concatenate([part.presses[way] for part in self.pressing], axis=2) for way in (0, 1))
        return _Pressing(
            g=g,
            force_map=force_map,
            load=self.chosen_load,
            stiffness=self.chosen_stiffness,
            presses=(outward, inward),
            unbalanced=np.concatenate([part.unbalanced for part in self.pressing], axis=1),
            placed=placed,
            own_bend=np.concatenate([part.own_bend for part in self.pressing], axis=1),
            force=force,
            tangent=tangent,
        )

    def _linearise_coupled(self) -> None:
        """The same where bodies deform under the loads of all contacts, and beams and a ring with them."""
        self._find_bodies()
        part = self._assembled()
        stiffness, bores, races = self.chosen_stiffness, self._positions(1), self._positions(3)
        whole, left = self._flexibility(part.load)
        self.off_by = self.of_all(left)
        wanted = np.abs(left).sum(axis=1)
        expected = self.of_chosen(self.deformation)[:, 0] - left[:, 0]
        stiff = stiffness[0][:, bores] + stiffness[0][:, races]
        # An open roller stands in the middle of its play.
        free, middle = stiff <= 0.0, 0.5 * (expected[:, bores] + expected[:, races])
        both = 0.5 * np.abs(left[:, 0, bores] + left[:, 0, races])
        for places in (bores, races):
            expected[:, places] = np.where(free, middle, expected[:, places])
            wanted[:, places] = np.where(free, both, wanted[:, places])
        matters = (stiffness[0] > 0.0) | (expected > 0.0)
        self.off = np.max(wanted * matters, axis=1, initial=0.0)
        apart = np.abs(part.unbalanced).sum(axis=-1) / np.where(stiff > 0.0, stiff, np.inf)
        self.off = np.maximum(self.off, np.max(apart, axis=1, initial=0.0))
        moves = self.shifts is not None and not self.held
        found = self._eliminate(part, whole, left, turning=moves)
        if moves and not (close := self._is_near(found.de, stiffness)).all():
            # Far off loads may turn with soft pins more than these hold against.
            still = self._eliminate(part, whole, left, turning=False)
            found = _Eliminated(*(_by_rows(close, *each) for each in zip(found, still, strict=True)))
        self.force, self.tangent, self.dx, self.dx_by_pose, self.de, self.de_by_pose = found

    def _eliminate(self, part: _Pressing, whole: FloatArray, left: FloatArray, *, turning: bool) -> _Eliminated:
        """The same where loads deform more than their own contacts: force and tangent of the pose.

        Without `turning` loads that turn with displaced pins count where they hold these back alone.
        """
        system, g, force_map, stiffness = self.system, part.g, part.force_map, part.stiffness
        presses, unbalanced, placed, own_bend = part.presses, part.unbalanced, part.placed, part.own_bend
        force, tangent = part.force, part.tangent
        rows, components, count, size = g.shape
        rollers = unbalanced.shape[1]
        if self.shifts is not None:
            # Loads turn with displaced pins: as if contacts lay along their tangents, without loads. What they turn with the pose
            # is in the tangent already.
            bent, along, turn = self.members.turned_loads(size)
            if not turning:
                bent[0] = 0.0 if self.held else np.maximum(bent[0], 0.0)
                bent[1:], turn = 0.0, turn * 0.0
            held = _pressed(bent, along)
            shape = rows, components * along.shape[2], size
            tangent = tangent - np.matmul(along.reshape(shape).swapaxes(1, 2), held.reshape(shape))
            g, force_map = np.concatenate((g, along), axis=2), np.concatenate((force_map, along), axis=2)
            slips = self.members.slips(chosen=True) if turning else np.zeros(along.shape[:3])
            left = np.concatenate((left, slips), axis=2)
            turn = np.concatenate((np.zeros(part.g.shape), turn), axis=2).reshape(rows, -1, size)
            stiffness = np.concatenate((_filled(stiffness, bent.shape[0]), bent), axis=2)
        mine, count = count, g.shape[2]
        each = components * count
        t = np.zeros((rows, components, count, rollers, components))
        own = np.arange(rollers)
        for press, places in zip(presses, (self._positions(1), self._positions(3)), strict=True):
            for component in range(components):
                t[:, component, places, own, component] = press[:, component]
        flat = t.reshape(rows, components * count, rollers * components)
        moved_by = g.reshape(rows, each, size)
        if self.shifts is not None:
            moved_by = moved_by - np.matmul(whole.reshape(rows, each, each), turn)
        right = np.concatenate((moved_by, flat, left.reshape(rows, each, 1)), axis=-1)
        system_matrix = _pressed(
            stiffness, whole.reshape(rows, components * count, components, count).transpose(0, 2, 3, 1)
        )
        system_matrix = system_matrix.transpose(0, 3, 1, 2).reshape(rows, components * count, components * count)
        own = np.arange(components * count)
        system_matrix[:, own, own] += 1.0
        found = solved(system_matrix, right)
        x = found.reshape(rows, components, count, right.shape[-1])
        kx = _pressed(stiffness, x).reshape(rows, components * count, right.shape[-1])
        back = np.concatenate((force_map.reshape(rows, each, size), flat), axis=-1)
        products = np.matmul(back.swapaxes(1, 2), kx)
        if self.shifts is not None:
            # What turns with the pose: what is taken of it by pins and by the places of rollers.
            slipped = found.copy()
            slipped[..., :size] -= g.reshape(rows, each, size)
            products[:, :size] += np.matmul(turn.swapaxes(1, 2), slipped)
        tangent = tangent + products[:, :size, :size]
        force = force - products[:, :size, -1]
        block = products[:, size:, size:-1].copy()
        first = np.arange(rollers) * components
        block[:, first, first] += own_bend
        flat_placed = placed.reshape(rows, rollers * components, size)
        down, across = products[:, size:, :size] + flat_placed, products[:, :size, size:-1] + flat_placed.swapaxes(1, 2)
        diagonal = np.einsum("bii->bi", block)
        if components > 1:
            diagonal[:, 1::2] += LEAST_TURNING * np.abs(diagonal[:, ::2])
        diagonal += diagonal == 0.0
        short = unbalanced.reshape(rows, rollers * components) - products[:, size:, -1]
        placing = solved(block, np.concatenate((down, short[..., None]), axis=-1))
        tangent = tangent - np.matmul(across, placing[..., :-1])
        force = force - np.matmul(across, placing[..., -1:])[..., 0]
        of_rollers = x[..., size:-1].reshape(rows, components * count, rollers * components)
        placing = placing.reshape(rows, rollers, components, size + 1)
        dx, dx_by_pose = self._bounded(-placing[..., -1]), -placing[..., :-1]
        placed_by = np.concatenate((dx_by_pose, dx[..., None]), axis=-1)
        moved = np.matmul(of_rollers, placed_by.reshape(rows, rollers * components, size + 1))
        moved = moved.reshape(rows, components, count, size + 1)
        if not self.sticking and system.model.friction is None:
            tangent = 0.5 * (tangent + tangent.swapaxes(1, 2))
        return _Eliminated(
            force=force,
            tangent=tangent,
            dx=dx,
            dx_by_pose=dx_by_pose,
            de=(moved[..., -1] - x[..., -1])[:, :, :mine],
            de_by_pose=(x[..., :size] + moved[..., :-1])[:, :, :mine],
        )

    def _is_near(self, de: FloatArray, stiffness: FloatArray) -> NDArray[np.bool_]:
        """Positions where corrections of deformations are so small that loads follow them linearly."""
        moved = np.max(np.where(stiffness[0] > 0.0, np.abs(de).sum(axis=1), 0.0), axis=1, initial=0.0)
        return self._are_small(moved, ROUGHLY_SETTLED)

    def _bounded(self, dx: FloatArray) -> FloatArray:
        """Corrections of places and leans that go no farther than half of what is pressed together: beyond, other slices meet
        than the slopes know of.
        """
        if self.system.components == 1:
            return dx
        each = [0.5 * (at.room + self.half * np.abs(at.at_race - at.at_bore)) for at in self.discs]
        room = np.concatenate([self.picked(one, own[1]) for one, own in zip(each, self.chosen, strict=True)], axis=1)
        room = np.maximum(room, LEAST_ROOM)
        long = np.abs(dx).max(axis=-1)
        return np.asarray(dx * np.divide(room, long, out=np.ones(long.shape), where=long > room)[..., None])

    def _flexibility(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """W among the chosen contacts, shape (positions, components, chosen, components, chosen), and what is left of their
        deformations, r.
        """
        system = self.system
        rows, components, count = load.shape
        members = None
        if self.shifts is not None:
            members = self.members = PinMembers(self)
        entries = count + (0 if members is None else members.count)
        whole = np.zeros((rows, components, entries, components, entries))
        for disc, bodies in enumerate(self.bodies):
            pins, bores, holes, races = self.at[disc]
            among = np.r_[pins, bores, holes]
            first, second = np.arange(bores.start, bores.stop), np.arange(races.start, races.stop)
            for component, body in enumerate(bodies):
                mine = whole[:, component, :, component]
                mine[:, among[:, None], among] = body.among
                mine[:, races, races] = body.on_race
                mine[:, first, second] = mine[:, second, first] = body.across_roller
        left = self.of_chosen(self.deformation - self.overlap)
        if system.coupled:
            left += np.einsum("bcicj,bcj->bci", whole[:, :, :count, :, :count], load)
        if members is not None and self.shifts is not None and system.model.pins is not None:
            left += members.approaches(members.unsettled(self.shifts))
            members.add_flexibility(whole)
        return whole, left

    def _find_bodies(self) -> None:
        """Find what bodies yield between the chosen contacts: what was found before, where neither places nor choice changed."""
        before = self.before
        if before is not None and all(
            first is second or np.array_equal(first, second)
            for mine, theirs in zip(self.chosen, before.chosen, strict=True)
            for first, second in zip(mine, theirs, strict=True)
        ):
            self.bodies: list[list[BodyFlexibility]] = before.bodies
            return
        self.bodies = [
            []
            if model.coefficients is None
            else model.body_flexibility(self.body_places(disc), self.chosen[disc][:3])[: self.system.components]
            for disc, model in enumerate(self.system.bodies)
        ]

    @property
    def onward(self) -> ContactStart:
        """Where the contacts of a position start that is nearby in pose and crank angle: no pin is left out."""
        motions = [each.flank for each in self.discs]
        return ContactStart(
            parameter=_beside([motion.parameter for motion in motions]),
            share=self.share,
            known=KnownPins(
                approach=np.repeat(self.system.never_left_out, self.angle.size, axis=0),
                point=_beside([motion.point for motion in motions]),
                turning=_beside([motion.turning for motion in motions]),
            ),
            follow=self.following(),
            inner=self.inner,
        )

    def pin_loads(self, disc: int) -> FloatArray:
        """Return loads of wheel pins and shaft pins, and in slices their moments by half the thickness of the disc, N, shape
        (positions, components, pairs).
        """
        pins, _, holes, _ = self.system.of_kind[disc]
        return np.concatenate((self.corrected_load[..., pins], self.corrected_load[..., holes]), axis=-1)

    def pushes(self, disc: int) -> ComplexArray:
        """Return the force of every crank bearing on a disc in the fixed frame, N, shape (positions, cranks)."""
        at, bores = self.discs[disc], self.system.of_kind[disc][1]
        return _by_crank(self.corrected_load[:, 0, bores] * at.outward, at.bores.arm.shape[1])

    def bearing_moments(self, disc: int) -> ComplexArray:
        """Return what every crank bearing presses the lean of a disc with, in slices, N·mm, shape (positions, cranks)."""
        at, bores = self.discs[disc], self.system.of_kind[disc][1]
        return _by_crank(self.half * self.corrected_load[:, 1, bores] * at.rays.direction, at.bores.arm.shape[1])

    @property
    def inner(self) -> Inner:
        """Inner unknowns beside the pose, to start from elsewhere."""
        state = self._whole_state
        return Inner(lean=state.lean, approach=state.approach, near=state.near)

    @cached_property
    def shifts(self) -> ComplexArray | None:
        """Displacements of the pins, mm."""
        if self.system.model.pins is None:
            return None
        each = [at.shifts for at in self.discs]
        if self.system.components > 1:
            each += [None if at.leans is None else at.leans * self.half for at in self.discs]
        return np.stack([one for one in each if one is not None], axis=1)

    def body_places(self, disc: int) -> tuple[FloatArray, FloatArray, FloatArray, ComplexArray, float]:
        """Where the contacts of a disc lie on its body: θ on the flank, polar angles in bores and holes, places of the first."""
        at = self.discs[disc]
        turn, holes = at.pose[:, DISC_ROTATION, None], at.holes.gradient
        in_bore = np.angle(at.rays.outermost * at.rays.direction - at.displacement) - turn
        in_hole = np.angle(-(holes[..., X] + 1j * holes[..., Y])) - turn
        on_flank = at.geometry.profile.flank(at.flank.parameter)
        return at.flank.parameter, in_bore, in_hole, on_flank, float(at.geometry.placement.bore_radius)

    def _rub(self, disc: int, g: FloatArray) -> FloatArray:
        """What loads press the coordinates of a disc with, G and friction along the tangents of pins and holes."""
        friction = self.system.model.friction
        if friction is None:
            return g
        system, found, row, at = self.system, g.copy(), self.row, self.discs[disc]
        kinds = system.of_kind[disc][0], system.of_kind[disc][2]
        load = np.concatenate([self.load[:, 0, kind] for kind in kinds], axis=1)
        stiffness = np.concatenate([self.stiffness[0][:, kind] for kind in kinds], axis=1)
        if system.coupled and not friction.turns:
            stiffness = self._through_bodies(disc, stiffness)
        slip, by_load, held, by_slip = friction.along(at.geometry, self.angle, at.pose, at, load, stiffness, disc)
        self.rubs.append(by_load)
        # Moments on leans rub as loads do, those of contacts that stick by what these hold.
        by_moment = by_load + np.divide(held, load, out=np.zeros(load.shape), where=load > 0.0)
        self.rubs_leaning.append(by_moment)
        pins, _, holes, _ = self.local[disc]
        some = self.chosen[disc]
        for where, which in ((pins, some[0]), (holes, system.pins + some[2])):
            by = by_load[row, which][..., None]
            found[:, 0, where] += by * slip[row, which]
            if at.tilts is None:
                continue
            motion = at.flank if where is pins else at.holes
            along = (
                self._thick
                * by_moment[row, which][..., None]
                * motion.along[row, which if where is pins else some[2]][..., :2]
            )
            second = found[:, 1]
            second[:, where, system.one.lean_place] += along
            if where is pins and system.one.wheel_leans:
                second[:, where, system.one.wheel_lean_place] -= along
        if by_slip is not None:
            self.sticking.append((by_slip, slip, held))
        return found

    def _through_bodies(self, disc: int, stiffness: FloatArray) -> FloatArray:
        """Stiffnesses of wheel pins and shaft pins, shape (positions, pairs), with what the bodies yield there: diagonal of
        K (1 + C K)⁻¹ of the chosen contacts.
        """
        pins, _, holes, _ = self.local[disc]
        first = self.at[disc][0].start
        own = self.chosen_stiffness[0][:, first : first + holes.stop]
        matrix = self.bodies[disc][0].among * own[:, None]
        place = np.arange(own.shape[1])
        matrix[:, place, place] += 1.0
        through = own * np.diagonal(
            solved(matrix, np.broadcast_to(np.eye(own.shape[1]), matrix.shape)), axis1=1, axis2=2
        )
        found, some = stiffness.copy(), self.chosen[disc]
        found[self.row, some[0]] = through[:, pins]
        found[self.row, self.system.pins + some[2]] = through[:, holes]
        return found

    @property
    def _thick(self) -> FloatArray:
        return self.half[..., None] if self.half.ndim else self.half

    def _bends(self, disc: int) -> FloatArray:
        """Σ F ∂²d/∂q² of the contacts of a disc by its own coordinates but what the rollers' places turn."""
        system, at = self.system, self.discs[disc]
        pins, bores, holes, _ = system.of_kind[disc]
        found = at.flank.bend(self.load[:, 0, pins]) + at.holes.bend(self.load[:, 0, holes])
        if at.tilts is not None:
            found += at.flank.bend_leans(self.load[:, 1, pins] * self.half, system.one)
            found += at.holes.bend_leans(self.load[:, 1, holes] * self.half, system.one)
        cranks = at.bores.arm.shape[1]
        push = (self.load[:, 0, bores] * at.outward).reshape(found.shape[0], cranks, -1).sum(axis=2).conjugate()
        found[:, DISC_ROTATION, DISC_ROTATION] += (push * at.bores.arm).real.sum(axis=1)
        if at.bores.twists:
            found[:, at.bores.twists, at.bores.twists] -= (push * at.bores.lever).real
        return np.asarray(found)

    def _positions(self, number: int) -> Indices:
        """Where the contacts of a kind stand among the chosen."""
        return np.concatenate([np.arange(own[number].start, own[number].stop) for own in self.at])

    def settled(self, roughly: bool) -> NDArray[np.bool_]:
        """Positions whose inner unknowns are close enough for a step of the pose, or for an answer."""
        return self._are_small(
            self.moved, ROUGHLY_SETTLED if roughly else SETTLED_IN_MOTION if self.by_crank else SETTLED
        )

    def _are_small(self, moved: FloatArray, part: float) -> NDArray[np.bool_]:
        """Positions where corrections, mm, are a small part of the largest approach."""
        deep = np.max(np.abs(self.overlap[:, 0]) * (self.load[:, 0] > 0.0), axis=1, initial=0.0)
        return np.asarray(moved <= part * deep + ROUND_OFF)

    def again(self, state: _State) -> Linearised:
        """Return the contacts at the same poses with other inner unknowns."""
        return Linearised(
            self.system,
            self.angle,
            self.pose,
            state,
            None if self.by_crank else self.known,
            roughly=self.roughly,
            margin=self.margin,
            by_crank=self.by_crank,
        )

    @property
    def here(self) -> _State:
        """Inner unknowns without the correction."""
        return self._state(np.zeros(self.angle.size))

    @cached_property
    def _whole_state(self) -> _State:
        """Inner unknowns after the whole correction."""
        return self._state()

    def _state(self, fraction: FloatArray | None = None) -> _State:
        """Inner unknowns after the correction."""
        system, approach = self.system, None
        if system.deforms:
            approach = self.after
        shifts = self.shifts_after
        place, lean = self.place_after, self.lean_after
        if fraction is not None and not np.all(fraction == 1.0):
            part = fraction[:, None]
            place, lean = self.place + part * (place - self.place), self.lean + part * (lean - self.lean)
            if approach is not None:
                approach = self.deformation + part[..., None] * (approach - self.deformation)
        if fraction is not None and shifts is not None and self.shifts is not None:
            shifts = self.shifts + fraction[:, None, None] * (shifts - self.shifts)
        return _State(
            parameter=_beside([at.flank.parameter for at in self.discs]),
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
        """Their leans by half the thickness of the disc, mm."""
        return self.lean + self.of_all_rollers(self.dx)[..., 1] if self.system.components > 1 else self.lean

    def slices_after(self, disc: int) -> list[SlicedContact]:
        """Return the contacts of a disc in slices, by kind, moved along their slopes by the correction."""
        if disc not in self._moved_slices:
            found = []
            for one, kind in zip(self.sliced[disc], self.system.of_kind[disc], strict=True):
                change = self.after[:, :, kind] - self.deformation[:, :, kind]
                found.append(
                    one.moved(change[:, 0], change[:, 1] / self.half, self.corrected_load[:, :, kind], self.half)
                )
            self._moved_slices[disc] = found
        return self._moved_slices[disc]

    @cached_property
    def shifts_after(self) -> ComplexArray | None:
        """Displacements of the pins after the correction: those that the loads press."""
        pins = self.system.model.pins
        return None if pins is None else np.asarray(-pins.under(self.members.forces(self.corrected_load)))

    @cached_property
    def corrected_load(self) -> FloatArray:
        """Loads of all contacts, to first order in what is left of the inner unknowns."""
        load = self.load + self.of_all(self.change)
        return np.where(load[:, :1] > 0.0, load, 0.0)

    def corrected(self, part: FloatArray) -> Linearised:
        """Return the contacts at the same poses with the inner unknowns corrected of those positions whose part is not zero.

        Deformations are found for pins that stand where they stand, and gaps taken as linear in what displaces these, a convex
        problem; then the pins are put where the loads press them, or that part of the way there.
        """
        moves = part > 0.0
        at = self._stepped(moves)
        if self.shifts is None:
            return at
        for _ in range(MAX_CORRECTIONS):
            going = moves & ~at.settled(roughly=True)
            if not going.any():
                break
            at = at._stepped(going)
        state = at._state()
        if state.shifts is not None:
            state = state._replace(shifts=self.shifts + part[:, None, None] * (state.shifts - self.shifts))
        return self.again(state if moves.all() else _mixed(self.here, state, moves))

    def _stepped(self, moves: NDArray[np.bool_]) -> Linearised:
        """The contacts with deformations of some positions a step on, or where the energy along it has nearly ceased to fall."""
        rows = self.angle.size
        fraction, low, high = moves.astype(float), np.zeros(rows), np.ones(rows)
        start = self.along(self.step)
        low_slope, high_slope = start.copy(), np.zeros(rows)
        for _ in range(MAX_HALVINGS):
            found = Linearised(
                self.system,
                self.angle,
                self.pose,
                self._state(fraction),
                self.known,
                roughly=self.roughly,
                before=self,
                margin=self.margin,
                by_crank=self.by_crank,
            )
            if not self.system.deforms:
                break
            end = found.along(self.step)
            far = found.off > self.off if self.system.coupled else end > STEEPEST * np.abs(start)
            far = far & moves & (found.off > 0.5 * self.off) & (found.off > ROUND_OFF * 100.0)
            if not far.any():
                break
            high, high_slope = np.where(far, fraction, high), np.where(far, end, high_slope)
            near = (end < 0.0) & ~far & (fraction < 1.0)
            low, low_slope = np.where(near, fraction, low), np.where(near, end, low_slope)
            rise = high_slope - low_slope
            place = np.divide(-low_slope, rise, out=np.full(rows, 0.5), where=rise != 0.0)
            # A contact that closes has no slope before.
            place = np.where(place > 0.0, place, 0.5).clip(0.1, 0.9)
            fraction = np.where(far, low + (high - low) * place, fraction)
        return found

    @cached_property
    def step(self) -> FloatArray:
        """Correction of the deformations of all contacts."""
        return self.after - self.deformation

    def along(self, step: FloatArray) -> FloatArray:
        """Return the slope of the energy of the inner unknowns along a step of the deformations, rᵀ K de, N·mm."""
        if not self.system.deforms:
            return np.zeros(step.shape[0])
        return np.asarray((self.off_by * _pressed(self.stiffness, step[..., None])[..., 0]).sum(axis=(1, 2)))

    @cached_property
    def yielding(self) -> list[list[FloatArray]]:
        """What the bodies take of the approaches on pins, bores and holes, and of their tilts, by disc and component."""
        found: list[list[FloatArray]] = []
        for disc, bodies in enumerate(self.bodies if self.system.coupled else []):
            some, kinds = self.chosen[disc], self.system.of_kind[disc]
            found.append([])
            for component, body in enumerate(bodies):
                load = self.corrected_load[:, component]
                loaded = np.concatenate([self.picked(load[:, kinds[kind]], some[kind]) for kind in range(3)], axis=1)
                found[disc].append(body.taken(loaded))
        return found

    @cached_property
    def leaves_out(self) -> NDArray[np.bool_]:
        """Positions where a contact of coupled bodies that was left out is pressed together after all."""
        found = np.zeros(self.angle.size, dtype=bool)
        if not self.system.coupled or not np.isfinite(self.margin):
            return found
        for disc, yielding in enumerate(self.yielding):
            some, kinds = self.chosen[disc], self.system.of_kind[disc]
            for kind, part in enumerate(
                np.split(yielding[0], np.cumsum((self.system.pins, self.system.rollers)), axis=1)
            ):
                reach = self.overlap[:, 0, kinds[kind]] - part
                if self.system.components > 1:
                    reach = reach + np.abs(self.overlap[:, 1, kinds[kind]])
                pressed = reach > 0.0
                pressed[self.row, some[kind]] = False
                found |= pressed.any(axis=1)
        return found

    def following(self) -> Following:
        """Return how the inner unknowns follow the pose."""
        state = self._whole_state
        shifts = None
        if self.shifts is not None and self.de_by_pose is not None:
            pins = self.system.model.pins
            assert pins is not None
            change = _pressed(self.chosen_stiffness, self.de_by_pose)
            each = np.moveaxis(change, -1, 0)
            shifts = np.stack(
                [-pins.under(self.members.forces(self.of_all(one), changes=True)) for one in each], axis=-1
            )
        columns: tuple[tuple[int, ...], ...] = ()
        if self.system.coupled:
            by_pose = self.of_all_rollers(self.dx_by_pose)
        else:
            by_pose = np.concatenate(self.by_own, axis=1) if len(self.by_own) > 1 else self.by_own[0]
            if len(self.by_own) > 1:
                columns = tuple(tuple(own.tolist()) for own in self.columns)
        by_approach = None if self.de_by_pose is None else self.of_all(self.de_by_pose)
        return Following(
            pose=with_crank(self.pose, self.angle) if self.by_crank else self.pose,
            place=state.place,
            lean=state.lean,
            approach=state.approach,
            shifts=state.shifts,
            by_pose=by_pose,
            approach_by_pose=by_approach,
            shifts_by_pose=shifts,
            columns=columns,
        )


def _law_groups(system: ContactSystem) -> list[tuple[Any, slice | Indices]]:
    """Laws of all discs in the plane with their contacts: those that read one table are one law."""
    groups: list[tuple[Any, slice | Indices]] = []
    lines: dict[int, list[tuple[LineContactLaw, slice]]] = {}
    for laws, kinds in zip(system.laws, system.of_kind, strict=True):
        for law, kind in zip(laws.laws, kinds, strict=True):
            if type(law) is LineContactLaw:
                lines.setdefault(id(law.table), []).append((law, kind))
            elif kind.start < kind.stop:
                groups.append((law, kind))
    for same in lines.values():
        counts = [kind.stop - kind.start for _, kind in same]
        length, modulus = (
            np.repeat([getattr(law, name) for law, _ in same], counts) for name in ("length", "contact_modulus")
        )
        contacts = np.concatenate([np.arange(kind.start, kind.stop) for _, kind in same])
        groups.append((LineContactLaw(length, modulus, same[0][0].table), contacts))
    return groups


def _radii(system: ContactSystem) -> FloatArray:
    """Effective radii of all contacts, mm, shape (1 or positions, contacts); those of wheel pins are not known yet."""
    every = [(laws.outer_radius, laws.hole_radius, laws.inner_radius) for laws in system.laws]
    rows = max(np.atleast_2d(each).shape[0] for radii in every for each in radii)
    found = np.ones((rows, system.contacts))
    for kinds, radii in zip(system.of_kind, every, strict=True):
        for kind, radius in zip(kinds[1:], radii, strict=True):
            found[:, kind] = radius
    return found


def _beside(values: list[Any]) -> Any:
    """Arrays of discs side by side: itself where there is one."""
    return values[0] if len(values) == 1 else np.concatenate(values, axis=1)


def _by_crank(values: NDArray[Any], cranks: int) -> NDArray[Any]:
    """Sums over the rollers of every crank."""
    return np.asarray(values.reshape(values.shape[0], cranks, -1).sum(axis=2))


def _turn_with_cages(tangent: FloatArray, forces: FloatArray, moved: FloatArray) -> None:
    """Take from a tangent by the crank angle what forces of bearings turn with the cages, in place: the stiffness of rollers on
    turning rays counts it.
    """
    turned = np.matmul(forces[:, None], moved[..., :-1])[:, 0]
    tangent[:, :-1, -1] -= turned
    tangent[:, -1, :-1] -= turned


def _by_rows(rows: NDArray[np.bool_], first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
    """Values of the first of some positions, of the second elsewhere."""
    return np.where(rows.reshape(-1, *(1,) * (first.ndim - 1)), first, second)


def with_crank(pose: FloatArray, angle: FloatArray) -> FloatArray:
    """Return poses with the crank angle as one more coordinate behind them."""
    return np.concatenate((pose, angle[:, None]), axis=1)


def _places_of(chosen: list[list[Indices]]) -> tuple[list[list[slice]], list[slice], list[list[slice]]]:
    """Return where chosen contacts of each disc and kind stand among all chosen, the rollers of each disc among these, and the
    contacts of each kind among those of their disc.
    """
    ends = np.cumsum([0, *(some.shape[1] for own in chosen for some in own)])
    at = [[slice(ends[4 * disc + kind], ends[4 * disc + kind + 1]) for kind in range(4)] for disc in range(len(chosen))]
    ends = np.cumsum([0, *(own[1].shape[1] for own in chosen)])
    local = [[slice(kind.start - own[0].start, kind.stop - own[0].start) for kind in own] for own in at]
    return at, [slice(first, last) for first, last in pairwise(ends)], local


def _padded(mask: NDArray[np.bool_]) -> Indices:
    """Numbers of what is chosen in each row, ascending, padded to the fullest row with others."""
    count = int(np.max(np.count_nonzero(mask, axis=1), initial=0))
    if count == mask.shape[1]:
        return np.broadcast_to(np.arange(count), mask.shape)
    return np.sort(np.argsort(~mask, axis=1, kind="stable")[:, :count], axis=1)


def _pressed(stiffness: FloatArray, moved: FloatArray) -> FloatArray:
    """K of columns of deformations, shape (positions, components, contacts, columns)."""
    if stiffness.shape[0] == 1:
        return np.asarray(stiffness[0][:, None, :, None] * moved)
    k, mixed, turning = (each[..., None] for each in stiffness)
    first, second = moved[:, 0], moved[:, 1]
    return np.stack((k * first + mixed * second, mixed * first + turning * second), axis=1)


def _filled(stiffness: FloatArray, count: int) -> FloatArray:
    """Stiffnesses with zeros for the parts that they do not have."""
    if stiffness.shape[0] == count:
        return stiffness
    return np.concatenate((stiffness, np.zeros((count - stiffness.shape[0], *stiffness.shape[1:]))))


def _own_stiffness(stiffness: FloatArray, press: FloatArray) -> FloatArray:
    """Stiffness of contacts against the place and lean of their rollers, shape (positions, rollers, components, components)."""
    if stiffness.shape[0] == 1:
        return np.asarray((stiffness[0] * press[:, 0] ** 2)[..., None, None])
    k, mixed, turning = stiffness
    first, second = press[:, 0], press[:, 1]
    cross = first * mixed * second
    return np.stack((np.stack((k * first**2, cross), -1), np.stack((cross, turning * second**2), -1)), -2)


def _hold_turning(blocks: FloatArray) -> None:
    """Let rollers that touch at one end alone turn about it against a little, in place."""
    if blocks.shape[-1] > 1:
        blocks[..., 1, 1] += LEAST_TURNING * blocks[..., 0, 0]


def _solved_blocks(blocks: FloatArray, right: FloatArray) -> FloatArray:
    """Columns solved roller by roller; what nothing holds stays where it is."""
    if blocks.shape[-1] == 1:
        held = blocks[..., 0, 0]
        return right / np.where(held != 0.0, held, np.inf)[..., None, None]
    determinant = blocks[..., 0, 0] * blocks[..., 1, 1] - blocks[..., 0, 1] ** 2
    inverse = 1.0 / np.where(determinant > 0.0, determinant, np.inf)
    first, second = right[..., 0, :], right[..., 1, :]
    a, b, c = (blocks[..., i, j][..., None] for i, j in ((0, 0), (0, 1), (1, 1)))
    return np.stack((c * first - b * second, a * second - b * first), axis=-2) * inverse[..., None, None]
