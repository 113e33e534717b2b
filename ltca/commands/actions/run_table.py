"""The table of ``cyclo run``: loads, pressures, transmission error, backlash, stiffness and life of the cases side by side.

What decides a design, in the order in which it is read; page and ``summary.json`` have the rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor, isfinite, log10
from shutil import get_terminal_size

from ltca.analysis.life.bearing_lives import BearingLives
from ltca.analysis.life.life_text import life_summary
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.summary import refined_value
from ltca.analysis.verdict.values import race_pressures
from ltca.drive.units.quantities import ARCMIN
from ltca.drive.yielding_parts import stiffness_notes, yielding_parts
from ltca.quantities import printed, scalar_named

Summaries = Mapping[str, Mapping[str, float | None]]
Lives = Mapping[str, BearingLives | str]
Group = tuple[str, Sequence[tuple[str, str]]]

WIDTH = 80
"""Columns of a terminal that does not say how many it has, and of a file."""
LEAST_COLUMN = 9
BORE, RACE = "max_roller_pressure_mid_outer", "max_roller_pressure_mid_inner"
GROUPS: tuple[Group, ...] = (
    ("largest load [N]", (
        ("wheel pin", "max_pin_load"), ("roller", "max_roller_load"), ("shaft pin", "max_pin_shaft_load"),
        ("crank bearing", "max_bearing_load"), ("crank bearing, crank #", "max_bearing_load_crank_#"),
        ("crank in carrier, first", "max_crank_support_load_first"),
        ("crank in carrier, second", "max_crank_support_load_second"),
        ("planet, tangential", "max_first_stage_tangential_force"),
        ("planet, radial", "max_first_stage_radial_force"),
        ("planet, axial", "max_first_stage_axial_force"),
        ("main bearing, radial", "max_main_bearing_radial"), ("main bearing, axial", "max_main_bearing_axial"),
    )),
    ("parts that carry at once, mean", (
        ("wheel pins per disc", "mean_loaded_pins"), ("rollers per bearing", "mean_loaded_rollers"),
        ("shaft pins per disc", "mean_loaded_pin_shaft_pins"),
    )),
    ("part of the torque on a disc, largest", (("disc #", "max_torque_share_disc_#"),)),
    ("largest pressure at mid-width [MPa]", (
        ("flank", "max_pin_pressure_mid"), ("roller in the bore", BORE), ("roller on inner race", RACE),
        ("hole", "max_pin_shaft_pressure_mid"),
        ("wheel-pin seat", "max_pin_seat_pressure"), ("shaft-pin sleeve", "max_hole_seat_pressure"),
    )),
    ("largest stress along walls of the disc [MPa]", (
        ("lobe root", "max_root_stress"), ("bore", "max_bore_stress"), ("hole", "max_hole_stress"),
    )),
    ("largest deflection [mm]", (
        ("wheel pin", "max_pin_deflection"), ("shaft pin", "max_shaft_pin_deflection"),
        ("crank #", "max_crank_deflection_crank_#"),
        ("output along the axis", "max_main_bearing_axial_displacement"),
    )),
    ("transmission error, peak to peak [″]", (
        ("at the torque", "ptp_transmission_error"), ("at the light torque", "ptp_transmission_error_light"),
    )),
    ("backlash at the output, all clearances, sampled [′]", (
        ("largest over a turn", "backlash_output"), ("least over a turn", "min_backlash_output"),
        ("part of turn preloaded", "preloaded_part_of_turn"), ("overlap at rest, mm", "interference"),
    )),
)  # fmt: skip
"""Headings with the unit, and rows with the scalar of each; ``#`` stands for every disc or crank where there are several."""
WHERE_NOT_ZERO = ("preloaded_part_of_turn", "interference")
"""Scalars that have a row where they are not zero."""
WHERE_KNOWN = (
    "crank_support",
    "first_stage",
    "main_bearing",
    "pin_shaft",
    "shaft_pin",
    "seat",
    "stress",
    "deflection",
    "ptp",
)
"""Parts of names of scalars that not every drive, engine and run has: a single position has no range."""
LOSSES: Group = (
    "efficiency and losses",
    (
        ("efficiency, mean", "mean_efficiency"),
        ("moves back (1) or not", "moves_back"),
        ("power lost [W]", "power_loss"),
        ("drag at the input [N·mm]", "drag_torque"),
    ),
)
ALONG: Group = (
    "along the width",
    (
        ("largest flank pressure anywhere [MPa]", "max_pin_pressure_max"),
        ("largest roller pressure anywhere [MPa]", "max_roller_pressure_max"),
        ("largest hole pressure anywhere [MPa]", "max_pin_shaft_pressure_max"),
        ("face load factor K_Hβ, wheel pins", "max_pin_face_load_factor"),
        ("face load factor K_Hβ, rollers", "max_roller_face_load_factor"),
        ("face load factor K_Hβ, shaft pins", "max_pin_shaft_face_load_factor"),
        ("tilt of a disc [rad]", "max_disc_tilt"),
        ("moment of a crank bearing [N·mm]", "max_crank_bearing_moment"),
    ),
)
LIFE = (
    ("million turns", "bearing_life_million_turns", ".1f"),
    ("hours", "bearing_life_hours", ".0f"),
    ("static safety S0", "static_safety_S0", ".2f"),
)


