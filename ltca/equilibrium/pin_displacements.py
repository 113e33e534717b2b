r"""Pins displaced by the parts that hold them: beams under several discs, and the ring of the pin wheel under all its pins.

What the forces on pins displace is :math:`u = -S f`, with one symmetric flexibility S and the forces :math:`f = F e` of the
discs against the displacements, :math:`e = \partial \delta / \partial u`. S is a sum: a pin is one beam under the forces of all
discs (`ltca.beam`), and the ring moves every pin by the forces on all of them, summed over the discs
(`ltca.compliance.ring`). Displacements of wheel pins are those in the turning wheel, so S does not turn.
What a disc's own force makes a beam yield lies along the common normal, in series with the contact, and is part of its law
(`ltca.laws.backed`).

Gaps are those of the displaced pins, with no normal linearised: loads and displacements are found together at every pose by
Newton's method, pin by pin where neither the ring nor the body of a disc couples them, for all that carry at once elsewhere.
With :math:`K = \partial f/\partial u` and :math:`H = \partial f/\partial q` the tangent of the whole is that of pins at rest
less :math:`H^T (1 + S K)^{-1} S H`.

In slices a disc presses a pin with a moment as well, and the pin leans where it stands in the disc. Leans are kept as
displacements at half the thickness of the disc and moments as forces there, behind those of all discs, so that S stays one
symmetric matrix: the slope under a force is the deflection under a moment. All that a beam bends is in S then, also under its
own disc and in a drive of one disc, and laws are those of the contacts alone. A ring moves seats and does not lean them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.beam import PinBeam
from ltca.compliance.response import DiscResponse, PairSlopes
from ltca.compliance.ring import ring_flexibility
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE, Coordinates

PLAIN_ITERATIONS = 20
"""Iterations by the size of the residual; rings so soft that contacts alternate are settled by their energy."""
MAX_ITERATIONS = 60
SHIFT_TOLERANCE = 5e-14
"""Largest residual of a pin's displacement, mm: a few round-offs of coordinates of 100 mm."""
ROUGH = 0.02
"""Residual of displacements, as a part of the largest approach, that loads follow linearly well enough for a step."""
ENTRIES_AT_ONCE = 2_000_000
"""Entries of the matrices solved at once, 16 MB each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PinDisplacements:
    """What displaces pins.

    Attributes
    ----------
    beams : array, shape (pairs, discs, discs) or (positions, pairs, discs, discs)
        Deflection of each pin at disc d under a unit force of disc d', wheel pins before shaft pins, mm/N; zero for d = d', and
        for pins that do not bend. Where pins lean, those of leans and moments by `half_width` follow, and d = d' is not zero.
    ring : array, shape (z_P, 2, z_P, 2) or (positions, z_P, 2, z_P, 2), or None
        Displacement (x, y) of the seats of the wheel pins in the wheel under unit forces at the seats, mm/N.
    half_width : float or array, shape (positions, 1)
        Half the thickness of the discs, mm.
    leans : bool
        Whether pins lean.
    """

    beams: FloatArray = by_drive(3)
    ring: FloatArray | None = by_drive(4, default=None)
    half_width: float | FloatArray = by_drive(0, default=1.0)
    leans: bool = False

    @classmethod
    def of_drive(cls, drive: Drive, lender: Drive | None = None) -> PinDisplacements | None:
        """Return what displaces the pins of a drive; None where they stand still but for what each disc alone bends.

        A ring of finite elements takes the shape of that of the `lender`, if one is given (`ring_flexibility`).
        """
        beams, ring = _beams(drive), ring_flexibility(drive, lender)
        if ring is None and not beams.any():
            return None
        return cls(beams=beams, ring=ring, half_width=0.5 * drive.disc.thickness, leans=drive.contact.slices > 1)

    @property
    def discs(self) -> int:
        """Number of discs."""
        return int(self.beams.shape[-1]) // (1 + self.leans)

    def unmoved(self, positions: int) -> ComplexArray:
        """Return the displacements of pins that stand where they stand without load, shape (positions, discs, pairs)."""
        pairs, rows, _ = self.beams.shape[-3:]
        return np.zeros((positions, rows, pairs), dtype=complex)

    def lean(self, shifts: ComplexArray, disc: int) -> ComplexArray:
        """Return the leans of the pins at a disc among their displacements, rad, shape (positions, pairs)."""
        return np.asarray(shifts[:, self.discs + disc] / self.half_width)

    def under(self, force: ComplexArray) -> ComplexArray:
        """Return S f, mm, for forces on the pins by disc, N, shape (positions, discs, pairs)."""
        found: ComplexArray = np.matmul(self.beams.astype(complex), force.swapaxes(1, 2)[..., None])[..., 0].swapaxes(
            1, 2
        )
        if self.ring is not None:
            found[:, : self.discs, : self.ring.shape[-2]] += self.of_ring(force)[:, None]
        return found

    def of_ring(self, force: ComplexArray) -> ComplexArray:
        """Return the part of the ring in S f, the same for all discs, shape (positions, z_P)."""
        if self.ring is None:
            return np.zeros((force.shape[0], 0), dtype=complex)
        seats = self.ring.shape[-2]
        total = force[:, : self.discs, :seats].sum(axis=1)
        flat = np.stack((total.real, total.imag), axis=-1).reshape(-1, 2 * seats, 1)
        matrix = self.ring.reshape(*self.ring.shape[:-4], 2 * seats, 2 * seats)
        moved = np.matmul(matrix, flat).reshape(-1, seats, 2)
        return np.asarray(moved[..., 0] + 1j * moved[..., 1])

    def settle(
        self,
        respond: Callable[[ComplexArray], tuple[DiscResponse, ...]],
        coordinates: Coordinates,
        turned: ComplexArray,
        shifts: ComplexArray,
        *,
        roughly: bool = False,
    ) -> DisplacedPins:
        """Return the contacts of all discs with the pins displaced by all forces, and how all follow the pose.

        Parameters
        ----------
        respond : callable
            Returns the contacts of all discs for displacements, mm, complex, shape (positions, discs, pairs), with leans behind
            them in slices (`lean`).
        coordinates : Coordinates
            Of the whole.
        turned : array of complex, shape (positions,)
            Direction in which the wheel stands.
        shifts : array of complex, shape (positions, discs, pairs)
            Displacements to start from, mm.
        roughly : bool
            End where what is left follows linearly (`ROUGH`): pose and displacements are then found together.

        Raises
        ------
        ConvergenceError
            When they do not settle.
        """
        kind = LeaningPins if self.leans else DisplacedPins

        def together(moved: ComplexArray) -> DisplacedPins:
            return kind(self, respond(moved), coordinates, turned, moved)

        def each(moved: ComplexArray) -> DisplacedPins:
            return kind(self, respond(moved), coordinates, turned, moved, alone=True)

        try:
            return self._settle(together, shifts, roughly)
        except ConvergenceError:
            # Steps of all pins are as long as the worst of them allows: where nothing but the pose couples pins, each may settle
            # by itself.
            if self.ring is not None or not each(shifts).alone:
                raise
            return self._settle(each, shifts, roughly)

    @staticmethod
    def _settle(at: Callable[[ComplexArray], DisplacedPins], shifts: ComplexArray, roughly: bool) -> DisplacedPins:
        """Settle the displacements by the size of what is left, and by their energy where contacts alternate."""
        history: list[float] = []
        system = at(shifts)
        for _ in range(PLAIN_ITERATIONS):
            size = system.size
            history.append(float(np.max(size, initial=0.0)))
            most = float(np.max(np.abs(system.shifts), initial=0.0))
            if history[-1] <= SHIFT_TOLERANCE + 1e-13 * most or (roughly and np.all(size <= system.rough)):
                return system
            if system.is_settled(most, roughly):
                return system
            step, each = system.step, system.sizes
            fraction = system.longest
            for _ in range(10):
                there = at(system.shifts + fraction * step)
                worse = (there.sizes > each) & (there.sizes > SHIFT_TOLERANCE + 1e-11 * most)
                if not worse.any():
                    break
                fraction = np.where(worse, 0.5 * fraction, fraction)
            system = there
            if len(history) > 2 and _is_round_off(float(np.max(system.size)), history[-1], most):
                return system
        return _settled_by_energy(system, at, history, roughly)


def _settled_by_energy(
    system: DisplacedPins, at: Callable[[ComplexArray], DisplacedPins], history: list[float], roughly: bool
) -> DisplacedPins:
    """Settle the pins of a soft ring, on which contacts open and close from step to step, along the slope of the energy.

    With :math:`u = -S g` the energy of contacts and parts is :math:`U(u) + g^T S g/2`, whose slope along a step of g is that of
    what is left over: steps end where it has not turned upward, which no alternation of contacts can escape.
    """
    # The first step is a whole one: what made the displacements is known from there on.
    aim = system.aim
    known, system = aim, at(system.shifts + system.step)
    for _ in range(MAX_ITERATIONS):
        most = float(np.max(np.abs(system.shifts), initial=0.0))
        history.append(float(np.max(system.size, initial=0.0)))
        settled = history[-1] <= SHIFT_TOLERANCE + 1e-12 * most or _is_round_off(history[-1], history[-2], most)
        if settled or system.is_settled(most, roughly):
            return system
        way, step = system.aim - known, system.step
        steep = np.abs(system.along(way, system.left))
        fraction = system.longest
        there = at(system.shifts + fraction * step)
        for _ in range(20):
            uphill = -system.along(way, there.left)
            too_far = (uphill > 0.1 * steep) & (there.sizes > SHIFT_TOLERANCE + 1e-12 * most)
            if not too_far.any():
                break
            shorter = np.divide(steep, steep + uphill, out=np.ones_like(steep), where=too_far).clip(0.1, 0.8)
            fraction = np.where(too_far, shorter * fraction, fraction)
            there = at(system.shifts + fraction * step)
        known, system = known + fraction * way, there
    raise ConvergenceError(
        f"the displacements of the pins do not settle (the largest is {most:.3g} mm): the ring or the beams that hold them are "
        "too soft for these loads; largest change in mm",
        history,
    )


def _is_round_off(left: float, before: float, most: float) -> bool:
    """Whether what is left of displacements, mm, no longer falls because it is nothing but round-off of forces and gaps."""
    return before < 1e-11 * (1.0 + most) and left >= 0.5 * before


@dataclass(frozen=True, slots=True, kw_only=True)
class Settled:
    """What displaced pins do to the whole.

    Attributes
    ----------
    force : array, shape (positions, coordinates)
        What is added to the generalised force because displacements have not settled, to first order, N and N·mm.
    tangent : array, shape (positions, coordinates, coordinates)
        What is added to the tangent.
    onward : array of complex, shape (positions, discs, pairs)
        Displacements to go on from, mm.
    by_pose : array of complex, shape (positions, discs, pairs, coordinates)
        How displacements follow the pose.
    left : array, shape (positions,)
        Force that what is left of the displacements amounts to, N.
    """

    force: FloatArray
    tangent: FloatArray
    onward: ComplexArray
    by_pose: ComplexArray
    left: FloatArray


class DisplacedPins:
    """How loads on pins and their displacements follow each other and the pose.

    Parameters
    ----------
    held : PinDisplacements
        What displaces the pins.
    parts : tuple of DiscResponse
        Contacts of each disc, with their slopes.
    coordinates : Coordinates
        Of the whole.
    turned : array of complex, shape (positions,)
        Direction in which the wheel stands.
    shifts : array of complex, shape (positions, discs, pairs)
        Displacements that the contacts were found at, mm.
    alone : bool
        Whether pins take steps of their own lengths where none couples them.
    """

    condenses = False
    """Whether the seats of a ring are found beside the pins, not with all of them at once."""

    def __init__(
        self,
        held: PinDisplacements,
        parts: tuple[DiscResponse, ...],
        coordinates: Coordinates,
        turned: ComplexArray,
        shifts: ComplexArray,
        *,
        alone: bool = False,
    ) -> None:
        self.held, self.parts, self.coordinates, self.shifts = held, parts, coordinates, shifts
        self.slopes: list[PairSlopes] = [part.slopes for part in parts if part.slopes is not None]
        self.coupled = any(slopes.by_approach.ndim > 2 for slopes in self.slopes)
        self.coupled |= held.ring is not None and not self.condenses
        self.alone = alone and not self.coupled
        wheel, pairs = parts[0].pin_load.shape[1], parts[0].pin_forces.shape[1]
        self.moves = np.any(held.beams != 0.0, axis=(-2, -1)).reshape(-1, pairs).any(axis=0)
        self.moves |= (held.ring is not None) & (np.arange(pairs) < wheel)
        self.frame = np.where(np.arange(pairs) < wheel, turned.conjugate()[:, None], 1.0)
        """What turns directions into those of the part that holds the pin, shape (positions, pairs)."""
        self.rubs = _friction_by_load(parts)
        self.force = self._forces()
        """Against the pins' displacements, N, shape (positions, discs, pairs)."""
        self.left = shifts + held.under(self.force)
        """Displacements less what the forces make of them, mm, shape (positions, discs, pairs)."""
        self.size = np.max(np.abs(self.left), axis=(1, 2), initial=0.0)

    @property
    def sizes(self) -> FloatArray:
        """Largest of what is left of each pin, or of all where they are coupled, mm, shape (positions, 1, pairs or 1)."""
        return np.asarray(np.max(np.abs(self.left), axis=1 if self.alone else (1, 2), keepdims=True, initial=0.0))

    @property
    def longest(self) -> FloatArray:
        """Longest part of Newton's step, shape (positions, 1, pairs or 1), by which a pin moves no farther than twice what
        displaces and presses it now: steps have no bound where loads on a soft pin turn with it as much as it holds against.
        """
        if not self.alone:
            return np.ones(self.sizes.shape)
        step = np.max(np.abs(self.step), axis=1)
        room = np.max(np.abs(self.shifts), axis=1) + np.max([self._pressed(part) for part in self.parts], axis=0)
        return np.asarray(np.divide(2.0 * room, step, out=np.ones(step.shape), where=step > 2.0 * room)[:, None])

    def _pressed(self, part: DiscResponse) -> FloatArray:
        """How deep pairs are pressed together anywhere, mm, shape (positions, pairs)."""
        pressed = np.concatenate((part.flank.approach, part.holes.approach), axis=1)
        if part.leaning_pins is not None and part.leaning_holes is not None:
            tilts = [np.abs(pairs.tilt.tilt) for pairs in (part.leaning_pins, part.leaning_holes)]
            pressed = pressed + np.asarray(self.held.half_width) * np.concatenate(tilts, axis=1)
        return np.maximum(pressed, 0.0)

    def along(self, way: ComplexArray, left: ComplexArray) -> FloatArray:
        """Return Σ of products of components of each pin, or of all where they are coupled, shape (positions, 1, pairs or 1)."""
        return np.asarray((way.conjugate() * left).real.sum(axis=1 if self.alone else (1, 2), keepdims=True))

    def _forces(self) -> ComplexArray:
        return np.stack([-part.pin_forces * self.frame for part in self.parts], axis=1)

    @property
    def rough(self) -> FloatArray:
        """Residual from which on loads follow displacements linearly, mm, shape (positions,)."""
        largest = [np.max(part.flank.approach, axis=1) for part in self.parts]
        return np.asarray(ROUGH * np.maximum(np.max(largest, axis=0), 0.0))

    @cached_property
    def step(self) -> ComplexArray:
        """Newton's step of the displacements with the pose held, mm."""
        return -self.left - self.held.under(self.aim - self.force)

    def is_settled(self, most: float, roughly: bool) -> bool:
        """Whether Newton's step is nothing, or small enough; `most` is the largest displacement, mm.

        A soft part makes much of little: what is left, by a step that moves no contact, is its flexibility times the round-off of
        their loads.
        """
        size = np.max(np.abs(self.step), axis=(1, 2), initial=0.0)
        return bool(np.all(size <= SHIFT_TOLERANCE + 1e-12 * most) or (roughly and np.all(size <= self.rough)))

    @cached_property
    def aim(self) -> ComplexArray:
        """Forces on the pins after Newton's step, linear, N."""
        change = np.zeros_like(self.left)
        for rows, disc, pair in self._groups():
            stiffness, flexibility = self._stiffness(rows, disc, pair), self._flexibility(rows, disc, pair)
            given = self._flat(self.left[rows, disc, pair])
            moved = self._solved(rows, flexibility, stiffness, -given)
            change[rows, disc, pair] = _vectors_of(_times(stiffness, moved))[..., 0]
        return self.force + change

    def settled(self) -> Settled:
        """Return what displaced pins add to force and tangent of discs whose pins stand still, and how they follow the pose."""
        positions, size = self.force.shape[0], self.coordinates.size
        added, tangent = np.zeros((positions, size)), np.zeros((positions, size, size))
        # By the coordinates, and by what is left of the displacements.
        change = np.zeros((size + 1, *self.force.shape), dtype=complex)
        unbalanced, stiffest, stepped = (np.zeros(positions) for _ in range(3))
        for rows, disc, pair in self._groups():
            stiffness, flexibility = self._stiffness(rows, disc, pair), self._flexibility(rows, disc, pair)
            by_pose, own = self._by_pose(rows, disc, pair), rows[:, 0, 0]
            given = self._flat(self.left[rows, disc, pair])
            right = np.concatenate((self._moved_by(rows, flexibility, by_pose), given), axis=-1)
            moved = -self._solved(rows, flexibility, stiffness, right)
            back = by_pose if self.rubs is None else self._by_shift(rows, disc, pair)
            onto = np.matmul(back.swapaxes(2, 3), moved).sum(axis=1)
            tangent[own], added[own] = onto[..., :-1], onto[..., -1]
            force = _times(stiffness, moved)
            force[..., :-1] += by_pose
            change[:, rows, disc, pair] = np.moveaxis(_vectors_of(force), -1, 0)
            unbalanced[own] = np.max(np.abs(force[..., -1]), axis=(1, 2), initial=0.0)
            stepped[own] = np.max(np.abs(moved[..., -1]), axis=(1, 2), initial=0.0)
            stiffest[own] = np.abs(stiffness).reshape(own.size, -1).max(axis=1)
        # What is left by a step that moves no contact is round-off of a soft part.
        most = np.max(np.abs(self.shifts), axis=(1, 2), initial=0.0)
        *by_pose_of_all, by_left = (self.held.under(each) for each in change)
        return Settled(
            force=added,
            tangent=0.5 * (tangent + tangent.swapaxes(1, 2)) if self.rubs is None else tangent,
            onward=self.shifts - self.left - by_left,
            by_pose=-np.stack(by_pose_of_all, axis=-1),
            left=np.where(stepped <= SHIFT_TOLERANCE + 1e-12 * most, unbalanced, stiffest * self.size),
        )

    def _solved(
        self, rows: NDArray[np.intp], flexibility: FloatArray, stiffness: FloatArray, right: FloatArray
    ) -> FloatArray:
        """(1 + S K)⁻¹ of columns, by groups."""
        return np.asarray(np.linalg.solve(_one_plus(flexibility, stiffness), right), dtype=float)

    def _moved_by(self, rows: NDArray[np.intp], flexibility: FloatArray, force: FloatArray) -> FloatArray:
        """S of columns of forces, by groups."""
        return np.asarray(np.matmul(flexibility, force))

    @staticmethod
    def _flat(values: ComplexArray) -> FloatArray:
        """Displacements of the members of groups by member and component, as a column."""
        return np.stack((values.real, values.imag), axis=-1).reshape(*values.shape[:2], -1, 1)

    def _groups(self) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]]:
        """Positions, discs and pairs of what is solved together, shape (positions, groups, members) when broadcast.

        A group is a pin under all discs where nothing else couples pins, or everything that carries and can move.
        """
        positions, discs, pairs = self.force.shape
        own = np.flatnonzero(self.moves)
        if not self.coupled:
            disc, pair = np.broadcast_arrays(np.arange(discs)[None, None, :], own[None, :, None])
            at_once = max(1, ENTRIES_AT_ONCE // max(1, own.size * (2 * discs) ** 2))
        else:
            # A contact that carries nothing has no stiffness. Most rows have a few idle ones for the sake of the fullest.
            load = np.stack([np.concatenate((part.pin_load, part.hole_load), axis=1) for part in self.parts], axis=1)
            load = np.tile(load, (1, discs // len(self.parts), 1))  # leans carry where displacements do
            carries = ((load > 0.0) & self.moves).reshape(positions, discs * pairs)
            most = max(1, int(np.max(np.count_nonzero(carries, axis=1), initial=0)))
            chosen = np.sort(np.argsort(~carries, axis=1, kind="stable")[:, :most], axis=1)[:, None, :]
            disc, pair = chosen // pairs, chosen % pairs
            at_once = max(1, ENTRIES_AT_ONCE // (2 * most) ** 2)
        for first in range(0, positions, at_once):
            rows = np.arange(first, min(first + at_once, positions))[:, None, None]
            part = slice(None) if not self.coupled else rows[:, 0, 0]
            yield rows, disc[part], pair[part]

    def _flexibility(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """S among the members of groups, by member and component, shape (positions or 1, groups, 2 members, 2 members)."""
        beams, ring = self.held.beams, self.held.ring
        one, other = np.broadcast_arrays(pair[..., :, None], pair[..., None, :])
        places: tuple[NDArray[np.intp], ...] = (one, disc[..., :, None], disc[..., None, :])
        if beams.ndim > 3:
            places = (rows[..., None], *places)
        count = 2 * one.shape[-1]
        found = np.zeros(
            (*np.broadcast_shapes(one.shape[:-2], (*rows.shape[:1], 1) if beams.ndim > 3 else ()), count, count)
        )
        if beams.any():
            along = beams[places] * (one == other)
            found[..., ::2, ::2] = found[..., 1::2, 1::2] = along
        if ring is not None and self.coupled:
            # Row by row of a matrix with an empty seat in the place of all shaft pins.
            seats = ring.shape[-2]
            own = ring[rows[:, 0, 0]] if ring.ndim > 4 else ring
            whole = np.zeros((*own.shape[:-4], 2 * seats + 2, 2 * seats + 2))
            whole[..., :-2, :-2] = own.reshape(*own.shape[:-4], 2 * seats, 2 * seats)
            seat = np.where(disc < self.held.discs, np.minimum(pair, seats), seats)
            seat = (2 * seat[..., None] + np.arange(2)).reshape(*pair.shape[:-1], count)
            if ring.ndim > 4:
                row = np.arange(own.shape[0])[:, None, None, None]
                found = found + whole[row, seat[..., :, None], seat[..., None, :]]
            else:
                found = found + np.take(whole, seat[..., :, None] * whole.shape[-1] + seat[..., None, :])
        return found

    def _stiffness(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """K among the members of groups: that of the contacts along their normals, and loads that turn with them.

        A matrix by member and component where the body of a disc couples them; a block for each member, shape (…, members, 2, 2),
        where nothing does.
        """
        normal, slip = self._vectors(rows, disc, pair, "gradient"), self._vectors(rows, disc, pair, "along")
        pushing = self._pushing(rows, disc, pair)
        bend = self._bend(rows, disc, pair)[..., None, None] * slip[..., :, None] * slip[..., None, :]
        if self.slopes[0].by_approach.ndim == 2:
            by_approach = np.stack([slopes.by_approach for slopes in self.slopes], axis=1)[rows, disc, pair]
            return np.asarray(bend + by_approach[..., None, None] * pushing[..., :, None] * normal[..., None, :])
        members = normal.shape[2]
        itself = np.arange(members)
        every = np.stack([slopes.by_approach for slopes in self.slopes], axis=1)
        same = disc[..., :, None] == disc[..., None, :]
        slope = every[rows[..., None], disc[..., :, None], pair[..., :, None], pair[..., None, :]] * same
        found = pushing[..., :, :, None, None] * slope[..., :, None, :, None] * normal[..., None, None, :, :]
        found[:, :, itself, :, itself, :] += np.moveaxis(bend, 2, 0)
        return np.asarray(found.reshape(*found.shape[:2], 2 * members, 2 * members))

    def _by_pose(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """H of the members of groups, shape (positions, groups, 2 members, coordinates)."""
        loads = [slopes.by_pose[rows, pair] for slopes in self.slopes]
        return self._following(rows, disc, pair, loads, self._pushing(rows, disc, pair))

    def _by_shift(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """How generalised forces follow the displacements, in the layout of H, which they are without friction.

        Friction works by the place of the pin; the lever of the point of contact about it is left out.
        """
        loads = []
        for number, (part, slopes) in enumerate(zip(self.parts, self.slopes, strict=True)):
            assert self.rubs is not None
            along = np.concatenate((part.flank.along, part.holes.along), axis=1) * self.rubs[:, number, :, None]
            by_approach = slopes.by_approach
            rubbed = by_approach[..., None] * along if by_approach.ndim == 2 else np.matmul(by_approach, along)
            loads.append((slopes.by_pose + rubbed)[rows, pair])
        return self._following(rows, disc, pair, loads, self._vectors(rows, disc, pair, "gradient"))

    def _pushing(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """Forces of unit loads on the pins, friction included, shape (positions, groups, members, 2)."""
        normal = self._vectors(rows, disc, pair, "gradient")
        if self.rubs is None:
            return normal
        return np.asarray(normal + self.rubs[rows, disc, pair][..., None] * self._vectors(rows, disc, pair, "along"))

    def _following(
        self,
        rows: NDArray[np.intp],
        disc: NDArray[np.intp],
        pair: NDArray[np.intp],
        by_pose: list[FloatArray],
        normal: FloatArray,
    ) -> FloatArray:
        """Forces along normals whose loads follow the pose as given, and loads that turn with it."""
        load = self._load(rows, disc, pair)
        found = np.zeros((*normal.shape, self.coordinates.size))
        for number, loads in enumerate(by_pose):
            mine = (disc == number)[..., None, None]
            block = self._turning(rows, disc, pair, number, load)
            block += normal[..., :, None] * loads[..., None, :]
            found[..., self.coordinates.columns(number)] += mine * block
        return np.asarray(found.reshape(*found.shape[:2], -1, self.coordinates.size))

    def _turning(
        self,
        rows: NDArray[np.intp],
        disc: NDArray[np.intp],
        pair: NDArray[np.intp],
        number: int,
        load: FloatArray | float,
    ) -> FloatArray:
        """F ∂²δ/∂u∂q by the pose of a disc: κ s_u s_qᵀ, on the flank with s_u e₂ᵀ − s_u e_Wᵀ as well."""
        slip = self._vectors(rows, disc, pair, "along")
        bend, on_flank = self._curved(rows, disc, pair) * load, load * self._on_flank(pair)
        part = self.parts[number]
        every = np.concatenate((part.flank.along, part.holes.along), axis=1)[rows, pair]
        block = bend[..., None, None] * slip[..., :, None] * every[..., None, :]
        block[..., DISC_ROTATION] -= on_flank[..., None] * slip
        block[..., WHEEL_ANGLE] += on_flank[..., None] * slip
        return np.asarray(block)

    def _vectors(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp], name: str) -> FloatArray:
        """Normals (`gradient`) or tangents (`along`) against displacements of the pins, shape (positions, groups, members, 2).

        A pin moves against a disc as the disc moves the other way against it.
        """
        each = [np.concatenate((getattr(p.flank, name), getattr(p.holes, name)), axis=1) for p in self.parts]
        return self._seen(np.stack([one[..., DISC_PLACE] for one in each], axis=1), rows, disc, pair)

    def _seen(
        self, every: FloatArray, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]
    ) -> FloatArray:
        """Derivatives by places of discs, (positions, discs, pairs, 2), as those by displacements of the members of groups."""
        turned = -(every[..., 0] + 1j * every[..., 1]) * self.frame[:, None]
        found = turned[rows, disc, pair]
        return np.stack((found.real, found.imag), axis=-1)

    def _load(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        load = [np.concatenate((part.pin_load, part.hole_load), axis=1) for part in self.parts]
        return np.asarray(np.stack(load, axis=1)[rows, disc, pair])

    def _on_flank(self, pair: NDArray[np.intp]) -> NDArray[np.bool_]:
        return np.asarray(pair < self.parts[0].pin_load.shape[1])

    def _bend(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """F κ of the contacts with the sign of their curvature."""
        return self._curved(rows, disc, pair) * self._load(rows, disc, pair)

    def _curved(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """κ of the contacts with its sign, 1/mm."""
        bending = [np.concatenate((part.flank.bending, part.holes.bending), axis=1) for part in self.parts]
        return np.asarray(np.stack(bending, axis=1)[rows, disc, pair] * np.where(self._on_flank(pair), -1.0, 1.0))


class LeaningPins(DisplacedPins):
    """Pins that lean as well: members of groups are displacements and leans of pairs, the latter behind those of all discs.

    With :math:`a = \\partial \\delta/\\partial u` and :math:`b = \\partial \\theta/\\partial u` the stiffness is
    :math:`F_\\delta a a^T + F_\\theta (a b^T + b a^T) + M_\\theta b b^T`, and what loads and moments add that turn with the pins.

    Where nothing but a ring couples pins, groups are pins under all discs, and their seats in the ring are found with them:
    of the forces :math:`y = P^T K u` on the seats, u = A⁻¹(g − P R y) with the A of the beams alone and the R of the ring.
    """

    condenses = True

    def _seats(self, rows: NDArray[np.intp]) -> tuple[FloatArray, FloatArray] | None:
        """P of a pin, shape (2 members, 2), and R of the ring; None where no ring moves pins or it is in S."""
        ring = self.held.ring
        if ring is None or self.coupled:
            return None
        count, seats = self.force.shape[1], ring.shape[-2]
        onto = np.zeros((2 * count, 2))
        onto[: 2 * self.held.discs] = np.tile(np.eye(2), (self.held.discs, 1))
        own = ring[rows[:, 0, 0]] if ring.ndim > 4 else ring[None]
        return onto, own.reshape(-1, 2 * seats, 2 * seats)

    def _solved(
        self, rows: NDArray[np.intp], flexibility: FloatArray, stiffness: FloatArray, right: FloatArray
    ) -> FloatArray:
        held = self._seats(rows)
        if held is None:
            return super()._solved(rows, flexibility, stiffness, right)
        onto, ring = held
        seats, columns = ring.shape[-1] // 2, right.shape[-1]
        units = np.broadcast_to(onto, (*right.shape[:2], *onto.shape))
        found = np.linalg.solve(_one_plus(flexibility, stiffness), np.concatenate((right, units), axis=-1))
        alone, moved = found[..., :columns], found[:, :seats, :, columns:]
        press = np.matmul(onto.T, stiffness[:, :seats])
        system = np.matmul(np.matmul(press, moved), ring.reshape(-1, seats, 2, 2 * seats)).reshape(
            -1, 2 * seats, 2 * seats
        )
        system = system + np.eye(2 * seats)
        pressed = np.matmul(press, alone[:, :seats]).reshape(-1, 2 * seats, columns)
        back = np.matmul(ring, np.linalg.solve(system, pressed)).reshape(-1, seats, 2, columns)
        alone[:, :seats] -= np.matmul(moved, back)
        return np.asarray(alone)

    def _moved_by(self, rows: NDArray[np.intp], flexibility: FloatArray, force: FloatArray) -> FloatArray:
        found, held = super()._moved_by(rows, flexibility, force), self._seats(rows)
        if held is not None:
            onto, ring = held
            seats, columns = ring.shape[-1] // 2, force.shape[-1]
            total = np.matmul(onto.T, force[:, :seats]).reshape(-1, 2 * seats, columns)
            found[:, :seats] += np.matmul(onto, np.matmul(ring, total).reshape(-1, seats, 2, columns))
        return found

    def _forces(self) -> ComplexArray:
        moments = np.stack([-part.pin_moments * self.frame for part in self.parts], axis=1)
        moments /= np.asarray(self.held.half_width)[..., None]
        return np.concatenate((super()._forces(), moments), axis=1)

    def _kinds(
        self, rows: NDArray[np.intp], row: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], NDArray[np.bool_], FloatArray]:
        """Disc of each member, whether it is a lean, and half the width."""
        half = np.asarray(self.held.half_width)
        return (
            row % self.held.discs,
            row >= self.held.discs,
            half[rows[:, 0, 0]][..., None] if half.ndim else half,
        )

    def _by_member(
        self, rows: NDArray[np.intp], row: NDArray[np.intp], pair: NDArray[np.intp]
    ) -> tuple[FloatArray, FloatArray]:
        """a and b of the members, shape (positions, groups, members, 2)."""
        disc, lean, half = self._kinds(rows, row)
        normal = self._vectors(rows, disc, pair, "gradient")
        tilts = [(part.leaning_pins, part.leaning_holes) for part in self.parts]
        each = [np.concatenate([one.tilt.gradient for one in both if one is not None], axis=1) for both in tilts]
        turned = self._seen(np.stack([one[..., DISC_PLACE] for one in each], axis=1), rows, disc, pair)
        on = lean[..., None]
        return np.where(on, 0.0, normal), np.where(on, normal / half[..., None], turned)

    def _loads(self, rows: NDArray[np.intp], row: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """F of displacements and M by half the width of leans."""
        disc, lean, half = self._kinds(rows, row)
        return np.where(lean, self._moments(rows, disc, pair) / half, self._load(rows, disc, pair))

    def _moments(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        each = [
            np.concatenate(
                [one.contact.moment for one in (part.leaning_pins, part.leaning_holes) if one is not None], axis=1
            )
            for part in self.parts
        ]
        return np.asarray(np.stack(each, axis=1)[rows, disc, pair])

    def _stiffness(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """K among the members of groups, a matrix by member and component."""
        row = disc
        disc, lean, half = self._kinds(rows, row)
        a, b = self._by_member(rows, row, pair)
        one_disc = disc[..., :, None] == disc[..., None, :]
        itself = one_disc & (pair[..., :, None] == pair[..., None, :])

        def among(name: str) -> FloatArray:
            every = np.stack([np.asarray(getattr(slopes, name)) for slopes in self.slopes], axis=1)
            if every.ndim == 3:
                return np.asarray(every[rows, disc, pair][..., None] * itself)
            where = rows[..., None], disc[..., :, None], pair[..., :, None], pair[..., None, :]
            return np.asarray(every[where] * one_disc)

        def outer(first: FloatArray, values: FloatArray, second: FloatArray) -> FloatArray:
            return np.asarray(
                first[..., :, :, None, None] * values[..., :, None, :, None] * second[..., None, None, :, :]
            )

        mixed = among("by_tilt")
        found = outer(a, among("by_approach"), a) + outer(b, among("moment_by_tilt"), b)
        found += outer(a, mixed, b) + outer(b, mixed.swapaxes(-1, -2), a)
        slip = self._vectors(rows, disc, pair, "along")
        other = lean[..., :, None] ^ lean[..., None, :]
        none = lean[..., :, None] & lean[..., None, :]
        load, moment = self._load(rows, disc, pair), self._moments(rows, disc, pair) / half
        turning = np.where(other, moment[..., None], np.where(none, 0.0, load[..., None])) * itself
        found += outer(slip, turning * self._curved(rows, disc, pair)[..., None], slip)
        members = 2 * row.shape[-1]
        return found.reshape(*found.shape[:2], members, members)

    def _by_pose(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        row = disc
        disc, lean, _ = self._kinds(rows, row)
        a, b = self._by_member(rows, row, pair)
        load, moment = self._loads(rows, row, pair), np.where(lean, 0.0, self._moments(rows, disc, pair))
        found = np.zeros((*a.shape, self.coordinates.size))
        one, on_flank = replace(self.coordinates, discs=1), self._on_flank(pair)[..., None, None]
        for number, slopes in enumerate(self.slopes):
            assert slopes.moment_by_pose is not None
            turned = self._turning(rows, disc, pair, number, 1.0)
            block = load[..., None, None] * turned
            # Tilts by the disc's lean turn as gaps by its displacement do, and by the wheel's the other way.
            moved = moment[..., None, None] * turned[..., DISC_PLACE]
            block[..., one.lean_place] += moved
            if one.wheel_leans:
                block[..., one.wheel_lean_place] -= on_flank * moved
            block += a[..., :, None] * slopes.by_pose[rows, pair][..., None, :]
            block += b[..., :, None] * slopes.moment_by_pose[rows, pair][..., None, :]
            found[..., self.coordinates.columns(number)] += (disc == number)[..., None, None] * block
        return np.asarray(found.reshape(*found.shape[:2], -1, self.coordinates.size))

    def _by_shift(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """As without friction: Newton's steps take what friction adds to the slopes a few more."""
        return self._by_pose(rows, disc, pair)


def _friction_by_load(parts: tuple[DiscResponse, ...]) -> FloatArray | None:
    """Friction of contacts by their loads, shape (positions, discs, pairs); None without friction."""
    return None if parts[0].friction is None else np.stack([part.rubs for part in parts], axis=1)


def _times(stiffness: FloatArray, moved: FloatArray) -> FloatArray:
    """K u of groups; see `DisplacedPins._stiffness`."""
    if stiffness.ndim == 4:
        return np.asarray(np.matmul(stiffness, moved))
    each = moved.reshape(*stiffness.shape[:-1], moved.shape[-1])
    return np.asarray(np.matmul(stiffness, each).reshape(moved.shape))


def _one_plus(flexibility: FloatArray, stiffness: FloatArray) -> FloatArray:
    """1 + S K of groups."""
    if stiffness.ndim == 4:
        found = np.matmul(flexibility, stiffness)
    else:
        first, second = flexibility[..., ::2], flexibility[..., 1::2]
        shape = (*np.broadcast_shapes(first.shape[:2], stiffness.shape[:2]), *flexibility.shape[2:])
        found = np.empty(shape)
        for way in (0, 1):
            found[..., way::2] = first * stiffness[:, :, None, :, 0, way] + second * stiffness[:, :, None, :, 1, way]
    itself = np.arange(found.shape[-1])
    found[..., itself, itself] += 1.0
    return np.asarray(found)


def _vectors_of(values: FloatArray) -> ComplexArray:
    """Components of the members of groups, shape (…, 2 members, columns), as complex numbers."""
    return np.asarray(values[..., ::2, :] + 1j * values[..., 1::2, :])


def _beams(drive: Drive) -> FloatArray:
    """Flexibility of the pins between discs, without what each disc bends alone; in slices with that and with leans."""
    discs, thickness, leans = drive.disc.number_of_discs, drive.disc.thickness, drive.contact.slices > 1

    def of(beam: PinBeam | None, pins: int) -> FloatArray:
        rows = discs * (1 + leans)
        if beam is None or (discs == 1 and not leans):
            return np.zeros((pins, rows, rows))
        found = beam.flexibility(from_start(beam, drive).tolist(), thickness, slopes=leans)
        if leans:
            lever = np.repeat([1.0, 0.5 * thickness], discs)
            found = found * lever[:, None] * lever
        else:
            found = found - np.diag(np.diag(found))
        return np.broadcast_to(found, (pins, rows, rows))

    shaft = of(shaft_pin_beam(drive), drive.number_of_holes)
    return np.concatenate((of(wheel_pin_beam(drive), drive.pin_wheel.number_of_pins), shaft))
