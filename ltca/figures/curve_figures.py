"""Figures of `cyclo curves`: torque against wind-up, orders of the transmission error, flank pressure and its limit."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ltca.analysis.pressure_safety import PressureSafety
from ltca.analysis.torque_curve import TorqueCurve
from ltca.analysis.transmission_error_orders import Spectrum
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.figures.labelled_curves import COLOURS, STYLE
from ltca.output.files import whole_file

FloatArray = NDArray[np.float64]

NAMED = 10
"""Orders listed by name in the figure, the largest."""
SEEN = 0.004
"""Amplitudes below this part of the largest are thinner than a line: the axis ends behind the last one above."""
APART = 0.055, 0.04
"""Width and height of a number at a line, as parts of the axes: where two would overlap the larger amplitude has it."""


def _save(figure: Figure, stem: Path) -> Path:
    for suffix in (".svg", ".png"):
        path = stem.with_suffix(suffix)
        with whole_file(path) as part:
            figure.savefig(part, dpi=130, metadata={"Date": None} if suffix == ".svg" else None)
    return path


def draw_torque_curve(curve: TorqueCurve, title: str, stem: Path) -> Path:
    """Draw torque against wind-up at every crank angle, the play magnified; return the PNG."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        axes, close = figure.subplots(1, 2, width_ratios=(3, 2))
        torque = curve.torque / 1e3
        for number, angle in enumerate(curve.crank_angle):
            colour = COLOURS[number % len(COLOURS)]
            for axis in (axes, close):
                label = f"{np.degrees(angle):.0f}°"
                if curve.loop is None:
                    axis.plot(curve.output_angle[number] * ARCMIN, torque, color=colour, label=label)
                    continue
                for branch in (curve.loop.rising, curve.loop.falling):
                    axis.plot(branch[number] * ARCMIN, curve.loop.torque / 1e3, color=colour, label=label)
                    label = "_"
        for axis in (axes, close):
            axis.axhline(0.0, color="#7a7a7a", linewidth=0.6)
            axis.set_xlabel("angle of the output [′]")
        axes.set_ylabel("torque on the output [N m]")
        axes.legend(title="crank angle", frameon=False, fontsize=8.0)
        part = curve.lost_motion_part * float(np.max(torque))
        close.set_ylim(-2.0 * part, 2.0 * part)
        for side in (-part, part):
            close.axhline(side, color=COLOURS[2], linewidth=0.8, linestyle=(0, (4, 2)))
        close.set_title(f"play; dashed ±{100.0 * curve.lost_motion_part:g} % of the rated torque", fontsize=8.5)
        axes.set_title(title)
        return _save(figure, stem)


def draw_spectrum(spectrum: Spectrum, title: str, stem: Path) -> Path:
    """Draw the amplitudes of the orders, the largest by name; return the PNG."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        axes = figure.subplots()
        values = np.array([order.value for order in spectrum.orders])
        heights = spectrum.amplitude * ARCSEC
        axes.vlines(values, 0.0, heights, color=COLOURS[1], linewidth=1.6)
        largest = np.argsort(-heights)[:NAMED]
        seen = heights >= SEEN * heights.max()
        ends = 1.05 * float(values[seen].max()), 1.12 * float(heights.max()) + 1e-9
        free = _without_overlap(values / ends[0], heights / ends[1])
        for row, number in enumerate(largest):
            order = spectrum.orders[number]
            if seen[number] and free[number]:
                place = float(values[number]), float(heights[number])
                axes.text(*place, f"{order.value:.4g}", fontsize=7.0, ha="center", va="bottom")
            axes.text(
                0.42, 0.96 - 0.055 * row, f"{order.value:>8.4f}  {heights[number]:.3f}″  {order.name}",
                transform=axes.transAxes, fontsize=7.5, family="monospace",
            )  # fmt: skip
        axes.set_xlim(0.0, ends[0])
        axes.set_ylim(0.0, ends[1])
        axes.set_xlabel("order per turn of the crank")
        axes.set_ylabel("amplitude [″]")
        axes.set_title(f"{title}; unexplained {spectrum.residual * ARCSEC:.2g}″ rms")
        return _save(figure, stem)


def _without_overlap(x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    """Which lines at places x of the axes can have a number at their end y: no larger one's, and no larger line behind it."""
    free = np.zeros(x.size, dtype=bool)
    for number in np.argsort(-y, kind="stable"):
        apart = np.abs(x - x[number])
        numbers = free & (apart < APART[0]) & (np.abs(y - y[number]) < APART[1])
        lines = (apart < 0.5 * APART[0]) & (y > y[number])
        free[number] = not np.any(numbers | lines)
    return free


def draw_pressure(
    crank_angle: FloatArray, pressure: FloatArray, safety: PressureSafety, title: str, stem: Path, discs: int = 1
) -> Path:
    """Draw the largest flank pressure over the crank angle with the limit; return the PNG."""
    disc, number = divmod(safety.pin, pressure.shape[1] // discs)
    pin = f"pin {number}" if discs == 1 else f"pin {number} on disc {disc}"
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.6))
        axes = figure.subplots()
        degrees = np.degrees(crank_angle)
        for column in range(pressure.shape[1]):
            axes.plot(degrees, pressure[:, column], color="#b8cfe0", linewidth=0.7)
        axes.plot(degrees, pressure.max(axis=1), color=COLOURS[1])
        bounded = np.isfinite(safety.limit)
        if bounded:
            axes.axhline(safety.limit, color=COLOURS[2], linewidth=1.0, linestyle=(0, (4, 2)))
        axes.plot(degrees[safety.position], safety.largest, "o", color=COLOURS[0], markersize=4.0)
        axes.set_xlim(degrees[0], degrees[-1])
        axes.set_ylim(0.0, 1.12 * (max(safety.limit, safety.largest) if bounded else safety.largest))
        axes.set_xlabel("crank angle φ_C [°]")
        axes.set_ylabel("flank pressure at mid-width [MPa]")
        told = (
            f"safety {safety.safety:.3f} against {safety.limit:g} MPa"
            if bounded
            else f"{safety.largest:.0f} MPa, no limit"
        )
        axes.set_title(f"{title}: {told} ({pin})")
        return _save(figure, stem)
