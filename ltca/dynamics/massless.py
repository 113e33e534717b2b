"""Coordinates of parts that yield and have no mass: they follow all others as springs do (``docs/theory/motion.md``)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.dynamics.contact_forces import Instant
from ltca.errors import ConvergenceError

SETTLED = 1e-8
"""Last step, mm, to first order of which forces are corrected: 1e-5 of approaches, whose square is left."""
ONWARD = 1e-7
"""Motion by which the change of forces is differenced, mm or rad: 1e-4 of approaches, 1e4 times the round-off of forces."""
STEPS, HALVINGS = 60, 12
"""Steps tried, and how often one is halved that leaves more than there was."""

Respond = Callable[[FloatArray, FloatArray], tuple[Instant, FloatArray]]
"""Forces at coordinates and their rates, and ∂U/∂x + R − Q."""


class MasslessParts:
    """Parts without mass: columns N, shape (n, k), and first places, mm; `rubs` tells whether forces feel their rates."""

    def __init__(self, columns: FloatArray, place: FloatArray, rubs: bool) -> None:
        self.columns, self.rubs = columns, rubs
        self.warm_start: tuple[Any, ...] = place.copy(), np.zeros(columns.shape[::-1]), None, np.zeros(columns.shape[1])

    def settle(
        self, others: FloatArray, rate: FloatArray, respond: Respond
    ) -> tuple[FloatArray, FloatArray, Instant, FloatArray]:
        """Return coordinates and rates of all, shape (n,), the forces there, and ∂z/∂x, shape (k, n)."""
        columns = self.columns
        place, slope, before_others, before_rates = self.warm_start
        if before_others is not None:
            place = place + slope @ (others - before_others)
        fastest = float(np.abs(rate).max())
        onward = ONWARD / fastest if self.rubs and fastest > 0.0 else 0.0
        # Last rates are those of a hair before: what K misses of the slope of f, friction above all, counts for their change.
        following = before_rates if onward else slope @ rate
        moving = rate + columns @ following
        ahead = respond(others + columns @ place + onward * moving, moving)[1] if onward else None
        step: FloatArray = np.zeros(place.size)
        before, halved = np.inf, 0
        history: list[float] = []
        for _ in range(STEPS):
            now, unbalanced = respond(others + columns @ place, moving)
            left = columns.T @ unbalanced
            if (size := float(np.linalg.norm(left))) > before and halved < HALVINGS:
                step, halved = 0.5 * step, halved + 1
                place = place + step
                continue
            pressed = columns.T @ now.stiffness
            matrix = pressed @ columns
            slope = -np.asarray(np.linalg.solve(matrix, pressed), dtype=float)
            step, before, halved = np.asarray(np.linalg.solve(matrix, left), dtype=float), size, 0
            if ahead is not None:
                following = following + (step - np.linalg.solve(matrix, columns.T @ ahead)) / onward
                ahead = None
            elif not onward:
                following = slope @ rate
            moving, place = rate + columns @ following, place - step
            history.append(float(np.abs(step).max()))
            if history[-1] <= SETTLED:
                self.warm_start = place, slope, others, following
                now = replace(now, force=now.force - now.stiffness @ (columns @ step))
                return others + columns @ place, moving, now, slope
        raise ConvergenceError("parts without mass find no balance in motion; last steps in mm", history)
