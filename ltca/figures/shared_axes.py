"""Axes of what figures and pages both draw: range and ticks from the values of all cases, the same in both."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import ceil, floor, log10
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN, ARCSEC

if TYPE_CHECKING:
    import xarray as xr

    from ltca.analysis.pressure_safety import PressureSafety
    from ltca.analysis.torque_curve import TorqueCurve
    from ltca.analysis.transmission_error_orders import Spectrum
    from ltca.output.labelled import Labelled, LabelledArray

STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Between ticks, times a power of ten."""
MOST_INTERVALS = 4
"""Between the ticks of an axis: labels of panels an inch high stand apart."""
MOST_OF_A_PLOT, MOST_ORDERS = 6, 8
"""Of plots with the room of a figure, and along their axis of orders."""
FLAT = 1e-9
"""Range, as a part of the largest value, below which values count as all alike."""
LEAST_SHARE = 0.02
"""About equal shares of the torque, at least: less differs by nothing."""
CONTACTS = {
    "pin/load": "pin_load",
    "pin/pressure": "pin_pressure_mid",
    "outer/load": "roller_load",
    "outer/pressure": "roller_pressure_mid_outer",
    "hole/load": "pin_shaft_load",
    "hole/pressure": "pin_shaft_pressure_mid",
}
"""Quantities of contacts, N and MPa, whose axes begin at zero."""


class Axis(NamedTuple):
    """Range of an axis, which begins and ends at a tick.

    Attributes
    ----------
    low, high : float
        Its ends.
    step : float
        Between ticks.
    """

    low: float
    high: float
    step: float

    @property
    def ticks(self) -> FloatArray:
        """Where its ticks stand, both ends among them."""
        count = round((self.high - self.low) / self.step)
        return np.asarray(self.step * (round(self.low / self.step) + np.arange(count + 1)))


def axis_of(*values: FloatArray, zero: bool = False, most: int = MOST_INTERVALS) -> Axis:
    """Return the axis that holds all finite values in `most` intervals, with zero on it where that is asked for.

    Examples
    --------
    >>> axis_of(np.array([3104.0, 3681.3]), zero=True)
    Axis(low=0.0, high=4000.0, step=1000.0)
    """
    every = np.concatenate([np.ravel(each) for each in values] or [np.zeros(0)])
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if every.size else (0.0, 1.0)
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= FLAT * max(abs(low), abs(high)):
        room = 0.1 * abs(high) or 1.0
        low, high = (low, high + room) if zero else (low - room, high + room)
    power = 10.0 ** floor(log10((high - low) / most))
    for step in (power * each for each in (*STEPS, 20.0)):
        # A hair beyond a tick is the tick.
        first, last = floor(low / step + FLAT), ceil(high / step - FLAT)
        if last - first <= most:
            break
    return Axis(first * step, last * step, step)


def deviation(error: FloatArray) -> FloatArray:
    """Return a transmission error less its mean over the positions, which stand last."""
    return np.asarray(error - np.nanmean(error, axis=-1, keepdims=True))


def contact_values(dataset: Labelled, torque: str) -> dict[str, FloatArray]:
    """Return loads and pressures of contacts by the name of their axis, as ``full/pin/load``."""
    return {f"{torque}/{key}": dataset[name].values for key, name in CONTACTS.items() if dataset[name].values.size}


def run_values(dataset: Labelled) -> dict[str, FloatArray]:
    """Return what a run is drawn from, by the name of its axis: contacts, transmission errors, ″, bearing forces, N, shares."""
    radial, tangential = dataset["bearing_radial"].values, dataset["bearing_tangential"].values
    with np.errstate(invalid="ignore"):
        values = contact_values(dataset, "full") | {
            "full/te": _deviations(dataset["transmission_error"]),
            "light/te": _deviations(dataset["transmission_error_light"]),
            "radial": radial,
            "tangential": tangential,
            "total": np.hypot(radial, tangential),
        }
    if dataset.sizes["disc"] > 1:
        whole = dataset["wheel_moment"].transpose("case", "position").values
        values["share"] = dataset["disc_torque"].transpose("case", "disc", "position").values / whole[:, None]
    if dataset.sizes["crank"] > 1:
        values["crank"] = dataset["crank_torque"].values / 1e3
    return values


def _deviations(error: LabelledArray | xr.DataArray) -> FloatArray:
    """Deviations of the cases that have an answer somewhere, arc seconds."""
    values = error.transpose("case", "position").values * ARCSEC
    return deviation(values[np.isfinite(values).any(axis=1)])


def torque_shares(dataset: xr.Dataset) -> xr.DataArray:
    """Return the part of the torque that each disc carries."""
    return dataset["disc_torque"] / dataset["wheel_moment"]


def run_axes(values: Mapping[str, FloatArray], discs: int) -> dict[str, Axis]:
    """Return the axes of values by name (`run_values`)."""
    axes = {}
    for name, each in values.items():
        if name == "share":
            equal = 1.0 / discs
            room = max(LEAST_SHARE, float(np.nanmax(np.abs(each - equal), initial=0.0)))
            axes[name] = axis_of(np.array([equal - room, equal + room]))
        else:
            axes[name] = axis_of(each, zero=name.endswith(("load", "pressure")))
    return axes


LEAST_AMPLITUDE = 0.004
"""Amplitudes below this part of the largest are thinner than a line: the axis of orders ends behind the last one above."""
BEYOND_ORDERS = 1.05
"""Of the last order seen, and of the largest amplitude, at least: room for its number."""


class Plane(NamedTuple):
    """Axes of curves.

    Attributes
    ----------
    x, y : Axis
        Along and up.
    """

    x: Axis
    y: Axis


def torque_axes(curves: Iterable[TorqueCurve]) -> Plane:
    """Return the axes of torque curves: torque, N·m, and angle of the output, arc minutes."""
    torques, angles = list[FloatArray](), list[FloatArray]()
    for curve in curves:
        torques.append(curve.torque / 1e3)
        angles += [curve.output_angle] if curve.loop is None else [curve.loop.rising, curve.loop.falling]
    return Plane(axis_of(*torques), axis_of(*(angle * ARCMIN for angle in angles), most=MOST_OF_A_PLOT))


def order_axes(spectra: Iterable[Spectrum]) -> Plane:
    """Return the axes of orders of the transmission error: order by turn of the crank, and amplitude, arc seconds."""
    values, amplitudes = list[FloatArray](), list[FloatArray]()
    for spectrum in spectra:
        seen = spectrum.amplitude >= LEAST_AMPLITUDE * spectrum.amplitude.max()
        values.append(np.array([order.value for order in spectrum.orders])[seen])
        amplitudes.append(spectrum.amplitude * ARCSEC)
    told = (values, MOST_ORDERS), (amplitudes, MOST_OF_A_PLOT)
    return Plane(*(axis_of(*(BEYOND_ORDERS * each for each in those), zero=True, most=most) for those, most in told))


def pressure_axis(found: Iterable[PressureSafety]) -> Axis:
    """Return the axis of flank pressures, MPa, with their limits."""
    return axis_of(*(np.array([each.largest, each.limit]) for each in found), zero=True, most=MOST_OF_A_PLOT)
