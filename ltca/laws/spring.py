"""A contact that yields like a linear spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ltca.arrays import FloatArray, by_drive
from ltca.laws.contact_law import ContactLaw


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringLaw(ContactLaw):
    """Unilateral linear spring (Eq. 77); `stiffness` in N/mm, of a batch of drives an array of shape (positions, 1)."""

    stiffness: float | FloatArray = by_drive(0)

    def load_and_stiffness(self, approach: ArrayLike, effective_radius: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return the load at an approach (Eq. 77) and its derivative, N and N/mm."""
        delta = np.asarray(approach, dtype=float)
        return self.stiffness * np.maximum(delta, 0.0), np.where(delta > 0.0, self.stiffness, 0.0)

    def energy(self, approach: ArrayLike, effective_radius: ArrayLike) -> FloatArray:
        """Return ∫ F dδ, N·mm."""
        return np.asarray(0.5 * self.stiffness * np.maximum(np.asarray(approach, dtype=float), 0.0) ** 2)

    def take(self, shape: tuple[int, ...], places: Any) -> ContactLaw:
        """Return the springs of some contacts of a batch."""
        if np.ndim(self.stiffness) == 0:
            return self
        return SpringLaw(stiffness=np.asarray(np.broadcast_to(self.stiffness, shape)[places]))
