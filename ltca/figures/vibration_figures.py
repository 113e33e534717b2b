"""Figures of `cyclo dynamics`: Campbell diagram, and response over speed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from ltca.analysis.forced_vibration import ForcedVibration
from ltca.analysis.vibration import Vibration, speed_range
from ltca.drive.units.quantities import ARCSEC
from ltca.figures.house_style import COLOURS, DASHED, MARK, OTHERS, STYLE, save_figure, shortened_label

ROOM = 1.15
"""Frequencies drawn above the highest mode that an order meets, or that order at the largest speed."""
FIRST_NAME, NAME_STEP = 0.95, -0.07
"""Where the lines of orders are named, as parts of their length: one after the other, since some lie on each other."""
SPEED = "speed of the input [rpm]"


def draw_campbell(found: Vibration, fastest: float, title: str, path: Path) -> Path:
    """Draw eigenfrequencies over a turn as bands, and the largest orders as lines, over the speed of the input; return the file.

    Parameters
    ----------
    found : Vibration
        The vibrations.
    fastest : float
        Largest speed of the input, turns a minute.
    title : str
        Of the drive.
    path : Path
        Of the file.
    """
    orders = found.told_orders
    reach = float(max(found.input_orders[place] for place in orders)) * fastest / 60.0
    met = [float(mode.max()) for mode in found.at_load.T if mode.min() <= reach]
    highest = ROOM * max([*met, float(found.at_load[:, 0].max())])
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.6))
        axes = figure.subplots()
        low, high = speed_range(found.drive)
        if found.drive.duty and high > low:
            axes.axvspan(low, min(high, fastest), color=OTHERS, alpha=0.35, linewidth=0.0)
            axes.text(low, highest, " speeds of the duty", fontsize=7.0, va="top", color=MARK)
        for mode, band in enumerate(found.at_load.T):
            if band.min() > highest:
                continue
            colour = COLOURS[1 + mode % (len(COLOURS) - 1)]
            axes.fill_between([0.0, fastest], band.min(), band.max(), color=colour, alpha=0.3, linewidth=0.0)
            axes.axhline(float(band.mean()), color=colour, linewidth=1.0)
            axes.text(fastest, float(band.mean()), f" {mode + 1}", fontsize=8.0, va="center", color=colour)
        for number, place in enumerate(orders):
            order = float(found.input_orders[place])
            end = min(fastest, 60.0 * highest / order)
            axes.plot([0.0, end], [0.0, order * end / 60.0], color=MARK, linewidth=0.8, linestyle=DASHED)
            at = FIRST_NAME + NAME_STEP * number
            axes.text(
                at * end, at * order * end / 60.0, f"{order:.4g}", fontsize=7.0, ha="center", va="center", color=MARK,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6},
            )  # fmt: skip
        axes.set_xlim(0.0, fastest)
        axes.set_ylim(0.0, highest)
        axes.set_xlabel(SPEED)
        axes.set_ylabel("frequency [Hz]")
        axes.set_title(
            f"{shortened_label(title, 40)}: eigenfrequencies over a turn, orders by turn of the input", fontsize=9.0
        )
        return save_figure(figure, path)


def draw_response(answer: ForcedVibration, found: Vibration, title: str, path: Path) -> Path:
    """Draw the transmission error in motion with its largest orders, and dynamic factors, over speed; return the file.

    Parameters
    ----------
    answer : ForcedVibration
        The response.
    found : Vibration
        Whose it is.
    title : str
        Of the drive.
    path : Path
        Of the file.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 5.4))
        above, below = figure.subplots(2, 1, sharex=True)
        above.plot(answer.speed, answer.amplitude * ARCSEC, color=COLOURS[0], label="root mean square")
        for number, place in enumerate(found.told_orders[:4]):
            size = answer.order_amplitude[:, place] * ARCSEC
            above.plot(
                answer.speed,
                size,
                color=COLOURS[1 + number],
                linewidth=0.9,
                label=shortened_label(found.spectrum.names[place], 40),
            )
        above.set_yscale("log")
        above.yaxis.set_major_formatter("{x:g}")
        above.set_ylabel("transmission error [″]")
        for number, (kind, factor) in enumerate(answer.factors.items()):
            below.plot(answer.speed, factor, color=COLOURS[1 + number], label=kind)
        below.set_ylabel("dynamic factor")
        below.set_xlabel(SPEED)
        for axes in (above, below):
            _end(axes, answer)
            axes.legend(frameon=False, fontsize=7.0, loc="upper left", ncols=2)
        above.set_title(shortened_label(title, 60))
        figure.align_ylabels()
        return save_figure(figure, path)


def _end(axes: Any, answer: ForcedVibration) -> None:
    """Mark where the linear response ends."""
    axes.set_xlim(0.0, float(np.max(answer.speed)))
    if answer.parts_from is not None:
        axes.axvline(answer.parts_from, color=MARK, linewidth=0.8, linestyle=DASHED)
