"""Plane strain in slices that do not feel each other: the near field of coefficients of finite elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.backed import BackedLaw
from ltca.laws.contact_law import ContactLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.sliced_contact import EXACT, POINTS, Exactness, SlicedContact, slice_heights


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
    overlap : float
        Compliance of the whole line that the law of a sleeve has as well, mm/N (`ltca.laws.backed.BackedLaw`).
    """

    length: float
    contact_modulus: float
    datum: float
    slices: int
    relief: FloatArray = by_drive(2)
    overlap: float = 0.0

    @property
    def plane(self) -> ContactLaw:
        """The law of the whole length."""
        law = PlaneContactLaw(thickness=self.length, contact_modulus=self.contact_modulus, datum=self.datum)
        return BackedLaw(contact=law, seat=None, play=np.zeros(1), overlap=self.overlap) if self.overlap else law

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives, as `ltca.laws.sliced_line.SlicedLine.respond`; `start` is of no use."""
        z = slice_heights(self.length, self.slices)
        weights = 0.5 / self.slices * np.polynomial.legendre.leggauss(POINTS)[1] * np.ones(z.shape)
        delta, theta, radius = (
            np.asarray(each)[..., None, None] for each in np.broadcast_arrays(approach, tilt, effective_radius)
        )
        local = delta + theta * z - self._relief_of(delta)
        whole, slope = self.plane.load_and_stiffness(local, np.broadcast_to(radius, local.shape))
        load, carried = weights * whole, weights * slope
        each = load.sum(axis=-1), carried.sum(axis=-1), (carried * z).sum(axis=-1)
        both = (-2, -1)
        return SlicedContact(
            load=load.sum(axis=both),
            moment=(load * z).sum(axis=both),
            by_approach=carried.sum(axis=both),
            by_tilt=(carried * z).sum(axis=both),
            moment_by_tilt=(carried * z**2).sum(axis=both),
            slice_load=each[0],
            line_load=whole / self.length,
            near=np.concatenate((delta[..., 0], theta[..., 0], *each), axis=-1),
        )

    def _relief_of(self, approach: FloatArray) -> FloatArray:
        """h against approaches, shape (…, 1, 1): of several drives their first axis."""
        relief = self.relief
        return relief if relief.ndim == 2 else relief.reshape(-1, *(1,) * (approach.ndim - 3), *relief.shape[1:])

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy of contacts, N·mm, shape (…)."""
        z = slice_heights(self.length, self.slices)
        weights = 0.5 / self.slices * np.polynomial.legendre.leggauss(POINTS)[1]
        delta, theta = (contact.near[..., number, None, None] for number in (0, 1))
        local = delta + theta * z - self._relief_of(delta)
        radius = np.broadcast_to(np.asarray(effective_radius)[..., None, None], local.shape)
        return np.asarray((self.plane.energy(local, radius) @ weights).sum(axis=-1))
