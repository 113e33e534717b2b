r"""Loads of all contact pairs at a pose when the pairs feel each other through the bodies (`fe` and `hybrid`).

Every approach is the sum of the contact's own law and what the loads on the bodies add,

.. math:: \delta_i(q) = w_i(F_i) + \sum_j C_{ij} F_j ,

with the law of the near field w (`ltca.compliance.near_field`: half-spaces with the lengths and profiles of the parts for
`hybrid`, plane strain with a datum for `fe`) and the body part C of `ltca.compliance.coefficients`, in which pins and race
are as thick as the disc and rollers as long as they are. The unknowns at a pose are the near-field approaches ε: F = f(ε) is
zero where ε is negative, so that no contact has to be switched on or off, and Newton's method solves

.. math:: R(\epsilon) = \epsilon + C f(\epsilon) - \delta(q) = 0 .

Only contacts that may carry are unknowns: those pressed together, and open ones within `CANDIDATE_MARGIN`. The others' ε follows
from the loads; where one of them is positive after all, every contact is taken.

Of a roller the outer contact is the unknown. Its inner contact carries F_i = F_o (n_o·n) and yields with the race,
the roller and the inner contacts of the other rollers; the place of the roller on its ray follows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, join_positions, take_positions
from ltca.compliance import sliced
from ltca.compliance.coefficients import SOLID, InfluenceCoefficients
from ltca.compliance.contact_laws import ContactLaws
from ltca.compliance.near_field import NearField, NearFieldLaws, OwnParts
from ltca.compliance.pressures import pressures_in_slices, pressures_of_law
from ltca.compliance.response import (
    ContactPressures,
    DiscResponse,
    KindPressures,
    PairSlopes,
    Start,
    add_bearing_bend,
    resultant,
    split_shifts,
)
from ltca.compliance.rollers import RollerState
from ltca.compliance.undeformed import UndeformedBodies
from ltca.contact.tracked_grid import ContactKind
from ltca.drive.hole_contact import shaft_pins_yield
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.backed import (
    back_shaft_pins,
    shaft_pin_seat,
    shaft_pin_stiffness,
    tip_share,
    tip_slope,
)
from ltca.laws.contact_law import ContactLaw
from ltca.laws.spring import SpringLaw

MAX_ITERATIONS = 60
POSITIONS_PER_CHUNK = 256
"""Positions solved at once: the matrices of more would not fit into the processor's cache."""
CANDIDATE_MARGIN = 0.25
"""Gap within which an open contact is taken for a candidate to carry, relative to the largest overlap at its position."""


