"""Pressures along the width from half-space grids of contacts that tilt, one solution for each contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.tilted_grid import SAMPLES, TiltedPiece, press_tilted
from ltca.laws.width_pressure import PatchAlongWidth, WidthPressures

HEIGHTS = 33
"""Heights at which pressures are given where none are asked for."""


def solve_along_width(
    kind: ContactKind,
    approach: FloatArray,
    tilt: FloatArray,
    effective_radius: FloatArray,
    heights: FloatArray | None = None,
    separations: Callable[..., tuple[Separation, Sequence[TiltedPiece]]] | None = None,
) -> WidthPressures:
    """Return pressures of contacts from half-space grids at their approaches and tilts, one solution for each that is closed.

    Parameters
    ----------
    kind : ContactKind
        Kind of the contacts.
    approach, tilt, effective_radius : array, shape (…)
        δ in the middle of the width, mm; θ, rad, positive presses positive z; ρ, mm.
    heights : array, shape (heights,), optional
        z, mm; default `HEIGHTS` even ones from end to end.
    separations : callable, optional
        Separation of the surfaces of a contact by its indices in the arrays, and pieces to start from
        (`ltca.contact.tilted_grid`); default the parabola x²/(2ρ) and none.
    """
    half = 0.5 * kind.length
    z = np.linspace(-half, half, HEIGHTS) if heights is None else np.asarray(heights, dtype=float)
    delta, theta, radius = np.broadcast_arrays(approach, tilt, effective_radius)
    lines, pressures = np.zeros((*delta.shape, z.size)), np.zeros((*delta.shape, z.size))
    largest, place, end_load = np.zeros(delta.shape), np.zeros(delta.shape), np.zeros((*delta.shape, 2))
    # A line that reaches nowhere is open: no tilt brings its ends further than that, and no lead its metal.
    metal = max(0.0, -float(kind.relief(np.linspace(-half, half, SAMPLES)).min()))
    for index in zip(*np.nonzero(delta + half * np.abs(theta) + metal > 0.0), strict=True):
        size = float(radius[index])
        separation, known = _parabola(size) if separations is None else separations(*index)
        pressed = press_tilted(kind, separation, float(delta[index]), float(theta[index]), known)
        if pressed is None:
            continue
        along = PatchAlongWidth.of_patch(pressed.patch, kind)
        lines[index], pressures[index] = along.means(along.line_load, z), along.means(along.peak, z)
        largest[index], place[index] = along.largest()
        end_load[index] = along.means(along.line_load, np.array((-half, half)))
    return WidthPressures(
        height=z,
        line_load=lines,
        even_line_load=lines,
        pressure=pressures,
        largest=largest,
        place=place,
        end_load=end_load,
    )


def _parabola(radius: float) -> tuple[Separation, tuple[TiltedPiece, ...]]:
    return Separation(effective_radius=radius, departure=lambda _, x: x**2 / (2.0 * radius)), ()
