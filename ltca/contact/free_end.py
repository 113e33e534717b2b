"""Free ends: bodies that stop where the contact stops are no half-spaces.

A roller flush with a disc of the same thickness has a free face at y = ±L/2 in both bodies, where the half-space has
material that stiffens the end and props it up. The usual correction mirrors the load in the face (de Mul, Kalker and
Fredriksson, J. Tribol. 108 (1986) 140, after Hetényi): the mirror load cancels the shear stress on the face. The
normal stress on the face is doubled instead of removed; letting it go softens the end further, which
R. Guilbault (J. Tribol. 133 (2011) 031402) covers by an overload factor on the mirror load.

The mirrored kernel 1/√(x² + (y+y')²) is positive definite on one side of the face, so the matrix stays symmetric
positive definite for every factor ≥ 0. When only one body has free ends its images count by its share of the
compliance.

What this does to flush rollers, and how far it is from solid bodies in three dimensions, is measured in
``docs/theory/solid_contact.md``: pressures are within 0.03 of that in the middle from a half-width inside the end on.
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

    Guilbault's fit, quoted from memory of the secondary literature and not compared with his print. It leaves
    the pressure near a flush end at 0.9 of the middle, which is what an end in plane stress beside a middle in plane
    strain suggests (1 − ν² = 0.91).

    Examples
    --------
    >>> round(guilbault_factor(0.3), 3)
    1.39
    """
    return 1.29 - (0.08 - 0.5 * poisson_ratio) / (1.0 - poisson_ratio)


def remaining_bulge(free_ends: Iterable[FreeEnds], stretch: FloatArray) -> FloatArray:
    r"""Return what images leave of the bulge of half-spaces at an end that carries: 1 far from end planes, none at a full image.

    It is 1 less the parts of the images: what a narrow stretch at the end, of the length `stretch` by that of the contact, feels
    of its image in the plane of a body, by what it would feel of one in a plane at its own end, :math:`\langle 1/(y + y' + 2g)
    \rangle` over the stretch with the gap g.
    """

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
    """Return the free ends of the bodies of a contact of a length, mm, and a compliance 1/E*, 1/MPa; by length.

    `bodies` has of each one that ends its length, mm, at least that of the contact, its part (1 − ν²)/E of the compliance, 1/MPa,
    by which its images count, and ν.

    Examples
    --------
    >>> both = free_ends_of(12.0, 2e-5, [(12.0, 1e-5, 0.3), (12.0, 1e-5, 0.3)])
    >>> [(each.reach, round(each.weight, 3)) for each in both]
    [(1.0, 1.39)]
    """
    weights: dict[float, float] = {}
    for own, part, poisson_ratio in bodies:
        reach = max(own / length, 1.0)
        weights[reach] = weights.get(reach, 0.0) + min(part / compliance, 1.0) * guilbault_factor(poisson_ratio)
    return tuple(FreeEnds(reach=reach, weight=weight) for reach, weight in sorted(weights.items()))
