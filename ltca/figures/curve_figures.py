"""Figures of `cyclo curves`: torque against wind-up, orders of the transmission error, flank pressure and its limit."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ltca.analysis.pressure_safety import PressureSafety
from ltca.analysis.torque_curve import TorqueCurve
from ltca.analysis.transmission_error_orders import Spectrum
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.figures.house_style import COLOURS, CRANK, DASHED, MARK, STYLE, formula, save_figure, shortened_name

ORDERS_NAMED = 10
"""Orders listed by name in the figure, the largest."""
LEAST_AMPLITUDE = 0.004
"""Amplitudes below this part of the largest are thinner than a line: the axis ends behind the last one above."""
NUMBER_SIZE = 0.055, 0.04
"""Width and height of a number at a line, as parts of the axes: where two would overlap the larger amplitude has it."""


STIFFNESS_FROM = 0.5
"""Part of the rated torque from which on the stiffness is read."""


def _save(figure: Figure, path: Path) -> Path:
    return save_figure(figure, path)


def draw_torque_curve(curve: TorqueCurve, title: str, path: Path) -> Path:
    """Draw torque against wind-up over all crank angles, the stiffness marked and the play magnified; return the file."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        axes, close = figure.subplots(1, 2, width_ratios=(3, 2))
        torque = curve.torque / 1e3
        turns = [f"{np.degrees(angle):.3g}°" for angle in curve.crank_angle]
        angles = ", ".join(turns) if len(turns) < 6 else f"{len(turns)} crank angles"
        part = curve.lost_motion_part * float(np.max(torque))
        for axis in (axes, close):
            if curve.loop is None:
                _band(axis, curve.output_angle * ARCMIN, torque, COLOURS[1], f"mean and range over {angles}")
            else:
                loop = curve.loop.torque / 1e3
                _band(axis, curve.loop.rising * ARCMIN, loop, COLOURS[1], "torque rising")
                _band(axis, curve.loop.falling * ARCMIN, loop, COLOURS[5], "torque falling")
            axis.axhline(0.0, color=MARK, linewidth=0.6)
            axis.set_xlabel("angle of the output [′]")
            axis.xaxis.set_major_locator(mpl.ticker.MaxNLocator(5))
        _mark_stiffness(axes, curve)
        axes.set_ylabel("torque on the output [N m]")
        axes.legend(frameon=False, fontsize=7.5, loc="upper left", borderaxespad=0.2)
        axes.set_ylim(float(torque.min()) * 1.05, float(torque.max()) * 1.3)
        seen = np.abs(torque) <= 2.0 * part if curve.loop is None else np.abs(curve.loop.torque / 1e3) <= 2.0 * part
        shown = [curve.output_angle] if curve.loop is None else [curve.loop.rising, curve.loop.falling]
        if seen.sum() > 1:
            within = np.concatenate([one[:, seen].ravel() for one in shown]) * ARCMIN
            room = 0.12 * max(float(np.ptp(within)), 1e-9)
            close.set_xlim(within.min() - room, within.max() + room)
        close.set_ylim(-2.0 * part, 2.0 * part)
        for side in (-part, part):
            close.axhline(side, color=COLOURS[2], linewidth=0.8, linestyle=DASHED)
        lost = np.array([curve.lost_motion.min(), curve.lost_motion.max()]) * ARCMIN
        close.set_title(
            f"play: lost motion {_from_to(*lost)}′\nbetween ±{100.0 * curve.lost_motion_part:g} % of the rated torque (dashed)",
            fontsize=8.0,
        )
        axes.set_title(shortened_name(title, 48))
        if curve.loop is not None:
            axes.text(0.98, 0.02, f"mean and range\nover {angles}", transform=axes.transAxes, ha="right", fontsize=7.5)
        return _save(figure, path)


def _from_to(low: float, high: float) -> str:
    """A range in four figures, or one number where both read alike."""
    first, last = f"{low:.4g}", f"{high:.4g}"
    return first if first == last else f"{first} … {last}"


def _band(axes: Any, angle: FloatArray, torque: FloatArray, colour: str, label: str) -> None:
    """Draw mean and range of curves at several crank angles, which would otherwise hide each other."""
    low, mean, high = angle.min(axis=0), angle.mean(axis=0), angle.max(axis=0)
    axes.fill_betweenx(torque, low, high, color=colour, alpha=0.25, linewidth=0.0)
    axes.plot(mean, torque, color=colour, label=label)


