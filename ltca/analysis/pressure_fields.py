"""Pressure over every loaded contact at chosen crank angles: solved on grids that carry the loads found, as one dataset.

Layout of ``pressure.nc``: dimensions, coordinates and names of ``results.nc``, and the cells ``pin_cell_x``,
``pin_cell_y``, ``roller_cell_x``, ``roller_cell_y`` of each patch. Patches differ in size, so each has edges of its
own: ``pin_x_edge (case, disc, position, pin, pin_bound_x)`` along the common tangent in the sense of the growing flank
parameter, ``pin_y_edge`` along the width from mid-width, mm; for rollers alike, with ``_outer`` (bore) and ``_inner``
(race) behind the name. ``pin_pressure``, ``roller_pressure_outer`` and ``roller_pressure_inner`` are the mean
pressures of the cells, MPa. A pair that carries less than 0.1 % of the largest load of its kind has pressure
zero on cells of no size, so sums of pressure times area are loads without exception.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.results import coordinates, provenance
from ltca.analysis.summary import LOADED_FRACTION
from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, ContactKinds, Departure
from ltca.contact.end_pressure import largest_pressure
from ltca.contact.fitted_grid import solve_fitted
from ltca.contact.pressure_cells import PatchPressure
from ltca.contact.subsurface import SubsurfaceShear, find_subsurface_shear
from ltca.drive.hole_contact import hole_modulus
from ltca.errors import ConvergenceError
from ltca.geometry.separation import circle_departure, flank_departure
from ltca.laws.line_contact import LineContactLaw
from ltca.quantities import QUANTITIES

FIELD_CELLS = 16
"""Cells over each half-width and half of each length."""
MOST_SECANTS = 12
LOAD_TOLERANCE = 1e-5
"""Relative deviation of the load of a field from that of its contact."""
GRID_STEP = 1e-3
"""Largest such deviation: from one grid of the ladder to the next the load at an approach jumps by some 2e-4."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PressureField:
    """Pressure over one whole patch.

    Attributes
    ----------
    x_edges, y_edges : array
        Cell edges along profile and width, mm.
    pressure : array, shape (x cells, y cells)
        Mean pressure of the cells, MPa.
    mid, largest : float
        Largest pressure at mid-width and anywhere, MPa.
    half_width : float
        At mid-width, mm.
    load : float
        N.
    max_shear, max_shear_depth : float
        Largest shear stress below mid-width in MPa and its depth in mm.
    """

    x_edges: FloatArray
    y_edges: FloatArray
    pressure: FloatArray
    mid: float
    largest: float
    half_width: float
    load: float
    max_shear: float
    max_shear_depth: float


def recover_pressure(
    kind: ContactKind,
    load: float,
    effective_radius: float,
    departure: Departure,
    poisson_ratio: float,
    moment: float | None = None,
) -> PressureField:
    """Solve one contact that carries a load, N, at an effective radius ρ, mm, and unfold its symmetry.

    `departure` is the true separation over the distance along the tangent, mm; `poisson_ratio` that of the body whose shear
    stress is wanted; `moment` that of a contact in slices about the middle of its width, N·mm, which tilts.
    """
    if moment is None:
        solved = _solve_at_load(kind, load, effective_radius, departure)
        largest = largest_pressure(solved, kind.end_cell)
    else:
        from ltca.analysis.tilted_fields import solve_tilted

        solved, largest = solve_tilted(kind, load, moment, effective_radius, departure)
    x, y, pressure = solved.unfolded()
    shear, mid, half_width = SubsurfaceShear(0.0, 0.0), 0.0, 0.0
    if y[0] < 0.0 < y[-1]:  # what carries beside the middle has nothing there
        shear, mid, half_width = find_subsurface_shear(solved, poisson_ratio), solved.mid_pressure, solved.half_width
    return PressureField(
        x_edges=x,
        y_edges=y,
        pressure=pressure,
        mid=mid,
        largest=largest,
        half_width=half_width,
        load=solved.load,
        max_shear=shear.max_shear,
        max_shear_depth=shear.depth,
    )


