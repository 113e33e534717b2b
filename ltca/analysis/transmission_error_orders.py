r"""Orders of the transmission error by name, fitted together.

Orders are counted per turn of the crank. Everything in a cycloid drive comes from a few motions: the crank (1), the
loaded zone past the teeth of the flank (z_C), past the holes (z_PS), past single pins of the wheel, which turns on by
1/z_P a turn (z_C/z_P), and past the rollers of the cage (1 − c with the cage speed c; n_BR (1 − c) for equal rollers). The sun
of a first stage turns z₂/z₁ times against the carrier; its order is known where its teeth or those of the planets run out.
The true period of all of them is long (98 turns for the rollers of the paper's drive), so the known orders are fitted
by least squares in place of a Fourier transform over a period.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ltca.arrays import ComplexArray, FloatArray
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement

LEAST_SINGULAR_RATIO = 1e-3
"""Least singular value, relative to the largest, at which orders can be distinguished."""
SAME_DISTANCE = 1e-6
"""Part of the distance of orders that turns tell apart by which one may be nearer, for the rounding of angles."""
NAMED_HARMONICS = 7
"""Multiples of each origin that names are looked for among, however many are fitted: an order has one name everywhere."""
HIGHEST_ORDER = 320
"""Order of the flank up to which multiples are fitted."""
PASSED_HARMONICS = 3
"""Multiples of each origin from which orders of rollers that pass flank and holes keep clear."""
CLEAR_OF_OTHERS = 0.99
"""Periods by which these orders shift against any of those over as many turns as there are wheel pins, at least."""
SAME_ORDER = 1e-9
"""Difference up to which orders are one."""
POSITIONS_PER_CHUNK = 20_000
"""Positions whose columns are held in memory at once."""


class Order(NamedTuple):
    """An order by its origin."""

    value: float
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectrum:
    """Fitted orders.

    Attributes
    ----------
    orders : tuple of Order
        Ascending.
    amplitude : array, shape (orders,)
        rad.
    phase : array, shape (orders,)
        φ of ``amplitude · cos(order · φ_C − φ)``, rad.
    mean : float
        rad.
    residual : float
        Root mean square of what no order explains, rad.
    turns : float
        Turns of the crank that the positions cover.
    """

    orders: tuple[Order, ...]
    amplitude: FloatArray
    phase: FloatArray
    mean: float
    residual: float
    turns: float = np.inf

    def of(self, value: float) -> float:
        """Return the amplitude of the fitted order nearest to a value, rad."""
        return float(self.amplitude[int(np.argmin([abs(order.value - value) for order in self.orders]))])

    @property
    def groups(self) -> tuple[tuple[int, ...], ...]:
        """Places of orders that the turns do not tell apart, ascending; alone where they do.

        Two orders shift by less than a period against each other over N turns where they are nearer than 1/N: their sum is
        known, the share of each is not.
        """
        groups = [[0]]
        for place in range(1, len(self.orders)):
            step = self.orders[place].value - self.orders[place - 1].value
            if step * self.turns < 1.0 - SAME_DISTANCE:
                groups[-1].append(place)
            else:
                groups.append([place])
        return tuple(map(tuple, groups))

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each order; of one that is not told from others the names of all of them."""
        return tuple(" or ".join(self.orders[place].name for place in places) for places in self.groups for _ in places)

    def resolved(self) -> Spectrum:
        """Return the spectrum with one order for each of `groups`, as results show it.

        Orders that are not told apart become the largest of them, under the names of all, with √2 times the root mean square of
        their sum over the turns.
        """
        orders, waves, names = list[Order](), list[complex](), self.names
        values = np.array([order.value for order in self.orders])
        complex_amplitude = self.amplitude * np.exp(-1j * self.phase)
        for places in map(list, self.groups):
            largest = max(places, key=lambda place: self.amplitude[place])
            orders.append(Order(self.orders[largest].value, names[largest]))
            if len(places) == 1:
                waves.append(complex(complex_amplitude[largest]))
                continue
            wave = complex_amplitude[places]
            shift = np.subtract.outer(values[places], values[places]) * self.turns  # periods over all turns
            mean = np.sinc(shift) * np.exp(1j * np.pi * shift)
            size = np.sqrt(max(float(np.real(wave @ mean @ wave.conj())), 0.0))
            waves.append(complex(size * np.exp(1j * np.angle(wave @ mean[:, places.index(largest)]))))
        return Spectrum(
            orders=tuple(orders),
            amplitude=np.abs(waves),
            phase=-np.angle(waves),
            mean=self.mean,
            residual=self.residual,
            turns=self.turns,
        )


