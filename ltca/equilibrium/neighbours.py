"""Which positions of many are balanced first, and the poses of those between them: seen from the crank they hardly differ."""

from __future__ import annotations

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


def pose_between(angle: FloatArray, pose: FloatArray, wanted: FloatArray, coordinates: Coordinates) -> FloatArray:
    """Return poses at wanted crank angles between known ones, linearly as seen from the turning crank.

    Known angles, rad, may stand in any order; poses have the shape (positions, coordinates).

    Examples
    --------
    >>> known = np.array([[1.0, 0, 0, 0], [-1.0, 0, 0, 2]])
    >>> pose_between(np.array([0.0, np.pi]), known, np.array([0.5 * np.pi]), Coordinates()).round(9)
    array([[0., 1., 0., 1.]])
    """
    order = np.argsort(angle, kind="stable")
    seen = turned_poses(pose, -angle, coordinates)[order]
    between = np.stack([np.interp(wanted, angle[order], column) for column in seen.T], axis=1)
    return turned_poses(between, wanted, coordinates)


def start_between(angle: FloatArray, known: Start, wanted: FloatArray, ratio: float) -> Start:
    """Return inner unknowns between known ones: places on the flank in line as seen from the wheel, the rest likewise.

    Parameters
    ----------
    angle : array, shape (positions,)
        φ_C of the known poses, in any order, rad.
    known : Start
        Inner unknowns there.
    wanted : array
        φ_C of the poses to start at, rad.
    ratio : float
        u: a pin moves along the flank by φ_C/u.
    """
    order = np.argsort(angle, kind="stable")
    at = angle[order]
    behind = np.clip(np.searchsorted(at, wanted), 1, max(at.size - 1, 1))
    before, after = order[behind - 1], order[min(at.size - 1, 1) * behind]
    span = angle[after] - angle[before]
    part = np.clip((wanted - angle[before]) / np.where(span > 0.0, span, 1.0), 0.0, 1.0)[:, None]

    def between(values: FloatArray) -> FloatArray:
        return np.asarray(values[before] + part * (values[after] - values[before]))

    along = between(known.parameter - angle[:, None] / ratio) + wanted[:, None] / ratio
    nearer = np.where(part[:, 0] < 0.5, before, after)
    return Start(
        parameter=along,
        share=between(known.share),
        inner=take_positions(known.inner, nearer),
    )


def pose_beside(angle: FloatArray, pose: FloatArray, wanted: FloatArray, coordinates: Coordinates) -> FloatArray:
    """Return poses that look from the turning crank as others do: row by row, from `angle` turned to `wanted`."""
    return turned_poses(turned_poses(pose, -angle, coordinates), wanted, coordinates)


def start_beside(angle: FloatArray, known: Start, wanted: FloatArray, ratio: float) -> Start:
    """Return inner unknowns as seen from the wheel, row by row, from `angle` turned to `wanted`; see `start_between`."""
    along = (known.parameter - angle[:, None] / ratio) + wanted[:, None] / ratio
    return Start(parameter=along, share=known.share, inner=known.inner)


def turned_poses(pose: FloatArray, angle: FloatArray, coordinates: Coordinates) -> FloatArray:
    """Return poses whose displacements are turned by angles, rad; rotations stay.

    Parameters
    ----------
    pose : array, shape (positions, coordinates)
        q.
    angle : array, shape (positions,)
        rad.
    coordinates : Coordinates
        What they are made of.
    """
    turned = pose.copy()
    for x in coordinates.displacements:
        place = (pose[:, x] + 1j * pose[:, x + 1]) * np.exp(1j * angle)
        turned[:, x], turned[:, x + 1] = place.real, place.imag
    return turned
