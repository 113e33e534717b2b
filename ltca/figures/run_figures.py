"""Figures of a run, corresponding to the paper's Fig. 23–26, 28–30 and 34–36: a panel for each case, the others behind.

Several discs have a curve each: dashed from the second on, of several cases in the colour of their case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.analysis.summary import LOADED_FRACTION
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCSEC
from ltca.figures.crank_figures import HALF_TURN, draw_cranks, draw_rollers_of_each_crank, mark_a_half_turn
from ltca.figures.curve_panels import (
    MARKED_POSITIONS,
    MOST_CURVES,
    case_names,
    degrees,
    draw_panels,
    lines_of,
    mark_a_turn,
    name_panel,
    one_by_one,
    set_axis,
)
from ltca.figures.house_style import CRANK, INK, MARK, OTHERS, STYLE, formula, save_figure
from ltca.figures.mesh_range import elements_shown, loaded_window
from ltca.figures.shared_axes import Axis, deviation, run_axes, run_values, torque_shares
from ltca.figures.width_figures import draw_along_width

Axes: TypeAlias = Mapping[str, Axis]
"""By the names of `ltca.figures.shared_axes.run_values`."""
Draw: TypeAlias = Callable[[Figure, xr.Dataset, Axes], None]
MESHES_SHOWN = 20
"""Of more meshes in a turn the steps of the numbers of loaded contacts would be hatching: fewer are shown."""


@cache
def _shipped() -> str:
    from ltca.reading.drive_file import shipped_drive

    return shipped_drive()


def with_paper_number(title: str, number: int, dataset: xr.Dataset) -> str:
    """Return a title with the number of the paper's figure, where the drive is the paper's."""
    return f"{title} (Fig. {number})" if dataset.attrs.get("drive_file") == _shipped() else title


def _loaded(dataset: xr.Dataset, name: str) -> FloatArray:
    load = dataset[name].values
    largest = load.max(axis=(1, 2), keepdims=True)
    return np.asarray((load > LOADED_FRACTION * largest).sum(axis=2), dtype=float)


def _torque_words(data: xr.Dataset, name: str) -> str:
    """The torque of all cases, with its unit; of different ones from the least to the largest."""
    if name not in data.coords:
        return ""
    values = np.abs(np.atleast_1d(data[name].values)) / 1e3
    least, most = f"{values.min():.4g}", f"{values.max():.4g}"
    return f", {least if least == most else f'{least} … {most}'} N·m"


def _transmission_error(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
    names, lines, x = case_names(data), lines_of(data), degrees(data)
    rows = len(names)
    figure.set_figheight(max(3.6, 1.0 + 1.1 * rows))
    grid = figure.subplots(rows, 2, sharex=True, sharey="col", squeeze=False)
    order = np.argsort(x, kind="stable")
    told = (
        (f"light torque{_torque_words(data, 'light_torque')}", "transmission_error_light", axes_of["light/te"]),
        (f"full torque{_torque_words(data, 'torque')}", "transmission_error", axes_of["full/te"]),
    )
    for column, (words, name, axis) in enumerate(told):
        values = deviation(data[name].values * ARCSEC)[:, order]
        for row in range(rows):
            axes = grid[row, column]
            marker = "o" if x.size < MARKED_POSITIONS else None
            axes.plot(
                x[order], values[row], color=lines[row].colour, linestyle=lines[row].dashes, marker=marker,
                markersize=3.0, zorder=2.5,
            )  # fmt: skip
            for other in np.delete(values, row, axis=0):
                axes.plot(x[order], other, color=OTHERS, linewidth=0.9, zorder=2.0)
            name_panel(axes, names[row], 2)
        grid[0, column].margins(x=0.0)
        set_axis(grid[0, column], axis)
        grid[0, column].set_title(words + "\n", loc="center")
        formula(grid[-1, column].set_xlabel(CRANK))
    mark_a_turn(grid[0, 0], x[order])
    figure.supylabel("deviation from the mean [″]", fontsize=9.0)
    member = "output (pin shaft)" if data.attrs.get("held") == "pin-wheel" else "wheel"
    figure.suptitle(with_paper_number(f"Transmission error at the {member}", 23, data))


def _over_its_mesh(load: str, name: str, label: str, words: str, number: int, axis: str) -> Draw:
    """One pin over the range in which it is loaded, by the load that tells the range."""

    def draw(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
        x = degrees(data)
        discs = np.atleast_1d(data["disc"].values) if "of_case" in data.coords else np.zeros(data.sizes["case"], int)
        shown = elements_shown(x, data[load].values, discs)
        pick = shown[discs][:, None, None]
        values, loads = (np.take_along_axis(data[one].values, pick, axis=2)[:, :, 0] for one in (name, load))
        different = len(set(shown.tolist())) > 1
        pins = f"s {', '.join(map(str, shown.tolist()))} of the discs" if different else f" {shown[0]}"
        panels = draw_panels(
            figure, x, values, case_names(data), CRANK, label, lines=lines_of(data),
            title=with_paper_number(words.format(pins), number, data), axis=axes_of[axis],
        )  # fmt: skip
        window = loaded_window(x, loads)
        if window is not None:
            panels[0].set_xlim(*window)
            panels[0].xaxis.set_major_locator(mpl.ticker.MaxNLocator(7, steps=[1, 1.5, 2, 3, 6, 10]))

    return draw


def _number_loaded(name: str, words: str, number: int) -> Draw:
    def draw(figure: Figure, data: xr.Dataset, _: Axes) -> None:
        names, x, counts, lines = case_names(data), degrees(data), _loaded(data, name), lines_of(data)
        order = np.argsort(x, kind="stable")
        # Whole numbers of six cases would lie on each other: one narrow axes each.
        figure.set_figheight(max(2.6, 1.1 + 0.72 * len(names)))
        axes = figure.subplots(len(names), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, case, count, line in zip(axes, names, counts, lines, strict=True):
            axis.step(x[order], count[order], where="mid", color=line.colour)
            axis.fill_between(x[order], count[order], step="mid", color=line.colour, alpha=0.12, linewidth=0.0)
            name_panel(axis, case)
            told = f"{count.min():.0f} to {count.max():.0f}, mean {count.mean():.2f}"
            axis.set_title(told, loc="right", fontsize=8.5, color=INK, pad=3.0)
        axes[0].set_ylim(max(0.0, counts.min() - 1.0), counts.max() + 0.5)
        axes[0].yaxis.set_major_locator(mpl.ticker.MaxNLocator(integer=True, nbins=3))
        axes[0].margins(x=0.0)
        mark_a_turn(axes[0], x[order])
        part = ""
        meshes = max(data.sizes["pin"], 1)
        if meshes > MESHES_SHOWN and np.ptp(x) > 300.0:
            end = 30.0 * max(1.0, round(12.0 * MESHES_SHOWN / meshes))
            axes[0].set_xlim(0.0, end)
            axes[0].set_xticks(np.arange(0.0, end + 1.0, end / 6.0))
            part = f", {end:.0f}° of the turn (ranges and means are those of all of it)"
        formula(axes[-1].set_xlabel(CRANK))
        figure.supylabel("number", fontsize=9.0)
        figure.suptitle(with_paper_number(words, number, data) + part)

    return draw


def _bearing(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
    total = np.hypot(data["bearing_radial"].values, data["bearing_tangential"].values)
    title = with_paper_number("Bearing load of the crank", 28, data)
    _over_the_turn(figure, data, total, "total bearing load [N]", title, axes_of["total"])


def _over_the_turn(figure: Figure, data: xr.Dataset, values: FloatArray, label: str, title: str, axis: Axis) -> Any:
    names, lines = case_names(data), lines_of(data)
    return draw_panels(figure, degrees(data), values, names, CRANK, label, axis=axis, lines=lines, title=title)


def _bearing_component(name: str, label: str, words: str, number: int) -> Draw:
    def draw(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
        title, axis = with_paper_number(words, number, data), axes_of[name.removeprefix("bearing_")]
        _over_the_turn(figure, data, data[name].values, label, title, axis)

    return draw


def _torque_share(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
    share, equal = data["torque_share"].values, 1.0 / (1 + int(data["disc"].values.max()))
    title = f"Part of the torque that each disc carries (largest {share.max():.3f}, equal parts {equal:.3f})"
    for axes in _over_the_turn(figure, data, share, "part of the torque", title, axes_of["share"]):
        axes.axhline(equal, color=MARK, linewidth=0.6)


def _roller_distribution(figure: Figure, data: xr.Dataset, axes_of: Axes) -> None:
    """Load of all rollers at all positions over their place against the eccentricity, which stands in the middle."""
    rollers = data.sizes["roller"]
    angle = data["crank_angle"].values
    speed = float(data["cage_speed"].values[0])
    place = speed * angle[:, None] + 2.0 * np.pi * np.arange(rollers) / rollers - angle[:, None]
    place = np.degrees(np.mod(place + np.pi, 2.0 * np.pi)) - HALF_TURN
    title = with_paper_number("Load distribution over the rollers", 34, data)
    if "of_case" in data.coords and np.ptp(data["crank"].values) > 0:
        draw_rollers_of_each_crank(
            figure, data, place, f"{title}, all discs: mean and range", axes_of["full/outer/load"]
        )
        return
    edges = np.linspace(-HALF_TURN, HALF_TURN, 121)
    centres = 0.5 * (edges[1:] + edges[:-1])
    bins = np.digitize(place, edges[1:-1])
    names = case_names(data)
    load = data["roller_load"].values
    if place.size < 4 * centres.size:
        order = np.argsort(place.ravel(), kind="stable")
        x, curves = place.ravel()[order], load.reshape(len(names), -1)[:, order]
    else:
        count = np.bincount(bins.ravel(), minlength=centres.size)
        met = count > 0  # at few positions rollers pass some places never
        x, sums = centres[met], [np.bincount(bins.ravel(), case.ravel(), minlength=centres.size) for case in load]
        curves = np.stack([total[met] / count[met] for total in sums])
    label = "angle of the roller from the eccentricity [°]"
    panels = draw_panels(
        figure, x, curves, names, label, "load on the bore [N]", axis=axes_of["full/outer/load"], lines=lines_of(data),
        title=title,
    )  # fmt: skip
    mark_a_half_turn(panels[0])


FIGURES: dict[str, Draw] = {
    "fig23_transmission_error": _transmission_error,
    "fig24_pin_load": _over_its_mesh(
        "pin_load", "pin_load", "load [N]", "Load of wheel pin{} over a mesh", 24, "full/pin/load"
    ),
    "fig25_loaded_pins": _number_loaded("pin_load", "Number of loaded wheel pins", 25),
    "fig26_pin_pressure": _over_its_mesh(
        "pin_load",
        "pin_pressure_mid",
        "pressure at mid-width [MPa]",
        "Largest flank pressure at wheel pin{}",
        26,
        "full/pin/pressure",
    ),
    "fig28_bearing_load": _bearing,
    "fig29_tangential_bearing_load": _bearing_component(
        "bearing_tangential", "tangential bearing load [N]", "Tangential bearing load", 29
    ),
    "fig30_radial_bearing_load": _bearing_component(
        "bearing_radial", "radial bearing load [N]", "Radial bearing load", 30
    ),
    "fig34_roller_load": _roller_distribution,
    "fig35_pin_shaft_load": _over_its_mesh(
        "pin_shaft_load", "pin_shaft_load", "load [N]", "Load of shaft pin{}", 35, "full/hole/load"
    ),
    "fig36_loaded_shaft_pins": _number_loaded("pin_shaft_load", "Number of loaded shaft pins", 36),
    "along_width": draw_along_width,
    "torque_share": _torque_share,
    "cranks": draw_cranks,
}


OF_THE_DRIVE = ("fig23_transmission_error",)
"""What is no disc's own."""
OF_SEVERAL_DISCS = ("torque_share",)
"""What a drive of one disc has not."""
OF_SEVERAL_CRANKS = ("cranks",)
"""What a drive with a central crank has not."""
OF_THE_CRANKS = (
    "fig28_bearing_load",
    "fig29_tangential_bearing_load",
    "fig30_radial_bearing_load",
    "fig34_roller_load",
    "along_width",
)
"""What every crank has of its own."""
OF_SLICES = ("along_width",)
"""What a drive has whose contacts have slices."""
OF_THE_PIN_SHAFT = ("fig35_pin_shaft_load", "fig36_loaded_shaft_pins")
"""What a drive without pin shaft has not."""


