"""Energy of contacts at a pose, with bodies and pins behind, and works beside those of forces (``docs/theory/motion.md``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import FloatArray

if TYPE_CHECKING:
    from ltca.mechanics.contacts import Linearised

RADIUS_STEP = 1e-4
"""Relative step of an effective radius for the derivative of an energy."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredEnergy:
    """Energy of the contacts of a disc."""

    energy: FloatArray  # U, N·mm, shape (positions,)
    radius: FloatArray  # ρ of wheel pins and flank, mm, shape (positions, z_P)
    by_radius: FloatArray  # ∂U/∂ρ, N
    load: FloatArray  # F, N, shape (positions, contacts); of no contact where they do not feel each other
    coefficients: FloatArray  # C, mm/N, shape (positions, contacts, contacts)

    def work_to(self, other: StoredEnergy) -> tuple[FloatArray, FloatArray]:
        """Return ∫∂U/∂ρ dρ and −½∫Fᵀ dC F on the way to other poses nearby, by trapezoids, N·mm, shape (positions,)."""
        curvature = 0.5 * ((self.by_radius + other.by_radius) * (other.radius - self.radius)).sum(axis=-1)
        change = other.coefficients - self.coefficients
        squares = [np.einsum("bi,bij,bj->b", each.load, change, each.load) for each in (self, other)]
        return np.asarray(curvature), -0.25 * (squares[0] + squares[1])


def stored_by_disc(at: Linearised) -> tuple[StoredEnergy, ...]:
    """Return the energy of the contacts of every disc, with the bodies between them."""
    return tuple(_of_disc(at, disc) for disc in range(at.system.discs))


def stored_by_pins(at: Linearised) -> FloatArray:
    """Return the energy of beams and ring that hold pins, ½ Σ F·S F, N·mm, shape (positions,)."""
    pins = at.system.model.pins
    if at.shifts is None or pins is None:
        return np.zeros(at.pose.shape[0])
    force = at.members.forces(at.corrected_load)
    return np.asarray(0.5 * (force.conjugate() * pins.under(force)).real.sum(axis=(1, 2)))


def _of_disc(at: Linearised, disc: int) -> StoredEnergy:
    """Energy of the laws at the deformations of their contacts, and that of the bodies, ½ FᵀCF."""
    system, kinds = at.system, at.system.of_kind[disc]
    laws, rows = system.laws[disc], at.pose.shape[0]
    pin_radius = at.discs[disc].flank.effective_radius
    radii = pin_radius, laws.outer_radius, laws.hole_radius, laws.inner_radius

    nears = [one.near for one in at.slices_after(disc)]

    def of_kind(number: int, radius: FloatArray) -> FloatArray:
        near = nears[number] if nears else None
        return system.contact_laws.energy(laws.laws[number], at.after[:, :, kinds[number]], at.half, radius, near)

    energy = sum((of_kind(number, radius).sum(axis=-1) for number, radius in enumerate(radii)), np.zeros(rows))
    low, high = (of_kind(0, pin_radius * (1.0 + side)) for side in (-RADIUS_STEP, RADIUS_STEP))
    bodies, loads, matrices = system.model.discs[disc], [np.zeros((rows, 0))], []
    if bodies.coefficients is not None:
        every = [np.tile(np.arange(kind.stop - kind.start), (rows, 1)) for kind in kinds[:3]]
        for component, body in enumerate(bodies.body_flexibility(at.body_places(disc), every)[: system.components]):
            load, matrix = at.corrected_load[:, component], body.among
            on_walls, in_bores, on_races = load[:, kinds[0].start : kinds[2].stop], load[:, kinds[1]], load[:, kinds[3]]
            energy = energy + 0.5 * np.einsum("bi,bij,bj->b", on_walls, matrix, on_walls)
            energy = energy + 0.5 * np.einsum("bi,bij,bj->b", on_races, body.on_race, on_races)
            energy = energy + body.across_roller * (in_bores * on_races).sum(axis=1)
            loads.append(on_walls)
            matrices.append(matrix)
    # Races and what rollers yield between their contacts are alike everywhere: they do no work as contacts move.
    load = np.concatenate(loads, axis=1)
    coefficients, first = np.zeros((rows, load.shape[1], load.shape[1])), 0
    for matrix in matrices:
        own = slice(first, first + matrix.shape[1])
        coefficients[:, own, own], first = matrix, own.stop
    return StoredEnergy(
        energy=energy,
        radius=pin_radius,
        by_radius=(high - low) / (2.0 * RADIUS_STEP * pin_radius),
        load=load,
        coefficients=coefficients,
    )
