"""Balance as many positions as have an answer: one that has none costs the others nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, join_positions, spread_positions, take_positions
from ltca.equilibrium.balance import Equilibrium
from ltca.errors import ConvergenceError

Balance = Callable[[NDArray[np.intp], FloatArray | None], Equilibrium]
"""What balances some positions, from poses near by if given."""
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, kw_only=True)
class PartlyBalanced:
    """Positions of which some may have no answer.

    Attributes
    ----------
    positions : int
        How many were asked for.
    rows : array of int
        Which have an answer, ascending.
    found : Equilibrium
        Of these.
    failure : ConvergenceError or None
        Of the first that has none.
    """

    positions: int
    rows: NDArray[np.intp]
    found: Equilibrium
    failure: ConvergenceError | None

    @property
    def balanced(self) -> NDArray[np.bool_]:
        """Which have an answer, shape (positions,)."""
        known = np.zeros(self.positions, dtype=bool)
        known[self.rows] = True
        return known

    def spread(self, value: Value) -> Value:
        """Return a tree of arrays of the balanced positions as one of all positions: no numbers elsewhere."""
        return value if self.failure is None else spread_positions(value, self.rows, self.positions)


def all_balanced(found: Equilibrium) -> PartlyBalanced:
    """Return positions that all have an answer."""
    positions = found.crank_angle.size
    return PartlyBalanced(positions=positions, rows=np.arange(positions), found=found, failure=None)


def nothing_balanced(like: Equilibrium, positions: int, failure: ConvergenceError) -> PartlyBalanced:
    """Return positions of which none has an answer, with arrays of the same shapes as those of `like`."""
    none = np.zeros(0, dtype=np.intp)
    return PartlyBalanced(positions=positions, rows=none, found=take_positions(like, none), failure=failure)


def balance_what_can_be(balance: Balance, positions: int, start: FloatArray | None = None) -> PartlyBalanced:
    """Balance positions together, and where that fails find out which of them have an answer.

    Poses to start from, shape (positions, coordinates), are not a number where there is none. Where no position has an answer the
    ConvergenceError of all together is raised.
    """
    everything = np.arange(positions)
    failures: list[ConvergenceError] = []
    pieces: list[tuple[NDArray[np.intp], Equilibrium]] = []

    # No function that calls itself: it would be a cycle that keeps the answers until they are collected as garbage.
    waiting = [everything]
    while waiting:
        part = waiting.pop()
        begin = None if start is None or np.isnan(start[part]).any() else start[part]
        try:
            pieces.append((part, balance(part, begin)))
        except ConvergenceError as error:
            failures.append(error)
            if part.size > 1:
                waiting += np.array_split(part, 2)[::-1]
    if not pieces:
        raise failures[0]
    rows = np.concatenate([rows for rows, _ in pieces])
    found = join_positions([piece for _, piece in pieces])
    # The first failure is that of all positions together, and names the worst of them and how many there are.
    failure = failures[0] if rows.size < positions else None
    return PartlyBalanced(positions=positions, rows=rows, found=found, failure=failure)
