r"""Coordinates of parts that yield and have no mass: they follow all others as springs do.

A file gives no mass to the ring that ties the tips of shaft pins, nor to the far flange of a carrier. Such coordinates
:math:`x = \dots + N z` stand wherever their forces balance, :math:`N^T (\partial U/\partial x + R - Q) = 0`, and with the
stiffness K they move with the rates of the others,

.. math:: \dot z = -(N^T K N)^{-1} N^T K \dot x .

What is stored is then the least energy over z, whose slopes by the other coordinates are the forces at that place: the
balance of energy needs nothing besides. Modes do likewise with parts without mass (`ltca.dynamics.modes`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ltca.arrays import FloatArray
from ltca.dynamics.contact_forces import Instant
from ltca.errors import ConvergenceError

SETTLED = 1e-8
"""Last step, mm, to first order of which forces are corrected: 1e-5 of approaches, whose square is left."""
STEPS, HALVINGS = 60, 12
"""Steps tried, and how often one is halved that leaves more than there was."""

Respond = Callable[[FloatArray, FloatArray], tuple[Instant, FloatArray]]
"""Forces at coordinates and their rates, and what presses from outside."""


class MasslessParts:
    """Parts without mass, followed in time.

    Parameters
    ----------
    columns : array, shape (n, k)
        N, mm and rad by mm.
    place : array, shape (k,)
        Where they begin, mm.
    """

    def __init__(self, columns: FloatArray, place: FloatArray) -> None:
        self.columns = columns
        self._place, self._slope = place.copy(), np.zeros((columns.shape[1], columns.shape[0]))
        self._others: FloatArray | None = None

    def settle(
        self, others: FloatArray, rate: FloatArray, respond: Respond
    ) -> tuple[FloatArray, FloatArray, Instant, FloatArray]:
        """Return coordinates and rates of all, each of shape (n,), the forces there, and ∂z/∂x, shape (k, n).

        Parameters
        ----------
        others, rate : array, shape (n,)
            Coordinates and rates without these parts.
        respond : callable
            Returns the forces.

        Raises
        ------
        ConvergenceError
            Where they find no balance.
        """
        columns = self.columns
        place = self._place if self._others is None else self._place + self._slope @ (others - self._others)
        step, before, history = np.zeros(place.size), np.inf, [0.0]
        halved = 0
        for _ in range(STEPS):
            moving = rate + columns @ (self._slope @ rate)
            now, outer = respond(others + columns @ place, moving)
            left = columns.T @ (now.force + now.friction - outer)
            if (size := float(np.linalg.norm(left))) > before and halved < HALVINGS and history[-1] > SETTLED:
                step, halved = 0.5 * step, halved + 1
                place = place + step
                continue
            pressed = columns.T @ now.stiffness
            solved = np.linalg.solve(pressed @ columns, np.column_stack((pressed, left)))
            self._slope, step, before, halved = -solved[:, :-1], solved[:, -1], size, 0
            place = place - step
            history.append(float(np.abs(step).max()))
            if history[-1] <= SETTLED:
                self._place, self._others = place, others
                moved = columns @ step
                now = replace(now, force=now.force - now.stiffness @ moved)
                return others + columns @ place, rate + columns @ (self._slope @ rate), now, self._slope
        raise ConvergenceError("parts without mass find no balance in motion; last steps in mm", history)
