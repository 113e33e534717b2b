"""What the tests of reducers share."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.equilibrium.reducer import Reducer, disc_responses


@pytest.fixture
def stored():
    """The function that tells the energy stored in a reducer."""
    return stored_energy


def stored_energy(model, response, pose):
    """ΣU of contacts and supports, N·mm, and ∂U/∂ρ of every wheel pin, N, by differences of the law alone."""
    total, slopes = np.zeros(pose.shape[0]), []
    for disc, part in zip(model.discs, disc_responses(response), strict=True):
        laws, flank = disc.roller_laws, part.flank
        total = total + disc.pin_law.energy(flank.approach, flank.effective_radius).sum(axis=1)
        total = total + disc.hole_law.energy(part.holes.approach, disc.geometry.placement.hole_effective_radii).sum(
            axis=1
        )
        total = total + laws.inner.energy(part.rollers.inner_approach, laws.inner_radius).sum(axis=1)
        total = total + laws.outer.energy(part.rollers.outer_approach, laws.outer_radius).sum(axis=1)
        step = 1e-4 * flank.effective_radius
        ends = [disc.pin_law.energy(flank.approach, flank.effective_radius + side * step) for side in (1.0, -1.0)]
        slopes.append((ends[0] - ends[1]) / (2.0 * step))
    if isinstance(model, Reducer) and model.supports is not None:
        total = total + 0.5 * np.einsum("bi,ij,bj->b", pose, model.supports, pose)
    return total, np.concatenate(slopes, axis=1)
