"""Laws made of laws: springs, laws in series, and the approach at a given load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.errors import ConvergenceError
from ltca.laws.contact_law import LoadLaw

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringLaw:
    """Unilateral linear spring; `stiffness` in N/mm."""

    stiffness: float

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm."""
        delta = np.asarray(approach, dtype=float)
        return self.stiffness * np.maximum(delta, 0.0), np.where(delta > 0.0, self.stiffness, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeriesLaw:
    """A spring and a contact in series: the approach is the sum of both at the same load.

    Attributes
    ----------
    spring : SpringLaw
        The spring.
    contact : LoadLaw
        The contact.
    """

    spring: SpringLaw
    contact: LoadLaw

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at a total approach and its derivative, N and N/mm."""
        delta, radius = np.broadcast_arrays(np.asarray(approach, dtype=float), np.asarray(effective_radius))
        closed = delta > 0.0
        total = np.where(closed, delta, 0.0)
        # The contact law is convex: from the whole approach Newton falls to the root without passing it.
        own = total.copy()
        history: list[float] = []
        for _ in range(80):
            load, stiffness = self.contact.load_and_stiffness(own, radius)
            step = (own + load / self.spring.stiffness - total) / (1.0 + stiffness / self.spring.stiffness)
            own = np.maximum(own - step, 0.0)
            history.append(float(np.max(np.abs(step) / np.where(closed, total, 1.0), initial=0.0)))
            if history[-1] < 1e-9:
                break
        else:
            raise ConvergenceError("spring and contact in series do not balance; relative change", history)
        load, stiffness = self.contact.load_and_stiffness(own, radius)
        soft = np.where(closed & (stiffness > 0.0), stiffness, 1.0)
        series = 1.0 / (1.0 / self.spring.stiffness + 1.0 / soft)
        return np.where(closed, load, 0.0), np.where(closed & (stiffness > 0.0), series, 0.0)


def approach_at_load(law: LoadLaw, load: FloatArray, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the approach of a contact at a load and its derivative, mm and mm/N; zero where there is no load.

    Parameters
    ----------
    law : LoadLaw
        A convex law.
    load : array
        N.
    effective_radius : array
        mm.

    Raises
    ------
    ConvergenceError
        When Newton's method does not settle.
    """
    force, radius = np.broadcast_arrays(np.asarray(load, dtype=float), np.asarray(effective_radius, dtype=float))
    loaded = force > 0.0
    approach = np.full(force.shape, 1e-3)
    history: list[float] = []
    for _ in range(100):
        found, stiffness = law.load_and_stiffness(approach, radius)
        step = (found - force) / stiffness
        # A law like δ^1.1: from far above the root the step could fall below zero.
        following = np.maximum(approach - step, 0.1 * approach)
        history.append(float(np.max(np.where(loaded, np.abs(following / approach - 1.0), 0.0), initial=0.0)))
        approach = np.where(loaded, following, approach)
        if history[-1] < 1e-9:
            _, stiffness = law.load_and_stiffness(approach, radius)
            return np.where(loaded, approach, 0.0), np.where(loaded, 1.0 / stiffness, 0.0)
    raise ConvergenceError("no approach found for a load; relative change", history)
