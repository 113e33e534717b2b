"""What contacts of the one system store, with the bodies and pins behind them (`ltca.compliance.stored_energy`)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.compliance.stored_energy import Pressed, StoredEnergy

if TYPE_CHECKING:
    from ltca.mechanics.contacts import Linearised


def stored_by_disc(at: Linearised) -> tuple[StoredEnergy, ...]:
    """Return what the contacts of every disc store, with the bodies between them."""
    return tuple(_of_disc(at, disc) for disc in range(at.system.discs))


def stored_by_pins(at: Linearised) -> FloatArray:
    """Return what beams and ring store that hold pins, ½ Σ F·S F, N·mm, shape (positions,)."""
    pins = at.system.model.pins
    if at.shifts is None or pins is None:
        return np.zeros(at.pose.shape[0])
    force = at.members.forces(at.corrected_load)
    return np.asarray(0.5 * (force.conjugate() * pins.under(force)).real.sum(axis=(1, 2)))


def _of_disc(at: Linearised, disc: int) -> StoredEnergy:
    """Energy of the laws at the deformations of their contacts, and that of the bodies, ½ FᵀCF."""
    system, kinds = at.system, at.system.of_kind[disc]
    laws = system.laws[disc]
    radii = at.discs[disc].flank.effective_radius, laws.outer_radius, laws.hole_radius, laws.inner_radius
    deformation = [at.after[:, 0, kind] for kind in kinds]
    tilts: list[Any] = [None] * len(kinds)
    near: list[Any] = [None] * len(kinds)
    if system.components > 1:
        tilts = [at.after[:, 1, kind] / at.half for kind in kinds]
        near = [one.near for one in at.slices_after(disc)]
    pins, *others = map(Pressed, laws.laws, deformation, radii, tilts, near)
    found = StoredEnergy.of_laws(pins, others)
    bodies = system.model.discs[disc]
    if bodies.coefficients is None:
        return found
    rows = at.pose.shape[0]
    every = [np.tile(np.arange(kind.stop - kind.start), (rows, 1)) for kind in kinds[:3]]
    energy, loads, matrices = found.energy, [], []
    for component, body in enumerate(bodies.body_flexibility(at.body_places(disc), every)[: system.components]):
        load, matrix = at.corrected_load[:, component], body.among
        on_walls = np.concatenate([load[:, kind] for kind in kinds[:3]], axis=1)
        in_bores, on_races = load[:, kinds[1]], load[:, kinds[3]]
        energy = energy + 0.5 * np.einsum("bi,bij,bj->b", on_walls, matrix, on_walls)
        energy = energy + 0.5 * np.einsum("bi,bij,bj->b", on_races, body.on_race, on_races)
        energy = energy + body.across_roller * (in_bores * on_races).sum(axis=1)
        loads.append(on_walls)
        matrices.append(matrix)
    # Races and what rollers yield between their contacts are alike everywhere: they do no work as contacts move.
    count = loads[0].shape[1]
    whole = np.zeros((rows, len(loads), count, len(loads), count))
    for component, matrix in enumerate(matrices):
        whole[:, component, :, component] = matrix
    size = len(loads) * count
    return replace(
        found, energy=energy, load=np.concatenate(loads, axis=1), coefficients=whole.reshape(rows, size, size)
    )
