"""Figures of a run, corresponding to the paper's Fig. 23–26, 28–30 and 34–36: six cases per axes, labelled directly.

Several discs have a curve each: dashed from the second on, so that equal ones are both seen; of several cases in the
colour of their case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.analysis.summary import LOADED_FRACTION
from ltca.drive.units.quantities import ARCSEC
from ltca.figures.crank_figures import draw_cranks, draw_rollers_of_each_crank
from ltca.figures.labelled_curves import (
    CRANK,
    STYLE,
    FloatArray,
    case_names,
    degrees,
    draw_curves,
    lines_of,
    mark_a_turn,
    one_by_one,
)
from ltca.output.files import whole_file


def _loaded(dataset: xr.Dataset, name: str) -> FloatArray:
    load = dataset[name].values
    largest = load.max(axis=(1, 2), keepdims=True)
    return np.asarray((load > LOADED_FRACTION * largest).sum(axis=2), dtype=float)


def _transmission_error(figure: Figure, data: xr.Dataset) -> None:
    upper, lower = figure.subplots(2, 1, sharex=True)
    names = case_names(data)
    light, full = (data[name].values * ARCSEC for name in ("transmission_error_light", "transmission_error"))
    draw_curves(figure, upper, degrees(data), light - light.mean(axis=1, keepdims=True), names, "", "light torque [″]")
    draw_curves(figure, lower, degrees(data), full - full.mean(axis=1, keepdims=True), names, CRANK, "full torque [″]")
    member = "output (pin shaft)" if data.attrs.get("held") == "pin-wheel" else "wheel"
    figure.suptitle(f"Transmission error at the {member}, deviation from its mean (Fig. 23)")


def _one_quantity(
    name: str, element: int | None, label: str, title: str, factor: float = 1.0
) -> Callable[[Figure, xr.Dataset], None]:
    def draw(figure: Figure, data: xr.Dataset) -> None:
        values = data[name].values * factor
        if element is not None:
            values = values[:, :, element]
        axes = figure.subplots()
        draw_curves(figure, axes, degrees(data), values, case_names(data), CRANK, label, lines=lines_of(data))
        axes.set_title(title)

    return draw


def _number_loaded(name: str, title: str) -> Callable[[Figure, xr.Dataset], None]:
    def draw(figure: Figure, data: xr.Dataset) -> None:
        names, x, counts, lines = case_names(data), degrees(data), _loaded(data, name), lines_of(data)
        # Whole numbers of six cases would lie on each other: one narrow axes each.
        figure.set_figheight(max(figure.get_figheight(), 0.6 * len(names)))
        axes = np.atleast_1d(figure.subplots(len(names), 1, sharex=True, sharey=True))
        for number, (axis, case) in enumerate(zip(axes, names, strict=True)):
            axis.step(x, counts[number], where="mid", color=lines[number].colour)
            axis.set_ylim(counts.min() - 0.5, counts.max() + 0.5)
            axis.yaxis.set_major_locator(mpl.ticker.MaxNLocator(integer=True, nbins=3))
            axis.text(
                1.01, 0.5, f"{case}\nmean {counts[number].mean():.2f}", transform=axis.transAxes, va="center",
                color=lines[number].colour, fontsize=8.5,
            )  # fmt: skip
            axis.margins(x=0.0)
        mark_a_turn(axes[-1], x)
        axes[-1].set_xlabel(CRANK)
        figure.supylabel("number", fontsize=9.0)
        figure.suptitle(title)

    return draw


def _bearing(figure: Figure, data: xr.Dataset) -> None:
    total = np.hypot(data["bearing_radial"].values, data["bearing_tangential"].values)
    axes = figure.subplots()
    limits = (0.98 * total.min(), 1.01 * total.max())
    draw_curves(
        figure, axes, degrees(data), total, case_names(data), CRANK, "total bearing load [N]", limits, lines_of(data)
    )
    axes.set_title("Bearing load of the crank (Fig. 28)")


def _bearing_component(name: str, label: str, title: str) -> Callable[[Figure, xr.Dataset], None]:
    def draw(figure: Figure, data: xr.Dataset) -> None:
        values = data[name].values
        axes = figure.subplots()
        room = 0.06 * max(np.ptp(values), 1e-6)
        limits = (values.min() - room, values.max() + room)
        draw_curves(figure, axes, degrees(data), values, case_names(data), CRANK, label, limits, lines_of(data))
        axes.set_title(title)

    return draw


def _torque_share(figure: Figure, data: xr.Dataset) -> None:
    share, equal = data["torque_share"].values, 1.0 / (1 + int(data["disc"].values.max()))
    room = max(0.02, 1.1 * float(np.max(np.abs(share - equal))))
    axes = figure.subplots()
    axes.axhline(equal, color="#7a7a7a", linewidth=0.6)
    limits = (equal - room, equal + room)
    draw_curves(
        figure, axes, degrees(data), share, case_names(data), CRANK, "part of the torque", limits, lines_of(data)
    )
    axes.set_title(f"Part of the torque that each disc carries (largest {share.max():.3f}, equal parts {equal:.3f})")


def _roller_distribution(figure: Figure, data: xr.Dataset) -> None:
    """Load of all rollers at all positions over their place against the eccentricity."""
    rollers = data.sizes["roller"]
    angle = data["crank_angle"].values
    speed = float(data["cage_speed"].values[0])
    place = speed * angle[:, None] + 2.0 * np.pi * np.arange(rollers) / rollers - angle[:, None]
    place = np.degrees(np.mod(place, 2.0 * np.pi))
    if "of_case" in data.coords and np.ptp(data["crank"].values) > 0:
        draw_rollers_of_each_crank(figure, data, place)
        return
    edges = np.linspace(0.0, 360.0, 121)
    centres = 0.5 * (edges[1:] + edges[:-1])
    bins = np.digitize(place, edges[1:-1])
    names = case_names(data)
    axes = figure.subplots()
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
    draw_curves(figure, axes, x, curves, names, label, "load on the bore [N]", lines=lines_of(data))
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 60.0))
    axes.set_title("Load distribution over the rollers (Fig. 34)")


FIGURES: dict[str, Callable[[Figure, xr.Dataset], None]] = {
    "fig23_transmission_error": _transmission_error,
    "fig24_pin_load": _one_quantity("pin_load", 0, "load [N]", "Load of wheel pin 0 over its mesh (Fig. 24)"),
    "fig25_loaded_pins": _number_loaded("pin_load", "Number of loaded wheel pins (Fig. 25)"),
    "fig26_pin_pressure": _one_quantity(
        "pin_pressure_mid", 0, "pressure at mid-width [MPa]", "Largest flank pressure at wheel pin 0 (Fig. 26)"
    ),
    "fig28_bearing_load": _bearing,
    "fig29_tangential_bearing_load": _bearing_component(
        "bearing_tangential", "tangential bearing load [N]", "Tangential bearing load (Fig. 29)"
    ),
    "fig30_radial_bearing_load": _bearing_component(
        "bearing_radial", "radial bearing load [N]", "Radial bearing load (Fig. 30)"
    ),
    "fig34_roller_load": _roller_distribution,
    "fig35_pin_shaft_load": _one_quantity("pin_shaft_load", 0, "load [N]", "Load of shaft pin 0 (Fig. 35)"),
    "fig36_loaded_shaft_pins": _number_loaded("pin_shaft_load", "Number of loaded shaft pins (Fig. 36)"),
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
)
"""What every crank has of its own."""
OF_THE_PIN_SHAFT = ("fig35_pin_shaft_load", "fig36_loaded_shaft_pins")
"""What a drive without pin shaft has not."""


def figure_names(discs: int, holes: int, cranks: int = 1) -> list[str]:
    """Return the names of the figures of a run, keys of `FIGURES`.

    Parameters
    ----------
    discs, holes, cranks : int
        How many the drives have; no holes without a pin shaft.
    """
    missing: tuple[str, ...] = OF_SEVERAL_DISCS if discs == 1 else ()
    missing += OF_SEVERAL_CRANKS if cranks == 1 else ()
    missing += OF_THE_PIN_SHAFT if holes == 0 else ()
    return [name for name in FIGURES if name not in missing]


def draw_figure(name: str, dataset: xr.Dataset) -> Figure:
    """Return one figure.

    Parameters
    ----------
    name : str
        Key of `FIGURES`.
    dataset : xarray.Dataset
        Of `ltca.analysis.results.build_dataset`; of several discs each has a curve of its own.
    """
    dataset = _answered(dataset)
    if name in OF_SEVERAL_DISCS:
        dataset = dataset.assign(torque_share=dataset["disc_torque"] / dataset["wheel_moment"])
    shown = one_by_one(dataset, dataset.sizes["crank"] if name in (*OF_THE_CRANKS, *OF_SEVERAL_CRANKS) else 1)
    drawn = int(shown["of_case"].max()) + 1 if "of_case" in shown.coords else dataset.sizes["case"]
    if name in OF_THE_DRIVE:
        shown, drawn = dataset.isel(disc=0, crank=0), dataset.sizes["case"]
    elif name in OF_SEVERAL_CRANKS:
        shown = dataset.isel(case=slice(drawn))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        FIGURES[name](figure, shown)
        if drawn < dataset.sizes["case"]:
            figure.text(0.005, 0.005, f"{drawn} of {dataset.sizes['case']} cases", fontsize=7.0)
    return figure


def _answered(dataset: xr.Dataset) -> xr.Dataset:
    """The positions at which every case has an answer."""
    states = [dataset[name].values for name in ("status", "status_light") if name in dataset]
    known = np.all([state == 0 for state in states], axis=(0, 1)) if states else np.zeros(0, dtype=bool)
    return dataset.isel(position=known) if np.any(known) and not np.all(known) else dataset


def write_figures(dataset: xr.Dataset, folder: Path) -> Iterator[Path]:
    """Write every figure as SVG and PNG.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of `ltca.analysis.results.build_dataset`.
    folder : Path
        Where to write; made when missing.

    Yields
    ------
    Path
        The PNG of each figure when both files are written.
    """
    with mpl.rc_context(STYLE):
        for name in figure_names(dataset.sizes["disc"], dataset.sizes["hole"], dataset.sizes["crank"]):
            figure = draw_figure(name, dataset)
            # One layout serves both files: to find it takes as long as to draw.
            layout = figure.get_layout_engine()
            if layout is not None:
                layout.execute(figure)
            figure.set_layout_engine("none")
            for suffix in (".svg", ".png"):
                path = folder / f"{name}{suffix}"
                metadata = {"Date": None} if suffix == ".svg" else None
                with whole_file(path) as part:
                    figure.savefig(part, dpi=130, metadata=metadata)
            yield path
