"""Pictures of contact pressure, corresponding to the paper's Fig. 27 and 31–33."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ltca.analysis.summary import LOADED_FRACTION
from ltca.contact.tracked_grid import END_STRETCH
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.figures.labelled_curves import COLOURS, STYLE, draw_curves
from ltca.geometry.flank import FlankProfile
from ltca.output.files import whole_file

FloatArray = NDArray[np.float64]

SIDES = ("outer", "inner")
PRESSURE_FIGURES = ("fig27_contact_zone", "fig32_roller_pressure_along", "fig33_roller_pressure_across")
"""Drawn once for all cases."""

_PROBE = (
    "import pyvista as pv; p = pv.Plotter(off_screen=True, window_size=(64, 64)); p.add_mesh(pv.Sphere()); "
    "p.screenshot(None, return_img=True); p.close()"
)


@cache
def can_render() -> bool:
    """Return whether pyvista renders off-screen here; tried in a process of its own, for without GL it crashes."""
    try:
        done = subprocess.run([sys.executable, "-c", _PROBE], capture_output=True, timeout=120.0, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def even_cells(edges: FloatArray, pressure: FloatArray, cells: int) -> tuple[FloatArray, FloatArray]:
    """Return cell centres and mean pressures on even cells along the last axis (integrals are kept).

    Parameters
    ----------
    edges : array, shape (n + 1,)
        Edges of the given cells, mm.
    pressure : array, shape (…, n)
        Their mean pressures, MPa.
    cells : int
        How many even cells to make.
    """
    from scipy.interpolate import PchipInterpolator

    even = np.linspace(edges[0], edges[-1], cells + 1)
    sums = np.concatenate([np.zeros((*pressure.shape[:-1], 1)), np.cumsum(pressure * np.diff(edges), axis=-1)], axis=-1)
    # The integral is interpolated monotonically: means stay positive and do not show the steps of the cells.
    means = np.diff(PchipInterpolator(edges, sums, axis=-1)(even), axis=-1) / (even[1] - even[0])
    return np.asarray(0.5 * (even[1:] + even[:-1])), means


def hardest_roller(fields: xr.Dataset, case: str) -> tuple[str, dict[str, int]]:
    """Return where the roller pressure at mid-width is largest in a case: the side, and an indexer of the rest."""
    sides = [fields[f"roller_pressure_mid_{side}"].sel(case=case) for side in SIDES]
    side = int(np.argmax([float(mid.max()) for mid in sides]))
    at = np.unravel_index(int(np.argmax(sides[side].values)), sides[side].shape)
    place = {str(name): int(i) for name, i in zip(sides[side].dims, at, strict=True)}
    return SIDES[side], place


def _named(fields: xr.Dataset, side: str, place: dict[str, int]) -> str:
    angle = float(np.degrees(fields["crank_angle"].values[place["position"]]))
    race = "bore" if side == "outer" else "inner race"
    disc = f" of disc {place['disc']}" if fields.sizes["disc"] > 1 else ""
    return f"roller {place['roller']} on the {race}{disc}, crank angle {angle:.4g}°"


def flank_arc_length(profile: FlankProfile, samples: int = 4001) -> tuple[FloatArray, FloatArray]:
    """Return parameters θ over one tooth from a root (θ = 0) and the arc length of the flank from there, mm."""
    theta = np.linspace(0.0, 2.0 * np.pi / (profile.reduction_ratio - 1.0), samples)
    _, tangent, _ = profile.locus(theta)
    speed = np.abs(tangent) * (1.0 - profile.offset * profile.locus_curvature(theta))
    step = theta[1] - theta[0]
    return theta, np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step)])


def draw_contact_zone(figure: Figure, results: xr.Dataset, drive: Drive) -> None:
    """Draw the contact zone on one flank of each case over the arc from root to tip (Fig. 27).

    Parameters
    ----------
    figure : Figure
        To draw into.
    results : xarray.Dataset
        Of `ltca.analysis.results.build_dataset`.
    drive : Drive
        Any of the cases, for the flank.
    """
    profile = FlankProfile.of_drive(single_discs(drive)[0])
    theta, arc = flank_arc_length(profile)
    half = theta.size // 2
    tip = float(arc[half])
    outline = profile.flank(theta[: half + 1])
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.7))
    names = [str(name) for name in results["case"].values]
    left.plot(np.abs(outline), arc[: half + 1], color="#555555")
    left.set_xlabel("distance from the disc centre [mm]")
    left.set_ylabel("arc length from the root [mm]")
    left.set_ylim(0.0, tip)
    reach = np.ptp(np.abs(outline))
    tooth = theta[-1]
    for number, name in enumerate(names):
        colour = COLOURS[number % len(COLOURS)]
        data = results.isel(case=number, crank=0)  # all discs: their flanks are alike
        load = data["pin_load"].values
        loaded = load > LOADED_FRACTION * load.max()
        place = np.interp(np.mod(data["pin_contact_parameter"].values[loaded], tooth), theta, arc)
        place = np.minimum(place, arc[-1] - place)  # both flanks of a tooth are mirror images
        width, pressure = data["pin_half_width"].values[loaded], data["pin_pressure_mid"].values[loaded]
        low, high = float(np.min(place - width)), float(np.max(place + width))
        offset = np.abs(outline).min() - (0.05 + 0.055 * number) * reach
        left.plot([offset, offset], [low, high], color=colour, linewidth=3.0, solid_capstyle="butt")
        order = np.argsort(place)
        right.plot(place[order], pressure[order], color=colour, linestyle="none", marker=".", markersize=2.0)
        top = int(np.argmax(pressure))
        right.plot(place[top], pressure[top], color=colour, marker="o", markersize=4.0)
        right.annotate(
            f"{name}\n{low:.2f} to {high:.2f} mm\n{pressure[top]:.0f} MPa at {place[top]:.2f} mm",
            xy=(1.03, 1.0 - number / len(names)),
            xycoords="axes fraction",
            va="top",
            fontsize=8.0,
            color=colour,
            annotation_clip=False,
        )
    left.set_xlim(np.abs(outline).min() - (0.08 + 0.055 * len(names)) * reach, None)
    right.set_xlabel("arc length from root (0) to tip [mm]")
    right.set_ylabel("pressure at mid-width [MPa]")
    right.set_xlim(0.0, tip)
    right.set_title("range of contact, place of the largest pressure (o)", fontsize=9)
    right.set_ylim(bottom=0.0)
    figure.suptitle("Contact zone on the flank, contact half-width included (Fig. 27)")


def draw_sections(fields: xr.Dataset, *, major: bool) -> Figure:
    """Draw the pressure of the hardest loaded roller of each case along its major or minor axis (Fig. 32, 33).

    Parameters
    ----------
    fields : xarray.Dataset
        Of `ltca.analysis.pressure_fields.build_pressure_dataset`.
    major : bool
        Along the roller (over y at x = 0) or across it (over x at mid-width).
    """
    figure = Figure(figsize=(7.2, 4.4))
    axes = figure.subplots()
    names = [str(name) for name in fields["case"].values]
    curves, places, titles = [], [], []
    for name in names:
        side, place = hardest_roller(fields, name)
        field = fields.sel(case=name).isel(place)
        pressure = field[f"roller_pressure_{side}"].values
        x, y = field[f"roller_x_edge_{side}"].values, field[f"roller_y_edge_{side}"].values
        if major:
            centres, means = even_cells(y, pressure, round(1.0 / END_STRETCH))
            middle = pressure.shape[0] // 2
            curves.append(means[middle - 1 : middle + 1].mean(axis=0))
        else:
            middle = pressure.shape[1] // 2
            centres = 0.5 * (x[1:] + x[:-1])
            curves.append(pressure[:, middle - 1 : middle + 1].mean(axis=1))
        places.append(centres)
        titles.append(_named(fields, side, place))
    # One axis for all: patches differ a little in size.
    reach = max(float(np.max(np.abs(c[curve > 0.0]))) for c, curve in zip(places, curves, strict=True)) * 1.1
    common = np.linspace(-reach, 0.0, 401) if not major else places[int(np.argmax([c[-1] for c in places]))]
    resampled = np.array([np.interp(common, c, curve, 0.0, 0.0) for c, curve in zip(places, curves, strict=True)])
    label = "distance from mid-width [mm]" if major else "distance across the contact [mm]"
    draw_curves(figure, axes, common, resampled, names, label, "pressure [MPa]")
    shown = titles[0] if len(set(titles)) == 1 else "the hardest loaded roller of each case"
    if major:
        cell = float(np.mean(np.diff(common)))
        axes.set_title(f"Pressure along the roller, means over {cell:.3g} mm (Fig. 32)\n{shown}", fontsize=10)
    else:
        axes.set_title(f"Pressure across the roller at mid-width, one half of it (Fig. 33)\n{shown}", fontsize=10)
    return figure


def _surface(fields: xr.Dataset, case: str) -> tuple[FloatArray, FloatArray, FloatArray, str]:
    side, place = hardest_roller(fields, case)
    field = fields.sel(case=case).isel(place)
    x = field[f"roller_x_edge_{side}"].values
    cells = round(1.0 / END_STRETCH)
    y, pressure = even_cells(field[f"roller_y_edge_{side}"].values, field[f"roller_pressure_{side}"].values, cells)
    touched = np.nonzero(pressure.max(axis=1) > 0.0)[0]
    rows = slice(max(touched[0] - 1, 0), touched[-1] + 2)
    return 0.5 * (x[1:] + x[:-1])[rows], y, pressure[rows], _named(fields, side, place)


def render_roller_pressure(fields: xr.Dataset, case: str, path: Path) -> None:
    """Render the pressure over the hardest loaded roller of a case in 3-D with pyvista, off-screen (Fig. 31)."""
    import pyvista as pv
    from vtkmodules.vtkCommonCore import vtkLogger

    # Without an X server VTK says so before it takes EGL: no concern of the user's.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    x, y, pressure, title = _surface(fields, case)
    # The patch is a hundred times longer than wide: each axis is drawn to its own scale, with its own numbers.
    across, along = np.meshgrid(x / np.ptp(x), 1.6 * y / np.ptp(y), indexing="ij")
    top = float(pressure.max())
    grid = pv.StructuredGrid(across, along, 0.9 * pressure / top)
    grid["pressure [MPa]"] = pressure.ravel(order="F")
    plotter = pv.Plotter(off_screen=True, window_size=[1280, 860])
    plotter.set_background("white")  # type: ignore[arg-type]  # stub takes the wrapper
    plotter.add_mesh(
        grid,
        scalars="pressure [MPa]",
        cmap="viridis",
        smooth_shading=False,
        show_edges=True,
        edge_opacity=0.15,
        scalar_bar_args={"color": "black", "vertical": True, "position_x": 0.9, "position_y": 0.2, "fmt": "%.0f"},
    )
    ticks = {
        "x": [(f"{value:.3g}", (value / np.ptp(x), -0.9, 0.0)) for value in (x[0], 0.0, x[-1])],
        "y": [(f"{value:.3g}", (0.6, 1.6 * value / np.ptp(y), 0.0)) for value in 0.98 * np.array([y[0], 0.0, y[-1]])],
        "z": [(f"{part * top:.0f}", (-0.5, -0.86, 0.9 * part)) for part in (0.25, 0.5, 0.75, 1.0)],
    }
    titles = [
        ("across [mm]", (0.0, -1.05, 0.0)),
        ("along [mm]", (0.78, 0.0, 0.0)),
        ("pressure [MPa]", (-0.5, -0.86, 1.0)),
    ]
    labels = [label for axis in ticks.values() for label in axis] + titles
    plotter.add_point_labels(
        np.array([place for _, place in labels]),
        [text for text, _ in labels],
        text_color="black",
        font_size=13,
        shape=None,
        show_points=False,
        always_visible=True,
        justification_horizontal="center",
        justification_vertical="center",
    )
    for corner in ((0.5, -0.8, 0.0), (-0.5, -0.8, 0.9)):
        plotter.add_mesh(pv.Line((-0.5, -0.8, 0.0), corner), color="#888888")
    plotter.add_mesh(pv.Line((0.5, -0.8, 0.0), (0.5, 0.8, 0.0)), color="#888888")
    # VTK, too, reads what stands between dollar signs as a formula.
    plotter.add_text(f"{case}: {title}".replace("$", "\\$"), font_size=11, color="black", position="upper_edge")
    plotter.camera_position = [(2.6, -2.9, 2.0), (0.05, 0.0, 0.33), (0.0, 0.0, 1.0)]
    with whole_file(path) as part:
        plotter.screenshot(str(part))
    plotter.close()


def draw_roller_pressure(fields: xr.Dataset, case: str) -> Figure:
    """Draw what `render_roller_pressure` renders with matplotlib, where there is no GL (Fig. 31)."""
    x, y, pressure, title = _surface(fields, case)
    figure = Figure(figsize=(7.6, 5.4))
    axes: Any = figure.add_subplot(projection="3d")
    across, along = np.meshgrid(x, y, indexing="ij")
    axes.plot_surface(across, along, pressure, cmap="viridis", rstride=1, cstride=1, linewidth=0.0, antialiased=False)
    axes.set_xlabel("across [mm]")
    axes.set_ylabel("along [mm]")
    axes.set_zlabel("pressure [MPa]")
    axes.set_title(f"{case}: {title}", fontsize=10)
    axes.view_init(elev=28.0, azim=-52.0)
    return figure


def write_pressure_figures(results: xr.Dataset, fields: xr.Dataset, drive: Drive, folder: Path) -> Iterator[Path]:
    """Write Fig. 27 and 31–33; sections as SVG and PNG, 3-D pictures as PNG.

    Parameters
    ----------
    results : xarray.Dataset
        The run, for the contact zone.
    fields : xarray.Dataset
        Its pressure fields.
    drive : Drive
        Any of the cases, for the flank.
    folder : Path
        Where to write; made when missing.

    Yields
    ------
    Path
        The PNG of each figure when it is written.
    """
    with mpl.rc_context(STYLE):
        zone = Figure(figsize=(10.4, 4.6))
        draw_contact_zone(zone, results, drive)
        drawn = zone, draw_sections(fields, major=True), draw_sections(fields, major=False)
        for name, figure in zip(PRESSURE_FIGURES, drawn, strict=True):
            for suffix in (".svg", ".png"):
                with whole_file(folder / f"{name}{suffix}") as part:
                    figure.savefig(part, dpi=130, metadata={"Date": None} if suffix == ".svg" else None)
            yield folder / f"{name}.png"
        for case in (str(name) for name in fields["case"].values):
            path = folder / f"fig31_roller_pressure_{case}.png"
            if can_render():
                render_roller_pressure(fields, case, path)
            else:
                with whole_file(path) as part:
                    draw_roller_pressure(fields, case).savefig(part, dpi=130)
            yield path
