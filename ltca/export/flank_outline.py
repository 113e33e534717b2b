"""The flank of a part as it is made, and one periodic cubic spline through it.

The spline runs by chord length through points of the exact flank, closely enough that it departs from it by less than a fifth
of a micron everywhere; its control points and knots are what drawings and solids carry. A reader that fits a curve of its
own through points would be microns away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import ComplexArray, FloatArray
from ltca.errors import DriveError
from ltca.geometry.flank import FlankProfile

POINTS_PER_LOBE = 48
"""To start with: 0.11 µm off on the paper's drive."""
POINTS_PER_WAVE = 12
"""Of the highest harmonic of the flank, to start with: it is 0.02 % of its amplitude off."""
TOLERANCE = 2e-4
"""Departure of the spline from the exact flank at which no more points are put in, mm; a micron is promised."""
MOST_POINTS = 200_000
"""Points of one flank: beyond that no CAD system reads it in reasonable time."""
MOST_SPANS = 16
"""Of an arc of a flank in a solid: kernels integrate each face by a fixed rule. Volumes read 1e-6 wrong with them, 2e-4 wrong of
sharp lobes with arcs from root to tip."""
CHECKED_SHARES = np.array([0.25, 0.5, 0.75])
"""Places between two points of the spline where its departure is measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MadeFlank:
    """Flank of a part as it is made, in the frame of the disc.

    Attributes
    ----------
    profile : FlankProfile
        With both offsets, runout and deviation.
    inward : float
        By how much the flank is moved into the material along its own normal, mm.
    """

    profile: FlankProfile
    inward: float = 0.0

    @property
    def lobes(self) -> int:
        """How many lobes there are."""
        return round(self.profile.reduction_ratio) - 1

    def points(self, parameter: FloatArray) -> ComplexArray:
        """Return points at θ, mm."""
        found = self.profile.flank(parameter)
        return np.asarray(found - self.inward * self.profile.normal(parameter)) if self.inward else found

    def normals(self, parameter: FloatArray) -> ComplexArray:
        """Return unit normals out of the material at θ."""
        return self.profile.normal(parameter)

    def curvature(self, parameter: FloatArray) -> FloatArray:
        """Return the curvature at θ, 1/mm, positive where the disc is convex."""
        found = self.profile.curvature(parameter)
        return np.asarray(found / (1.0 - self.inward * found))

    def departure(self, points: ComplexArray, near: FloatArray) -> FloatArray:
        """Return how far complex points, mm, lie outside the flank along its normal, mm; `near` is θ near each, rad."""
        found = self.profile.nearest_point(points, near).parameter
        return self.profile.distance(points, found) + self.inward

    def start(self) -> FloatArray:
        """Return the parameters θ that a spline begins with, from 0, a multiple of the lobes, rad."""
        deviation = self.profile.deviation
        waves = 0 if deviation is None else max(deviation.orders, default=0)
        most = max(POINTS_PER_LOBE * self.lobes, POINTS_PER_WAVE * waves)
        each = 2 * int(np.ceil(0.5 * most / self.lobes))  # even: roots and tips are points
        even = np.arange(each * self.lobes) / (each * self.lobes)
        return np.asarray(2.0 * np.pi * even)

    def area(self) -> float:
        """Return the area inside the flank, mm², by Green's theorem: the trapezoidal rule is exact on closed curves."""
        count = 10 * self.start().size
        parameter = 2.0 * np.pi * np.arange(count) / count
        tangents = self.profile.flank_tangent(parameter) * (1.0 - self.inward * self.profile.curvature(parameter))
        return float(np.pi * np.mean((self.points(parameter).conjugate() * tangents).imag))


@dataclass(frozen=True, slots=True, kw_only=True)
class ClampedSpline:
    """A cubic B-spline whose knots are fourfold at its ends.

    Attributes
    ----------
    knots : array, shape (n + 4,)
        mm along the chords.
    control_points : array of complex, shape (n,)
        mm.
    """

    knots: FloatArray
    control_points: ComplexArray


