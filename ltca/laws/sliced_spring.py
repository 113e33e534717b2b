"""Springs even along the width, in slices: what shaft pins do in the paper's model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.sliced_contact import EXACT, POINTS, Exactness, SlicedContact, slice_heights


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
        z = slice_heights(self.length, self.slices)
        weights = 0.5 / self.slices * np.polynomial.legendre.leggauss(POINTS)[1] * np.ones(z.shape)
        delta, theta = np.broadcast_arrays(approach, tilt)
        pressed = np.maximum(delta[..., None, None] + theta[..., None, None] * z, 0.0)
        stiffness = np.asarray(self.stiffness)[..., None, None]
        load, carried = stiffness * weights * pressed, stiffness * weights * (pressed > 0.0)
        both = (-2, -1)
        each = load.sum(axis=-1), carried.sum(axis=-1), (carried * z).sum(axis=-1)
        return SlicedContact(
            load=load.sum(axis=both),
            moment=(load * z).sum(axis=both),
            by_approach=carried.sum(axis=both),
            by_tilt=(carried * z).sum(axis=both),
            moment_by_tilt=(carried * z**2).sum(axis=both),
            slice_load=each[0],
            line_load=stiffness / self.length * pressed,
            near=np.concatenate((delta[..., None], theta[..., None], *each), axis=-1),
        )

    def energy(self, contact: SlicedContact, effective_radius: FloatArray | float) -> FloatArray:
        """Return the energy of contacts, N·mm, shape (…), whatever the radius."""
        weights = 0.5 * self.length / self.slices * np.polynomial.legendre.leggauss(POINTS)[1]
        stored = (contact.line_load**2 @ weights).sum(axis=-1)
        return np.asarray(0.5 * self.length * stored / self.stiffness)
