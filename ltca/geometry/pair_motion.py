"""Approaches of pairs at a pose, positive where pressed, and their derivatives by the pose; arrays (positions, pairs, …)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.geometry.coordinates import DISC_PLACE, DISC_ROTATION, WHEEL_ANGLE, Coordinates

Turns: TypeAlias = dict[int, ComplexArray]
"""How leans that stand on a body follow the pose, by the place of a coordinate in it."""


def dot(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Return the scalar product of vectors of the plane."""
    return first.real * second.real + first.imag * second.imag


def cross(first: ComplexArray, second: ComplexArray) -> FloatArray:
    """Return their vector product."""
    return first.real * second.imag - first.imag * second.real


@dataclass(frozen=True, slots=True, kw_only=True)
class PairMotion:
    """Approach δ of pairs of one kind, mm, with first and second derivatives by the pose, which have few terms (`bend`)."""

    approach: FloatArray  # δ, mm, shape (positions, pairs)
    gradient: FloatArray  # ∂δ/∂q, mm/mm and mm/rad, shape (positions, pairs, coordinates)
    along: FloatArray  # s, the slip of the contact along its tangent, alike
    bending: FloatArray  # κ of the path of equal approach, 1/mm

    def bend(self, load: FloatArray) -> FloatArray:
        """Return Σ F ∂²δ/∂q² of loads F, N, shape (positions, coordinates, coordinates); holes have κ s sᵀ + s₂ e₂e₂ᵀ."""
        total = np.matmul(self.along.swapaxes(-1, -2), (load * self.bending)[..., None] * self.along)
        total[..., DISC_ROTATION, DISC_ROTATION] += (load * self.along[..., DISC_ROTATION]).sum(axis=-1)
        return np.asarray(total)

    def leaning(self, lean: ComplexArray, turns: Turns, coordinates: Coordinates) -> PairTilt:
        """Return the tilt of pairs from the lean of the disc at each less that of the other part, rad, (positions, pairs)."""
        normal = self.gradient[..., 0] + 1j * self.gradient[..., 1]
        across = dot(self.along[..., 0] + 1j * self.along[..., 1], lean)
        gradient = self._bent_by(across)
        for leans, sign in self._leans(coordinates):
            gradient[..., leans] += sign * self.gradient[..., DISC_PLACE]
        for place, turn in turns.items():
            gradient[..., place] += dot(normal, turn)
        return PairTilt(tilt=dot(normal, lean), gradient=gradient)

    def _bent_by(self, across: FloatArray) -> FloatArray:
        """Σ λ_a ∂²δ/∂a∂q over a = x, y, from Σ λ_a s_a: pins in holes."""
        return (across * self.bending)[..., None] * self.along

    def bend_leans(self, moment: FloatArray, turns: Turns, coordinates: Coordinates) -> FloatArray:
        """Return Σ M ∂²θ/∂q² of moments M, N·mm, without third derivatives of δ, which are of the order of the lean."""
        total = np.zeros((moment.shape[0], coordinates.size, coordinates.size))
        for place in (0, 1):
            row = (moment[..., None] * self._bent_by(self.along[..., place])).sum(axis=1)
            for leans, sign in self._leans(coordinates):
                total[:, leans.start + place] += sign * row
                total[:, :, leans.start + place] += sign * row
        for turning, turn in turns.items():
            across = dot(self.along[..., 0] + 1j * self.along[..., 1], turn)
            row = (moment[..., None] * self._bent_by(across)).sum(axis=1)
            total[:, turning] += row
            total[:, :, turning] += row
        return total

    @staticmethod
    def _leans(coordinates: Coordinates) -> tuple[tuple[slice, float], ...]:
        """Places of the leans among the coordinates that pairs tilt by, and their signs."""
        return ((coordinates.lean_place, 1.0),)


