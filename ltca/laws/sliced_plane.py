"""Plane strain in slices that do not feel each other: the near field of coefficients of finite elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.sliced_line import POINTS, SlicedContact, slice_heights


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedPlane:
    """Law of line contacts in plane strain slice by slice (`ltca.laws.plane_strain`).

    Parameters
    ----------
    length : float
        L, mm.
    contact_modulus : float
        E*, MPa.
    datum : float
        D, mm.
    slices : int
        n.
    relief : array, shape (slices, points)
        h, mm: by how much lead and profile fall short at the points (`ltca.laws.sliced_line.slice_heights`).
    """

    length: float
    contact_modulus: float
    datum: float
    slices: int
    relief: FloatArray = by_drive(2)

    @property
    def plane(self) -> PlaneContactLaw:
        """The law of the whole length."""
        return PlaneContactLaw(thickness=self.length, contact_modulus=self.contact_modulus, datum=self.datum)

    def respond(
        self, approach: FloatArray, tilt: FloatArray, effective_radius: FloatArray, start: FloatArray | None = None
    ) -> SlicedContact:
        """Return loads, moments and their derivatives, as `ltca.laws.sliced_line.SlicedLine.respond`; `start` is of no use."""
        z = slice_heights(self.length, self.slices)
        weights = 0.5 / self.slices * np.polynomial.legendre.leggauss(POINTS)[1] * np.ones(z.shape)
        delta, theta, radius = (
            np.asarray(each)[..., None, None] for each in np.broadcast_arrays(approach, tilt, effective_radius)
        )
        local = delta + theta * z - self.relief
        whole, slope = self.plane.load_and_stiffness(local, np.broadcast_to(radius, local.shape))
        load, carried = weights * whole, weights * slope
        scale = 2.0 / (np.pi * self.contact_modulus * self.length)
        # φ = F δ − ∫ δ dF with δ by F in closed form.
        pressed = np.where(whole > 0.0, whole, 1.0)
        logarithm = np.log(2.0 * self.datum / np.sqrt(2.0 * scale * pressed * radius))
        spent = scale * pressed**2 * 0.5 * (logarithm + 0.75)
        stored = np.where(whole > 0.0, whole * local - spent, 0.0)
        both = (-2, -1)
        return SlicedContact(
            load=load.sum(axis=both),
            moment=(load * z).sum(axis=both),
            by_approach=carried.sum(axis=both),
            by_tilt=(carried * z).sum(axis=both),
            moment_by_tilt=(carried * z**2).sum(axis=both),
            energy=(weights * stored).sum(axis=both),
            slice_load=load.sum(axis=-1),
            line_load=whole / self.length,
        )
