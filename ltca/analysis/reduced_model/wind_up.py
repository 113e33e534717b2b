"""Wind-up of the output over torque and crank angle, as a table of mean and orders.

At each of some torques either way the drive is balanced without friction at crank angles over all turns, and the deviation of
the output is fitted by a mean and the orders that a drive can have (`ltca.analysis.transmission_error_orders`). The means are the
torque–wind-up curve with the play between its least torques; the orders are the transmission error at that torque.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ltca.analysis.memory_need import positions_together
from ltca.analysis.transmission_error_orders import Order, Spectrum, fit_several, fitted_orders, named_orders
from ltca.arrays import FloatArray
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.equilibrium.output_angle import wheel_angle_of_input
from ltca.equilibrium.output_torque import solve_at_output
from ltca.equilibrium.reducer import Reducer

TORQUE_PARTS = (1e-4, 0.003, 0.01, 0.03, 0.06, 0.1, 0.17, 0.25, 0.37, 0.5, 0.62, 0.75, 0.87, 1.0)
"""Torques of the table by the largest one, either way; at the first bodies yield 1e-4 of what they do at the last."""
HARMONICS = 3
"""Multiples of each origin of an order; what higher ones do is told with the residual."""
POSITIONS_PER_UNKNOWN = 4
"""Positions for each cosine, sine and mean that is fitted."""
GOLDEN = 0.5 * (5.0**0.5 - 1.0)
"""Step by which positions go on, modulo one, over all turns: no order looks like another at them."""
LEAST_AMPLITUDE = 5e-4 / ARCMIN
"""Amplitude, rad, up to which an order is left out: 0.0005′ at every torque."""
DEVIATIONS = 3.0
"""Standard errors of an amplitude, by the residual of its fit, up to which an order is left out at every torque: at other
positions the fit is better without it.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class WindUp:
    """Deviation of the output from its ideal angle, by the torque on it and the crank angle.

    Attributes
    ----------
    torque : array, shape (nodes,)
        On the output, as it turns it ccw positive, ascending, N·mm.
    mean : array, shape (nodes,)
        Over the crank angle, rad.
    orders : tuple of Order
        Those that are kept, by turn of the crank against the pin shaft; without a name where they are below the residual at
        every torque.
    cosine, sine : array, shape (orders, nodes)
        Amplitudes, rad.
    residual : array, shape (nodes,)
        Root mean square of what no order explains, and of the orders left out, rad.
    turns, positions : int
        Crank turns behind the orders, and positions in all of them.
    """

    torque: FloatArray
    mean: FloatArray
    orders: tuple[Order, ...]
    cosine: FloatArray
    sine: FloatArray
    residual: FloatArray
    turns: int
    positions: int

    @property
    def stops(self) -> tuple[float, float]:
        """Mean deviation at the least torque either way, rad: the play lies between."""
        middle = self.torque.size // 2
        return float(self.mean[middle - 1]), float(self.mean[middle])

    @property
    def unidentified(self) -> FloatArray:
        """Root mean square of all orders without a name together, shape (nodes,), rad."""
        unnamed = np.array([not order.name for order in self.orders], dtype=bool)
        return np.asarray(np.sqrt(0.5 * np.sum(self.cosine[unnamed] ** 2 + self.sine[unnamed] ** 2, axis=0)))

    @property
    def play(self) -> float:
        """Mean over the crank angle, rad."""
        low, high = self.stops
        return max(high - low, 0.0)

    @property
    def stiffness(self) -> float:
        """Of a spring behind the play that gives the mean wind-up at the largest torque, mean of both ways, N·mm/rad."""
        low, high = self.stops
        return float(0.5 * (self.torque[0] / (self.mean[0] - low) + self.torque[-1] / (self.mean[-1] - high)))


def wind_up(drive: Drive, model: Reducer, largest: float, advance: Callable[[int], None] = lambda _: None) -> WindUp:
    """Return the wind-up up to a torque either way.

    Parameters
    ----------
    drive : Drive
        At its temperatures.
    model : Reducer
        Without friction.
    largest : float
        Largest torque, N·mm.
    advance : callable
        Told of solved positions.
    """
    orders = wind_up_orders(drive)
    angle = scattered_angles(drive, len(orders))
    opposing = drive.load_sign
    torque, spectra = [], list[Spectrum]()
    for way in (1.0, -1.0):
        errors = np.empty((len(TORQUE_PARTS), angle.size))
        for rows in np.array_split(np.arange(angle.size), -(-angle.size // positions_together(drive))):
            start, moment = None, None
            for place in range(len(TORQUE_PARTS) - 1, -1, -1):
                load = way * largest * TORQUE_PARTS[place]
                found = solve_at_output(model, [drive], angle[rows], load, start, wheel_moment=moment)
                start = found.pose
                moment = found.wheel_moment * (TORQUE_PARTS[place - 1] / TORQUE_PARTS[place])
                errors[place, rows] = drive.output_deviation(wheel_angle_of_input(model, found), load)
                advance(rows.size)
        torque += [opposing * way * largest * part for part in TORQUE_PARTS]
        spectra += fit_several(angle, errors, orders)
    along = np.argsort(torque)
    amplitude = np.array([spectra[place].amplitude for place in along]).T
    phase = np.array([spectra[place].phase for place in along]).T
    residual = np.array([spectra[place].residual for place in along])
    noise = DEVIATIONS * residual * np.sqrt(2.0 / angle.size)
    kept = (np.max(amplitude, axis=1) > LEAST_AMPLITUDE) & np.any(amplitude > noise, axis=1)
    named = named_orders(orders, amplitude, residual)
    left = 0.5 * np.sum(amplitude[~kept] ** 2, axis=0)
    return WindUp(
        torque=np.array(torque)[along],
        mean=np.array([spectra[place].mean for place in along]),
        orders=tuple(order for order, stays in zip(named, kept, strict=True) if stays),
        cosine=(amplitude * np.cos(phase))[kept],
        sine=(amplitude * np.sin(phase))[kept],
        residual=np.sqrt(residual**2 + left),
        turns=drive.pin_wheel.number_of_pins,
        positions=angle.size,
    )


def wind_up_orders(drive: Drive) -> tuple[Order, ...]:
    """Return the orders that are fitted, named as `cyclo curves` names them."""
    return fitted_orders(drive, harmonics=HARMONICS)


def scattered_angles(drive: Drive, orders: int, by_unknown: int = POSITIONS_PER_UNKNOWN) -> FloatArray:
    """Return crank angles over as many turns as there are wheel pins, so many for each unknown of the orders, rad."""
    return scattered_by(drive, by_unknown * (2 * orders + 1))


def scattered_by(drive: Drive, count: int) -> FloatArray:
    """Return so many crank angles over as many turns as there are wheel pins, rad."""
    return np.asarray(2.0 * np.pi * drive.pin_wheel.number_of_pins * np.mod(GOLDEN * np.arange(count), 1.0))


def frictionless(model: Reducer) -> Reducer:
    """Return a model without friction."""
    return replace(model, friction=None)
