"""Page of ``cyclo dynamics --time``: transmission error, loads and torques over time, spectrum, balance of energy."""

from __future__ import annotations

import numpy as np

from ltca.analysis.time_dataset import loads_by_kind
from ltca.analysis.time_run import TimeRun
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCSEC
from ltca.page.study_page import Curves, Section
from ltca.page.tables import Table, number, word

POINTS = 1500
"""Points of a line over time; of more samples each has the largest and the least of its share."""
ORDERS = 200
"""Largest order drawn, by turn of the crank."""


def time_sections(case: str, found: TimeRun) -> list[Section]:
    """Return the sections of one case; of several each has the name of its case.

    Parameters
    ----------
    case : str
        Name of the case, empty for a single one.
    found : TimeRun
        The run.
    """
    heading, ending = f", {case}" if case else "", f"_{case}" if case else ""
    taken, error = found.samples, found.transmission_error * ARCSEC
    rows = _kept(error)
    axis, x = "time, s", taken.time[rows]
    drawn = [
        Curves(title="Transmission error", unit="arc seconds", axis=axis, x=x, lines={"": error[rows]}),
        Curves(
            title="Torque at the input and at the output, external, counter-clockwise positive",
            unit="N·m",
            axis=axis,
            x=x,
            lines={"input": taken.input_torque[rows] / 1e3, "output": taken.output_torque[rows] / 1e3},
        ),
        Curves(
            title="Largest load of each kind",
            unit="N",
            axis=axis,
            x=x,
            lines={
                kind: values.reshape(values.shape[0], -1).max(axis=1)[rows]
                for kind, values in loads_by_kind(found).items()
                if values.size
            },
        ),
    ]
    sections = [Section(heading=f"In time{heading}", notes=_notes(found), curves=drawn)]
    orders, amplitude = found.spectrum()
    if orders.size:
        shown = orders <= ORDERS
        plot = Curves(
            title="Orders of the transmission error by turn of the crank, whole turns at the end of the run",
            unit="arc seconds", axis="order", x=orders[shown], lines={"": amplitude[shown] * ARCSEC},
        )  # fmt: skip
        sections.append(Section(heading=f"Spectrum{heading}", curves=[plot]))
    return [*sections, _energy(heading, ending, found)]


def _notes(found: TimeRun) -> list[str]:
    course = found.course
    damping = found.drive.damping
    ratio = "no damping" if damping is None else f"damping ratio {damping.ratio_at_resonance:g}"
    rubs = "with friction" if found.drive.friction is not None else "without friction"
    return [
        f"{course.motion}: {course.time:g} s up to {course.speed:g} rpm of the input, driven by "
        f"{course.driven_by}; {ratio}, {rubs}. "
        f"A disc has no pin in contact in {found.lost_contact:.2%} of the time."
    ]


def _energy(heading: str, ending: str, found: TimeRun) -> Section:
    energy = found.energy
    told = (
        ("work at the input", energy.input),
        ("work of the output on its load", energy.output),
        ("lost in damping", energy.damping),
        ("lost in friction", energy.friction),
        ("change of kinetic energy", energy.kinetic),
        ("change of stored energy", energy.stored),
        ("work of changing radii of curvature", energy.curvature),
        ("work of contacts that move over the bodies", energy.stations),
        ("work of teeth that planets carry unevenly", energy.teeth),
        ("left", energy.left),
    )
    rows = [[word(words), number(value / 1e3, "{:.6g}", "J")] for words, value in told if np.isfinite(value)]
    if np.isfinite(energy.relative):
        rows.append([word("left by the throughput"), number(energy.relative, "{:.1e}")])
    table = Table(name=f"energy{ending}", caption="", columns=["", "value"], rows=rows, words=1)
    return Section(heading=f"Balance of energy{heading}", tables=[table])


def _kept(values: FloatArray) -> np.ndarray:
    """Rows of the largest and the least value in each of even shares, ascending; all where there are few."""
    if values.size <= POINTS:
        return np.arange(values.size)
    shares = np.array_split(np.arange(values.size), POINTS // 2)
    ends = [(share[np.argmin(values[share])], share[np.argmax(values[share])]) for share in shares]
    return np.unique([0, *np.ravel(ends), values.size - 1])
