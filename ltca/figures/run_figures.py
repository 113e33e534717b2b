"""Figures of a run, corresponding to the paper's Fig. 23–26, 28–30 and 34–36: six cases per axes, labelled directly.

Several discs have a curve each: dashed from the second on, so that equal ones are both seen; of several cases in the
colour of their case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ltca.analysis.summary import LOADED_FRACTION
from ltca.drive.units.quantities import ARCSEC
from ltca.output.files import whole_file

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
SECTORS, FEWEST_IN_A_SECTOR = 60, 8
"""Places of the rollers about a crank at which mean and range are taken, and rollers of one disc that pass each."""
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


def _lines(dataset: xr.Dataset) -> list[Line]:
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


def _degrees(dataset: xr.Dataset) -> FloatArray:
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
    _mark_a_turn(axes, x[order])
    _label_ends(axes, x[order], curves[:, order], names, lines)


def _mark_a_turn(axes: Any, x: FloatArray) -> None:
    """A whole turn has its ticks at sixths."""
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


def _cases(dataset: xr.Dataset) -> list[str]:
    return [str(name) for name in dataset["case"].values]


def _loaded(dataset: xr.Dataset, name: str) -> FloatArray:
    load = dataset[name].values
    largest = load.max(axis=(1, 2), keepdims=True)
    return np.asarray((load > LOADED_FRACTION * largest).sum(axis=2), dtype=float)


CRANK = "crank angle φ_C [°]"


def _transmission_error(figure: Figure, data: xr.Dataset) -> None:
    upper, lower = figure.subplots(2, 1, sharex=True)
    names = _cases(data)
    light, full = (data[name].values * ARCSEC for name in ("transmission_error_light", "transmission_error"))
    draw_curves(figure, upper, _degrees(data), light - light.mean(axis=1, keepdims=True), names, "", "light torque [″]")
    draw_curves(figure, lower, _degrees(data), full - full.mean(axis=1, keepdims=True), names, CRANK, "full torque [″]")
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
        draw_curves(figure, axes, _degrees(data), values, _cases(data), CRANK, label, lines=_lines(data))
        axes.set_title(title)

    return draw


def _number_loaded(name: str, title: str) -> Callable[[Figure, xr.Dataset], None]:
    def draw(figure: Figure, data: xr.Dataset) -> None:
        names, x, counts, lines = _cases(data), _degrees(data), _loaded(data, name), _lines(data)
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
        _mark_a_turn(axes[-1], x)
        axes[-1].set_xlabel(CRANK)
        figure.supylabel("number", fontsize=9.0)
        figure.suptitle(title)

    return draw


def _bearing(figure: Figure, data: xr.Dataset) -> None:
    total = np.hypot(data["bearing_radial"].values, data["bearing_tangential"].values)
    axes = figure.subplots()
    limits = (0.98 * total.min(), 1.01 * total.max())
    draw_curves(
        figure, axes, _degrees(data), total, _cases(data), CRANK, "total bearing load [N]", limits, _lines(data)
    )
    axes.set_title("Bearing load of the crank (Fig. 28)")


def _bearing_component(name: str, label: str, title: str) -> Callable[[Figure, xr.Dataset], None]:
    def draw(figure: Figure, data: xr.Dataset) -> None:
        values = data[name].values
        axes = figure.subplots()
        room = 0.06 * max(np.ptp(values), 1e-6)
        limits = (values.min() - room, values.max() + room)
        draw_curves(figure, axes, _degrees(data), values, _cases(data), CRANK, label, limits, _lines(data))
        axes.set_title(title)

    return draw


def _torque_share(figure: Figure, data: xr.Dataset) -> None:
    share, equal = data["torque_share"].values, 1.0 / (1 + int(data["disc"].values.max()))
    room = max(0.02, 1.1 * float(np.max(np.abs(share - equal))))
    axes = figure.subplots()
    axes.axhline(equal, color="#7a7a7a", linewidth=0.6)
    limits = (equal - room, equal + room)
    draw_curves(figure, axes, _degrees(data), share, _cases(data), CRANK, "part of the torque", limits, _lines(data))
    axes.set_title(f"Part of the torque that each disc carries (largest {share.max():.3f}, equal parts {equal:.3f})")


def _roller_distribution(figure: Figure, data: xr.Dataset) -> None:
    """Load of all rollers at all positions over their place against the eccentricity."""
    rollers = data.sizes["roller"]
    angle = data["crank_angle"].values
    speed = float(data["cage_speed"].values[0])
    place = speed * angle[:, None] + 2.0 * np.pi * np.arange(rollers) / rollers - angle[:, None]
    place = np.degrees(np.mod(place, 2.0 * np.pi))
    if "of_case" in data.coords and np.ptp(data["crank"].values) > 0:
        _range_of_each_crank(figure, data, place)
        return
    edges = np.linspace(0.0, 360.0, 121)
    centres = 0.5 * (edges[1:] + edges[:-1])
    bins = np.digitize(place, edges[1:-1])
    names = _cases(data)
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
    draw_curves(figure, axes, x, curves, names, label, "load on the bore [N]", lines=_lines(data))
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 60.0))
    axes.set_title("Load distribution over the rollers (Fig. 34)")


def _range_of_each_crank(figure: Figure, data: xr.Dataset, place: FloatArray) -> None:
    """Mean load and its range on each crank: the force turns over the revolution, and a curve of each disc hides the others."""
    steps = min(SECTORS, max(4, place.size // FEWEST_IN_A_SECTOR))
    sector = np.minimum((place / 360.0 * steps).astype(int), steps - 1)
    load, names, lines = data["roller_load"].values, _cases(data), _lines(data)
    owners = list(zip(data["of_case"].values.tolist(), data["crank"].values.tolist(), strict=True))
    several, told, drawn = len({case for case, _ in owners}) > 1, {}, []
    for row, owner in enumerate(owners):
        told.setdefault(owner, []).append(row)
    for (_, crank), rows in told.items():
        inside = [load[np.ix_(rows)][:, sector == number] for number in range(steps)]
        low, mean, high = (
            np.array([pick(part) if part.size else np.nan for part in inside]) for pick in (np.min, np.mean, np.max)
        )
        words = [word for word in names[rows[0]].split(", ") if not word.startswith("disc ")]
        line = Line(lines[rows[0]].colour, DASHES[crank % len(DASHES)] if several else "-")
        drawn.append((", ".join(words), line, low, mean, high))
    axes, middle = figure.subplots(), (np.arange(steps) + 0.5) * 360.0 / steps
    for _, line, low, _, high in drawn:
        axes.fill_between(middle, low, high, color=line.colour, alpha=0.12, linewidth=0.0)
    draw_curves(
        figure, axes, middle, np.array([mean for _, _, _, mean, _ in drawn]), [name for name, *_ in drawn],
        "angle of the roller from the eccentricity [°]", "load on the bore [N]",
        (0.0, 1.04 * max(float(np.nanmax(high)) for *_, high in drawn) + 1e-9), [line for _, line, *_ in drawn],
    )  # fmt: skip
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 60.0))
    axes.set_title("Load on the rollers of each crank, all discs: mean and range over the positions (Fig. 34)")


def _cranks(figure: Figure, data: xr.Dataset) -> None:
    """Torque of each crank, and where they yield how far each goes in the plane of each disc."""
    cranks, yields = data.sizes["crank"], "crank_deflection_radial" in data
    figure.set_figheight((1.0 + yields) * figure.get_figheight() * 0.85)
    panels = np.atleast_1d(figure.subplots(1 + yields, 1, sharex=True))
    torque = _one_by_one(data.isel(disc=[0]), cranks)
    values = torque["crank_torque"].values / 1e3
    room = 0.06 * max(np.ptp(values), 1e-6)
    draw_curves(
        figure, panels[0], _degrees(torque), values, _cases(torque), "" if yields else CRANK, "torque [N m]",
        (values.min() - room, values.max() + room), _lines(torque),
    )  # fmt: skip
    if yields:
        moved = _one_by_one(data, cranks)
        size = 1e3 * np.hypot(moved["crank_deflection_radial"].values, moved["crank_deflection_tangential"].values)
        draw_curves(
            figure, panels[1], _degrees(moved), size, _cases(moved), CRANK, "deflection at the disc [µm]",
            (0.0, 1.04 * float(np.nanmax(size)) + 1e-9), _lines(moved),
        )  # fmt: skip
    figure.suptitle("Moment that holds each crank" + (", and how far it yields on its bearings" if yields else ""))


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
    "cranks": _cranks,
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
    if name in OF_SEVERAL_CRANKS:
        shown = dataset
    elif name in OF_THE_DRIVE:
        shown = dataset.isel(disc=0, crank=0)
    else:
        shown = _one_by_one(dataset, dataset.sizes["crank"] if name in OF_THE_CRANKS else 1)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        FIGURES[name](figure, shown)
        if "of_case" in shown.coords and (drawn := int(shown["of_case"].max()) + 1) < dataset.sizes["case"]:
            figure.text(0.005, 0.005, f"{drawn} of {dataset.sizes['case']} cases", fontsize=7.0)
    return figure


def _answered(dataset: xr.Dataset) -> xr.Dataset:
    """The positions at which every case has an answer."""
    states = [dataset[name].values for name in ("status", "status_light") if name in dataset]
    known = np.all([state == 0 for state in states], axis=(0, 1)) if states else np.zeros(0, dtype=bool)
    return dataset.isel(position=known) if np.any(known) and not np.all(known) else dataset


def _one_by_one(dataset: xr.Dataset, cranks: int) -> xr.Dataset:
    """Every disc of every case, on every crank, as a case of its own; where they are too many, the cases that have room."""
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
