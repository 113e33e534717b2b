"""The scalars of one case: what ``summary.json`` holds."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from ltca.analysis.contact_arrays import array_of
from ltca.analysis.extremes import Sampling, is_full_turn, refine_together, sampling
from ltca.analysis.friction.losses import KINDS
from ltca.analysis.loaded_analysis import MAX_BATCH_POSITIONS, LoadedAnalysis
from ltca.analysis.mass_values import NAMES as OF_MASSES, mass_values
from ltca.analysis.memory_need import positions_together
from ltca.analysis.results import case_arrays
from ltca.arrays import FloatArray, batch_layout, stack_drives, take_rows
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.equilibrium.output_angle import play_before_cranks
from ltca.errors import ConvergenceError
from ltca.geometry.coordinates import DISC_ROTATION, WHEEL_ANGLE
from ltca.geometry.first_contact import backlash, interference
from ltca.geometry.interference import overlap_at_rest
from ltca.geometry.play import POSITIONS, TurnPlay, plays_over_a_turn
from ltca.quantities import NEED_SLICES, REFINED, SCALARS, scalar_named

LOADED_FRACTION = 1e-3
"""A contact counts as loaded above this part of the largest load of its kind in the case."""

OF_CONTACTS = tuple(
    f"max_{part}_{kind}" for part in ("pin", "roller", "pin_shaft") for kind in ("load", "pressure_mid", "pressure_max")
)
"""Largest loads and pressures of the contacts."""
OF_PINS = (
    "max_pin_seat_pressure", "max_hole_seat_pressure", "max_pin_deflection", "max_shaft_pin_deflection",
    "max_ring_displacement_radial",
)  # fmt: skip
"""What loose pins, sleeves, pins that bend and an elastic ring have."""
OF_REACTIONS = (
    *(f"max_crank_support_load_{which}" for which in ("first", "second")),
    *(f"max_first_stage_{which}_force" for which in ("tangential", "radial", "axial")),
)
"""Largest forces of the teeth of a first stage and on the bearings of cranks."""
OF_WIDTH = tuple(name for name, one in SCALARS.items() if one.of in NEED_SLICES and one.in_summary)
"""Of contacts in slices."""
OF_RANGES = (
    "ptp_tangential_bearing_load",
    "ptp_transmission_error",
    "ptp_transmission_error_light",
    "pin_shaft_loaded_range",
)
"""Ranges, which need more than one position."""
OF_LOADS = ("pin_shaft_loaded_range", "mean_loaded_pins", "mean_loaded_rollers", "mean_loaded_pin_shaft_pins")
"""Counts of loaded contacts: those of a disc, or of a crank bearing in a disc, are means over discs and bearings as well."""
Values = Mapping[str, float]
"""Scalars by name."""
OF_FLANK = ("backlash_wheel", "backlash_disc", "interference")
"""Backlash and overlap of the discs in their nominal places."""
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
    (found,) = summarise_cases({"": analysis}).values()
    return found


def summarise_cases(
    analyses: Mapping[str, LoadedAnalysis],
    *,
    without_load: bool = True,
    masses: bool = True,
    near: TurnPlay | None = None,
) -> dict[str, dict[str, float | None]]:
    """Return the scalars of several cases by name, as `summarise` does; what is solved for them is solved together.

    Parameters
    ----------
    analyses : mapping of str to LoadedAnalysis
        By name.
    without_load : bool
        Whether backlash, free play and overlap are wanted, which no load moves.
    masses : bool
        Whether masses and inertias are wanted.
    near : TurnPlay, optional
        Free play of a drive that all of these nearly are (`ltca.geometry.play.plays_over_a_turn`).
    """
    each = list(analyses.values())
    unloaded: Sequence[Values] = [dict.fromkeys(OF_FLANK, np.nan)] * len(each)
    plays: Sequence[Values] = [dict.fromkeys(FREE_PLAY, np.nan)] * len(each)
    if without_load:
        layouts = [batch_layout(analysis.model.geometries) for analysis in each]
        unloaded = _together(_unloaded, each, layouts)
        turn = POSITIONS if near is None else 2
        plays = _together(partial(_plays, near=near), each, layouts, positions=turn)
    refined = _together(_refined, each, [_refined_with(analysis) for analysis in each])
    known = zip(each, unloaded, plays, refined, strict=True)
    return {name: _summary(*of, masses=masses) for name, of in zip(analyses, known, strict=True)}


def _together(
    function: Callable[[Sequence[LoadedAnalysis]], Sequence[Values]],
    analyses: Sequence[LoadedAnalysis],
    layouts: Sequence[Hashable],
    *,
    positions: int | None = None,
) -> list[Values]:
    """Values of each analysis by a function that takes those of one layout together, in batches that memory holds, or one by one.

    `positions` are those at which it looks at each of them, by default those of the analyses.
    """
    groups: dict[Hashable, list[int]] = {}
    for number, (analysis, layout) in enumerate(zip(analyses, layouts, strict=True)):
        alone = number if layout is None else None
        groups.setdefault((layout, alone, analysis.full.crank_angle.tobytes()), []).append(number)
    by_number: dict[int, Values] = {}
    for members in groups.values():
        most = min(MAX_BATCH_POSITIONS, *(positions_together(analyses[number].drive) for number in members))
        many = max(1, most // (positions or analyses[members[0]].full.crank_angle.size))
        for part in (members[first : first + many] for first in range(0, len(members), many)):
            try:
                values = function([analyses[number] for number in part])
            except ConvergenceError:  # one of them has no answer
                if len(part) == 1:
                    raise
                values = [function([analyses[number]])[0] for number in part]
            by_number |= zip(part, values, strict=True)
    return [by_number[number] for number in range(len(analyses))]


def _summary(
    analysis: LoadedAnalysis, unloaded: Values, plays: Values, refined: Values, *, masses: bool
) -> dict[str, float | None]:
    """The scalars of one case from what was solved for it."""
    arrays = case_arrays(analysis)
    full, contacts = analysis.full, analysis.full.response
    angle = full.crank_angle
    pins, rollers, holes = (
        load > LOADED_FRACTION * np.max(load, initial=0.0)
        for load in (contacts.pin_load, contacts.rollers.outer_load, contacts.hole_load)
    )
    pressures, discs = analysis.pressures, analysis.drive.disc.number_of_discs
    values = {
        "backlash_disc": unloaded["backlash_disc"],
        "backlash_wheel": unloaded["backlash_wheel"],
        **plays,
        "interference": unloaded["interference"],
        "pin_end_cell": pressures.pins.end_cell,
        "roller_end_cell": pressures.outer.end_cell,
        "pin_shaft_end_cell": pressures.holes.end_cell,
        "pin_shaft_loaded_range": 360.0 * np.mean(holes) if holes.size else np.nan,
        "mean_loaded_pins": np.mean(pins.sum(axis=1)) / discs,
        "mean_loaded_rollers": np.mean(rollers.sum(axis=1)) / (discs * analysis.drive.crank.number),
        "mean_loaded_pin_shaft_pins": np.mean(holes.sum(axis=1)) / discs if holes.size else np.nan,
        "max_equilibrium_residual": max(np.max(full.residual), np.max(analysis.light.residual)),
        **scalars_of_positions(analysis, arrays),
        "cycloid_stage_stiffness": analysis.stiffness_from_light(analysis.stage_wind_up),
        "reducer_stiffness": analysis.stiffness_from_light(analysis.wind_up),
        **(mass_values(analysis.as_written) if masses else dict.fromkeys(OF_MASSES, np.nan)),
    }
    values |= {f"compliance_share_{part}": np.mean(share) for part, share in analysis.compliance_shares.items()}
    values |= {f"refined_{name}": refined.get(name, np.nan) for name in values if name in REFINED}
    values |= _sampling(sampling(analysis.drive, angle))
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
    values |= _sums(arrays, *OF_WIDTH)
    values |= _of_cranks(analysis) | _sums(arrays, *OF_PINS, *OF_REACTIONS) | _of_friction(analysis, arrays)
    values |= _of_main_bearing(arrays)
    return values | _sums(arrays, "max_root_stress", "max_bore_stress", "max_hole_stress")


def scalar_key(name: str) -> str:
    """The key of a scalar, also of one over the whole turn."""
    bare = name.removeprefix("refined_")
    return name.removesuffix(bare) + scalar_named(bare).key


def _unloaded(analyses: Sequence[LoadedAnalysis]) -> list[dict[str, float]]:
    """Backlash of flank and pins alone, the discs in their nominal places, and the largest overlap of any parts there."""
    angle = analyses[0].full.crank_angle
    rows, angles = np.repeat(np.arange(len(analyses)), angle.size), np.tile(angle, len(analyses))
    geometries = zip(*(analysis.model.geometries for analysis in analyses), strict=True)
    discs = [take_rows(stack_drives(own, 1), rows) for own in geometries]

    def of_cases(values: FloatArray) -> FloatArray:
        return values.reshape(len(analyses), angle.size)

    wheel = of_cases(backlash(discs, angles, WHEEL_ANGLE)).mean(axis=1) * ARCMIN
    own = np.min([of_cases(backlash([disc], angles, DISC_ROTATION)).mean(axis=1) for disc in discs], axis=0) * ARCMIN
    overlap = np.max([of_cases(interference(disc, angles)).max(axis=1) for disc in discs], axis=0)
    largest = [overlap_at_rest(one.drive, flank)[0] for one, flank in zip(analyses, overlap.tolist(), strict=True)]
    return [dict(zip(OF_FLANK, each, strict=True)) for each in np.stack([wheel, own, largest], axis=1).tolist()]


def _plays(analyses: Sequence[LoadedAnalysis], near: TurnPlay | None = None) -> list[dict[str, float]]:
    """Free play of the output with every clearance over a turn: the largest, which is what is judged, and the least."""
    try:
        before = [partial(play_before_cranks, analysis.model) for analysis in analyses]
        found = plays_over_a_turn([analysis.model.geometries for analysis in analyses], near, before)
    except ConvergenceError:
        if len(analyses) > 1:
            raise
        return [
            dict.fromkeys(FREE_PLAY, np.nan)
        ]  # nothing stops the wheel, or no pose was found: there is no play to tell
    scales = [abs(analysis.drive.output_per_wheel_angle) * ARCMIN for analysis in analyses]
    plays = [scale * np.array([play.largest, play.least]) for scale, play in zip(scales, found, strict=True)]
    return [
        dict(zip(FREE_PLAY, (*play.tolist(), turn.preloaded), strict=True))
        for play, turn in zip(plays, found, strict=True)
    ]


SUMS: dict[str, Callable[..., Any]] = {
    "max": np.max,
    "min": np.min,
    "mean": np.mean,
    "ptp": np.ptp,
    "largest known": np.nanmax,
    "largest amount": lambda values: np.max(np.abs(values)),
    "largest length": lambda values: np.max(np.hypot(values[..., 0], values[..., 1])),
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
        "drag_torque": found.drag_torque,
        **_sums(arrays, "mean_input_torque", "mean_input_torque_back", "power_loss"),
        **{f"power_loss_{kind}": float(np.mean(found.watts(found.by_kind[kind]))) for kind in KINDS},
        **_sums(arrays, *(f"mean_loss_{kind}" for kind in KINDS), *(f"max_{name}" for name in rubbed)),
    }


def _of_main_bearing(arrays: Mapping[str, FloatArray]) -> dict[str, float]:
    """Largest loads of the main bearing; nothing where the file says nothing of it."""
    if "main_bearing_x" not in arrays:
        return {}
    axial = "main_bearing_axial_displacement"
    return ({f"max_{axial}": float(np.max(np.abs(arrays[axial])))} if axial in arrays else {}) | {
        "max_main_bearing_radial": float(np.max(np.hypot(arrays["main_bearing_x"], arrays["main_bearing_y"]))),
        "max_main_bearing_axial": float(np.max(np.abs(arrays["main_bearing_z"]))),
        "max_main_bearing_moment": float(
            np.max(np.hypot(arrays["main_bearing_moment_x"], arrays["main_bearing_moment_y"]))
        ),
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


def _refined_with(analysis: LoadedAnalysis) -> Hashable:
    """What analyses must agree in whose extremes are refined together; None for those that are refined alone, or not at all."""
    together = analysis.engine.batches and analysis.engine.options["contacts"] != "grids" and _is_whole(analysis)
    return batch_layout(analysis.model) if together else None


def _is_whole(analysis: LoadedAnalysis) -> bool:
    return analysis.is_complete and is_full_turn(analysis.full.crank_angle)


def _refined(analyses: Sequence[LoadedAnalysis]) -> list[dict[str, float]]:
    """Extremes over the whole turn; none where the positions are no whole turn, or one between them has no answer."""
    if not _is_whole(analyses[0]):
        return [{}]
    try:
        return [extremes.values for extremes in refine_together(analyses)]
    except ConvergenceError:  # those of the positions stand
        if len(analyses) > 1:
            raise
        return [{}]


def _sampling(found: Sampling) -> dict[str, float]:
    return {
        "positions": found.positions,
        "positions_per_mesh_period": found.positions_per_mesh_period,
        "distinct_mesh_phases": found.distinct_mesh_phases,
    }
