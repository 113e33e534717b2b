"""Which samples bind, by their geometry alone: where no other quantity tells the least backlash.

A pose in which no parts overlap proves that a sample moves there, and is found by a few linear programmes; the play itself, which
takes longer, is sought only where none is found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import BoolArray, FloatArray, take_rows
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError
from ltca.geometry.play import CLOSED, free_play, least_overlap

NO_BACKLASH = 1e-3
"""Backlash at the output that counts as none, arcmin. A choice: a hundred times the gain at which the search for the free play
ends (`ltca.geometry.play.LEAST_GAIN`, some 1e-5 arcmin), and a thousandth of the unit that backlashes are stated in."""

Rows = NDArray[np.intp]


def samples_that_bind(model: Reducer, drives: Sequence[Drive], crank_angle: FloatArray) -> BoolArray:
    """Return which samples have no backlash at the output at some position, shape (samples,).

    Parameters
    ----------
    model : Reducer
        Of all samples, a row for each position, sample by sample.
    drives : sequence of Drive
        The samples.
    crank_angle : array, shape (samples · positions,)
        φ_C, rad.
    """
    bound = np.zeros(len(drives), dtype=bool)
    every = np.arange(crank_angle.size).reshape(len(drives), -1)
    # Where most samples bind they do so at most positions: one decides on many of them.
    for columns in (slice(0, 1), slice(1, None)):
        left = np.flatnonzero(~bound)
        rows = every[left, columns]
        if not rows.size:
            continue
        overlap = _overlap(model, crank_angle, rows.ravel()).reshape(rows.shape)
        doubtful, worst = overlap > CLOSED, np.zeros(rows.shape, dtype=bool)
        worst[np.arange(left.size), np.argmax(overlap, axis=1)] = True
        for chosen in (doubtful & worst, doubtful & ~worst):
            sample, column = np.nonzero(chosen & ~bound[left, None])
            if sample.size:
                without = _without_backlash(model, drives, crank_angle, rows[sample, column])
                np.logical_or.at(bound, left[sample], without)
    return bound


def _overlap(model: Reducer, crank_angle: FloatArray, rows: Rows) -> FloatArray:
    """Least overlap found at some rows, mm; infinite where a programme has no answer."""
    try:
        return least_overlap([take_rows(disc, rows) for disc in model.geometries], crank_angle[rows])
    except ConvergenceError:
        return np.full(rows.size, np.inf)


def _without_backlash(model: Reducer, drives: Sequence[Drive], crank_angle: FloatArray, rows: Rows) -> BoolArray:
    """Rows without backlash at the output; one without an answer counts as none of them."""
    try:
        play = free_play([take_rows(disc, rows) for disc in model.geometries], crank_angle[rows]).play
    except ConvergenceError:
        if rows.size == 1:
            return np.zeros(1, dtype=bool)
        return np.concatenate([_without_backlash(model, drives, crank_angle, one) for one in np.split(rows, rows.size)])
    positions = crank_angle.size // len(drives)
    scale = np.array([abs(drives[row // positions].output_per_wheel_angle) for row in rows.tolist()])
    play = play + play_before_cranks(model, crank_angle)[rows]
    return np.asarray(scale * play * ARCMIN <= NO_BACKLASH)
