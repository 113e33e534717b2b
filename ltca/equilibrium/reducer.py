"""A reducer of several discs: every disc a member with its own joints to wheel, crank and pin shaft, one wheel for all.

The coordinates are those of disc after disc and the wheel's (`ltca.geometry.coordinates`). A pair touches the columns of its
disc and of the wheel only, so force and tangent of the reducer are those of its discs, put in their places and summed at the
wheel; supports are springs on coordinates.
Pairs are numbered disc after disc: of n discs array axes for pairs are n times as long.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import (
    ComplexArray,
    FloatArray,
    Result,
    by_drive,
    has_rows,
    join_positions,
    map_arrays,
    take_positions,
    take_rows,
)
from ltca.compliance.pin_flexibility import PinDisplacements
from ltca.compliance.response import (
    ContactPressures,
    DiscModel,
    DiscResponse,
    KindPressures,
    Response,
    Start,
    bearing_moments,
    bearing_pushes,
)
from ltca.drive.parts import Drive
from ltca.equilibrium.external_force import ExternalForce
from ltca.equilibrium.first_stage import StageMesh
from ltca.equilibrium.friction.turning import RubbingPins, TurningFriction
from ltca.equilibrium.supports import Supports
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates
from ltca.geometry.pair_motion import KnownPins
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.carrier import far_flange_stiffness
from ltca.mechanics.answers import disc_response
from ltca.mechanics.contacts import ContactSystem, Linearised

POSITIONS_AT_ONCE = 512
"""Positions whose contacts are found at once: few enough for the processor's cache."""


