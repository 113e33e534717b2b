"""Contacts in slices that do not feel each other: a law of the plane at every height."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ltca.arrays import FloatArray, by_drive
from ltca.laws.contact_law import ContactLaw
from ltca.laws.sliced_contact import EXACT, Exactness, SlicedContact, rows_of, slice_heights, slice_means


@dataclass(frozen=True, slots=True, kw_only=True)
class SeparateSlices:
    """Law of contacts whose slices follow a law of the plane, each by its own approach: plane strain, springs, seats."""

    law: ContactLaw  # of the whole length
    length: float  # mm
    slices: int
    relief: FloatArray = by_drive(2)  # of lead and profile at the points (`slice_heights`), mm, shape (slices, points)

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
        pressed, line, slope = local > 0.0, np.zeros(local.shape), np.zeros(local.shape)
        contacts = np.nonzero(pressed)[:-2]
        line[pressed], slope[pressed] = self.law.take(delta.shape, contacts).load_and_stiffness(
            local[pressed], radius[contacts]
        )
        return SlicedContact.of_separate(delta, theta, line / self.length, slope / self.length, self.length)

    def take(self, shape: tuple[int, ...], places: Any) -> SeparateSlices:
        """Return the law of some contacts of a batch (`ltca.laws.contact_law.ContactLaw.take`)."""
        return replace(self, law=self.law.take(shape, places), relief=rows_of(self.relief, places))

    def energy(self, contact: SlicedContact, effective_radius: FloatArray | float) -> FloatArray:
        """Return the energy of contacts, N·mm, shape (…)."""
        local = self._local(contact.near[..., 0], contact.near[..., 1])
        pressed, stored = local > 0.0, np.zeros(local.shape)
        contacts, shape = np.nonzero(pressed)[:-2], local.shape[:-2]
        radius = np.broadcast_to(effective_radius, shape)[contacts]
        stored[pressed] = self.law.take(shape, contacts).energy(local[pressed], radius)
        return np.asarray(slice_means(stored).sum(axis=-1) / self.slices)

    def _local(self, approach: FloatArray, tilt: FloatArray) -> FloatArray:
        """Approaches of the points of contacts; reliefs of several drives go with the first axis."""
        delta, relief = approach[..., None, None], self.relief
        if relief.ndim > 2:
            relief = relief.reshape(-1, *(1,) * (approach.ndim - 1), *relief.shape[1:])
        return np.asarray(delta + tilt[..., None, None] * slice_heights(self.length, self.slices) - relief)
