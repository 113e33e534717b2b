r"""Springs on coordinates: crankshafts as beams on their bearings, and the wheel on its own (``docs/how-to/supports.md``).

With the displacements w in bearings with clearance or preload, their energy ψ (`SideLaw`) and reactions R, K of the shaft on
springs, and the parts L of forces on bearings, U is convex and smooth:

.. math:: U(u) = \min_w \tfrac12 (u - Lw)^T K (u - Lw) + \sum \psi(w), \qquad f = K (u - Lw), \quad R = L^T f .
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_beam
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pairs import ContactGeometry
from ltca.laws.bearing_pair import SideLaw
from ltca.laws.carrier import far_flange_stiffness
from ltca.laws.member_bearings import (
    crank_laws,
    crank_shares,
    crank_stiffness,
    crank_torsion,
    side_law,
    wheel_law,
    wheel_rows,
)

MAX_ITERATIONS = 80
SETTLED = 1e-13
"""Largest change of a displacement in a bearing, relative to the displacements."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingSupport:
    """A shaft, or the wheel, on bearings with clearance or preload; all arrays may have the positions in front."""

    by_pose: FloatArray = by_drive(2)  # x and y of planes, and of leans, in turn, shape (2·planes, coordinates)
    stiffness: FloatArray = by_drive(2)  # K, N/mm, shape (planes, planes)
    shares: FloatArray = by_drive(2)  # L, shape (planes, bearings)
    gap: FloatArray = by_drive(1)  # of `SideLaw`, mm, shape (bearings,)
    lift_off: FloatArray = by_drive(1)  # N
    beyond: FloatArray = by_drive(1)  # mm/N

    @classmethod
    def of_laws(
        cls, by_pose: FloatArray, stiffness: FloatArray, shares: FloatArray, laws: tuple[SideLaw, ...]
    ) -> BearingSupport:
        """Return the support with the laws of its bearings."""
        gap, lift_off, beyond = (
            np.array([getattr(law, name) for law in laws]) for name in ("gap", "lift_off", "beyond")
        )
        return cls(by_pose=by_pose, stiffness=stiffness, shares=shares, gap=gap, lift_off=lift_off, beyond=beyond)

    def respond(
        self, pose: FloatArray, beside: ComplexArray | None = None, slopes: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return generalised force and tangent, shapes (positions, coordinates) and (positions, coordinates, coordinates).

        `beside` are forces that bearings carry while the planes stand still, N, shape (positions, bearings), `slopes` their
        derivatives by the pose, x and y of every bearing in turn, shape (positions, 2·bearings, coordinates).
        """
        displaced, given, by_given = self._settle(pose, beside)
        force = self._forces(displaced, given)
        lost = _both(np.matmul(self.stiffness, self.shares))
        tangent = _both(self.stiffness) - np.matmul(lost, np.matmul(by_given, lost.swapaxes(-1, -2)))
        tangent = 0.5 * (tangent + tangent.swapaxes(-1, -2))
        found = np.matmul(tangent, self.by_pose)
        if slopes is not None:
            found = found - np.matmul(lost, np.matmul(by_given, slopes))
        back = self.by_pose.swapaxes(-1, -2)
        both = np.stack((force.real, force.imag), axis=-1).reshape(pose.shape[0], -1, 1)
        return np.matmul(back, both)[..., 0], np.matmul(back, found)

    def energy(self, pose: FloatArray, beside: ComplexArray | None = None) -> FloatArray:
        """Return the stored energy, N·mm, shape (positions,); `beside` as for `respond`."""
        displaced, given, _ = self._settle(pose, beside)
        rest = displaced - _times(self.shares, given)
        lifted = np.where(self.beyond > 0.0, np.abs(given), 0.0)
        softer = lifted * (self.lift_off + 0.5 * lifted / np.where(self.beyond > 0.0, self.beyond, 1.0))
        return np.asarray(0.5 * (rest.conj() * _times(self.stiffness, rest)).real.sum(axis=1) + softer.sum(axis=1))

    def reactions(self, pose: FloatArray, beside: ComplexArray | None = None) -> ComplexArray:
        """Return the force of each bearing on shaft or wheel, x + iy, N, shape (positions, bearings)."""
        displaced, given, _ = self._settle(pose, beside)
        carried = _times(self.shares.swapaxes(-1, -2), self._forces(displaced, given))
        return -carried if beside is None else -(carried + beside)

    def given(self, pose: FloatArray, beside: ComplexArray | None = None) -> ComplexArray:
        """Return the displacement w in each bearing, x + iy, mm, shape (positions, bearings); `beside` as for `respond`."""
        return self._settle(pose, beside)[1]

    def _forces(self, displaced: ComplexArray, given: ComplexArray) -> ComplexArray:
        return _times(self.stiffness, displaced - _times(self.shares, given))

    def _settle(self, pose: FloatArray, beside: ComplexArray | None) -> tuple[ComplexArray, ComplexArray, FloatArray]:
        """u of every plane, w of every bearing, mm, complex, and its derivative by Lᵀ K u, real and imaginary parts in turn."""
        both = np.matmul(self.by_pose, pose[..., None])[..., 0]
        displaced = both[:, ::2] + 1j * both[:, 1::2]
        lost = np.matmul(self.stiffness, self.shares)
        matrix = np.matmul(self.shares.swapaxes(-1, -2), lost)
        push = _times(lost.swapaxes(-1, -2), displaced)
        if beside is not None:
            push = push + beside
        count = push.shape[1]
        matrix = np.broadcast_to(matrix, (push.shape[0], count, count))
        own = matrix[:, np.arange(count), np.arange(count)]
        coupled = matrix - own[..., None] * np.eye(count)
        size = np.max(np.abs(displaced), axis=1, initial=0.0)[:, None]
        given = np.zeros(push.shape, dtype=complex)
        if count == 1:
            given, slope = self._given(push, own)
            return displaced, given, _blocks(slope)
        # Newton's method on piecewise smooth functions: sweeps before its steps find the pieces, and never raise the energy.
        for _ in range(MAX_ITERATIONS):
            for bearing in range(count):
                given[:, bearing] = self._given(push - _times(coupled, given), own)[0][:, bearing]
            found, slope = self._given(push - _times(coupled, given), own)
            blocks = _blocks(slope)
            left = found - given
            system = np.eye(2 * count) + np.matmul(blocks, _both(coupled))
            # A shaft that floats has no one w: the least change serves.
            solved = np.linalg.pinv(system, rcond=1e-11)
            if np.all(np.abs(left) <= SETTLED * size):
                return displaced, given, np.matmul(solved, blocks)
            step = np.matmul(solved, np.stack((left.real, left.imag), axis=-1).reshape(-1, 2 * count, 1))[..., 0]
            given = given + step[:, ::2] + 1j * step[:, 1::2]
        raise ConvergenceError(
            "the clearances of the bearings of a shaft do not settle; change in mm", [float(np.max(np.abs(left)))]
        )

    def _given(self, push: ComplexArray, own: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """w by the reactions without it and the stiffness `own` against it, and its derivative, shape (…, 2, 2)."""
        size = np.abs(push)
        ahead = np.divide(push, size, out=np.ones_like(push), where=size > 0.0)
        stiff = np.where(own > 0.0, own, 1.0)
        free = size <= stiff * self.gap
        lifted = size > self.lift_off
        softer = self.beyond / (1.0 + stiff * self.beyond)
        length = np.where(free, size / stiff, self.gap) + np.where(lifted, size - self.lift_off, 0.0) * softer
        along = np.where(free & (self.gap > 0.0), 1.0 / stiff, 0.0) + np.where(lifted, softer, 0.0)
        across = np.divide(length, size, out=along.copy(), where=size > 0.0)
        direction = np.stack((ahead.real, ahead.imag), axis=-1)
        outer = direction[..., :, None] * direction[..., None, :]
        slope = across[..., None, None] * np.eye(2) + (along - across)[..., None, None] * outer
        return np.asarray(length * ahead), np.asarray(slope)


@dataclass(frozen=True, slots=True, kw_only=True)
class Supports:
    """Springs on coordinates."""

    matrix: FloatArray = by_drive(2)  # stiffness of linear ones, N/mm
    bearings: tuple[BearingSupport, ...] = ()  # with clearance or preload, cranks first
    cranks: int = 0  # that stand on such bearings

    @classmethod
    def of_drive(cls, drive: Drive, geometry: ContactGeometry) -> Supports | None:
        """Return the supports of a drive, None where nothing yields; `geometry` is that of one disc."""
        coordinates = Coordinates.of_drive(drive)
        shaft, wheel, laws = crank_stiffness(drive), wheel_law(drive), crank_laws(drive)
        if shaft is None and wheel is None and not coordinates.ring:
            return None
        matrix, bearings = np.zeros((coordinates.size, coordinates.size)), []
        flange = far_flange_stiffness(drive)
        for crank in range(0 if shaft is None else coordinates.cranks):
            by_pose = _bent_by_pose(drive, geometry, crank)
            if laws is None:
                matrix += by_pose.T @ _both(np.asarray(shaft)) @ by_pose
            else:
                bearings.append(BearingSupport.of_laws(by_pose, np.asarray(shaft), crank_shares(drive), laws))
        if (twisted := crank_torsion(drive)) is not None:
            for twist in coordinates.twist_places:
                turns = coordinates.own * np.arange(coordinates.discs) + twist
                matrix[np.ix_(turns, turns)] += twisted
        of_wheel = np.eye(coordinates.size)[coordinates.wheel_place]
        of_lean = np.eye(coordinates.size)[coordinates.wheel_lean_place]
        rows = wheel_rows(drive)
        held: list[tuple[FloatArray, SideLaw | float]] = []
        if drive.wheel_tilts and rows:  # each at its pressure centre
            held = [(of_wheel + row.pressure_centre * of_lean, side_law(drive, [row])) for row in rows]
        elif wheel is not None:
            held = [(of_wheel, wheel)]
        for at, law in held:
            if isinstance(law, SideLaw):
                bearings.append(BearingSupport.of_laws(at, np.array([[law.stiffness]]), np.ones((1, 1)), (law,)))
            else:
                matrix += law * at.T @ at
        if drive.wheel_tilts and not rows and drive.main_bearing is not None:
            matrix += (drive.main_bearing.tilt_stiffness or 0.0) * of_lean.T @ of_lean
        if flange is not None:
            matrix[coordinates.ring_place, coordinates.ring_place] += flange
        if geometry.tips_by_ring.size and coordinates.ring:
            matrix[coordinates.ring_place, coordinates.ring_place] += _ring_stiffness(drive, geometry)
        cranks = 0 if shaft is None or laws is None else coordinates.cranks
        return cls(matrix=matrix, bearings=tuple(bearings), cranks=cranks)

    def respond(
        self, pose: FloatArray, beside: ComplexArray | None = None, slopes: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Return generalised force and tangent; arguments as for `BearingSupport.respond`, of every crank on axis 1."""
        force, tangent = np.matmul(self.matrix, pose[..., None])[..., 0], self.matrix
        for support, carried, changes in self._each(beside, slopes):
            pushed, stiff = support.respond(pose, carried, changes)
            force, tangent = force + pushed, tangent + stiff
        return force, tangent

    def _each(
        self, beside: ComplexArray | None, slopes: FloatArray | None = None
    ) -> Iterator[tuple[BearingSupport, Any, Any]]:
        """Bearings with the forces beside the discs of those of cranks."""
        for number, support in enumerate(self.bearings):
            carried, changes = (
                None if each is None or number >= self.cranks else each[:, number] for each in (beside, slopes)
            )
            yield support, carried, changes

    def given(self, pose: FloatArray, beside: ComplexArray) -> ComplexArray | None:
        """Return displacements in the two bearings of every crank, x + iy, mm, shape (positions, cranks, 2); None for springs."""
        if not self.cranks:
            return None
        each = [support.given(pose, carried) for support, carried, _ in self._each(beside)]
        return np.stack(each[: self.cranks], axis=1)

    def energy(self, pose: FloatArray, beside: ComplexArray | None = None) -> FloatArray:
        """Return the energy stored at poses, N·mm, shape (positions,); `beside` as for `respond`."""
        total: FloatArray = 0.5 * (pose * np.matmul(self.matrix, pose[..., None])[..., 0]).sum(axis=1)
        return sum((support.energy(pose, carried) for support, carried, _ in self._each(beside)), total)


def _bent_by_pose(drive: Drive, geometry: ContactGeometry, crank: int) -> FloatArray:
    """`BearingSupport.by_pose` of a crank, relative to the straight line between its bearings."""
    coordinates = Coordinates.of_drive(drive)
    places = coordinates.journals(crank)
    found = np.zeros((places.size, 2, coordinates.size))
    for direction in (0, 1):
        found[np.arange(places.size), direction, places + direction] = 1.0
    if drive.carrier is not None and drive.carrier.posts is not None:
        far, seat = crank_shares(drive)[:, 1, None], geometry.seats_by_ring[..., crank, :]
        found[:, 0, coordinates.ring_place] -= far * seat.real
        found[:, 1, coordinates.ring_place] -= far * seat.imag
    return found.reshape(2 * places.size, coordinates.size)


def _ring_stiffness(drive: Drive, geometry: ContactGeometry) -> FloatArray:
    """Stiffness against x, y and rotation of the ring, Σ k vᵀ v over the tips that it moves by v, shape (3, 3)."""
    beam = shaft_pin_beam(drive)
    assert beam is not None
    tips = geometry.tips_by_ring
    return np.asarray(beam.tip_stiffness * (tips.conjugate().T @ tips).real)


def _times(matrix: FloatArray, values: ComplexArray) -> ComplexArray:
    """A real matrix, of one drive or by position, times complex columns of every position."""
    return np.asarray(
        np.matmul(matrix, values.real[..., None])[..., 0] + 1j * np.matmul(matrix, values.imag[..., None])[..., 0]
    )


def _both(matrix: FloatArray) -> FloatArray:
    """A matrix of planes as one of x and y of every plane in turn."""
    rows, columns = matrix.shape[-2:]
    found = np.zeros((*matrix.shape[:-2], rows, 2, columns, 2))
    found[..., 0, :, 0] = found[..., 1, :, 1] = matrix
    return found.reshape(*matrix.shape[:-2], 2 * rows, 2 * columns)


def _blocks(slope: FloatArray) -> FloatArray:
    """Blocks (positions, bearings, 2, 2) as block diagonal matrices."""
    positions, count = slope.shape[:2]
    found = np.zeros((positions, count, 2, count, 2))
    for bearing in range(count):
        found[:, bearing, :, bearing] = slope[:, bearing]
    return found.reshape(positions, 2 * count, 2 * count)
