"""Kinetic energy of a drive in motion, and its inertia forces (``docs/theory/motion.md``)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray
from ltca.dynamics.kinetics import Body, Motion, moving_bodies
from ltca.dynamics.masses import DISCS, DriveMasses
from ltca.geometry.coordinates import DISC_ROTATION

QUARTERS = 0.0, 0.5 * np.pi, np.pi
"""Crank angles whose rows tell a mean, a cosine and a sine part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaningSpin:
    """A body that spins about its own axis while this leans, T_g = −½ J (ν ẋ) [(f ẋ) |l|² + l × l̇]."""

    inertia: float  # J, t·mm²
    turns: FloatArray  # row ν
    lean: int  # place of the first of the two coordinates of l

    def add(self, frame: FloatArray, x: FloatArray, rate: FloatArray, matrix: FloatArray, bias: FloatArray) -> None:
        """Add its part of the mass matrix and of the inertia forces besides M ẍ, in place (`KineticEnergy.at`)."""
        own = slice(self.lean, self.lean + 2)
        lean, leaning = x[own], rate[own]
        across = np.zeros_like(frame)
        across[own] = -lean[1], lean[0]  # l × l̇ by the rates
        row = (lean @ lean) * frame + across
        matrix -= 0.5 * self.inertia * (np.outer(self.turns, row) + np.outer(row, self.turns))
        spin, turn = float(self.turns @ rate), float(frame @ rate)
        bias -= self.inertia * (lean @ leaning) * (turn * self.turns + spin * frame)
        bias[own] += self.inertia * spin * (np.array([leaning[1], -leaning[0]]) + turn * lean)


@dataclass(frozen=True, slots=True, kw_only=True)
class KineticEnergy:
    """Kinetic energy of a drive; matrices are mean, cosine and sine part over the crank angle, shape (3, n, n)."""

    crank: int  # place of the crank angle
    frame: FloatArray  # row f of the rotation of the frame
    mass: FloatArray  # of bodies where they nominally stand
    turned: FloatArray  # G = Σ m Re(rᴴ i D)
    displaced: FloatArray  # H = Σ m Re(Dᴴ D)
    spins: tuple[LeaningSpin, ...] = ()

    @classmethod
    def of_drive(cls, motion: Motion, masses: DriveMasses) -> KineticEnergy:
        """Return the kinetic energy of all bodies of a drive whose densities are known."""
        spins, frame = list[LeaningSpin](), motion.frame_turns
        for number, disc in enumerate(masses.of(DISCS) if motion.pose.leans else ()):
            own = motion.pose.columns(number)
            turns, lean = frame + motion.unit(int(own[DISC_ROTATION])), int(own[motion.pose.lean_place][0])
            spins.append(LeaningSpin(inertia=disc.about_own_axis, turns=turns, lean=lean))
        bodies = [moving_bodies(motion, masses, angle) for angle in QUARTERS]
        # The angle of the wheel, behind all others of the pose, turns the frame, and displaces nothing in it.
        displaces = np.where(np.arange(motion.size) < motion.wheel_angle, 1.0, 0.0)
        return cls.of_bodies(bodies, crank=motion.crank, frame=frame, displaces=displaces, spins=tuple(spins))

    @classmethod
    def of_bodies(
        cls,
        at_quarters: Sequence[Sequence[Body]],
        *,
        crank: int,
        frame: FloatArray,
        displaces: FloatArray,
        spins: tuple[LeaningSpin, ...] = (),
    ) -> KineticEnergy:
        """Return the kinetic energy by rows of bodies at `QUARTERS`; `displaces` is 1 at coordinates that displace them."""
        each = []
        for bodies in at_quarters:
            size, row = np.array([[body.size] for body in bodies]), np.array([body.row for body in bodies])
            # What the turning frame adds by rad, i D.
            added = displaces * np.array([0.0 * body.row if body.turns else body.carried for body in bodies])
            products = row.conj().T @ (size * row), row.conj().T @ (size * added), added.conj().T @ (size * added)
            each.append(np.real(products))
        mean, even = 0.5 * (each[0] + each[2]), 0.5 * (each[0] - each[2])
        mass, turned, displaced = np.stack((mean, even, each[1] - mean), axis=1)
        return cls(crank=crank, frame=frame, mass=mass, turned=turned, displaced=displaced, spins=spins)

    def at(self, x: FloatArray, rate: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the mass matrix and the inertia forces besides M ẍ, shapes (n, n) and (n,)."""
        cosine, sine = np.cos(x[self.crank]), np.sin(x[self.crank])

        def over(parts: FloatArray) -> tuple[FloatArray, FloatArray]:
            """Value and derivative at the crank angle."""
            mean, even, odd = parts
            return mean + cosine * even + sine * odd, cosine * odd - sine * even

        f, turn, bias = self.frame, self.frame @ rate, np.zeros(x.size)
        matrix, slope = over(self.mass)
        if f.any():  # the frame turns
            (g, g_slope), (h, h_slope) = over(self.turned), over(self.displaced)
            along = g @ rate
            matrix = matrix + _framed(f, g @ x, float(x @ h @ x))
            slope = slope + _framed(f, g_slope @ x, float(x @ h_slope @ x))
            bias = f * (rate @ along + 2.0 * turn * (x @ h @ rate)) + turn * (along - g.T @ rate) - turn**2 * (h @ x)
        pushed = slope @ rate
        bias += rate[self.crank] * pushed
        bias[self.crank] -= 0.5 * (rate @ pushed)
        for spin in self.spins:
            spin.add(f, x, rate, matrix, bias)
        return matrix, bias

    def energy(self, x: FloatArray, rate: FloatArray) -> float:
        """Return the kinetic energy, N·mm; arguments as for `at`."""
        return 0.5 * float(rate @ self.at(x, rate)[0] @ rate)


def _framed(frame: FloatArray, along: FloatArray, square: float) -> FloatArray:
    crossed = np.outer(frame, along)
    return np.asarray(crossed + crossed.T + square * np.outer(frame, frame))