@dataclass(frozen=True, slots=True, kw_only=True)
class PairTilt:
    """Tilt θ of pairs, rad, shape (positions, pairs), and ∂θ/∂q: the approach at a height z about the middle is δ + θ z."""

    tilt: FloatArray
    gradient: FloatArray

    def at(
        self, gap: FloatArray, slope: FloatArray, height: FloatArray, drop: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return gaps at heights where bodies fall short by `drop`, mm, and their derivatives, from those of the middles."""
        return gap - self.tilt * height + drop, slope - self.gradient * height[..., None]

    def deepest(self, height: FloatArray, drop: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the height, of some of shape (positions, heights), at which each pair is pressed most, and the drop there."""
        first = np.argmax(self.tilt[..., None] * height[:, None] - drop[:, None], axis=-1)
        return np.take_along_axis(height, first, axis=1), np.take_along_axis(drop, first, axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankMotion(PairMotion):
    """Pairs of wheel pin and flank, shape (positions, z_P)."""

    parameter: FloatArray  # θ of the contact on the flank, rad
    effective_radius: FloatArray  # ρ of pin and flank, mm
    point: ComplexArray  # centre of the pin in the frame of the disc, mm
    turning: ComplexArray  # change of θ as that centre moves, ∂θ/∂x + i ∂θ/∂y, rad/mm

    def _bent_by(self, across: FloatArray) -> FloatArray:
        """As for holes, of pins on the flank."""
        found = -(across * self.bending)[..., None] * self.along
        found[..., DISC_ROTATION] -= across
        return found

    @staticmethod
    def _leans(coordinates: Coordinates) -> tuple[tuple[slice, float], ...]:
        """As for holes; pins on the flank lean with the wheel."""
        of_disc = (coordinates.lean_place, 1.0)
        return (of_disc, (coordinates.wheel_lean_place, -1.0)) if coordinates.wheel_leans else (of_disc,)

    def bend(self, load: FloatArray) -> FloatArray:
        """Return Σ F ∂²δ/∂q² of pins on the flank, −(κ s sᵀ + e₂ sᵀ + s e₂ᵀ − s₂ e₂e₂ᵀ − s_W e_W e_Wᵀ), W the wheel angle."""
        total = np.matmul(self.along.swapaxes(-1, -2), (load * self.bending)[..., None] * self.along)
        slip = np.matmul(load[..., None, :], self.along)[..., 0, :]
        total[..., DISC_ROTATION, :] += slip
        total[..., :, DISC_ROTATION] += slip
        for turn in (DISC_ROTATION, WHEEL_ANGLE):
            total[..., turn, turn] -= slip[..., turn]
        return np.asarray(-total)


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownPins:
    """Centres and turning of wheel pins at some pose (`FlankMotion`), from which contact parameters at others are guessed."""

    point: ComplexArray
    turning: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class BoreMotion:
    """Bores of the disc against the centres of the inner races in them, in the fixed frame, shape (positions, cranks)."""

    displacement: ComplexArray  # bore centre from inner-race centre, mm
    arm: ComplexArray  # bore centre from disc centre, mm: minus the second derivative of `displacement` by the rotation
    gradient: ComplexArray  # ∂ displacement/∂q, mm/mm and mm/rad, shape (positions, cranks, coordinates)
    lever: ComplexArray  # race centre from its twisted crank's axis, mm: the second derivative by the twist
    twists: tuple[int, ...] = ()  # places of the twist of every crank in the pose

    def each(self, values: ComplexArray, rollers: int) -> ComplexArray:
        """Return values of the bores, shape (positions, cranks, …), as those of all their rollers, (positions, rollers, …)."""
        return values if values.shape[1] == 1 else np.repeat(values, rollers // values.shape[1], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerRays:
    """Rollers on their cage rays about the inner-race centres, crank after crank."""

    direction: ComplexArray  # unit vector n of each ray in the fixed frame, shape (positions, rollers)
    outermost: FloatArray  # distance s from the race centre of a roller that rests on the race, mm
    bore_play: FloatArray  # bore radius less roller radius, mm

    def touching(self, displaced: ComplexArray) -> FloatArray:
        """Return the distance s at which each roller just touches a bore `displaced` along and across its ray, mm."""
        # A disc displaced sideways by more than the bore play does not meet the ray: the nearest point instead.
        return np.asarray(displaced.real + np.sqrt(np.maximum(self.bore_play**2 - displaced.imag**2, 0.0)))

    def resting(self, bores: BoreMotion) -> ComplexArray:
        """Return rollers that rest on the race from the bore centres, s n − d, mm: they overlap by its size less the play."""
        return self.outermost * self.direction - bores.each(bores.displacement, self.direction.shape[1])
