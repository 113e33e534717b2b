"""Figures of an optimisation: the search in one aim over every variable, or the Pareto front of two."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ltca.drive.fields import whose
from ltca.figures.field_scale import field_scale
from ltca.figures.house_style import COLOURS, DASHED, OTHERS, STYLE, save_figure
from ltca.quantities import SCALARS
from ltca.studies.optimiser import Optimum, describe_bound, front_span


def write_optimum_figure(optimum: Optimum, solved: str, folder: Path, kind: str = "svg") -> Path:
    """Write the figure of candidates, as ``svg``, ``png`` or ``pdf``, and return the file; `solved` tells how they were."""
    two = len(optimum.problem.aims) == 2
    with mpl.rc_context(STYLE):
        title = _title(optimum, solved)
        figure, name = (_front(optimum, title), "pareto") if two else (_search(optimum, title), "search")
    return save_figure(figure, folder / "figures" / f"{name}.{kind}")


def _title(optimum: Optimum, solved: str) -> str:
    limits = ", ".join(describe_bound(limit) for limit in optimum.problem.limits)
    told = f"{len(optimum.variables)} candidates × {solved}" + (f", subject to {limits}" if limits else "")
    return fill(told, 76)


def _front(optimum: Optimum, title: str) -> Figure:
    figure = Figure(figsize=(6.4, 4.6))
    axes = figure.subplots()
    points = optimum.values[:, :2]
    fine = optimum.feasible
    axes.plot(*points[~fine].T, ".", color=OTHERS, markersize=3.0, label="beyond a limit")
    axes.plot(*points[fine].T, ".", color=COLOURS[6], markersize=4.0, label="within the limits")
    axes.plot(*points[optimum.front].T, "o-", color=COLOURS[1], markersize=4.0, label="Pareto front")
    left, right, low, high = front_span(optimum)
    near = left <= optimum.start[0] <= right and low <= optimum.start[1] <= high
    told = "the drive as it is" + ("" if near else ", beyond the axes")
    axes.plot(*optimum.start[:2], "s", color=COLOURS[0], label=told)
    axes.plot(*points[optimum.best], "D", color=COLOURS[2], label="compromise")
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_xlabel(SCALARS[optimum.problem.aims[0]].heading)
    axes.set_ylabel(SCALARS[optimum.problem.aims[1]].heading)
    axes.legend(frameon=False, fontsize=8.0)
    figure.suptitle(title, fontsize=9.5)
    return figure


def _search(optimum: Optimum, title: str) -> Figure:
    count = len(optimum.problem.variables)
    columns = min(count, 4)
    rows = -(-count // columns)
    figure = Figure(figsize=(max(1.2 + 3.0 * columns, 6.8), 0.8 + 3.0 * rows))
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    all_axes = grid.ravel()[:count]
    for spare in grid.ravel()[count:]:
        spare.set_visible(False)
    aim, fine = optimum.values[:, 0], optimum.feasible
    for column, (axes, variable) in enumerate(zip(all_axes, optimum.problem.variables, strict=True)):
        scale, unit = field_scale(variable.path, np.array([variable.low, variable.high]))
        x = scale * optimum.variables[:, column]
        if not fine.all():
            axes.plot(x[~fine], aim[~fine], ".", color=OTHERS, markersize=3.0, label="beyond a limit")
        axes.plot(x[fine], aim[fine], ".", color=COLOURS[6], markersize=3.5, label="within the limits")
        axes.plot(x[optimum.best], aim[optimum.best], "D", color=COLOURS[2], label="best")
        axes.axhline(optimum.start[0], color=COLOURS[0], linewidth=0.8, linestyle=DASHED, label="as it is")
        owner = whose(optimum.problem.drive, variable.path)
        axes.set_xlabel(variable.path + (f" [{unit}]" if unit else "") + (f"\n({owner})" if owner else ""))
        axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
    for axes in grid[:, 0]:
        axes.set_ylabel(SCALARS[optimum.problem.aims[0]].heading)
    # Below all axes: points lie anywhere in them.
    handles, words = all_axes[-1].get_legend_handles_labels()
    figure.legend(handles, words, loc="outside lower center", ncols=2 if count == 1 else 4, frameon=False, fontsize=7.5)
    figure.suptitle(title, fontsize=9.5)
    return figure
