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
the line carry, pressure bulges there within some half-widths: the end slices are softer in V by :math:`\varepsilon_n(b/l)`,
tabulated for every n so that an aligned straight line has the load of `ltca.laws.line_contact`. A line of one slice is that law
itself and not made here. ``docs/theory/width.md`` has the sources and the measured errors.

Newton's method on the loads squares what is left over: its last step is taken along the slopes without another evaluation, to
round-off.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, by_drive
from ltca.contact.free_end import FreeEnds
from ltca.contact.influence import end_images, lagged_influence
from ltca.errors import ConvergenceError
from ltca.laws.backed import HALF_SPACE_DATUM, MAX_OVERLAP, OVERLAP_SHARPNESS
from ltca.laws.plane_strain import PlaneContactLaw, plane_load
from ltca.laws.slenderness_curve import quintic, quintic_spline_pieces
from ltca.laws.sliced_contact import (
    EXACT,
    LAST_STEP_ERROR,
    POINTS,
    SHARES,
    Exactness,
    SlicedContact,
    loads_nearby,
    rows_of,
    slice_heights,
)

STRIP = float(np.exp(1.25 - np.log(4.0)))
"""Half-width of an evenly pressed strip by that of a semi-elliptic one of the same energy: ⟨−ln|x − x′|⟩ = 3/2 − ln 2b of the
strip, 1/4 − ln(b/2) of the semi-ellipse."""
DATUM = 4.0
"""Datum of the plane law by the length of the line; what it is makes no difference but to slices that carry unevenly."""
SLEEVE_DATUM = 0.685
"""The same of a sleeve's part, whose slices do not feel each other: as deep as an aligned line counts at usual loads."""
MAX_ITERATIONS = 60
TOGETHER = 2048
"""Contacts solved at once: many enough for arrays over them, few enough for memory."""
ROUND_OFF = 1e-13
"""What is left over by round-off alone."""
NARROWEST, WIDEST = 1e-4, 40.0
"""Half-width by the length of a slice at the ends of the tables."""
TOUCHING = 1e-16
"""Deepest approach by the length up to which a contact is open: less is round-off of where parts stand."""
_KNOTS = 81
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
TABLE = Path(__file__).with_name("sliced_line.json")


@cache
def _strips(slices: int) -> FloatArray:
    """a_k at the knots, shape (slices, knots)."""
    found = np.empty((_KNOTS, slices))
    for row, place in zip(found, places(), strict=True):
        width = 2.0 * STRIP * float(np.exp(place))
        row[:] = lagged_influence(width, 1, np.arange(slices + 1.0), mirrored=False)[0, 0] / width**2
    # What plane strain counts of a strip, its datum at the length of a slice.
    found[:, 0] -= 2.0 * (1.5 - np.log(2.0 * STRIP) - places())
    return found.T


def places() -> FloatArray:
    """Return the knots of the tables, ln(b/l)."""
    return np.linspace(np.log(NARROWEST), np.log(WIDEST), _KNOTS)


@cache
def softer_ends(slices: int) -> FloatArray:
    """Return ε at the knots of lines of so many slices, as it ships with the package."""
    return np.array(json.loads(TABLE.read_text(encoding="utf-8"))["softer"][str(slices)])


@cache
def _images(slices: int, reach: float) -> FloatArray:
    """What strips feel of the images of others in both end planes at the knots, shape (slices, knots).

    The planes stand `reach` half-lengths from the middle. Strips i and j have the coefficient of the lag |i − (n − 1 − j)|.
    """
    found = np.empty((_KNOTS, slices))
    edges = np.arange(slices + 1.0) - 0.5 * slices
    for row, place in zip(found, places(), strict=True):
        width = 2.0 * STRIP * float(np.exp(place))
        row[:] = end_images(width, edges, 0.5 * slices * reach)[0, ::-1] / width**2
    return found.T


