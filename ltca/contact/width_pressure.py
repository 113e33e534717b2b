"""Pressure along the width of contacts in slices (stand-in until the function of the kernel is merged)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.contact.tracked_grid import ContactKind


@dataclass(frozen=True, slots=True, kw_only=True)
class WidthPressures:
    """Line load and pressure along contacts."""

    height: FloatArray
    line_load: FloatArray
    pressure: FloatArray
    largest: FloatArray
    place: FloatArray
    runs_off: BoolArray


def estimate_along_width(
    kind: ContactKind, contact: Any, effective_radius: FloatArray, heights: FloatArray | None = None
) -> WidthPressures:
    """Pressures from line loads at the points of slices."""
    points = contact.line_load.shape[-1]
    weights = np.polynomial.legendre.leggauss(points)[1] / 2.0
    return estimate_of_slices(
        kind, contact.line_load @ weights * kind.length / contact.line_load.shape[-2], effective_radius
    )


def estimate_of_slices(kind: ContactKind, slice_load: FloatArray, effective_radius: FloatArray) -> WidthPressures:
    """Pressures from loads of slices."""
    n = slice_load.shape[-1]
    size = kind.length / n
    z = (np.arange(n) - 0.5 * (n - 1)) * size
    line = slice_load / size
    pressure = np.sqrt(line * kind.contact_modulus / (np.pi * np.asarray(effective_radius)[..., None]))
    at = np.argmax(pressure, axis=-1)
    ends = line[..., [0, -1]] > 1e-3 * np.maximum(line.max(axis=-1), 1e-300)[..., None]
    return WidthPressures(
        height=z, line_load=line, pressure=pressure, largest=pressure.max(axis=-1), place=z[at], runs_off=ends
    )
