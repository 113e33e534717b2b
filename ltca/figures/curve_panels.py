"""Curves in separate panels, the others grey behind; discs and cranks are shown as cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.arrays import FloatArray
from ltca.figures.house_style import COLOURS, INK, OTHERS, formula, shortened_label
from ltca.figures.shared_axes import Axis, axis_of

DASHES: tuple[Any, ...] = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (8, 3)))
"""Lines of disc after disc."""
MOST_CURVES = 16
"""Panels of one figure; more do not fit on a page."""
MARKED_POSITIONS = 40
"""Positions below which each is marked."""
TWO_COLUMNS_FROM = 4
"""Panels from which on they stand in two columns."""
ROW_HEIGHT = 1.25
"""Of panels, inches."""
UNNAMED_CASE = "nominal"
"""Name of the case of a drive without cases: it tells nothing."""
LETTERS = {1: 84, 2: 42}
"""Letters above a panel of the width of the figure, and of half of it."""
ROOM = 0.03
"""Part of an axis beyond its last ticks: lines on them are drawn whole."""


class Line(NamedTuple):
    """How a curve is drawn.

    Attributes
    ----------
    colour : str
        Of the line.
    dashes : str or tuple
        A line style of matplotlib's.
    """

    colour: str
    dashes: Any = "-"


def plain_lines(count: int) -> list[Line]:
    """Return lines of curves that differ in colour alone."""
    return [Line(COLOURS[number % len(COLOURS)]) for number in range(count)]


def lines_of(dataset: xr.Dataset) -> list[Line]:
    """Lines of what `one_by_one` has put side by side."""
    if "of_case" not in dataset.coords:
        return plain_lines(dataset.sizes["case"])
    discs = [int(disc) for disc in dataset["disc"].values]
    colours: Any = dataset["of_case"].values
    if len(set(colours)) == 1:  # by what differs: cranks before discs, which differ in their dashes
        colours = discs if np.ptp(dataset["crank"].values) == 0 else dataset["crank"].values
    return [
        Line(COLOURS[int(colour) % len(COLOURS)], DASHES[disc % len(DASHES)])
        for colour, disc in zip(colours, discs, strict=True)
    ]


def degrees(dataset: xr.Dataset) -> FloatArray:
    """Return the crank angles of a dataset, degrees."""
    return np.asarray(np.degrees(dataset["crank_angle"].values))


def panel_grid(figure: Figure, count: int) -> Any:
    """Return axes in one or two columns, row by row, that share both scales, and give the figure the height they need."""
    across = 1 if count < TWO_COLUMNS_FROM else 2
    rows = -(-count // across)
    figure.set_figheight(3.9 if count == 1 else max(3.6, 0.8 + ROW_HEIGHT * rows))
    grid = figure.subplots(rows, across, sharex=True, sharey=True, squeeze=False)
    for column, spare in enumerate(grid.ravel()[count:]):
        spare.set_visible(False)
        # The scale of x stands below the last panel of a column.
        grid[-2, across - 1 - column].tick_params(labelbottom=True)
    return grid.ravel()[:count]


def draw_panels(
    figure: Figure,
    x: FloatArray,
    curves: FloatArray,
    names: Sequence[str],
    x_label: str,
    y_label: str,
    *,
    axis: Axis | None = None,
    lines: Sequence[Line] | None = None,
    title: str = "",
) -> Any:
    """Draw each curve in a panel with its name above, all others grey behind it, to the same scales; return the axes.

    `x` has shape (positions,) in any order, `curves` (curves, positions). Labels have units, formulas between dollar signs.
    The `axis` of y is by default from zero where nothing is negative.
    """
    order = np.argsort(x, kind="stable")
    lines = plain_lines(len(curves)) if lines is None else lines
    panels = panel_grid(figure, len(curves))
    marker = "o" if x.size < MARKED_POSITIONS else None
    across = 1 if len(curves) < TWO_COLUMNS_FROM else 2
    for number, (axes, line) in enumerate(zip(panels, lines, strict=True)):
        others = [curve for place, curve in enumerate(curves) if place != number]
        # Own curves first: who reads a panel's lines finds what it is about.
        axes.plot(
            x[order], curves[number][order], color=line.colour, linestyle=line.dashes, marker=marker, markersize=3.0,
            zorder=2.5,
        )  # fmt: skip
        for other in others:
            axes.plot(x[order], other[order], color=OTHERS, linewidth=0.9, zorder=2.0)
        name_panel(axes, names[number], across)
    axes = panels[0]
    axes.margins(x=0.0)
    set_axis(axes, axis_of(curves, zero=bool(np.nanmin(curves) >= 0.0)) if axis is None else axis)
    mark_a_turn(axes, x[order])
    label_all(figure, panels, x_label, y_label)
    if title:
        figure.suptitle(title)
    return panels


def set_axis(axes: Any, axis: Axis) -> None:
    """Give the axis of y its range and its ticks."""
    room = ROOM * (axis.high - axis.low)
    axes.set_ylim(axis.low if axis.low == 0.0 else axis.low - room, axis.high + room)
    axes.set_yticks(axis.ticks)
    axes.ticklabel_format(axis="y", useOffset=False, style="plain")


def name_panel(axes: Any, name: str, across: int = 1) -> None:
    """Write a name above the left of a panel, shortened in its middle where panels `across` leave no room."""
    if name != UNNAMED_CASE:
        axes.set_title(shortened_label(name, LETTERS[across]), loc="left", fontsize=8.5, color=INK, pad=3.0)


def label_all(figure: Figure, panels: Any, x_label: str, y_label: str) -> None:
    """Label the axes of a single panel at it, of several once for all; formulas stand between dollar signs."""
    if len(panels) == 1:
        formula(panels[0].set_xlabel(x_label)), formula(panels[0].set_ylabel(y_label))
        return
    formula(figure.supxlabel(x_label, fontsize=9.0))
    formula(figure.supylabel(y_label, fontsize=9.0))


def mark_a_turn(axes: Any, x: FloatArray) -> None:
    """Give a whole turn its ticks at sixths."""
    if x.size > 1 and np.isclose(x[0], 0.0) and x[-1] > 300.0:
        axes.set_xlim(0.0, 360.0)
        axes.set_xticks(np.arange(0.0, 361.0, 60.0))


def case_names(dataset: xr.Dataset) -> list[str]:
    """Return the names of the cases."""
    return [str(name) for name in dataset["case"].values]


def one_by_one(dataset: xr.Dataset, cranks: int) -> xr.Dataset:
    """Return every disc of every case, on the first `cranks`, as a case; of too many the cases that have room."""
    discs = dataset.sizes["disc"]
    if discs * cranks == 1:
        return dataset.isel(disc=0, crank=0, case=slice(MOST_CURVES))
    shown = range(min(dataset.sizes["case"], max(1, MOST_CURVES // (discs * cranks))))
    curves = [(case, disc, crank) for case in shown for disc in range(discs) for crank in range(cranks)]
    words = ("case", "disc", "crank")
    index = {word: xr.DataArray([curve[place] for curve in curves], dims="case") for place, word in enumerate(words)}

    def named(case: int, disc: int, crank: int) -> str:
        told = [str(dataset["case"].values[case])] if dataset.sizes["case"] > 1 else []
        told += [f"disc {disc}"] if discs > 1 else []
        return ", ".join(told + ([f"crank {crank}"] if cranks > 1 else []))

    of_case = ("case", [case for case, _, _ in curves])
    return dataset.isel(index).assign_coords(case=[named(*curve) for curve in curves], of_case=of_case)
