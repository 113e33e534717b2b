r"""Layers along the axis of an extruded body: quadratic elements, graded towards the free ends.

Displacements of a body that is its own mirror image in z = 0 split into two classes under loads that are even or odd in z:

==============  ====================  =========
class           in the plane (u, v)   axial (w)
==============  ====================  =========
symmetric       even                  odd
antisymmetric   odd                   even
==============  ====================  =========

Half of the thickness serves both: an odd function is zero at z = 0, an even one is free there. Integrals are those over the whole
thickness, so that loads, energies and stiffness are those of the whole body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from fem.errors import MeshError
from ltca.arrays import FloatArray, IntArray

Parity = Literal["symmetric", "antisymmetric", "whole"]
"""Class of the displacements; "whole" for a body meshed over all of its thickness."""

# Products of two quadratic functions and a linear one: five points are exact beyond need.
GAUSS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Layers:
    """Quadratic layers along the axis.

    Attributes
    ----------
    vertices : array, shape (layers + 1,)
        Ascending heights of the ends of the layers, mm; from 0 to half the thickness for the classes of half a body.
    parity : {"symmetric", "antisymmetric", "whole"}
        Class of the displacements.
    """

    vertices: FloatArray
    parity: Parity

    def __post_init__(self) -> None:
        heights = np.array(self.vertices, dtype=float)
        if heights.ndim != 1 or heights.size < 2 or not np.all(np.diff(heights) > 0.0):
            raise MeshError(f"heights of layers {heights.tolist()}: must be two at least, ascending, mm")
        if self.parity != "whole" and heights[0] != 0.0:
            raise MeshError(f"first height of the layers {heights[0]:g} mm: must be 0 for half of a body")
        heights.flags.writeable = False
        object.__setattr__(self, "vertices", heights)

    @property
    def heights(self) -> FloatArray:
        """Heights of all nodes, ends and middles of the layers, mm, shape (2 layers + 1,)."""
        return with_middles(self.vertices)

    @property
    def thickness(self) -> float:
        """Of the whole body, mm."""
        extent = float(self.vertices[-1] - self.vertices[0])
        return extent if self.parity == "whole" else 2.0 * extent

    @property
    def free_in_plane(self) -> IntArray:
        """Nodes at which displacements in the plane are unknown."""
        first = 1 if self.parity == "antisymmetric" else 0
        return np.arange(first, self.heights.size)

    @property
    def free_along_axis(self) -> IntArray:
        """Nodes at which the axial displacement is unknown."""
        first = 1 if self.parity == "symmetric" else 0
        return np.arange(first, self.heights.size)

    @property
    def unknowns_per_node(self) -> int:
        """Unknowns at every node of a section: heights of u, v and w."""
        return 2 * self.free_in_plane.size + self.free_along_axis.size

    def unit_load(self, z: FloatArray) -> FloatArray:
        """Return the load by length at heights in the plane, 1/mm: of 1 N even along the thickness, or of 1 N·mm linear in z.

        Linear for the antisymmetric class. The same function measures: the mean of a displacement along the thickness, or its
        tilt.
        """
        if self.parity == "antisymmetric":
            return np.asarray(12.0 * z / self.thickness**3)
        return np.full(np.shape(z), 1.0 / self.thickness)

    def points(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return Gauss points, mm, their weights over the whole body, and shapes and slopes of all nodes there.

        Shapes of the arrays: (points,), (points,), (points, nodes), (points, nodes).
        """
        nodes, weights = GAUSS
        xi = 0.5 * (nodes + 1.0)
        size = np.diff(self.vertices)
        z = (self.vertices[:-1, None] + size[:, None] * xi).ravel()
        weight = (0.5 * size[:, None] * weights).ravel() * (1.0 if self.parity == "whole" else 2.0)
        shapes = np.stack([(1.0 - xi) * (1.0 - 2.0 * xi), 4.0 * xi * (1.0 - xi), xi * (2.0 * xi - 1.0)], axis=1)
        slopes = np.stack([4.0 * xi - 3.0, 4.0 - 8.0 * xi, 4.0 * xi - 1.0], axis=1)
        values, derivatives = np.zeros((z.size, self.heights.size)), np.zeros((z.size, self.heights.size))
        for layer in range(size.size):
            rows, own = slice(layer * xi.size, (layer + 1) * xi.size), slice(2 * layer, 2 * layer + 3)
            values[rows, own], derivatives[rows, own] = shapes, slopes / size[layer]
        return z, weight, values, derivatives

    def moments(self, density: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Return ∫ f ψ dz of a density f(z) with the shape of every node, over the whole body, shape (nodes,).

        For the classes of half a body the density has to have the parity of the displacements in the plane.
        """
        z, weight, values, _ = self.points()
        return np.asarray((weight * density(z)) @ values)


def with_middles(ends: FloatArray) -> FloatArray:
    """Return ends of cells with the middles between them, shape (2 n − 1,) for n ends."""
    found = np.empty(2 * ends.size - 1)
    found[0::2], found[1::2] = ends, 0.5 * (ends[1:] + ends[:-1])
    return found


def graded_layers(
    thickness: float, number: int, parity: Parity, *, finest: float = 0.5, marks: tuple[float, ...] = ()
) -> Layers:
    """Return layers that become thinner towards the free ends.

    Parameters
    ----------
    thickness : float
        Of the whole body, mm; it is its own mirror image in z = 0.
    number : int
        Layers over half of the thickness, at least 1.
    parity : {"symmetric", "antisymmetric", "whole"}
        Class of the displacements; "whole" gives twice as many layers.
    finest : float
        Thickness of the last layer by that of the first, in (0, 1]; geometric in between.
    marks : tuple of float
        Heights between 0 and half the thickness at which a layer has to end, mm: the nearest end moves there.

    Returns
    -------
    Layers

    Raises
    ------
    MeshError
        When a parameter is out of bounds.
    """
    if not (np.isfinite(thickness) and thickness > 0.0):
        raise MeshError(f"thickness {thickness:g} mm of an extruded body: must be greater than 0 mm")
    if number < 1 or not 0.0 < finest <= 1.0:
        raise MeshError(f"{number} layers, the last {finest:g} of the first: must be at least 1, and in (0, 1]")
    sizes = finest ** (np.arange(number) / max(number - 1, 1))
    half = 0.5 * thickness * np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    half[-1] = 0.5 * thickness
    for mark in marks:
        if not 0.0 < mark < 0.5 * thickness:
            raise MeshError(f"height {mark:g} mm of a layer's end: must be between 0 and {0.5 * thickness:g} mm")
        half[1 + int(np.argmin(np.abs(half[1:-1] - mark)))] = mark
    return Layers(vertices=half if parity != "whole" else np.concatenate([-half[:0:-1], half]), parity=parity)
