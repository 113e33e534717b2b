r"""Hysteresis of the wind-up as Maxwell-slip elements whose strength goes with the load.

Friction in a drive is Coulomb's, so what contacts hold grows with what they carry: the loop of a drive is narrow at light torques
and gone within the play. Elements of constant strength have the same width everywhere; those here act on the elastic torque f,
the torque of the drive without friction at the same wind-up: an element moves by :math:`\kappa\,\Delta f` and slips at
:math:`c\,T_r (|f|/T_r)^p` with the rated torque :math:`T_r` and p = 1 (Coulomb) or 2 (more contacts carry). Its stiffness by its
strength says at which part of the torque of the reversal it slips back. Torque along a path is linear in the strengths, which are
found by non-negative least squares. What contacts hold goes with the crank angle as well: the strength of all elements has a
factor for it, of one in the mean, by orders, found from the drive loaded slowly at many crank angles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from ltca.analysis.transmission_error_orders import Order, fit_orders
from ltca.arrays import FloatArray

SLIPS_BACK_AT = (0.95, 0.92, 0.89, 0.86, 0.83, 0.8, 0.76, 0.7, 0.6, 0.45, 0.3)
"""Elastic torque by that of the reversal at which an element has slipped back."""
EXPONENTS = (1.0, 2.0)
LEAST_FACTOR = 0.005
"""Amplitude of an order of the factor, by one, up to which it is left out."""
LEAST_STRENGTH = 1e-5
"""By the rated torque; weaker elements are left out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HysteresisElements:
    """Maxwell-slip elements on the elastic torque.

    Attributes
    ----------
    exponent, strength, stiffness : array, shape (elements,)
        p, c and κ.
    """

    exponent: FloatArray
    strength: FloatArray
    stiffness: FloatArray


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
            What is fitted; those weaker than `LEAST_FACTOR` are left out.
        """
        amplitudes = []
        for part in parts:
            fit = fit_orders(crank_angle, part / part.mean(), orders)
            amplitudes.append(fit.amplitude * np.exp(1j * fit.phase) / fit.mean)
        found = np.array(amplitudes)
        kept = np.max(np.abs(found), axis=0) > LEAST_FACTOR
        return cls(
            orders=tuple(order for order, stays in zip(orders, kept, strict=True) if stays),
            cosine=found.real[:, kept],
            sine=found.imag[:, kept],
        )


NO_FACTOR = StrengthFactor(orders=(), cosine=np.zeros((2, 0)), sine=np.zeros((2, 0)))
NO_ELEMENTS = HysteresisElements(exponent=np.zeros(0), strength=np.zeros(0), stiffness=np.zeros(0))


def _responses(
    elastic: FloatArray,
    rated: float,
    exponent: FloatArray,
    strength: FloatArray,
    stiffness: FloatArray,
    factors: tuple[float, float],
) -> FloatArray:
    """Torque of each element along a path, shape (points, elements); factors are those of negative and positive torque."""
    state, found = np.zeros(strength.size), np.zeros((elastic.size, strength.size))
    before = 0.0
    for place, value in enumerate(elastic.tolist()):
        most = factors[int(value > 0.0)] * strength * rated * (abs(value) / rated) ** exponent
        state = np.clip(state + stiffness * (value - before), -most, most)
        before, found[place] = value, state
    return found


def fit_elements(
    elastic: list[FloatArray], torque: list[FloatArray], rated: float, factors: list[tuple[float, float]]
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
    """
    exponent = np.repeat(EXPONENTS, len(SLIPS_BACK_AT))
    back = np.tile(SLIPS_BACK_AT, len(EXPONENTS))
    # What slips back at the part ρ has gone from c to −c ρ^p over 1 − ρ; an element follows its own strength while it grows.
    slope = np.maximum((1.0 + back**exponent) / (1.0 - back), exponent)
    one = np.ones(exponent.size)
    columns = np.vstack(
        [_responses(path, rated, exponent, one, slope, factor) for path, factor in zip(elastic, factors, strict=True)]
    )
    beside = np.concatenate([value - path for path, value in zip(elastic, torque, strict=True)])
    strength = nnls(columns / rated, beside / rated)[0]
    kept = strength > LEAST_STRENGTH
    return HysteresisElements(exponent=exponent[kept], strength=strength[kept], stiffness=(slope * strength)[kept])
