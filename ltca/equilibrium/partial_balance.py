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

Balance = Callable[[FloatArray, float, FloatArray | None], Equilibrium]
"""Function that balances positions: crank angles, output torque and poses near by if there are any."""
Value = TypeVar("Value")


@dataclass(frozen=True, slots=True, kw_only=True)
class PartlyBalanced:
    """Positions that have an answer, their answer, and the failure of the first that has none."""

    balanced: NDArray[np.bool_]
    found: Equilibrium
    failure: ConvergenceError | None = None

    def spread(self, value: Value) -> Value:
        """Return a tree of arrays of the balanced positions as one of all positions, NaN elsewhere."""
        if self.failure is None:
            return value
        return spread_positions(value, np.flatnonzero(self.balanced), self.balanced.size)


def all_balanced(found: Equilibrium) -> PartlyBalanced:
    """Return positions that all have an answer."""
    return PartlyBalanced(balanced=np.ones(found.crank_angle.size, dtype=bool), found=found)


def balance_what_can_be(
    balance: Balance,
    crank_angle: FloatArray,
    torque: float,
    start: FloatArray | None = None,
    like: Equilibrium | None = None,
) -> PartlyBalanced:
    """Balance positions together, and where that fails each one that has an answer; poses to start from may be NaN.

    Where none has an answer arrays are shaped like those of `like`; without that the ConvergenceError of all is raised.
    """
    failures: list[ConvergenceError] = []
    pieces: list[tuple[NDArray[np.intp], Equilibrium]] = []
    # No function that calls itself: it would be a cycle that keeps the answers until they are collected as garbage.
    waiting = [np.arange(crank_angle.size)]
    while waiting:
        part = waiting.pop()
        begin = None if start is None or np.isnan(start[part]).any() else start[part]
        try:
            pieces.append((part, balance(crank_angle[part], torque, begin)))
        except ConvergenceError as error:
            failures.append(error)
            if part.size > 1:
                waiting += np.array_split(part, 2)[::-1]
    if not pieces:
        if like is None:
            raise failures[0]
        none = np.zeros(0, dtype=np.intp)
        pieces.append((none, take_positions(like, none)))
    balanced = np.zeros(crank_angle.size, dtype=bool)
    balanced[np.concatenate([rows for rows, _ in pieces])] = True
    # The first failure is that of all positions together, and names the worst of them and how many there are.
    return PartlyBalanced(
        balanced=balanced,
        found=join_positions([piece for _, piece in pieces]),
        failure=None if balanced.all() else failures[0],
    )
