"""Page of ``cyclo dynamics``: modes, Campbell diagram, critical speeds, response over speed."""

from __future__ import annotations

import numpy as np

from ltca.analysis.force_orders import ForceSpectrum
from ltca.analysis.forced_vibration import OPERATION, ForcedVibration, response_notes
from ltca.analysis.mass_values import mass_rows
from ltca.analysis.vibration import Vibration
from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.units.quantities import ARCSEC
from ltca.page.study_page import Curves, Section
from ltca.page.tables import Table, folded, minus, number, texts, word

SPEEDS_SHOWN = 40
ORDERS_SHOWN, ORDERS_GROWN = 3, 2
"""Orders of each kind of force that a table shows: the largest, and more that motion changes most; files have all."""
ORDERS_OVER_SPEED = 4
"""Orders of each kind of force that are drawn over speed."""
POINTS = 201
"""Of a straight line, on which a text stands at one of them."""
ROOM = 1.15
"""Frequencies drawn above the highest mode that an order meets."""


def dynamics_sections(case: str, found: Vibration, answer: ForcedVibration | None, fastest: float) -> list[Section]:
    """Return the sections of one case; of several each has the name of its case.

    Parameters
    ----------
    case : str
        Name of the case, empty for a single one.
    found : Vibration
        Its vibrations.
    answer : ForcedVibration or None
        Its response.
    fastest : float
        Largest speed of the input, turns a minute.
    """
    ending = f"_{case}" if case else ""
    sections = [_modes(case, ending, found), _campbell(case, ending, found, fastest)]
    if answer is not None:
        sections.append(_response(case, found, answer))
    sections.append(_forces(case, ending, found, answer))
    rows = texts(mass_rows(found.drive))
    table = Table(name=f"masses{ending}", caption="", columns=["", "value"], rows=rows, words=1)
    return [*sections, Section(heading=_heading(case, "Masses"), tables=[table])]


def _forces(case: str, ending: str, found: Vibration, answer: ForcedVibration | None) -> Section:
    """Spectra of single forces at rest, at the speeds of operation and at critical ones, and over speed."""
    notes = [
        f"Over {found.turns} turns of the crank, orders by turn of the crank against the pin shaft: of each kind the part with "
        "the largest amplitude of an order. Rest: what the orders leave of this part, root mean square; where it is large, more "
        "--turns tell more orders apart. dynamics.nc has every part and order."
    ]
    tables = [_force_table(f"force_orders{ending}", "Orders at rest", found.forces, None)]
    curves = []
    if answer is not None:
        notes.append(
            "In motion: the force at rest and what the response adds to it, while contacts stay closed. Curves are those of the "
            "largest part."
        )
        told = [place for place, why in enumerate(answer.reasons) if why and place]
        # Speeds of operation first.
        for place in sorted(told, key=lambda each: answer.reasons[each] != OPERATION):
            title = f"orders at {answer.told_speed[place]:.0f} rpm, {minus(answer.reasons[place])}"
            there = tuple(one.at(place) for one in answer.forces)
            resting = tuple(one.at(0) for one in answer.forces)
            tables.append(
                _force_table(f"force_orders_{answer.told_speed[place]:.0f}_rpm{ending}", title, there, resting)
            )
        curves = [
            Curves(
                title=f"Orders that motion changes most: {one.kind}",
                unit="N",
                axis="speed of the input, rpm",
                x=answer.told_speed,
                lines={f"order {one.orders[order]:.5g}": _largest(one.amplitude[order]) for order in _changed(one)},
            )
            for one in answer.forces
        ]
    return Section(heading=_heading(case, "Orders of single forces"), notes=notes, curves=curves, tables=folded(tables))


def _largest(amplitude: ComplexArray) -> FloatArray:
    """Largest amplitude of all parts, shape (speeds,)."""
    return np.asarray(np.abs(amplitude).reshape(len(amplitude), -1).max(axis=1))


def _changed(one: ForceSpectrum) -> list[int]:
    """Places of the orders that motion changes most, ascending."""
    grown = np.abs(one.amplitude - one.amplitude[:, :1]).reshape(len(one.orders), -1).max(axis=1)
    return sorted(np.argsort(-grown, kind="stable")[:ORDERS_OVER_SPEED].tolist())


def _force_table(
    name: str, caption: str, spectra: tuple[ForceSpectrum, ...], resting: tuple[ForceSpectrum, ...] | None
) -> Table:
    """The largest orders of each kind, and those that motion makes largest."""
    rows = []
    for number_of_kind, one in enumerate(spectra):
        sizes, places = one.largest()
        shown = np.argsort(-sizes, kind="stable")[:ORDERS_SHOWN].tolist()
        if resting is not None:
            grown = np.abs(one.amplitude - resting[number_of_kind].amplitude).reshape(len(sizes), -1).max(axis=1)
            shown += [each for each in np.argsort(-grown, kind="stable").tolist() if each not in shown][:ORDERS_GROWN]
        for order in shown:
            part = places[order]
            row = [
                word(one.name(part)),
                number(float(one.orders[order]), "{:.5g}"),
                number(float(sizes[order]), "{:.4g}"),
            ]
            if resting is not None:
                still = resting[number_of_kind].amplitude[(order, *part)]
                row.append(number(float(np.abs(still)), "{:.4g}"))
            rows.append([*row, number(float(one.mean[part]), "{:.5g}"), number(float(one.rest[part]), "{:.4g}")])
    still_column = [] if resting is None else ["at rest, N"]
    columns = ["part", "order", "amplitude, N", *still_column, "mean, N", "rest, N"]
    return Table(name=name, caption=caption, columns=columns, rows=rows)