def _mark_stiffness(axes: Any, curve: TorqueCurve) -> None:
    """Draw the chord whose slope is the stiffness, with its value."""
    rated = float(np.max(curve.torque)) / 1e3
    given = curve.output_angle.mean(axis=0) * ARCMIN
    ends = np.array([STIFFNESS_FROM, 1.0]) * rated
    first, last = np.interp(ends, curve.torque / 1e3, given)
    axes.plot([first, last], ends, color=COLOURS[2], linewidth=4.0, alpha=0.6, solid_capstyle="butt", zorder=2.6)
    for at in ends:
        axes.plot([axes.get_xlim()[0], first if at == ends[0] else last], [at, at], color=MARK, linewidth=0.5)
    low, high = (float(pick(curve.stiffness)) / ARCMIN / 1e3 for pick in (np.min, np.max))
    told = f"cycloid stage, 50 … 100 %\n{_from_to(low, high)} N m/′"
    # Below the chord, on the side to which the curve leaves room.
    axes.annotate(
        told, xy=(0.5 * (first + last), ends.mean()), xycoords="data", xytext=(0.98, 0.30), textcoords="axes fraction",
        fontsize=8.0, color=COLOURS[2], ha="right", va="top",
        arrowprops={"arrowstyle": "-", "color": COLOURS[2], "linewidth": 0.6, "shrinkB": 2.0},
    )  # fmt: skip


def draw_spectrum(spectrum: Spectrum, title: str, path: Path) -> Path:
    """Draw the amplitudes of the orders, the largest by name; return the file."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        axes = figure.subplots()
        values = np.array([order.value for order in spectrum.orders])
        heights = spectrum.amplitude * ARCSEC
        axes.vlines(values, 0.0, heights, color=COLOURS[1], linewidth=1.6)
        largest = np.argsort(-heights)[:ORDERS_NAMED]
        seen = heights >= LEAST_AMPLITUDE * heights.max()
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
        axes.set_title(f"{shortened_name(title, 48)}; unexplained {spectrum.residual * ARCSEC:.2g}″ rms")
        return _save(figure, path)


def _without_overlap(x: FloatArray, y: FloatArray) -> NDArray[np.bool_]:
    """Which lines at places x of the axes can have a number at their end y: no larger one's, and no larger line behind it."""
    free = np.zeros(x.size, dtype=bool)
    for number in np.argsort(-y, kind="stable"):
        apart = np.abs(x - x[number])
        numbers = free & (apart < NUMBER_SIZE[0]) & (np.abs(y - y[number]) < NUMBER_SIZE[1])
        lines = (apart < 0.5 * NUMBER_SIZE[0]) & (y > y[number])
        free[number] = not np.any(numbers | lines)
    return free


def draw_pressure(
    crank_angle: FloatArray, pressure: FloatArray, safety: PressureSafety, title: str, path: Path, discs: int = 1
) -> Path:
    """Draw the largest flank pressure over the crank angle with the limit; return the file."""
    disc, number = divmod(safety.pin, pressure.shape[1] // discs)
    pin = f"pin {number}" if discs == 1 else f"disc {disc}, pin {number}"
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.6))
        axes = figure.subplots()
        degrees = np.degrees(crank_angle)
        for column in range(pressure.shape[1]):
            axes.plot(degrees, pressure[:, column], color="#b8cfe0", linewidth=0.7)
        axes.plot(degrees, pressure.max(axis=1), color=COLOURS[1])
        bounded = np.isfinite(safety.limit)
        if bounded:
            axes.axhline(safety.limit, color=COLOURS[2], linewidth=1.0, linestyle=DASHED)
        axes.plot(degrees[safety.position], safety.largest, "o", color=COLOURS[0], markersize=4.0)
        axes.set_xlim(degrees[0], degrees[-1])
        if 300.0 < degrees[-1] - degrees[0] < 360.0:
            axes.set_xlim(degrees[0], degrees[0] + 360.0)
            axes.set_xticks(degrees[0] + np.arange(0.0, 361.0, 60.0))
        axes.set_ylim(0.0, 1.12 * (max(safety.limit, safety.largest) if bounded else safety.largest))
        formula(axes.set_xlabel(CRANK))
        axes.set_ylabel("flank pressure at mid-width [MPa]")
        told = (
            f"safety {safety.safety:.3f} against {safety.limit:g} MPa"
            if bounded
            else f"{safety.largest:.0f} MPa, no limit"
        )
        axes.set_title(f"{shortened_name(title, 40)}: {told} ({pin})")
        return _save(figure, path)
