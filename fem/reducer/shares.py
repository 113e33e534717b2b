r"""Part of the wheel's moment that each disc carries: iteration of the moments until all wheel angles agree.

Disc k alone turns the wheel to :math:`\theta_k(M_k)`, nearly a straight line. Each round takes the lines as they are known
and finds the moments whose angles agree and whose sum is the required one; their result updates the lines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray
from ltca.errors import ConvergenceError

MAX_ROUNDS = 12
ANGLE_TOLERANCE = 1e-9
"""Largest difference of wheel angles, rad: a hundred thousandth of the wind-up of a drive."""
MOMENT_TOLERANCE = 1e-8
"""Largest moment left over as a part of the wheel's."""
MIN_SHARE = 1e-3
"""A disc below this part of the mean share floats in its play: its place is indeterminate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SharedAnswer:
    """Wheel angles of the discs under given moments.

    Attributes
    ----------
    wheel_angle : array, shape (discs,)
        To which each disc alone turns the wheel, rad.
    left_over : float
        Excess of the sum of all moments over the required one, N·mm.
    """

    wheel_angle: FloatArray
    left_over: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Shares:
    """Moments under which all discs turn the wheel to one angle.

    Attributes
    ----------
    moment : array, shape (discs,)
        N·mm.
    slope : array, shape (discs,)
        dθ/dM of each, rad/(N·mm).
    spread : tuple of float
        Largest difference of the wheel angles in each round, rad.
    left_over : tuple of float
        Moment left over in each round, N·mm.
    """

    moment: FloatArray
    slope: FloatArray
    spread: tuple[float, ...]
    left_over: tuple[float, ...]


def share_moment(
    answer: Callable[[FloatArray], SharedAnswer],
    moment: FloatArray,
    slope: FloatArray,
    *,
    rise: float = 1.0,
    angle_tolerance: float = ANGLE_TOLERANCE,
    rounds: int = MAX_ROUNDS,
) -> Shares:
    """Find the moments under which all discs turn the wheel to one angle.

    `answer` gives wheel angles for moments of shape (discs,), N·mm. `moment` and `slope` (dθ/dM, rad/(N·mm)) are first
    estimates; the moments must add up to the sign of the wheel's moment. `rise` is the derivative of the moment left over by
    the sum of the moments. ConvergenceError when a disc would carry nothing or the angles do not agree; the history holds
    their differences, rad.
    """
    moment, slope = np.array(moment, dtype=float), np.array(slope, dtype=float)
    sign, size = np.sign(moment.sum()), abs(moment.sum())
    least = MIN_SHARE * size / moment.size
    spread: list[float] = []
    left: list[float] = []
    before: tuple[FloatArray, FloatArray] | None = None
    for _ in range(rounds):
        found = answer(moment)
        angle = found.wheel_angle
        spread.append(float(np.ptp(angle)))
        left.append(found.left_over)
        if spread[-1] <= angle_tolerance and abs(left[-1]) <= MOMENT_TOLERANCE * size:
            return Shares(moment=moment, slope=slope, spread=tuple(spread), left_over=tuple(left))
        if before is not None:
            slope = _secants(slope, moment - before[0], angle - before[1], 1e-6 * size)
        before = moment, angle
        more = -found.left_over / rise
        common = (more + np.sum(angle / slope)) / np.sum(1.0 / slope)
        wanted = moment + (common - angle) / slope
        short = sign * wanted < least
        if np.any(short & (sign * moment <= least)):
            disc = int(np.argmin(sign * wanted))
            raise ConvergenceError(
                f"disc {disc} carries less than {MIN_SHARE:g} of the mean share of the wheel's moment: finite elements "
                "cannot say where a disc without load rests; differences of the wheel angles in rad",
                spread,
            )
        # A disc that would be let go is first tried at next to nothing: others make up for it.
        moment = np.where(short, sign * least, wanted)
        moment[~short] += (np.sum(wanted) - moment.sum()) / np.count_nonzero(~short)
    raise ConvergenceError(f"the discs' wheel angles do not agree after {rounds} rounds; differences in rad", spread)


def _secants(slope: FloatArray, moments: FloatArray, angles: FloatArray, least: float) -> FloatArray:
    """Return secants over the last step, where it was long enough and the secant is plausible, else the slopes before."""
    told = np.abs(moments) > least
    secant = angles / np.where(told, moments, 1.0)
    return np.where(told & (secant > 0.1 * slope) & (secant < 10.0 * slope), secant, slope)
