"""Page of ``cyclo dynamics``: modes, Campbell diagram, critical speeds, response over speed."""

from __future__ import annotations

import numpy as np

from ltca.analysis.forced_vibration import ForcedVibration, response_notes
from ltca.analysis.vibration import Vibration
from ltca.drive.units.quantities import ARCSEC
from ltca.dynamics.mass_values import mass_rows
from ltca.page.study_page import Curves, Section
from ltca.page.tables import Table, minus, number, texts, word

SPEEDS_SHOWN = 40
FORCE_MULTIPLES = 6
"""Multiples of the passage of a force that are shown; files have all."""
POINTS = 2
"""Of a straight line."""


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
    sections.append(_forces(case, ending, found))
    rows = texts(mass_rows(found.drive))
    table = Table(name=f"masses{ending}", caption="", columns=["", "value"], rows=rows, words=1)
    return [*sections, Section(heading=_heading(case, "Masses"), tables=[table])]


def _forces(case: str, ending: str, found: Vibration) -> Section:
    columns = [
        "force",
        "mean, N",
        "order of passage",
        *(f"{multiple} ×, N" for multiple in range(1, FORCE_MULTIPLES + 1)),
    ]
    rows = [
        [
            word(one.name),
            number(one.mean, "{:.5g}"),
            number(one.passage, "{:.6g}"),
            *(number(float(size), "{:.4g}") for size in one.amplitude[:FORCE_MULTIPLES]),
            *[word("")] * max(FORCE_MULTIPLES - one.amplitude.size, 0),
            number(one.rest, "{:.4g}"),
        ]
        for one in found.forces
    ]
    notes = [
        f"At the load and at rest, over {found.turns} turns of the crank: amplitudes of the multiples of the order, by turn of "
        "the crank against the pin shaft, in which a part meets its load again; more of them in dynamics.json."
    ]
    table = Table(name=f"force_orders{ending}", caption="", columns=[*columns, "rest, rms, N"], rows=rows)
    return Section(heading=_heading(case, "Orders of single forces"), notes=notes, tables=[table])


def _heading(case: str, words: str) -> str:
    return f"{words}, {case}" if case else words


def _modes(case: str, ending: str, found: Vibration) -> Section:
    rows = [
        [
            word(str(mode + 1)),
            *(number(float(pick(found.at_load[:, mode])), "{:.5g}") for pick in (np.min, np.mean, np.max)),
            word(words),
        ]
        for mode, words in enumerate(found.words)
    ]
    columns = ["mode", "least, Hz", "mean, Hz", "largest, Hz", "what moves, part of the kinetic energy"]
    by_torque = Curves(
        title="Eigenfrequencies over torque, mean of a turn", unit="Hz", axis="torque at the output, N·m",
        x=found.torque / 1e3,
        lines={f"mode {mode + 1}": found.frequency[:, :, mode].mean(axis=1) for mode in range(len(found.words))},
    )  # fmt: skip
    ends = found.ends_words
    notes = [
        f"At the load, over {found.crank_angle.size} crank angles of a turn; shapes at crank angle 0. Without friction; "
        f"{ends}. The turning of the whole drive is no vibration and left out."
    ]
    table = Table(name=f"modes{ending}", caption="", columns=columns, rows=rows)
    return Section(heading=_heading(case, "Modes"), notes=notes, curves=[by_torque], tables=[table])


def _campbell(case: str, ending: str, found: Vibration, fastest: float) -> Section:
    x = np.linspace(0.0, fastest, POINTS)
    reach = float(max(found.input_orders[place] for place in found.told_orders)) * fastest / 60.0
    lines = {
        f"mode {mode + 1}": np.full(x.size, found.at_load[:, mode].mean())
        for mode in range(len(found.words))
        if mode == 0 or found.at_load[:, mode].min() <= reach
    }
    for place in found.told_orders:
        order = float(found.input_orders[place])
        lines[f"order {order:.5g}, {found.spectrum.orders[place].name}"] = order * x / 60.0
    plot = Curves(title="Campbell diagram", unit="Hz", axis="speed of the input, rpm", x=x, lines=lines)
    speeds = found.critical_speeds(fastest)
    rows = [
        [
            number(one.slowest, "{:.0f}"),
            number(one.speed, "{:.0f}"),
            number(one.fastest, "{:.0f}"),
            word(str(one.mode + 1)),
            number(one.order.value, "{:.6g}"),
            word(minus(one.order.name)),
            number(one.amplitude * ARCSEC, "{:.4f}", "arcsec"),
            word("yes" if one.in_duty else ""),
        ]
        for one in speeds[:SPEEDS_SHOWN]
    ]
    columns = ["least, rpm", "mean, rpm", "largest, rpm", "mode", "order", "origin", "amplitude at rest", "in range"]
    table = Table(name=f"critical_speeds{ending}", caption="", columns=columns, rows=rows)
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
        lines[found.spectrum.orders[place].name] = answer.order_amplitude[:, place] * ARCSEC
    error = Curves(
        title="Transmission error in motion", unit="arc seconds", axis="speed of the input, rpm", x=x, lines=lines
    )
    factors = Curves(title="Dynamic factor", unit="", axis="speed of the input, rpm", x=x, lines=answer.factors)
    told = [f"{note[0].upper()}{note[1:]}." for note in response_notes(answer, found)]
    notes = ["Largest load of a contact in motion by the largest at rest, contacts closed.", *told]
    return Section(heading=_heading(case, "Response over speed"), notes=notes, curves=[error, factors])
