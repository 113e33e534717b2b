"""Curves with their names at their right ends, in the style of the house; discs and cranks as cases of their own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

# Okabe and Ito's palette, readable with every kind of colour vision; black first for the clearance-free case.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A7A7A")
STYLE: Any = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.2,
    # Names of drives and cases are the user's: a dollar sign in them starts no formula.
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "cyclo",
    "figure.constrained_layout.use": True,
}


DASHES: tuple[Any, ...] = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (6, 1.5, 1, 1.5)), (0, (8, 3)))
"""Lines of disc after disc."""
MOST_CURVES = 16
"""Names beside one axes; more cannot be told apart."""


class Line(NamedTuple):
    """How a curve is drawn.

    Attributes
    ----------
    colour : str
        Of the line and its name.
    dashes : str or tuple
        A line style of matplotlib's.
    """

    colour: str
    dashes: Any = "-"


def plain_lines(count: int) -> list[Line]:
    """Return lines of curves that differ in colour alone."""
    return [Line(COLOURS[number % len(COLOURS)]) for number in range(count)]


def lines_of(dataset: xr.Dataset) -> list[Line]:
    """Lines of what `_one_by_one` has put side by side."""
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


def draw_curves(
    figure: Figure,
    axes: Any,
    x: FloatArray,
    curves: FloatArray,
    names: Sequence[str],
    x_label: str,
    y_label: str,
    limits: tuple[float, float] | None = None,
    lines: Sequence[Line] | None = None,
) -> None:
    """Draw one curve for each case and put its name at its right end, moved apart where ends coincide.

    The limits of y are from zero where nothing is negative, unless they are given.
    """
    order = np.argsort(x, kind="stable")
    few = x.size < 40
    lines = plain_lines(len(curves)) if lines is None else lines
    for curve, line in zip(curves, lines, strict=True):
        marker = "o" if few else None
        axes.plot(x[order], curve[order], color=line.colour, linestyle=line.dashes, marker=marker, markersize=3.0)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.margins(x=0.0)
    if limits is not None:
        axes.set_ylim(*limits)
    elif np.nanmin(curves) >= 0.0:
        axes.set_ylim(bottom=0.0)
    mark_a_turn(axes, x[order])
    _label_ends(axes, x[order], curves[:, order], names, lines)


def mark_a_turn(axes: Any, x: FloatArray) -> None:
    """Give a whole turn its ticks at sixths."""
    if x.size > 1 and np.isclose(x[0], 0.0) and x[-1] > 300.0:
        axes.set_xlim(0.0, 360.0)
        axes.set_xticks(np.arange(0.0, 361.0, 60.0))


def _label_ends(axes: Any, x: FloatArray, curves: FloatArray, names: Sequence[str], lines: Sequence[Line]) -> None:
    low, high = axes.get_ylim()
    ends = (curves[:, -1] - low) / (high - low)
    order = np.argsort(np.round(ends, 6), kind="stable")  # ends that coincide keep the order of the names
    gap = 0.062
    places = ends[order].copy()
    for _ in range(200):  # push overlapping labels apart, half each way
        moved = False
        for i in range(1, places.size):
            overlap = gap - (places[i] - places[i - 1])
            if overlap > 1e-6:
                places[i] += 0.5 * overlap
                places[i - 1] -= 0.5 * overlap
                moved = True
        if not moved:
            break
    places += max(0.0, -places[0]) if places[-1] <= 1.0 else min(0.0, 1.0 - places[-1])
    right = (x[-1] - axes.get_xlim()[0]) / (axes.get_xlim()[1] - axes.get_xlim()[0])
    for place, number in zip(places, order, strict=True):
        frame = {"color": lines[number].colour, "transform": axes.transAxes, "clip_on": False}
        axes.text(1.045, place, names[number], va="center", fontsize=8.5, **frame)
        # A plain line: an arrow to the text is clipped at its frame by bisection, a quarter of the time of a figure.
        axes.add_artist(Line2D([right, 1.038], [ends[number], place], linewidth=0.6, **frame))


def case_names(dataset: xr.Dataset) -> list[str]:
    """Return the names of the cases."""
    return [str(name) for name in dataset["case"].values]


CRANK = "crank angle φ_C [°]"
"""Label of the axis that most figures share."""


def one_by_one(dataset: xr.Dataset, cranks: int) -> xr.Dataset:
    """Return every disc of every case, on every crank, as a case of its own; of too many the cases that have room.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `ltca.analysis.results.build_dataset`.
    cranks : int
        How many of the cranks are shown, the first of them.
    """
    discs = dataset.sizes["disc"]
    if discs * cranks == 1:
        return dataset.isel(disc=0, crank=0)
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
