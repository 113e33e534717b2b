r"""An elastic cylinder between two rigid planes, solved with its true boundary: a reference for half-spaces.

Plane strain, linear elasticity, frictionless. No conformal map is needed: with Muskhelishvili's potentials the boundary
values of a disc of radius 1 under tractions t are

.. math:: 2\mu u = (\kappa + 1) \varphi - f, \quad f = i \int t\,ds = \sum A_k e^{ik\theta}, \quad
   \varphi = \tfrac12 A_1 e^{i\theta} + \sum_{k \ge 2} A_k e^{ik\theta},

Fourier series that are summed exactly. Beside it stands the half-plane under the same contact, with the parabola of the tables
or the true circle; its datum is that of Johnson, Eq. 5.57. Lengths are parts of the radius, pressures of E* = E/(1 − ν²).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ltca.arrays import FloatArray

POISSON_RATIO = 0.3
POINTS_PER_CELL = 8
PLANE_DATUM = (2.0 * np.log(2.0) - 2.0) / np.pi
"""Constant beside −(2/π)∫p ln|x − s| with which Hertz pressure gives (2 ln(4/b) − 1) q/π."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CylinderContact:
    """Result of one of the two contacts.

    Attributes
    ----------
    line_load : float
        Load by length, radius and E*.
    half_width : float
        2√⟨x²⟩ with the pressure as weight, by the radius.
    peak_pressure : float
        By E*.
    """

    line_load: float
    half_width: float
    peak_pressure: float


def hertz_approach(half_width: float) -> float:
    """Return the approach of centre and plane at a half-width, both by the radius (Hertz, and Johnson, Eq. 5.57)."""
    return 0.25 * half_width**2 * (2.0 * float(np.log(4.0 / half_width)) - 1.0)


def press_cylinder(approach: float, cells: int, reach: float) -> CylinderContact:
    """Press the cylinder with its true boundary to an approach of centre and plane, by the radius.

    `cells` divide half of the boundary up to the angle `reach`, rad, within which the contact must end.
    """
    edges, matrix = _cylinder(cells, reach)
    width = edges[1] - edges[0]
    gap = 1.0 - np.diff(np.sin(edges)) / width
    force = _press(matrix, approach - gap)
    return _contact(force, np.sin(0.5 * (edges[1:] + edges[:-1])), width)


def press_half_plane(approach: float, cells: int, reach: float, *, parabola: bool) -> CylinderContact:
    """Press a half-plane instead, as in `press_cylinder`, with the separation x²/2 of the tables or 1 − √(1 − x²) of the
    circle.
    """
    edges = reach * np.arange(cells + 1.0) / cells
    width = edges[1] - edges[0]
    if parabola:
        gap = np.diff(edges**3) / (6.0 * width)
    else:
        gap = 1.0 - np.diff(0.5 * (edges * np.sqrt(1.0 - edges**2) + np.arcsin(edges))) / width
    force = _press(_half_plane(cells, reach), approach - gap)
    return _contact(force, 0.5 * (edges[1:] + edges[:-1]), width)


@cache
def _cylinder(cells: int, reach: float) -> tuple[FloatArray, FloatArray]:
    """Edges of the cells, rad, and mean displacement towards the centre by unit forces on them and on their images."""
    count = POINTS_PER_CELL * round(2.0 * np.pi / (reach / cells))
    count += count % 2
    spacing = 2.0 * np.pi / count
    order = np.fft.fftfreq(count, 1.0 / count)
    middle = np.exp(0.5j * spacing * order)
    shear, kappa = 0.5 * (1.0 - POISSON_RATIO), 3.0 - 4.0 * POISSON_RATIO
    matrix = np.empty((cells, cells))
    for cell in range(cells):
        points = np.arange(cell * POINTS_PER_CELL, (cell + 1) * POINTS_PER_CELL)
        upward = np.zeros(count)
        upward[np.concatenate([points, count - 1 - points])] += 1.0 / POINTS_PER_CELL
        upward[np.concatenate([count // 2 - 1 - points, count // 2 + points])] -= 1.0 / POINTS_PER_CELL
        # i∫t ds of vertical forces, in a frame with θ from the lowest point: vectors turn by i.
        force = -1j * (np.cumsum(upward) - 0.5 * upward)
        series = np.fft.fft(force) / (count * middle)
        inner = np.where(order >= 2, series, 0.0)
        inner[1] = 0.5 * series[1].real
        displacement = (kappa + 1.0) * np.fft.ifft(inner * middle) * count - force
        centre = -(series[0] - 2.0 * np.conj(inner[2]))
        inward = -((displacement - centre) / (2.0 * shear)).real
        matrix[:, cell] = inward[: cells * POINTS_PER_CELL].reshape(cells, POINTS_PER_CELL).mean(axis=1)
    return spacing * POINTS_PER_CELL * np.arange(cells + 1.0), matrix


@cache
def _half_plane(cells: int, reach: float) -> FloatArray:
    """Mean displacement of the cells by unit forces on them and their images."""
    edges = reach * np.arange(cells + 1.0) / cells
    low, high = edges[:-1], edges[1:]

    def twice(distance: FloatArray) -> FloatArray:
        size = np.abs(distance)
        return np.asarray(0.5 * size**2 * np.log(np.where(size > 0.0, size, 1.0)) - 0.75 * size**2)

    def mean(first: FloatArray, last: FloatArray) -> FloatArray:
        """∬ ln|x − s| over cells and sources from first to last."""
        left, right = low[:, None], high[:, None]
        return twice(right - first) - twice(right - last) - twice(left - first) + twice(left - last)

    both = mean(low[None, :], high[None, :]) + mean(-high[None, :], -low[None, :])
    return np.asarray(-(2.0 / np.pi) * both / (edges[1] - edges[0]) ** 2 + 2.0 * PLANE_DATUM)


def _press(matrix: FloatArray, penetration: FloatArray) -> FloatArray:
    """Forces of the cells in contact; cells are exchanged until all conditions of contact hold."""
    touching = penetration > 0.0
    for _ in range(100):
        force = np.zeros(penetration.size)
        force[touching] = np.linalg.solve(matrix[np.ix_(touching, touching)], penetration[touching])
        below = matrix @ force < penetration - 1e-14
        after = np.where(touching, force > 0.0, below)
        if np.array_equal(after, touching):
            return force
        touching = after
    raise ArithmeticError("the cells in contact do not settle")


def _contact(force: FloatArray, place: FloatArray, width: float) -> CylinderContact:
    return CylinderContact(
        line_load=2.0 * float(force.sum()),
        half_width=2.0 * float(np.sqrt((force @ place**2) / force.sum())),
        peak_pressure=float(force[0]) / width,
    )
