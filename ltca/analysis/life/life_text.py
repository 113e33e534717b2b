"""What is told of lives: entries of a summary, the table of a JSON file, lines for the terminal."""

from __future__ import annotations

from math import isfinite
from typing import Any

from ltca.analysis.life.bearing_lives import BearingLife, BearingLives, EntryLife
from ltca.analysis.life.laminae import LAMINAE
from ltca.drive.parts import Drive


def life_summary(lives: BearingLives) -> dict[str, float | None]:
    """Return the scalars of a summary: the shortest life and the least static safety of all crank bearings.

    Parameters
    ----------
    lives : BearingLives
        Of all crank bearings.

    Returns
    -------
    dict of str to float or None
        ``bearing_life_million_turns``, ``bearing_life_hours`` (None without a speed), ``static_safety_S0``; None where
        nothing is rated.
    """
    shortest = lives.shortest
    if lives.not_rated:
        return dict.fromkeys(("bearing_life_million_turns", "bearing_life_hours", "static_safety_S0"))
    return {
        "bearing_life_million_turns": _finite(shortest.life),
        "bearing_life_hours": _finite(shortest.hours),
        "static_safety_S0": _finite(lives.static_safety),
    }


def life_content(lives: BearingLives, drive: Drive) -> dict[str, Any]:
    """Return what a JSON file holds of lives: the shortest first, then every bearing with the entries of its duty.

    Parameters
    ----------
    lives : BearingLives
        Of all crank bearings.
    drive : Drive
        Whose they are.
    """
    bearings = [_of_bearing(bearing) for bearing in (lives.shortest, *lives.bearings)]
    entries = [_of_entry(entry) for entry in lives.shortest.entries] if drive.duty else None
    if lives.not_rated:
        for told in (*bearings, *(entries or [])):
            told.update({name: None for name in told if name in RATED})
    return {
        **bearings[0],
        "dynamic_load_rating_N": lives.dynamic_load_rating,
        "static_load_rating_N": lives.static_load_rating,
        "fatigue_load_limit_N": lives.fatigue_load_limit,
        "ratings_of_maker": [*lives.of_maker],
        "least_static_safety_S0": None if lives.not_rated else _finite(lives.static_safety),
        "not_rated": [*lives.not_rated],
        "laminae": LAMINAE,
        "bearings": bearings[1:],
        "duty": entries,
    }


RATED = (
    "million_turns",
    "hours",
    "static_safety_S0",
    "life_modification_factor",
    "modified_million_turns",
    "modified_hours",
)
"""What is told of a bearing only where it is rated."""


def _of_bearing(bearing: BearingLife) -> dict[str, Any]:
    modified = {
        "life_modification_factor": None if bearing.modified_life is None else bearing.modified_life / bearing.life,
        "modified_million_turns": _finite(bearing.modified_life),
        "modified_hours": _finite(bearing.modified_hours),
    }
    return {
        "million_turns": _finite(bearing.life),
        "disc": bearing.disc,
        "crank": bearing.crank,
        "hours": _finite(bearing.hours),
        "equivalent_load_N": bearing.equivalent_load,
        "inner_roller_load_N": bearing.inner_load,
        "outer_roller_load_N": bearing.outer_load,
        "static_load_N": bearing.static_load,
        "static_safety_S0": _finite(bearing.static_safety),
        **(modified if any(entry.viscosity_ratio is not None for entry in bearing.entries) else {}),
    }


def _of_entry(entry: EntryLife) -> dict[str, Any]:
    return {
        "torque_N_mm": entry.torque,
        "crank_speed_rpm": entry.speed,
        "part_of_turns": entry.turns,
        "million_turns": _finite(entry.life),
        "equivalent_load_N": entry.equivalent_load,
        "static_load_N": entry.static_load,
        "viscosity_ratio": entry.viscosity_ratio,
        "life_modification_factor": entry.modification,
    }


def life_lines(lives: BearingLives, drive: Drive, speed: str | None) -> list[str]:
    """Return the lines of a terminal about lives.

    Parameters
    ----------
    lives : BearingLives
        Of all crank bearings.
    drive : Drive
        Whose they are.
    speed : str or None
        Which speed the hours are at, in words; those of the duty where it is None.
    """
    found = lives.shortest
    discs, cranks = drive.disc.number_of_discs, drive.crank.number
    named = ([f"disc {found.disc}"] if discs > 1 else []) + ([f"crank {found.crank}"] if cranks > 1 else [])
    which = f" of {', '.join(named)}, the shortest of {len(lives.bearings)}" if named else ""
    if lives.not_rated:
        told = "ISO 281 rates no such crank bearing (--load-rating gives the maker's): no life, no static safety"
        return [told, *(f"  {reason}" for reason in lives.not_rated), f"  largest force {found.static_load:.0f} N"]
    dynamic, static = (
        _rating(lives, *one) for one in (("C", lives.dynamic_load_rating), ("C0", lives.static_load_rating))
    )
    lines = [
        f"rating life of the crank bearing{which} ({_over(drive)})",
        f"  {dynamic}, P {found.equivalent_load:.0f} N, L10r {found.life:.1f} million turns",
    ]
    at = f" at {speed}" if speed is not None else ""
    if found.hours is not None:
        lines.append(f"  {found.hours:.0f} h{at}")
    lines.append(
        f"  {static}, largest force {found.static_load:.0f} N, S0 {found.static_safety:.2f}"
        + (f", least of all {lives.static_safety:.2f}" if lives.static_safety < found.static_safety else "")
    )
    if drive.duty:
        lines += [
            f"  {entry.torque / 1000.0:.6g} N·m: {100.0 * entry.turns:.3g} % of the turns, alone {entry.life:.1f} million turns"
            for entry in found.entries
        ]
    return lines + _modified_lines(found)


def _rating(lives: BearingLives, name: str, value: float) -> str:
    """A rating with its name and unit, and whose it is where it is not that of the standard."""
    return f"{name} {value:.0f} N" + (" (of the maker)" if name in lives.of_maker else "")


def _over(drive: Drive) -> str:
    return (
        f"over {len(drive.duty)} entries of the duty"
        if drive.duty
        else "each place of the races by the loads that pass it"
    )


def _modified_lines(found: BearingLife) -> list[str]:
    """What the lubricant makes of it."""
    ratios = [entry.viscosity_ratio for entry in found.entries if entry.viscosity_ratio is not None]
    if not ratios:
        return []
    kappa = f"{min(ratios):.3g}" + (f" … {max(ratios):.3g}" if len(ratios) > 1 else "")
    if found.modified_life is None:
        return [f"  κ {kappa}: below 0.1 ISO 281 tells no a_ISO, the surfaces touch"]
    hours = "" if found.modified_hours is None else f", {found.modified_hours:.0f} h"
    factor = found.modified_life / found.life
    return [f"  κ {kappa}, a_ISO {factor:.3g}: {found.modified_life:.1f} million turns{hours}"]


def _finite(value: float | None) -> float | None:
    return value if value is not None and isfinite(value) else None