def _solve_at_load(kind: ContactKind, load: float, effective_radius: float, departure: Departure) -> PatchPressure:
    """The grid at the approach at which it carries a load, by secants over the logarithms of both.

    What lies behind a contact, seats, bent pins, the body, has its part of the approach of the bodies: the load has not.
    """
    law = LineContactLaw(kind.length, kind.contact_modulus)
    approach = float(law.approach_at_load(np.array(load), np.array(effective_radius))[0])
    slope, best, last, misses = 1.0 / 1.1, None, None, list[float]()
    for _ in range(MOST_SECANTS):
        solved = solve_fitted(kind, approach, effective_radius, departure)
        miss = float(np.log(load / solved.load)) if solved.load > 0.0 else 1.0
        misses.append(abs(miss))
        if best is None or abs(miss) == min(misses):
            best = solved
        if abs(miss) < LOAD_TOLERANCE:
            break
        if last is not None and abs(last[1] - miss) > LOAD_TOLERANCE:
            slope = float(np.clip((np.log(approach) - last[0]) / (last[1] - miss), 0.5, 1.2))
        last = float(np.log(approach)), miss
        approach *= float(np.exp(np.clip(slope * miss, -2.0, 2.0)))
    if best is None or min(misses) > GRID_STEP:
        raise ConvergenceError(f"no pressure field carries {load:g} N; deviations of the load, part of it", misses)
    return best


CONTACTS = {
    "pin": "wheel pin",
    "roller_outer": "roller in the bore",
    "roller_inner": "roller on the inner race",
    "hole": "shaft pin",
}
"""Contacts with a pressure over their width, by the names of the dataset."""


def loads_of(analysis: LoadedAnalysis, contact: str) -> FloatArray:
    """Return the loads of one kind of `CONTACTS` of a drive of one disc, N, shape (positions, pairs)."""
    contacts = analysis.full.response
    return {
        "pin": contacts.pin_load,
        "roller_outer": contacts.rollers.outer_load,
        "roller_inner": contacts.rollers.inner_load,
        "hole": contacts.hole_load,
    }[contact]


def moment_of(analysis: LoadedAnalysis, contact: str, position: int, pair: int) -> float | None:
    """Return the moment of a contact of one kind of `CONTACTS` in slices of a drive of one disc, N·mm; None in the plane."""
    (part,) = analysis.full.response.parts
    rollers = part.rollers.leaning
    if part.leaning_pins is None or part.leaning_holes is None or rollers is None:
        return None
    moments = {
        "pin": part.leaning_pins.contact.moment,
        "roller_outer": rollers.outer.moment,
        "roller_inner": rollers.inner.moment,
        "hole": part.leaning_holes.contact.moment,
    }[contact]
    return float(np.asarray(moments)[position, pair])


def pressure_field(
    analysis: LoadedAnalysis, contact: str, position: int, pair: int, cells: int = FIELD_CELLS
) -> PressureField:
    """Return the pressure over one loaded contact of `CONTACTS` at one position of a drive of one disc.

    The bodies near it are half-spaces of finite length, whatever yields beyond; in plane strain there is no such field.
    """
    drive, place = analysis.drive, analysis.model.discs[0].geometry.placement
    kinds, parts, load = ContactKinds.of_drive(drive, cells), drive.materials, loads_of(analysis, contact)
    if contact == "pin":
        profile, theta = analysis.model.discs[0].geometry.profile, analysis.full.response.flank.parameter
        at, pin_radius = float(theta[position, pair]), float(place.wheel_pin_radii[pair])
        kind, radius, material = kinds.pins, analysis.full.response.flank.effective_radius[position, pair], parts.disc

        def departure(x: FloatArray) -> FloatArray:
            return flank_departure(profile, at, x) + circle_departure(x, pin_radius)

    elif contact == "hole":
        own, wall = float(place.shaft_pin_radii[pair]), float(place.hole_radii[pair])
        modulus = hole_modulus(drive, rigid_shaft_pins=analysis.pressures.rigid_shaft_pins)
        kind, radius, material = (
            replace(kinds.holes, contact_modulus=modulus),
            place.hole_effective_radii[pair],
            parts.disc,
        )

        def departure(x: FloatArray) -> FloatArray:
            return circle_departure(x, own) + circle_departure(x, -wall)

    else:
        outer, own = contact == "roller_outer", float(place.roller_radii[pair])
        kind, material = kinds.outer if outer else kinds.inner, parts.roller
        radius = (place.outer_effective_radii if outer else place.inner_effective_radii)[pair]
        race = -float(place.bore_radius) if outer else float(place.inner_race_radius)

        def departure(x: FloatArray) -> FloatArray:
            return circle_departure(x, own) + circle_departure(x, race)

    moment = moment_of(analysis, contact, position, pair)
    return recover_pressure(kind, float(load[position, pair]), float(radius), departure, material.poisson_ratio, moment)


def pin_fields(analysis: LoadedAnalysis, position: int, cells: int = FIELD_CELLS) -> dict[int, PressureField]:
    """Return the pressure fields of the loaded wheel pins of one position of a drive of one disc, by pin."""
    return _fields(analysis, "pin", position, cells)


