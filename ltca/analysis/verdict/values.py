"""What is judged: values with the part and the crank angle where they are reached."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf, isclose, isfinite

import numpy as np

from ltca.analysis.contact_arrays import PARTS, contact_arrays
from ltca.analysis.extremes import RESOLVED
from ltca.analysis.half_width_guard import HALF_WIDTH_BOUND
from ltca.analysis.life.bearing_lives import bearing_lives
from ltca.analysis.life.equivalent_load import covers_whole_turns
from ltca.analysis.life.life_text import life_summary
from ltca.analysis.light_torque import light_torque_lines
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.results import case_arrays
from ltca.analysis.summary import refined_value
from ltca.analysis.verdict.assembly import assembly_values
from ltca.analysis.verdict.duty import worst_of_duty
from ltca.analysis.verdict.geometry import pin_hollow_margin, roller_gap, undercut_margin, walls
from ltca.analysis.verdict.pin_stress import PinStress, pin_stress
from ltca.analysis.verdict.places import largest_value, most_of
from ltca.analysis.verdict.proportions import odd_proportions
from ltca.arrays import place_of_largest
from ltca.compliance.response import ContactPressures, KindPressures
from ltca.contact.subsurface import LINE_SHEAR_DEPTH, line_contact_shear, line_contact_shear_at
from ltca.drive.members.judgement import ANYWHERE, WHOLE, Check, Value, allowable_anywhere, judge
from ltca.drive.members.limits import Limit
from ltca.drive.single_discs import single_discs
from ltca.drive.yielding_parts import yielding_parts
from ltca.errors import OverloadError
from ltca.geometry.interference import overlap_at_rest
from ltca.geometry.play import PLAY_SAMPLED, preload_words
from ltca.quantities import LIMITED, QUANTITIES

DEMANDED = {
    limit.quantity: limit
    for limit in (
        WHOLE,
        Limit(
            quantity="half_width_ratio", sense="max", value=HALF_WIDTH_BOUND,
            source="theory of half-spaces",
        ),
        Limit(
            quantity="distinct_mesh_phases", sense="min", value=float(RESOLVED), source="sampling of the mesh"
        ),
        Limit(
            quantity="axial_play_taken", sense="max", value=1.0,
            source="geometry: the rim of a tilted disc touches beside it (disc.axial_play)",
        ),
    )
}  # fmt: skip
"""What theories demand, by quantity."""
OF_LOADS = (
    "pin_load", "roller_load", "pin_shaft_load", "bearing_load", "pin_pressure_mid", "roller_pressure_mid_outer",
    "roller_pressure_mid_inner", "pin_shaft_pressure_mid",
)  # fmt: skip
"""Loads and pressures that may be limited, in the order of the verdict."""
LIVES = ("bearing_life_million_turns", "bearing_life_hours", "bearing_life_modified_hours", "static_safety_S0")
"""What `ltca.analysis.life` tells."""


def find_values(analysis: LoadedAnalysis, summary: Mapping[str, float | None], *, lives: bool = True) -> list[Value]:
    """Return everything that may be judged of one case and its summary; bearing lives, which take 1 s, on demand."""
    found = [*_of_shape(analysis), *_of_loads(analysis, summary), *_of_pins(analysis), *_of_walls(analysis)]
    found += [*_anywhere(analysis, summary), *_of_tilt(analysis)]
    found += _of_lives(analysis) if lives else []
    return [*found, *_of_theory(analysis, summary), *assembly_values(analysis), *_of_friction(analysis, summary)]


def judge_analysis(
    analysis: LoadedAnalysis, summary: Mapping[str, float | None], limits: Mapping[str, Limit], *, lives: bool = True
) -> list[Check]:
    """Return the checks of one case against the limits of its drive file; lives that have a limit are judged in any case."""
    wanted = lives or any(limit.quantity in LIVES for limit in limits.values())
    values = worst_of_duty(analysis, find_values(analysis, summary, lives=wanted), find_values)
    if analysis.drive.contact.slices == 1:  # pressures at ends are judged where a limit asks for them
        asked = {limit.quantity for limit in limits.values()}
        if "roller_pressure_max" in asked:
            asked |= {"roller_pressure_max_outer", "roller_pressure_max_inner"}
        values = [value for value in values if value.quantity not in ANYWHERE or value.quantity in asked]
    return judge(analysis.drive, values, limits, DEMANDED | _allowable_inside(analysis, values, limits))


def _allowable_inside(
    analysis: LoadedAnalysis, values: Sequence[Value], limits: Mapping[str, Limit]
) -> dict[str, Limit]:
    """Allowable pressures of the joints whose contacts end before their lines do, by quantity."""
    kinds, known = _kinds_anywhere(analysis.pressures), {value.quantity: value for value in values}
    found = {}
    for quantity, kind in kinds.items():
        value, along = known.get(quantity), kind.along
        if value is None or along is None or np.nanmax(along.end_load, initial=0.0) > 0.0:
            continue
        if any(
            limit.sense == "max" and limit.quantity in (quantity, "roller_pressure_max") for limit in limits.values()
        ):
            continue
        limit = allowable_anywhere(analysis.drive, value)
        if limit is not None:
            found[quantity] = limit
    return found


def _kinds_anywhere(pressures: ContactPressures) -> dict[str, KindPressures]:
    """Pressures by the names of their largest anywhere."""
    return dict(zip(ANYWHERE, (pressures.pins, pressures.outer, pressures.inner, pressures.holes), strict=True))


def _anywhere(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> Iterator[Value]:
    """Largest pressures anywhere along the width, with the height where that is known; refined between the positions."""
    names = ("wheel pin", "roller", "roller", "shaft pin")
    rollers = max(
        ("roller_pressure_max_outer", "roller_pressure_max_inner"),
        key=lambda name: float(np.max(_kinds_anywhere(analysis.pressures)[name].largest, initial=0.0)),
    )
    for (quantity, kind), name in zip(_kinds_anywhere(analysis.pressures).items(), names, strict=True):
        if not kind.largest.shape[1]:
            continue
        scalar = "roller_pressure_max" if quantity == rollers else quantity
        refined = refined_value(summary, LIMITED[scalar].key) if scalar in LIMITED else None
        value = largest_value(analysis, quantity, kind.largest, name, refined)
        if kind.along is not None and value.value is not None:
            height = kind.along.place[place_of_largest(kind.largest)]
            value = replace(value, part=f"{value.part}, z = {height:.3g} mm")
        yield value


def _of_tilt(analysis: LoadedAnalysis) -> Iterator[Value]:
    """Tilts of the discs, what they take of the axial play, and face load factors; nothing in the plane."""
    arrays = case_arrays(analysis)
    if "disc_tilt" not in arrays:
        return
    for part, name in (("pin", "wheel pins"), ("roller", "rollers"), ("pin_shaft", "shaft pins")):
        each = np.asarray(arrays[f"{part}_face_load_factor"])
        each = np.moveaxis(each, -1, 0).reshape(each.shape[-1], -1)
        if np.any(np.isfinite(each)):
            found = largest_value(analysis, f"{part}_face_load_factor", each, name, discs=1)
            yield replace(found, part=name)
    tilt = np.hypot(*np.moveaxis(np.asarray(arrays["disc_tilt"]), -1, 0)).T
    yield largest_value(analysis, "disc_tilt", tilt, "")
    play = analysis.drive.disc.axial_play
    if play is not None:
        rims = [model.geometry.profile.tip_radius for model in analysis.model.discs]
        yield largest_value(analysis, "axial_play_taken", 2.0 * float(np.max(rims)) * tilt / play, "")


STIFF_PINS = 10.0
"""Stiffness of a shaft pin, by E times thickness of the disc, beyond which it is pointed out: walls of holes yield alike."""


def notes(analysis: LoadedAnalysis) -> list[str]:
    """Return what to know beside the checks, one sentence each: warnings, odd sizes, pins that dwarf the disc."""
    drive, shaft = analysis.drive, analysis.drive.pin_shaft
    found = [*analysis.warnings, *odd_proportions(analysis.as_written), yielding_parts(drive).words]
    beside = analysis.engine_words, analysis.width_words, analysis.hole_words, analysis.share_words
    found += [words for words in beside if words]
    found += light_torque_lines({drive.case: drive}, analysis.torque)
    if shaft is not None and shaft.stiffness is not None and analysis.engine.compliance == "half-space":
        disc = drive.materials.disc.youngs_modulus * drive.disc.thickness
        if shaft.stiffness > STIFF_PINS * disc:
            found.append(
                f"pin_shaft.stiffness = {shaft.stiffness:g} N/mm dwarfs the disc (E times thickness {disc:.4g} N/mm): the wall "
                "of the hole yields more than the pin, and half-spaces leave it out; try --compliance hybrid"
            )
    return found


def _of_shape(analysis: LoadedAnalysis) -> Iterator[Value]:
    singles = single_discs(analysis.drive)
    yield _least("undercut_margin", [{"": undercut_margin(one)} for one in singles])
    yield _least("pin_hollow_margin", [{"": pin_hollow_margin(one)} for one in singles])
    yield _least("wall", [dict(walls(one)) for one in singles])
    yield Value(quantity="roller_gap", value=roller_gap(analysis.drive), part="between neighbouring rollers")


def _least(quantity: str, discs: Sequence[Mapping[str, float]]) -> Value:
    """The least of the named values of all discs; the disc is named where another one has more in the same place."""
    number, name = min(
        ((number, name) for number, named in enumerate(discs) for name in named),
        key=lambda place: discs[place[0]][place[1]],
    )
    value = discs[number][name]
    if not isfinite(value):
        return Value(quantity=quantity, value=None, reason="the flank has no hollow")
    differs = any(not isclose(named.get(name, inf), value) for named in discs)
    return Value(
        quantity=quantity, value=value, part=", ".join(filter(None, (f"disc {number}" if differs else "", name)))
    )


def _of_loads(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> Iterator[Value]:
    angle = analysis.full.crank_angle
    for quantity in ("backlash_disc", "backlash_wheel"):
        yield Value(quantity=quantity, value=summary[LIMITED[quantity].key])
    overlap = summary[LIMITED["interference"].key]
    yield Value(
        quantity="interference",
        value=overlap,
        part="" if overlap is None else overlap_at_rest(analysis.drive, overlap)[1],
    )
    play = summary["backlash_output_arcmin"]
    yield Value(
        quantity="backlash_output",
        value=play,
        part=", ".join(filter(None, (preload_words(summary["preloaded_part_of_turn"] or 0.0), PLAY_SAMPLED))),
        reason=""
        if play is not None
        else "no pose of rigid parts stops the wheel within half a pin pitch, or none was found",
        least=summary["min_backlash_output_arcmin"],
    )
    yield Value(quantity="mean_loaded_pins", value=summary["mean_loaded_pins"])
    yield Value(quantity="ptp_transmission_error", value=refined_value(summary, LIMITED["ptp_transmission_error"].key))
    bearing = np.hypot(analysis.bearing_radial, analysis.bearing_tangential).reshape(angle.size, -1)
    arrays = contact_arrays(analysis.full.response, analysis.pressures) | {"bearing_load": bearing}
    races = race_pressures(analysis, summary)
    for quantity in OF_LOADS:
        several = "crank" if analysis.drive.crank.number > 1 else ""
        each, name = arrays[quantity], PARTS.get(QUANTITIES[quantity].of, several)
        if each.shape[1]:
            refined = races[quantity] if quantity in races else refined_value(summary, LIMITED[quantity].key)
            yield largest_value(analysis, quantity, each, name, refined)


def race_pressures(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> dict[str, float | None]:
    """Return the largest pressures in bores and on inner races, MPa: of the larger one a summary has that between positions."""
    sampled = {
        "roller_pressure_mid_outer": analysis.pressures.outer.mid,
        "roller_pressure_mid_inner": analysis.pressures.inner.mid,
    }
    known = {name: pressure[np.isfinite(pressure)] for name, pressure in sampled.items()}
    found = {name: float(np.max(pressure)) for name, pressure in known.items() if pressure.size}
    if found:
        larger = max(found, key=lambda name: found[name])
        found[larger] = max(found[larger], refined_value(summary, LIMITED["roller_pressure_mid"].key) or 0.0)
    return {name: found.get(name) for name in sampled}


def _of_pins(analysis: LoadedAnalysis) -> Iterator[Value]:
    """Stress and deflection of pins, pressure of their seats."""
    for pins in ("wheel", "shaft") if analysis.drive.pin_shaft is not None else ("wheel",):
        name = f"{pins} pin"
        stress = pin_stress(analysis, "wheel" if pins == "wheel" else "shaft")
        yield _bending_fatigue(analysis, stress, pins)
        for kind in ("bending", "shear"):
            quantity = f"{pins}_pin_{kind}_stress"
            if stress is None:
                yield Value(quantity=quantity, value=None, reason=f"{name}s are no beams (pin_{pins}.beam)")
            else:
                yield largest_value(analysis, quantity, getattr(stress, kind), name, discs=1)
    arrays = case_arrays(analysis)
    for quantity in ("pin_seat_pressure", "hole_seat_pressure", "pin_deflection", "shaft_pin_deflection"):
        variable = LIMITED[quantity].of
        if variable in arrays:
            name = PARTS[QUANTITIES[variable].of]
            yield largest_value(analysis, quantity, np.concatenate(arrays[variable], axis=1), name)


def _bending_fatigue(analysis: LoadedAnalysis, stress: PinStress | None, pins: str) -> Value:
    quantity = f"{pins}_pin_bending_amplitude"
    if stress is None:
        return Value(quantity=quantity, value=None, reason=f"{pins} pins are no beams (pin_{pins}.beam)")
    if not (covers_whole_turns(analysis.full.crank_angle) and np.all(analysis.balanced)):
        return Value(quantity=quantity, value=None, reason="positions cover no whole turns")
    cycle = stress.cycle
    told = "it rolls: fully reversed" if stress.rolls else f"stress ratio {cycle.ratio:.2g}"
    part = f"{pins} pins" if cycle.pin is None else f"{pins} pin {cycle.pin}"
    return Value(quantity=quantity, value=cycle.equivalent_amplitude, part=f"{part}, {told}")


def _of_walls(analysis: LoadedAnalysis) -> Iterator[Value]:
    """Stresses of the disc: along its walls where the engine knows them, and below its contacts."""
    for wall in ("root", "bore", "hole") if analysis.drive.pin_shaft is not None else ("root", "bore"):
        if not analysis.wall_stresses:
            told = "half-spaces have no walls (--compliance fe or hybrid)"
            yield Value(quantity=f"{wall}_stress", value=None, reason=told)
            continue
        parts = [np.asarray(getattr(walls_of, wall)) for walls_of in analysis.wall_stresses]
        each = np.concatenate([part.reshape(part.shape[0], -1) for part in parts], axis=1)
        if np.any(np.isfinite(each)):
            yield largest_value(analysis, f"{wall}_stress", each, "lobe" if wall == "root" else wall)
    pressures = analysis.pressures
    kinds = [
        (kind, f"below {name}")
        for kind, name in ((pressures.pins, "wheel pin"), (pressures.outer, "roller"), (pressures.holes, "shaft pin"))
        if kind.mid.size
    ]
    yield most_of(
        largest_value(analysis, "disc_shear", line_contact_shear(kind.mid, np.zeros_like(kind.mid)), name)
        for kind, name in kinds
    )
    yield most_of(
        largest_value(analysis, "shear_depth", LINE_SHEAR_DEPTH * kind.half_width, name) for kind, name in kinds
    )
    case = analysis.drive.materials.disc.hardness_depth
    if case is not None:
        yield most_of(
            largest_value(analysis, "core_shear", line_contact_shear_at(kind.mid, kind.half_width, case), name)
            for kind, name in kinds
        )


def _of_lives(analysis: LoadedAnalysis) -> Iterator[Value]:
    """Shortest life and least static safety of the crank bearings, of positions that cover whole turns."""
    named = [name for name in LIVES if "modified" not in name or analysis.drive.lubricant is not None]
    if not covers_whole_turns(analysis.full.crank_angle):
        told = "positions cover no whole turns"
        yield from (Value(quantity=name, value=None, reason=told) for name in named)
        return
    try:
        lives = bearing_lives(analysis)
    except OverloadError as error:
        yield from (Value(quantity=name, value=None, reason=error.problems[0]) for name in named)
        return
    told = ("; ".join(lives.not_rated)) if lives.not_rated else "there is no speed (load.speed)"
    for name, value in life_summary(lives).items():
        if name == "static_safety_S0" and value is not None:  # the load counts beside the entries of a duty
            largest = float(np.max(np.hypot(analysis.bearing_radial, analysis.bearing_tangential)))
            value = min(value, lives.static_load_rating / largest)
        yield Value(quantity=name, value=value, reason="" if value is not None else told)
    if analysis.drive.lubricant is not None:
        modified = [one.modified_hours for one in lives.bearings if one.modified_hours is not None]
        known = not lives.not_rated and len(modified) == len(lives.bearings)
        yield Value(
            quantity="bearing_life_modified_hours",
            value=min(modified) if known else None,
            reason="" if known else "; ".join(lives.not_rated) or "below κ = 0.1 ISO 281 tells no a_ISO",
        )


def _of_theory(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> Iterator[Value]:
    """How far half-spaces and samples stand for what they stand for."""
    drive, pressures = analysis.drive, analysis.pressures
    radius = np.minimum(analysis.full.response.flank.effective_radius, drive.pin_wheel.pin_radius)
    ratios = [
        (pressures.pins.half_width / radius, "wheel pin"),
        (
            np.maximum(pressures.outer.half_width, pressures.inner.half_width) / drive.crank_bearing.roller_radius,
            "roller",
        ),
    ]
    if drive.pin_shaft is not None:  # as `wide_holes_warning` has it, which tells what it means for the drive
        ratios.append((pressures.holes.widest / drive.pin_shaft.pin_radius, "shaft pin"))
    yield most_of(largest_value(analysis, "half_width_ratio", each, name) for each, name in ratios)
    softer = min(drive.materials.disc.youngs_modulus, drive.flank_pin.youngs_modulus)
    yield largest_value(analysis, "contact_strain", pressures.pins.mid / softer, "wheel pin")
    yield Value(quantity="distinct_mesh_phases", value=summary["distinct_mesh_phases"])


def _of_friction(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> Iterator[Value]:
    if analysis.losses is None:
        for quantity in ("mean_efficiency", "pin_pv"):
            yield Value(quantity=quantity, value=None, reason="nothing rubs ([friction] is left out)")
        return
    for quantity in ("mean_efficiency", "mean_efficiency_back", "moves_back", "power_loss"):
        value = summary[LIMITED[quantity].key]
        through = "no torque goes through (load.torque = 0)" if "efficiency" in quantity else ""
        reason = through if analysis.torque == 0.0 and through else "there is no speed (load.speed)"
        yield Value(quantity=quantity, value=value, reason=reason if value is None else "")
    values = case_arrays(analysis)
    for quantity in ("pin_pv", "pin_seat_pv", "pin_shaft_pv", "hole_seat_pv"):
        if quantity not in values or not values[quantity].size:
            continue
        each = np.concatenate(values[quantity], axis=1)
        if np.any(np.isfinite(each)):
            yield largest_value(analysis, quantity, each, PARTS[QUANTITIES[quantity].of])
        else:
            yield Value(quantity=quantity, value=None, reason="there is no speed (load.speed)")
