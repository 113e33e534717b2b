"""Measured points as the deviation of a flank from its design along the design normal, over θ.

Every point lies on one normal of the design: the foot of that normal gives θ, the distance along it the deviation. So the
flank of the analysis passes through every measured point, whatever runout the drive has.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray
from ltca.drive.deviations import ProfileErrors
from ltca.drive.parts import Drive
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.flank import FlankProfile
from ltca.reading.disc_checks import deviation_bound
from ltca.reading.measured.points import MeasuredPoints

LEAST_PER_LOBE = 4
"""Least number of points per lobe, to distinguish a lobe from a circle."""
TABLE_PER_LOBE = 128
"""Places of the flank per lobe from which the nearest one is searched."""
SAME_PLACE = 1e-9
"""Difference of θ up to which two points are one place, rad: the first point of a turn is often repeated as its last."""
SAME_DEVIATION = 1e-3
"""Largest accepted difference of two measurements of one place, mm."""
ALONG_NORMAL = 0.5
"""Least cosine between a measured normal and that of the flank: 60°."""
INCH = 25.4


def measured_errors(single: Drive, measured: MeasuredPoints) -> ProfileErrors:
    """Return the deviation of the flank of a drive of one disc, at 20 °C, from measured points.

    The flank is that of the design, with both offsets, runout and the turn of its phase; the points are in the frame of the
    disc: centre of the bore at the origin, hole 0 on +x. DriveError when they are too few or leave out more than a lobe,
    lie far off the flank, or contradict each other.
    """
    errors = single.disc.profile_errors
    profile = FlankProfile.of_drive(replace(single, disc=replace(single.disc, profile_errors=ProfileErrors())))
    lobes = round(profile.reduction_ratio) - 1
    least = LEAST_PER_LOBE * lobes
    if measured.points.size < least:
        told = f"holds {measured.points.size} points: must be at least {least}, {LEAST_PER_LOBE} a lobe"
        raise DriveError([told], measured.source)
    theta, deviation = _feet(profile, lobes, measured, deviation_bound(single))
    order = np.argsort(theta, kind="stable")
    theta, deviation, lines = theta[order], deviation[order], measured.lines[order]
    theta, deviation = _each_once(theta, deviation, lines, measured.source)
    _require_all_around(theta, lobes, measured.source)
    return replace(errors, parameter=tuple(theta.tolist()), deviation=tuple(deviation.tolist()))


def _feet(profile: FlankProfile, lobes: int, measured: MeasuredPoints, bound: float) -> tuple[FloatArray, FloatArray]:
    """θ in [0, 2π) and the deviation of every point."""
    from scipy.spatial import cKDTree  # 0.1 s to import

    table = np.linspace(0.0, 2.0 * pi, TABLE_PER_LOBE * lobes, endpoint=False)
    known, points = profile.flank(table), measured.points
    away, nearest = cKDTree(np.column_stack([known.real, known.imag])).query(
        np.column_stack([points.real, points.imag])
    )
    # Half a step of the table may lie between a point and its foot.
    _require_near(away - 0.6 * float(np.max(np.abs(np.diff(known)))), bound, known, measured)
    try:
        found = profile.nearest_point(points, table[nearest]).parameter
    except ConvergenceError as error:
        raise DriveError(
            ["points have no place on the flank: they lie beyond its centres of curvature"], measured.source
        ) from error
    deviation = profile.distance(points, found)
    _require_near(np.abs(deviation), bound, known, measured)
    if measured.normals is not None:
        _require_outward(profile.normal(found), measured)
    theta = np.mod(found, 2.0 * pi)
    return np.where(theta >= 2.0 * pi, 0.0, theta), deviation


def _require_near(away: FloatArray, bound: float, flank: NDArray[np.complex128], measured: MeasuredPoints) -> None:
    """Refuse points in another frame or unit."""
    worst = int(np.argmax(away))
    if away[worst] <= bound:
        return
    size = float(np.mean(np.abs(measured.points)) / np.mean(np.abs(flank)))
    units = {
        1.0 / INCH: "inches",
        1e-3: "metres",
        1e3: "micrometres",
        10.0: "tenths of a millimetre",
        0.1: "centimetres",
    }
    like = [unit for ratio, unit in units.items() if abs(size / ratio - 1.0) < 0.05]
    hint = (
        f"they look like {like[0]}, mm are read"
        if like
        else "the frame is that of the disc, centre of the bore at the origin and hole 0 on +x, as `cyclo export` writes it"
    )
    point = measured.points[worst]
    raise DriveError(
        [
            f"line {measured.lines[worst]}: the point ({point.real:g}, {point.imag:g}) mm lies {away[worst]:.3g} mm off the "
            f"flank, must be at most {bound:g} mm, a tenth of the smallest pin or roller radius; {hint}"
        ],
        measured.source,
    )


def _require_outward(normals: NDArray[np.complex128], measured: MeasuredPoints) -> None:
    given = measured.normals
    assert given is not None
    sizes = np.abs(given)
    along = (given * normals.conjugate()).real / np.where(sizes > 0.0, sizes, 1.0)
    worst = int(np.argmin(along))
    if along[worst] < ALONG_NORMAL:
        told = f"({given[worst].real:g}, {given[worst].imag:g})"
        raise DriveError(
            [
                f"line {measured.lines[worst]}: the normal {told} is more than 60° off that of the flank there, which points out "
                "of the disc"
            ],
            measured.source,
        )


def _each_once(
    theta: FloatArray, deviation: FloatArray, lines: NDArray[np.int64], source: str
) -> tuple[FloatArray, FloatArray]:
    """Leave out repeated places, also across θ = 0."""
    after = np.append(theta[1:], theta[0] + 2.0 * pi)
    repeated = after - theta < SAME_PLACE
    apart = np.abs(np.roll(deviation, -1) - deviation)
    worst = int(np.argmax(np.where(repeated, apart, 0.0)))
    if repeated[worst] and apart[worst] > SAME_DEVIATION:
        other = lines[(worst + 1) % lines.size]
        raise DriveError(
            [f"lines {lines[worst]} and {other} are one place of the flank and differ by {apart[worst]:.3g} mm there"],
            source,
        )
    return theta[~repeated], deviation[~repeated]


def _require_all_around(theta: FloatArray, lobes: int, source: str) -> None:
    gaps = np.diff(np.append(theta, theta[0] + 2.0 * pi))
    widest = int(np.argmax(gaps))
    if gaps[widest] > 2.0 * pi / lobes:
        raise DriveError(
            [
                f"no points between θ = {theta[widest]:.4g} and {theta[widest] + gaps[widest]:.4g} rad: a gap must be less than "
                f"{2.0 * pi / lobes:.4g} rad, a lobe; the whole flank must be measured"
            ],
            source,
        )
