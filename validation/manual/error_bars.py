"""Error bars of values that are computed on grids of several sizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from fem.discretisation_error import estimate_error
from validation.manual.case import Figure
from validation.rows import Row

Size = TypeVar("Size")

FORMAL_ORDER = 2.0
"""Order of stresses of quadratic elements and of constant cells: a higher observed one counts as this, it is chance."""
HALVED = "grid convergence index of three sizes, each half of the one before (ASME V&V 20, `fem.discretisation_error`)"
"""How `error_by_size` finds an error bar from three sizes, in words."""
DOUBLED = "change by twice as many"
"""How it finds one from two."""
ROUND_OFF = 1e-12
"""Least error bar of a ratio, whatever its changes."""


def error_by_size(values: Sequence[float], ratios: Sequence[float] | None = None) -> float:
    """Return the error bar of the last of values found with elements, cells or steps divided by a ratio each time.

    Of three and more values the grid convergence index, with the state of convergence of the last three; of two, as of positions
    over a turn, the change.

    Parameters
    ----------
    values : sequence of float
        At least two, coarsest first.
    ratios : sequence of float, optional
        By which each is finer than the one before, one less than values; halves by default.

    Examples
    --------
    >>> round(error_by_size([1.4, 1.1, 1.0]), 2)
    0.06
    >>> round(error_by_size([1.1, 1.0]), 3)
    0.1
    """
    if len(values) == 2:
        return abs(values[1] - values[0])
    return estimate_error(values, FORMAL_ORDER, ratios).bar


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
        error = error_by_size([row.value if row.reference is None else row.difference for row in found])
        figures.append(
            Figure.of_row(
                found[-1],
                numerical_error=max(error, least_error(found[-1])),
                numerical_origin=f"{HALVED if len(sizes) > 2 else DOUBLED} ({of})",
                reference_error=reference_error(found[-1]),
            )
        )
    return figures