class JointFriction(RubbingPins, Protocol):
    """Friction of the joints at a pose."""

    @property
    def pin(self) -> float:
        """Coefficient with which wheel pins rub."""
        ...

    @property
    def hole(self) -> float:
        """Coefficient with which shaft pins rub."""
        ...

    @property
    def rolling(self) -> float:
        """Moment between crank and disc by the load of a crank bearing, mm."""
        ...

    @property
    def motion(self) -> int:
        """+1 where the crank turns counter-clockwise, −1 clockwise, 0 where the input is locked."""
        ...

    @property
    def turns(self) -> bool:
        """Whether the drive turns: its friction goes with the loads alone and may be followed from none."""
        ...

    def scaled(self, strength: float) -> JointFriction:
        """Return the friction with all coefficients times a factor."""
        ...

    def reversed(self) -> JointFriction:
        """Return the friction of the same drive as it turns the other way."""
        ...

    def of_wheel(
        self, parts: Sequence[DiscResponse], reduction_ratio: float, external: ComplexArray | float = 0.0
    ) -> FloatArray:
        """Return the moment by which the wheel's bearing rubs, N·mm."""
        ...

    def of_cranks(self, pushes: Sequence[ComplexArray], on_bearings: ComplexArray | None = None) -> FloatArray:
        """Return the moment that rubbing takes at every crank, N·mm, shape (positions, cranks)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Reducer:
    """Discs that share wheel, cranks and pin shaft, and what these rest on.

    Attributes
    ----------
    discs : tuple of DiscModel
        How the contacts of each disc yield, all by the same model.
    supports : Supports or None
        Springs on coordinates; None where nothing yields.
    pins : PinDisplacements or None
        What displaces pins: beams under several discs, the ring of the wheel.
    flange : array, shape (3, 3) or (positions, 3, 3), or None
        What of the supports holds the far flange of a carrier (`ltca.laws.carrier`); None without posts.
    friction : JointFriction or None
        What rubs.
    stage : StageMesh or None
        Teeth of the first stage.
    external : ExternalForce or None
        Forces from outside on the output.
    """

    discs: tuple[DiscModel, ...]
    supports: Supports | None = None
    pins: PinDisplacements | None = None
    flange: FloatArray | None = by_drive(2, default=None)
    friction: JointFriction | None = None
    stage: StageMesh | None = None
    external: ExternalForce | None = None
    _by_position: bool | None = field(init=False, repr=False, compare=False, default=None)

    @classmethod
    def of_drive(cls, drive: Drive, discs: Sequence[DiscModel], ring_lender: Drive | None = None) -> Reducer:
        """Return the reducer of a drive whose discs yield by these models; a ring of finite elements may be that of a lender."""
        return cls(
            discs=tuple(discs),
            supports=Supports.of_drive(drive, discs[0].geometry),
            pins=PinDisplacements.of_drive(drive, ring_lender),
            flange=far_flange_stiffness(drive),
            friction=TurningFriction.of_drive(drive),
            stage=StageMesh.of_drive(drive),
            external=ExternalForce.of_drive(drive),
        )

    def take(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Reducer:
        """Return the model of some positions: itself where no two differ, neither in their drives nor in their friction."""
        if self._by_position is None:  # looked up once, and only for models that are solved
            object.__setattr__(self, "_by_position", has_rows(self))
        return take_rows(self, rows) if self._by_position else self

    @property
    def symmetric(self) -> bool:
        """Whether its forces are slopes of a potential: neither friction nor forces that go with the moments of the cranks."""
        return self.friction is None and not self._teeth_press

    @property
    def _teeth_press(self) -> bool:
        """Whether the forces of a first stage act on something that yields."""
        stage = self.stage
        return stage is not None and (stage.yields or (stage.carried and self.coordinates.wheel))

    @property
    def coordinates(self) -> Coordinates:
        """What its poses are made of."""
        return replace(self.discs[0].geometry.coordinates, discs=len(self.discs))

    @property
    def geometries(self) -> tuple[ContactGeometry, ...]:
        """The contact geometry of every disc."""
        return tuple(disc.geometry for disc in self.discs)

    def respond(
        self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None, *, roughly: bool = False
    ) -> Response:
        """Return the contact forces of all discs.

        Parameters
        ----------
        crank_angle : array, shape (positions,)
            φ_C, rad.
        pose : array, shape (positions, coordinates)
            q of `ltca.geometry.coordinates`.
        start : Start, optional
            Inner unknowns of a neighbouring pose, displacements of the pins among them.
        roughly : bool
            Whether contacts in slices and displacements of pins that have nearly settled will do: force and tangent are then
            those of settled ones to first order, and `Response.left` tells what is left.
        """
        return self.evaluate(crank_angle, pose, start, roughly=roughly).whole

    def _hold(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        parts: Sequence[DiscResponse],
        force: FloatArray,
        tangent: FloatArray,
    ) -> FloatArray:
        """Add what first stage, supports, forces from outside and friction of bearings do to force and tangent, in place; return
        the diagonal of the tangent of the contacts alone.
        """
        coordinates = self.coordinates
        contact_stiffness = np.asarray(np.einsum("bii->bi", tangent).copy(), dtype=float)
        beside_discs: tuple[ComplexArray, FloatArray] | tuple[()] = ()
        if self.stage is not None and self._teeth_press:
            beside_discs = self._press_teeth(self.stage, crank_angle, pose, parts, force, tangent)
        if self.supports is not None:
            held, stiffness = self.supports.respond(pose, *beside_discs)
            force += held
            tangent += stiffness
        if self.external is not None and coordinates.wheel:
            pressed = self.external.on_wheel(crank_angle)
            force[:, coordinates.wheel_place] -= np.stack((pressed.real, pressed.imag), axis=-1)
            if coordinates.wheel_leans:
                tilting = self.external.tilting(crank_angle)
                force[:, coordinates.wheel_lean_place] -= np.stack((tilting.real, tilting.imag), axis=-1)
        if self.friction is not None:
            ratio = self.discs[0].geometry.placement.reduction_ratio
            beside = self.force_beside_pins(crank_angle, pose, parts)
            force[:, WHEEL_ANGLE] += self.friction.of_wheel(parts, ratio, beside)
        return contact_stiffness

    def evaluate(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: Start | None = None,
        *,
        roughly: bool = False,
        everything: bool = False,
    ) -> Evaluation:
        """Return what a search asks for at poses; arguments as for `respond`, which makes a whole response of it.

        `everything` takes all contacts of coupled bodies as candidates to carry (`Evaluation.overlooks`).
        """
        rows = crank_angle.size
        if rows > POSITIONS_AT_ONCE:
            blocks = np.array_split(np.arange(rows), -(-rows // POSITIONS_AT_ONCE))
            each = [
                self.take(some).evaluate(
                    *take_positions((crank_angle, pose, start), some), roughly=roughly, everything=everything
                )
                for some in blocks
            ]
            return join_positions(each)
        at = ContactSystem(self).respond(crank_angle, pose, start, roughly=roughly, everything=everything)
        force, tangent = at.force.copy(), at.tangent.copy()
        found = _Evaluated(self, at)
        if self.friction is not None:
            for number, part in enumerate(found.parts):
                own, geometry = self.coordinates.columns(number), self.discs[number].geometry
                push = np.abs(bearing_pushes(part.rollers, geometry.placement.cranks))
                force[:, own] += self.friction.of_bearings(geometry, pose[:, own], push)
        needs_parts = self.friction is not None or (self.stage is not None and self._teeth_press)
        stiffness = self._hold(crank_angle, pose, found.parts if needs_parts else (), force, tangent)
        return Evaluation(
            force=force,
            tangent=tangent,
            contact_stiffness=stiffness,
            left=at.left,
            block=np.full(rows, found, dtype=object),
            row=np.arange(rows),
        )

    def crank_moments(self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]) -> FloatArray:
        """Return the external moment that holds each crank by virtual work, ccw positive, N·mm, shape (positions, cranks).

        It is ∂U/∂φ_C of the contacts: the moment of every bearing's force about the crank axis, which is that of the forces on
        the crank alone, and that of its cages (`cage_moments`) times `cage_speed`, the part of the crank's angle by which they
        turn. Friction at the crank adds its own.
        """
        cranks = self.discs[0].geometry.placement.cranks
        pushes = [bearing_pushes(part.rollers, cranks) for part in parts]
        total = self.discs[0].geometry.placement.cage_speed * self.cage_moments(crank_angle, pose, parts)
        for number, (disc, push) in enumerate(zip(self.discs, pushes, strict=True)):
            bores = disc.geometry.bores(crank_angle, pose[:, self.coordinates.columns(number)])
            total = total + (bores.lever.conjugate() * push).imag
        if self.friction is None:
            return total
        on_bearings = None if self.stage is None else self.stage.on_bearings(total)
        return total + self.friction.of_cranks(pushes, on_bearings)

    def cage_moments(self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]) -> FloatArray:
        """Return the external moment that holds the cages of each crank at their angle, ccw positive, N·mm, (positions, cranks).

        Cage and inner race are concentric and the race pushes its rollers along its radii, the bore along its own: what holds
        the cage is the moment of the bearing's force at the displaced centre of the bore, and of its couple at the bore's lean in
        the race, the sum over all discs.
        """
        cranks = self.discs[0].geometry.placement.cranks
        total = np.zeros((crank_angle.size, cranks))
        for number, (disc, part) in enumerate(zip(self.discs, parts, strict=True)):
            geometry, own = disc.geometry, pose[:, self.coordinates.columns(number)]
            bores = geometry.bores(crank_angle, own)
            total += (bores.displacement.conjugate() * bearing_pushes(part.rollers, cranks)).imag
            if self.coordinates.leans:
                tilting = bearing_moments(part.rollers, geometry.rollers(crank_angle), cranks)
                total += ((geometry.lean(own) - geometry.journal_leans(own)).conjugate() * tilting).imag
        return total

    def force_beside_pins(
        self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
    ) -> ComplexArray:
        """Return the force on the wheel relative to the pin shaft from outside and by the teeth of a first stage, N, shape
        (positions,).
        """
        total = np.zeros(crank_angle.shape, dtype=complex)
        if self.external is not None:
            total = total + self.external.on_wheel(crank_angle)
        if self.stage is not None and self.stage.carried:
            total = total + self.stage.on_wheel(self.crank_moments(crank_angle, pose, parts))[0]
        return total

    def tilting_beside_pins(
        self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
    ) -> ComplexArray:
        """Return what presses the lean of the wheel from outside and by the teeth of a first stage, N·mm, shape (positions,)."""
        total = np.zeros(crank_angle.shape, dtype=complex)
        if self.external is not None:
            total = total + self.external.tilting(crank_angle)
        if self.stage is not None and self.stage.carried:
            total = total + self.stage.tilting_on_wheel(self.crank_moments(crank_angle, pose, parts))[0]
        return total

    def carried_beside_discs(
        self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
    ) -> ComplexArray | None:
        """Return what the two bearings of every crank carry of the forces of a first stage while the planes of the discs stand
        still, N, shape (positions, cranks, 2); None without these forces.
        """
        if self.stage is None or not self.stage.yields:
            return None
        return self.stage.beside_discs(self.stage.on_planets(self.crank_moments(crank_angle, pose, parts))[0])

    def _press_teeth(
        self,
        stage: StageMesh,
        crank_angle: FloatArray,
        pose: FloatArray,
        parts: Sequence[DiscResponse],
        force: FloatArray,
        tangent: FloatArray,
    ) -> tuple[ComplexArray, FloatArray] | tuple[()]:
        """Take the forces of the first stage from the coordinates of cranks, flange and wheel, in place, before any but contacts
        press, and return what the bearings of the cranks carry of them while the discs stand still, with its derivatives.

        Where cranks are rigid, the derivatives of what the planets press on main bearing and flange are left out.
        """
        coordinates = self.coordinates
        moments = self.crank_moments(crank_angle, pose, parts)
        slopes = self._moment_slopes(crank_angle, pose, parts, tangent)
        on_wheel, by_moments = stage.on_wheel(moments)
        if coordinates.wheel:
            force[:, coordinates.wheel_place] -= np.stack((on_wheel.real, on_wheel.imag), axis=-1)
            moved = np.einsum("pc,pcj->pj", by_moments, slopes)
            tangent[:, coordinates.wheel_place] -= np.stack((moved.real, moved.imag), axis=1)
        if coordinates.wheel_leans:
            tilting, by_moments = stage.tilting_on_wheel(moments)
            force[:, coordinates.wheel_lean_place] -= np.stack((tilting.real, tilting.imag), axis=-1)
            moved = np.einsum("pc,pcj->pj", by_moments, slopes)
            tangent[:, coordinates.wheel_lean_place] -= np.stack((moved.real, moved.imag), axis=1)
        if not stage.yields:
            return ()
        pressed, by_moment = stage.on_planets(moments)
        force -= stage.on_coordinates(pressed)
        work = (stage.by_pose.conjugate() * by_moment[..., None]).real.sum(axis=-2)
        tangent -= np.matmul(work.swapaxes(-1, -2), slopes)
        carried, changes = stage.beside_discs(pressed), stage.beside_discs(by_moment)
        both = np.stack((changes.real, changes.imag), axis=-1).reshape(*moments.shape, -1, 1)
        return carried, both * slopes[:, :, None]

    def _moment_slopes(
        self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse], tangent: FloatArray
    ) -> FloatArray:
        """Derivatives of the moments that hold the cranks by the pose, shape (positions, cranks, coordinates), from the tangent
        of the contacts; zero where cranks are rigid, whose forces it does not have.
        """
        coordinates, cage = self.coordinates, np.asarray(self.discs[0].geometry.placement.cage_speed)
        slopes = np.zeros((crank_angle.size, self.discs[0].geometry.placement.cranks, coordinates.size))
        if not coordinates.cranks:
            return slopes
        for number, (disc, part) in enumerate(zip(self.discs, parts, strict=True)):
            own = coordinates.columns(number)
            bores = disc.geometry.bores(crank_angle, pose[:, own])
            x = own[coordinates.crank(0) + 2 * np.arange(coordinates.cranks)]
            arm = bores.lever + cage * bores.displacement
            changes = tangent[:, x] + 1j * tangent[:, x + 1]
            slopes += (arm.conjugate()[..., None] * changes).imag
            push = bearing_pushes(part.rollers, coordinates.cranks)
            slopes[..., own] += cage[..., None] * (bores.gradient.conjugate() * push[..., None]).imag
            for crank, twist in enumerate(bores.twists):
                slopes[:, crank, own[twist]] -= (bores.lever[:, crank].conjugate() * push[:, crank]).real
        return slopes

    def pressures(self, response: Response) -> ContactPressures:
        """Return the pressures of all discs behind a response of this model."""
        found = [disc.pressures(part) for disc, part in zip(self.discs, response.parts, strict=True)]
        kinds = ("pins", "outer", "inner", "holes")
        joined: dict[str, Any] = {kind: _beside_kinds([getattr(each, kind) for each in found]) for kind in kinds}
        return ContactPressures(**joined, rigid_shaft_pins=found[0].rigid_shaft_pins)


class _Evaluated:
    """Contacts of some positions as one system found them, and their responses once somebody asks."""

    def __init__(self, model: Reducer, at: Linearised) -> None:
        self.model, self.at = model, at

    @cached_property
    def parts(self) -> tuple[DiscResponse, ...]:
        """Contacts of every disc."""
        model, at = self.model, self.at
        parts = tuple(disc_response(at, disc) for disc in range(len(model.discs)))
        if at.shifts is not None and model.pins is not None and model.pins.ring is not None:
            ring = -model.pins.of_ring(at.members.forces(at.corrected_load))
            parts = tuple(replace(part, ring=ring) for part in parts)
        return parts

    @cached_property
    def start(self) -> Start:
        """Where other poses of the same positions start."""
        at = self.at
        flanks = [each.flank for each in at.discs]
        known = {name: _beside([getattr(flank, name) for flank in flanks]) for name in ("point", "turning")}
        return Start(
            parameter=_beside([flank.parameter for flank in flanks]),
            share=np.full(at.place.shape, 0.5),
            known=KnownPins(**known),
            follow=at.following(),
            inner=at.inner,
        )


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What a search asks for at the poses of some positions.

    Attributes
    ----------
    force, tangent, contact_stiffness, left : array
        Of `Response`.
    block : array of object, shape (positions,)
        What each position was evaluated with.
    row : array of int, shape (positions,)
        Its number there.
    """

    force: FloatArray
    tangent: FloatArray
    contact_stiffness: FloatArray
    left: FloatArray
    block: NDArray[np.object_]
    row: NDArray[np.intp]

    def _gathered(self, of_block: Callable[[_Evaluated], Result]) -> Result:
        """What blocks have, of the positions in their order."""
        order: list[NDArray[np.intp]] = []
        each: list[Result] = []
        numbers = np.arange(self.row.size)
        left = np.ones(self.row.size, dtype=bool)
        while left.any():
            found = self.block[np.argmax(left)]
            mine = numbers[self.block == found]
            left[mine] = False
            rows = self.row[mine]
            values = of_block(found)
            if rows.size != found.at.angle.size or np.any(rows != np.arange(rows.size)):
                values = take_positions(values, rows)
            order.append(mine)
            each.append(values)
        if len(each) == 1:
            return each[0]
        return take_positions(join_positions(each), np.argsort(np.concatenate(order)))

    @property
    def overlooks(self) -> NDArray[np.bool_]:
        """Positions where a contact was left out that is pressed together after all."""
        return self._gathered(lambda found: found.at.leaves_out)

    @property
    def start(self) -> Start:
        """Where other poses of the same positions start."""
        return self._gathered(lambda found: found.start)

    @property
    def kept(self) -> Response:
        """The whole response, without what a search alone asks for."""
        return self.whole.kept

    @property
    def whole(self) -> Response:
        """The whole response."""
        parts, shifts, start = self._gathered(lambda found: (found.parts, found.at.shifts_after, found.start))
        return Response(
            force=self.force,
            tangent=self.tangent,
            **_contacts_of(parts),
            parts=parts,
            shifts=None if shifts is None else shifts[:, : len(parts)],
            ring=parts[0].ring,
            follow=start.follow,
            left=self.left,
            inner=start.inner,
            contact_stiffness=self.contact_stiffness,
        )