@dataclass(frozen=True, slots=True, kw_only=True)
class FlankSpline:
    """A closed cubic spline, twice continuously differentiable everywhere.

    Attributes
    ----------
    flank : MadeFlank
        What it follows.
    parameter : array, shape (n,)
        θ of its points, ascending from 0, rad.
    knots : array, shape (n + 1,)
        Chord length at each point and of the whole turn, mm.
    pieces : array of complex, shape (4, n)
        Powers 3 … 0 of the distance from the knot before.
    centre : complex
        Where the origin of the flank's frame stands, mm.
    """

    flank: MadeFlank
    parameter: FloatArray
    knots: FloatArray
    pieces: ComplexArray
    centre: complex = 0j

    @property
    def points(self) -> ComplexArray:
        """Points it runs through, mm."""
        return np.asarray(self.pieces[3])

    def placed(self, centre: complex) -> FlankSpline:
        """Return it with the origin of its frame elsewhere."""
        moved = self.pieces.copy()
        moved[3] += centre - self.centre
        return replace(self, pieces=moved, centre=centre)

    def along(self, flank: MadeFlank) -> FlankSpline:
        """Return one in the same place through points of a flank that is nearly this one, at the same parameters and knots."""
        return _through(flank, self.parameter, self.knots).placed(self.centre)

    def values(self, piece: NDArray[np.intp], share: FloatArray) -> ComplexArray:
        """Return points of pieces, at shares of their lengths from 0 to 1."""
        t = share * np.diff(self.knots)[piece]
        c3, c2, c1, c0 = self.pieces[:, piece]
        return np.asarray(c0 + t * (c1 + t * (c2 + t * c3)))

    def clamped(self) -> ClampedSpline:
        """Return the whole turn as one B-spline, whose last control point is its first, to the last bit."""
        return self._between(0, self.parameter.size)

    def arcs(self) -> tuple[ClampedSpline, ...]:
        """Return the same curve in arcs of at most `MOST_SPANS` spans, cut at roots and tips as well; neighbours share their
        end points to the last bit.
        """
        count = 2 * self.flank.lobes
        halves = np.searchsorted(self.parameter, 2.0 * np.pi * (np.arange(count) - 1e-9) / count).tolist()
        cuts: list[int] = []
        for first, last in pairwise([*halves, self.parameter.size]):
            parts = -(-(last - first) // MOST_SPANS)
            cuts += [first + (last - first) * part // parts for part in range(parts)]
        return tuple(self._between(first, last) for first, last in pairwise([*cuts, self.parameter.size]))

    def _between(self, first: int, last: int) -> ClampedSpline:
        """The pieces from one to before another, by blossoming: control point i is the polar form at knots i + 1 … i + 3."""
        inside = self.knots[first : last + 1]
        knots = np.concatenate([inside[:1].repeat(3), inside, inside[-1:].repeat(3)])
        count = knots.size - 4
        piece = np.clip(np.arange(count) - 1, 0, last - first - 1) + first
        start = self.knots[piece]
        u, v, w = (knots[k : k + count] - start for k in (1, 2, 3))
        c3, c2, c1, c0 = self.pieces[:, piece]
        control = c0 + c1 * (u + v + w) / 3.0 + c2 * (u * v + v * w + w * u) / 3.0 + c3 * u * v * w
        control[-1] = self.points[last % self.parameter.size]
        return ClampedSpline(knots=knots, control_points=control)


def follow_flank(flank: MadeFlank) -> FlankSpline:
    """Return a spline that departs from a flank by less than `TOLERANCE`, wherever it is compared.

    Raises `DriveError` when that takes more than `MOST_POINTS` points.
    """
    parameter = flank.start()
    while parameter.size <= MOST_POINTS:
        spline = _through(flank, parameter)
        coarse = np.max(np.abs(departures(spline)), axis=0) > TOLERANCE
        if not coarse.any():
            return spline
        ends = np.append(parameter[1:], 2.0 * np.pi)
        parameter = np.sort(np.append(parameter, 0.5 * (parameter + ends)[coarse]))
    raise DriveError(
        [f"disc.profile_errors: the flank needs more than {MOST_POINTS} points to be followed within {TOLERANCE:g} mm"]
    )


def departures(spline: FlankSpline, places: FloatArray = CHECKED_SHARES) -> FloatArray:
    """Return how far a spline lies outside the exact flank between its points, mm, of shape (k, n), piece by piece.

    `places`, of shape (k,), are shares of each piece at which it is compared, from 0 to 1.
    """
    piece = np.arange(spline.parameter.size)
    ends = np.append(spline.parameter[1:], 2.0 * np.pi)
    rows = [
        spline.flank.departure(
            spline.values(piece, np.full(piece.size, share)) - spline.centre,
            spline.parameter + share * (ends - spline.parameter),
        )
        for share in places.tolist()
    ]
    return np.array(rows)


def _through(flank: MadeFlank, parameter: FloatArray, knots: FloatArray | None = None) -> FlankSpline:
    """The periodic cubic spline by chord length, or with knots given, through the points at θ."""
    from scipy.interpolate import CubicSpline  # 0.1 s to import

    points = flank.points(parameter)
    closed = np.append(points, points[0])
    if knots is None:
        knots = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
    both = CubicSpline(knots, np.column_stack([closed.real, closed.imag]), bc_type="periodic").c
    return FlankSpline(flank=flank, parameter=parameter, knots=knots, pieces=both[..., 0] + 1j * both[..., 1])
