r"""Hysteresis of the wind-up as Maxwell-slip elements whose strength goes with the load.

Friction in a drive is Coulomb's, so what contacts hold grows with what they carry: the loop of a drive is narrow at light
torques and gone within the play. Elements of constant strength have the same width everywhere; those here act on the elastic
torque f, the torque of the drive without friction at the same wind-up. Each flank has its own, with the load q = f or −f
where that is positive, since other contacts carry there and let go elsewhere: an element moves by :math:`\kappa\,\Delta q`
and slips at :math:`c\,T_r (q/T_r)^p` with the rated torque :math:`T_r` and p = 1 (Coulomb) or 2 (more contacts carry). Its
stiffness by its strength says at which part of the torque of the reversal it slips back. Torque along a path is linear in
the strengths, which are found by non-negative least squares, flank by flank. What contacts hold goes with the crank angle as
well: the strength of all elements has a factor for it, of one in the mean, by orders, found from the drive loaded slowly at
many crank angles. So does where they slip back: some elements have a weight :math:`1 + \cos(o\varphi_C - \psi)` besides,
with an order o and ψ of 0, π/2, π or 3π/2, which is never negative; a sum of them is a distribution of elements that goes
with the crank angle. Factor and weight act on strength and stiffness alike. Orders are taken one by one, the one that
explains most of what is left along the paths first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from ltca.analysis.transmission_error_orders import Order, fit_orders, named_orders
from ltca.arrays import FloatArray

SLIPS_BACK_AT = (0.98, 0.965, 0.95, 0.92, 0.89, 0.86, 0.83, 0.8, 0.76, 0.7, 0.6, 0.45, 0.3)
"""Elastic torque by that of the reversal at which an element has slipped back."""
EXPONENTS = (1.0, 2.0)
LEAST_FACTOR = 0.005
"""Amplitude of an order of the factor, by one, up to which it is left out."""
LEAST_STRENGTH = 1e-5
"""By the rated torque; weaker elements are left out."""
PHASES = (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi)
"""Of weights, rad: sums of them have any phase."""
MOST_ORDERS = 3
"""Of weights; each has four times as many strengths as there are elements without one."""
LEAST_GAIN = 0.9
"""Squares that are left on paths not fitted to, by those without one more order, above which it is not taken."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HysteresisElements:
    """Maxwell-slip elements on the elastic torque.

    Attributes
    ----------
    flank : array, shape (elements,)
        Sign of the elastic torque under which an element carries: contacts of the other flank are open then.
    exponent, strength, stiffness : array, shape (elements,)
        p, c and κ.
    order, amplitude, phase : array, shape (elements,)
        Of the weight 1 + amplitude·cos(order·φ_C − phase) on strength and stiffness; phase in rad.
    """

    flank: FloatArray
    exponent: FloatArray
    strength: FloatArray
    stiffness: FloatArray
    order: FloatArray
    amplitude: FloatArray
    phase: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class StrengthFactor:
    """Factor of the strength of all elements over the crank angle, 1 in the mean.

    Attributes
    ----------
    orders : tuple of Order
        By turn of the crank against the pin shaft.
    cosine, sine : array, shape (2, orders)
        Amplitudes at negative and at positive torque.
    """

    orders: tuple[Order, ...]
    cosine: FloatArray
    sine: FloatArray

    @classmethod
    def fitted(cls, crank_angle: FloatArray, parts: list[FloatArray], orders: tuple[Order, ...]) -> StrengthFactor:
        """Return the factor by what is held by friction at some crank angles.

        Parameters
        ----------
        crank_angle : array, shape (angles,)
            rad.
        parts : list of array, shape (angles,)
            Of the torque, at negative and at positive torque.
        orders : tuple of Order
            What is fitted; those weaker than `LEAST_FACTOR` are left out, and those below the residual have no name.
        """
        amplitudes, residuals = [], []
        for part in parts:
            fit = fit_orders(crank_angle, part / part.mean(), orders)
            amplitudes.append(fit.amplitude * np.exp(1j * fit.phase) / fit.mean)
            residuals.append(fit.residual / abs(fit.mean))
        found = np.array(amplitudes)
        named = named_orders(orders, np.abs(found.T), np.array(residuals))
        kept = np.max(np.abs(found), axis=0) > LEAST_FACTOR
        return cls(
            orders=tuple(order for order, stays in zip(named, kept, strict=True) if stays),
            cosine=found.real[:, kept],
            sine=found.imag[:, kept],
        )


NO_FACTOR = StrengthFactor(orders=(), cosine=np.zeros((2, 0)), sine=np.zeros((2, 0)))
NO_ELEMENTS = HysteresisElements(
    flank=np.zeros(0),
    exponent=np.zeros(0),
    strength=np.zeros(0),
    stiffness=np.zeros(0),
    order=np.zeros(0),
    amplitude=np.zeros(0),
    phase=np.zeros(0),
)


def _responses(
    elastic: FloatArray,
    rated: float,
    exponent: FloatArray,
    stiffness: FloatArray,
    factors: tuple[float, float],
) -> FloatArray:
    """Torque along a path of elements of strength one on both flanks, shape (points, elements); factors as in `fit_elements`."""
    state, found = np.zeros((2, exponent.size)), np.zeros((elastic.size, exponent.size))
    factor, before = np.array(factors)[:, None], np.zeros((2, 1))
    for place, value in enumerate(elastic.tolist()):
        load = np.array([[max(-value, 0.0)], [max(value, 0.0)]])
        most = factor * rated * (load / rated) ** exponent
        state = np.clip(state + factor * stiffness * (load - before), -most, most)
        before = load
        found[place] = state[1] - state[0]
    return found


