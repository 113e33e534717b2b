"""Line contacts in slices along their width, of any lead and profile: load and moment by approach and tilt.

Slice i, l = L/n long, carries F_i = ∫ q(δ + θ z − h(z) − u_i) dz, u_i = ∂V/∂F_i, V = Σ a_|i−j|(b/l) F_i F_j/(2π E* l), with q of
plane strain, Love's a_k of strips less what q has, and b of the mean line load Σ F²/(l Σ F); end slices are softer by ε_n(b/l),
tabulated for the load of an aligned line (docs/theory/width.md). Newton's last step is taken along the slopes, to round-off.
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
from ltca.contact.hertz import line_half_width
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
"""Half-width of an evenly pressed strip by that of a semi-elliptic one of the same energy, 3/2 − ln 2b against 1/4 − ln(b/2)."""
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
_BENDS, _BENDS_AT_ENDS = np.array([[6.0], [-4.0], [1.0]]), np.array([[[-5.0], [2.0]], [[2.0], [-1.0]]])
"""D′D of second differences by the lag, and what is added to it in the corners."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
TABLE = Path(__file__).with_name("sliced_line.json")


def places() -> FloatArray:
    """Return the knots of the tables, ln(b/l)."""
    return np.linspace(np.log(NARROWEST), np.log(WIDEST), _KNOTS)


@cache
def softer_ends(slices: int) -> FloatArray:
    """Return ε at the knots of lines of so many slices, as it ships with the package."""
    return np.array(json.loads(TABLE.read_text(encoding="utf-8"))["softer"][str(slices)])


@cache
def _strips(slices: int) -> FloatArray:
    """a_k at the knots, shape (slices, knots), less what plane strain counts of a strip, its datum at the length of a slice."""
    edges, widths = np.arange(slices + 1.0), 2.0 * STRIP * np.exp(places())
    found = np.array([lagged_influence(width, 1, edges, mirrored=False)[0, 0] / width**2 for width in widths.tolist()])
    found[:, 0] -= 2.0 * (1.5 - np.log(widths))
    return found.T


@cache
def _images(slices: int, reach: float) -> FloatArray:
    """Coefficients of strips with images in both end planes, `reach` half-lengths from the middle, (slices, knots)."""
    edges, widths = np.arange(slices + 1.0) - 0.5 * slices, 2.0 * STRIP * np.exp(places())
    planes = 0.5 * slices * reach
    return np.array([end_images(width, edges, planes)[0, ::-1] / width**2 for width in widths.tolist()]).T


@cache
def _pieces(slices: int, free_ends: tuple[FreeEnds, ...]) -> FloatArray:
    """Pieces of a_k, ε and, where ends are free, those of images, shape (6, curves, pieces)."""
    ends, images = softer_ends(slices), np.empty((0, _KNOTS))
    if free_ends:
        images = np.sum([each.weight * _images(slices, each.reach) for each in free_ends], axis=0)
        ends = (1.0 - images[-1] / _images(slices, 1.0)[-1]) ** 2 * ends
    every = np.concatenate((_strips(slices), ends[None], images))
    return np.stack([quintic_spline_pieces(curve) for curve in every], axis=1)


@cache
def _between(slices: int) -> NDArray[np.intp]:
    """Lag of each pair of slices."""
    number = np.arange(slices)
    return np.asarray(np.abs(number[:, None] - number))


