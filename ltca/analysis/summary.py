"""The scalars of one case: what ``summary.json`` holds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ltca.analysis.contact_arrays import array_of
from ltca.analysis.extremes import Sampling, is_full_turn, refine_extremes, sampling
from ltca.analysis.friction.losses import KINDS
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.results import case_arrays
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, interference
from ltca.geometry.pairs import ContactGeometry
from ltca.geometry.play import play_over_a_turn
from ltca.quantities import REFINED, SCALARS, scalar_named

LOADED_FRACTION = 1e-3
"""A contact counts as loaded above this part of the largest load of its kind in the case."""

OF_CONTACTS = tuple(
    f"max_{part}_{kind}" for part in ("pin", "roller", "pin_shaft") for kind in ("load", "pressure_mid", "pressure_max")
)
"""Largest loads and pressures of the contacts."""
OF_PINS = ("max_pin_seat_pressure", "max_hole_seat_pressure", "max_pin_deflection", "max_shaft_pin_deflection")
"""What loose pins, sleeves and pins that bend have."""
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
    geometry, arrays = analysis.model.geometries, case_arrays(analysis)
    full, contacts = analysis.full, analysis.full.response
    angle = full.crank_angle
    pins, rollers, holes = (
        load > LOADED_FRACTION * np.max(load, initial=0.0)
        for load in (contacts.pin_load, contacts.rollers.outer_load, contacts.hole_load)
    )
    pressures = analysis.pressures
    play = np.mean(backlash(geometry, angle, WHEEL_ANGLE))
    values = {
        "backlash_disc": min(np.mean(backlash([disc], angle, DISC_ROTATION)) for disc in geometry) * ARCMIN,
        "backlash_wheel": play * ARCMIN,
        **_free_play(geometry, analysis.drive),
        "interference": max(np.max(interference(disc, angle)) for disc in geometry),
        "pin_end_cell": pressures.pins.end_cell,
        "roller_end_cell": pressures.outer.end_cell,
        "pin_shaft_end_cell": pressures.holes.end_cell,
        "pin_shaft_loaded_range": 360.0 * np.mean(holes) if holes.size else np.nan,
        "mean_loaded_pins": np.mean(pins.sum(axis=1)),
        "mean_loaded_rollers": np.mean(rollers.sum(axis=1)),
        "mean_loaded_pin_shaft_pins": np.mean(holes.sum(axis=1)) if holes.size else np.nan,
        "max_equilibrium_residual": max(np.max(full.residual), np.max(analysis.light.residual)),
        **scalars_of_positions(analysis, arrays),
    }
    values |= {f"compliance_share_{part}": np.mean(share) for part, share in analysis.compliance_shares.items()}
    values |= _refined(analysis, values) | _sampling(sampling(analysis.drive, angle))
    if not np.all(analysis.balanced):  # a position without an answer is no contact that is open
        values |= dict.fromkeys(OF_LOADS, np.nan)
    if angle.size == 1:  # one angle says nothing of ranges
        values |= dict.fromkeys(OF_RANGES, np.nan)
    return {scalar_key(name): float(value) if np.isfinite(value) else None for name, value in values.items()}


def scalars_of_positions(analysis: LoadedAnalysis, arrays: Mapping[str, FloatArray]) -> dict[str, float]:
    """Return the scalars that follow loads, poses and pressures of the positions smoothly, by their names in the registry.

    `arrays` are those of the case, from `ltca.analysis.results.case_arrays`.
    """
    radial, tangential = analysis.bearing_radial, analysis.bearing_tangential
    values = {
        "mean_bearing_load": np.mean(np.hypot(radial, tangential)),
        "mean_radial_bearing_load": np.mean(radial),
        "mean_tangential_bearing_load": np.mean(tangential),
        "ptp_tangential_bearing_load": np.max(np.ptp(tangential, axis=0)),
        "max_bearing_load": np.max(np.hypot(radial, tangential)),
        **_sums(arrays, *OF_CONTACTS, "ptp_transmission_error", "ptp_transmission_error_light"),
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
    values |= _of_cranks(analysis) | _sums(arrays, *OF_PINS) | _of_friction(analysis, arrays)
    return values | _sums(arrays, "max_root_stress", "max_bore_stress", "max_hole_stress")


def scalar_key(name: str) -> str:
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


SUMS: dict[str, Callable[[FloatArray], Any]] = {
    "max": np.max,
    "min": np.min,
    "mean": np.mean,
    "ptp": np.ptp,
    "largest known": np.nanmax,
}
"""How a scalar sums its array up."""


def _sums(arrays: Mapping[str, FloatArray], *names: str) -> dict[str, float]:
    """Scalars of the arrays that there are, by name; not a number of an array without parts, as without a pin shaft."""
    found = {}
    for scalar in (SCALARS[name] for name in names):
        values, how = array_of(arrays, scalar.of), scalar.how or scalar.name.partition("_")[0]
        if values is None:
            continue
        known = np.any(np.isfinite(values)) if how == "largest known" else values.size
        factor = ARCSEC if scalar.unit == "arcsec" else 1.0
        found[scalar.name] = factor * float(SUMS[how](values)) if known else np.nan
    return found


def _of_friction(analysis: LoadedAnalysis, arrays: Mapping[str, FloatArray]) -> dict[str, float]:
    """Efficiencies, torques and losses over the positions; nothing without friction."""
    found, back = analysis.losses, analysis.losses_back
    if found is None or back is None:
        return {}
    rubbed = [
        name for name in ("pin_pv", "pin_seat_pv", "pin_shaft_pv", "hole_seat_pv") if np.size(arrays.get(name, ()))
    ]
    return {
        "mean_efficiency": found.mean_efficiency,
        **_sums(arrays, "min_efficiency"),
        "mean_efficiency_back": back.mean_efficiency,
        **_sums(arrays, "moves_back"),
        "mean_crank_torque": float(np.mean(analysis.crank_torques.sum(axis=1))),
        **_sums(arrays, "mean_input_torque", "mean_input_torque_back", "power_loss"),
        **{f"power_loss_{kind}": float(np.mean(found.watts(found.by_kind[kind]))) for kind in KINDS},
        **_sums(arrays, *(f"mean_loss_{kind}" for kind in KINDS), *(f"max_{name}" for name in rubbed)),
    }


def _of_cranks(analysis: LoadedAnalysis) -> dict[str, float]:
    """Largest bearing load of each of several cranks on any disc, and how far each goes in the plane of any where it yields."""
    load, moved = np.hypot(analysis.bearing_radial, analysis.bearing_tangential), np.abs(analysis.crank_deflections)
    cranks = load.shape[2] if load.shape[2] > 1 else 0
    return {
        **{f"max_bearing_load_crank_{crank}": float(np.max(load[:, :, crank])) for crank in range(cranks)},
        **{f"max_crank_deflection_crank_{crank}": float(np.max(moved[:, :, crank])) for crank in range(moved.shape[2])},
    }


def refined_value(summary: Mapping[str, float | None], key: str) -> float | None:
    """Return a scalar over the whole turn where there is one, over the positions otherwise; its key without ``refined_``."""
    refined = summary.get(f"refined_{key}")
    return summary.get(key) if refined is None else refined


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
