"""Newton's steps of parts that stand between contacts in slices: place and lean at which forces and moments balance.

A loose pin or a sleeve between flank and seat: the energy of what holds the part is convex in its
place and lean but for a little geometry, and its slopes are what is left of forces and moments. A step is shortened where the
energy rises again steeply at its end: the slope along the step says so, also where differences of energies are round-off.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray

SETTLED = 1e-10
"""Largest force and moment (by half the length) left over, by the larger load of the two contacts."""
ROUND_OFF = 1e-7
"""What is left that may be due to what the slices leave over."""
MAX_TRIALS = 16
"""Places along a step at which the slope of the energy is asked for."""
STEEPEST = 0.5
"""Largest slope of the energy at the end of a step, by that at its start, that is not shortened."""
LEAST_TURNING = 1e-9
"""Stiffness against leaning by that of the place times the square of half the length: what touches at one end alone turns about
that end freely."""
DAMPING = 1e-6
"""The same of a step: what is left over of what turns freely must not send it far."""


class PartStiffness(NamedTuple):
    """Second derivatives of the energy by place and lean, N/mm, N/rad and N·mm/rad."""

    place: FloatArray
    mixed: FloatArray
    lean: FloatArray
    half: float
    """Half of the length of the contacts, mm."""

    def take(self, rows: NDArray[np.intp]) -> PartStiffness:
        """Return those of some parts."""
        return PartStiffness(self.place[rows], self.mixed[rows], self.lean[rows], self.half)

    def along(self, step: FloatArray, turn: FloatArray) -> FloatArray:
        """Return the second derivative along steps, N·mm."""
        return np.asarray(step * (self.place * step + 2.0 * self.mixed * turn) + self.lean * turn**2)

    @property
    def matrix(self) -> FloatArray:
        """Matrices of place and lean, shape (parts, 2, 2); those of parts that nothing holds are one."""
        found = np.empty((self.place.size, 2, 2))
        found[:, 0, 0], found[:, 1, 1] = self.place, self.lean + LEAST_TURNING * self.half**2 * self.place
        found[:, 0, 1] = found[:, 1, 0] = self.mixed
        found[self.place <= 0.0] = np.eye(2)
        return found


def newton_step(
    force: FloatArray, moment: FloatArray, stiffness: PartStiffness
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return Newton's step of place, mm, and lean, rad, of parts, and the slope of the energy along it, N·mm.

    Parameters
    ----------
    force, moment : array, shape (parts,)
        Slopes of the energy by place and lean, N and N·mm.
    stiffness : PartStiffness
        Second derivatives there.
    """
    stiff, mixed, turning, half = stiffness
    turning = turning + DAMPING * half**2 * stiff
    held = stiff > 0.0
    determinant = np.where(held, stiff * turning - mixed**2, 1.0)
    turn = -(stiff * moment - mixed * force) / determinant
    step = -(force + mixed * turn) / np.where(held, stiff, 1.0)
    return step, turn, np.asarray(force * step + moment * turn)


def shorten_steps(
    slope: FloatArray, move: Callable[[NDArray[np.intp], FloatArray], tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """Return which parts of steps are taken: the whole, or where the slope of the energy along them has nearly gone.

    Parameters
    ----------
    slope : array, shape (steps,)
        Slopes of the energy along the steps where they start, N·mm.
    move : callable
        Takes some of the steps, by their numbers, to parts of them; returns slope and second derivative of the energy there.
        Every step is left where it was taken last.
    """
    fraction, low, high = np.ones(slope.size), np.zeros(slope.size), np.full(slope.size, np.inf)
    steep, rows = STEEPEST * np.abs(slope), np.arange(slope.size)
    for trial in range(MAX_TRIALS):
        ahead, bend = move(rows, fraction[rows])
        far = ahead > steep[rows]
        short = (ahead < -steep[rows]) & np.isfinite(high[rows])
        high[rows[far]], low[rows[short]] = fraction[rows[far]], fraction[rows[short]]
        on = far | short
        if not on.any() or trial == MAX_TRIALS - 1:
            break
        rows, ahead, bend = rows[on], ahead[on], bend[on]
        # Where a slice begins to carry the slope turns within a little: from beyond, its tangent leads there. From before it
        # leads anywhere; places are halved by their size then.
        tangent = fraction[rows] - ahead / np.where(bend > 0.0, bend, 1.0)
        within = (bend > 0.0) & (tangent > low[rows]) & (tangent < high[rows])
        cut = high[rows] * np.clip(np.abs(slope[rows]) / (np.abs(slope[rows]) + np.abs(ahead)), 0.1, 0.7)
        halved = np.where(low[rows] > 0.0, np.sqrt(low[rows] * high[rows]), cut)
        fraction[rows] = np.where(within, tangent, halved)
    return fraction


def unbalanced(left: FloatArray, before: FloatArray) -> NDArray[np.intp]:
    """Return the parts that go on with what is left over by their loads, and was before their last step.

    Nothing but what the slices leave over is left where steps no longer help.
    """
    return np.flatnonzero((left > SETTLED) & ~((before < ROUND_OFF) & (left >= 0.5 * before)))
