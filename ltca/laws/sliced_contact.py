"""What contacts in slices carry, whatever their law, and where a neighbour of theirs starts from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ltca.arrays import FloatArray, map_arrays

POINTS = 4
"""Points of a slice at which its surfaces' approach is taken (Gauss)."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(POINTS)
SHARES = 0.5 * _WEIGHTS
"""Parts of the points in the mean over a slice."""
LARGEST_EXTRAPOLATION = 0.3
"""Change of a slice's load by the largest up to which slopes tell it."""
LAST_STEP_ERROR = 1e4
"""Bound of what a last step along slopes leaves over, by the square of what was left before it."""


class Exactness(NamedTuple):
    """How close slices come to balance before their last step, which is taken along slopes and squares what is left."""

    slices: float
    """Load of a slice that is left over by the largest of its contact."""
    steady: float
    """Change of a point's approach by itself in the last step."""


EXACT = Exactness(slices=1e-8, steady=1e-3)
"""To round-off: line loads follow their slopes so far."""
ROUGH = Exactness(slices=3e-3, steady=0.3)
"""While a search is on its way: 1e-5 of a load."""


@cache
def slice_heights(length: float, slices: int) -> FloatArray:
    """Return z of the points of the slices of a line of a length in mm, shape (slices, points)."""
    middle = (np.arange(slices) - 0.5 * (slices - 1)) * length / slices
    return np.asarray(middle[:, None] + 0.5 * length / slices * _NODES)


def slice_means(values: FloatArray) -> FloatArray:
    """Return the means over slices of values at their points, shape (…, slices, points)."""
    return np.asarray(values @ SHARES)


def rows_of(relief: FloatArray, places: Any) -> FloatArray:
    """Return the reliefs of some contacts, by a mask or arrays of numbers; one that all share as it is."""
    if relief.ndim == 2:
        return relief
    return relief[places[0] if isinstance(places, tuple) else np.nonzero(places)[0]]


@cache
def _sums(length: float, slices: int) -> FloatArray:
    """Weights of all points of a line for ∫ z dz, for ∫ dz and ∫ z dz of each slice, and for ∫ z² dz, shape (points, 2 n + 2)."""
    z, own = slice_heights(length, slices).ravel(), np.repeat(np.eye(slices), POINTS, axis=0)
    weights = length / slices * np.tile(SHARES, slices)
    return np.asarray(weights[:, None] * np.column_stack((z, own, own * z[:, None], z**2)))


