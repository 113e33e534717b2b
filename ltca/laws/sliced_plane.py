"""Plane strain in slices that do not feel each other: the near field of coefficients of finite elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.backed import BackedLaw
from ltca.laws.contact_law import ContactLaw
from ltca.laws.plane_strain import PlaneContactLaw
from ltca.laws.sliced_contact import EXACT, Exactness, SlicedContact, slice_heights, slice_means


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
        delta, theta, radius = (np.asarray(each) for each in np.broadcast_arrays(approach, tilt, effective_radius))
        local = self._local(delta, theta)
        whole, slope = self.plane.load_and_stiffness(local, np.broadcast_to(radius[..., None, None], local.shape))
        return SlicedContact.of_separate(delta, theta, whole / self.length, slope / self.length, self.length)

    def _local(self, approach: FloatArray, tilt: FloatArray) -> FloatArray:
        """Approaches of the points of contacts."""
        delta = approach[..., None, None]
        return np.asarray(
            delta + tilt[..., None, None] * slice_heights(self.length, self.slices) - self._relief_of(delta)
        )

    def _relief_of(self, approach: FloatArray) -> FloatArray:
        """h against approaches, shape (…, 1, 1): of several drives their first axis."""
        relief = self.relief
        return relief if relief.ndim == 2 else relief.reshape(-1, *(1,) * (approach.ndim - 3), *relief.shape[1:])

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy of contacts, N·mm, shape (…)."""
        local = self._local(contact.near[..., 0], contact.near[..., 1])
        radius = np.broadcast_to(np.asarray(effective_radius)[..., None, None], local.shape)
        return np.asarray(slice_means(self.plane.energy(local, radius)).sum(axis=-1) / self.slices)
