r"""Kinetic energy of a drive in motion over the coordinates of `ltca.dynamics.kinetics.Motion`, and its inertia forces.

Every body has the velocity :math:`z = r(\varphi)\dot x + i\,(f\dot x)\,D(\varphi)x`: what its row gives at the place where it
nominally stands, and what the turning frame of a held wheel adds because the pose displaces it there. Rows are
:math:`a + c\,e^{i\varphi}`, since eccentrics go round and nothing else does. Lagrange's equations of
:math:`T = \tfrac12 \dot x^T M(x) \dot x` have all its terms, centrifugal and Coriolis ones included, so that the energy of a
motion closes:

.. math:: \frac{d}{dt}\frac{\partial T}{\partial\dot x} - \frac{\partial T}{\partial x}
   = M\ddot x + \dot M\dot x - \frac{\partial T}{\partial x} .

A disc that leans by l in a frame which turns brings its transverse moments of inertia and, because it spins at
:math:`\nu\dot x` about its leaning axis, a gyroscopic moment: to second order in l, J being that about its own axis,

.. math:: T_g = -\tfrac12 J\,(\nu\dot x)\left[(f\dot x)\,|l|^2 + l \times \dot l\right] .
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.dynamics.kinetics import Body, Motion, moving_bodies
from ltca.dynamics.masses import DriveMasses


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaningSpin:
    """A body that spins about an axis which leans.

    Attributes
    ----------
    inertia : float
        J about its own axis, t·mm².
    turns : array, shape (n,)
        ν, row of its rotation.
    lean : int
        Place of the first of the two coordinates of its lean.
    """

    inertia: float
    turns: FloatArray
    lean: int

    def add(self, frame: FloatArray, x: FloatArray, rate: FloatArray, matrix: FloatArray, bias: FloatArray) -> None:
        """Add its part of the mass matrix and of the inertia forces besides M ẍ, in place; arguments as for `KineticEnergy.at`,
        `frame` the row of the rotation of the frame.
        """
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
    """Kinetic energy of a drive.

    Attributes
    ----------
    crank : int
        Place of the crank angle.
    frame : array, shape (n,)
        f, row of the rotation of the frame of the pin shaft; zeros where it stands.
    mass : array, shape (3, n, n)
        Mass matrix of bodies where they nominally stand: its mean, cosine and sine part over the crank angle.
    turned : array, shape (3, n, n)
        G = Σ m Re(rᴴ i D), likewise.
    displaced : array, shape (3, n, n)
        H = Σ m Re(Dᴴ D), likewise.
    spins : tuple of LeaningSpin
        Discs that lean.
    """

    crank: int
    frame: FloatArray
    mass: FloatArray
    turned: FloatArray
    displaced: FloatArray
    spins: tuple[LeaningSpin, ...] = ()

    @classmethod
    def of_drive(cls, motion: Motion, masses: DriveMasses) -> KineticEnergy:
        """Return the kinetic energy of all bodies of a drive whose densities are known."""
        ends = [moving_bodies(motion, masses, angle) for angle in (0.0, np.pi)]
        found = cls.of_bodies(*ends, crank=motion.crank, frame=motion.frame_turns, displaces=_displaced_columns(motion))
        return replace(found, spins=_spins(motion, ends[0]))

    @classmethod
    def of_bodies(
        cls, at_zero: Sequence[Body], at_half: Sequence[Body], *, crank: int, frame: FloatArray, displaces: FloatArray
    ) -> KineticEnergy:
        """Return the kinetic energy of bodies from their rows at the crank angles 0 and π.

        `displaces` is 1 at coordinates that displace bodies in the frame, shape (n,).
        """
        size = frame.size
        mass, turned, displaced = (np.zeros((3, size, size)) for _ in range(3))
        for first, second in zip(at_zero, at_half, strict=True):
            steady, going = 0.5 * (first.row + second.row), 0.5 * (first.row - second.row)
            mass += first.size * _product(steady, going, steady, going)
            if first.turns or not np.any(frame):
                continue
            # What the turning frame adds by rad, i D.
            carried, carried_going = 0.5 * (first.carried + second.carried), 0.5 * (first.carried - second.carried)
            own, own_going = carried * displaces, carried_going * displaces
            turned += first.size * _product(steady, going, own, own_going)
            displaced += first.size * _product(own, own_going, own, own_going)
        return cls(crank=crank, frame=frame, mass=mass, turned=turned, displaced=displaced)

    def at(self, x: FloatArray, rate: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the mass matrix and the inertia forces besides M ẍ, shapes (n, n) and (n,).

        Parameters
        ----------
        x, rate : array, shape (n,)
            Coordinates, mm and rad, and their rates, mm/s and rad/s.
        """
        cosine, sine = np.cos(x[self.crank]), np.sin(x[self.crank])
        mean, even, odd = self.mass
        matrix, slope = mean + cosine * even + sine * odd, cosine * odd - sine * even
        if not self.frame.any():
            pushed = slope @ rate
            bias = rate[self.crank] * pushed
            bias[self.crank] -= 0.5 * (rate @ pushed)
            return self._with_spins(x, rate, matrix, bias)
        f, turn = self.frame, self.frame @ rate
        g, h = (self._over(each, cosine, sine) for each in (self.turned, self.displaced))
        g_slope, h_slope = (cosine * each[2] - sine * each[1] for each in (self.turned, self.displaced))
        matrix = matrix + _framed(f, g @ x, float(x @ h @ x))
        slope = slope + _framed(f, g_slope @ x, float(x @ h_slope @ x))
        pushed, along = slope @ rate, g @ rate
        bias = rate[self.crank] * pushed + f * (rate @ along + 2.0 * turn * (x @ h @ rate)) + turn * along
        bias -= turn * (g.T @ rate) + turn**2 * (h @ x)
        bias[self.crank] -= 0.5 * (rate @ pushed)
        return self._with_spins(x, rate, matrix, np.asarray(bias))

    def _with_spins(
        self, x: FloatArray, rate: FloatArray, matrix: FloatArray, bias: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Mass matrix and inertia forces with those of spins about axes that lean added, in place."""
        for spin in self.spins:
            spin.add(self.frame, x, rate, matrix, bias)
        return matrix, bias

    def energy(self, x: FloatArray, rate: FloatArray) -> float:
        """Return the kinetic energy, N·mm; arguments as for `at`."""
        return 0.5 * float(rate @ self.at(x, rate)[0] @ rate)

    @staticmethod
    def _over(parts: FloatArray, cosine: float, sine: float) -> FloatArray:
        return np.asarray(parts[0] + cosine * parts[1] + sine * parts[2])


def _spins(motion: Motion, bodies: Sequence[Body]) -> tuple[LeaningSpin, ...]:
    """Discs that lean; none in the plane."""
    if not motion.pose.leans:
        return ()
    discs = {f"disc {number}": number for number in range(motion.pose.discs)}
    return tuple(
        LeaningSpin(
            inertia=body.size,
            turns=body.row.real,
            lean=int(motion.pose.columns(discs[body.name])[motion.pose.lean_place][0]),
        )
        for body in bodies
        if body.turns and body.name in discs
    )


def _displaced_columns(motion: Motion) -> FloatArray:
    """1 at the coordinates of the pose but the angle of the wheel, by which the frame turns."""
    found = np.zeros(motion.size)
    found[: motion.pose.size] = 1.0
    found[motion.wheel_angle] = 0.0
    return found


def _framed(frame: FloatArray, along: FloatArray, square: float) -> FloatArray:
    crossed = np.outer(frame, along)
    return np.asarray(crossed + crossed.T + square * np.outer(frame, frame))


def _product(a: np.ndarray, c: np.ndarray, b: np.ndarray, d: np.ndarray) -> FloatArray:
    """Mean, cosine and sine part of Re((a + c e^{iφ})ᴴ (b + d e^{iφ})), shape (3, n, n)."""
    mean = np.outer(a.conjugate(), b) + np.outer(c.conjugate(), d)
    ahead, behind = np.outer(a.conjugate(), d), np.outer(c.conjugate(), b)
    return np.stack((mean.real, (ahead + behind).real, (behind - ahead).imag))
