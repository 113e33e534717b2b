"""Safety of the flank pressure against a limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.arrays import FloatArray, place_of_largest


@dataclass(frozen=True, slots=True, kw_only=True)
class PressureSafety:
    """Least safety of a run.

    Attributes
    ----------
    limit, largest : float
        Given limit and largest pressure, MPa.
    safety : float
        Limit by largest pressure.
    load_factor : float
        Factor on the load of that contact that would reach the limit: pressure of a line contact grows as √load.
    position, pin : int
        Where the largest pressure is.
    per_pin : array, shape (pins,)
        Least safety of each pin; infinite where it carries nothing.
    """

    limit: float
    largest: float
    safety: float
    load_factor: float
    position: int
    pin: int
    per_pin: FloatArray


def pressure_safety(pressure: FloatArray, limit: float) -> PressureSafety:
    """Return the safety of pressures against a limit.

    Parameters
    ----------
    pressure : array, shape (positions, pins)
        Pressures at mid-width, MPa.
    limit : float
        Permissible pressure, MPa, positive.

    Raises
    ------
    ValueError
        When the limit is not positive or nothing is pressed.

    Examples
    --------
    >>> pressure_safety(np.array([[500.0, 0.0], [0.0, 800.0]]), 1600.0).safety
    2.0
    """
    if not limit > 0.0:
        raise ValueError(f"the limit must be greater than 0 MPa, not {limit:g}")
    largest = float(np.max(pressure))
    if not largest > 0.0:
        raise ValueError("no pin is pressed on the flank")
    position, pin = place_of_largest(pressure)
    worst = pressure.max(axis=0)
    return PressureSafety(
        limit=limit,
        largest=largest,
        safety=limit / largest,
        load_factor=(limit / largest) ** 2,
        position=position,
        pin=pin,
        per_pin=np.where(worst > 0.0, limit / np.where(worst > 0.0, worst, 1.0), np.inf),
    )


class PressureOfTurns:
    """Flank pressures turn by turn, of which the turn with the largest is kept: what is drawn is what is printed.

    Parameters
    ----------
    each : int
        Positions in a turn.
    """

    def __init__(self, each: int) -> None:
        self._each, self._complete = each, 0
        self._open: FloatArray | None = None
        self._largest: Any = None
        self.turn = 0
        self.worst: Any = None

    def add(self, pressure: FloatArray) -> None:
        """Take the pressures of the next positions, shape (positions, pins), MPa.

        Parameters
        ----------
        pressure : array, shape (positions, pins)
            At mid-width, MPa.
        """
        self._open = pressure if self._open is None else np.concatenate([self._open, pressure])
        while len(self._open) >= self._each:
            one, self._open = self._open[: self._each], self._open[self._each :]
            if self.worst is None or one.max() > self.worst.max():
                self.turn, self.worst = self._complete, one.copy()
            largest = one.max(axis=0)
            self._largest = largest if self._largest is None else np.maximum(self._largest, largest)
            self._complete += 1

    def safety(self, limit: float) -> PressureSafety:
        """Return the safety over all turns.

        Parameters
        ----------
        limit : float
            Permissible pressure, MPa.
        """
        # The largest of each pin in all turns stands behind the worst turn, whose position is found first.
        return pressure_safety(np.vstack([self.worst, self._largest]), limit)
