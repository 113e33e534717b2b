"""Figures of several cranks: moment and deflection of each, and the loads of its rollers."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ltca.figures.labelled_curves import (
    CRANK,
    DASHES,
    FloatArray,
    Line,
    case_names,
    degrees,
    draw_curves,
    lines_of,
    one_by_one,
)

SECTORS, FEWEST_IN_A_SECTOR = 60, 8
"""Places of the rollers about a crank at which mean and range are taken, and rollers of one disc that pass each."""


def draw_rollers_of_each_crank(figure: Figure, data: xr.Dataset, place: FloatArray) -> None:
    """Draw mean and range of the roller loads of each crank, all its discs together: curves of each hide each other.

    Parameters
    ----------
    figure : Figure
        Where to.
    data : xarray.Dataset
        Of `one_by_one`.
    place : array, shape (discs and cranks, positions, rollers) or what broadcasts to it
        Of the rollers from the eccentricity, degrees.
    """
    steps = min(SECTORS, max(4, place.size // FEWEST_IN_A_SECTOR))
    sector = np.minimum((place / 360.0 * steps).astype(int), steps - 1)
    load, names, lines = data["roller_load"].values, case_names(data), lines_of(data)
    owners = list(zip(data["of_case"].values.tolist(), data["crank"].values.tolist(), strict=True))
    several = len({case for case, _ in owners}) > 1
    told: dict[tuple[int, int], list[int]] = {}
    for row, owner in enumerate(owners):
        told.setdefault(owner, []).append(row)
    met = np.flatnonzero(
        np.bincount(sector.ravel(), minlength=steps)
    )  # at few positions rollers pass some places never
    drawn = []
    for (_, crank), rows in told.items():
        inside = [load[rows][:, sector == number] for number in met]
        low, mean, high = (np.array([pick(part) for part in inside]) for pick in (np.min, np.mean, np.max))
        of_disc = f"disc {int(data['disc'].values[rows[0]])}, crank {crank}"
        name = names[rows[0]]
        if name.endswith(of_disc):
            name = f"{name.removesuffix(of_disc)}crank {crank}"
        line = Line(lines[rows[0]].colour, DASHES[crank % len(DASHES)] if several else "-")
        drawn.append((name, line, low, mean, high))
    axes, middle = figure.subplots(), (met + 0.5) * 360.0 / steps
    for _, line, low, _, high in drawn:
        axes.fill_between(middle, low, high, color=line.colour, alpha=0.12, linewidth=0.0)
    draw_curves(
        figure, axes, middle, np.array([mean for _, _, _, mean, _ in drawn]), [name for name, *_ in drawn],
        "angle of the roller from the eccentricity [°]", "load on the bore [N]",
        (0.0, 1.04 * max(float(np.nanmax(high)) for *_, high in drawn) + 1e-9), [line for _, line, *_ in drawn],
    )  # fmt: skip
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 60.0))
    axes.set_title("Load on the rollers of each crank, all discs: mean and range (Fig. 34)")


def draw_cranks(figure: Figure, data: xr.Dataset) -> None:
    """Draw the torque of each crank, and where they yield how far each goes in the plane of each disc.

    Parameters
    ----------
    figure : Figure
        Where to.
    data : xarray.Dataset
        Of `ltca.analysis.results.build_dataset`, with several cranks.
    """
    cranks, yields = data.sizes["crank"], "crank_deflection_radial" in data
    figure.set_figheight((1.0 + yields) * figure.get_figheight() * 0.85)
    panels = np.atleast_1d(figure.subplots(1 + yields, 1, sharex=True))
    torque = one_by_one(data.isel(disc=[0]), cranks)
    values = torque["crank_torque"].values / 1e3
    room = 0.06 * max(np.ptp(values), 1e-6)
    draw_curves(
        figure, panels[0], degrees(torque), values, case_names(torque), "" if yields else CRANK, "torque [N m]",
        (values.min() - room, values.max() + room), lines_of(torque),
    )  # fmt: skip
    if yields:
        moved = one_by_one(data, cranks)
        size = 1e3 * np.hypot(moved["crank_deflection_radial"].values, moved["crank_deflection_tangential"].values)
        draw_curves(
            figure, panels[1], degrees(moved), size, case_names(moved), CRANK, "deflection at the disc [µm]",
            (0.0, 1.04 * float(np.nanmax(size)) + 1e-9), lines_of(moved),
        )  # fmt: skip
    figure.suptitle("Moment that holds each crank" + (", and how far it yields on its bearings" if yields else ""))
