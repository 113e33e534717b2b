r"""Teeth of a first stage in motion: forces of the sun on the planets, and their yielding (``docs/theory/motion.md``).

With half the free angle h, and the direction p of forces by moments and the displacement u of each crank at its planet,

.. math:: e_\pm = \varphi_C - \varphi_{sun} + \overline{p \cdot u}, \qquad
   \textstyle\sum T = -\frac{1}{\bar k}\left[\min(e_+ + h, 0) + \max(e_- - h, 0)\right] .
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ltca.arrays import ComplexArray, FloatArray
from ltca.dynamics.kinetics import Motion
from ltca.equilibrium.reducer import Reducer

SETTLED = 1e-12
"""Change of the moment of all cranks, relative or by 1 N·mm, at which bearings and teeth agree."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TeethForces:
    """Teeth of a first stage at one instant."""

    force: FloatArray  # ∂U/∂x, N and N·mm
    stiffness: FloatArray  # of the flank that carries
    carried: ComplexArray | None  # on bearings of cranks, discs standing still, N, (1, cranks, 2)
    energy: float  # N·mm
    uneven: FloatArray  # forces whose work is booked by itself
    moved: FloatArray  # lag of each crank, and the wheel

    def work_to(self, other: TeethForces) -> float:
        """Return the work of the uneven forces on the way to another instant nearby, by a trapezoid, N·mm."""
        return 0.5 * float((self.uneven + other.uneven) @ (other.moved - self.moved))


class Teeth:
    """Teeth of the first stage of a drive, which its model has."""

    def __init__(self, model: Reducer, motion: Motion) -> None:
        stage = model.stage
        assert stage is not None
        self._stage, self._motion = stage, motion
        self._cranks = motion.drive.crank.number
        self._half_free = float(np.squeeze(stage.half_free))
        self._pushed = {sense: stage.on_planets(np.full((1, self._cranks), sense))[1] for sense in (1.0, -1.0)}
        self._together = {sense: stage.together(sense) for sense in (1.0, -1.0)}
        bears = model.supports is not None and bool(model.supports.cranks) and stage.yields
        self._supports = model.supports if bears else None
        self._wheel = np.r_[motion.pose.wheel_place, motion.pose.wheel_lean_place].astype(np.intp)

    def at(self, x: FloatArray, moments: FloatArray) -> TeethForces:
        """Return the forces at coordinates, shape (n,), and moments of the contacts that hold each crank, N·mm, (cranks,)."""
        motion, stage, own = self._motion, self._stage, moments - moments.mean()
        pose = x[: motion.pose.size]
        by_pose = np.matmul(stage.by_pose, pose)
        sense, total, given = self._carried(x, own, by_pose, float(moments.sum()))
        shares = (own + total / self._cranks)[None]
        compliance, by_coordinates = self._together[sense]
        force, stiffness, energy = np.zeros(motion.size), np.zeros((motion.size, motion.size)), 0.0
        on_planets = stage.on_planets(shares)[0]
        force[: pose.size] -= stage.on_coordinates(on_planets)[0]
        if motion.sun is None:
            # Rigid teeth: what all carry evenly is the constraint of the input.
            force[: pose.size] += total * motion.mesh_by_pose
        else:
            force[motion.crank] -= total
            force[motion.sun] += total
            energy = 0.5 * compliance * total**2
            if total:
                row = motion.unit(motion.crank) - motion.unit(motion.sun)
                row[: pose.size] += by_coordinates
                stiffness += np.outer(row, row) / compliance
        there = np.array([motion.pose.wheel, motion.pose.wheel_leans], dtype=bool)
        on_wheel = stage.on_wheel(shares)[0][0, there].view(float)
        force[self._wheel] -= on_wheel
        return TeethForces(
            force=force,
            stiffness=stiffness,
            carried=None if self._supports is None else stage.beside_discs(on_planets),
            energy=energy,
            uneven=np.concatenate((own, on_wheel)),
            moved=np.concatenate((self._lag(sense, by_pose, given), x[self._wheel])),
        )

    def _carried(
        self, x: FloatArray, own: FloatArray, by_pose: ComplexArray, without_sun: float
    ) -> tuple[float, float, ComplexArray | None]:
        """Flank that carries, moment of all cranks, 0 where no flank touches, and displacements in their bearings."""
        motion = self._motion
        if motion.sun is None:
            return float(motion.drive.driving_sign), without_sun, self._given(x, own, without_sun)
        apart = float(x[motion.crank] - x[motion.sun])

        def follows(total: float) -> tuple[float, ComplexArray | None]:
            given, found = self._given(x, own, total), 0.0
            for sense, (together, _) in self._together.items():
                lag = apart + float(self._lag(sense, by_pose, given).mean())
                found -= sense * min(sense * lag + self._half_free, 0.0) / together
            return found, given

        total, given = follows(0.0)
        if self._supports is not None and total:
            # The moment that follows falls as one is assumed: what agrees lies between none and the one that follows from none.
            # Lags of the size of the backlash are known to their round-off, and so is what they press.
            round_off = 8.0 * np.finfo(float).eps * (abs(apart) + self._half_free)
            known = max(SETTLED, round_off / min(together for together, _ in self._together.values()))
            total = float(brentq(lambda moment: follows(moment)[0] - moment, 0.0, total, xtol=known, rtol=SETTLED))
            given = follows(total)[1]
        return (1.0 if total >= 0.0 else -1.0), total, given

    def _given(self, x: FloatArray, own: FloatArray, total: float) -> ComplexArray | None:
        """Displacements in the bearings of the cranks, mm, shape (1, cranks, 2); None where these are springs alone."""
        if self._supports is None:
            return None
        on_planets = self._stage.on_planets((own + total / self._cranks)[None])[0]
        return self._supports.given(x[None, : self._motion.pose.size], self._stage.beside_discs(on_planets))

    def _lag(self, sense: float, by_pose: ComplexArray, given: ComplexArray | None) -> FloatArray:
        """p·u of every crank on a flank, rad."""
        moved = by_pose if given is None else by_pose + np.matmul(given, self._stage.by_bearings)
        return np.asarray((self._pushed[sense].conjugate() * moved)[0].real.sum(axis=-1))
