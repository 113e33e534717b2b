"""Error bars of a drive on nested meshes for ``summary.json``, for print and for the page.

All three say numerical uncertainty: what smaller elements would change. Uncertainty of the input (dimensions, materials) and of
the model (plane strain, supports) are none of it (ASME V&V 10, V&V 20).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from fem.discretisation_error import SAFETY_FACTOR, ErrorEstimate
from fem.reducer.nested_meshes import NestedFigure, NestedSolution
from ltca.drive.units.quantities import ARCSEC
from ltca.page.study_page import Section
from ltca.page.tables import Cell, Table, minus, number, word
from ltca.quantities import QUANTITIES

NUMERICAL = (
    "Error bars are numerical uncertainty alone: what smaller elements would change. What dimensions, materials, supports and "
    "plane strain are off by is none of it."
)
STATES = {
    "monotone": "converges",
    "slow": "slow, order below 0.5: 1.25 times the spread",
    "oscillating": "oscillates: the spread",
    "unsettled": "changes do not shrink: 3 times the spread",
}
"""What is told of each state of `fem.discretisation_error`."""
WHEEL_ANGLE = "wheel_angle"


def error_content(nested: NestedSolution) -> dict[str, Any]:
    """Return the key ``error`` of ``summary.json``: meshes, figures with error bars, stresses against closed forms."""
    return {
        "safety_factor": SAFETY_FACTOR,
        "meshes": [{"size": level.size, "dof": level.unknowns, "seconds": level.seconds} for level in nested.levels],
        "figures": [
            {
                "quantity": figure.quantity,
                "place": figure.place or None,
                "disc": figure.disc,
                "part": figure.part,
                "unit": figure.unit,
                "formal_order": figure.formal_order,
            }
            | _estimate(figure.estimate)
            for figure in nested.figures
        ],
        "closed_forms": [
            {
                "problem": reference.name,
                "source": reference.source,
                "unit": "MPa",
                "exact": reference.exact,
                "uncertainty": reference.uncertainty,
                "error": reference.error,
                "within_error_bar": reference.held,
            }
            | _estimate(reference.estimate)
            for reference in nested.references
        ],
    }


def _estimate(estimate: ErrorEstimate) -> dict[str, Any]:
    return {
        "values": list(estimate.values),
        "state": estimate.state,
        "observed_order": estimate.order if isfinite(estimate.order) else None,
        "extrapolated": estimate.extrapolated if isfinite(estimate.extrapolated) else None,
        "error_bar": estimate.bar,
    }


def told_title(figure: NestedFigure) -> str:
    """Return a quantity in words, that of ``fem.nc``."""
    quantity = QUANTITIES[figure.quantity]
    words = quantity.in_fem or quantity.description
    for rest in (", clear of contacts", ", ccw positive"):
        words = words.removesuffix(rest)
    return words


def told_unit(figure: NestedFigure) -> tuple[float, str]:
    """Return the factor and the unit in which a figure is told."""
    return (ARCSEC, "″") if figure.quantity == WHEEL_ANGLE else (1.0, figure.unit)


def mesh_words(nested: NestedSolution) -> str:
    """Return what the meshes are."""
    each = ", ".join(f"{level.size:g} ({level.unknowns:,} unknowns, {level.seconds:.1f} s)" for level in nested.levels)
    return f"nested meshes, edges of {each} of the default"


def error_lines(nested: NestedSolution) -> list[str]:
    """Return the lines that `cyclo fem --error` prints: largest figures, stresses against closed forms, what the bars mean."""
    rows = [("", "where", "finest mesh", "order", "extrapolated", "error bar", "part", "")]
    for figure in nested.largest:
        factor, unit = told_unit(figure)
        own = figure.estimate
        rows.append(
            (
                told_title(figure),
                figure.place,
                f"{factor * own.value:.7g} {unit}",
                _order(own),
                _extrapolated(own, factor),
                f"{factor * own.bar:.2g}",
                f"{100.0 * own.relative_bar:.2g} %",
                STATES[own.state],
            )
        )
    lines = [mesh_words(nested), *_columns(rows)]
    rows = [("stress against closed forms, MPa", "source", "finest mesh", "order", "exact", "error", "error bar", "")]
    for reference in nested.references:
        own = reference.estimate
        rows.append(
            (
                reference.name,
                reference.source,
                f"{own.value:.6g}",
                _order(own),
                f"{reference.exact:.6g}" + (f" ± {reference.uncertainty:.1g}" if reference.uncertainty else ""),
                f"{reference.error:+.2g}",
                f"{own.bar:.2g}",
                "within its bar" if reference.held else "beyond its bar",
            )
        )
    return [*lines, *_columns(rows), NUMERICAL]


def _order(estimate: ErrorEstimate) -> str:
    return f"{estimate.order:.2f}" if isfinite(estimate.order) else "–"


def _extrapolated(estimate: ErrorEstimate, factor: float) -> str:
    return f"{factor * estimate.extrapolated:.7g}" if isfinite(estimate.extrapolated) else "–"


def _columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Return rows as lines, the first two columns and the last on the left."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    last = len(widths) - 1
    return [
        "  "
        + "  ".join(
            text.ljust(width) if column in (0, 1, last) else text.rjust(width)
            for column, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def error_section(nested: NestedSolution) -> Section:
    """Return the section of the page: largest figures, every figure, closed forms."""
    columns = [
        "",
        "where",
        "finest mesh",
        "observed order",
        "extrapolated",
        "error bar",
        "part of value",
        "convergence",
    ]
    largest, every = ([_cells(figure) for figure in figures] for figures in (nested.largest, nested.figures))
    closed = [
        [
            word(reference.name),
            word(reference.source),
            number(reference.estimate.value, "{:.6g}", "MPa"),
            number(reference.estimate.order, "{:.2f}"),
            number(reference.exact, "{:.6g}", "MPa"),
            number(reference.error, "{:+.2g}", "MPa"),
            number(reference.estimate.bar, "{:.2g}", "MPa"),
            word("within its bar" if reference.held else "beyond its bar"),
        ]
        for reference in nested.references
    ]
    heads = ["", "source", "finest mesh", "observed order", "exact", "error", "error bar", "verdict"]
    return Section(
        heading="Error bars",
        notes=[minus(mesh_words(nested)) + ".", NUMERICAL],
        tables=[
            Table(name="errors", caption="", columns=columns, rows=largest, words=1, last_words=1),
            Table(
                name="closed_forms",
                caption="stress along walls against closed forms, on meshes of the same edges",
                columns=heads,
                rows=closed,
                words=1,
                last_words=1,
            ),
            Table(
                name="all_errors",
                caption="every contact above 5 % of the largest load of its kind",
                columns=columns,
                rows=every,
                words=1,
                last_words=1,
                folded=True,
            ),
        ],
    )


def _cells(figure: NestedFigure) -> list[Cell]:
    factor, unit = told_unit(figure)
    own = figure.estimate
    return [
        word(told_title(figure)),
        word(figure.place),
        number(factor * own.value, "{:.7g}", unit),
        number(own.order, "{:.2f}"),
        number(factor * own.extrapolated, "{:.7g}", unit),
        number(factor * own.bar, "{:.2g}", unit),
        number(100.0 * own.relative_bar, "{:.2g}", "%"),
        word(STATES[own.state]),
    ]