def figure_names(discs: int, holes: int, cranks: int = 1, slices: int = 1) -> list[str]:
    """Return the names of the figures of a run, keys of `FIGURES`; `holes` is 0 without a pin shaft."""
    missing: tuple[str, ...] = OF_SEVERAL_DISCS if discs == 1 else ()
    missing += OF_SEVERAL_CRANKS if cranks == 1 else ()
    missing += OF_THE_PIN_SHAFT if holes == 0 else ()
    missing += OF_SLICES if slices == 1 else ()
    return [name for name in FIGURES if name not in missing]


def figures_of(dataset: xr.Dataset) -> list[str]:
    """Return the names of the figures of the dataset of a run."""
    sizes = dataset.sizes
    return figure_names(sizes["disc"], sizes["hole"], sizes["crank"], sizes.get("slice", 1))


def draw_figure(name: str, dataset: xr.Dataset) -> Figure:
    """Return one figure of a run, a key of `FIGURES`; of several discs each has a curve."""
    axes_of = run_axes(run_values(dataset), dataset.sizes["disc"])
    dataset = _answered(dataset)
    if name in OF_SEVERAL_DISCS:
        dataset = dataset.assign(torque_share=torque_shares(dataset))
    shown = one_by_one(dataset, dataset.sizes["crank"] if name in (*OF_THE_CRANKS, *OF_SEVERAL_CRANKS) else 1)
    drawn = int(shown["of_case"].max()) + 1 if "of_case" in shown.coords else shown.sizes["case"]
    if name in OF_THE_DRIVE:
        drawn = min(dataset.sizes["case"], MOST_CURVES)
        shown = dataset.isel(disc=0, crank=0, case=slice(drawn))
    elif name in OF_SEVERAL_CRANKS:
        shown = dataset.isel(case=slice(drawn))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.9))
        FIGURES[name](figure, shown, axes_of)
        if drawn < dataset.sizes["case"]:
            layout: Any = figure.get_layout_engine()
            layout.set(rect=(0.0, 0.025, 1.0, 0.975))
            figure.text(0.005, 0.005, f"{drawn} of {dataset.sizes['case']} cases", fontsize=7.0)
    return figure


def _answered(dataset: xr.Dataset) -> xr.Dataset:
    """The positions at which every case has an answer."""
    states = [dataset[name].values for name in ("status", "status_light") if name in dataset]
    known = np.all([state == 0 for state in states], axis=(0, 1)) if states else np.zeros(0, dtype=bool)
    return dataset.isel(position=known) if np.any(known) and not np.all(known) else dataset


def write_figures(dataset: xr.Dataset, folder: Path, kind: str = "svg") -> Iterator[Path]:
    """Write every figure of a run as ``svg``, ``png`` or ``pdf`` and yield each file."""
    for name in figures_of(dataset):
        yield save_figure(draw_figure(name, dataset), folder / f"{name}.{kind}")
