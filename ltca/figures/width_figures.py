"""Figure of contacts in slices: line load and pressure along the width of the most loaded wheel pin and roller."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.arrays import place_of_largest
from ltca.figures.curve_panels import case_names, lines_of
from ltca.figures.house_style import INK, shortened_label

PARTS = (
    ("pin", "pin_load", "z_pin", "pin_line_load", "pin_pressure_along_width", "wheel pin"),
    (
        "roller",
        "roller_load",
        "z_roller",
        "roller_line_load",
        "roller_pressure_along_width_outer",
        "roller in the bore",
    ),
)
"""Part, its load, height, line load and pressure in the dataset, and its name."""
LETTERS = 40
"""Of a name in the legend."""
MOST_NAMES = 8
"""Names in the legend: beyond that curves are told by the table."""


def draw_along_width(figure: Figure, data: xr.Dataset, _: Any = None) -> None:
    """Draw them at the position at which the load is largest, a curve for each case; `data` comes from `one_by_one`."""
    names, lines = case_names(data), lines_of(data)
    figure.set_figheight(4.6 + 0.16 * (min(len(names), MOST_NAMES) if len(names) > 1 else 0))
    grid = figure.subplots(2, len(PARTS), sharex="col", sharey="row", squeeze=False)
    for column, (_, load, height, line_load, pressure, name) in enumerate(PARTS):
        told = []
        for case, line in enumerate(lines):
            loads = data[load].values[case]
            position, pair = place_of_largest(loads)
            z = data[height].values[case]
            edges = np.append(z - 0.5 * (z[1] - z[0]), z[-1] + 0.5 * (z[1] - z[0]))
            for row, variable in enumerate((line_load, pressure)):
                values = data[variable].values[case, position, pair]
                grid[row, column].stairs(
                    values, edges, baseline=None, color=line.colour, linestyle=line.dashes, linewidth=1.4,
                    label=shortened_label(names[case], LETTERS),
                )  # fmt: skip
            told.append((pair, float(np.degrees(data["crank_angle"].values[position]))))
        which = f"{name}, where it carries most"
        if len(told) == 1:
            which = f"{name} {told[0][0]} at {told[0][1]:.0f}°"
        grid[0, column].set_title(which, color=INK)
        grid[1, column].set_xlabel("height above mid-width [mm]")
    grid[0, 0].set_ylabel("line load [N/mm]")
    grid[1, 0].set_ylabel("largest pressure [MPa]")
    for row in range(2):
        grid[row, 0].set_ylim(bottom=0.0)
    if 1 < len(names) <= MOST_NAMES:
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=min(3, len(names)), frameon=False)
    figure.suptitle("Line load and pressure along the width, mean over each slice")
