"""Figure of `cyclo dynamics --time`: transmission error, torque at the input and largest loads over time, and orders."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from ltca.analysis.time_dataset import loads_by_kind
from ltca.analysis.time_run import TimeRun
from ltca.drive.units.quantities import ARCSEC
from ltca.figures.house_style import COLOURS, STYLE, save_figure

LARGEST_ORDER = 200


def draw_time_run(found: TimeRun, title: str, path: Path) -> Path:
    """Draw a run over time in panels under each other; return the file.

    Parameters
    ----------
    found : TimeRun
        The run.
    title : str
        Of the drive.
    path : Path
        Of the file.
    """
    taken, (orders, amplitude) = found.samples, found.spectrum()
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 8.4 if orders.size else 6.6), layout="constrained")
        panels = figure.subplots(4 if orders.size else 3, 1)
        for panel in panels[1:3]:
            panel.sharex(panels[0])
        panels[0].plot(taken.time, found.transmission_error * ARCSEC, color=COLOURS[1], linewidth=0.6)
        panels[0].set_ylabel("transmission error [″]")
        panels[1].plot(taken.time, taken.input_torque / 1e3, color=COLOURS[2], linewidth=0.6)
        panels[1].set_ylabel("input torque [N·m]")
        for number, (kind, values) in enumerate(loads_by_kind(found).items()):
            if values.size:
                largest = values.reshape(values.shape[0], -1).max(axis=1)
                panels[2].plot(taken.time, largest, color=COLOURS[1 + number], linewidth=0.6, label=kind)
        panels[2].set_ylabel("largest load [N]")
        panels[2].set_xlabel("time [s]")
        panels[2].legend(ncols=4, fontsize=7.0, loc="upper right")
        if orders.size:
            shown = orders <= LARGEST_ORDER
            panels[3].plot(orders[shown], amplitude[shown] * ARCSEC, color=COLOURS[1], linewidth=0.8)
            panels[3].set_yscale("log")
            panels[3].set_xlabel("order by turn of the crank")
            panels[3].set_ylabel("amplitude [″]")
        panels[0].set_title(title)
        return save_figure(figure, path)
