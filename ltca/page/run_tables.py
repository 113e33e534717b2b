"""Tables of a run: verdict, loads, pressures, transmission error and its orders, losses, inputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from math import degrees
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.analysis.extremes import is_full_turn
from ltca.analysis.summary import refined_value
from ltca.analysis.summary_rows import FRICTION_ROWS, rows_of, with_residual_part
from ltca.analysis.transmission_error_orders import NAMED_HARMONICS, fitted_orders
from ltca.arrays import FloatArray
from ltca.drive.fields import field_kind
from ltca.drive.materials import Material
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCSEC, label
from ltca.page.derived import derived_rows
from ltca.page.tables import NOTHING, Cell, Table, minus, number, texts, word
from ltca.quantities import Scalar

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

Summaries = Mapping[str, Mapping[str, float | None]]

GROUPS = ("loads", "pressures", "transmission", "losses", "rest")
ELSEWHERE = ("cycloid_stage_stiffness", "reducer_stiffness")
"""Scalars that the section on the wind-up has, least and largest."""
ORDERS_SHOWN = 8
"""Orders of the transmission error in the table."""
ORDER_TOLERANCE = 1e-9
"""Departure up to which an order counts as a whole one."""


def summary_tables(drives: Mapping[str, Drive], summaries: Summaries) -> dict[str, Table]:
    """Return the scalars of the cases side by side, by `GROUPS`; those that have a row."""
    yields = any(drive.crank.support or drive.wheel_yields or drive.carrier for drive in drives.values())
    whole = {name: with_residual_part(case) for name, case in summaries.items()}
    captions = {"transmission": "Transmission error and backlash", "rest": "What else is known of the answer"}
    rows: dict[str, list[list[Cell]]] = {name: [] for name in GROUPS}
    for row in rows_of(whole, yields=bool(yields)):
        values = [refined_value(case, row.key) for case in whole.values()]
        if all(value is None for value in values) or row.name in ELSEWHERE:
            continue
        rows[_group(row)].append(
            [word(row.title), *(number(value, f"{{:{row.digits}}}", row.unit) for value in values)]
        )
    return {
        name: Table(name=name, caption=captions.get(name, ""), columns=["", *whole], rows=each)
        for name, each in rows.items()
        if each
    }


def _group(row: Scalar) -> str:
    if row.name in FRICTION_ROWS:
        return "losses"
    if "transmission_error" in row.name or row.name.startswith(
        ("backlash", "min_backlash", "preloaded", "interference")
    ):
        return "transmission"
    if row.unit == "MPa":
        return "pressures"
    return "rest" if "residual" in row.name or row.name.startswith("compliance_share") else "loads"


def turn_orders(case: Labelled) -> FloatArray | None:
    """Return the amplitudes of whole orders over one turn, from 1, arc seconds; None where positions are no turn."""
    angle = case["crank_angle"].values
    if not is_full_turn(angle) or np.any(case["status"].values) or np.any(case["status_light"].values):
        return None
    lines = np.fft.rfft(case["transmission_error"].values) * (2.0 / angle.size) * ARCSEC
    return np.asarray(np.abs(lines[1 : (angle.size + 1) // 2]))


def orders_table(dataset: Labelled, drives: Mapping[str, Drive]) -> Table | None:
    """Return the largest whole orders of the transmission error, cases side by side; None where there are none."""
    each = {name: turn_orders(dataset.isel(case=place)) for place, name in enumerate(drives)}
    found = {name: lines for name, lines in each.items() if lines is not None and lines.size}
    if not found:
        return None
    largest = np.max(list(found.values()), axis=0)
    chosen = np.sort(np.argsort(-largest, kind="stable")[:ORDERS_SHOWN])
    drive = next(iter(drives.values()))
    names = {
        round(one.value): one.name
        for one in fitted_orders(drive, harmonics=NAMED_HARMONICS)
        if abs(one.value - round(one.value)) < ORDER_TOLERANCE
    }
    rows = [
        [
            word(str(place + 1)),
            word(minus(names.get(int(place) + 1, NOTHING))),
            *(number(float(lines[place]), "{:.3f}", "arcsec") for lines in found.values()),
        ]
        for place in chosen
    ]
    columns = ["order", "where it comes from", *found]
    return Table(name="orders", caption="Largest whole orders, amplitudes", columns=columns, rows=rows, words=1)


def input_tables(drives: Mapping[str, Drive]) -> list[Table]:
    """Return every field that is given, with its unit: those in which cases differ, and what all have."""
    flat = {
        name: {path: value for path, value in _leaves(drive, "") if not path.startswith(_not_there(drive))}
        for name, drive in drives.items()
    }
    paths = list(dict.fromkeys(path for each in flat.values() for path in each))
    differing, common = [], []
    for path in paths:
        values = [each.get(path) for each in flat.values()]
        if all(value == values[0] for value in values):
            common.append([word(path), _input(values[0], path), word(_unit(path))])
        else:
            differing.append([word(path), word(_unit(path)), *(_input(value, path) for value in values)])
    told = "fields that all cases share" if differing else "fields"
    columns = ["field", "value", "unit"]
    tables = [Table(name="inputs", caption=told, columns=columns, rows=common, words=2, folded=True)]
    if not differing:
        return tables
    heads, caption = ["field", "unit", *drives], "What differs between cases"
    return [Table(name="inputs_by_case", caption=caption, columns=heads, rows=differing, words=1), *tables]


def _not_there(drive: Drive) -> tuple[str, ...]:
    """How fields begin of parts that a drive is without; properties that warmth has use for elsewhere stay."""
    shaft, parts = drive.pin_shaft, drive.materials
    kinds = {drive.pin_wheel.seat.kind, shaft.seat.kind if shaft is not None else ""}
    there = {
        "shaft_pin": shaft is not None,
        "crankshaft": drive.crank.support is not None,
        "wheel_seat": drive.pin_wheel.seat.kind == "slot",
        "sleeve": "sleeve" in kinds,
        "carrier": drive.posts is not None,
    }
    without = [
        f"materials.{part}." for part, is_there in there.items() if not is_there and getattr(parts, part) == Material()
    ]
    return (*without, *(() if shaft is not None else ("clearance.pin_hole",)))


def _leaves(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    for item in fields(part):
        value, name = getattr(part, item.name), f"{path}.{item.name}" if path else item.name
        if not item.compare:  # the name of the case, which heads the column
            continue
        if is_dataclass(value):
            yield from _leaves(value, name)
        elif isinstance(value, tuple) and any(is_dataclass(entry) for entry in value):
            for place, entry in enumerate(value):
                yield from _leaves(entry, f"{name}.{place}")
        elif value is not None and value != ():
            yield name, value


def _unit(path: str) -> str:
    kind = field_kind(path)
    return "" if kind is None or kind.unit in ("", "dimensionless") else label(kind.unit)


def _input(value: Any, path: str) -> Cell:
    if value is None:
        return word(NOTHING)
    if isinstance(value, tuple):
        return Cell(
            text=minus(", ".join(_words(each) for each in value)), value=" ".join(_words(each) for each in value)
        )
    note = ""
    if _unit(path) == "rad" and isinstance(value, float) and value:
        note = minus(f"{degrees(value):.6g}°")
    return Cell(text=minus(_words(value)), value=_words(value), note=note)


def _words(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def derived_tables(written: Mapping[str, Drive], drives: Mapping[str, Drive]) -> list[Table]:
    """Return values derived from the inputs, as given and warm: cases side by side where they differ, otherwise once."""
    each = {name: dict(derived_rows(written[name], drive, plays=False)) for name, drive in drives.items()}
    titles = list(dict.fromkeys(title for rows in each.values() for title in rows))
    cases = list(each.values())
    if all(case == cases[0] for case in cases):
        return [Table(name="derived", caption="", columns=["", "value"], rows=texts(cases[0].items()), words=1)]
    same = [title for title in titles if len({case.get(title, NOTHING) for case in cases}) == 1]
    rows = [
        [word(title), *(word(minus(case.get(title, NOTHING))) for case in cases)]
        for title in titles
        if title not in same
    ]
    differing = Table(
        name="derived_by_case", caption="What differs between cases", columns=["", *each], rows=rows, words=len(cases)
    )
    common = texts((title, cases[0].get(title, NOTHING)) for title in same)
    return [
        differing,
        Table(name="derived", caption="What all cases have", columns=["", "value"], rows=common, words=1),
    ]
