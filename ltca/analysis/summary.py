"""The scalars of one case: what ``summary.json`` holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ltca.analysis.extremes import Sampling, is_full_turn, refine_extremes, sampling
from ltca.analysis.friction.variables import friction_scalars
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.results import seat_values
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.equilibrium.reducer import geometries
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, interference
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import play_over_a_turn
from ltca.quantities import REFINED, scalar_named

FloatArray = NDArray[np.float64]

LOADED_FRACTION = 1e-3
"""A contact counts as loaded above this part of the largest load of its kind in the case."""

OF_RANGES = (
    "ptp_tangential_bearing_load",
    "ptp_transmission_error",
    "ptp_transmission_error_light",
    "pin_shaft_loaded_range",
)
"""What needs more than one position."""
OF_LOADS = ("pin_shaft_loaded_range", "mean_loaded_pins", "mean_loaded_rollers", "mean_loaded_pin_shaft_pins")
"""Counts of loaded contacts."""
FREE_PLAY = ("backlash_output", "min_backlash_output", "preloaded_part_of_turn")
"""Free play of the output: largest and least over a turn, and the part of it where parts overlap in every pose."""


def summarise(analysis: LoadedAnalysis) -> dict[str, float | None]:
    """Return the scalars of one case; means and peaks run over its positions, refined extremes over the whole turn.

    Parameters
    ----------
    analysis : LoadedAnalysis
        The case.

    Returns
    -------
    dict of str to (float or None)
        The keys of ``summary.json``, their units in their names; None where the engine or the positions cannot say a
        value, as positions that are no full turn say nothing of it.
    """
    geometry = geometries(analysis.model)
    full, contacts = analysis.full, analysis.full.response
    angle = full.crank_angle
    radial, tangential = analysis.bearing_radial, analysis.bearing_tangential
    pins, rollers, holes = (
        load > LOADED_FRACTION * np.max(load, initial=0.0)
        for load in (contacts.pin_load, contacts.rollers.outer_load, contacts.hole_load)
    )
    pressures = analysis.pressures
    play = np.mean(backlash(geometry, angle, WHEEL_ANGLE))
    roller_mid = max(np.max(pressures.outer.mid), np.max(pressures.inner.mid))
    roller_largest = max(np.max(pressures.outer.largest), np.max(pressures.inner.largest))
    values = {
        "backlash_disc": min(np.mean(backlash([disc], angle, DISC_ROTATION)) for disc in geometry) * ARCMIN,
        "backlash_wheel": play * ARCMIN,
        **_free_play(geometry, analysis.drive),
        "interference": max(np.max(interference(disc, angle)) for disc in geometry),
        "mean_bearing_load": np.mean(np.hypot(radial, tangential)),
        "mean_radial_bearing_load": np.mean(radial),
        "mean_tangential_bearing_load": np.mean(tangential),
        "ptp_tangential_bearing_load": np.max(np.ptp(tangential, axis=0)),
        "max_bearing_load": np.max(np.hypot(radial, tangential)),
        "max_pin_load": np.max(contacts.pin_load),
        "max_pin_pressure_mid": np.max(pressures.pins.mid),
        "max_pin_pressure_max": np.max(pressures.pins.largest),
        "max_roller_load": np.max(contacts.rollers.outer_load),
        "max_roller_pressure_mid": roller_mid,
        "max_roller_pressure_max": roller_largest,
        "pin_end_cell": pressures.pins.end_cell,
        "roller_end_cell": pressures.outer.end_cell,
        "max_pin_shaft_load": _most(contacts.hole_load),
        "max_pin_shaft_pressure_mid": _most(pressures.holes.mid),
        "max_pin_shaft_pressure_max": _most(pressures.holes.largest),
        "pin_shaft_end_cell": pressures.holes.end_cell,
        "pin_shaft_loaded_range": 360.0 * np.mean(holes) if holes.size else np.nan,
        "mean_loaded_pins": np.mean(pins.sum(axis=1)),
        "mean_loaded_rollers": np.mean(rollers.sum(axis=1)),
        "mean_loaded_pin_shaft_pins": np.mean(holes.sum(axis=1)) if holes.size else np.nan,
        "ptp_transmission_error": np.ptp(analysis.transmission_error) * ARCSEC,
        "ptp_transmission_error_light": np.ptp(analysis.transmission_error_light) * ARCSEC,
        "max_equilibrium_residual": max(np.max(full.residual), np.max(analysis.light.residual)),
    }
    share = analysis.torque_share
    for disc in range(share.shape[1]):
        values |= {
            f"mean_torque_share_disc_{disc}": np.mean(share[:, disc]),
            f"max_torque_share_disc_{disc}": np.max(share[:, disc]),
        }
    torques = analysis.crank_torques
    for crank in range(torques.shape[1]):
        values[f"mean_torque_crank_{crank}"] = np.mean(torques[:, crank])
        values[f"max_torque_crank_{crank}"] = np.max(np.abs(torques[:, crank]))
    values |= _of_cranks(analysis) | _of_pins(analysis)
    if analysis.losses is not None:
        values |= friction_scalars(analysis, rubbing_pressures(analysis))
    values |= {f"compliance_share_{part}": np.mean(share) for part, share in analysis.compliance_shares.items()}
    if analysis.wall_stresses:
        for wall in ("root", "bore", "hole"):
            largest = _largest(np.concatenate([getattr(walls, wall).ravel() for walls in analysis.wall_stresses]))
            values[f"max_{wall}_stress"] = largest
    values |= _refined(analysis, values) | _sampling(sampling(analysis.drive, angle))
    if not np.all(analysis.balanced):  # a position without an answer is no contact that is open
        values |= dict.fromkeys(OF_LOADS, np.nan)
    if angle.size == 1:  # one angle says nothing of ranges
        values |= dict.fromkeys(OF_RANGES, np.nan)
    return {_key(name): float(value) if np.isfinite(value) else None for name, value in values.items()}


def _key(name: str) -> str:
    """The key of a scalar, also of one over the whole turn."""
    bare = name.removeprefix("refined_")
    return name.removesuffix(bare) + scalar_named(bare).key


def _free_play(discs: Sequence[ContactGeometry], drive: Drive) -> dict[str, float]:
    """Free play of the output with every clearance over a turn: the largest, which is what is judged, and the least."""
    try:
        found = play_over_a_turn(discs)
    except ConvergenceError:  # nothing stops the wheel, or no pose was found: there is no play to tell
        return dict.fromkeys(FREE_PLAY, np.nan)
    scale = abs(drive.output_per_wheel_angle) * ARCMIN
    return dict(zip(FREE_PLAY, (scale * found.largest, scale * found.least, found.preloaded), strict=True))


def _of_pins(analysis: LoadedAnalysis) -> dict[str, float]:
    """Largest pressure in the seats of loose pins and sleeves, and how far pins bend, of all discs."""
    each = [seat_values(disc) for disc in analysis.discs]
    return {
        key: max(float(np.max(values[name], initial=0.0)) for values in each)
        for key, name in (
            ("max_pin_seat_pressure", "pin_seat_pressure_max"),
            ("max_hole_seat_pressure", "hole_seat_pressure_max"),
            ("max_pin_deflection", "pin_deflection"),
            ("max_shaft_pin_deflection", "shaft_pin_deflection"),
        )
        if name in each[0]
    }


def rubbing_pressures(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Return the pressures of what rubs by their names in the dataset, shape (discs, positions, pairs), MPa."""
    seats = [seat_values(disc) for disc in analysis.discs]
    pressures = {name: np.stack([values[name] for values in seats]) for name in seats[0]}
    for name, kind in (("pin", analysis.pressures.pins), ("pin_shaft", analysis.pressures.holes)):
        pressures[f"{name}_pressure_mid"] = np.stack(np.split(kind.mid, len(seats), axis=1))
    return pressures


