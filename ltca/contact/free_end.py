"""Free ends: bodies that stop where the contact stops, by images of the load in the end planes (docs/theory/solid_contact.md).

An image cancels the shear on a face and doubles the normal stress (de Mul, Kalker and Fredriksson, J. Tribol. 108 (1986) 140,
after Hetényi); R. Guilbault (J. Tribol. 133 (2011) 031402) covers that by an overload factor. Of one body it counts by its
compliance.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeEnds:
    """End planes of bodies, `reach` half-lengths of the contact from its middle, and the weight of the images in them."""

    reach: float
    weight: float


def guilbault_factor(poisson_ratio: float) -> float:
    """Overload factor ψ = 1.29 − (0.08 − 0.5 ν)/(1 − ν) of the mirror load.

    Quoted from memory of the secondary literature, not compared with Guilbault's print.

    >>> round(guilbault_factor(0.3), 3)
    1.39
    """
    return 1.29 - (0.08 - 0.5 * poisson_ratio) / (1.0 - poisson_ratio)


def remaining_bulge(free_ends: Iterable[FreeEnds], stretch: FloatArray) -> FloatArray:
    """Return the part of the bulge of half-spaces at an end that images leave; `stretch` is by the length of the contact."""

    def felt(gap: FloatArray) -> FloatArray:
        first, middle, last = gap, gap + 1.0, gap + 2.0
        below = first * np.log(np.where(first > 0.0, first, 1.0))
        return np.asarray(last * np.log(last) - 2.0 * middle * np.log(middle) + below)

    at = np.asarray(stretch, dtype=float)
    of_images = sum(
        each.weight * felt((each.reach - 1.0) / np.maximum(at, 1e-300)) / (2.0 * np.log(2.0)) for each in free_ends
    )
    return np.asarray(np.maximum(1.0 - of_images, 0.0))


def free_ends_of(
    length: float, compliance: float, bodies: Iterable[tuple[float, float, float]]
) -> tuple[FreeEnds, ...]:
    """Return the free ends, by length, of a contact's bodies, each given by its length, mm, (1 − ν²)/E, 1/MPa, and ν.

    >>> both = free_ends_of(12.0, 2e-5, [(12.0, 1e-5, 0.3), (12.0, 1e-5, 0.3)])
    >>> [(each.reach, round(each.weight, 3)) for each in both]
    [(1.0, 1.39)]
    """
    weights: dict[float, float] = {}
    for own, part, poisson_ratio in bodies:
        reach = max(own / length, 1.0)
        weights[reach] = weights.get(reach, 0.0) + min(part / compliance, 1.0) * guilbault_factor(poisson_ratio)
    return tuple(FreeEnds(reach=reach, weight=weight) for reach, weight in sorted(weights.items()))
