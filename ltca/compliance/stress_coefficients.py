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
    """Stress along the walls at stations, for a newton at each station of the influence coefficients.

    Attributes
    ----------
    walls : tuple of Boundary
        Stress stations of flank, bores and holes.
    loaded : tuple of Boundary
        Stations of the loads, in the same order.
    stress : array, shape (stress stations, stations)
        Tension positive, MPa/N.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class WallContacts:
    """Contacts of one wall.

    Attributes
    ----------
    parameter : array, shape (positions, contacts)
        Places: θ on the flank, polar angles in the disc frame about their centres on bores and holes, rad.
    load : array, shape (positions, contacts)
        Into the disc, N.
    """

    parameter: FloatArray
    load: FloatArray


def read_stress_coefficients(data: Labelled, loaded: tuple[Boundary, ...]) -> StressCoefficients | None:
    """Return the stress coefficients of a file; None where it has none.

    Parameters
    ----------
    data : Dataset
        Content of the file, of the right schema (`ltca.reading.coefficient_schema`).
    loaded : tuple of Boundary
        Its stations: flank, bores, holes.
    """
    if "disc_stress" not in data:
        return None
    flank = loaded[0]
    return StressCoefficients(
        walls=boundaries_of(data["stress_station_boundary"].values.astype(int), flank.teeth, flank.clustering),
        loaded=loaded,
        stress=np.asarray(data["disc_stress"].values, dtype=float),
    )


def evaluate_wall_stress(coefficients: StressCoefficients, contacts: Sequence[WallContacts]) -> FloatArray:
    """Return the stress along the walls at all stress stations, shape (positions, stress stations), MPa.

    Parameters
    ----------
    coefficients : StressCoefficients
        Of the disc.
    contacts : sequence of WallContacts
        Of flank, each bore and each hole. Loads in equilibrium get one answer whatever balanced the unit loads when the
        coefficients were derived.
    """
    positions = contacts[0].load.shape[0]
    rows = np.arange(positions)[:, None, None]
    loads = np.zeros((positions, coefficients.stress.shape[1]))
    for boundary, own in zip(coefficients.loaded, contacts, strict=True):
        stations, weights = boundary.weights(own.parameter)
        np.add.at(loads, (rows, stations), weights * own.load[..., None])
    return np.asarray(loads @ coefficients.stress.T)