def _of_cranks(analysis: LoadedAnalysis) -> dict[str, float]:
    """Largest bearing load of each of several cranks on any disc, and how far each goes in the plane of any where it yields."""
    load, moved = np.hypot(analysis.bearing_radial, analysis.bearing_tangential), np.abs(analysis.crank_deflections)
    cranks = load.shape[2] if load.shape[2] > 1 else 0
    return {
        **{f"max_bearing_load_crank_{crank}": float(np.max(load[:, :, crank])) for crank in range(cranks)},
        **{f"max_crank_deflection_crank_{crank}": float(np.max(moved[:, :, crank])) for crank in range(moved.shape[2])},
    }


def _most(values: FloatArray) -> float:
    """Largest value; not a number without a pin shaft."""
    return float(np.max(values)) if values.size else np.nan


def refined_value(summary: Mapping[str, float | None], key: str) -> float | None:
    """Return a scalar over the whole turn where there is one, over the positions otherwise.

    Parameters
    ----------
    summary : mapping of str to (float or None)
        From `summarise`.
    key : str
        Without ``refined_``.
    """
    refined = summary.get(f"refined_{key}")
    return summary.get(key) if refined is None else refined


def _largest(values: FloatArray) -> float:
    """Largest of what is known; not a number where nothing is."""
    return float(np.nanmax(values)) if np.any(np.isfinite(values)) else float("nan")


def _refined(analysis: LoadedAnalysis, values: Iterable[str]) -> dict[str, float]:
    whole = analysis.is_complete and is_full_turn(analysis.full.crank_angle)
    try:
        found = refine_extremes(analysis) if whole else None
    except ConvergenceError:  # one between the positions has no answer; those of the positions stand
        found = None
    return {f"refined_{name}": np.nan if found is None else found.values[name] for name in values if name in REFINED}


def _sampling(found: Sampling) -> dict[str, float]:
    return {
        "positions": found.positions,
        "positions_per_mesh_period": found.positions_per_mesh_period,
        "distinct_mesh_phases": found.distinct_mesh_phases,
    }