def known_orders(drive: Drive, *, harmonics: int = 4) -> tuple[Order, ...]:
    """Return the orders a drive can have, ascending; an order of several origins bears the name of the first.

    Parameters
    ----------
    drive : Drive
        The drive.
    harmonics : int
        Multiples of each origin.
    """
    names = [*_origins(drive, max(harmonics, NAMED_HARMONICS)), *_rollers_past(drive)]
    found: list[Order] = []
    for order in _origins(drive, harmonics):
        if order.value > 0.0 and all(abs(order.value - other.value) > SAME_ORDER for other in found):
            found.append(_named(order, names))
    return tuple(sorted(found))


def fitted_orders(drive: Drive, *, harmonics: int) -> tuple[Order, ...]:
    """Return the orders that are fitted over many turns: `known_orders`, and with rollers that pass flank and holes, ascending.

    Rollers bend the same contacts as the flank and the holes, so that sums and differences of their orders show as well; those
    less than an order apart from others over as many turns as there are wheel pins are left out, since positions could not
    tell them apart.

    Parameters
    ----------
    drive : Drive
        The drive.
    harmonics : int
        Multiples of each origin; no more than `most_harmonics`.
    """
    harmonics = min(harmonics, most_harmonics(drive))
    found, few = list(known_orders(drive, harmonics=harmonics)), min(harmonics, PASSED_HARMONICS)
    clear_of = [0.0, *(order.value for order in known_orders(drive, harmonics=few))]
    names = [*_origins(drive, max(harmonics, NAMED_HARMONICS)), *_rollers_past(drive)]
    beside, turns = _rollers_past(drive), drive.pin_wheel.number_of_pins
    if holes := drive.number_of_holes:
        beside = [Order(float((few + 1) * holes), f"pin holes, {few + 1} z_PS"), *beside]
    for order in beside:
        if all(abs(order.value - other) * turns > CLEAR_OF_OTHERS for other in clear_of):
            clear_of.append(order.value)
            if all(abs(order.value - other.value) > SAME_ORDER for other in found):
                found.append(_named(order, names))
    return tuple(sorted(found))