@dataclass(frozen=True)
class BodyFlexibility:
    """What bodies yield at the contacts of a disc under the loads of some of them, or by moments at half the width.

    Attributes
    ----------
    coefficients : InfluenceCoefficients
        Of the bodies.
    own : OwnParts
        What each contact's own body parts add to its own.
    race : array, shape (rollers, rollers)
        Between the rollers on the races.
    behind : float
        What stands behind shaft pins in their holes, mm/N.
    unit : float
        Of what is taken and of the loads, by mm/N.
    places : tuple
        Of the contacts (`InfluenceCoefficients.disc_matrix`).
    loaded : tuple of array of int, shape (positions, chosen)
        Wheel pins, rollers and holes that carry.
    """

    coefficients: InfluenceCoefficients
    own: Any
    race: FloatArray
    behind: float
    unit: float
    places: tuple[Any, ...]
    loaded: tuple[NDArray[np.intp], ...]

    @cached_property
    def among(self) -> FloatArray:
        """What loaded pins, rollers in the bores and holes take by each other's loads, shape (positions, n, n), mm/N."""
        flank, bore, holes, on_flank, radius = self.places
        found = self.coefficients.disc_matrix(flank, bore, holes, on_flank, radius, self.loaded, among=True)
        place = np.arange(found.shape[1])
        found[:, place, place] += self.diagonal
        return self.unit * found if self.unit != 1.0 else found

    @property
    def diagonal(self) -> FloatArray:
        """What is added of each loaded contact alone."""
        own = self.own.pin, self.own.outer, self.own.hole + self.behind
        return np.repeat(own, [some.shape[1] for some in self.loaded])

    @property
    def on_race(self) -> FloatArray:
        """What rollers take on the races by each other's loads there, shape (positions, rollers, rollers)."""
        some = self.loaded[1]
        return np.asarray(self.unit * self.race[some[:, :, None], some[:, None, :]])

    @property
    def across_roller(self) -> float:
        """What a roller yields at one of its contacts under the load of the other."""
        return self.unit * float(self.coefficients.roller[0, 1])

    def taken(self, load: FloatArray) -> FloatArray:
        """What all pins, rollers in the bores and holes take by the loads of the chosen ones, shape (positions, n)."""
        flank, bore, holes, on_flank, radius = self.places
        matrix = self.coefficients.disc_matrix(flank, bore, holes, on_flank, radius, self.loaded)
        found = np.matmul(matrix, load[..., None])[..., 0]
        first = np.cumsum((0, flank.shape[1], bore.shape[1]))
        chosen = np.concatenate([at + some for at, some in zip(first, self.loaded, strict=True)], axis=1)
        found[np.arange(found.shape[0])[:, None], chosen] += self.diagonal * load
        return np.asarray(self.unit * found)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledCompliance:
    """Compliance of contacts coupled through the bodies.

    Attributes
    ----------
    geometry : ContactGeometry
        The contact geometry of the drive.
    coefficients : InfluenceCoefficients
        Body parts, rollers as long as they are.
    near_field : NearFieldLaws
        Laws of the near fields.
    hole_law : ContactLaw
        Near field of the hole's wall, or the spring of the shaft pin where the wall does not yield.
    hole_spring : float
        What the spring of the shaft pin yields behind the near field, mm/N; zero where it is the law.
    race : array, shape (rollers, rollers)
        Coefficients between the inner contacts of the rollers, which feel those on their own race alone, mm/N.
    outer_radius, inner_radius : array, shape (rollers,)
        Effective radii of the rollers' contacts, mm.
    hole_radius : array, shape (z_PS,)
        Effective radii of shaft pins and holes, mm.
    own : OwnParts
        What each contact's own body parts add to the diagonal of C.
    race_tilting : array, shape (rollers, rollers), or None
        Tilts by moments between the inner contacts, rad/(N·mm), of solid bodies in slices.
    """

    grids_can_check: ClassVar[bool] = False

    geometry: ContactGeometry
    coefficients: InfluenceCoefficients
    near_field: NearFieldLaws
    hole_law: ContactLaw
    hole_spring: float
    race: FloatArray
    outer_radius: FloatArray
    inner_radius: FloatArray
    hole_radius: FloatArray
    own: OwnParts
    race_tilting: FloatArray | None = None

    @classmethod
    def of_drive(
        cls,
        drive: Drive,
        coefficients: InfluenceCoefficients,
        near_field: NearField,
        *,
        hole_near_field: bool = True,
    ) -> CoupledCompliance:
        """Return the coupled model of a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        coefficients : InfluenceCoefficients
            Of this drive.
        near_field : {"plane-strain", "half-space"}
            Plane strain, or half-spaces of finite length with the profiles of rollers and pins.
        hole_near_field : bool
            Whether holes and shaft pins yield like a Hertz contact; else the springs of the pins stand for all.

        Raises
        ------
        DriveError
            When the coefficients are those of other bodies, or plane strain cannot say what the drive has.
        """
        fingerprint = drive.shape_fingerprint(coefficients.bodies)
        if coefficients.fingerprint != fingerprint:
            raise DriveError(
                [
                    f"influence coefficients of the shape {coefficients.fingerprint}: must be those of {drive.name}, shape "
                    f"{fingerprint}"
                ]
            )
        geometry = replace(ContactGeometry.of_drive(drive), tip_share=tip_share(drive), tip_slope=tip_slope(drive))
        place = geometry.placement
        yields = hole_near_field and shaft_pins_yield(drive)
        laws = NearFieldLaws.of_drive(
            drive,
            near_field,
            rigid_shaft_pins=hole_near_field and not yields,
            solid=coefficients.plane == SOLID,
        )
        body = coefficients.placed_in(drive).with_roller_length(drive.roller_length)
        stiffness = shaft_pin_stiffness(drive)
        slices, width = drive.contact.slices, drive.disc.thickness
        # In slices a beam bends behind its contact, under the forces of all discs (`ltca.equilibrium.pin_displacements`).
        bends_behind = slices > 1 and shaft_pin_beam(drive) is not None
        at_hole: Any = laws.hole
        if not hole_near_field and not bends_behind:
            at_hole = (
                SpringLaw(stiffness=stiffness)
                if slices == 1
                else sliced.back_line(
                    sliced.SlicedSpring(stiffness=stiffness, length=width, slices=slices),
                    shaft_pin_seat(drive),
                    place.shaft_pin_plays,
                )
            )
        # A sleeve's own law has all that it yields (`ltca.laws.backed`).
        bare = drive.pin_shaft is not None and drive.pin_shaft.seat.kind == "fixed"
        own = OwnParts.of_drive(drive, geometry, body, near_field, laws.datum, elastic_shaft_pins=yields and bare)
        on_race = place.roller_cage_angles, float(place.inner_race_radius)
        race, tilting = body.race_matrix(*on_race), None
        if body.tilting is not None and own.tilting is not None:
            tilting = body.tilting.race_matrix(*on_race) + own.tilting.inner * np.eye(race.shape[0])
        return cls(
            geometry=geometry,
            coefficients=body,
            near_field=laws,
            hole_law=at_hole
            if slices > 1
            else back_shaft_pins(drive, at_hole, place.shaft_pin_plays, laws.depth if hole_near_field else None),
            hole_spring=1.0 / stiffness if hole_near_field and not bends_behind else 0.0,
            race=race + own.inner * np.eye(race.shape[0]),
            outer_radius=place.outer_effective_radii,
            inner_radius=place.inner_effective_radii,
            hole_radius=place.hole_effective_radii,
            own=own,
            race_tilting=tilting,
        )

    def respond(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: Start | None = None,
        shifts: ComplexArray | None = None,
        leans: ComplexArray | None = None,
        again: DiscResponse | None = None,
        *,
        roughly: bool = False,
    ) -> DiscResponse:
        """Return the contact forces at the poses of a batch of positions; see `ltca.compliance.uncoupled`.

        Contacts that feel each other all move with displaced pins, and settle together: `again` and `roughly` are of no use.

        Raises
        ------
        ConvergenceError
            When the near-field approaches of a position do not settle.
        """
        moved = split_shifts(shifts, self.geometry)
        if self.geometry.coordinates_of(pose).leans:
            from ltca.compliance.coupled_slices import respond_in_slices

            parts = [
                respond_in_slices(self, *take_positions((crank_angle, pose, start, shifts, leans, moved[0]), rows))
                for rows in np.array_split(
                    np.arange(crank_angle.size), max(1, -(-crank_angle.size // POSITIONS_PER_CHUNK))
                )
            ]
            in_slices: DiscResponse = join_positions(parts)
            return in_slices
        flank = self.geometry.flank(crank_angle, pose, None if start is None else start.parameter, moved[0])
        holes = self.geometry.holes(crank_angle, pose, moved[1])
        pins, parts = (flank, holes, shifts), []
        for rows in np.array_split(np.arange(crank_angle.size), max(1, -(-crank_angle.size // POSITIONS_PER_CHUNK))):
            bodies = UndeformedBodies(self.geometry, *take_positions((crank_angle, pose, pins), rows))
            parts.append(self._solve(bodies, start, rows))
        joined: DiscResponse = join_positions(parts)
        return joined

    @property
    def contact_laws(self) -> ContactLaws:
        """Laws of the contacts."""
        near = self.near_field
        return ContactLaws(
            (near.pin, near.outer, self.hole_law, near.inner), self.outer_radius, self.hole_radius, self.inner_radius
        )

    def body_flexibility(self, places: tuple[Any, ...], loaded: Sequence[NDArray[np.intp]]) -> list[BodyFlexibility]:
        """Return what the bodies of a disc yield of approaches by loads and, of solid bodies in slices, of tilts by moments.

        `places` are those that `InfluenceCoefficients.disc_matrix` takes, `loaded` the wheel pins, rollers and holes that carry.
        """
        whole = self.coefficients
        found = [BodyFlexibility(whole, self.own, self.race, self.hole_spring, 1.0, places, tuple(loaded))]
        tilting, own = whole.tilting, self.own.tilting
        if self.race_tilting is not None and tilting is not None and own is not None:
            # What a pin stands on behind its contact is rigid against moments.
            unit = (0.5 * whole.thickness) ** 2
            found.append(BodyFlexibility(tilting, own, self.race_tilting, 0.0, unit, places, tuple(loaded)))
        return found

    def body_matrix(self, bodies: UndeformedBodies, loaded: Sequence[NDArray[np.intp]]) -> FloatArray:
        """Return C of all contacts by the loads of some, pins, rollers and holes, mm/N, shape (positions, contacts, loaded)."""
        flank, place = bodies.flank.parameter, self.geometry.placement
        on_flank, profile = self.geometry.profile.flank(flank), float(place.bore_radius)
        found = self.coefficients.disc_matrix(flank, bodies.bore_places, bodies.hole_places, on_flank, profile, loaded)
        first = np.cumsum((0, flank.shape[1], bodies.bore_places.shape[1]))
        chosen = np.concatenate([at + part for at, part in zip(first, loaded, strict=True)], axis=1)
        own = (self.own.pin, self.own.outer, self.own.hole + self.hole_spring)
        rows, columns = np.arange(chosen.shape[0])[:, None], np.arange(chosen.shape[1])
        found[rows, chosen, columns] += np.repeat(own, [part.shape[1] for part in loaded])
        return found

    def _solve(self, bodies: UndeformedBodies, start: Start | None, rows: NDArray[np.intp]) -> DiscResponse:
        guess = bodies.geometric * np.where(bodies.geometric > 0.0, 0.5, 1.0)  # a fair share of a rigid overlap
        if start is not None:
            for row, warm in enumerate(start.warm_start[rows]):
                if warm is not None:
                    guess[row] = warm
        for margin in (CANDIDATE_MARGIN, np.inf):
            batch = _Batch(self, bodies, margin)
            response = batch.response(batch.solve(guess))
            if response is not None:
                return response
        raise AssertionError("all contacts are taken, none is left out")

    def pressures(self, response: DiscResponse) -> ContactPressures:
        """Return pressures and half-widths from the near fields, of contacts in slices from their line loads."""
        laws = self.near_field
        if response.leaning_pins is not None:
            place, rigid = self.geometry.placement, laws.rigid_shaft_pins
            at_hole: Any = laws.hole
            modulus = getattr(at_hole, "contact", at_hole).contact_modulus
            kinds = replace(laws.kinds, holes=replace(laws.kinds.holes, contact_modulus=modulus))
            return pressures_in_slices(response, kinds, place, has_ends=laws.has_ends, rigid_shaft_pins=rigid)
        assert response.deformation is not None
        near = response.deformation[:, 0]
        pins, rollers = response.pin_load.shape[1], self.outer_radius.size
        inner, _ = laws.inner.approach_at_load(response.rollers.inner_load, self.inner_radius)
        hole, _ = laws.hole.approach_at_load(response.hole_load, self.hole_radius)

        def read(law: ContactLaw, kind: ContactKind, approach: FloatArray, radius: FloatArray) -> KindPressures:
            return pressures_of_law(law, kind if laws.has_ends else None, approach, radius)

        return ContactPressures(
            pins=read(laws.pin, laws.kinds.pins, near[:, :pins], response.flank.effective_radius),
            outer=read(laws.outer, laws.kinds.outer, near[:, pins : pins + rollers], self.outer_radius),
            inner=read(laws.inner, laws.kinds.inner, inner, self.inner_radius),
            holes=read(laws.hole, laws.kinds.holes, hole, self.hole_radius),
            rigid_shaft_pins=laws.rigid_shaft_pins,
        )


class _Batch:
    """The coupled problem of some positions: as many contacts in each of them as may carry anywhere."""

    def __init__(self, model: CoupledCompliance, bodies: UndeformedBodies, margin: float) -> None:
        self.bodies, self.model, flank = bodies, model, bodies.flank
        pins, rollers = flank.approach.shape[1], model.outer_radius.size
        self.loaded = bodies.within(margin)
        on_flank, in_bore, in_holes = self.loaded
        self.chosen = np.concatenate((on_flank, pins + in_bore, pins + rollers + in_holes), axis=1)
        self.outer = slice(on_flank.shape[1], on_flank.shape[1] + in_bore.shape[1])
        self.all_outer = slice(pins, pins + rollers)
        rows = np.arange(self.chosen.shape[0])[:, None]
        self.body = model.body_matrix(bodies, self.loaded)
        self.among = self.body[rows, self.chosen]
        self.race = model.race[in_bore[:, :, None], in_bore[:, None, :]]
        self.effective_radius = np.take_along_axis(flank.effective_radius, on_flank, axis=1)
        self.outer_radius, self.inner_radius = model.outer_radius[in_bore], model.inner_radius[in_bore]
        self.hole_radius = model.hole_radius[in_holes]
        self.pin_law = model.near_field.pin.take(flank.approach.shape, (rows, on_flank))
        self.hole_law = model.hole_law.take((rows.size, model.hole_radius.size), (rows, in_holes))
        self.inner_near = self.inner_compliance = self.inner_load = np.zeros(in_bore.shape)
        self.placed = False
        self.place_rollers(np.zeros((rows.size, rollers)))

    def of_chosen(self, values: FloatArray) -> FloatArray:
        """The values of the chosen contacts."""
        return np.take_along_axis(values, self.chosen, axis=1)

    def of_all(self, values: FloatArray, kind: NDArray[np.intp], count: int) -> FloatArray:
        """Values of the chosen contacts of a kind among zeros for the others."""
        full = np.zeros((values.shape[0], count))
        np.put_along_axis(full, kind, values, axis=1)
        return full

    def place_rollers(self, inner_approach: FloatArray) -> None:
        """Put the rollers where their inner contacts are pressed together by an amount, mm."""
        self.inner_approach = inner_approach
        self.length, self.outward, cosine = self.bodies.rollers_at(inner_approach)
        self.cosine = np.take_along_axis(cosine, self.loaded[1], axis=1)

    @property
    def geometric(self) -> FloatArray:
        """Overlap of the undeformed bodies at the present places of the rollers, shape (positions, contacts)."""
        overlap = self.bodies.geometric.copy()
        overlap[:, self.all_outer] = self.length - self.bodies.rays.bore_play
        return overlap

    def loads(self, near: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return loads and stiffnesses of the near fields."""
        m, outer = self.model, self.outer
        parts = (
            self.pin_law.load_and_stiffness(near[:, : outer.start], self.effective_radius),
            m.near_field.outer.load_and_stiffness(near[:, outer], self.outer_radius),
            self.hole_law.load_and_stiffness(near[:, outer.stop :], self.hole_radius),
        )
        load, stiffness = (np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True))
        return load, stiffness

    def evaluate(self, near: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residual R(ε) and the body matrix with the inner contacts of the rollers in it."""
        m, outer, in_bore = self.model, self.outer, self.loaded[1]
        self.load, self.stiffness = self.loads(near)
        outer_load = self.load[:, outer]
        cross = m.coefficients.roller[0, 1]
        # The direction of the outer load hardly turns with the roller's place: that of the last evaluation is as good.
        for _ in range(1 if self.placed else 2):
            inner_load = outer_load * self.cosine
            expected = self.inner_near + self.inner_compliance * (inner_load - self.inner_load)
            self.inner_load = inner_load
            self.inner_near, self.inner_compliance = m.near_field.inner.approach_at_load(
                inner_load, self.inner_radius, expected
            )
            inner = self.of_all(self.inner_load, in_bore, m.race.shape[0]) @ m.race
            inner += self.of_all(self.inner_near + cross * outer_load, in_bore, m.race.shape[0])
            self.place_rollers(inner)
        self.placed = True
        c = self.cosine
        matrix = self.among.copy()
        matrix[:, outer, outer] += c[:, :, None] * self.race * c[:, None, :]
        diagonal = np.einsum("bii->bi", matrix)
        diagonal[:, outer] += c * self.inner_compliance * c + 2.0 * cross * c
        yielding = np.matmul(self.among, self.load[..., None])[..., 0]
        yielding[:, outer] += cross * self.inner_load
        return near + yielding - self.of_chosen(self.geometric), matrix

    def solve(self, guess: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the near-field approaches at which every contact's approach is accounted for, and the matrix there."""
        near = self.of_chosen(guess)
        residual, matrix = self.evaluate(near)
        size = np.max(np.abs(residual), axis=1)
        history: list[float] = []
        for _ in range(MAX_ITERATIONS):
            history.append(float(np.max(size, initial=0.0)))
            if history[-1] < 1e-13:
                return near, matrix
            jacobian = np.eye(near.shape[1]) + matrix * self.stiffness[:, None, :]
            step = np.linalg.solve(jacobian, residual[..., None])[..., 0]
            fraction = np.ones(near.shape[0])
            for _ in range(12):
                trial = near - fraction[:, None] * step
                residual, matrix = self.evaluate(trial)
                found = np.max(np.abs(residual), axis=1)
                worse = (found > size) & (found > 1e-12)
                if not worse.any():
                    break
                fraction = np.where(worse, 0.5 * fraction, fraction)
            near, size = trial, found
            if len(history) > 5 and history[-1] < 1e-11 and float(np.max(size)) >= 0.5 * history[-1]:
                return near, matrix  # round-off of radii of 100 mm
        raise ConvergenceError("near-field approaches do not settle; largest residual in mm", history)

    def response(self, solution: tuple[FloatArray, FloatArray]) -> DiscResponse | None:
        """Return forces and tangent at the solution; None where a contact that was left out is pressed together."""
        near, matrix = solution
        bodies, (on_flank, in_bore, in_holes), outer = self.bodies, self.loaded, self.outer
        cross = self.model.coefficients.roller[0, 1]
        pins, rollers = bodies.flank.approach.shape[1], self.model.outer_radius.size
        contacts = bodies.geometric.shape[1]
        yielding = np.matmul(self.body, self.load[..., None])[..., 0]
        yielding[:, self.all_outer] += cross * self.of_all(self.inner_load, in_bore, rollers)
        everywhere = self.geometric - yielding
        np.put_along_axis(everywhere, self.chosen, near, axis=1)
        left_out = self.of_all(np.ones(near.shape), self.chosen, contacts) == 0.0
        if np.any(everywhere[left_out] > 0.0):
            return None
        # dF = k (1 + C k)⁻¹ dδ: symmetric, and zero in rows and columns of open contacts.
        root = np.sqrt(self.stiffness)
        inside = np.eye(near.shape[1]) + root[:, :, None] * matrix * root[:, None, :]
        gradient = np.zeros((*near.shape, bodies.flank.gradient.shape[-1]))
        gradient[:, : outer.start] = np.take_along_axis(bodies.flank.gradient, on_flank[..., None], axis=1)
        outward = np.take_along_axis(self.outward, in_bore, axis=1)
        moved = np.take_along_axis(
            np.broadcast_to(bodies.moved, (*self.outward.shape, gradient.shape[-1])), in_bore[..., None], axis=1
        )
        gradient[:, outer] = -(outward.conjugate()[..., None] * moved).real
        gradient[:, outer.stop :] = np.take_along_axis(bodies.holes.gradient, in_holes[..., None], axis=1)
        gradient *= root[..., None]
        changed = np.linalg.solve(inside, gradient)
        tangent = np.matmul(gradient.swapaxes(1, 2), changed)
        load = self.of_all(self.load, self.chosen, contacts)
        pin_load, outer_load, hole_load = np.split(load, (pins, pins + rollers), axis=1)
        tangent += bodies.flank.bend(pin_load) + bodies.holes.bend(hole_load)
        across = (outward.conjugate()[..., None] * moved).imag
        bend = self.load[:, outer] / np.take_along_axis(self.length, in_bore, axis=1)
        tangent += np.matmul(across.swapaxes(1, 2), bend[..., None] * across)
        # A pair's approach: the overlap less what the other pairs' loads take of it. Negative is open.
        approach = everywhere + self.of_all(np.einsum("bii->bi", self.among) * self.load, self.chosen, contacts)
        inner_load = self.of_all(self.inner_load, in_bore, rollers)
        rays = bodies.rays
        resting = np.abs(rays.outermost * rays.direction - bodies.displacement) - rays.bore_play
        free = outer_load <= 0.0
        inner_near = self.of_all(self.inner_near, in_bore, rollers) + np.diag(self.model.race) * inner_load
        at_bore = approach[:, self.all_outer]
        state = RollerState(
            share=np.full(free.shape, 0.5),
            inner_approach=np.where(free, 0.0, inner_near),
            outer_approach=np.where(free, np.minimum(resting, at_bore), at_bore),
            inner_load=inner_load,
            outer_load=outer_load,
            outer_direction=self.outward,
            tangent=np.zeros((*free.shape, 2, 2)),
        )
        add_bearing_bend(tangent, state, bodies.bores)
        flank = replace(bodies.flank, approach=approach[:, :pins])
        holes = replace(bodies.holes, approach=approach[:, pins + rollers :])
        warm_start = np.empty(near.shape[0], dtype=object)
        warm_start[:] = list(everywhere)
        kept = np.r_[:pins, pins + rollers : contacts]
        return DiscResponse(
            force=resultant(flank, pin_load, holes, hole_load, state, bodies.bores),
            tangent=tangent,
            flank=flank,
            holes=holes,
            rollers=state,
            pin_load=pin_load,
            hole_load=hole_load,
            warm_start=warm_start,
            shifts=bodies.shifts,
            slopes=None
            if bodies.shifts is None
            else _coupled_slopes(root, inside, np.asarray(changed), self.chosen, kept),
        )


def _coupled_slopes(
    root: FloatArray, inside: FloatArray, changed: FloatArray, chosen: NDArray[np.intp], kept: NDArray[np.intp]
) -> PairSlopes:
    """Return how the loads follow approaches and pose where contacts feel each other: dF = r (1 + r C r)⁻¹ r dδ.

    Parameters
    ----------
    root : array, shape (positions, chosen)
        r, square root of the stiffness of each contact that may carry.
    inside : array, shape (positions, chosen, chosen)
        1 + r C r.
    changed : array, shape (positions, chosen, coordinates)
        (1 + r C r)⁻¹ r ∂δ/∂q.
    chosen : array of int, shape (positions, chosen)
        Which of all contacts they are.
    kept : array of int
        Numbers of wheel pins and shaft pins among all contacts, the last of which is the last of these.
    """
    positions, contacts, rows = (
        root.shape[0],
        max(int(kept[-1]), int(chosen.max())) + 1,
        np.arange(root.shape[0])[:, None],
    )
    by_pose, by_approach = np.zeros((positions, contacts, changed.shape[2])), np.zeros((positions, contacts, contacts))
    by_pose[rows, chosen] = root[..., None] * changed
    between = root[..., None] * np.linalg.solve(inside, root[..., None] * np.eye(root.shape[1]))
    by_approach[rows[..., None], chosen[:, :, None], chosen[:, None, :]] = between
    return PairSlopes(by_approach=by_approach[:, kept[:, None], kept], by_pose=by_pose[:, kept])
