r"""Stress along the walls of the disc by the loads on it: reading from the coefficient file, and the stress they give.

At a wall without load the stress has one component, along the wall. It is linear in the loads of all contacts: the
coefficients hold it at stations of flank, bore and hole walls, for a newton at each station of the influence coefficients
(format in docs/theory/coefficients.md). Right under a contact the wall carries the contact's own pressure along itself, too;
that part is not in the coefficients, so what they give varies smoothly along the wall and with the place of the load.
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
    """Stress along the walls at stations of flank, bores and holes, for a newton at each station of the influence coefficients.

    `walls` has the stations of the stress, `loaded` those of the loads in the same order; `stress`, tension positive, MPa/N, has
    the shape (stress stations, stations).
    """

    walls: tuple[Boundary, ...]
    loaded: tuple[Boundary, ...]
    stress: FloatArray

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
    """Return the stress along the walls at all stress stations, shape (positions, stress stations), MPa.

    `contacts` has of flank, each bore and each hole the places (θ, or polar angles in the disc frame about its centre, rad) and
    the loads into the disc, N, shape (positions, contacts). Loads in equilibrium get one answer whatever balanced the unit loads
    when the coefficients were derived.
    """
    positions = contacts[0][1].shape[0]
    rows = np.arange(positions)[:, None, None]
    loads = np.zeros((positions, coefficients.stress.shape[1]))
    for boundary, (parameter, load) in zip(coefficients.loaded, contacts, strict=True):
        stations, weights = boundary.weights(parameter)
        np.add.at(loads, (rows, stations), weights * load[..., None])
    return np.asarray(loads @ coefficients.stress.T)
