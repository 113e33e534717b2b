"""Page of ``cyclo curves``: torque curve, orders of the transmission error, life, flank pressure; all cases together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ltca.analysis.life.bearing_lives import BearingLives
from ltca.analysis.pressure_safety import PressureSafety
from ltca.analysis.stiffness_by_part import FORMS, HEADS, StiffnessByPart
from ltca.analysis.torque_curve import UNDER_FORCES, TorqueCurve
from ltca.analysis.transmission_error_orders import Spectrum
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.drive.yielding_parts import stiffness_notes
from ltca.figures.shared_axes import order_axes, pressure_axis, torque_axes
from ltca.page.run_sections import lives_of_cases
from ltca.page.study_page import Curves, Section
from ltca.page.tables import NOTHING, Cell, Table, minus, number, word
from ltca.quantities import SCALARS

ORDERS_SHOWN = 15
FALLING = "falling"
"""Behind the name of a case: the curve with friction on its way back."""


def torque_section(curves: Mapping[str, TorqueCurve], backlashes: Mapping[str, str] | None = None) -> Section:
    """Return wind-up over torque of all cases in one plot, and what is read from it; `backlashes` in words, by case."""
    # Curves at single crank angles lie on each other; the table has how far they differ.
    lines, dashed = dict[str, tuple[FloatArray, FloatArray]](), list[str]()
    for case, curve in curves.items():
        name = _of(case, curves)
        if curve.loop is None:
            lines[name] = curve.torque, curve.output_angle
        else:
            dashed.append(f"{name}, {FALLING}".removeprefix(", "))
            lines[name or "rising"] = curve.loop.torque, curve.loop.rising
            lines[dashed[-1]] = curve.loop.torque, curve.loop.falling
    plane = torque_axes(curves.values())
    x = np.unique(np.concatenate([torque for torque, _ in lines.values()]))
    plot = Curves(
        title="Angle of the output", unit="arc minutes", axis="torque at the output, N·m", x=x / 1e3,
        lines={name: _over(x, torque, np.mean(angle, axis=0) * ARCMIN) for name, (torque, angle) in lines.items()},
        along=plane.x, up=plane.y, dashed=dashed,
    )  # fmt: skip
    each = [_torque_rows(curve, (backlashes or {}).get(case, "")) for case, curve in curves.items()]
    titles = list(dict.fromkeys(title for rows in each for title in rows))
    rows = [[word(title), *(word(one.get(title, NOTHING)) for one in each)] for title in titles]
    heads = ["over the crank angles"] if len(curves) == 1 else list(curves)
    table = Table(name="torque_curve", caption="", columns=["", *heads], rows=rows)
    angles = {curve.crank_angle.size for curve in curves.values()}
    told = (
        f"Means of {' or '.join(map(str, sorted(angles)))} crank angles; the table has the range sampled there, if nothing else "
        "is said."
    )
    whose = stiffness_notes({name: curve.yielding for name, curve in curves.items()})
    if any(curve.displaced for curve in curves.values()):
        whose.append(f"{UNDER_FORCES[0].upper()}{UNDER_FORCES[1:]}.")
    return Section(heading="Torque curve", notes=[told, *whose], curves=[plot], tables=[table])


def _of(case: str, cases: Mapping[str, object]) -> str:
    """The name of a case, which a single one does without."""
    return case if len(cases) > 1 else ""


def _over(x: FloatArray, torque: FloatArray, angle: FloatArray) -> FloatArray:
    """A line through its own points, at those of all lines; nothing beyond its ends."""
    order = np.argsort(torque, kind="stable")
    return np.asarray(np.interp(x, torque[order], angle[order], np.nan, np.nan))


def _torque_rows(curve: TorqueCurve, backlash: str) -> dict[str, str]:
    title = SCALARS["backlash_output"].verdict_title
    rows = {
        f"lost motion at ±{100.0 * curve.lost_motion_part:g} % of the torque, ′": curve.lost_motion * ARCMIN,
        "torsional stiffness of the cycloid stage, 50 … 100 % of the torque, N·m/′": curve.stiffness / ARCMIN / 1e3,
        "torsional stiffness of the reducer with what the file describes, N·m/′": curve.reducer_stiffness
        / ARCMIN
        / 1e3,
    }
    if curve.loop is not None:
        rows["width of the loop of friction there, ′"] = curve.loop.width * ARCMIN
        rows["energy lost in a loop at the torque, J"] = curve.loop.energy / 1e3
    first = minus(backlash) or f"{_range(curve.backlash * ARCMIN)}′"
    return {title: first} | {title: _range(values) for title, values in rows.items()}


def parts_section(parts: Mapping[str, StiffnessByPart]) -> list[Section]:
    """Return the section on the stiffness with and without each part, a table for each case; none where it was not asked for."""
    if not parts:
        return []
    tables = [
        Table(
            name=f"stiffness_by_part_{case}" if len(parts) > 1 else "stiffness_by_part",
            caption=_of(case, parts),
            columns=["", *HEADS],
            rows=[[word(name), *map(number, read.printed, FORMS)] for name, read in found.rows.items()],
        )
        for case, found in parts.items()
    ]
    notes = dict.fromkeys(f"{note[0].upper()}{note[1:]}." for found in parts.values() for note in found.notes)
    return [Section(heading="Stiffness by part", notes=[*notes], tables=tables)]


def orders_section(spectra: Mapping[str, Spectrum], over: Sequence[str]) -> Section:
    """Return the orders of the transmission error, a plot for each case, and the largest in a table; `over` says what of."""
    plane = order_axes(spectra.values())
    plots = [
        Curves(
            title=f"{case}: orders of the transmission error".removeprefix(": "), unit="arc seconds",
            axis="order, per turn of the crank", x=np.array([order.value for order in spectrum.orders]),
            lines={"": spectrum.amplitude * ARCSEC}, kind="stems", along=plane.x, up=plane.y,
        )
        for case, spectrum in ((_of(case, spectra), spectrum) for case, spectrum in spectra.items())
    ]  # fmt: skip
    amplitudes = [
        {
            (order.value, order.name): float(size)
            for order, size in zip(spectrum.orders, spectrum.amplitude, strict=True)
        }
        for spectrum in spectra.values()
    ]
    every = list(dict.fromkeys(key for each in amplitudes for key in each))
    largest = sorted(every, key=lambda key: -max(each.get(key, 0.0) for each in amplitudes))[:ORDERS_SHOWN]
    rows = [
        [word(minus(name)), number(value), *(_arc_seconds(each.get((value, name))) for each in amplitudes)]
        for value, name in largest
    ]
    rest = [_arc_seconds(spectrum.residual) for spectrum in spectra.values()]
    rows.append([word("unexplained, root mean square"), word(""), *rest])
    heads = ["amplitude"] if len(spectra) == 1 else list(spectra)
    table = Table(name="orders", caption="", columns=["origin", "order", *heads], rows=rows)
    return Section(
        heading="Transmission error",
        notes=[f"Orders {one}." for one in dict.fromkeys(over)],
        curves=plots,
        tables=[table],
    )


def _arc_seconds(value: float | None) -> Cell:
    return number(None if value is None else value * ARCSEC, "{:.4f}", "arcsec")


def life_section(lives: Mapping[str, BearingLives], lines: Mapping[str, Sequence[str]]) -> Section:
    """Return the section on the life of the crank bearings: lives side by side, and by case what is told of each in lines."""
    heading = "Life of the crank bearings"
    if len(lives) == 1:
        return Section(heading=heading, notes=[minus(line.strip()) for each in lines.values() for line in each])
    told = [[word(case), word(minus("; ".join(line.strip() for line in each)))] for case, each in lines.items()]
    words = Table(
        name="life_in_words", caption="ratings in words", columns=["case", "rating"], rows=told, words=1, folded=True
    )
    return Section(heading=heading, tables=[*lives_of_cases(lives).tables, words])


class TurnOfPressure(NamedTuple):
    """The turn that holds the largest flank pressure of a case.

    Attributes
    ----------
    crank_angle : array, shape (positions,)
        rad.
    pressure : array, shape (positions, pins)
        At mid-width, MPa.
    safety : PressureSafety
        Of all turns.
    """

    crank_angle: FloatArray
    pressure: FloatArray
    safety: PressureSafety


def pressure_section(turns: Mapping[str, TurnOfPressure]) -> Section:
    """Return the largest flank pressure at each position of the turn that holds the largest of all, cases in one plot."""
    found = [turn.safety for turn in turns.values()]
    angles = [np.degrees(turn.crank_angle - turn.crank_angle[0]) for turn in turns.values()]
    x = np.unique(np.concatenate(angles))
    lines = {
        _of(case, turns) or "largest of all pins": _over(x, angle, turn.pressure.max(axis=1))
        for angle, (case, turn) in zip(angles, turns.items(), strict=True)
    }
    limits = sorted({safety.limit for safety in found if np.isfinite(safety.limit)})
    for limit in limits:
        lines["limit" if len(limits) == 1 else f"limit {limit:g} MPa"] = np.full(x.size, limit)
    plot = Curves(
        title="Largest flank pressure at mid-width", unit="MPa", axis="crank angle in its turn", x=x, lines=lines,
        degrees=True, up=pressure_axis(found),
    )  # fmt: skip
    rows = [
        [
            word(case), number(safety.largest, "{:.1f}"),
            number(safety.limit if np.isfinite(safety.limit) else None, "{:g}"), number(safety.safety, "{:.3f}"),
        ]
        for case, safety in zip(turns, found, strict=True)
    ]  # fmt: skip
    columns = ["case", "largest sampled, MPa", "limit, MPa", "safety"]
    table = Table(name="flank_pressure", caption="", columns=columns, rows=rows)
    return Section(heading="Flank pressure", curves=[plot], tables=[table])


def _range(values: FloatArray) -> str:
    return minus(f"{values.min():.4g} … {values.max():.4g}")