def run_table(
    analyses: Mapping[str, LoadedAnalysis], summaries: Summaries, lives: Lives, loads: Mapping[str, str]
) -> str:
    """Return the table of a run, as many cases beside each other as the screen has columns for.

    `loads` has torque and direction in words of cases that differ in them, and is empty otherwise.
    """
    summaries = {name: {**case, **_of_races(analyses[name], case)} for name, case in summaries.items()}
    rows = [("torque, crank", [loads[name] for name in summaries])] if loads else []
    for heading, each in GROUPS:
        rows += _group(heading, [row for title, name in each for row in _rows(title, name, summaries)])
    if any(scalar_named("max_disc_tilt").key in case for case in summaries.values()):
        heading, each = ALONG
        rows += _group(heading, [row for title, name in each for row in _rows(title, name, summaries, known=True)])
    rows += _group("stiffness of the cycloid stage [N·m/′]", _stiffness_rows(summaries))
    rows += _group(
        "life of the crank bearings, L10r",
        [row for title, name, digits in LIFE for row in _life(title, name, digits, lives)],
    )
    heading, each = LOSSES
    rows += _group(heading, [row for title, name in each for row in _rows(title, name, summaries, known=True)])
    return "\n".join(_side_by_side([("", list(summaries)), *rows]))


def _group(heading: str, rows: list[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    return [(heading, []), *((f"  {title}", cells) for title, cells in rows)] if rows else []


def _rows(title: str, name: str, summaries: Summaries, *, known: bool = False) -> list[tuple[str, list[str]]]:
    """The row of a scalar, or one for each of several discs or cranks; none of what the drive has not."""
    if "#" in name:
        first = next(iter(summaries.values()))
        many = sum(scalar_named(name.replace("#", str(number))).key in first for number in range(len(first)))
        several = many > 1 or "deflection" in name
        return [
            row
            for number in range(many if several else 0)
            for row in _rows(title.replace("#", str(number)), name.replace("#", str(number)), summaries)
        ]
    scalar = scalar_named(name)
    values = [refined_value(case, scalar.key) for case in summaries.values()]
    if name in WHERE_NOT_ZERO and not any(values):
        return []
    if (known or any(part in name for part in WHERE_KNOWN)) and all(value is None for value in values):
        return []
    return [(title, [_number(value, scalar.digits, scalar.unit) for value in values])]


def _of_races(analysis: LoadedAnalysis, summary: Mapping[str, float | None]) -> dict[str, float | None]:
    """The pressures on both races by the keys of the rows."""
    return {scalar_named(f"max_{name}").key: value for name, value in race_pressures(analysis, summary).items()}


def _life(title: str, name: str, digits: str, lives: Lives) -> list[tuple[str, list[str]]]:
    values = [None if isinstance(one, str) else life_summary(one)[name] for one in lives.values()]
    return [] if all(value is None for value in values) else [(title, [_number(value, digits) for value in values])]


def _stiffness_rows(summaries: Summaries) -> list[tuple[str, list[str]]]:
    """Stiffness of the cycloid stage, and of the reducer where its file describes more."""
    rows = []
    titles = {
        "from light torque, least": "cycloid_stage_stiffness",
        "reducer as described, least": "reducer_stiffness",
    }
    for title, name in titles.items():
        values = [case.get(scalar_named(name).key) for case in summaries.values()]
        shown = [None if one is None else one / ARCMIN / 1e3 for one in values]
        rows.append((title, [_number(one, f".{_decimals(shown)}f") for one in shown]))
    return rows[: 1 + (rows[0][1] != rows[1][1])]


def _decimals(values: Sequence[float | None]) -> int:
    """Decimals that show at least three digits of each number, and no less than two decimals."""
    least = min((abs(value) for value in values if value), default=1.0)
    return max(2, 2 - floor(log10(least))) if isfinite(least) else 2


def _number(value: float | None, digits: str, unit: str = "") -> str:
    return "–" if value is None else printed(value, f"{{:{digits}}}", unit)


def whose_stiffness(analyses: Mapping[str, LoadedAnalysis]) -> list[str]:
    """Return what yields in the stiffness of every case and what is rigid because its file leaves it out, as lines."""
    return stiffness_notes({name: yielding_parts(analysis.drive) for name, analysis in analyses.items()})


def lives_told(lives: Lives) -> list[str]:
    """Return why cases have no life, one line for each reason."""
    reasons = {
        name: found if isinstance(found, str) else "; ".join(found.not_rated)
        for name, found in lives.items()
        if isinstance(found, str) or found.not_rated
    }
    return [
        f"no life of the crank bearings{'' if len(reasons) == len(lives) else f' of {name}'}: {reason}"
        for name, reason in ({reason: (name, reason) for name, reason in reasons.items()}).values()
    ]


def _side_by_side(rows: list[tuple[str, list[str]]]) -> list[str]:
    """Rows with their cells in columns, as many columns beside each other as the screen shows, headings in rows of their own."""
    head = max(len(title) for title, cells in rows if cells)
    columns = len(rows[0][1])
    widths = [max(LEAST_COLUMN, *(len(cells[column]) + 2 for _, cells in rows if cells)) for column in range(columns)]
    many = max(1, (get_terminal_size(fallback=(WIDTH, 24)).columns - head) // max(widths))
    return [
        (f"{title:<{head}}" + "".join(f"{cells[c]:>{widths[c]}}" for c in range(first, min(first + many, columns))))
        if cells
        else title
        for first in range(0, columns, many)
        for title, cells in rows
    ]
