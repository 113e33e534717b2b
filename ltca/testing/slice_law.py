"""What contacts in slices carry, by own quadratures: the formula of `ltca.laws.sliced_line` without its tables.

Independent of `ltca.laws.sliced_line` and `ltca.contact.influence`: kernels are integrals over two strips by quadrature, what the
slices press in is the slope of V by differences, and approaches follow from line loads in closed form, so that nothing is
searched. Shared is the table of the softer ends alone, which is a measurement and no formula.
"""

from __future__ import annotations

import json
from functools import cache

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, make_interp_spline

import ltca.laws.sliced_line as shipped
from ltca.arrays import FloatArray
from ltca.contact.free_end import FreeEnds

STEP = 1e-5
"""Step of the differences of V, by the largest load of a slice: curvature and round-off are both of 1e-10."""
_WIDTHS = np.linspace(np.log(1e-5), np.log(60.0), 481)


@cache
def _kernel(slices: int) -> CubicSpline:
    """Mean of l/r over two strips l long and 2b wide of the same energy as semi-elliptic pressure, by ln(b/l), for all lags."""
    # Two even distributions differ by a triangular one; the square of the variable takes the logarithm at its ends.
    nodes, weights = np.polynomial.legendre.leggauss(60)
    u, w = 0.5 * (1.0 + nodes), 0.5 * weights
    t = u**4
    inside, weight = np.concatenate((0.5 * t, 1.0 - 0.5 * t)), np.tile(4.0 * u**3 * w, 2) * 0.5
    strip = 2.0 * np.exp(1.25 - np.log(4.0)) * np.exp(_WIDTHS)[:, None]
    found = np.empty((_WIDTHS.size, slices))
    for lag in range(slices):
        total = np.zeros(_WIDTHS.size)
        for side in (-1.0, 1.0):
            apart = np.abs(lag + side * inside)
            even = 2.0 * (np.arcsinh(strip / apart) / strip - (np.hypot(apart, strip) - apart) / strip**2)
            total += (even * weight * (1.0 - inside)).sum(axis=1)
        found[:, lag] = total
    return CubicSpline(_WIDTHS, found)


@cache
def _softer_table(slices: int, free_ends: tuple[FreeEnds, ...]) -> BSpline:
    values = np.array(json.loads(shipped.TABLE.read_text(encoding="utf-8"))["softer"][str(slices)])
    if free_ends:
        knots = shipped.places()
        felt = sum(each.weight * _image_kernel(slices, each.reach)(knots)[:, 0, 0] for each in free_ends)
        values = values * (1.0 - felt / _image_kernel(slices, 1.0)(knots)[:, 0, 0]) ** 2
    return make_interp_spline(shipped.places(), values, k=5)


def _softer(slices: int, place: FloatArray, free_ends: tuple[FreeEnds, ...]) -> FloatArray:
    """By how much the end slices are softer at ln(b/l): the table, and straight on beyond it."""
    table, knots = _softer_table(slices, free_ends), shipped.places()
    held = np.clip(place, knots[0], knots[-1])
    return np.asarray(table(held) + table(held, 1) * (place - held))


@cache
def _image_kernel(slices: int, reach: float) -> CubicSpline:
    """The same of the images of strips in both end planes, `reach` half-lengths from the middle, for all pairs of strips."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    middle = np.arange(slices) - 0.5 * (slices - 1)
    # The sum of two places in strips is triangular about that of their middles; by the square of its distance from either end.
    u, w = 0.5 * (1.0 + nodes), 0.5 * weights
    t = u**4
    inside = np.concatenate((t - 1.0, 1.0 - t))
    weight = np.tile(4.0 * u**3 * w * t, 2)
    strip = 2.0 * np.exp(1.25 - np.log(4.0)) * np.exp(_WIDTHS)[:, None]
    sums = np.round(2.0 * (middle[:, None] + middle)).astype(int)
    by_sum = {}
    for total in np.unique(sums).tolist():
        found = np.zeros(_WIDTHS.size)
        for side in (1.0, -1.0):
            apart = np.maximum(slices * reach - side * (0.5 * total + inside), 1e-300)
            even = 2.0 * (np.arcsinh(strip / apart) / strip - (np.hypot(apart, strip) - apart) / strip**2)
            found += (even * weight).sum(axis=1)
        by_sum[total] = found
    return CubicSpline(_WIDTHS, np.array([[by_sum[each] for each in row] for row in sums.tolist()]).transpose(2, 0, 1))


def pressed_in(
    load: FloatArray,
    length: float,
    modulus: float,
    radius: FloatArray,
    free_ends: tuple[FreeEnds, ...] = (),
) -> FloatArray:
    """Return u of the slices of contacts that carry, mm, shape (contacts, slices), by differences of V."""
    step = STEP * load.max(axis=1)
    found = np.empty(load.shape)
    for number in range(load.shape[1]):
        ends = []
        for side in (1.0, -1.0):
            moved = load.copy()
            moved[:, number] += side * step
            ends.append(_together(moved, length, modulus, radius, free_ends))
        found[:, number] = (ends[0] - ends[1]) / (2.0 * step)
    return found


def _together(
    load: FloatArray, length: float, modulus: float, radius: FloatArray, free_ends: tuple[FreeEnds, ...]
) -> FloatArray:
    """V, N·mm."""
    n, size = load.shape[1], length / load.shape[1]
    mean = (load**2).sum(axis=1) / (size * load.sum(axis=1))
    ratio = np.sqrt(4.0 * mean * radius / (np.pi * modulus)) / size
    kernel = _kernel(n)(np.log(ratio))
    # What plane strain of the datum 4 L counts of a strip of 0.87 b.
    kernel[:, 0] -= 2.0 * (np.log(4.0 * n) + 1.5 - np.log(2.0 * np.exp(1.25 - np.log(4.0)) * ratio))
    lag = np.abs(np.arange(n)[:, None] - np.arange(n))
    form = np.einsum("ci,cij,cj->c", load, kernel[:, lag], load)
    form += ratio**2 / (1.0 + ratio**2) * (np.diff(load, 2, axis=1) ** 2).sum(axis=1)
    softer = _softer(n, np.log(ratio), free_ends)
    for each in free_ends:
        form += each.weight * np.einsum("ci,cij,cj->c", load, _image_kernel(n, each.reach)(np.log(ratio)), load)
    form -= softer * (load[:, 0] ** 2 + load[:, -1] ** 2)
    return np.asarray(form / (2.0 * np.pi * modulus * size))


def plane_approach(line_load: FloatArray, length: float, modulus: float, radius: FloatArray) -> FloatArray:
    """Return the approach of plane strain under line loads above zero, with the datum 4 L, mm."""
    half_width = np.sqrt(4.0 * line_load * radius / (np.pi * modulus))
    return np.asarray(2.0 * line_load / (np.pi * modulus) * (np.log(8.0 * length / half_width) + 0.5))
