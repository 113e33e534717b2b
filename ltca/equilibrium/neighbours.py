"""Which positions of many are balanced first, and the poses of those between them: seen from the crank they hardly differ."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, take_positions
from ltca.compliance.response import Start
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pairs import ContactGeometry

RESOLVED = 4
"""Leading positions in a passage of a tooth, a hole or a roller, whichever are most: a pose between two is near then."""
WORTH = 2
"""Positions for one leading, below which each might as well lead."""
MOST = 8
Way: TypeAlias = tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]
"""Known positions before and after wanted ones, and the part of the way between them."""


def leading_positions(geometry: ContactGeometry, angle: FloatArray, moment: FloatArray) -> NDArray[np.intp]:
    """Return which positions of one drive to balance first; all of them where neighbours are no help.

    Crank angles are in rad, moments on the wheel in N·mm: only positions under the same moment have neighbours.
    """
    everything = np.arange(angle.size)
    place = geometry.placement
    if angle.size < WORTH * RESOLVED or np.ptp(moment) > 0.0:
        return everything
    order = np.argsort(angle, kind="stable")
    passages = max(place.reduction_ratio, place.hole_radii.shape[-1], place.roller_radii.shape[-1] // place.cranks)
    spacing = float(np.max(np.diff(angle[order])))
    stride = min(MOST, int(2.0 * np.pi / (passages * RESOLVED * spacing))) if spacing > 0.0 else 1
    if stride < WORTH:
        return everything
    return np.sort(np.append(order[:-1:stride], order[-1]))


def between(angle: FloatArray, wanted: FloatArray) -> Way:
    """Return the known positions before and after each wanted crank angle, rad, and the part of the way between these.

    Known angles may stand in any order; beyond the first and the last there is nothing but these.
    """
    order = np.argsort(angle, kind="stable")
    behind = np.clip(np.searchsorted(angle[order], wanted), 1, max(angle.size - 1, 1))
    before, after = order[behind - 1], order[min(angle.size - 1, 1) * behind]
    span = angle[after] - angle[before]
    return before, after, np.clip((wanted - angle[before]) / np.where(span > 0.0, span, 1.0), 0.0, 1.0)


def pose_between(
    angle: FloatArray, pose: FloatArray, wanted: FloatArray, coordinates: Coordinates, way: Way | None = None
) -> FloatArray:
    """Return poses at wanted crank angles between known ones, linearly as seen from the turning crank.

    Known angles, rad, may stand in any order; poses have the shape (positions, coordinates). `way` is `between` by default.

    Examples
    --------
    >>> known = np.array([[1.0, 0, 0, 0], [-1.0, 0, 0, 2]])
    >>> pose_between(np.array([0.0, np.pi]), known, np.array([0.5 * np.pi]), Coordinates()).round(9)
    array([[0., 1., 0., 1.]])
    """
    before, after, _ = between(angle, wanted) if way is None else way
    seen, span = _turned(pose, -angle, coordinates), angle[after] - angle[before]
    slope = (seen[after] - seen[before]) / np.where(span > 0.0, span, 1.0)[:, None]
    ahead = np.minimum(np.maximum(wanted - angle[before], 0.0), span)
    inside = np.where((ahead < span)[:, None], seen[before] + slope * ahead[:, None], seen[after])
    return _turned(inside, wanted, coordinates)


def start_between(angle: FloatArray, known: Start, wanted: FloatArray, ratio: float, way: Way) -> Start:
    """Return inner unknowns between known ones: places on the flank in line as seen from the wheel, the rest from the nearer.

    Angles, rad, and `way` are those of `between`; a pin moves along the flank by φ_C/u, u the `ratio`.
    """
    before, after, part = way

    def at(values: FloatArray) -> FloatArray:
        return np.asarray(values[before] + part[:, None] * (values[after] - values[before]))

    return Start(
        parameter=at(known.parameter - angle[:, None] / ratio) + wanted[:, None] / ratio,
        share=at(known.share),
        inner=None
        if known.inner is None
        else take_positions(known.inner.elsewhere, np.where(part < 0.5, before, after)),
    )


def _turned(pose: FloatArray, angle: FloatArray, coordinates: Coordinates) -> FloatArray:
    """Poses whose displacements are turned by angles, rad; rotations stay."""
    turned = pose.copy()
    for x in coordinates.displacements:
        place = (pose[:, x] + 1j * pose[:, x + 1]) * np.exp(1j * angle)
        turned[:, x], turned[:, x + 1] = place.real, place.imag
    return turned
