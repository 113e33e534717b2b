r"""Anderson's mixing: a fixed point x = G(x) from the last few pairs of x and G(x).

The next x is the combination of the last :math:`G(x_k)`, with factors that add up to one, whose changes :math:`G(x_k) - x_k`
combined the same way are smallest (Walker & Ni 2011). For a G that is affine this is GMRES; it needs no derivative of G.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ltca.arrays import ComplexArray, FloatArray

WORSE = 2.0
"""Growth of the change from one round to the next at which older rounds are forgotten: contacts have opened or closed."""


@dataclass(slots=True, kw_only=True)
class AndersonMixing:
    """Memory of the last rounds.

    Attributes
    ----------
    depth : int
        Number of earlier rounds that are combined.
    """

    depth: int
    _changes: list[FloatArray] = field(default_factory=list)
    _values: list[FloatArray] = field(default_factory=list)

    def next(self, given: ComplexArray, found: ComplexArray) -> ComplexArray:
        """Return the x to try next, by x and G(x) of this round, of any shape."""
        change, value = ((found - given).ravel().view(float), found.ravel().view(float))
        if self._changes and np.linalg.norm(change) > WORSE * np.linalg.norm(self._changes[-1]):
            self._changes.clear()
            self._values.clear()
        self._changes.append(change.copy())
        self._values.append(value.copy())
        del self._changes[: -self.depth - 1], self._values[: -self.depth - 1]
        if len(self._changes) == 1:
            return found
        steps, moves = np.diff(self._changes, axis=0).T, np.diff(self._values, axis=0).T
        factors = np.linalg.lstsq(steps, change, rcond=1e-10)[0]
        return np.asarray((value - moves @ factors).view(complex).reshape(found.shape))