def roller_fields(
    analysis: LoadedAnalysis, position: int, side: str, cells: int = FIELD_CELLS
) -> dict[int, PressureField]:
    """Return the pressure fields of the loaded rollers of one disc at one position, by roller, in the bore or on the race."""
    return _fields(analysis, f"roller_{side}", position, cells)


def _fields(analysis: LoadedAnalysis, contact: str, position: int, cells: int) -> dict[int, PressureField]:
    pairs = np.nonzero(is_loaded(analysis, contact)[position])[0]
    return {int(pair): pressure_field(analysis, contact, position, int(pair), cells) for pair in pairs}


def is_loaded(analysis: LoadedAnalysis, contact: str) -> NDArray[np.bool_]:
    """Tell which contacts of a kind have a field, shape (positions, pairs): those with some load beside the largest."""
    load = loads_of(analysis, contact)
    return np.asarray(load > LOADED_FRACTION * np.max(load, initial=0.0, where=np.isfinite(load)))


FIELD_VALUES = {
    "pressure": "pressure",
    "x_edge": "x_edges",
    "y_edge": "y_edges",
    "pressure_mid": "mid",
    "pressure_max": "largest",
    "half_width": "half_width",
    "field_load": "load",
    "max_shear": "max_shear",
    "max_shear_depth": "max_shear_depth",
}
"""Attributes of `PressureField` by what stands behind the kind of contact in their names in the dataset."""


def build_pressure_dataset(
    drive_name: str, analyses: Mapping[str, LoadedAnalysis], cells: int = FIELD_CELLS, drive_file: str | None = None
) -> xr.Dataset:
    """Return the pressure fields of all cases; the layout is told in `ltca.analysis.pressure_fields`.

    Parameters
    ----------
    drive_name : str
        Name of the drive.
    analyses : mapping of str to LoadedAnalysis
        One for each case, all at the chosen crank angles.
    cells : int
        Cells over each half-width and half of each length.
    drive_file : str, optional
        Text of the drive file; by default the drive of the first case written as one.
    """
    first = next(iter(analyses.values()))
    placement = first.model.discs[0].geometry.placement
    positions = range(first.full.crank_angle.size)
    variables: dict[str, Any] = {}
    discs = [analysis.discs for analysis in analyses.values()]
    pins = [[[pin_fields(disc, position, cells) for position in positions] for disc in case] for case in discs]
    _store(variables, "pin", "", pins, placement.wheel_pin_radii.size)
    for side in ("outer", "inner"):
        rollers = [
            [[roller_fields(disc, position, side, cells) for position in positions] for disc in case] for case in discs
        ]
        _store(variables, "roller", f"_{side}", rollers, placement.roller_radii.size, placement.cranks)
    dataset = xr.Dataset(
        variables,
        coords=coordinates(analyses),
        attrs={
            **provenance(drive_name, first.as_written, drive_file),
            **first.engine.options,
            "cells_per_half_width": cells,
            "fingerprint": [analysis.drive.fingerprint() for analysis in analyses.values()],
        },
    )
    kinds = ContactKinds.of_drive(first.drive, cells)
    for name, kind in (
        ("pin_pressure_max", kinds.pins),
        ("roller_pressure_max_outer", kinds.outer),
        ("roller_pressure_max_inner", kinds.inner),
    ):
        dataset[name].attrs["end_cell_mm"] = kind.end_cell
    return dataset


def _store(
    variables: dict[str, Any],
    name: str,
    side: str,
    fields: list[list[list[dict[int, PressureField]]]],
    count: int,
    cranks: int = 1,
) -> None:
    """Put the fields of one kind on one side, by case, disc, position and pair, into arrays of full size; rollers by crank."""
    flat = [field for case in fields for disc in case for position in disc for field in position.values()]
    nx, ny = flat[0].pressure.shape if flat else (1, 1)
    shape = (len(fields), len(fields[0]), len(fields[0][0]), count)
    sizes = {"pressure": (nx, ny), "x_edge": (nx + 1,), "y_edge": (ny + 1,)}
    arrays = {key: np.zeros((*shape, *sizes.get(key, ()))) for key in FIELD_VALUES}
    for case, disc, position in np.ndindex(shape[:3]):
        for pair, field in fields[case][disc][position].items():
            place = (case, disc, position, pair)
            for key, attribute in FIELD_VALUES.items():
                arrays[key][place] = getattr(field, attribute)
    for key, values in arrays.items():
        quantity = QUANTITIES[f"{name}_{key}{side}"]
        if "crank" in quantity.dimensions:  # pairs come crank after crank
            values = np.moveaxis(values.reshape(*shape[:3], cranks, -1, *values.shape[4:]), 3, 2)
        variables[quantity.name] = quantity.labelled(values)
