r"""Line contacts in slices along their width: load and moment by approach and tilt, for any lead and profile.

A line of the length L is cut into n slices of the length l = L/n. Slice i carries F_i, evenly along l. Its surfaces approach by
:math:`\delta + \theta z - h(z)` at the height z, less :math:`u_i(F)`, what all slices press in together beyond what the slice
does as plane strain counts it:

.. math::
    F_i = \int_l q(\delta + \theta z - h(z) - u_i)\,dz, \qquad
    u_i = \frac{\partial V}{\partial F_i}, \qquad
    V = \frac{1}{2 \pi E^* l} \sum_{ij} a_{|i-j|}(b/l) F_i F_j .

q is the line load of plane strain with the datum D (`ltca.laws.plane_strain`), :math:`\delta = (2 q/\pi E^*)(\ln(2D/b) + 1/2)`
with the half-width b of the line load itself; a lag's coefficient :math:`a_k` is the integral of Boussinesq's kernel over two strips
l long and as wide as the contact of the mean line load (Love; `ltca.contact.influence`), and of a slice on itself less what q counts
of it. Strips are as wide as makes their own energy that of the semi-elliptic pressure. The mean line load
:math:`\sum F^2/(l \sum F)` moves with the loads, and V knows it: loads, moment and energy belong to one potential to the last bit,

.. math:: E = \sum \int \varphi(\delta + \theta z - h - u_i)\,dz + \sum F_i u_i - V, \qquad \varphi' = q .

Slices are integrated at `POINTS` points each, so that a contact that ends within a slice moves on smoothly. Where the ends of the
line carry, pressure bulges there within some half-widths: the end slices are softer in V by :math:`\varepsilon(b/l)`, tabulated
once so that an aligned straight line has the load of `ltca.laws.line_contact`. A line of one slice is that law itself and not
made here.
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
from ltca.laws.slenderness_curve import SlendernessCurve, quintic_spline_pieces

POINTS = 4
"""Points of a slice at which its surfaces' approach is taken (Gauss)."""
STRIP = float(np.exp(1.25 - np.log(4.0)))
"""Half-width of an evenly pressed strip by that of a semi-elliptic one of the same energy: ⟨−ln|x − x′|⟩ = 3/2 − ln 2b of the
strip, 1/4 − ln(b/2) of the semi-ellipse."""
DATUM = 4.0
"""Datum of the plane law by the length of the line; what it is makes no difference but to slices that carry unevenly."""
MAX_ITERATIONS = 60
SETTLED = 1e-12
"""What is left over of a slice's load, by the largest."""
ROUND_OFF = 1e-9
"""What round-off of approaches may leave over."""
NARROWEST, WIDEST = 1e-4, 40.0
"""Half-width by the length of a slice at the ends of the tables."""
SMOOTHING = 1.0
_KNOTS = 81
TABLE = Path(__file__).with_name("sliced_line.json")


def slice_heights(length: float, slices: int) -> FloatArray:
    """Return z of the points of the slices of a line of a length in mm, shape (slices, points)."""
    middle = (np.arange(slices) - 0.5 * (slices - 1)) * length / slices
    return np.asarray(middle[:, None] + 0.5 * length / slices * np.polynomial.legendre.leggauss(POINTS)[0])


@cache
def plane_curve() -> SlendernessCurve:
    """Return w = X/Q over ln X, of the plane law with X = 2 δ ρ/D² and Q = (b/D)²: X = Q (ln(4/Q) + 1)/2."""
    places = np.linspace(-46.0, -0.3, 129)
    square = np.exp(places) / 3.0
    for _ in range(100):
        square = np.exp(places) / (0.5 * (np.log(4.0 / square) + 1.0))
    for _ in range(3):
        slope = 0.5 * np.log(4.0 / square)
        square = square - (square * (slope + 0.5) - np.exp(places)) / slope
    return SlendernessCurve.through(places, np.exp(places) / square, 0.5)


