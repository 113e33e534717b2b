"""Where a quantity is largest: part and crank angle of a value."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray, place_of_largest
from ltca.drive.members.judgement import Value
from ltca.drive.members.verdict_words import part_words


def most_of(values: Iterable[Value]) -> Value:
    """Return the largest of one quantity at several kinds of contacts, at least one."""
    return max(values, key=lambda one: -1.0 if one.value is None else one.value)


def largest_value(
    analysis: LoadedAnalysis,
    quantity: str,
    values: FloatArray,
    name: str,
    refined: float | None = None,
    discs: int | None = None,
) -> Value:
    """Return the largest of values, shape (positions, pairs), as a limited quantity with its part and crank angle.

    Pairs are those of disc 0 first, of all discs unless `discs` says of how many; `name` is what a pair is called. Of equal
    values the first is named. A larger value between the positions, `refined`, counts at the place of the sampled one.
    """
    if not np.any(np.isfinite(values)):
        return Value(quantity=quantity, value=None, reason="the engine cannot say it")
    position, pair = place_of_largest(values)
    count = len(analysis.model.discs) if discs is None else discs
    disc, number = divmod(pair, values.shape[1] // count)
    part = part_words(analysis.drive, name, number, values.shape[1] // count, disc if discs is None else None)
    largest = float(np.nanmax(values))
    return Value(
        quantity=quantity,
        value=largest if refined is None else max(refined, largest),
        part=part,
        crank_angle=float(analysis.full.crank_angle[position]),
    )
