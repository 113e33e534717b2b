"""Yield of a solid cylinder with free ends at a contact beyond plane strain, κ e(ν, R/t) and 12/t² κ e′(ν, R/t).

From finite elements in three dimensions (``benchmarks/solid_cylinder.py`` prints the tables; docs/theory/solid_bodies.md).
"""

from __future__ import annotations

import numpy as np

POISSON_RATIOS = (0.2, 0.3, 0.4)
RADIUS_BY_LENGTH = (1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 1.0)
EVEN = (
    (0.0443, 0.0481, 0.0555, 0.0696, 0.0886),
    (0.1055, 0.1145, 0.1325, 0.1664, 0.2114),
    (0.2035, 0.2212, 0.2562, 0.3223, 0.4093),
)
"""e by Poisson's ratio (rows) and R/t."""
LINEAR = (
    (0.0477, 0.0528, 0.0520, 0.0176, -0.1068),
    (0.1160, 0.1345, 0.1553, 0.1485, 0.0505),
    (0.2258, 0.2657, 0.3204, 0.3545, 0.2919),
)
"""e′, the same."""


def free_ends_of_cylinder(radius: float, length: float, poisson_ratio: float) -> tuple[float, float]:
    """Return e and e′ of an even and a linear load; beyond R/t of 1/16 to 1 the ends of the table hold.

    >>> free_ends_of_cylinder(1.0, 4.0, 0.3)
    (0.1325, 0.1553)
    """
    at = np.log(radius / length)
    nodes = np.array(POISSON_RATIOS)
    # Lagrange's weights of the three Poisson ratios.
    weights = [
        float(np.prod([(poisson_ratio - other) / (own - other) for other in nodes if other != own])) for own in nodes
    ]
    even, linear = (
        float(sum(w * np.interp(at, np.log(RADIUS_BY_LENGTH), row) for w, row in zip(weights, table, strict=True)))
        for table in (EVEN, LINEAR)
    )
    return round(even, 12), round(linear, 12)