@cache
def _moments(length: float, slices: int) -> FloatArray:
    """Weights of the points of each slice of a line of a length in mm for ∫ dz, ∫ z dz and ∫ z² dz, shape (slices, 3, points)."""
    z = slice_heights(length, slices)
    weights = length / slices * SHARES
    return np.ascontiguousarray(np.stack((np.broadcast_to(weights, z.shape), weights * z, weights * z**2), axis=1))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedLine:
    """Law of line contacts of one length in slices."""

    length: float  # L, mm
    contact_modulus: float  # E*, MPa
    slices: int  # at least 3
    relief: FloatArray = by_drive(2)  # h of lead and profile at the points (`slice_heights`), mm, (slices, points)
    sleeve: float = 0.0  # part of the compliance that is a sleeve's, whose slices do not feel each other
    overlap: float = 0.0  # compliance of the line that the sleeve's law has as well, mm/N (`BackedLaw`)
    ends: FloatArray | None = None  # ε over ln(b/l), shape (6, pieces); default `softer_ends`
    free_ends: tuple[FreeEnds, ...] = ()  # of bodies that end at the line's ends or beyond

    @classmethod
    def straight(
        cls, length: float, contact_modulus: float, slices: int, free_ends: tuple[FreeEnds, ...] = ()
    ) -> SlicedLine:
        """Return the law of lines without lead or profile."""
        relief = np.zeros((slices, POINTS))
        return cls(length=length, contact_modulus=contact_modulus, slices=slices, relief=relief, free_ends=free_ends)

    def respond(
        self,
        approach: FloatArray,
        tilt: FloatArray,
        effective_radius: FloatArray,
        start: FloatArray | None = None,
        exactness: Exactness = EXACT,
    ) -> SlicedContact:
        """Return loads, moments and derivatives at δ in the middle, mm, θ, rad, and ρ, mm, from a neighbour's `near` as start."""
        given = (np.asarray(each, dtype=float) for each in (approach, tilt, effective_radius))
        delta, theta, radius = np.broadcast_arrays(*given)
        shape, z, n = delta.shape, slice_heights(self.length, self.slices), self.slices
        delta, theta, radius = delta.reshape(-1), theta.reshape(-1), radius.reshape(-1)
        # Contacts come last: every step is one on arrays over them.
        relief = self.relief.reshape(-1, *z.shape).transpose(1, 2, 0)
        if relief.shape[2] not in (1, *shape[:1]):
            raise ValueError(f"reliefs of {relief.shape[2]} positions do not fit approaches of the shape {shape}")
        found, touching = SlicedContact.open(delta.size, n), TOUCHING * self.length
        deepest = delta + z.max() * np.abs(theta) - self.relief.min(initial=0.0)
        closed = np.flatnonzero(deepest > touching)
        for rows in np.split(closed, range(TOGETHER, closed.size, TOGETHER)):
            fall = relief[..., rows * relief.shape[2] // max(delta.size, 1)]  # by the first axis of the approaches
            free = delta[rows] + theta[rows] * z[..., None] - fall
            pressed = (free > touching).any(axis=(0, 1))
            rows, free = rows[pressed], free[..., pressed]
            if not rows.size:
                continue
            load = np.zeros((n, rows.size))
            if start is not None:
                near = start.reshape(-1, 2 + 3 * n)[rows]
                load = loads_nearby(near, delta[rows], theta[rows]).T
            self._settle(found, rows, free, radius[rows], load, exactness)
            found.near[rows, 0], found.near[rows, 1] = delta[rows], theta[rows]
        return found.shaped(shape)

    def take(self, shape: tuple[int, ...], places: Any) -> SlicedLine:
        """Return the law of some contacts of a batch (`ltca.laws.contact_law.ContactLaw.take`)."""
        return self if self.relief.ndim == 2 else replace(self, relief=rows_of(self.relief, places))

    def energy(self, contact: SlicedContact, effective_radius: FloatArray) -> FloatArray:
        """Return the energy E of contacts, N·mm, shape (…)."""
        n, shape = self.slices, contact.load.shape
        carries = contact.load.reshape(-1) > 0.0
        radius = np.broadcast_to(effective_radius, shape).reshape(-1)[carries]
        load = contact.slice_load.reshape(-1, n)[carries].T
        line_load = contact.line_load.reshape(-1, n, POINTS)[carries].transpose(1, 2, 0)
        plane = PlaneContactLaw(thickness=1.0, contact_modulus=self.contact_modulus, datum=DATUM * self.length)
        own = np.matmul(_moments(self.length, n)[:, :1], plane.energy_of_load(line_load, radius)).sum(axis=(0, 1))
        stored, pressed_in, _ = self._coupling(load, radius)
        # ∫ u dF along F x² of what is counted twice, dF = 2 x F dx
        for x, weight in zip(0.5 * (_NODES + 1.0), _WEIGHTS, strict=True):
            stored = stored - weight * x * (load * self._counted_twice(load * x**2, radius)[0]).sum(axis=0)
        found = np.zeros(carries.shape)
        found[carries] = own + (load * pressed_in).sum(axis=0) - stored
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

    def _coupling(self, load: FloatArray, effective_radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """V without what is counted twice, u and ∂u/∂F at the loads of slices, shape (slices, contacts)."""
        size = self.length / self.slices
        total, square = load.sum(axis=0), (load**2).sum(axis=0)
        mean = square / (size * total)
        matrix = self._matrix(np.log(line_half_width(mean, effective_radius, self.contact_modulus) / size))
        pressed, by_width, curved = np.einsum("kijc,jc->kic", matrix, load)
        slope, bend = 0.5 * (load * by_width).sum(axis=0), 0.5 * (load * curved).sum(axis=0)
        # How ln b follows the loads, and by it everything else.
        grow = load / square - 0.5 / total
        both = (by_width + (0.5 * bend - slope) * grow - slope / total)[:, None] * grow
        twice, twice_by_load = self._counted_twice(load, effective_radius)
        by_load, own = matrix[0], np.arange(self.slices)
        by_load += both
        by_load += both.swapaxes(0, 1)
        by_load[own, own] += slope / square - twice_by_load
        return 0.5 * (load * pressed).sum(axis=0), pressed + slope * grow - twice, by_load

    def _counted_twice(
        self, load: FloatArray, effective_radius: FloatArray
    ) -> tuple[FloatArray | float, FloatArray | float]:
        """Smoothly bounded part to subtract of what each slice presses in, and its derivative by the load."""
        if not self.overlap:
            return 0.0, 0.0
        force = np.maximum(load, 1e-300)
        half_width = line_half_width(force * (self.slices / self.length), effective_radius, self.contact_modulus)
        deep = np.maximum(np.log(2.0 * HALF_SPACE_DATUM * self.length / half_width) + 0.5, 0.5)
        ratio = self.overlap * self.length * np.pi * self.contact_modulus
        part = (ratio / (2.0 * MAX_OVERLAP * deep)) ** OVERLAP_SHARPNESS
        bounded = self.overlap * self.slices * (1.0 + part) ** (-1.0 / OVERLAP_SHARPNESS)
        narrow = np.where(deep > 0.5, 0.5 * part / (1.0 + part) / deep, 0.0)
        return bounded * force, bounded * (1.0 - narrow)

    def _matrix(self, place: FloatArray) -> FloatArray:
        """Coefficients of slices on slices at ln(b/l), with two derivatives by it, mm/N, (3, slices, slices, contacts)."""
        n, curves, lag = self.slices, self._curves(place), _between(self.slices)
        curves[:, :n] *= 1.0 - self.sleeve
        curves[0, 0] -= 2.0 * ((1.0 - self.sleeve) * np.log(DATUM * n) + self.sleeve * np.log(DATUM / SLEEVE_DATUM))
        # Second differences count where slices are narrower than the contact: the kernel of wide strips hardly knows of loads
        # that alternate from slice to slice.
        wide = np.exp(2.0 * place)
        part = wide / (1.0 + wide)
        rise = 2.0 * part * (1.0 - part)
        smooth = np.stack((part, rise, 2.0 * rise * (1.0 - 2.0 * part)))[:, None]
        curves[:, :3] += _BENDS * smooth
        at_ends = _BENDS_AT_ENDS * smooth[:, None]
        at_ends[:, 0, 0] -= curves[:, n]
        scale = n / (np.pi * self.contact_modulus * self.length)
        curves *= scale
        at_ends *= scale
        found = curves.take(lag, axis=1)
        if self.free_ends:
            # A slice feels the images of those as far from the other end.
            found += curves.take(n + 1 + lag[:, ::-1], axis=1)
        found[:, :2, :2] += at_ends
        found[:, -2:, -2:] += at_ends[:, ::-1, ::-1]
        return found

    def _curves(self, place: FloatArray) -> FloatArray:
        """The curves of `_pieces` at ln(b/l) with two derivatives by it, shape (3, curves, contacts)."""
        pieces = _pieces(self.slices, self.free_ends)
        if self.ends is not None:
            pieces = pieces.copy()
            pieces[:, self.slices] = self.ends
        start, stop = np.log(NARROWEST), np.log(WIDEST)
        spacing = (stop - start) / (_KNOTS - 1)
        held = place.clip(start, stop)
        at = (held - start) / spacing
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        value, first, second = quintic(pieces.take(piece, axis=2), at - piece)
        curves = np.stack((value, first / spacing, second / spacing**2))
        beyond = place != held
        if beyond.any():
            # Curves are nearly straight there.
            curves[0][:, beyond] += curves[1][:, beyond] * (place - held)[beyond]
            curves[2][:, beyond] = 0.0
        return curves

    def _settle(
        self,
        found: SlicedContact,
        rows: NDArray[np.intp],
        free: FloatArray,
        radius: FloatArray,
        load: FloatArray,
        exactness: Exactness,
    ) -> None:
        """Put contacts by the free approaches of their points, contacts last; `load` of slices to start from, 0 where unknown."""
        datum, moments = DATUM * self.length, _moments(self.length, self.slices)
        unknown = ~(load.sum(axis=0) > 0.0)
        if unknown.any():
            # With the length as datum an aligned line has about the load that it has with its slices coupled.
            line, _ = self._line_load(free[..., unknown], radius[unknown], self.length)
            load[:, unknown] = np.matmul(moments[:, :1], line)[:, 0]
        history: list[float] = []
        before, fraction, way = np.full(rows.size, np.inf), np.ones(rows.size), np.zeros(load.shape)
        for _ in range(MAX_ITERATIONS):
            _, pressed_in, by_load = self._coupling(load, radius)
            local = free - pressed_in[:, None]
            line, slope = self._line_load(local, radius, datum)
            left = np.matmul(moments[:, :1], line)[:, 0] - load
            size, largest = np.abs(left).max(axis=0), load.max(axis=0)
            history.append(float(np.max(size / largest, initial=0.0)))
            done = size <= exactness.slices * largest
            stiff, leaning, own = np.matmul(moments, slope).swapaxes(0, 1)
            # Of what is left over and, at the end, of the approach and of the tilt.
            right = np.stack((left, stiff, leaning) if done.any() else (left,), axis=1)
            moved = _solved(by_load, stiff, right)
            if done.any():
                # The last step is taken along the slopes, unless points open or close in it.
                shift = -np.einsum("ijc,jc->ic", by_load, moved[:, 0])[:, None]
                at = np.abs(local).min(axis=(0, 1))
                done &= (np.abs(shift[:, 0]).max(axis=0) <= exactness.steady * at) | (size <= ROUND_OFF * largest)
                settled = np.maximum(line + slope * shift, 0.0)
                last_step = LAST_STEP_ERROR * (size / largest) ** 2 * load.sum(axis=0)
                values = (settled, moved[:, 1:], stiff, leaning, own, last_step)
                found.put(rows[done], _carried(moments, *(each[..., done] for each in values)))
                if done.all():
                    return
            # Back to a part of the last step where it made things worse.
            worse = (size > before) & (fraction > 1e-3) & (size > ROUND_OFF * largest)
            before, fraction = np.where(worse, before, size), np.where(worse, 0.4 * fraction, 1.0)
            target = np.maximum(load + moved[:, 0], 0.0)
            # Something carries on.
            target = np.where(target.any(axis=0), target, 0.1 * load)
            back = np.maximum(load - 1.5 * fraction * way, 0.0)
            way = np.where(worse, way, target - load)
            load = np.where(worse, back, target)
            if done.any():
                on = ~done
                rows, before, fraction, radius = rows[on], before[on], fraction[on], radius[on]
                load, way, free = load[:, on], way[:, on], free[..., on]
        raise ConvergenceError(self._why_not(load, radius), history)

    def _why_not(self, load: FloatArray, effective_radius: FloatArray) -> str:
        """Message about contacts that do not settle."""
        message = "the slices of a line contact do not settle; load left over by the largest"
        size = self.length / self.slices
        mean = (load**2).sum(axis=0) / (load.sum(axis=0) * size)
        half_width = float(np.max(line_half_width(mean, effective_radius, self.contact_modulus)))
        if not half_width > size:
            return message
        most = max(3, int(2.0 * self.length / half_width) // 2 * 2 - 1)
        return (
            f"contact.slices = {self.slices}: slices of {size:.3g} mm are too narrow for a contact with a half-width of "
            f"{half_width:.3g} mm, choose at most {most}; {message}"
        )


def _carried(
    moments: FloatArray,
    line: FloatArray,
    moved: FloatArray,
    stiff: FloatArray,
    leaning: FloatArray,
    own: FloatArray,
    left: FloatArray,
) -> SlicedContact:
    """Settled contacts, contacts last: by the tilt, points of a slice approach alike but for their heights, as its load does."""
    load, moment = np.matmul(moments[:, :2], line).swapaxes(0, 1)
    by_approach, by_tilt = moved.swapaxes(0, 1)
    inverse = np.divide(1.0, stiff, out=np.zeros(stiff.shape), where=stiff > 0.0)
    return SlicedContact(
        load=load.sum(axis=0),
        moment=moment.sum(axis=0),
        by_approach=by_approach.sum(axis=0),
        by_tilt=by_tilt.sum(axis=0),
        moment_by_tilt=(own + leaning * inverse * (by_tilt - leaning)).sum(axis=0),
        slice_load=load.T,
        line_load=np.moveaxis(line, -1, 0),
        near=np.concatenate((np.zeros((2, left.size)), load, by_approach, by_tilt)).T,
        left=left,
    )


def _solved(by_load: FloatArray, stiff: FloatArray, right: FloatArray) -> FloatArray:
    """Solve (1 + A K) x = b, A positive definite, K > 0 diagonal, contacts last, by elimination: pivots are above one."""
    n = len(stiff)
    own = np.arange(n)
    system = np.concatenate((by_load * stiff[:, None], right), axis=1)
    system[own, own] += 1.0
    for k in range(n):
        system[k, k + 1 :] /= system[k, k]
        system[k + 1 :, k + 1 :] -= system[k + 1 :, k, None] * system[k, k + 1 :]
    found = system[:, n:]
    for k in range(n - 1, 0, -1):
        found[:k] -= system[:k, k, None] * found[k]
    return found
