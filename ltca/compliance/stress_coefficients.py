"""Stress along the walls of the disc by the loads on it: reading from the coefficient file, and the stress they give.

The contact's own pressure along the wall under it is left out, so that stresses vary smoothly (docs/theory/coefficients.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ltca.arrays import FloatArray
from ltca.geometry.boundary_stations import Boundary, boundaries_of, turned_boundaries

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


@dataclass(frozen=True, slots=True, kw_only=True)
class StressCoefficients:
    """Stress along the walls at stations of flank, bores and holes by a newton at each station of the influence coefficients."""

    walls: tuple[Boundary, ...]  # stations of the stress
    loaded: tuple[Boundary, ...]  # those of the loads, in the same order
    stress: FloatArray  # tension positive, MPa/N, shape (stress stations, stations)

    def placed(self, *, bores: int, steps: int, pattern: int, flank_turn: float) -> StressCoefficients:
        """Return the coefficients of the part as it stands in a disc, see `InfluenceCoefficients.placed_in`."""
        walls, loaded = (
            turned_boundaries(boundaries, bores=bores, steps=steps, pattern=pattern, flank_turn=flank_turn)
            for boundaries in (self.walls, self.loaded)
        )
        return replace(self, walls=walls, loaded=loaded)


def read_stress_coefficients(data: Labelled, loaded: tuple[Boundary, ...]) -> StressCoefficients | None:
    """Return the stress coefficients of a file with stations on flank, bores and holes; None where it has none."""
    if "disc_stress" not in data:
        return None
    flank = loaded[0]
    return StressCoefficients(
        walls=boundaries_of(data["stress_station_boundary"].values.astype(int), flank.teeth, flank.clustering),
        loaded=loaded,
        stress=np.asarray(data["disc_stress"].values, dtype=float),
    )


def evaluate_wall_stress(
    coefficients: StressCoefficients, contacts: Sequence[tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """Return the stress at all stress stations, MPa, (positions, stations), from places and loads into the disc of every wall."""
    positions = contacts[0][1].shape[0]
    rows = np.arange(positions)[:, None, None]
    loads = np.zeros((positions, coefficients.stress.shape[1]))
    for boundary, (parameter, load) in zip(coefficients.loaded, contacts, strict=True):
        stations, weights = boundary.weights(parameter)
        np.add.at(loads, (rows, stations), weights * load[..., None])
    return np.asarray(loads @ coefficients.stress.T)