def _heading(case: str, words: str) -> str:
    return f"{words}, {case}" if case else words


def _modes(case: str, ending: str, found: Vibration) -> Section:
    rows = [
        [
            word(str(mode + 1)),
            word(words),
            *(number(float(pick(found.at_load[:, mode])), "{:.5g}") for pick in (np.min, np.mean, np.max)),
        ]
        for mode, words in enumerate(found.words)
    ]
    columns = ["mode", "what moves", "least, Hz", "mean, Hz", "largest, Hz"]
    by_torque = Curves(
        title="Eigenfrequencies over torque, mean of a turn", unit="Hz", axis="torque at the output, N·m",
        x=found.torque / 1e3,
        lines={f"mode {mode + 1}": found.frequency[:, :, mode].mean(axis=1) for mode in range(len(found.words))},
    )  # fmt: skip
    ends = found.ends_words
    notes = [
        f"At the load, over {found.crank_angle.size} crank angles of a turn; shapes, with parts of the kinetic energy, "
        f"at crank angle 0. Without friction; {ends}. The turning of the whole drive is no vibration and left out."
    ]
    table = Table(name=f"modes{ending}", caption="", columns=columns, rows=rows, words=1)
    return Section(heading=_heading(case, "Modes"), notes=notes, curves=[by_torque], tables=[table])


def _campbell(case: str, ending: str, found: Vibration, fastest: float) -> Section:
    x = np.linspace(0.0, fastest, POINTS)
    reach = float(max(found.input_orders[place] for place in found.told_orders)) * fastest / 60.0
    met = [mode for mode in range(len(found.words)) if mode == 0 or found.at_load[:, mode].min() <= reach]
    lines = {f"mode {mode + 1}": np.full(x.size, found.at_load[:, mode].mean()) for mode in met}
    highest, beside = ROOM * float(found.at_load[:, met].max()), dict[str, str]()
    for place in found.told_orders:
        order = float(found.input_orders[place])
        name = f"order {order:.5g}, {minus(found.spectrum.names[place])}"
        lines[name], beside[name] = order * x / 60.0, f"{order:.4g}"
    plot = Curves(
        title="Campbell diagram: modes, and dashed the orders by turn of the input", unit="Hz",
        axis="speed of the input, rpm", x=x, lines=lines, beside=beside, span=(0.0, fastest, 0.0, highest),
    )  # fmt: skip
    speeds = found.critical_speeds(fastest)
    rows = [
        [
            number(one.speed, "{:.0f}"),
            word(minus(one.order.name)),
            number(one.order.value, "{:.6g}"),
            number(one.mode + 1, "{:.0f}"),
            number(one.amplitude * ARCSEC, "{:.4f}", "arcsec"),
            number(one.slowest, "{:.0f}"),
            number(one.fastest, "{:.0f}"),
            word("yes" if one.in_duty else ""),
        ]
        for one in speeds[:SPEEDS_SHOWN]
    ]
    columns = ["mean, rpm", "origin", "order", "mode", "amplitude at rest", "least, rpm", "largest, rpm", "in range"]
    table = Table(name=f"critical_speeds{ending}", caption="", columns=columns, rows=rows, words=1, last_words=1)
    notes = [
        f"Where the {len(found.told_orders)} largest orders of the transmission error meet an eigenfrequency, up to "
        f"{fastest:g} rpm of the input; {len(speeds)} in all. Orders are counted by turn of the input in "
        "the diagram, by turn of the crank against the pin shaft in the table."
    ]
    return Section(
        heading=_heading(case, "Critical speeds"), notes=notes, curves=[plot], tables=[table] if rows else []
    )


def _response(case: str, found: Vibration, answer: ForcedVibration) -> Section:
    x = answer.speed
    lines = {"root mean square": answer.amplitude * ARCSEC}
    for place in found.told_orders[:4]:
        lines[found.spectrum.names[place]] = answer.order_amplitude[:, place] * ARCSEC
    error = Curves(
        title="Transmission error in motion", unit="arc seconds", axis="speed of the input, rpm", x=x, lines=lines
    )
    factors = Curves(title="Dynamic factor", unit="", axis="speed of the input, rpm", x=x, lines=answer.factors)
    told = [f"{note[0].upper()}{note[1:]}." for note in response_notes(answer, found)]
    notes = ["Largest load of a contact in motion by the largest at rest, contacts closed.", *told]
    return Section(heading=_heading(case, "Response over speed"), notes=notes, curves=[error, factors])
