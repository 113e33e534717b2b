"""Springs even along the width, in slices: what shaft pins do in the paper's model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.sliced_line import POINTS, SlicedContact, slice_heights


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
        self, approach: FloatArray, tilt: FloatArray, effective_radius: FloatArray, start: FloatArray | None = None
    ) -> SlicedContact:
        """Return loads, moments and their derivatives, as `ltca.laws.sliced_line.SlicedLine.respond`; no start is needed."""
        z = slice_heights(self.length, self.slices)
        weights = 0.5 / self.slices * np.polynomial.legendre.leggauss(POINTS)[1] * np.ones(z.shape)
        delta, theta = np.broadcast_arrays(approach, tilt)
        pressed = np.maximum(delta[..., None, None] + theta[..., None, None] * z, 0.0)
        stiffness = np.asarray(self.stiffness)[..., None, None]
        load, carried = stiffness * weights * pressed, stiffness * weights * (pressed > 0.0)
        both = (-2, -1)
        return SlicedContact(
            load=load.sum(axis=both),
            moment=(load * z).sum(axis=both),
            by_approach=carried.sum(axis=both),
            by_tilt=(carried * z).sum(axis=both),
            moment_by_tilt=(carried * z**2).sum(axis=both),
            energy=0.5 * (load * pressed).sum(axis=both),
            slice_load=load.sum(axis=-1),
            line_load=stiffness / self.length * pressed,
        )
