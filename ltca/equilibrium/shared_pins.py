r"""Pins that bend under several discs: each disc finds the pins where the forces of the others have moved them.

A pin is one beam under the forces of all discs (`ltca.laws.beam`). What a disc's own force makes the pin yield lies along the
common normal, in series with the contact, and is part of its law (`ltca.laws.backed`); what the others' forces make it yield
moves the pin against that disc, in whatever direction they press:

.. math:: u_{d} = -\sum_{d' \ne d} c_{dd'} F_{d'} e_{d'}, \qquad e = \partial \delta / \partial u .

Loads and displacements are found together at every pose, pin by pin or, where the contacts of a disc feel each other, for
all at once, by Newton's method; the tangent is that of the whole, e turning with pose and pin included.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ltca.arrays import ComplexArray, FloatArray, by_drive
from ltca.compliance.response import DiscResponse, PairSlopes
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, Coordinates
from ltca.laws.backed import from_start, shaft_pin_beam, wheel_pin_beam
from ltca.laws.beam import PinBeam

MAX_ITERATIONS = 60
SHIFT_TOLERANCE = 5e-14
"""Largest residual of a pin's displacement, mm: a few round-offs of coordinates of 100 mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SharedPins:
    """Pins that several discs bend.

    Attributes
    ----------
    flexibility : array, shape (pairs, discs, discs) or (positions, pairs, discs, discs)
        c_dd' of each pin, wheel pins before shaft pins, mm/N; zero for d = d', and for pins that do not bend.
    """

    flexibility: FloatArray = by_drive(3)

    @classmethod
    def of_drive(cls, drive: Drive) -> SharedPins | None:
        """Return the pins that the discs of a drive share; None where one disc is alone or none bends."""
        found = _flexibility(drive)
        return None if found is None else cls(flexibility=found)

    def settle(
        self,
        respond: Callable[[ComplexArray], tuple[DiscResponse, ...]],
        coordinates: Coordinates,
        shifts: ComplexArray,
    ) -> tuple[tuple[DiscResponse, ...], ComplexArray, SharedTangent]:
        """Return the contacts of all discs with the pins displaced by all forces, the displacements, and how all follow the pose.

        `respond` returns the contacts of all discs for displacements, mm, complex, shape (positions, discs, pairs). A
        ConvergenceError is raised where they do not settle.
        """
        history: list[float] = []
        parts = respond(shifts)
        system = SharedTangent(self.flexibility, parts, coordinates)
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
                system = SharedTangent(self.flexibility, parts, coordinates)
                left = system.left_over(trial)
                found = np.max(np.abs(left), axis=(1, 2), initial=0.0)
                worse = (found > size) & (found > SHIFT_TOLERANCE + 1e-11 * most)
                if not worse.any():
                    break
                fraction = np.where(worse, 0.5 * fraction, fraction)
            shifts, size = trial, found
            if len(history) > 2 and history[-1] < 1e-11 * (1.0 + most) and float(np.max(size)) >= 0.5 * history[-1]:
                return parts, shifts, system  # round-off
        raise ConvergenceError("the displacements of shared pins do not settle; largest change in mm", history)