@dataclass(frozen=True, slots=True, kw_only=True)
class SlicedContact:
    """Contacts in slices at some approaches and tilts, zero where open, shape (…)."""

    load: FloatArray  # Σ F, N
    moment: FloatArray  # Σ ∫ q z dz, N·mm: turns positive z into the other body
    by_approach: FloatArray  # ∂F/∂δ, N/mm
    by_tilt: FloatArray  # ∂F/∂θ = ∂M/∂δ, N/rad
    moment_by_tilt: FloatArray  # ∂M/∂θ, N·mm/rad
    slice_load: FloatArray  # F_i, N, shape (…, slices)
    line_load: FloatArray  # q at the points of the slices, N/mm, shape (…, slices, points)
    near: FloatArray  # δ, θ, F_i, ∂F_i/∂δ, ∂F_i/∂θ for `loads_nearby`, shape (…, 2 + 3 slices); or nothing, (…, 0)
    left: FloatArray  # force that may be left over of the slices, N

    @classmethod
    def open(cls, contacts: int, slices: int) -> SlicedContact:
        """Return a row of contacts that carry nothing."""
        names = "load", "moment", "by_approach", "by_tilt", "moment_by_tilt", "left"
        return cls(
            **{name: np.zeros(contacts) for name in names},
            slice_load=np.zeros((contacts, slices)),
            line_load=np.zeros((contacts, slices, POINTS)),
            near=np.zeros((contacts, 2 + 3 * slices)),
        )

    def put(self, rows: NDArray[np.intp], part: SlicedContact) -> None:
        """Write what some of a row of contacts are now."""
        for name in self.__slots__:
            getattr(self, name)[rows] = getattr(part, name)

    def shaped(self, shape: tuple[int, ...]) -> SlicedContact:
        """Return a row of contacts in a shape."""
        found: SlicedContact = map_arrays(lambda values: values.reshape((*shape, *values.shape[1:])), self)
        return found

    @classmethod
    def of_separate(
        cls, approach: FloatArray, tilt: FloatArray, line_load: FloatArray, line_slope: FloatArray, length: float
    ) -> SlicedContact:
        """Return contacts of separate slices from line loads, N/mm, and derivatives, N/mm², (…, slices, points)."""
        shape, slices = line_load.shape[:-2], line_load.shape[-2]
        sums = _sums(length, slices)
        carried = line_load.reshape(-1, slices * POINTS) @ sums[:, : slices + 1]
        stiff = line_slope.reshape(-1, slices * POINTS) @ sums
        each = [
            values.reshape(*shape, slices)
            for values in (carried[:, 1:], stiff[:, 1 : slices + 1], stiff[:, slices + 1 : -1])
        ]
        return cls(
            load=each[0].sum(axis=-1),
            moment=carried[:, 0].reshape(shape),
            by_approach=each[1].sum(axis=-1),
            by_tilt=stiff[:, 0].reshape(shape),
            moment_by_tilt=stiff[:, -1].reshape(shape),
            slice_load=each[0],
            line_load=line_load,
            near=np.concatenate((approach[..., None], tilt[..., None], *each), axis=-1),
            left=np.zeros(shape),
        )

    @property
    def kept(self) -> SlicedContact:
        """The contacts without what a search alone asks for."""
        return replace(self, near=self.near[..., :0])

    def moved(
        self, approach: FloatArray, tilt: FloatArray, load: FloatArray, half: FloatArray | float
    ) -> SlicedContact:
        """Return contacts moved along the slopes of their slices, with loads and moments by `half`, (positions, 2, contacts)."""
        force, moment = load[:, 0], load[:, 1] * half
        if not self.near.shape[-1]:
            return replace(self, load=force, moment=moment)
        near = self.near.copy()
        at, leaned, loads, by_approach, by_tilt = _parts(near)
        added = approach[..., None] * by_approach + tilt[..., None] * by_tilt
        at += approach[..., None]
        leaned += tilt[..., None]
        loads += added
        slice_load = np.maximum(self.slice_load + added, 0.0)  # one that opens on the way does not pull
        grown = np.divide(slice_load, self.slice_load, out=np.ones(added.shape), where=self.slice_load > 0.0)
        line_load = self.line_load * grown[..., None]
        return replace(self, load=force, moment=moment, slice_load=slice_load, line_load=line_load, near=near)


def _parts(near: FloatArray) -> list[FloatArray]:
    """Views of δ, θ, F_i, ∂F_i/∂δ and ∂F_i/∂θ in `SlicedContact.near`."""
    slices = (near.shape[-1] - 2) // 3
    return np.split(near, (1, 2, 2 + slices, 2 + 2 * slices), axis=-1)


def loads_nearby(near: FloatArray, approach: FloatArray, tilt: FloatArray) -> FloatArray:
    """Return loads of slices, N, (contacts, slices), from `near` ones, along their slopes where the change is small."""
    at, leaned, load, by_approach, by_tilt = _parts(near)
    moved = (approach[:, None] - at) * by_approach + (tilt[:, None] - leaned) * by_tilt
    trusted = (np.abs(moved) < LARGEST_EXTRAPOLATION * load.max(axis=1, keepdims=True)).all(axis=1, keepdims=True)
    return np.asarray(np.where(trusted, np.maximum(load + moved, 0.0), load))
