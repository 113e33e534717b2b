"""Pictures of contact pressure, corresponding to the paper's Fig. 27 and 31–33."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.analysis.summary import LOADED_FRACTION
from ltca.arrays import FloatArray, place_of_largest
from ltca.contact.contact_kind import END_STRETCH
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.figures.curve_panels import MOST_CURVES, TWO_COLUMNS_FROM, draw_panels, name_panel
from ltca.figures.house_style import COLOUR_MAP, COLOURS, OTHERS, STYLE, save_figure, shortened_label
from ltca.figures.run_figures import with_paper_number
from ltca.geometry.flank import FlankProfile
from ltca.output.file_names import file_words

SIDES = ("outer", "inner")
PRESSURE_FIGURES = ("fig27_contact_zone", "fig32_roller_pressure_along", "fig33_roller_pressure_across")
"""Drawn once for all cases."""
ARC_POINTS = 4001
"""Points at which the arc length of a flank is integrated."""


def even_cells(edges: FloatArray, pressure: FloatArray, cells: int) -> tuple[FloatArray, FloatArray]:
    """Return cell centres and mean pressures on even cells along the last axis; integrals are kept.

    `edges` of the given cells have shape (n + 1,), mm; `pressure`, their means, (…, n), MPa.
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
    place = dict(zip(map(str, sides[side].dims), place_of_largest(sides[side].values), strict=True))
    return SIDES[side], place


def _named(fields: xr.Dataset, side: str, place: dict[str, int]) -> str:
    angle = float(np.degrees(fields["crank_angle"].values[place["position"]]))
    race = "bore" if side == "outer" else "inner race"
    several = "".join(f"{part} {place[part]}, " for part in ("disc", "crank") if fields.sizes[part] > 1)
    return f"{several}roller {place['roller']} on the {race}, crank angle {angle:.4g}°"


def flank_arc_length(profile: FlankProfile) -> tuple[FloatArray, FloatArray]:
    """Return parameters θ over one tooth from a root (θ = 0) and the arc length of the flank from there, mm."""
    theta = np.linspace(0.0, 2.0 * np.pi / (profile.reduction_ratio - 1.0), ARC_POINTS)
    _, tangent, _ = profile.locus(theta)
    speed = np.abs(tangent) * (1.0 - profile.offset * profile.locus(theta).curvature)
    step = theta[1] - theta[0]
    return theta, np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step)])


