"""`AnalysisResult.pressure`: the pressure over one contact as a labelled array."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.pressure_fields import CONTACTS, FIELD_CELLS, is_loaded, loads_of, pressure_field
from ltca.arrays import FloatArray, place_of_largest
from ltca.contact.contact_kind import END_STRETCH
from ltca.errors import DriveError, did_you_mean, shortened
from ltca.front.arguments import angles_given, counted

MOST_CELLS = 60
SAME_ANGLE = 1e-9
"""Difference up to which a crank angle is one of those analysed, rad: texts in degrees are rounded."""


def contact_pressure(
    loaded: LoadedAnalysis,
    case: str,
    contact: str,
    number: int | None,
    *,
    position: int | None = None,
    crank_angle: float | str | None = None,
    disc: int | None = None,
    crank: int | None = None,
    cells: int = FIELD_CELLS,
) -> xr.DataArray:
    """Return the pressure over one contact; see `ltca.facade.AnalysisResult.pressure`."""
    if contact not in CONTACTS:
        meant = did_you_mean(contact, CONTACTS) if isinstance(contact, str) else ""
        names = ", ".join(map(repr, CONTACTS))
        raise DriveError([f"contact = {shortened(contact)}: is unknown; must be one of {names}{meant}"])
    if loaded.engine.compliance == "fe":
        raise DriveError(
            ["compliance = fe: plane strain has no pressure over the width; analyse on hybrid or half-space"]
        )
    grid = counted(cells, "cells", 4, MOST_CELLS)
    discs, cranks = loaded.discs, loaded.drive.crank.number
    of_roller = contact.startswith("roller")
    if crank is not None and not of_roller:
        raise DriveError(
            [f"crank = {shortened(crank)}: has no effect with contact = {contact!r}; only rollers are of a crank"]
        )
    loads = np.stack([loads_of(one, contact) for one in discs])
    loads = loads.reshape(*loads.shape[:2], cranks if of_roller else 1, -1)  # (discs, positions, cranks, pairs)
    has_field = np.stack([is_loaded(one, contact) for one in discs]).reshape(loads.shape)
    asked = {
        "disc": disc,
        "position": _position(loaded, position, crank_angle),
        "crank": crank if of_roller else 0,
        "number": number,
    }
    if not loads.shape[3]:
        raise DriveError([f"contact = {contact!r}: there is none in this drive"])
    for (name, value), size in zip(asked.items(), loads.shape, strict=True):
        if value is not None:
            asked[name] = counted(value, name, 0, size - 1)
    chosen = np.ix_(
        *(range(size) if one is None else [one] for one, size in zip(asked.values(), loads.shape, strict=True))
    )
    carried = np.where(has_field[chosen], loads[chosen], 0.0)
    if not np.any(carried > 0.0):
        given = {"disc": disc, "position": asked["position"], "crank": crank, "number": number}
        where = ", ".join(f"{name} {value}" for name, value in given.items() if value is not None)
        raise DriveError([f"contact = {contact!r}: carries nothing" + (f" at {where}" if where else "")])
    place = [int(axis.flat[index]) for axis, index in zip(chosen, place_of_largest(carried), strict=True)]
    in_disc, at, on_crank, pair = place
    field = pressure_field(discs[in_disc], contact, at, on_crank * loads.shape[3] + pair, grid)
    part_name = {"pin": "pin", "hole": "hole"}.get(contact, "roller")
    told: dict[str, Any] = {
        "case": case,
        "disc": in_disc,
        **({"crank": on_crank} if of_roller else {}),
        "position": at,
        "crank_angle": ((), float(loaded.full.crank_angle[at]), {"units": "rad", "long_name": "crank angle φ_C, held"}),
        part_name: pair,
    }
    x = field.x_edges
    y, pressure = _with_whole_ends(field.y_edges, field.pressure)
    return xr.DataArray(
        pressure,
        dims=("x", "y"),
        coords={
            "x": ("x", 0.5 * (x[1:] + x[:-1]), {"units": "mm", "long_name": "along the profile"}),
            "y": ("y", 0.5 * (y[1:] + y[:-1]), {"units": "mm", "long_name": "along the width, from its middle"}),
            "x_size": ("x", np.diff(x), {"units": "mm", "long_name": "size of the cell along the profile"}),
            "y_size": ("y", np.diff(y), {"units": "mm", "long_name": "size of the cell along the width"}),
            **told,
        },
        name="pressure",
        attrs={
            "units": "MPa",
            "long_name": f"mean pressure of the cells, {CONTACTS[contact]}",
            "load_N": field.load,
            "pressure_mid_MPa": field.mid,
            "pressure_max_MPa": field.largest,
            "half_width_mm": field.half_width,
            "max_shear_MPa": field.max_shear,
            "max_shear_depth_mm": field.max_shear_depth,
        },
    )


def _with_whole_ends(edges: FloatArray, pressure: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Edges along the width and mean pressures with `END_STRETCH` of the length as the last cell at either end.

    At the end of a straight generator the pressure of half-spaces has no bound: the means of ever finer cells grow without end.
    """
    stretch = END_STRETCH * float(edges[-1] - edges[0])
    low, high = float(edges[0]) + stretch, float(edges[-1]) - stretch
    if edges[1] - edges[0] >= stretch and edges[-1] - edges[-2] >= stretch:
        return edges, pressure
    inner = edges[(edges > low + 0.5 * stretch) & (edges < high - 0.5 * stretch)]  # no slivers beside them
    whole = np.concatenate([edges[:1], [low], inner, [high], edges[-1:]])
    sums = np.zeros((pressure.shape[0], edges.size))
    np.cumsum(pressure * np.diff(edges), axis=1, out=sums[:, 1:])
    carried = np.array([np.interp(whole, edges, row) for row in sums])  # ∫ p dy is piecewise linear
    return whole, np.diff(carried, axis=1) / np.diff(whole)


def _position(loaded: LoadedAnalysis, position: int | None, crank_angle: float | str | None) -> int | None:
    """The position asked for by its number or its crank angle; None where none is."""
    if position is not None and crank_angle is not None:
        raise DriveError(["position and crank_angle: give one of them"])
    if crank_angle is None:
        return position
    angles = loaded.full.crank_angle
    given = np.asarray(angles_given(crank_angle))
    if given.size != 1 or given.dtype.kind not in "iuf" or not np.all(np.isfinite(given)):
        raise DriveError([f"crank_angle = {shortened(crank_angle)}: must be one angle in rad"])
    away = np.abs(angles - float(given.reshape(-1)[0]))
    nearest = int(np.argmin(away))
    if away[nearest] > SAME_ANGLE:
        raise DriveError(
            [f"crank_angle = {shortened(crank_angle)}: was not analysed; the nearest is {angles[nearest]:.9g} rad"]
        )
    return nearest
