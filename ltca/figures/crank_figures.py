"""Figures of several cranks: moment and deflection of each, and the loads of its rollers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.arrays import FloatArray
from ltca.figures.curve_panels import (
    DASHES,
    TWO_COLUMNS_FROM,
    case_names,
    degrees,
    label_all,
    lines_of,
    mark_a_turn,
    name_panel,
    one_by_one,
    panel_grid,
    set_axis,
)
from ltca.figures.house_style import COLOURS, CRANK, OTHERS, formula
from ltca.figures.shared_axes import Axis, axis_of

SECTORS, FEWEST_IN_A_SECTOR = 60, 8
"""Places of the rollers about a crank at which mean and range are taken, and rollers of one disc that pass each."""
HALF_TURN = 180.0
"""Places of rollers run from minus to plus this, degrees: what the eccentricity loads stands in the middle."""


def draw_rollers_of_each_crank(figure: Figure, data: xr.Dataset, place: FloatArray, title: str, axis: Axis) -> None:
    """Draw mean and range of the roller loads of each crank, all its discs together, a panel for each crank.

    `place` is the angle of the rollers from the eccentricity, degrees from −180 to 180, of shape (discs and cranks, positions,
    rollers) or what broadcasts to it; `data` comes from `one_by_one`.
    """
    steps = min(SECTORS, max(4, place.size // FEWEST_IN_A_SECTOR))
    sector = np.minimum(((place + HALF_TURN) / 360.0 * steps).astype(int), steps - 1)
    load, names, lines = data["roller_load"].values, case_names(data), lines_of(data)
    owners = list(zip(data["of_case"].values.tolist(), data["crank"].values.tolist(), strict=True))
    told: dict[tuple[int, int], list[int]] = {}
    for row, owner in enumerate(owners):
        told.setdefault(owner, []).append(row)
    # At few positions rollers pass some places never.
    met = np.flatnonzero(np.bincount(sector.ravel(), minlength=steps))
    middle, drawn = (met + 0.5) * 360.0 / steps - HALF_TURN, []
    for (_, crank), rows in told.items():
        inside = [load[rows][:, sector == number] for number in met]
        low, mean, high = (np.array([pick(part) for part in inside]) for pick in (np.min, np.mean, np.max))
        of_disc = f"disc {int(data['disc'].values[rows[0]])}, crank {crank}"
        name = names[rows[0]]
        if name.endswith(of_disc):
            name = f"{name.removesuffix(of_disc)}crank {crank}"
        drawn.append((name, lines[rows[0]].colour, low, mean, high))
    panels = panel_grid(figure, len(drawn))
    for axes, (name, colour, low, mean, high) in zip(panels, drawn, strict=True):
        axes.fill_between(middle, low, high, color=colour, alpha=0.15, linewidth=0.0)
        axes.plot(middle, mean, color=colour, zorder=2.5)
        for _, _, _, other, _ in drawn:
            if other is not mean:
                axes.plot(middle, other, color=OTHERS, linewidth=0.9, zorder=2.0)
        name_panel(axes, name, 1 if len(drawn) < TWO_COLUMNS_FROM else 2)
    set_axis(panels[0], axis)
    mark_a_half_turn(panels[0])
    label_all(figure, panels, "angle of the roller from the eccentricity [°]", "load on the bore [N]")
    figure.suptitle(title)


def mark_a_half_turn(axes: Any) -> None:
    """Set the axis of roller angles from −180° to 180°."""
    axes.set_xlim(-HALF_TURN, HALF_TURN)
    axes.set_xticks(np.arange(-HALF_TURN, HALF_TURN + 1.0, 90.0))


def draw_cranks(figure: Figure, data: xr.Dataset, axes_of: Mapping[str, Axis]) -> None:
    """Draw the torque of each crank, and where they yield how far each goes in the plane of each disc."""
    cranks, yields = data.sizes["crank"], "crank_deflection_radial" in data
    torque = one_by_one(data.isel(disc=[0]), cranks)
    values, names = torque["crank_torque"].values / 1e3, case_names(torque)
    colours = [COLOURS[int(number) % len(COLOURS)] for number in torque["crank"].values]
    rows = len(names)
    figure.set_figheight(max(3.6, 1.0 + 1.25 * rows))
    grid = figure.subplots(rows, 1 + yields, sharex=True, sharey="col", squeeze=False)
    x = degrees(torque)
    order = np.argsort(x, kind="stable")
    for row in range(rows):
        axes = grid[row, 0]
        axes.plot(x[order], values[row][order], color=colours[row], zorder=2.5)
        for other in np.delete(values, row, axis=0):
            axes.plot(x[order], other[order], color=OTHERS, linewidth=0.9, zorder=2.0)
        name_panel(axes, names[row], 1 + yields)
    grid[0, 0].margins(x=0.0)
    set_axis(grid[0, 0], axes_of["crank"])
    heading = "Moment that holds each crank"
    if yields:
        shown = data.isel(case=np.unique(torque["of_case"].values))
        parts = (
            shown[name].transpose("case", "crank", "disc", "position").values
            for name in ("crank_deflection_radial", "crank_deflection_tangential")
        )
        moved = 1e3 * np.hypot(*parts).reshape(-1, shown.sizes["disc"], shown.sizes["position"])
        for row in range(rows):
            axes = grid[row, 1]
            for disc, curve in enumerate(moved[row]):
                dashes = DASHES[disc % len(DASHES)]
                axes.plot(x[order], curve[order], color=colours[row], linestyle=dashes, label=f"disc {disc}")
        set_axis(grid[0, 1], axis_of(moved, zero=True))
        if moved.shape[1] > 1:
            handles, words = grid[0, 1].get_legend_handles_labels()
            figure.legend(
                handles, words, loc="outside lower right", ncols=min(len(words), 5), frameon=False, fontsize=8.0
            )
        heading += ", and how far it yields on its bearings"
    for axes, label in zip(grid[rows // 2], ("torque [N·m]", "deflection at the disc [µm]"), strict=False):
        axes.set_ylabel(label)
    for axes in grid[-1]:
        formula(axes.set_xlabel(CRANK))
    mark_a_turn(grid[0, 0], x[order])
    figure.suptitle(heading)
