"""Which positions of many are balanced first, and the poses of those between them: seen from the crank they hardly differ."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, take_positions
from ltca.compliance.response import Start
from ltca.geometry.coordinates import Coordinates
from ltca.geometry.pairs import ContactGeometry

RESOLVED = 3.5
"""Leading positions in a passage of a tooth, a hole or a roller, whichever are most."""
WORTH = 2
"""Positions for one leading, below which each might as well lead."""
LEAST = 8
"""Positions of a series in which some lead others."""
MOST = 8
"""Positions for one leading where each evaluation takes long; half of it elsewhere."""
AROUND = 4
"""Known positions that a place between them follows, by Lagrange's polynomial; the two beside it where spacings differ."""
UNEVEN = 2.0
"""Ratio of spacings from which they differ."""
Way: TypeAlias = tuple[NDArray[np.intp], FloatArray]
"""Known positions around wanted ones and their weights, shape (wanted, positions around)."""


def have_neighbours(moment: FloatArray) -> bool:
    """Return whether positions are enough, all under the same moment, for one to lead others."""
    return moment.size >= LEAST and not np.ptp(moment) > 0.0


def leading_positions(
    geometry: ContactGeometry, angle: FloatArray, moment: FloatArray, most: int = MOST
) -> NDArray[np.intp]:
    """Return which positions of one drive to balance first, in order of their angles; all where neighbours are no help."""
    order = np.argsort(angle, kind="stable")
    place = geometry.placement
    if not have_neighbours(moment):
        return order
    passages = max(place.reduction_ratio, place.hole_radii.shape[-1], place.roller_radii.shape[-1] // place.cranks)
    spacing = float(np.max(np.diff(angle[order])))
    stride = min(most, int(2.0 * np.pi / (passages * RESOLVED * spacing))) if spacing > 0.0 else 1
    if stride < WORTH:
        return order
    return np.append(order[:-1:stride], order[-1])


def between(angle: FloatArray, wanted: FloatArray) -> Way:
    """Return the known positions around each wanted crank angle, rad, and the weights that interpolate between these.

    >>> between(np.arange(5.0), np.array([1.5]))
    (array([[0, 1, 2, 3]]), array([[-0.0625,  0.5625,  0.5625, -0.0625]]))
    """
    order = np.argsort(angle, kind="stable")
    count = min(AROUND, angle.size)
    behind = np.clip(np.searchsorted(angle[order], wanted), 1, max(angle.size - 1, 1))
    first = np.clip(behind - count // 2, 0, angle.size - count)
    around = first[:, None] + np.arange(count)
    place, x = angle[order][around], np.clip(wanted, angle.min(), angle.max())[:, None]
    apart = place[:, :, None] - place[:, None, :]
    off = np.broadcast_to((x - place)[:, None, :], apart.shape).copy()
    own = np.arange(count)
    apart[:, own, own] = off[:, own, own] = 1.0
    weights = np.prod(np.divide(off, apart, out=np.ones(apart.shape), where=apart != 0.0), axis=2)
    steps = np.diff(place, axis=1)
    uneven = steps.max(axis=1, initial=0.0) > UNEVEN * steps.min(axis=1, initial=np.inf)
    rows = np.nonzero(uneven)[0]
    before = (behind - 1 - first)[rows]
    span, ahead = steps[rows, before], x[rows, 0] - place[rows, before]
    part = np.divide(ahead, span, out=np.zeros(rows.size), where=span > 0.0)
    weights[rows] = 0.0
    weights[rows, before], weights[rows, before + 1] = 1.0 - part, part
    return order[around], weights


def pose_between(
    angle: FloatArray, pose: FloatArray, wanted: FloatArray, coordinates: Coordinates, way: Way | None = None
) -> FloatArray:
    """Return poses at wanted crank angles, interpolated as seen from the turning crank; `way` is `between` by default.

    >>> known = np.array([[1.0, 0, 0, 0], [-1.0, 0, 0, 2]])
    >>> pose_between(np.array([0.0, np.pi]), known, np.array([0.5 * np.pi]), Coordinates()).round(9)
    array([[0., 1., 0., 1.]])
    """
    around, weights = between(angle, wanted) if way is None else way
    seen = turned(pose, -angle, coordinates)
    return turned(np.einsum("wk,wkc->wc", weights, seen[around]), wanted, coordinates)


def start_between(angle: FloatArray, known: Start, wanted: FloatArray, ratio: float, way: Way) -> Start:
    """Return inner unknowns, flank places (seen from the wheel) and deformations interpolated, others of the nearest position."""
    around, weights = way

    def at(values: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("wk,wk...->w...", weights, values[around]))

    inner = known.inner
    if inner is not None:
        nearest = np.take_along_axis(around, np.argmax(weights, axis=1)[:, None], axis=1)[:, 0]
        approach, inner = inner.approach, take_positions(inner.elsewhere, nearest)
        inner = inner if approach is None else replace(inner, approach=at(approach))
    return Start(
        parameter=at(known.parameter - angle[:, None] / ratio) + wanted[:, None] / ratio,
        share=at(known.share),
        inner=inner,
    )


def turned(pose: FloatArray, angle: FloatArray, coordinates: Coordinates) -> FloatArray:
    """Return poses whose displacements are turned by angles, rad; rotations stay."""
    found = pose.copy()
    for x in coordinates.displacements:
        place = (pose[:, x] + 1j * pose[:, x + 1]) * np.exp(1j * angle)
        found[:, x], found[:, x + 1] = place.real, place.imag
    return found
