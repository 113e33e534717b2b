r"""A round body held along an inner circle, loaded by a patch on its outer one: the closed form of wheel pins and races.

Plane elasticity in Kolosov's potentials (Muskhelishvili, *Some Basic Problems of the Mathematical Theory of Elasticity*,
§ 56–60): with :math:`\varphi = A \ln z + \sum a_n z^n` and :math:`\psi = -\kappa A \ln z + \sum b_n z^n` the harmonics
:math:`\pm m` of displacement and traction take four coefficients, which the held circle and the load give.
Beside it what a thin wall, as a beam, bends under a patch, and what stations far apart miss of what happens across it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr


# Harmonics times half-width over radius: what is left out falls with the cube, to 1e-6 of the patch's own.
RESOLUTION = 60.0
# Below, a patch on itself goes with the logarithm of its width and others do not feel it, but for (b/R)² of some 0.3.
NARROW = 0.01


# Distance of stations, by the thickness of the wall, from which sums over them may miss all of what crosses it.
LARGEST_DISTANCE = 2.0 * float(np.pi) / float(np.log(3.0))


def held_ring_approach(inner: float, outer: float, half_width: float, kolosov: float, angle: FloatArray) -> FloatArray:
    r"""Return approaches at angles from a loaded patch, as multiple of 2(1 − ν²)/(πEt).

    Load and measure are those of a coefficient file: a semi-elliptic pressure along the wall, in the direction of the
    normal at its middle, and the mean of the displacement with the same weights.

    Parameters
    ----------
    inner, outer : float
        Radii of the held and of the loaded circle, mm.
    half_width : float
        Of the patches, along the wall, mm.
    kolosov : float
        Kolosov's constant: 3 − 4ν in plane strain, (3 − ν)/(1 + ν) in plane stress.
    angle : array, shape (m,)
        Between load and place, rad.

    Returns
    -------
    array, shape (m,)
        Positive into the body.
    """
    width, ratio = max(half_width / outer, NARROW), inner / outer
    count = max(int(RESOLUTION / width), 64)
    order = np.arange(1, count + 1)
    weight = _weights(width, count + 2)
    # Everything in units of 1 N/mm, the outer radius and 2G; a newton pushes along −x at angle 0.
    load = -weight / (2.0 * np.pi)
    level = _level(ratio, kolosov, load[1])
    plus, minus = _harmonics(ratio, kolosov, order, load)
    seen = level * weight[1] + (np.cos(np.outer(angle, order)) @ (plus * weight[order + 1] + minus * weight[order - 1]))
    # Displacements over 2G, and the unit is (κ + 1)/(2π) over 2G for a newton each millimetre.
    narrower = np.where(np.abs(angle) < width, np.log(width * outer / half_width), 0.0)
    return np.asarray(narrower - seen * 2.0 * np.pi / (kolosov + 1.0))


def _weights(width: float, count: int) -> FloatArray:
    """Means of cos(kt) over a semi-elliptic patch, 2 J₁(kb)/(kb), for k = 0 … count."""
    from scipy.special import j1

    argument = width * np.arange(1, count + 1)
    return np.concatenate([[1.0], 2.0 * j1(argument) / argument])


def _level(ratio: float, kolosov: float, load: float) -> float:
    """Harmonic 0 of the displacement at the outer circle, which the load squeezes evenly."""
    # κ a r − a r − b/r = 0 where it is held, 2a + b = load outside.
    uniform = load / (2.0 + (kolosov - 1.0) * ratio**2)
    return uniform * (kolosov - 1.0) * (1.0 - ratio**2)


def _harmonics(
    ratio: float, kolosov: float, order: NDArray[np.int_], load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Harmonics +m and −m of the displacement at the outer circle."""
    m = order.astype(float)
    # Unknown: a of 1 + m and b of m − 1 by powers of the outer radius, a of 1 − m and b of −m − 1 by those of the inner.
    inside, nothing = ratio**m, np.zeros_like(m)
    held_plus = [kolosov * ratio * inside, nothing, m - 1.0, -np.ones_like(m)]
    held_minus = [-(1.0 + m) * ratio * inside, -inside / ratio, kolosov * np.ones_like(m), nothing]
    pulled_plus = [(1.0 + m) * (1.0 - m), 1.0 - m, (1.0 - m) * inside / ratio, nothing]
    pulled_minus = [1.0 + m, nothing, (1.0 - m) * (1.0 + m) * inside / ratio, (m + 1.0) * ratio * inside]
    moved_plus = [kolosov + nothing, nothing, (m - 1.0) * inside / ratio, -ratio * inside]
    moved_minus = [-(1.0 + m), nothing - 1.0, kolosov * inside / ratio, nothing]
    # Of the first harmonic two are others: in the place of a of 0 stands A ln z, in that of b of 0 a shift of the whole.
    for row, entry in (
        (held_plus, (kolosov * ratio**2, 0.0, -1.0, -1.0)),
        (held_minus, (-2.0 * ratio**2, 1.0, 2.0 * kolosov * np.log(ratio), 0.0)),
        (pulled_plus, (0.0, 0.0, 1.0 + kolosov, 0.0)),
        (pulled_minus, (2.0, 0.0, 2.0, 2.0 * ratio**2)),
        (moved_plus, (kolosov, 0.0, -1.0, -(ratio**2))),
        (moved_minus, (-2.0, 1.0, 0.0, 0.0)),
    ):
        for column, value in zip(row, entry, strict=True):
            column[0] = value
    rows = (held_plus, held_minus, pulled_plus, pulled_minus)
    system = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    # Tractions of harmonic k are those of the patch's weight of k − 1: its direction is that of its middle.
    right = np.stack([nothing, nothing, load[order - 1], load[order + 1]], axis=-1)
    found = np.linalg.solve(system, right[..., None])[..., 0]
    plus, minus = (np.sum(np.stack(row, axis=-1) * found, axis=-1) for row in (moved_plus, moved_minus))
    return plus, minus


PER_STATION = 12
"""Points of a wall for each station: a twelfth of their spacing apart they tell the thickness of a thin one to some per cent."""


def wall_bending(dataset: xr.Dataset, stations: NDArray[np.integer]) -> FloatArray:
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
    """Return points along each boundary, `PER_STATION` for each station, and how far the next boundary is from them, mm."""
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