def fit_elements(
    elastic: list[FloatArray],
    torque: list[FloatArray],
    rated: float,
    factors: list[tuple[float, float]],
    crank_angle: FloatArray | None = None,
    orders: tuple[float, ...] = (),
    judged: int = 0,
) -> HysteresisElements:
    """Fit elements to paths of torque.

    Parameters
    ----------
    elastic : list of array, shape (points,)
        Torque of the drive without friction at the same wind-up, path by path, N·mm; each path starts without load.
    torque : list of array, shape (points,)
        Torque along the same paths, N·mm.
    rated : float
        T_r, N·mm.
    factors : list of tuple of float
        Of the strength at negative and positive torque, path by path.
    crank_angle : array, shape (paths,), optional
        Of each path, rad; needed with `orders`.
    orders : tuple of float
        By turn of the crank, that weights may have: `MOST_ORDERS` of them at most are taken.
    judged : int
        Last paths that choose the orders, by elements fitted to the others; the elements returned are fitted to all.
    """
    exponent = np.repeat(EXPONENTS, len(SLIPS_BACK_AT))
    back = np.tile(SLIPS_BACK_AT, len(EXPONENTS))
    # What slips back at the part ρ has gone from c to −c ρ^p over 1 − ρ; an element follows its own strength while it grows.
    slope = np.maximum((1.0 + back**exponent) / (1.0 - back), exponent)
    alone = [
        _responses(path, rated, exponent, slope, factor) / rated for path, factor in zip(elastic, factors, strict=True)
    ]
    beside = [(value - path) / rated for path, value in zip(elastic, torque, strict=True)]
    angle = np.zeros(len(elastic)) if crank_angle is None else crank_angle
    flank = [path > 0.0 for path in elastic]

    def fitted(chosen: tuple[float, ...], last: int) -> list[FloatArray]:
        """Strengths on the flank of negative and of positive torque: points of one say nothing of the other."""
        found = []
        for way in (False, True):
            rows = [(_weights(chosen, angle[at]), at, flank[at] == way) for at in range(last)]
            columns = np.vstack([np.kron(weight, alone[at][here]) for weight, at, here in rows])
            right = np.concatenate([beside[at][here] for _, at, here in rows])
            found.append(np.asarray(nnls(columns, right, maxiter=20 * columns.shape[1])[0]))
        return found

    def rest(chosen: tuple[float, ...], strength: list[FloatArray], places: range) -> list[FloatArray]:
        """Return what elements leave of some paths."""
        found = []
        for at in places:
            columns = np.kron(_weights(chosen, angle[at]), alone[at])
            found.append(beside[at] - np.where(flank[at], columns @ strength[1], columns @ strength[0]))
        return found

    first = len(elastic) - judged
    own, others = range(first), range(first, len(elastic))

    taken: tuple[float, ...] = ()
    strength = fitted(taken, first) if orders else []
    least = np.sum(np.square(rest(taken, strength, others))) if orders else 0.0
    while len(taken) < min(MOST_ORDERS, len(orders)):
        most = _strongest(
            np.array(rest(taken, strength, own)), angle[:first], [one for one in orders if one not in taken]
        )
        tried = fitted((*taken, most), first)
        left = np.sum(np.square(rest((*taken, most), tried, others)))
        if left > LEAST_GAIN * least:
            break
        taken, strength, least = (*taken, most), tried, left
    flanks = fitted(taken, len(elastic))
    weights = 1 + len(PHASES) * len(taken)
    order = np.repeat(np.concatenate([[0.0], np.repeat(taken, len(PHASES))]), exponent.size)
    phase = np.repeat(np.concatenate([[0.0], np.tile(PHASES, len(taken))]), exponent.size)

    def both(column: FloatArray) -> FloatArray:
        return np.concatenate([column[one > LEAST_STRENGTH] for one in flanks])

    kept = np.concatenate([one[one > LEAST_STRENGTH] for one in flanks])
    return HysteresisElements(
        flank=np.concatenate(
            [np.full(np.sum(one > LEAST_STRENGTH), way) for one, way in zip(flanks, (-1.0, 1.0), strict=True)]
        ),
        exponent=both(np.tile(exponent, weights)),
        strength=kept,
        stiffness=both(np.tile(slope, weights)) * kept,
        order=both(order),
        amplitude=both(np.where(order > 0.0, 1.0, 0.0)),
        phase=both(phase),
    )


def _strongest(rest: FloatArray, crank_angle: FloatArray, orders: list[float]) -> float:
    """Return the order that explains most of what is left along paths, shape (paths, points)."""
    centred = rest - rest.mean(axis=0)

    def explained(order: float) -> float:
        columns = np.column_stack([np.cos(order * crank_angle), np.sin(order * crank_angle)])
        basis = np.linalg.qr(columns - columns.mean(axis=0))[0]
        return float(np.sum(np.square(basis.T @ centred)))

    return max(orders, key=explained)


def _weights(orders: tuple[float, ...], crank_angle: float) -> FloatArray:
    """Weight one, and those of each order and phase, at a crank angle, shape (1, weights)."""
    of_orders = [1.0 + np.cos(order * crank_angle - phase) for order in orders for phase in PHASES]
    return np.array([[1.0, *of_orders]])
