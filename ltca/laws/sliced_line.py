r"""Line contacts in slices along their width: load and moment by approach and tilt, for any lead and profile.

A line of the length L is cut into n slices of the length l = L/n. Slice i carries F_i, evenly along l. Its surfaces approach by
:math:`\delta + \theta z - h(z)` at the height z, less :math:`u_i(F)`, what all slices press in together beyond what the slice
does as plane strain counts it:

.. math::
    F_i = \int_l q(\delta + \theta z - h(z) - u_i)\,dz, \qquad
    u_i = \frac{\partial V}{\partial F_i}, \qquad
    V = \frac{1}{2 \pi E^* l} \sum_{ij} a_{|i-j|}(b/l) F_i F_j .

q is the line load of plane strain with the datum D (`ltca.laws.plane_strain`), :math:`\delta = (2 q/\pi E^*)(\ln(2D/b) + 1/2)`
with the half-width b of the line load itself; a lag's coefficient :math:`a_k` is the integral of Boussinesq's kernel over two
strips l long and as wide as the contact of the mean line load (Love; `ltca.contact.influence`), and of a slice on itself less
what q counts of it. Strips are as wide as makes their own energy that of the semi-elliptic pressure. The mean line load
:math:`\sum F^2/(l \sum F)` moves with the loads, and V knows it: loads, moment and energy belong to one potential,

.. math:: E = \sum \int \varphi(\delta + \theta z - h - u_i)\,dz + \sum F_i u_i - V, \qquad \varphi' = q .

Slices are integrated at `POINTS` points each, so that a contact that ends within a slice moves on smoothly. Where the ends of
the line carry, pressure bulges there within some half-widths: the end slices are softer in V by :math:`\varepsilon(b/l)`,
tabulated once so that an aligned straight line has the load of `ltca.laws.line_contact`. A line of one slice is that law itself
and not made here. ``docs/theory/width.md`` has the sources and the measured errors.

Newton's method on the loads squares what is left over: its last step is taken along the slopes without another evaluation, to
round-off.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, by_drive
from ltca.contact.influence import lagged_influence
from ltca.errors import ConvergenceError
from ltca.laws.backed import HALF_SPACE_DATUM, MAX_OVERLAP, OVERLAP_SHARPNESS
from ltca.laws.slenderness_curve import SlendernessCurve, quintic_spline_pieces

POINTS = 4
"""Points of a slice at which its surfaces' approach is taken (Gauss)."""
STRIP = float(np.exp(1.25 - np.log(4.0)))
"""Half-width of an evenly pressed strip by that of a semi-elliptic one of the same energy: ⟨−ln|x − x′|⟩ = 3/2 − ln 2b of the
strip, 1/4 − ln(b/2) of the semi-ellipse."""
DATUM = 4.0
"""Datum of the plane law by the length of the line; what it is makes no difference but to slices that carry unevenly."""
SLEEVE_DATUM = 0.685
"""The same of a sleeve's part, whose slices do not feel each other: as deep as an aligned line counts at usual loads."""
MAX_ITERATIONS = 60
NEAR = 1e-8
"""What may be left over of a slice's load, by the largest, before the last step, which squares it."""
ROUND_OFF = 1e-13
"""What is left over by round-off alone."""
NARROWEST, WIDEST = 1e-4, 40.0
"""Half-width by the length of a slice at the ends of the tables."""
TOUCHING = 1e-16
"""Deepest approach by the length up to which a contact is open: less is round-off of where parts stand."""
_KNOTS = 81
_LIGHTEST, _HEAVIEST, _PLANE_KNOTS = -46.0, -0.3, 4097
_NODES, _SHARES = np.polynomial.legendre.leggauss(8)
TABLE = Path(__file__).with_name("sliced_line.json")


@cache
def slice_heights(length: float, slices: int) -> FloatArray:
    """Return z of the points of the slices of a line of a length in mm, shape (slices, points)."""
    middle = (np.arange(slices) - 0.5 * (slices - 1)) * length / slices
    return np.asarray(middle[:, None] + 0.5 * length / slices * np.polynomial.legendre.leggauss(POINTS)[0])


@cache
def plane_curve() -> SlendernessCurve:
    """Return w = X/Q over ln X, of the plane law with X = 2 δ ρ/D² and Q = (b/D)²: X = Q (ln(4/Q) + 1)/2."""
    places = np.linspace(_LIGHTEST, _HEAVIEST, 129)
    return SlendernessCurve.through(places, np.exp(places) / _plane_square(places), 0.5)


