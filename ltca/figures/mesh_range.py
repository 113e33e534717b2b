"""Choice of the pin that is shown over its mesh, and of the crank angles: the mesh is whole, with a small margin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.summary import LOADED_FRACTION
from ltca.arrays import FloatArray, IntArray

MARGIN = 0.08
"""Part of the length of a mesh that is shown before and after it."""
WINDOW_GRID = 5.0
"""Windows begin and end at whole multiples, degrees."""


def loaded_at(load: FloatArray) -> NDArray[np.bool_]:
    """Return where loads are more than nothing, by the largest of all."""
    return np.asarray(load > LOADED_FRACTION * max(float(np.nanmax(load)), 1e-300))


def elements_shown(crank_angle: FloatArray, load: FloatArray, discs: IntArray) -> IntArray:
    """Return which pin of each disc to show: the first whose mesh the positions do not cut in two.

    `crank_angle` in degrees has shape (positions,), `load` (cases, positions, pins), and `discs` (cases,) says whose loads they
    are. Of further discs the pins are those that mesh about when that of the first does, so that all fit one axis.
    """
    order = np.argsort(crank_angle, kind="stable")
    loaded = loaded_at(load)[:, order]
    chosen: list[int] = []
    middle = 0.0
    for disc in range(int(discs.max()) + 1):
        of_disc = loaded[discs == disc].any(axis=0)
        places = np.arange(of_disc.shape[0])[:, None]
        with np.errstate(invalid="ignore"):
            centre = (of_disc * places).sum(axis=0) / of_disc.sum(axis=0)
        whole = of_disc.any(axis=0) & ~of_disc[0] & ~of_disc[-1] & (np.diff(of_disc, axis=0).sum(axis=0) == 2)
        pins = np.flatnonzero(whole)
        if not pins.size:
            chosen.append(0)
        elif not chosen:
            chosen.append(int(pins[0]))
            middle = float(centre[pins[0]])
        else:
            chosen.append(int(pins[np.argmin(np.abs(centre[pins] - middle))]))
    return np.array(chosen)


def loaded_window(crank_angle: FloatArray, load: FloatArray) -> tuple[float, float] | None:
    """Return the crank angles, degrees, between which any of the curves is loaded, with a little room.

    Loads have shape (curves, positions); None where nothing would be left out, or nothing is loaded.
    """
    at = crank_angle[loaded_at(load).any(axis=0)]
    if at.size < 2:
        return None
    apart = float(np.max(np.diff(np.sort(crank_angle))))  # to the next position, where a curve has come down to nothing
    room = max(MARGIN * float(np.ptp(at)), WINDOW_GRID, apart)
    low = max(
        WINDOW_GRID * np.floor((at.min() - room) / WINDOW_GRID), WINDOW_GRID * np.floor(crank_angle.min() / WINDOW_GRID)
    )
    high = min(
        WINDOW_GRID * np.ceil((at.max() + room) / WINDOW_GRID), WINDOW_GRID * np.ceil(crank_angle.max() / WINDOW_GRID)
    )
    return (float(low), float(high)) if high - low < 0.95 * np.ptp(crank_angle) else None
