"""Springs even along the width, in slices: what shaft pins do in the paper's model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.sliced_contact import EXACT, Exactness, SlicedContact, slice_heights, slice_means


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedSpring:
    """Law of springs that carry where they are pressed in.

    Parameters
    ----------
    stiffness : float
        Of the whole width, N/mm.
    length : float
        mm.
    slices : int
        As of `ltca.laws.sliced_line.SlicedLine`.
    """

    stiffness: float | FloatArray = by_drive(0)
    length: float
    slices: int

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives, as `ltca.laws.sliced_line.SlicedLine.respond`; no start is needed."""
        delta, theta = np.broadcast_arrays(approach, tilt)
        line = delta[..., None, None] + theta[..., None, None] * slice_heights(self.length, self.slices)
        stiffness = np.asarray(self.stiffness)[..., None, None] / self.length
        slope = stiffness * (line > 0.0)
        line *= slope
        return SlicedContact.of_separate(delta, theta, line, slope, self.length)

    def energy(self, contact: SlicedContact, effective_radius: FloatArray | float) -> FloatArray:
        """Return the energy of contacts, N·mm, shape (…), whatever the radius."""
        stored = slice_means(contact.line_load**2).sum(axis=-1)
        return np.asarray(0.5 * self.length**2 / self.slices * stored / self.stiffness)
