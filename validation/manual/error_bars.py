"""Error bars of values that are computed on grids of several sizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeVar

from validation.manual.case import Figure
from validation.rows import Row

Size = TypeVar("Size")

HALVED = "change by the last halving of elements or cells; the largest change of all sizes where changes do not fall"
"""How `change_by_halving` finds an error bar, in words."""
ROUND_OFF = 1e-12
"""Least error bar of a ratio, whatever its changes."""


def change_by_halving(values: Sequence[float]) -> float:
    """Return the error bar of the last of values found with elements, cells or steps halved each time.

    It is the change by the last halving: the error that is left is smaller from first-order convergence on. Where changes do
    not fall there is no order of convergence, and the largest change of all counts.

    Parameters
    ----------
    values : sequence of float
        At least two, coarsest first.

    Examples
    --------
    >>> change_by_halving([1.4, 1.1, 1.0])
    0.10000000000000009
    >>> change_by_halving([1.0, 1.1, 1.4, 1.3])
    0.2999999999999998
    """
    changes = [abs(after - before) for before, after in pairwise(values)]
    falling = all(after <= before for before, after in pairwise(changes))
    return changes[-1] if falling else max(changes)


def figures_by_size(
    rows_at: Callable[[Size], Sequence[Row]],
    sizes: Sequence[Size],
    of: str,
    *,
    least_error: Callable[[Row], float] = lambda row: 0.0 if row.difference_unit else ROUND_OFF,
    reference_error: Callable[[Row], float] = lambda row: 0.0,
) -> list[Figure]:
    """Return rows of the validation report as figures, with error bars from elements or cells halved each time.

    Parameters
    ----------
    rows_at : callable
        The rows at one size.
    sizes : sequence
        Coarsest first; the figures are those of the last.
    of : str
        What the sizes are, for the pages: "4, 8, 16 elements for the half-width".
    least_error : callable
        Least error bar of a row, whatever its changes, in the unit of its difference; round-off of ratios by default.
    reference_error : callable
        Error of the reference of a row, in the unit of its difference; none by default.
    """
    figures = []
    for found in zip(*(rows_at(size) for size in sizes), strict=True):
        # Of a row that must only have a sign the difference is zero as soon as it has it.
        error = change_by_halving([row.value if row.reference is None else row.difference for row in found])
        figures.append(
            Figure.of_row(
                found[-1],
                numerical_error=max(error, least_error(found[-1])),
                numerical_origin=f"{HALVED} ({of})",
                reference_error=reference_error(found[-1]),
            )
        )
    return figures