@cache
def _lags(slices: int) -> FloatArray:
    """Pieces of a_k over ln(b/l), k = 0 … n − 1, without the softer ends, shape (6, pieces, slices)."""
    found = np.empty((_KNOTS, slices))
    for row, place in zip(found, places(), strict=True):
        width = 2.0 * STRIP * float(np.exp(place))
        row[:] = lagged_influence(width, 1, np.arange(slices + 1.0), mirrored=False)[0, 0] / width**2
    # What plane strain counts of a strip, its datum at the length of a slice.
    found[:, 0] -= 2.0 * (1.5 - np.log(2.0 * STRIP) - places())
    return np.stack([quintic_spline_pieces(column) for column in found.T], axis=-1)


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
    """

    load: FloatArray
    moment: FloatArray
    by_approach: FloatArray
    by_tilt: FloatArray
    moment_by_tilt: FloatArray
    energy: FloatArray
    slice_load: FloatArray
    line_load: FloatArray

    def take(self, rows: NDArray[np.intp]) -> SlicedContact:
        """Return some of a row of contacts."""
        return SlicedContact(**{name: getattr(self, name)[rows] for name in self.__slots__})

    def put(self, rows: NDArray[np.intp], part: SlicedContact) -> None:
        """Write what some of a row of contacts are now."""
        for name in self.__slots__:
            getattr(self, name)[rows] = getattr(part, name)


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
    ends : array, shape (6, pieces), optional
        By how much end slices are softer, ε over ln(b/l); default `softer_ends`.
    """

    length: float
    contact_modulus: float
    slices: int
    relief: FloatArray = by_drive(2)
    ends: FloatArray = field(default_factory=softer_ends)

    @property
    def _weights(self) -> FloatArray:
        return np.asarray(0.5 * self.length / self.slices * np.polynomial.legendre.leggauss(POINTS)[1])

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
        closed = np.flatnonzero((free > 0.0).any(axis=(1, 2)))
        free, radius = free[closed], radius.reshape(-1)[closed]
        begin = None if start is None else start.reshape(-1, self.slices)[closed]
        found = self._closed(free, radius, begin)
        sizes = ((), (), (), (), (), (), (self.slices,), z.shape)
        whole = []
        for values, size in zip(found, sizes, strict=True):
            full = np.zeros((delta.size, *size))
            full[closed] = values
            whole.append(full.reshape((*shape, *size)))
        return SlicedContact(**dict(zip(SlicedContact.__slots__, whole, strict=True)))

    def _line_load(self, approach: FloatArray, effective_radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """q and dq/dδ of the plane law, zero where open."""
        datum = DATUM * self.length
        load, slope = np.zeros(approach.shape), np.zeros(approach.shape)
        pressed = approach > 0.0
        radius = np.broadcast_to(effective_radius[:, None, None], approach.shape)[pressed]
        scaled = 2.0 * approach[pressed] * radius / datum**2
        w, first, _ = plane_curve().value_and_derivatives(np.log(scaled))
        load[pressed] = 0.25 * np.pi * self.contact_modulus * datum**2 * scaled / (w * radius)
        slope[pressed] = 0.5 * np.pi * self.contact_modulus * (1.0 - first / w) / w
        return load, slope

    def _coupling(self, load: FloatArray, effective_radius: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """V, u and their derivative, shapes (contacts,), (contacts, slices) and (contacts, slices, slices)."""
        n, size = self.slices, self.length / self.slices
        total, square = load.sum(axis=1), (load**2).sum(axis=1)
        mean = square / (size * total)
        place = 0.5 * np.log(4.0 * mean * effective_radius / (np.pi * self.contact_modulus)) - np.log(size)
        # How ln b follows the loads.
        grow = load / square[:, None] - 0.5 / total[:, None]
        curve = self._coefficients(place)
        lag = np.abs(np.arange(n)[:, None] - np.arange(n))
        matrix, first, second = (each[:, lag] for each in curve[..., :n])
        for each, ends in zip((matrix, first, second), curve[..., n], strict=True):
            each[:, (0, -1), (0, -1)] -= ends[:, None]
        matrix[:, np.arange(n), np.arange(n)] -= 2.0 * np.log(DATUM * n)
        bends = np.diff(np.eye(n), 2, axis=0)
        wide = np.exp(2.0 * place)
        part = wide / (1.0 + wide)
        for each, factor in (
            (matrix, part),
            (first, 2.0 * part * (1.0 - part)),
            (second, 4.0 * part * (1.0 - part) * (1.0 - 2.0 * part)),
        ):
            each += SMOOTHING * factor[:, None, None] * (bends.T @ bends)
        scale = 1.0 / (np.pi * self.contact_modulus * size)
        pressed, by_width, bend = (np.matmul(each, load[..., None])[..., 0] for each in (matrix, first, second))
        energy, slope, curved = (0.5 * (load * each).sum(axis=1) for each in (pressed, by_width, bend))
        given = pressed + slope[:, None] * grow
        outer = by_width[:, :, None] * grow[:, None, :]
        grown = (
            np.eye(n) / square[:, None, None]
            + (0.5 / total**2)[:, None, None]
            - 2.0 * load[:, :, None] * load[:, None, :] / (square**2)[:, None, None]
        )
        hessian = matrix + outer + outer.swapaxes(1, 2)
        hessian += curved[:, None, None] * grow[:, :, None] * grow[:, None, :] + slope[:, None, None] * grown
        return scale * energy, scale * given, scale * hessian

    def _coefficients(self, place: FloatArray) -> FloatArray:
        """a_k and ε with first and second derivatives by ln(b/l), shape (3, contacts, slices + 1)."""
        pieces = np.concatenate((_lags(self.slices), self.ends[..., None]), axis=-1)
        start, stop = np.log(NARROWEST), np.log(WIDEST)
        spacing = (stop - start) / (_KNOTS - 1)
        held = place.clip(start, stop)
        at = (held - start) / spacing
        piece = np.minimum(at.astype(np.intp), _KNOTS - 2)
        t = (at - piece)[:, None]
        c0, c1, c2, c3, c4, c5 = pieces[:, piece]
        value = c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
        first = (c1 + t * (2.0 * c2 + t * (3.0 * c3 + t * (4.0 * c4 + t * 5.0 * c5)))) / spacing
        second = (2.0 * c2 + t * (6.0 * c3 + t * (12.0 * c4 + t * 20.0 * c5))) / spacing**2
        inside = (held == place)[:, None]
        return np.stack((value, np.where(inside, first, 0.0), np.where(inside, second, 0.0)))

    def _closed(self, free: FloatArray, radius: FloatArray, start: FloatArray | None) -> tuple[FloatArray, ...]:
        """The arrays of `SlicedContact` in its order, of contacts with something pressed together."""
        weights, z, n = self._weights, slice_heights(self.length, self.slices), self.slices
        load = self._line_load(free, radius)[0] @ weights if start is None else start.copy()
        bad = ~(load.sum(axis=1) > 0.0)
        if bad.any():
            load[bad] = self._line_load(free[bad], radius[bad])[0] @ weights
        history: list[float] = []
        going, before, fraction = np.arange(radius.size), np.full(radius.size, np.inf), np.ones(radius.size)
        way = np.zeros(load.shape)
        # Of the last evaluation: V, u, ∂u/∂F, q and its slope, and the approach that q is of.
        shapes = ((), (n,), (n, n), z.shape, z.shape, z.shape)
        last = tuple(np.zeros((radius.size, *shape)) for shape in shapes)
        for _ in range(MAX_ITERATIONS):
            now, here = load[going], radius[going]
            energy, pressed_in, by_load = self._coupling(now, here)
            local = free[going] - pressed_in[..., None]
            line, slope = self._line_load(local, here)
            left = line @ weights - now
            size = np.max(np.abs(left), axis=1)
            largest = np.max(now, axis=1)
            history.append(float(np.max(size / largest, initial=0.0)))
            done = size <= SETTLED * largest
            # Nothing but round-off of approaches is left where steps no longer help.
            done |= (size <= ROUND_OFF * largest) & (size >= 0.5 * before[going])
            for whole, part in zip(last, (energy, pressed_in, by_load, line, slope, local), strict=True):
                whole[going[done]] = part[done]
            worse = (size > before[going]) & (fraction[going] > 1e-3) & ~done
            # Back to a part of the last step where it made things worse.
            back = going[worse]
            fraction[back] *= 0.4
            load[back] = np.maximum(load[back] - (1.5 * fraction[back])[:, None] * way[back], 1e-3 * load[back])
            on = ~worse & ~done
            ahead = going[on]
            if ahead.size:
                stiff = slope[on] @ weights
                system = np.eye(n) + stiff[..., None] * by_load[on]
                step = np.linalg.solve(system, left[on][..., None])[..., 0]
                before[ahead], fraction[ahead] = size[on], 1.0
                moved = np.maximum(load[ahead] + step, 0.1 * load[ahead])
                way[ahead] = moved - load[ahead]
                load[ahead] = moved
            going = going[~done]
            if not going.size:
                break
        else:
            raise ConvergenceError("the slices of a line contact do not settle; load left over by the largest", history)
        energy, pressed_in, by_load, line, slope, local = last
        by_point = slope * weights
        stiff, leaning, turning = by_point.sum(axis=2), (by_point * z).sum(axis=2), (by_point * z**2).sum(axis=(1, 2))
        system = np.eye(n) + stiff[..., None] * by_load
        moved = np.linalg.solve(system, np.stack((stiff, leaning), axis=-1))
        back = np.matmul(by_load, moved)
        by_tilt = moved[..., 1].sum(axis=1)
        stored = self._plane_energy(local, line, radius) @ weights
        return (
            load.sum(axis=1),
            ((line * z) @ weights).sum(axis=1),
            moved[..., 0].sum(axis=1),
            by_tilt,
            turning - (leaning * back[..., 1]).sum(axis=1),
            stored.sum(axis=1) + (load * pressed_in).sum(axis=1) - energy,
            load,
            line,
        )

    def _plane_energy(self, approach: FloatArray, line_load: FloatArray, radius: FloatArray) -> FloatArray:
        """∫ q dδ = q δ − ∫ δ dq, N."""
        q = np.where(line_load > 0.0, line_load, 1.0)
        scale = 2.0 / (np.pi * self.contact_modulus)
        half_width = np.sqrt(2.0 * scale * q * radius[:, None, None])
        spent = scale * q**2 * 0.5 * (np.log(2.0 * DATUM * self.length / half_width) + 0.75)
        return np.where(line_load > 0.0, q * approach - spent, 0.0)
