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
from ltca.figures.curve_panels import mark_a_turn, set_axis
from ltca.figures.house_style import (
    COLOURS,
    CRANK,
    CRANK_ANGLE,
    DASHED,
    MARK,
    STYLE,
    formula,
    save_figure,
    shortened_label,
)
from ltca.figures.shared_axes import LEAST_AMPLITUDE, Axis, Plane, order_axes, pressure_axis, torque_axes

ORDERS_NAMED = 10
"""Orders listed by name in the figure, the largest."""
NUMBER_SIZE = 0.055, 0.04
"""Width and height of a number at a line, as parts of the axes: where two would overlap the larger amplitude has it."""


STIFFNESS_FROM = 0.5
"""Part of the rated torque from which on the stiffness is read."""


def _save(figure: Figure, path: Path) -> Path:
    return save_figure(figure, path)


def draw_torque_curve(curve: TorqueCurve, title: str, path: Path, plane: Plane | None = None) -> Path:
    """Draw wind-up over torque at all crank angles, the stiffness marked and the play magnified; return the file.

    `plane` are axes that several curves share; by default those of this one.
    """
    plane = torque_axes([curve]) if plane is None else plane
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
            axis.axvline(0.0, color=MARK, linewidth=0.6)
            axis.set_xlabel("torque at the output [N·m]")
        axes.set_xlim(plane.x.low, plane.x.high)
        axes.set_xticks(plane.x.ticks)
        set_axis(axes, plane.y)
        _mark_stiffness(axes, curve)
        axes.set_ylabel("angle of the output [′]")
        axes.legend(frameon=False, fontsize=7.5, loc="upper left", borderaxespad=0.2)
        seen = np.abs(torque) <= 2.0 * part if curve.loop is None else np.abs(curve.loop.torque / 1e3) <= 2.0 * part
        shown = [curve.output_angle] if curve.loop is None else [curve.loop.rising, curve.loop.falling]
        if seen.sum() > 1:
            within = np.concatenate([one[:, seen].ravel() for one in shown]) * ARCMIN
            room = 0.12 * max(float(np.ptp(within)), 1e-9)
            close.set_ylim(within.min() - room, within.max() + room)
        close.set_xlim(-2.0 * part, 2.0 * part)
        close.xaxis.set_major_locator(mpl.ticker.MaxNLocator(4))
        for side in (-part, part):
            close.axvline(side, color=COLOURS[2], linewidth=0.8, linestyle=DASHED)
        lost = np.array([curve.lost_motion.min(), curve.lost_motion.max()]) * ARCMIN
        close.set_title(
            f"play: lost motion {_from_to(*lost)}′\nbetween ±{100.0 * curve.lost_motion_part:g} % of the rated torque (dashed)",
            fontsize=8.0,
        )
        axes.set_title(shortened_label(title, 48))
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
    axes.fill_between(torque, low, high, color=colour, alpha=0.25, linewidth=0.0)
    axes.plot(torque, mean, color=colour, label=label)


def _mark_stiffness(axes: Any, curve: TorqueCurve) -> None:
    """Draw the chord whose slope is the stiffness, with its value."""
    rated = float(np.max(curve.torque)) / 1e3
    given = curve.output_angle.mean(axis=0) * ARCMIN
    ends = np.array([STIFFNESS_FROM, 1.0]) * rated
    first, last = np.interp(ends, curve.torque / 1e3, given)
    axes.plot(ends, [first, last], color=COLOURS[2], linewidth=4.0, alpha=0.6, solid_capstyle="butt", zorder=2.6)
    for at, angle in zip(ends, (first, last), strict=True):
        axes.plot([at, at], [axes.get_ylim()[0], angle], color=MARK, linewidth=0.5)
    low, high = (float(pick(curve.stiffness)) / ARCMIN / 1e3 for pick in (np.min, np.max))
    told = f"cycloid stage, 50 … 100 %\n{_from_to(low, high)} N·m/′"
    # Below the chord, on the side to which the curve leaves room.
    axes.annotate(
        told, xy=(ends.mean(), 0.5 * (first + last)), xycoords="data", xytext=(0.98, 0.30), textcoords="axes fraction",
        fontsize=8.0, color=COLOURS[2], ha="right", va="top",
        arrowprops={"arrowstyle": "-", "color": COLOURS[2], "linewidth": 0.6, "shrinkB": 2.0},
    )  # fmt: skip


