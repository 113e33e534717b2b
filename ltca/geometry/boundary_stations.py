r"""Stations of a closed boundary, uniform in a periodic parameter, and the interpolation between them.

Along the flank of a disc of :math:`z` teeth what is interpolated changes fastest in the roots, :math:`\theta = 2\pi k/z`.
There the stations stand closer: they are uniform in a parameter :math:`t` with

.. math:: \theta = t - \frac{a}{z} \sin(z t), \qquad 0 \le a < 1,

so that their distance is :math:`1 - a` of the mean one in the roots and :math:`1 + a` of it at the tips. This is Kepler's
equation for the anomalies :math:`E = z t` and :math:`M = z \theta`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray

LAGRANGE_POINTS = 6
HALLEY_STEPS = 3
"""Iterations of Kepler's equation: up to a = 0.8 two leave 1e-8 of the anomaly; three leave its rounding up to 0.97 (6e-13)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Boundary:
    """Stations of one closed boundary, uniform in a parameter of period 2π, rad.

    It has `count` stations from the number `first` of the matrix on, the first of them at the parameter `offset`, rad;
    `clustering` is a of the equation above, 0 for stations uniform in the parameter itself, and `teeth` is z.
    """

    first: int
    count: int
    offset: float = 0.0
    clustering: float = 0.0
    teeth: int = 1

    def weights(self, parameter: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Return stations and weights of local Lagrange interpolation at parameters, shapes (…, 6)."""
        return _lagrange(self.uniform(parameter), np.asarray(self.first), np.asarray(self.count))

    def uniform(self, parameter: FloatArray) -> FloatArray:
        """Return the parameters in which the stations are uniform, the first of them at 0, rad."""
        return uniform_parameter(parameter - self.offset, self.teeth, self.clustering)

    def refined(self, values: FloatArray, times: int) -> FloatArray:
        """Return values at `times` as many places (`parameters`), by Fourier series, shape (…, times · count).

        `values` are those at the stations of all boundaries, shape (…, all stations); every `times`-th place is a station.
        """
        spectrum = np.fft.rfft(values[..., self.first : self.first + self.count], axis=-1)
        if self.count % 2 == 0 and times > 1:
            # With an even number of stations the highest order contains both signs.
            spectrum[..., -1] *= 0.5
        return np.asarray(np.fft.irfft(spectrum, n=times * self.count, axis=-1) * times)

    def parameters(self, times: int = 1) -> FloatArray:
        """Return the parameters of the places of `refined`, rad."""
        uniform = 2.0 * np.pi * np.arange(times * self.count) / (times * self.count)
        return self.offset + clustered_parameter(uniform, self.teeth, self.clustering)


def clustered_parameter(uniform: FloatArray, teeth: int, clustering: float) -> FloatArray:
    """Return θ = t − (a/z) sin(z t) of uniform parameters t, rad."""
    return uniform - clustering / teeth * np.sin(teeth * uniform) if clustering else uniform


def uniform_parameter(parameter: FloatArray, teeth: int, clustering: float) -> FloatArray:
    """Return t of parameters θ, the inverse of `clustered_parameter`, rad.

    Examples
    --------
    >>> theta = clustered_parameter(np.array([0.1, 3.0]), 13, 0.6)
    >>> uniform_parameter(theta, 13, 0.6)
    array([0.1, 3. ])
    """
    if not clustering:
        return parameter
    mean = teeth * parameter
    sine, cosine = np.sin(mean), np.cos(mean)
    # t − θ by Halley's iteration from the series about small a, summed.
    beyond = clustering * sine / np.sqrt(1.0 - 2.0 * clustering * cosine + clustering**2)
    for _ in range(HALLEY_STEPS):
        sine, cosine = clustering * np.sin(mean + beyond), clustering * np.cos(mean + beyond)
        residual, slope = beyond - sine, 1.0 - cosine
        beyond = beyond - residual * slope / (slope**2 - 0.5 * residual * sine)
    return parameter + beyond / teeth


def weights_of(
    boundaries: Sequence[Boundary], number: NDArray[np.integer], parameter: FloatArray
) -> tuple[NDArray[np.intp], FloatArray]:
    """Return stations and weights of places on several boundaries, shapes (…, places, 6).

    `number` has the number of the boundary of each place, `parameter` the parameters, rad, both of the shape (…, places).
    """
    first, count, offset = (
        np.array([getattr(own, name) for own in boundaries])[number] for name in ("first", "count", "offset")
    )
    uniform = parameter - offset
    for own, boundary in enumerate(boundaries):
        if boundary.clustering:
            there = number == own
            uniform[there] = boundary.uniform(parameter[there])
    return _lagrange(uniform, first, count)


_NODES = np.arange(LAGRANGE_POINTS) - (LAGRANGE_POINTS // 2 - 1)
_SCALES = np.array([1.0 / np.prod([float(node - other) for other in _NODES if other != node]) for node in _NODES])


def _lagrange(
    parameter: FloatArray, first: NDArray[np.intp], count: NDArray[np.intp]
) -> tuple[NDArray[np.intp], FloatArray]:
    """Stations and weights on boundaries that begin at `first` and have `count` stations each."""
    place = np.mod(parameter, 2.0 * np.pi) * (count / (2.0 * np.pi))
    cell = np.floor(place)
    local = place - cell
    weights = np.empty((*place.shape, LAGRANGE_POINTS))
    # The product over all other nodes is that over the nodes before times that over the nodes after.
    before = np.ones_like(local)
    for number, node in enumerate(_NODES):
        weights[..., number] = before * _SCALES[number]
        before = before * (local - node)
    after = np.ones_like(local)
    for number, node in reversed(list(enumerate(_NODES))):
        weights[..., number] *= after
        after = after * (local - node)
    stations = np.mod(cell.astype(np.intp)[..., None] + _NODES, count[..., None]) + first[..., None]
    return stations, weights


def boundaries_of(numbers: NDArray[np.integer], teeth: int = 1, clustering: float = 0.0) -> tuple[Boundary, ...]:
    """Return the boundaries of stations from the number of the boundary of each station, from 0 and ascending.

    Those of the first boundary, the flank, cluster about the roots of its teeth.

    Examples
    --------
    >>> [(own.first, own.count) for own in boundaries_of(np.array([0, 0, 0, 1, 1]))]
    [(0, 3), (3, 2)]
    """
    counts = np.bincount(numbers)
    firsts = (np.cumsum(counts) - counts).tolist()
    flank, *walls = (Boundary(first=first, count=count) for first, count in zip(firsts, counts.tolist(), strict=True))
    return (replace(flank, teeth=teeth, clustering=clustering), *walls)


def turned_boundaries(
    boundaries: tuple[Boundary, ...], *, bores: int, steps: int, pattern: int, flank_turn: float
) -> tuple[Boundary, ...]:
    """Return flank, bores and holes of a part that stands turned in its disc, in the order of the disc.

    The part is turned by `steps` of ``2π/pattern``, of which bores and holes are whole numbers apart; `bores` is the number of
    bores among `boundaries`, and `flank_turn` the parameter of the disc's flank at which that of the part begins, rad.
    """
    flank, *walls = boundaries
    found = [replace(flank, offset=flank.offset + flank_turn)]
    for circle in (walls[:bores], walls[bores:]):
        moved = [replace(wall, offset=wall.offset + 2.0 * np.pi * steps / pattern) for wall in circle]
        first = -(steps * len(circle) // pattern) % max(1, len(circle))
        found += moved[first:] + moved[:first]
    return tuple(found)
