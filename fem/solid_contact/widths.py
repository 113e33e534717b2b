r"""Pressure hats along the width: moments, integrals with the layers of a body, classes of a symmetric body.

Pressure is piecewise linear along the width, with vertices at the heights of a `WidthGrid`; both its ends carry.
Integrals run over segments between the vertices of the grid and of the layers, so that no shape function has a kink
inside one. Beyond the grid there is no pressure: a body may be longer than the contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem.errors import MeshError
from fem.solid.layers import Layers, Parity
from ltca.arrays import FloatArray

# Hats times quadratic shapes are cubic; profiles are smooth between their breaks.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthGrid:
    """Vertices of the pressure along the width.

    Attributes
    ----------
    heights : array, shape (n,)
        Ascending, mm; from 0 for pressures even along the width, else symmetric about 0 unless every body is meshed
        whole.
    even : bool
        Whether the pressure is even: heights are those of the upper half, integrals those over both halves.
    """

    heights: FloatArray
    even: bool

    def __post_init__(self) -> None:
        heights = np.array(self.heights, dtype=float)
        if heights.ndim != 1 or heights.size < 2 or not np.all(np.diff(heights) > 0.0):
            raise MeshError(f"heights of the pressure {heights.tolist()}: must be two at least, ascending, mm")
        if self.even and heights[0] != 0.0:
            raise MeshError(f"first height of an even pressure {heights[0]:g} mm: must be 0")
        heights.flags.writeable = False
        object.__setattr__(self, "heights", heights)

    @property
    def size(self) -> int:
        """Number of hats."""
        return int(self.heights.size)

    @property
    def is_symmetric(self) -> bool:
        """Whether the heights are their own mirror image in z = 0."""
        return self.even or bool(
            np.allclose(self.heights, -self.heights[::-1], rtol=0.0, atol=1e-12 * self.heights[-1])
        )

    def moments(self, density: Callable[[FloatArray], FloatArray], breaks: FloatArray | None = None) -> FloatArray:
        """Return ∫ χ f dz of every hat χ with a function f(z), shape (n,).

        `breaks` are heights at which f has a kink, mm. Of an even pressure both halves count and f has to be even.
        """
        z, weight, hats = self._points(np.zeros(0) if breaks is None else breaks)
        return np.asarray((weight * density(z)) @ hats)

    def classes(self) -> dict[Parity, FloatArray]:
        """Return by class the matrix from the pressures to those of the upper half in the class, shape (class, n).

        Even pressures are symmetric; others have a symmetric part (p(z) + p(−z))/2 and an antisymmetric one (p(z) −
        p(−z))/2.
        """
        if self.even:
            return {"symmetric": np.eye(self.size)}
        if not self.is_symmetric:
            raise MeshError("heights of the pressure are not symmetric about 0: bodies must be meshed whole")
        # With a vertex in the middle or without one.
        upper = self.size // 2
        centred = bool(self.size % 2)
        mirrored = np.eye(self.size)[::-1]
        even, odd = 0.5 * (np.eye(self.size) + mirrored), 0.5 * (np.eye(self.size) - mirrored)
        if not centred:
            raise MeshError("heights of the pressure must have a vertex at 0")
        return {"symmetric": even[upper:], "antisymmetric": odd[upper + 1 :]}

    def onto(self, layers: Layers) -> sp.csr_matrix:
        """Return ∫ ψ χ dz of the free shapes ψ of layers with the hats of their class, shape (free in the plane, class hats).

        Over both halves for the classes of half a body; of a body meshed whole the hats are those of the grid.
        """
        parity = layers.parity
        if parity == "whole" and self.even:
            raise MeshError("even pressures need a body in its symmetric class")
        own = self if parity == "whole" or self.even else WidthGrid(heights=self.heights[self.size // 2 :], even=True)
        z, weight, hats = own._points(layers.vertices)
        shapes = _layer_shapes(layers, z)[:, layers.free_in_plane]
        if parity == "antisymmetric":
            hats = hats[:, 1:]
        return sp.csr_matrix((shapes * weight[:, None]).T @ hats)

    def _points(self, breaks: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gauss points, weights and hats there, over segments between the vertices and other breaks within the grid."""
        low, high = self.heights[0], self.heights[-1]
        inside = breaks[(breaks > low) & (breaks < high)]
        ends = np.unique(np.concatenate([self.heights, inside]))
        ends = ends[np.concatenate([[True], np.diff(ends) > 1e-12 * (high - low)])]
        length = np.diff(ends)
        z = (ends[:-1, None] + 0.5 * length[:, None] * (_POINTS + 1.0)).ravel()
        weight = (0.5 * length[:, None] * _WEIGHTS).ravel() * (2.0 if self.even else 1.0)
        return z, weight, self.hats(z)

    def hats(self, z: FloatArray) -> FloatArray:
        """Return the hats at heights, shape (heights, n); zero beyond the grid."""
        cell = np.clip(np.searchsorted(self.heights, z, side="right") - 1, 0, self.size - 2)
        part = (z - self.heights[cell]) / (self.heights[cell + 1] - self.heights[cell])
        values = np.zeros((z.size, self.size))
        rows, inside = np.arange(z.size), (part >= 0.0) & (part <= 1.0)
        values[rows, cell] = np.where(inside, 1.0 - part, 0.0)
        values[rows, cell + 1] = np.where(inside, part, 0.0)
        return values


def _layer_shapes(layers: Layers, z: FloatArray) -> FloatArray:
    """Shapes of all nodes of layers at heights, shape (heights, nodes); zero beyond the body."""
    ends = layers.vertices
    layer = np.clip(np.searchsorted(ends, z, side="right") - 1, 0, ends.size - 2)
    xi = (z - ends[layer]) / (ends[layer + 1] - ends[layer])
    inside = (xi >= -1e-12) & (xi <= 1.0 + 1e-12)
    values = np.zeros((z.size, layers.heights.size))
    rows = np.arange(z.size)
    for local, shape in enumerate(((1.0 - xi) * (1.0 - 2.0 * xi), 4.0 * xi * (1.0 - xi), xi * (2.0 * xi - 1.0))):
        values[rows, 2 * layer + local] = np.where(inside, shape, 0.0)
    return values