def _plane_square(place: FloatArray) -> FloatArray:
    """Q at ln X."""
    square = np.exp(place) / 3.0
    for _ in range(100):
        square = np.exp(place) / (0.5 * (np.log(4.0 / square) + 1.0))
    for _ in range(3):
        slope = 0.5 * np.log(4.0 / square)
        square = square - (square * (slope + 0.5) - np.exp(place)) / slope
    return np.asarray(square)


@cache
def _plane_pieces() -> FloatArray:
    """Cubic pieces of w over ln X from its values and slopes, as close to it as round-off of loads lets them matter."""
    places = np.linspace(_LIGHTEST, _HEAVIEST, _PLANE_KNOTS)
    square = _plane_square(places)
    value = 0.5 * (np.log(4.0 / square) + 1.0)
    slope = -0.5 * value / (value - 0.5) * (places[1] - places[0])
    before, after, rise = slope[:-1], slope[1:], np.diff(value)
    return np.stack((value[:-1], before, 3.0 * rise - 2.0 * before - after, before + after - 2.0 * rise))


def _inverse_of_plane_load(place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """w at ln X and its derivative."""
    per_knot = (_PLANE_KNOTS - 1) / (_HEAVIEST - _LIGHTEST)
    beyond = (place < _LIGHTEST) | (place >= _HEAVIEST)
    any_beyond = beyond.any()
    at = (place - _LIGHTEST) * per_knot
    piece = np.where(beyond, 0.0, at).astype(np.intp) if any_beyond else at.astype(np.intp)
    t = at - piece
    c0, c1, c2, c3 = _plane_pieces().take(piece, axis=1)
    value, slope = c0 + t * (c1 + t * (c2 + t * c3)), (c1 + t * (2.0 * c2 + (3.0 * t) * c3)) * per_knot
    if any_beyond:
        value[beyond], slope[beyond], _ = plane_curve().value_and_derivatives(place[beyond])
    return value, slope


@cache
def _lags(slices: int) -> FloatArray:
    """Pieces of a_k over ln(b/l), k = 0 … n − 1, without the softer ends, shape (6, slices, pieces)."""
    found = np.empty((_KNOTS, slices))
    for row, place in zip(found, places(), strict=True):
        width = 2.0 * STRIP * float(np.exp(place))
        row[:] = lagged_influence(width, 1, np.arange(slices + 1.0), mirrored=False)[0, 0] / width**2
    # What plane strain counts of a strip, its datum at the length of a slice.
    found[:, 0] -= 2.0 * (1.5 - np.log(2.0 * STRIP) - places())
    return np.stack([quintic_spline_pieces(column) for column in found.T], axis=1)


def places() -> FloatArray:
    """Return the knots of the tables, ln(b/l)."""
    return np.linspace(np.log(NARROWEST), np.log(WIDEST), _KNOTS)


@cache
def softer_ends() -> FloatArray:
    """Return pieces of ε over ln(b/l) that ship with the package, shape (6, pieces)."""
    return quintic_spline_pieces(np.array(json.loads(TABLE.read_text(encoding="utf-8"))["softer"]))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedContact:
    """Contacts in slices at some approaches and tilts, zero where open.

    Attributes
    ----------
    load, moment : array, shape (…)
        Σ F and Σ ∫ q z dz, N and N·mm: moments turn positive z into the other body.
    by_approach, by_tilt, moment_by_tilt : array, shape (…)
        ∂F/∂δ, ∂F/∂θ = ∂M/∂δ and ∂M/∂θ, N/mm, N/rad and N·mm/rad.
    energy : array, shape (…)
        E, N·mm.
    slice_load : array, shape (…, slices)
        F_i, N.
    line_load : array, shape (…, slices, points)
        q at the points of the slices, N/mm.
    slice_slopes : array, shape (…, 2, slices), or None
        ∂F_i/∂δ and ∂F_i/∂θ, N/mm and N/rad, where slices feel each other.
    """

    load: FloatArray
    moment: FloatArray
    by_approach: FloatArray
    by_tilt: FloatArray
    moment_by_tilt: FloatArray
    energy: FloatArray
    slice_load: FloatArray
    line_load: FloatArray
    slice_slopes: FloatArray | None = None

    def take(self, rows: NDArray[np.intp]) -> SlicedContact:
        """Return some of a row of contacts."""
        return SlicedContact(**{name: values[rows] for name, values in self._arrays()})

    def put(self, rows: NDArray[np.intp], part: SlicedContact) -> None:
        """Write what some of a row of contacts are now."""
        for name, values in self._arrays():
            values[rows] = getattr(part, name)

    def ahead(self, approach: FloatArray, tilt: FloatArray) -> FloatArray:
        """Return loads of the slices to start from where approaches and tilts are so much larger, shape (…, slices)."""
        if self.slice_slopes is None:
            return self.slice_load
        moved = approach[..., None] * self.slice_slopes[..., 0, :] + tilt[..., None] * self.slice_slopes[..., 1, :]
        # Slopes tell nothing beyond a change of the loads themselves.
        near = (np.abs(moved) < 0.3 * self.slice_load.max(axis=-1, keepdims=True)).all(axis=-1, keepdims=True)
        return np.asarray(np.where(near, np.maximum(self.slice_load + moved, 0.0), self.slice_load))

    def _arrays(self) -> list[tuple[str, FloatArray]]:
        return [(name, values) for name in self.__slots__ if (values := getattr(self, name)) is not None]


@cache
def _bends(slices: int) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
    """Rows, columns and values of D′D of second differences, where they are not zero."""
    differences = np.diff(np.eye(slices), 2, axis=0)
    product = differences.T @ differences
    rows, columns = np.nonzero(product)
    return rows, columns, product[rows, columns]


@cache
def _weights(length: float, slices: int) -> FloatArray:
    """Weights of the points of a slice of a line of a length in mm, shape (points, 1)."""
    return np.asarray(0.5 * length / slices * np.polynomial.legendre.leggauss(POINTS)[1][:, None])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Coupling:
    """What the slices of contacts press in together, V, at some loads; contacts come last.

    The second derivative is ``scale`` times that of the lags, the softer ends and the smoothing at a held width, with
    ``diagonal`` added on the diagonal and ``across grow' + grow across'`` everywhere, by which the width follows the loads.
    """

    energy: FloatArray
    pressed_in: FloatArray
    scale: float
    lags: FloatArray
    ends: FloatArray
    smooth: FloatArray
    diagonal: FloatArray
    across: FloatArray
    grow: FloatArray

    def by_load(self) -> FloatArray:
        """Return ∂u/∂F, shape (slices, slices, contacts)."""
        n = self.grow.shape[0]
        found = self.across[:, None] * self.grow
        found += found.swapaxes(0, 1).copy()
        found += self.lags[np.abs(np.arange(n)[:, None] - np.arange(n))]
        rows, columns, bends = _bends(n)
        found[rows, columns] += bends[:, None] * self.smooth
        found[np.arange(n), np.arange(n)] += self.diagonal
        found[0, 0] -= self.ends
        found[-1, -1] -= self.ends
        return np.asarray(self.scale * found)


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedLine:
    """Law of line contacts of one length and modulus in slices.

    Parameters
    ----------
    length : float
        L, mm.
    contact_modulus : float
        E*, MPa.
    slices : int
        n, at least 3.
    relief : array, shape (slices, points)
        h, mm: by how much lead and profile fall short at the points (`slice_heights`).
    sleeve : float
        Part of the compliance that is a sleeve's, whose slices do not feel each other: its wall is thinner than they are long.
    overlap : float
        Compliance of the whole line that the law of that sleeve has as well, mm/N (`ltca.laws.backed.BackedLaw`).
    ends : array, shape (6, pieces), optional
        By how much end slices are softer, ε over ln(b/l); default `softer_ends`.
    """

    length: float
    contact_modulus: float
    slices: int
    relief: FloatArray = by_drive(2)
    sleeve: float = 0.0
    overlap: float = 0.0
    ends: FloatArray = field(default_factory=softer_ends)

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives.

        Parameters
        ----------
        approach, tilt, effective_radius : array, shape (…)
            δ in the middle, mm; θ, rad, positive presses positive z; ρ, mm.
        start : array, shape (…, slices), optional
            Loads of the slices nearby, N.

        Raises
        ------
        ConvergenceError
            When loads do not settle.
        """
        given = (np.asarray(each, dtype=float) for each in (approach, tilt, effective_radius))
        delta, theta, radius = np.broadcast_arrays(*given)
        shape, z = delta.shape, slice_heights(self.length, self.slices)
        relief = self.relief
        if relief.ndim > z.ndim:  # of several drives, the first axis of the approaches
            relief = relief.reshape(-1, *(1,) * (delta.ndim - 1), *z.shape)
        free = (delta[..., None, None] + theta[..., None, None] * z - relief).reshape(-1, *z.shape)
        closed = np.flatnonzero((free > TOUCHING * self.length).any(axis=(1, 2)))
        begin = None if start is None else start.reshape(-1, self.slices)[closed].T
        # Contacts come last: every step is one on arrays over them.
        found = self._closed(np.ascontiguousarray(free[closed].transpose(1, 2, 0)), radius.reshape(-1)[closed], begin)
        whole = []
        for values in found:
            full = np.zeros((delta.size, *values.shape[:-1]))
            full[closed] = np.moveaxis(values, -1, 0)
            whole.append(full.reshape((*shape, *values.shape[:-1])))
        return SlicedContact(**dict(zip(SlicedContact.__slots__, whole, strict=True)))

    def _line_load(
        self, approach: FloatArray, effective_radius: FloatArray, datum: float
    ) -> tuple[FloatArray, FloatArray]:
        """q and dq/dδ of the plane law, zero where open, shape (slices, points, contacts)."""
        load, slope = np.zeros(approach.shape), np.zeros(approach.shape)
        pressed = approach > 0.0
        radius = np.broadcast_to(effective_radius, approach.shape)[pressed]
        scaled = (2.0 / datum**2) * approach[pressed] * radius
        w, first = _inverse_of_plane_load(np.log(scaled))
        inverse = (np.pi * self.contact_modulus) / w
        load[pressed] = (0.25 * datum**2) * scaled * inverse / radius
        slope[pressed] = inverse * (0.5 - 0.5 * first / w)
        return load, slope

    def _coupling(self, load: FloatArray, effective_radius: FloatArray) -> _Coupling:
        """V at the loads of slices, shape (slices, contacts)."""
        n, size = self.slices, self.length / self.slices
        total, square = load.sum(axis=0), (load**2).sum(axis=0)
        place = 0.5 * np.log(4.0 * square * effective_radius / (np.pi * self.contact_modulus * size * total))
        place -= np.log(size)
        # How ln b follows the loads.
        grow = load / square - 0.5 / total
        lags, ends = self._coefficients(place)
        lags[0, 0] -= 2.0 * np.log(DATUM * n)
        if self.sleeve:
            lags = (1.0 - self.sleeve) * lags
            lags[0, 0] -= 2.0 * self.sleeve * np.log(DATUM / SLEEVE_DATUM)
        # Products of the matrix and of its first two derivatives by ln b with the loads: a lag each way.
        beside = np.zeros((3 * n - 2, place.size))
        beside[n - 1 : 2 * n - 1] = load
        row, column = beside.strides
        near = np.lib.stride_tricks.as_strided(beside, (n, 2 * n - 1, place.size), (row, row, column))
        products = np.einsum("kmc,imc->kic", lags[:2, np.abs(np.arange(1 - n, n))], near)
        alike = np.einsum("ic,imc->mc", load, near[:, n - 1 :])
        form = 2.0 * (lags[2] * alike).sum(axis=0) - lags[2, 0] * square
        # Second differences count where slices are narrower than the contact: the kernel of wide strips hardly knows of loads
        # that alternate from slice to slice.
        wide = np.exp(2.0 * place)
        part = wide / (1.0 + wide)
        smooth = np.stack((part, 2.0 * part * (1.0 - part), 4.0 * part * (1.0 - part) * (1.0 - 2.0 * part)))
        bends = np.diff(load, 2, axis=0)
        back = np.zeros(load.shape)
        back[:-2] += bends
        back[1:-1] -= 2.0 * bends
        back[2:] += bends
        products += smooth[:2, None] * back
        form += smooth[2] * (bends**2).sum(axis=0)
        products[:, 0] -= ends[:2] * load[0]
        products[:, -1] -= ends[:2] * load[-1]
        form -= ends[2] * (load[0] ** 2 + load[-1] ** 2)
        pressed, by_width = products
        slope, curved = 0.5 * (load * by_width).sum(axis=0), 0.5 * form
        scale = 1.0 / (np.pi * self.contact_modulus * size)
        stored, twice, by_load = self._counted_twice(load, effective_radius)
        return _Coupling(
            energy=0.5 * scale * (load * pressed).sum(axis=0) - stored,
            pressed_in=scale * (pressed + slope * grow) - twice,
            scale=scale,
            lags=lags[0],
            ends=ends[0],
            smooth=smooth[0],
            diagonal=slope / square - by_load / scale,
            across=by_width + (0.5 * curved - slope) * grow - slope / total,
            grow=grow,
        )

    def _counted_twice(
        self, load: FloatArray, effective_radius: FloatArray
    ) -> tuple[FloatArray | float, FloatArray | float, FloatArray | float]:
        """Energy, what is subtracted from what each slice presses in, smoothly bounded, and its derivative by the load.

        The bound is a part of the approach of a plane as deep as a half-space of the line's length counts, at the line load.
        """
        if not self.overlap:
            return 0.0, 0.0, 0.0
        places, shares = 0.5 * (_NODES + 1.0), 0.5 * _SHARES
        at = np.maximum(load, 1e-300) * np.append(places**2, 1.0)[:, None, None]
        datum, ratio = HALF_SPACE_DATUM * self.length, self.overlap * self.length * np.pi * self.contact_modulus
        half_width = np.sqrt(4.0 * at * (self.slices / self.length) * effective_radius / (np.pi * self.contact_modulus))
        deep = np.maximum(np.log(2.0 * datum / half_width) + 0.5, 0.5)
        part = (ratio / (2.0 * MAX_OVERLAP * deep)) ** OVERLAP_SHARPNESS
        bounded = self.overlap * self.slices * (1.0 + part) ** (-1.0 / OVERLAP_SHARPNESS)
        off = bounded * at
        stored = np.einsum("k,kic->c", 2.0 * shares * places, off[:-1] * load)
        narrow = np.where(deep > 0.5, 0.5 * part / (1.0 + part) / deep, 0.0)
        return stored, off[-1], (bounded * (1.0 - narrow))[-1]

    def _coefficients(self, place: FloatArray) -> tuple[FloatArray, FloatArray]:
        """a_k and ε with first and second derivatives by ln(b/l), shapes (3, slices, contacts) and (3, contacts)."""
        pieces = np.concatenate((_lags(self.slices), self.ends[:, None]), axis=1)
        start, stop = np.log(NARROWEST), np.log(WIDEST)
        spacing = (stop - start) / (_KNOTS - 1)
        held = place.clip(start, stop)
        at = (held - start) / spacing
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        t = at - piece
        c0, c1, c2, c3, c4, c5 = pieces[:, :, piece]
        curve = np.empty((3, self.slices + 1, place.size))
        curve[0] = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
        curve[1] = (c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + t * (5.0 * c5))))) / spacing
        curve[2] = (2.0 * c2 + t * (6.0 * c3 + t * (12.0 * c4 + t * (20.0 * c5)))) / spacing**2
        beyond = place != held
        if beyond.any():
            # Curves are nearly straight there.
            curve[0][:, beyond] += curve[1][:, beyond] * (place - held)[beyond]
            curve[2][:, beyond] = 0.0
        return curve[:, :-1], curve[:, -1]

    def _closed(self, free: FloatArray, radius: FloatArray, start: FloatArray | None) -> tuple[FloatArray, ...]:
        """The arrays of `SlicedContact` in its order, of contacts with something pressed together, which come last."""
        n, datum, count = self.slices, DATUM * self.length, radius.size
        z = slice_heights(self.length, n)[..., None]
        weights = _weights(self.length, n)

        def loads_of(line: FloatArray) -> FloatArray:
            return np.asarray((line * weights).sum(axis=1))

        # With the length as datum an aligned line has about the load that it has with its slices coupled.
        load = loads_of(self._line_load(free, radius, self.length)[0]) if start is None else start.copy()
        bad = ~(load.sum(axis=0) > 0.0)
        if start is not None and bad.any():
            load[:, bad] = loads_of(self._line_load(free[..., bad], radius[bad], self.length)[0])
        history: list[float] = []
        going, before, fraction = np.arange(count), np.full(count, np.inf), np.ones(count)
        way = np.zeros(load.shape)
        scalars, by_slice, by_point = np.zeros((6, count)), np.zeros((n, count)), np.zeros((*free.shape[:2], count))
        slopes = np.zeros((2, n, count))
        for _ in range(MAX_ITERATIONS):
            now, here = load[:, going], radius[going]
            coupled = self._coupling(now, here)
            local = free[..., going] - coupled.pressed_in[:, None]
            line, slope = self._line_load(local, here, datum)
            left = loads_of(line) - now
            size, largest = np.max(np.abs(left), axis=0), np.max(now, axis=0)
            history.append(float(np.max(size / largest, initial=0.0)))
            worse = (size > before[going]) & (fraction[going] > 1e-3) & (size > ROUND_OFF * largest)
            # Back to a part of the last step where it made things worse.
            back = going[worse]
            fraction[back] *= 0.4
            load[:, back] = np.maximum(load[:, back] - 1.5 * fraction[back] * way[:, back], 0.0)
            carried = slope * weights
            stiff, leaning = carried.sum(axis=1), (carried * z).sum(axis=1)
            by_load = coupled.by_load()
            # Of what is left over, of the approach and of the tilt.
            right = np.stack((left, stiff, leaning), axis=-1).swapaxes(0, 1)
            system = np.moveaxis(by_load * stiff[:, None], -1, 0) + np.eye(n)
            moved = np.moveaxis(np.linalg.solve(system, right), 0, -1)
            step = moved[:, 0]
            done = size <= NEAR * largest
            if done.any():
                # The last step is taken along the slopes, unless points open or close in it.
                some = np.flatnonzero(done)
                shift = -(by_load[..., some] * step[:, some]).sum(axis=1)[:, None]
                at = local[..., some]
                steady = (np.abs(shift) <= 1e-3 * np.abs(at)).all(axis=(0, 1)) | (
                    size[some] <= ROUND_OFF * largest[some]
                )
                done[some[~steady]] = False
                some, shift, at = some[steady], shift[..., steady], at[..., steady]
                kept = going[some]
                settled = np.maximum(line[..., some] + slope[..., some] * shift, 0.0)
                stored = loads_of(self._plane_energy(at, line[..., some], here[some])).sum(axis=0)
                k, m = stiff[:, some], leaning[:, some]
                middle = np.divide(m, k, out=np.zeros(k.shape), where=k > 0.0)
                by_approach, by_tilt = moved[:, 1, some], moved[:, 2, some]
                own = (carried[..., some] * z**2).sum(axis=(0, 1)) - (m * middle).sum(axis=0)
                by_slice[:, kept], by_point[..., kept] = loads_of(settled), settled
                slopes[:, :, kept] = by_approach, by_tilt
                scalars[:, kept] = (
                    by_slice[:, kept].sum(axis=0),
                    loads_of(settled * z).sum(axis=0),
                    by_approach.sum(axis=0),
                    by_tilt.sum(axis=0),
                    own + (middle * by_tilt).sum(axis=0),
                    stored + (now[:, some] * coupled.pressed_in[:, some]).sum(axis=0) - coupled.energy[some],
                )
            on = ~worse & ~done
            ahead = going[on]
            before[ahead], fraction[ahead] = size[on], 1.0
            target = np.maximum(now[:, on] + step[:, on], 0.0)
            # Something carries on.
            target = np.where(target.any(axis=0), target, 0.1 * now[:, on])
            way[:, ahead] = target - now[:, on]
            load[:, ahead] = target
            going = going[~done]
            if not going.size:
                break
        else:
            raise ConvergenceError(self._why_not(load[:, going], radius[going]), history)
        return (*scalars, by_slice, by_point, slopes)

    def _why_not(self, load: FloatArray, effective_radius: FloatArray) -> str:
        """What to tell of contacts that do not settle."""
        told = "the slices of a line contact do not settle; load left over by the largest"
        mean = (load**2).sum(axis=0) / (load.sum(axis=0) * self.length / self.slices)
        half_width = float(np.max(np.sqrt(4.0 * mean * effective_radius / (np.pi * self.contact_modulus))))
        size = self.length / self.slices
        if not half_width > size:
            return told
        most = max(3, int(2.0 * self.length / half_width) // 2 * 2 - 1)
        return (
            f"contact.slices = {self.slices}: slices of {size:.3g} mm are too narrow for a contact with a half-width of "
            f"{half_width:.3g} mm, choose at most {most}; {told}"
        )

    def _plane_energy(self, approach: FloatArray, line_load: FloatArray, radius: FloatArray) -> FloatArray:
        """∫ q dδ = q δ − ∫ δ dq, N."""
        q = np.where(line_load > 0.0, line_load, 1.0)
        scale = 2.0 / (np.pi * self.contact_modulus)
        half_width = np.sqrt(2.0 * scale * q * radius)
        spent = scale * q**2 * 0.5 * (np.log(2.0 * DATUM * self.length / half_width) + 0.75)
        return np.where(line_load > 0.0, q * approach - spent, 0.0)
