r"""Teeth of a first stage in motion: what the sun presses on the planets, and what yields there.

The cranks turn together. By rigid teeth the sun would hold them at its own angle; they lag behind by what each planet yields in
the mean of all (`ltca.equilibrium.first_stage`): with the moments :math:`T_c` that hold the cranks, the displacement and slope
:math:`u_c` of each at its planet but what its own tooth force bends it, and the direction :math:`p_c` of the force by the moment,

.. math:: e_\pm = \varphi_C - \varphi_{sun} + \overline{p_c \cdot u_c}, \qquad
   \textstyle\sum T_c = -\frac{1}{\bar k}\left[\min(e_+ + h, 0) + \max(e_- - h, 0)\right] ,

k̄ being the compliance of all teeth and shafts together and h half of the free angle: one spring on either flank, with the
radial force of that flank in :math:`p_c`. Between the two nothing touches. Cranks are alike, so that each planet carries an
even share of :math:`\sum T_c` and what the contacts of its own crank depart from their mean by, whatever accelerates. The
forces press the coordinates of cranks, flange and wheel.

What the even shares do comes of the energy :math:`\tfrac12 \bar k (\sum T_c)^2`. The work of the uneven ones on their own
displacements would turn single cranks, which the contacts of this model do not feel; it is booked by itself, with that of the
sun on the wheel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ltca.arrays import ComplexArray, FloatArray
from ltca.dynamics.kinetics import Motion
from ltca.equilibrium.reducer import Reducer
from ltca.equilibrium.supports import Supports

SETTLED = 1e-12
"""Change of the moment of all cranks by itself, or by 1 N·mm, at which bearings and teeth agree."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TeethForces:
    """Teeth of a first stage at one instant.

    Attributes
    ----------
    force : array, shape (n,)
        ∂U/∂x, N and N·mm.
    stiffness : array, shape (n, n)
        Of the flank that carries.
    carried : array of complex, shape (cranks, 2), or None
        What the bearings of cranks carry of it while the planes of the discs stand still, N; None where these are springs alone.
    energy : float
        N·mm.
    uneven, moved : array, shape (k,)
        Forces whose work is booked by itself, and what they work on: uneven moments and the lag of each crank, and the sun on
        the wheel.
    """

    force: FloatArray
    stiffness: FloatArray
    carried: ComplexArray | None
    energy: float
    uneven: FloatArray
    moved: FloatArray

    def work_to(self, other: TeethForces) -> float:
        """Return the work of the uneven forces on the way to another instant nearby, by a trapezoid, N·mm."""
        return 0.5 * float((self.uneven + other.uneven) @ (other.moved - self.moved))


class Teeth:
    """Teeth of the first stage of a drive.

    Parameters
    ----------
    model : Reducer
        Of the drive, with its stage.
    motion : Motion
        Coordinates.
    """

    def __init__(self, model: Reducer, motion: Motion) -> None:
        stage = model.stage
        assert stage is not None
        self._stage, self._motion, self._supports = stage, motion, model.supports
        self._cranks = motion.drive.crank.number
        self._half_free = float(np.squeeze(stage.half_free))
        self._pushed = {sense: stage.on_planets(np.full((1, self._cranks), sense))[1][0] for sense in (1.0, -1.0)}
        self._together = {sense: stage.together(sense) for sense in (1.0, -1.0)}
        self._bears = model.supports is not None and bool(model.supports.cranks) and stage.yields
        wheel = [motion.pose.wheel_place] if motion.pose.wheel else []
        self._wheel = np.concatenate(
            [np.arange(motion.size)[one] for one in (*wheel, motion.pose.wheel_lean_place)]
            or [np.zeros(0, dtype=np.intp)]
        )

    def at(self, x: FloatArray, moments: FloatArray) -> TeethForces:
        """Return the forces at coordinates, shape (n,), and moments of the contacts that hold each crank, N·mm, (cranks,)."""
        motion, stage, own = self._motion, self._stage, moments - moments.mean()
        pose = x[: motion.pose.size]
        by_pose = np.matmul(stage.by_pose, pose)
        sense, total, given, closed = self._carried(x, own, by_pose, float(moments.sum()))
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
            if closed:
                row = motion.unit(motion.crank) - motion.unit(motion.sun)
                row[: pose.size] += by_coordinates
                stiffness += np.outer(row, row) / compliance
        on_wheel = self._on_wheel(shares)
        force[self._wheel] -= on_wheel
        return TeethForces(
            force=force,
            stiffness=stiffness,
            carried=stage.beside_discs(on_planets)[0] if self._bears else None,
            energy=energy,
            uneven=np.concatenate((own, on_wheel)),
            moved=np.concatenate((self._lag(self._pushed[sense], by_pose, given), x[self._wheel])),
        )

    def _carried(
        self, x: FloatArray, own: FloatArray, by_pose: ComplexArray, without_sun: float
    ) -> tuple[float, float, ComplexArray | None, bool]:
        """Flank that carries, moment of all cranks, displacements in their bearings, and whether a flank touches."""
        motion = self._motion
        if motion.sun is None:
            sense = float(motion.drive.driving_sign)
            return sense, without_sun, self._given(x, own, without_sun), True
        apart = float(x[motion.crank] - x[motion.sun])

        def follows(total: float) -> tuple[float, ComplexArray | None]:
            given, found = self._given(x, own, total), 0.0
            for sense, pushed in self._pushed.items():
                lag = apart + float(self._lag(pushed, by_pose, given).mean())
                found -= sense * min(sense * lag + self._half_free, 0.0) / self._together[sense][0]
            return found, given

        total, given = follows(0.0)
        if self._bears and total:
            # The moment that follows falls as one is assumed: what agrees lies between none and the one that follows from none.
            # Lags of the size of the backlash are known to their round-off, and so is what they press.
            round_off = 8.0 * np.finfo(float).eps * (abs(apart) + self._half_free)
            known = max(SETTLED, round_off / min(together for together, *_ in self._together.values()))
            total = float(brentq(lambda moment: follows(moment)[0] - moment, 0.0, total, xtol=known, rtol=SETTLED))
            given = follows(total)[1]
        return (1.0 if total >= 0.0 else -1.0), total, given, total != 0.0

    def _given(self, x: FloatArray, own: FloatArray, total: float) -> ComplexArray | None:
        """Displacements in the bearings of the cranks, mm, shape (cranks, 2); None where these are springs alone."""
        supports = self._supports
        if not self._bears or supports is None:
            return None
        on_planets = self._stage.on_planets((own + total / self._cranks)[None])[0]
        return _first(supports, x[None, : self._motion.pose.size], self._stage.beside_discs(on_planets))

    def _lag(self, pushed: ComplexArray, by_pose: ComplexArray, given: ComplexArray | None) -> FloatArray:
        """p·u of every crank, rad."""
        moved = by_pose if given is None else by_pose + np.matmul(given, self._stage.by_bearings)
        return np.asarray((pushed.conjugate() * moved).real.sum(axis=-1))

    def _on_wheel(self, shares: FloatArray) -> FloatArray:
        """Force of the sun on the wheel, and what it presses its lean with, over their coordinates."""
        pose, pressed = self._motion.pose, self._stage.on_wheel(shares)[0][0]
        there = np.array([pose.wheel, pose.wheel_leans], dtype=bool)
        return np.asarray(pressed[there].view(float))


def _first(supports: Supports, pose: FloatArray, carried: ComplexArray) -> ComplexArray | None:
    given = supports.given(pose, carried)
    return None if given is None else given[0]