class SharedTangent:
    """How loads on shared pins and their displacements follow each other and the pose.

    Parameters
    ----------
    flexibility : array
        Of `SharedPins`.
    parts : tuple of DiscResponse
        Contacts of each disc, with their slopes.
    coordinates : Coordinates
        Of the whole.
    """

    def __init__(self, flexibility: FloatArray, parts: tuple[DiscResponse, ...], coordinates: Coordinates) -> None:
        self.parts, self.coordinates = parts, coordinates
        self.slopes: list[PairSlopes] = [part.slopes for part in parts if part.slopes is not None]
        bends = np.any(flexibility != 0.0, axis=(-2, -1)).reshape(-1, flexibility.shape[-3]).any(axis=0)
        self.coupled = any(slopes.by_approach.ndim > 2 for slopes in self.slopes)
        self.own = np.arange(bends.size) if self.coupled else np.flatnonzero(bends)
        """Pairs that matter: pins that do not bend stand still, unless their loads follow those of others."""
        self.flexibility: FloatArray = flexibility[..., self.own, :, :]
        gradient = np.stack([self._pairs(part, "gradient")[..., DISC_PLACE] for part in parts], axis=1)
        along = np.stack([self._pairs(part, "along")[..., DISC_PLACE] for part in parts], axis=1)
        loads = [np.concatenate((part.pin_load, part.hole_load), axis=1)[:, self.own] for part in parts]
        self.load = np.stack(loads, axis=1)
        sense = np.where(self.own < parts[0].pin_load.shape[1], -1.0, 1.0)
        bending = np.stack([self._pairs(part, "bending") for part in parts], axis=1)
        # A pin moves against a disc as the disc moves the other way against it; shape (positions, pairs, discs, 2).
        self.normal = -gradient.swapaxes(1, 2)
        self.slip = -along.swapaxes(1, 2)
        # Against the pins' displacements.
        self.force = np.stack([-part.pin_forces[:, self.own] for part in parts], axis=2)
        self.bend = (self.load * sense * bending).swapaxes(1, 2)
        self.on_flank = (self.load * (sense < 0.0)).swapaxes(1, 2)
        positions, pairs, discs = self.bend.shape
        spread = np.zeros((positions, pairs, discs, 2, discs, 2))
        for disc in range(discs):
            slip = self.slip[:, :, disc]
            spread[:, :, disc, :, disc, :] = self.bend[:, :, disc, None, None] * slip[..., :, None] * slip[..., None, :]
        held = np.zeros((*np.broadcast_shapes(self.flexibility.shape[:-3], (positions,)), pairs, discs, 2, discs, 2))
        for axis in (0, 1):
            held[..., axis, :, axis] = self.flexibility
        shape = (positions, pairs, 2 * discs, 2 * discs)
        by_force: FloatArray = held.reshape(shape)
        # What a change of forces, and one of their directions, moves.
        self.yielding = np.eye(2 * discs) + np.matmul(by_force, spread.reshape(shape))
        self.held = np.linalg.solve(self.yielding, by_force)
        directions = np.zeros((positions, pairs, discs, discs, 2))
        for disc in range(discs):
            directions[:, :, disc, disc] = self.normal[:, :, disc]
        self.directions: FloatArray = directions.reshape(positions, pairs, discs, 2 * discs)
        self.along_normals = np.matmul(self.directions, np.matmul(self.held, self.directions.swapaxes(2, 3)))

    def left_over(self, shifts: ComplexArray) -> ComplexArray:
        """Return displacements less what the forces make of them, mm, shape (positions, discs, pairs)."""
        moved = np.matmul(self.flexibility.astype(complex), self.force[..., None])[..., 0]
        left = shifts.copy()
        left[..., self.own] += moved.swapaxes(1, 2)
        return left

    def step(self, left: ComplexArray) -> ComplexArray:
        """Return Newton's step of the displacements."""
        step = -left
        own = left[..., self.own]
        flat = np.stack((own.real, own.imag), axis=-1).swapaxes(1, 2)
        positions, pairs, discs, _ = flat.shape
        alone = np.linalg.solve(self.yielding, flat.reshape(positions, pairs, 2 * discs, 1))
        onto = np.matmul(self.directions, alone)[..., 0]
        change = self._loads(-self._times_slope(onto[..., None]))
        moved = -alone[..., 0] - np.matmul(self.held, np.matmul(self.directions.swapaxes(2, 3), change))[..., 0]
        moved = moved.reshape(positions, pairs, discs, 2)
        step[..., self.own] = (moved[..., 0] + 1j * moved[..., 1]).swapaxes(1, 2)
        return step

    def correction(self) -> FloatArray:
        """Return what shared pins add to the tangent of discs whose pins stand still."""
        positions, pairs, discs = self.bend.shape
        size = self.coordinates.size
        loads, turned = np.zeros((positions, pairs, discs, size)), np.zeros((positions, pairs, discs, 2, size))
        for disc, (part, slopes) in enumerate(zip(self.parts, self.slopes, strict=True)):
            own = self.coordinates.columns(disc)
            loads[:, :, disc, own] = slopes.by_pose[:, self.own]
            # F ∂²δ/∂u∂q: κ s_u s_qᵀ, on the flank with s_u e₂ᵀ as well.
            slip = self.slip[:, :, disc, :, None]
            block = self.bend[:, :, disc, None, None] * slip * self._pairs(part, "along")[:, :, None, :]
            block[..., DISC_ROTATION] -= self.on_flank[:, :, disc, None] * slip[..., 0]
            turned[:, :, disc][..., own] = block
        directions: FloatArray = turned.reshape(positions, pairs, 2 * discs, size)
        alone = np.matmul(self.held, directions)
        by_pose = self._loads(loads - self._times_slope(np.matmul(self.directions, alone)))
        moved = -alone - np.matmul(self.held, np.matmul(self.directions.swapaxes(2, 3), by_pose))
        onto = np.matmul(self.directions, moved)
        found = np.einsum("bpdi,bpdj->bij", loads, onto) + np.einsum("bpui,bpuj->bij", directions, moved)
        return np.asarray(0.5 * (found + found.swapaxes(1, 2)))

    def _times_slope(self, values: FloatArray) -> FloatArray:
        """∂F/∂δ of each disc times values, shape (positions, pairs, discs, …)."""
        found = np.empty_like(values)
        for disc, slopes in enumerate(self.slopes):
            own = values[:, :, disc]
            if not self.coupled:
                found[:, :, disc] = slopes.by_approach[:, self.own, None] * own
            else:
                found[:, :, disc] = np.matmul(slopes.by_approach, own)
        return found

    def _loads(self, right: FloatArray) -> FloatArray:
        """Loads that change by `right` with the pins held, shape (positions, pairs, discs, …), as the pins yield."""
        positions, pairs, discs, columns = right.shape
        if not self.coupled:
            slope = np.stack([slopes.by_approach[:, self.own] for slopes in self.slopes], axis=2)
            matrix = np.eye(discs) + slope[..., None] * self.along_normals
            return np.asarray(np.linalg.solve(matrix, right))
        # Shape (positions, discs, pairs, discs, pairs): the slope of disc d, then what its pins share with disc d'.
        matrix = np.empty((positions, discs, pairs, discs, pairs))
        for disc, slopes in enumerate(self.slopes):
            shared = self.along_normals[:, :, disc].swapaxes(1, 2)  # (positions, discs, pairs)
            matrix[:, disc] = (slopes.by_approach[:, :, None, :] * shared[:, None]).reshape(
                positions, pairs, discs, pairs
            )
        flat = matrix.reshape(positions, discs * pairs, discs * pairs) + np.eye(discs * pairs)
        found = np.linalg.solve(flat, right.swapaxes(1, 2).reshape(positions, discs * pairs, columns))
        return np.asarray(found.reshape(positions, discs, pairs, columns).swapaxes(1, 2))

    def _pairs(self, part: DiscResponse, name: str) -> FloatArray:
        """What the pairs that matter have on one disc, wheel pins before shaft pins."""
        found: FloatArray = np.concatenate((getattr(part.flank, name), getattr(part.holes, name)), axis=1)[:, self.own]
        return found


def _flexibility(drive: Drive) -> FloatArray | None:
    discs, thickness = drive.disc.number_of_discs, drive.disc.thickness
    wheel, shaft = wheel_pin_beam(drive), shaft_pin_beam(drive)
    if discs == 1 or (wheel is None and shaft is None):
        return None

    def of(beam: PinBeam | None, pins: int) -> FloatArray:
        if beam is None:
            return np.zeros((pins, discs, discs))
        found = beam.flexibility(from_start(beam, drive).tolist(), thickness)
        return np.broadcast_to(found - np.diag(np.diag(found)), (pins, discs, discs))

    return np.concatenate((of(wheel, drive.pin_wheel.number_of_pins), of(shaft, drive.number_of_holes)))