def draw_spectrum(spectrum: Spectrum, title: str, path: Path, plane: Plane | None = None) -> Path:
    """Draw the amplitudes of the orders, the largest by name, on axes that several share or its own; return the file."""
    plane = order_axes([spectrum]) if plane is None else plane
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 4.4))
        axes = figure.subplots()
        values = np.array([order.value for order in spectrum.orders])
        heights = spectrum.amplitude * ARCSEC
        axes.vlines(values, 0.0, heights, color=COLOURS[1], linewidth=1.6)
        largest = np.argsort(-heights)[:ORDERS_NAMED]
        seen = heights >= LEAST_AMPLITUDE * heights.max()
        ends = plane.x.high, plane.y.high
        free = _without_overlap(values / ends[0], heights / ends[1])
        for row, number in enumerate(largest):
            order = spectrum.orders[number]
            if seen[number] and free[number]:
                place = float(values[number]), float(heights[number])
                axes.text(*place, f"{order.value:.4g}", fontsize=7.0, ha="center", va="bottom")
            axes.text(
                0.42, 0.96 - 0.055 * row, f"{order.value:>8.4f}  {heights[number]:.3f}″  {shortened_label(order.name, 40)}",
                transform=axes.transAxes, fontsize=7.5, family="monospace",
            )  # fmt: skip
        axes.set_xlim(plane.x.low, plane.x.high)
        axes.set_xticks(plane.x.ticks)
        set_axis(axes, plane.y)
        axes.set_xlabel("order per turn of the crank")
        axes.set_ylabel("amplitude [″]")
        axes.set_title(f"{shortened_label(title, 48)}; unexplained {spectrum.residual * ARCSEC:.2g}″ rms")
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
    crank_angle: FloatArray,
    pressure: FloatArray,
    safety: PressureSafety,
    title: str,
    path: Path,
    discs: int = 1,
    axis: Axis | None = None,
) -> Path:
    """Draw the largest flank pressure over its turn of the crank with the limit, on an axis that several share or its own."""
    disc, number = divmod(safety.pin, pressure.shape[1] // discs)
    pin = f"pin {number}" if discs == 1 else f"disc {disc}, pin {number}"
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.2, 3.6))
        axes = figure.subplots()
        start, degrees = float(np.degrees(crank_angle[0])), np.degrees(crank_angle - crank_angle[0])
        for column in range(pressure.shape[1]):
            axes.plot(degrees, pressure[:, column], color="#b8cfe0", linewidth=0.7)
        axes.plot(degrees, pressure.max(axis=1), color=COLOURS[1])
        bounded = np.isfinite(safety.limit)
        if bounded:
            axes.axhline(safety.limit, color=COLOURS[2], linewidth=1.0, linestyle=DASHED)
        axes.plot(degrees[safety.position], safety.largest, "o", color=COLOURS[0], markersize=4.0)
        axes.set_xlim(0.0, degrees[-1])
        mark_a_turn(axes, degrees)
        set_axis(axes, pressure_axis([safety]) if axis is None else axis)
        formula(axes.set_xlabel(CRANK if start == 0.0 else f"crank angle {CRANK_ANGLE} − {start:g}° [°]"))
        axes.set_ylabel("flank pressure at mid-width [MPa]")
        told = (
            f"safety {safety.safety:.3f} against {safety.limit:g} MPa"
            if bounded
            else f"{safety.largest:.0f} MPa, no limit"
        )
        axes.set_title(f"{shortened_label(title, 40)}: {told} ({pin})")
        return _save(figure, path)
