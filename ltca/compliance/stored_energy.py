r"""Energy that the contacts of a disc store at a pose, and the work that goes with its change beside that of their forces.

With the near-field approaches ε of all contacts, their loads F and the coefficients C of the bodies between them,

.. math:: U = \sum_i \int_0^{\epsilon_i} F\,d\epsilon + \tfrac12 F^T C F, \qquad \delta = \epsilon + C F .

Contacts move over the bodies: to other radii of curvature ρ, and to other places, between which C differs. Forces act along the
normals alone, so that along a motion

.. math:: dU = F^T d\delta + \sum_i \frac{\partial U_i}{\partial\varrho_i} d\varrho_i - \tfrac12 F^T\,dC\,F ,

the derivative by ρ being that of the law at a held ε. Contacts that do not feel each other have no C. Of contacts in slices ε are
approaches and tilts, F loads and moments, and a law stores what its slices do together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ltca.arrays import FloatArray

RADIUS_STEP = 1e-4
"""Relative step of an effective radius for the derivative of an energy."""


class Pressed(NamedTuple):
    """Contacts of one kind: their law, approaches, shape (positions, pairs), and effective radii, mm; in slices tilts, and what
    they start from (`ltca.laws.sliced_contact.SlicedContact.near`).
    """

    law: Any
    approach: FloatArray
    radius: FloatArray
    tilt: FloatArray | None = None
    near: FloatArray | None = None

    def energy(self, radius: FloatArray) -> FloatArray:
        """Return what the contacts store at effective radii, N·mm, shape (positions, pairs)."""
        if self.tilt is None:
            return np.asarray(self.law.energy(self.approach, radius))
        curved = np.broadcast_to(radius, self.approach.shape)
        return np.asarray(self.law.energy(self.law.respond(self.approach, self.tilt, curved, self.near), curved))


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredEnergy:
    """Energy of the contacts of a disc.

    Attributes
    ----------
    energy : array, shape (positions,)
        U, N·mm.
    radius, by_radius : array, shape (positions, z_P)
        ρ of wheel pins and flank, mm, and ∂U/∂ρ, N.
    load : array, shape (positions, contacts)
        F, N.
    coefficients : array, shape (positions, contacts, contacts)
        C, mm/N; of no contact where they do not feel each other.
    """

    energy: FloatArray
    radius: FloatArray
    by_radius: FloatArray
    load: FloatArray
    coefficients: FloatArray

    @classmethod
    def of_laws(cls, pins: Pressed, others: Sequence[Pressed]) -> StoredEnergy:
        """Return what the laws store, of wheel pins and of the other kinds: of contacts that do not feel each other."""
        radius, positions = pins.radius, pins.approach.shape[0]
        low, high = (pins.energy(radius * (1.0 + side)) for side in (-RADIUS_STEP, RADIUS_STEP))
        energy = sum(kind.energy(kind.radius).sum(axis=-1) for kind in others)
        return cls(
            energy=np.asarray(pins.energy(radius).sum(axis=-1) + energy),
            radius=radius,
            by_radius=(high - low) / (2.0 * RADIUS_STEP * radius),
            load=np.zeros((positions, 0)),
            coefficients=np.zeros((positions, 0, 0)),
        )

    def work_to(self, other: StoredEnergy) -> tuple[FloatArray, FloatArray]:
        """Return ∫∂U/∂ρ dρ and −½∫Fᵀ dC F on the way to other poses nearby, by trapezoids, N·mm, shape (positions,)."""
        curvature = 0.5 * ((self.by_radius + other.by_radius) * (other.radius - self.radius)).sum(axis=-1)
        change = other.coefficients - self.coefficients
        squares = [np.einsum("bi,bij,bj->b", each.load, change, each.load) for each in (self, other)]
        return np.asarray(curvature), -0.25 * (squares[0] + squares[1])
