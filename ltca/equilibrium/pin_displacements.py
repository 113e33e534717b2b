r"""Pins displaced by the parts that hold them: beams under several discs, and the ring of the pin wheel under all its pins.

What the forces on pins displace is :math:`u = -S f`, with one symmetric flexibility S and the forces :math:`f = F e` of the
discs against the displacements, :math:`e = \partial \delta / \partial u`. S is a sum: a pin is one beam under the forces of all
discs (`ltca.laws.beam`), and the ring moves every pin by the forces on all of them, summed over the discs
(`ltca.compliance.ring`). Displacements of wheel pins are those in the turning wheel, so S does not turn.
What a disc's own force makes a beam yield lies along the common normal, in series with the contact, and is part of its law
(`ltca.laws.backed`).

Gaps are those of the displaced pins, with no normal linearised: loads and displacements are found together at every pose by
Newton's method, pin by pin where neither the ring nor the body of a disc couples them, for all that carry at once elsewhere.
With :math:`K = \partial f/\partial u` and :math:`H = \partial f/\partial q` the tangent of the whole is that of pins at rest
less :math:`H^T (1 + S K)^{-1} S H`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.compliance.response import DiscResponse, PairSlopes
from ltca.compliance.ring import ring_flexibility
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE, Coordinates
from ltca.laws.backed import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.laws.beam import PinBeam

MAX_ITERATIONS = 60
SHIFT_TOLERANCE = 5e-14
"""Largest residual of a pin's displacement, mm: a few round-offs of coordinates of 100 mm."""
ENTRIES_AT_ONCE = 2_000_000
"""Entries of the matrices solved at once, 16 MB each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PinDisplacements:
    """What displaces pins.

    Attributes
    ----------
    beams : array, shape (pairs, discs, discs) or (positions, pairs, discs, discs)
        Deflection of each pin at disc d under a unit force of disc d', wheel pins before shaft pins, mm/N; zero for d = d', and
        for pins that do not bend.
    ring : array, shape (z_P, 2, z_P, 2) or (positions, z_P, 2, z_P, 2), or None
        Displacement (x, y) of the seats of the wheel pins in the wheel under unit forces at the seats, mm/N.
    """

    beams: FloatArray = by_drive(3)
    ring: FloatArray | None = by_drive(4, default=None)

    @classmethod
    def of_drive(cls, drive: Drive) -> PinDisplacements | None:
        """Return what displaces the pins of a drive; None where they stand still but for what each disc alone bends."""
        beams, ring = _beams(drive), ring_flexibility(drive)
        if ring is None and not beams.any():
            return None
        return cls(beams=beams, ring=ring)

    def under(self, force: ComplexArray) -> ComplexArray:
        """Return S f, mm, for forces on the pins by disc, N, shape (positions, discs, pairs)."""
        found: ComplexArray = np.matmul(self.beams.astype(complex), force.swapaxes(1, 2)[..., None])[..., 0].swapaxes(
            1, 2
        )
        if self.ring is not None:
            found[:, :, : self.ring.shape[-2]] += self.of_ring(force)[:, None]
        return found

    def of_ring(self, force: ComplexArray) -> ComplexArray:
        """Return the part of the ring in S f, the same for all discs, shape (positions, z_P)."""
        if self.ring is None:
            return np.zeros((force.shape[0], 0), dtype=complex)
        seats = self.ring.shape[-2]
        total = force[:, :, :seats].sum(axis=1)
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
    ) -> tuple[tuple[DiscResponse, ...], ComplexArray, DisplacedPins]:
        """Return the contacts of all discs with the pins displaced by all forces, the displacements, and how all follow the pose.

        `respond` returns the contacts of all discs for displacements, mm, complex, shape (positions, discs, pairs); `turned` is
        the direction in which the wheel stands, shape (positions,). A ConvergenceError is raised where they do not settle.
        """
        history: list[float] = []
        parts = respond(shifts)
        system = DisplacedPins(self, parts, coordinates, turned)
        left = system.left_over(shifts)
        size = np.max(np.abs(left), axis=(1, 2), initial=0.0)
        for _ in range(MAX_ITERATIONS):
            history.append(float(np.max(size, initial=0.0)))
            most = float(np.max(np.abs(shifts), initial=0.0))
            if history[-1] <= SHIFT_TOLERANCE + 1e-13 * most:
                return parts, shifts, system
            step, fraction = system.step(left), np.ones(size.shape)
            for _ in range(10):
                trial = shifts + fraction[:, None, None] * step
                parts = respond(trial)
                system = DisplacedPins(self, parts, coordinates, turned)
                left = system.left_over(trial)
                found = np.max(np.abs(left), axis=(1, 2), initial=0.0)
                worse = (found > size) & (found > SHIFT_TOLERANCE + 1e-11 * most)
                if not worse.any():
                    break
                fraction = np.where(worse, 0.5 * fraction, fraction)
            shifts, size = trial, found
            if len(history) > 2 and history[-1] < 1e-11 * (1.0 + most) and float(np.max(size)) >= 0.5 * history[-1]:
                return parts, shifts, system  # round-off
        raise ConvergenceError("the displacements of the pins do not settle; largest change in mm", history)


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
    """

    def __init__(
        self, held: PinDisplacements, parts: tuple[DiscResponse, ...], coordinates: Coordinates, turned: ComplexArray
    ) -> None:
        self.held, self.parts, self.coordinates = held, parts, coordinates
        self.slopes: list[PairSlopes] = [part.slopes for part in parts if part.slopes is not None]
        self.coupled = held.ring is not None or any(slopes.by_approach.ndim > 2 for slopes in self.slopes)
        wheel, pairs = parts[0].pin_load.shape[1], parts[0].pin_forces.shape[1]
        self.moves = np.any(held.beams != 0.0, axis=(-2, -1)).reshape(-1, pairs).any(axis=0)
        self.moves |= (held.ring is not None) & (np.arange(pairs) < wheel)
        self.frame = np.where(np.arange(pairs) < wheel, turned.conjugate()[:, None], 1.0)
        """What turns directions into those of the part that holds the pin, shape (positions, pairs)."""
        # Against the pins' displacements.
        self.force = np.stack([-part.pin_forces * self.frame for part in parts], axis=1)

    def left_over(self, shifts: ComplexArray) -> ComplexArray:
        """Return displacements less what the forces make of them, mm, shape (positions, discs, pairs)."""
        return shifts + self.held.under(self.force)

    def step(self, left: ComplexArray) -> ComplexArray:
        """Return Newton's step of the displacements."""
        change = np.zeros_like(left)
        for rows, disc, pair in self._groups():
            stiffness, flexibility = self._stiffness(rows, disc, pair), self._flexibility(rows, disc, pair)
            given = left[rows, disc, pair]
            flat = np.stack((given.real, given.imag), axis=-1).reshape(*given.shape[:2], -1, 1)
            moved = np.linalg.solve(np.eye(flat.shape[2]) + np.matmul(flexibility, stiffness), -flat)
            force = np.matmul(stiffness, moved).reshape(*given.shape, 2)
            change[rows, disc, pair] = force[..., 0] + 1j * force[..., 1]
        return -left - self.held.under(change)

    def correction(self) -> FloatArray:
        """Return what displaced pins add to the tangent of discs whose pins stand still."""
        size = self.coordinates.size
        found = np.zeros((self.force.shape[0], size, size))
        for rows, disc, pair in self._groups():
            stiffness, flexibility = self._stiffness(rows, disc, pair), self._flexibility(rows, disc, pair)
            by_pose = self._by_pose(rows, disc, pair)
            matrix = np.eye(stiffness.shape[-1]) + np.matmul(flexibility, stiffness)
            moved = np.linalg.solve(matrix, np.matmul(flexibility, by_pose))
            found[rows[:, 0, 0]] -= np.matmul(by_pose.swapaxes(2, 3), moved).sum(axis=1)
        return 0.5 * (found + found.swapaxes(1, 2))

    def _groups(self) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]]:
        """Positions, discs and pairs of what is solved together, shape (positions, groups, members) when broadcast.

        A group is a pin under all discs where nothing else couples pins, or everything that carries and can move.
        """
        positions, discs, pairs = self.force.shape
        own = np.flatnonzero(self.moves)
        if not self.coupled:
            disc, pair = np.arange(discs)[None, None, :], own[None, :, None]
            at_once = max(1, ENTRIES_AT_ONCE // max(1, own.size * (2 * discs) ** 2))
        else:
            # A contact that carries nothing has no stiffness. Most rows have a few idle ones for the sake of the fullest.
            load = np.stack([np.concatenate((part.pin_load, part.hole_load), axis=1) for part in self.parts], axis=1)
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
        along = beams[places] * (one == other)
        found = along[..., :, None, :, None] * np.eye(2)[:, None, :]
        if ring is not None:
            seats = ring.shape[-2]
            both = (one < seats) & (other < seats)
            seat, by = np.where(both, one, 0), np.where(both, other, 0)
            held = ring[seat, :, by] if ring.ndim == 4 else ring[rows[..., None], seat, :, by]
            found = found + (held * both[..., None, None]).swapaxes(-3, -2)
        count = 2 * found.shape[-2]
        return np.asarray(found.reshape(*found.shape[:-4], count, count))

    def _stiffness(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """K among the members of groups: that of the contacts along their normals, and loads that turn with them."""
        normal, slip = self._vectors(rows, disc, pair, "gradient"), self._vectors(rows, disc, pair, "along")
        members = normal.shape[2]
        itself = np.arange(members)
        if self.slopes[0].by_approach.ndim == 2:
            by_approach = np.stack([slopes.by_approach for slopes in self.slopes], axis=1)[rows, disc, pair]
            found = np.zeros((*normal.shape[:2], members, 2, members, 2))
            found[:, :, itself, :, itself, :] = np.moveaxis(
                by_approach[..., None, None] * normal[..., :, None] * normal[..., None, :], 2, 0
            )
        else:
            every = np.stack([slopes.by_approach for slopes in self.slopes], axis=1)
            same = disc[..., :, None] == disc[..., None, :]
            slope = every[rows[..., None], disc[..., :, None], pair[..., :, None], pair[..., None, :]] * same
            found = normal[..., :, :, None, None] * slope[..., :, None, :, None] * normal[..., None, None, :, :]
        bend = self._bend(rows, disc, pair)
        found[:, :, itself, :, itself, :] += np.moveaxis(
            bend[..., None, None] * slip[..., :, None] * slip[..., None, :], 2, 0
        )
        return np.asarray(found.reshape(*found.shape[:2], 2 * members, 2 * members))

    def _by_pose(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp]) -> FloatArray:
        """H of the members of groups, shape (positions, groups, 2 members, coordinates)."""
        normal, slip = self._vectors(rows, disc, pair, "gradient"), self._vectors(rows, disc, pair, "along")
        bend, on_flank = self._bend(rows, disc, pair), self._load(rows, disc, pair) * self._on_flank(pair)
        found = np.zeros((*normal.shape, self.coordinates.size))
        for number, (part, slopes) in enumerate(zip(self.parts, self.slopes, strict=True)):
            mine = (disc == number)[..., None, None]
            loads = slopes.by_pose[rows, pair]
            # F ∂²δ/∂u∂q: κ s_u s_qᵀ, on the flank with s_u e₂ᵀ − s_u e_Wᵀ as well.
            every = np.concatenate((part.flank.along, part.holes.along), axis=1)[rows, pair]
            block = bend[..., None, None] * slip[..., :, None] * every[..., None, :]
            block[..., DISC_ROTATION] -= on_flank[..., None] * slip
            block[..., WHEEL_ANGLE] += on_flank[..., None] * slip
            block += normal[..., :, None] * loads[..., None, :]
            found[..., self.coordinates.columns(number)] += mine * block
        return np.asarray(found.reshape(*found.shape[:2], -1, self.coordinates.size))

    def _vectors(self, rows: NDArray[np.intp], disc: NDArray[np.intp], pair: NDArray[np.intp], name: str) -> FloatArray:
        """Normals (`gradient`) or tangents (`along`) against displacements of the pins, shape (positions, groups, members, 2).

        A pin moves against a disc as the disc moves the other way against it.
        """
        each = [
            np.concatenate((getattr(p.flank, name), getattr(p.holes, name)), axis=1)[..., DISC_PLACE]
            for p in self.parts
        ]
        every = np.stack(each, axis=1)
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
        bending = [np.concatenate((part.flank.bending, part.holes.bending), axis=1) for part in self.parts]
        turning = np.stack(bending, axis=1)[rows, disc, pair] * self._load(rows, disc, pair)
        return np.asarray(turning * np.where(self._on_flank(pair), -1.0, 1.0))


def _beams(drive: Drive) -> FloatArray:
    """Flexibility of the pins between discs, without what each disc bends alone."""
    discs, thickness = drive.disc.number_of_discs, drive.disc.thickness

    def of(beam: PinBeam | None, pins: int) -> FloatArray:
        if beam is None or discs == 1:
            return np.zeros((pins, discs, discs))
        found = beam.flexibility(from_start(beam, drive).tolist(), thickness)
        return np.broadcast_to(found - np.diag(np.diag(found)), (pins, discs, discs))

    shaft = of(shaft_pin_beam(drive), drive.number_of_holes)
    return np.concatenate((of(wheel_pin_beam(drive), drive.pin_wheel.number_of_pins), shaft))