def disc_pressures(pressures: ContactPressures, discs: int) -> tuple[ContactPressures, ...]:
    """Return the pressures of each of several discs from those of all."""
    if discs == 1:
        return (pressures,)

    def part(kind: KindPressures, number: int) -> KindPressures:
        each = kind.mid.shape[1] // discs
        own = slice(number * each, (number + 1) * each)
        return KindPressures(
            mid=kind.mid[:, own],
            largest=kind.largest[:, own],
            half_width=kind.half_width[:, own],
            end_cell=kind.end_cell,
            along=None if kind.along is None else map_arrays(lambda array: array[:, own], kind.along),
        )

    return tuple(
        ContactPressures(
            pins=part(pressures.pins, number),
            outer=part(pressures.outer, number),
            inner=part(pressures.inner, number),
            holes=part(pressures.holes, number),
            rigid_shaft_pins=pressures.rigid_shaft_pins,
        )
        for number in range(discs)
    )


def bearing_forces(model: Reducer, crank_angle: FloatArray, response: Response) -> NDArray[np.complex128]:
    """Return the forces of crank bearings on discs, shape (positions, discs, cranks), N: radial + i tangential (Eq. 73–74)."""
    forces = []
    for geometry, part in zip(model.geometries, response.parts, strict=True):
        ahead = geometry.placement.eccentric_directions(crank_angle)
        forces.append(bearing_pushes(part.rollers, ahead.shape[-1]) * ahead.conjugate())
    return np.stack(forces, axis=1)


