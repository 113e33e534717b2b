"""A reducer of several discs, which share wheel, cranks and pin shaft; pairs are numbered disc after disc."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

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
    put_positions,
    take_positions,
    take_rows,
)
from ltca.compliance.pin_flexibility import PinDisplacements
from ltca.compliance.response import (
    ContactPressures,
    DiscModel,
    DiscResponse,
    Response,
    Start,
    bearing_moments,
    bearing_pushes,
    beside,
)
from ltca.drive.parts import Drive
from ltca.equilibrium.external_force import ExternalForce
from ltca.equilibrium.first_stage import StageMesh
from ltca.equilibrium.friction.turning import TurningFriction
from ltca.equilibrium.supports import Supports
from ltca.geometry.coordinates import WHEEL_ANGLE, Coordinates
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.carrier import far_flange_stiffness
from ltca.mechanics.answers import disc_response
from ltca.mechanics.contacts import ContactSystem, Linearised
from ltca.mechanics.full_tangent import with_whole_tangent

POSITIONS_AT_ONCE = 512
"""Positions whose contacts are found at once: few enough for the processor's cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reducer:
    """Discs that share wheel, cranks and pin shaft, and what these rest on."""

    discs: tuple[DiscModel, ...]  # all by the same model
    supports: Supports | None = None
    pins: PinDisplacements | None = None  # beams under several discs, the ring of the wheel
    flange: FloatArray | None = by_drive(2, default=None)  # stiffness that holds the far flange of a carrier
    friction: TurningFriction | None = None
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
        """Whether its forces have a potential: neither friction nor forces that go with the moments of the cranks."""
        return self.friction is None and not self._teeth_press

    @property
    def _teeth_press(self) -> bool:
        """Whether the forces of a first stage act on something that yields."""
        stage = self.stage
        return stage is not None and (stage.yields or (stage.carried and self.coordinates.wheel))

    @property
    def coordinates(self) -> Coordinates:
        """The coordinates of its poses."""
        return replace(self.discs[0].geometry.coordinates, discs=len(self.discs))

    @property
    def geometries(self) -> tuple[ContactGeometry, ...]:
        """The contact geometry of every disc."""
        return tuple(disc.geometry for disc in self.discs)

    def respond(
        self, crank_angle: FloatArray, pose: FloatArray, start: Start | None = None, *, roughly: bool = False
    ) -> Response:
        """Return the contact forces of all discs; settled to first order if `roughly`, with the rest in `Response.left`."""
        return self.evaluate(crank_angle, pose, start, roughly=roughly).whole

    def evaluate(
        self,
        crank_angle: FloatArray,
        pose: FloatArray,
        start: Start | None = None,
        *,
        roughly: bool = False,
        everything: bool = False,
    ) -> Evaluation:
        """Return the contacts as a search needs them; `everything` takes all contacts that others move as candidates."""
        rows, system = crank_angle.size, ContactSystem(self)
        most = min(POSITIONS_AT_ONCE, system.positions_at_once)
        if rows > most:
            blocks = np.array_split(np.arange(rows), -(-rows // most))
            each = [
                self.take(some).evaluate(
                    *take_positions((crank_angle, pose, start), some), roughly=roughly, everything=everything
                )
                for some in blocks
            ]
            return join_positions(each)
        (_, first), *others = system.in_groups(crank_angle, pose, start, roughly=roughly, everything=everything)
        found = self._evaluated(first)
        for some, at in others:
            found = put_positions(found, some, self.take(some)._evaluated(at))
        return found

    def whole_tangent(self, crank_angle: FloatArray, pose: FloatArray, start: Start, lever: FloatArray) -> FloatArray:
        """Return the derivative of the force by the pose with nothing left out but friction (`ltca.mechanics.full_tangent`)."""
        most = min(POSITIONS_AT_ONCE, ContactSystem(self).positions_at_once)
        found = []
        for rows in np.array_split(np.arange(crank_angle.size), max(1, -(-crank_angle.size // most))):
            own = self.take(rows)
            at = ContactSystem(own).respond(*take_positions((crank_angle, pose, start), rows), roughly=False)
            found.append(own._evaluated(with_whole_tangent(at, lever[rows])).tangent)
        return np.concatenate(found)

    def _evaluated(self, at: Linearised) -> Evaluation:
        """Contacts at poses with first stage, supports, forces from outside and friction of bearings."""
        angle, pose, friction, found = at.angle, at.pose, self.friction, _Evaluated(self, at)
        force, tangent = at.force.copy(), at.tangent.copy()
        if friction is not None:
            for number, part in enumerate(found.parts):
                own, geometry = self.coordinates.columns(number), self.discs[number].geometry
                push = np.abs(bearing_pushes(part.rollers, geometry.placement.cranks))
                force[:, own] += friction.of_bearings(geometry, pose[:, own], push)
        contact_stiffness = np.asarray(np.einsum("bii->bi", tangent).copy(), dtype=float)
        beside: tuple[ComplexArray, FloatArray] | tuple[()] = ()
        if self.stage is not None and self._teeth_press:
            beside = self._press_teeth(self.stage, found, force, tangent)
        if self.supports is not None:
            held, stiffness = self.supports.respond(pose, *beside)
            force += held
            tangent += stiffness
        if self.external is not None:
            pressed = self.external.on_wheel(angle).view(float)
            for number, place in enumerate(self.wheel_places):
                force[:, place] -= pressed[:, 2 * number : 2 * number + place.size]
        if friction is not None:
            ratio, on_wheel = self.geometries[0].placement.reduction_ratio, self.beside_pins(angle, pose, found.parts)
            force[:, WHEEL_ANGLE] += friction.of_wheel(found.parts, ratio, on_wheel[:, 0])
        return Evaluation(
            force=force,
            tangent=tangent,
            contact_stiffness=contact_stiffness,
            left=at.left,
            block=np.full(angle.size, found, dtype=object),
            row=np.arange(angle.size),
        )

    def crank_moments(self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]) -> FloatArray:
        """Return the moment that holds each crank by virtual work, ∂U/∂φ_C, ccw positive, N·mm, shape (positions, cranks)."""
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
        """Return the moment that holds the cages of each crank, ccw positive, N·mm, shape (positions, cranks)."""
        # Those of the bearing's force at the displaced centre of the bore, and of its couple at the bore's lean in the race.
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

    def beside_pins(self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]) -> ComplexArray:
        """Return the force on the wheel from outside and by a first stage, N, and on its lean, N·mm, shape (positions, 2)."""
        total = np.zeros((crank_angle.size, 2), dtype=complex)
        if self.external is not None:
            total = total + self.external.on_wheel(crank_angle)
        if self.stage is not None and self.stage.carried:
            total = total + self.stage.on_wheel(self.crank_moments(crank_angle, pose, parts))[0]
        return total

    @property
    def wheel_places(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Coordinates of the wheel's place and of its lean, none where it has none."""
        every = np.arange(self.coordinates.size)
        return every[self.coordinates.wheel_place], every[self.coordinates.wheel_lean_place]

    def carried_beside_discs(
        self, crank_angle: FloatArray, pose: FloatArray, parts: Sequence[DiscResponse]
    ) -> ComplexArray | None:
        """Return `StageMesh.beside_discs` of the first stage, N, shape (positions, cranks, 2); None without its forces."""
        if self.stage is None or not self.stage.yields:
            return None
        return self.stage.beside_discs(self.stage.on_planets(self.crank_moments(crank_angle, pose, parts))[0])

    def _press_teeth(
        self, stage: StageMesh, found: _Evaluated, force: FloatArray, tangent: FloatArray
    ) -> tuple[ComplexArray, FloatArray] | tuple[()]:
        """Subtract the forces of the first stage, in place; return `beside` and `slopes` of `Supports.respond`."""
        moments = self.crank_moments(found.at.angle, found.at.pose, found.parts)
        slopes = self._moment_slopes(found, tangent)
        on_wheel, by_moments = stage.on_wheel(moments)
        moved = np.einsum("pkc,pcj->pkj", by_moments, slopes)
        for number, place in enumerate(self.wheel_places):
            if place.size:
                force[:, place] -= np.stack((on_wheel[:, number].real, on_wheel[:, number].imag), axis=-1)
                tangent[:, place] -= np.stack((moved[:, number].real, moved[:, number].imag), axis=1)
        if not stage.yields:
            return ()
        pressed, by_moment = stage.on_planets(moments)
        force -= stage.on_coordinates(pressed)
        work = (stage.by_pose.conjugate() * by_moment[..., None]).real.sum(axis=-2)
        tangent -= np.matmul(work.swapaxes(-1, -2), slopes)
        carried, changes = stage.beside_discs(pressed), stage.beside_discs(by_moment)
        both = np.stack((changes.real, changes.imag), axis=-1).reshape(*moments.shape, -1, 1)
        return carried, both * slopes[:, :, None]

    def _moment_slopes(self, found: _Evaluated, tangent: FloatArray) -> FloatArray:
        """Derivatives of the moments of the cranks by the pose, shape (positions, cranks, coordinates); zero of rigid cranks."""
        coordinates, place, angle = self.coordinates, self.geometries[0].placement, found.at.angle
        cage, slopes = np.asarray(place.cage_speed), np.zeros((angle.size, place.cranks, coordinates.size))
        if not coordinates.cranks:
            return slopes
        for number, (geometry, part) in enumerate(zip(self.geometries, found.parts, strict=True)):
            own = coordinates.columns(number)
            bores = geometry.bores(angle, found.at.pose[:, own])
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
        each = zip(self.discs, response.parts, strict=True)
        return beside([disc.pressures(part) for disc, part in each])


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
        """Start for other poses of the same positions."""
        return self.at.onward


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Contacts at poses as a search needs them; row `row` of `block` has the rest of each position."""

    force: FloatArray
    tangent: FloatArray
    contact_stiffness: FloatArray
    left: FloatArray
    block: NDArray[np.object_]
    row: NDArray[np.intp]

    def _gathered(self, of_block: Callable[[_Evaluated], Result]) -> Result:
        """Values of blocks, of the positions in their order."""
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
        """Start for other poses of the same positions."""
        return self._gathered(lambda found: found.start)

    @property
    def parts(self) -> tuple[DiscResponse, ...]:
        """Contacts of every disc."""
        return self._gathered(lambda found: found.parts)

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
            parts=parts,
            shifts=None if shifts is None else shifts[:, : len(parts)],
            left=self.left,
            inner=start.inner,
            contact_stiffness=self.contact_stiffness,
        )


def disc_pressures(pressures: ContactPressures, discs: int) -> tuple[ContactPressures, ...]:
    """Return the pressures of each of several discs from those of all."""

    def of_disc(number: int) -> ContactPressures:
        found: ContactPressures = map_arrays(lambda array: np.split(array, discs, axis=1)[number], pressures)
        return found

    return tuple(map(of_disc, range(discs)))


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
