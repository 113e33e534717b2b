"""The numbers behind the moving drive of a run: poses, loads and pressures of every contact at both torques."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import FloatArray
from ltca.compliance.response import KindPressures
from ltca.drive.units.quantities import ARCSEC
from ltca.equilibrium.balance import Equilibrium
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE, disc_displacement

MOST_VALUES = 1_500_000
"""Numbers on a page, some two megabytes: of runs with more, every second position is shown, or every third."""
TORQUES = ("full", "light")


def shown_positions(analyses: Mapping[str, LoadedAnalysis]) -> NDArray[np.intp]:
    """Return which positions of a run a page shows: all of them, or evenly chosen ones of many."""
    first = next(iter(analyses.values()))
    positions = first.full.crank_angle.size
    contacts = first.full.response
    each = 2 * (4 * contacts.pin_load.shape[1] + 6 * contacts.rollers.outer_load.shape[1])
    each += 2 * 3 * contacts.hole_load.shape[1] + 30 * len(first.model.discs)
    return np.arange(0, positions, ceil(each * positions * len(analyses) / MOST_VALUES))


def run_arrays(analyses: Mapping[str, LoadedAnalysis], rows: NDArray[np.intp]) -> dict[str, FloatArray]:
    """Return every array of a page of a run, positions last.

    Parameters
    ----------
    analyses : mapping of str to LoadedAnalysis
        By case.
    rows : array of int
        Positions that are shown (`shown_positions`).

    Returns
    -------
    dict of str to array
        ``angle``, rad; by number of the case, torque and name, as ``0/full/pin/load``: loads in N, pressures at mid-width in MPa,
        half-widths in mm of shape (discs, contacts, positions), the parameter of each contact on the flank, rad;
        ``radial`` and ``tangential`` of each disc, mm, its ``rotation``, rad, the ``wheel`` angle, rad, and
        the transmission error ``te`` in arc seconds; further curves of the whole drive (`_curves`).
    """
    first = next(iter(analyses.values()))
    arrays: dict[str, FloatArray] = {"angle": first.full.crank_angle}
    for number, analysis in enumerate(analyses.values()):
        for torque in TORQUES:
            for name, values in _of_torque(analysis, light=torque == "light").items():
                arrays[f"{number}/{torque}/{name}"] = values
        arrays |= {f"{number}/{name}": values for name, values in _curves(analysis).items()}
    return {name: np.ascontiguousarray(values[..., rows]) for name, values in arrays.items()}


def _of_torque(analysis: LoadedAnalysis, *, light: bool) -> dict[str, FloatArray]:
    found = _at_light_torque(analysis) if light else analysis
    each = [_of_disc(disc) for disc in found.discs]
    error = analysis.transmission_error_light if light else analysis.transmission_error
    return {
        **{name: np.stack([values[name] for values in each]) for name in each[0]},
        "wheel": found.full.pose[:, WHEEL_ANGLE],
        "te": error * ARCSEC,
    }


def _at_light_torque(analysis: LoadedAnalysis) -> LoadedAnalysis:
    """The analysis as if its light torque were that of the run; without pressures where they would be dear or unknown."""
    light, model, known = analysis.light, analysis.model, analysis.pressures
    grids = analysis.engine.options["contacts"] == "grids"  # they would be solved anew, for minutes
    if np.all(analysis.balanced_light) and not grids:
        return replace(analysis, full=light, pressures=model.pressures(light.response))
    pins, outer, inner, holes = (
        replace(kind, mid=np.full_like(kind.mid, np.nan), half_width=np.full_like(kind.half_width, np.nan))
        for kind in (known.pins, known.outer, known.inner, known.holes)
    )
    return replace(analysis, full=light, pressures=replace(known, pins=pins, outer=outer, inner=inner, holes=holes))


def _of_disc(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    full: Equilibrium = analysis.full
    contacts, pressures = full.response, analysis.pressures
    place = analysis.model.discs[0].geometry.placement
    displacement = disc_displacement(full.pose) * place.eccentric_direction(full.crank_angle).conjugate()
    kinds: dict[str, tuple[FloatArray, KindPressures]] = {
        "pin": (contacts.pin_load, pressures.pins),
        "outer": (contacts.rollers.outer_load, pressures.outer),
        "inner": (contacts.rollers.inner_load, pressures.inner),
        "hole": (contacts.hole_load, pressures.holes),
    }
    values: dict[str, FloatArray] = {}
    for kind, (load, pressed) in kinds.items():
        values |= {f"{kind}/load": load.T, f"{kind}/pressure": pressed.mid.T, f"{kind}/width": pressed.half_width.T}
    return values | {
        "pin/parameter": np.mod(contacts.flank.parameter, 2.0 * np.pi).T,
        "radial": displacement.real,
        "tangential": displacement.imag,
        "rotation": full.pose[:, DISC_ROTATION],
    }


def _curves(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Curves of the whole drive at the torque of the run: bearing forces by disc and crank, N, torques, N·m, losses."""
    discs = analysis.bearing_radial.shape[1]
    curves = {
        "radial": np.moveaxis(analysis.bearing_radial, 0, -1),
        "tangential": np.moveaxis(analysis.bearing_tangential, 0, -1),
    }
    if discs > 1:
        curves["share"] = analysis.torque_share.T
    if analysis.drive.crank.number > 1:
        curves["crank"] = analysis.crank_torques.T / 1000.0
    losses = analysis.losses
    if losses is not None:
        curves["efficiency"] = losses.efficiency
        for kind, energy in losses.by_kind.items():
            if np.any(energy):
                curves[f"loss/{kind}"] = energy
    return curves
