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

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from ltca.arrays import FloatArray
from ltca.laws.contact_law import ContactLaw

if TYPE_CHECKING:
    from ltca.laws.sliced_contact import SlicedContact

RADIUS_STEP = 1e-4
"""Relative step of an effective radius for the derivative of an energy."""

Pressed: TypeAlias = tuple[ContactLaw, FloatArray, FloatArray]
"""Law of contacts of one kind, their approaches, shape (positions, pairs), and effective radii, mm."""


class LawInSlices(Protocol):
    """Law of contacts in slices that tells what they store."""

    def respond(
        self, approach: FloatArray, tilt: FloatArray, effective_radius: FloatArray, start: FloatArray | None = None
    ) -> SlicedContact:
        """Return what contacts carry, as `ltca.laws.sliced_line.SlicedLine.respond`."""
        ...

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy of contacts, N·mm."""
        ...


PressedInSlices: TypeAlias = tuple[LawInSlices, FloatArray, FloatArray, FloatArray, FloatArray | None]
"""Law of contacts of one kind in slices, their approaches and tilts, shape (positions, pairs), effective radii, mm, and what they
start from (`ltca.laws.sliced_contact.SlicedContact.near`)."""


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
        law, approach, radius = pins
        energy = sum(other.energy(pressed, curved).sum(axis=-1) for other, pressed, curved in others)
        return cls._of_kinds(lambda curved: law.energy(approach, curved), radius, energy)

    @classmethod
    def of_slices(cls, pins: PressedInSlices, others: Sequence[PressedInSlices]) -> StoredEnergy:
        """Return the same of contacts in slices, each kind at its approaches and tilts."""

        def stored(kind: PressedInSlices, curved: FloatArray) -> FloatArray:
            law, approach, tilt, _, start = kind
            return law.energy(law.respond(approach, tilt, curved, start), curved)

        energy = sum(stored(kind, np.broadcast_to(kind[3], kind[1].shape)).sum(axis=-1) for kind in others)
        return cls._of_kinds(lambda curved: stored(pins, curved), pins[3], energy)

    @classmethod
    def _of_kinds(
        cls, on_pins: Callable[[FloatArray], FloatArray], radius: FloatArray, others: FloatArray | float
    ) -> StoredEnergy:
        """What wheel pins store by their radii, and what the other kinds do."""
        low, high = (on_pins(radius * (1.0 + side)) for side in (-RADIUS_STEP, RADIUS_STEP))
        positions = radius.shape[0]
        return cls(
            energy=np.asarray(on_pins(radius).sum(axis=-1) + others),
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
