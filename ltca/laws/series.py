"""Springs, and the approach at a given load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray, by_drive
from ltca.errors import ConvergenceError
from ltca.laws.contact_law import LoadLaw
from ltca.laws.plane_strain import PlaneContactLaw


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringLaw:
    """Unilateral linear spring (Eq. 77); `stiffness` in N/mm, of a batch of drives an array of shape (positions, 1)."""

    stiffness: float | FloatArray = by_drive(0)

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach and its derivative, N and N/mm."""
        delta = np.asarray(approach, dtype=float)
        return self.stiffness * np.maximum(delta, 0.0), np.where(delta > 0.0, self.stiffness, 0.0)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ, N·mm."""
        return np.asarray(0.5 * self.stiffness * np.maximum(np.asarray(approach, dtype=float), 0.0) ** 2)


def approach_at_load(
    law: LoadLaw, load: FloatArray, effective_radius: ArrayLike, start: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the approach of a contact at a load and its derivative, mm and mm/N; zero where there is no load.

    Parameters
    ----------
    law : LoadLaw
        A convex law.
    load : array
        N.
    effective_radius : array
        mm.
    start : array, optional
        Approaches at loads that differ little, mm; those that are not positive are no start.

    Raises
    ------
    ConvergenceError
        When Newton's method does not settle.
    """
    force, radius = np.broadcast_arrays(np.asarray(load, dtype=float), np.asarray(effective_radius, dtype=float))
    loaded = force > 0.0
    if isinstance(law, PlaneContactLaw):  # which is given the other way round
        approach, compliance = law.approach_and_compliance(force, radius)
        return np.where(loaded, approach, 0.0), np.where(loaded, compliance, 0.0)
    force, radius = force[loaded], radius[loaded]
    approach = np.full(force.shape, 1e-3)
    if start is not None:
        near = np.broadcast_to(start, loaded.shape)[loaded]
        approach = np.where(near > 0.0, near, approach)
    history: list[float] = []
    for _ in range(100):
        found, stiffness = law.load_and_stiffness(approach, radius)
        step = (found - force) / stiffness
        # A law like δ^1.1: from far above the root the step could fall below zero.
        following = np.maximum(approach - step, 0.1 * approach)
        history.append(float(np.max(np.abs(following / approach - 1.0), initial=0.0)))
        approach = following
        if history[-1] < 1e-7:  # quadratic: 1e-14 is left; of the derivative, which is that of the last step, 1e-8
            every, compliance = np.zeros(loaded.shape), np.zeros(loaded.shape)
            every[loaded], compliance[loaded] = approach, 1.0 / stiffness
            return every, compliance
    raise ConvergenceError("no approach found for a load; relative change", history)