@cache
def _pieces(slices: int, free_ends: tuple[FreeEnds, ...]) -> FloatArray:
    """Pieces of a_k, ε and, where ends are free, those of images, shape (6, curves, pieces).

    Images with the weight 1 at the very end leave nothing of the bulge there, and others a part of it; what even slices miss
    of its energy goes with the square. Where bodies reach beyond, images count by what the end slice feels of its own.
    """
    ends, images = softer_ends(slices), np.empty((0, _KNOTS))
    if free_ends:
        images = np.sum([each.weight * _images(slices, each.reach) for each in free_ends], axis=0)
        ends = (1.0 - images[-1] / _images(slices, 1.0)[-1]) ** 2 * ends
    every = np.concatenate((_strips(slices), ends[None], images))
    return np.stack([quintic_spline_pieces(curve) for curve in every], axis=1)


def _products(lags: FloatArray, load: FloatArray, other: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Products of the matrix of lags and of its first derivative with loads of others, and the form of its second with both.

    Lags have the shape (3, slices, contacts) with their derivatives, loads (slices, contacts).
    """
    n, count = load.shape
    beside = np.zeros((3 * n - 2, count))
    beside[n - 1 : 2 * n - 1] = other
    row, column = beside.strides
    near = np.lib.stride_tricks.as_strided(beside, (n, 2 * n - 1, count), (row, row, column))
    products = np.einsum("kmc,imc->kic", lags[:2, np.abs(np.arange(1 - n, n))], near)
    if other is load:
        alike = np.einsum("ic,imc->mc", load, near[:, n - 1 :])
        return products, 2.0 * (lags[2] * alike).sum(axis=0) - lags[2, 0] * alike[0]
    # Of loads and others that differ both ways count.
    alike = np.einsum("ic,imc->mc", load, near)
    return products, (lags[2, np.abs(np.arange(1 - n, n))] * alike).sum(axis=0)


@cache
def _bends(slices: int) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
    """Rows, columns and values of D′D of second differences, where they are not zero."""
    differences = np.diff(np.eye(slices), 2, axis=0)
    product = differences.T @ differences
    rows, columns = np.nonzero(product)
    return rows, columns, product[rows, columns]


@cache
def _moments(length: float, slices: int) -> FloatArray:
    """Weights of the points of each slice of a line of a length in mm for ∫ dz, ∫ z dz and ∫ z² dz, shape (slices, 3, points)."""
    z = slice_heights(length, slices)
    weights = length / slices * SHARES
    return np.ascontiguousarray(np.stack((np.broadcast_to(weights, z.shape), weights * z, weights * z**2), axis=1))


@cache
def _between(slices: int) -> NDArray[np.intp]:
    """Lag of each pair of slices."""
    return np.asarray(np.abs(np.arange(slices)[:, None] - np.arange(slices)))


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
    mirrored: FloatArray | None
    smooth: FloatArray
    diagonal: FloatArray
    across: FloatArray
    grow: FloatArray

    def by_load(self) -> FloatArray:
        """Return ∂u/∂F, shape (slices, slices, contacts)."""
        n = self.grow.shape[0]
        found = self.lags.take(_between(n), axis=0)
        if self.mirrored is not None:
            found += self.mirrored.take(_between(n)[:, ::-1], axis=0)
        both = self.across[:, None] * self.grow
        found += both
        found += both.swapaxes(0, 1)
        rows, columns, bends = _bends(n)
        found[rows, columns] += bends[:, None] * self.smooth
        own = np.arange(n)
        found[own, own] += self.diagonal
        found[0, 0] -= self.ends
        found[-1, -1] -= self.ends
        found *= self.scale
        return np.asarray(found)


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
        By how much end slices are softer, ε over ln(b/l); default `softer_ends` of as many slices, less where ends are free.
    free_ends : tuple of FreeEnds
        Of the bodies that end at the line's ends or beyond them; half-spaces where there are none.
    """

    length: float
    contact_modulus: float
    slices: int
    relief: FloatArray = by_drive(2)
    sleeve: float = 0.0
    overlap: float = 0.0
    ends: FloatArray | None = None
    free_ends: tuple[FreeEnds, ...] = ()

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and their derivatives.

        Parameters
        ----------
        approach, tilt, effective_radius : array, shape (…)
            δ in the middle, mm; θ, rad, positive presses positive z; ρ, mm.
        start : array, shape (…, 2 + 3 slices), optional
            What the same contacts were nearby (`SlicedContact.near`).
        exactness : Exactness
            How close to balance the slices come.

        Raises
        ------
        ConvergenceError
            When loads do not settle.
        """
        given = (np.asarray(each, dtype=float) for each in (approach, tilt, effective_radius))
        delta, theta, radius = np.broadcast_arrays(*given)
        shape, z, n = delta.shape, slice_heights(self.length, self.slices), self.slices
        delta, theta, radius = delta.reshape(-1), theta.reshape(-1), radius.reshape(-1)
        deepest = delta + z.max() * np.abs(theta) - self.relief.min(initial=0.0)
        closed = np.flatnonzero(deepest > TOUCHING * self.length)
        relief = self.relief.reshape(-1, *z.shape).transpose(1, 2, 0)
        if relief.shape[2] not in (1, *shape[:1]):
            raise ValueError(f"reliefs of {relief.shape[2]} positions do not fit approaches of the shape {shape}")
        drive = closed * relief.shape[2] // max(delta.size, 1)  # the first axis of the approaches
        found = replace(SlicedContact.open(delta.size, n), left=np.zeros(delta.size))
        near = None if start is None else start.reshape(-1, 2 + 3 * n)
        for some in np.array_split(np.arange(closed.size), -(-closed.size // TOGETHER)) if closed.size else ():
            rows, fall = closed[some], relief if relief.shape[2] == 1 else relief[..., drive[some]]
            # Contacts come last: every step is one on arrays over them.
            free = delta[rows] + theta[rows] * z[..., None] - fall
            begin = None if near is None else loads_nearby(near[rows], delta[rows], theta[rows]).T
            pressed = (free > TOUCHING * self.length).any(axis=(0, 1)) if self.relief.any() else np.ones(1, dtype=bool)
            if not pressed.all():
                rows, free, begin = rows[pressed], free[..., pressed], None if begin is None else begin[:, pressed]
            if not rows.size:
                continue
            found.put(rows, self._closed(free, radius[rows], begin, exactness))
            found.near[rows, 0], found.near[rows, 1] = delta[rows], theta[rows]
        return found.shaped(shape)

    def take(self, shape: tuple[int, ...], places: Any) -> SlicedLine:
        """Return the law of some contacts of a batch (`ltca.laws.contact_law.ContactLaw.take`)."""
        return self if self.relief.ndim == 2 else replace(self, relief=rows_of(self.relief, places))

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy E of contacts, N·mm, shape (…)."""
        n, shape = self.slices, contact.load.shape
        radius = np.broadcast_to(effective_radius, shape).reshape(-1)
        load, q = contact.slice_load.reshape(-1, n).T, contact.line_load.reshape(-1, n, POINTS).transpose(1, 2, 0)
        carries = contact.load.reshape(-1) > 0.0
        coupled = self._coupling(load[:, carries], radius[carries])
        plane = PlaneContactLaw(thickness=1.0, contact_modulus=self.contact_modulus, datum=DATUM * self.length)
        stored = plane.energy_of_load(q[..., carries], radius[carries])
        own = np.matmul(_moments(self.length, n)[:, :1], stored).sum(axis=(0, 1))
        found = np.zeros(radius.shape)
        found[carries] = own + (load[:, carries] * coupled.pressed_in).sum(axis=0) - coupled.energy
        return found.reshape(shape)

    def _line_load(
        self, approach: FloatArray, effective_radius: FloatArray, datum: float
    ) -> tuple[FloatArray, FloatArray]:
        """q and dq/dδ of the plane law, zero where open, shape (slices, points, contacts)."""
        pressed = approach > 0.0
        everywhere = pressed.all()
        # Where open any depth will do.
        at = approach if everywhere else np.where(pressed, approach, 1e-6 * self.length)
        place = (2.0 / datum**2) * effective_radius * at
        np.log(place, out=place)
        load, slope = plane_load(place)
        slope += load
        load *= at
        whole = 0.5 * np.pi * self.contact_modulus if everywhere else 0.5 * np.pi * self.contact_modulus * pressed
        load *= whole
        slope *= whole
        return load, slope

    def _coupling(self, load: FloatArray, effective_radius: FloatArray) -> _Coupling:
        """V at the loads of slices, shape (slices, contacts)."""
        n, size = self.slices, self.length / self.slices
        total, square = load.sum(axis=0), (load**2).sum(axis=0)
        place = 0.5 * np.log(4.0 * square * effective_radius / (np.pi * self.contact_modulus * size * total))
        place -= np.log(size)
        # How ln b follows the loads.
        grow = load / square - 0.5 / total
        lags, ends, mirrored = self._coefficients(place)
        lags[0, 0] -= 2.0 * np.log(DATUM * n)
        if self.sleeve:
            lags = (1.0 - self.sleeve) * lags
            lags[0, 0] -= 2.0 * self.sleeve * np.log(DATUM / SLEEVE_DATUM)
        products, form = _products(lags, load, load)
        if mirrored is not None:
            # A slice feels the images of those as far from the other end.
            of_images = _products(mirrored, load, load[::-1])
            products += of_images[0]
            form += of_images[1]
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
            mirrored=None if mirrored is None else mirrored[0],
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
        places, shares = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
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

    def _coefficients(self, place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray | None]:
        """a_k, ε and those of images with two derivatives by ln(b/l), shapes (3, slices, contacts), (3, contacts) and as a_k."""
        n, pieces = self.slices, _pieces(self.slices, self.free_ends)
        if self.ends is not None:
            pieces = pieces.copy()
            pieces[:, n] = self.ends
        start, stop = np.log(NARROWEST), np.log(WIDEST)
        spacing = (stop - start) / (_KNOTS - 1)
        held = place.clip(start, stop)
        at = (held - start) / spacing
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        value, first, second = quintic(pieces.take(piece, axis=2), at - piece)
        curve = np.stack((value, first / spacing, second / spacing**2))
        beyond = place != held
        if beyond.any():
            # Curves are nearly straight there.
            curve[0][:, beyond] += curve[1][:, beyond] * (place - held)[beyond]
            curve[2][:, beyond] = 0.0
        return curve[:, :n], curve[:, n], curve[:, n + 1 :] if self.free_ends else None

    def _closed(
        self, free: FloatArray, radius: FloatArray, start: FloatArray | None, exactness: Exactness
    ) -> SlicedContact:
        """What contacts with something pressed together carry, from approaches of their points, contacts last."""
        n, datum, count = self.slices, DATUM * self.length, radius.size
        moments = _moments(self.length, n)

        def loads_of(line: FloatArray) -> FloatArray:
            return np.asarray(np.matmul(moments[:, :1], line)[:, 0])

        # With the length as datum an aligned line has about the load that it has with its slices coupled.
        load = loads_of(self._line_load(free, radius, self.length)[0]) if start is None else start.copy()
        bad = ~(load.sum(axis=0) > 0.0)
        if start is not None and bad.any():
            load[:, bad] = loads_of(self._line_load(free[..., bad], radius[bad], self.length)[0])
        history: list[float] = []
        going, before, fraction = np.arange(count), np.full(count, np.inf), np.ones(count)
        way = np.zeros(load.shape)
        found: SlicedContact | None = None
        for _ in range(MAX_ITERATIONS):
            coupled = self._coupling(load, radius)
            local = free - coupled.pressed_in[:, None]
            line, slope = self._line_load(local, radius, datum)
            left = loads_of(line) - load
            size, largest = np.max(np.abs(left), axis=0), np.max(load, axis=0)
            history.append(float(np.max(size / largest, initial=0.0)))
            worse = (size > before) & (fraction > 1e-3) & (size > ROUND_OFF * largest)
            done = size <= exactness.slices * largest
            stiff, leaning, own = np.matmul(moments, slope).swapaxes(0, 1)
            by_load = coupled.by_load()
            # Of what is left over and, at the end, of the approach and of the tilt.
            right = np.stack((left, stiff, leaning) if done.any() else (left,), axis=1)
            moved = _eliminated(by_load * stiff[:, None], right)
            if done.any():
                # The last step is taken along the slopes, unless points open or close in it.
                shift = -np.einsum("ijc,jc->ic", by_load, moved[:, 0])[:, None]
                at = np.abs(local).min(axis=(0, 1))
                done &= (np.abs(shift[:, 0]).max(axis=0) <= exactness.steady * at) | (size <= ROUND_OFF * largest)
                settled = np.maximum(line + slope * shift, 0.0)
                last_step = LAST_STEP_ERROR * (size / largest) ** 2 * load.sum(axis=0)
                values = settled, moved[:, 1:], stiff, leaning, own, last_step
                part = self._carried(moments, values if done.all() else tuple(each[..., done] for each in values))
                if done.all() and found is None:
                    return part
                if found is None:
                    found = replace(SlicedContact.open(count, n), left=np.zeros(count))
                found.put(going[done], part)
            for kept, now in ((before, size), (fraction, 1.0)):
                kept[...] = np.where(worse, kept, now)
            # Back to a part of the last step where it made things worse.
            fraction[worse] *= 0.4
            target = np.maximum(load + moved[:, 0], 0.0)
            # Something carries on.
            target = np.where(target.any(axis=0), target, 0.1 * load)
            back = np.maximum(load - 1.5 * fraction * way, 0.0)
            way = np.where(worse, way, target - load)
            load = np.where(worse, back, target)
            if found is not None and done.all():
                return found
            if done.any():
                on = ~done
                going, before, fraction, radius = going[on], before[on], fraction[on], radius[on]
                load, way, free = load[:, on], way[:, on], free[..., on]
        raise ConvergenceError(self._why_not(load, radius), history)

    def _carried(self, moments: FloatArray, values: tuple[FloatArray, ...]) -> SlicedContact:
        """What contacts carry that are done."""
        line, moved, stiff, leaning, own, left = values
        both = np.matmul(moments[:, :2], line)
        # By the tilt points of a slice approach alike but for their heights, as its load follows.
        inverse = np.divide(1.0, stiff, out=np.zeros(stiff.shape), where=stiff > 0.0)
        turned = moved[:, 1] - leaning
        changes = both[:, 0], moved[:, 0], moved[:, 1]
        return SlicedContact(
            load=both[:, 0].sum(axis=0),
            moment=both[:, 1].sum(axis=0),
            by_approach=moved[:, 0].sum(axis=0),
            by_tilt=moved[:, 1].sum(axis=0),
            moment_by_tilt=(own + leaning * inverse * turned).sum(axis=0),
            slice_load=both[:, 0].T,
            line_load=np.moveaxis(line, -1, 0),
            near=np.concatenate((np.zeros((2, left.size)), *changes)).T,
            left=left,
        )

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


def _eliminated(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve (1 + A) x = b for many small A at once, contacts last, in place.

    By elimination without pivoting: A is a positive diagonal by a positive definite matrix, whose pivots are all above one.
    Solvers for stacks of matrices take them first and would have every array copied there and back.
    """
    n = matrix.shape[0]
    own = np.arange(n)
    matrix[own, own] += 1.0
    for k in range(n):
        pivot = 1.0 / matrix[k, k]
        factor = matrix[k + 1 :, k] * pivot
        matrix[k + 1 :, k + 1 :] -= factor[:, None] * matrix[k, k + 1 :]
        right[k + 1 :] -= factor[:, None] * right[k]
        matrix[k, k] = pivot
    for k in range(n - 1, -1, -1):
        right[k] *= matrix[k, k]
        right[:k] -= matrix[:k, k, None] * right[k]
    return right