def draw_contact_zone(figure: Figure, results: xr.Dataset, drive: Drive) -> None:
    """Draw the contact zone on one flank of each case over the arc from root to tip (Fig. 27)."""
    profile = FlankProfile.of_drive(single_discs(drive)[0])
    theta, arc = flank_arc_length(profile)
    half = theta.size // 2
    tip = float(arc[half])
    outline = profile.flank(theta[: half + 1])
    names = [str(name) for name in results["case"].values][:MOST_CURVES]
    across = 1 if len(names) < TWO_COLUMNS_FROM else 2
    rows = -(-len(names) // across)
    figure.set_figheight(max(4.0, 0.9 + 1.3 * rows))
    grid = figure.add_gridspec(rows, 1 + across, width_ratios=(1.1, *(2.4 / across,) * across))
    left = figure.add_subplot(grid[:, 0])
    panels: list[Any] = []
    for number in range(len(names)):
        cell, first = grid[number // across, 1 + number % across], panels[0] if panels else None
        panels.append(figure.add_subplot(cell, sharex=first, sharey=first))
    left.plot(np.abs(outline), arc[: half + 1], color="#555555")
    left.set_xlabel("distance from the disc centre [mm]")
    left.set_ylabel("arc length from the root [mm]")
    left.set_ylim(0.0, tip)
    left.set_title("range of contact beside the flank")
    reach, tooth = np.ptp(np.abs(outline)), theta[-1]
    found = [_contacts(results.isel(case=number, crank=0), theta, arc, tooth) for number in range(len(names))]
    step = min(0.055, 0.6 / len(names)) * reach
    for number, (axes, (place, width, pressure)) in enumerate(zip(panels, found, strict=True)):
        colour = COLOURS[number % len(COLOURS)]
        low, high = float(np.min(place - width)), float(np.max(place + width))
        offset = np.abs(outline).min() - step * (1.0 + number)
        left.plot([offset, offset], [low, high], color=colour, linewidth=3.0, solid_capstyle="butt")
        axes.plot(place, pressure, color=colour, linestyle="none", marker=".", markersize=2.5, zorder=2.5)
        for other, (at, _, behind) in enumerate(found):
            if other != number:
                axes.plot(at, behind, color=OTHERS, linestyle="none", marker=".", markersize=1.5, zorder=2.0)
        top = int(np.argmax(pressure))
        axes.plot(place[top], pressure[top], color=colour, marker="o", markersize=4.5, zorder=2.6)
        name_panel(axes, names[number], 2)
        # Where it is written nothing is drawn: pressures fall to both ends of the flank.
        told = f"{low:.2f} to {high:.2f} mm\n{pressure[top]:.0f} MPa at {place[top]:.2f} mm"
        axes.set_title(told, loc="right", fontsize=7.5, color=colour if colour == COLOURS[0] else "#444444", pad=3.0)
        inner = number + across < len(names)
        axes.tick_params(labelbottom=not inner, labelleft=number % across == 0)
        if not inner:
            axes.set_xlabel("arc length from root (0) to tip [mm]")
        if number % across == 0 and number // across == rows // 2:
            axes.set_ylabel("pressure at mid-width [MPa]")
    left.set_xlim(np.abs(outline).min() - step * (len(names) + 1.0), None)
    panels[0].set_xlim(0.0, tip)
    panels[0].set_ylim(0.0, 1.08 * max(float(np.max(pressure)) for _, _, pressure in found))
    figure.suptitle(
        with_paper_number("Contact zone on the flank, contact half-width included; o: largest pressure", 27, results)
    )


def _contacts(
    data: xr.Dataset, theta: FloatArray, arc: FloatArray, tooth: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places on the flank, half-widths and pressures of all loaded contacts of all discs: their flanks are alike."""
    load = data["pin_load"].values
    loaded = load > LOADED_FRACTION * load.max()
    place = np.interp(np.mod(data["pin_contact_parameter"].values[loaded], tooth), theta, arc)
    place = np.minimum(place, arc[-1] - place)  # both flanks of a tooth are mirror images
    return place, data["pin_half_width"].values[loaded], data["pin_pressure_mid"].values[loaded]


def joined_as_hertz(centres: FloatArray, pressure: FloatArray, points: int = 401) -> tuple[FloatArray, FloatArray]:
    """Return points x, y of a smooth line through mean pressures of cells across a contact, down to its edges.

    `centres` (mm) and `pressure` (MPa) have shape (n,); the line goes through the means themselves where fewer than six cells
    are loaded.
    """
    from scipy.interpolate import PchipInterpolator

    touched = np.flatnonzero(pressure > 0.0)
    if touched.size < 6:
        return centres, pressure
    inner = touched[1:-1]
    x, square = centres[inner], pressure[inner] ** 2
    step = x[1] - x[0]
    ends = []
    for end, beside, sign in ((0, 1, -1.0), (-1, -2, 1.0)):
        fall = max(square[beside] - square[end], square[end] / 2.5)  # no further than two cells and a half
        ends.append(x[end] + sign * step * square[end] / fall)
    knots = PchipInterpolator(np.array([ends[0], *x, ends[1]]), np.array([0.0, *square, 0.0]))
    line = 0.5 * (ends[0] + ends[1]) + 0.5 * (ends[1] - ends[0]) * -np.cos(np.linspace(0.0, np.pi, points))
    return line, np.sqrt(np.maximum(knots(line), 0.0))


def draw_sections(fields: xr.Dataset, *, major: bool) -> Figure:
    """Draw the pressure of the hardest loaded roller of each case along its major or minor axis (Fig. 32, 33).

    Major is along the roller (over y at x = 0), minor across it (over x at mid-width).
    """
    figure = Figure(figsize=(7.2, 3.9))
    names = [str(name) for name in fields["case"].values][:MOST_CURVES]
    curves, places, titles, cells = [], [], [], []
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
            across = pressure[:, middle - 1 : middle + 1].mean(axis=1)
            x, across = _both_halves(x, across)
            cells.append((0.5 * (x[1:] + x[:-1]), across))
            centres, curve = joined_as_hertz(*cells[-1])
            curves.append(curve)
        places.append(centres)
        titles.append(_named(fields, side, place))
    # One axis for all: patches differ a little in size.
    reach = max(float(np.max(np.abs(c[curve > 0.0]))) for c, curve in zip(places, curves, strict=True))
    common = np.linspace(-1.1 * reach, 1.1 * reach, 881)
    if major:
        common = places[int(np.argmax([c[-1] for c in places]))]
    resampled = np.array([np.interp(common, c, curve, 0.0, 0.0) for c, curve in zip(places, curves, strict=True)])
    label = "distance from mid-width [mm]" if major else "distance across the contact [mm]"
    shown = titles[0] if len(set(titles)) == 1 else "the hardest loaded roller of each case"
    if major:
        cell = float(np.mean(np.diff(common)))
        title = with_paper_number(f"Pressure along the roller, means over {cell:.3g} mm", 32, fields)
    else:
        title = with_paper_number("Pressure across the roller at mid-width; dots: means of the cells", 33, fields)
    panels = draw_panels(figure, common, resampled, names, label, "pressure [MPa]", title=f"{title}\n{shown}")
    for axes, (at, means), number in zip(panels, cells, range(len(cells)), strict=False):
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(at, means, ".", color=colour, markersize=3.5)
    panels[0].set_xlim(-1.04 * float(np.abs(common).max()), 1.04 * float(np.abs(common).max()))
    return figure


def _both_halves(x: FloatArray, pressure: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Edges and pressures across the whole contact, where one half of it is kept."""
    if x[0] < 0.0 < x[-1]:
        return x, pressure
    order = slice(None, None, -1)
    whole = (np.concatenate([x, -x[order][1:]]), np.concatenate([pressure, pressure[order]]))
    return whole if x[-1] <= 0.0 else (np.concatenate([-x[order], x[1:]]), np.concatenate([pressure[order], pressure]))


def _surface(fields: xr.Dataset, case: str) -> tuple[FloatArray, FloatArray, FloatArray, str]:
    side, place = hardest_roller(fields, case)
    field = fields.sel(case=case).isel(place)
    x = field[f"roller_x_edge_{side}"].values
    cells = round(1.0 / END_STRETCH)
    y, pressure = even_cells(field[f"roller_y_edge_{side}"].values, field[f"roller_pressure_{side}"].values, cells)
    touched = np.nonzero(pressure.max(axis=1) > 0.0)[0]
    rows = slice(max(touched[0] - 1, 0), touched[-1] + 2)
    return 0.5 * (x[1:] + x[:-1])[rows], y, pressure[rows], _named(fields, side, place)


def draw_roller_pressure(fields: xr.Dataset, case: str) -> Figure:
    """Draw the pressure over the hardest loaded roller of a case as a surface (Fig. 31).

    No light falls on the surface: its colours are those of the scale.
    """
    x, y, pressure, title = _surface(fields, case)
    figure = Figure(figsize=(7.2, 5.2))
    axes: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    across, along = np.meshgrid(1e3 * x, y, indexing="ij")
    top = float(pressure.max())
    ticks = mpl.ticker.MaxNLocator(5).tick_values(0.0, top)
    limits = mpl.colors.Normalize(0.0, top)
    corners = pressure[:-1, :-1], pressure[1:, :-1], pressure[:-1, 1:], pressure[1:, 1:]
    colours = mpl.colormaps[COLOUR_MAP](limits(np.mean(corners, axis=0)))
    axes.plot_surface(
        across, along, pressure, facecolors=colours, rstride=1, cstride=1, linewidth=0.0, antialiased=False, shade=False
    )
    # The patch is a hundred times longer than wide: each axis has its own scale.
    axes.set_box_aspect((1.0, 1.6, 0.85))
    for axis, label in ((axes.xaxis, "across [µm]"), (axes.yaxis, "along [mm]")):
        axis.set_rotate_label(False)
        axis.set_label_text(label, rotation=0.0)
        axis.labelpad = 11.0
    axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
    axes.yaxis.set_major_locator(mpl.ticker.MaxNLocator(5))
    axes.set_zticks([tick for tick in ticks if tick <= top])
    axes.set_zticklabels([])
    axes.set_zlim(0.0, top)
    axes.view_init(elev=26.0, azim=-58.0)
    bar = figure.colorbar(
        mpl.cm.ScalarMappable(limits, COLOUR_MAP), ax=axes, shrink=0.7, pad=0.02, label="pressure [MPa]"
    )
    bar.set_ticks([tick for tick in ticks if tick <= top])
    bar.outline.set_visible(False)
    figure.suptitle(f"{with_paper_number(shortened_label(case, 40), 31, fields)}: {title}, largest {top:.0f} MPa")
    return figure


def write_pressure_figures(
    results: xr.Dataset, fields: xr.Dataset, drive: Drive, folder: Path, kind: str = "svg"
) -> Iterator[Path]:
    """Write Fig. 27 and 31–33 and yield each file; surfaces always as PNG, since as lines they would take megabytes.

    `drive` is any of the cases, for the flank.
    """
    with mpl.rc_context(STYLE):
        zone = Figure(figsize=(10.4, 4.6))
        draw_contact_zone(zone, results, drive)
        drawn = zone, draw_sections(fields, major=True), draw_sections(fields, major=False)
    for name, figure in zip(PRESSURE_FIGURES, drawn, strict=True):
        yield save_figure(figure, folder / f"{name}.{kind}")
    for case, word in file_words(str(name) for name in fields["case"].values).items():
        with mpl.rc_context(STYLE):
            surface = draw_roller_pressure(fields, case)
        yield save_figure(surface, folder / f"fig31_roller_pressure_{word}.png")