def most_harmonics(drive: Drive) -> int:
    """Return the multiples of each origin that are fitted at most: fewer, but two, where the teeth are many."""
    return max(2, HIGHEST_ORDER // drive.disc.number_of_teeth)


def _named(order: Order, names: list[Order]) -> Order:
    """An order by the first of its names."""
    return next((order._replace(name=one.name) for one in names if abs(one.value - order.value) <= SAME_ORDER), order)


def _rollers_past(drive: Drive) -> list[Order]:
    """Sums and differences of the orders of rollers with those of flank and holes."""
    passage = drive.crank_bearing.number_of_rollers * _against_cage(drive)
    beside = [(multiple * drive.disc.number_of_teeth, f"{multiple} z_C") for multiple in (1, 2)]
    if holes := drive.number_of_holes:
        beside.append((holes, "z_PS"))
    orders = list[Order]()
    for value, name in beside:
        orders.append(Order(abs(value - passage), f"rollers past {name}, difference"))
        orders.append(Order(value + passage, f"rollers past {name}, sum"))
    return orders


def _against_cage(drive: Drive) -> float:
    """Turns of the crank against the cage of its rollers by turn of the crank."""
    return 1.0 - float(Placement.of_drive(single_discs(drive)[0]).cage_speed)


def _origins(drive: Drive, harmonics: int) -> list[Order]:
    """Orders by their origins, the likelier of several before others."""
    flank, pins = drive.disc.number_of_teeth, drive.pin_wheel.number_of_pins
    holes, rollers = drive.number_of_holes, drive.crank_bearing.number_of_rollers
    cage = _against_cage(drive)
    names: list[Order] = []
    for multiple in range(1, harmonics + 1):
        names.append(Order(float(multiple * flank), f"flank, {multiple} z_C"))
        if holes:
            names.append(Order(float(multiple * holes), f"pin holes, {multiple} z_PS"))
    # Two motions that both bend the same contacts show sums and differences of their orders.
    for first in (1, 2) if holes else ():
        for second in (1, 2):
            parts = f"{first} z_C", f"{second} z_PS"
            names.append(
                Order(float(abs(first * flank - second * holes)), f"flank and holes, |{parts[0]} − {parts[1]}|")
            )
            names.append(Order(float(first * flank + second * holes), f"flank and holes, {parts[0]} + {parts[1]}"))
    names += [Order(1.0, "crank, 1")]
    for multiple in range(1, harmonics + 1):
        names += [
            Order(multiple * rollers * cage, f"roller passage, {multiple} n_BR(1 − c)"),
            Order(float(multiple), f"crank, {multiple}"),
            Order(multiple * cage, f"cage, {multiple} (1 − c)"),
            Order(multiple * flank / pins, f"wheel pins, {multiple} z_C/z_P"),
        ]
    for side in (-2, -1, 1, 2):
        names.append(Order(float(flank + side), f"flank {side:+d}, z_C {side:+d}"))
        names.append(Order(flank + side * cage, f"flank {side:+d} cage"))
        names.append(Order(flank + side * flank / pins, f"flank {side:+d} wheel pins"))
    stage = drive.first_stage
    if stage is not None and stage.runs_out:
        # The sun turns so often against the carrier; shares of the cranks, which weight it, turn with them.
        names += [Order(stage.ratio, "sun, z₂/z₁")]
        names += [Order(abs(stage.ratio + side), f"sun {side:+d} crank") for side in (-2, -1, 1, 2)]
    return names


def least_turns(orders: tuple[Order, ...], positions: int, most: int) -> int:
    """Return the crank turns whose positions tell orders apart, as `fit_orders` asks for.

    Parameters
    ----------
    orders : tuple of Order
        What is to be fitted.
    positions : int
        In each turn.
    most : int
        Turns after which to end.

    Returns
    -------
    int
        Turns; `most` where fewer do not.
    """
    values = np.array([order.value for order in orders])
    gram = np.zeros((2 * len(orders) + 1,) * 2)
    for turn in range(1, most):
        angle = 2.0 * np.pi * (turn - 1 + np.arange(positions) / positions)
        columns = _columns(angle, values)
        gram += columns.T @ columns
        sizes = np.linalg.eigvalsh(gram)
        if turn * positions >= len(gram) and sizes[0] >= LEAST_SINGULAR_RATIO**2 * sizes[-1]:
            return turn
    return most


def _columns(crank_angle: FloatArray, values: FloatArray) -> FloatArray:
    """One, cosines and sines of orders at crank angles."""
    phase = np.asarray(crank_angle)[:, None] * values
    return np.hstack([np.ones((phase.shape[0], 1)), np.cos(phase), np.sin(phase)])


def fit_orders(crank_angle: FloatArray, error: FloatArray, orders: tuple[Order, ...]) -> Spectrum:
    """Fit amplitudes and phases of orders to a transmission error.

    Parameters
    ----------
    crank_angle, error : array, shape (positions,)
        φ_C and the transmission error there, rad.
    orders : tuple of Order
        What to fit.

    Returns
    -------
    Spectrum

    Raises
    ------
    ValueError
        When the positions cannot tell the orders apart (too few, or over too few turns).
    """
    return fit_several(crank_angle, np.asarray(error)[None], orders)[0]


def fit_several(crank_angle: FloatArray, errors: FloatArray, orders: tuple[Order, ...]) -> list[Spectrum]:
    """Fit orders to several transmission errors at the same crank angles, each as `fit_orders` does.

    Parameters
    ----------
    crank_angle : array, shape (positions,)
        φ_C, rad.
    errors : array, shape (errors, positions)
        rad.
    orders : tuple of Order
        What to fit.

    Returns
    -------
    list of Spectrum

    Raises
    ------
    ValueError
        When the positions cannot tell the orders apart (too few, or over too few turns).
    """
    values = np.array([order.value for order in orders])
    angle, rows = np.asarray(crank_angle), np.asarray(errors)
    # The triangle of columns and errors side by side, block by block: its solution and its last corner are theirs.
    triangle: Any = np.zeros((0, 2 * len(orders) + 1 + len(rows)))
    for first in range(0, angle.size, POSITIONS_PER_CHUNK):
        few = slice(first, first + POSITIONS_PER_CHUNK)
        block = np.column_stack([_columns(angle[few], values), rows[:, few].T])
        triangle = np.linalg.qr(np.vstack([triangle, block]), mode="r")
    count = 2 * len(orders) + 1
    solved, _, rank, singular = np.linalg.lstsq(triangle[:, :count], triangle[:, count:], rcond=None)
    if rank < count or singular[-1] < LEAST_SINGULAR_RATIO * singular[0]:
        raise ValueError(
            f"{angle.size} positions cannot tell {len(orders)} orders apart; give more of them over more turns"
        )
    left = np.linalg.norm(triangle[:, :count] @ solved - triangle[:, count:], axis=0) / np.sqrt(angle.size)
    return [
        Spectrum(
            orders=orders,
            amplitude=np.hypot(cosine, sine),
            phase=np.arctan2(sine, cosine),
            mean=float(mean),
            residual=float(residual),
            turns=float(np.ptp(angle)) / (2.0 * np.pi) * angle.size / (angle.size - 1),
        )
        for mean, cosine, sine, residual in zip(
            solved[0], solved[1 : len(orders) + 1].T, solved[len(orders) + 1 :].T, left, strict=True
        )
    ]


def named_orders(orders: tuple[Order, ...], amplitude: FloatArray, residual: FloatArray) -> tuple[Order, ...]:
    """Return orders with an empty name where no fit has them above its residual.

    What no order explains is spread over all of them: an order below the residual may be a part of it, and no motion of the
    drive.

    Parameters
    ----------
    orders : tuple of Order
        Those that were fitted.
    amplitude : array, shape (orders, fits)
        Their amplitudes.
    residual : array, shape (fits,)
        Root mean square of what the orders leave, in the same unit.

    Examples
    --------
    >>> orders = Order(13.0, "flank, 1 z_C"), Order(12.07, "flank -1 wheel pins")
    >>> named_orders(orders, np.array([[1.3, 0.4], [0.01, 0.02]]), np.array([0.04, 0.05]))[1]
    Order(value=12.07, name='')
    """
    above = np.any(amplitude > residual, axis=1)
    return tuple(order if stays else order._replace(name="") for order, stays in zip(orders, above, strict=True))


class OrderFit:
    """Least squares of a mean and orders, a·cos(order·φ_C − phase), on values that come a part of the positions at a time.

    Parameters
    ----------
    orders : array, shape (orders,)
        By turn of the crank; the positions must tell them apart as `fit_orders` asks for.
    """

    def __init__(self, orders: FloatArray) -> None:
        self.orders = orders
        count = 2 * orders.size + 1
        self._gram = np.zeros((count, count))
        self._right: Any = 0.0
        self._square: Any = 0.0
        self._positions = 0

    def add(self, crank_angle: FloatArray, values: FloatArray) -> None:
        """Add values at crank angles, shape (positions, …)."""
        columns = _columns(crank_angle, self.orders)
        self._gram += columns.T @ columns
        self._right = self._right + np.tensordot(columns, values, axes=(0, 0))
        self._square = self._square + np.sum(values**2, axis=0)
        self._positions += crank_angle.size

    @property
    def singular_ratio(self) -> float:
        """Least singular value of the columns by the largest one (`LEAST_SINGULAR_RATIO`)."""
        sizes = np.linalg.eigvalsh(self._gram)
        return float(np.sqrt(max(sizes[0], 0.0) / sizes[-1]))

    def solve(self) -> tuple[FloatArray, ComplexArray, FloatArray]:
        """Return the mean, shape (…), complex amplitudes a of Re a·exp(i·order·φ_C), shape (orders, …), and the root mean square
        of what no order explains, shape (…).
        """
        found = np.linalg.solve(self._gram, self._right.reshape(self._gram.shape[0], -1)).reshape(self._right.shape)
        left = self._square - np.sum(found * self._right, axis=0)
        count = self.orders.size
        amplitude = found[1 : count + 1] - 1j * found[count + 1 :]
        return found[0], np.asarray(amplitude), np.sqrt(np.maximum(left, 0.0) / self._positions)
