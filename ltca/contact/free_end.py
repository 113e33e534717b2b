"""Free ends: bodies that stop where the contact stops are no half-spaces.

A roller flush with a disc of the same thickness has a free face at y = ±L/2 in both bodies, where the half-space has
material that stiffens the end and props it up. The usual correction mirrors the load in the face (de Mul, Kalker and
Fredriksson, J. Tribol. 108 (1986) 140, after Hetényi): the mirror load cancels the shear stress on the face. The
normal stress on the face is doubled instead of removed; letting it go softens the end further, which
R. Guilbault (J. Tribol. 133 (2011) 031402) covers by an overload factor on the mirror load.

The mirrored kernel 1/√(x² + (y+y')²) is positive definite on one side of the face, so the matrix stays symmetric
positive definite for every factor ≥ 0. When only one body has free ends its images count by its share of the
compliance.

Measured on flush steel rollers (L = 11.8 mm, ρ = 2 … 5 mm, δ = 2 … 10 µm, factor 1.39), against the half-space:
at equal approach 24 … 28 % less load and 9 … 10 % less mid-width pressure; at equal load 30 … 35 % more approach and
4.6 … 5.8 % more mid-width pressure, since the ends no longer carry a peak: there the pressure falls to 0.90 … 0.95 of
the middle at a distance of 0.1 … 0.2 mm and to zero at the very end. With the plain mirror (factor 1) it is even
within 1 %.

Checked by finite elements in three dimensions (``docs/theory/solid_contact.md``), L = 11.8 mm, ρ = 5 mm, 2000 N at the same
load: from a half-width inside the end on, the pressure by that in the middle is within 0.03 of solid bodies (0.911
against 0.884), K_Hβ within 1 %; at half a half-width inside it is 0.035 too high. Where one of two bodies goes on beyond the
end, images with half the factor are within 0.045 from a half-width inside on. The approach is not compared: it depends on
what the bodies are held by.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ltca.arrays import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeEnds:
    """Free ends of the bodies of a contact, alike at both ends.

    Attributes
    ----------
    reach : float
        Length of the body by that of the contact, at least 1: its end planes stand so many half-lengths from the middle.
    weight : float
        Of the images in them (`free_end_factor`).
    """

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


def free_end_factor(poisson_ratio: float, compliance_share: float = 1.0) -> float:
    """Weight of the end images for `ltca.contact.pressure_cells`.

    Parameters
    ----------
    poisson_ratio : float
        ν of the bodies with free ends.
    compliance_share : float
        Their part of 1/E*: 1 when both bodies end at the contact's ends, 0.5 for one of two alike.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        If the share is outside 0 … 1.
    """
    if not 0.0 <= compliance_share <= 1.0:
        raise ValueError(f"the compliance share must lie between 0 and 1, not {compliance_share}")
    return compliance_share * guilbault_factor(poisson_ratio)


def remaining_bulge(free_ends: Iterable[FreeEnds], stretch: FloatArray) -> FloatArray:
    r"""Return what images leave of the bulge of half-spaces at an end that carries: 1 far from end planes, none at a full image.

    Parameters
    ----------
    free_ends : iterable of FreeEnds
        Of the bodies.
    stretch : array
        Length of the stretch at the end that is asked for, by that of the contact.

    Returns
    -------
    array
        1 less the parts of the images: what a narrow stretch feels of its image in the plane of a body, by what it would feel of
        one in a plane at its own end, :math:`\langle 1/(y + y' + 2g) \rangle` over the stretch with the gap g.
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
    """Return the free ends of the bodies of a contact.

    Parameters
    ----------
    length : float
        Of the contact, mm.
    compliance : float
        1/E* of the contact, 1/MPa.
    bodies : iterable of tuple of float
        Of each body that ends its length in mm, at least that of the contact, (1 − ν²)/E in 1/MPa and ν.

    Returns
    -------
    tuple of FreeEnds
        By their reach; bodies of one length together.

    Examples
    --------
    >>> both = free_ends_of(12.0, 2e-5, [(12.0, 1e-5, 0.3), (12.0, 1e-5, 0.3)])
    >>> [(each.reach, round(each.weight, 3)) for each in both]
    [(1.0, 1.39)]
    """
    weights: dict[float, float] = {}
    for own, part, poisson_ratio in bodies:
        reach = max(own / length, 1.0)
        weights[reach] = weights.get(reach, 0.0) + free_end_factor(poisson_ratio, min(part / compliance, 1.0))
    return tuple(FreeEnds(reach=reach, weight=weight) for reach, weight in sorted(weights.items()))
