"""The base class of load–approach laws: whatever provides them, a table, a grid, a spring or what stands behind a contact."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, NoReturn

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError

MAX_ITERATIONS = 100
"""Newton steps from a load to its approach."""
SETTLED = 1e-7
"""Relative change of the approach at the end: quadratic, 1e-14 is left; 1e-8 of the derivative, the last step's."""


class ContactLaw(ABC):
    """Load of contacts pressed together, smooth and rising with the approach, mm; zero where open, approach ≤ 0."""

    __slots__ = ()

    @abstractmethod
    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm; zeros where open."""

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ, N·mm."""
        self._refuse("energy")

    def mid_pressure(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the largest pressure at mid-width, MPa."""
        self._refuse("pressure")

    def half_width(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return the contact half-width at mid-width, mm."""
        self._refuse("half-width")

    def _refuse(self, quantity: str) -> NoReturn:
        raise TypeError(f"{type(self).__name__} has no {quantity}")

    def surface(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[ContactLaw, FloatArray]:
        """Return the law of the surfaces in contact alone and their approach, mm: without what stands behind them."""
        return self, np.asarray(approach, dtype=float)

    def take(self, shape: tuple[int, ...], places: Any) -> ContactLaw:
        """Return the law of some contacts of a batch of `shape`, by a mask or a tuple of arrays of numbers."""
        return self

    def approach_at_load(self, load: FloatArray, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the approach at a load and its derivative, mm and mm/N, by Newton's method on a convex law; 0 without load."""
        force, radius = np.broadcast_arrays(np.asarray(load, dtype=float), np.asarray(effective_radius, dtype=float))
        loaded = force > 0.0
        law, force, radius = self.take(loaded.shape, loaded), force[loaded], radius[loaded]
        approach = np.full(force.shape, 1e-3)
        history: list[float] = []
        for _ in range(MAX_ITERATIONS):
            carried, stiffness = law.load_and_stiffness(approach, radius)
            step = (carried - force) / stiffness
            # A law like δ^1.1: from far above the root the step could fall below zero.
            following = np.maximum(approach - step, 0.1 * approach)
            history.append(float(np.max(np.abs(following / approach - 1.0), initial=0.0)))
            approach = following
            if history[-1] < SETTLED:
                whole, compliance = np.zeros(loaded.shape), np.zeros(loaded.shape)
                whole[loaded], compliance[loaded] = approach, 1.0 / stiffness
                return whole, compliance
        raise ConvergenceError("no approach found for a load; relative change", history)
