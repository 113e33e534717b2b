"""Stations of a closed boundary, uniform in a parameter t of period 2π, and the interpolation between them.

On the flank of a disc of z teeth θ = t − (a/z) sin(z t), so that stations are closer in the roots, by 1 − a: Kepler's equation
for the anomalies E = z t and M = z θ (docs/theory/coefficients.md).
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
    """Stations of one closed boundary, the first at the parameter `offset`, rad; clustered by a and z of Kepler's equation."""

    first: int  # number of its first station in the matrix
    count: int
    offset: float = 0.0
    clustering: float = 0.0  # a, 0 for stations uniform in the parameter itself
    teeth: int = 1  # z

    def weights(self, parameter: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Return stations and weights of local Lagrange interpolation at parameters, shapes (…, 6)."""
        return _lagrange(self.uniform(parameter), np.asarray(self.first), np.asarray(self.count))

    def uniform(self, parameter: FloatArray) -> FloatArray:
        """Return the parameters in which the stations are uniform, the first of them at 0, rad."""
        return uniform_parameter(parameter - self.offset, self.teeth, self.clustering)

    def refined(self, values: FloatArray, times: int) -> FloatArray:
        """Refine values at all stations to `times` · count places of this boundary (`parameters`) by Fourier series."""
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
    """Return stations and weights at parameters, rad, on boundaries of these numbers, shapes (…, places, 6)."""
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
    """Return the boundaries by the ascending boundary number of each station; the first, the flank, clusters in its roots."""
    counts = np.bincount(numbers)
    firsts = (np.cumsum(counts) - counts).tolist()
    flank, *walls = (Boundary(first=first, count=count) for first, count in zip(firsts, counts.tolist(), strict=True))
    return (replace(flank, teeth=teeth, clustering=clustering), *walls)


def turned_boundaries(
    boundaries: tuple[Boundary, ...], *, bores: int, steps: int, pattern: int, flank_turn: float
) -> tuple[Boundary, ...]:
    """Return flank, bores and holes, in the order of the disc, of a part that stands turned by `steps` of 2π/`pattern` in it."""
    flank, *walls = boundaries
    found = [replace(flank, offset=flank.offset + flank_turn)]
    for circle in (walls[:bores], walls[bores:]):
        moved = [replace(wall, offset=wall.offset + 2.0 * np.pi * steps / pattern) for wall in circle]
        first = -(steps * len(circle) // pattern) % max(1, len(circle))
        found += moved[first:] + moved[:first]
    return tuple(found)
