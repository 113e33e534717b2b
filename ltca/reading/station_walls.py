r"""Walls of a disc between its stations: how they bend as beams, and what stations far apart miss of the load across them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


LARGEST_DISTANCE = 2.0 * float(np.pi) / float(np.log(3.0))
"""Spacing of stations by the thickness of the wall from which sums over them may miss all of the load across it."""


PER_STATION = 12
"""Points of a wall per station: a twelfth of their spacing apart they give the thickness of a thin wall to some per cent."""


def wall_bending(dataset: Labelled, stations: NDArray[np.integer]) -> FloatArray:
    r"""Return how much more the approach of stations may fall between patch and wider patch because their wall bends.

    A wall of thickness h and length L on simple supports has the moment :math:`FL/4` under a force F in its middle, and the
    curvature :math:`3FL/(Eh^3t)`; walls are held more firmly, and a ring of radius R
    has :math:`FR/\pi`. Spread over a patch of half-width b, and measured over it, the
    deflection is less by the curvature times :math:`b^2/4`, and from b to b′ the approach falls by

    .. math:: \frac{3\pi}{8} \frac{L}{h} \frac{b'^2 - b^2}{h^2}

    units of the near field :math:`2F/(\pi Et)` more.

    Parameters
    ----------
    dataset : Dataset
        Of coefficients.
    stations : array of int
        Which stations, those with a wider patch.

    Returns
    -------
    array, shape (stations,)
        Part of ln(b′/b); zero of bodies with one boundary.
    """
    boundary = dataset["station_boundary"].values
    points = dataset["station_x"].values + 1j * dataset["station_y"].values
    width, wider = dataset["station_half_width"].values[stations], dataset["wide_half_width"].values
    curves, thickness = _walls(boundary, points)
    found = np.zeros(len(stations))
    for place, station in enumerate(stations.tolist()):
        number = int(boundary[station])
        own, walls = curves[number], thickness[number]
        here = PER_STATION * int(np.count_nonzero(boundary[:station] == number))
        # As long as it is less than twice as thick, both ways.
        thin = np.roll(walls, -here) < 2.0 * walls[here]
        steps = np.roll(np.abs(own - np.roll(own, 1)), -here)
        forward, backward = int(np.argmin(thin)), int(np.argmin(thin[::-1]))
        length = float(steps[1:forward].sum() + steps[steps.size - backward :].sum())
        if thin.all():  # a ring has the moment FR/π
            length = 2.0 / np.pi**2 * float(steps.sum())
        if not (walls[here] > 0.0 and 0.0 < width[place] < wider[place]):
            continue  # other laws tell
        bent = (wider[place] ** 2 - width[place] ** 2) / walls[here] ** 2 * length / walls[here]
        found[place] = 3.0 * np.pi / 8.0 * bent / np.log(wider[place] / width[place])
    return np.where(np.isfinite(found), found, 0.0)


def missed_between_stations(boundary: NDArray[np.integer], points: ComplexArray) -> tuple[float, float, float]:
    r"""Return what sums over stations may miss of what crosses a wall, at worst, and the wall and distance where.

    A load on one side of a wall of thickness h is felt on the other over a length of about h: like :math:`1/(x^2 + h^2)`,
    with poles at :math:`\pm ih`. Of such a function a sum at places s apart is off by

    .. math:: \coth\frac{\pi h}{s} - 1 = \frac{2}{e^{2\pi h/s} - 1}

    of its integral at most (Trefethen and Weideman, SIAM Review 56, 2014, the trapezoidal rule): by 0.004 where stations are
    as far apart as the wall is thick, by all of it where they are `LARGEST_DISTANCE` times as far.

    Parameters
    ----------
    boundary : array of int, shape (stations,)
        The boundary of each station.
    points : array of complex, shape (stations,)
        Their places, mm.

    Returns
    -------
    missed : float
        Part of the integral; zero of bodies with one boundary.
    wall : float
        Thickness of the wall there, mm.
    distance : float
        From one station to the next there, mm.
    """
    curves, thickness = _walls(boundary, points)
    # From each station to the next one.
    apart = [np.abs(np.roll(curve, -1) - curve).reshape(-1, PER_STATION).sum(axis=1) for curve in curves.values()]
    walls = [np.minimum(own, np.roll(own, -1)).reshape(-1, PER_STATION).min(axis=1) for own in thickness.values()]
    wall, distance = np.concatenate(walls), np.concatenate(apart)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        missed = 2.0 / np.expm1(2.0 * np.pi * wall / distance)
    missed[~np.isfinite(missed)] = 0.0  # walls without thickness are left to other laws
    worst = int(np.argmax(missed))
    return float(missed[worst]), float(wall[worst]), float(distance[worst])


def _walls(
    boundary: NDArray[np.integer], points: ComplexArray
) -> tuple[dict[int, ComplexArray], dict[int, FloatArray]]:
    """Return points along each boundary, `PER_STATION` for each station, and their distance to the nearest other boundary,
    mm.
    """
    numbers = np.unique(boundary).tolist()
    curves = {number: _between(points[boundary == number]) for number in numbers}
    thickness = {
        number: np.min(
            [
                np.full(curves[number].size, np.inf),
                *(_clearance(curves[number], curves[one]) for one in numbers if one != number),
            ],
            axis=0,
        )
        for number in numbers
    }
    return curves, thickness


def _between(points: ComplexArray) -> ComplexArray:
    """Points of a wall between its stations, which are uniform in a parameter of period 2π, by Fourier series."""
    count = len(points)
    series, padded = np.fft.fft(points), np.zeros(PER_STATION * count, dtype=complex)
    order = np.rint(np.fft.fftfreq(count, 1.0 / count)).astype(int)
    padded[order] = series
    return np.asarray(PER_STATION * np.fft.ifft(padded))


def _clearance(points: ComplexArray, others: ComplexArray) -> FloatArray:
    """Distance of points from a closed line through others, mm."""
    from scipy.spatial import KDTree

    tree = KDTree(np.stack([others.real, others.imag], axis=1))
    nearest = tree.query(np.stack([points.real, points.imag], axis=1))[1]
    found = np.abs(points - others[nearest])
    for step in (-1, 1):
        side = others[(nearest + step) % len(others)] - others[nearest]
        along = ((points - others[nearest]) * side.conjugate()).real / np.maximum(np.abs(side) ** 2, 1e-300)
        found = np.minimum(found, np.abs(points - others[nearest] - along.clip(0.0, 1.0) * side))
    return np.asarray(found)