def disc_torques(response: Response) -> FloatArray:
    """Return the part of the external moment on the wheel that each disc carries, shape (positions, discs), N·mm."""
    return np.stack([part.force[:, WHEEL_ANGLE] for part in response.parts], axis=1)


def _contacts_of(parts: Sequence[DiscResponse]) -> dict[str, Any]:
    """The contacts of all discs, disc after disc."""
    names = ("flank", "holes", "rollers", "pin_load", "hole_load")
    return {name: _beside([getattr(part, name) for part in parts]) for name in names}


def _beside(values: Sequence[Any]) -> Any:
    """Put arrays (positions, pairs, …), or dataclasses of them, of the discs side by side."""
    if len(values) == 1 or values[0] is None:
        return values[0]
    if not is_dataclass(values[0]):
        return np.concatenate(values, axis=1)
    kind: Any = type(values[0])  # FlankMotion, PairMotion, RollerState
    return kind(**{item.name: _beside([getattr(value, item.name) for value in values]) for item in fields(kind)})


def _beside_kinds(kinds: Sequence[KindPressures]) -> KindPressures:
    return KindPressures(
        mid=_beside([kind.mid for kind in kinds]),
        largest=_beside([kind.largest for kind in kinds]),
        half_width=_beside([kind.half_width for kind in kinds]),
        end_cell=kinds[0].end_cell,
        along=_beside([kind.along for kind in kinds]),
    )
