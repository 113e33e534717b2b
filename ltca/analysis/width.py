"""Along the width of contacts in slices: line loads, pressures, moments, tilts; nothing of the plane model.

Heights are above the middle of the contact. A tilt is a small rotation vector, about x and about y of the fixed frame, and so are
moments, about the middle of the disc.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.arrays import ComplexArray, FloatArray
from ltca.compliance.response import AlongWidth, bearing_moments
from ltca.drive.parts import Drive
from ltca.quantities import QUANTITIES

AXES = ("x", "y")
"""What the dimension ``axis`` stands for."""
HEIGHTS = {"pin": "z_pin", "roller": "z_roller", "hole": "z_hole"}
"""Coordinates of the heights of the slices, by the parts that a quantity belongs to."""


def width_values(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Return what one disc has along its width, (position, pair, slice), (position, pair) or (position, …, axis)."""
    pressures, response = analysis.pressures, analysis.full.response.parts[0]
    pins, outer, inner, holes = (
        each.along for each in (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    )
    if pins is None or outer is None or inner is None or holes is None:
        return {}
    (disc,) = analysis.model.discs
    angle, cranks = analysis.full.crank_angle, disc.geometry.placement.cranks
    lean = analysis.full.pose[:, disc.geometry.coordinates_of(analysis.full.pose).lean_place]
    rays = disc.geometry.rollers(angle)
    rollers, flank, in_holes = response.rollers, response.leaning_pins, response.leaning_holes
    assert flank is not None
    assert in_holes is not None
    assert rollers.leaning is not None
    values = {
        "pin_moment": flank.contact.moment,
        "roller_moment": rollers.leaning.outer.moment,
        "roller_moment_inner": rollers.leaning.inner.moment,
        "pin_shaft_moment": in_holes.contact.moment,
        "pin_line_load": pins.line_load,
        "roller_line_load": outer.line_load,
        "roller_line_load_inner": inner.line_load,
        "pin_shaft_line_load": holes.line_load,
        "disc_tilt": np.stack((-lean[:, 1], lean[:, 0]), axis=-1),
        "crank_bearing_moment": moments_of(bearing_moments(rollers, rays, cranks)),
    }
    for part, side, kind in (
        ("pin", "", pins),
        ("roller", "_outer", outer),
        ("roller", "_inner", inner),
        ("pin_shaft", "", holes),
    ):
        values[f"{part}_pressure_along_width{side}"] = kind.pressure
        values[f"{part}_pressure_max_place{side}"] = kind.place
    return values


def face_load_factors(analysis: LoadedAnalysis) -> dict[str, FloatArray]:
    """Return K_Hβ of all discs, shape (disc, position) or (disc, position, crank); nothing of the plane model.

    What carries little is judged by all joints of its kind together (`face_load_factor`).
    """
    pressures, discs = analysis.pressures, len(analysis.model.discs)
    pins, outer, inner, holes = (
        each.along for each in (pressures.pins, pressures.outer, pressures.inner, pressures.holes)
    )
    if pins is None or outer is None or inner is None or holes is None:
        return {}
    bearings = discs * analysis.model.discs[0].geometry.placement.cranks
    rollers = np.maximum(face_load_factor(outer, bearings), face_load_factor(inner, bearings))
    return {
        "pin_face_load_factor": face_load_factor(pins, discs).T,
        "roller_face_load_factor": np.moveaxis(rollers.reshape(rollers.shape[0], discs, -1), 0, 1),
        "pin_shaft_face_load_factor": face_load_factor(holes, discs).T,
    }


def moments_of(leverage: ComplexArray) -> FloatArray:
    """Return the moments about x and y, N·mm, of forces of which Σ F z is given, shape (…, 2)."""
    return np.stack((-leverage.imag, leverage.real), axis=-1)


CARRYING = 0.1
"""Part of the largest load of its kind from which a joint has a face load factor: what barely touches does so at a corner."""


STRETCHES = 9
"""Stretches of a contact over which line loads are averaged for the face load factor: the slices of the default."""


def face_load_factor(kind: AlongWidth, groups: int = 1, series: int = 1) -> FloatArray:
    """Return K_Hβ of groups of pairs, shape (positions, groups): the largest line load by the largest mean one.

    Line loads are without the bulge of ends that carry (`AlongWidth.even_line_load`), which grows without bound as slices become
    narrower: an aligned straight line has a factor of one. The largest one is a mean over a ninth of the length, whose place is
    free: slices are divided ever further towards an end of a tilted line, where the load rises, and their own largest would
    follow them; of fewer than nine slices it is that of a slice. It is that of the pair that carries most, where that has the
    largest line load as well; not a number where a group carries less than `CARRYING` of the most that any does at one of the
    positions, of `series` drives one after another.
    """
    slices = kind.line_load.shape[-1]
    shape = kind.line_load.shape[0], groups, -1, slices
    each = kind.even_line_load.reshape(shape)
    if not each.shape[2]:
        return np.full(each.shape[:2], np.nan)
    mean = each.mean(axis=3).max(axis=2)
    largest = (each @ _stretches(slices).T).max(axis=(2, 3))
    known = np.where(np.isfinite(mean), mean, 0.0).reshape(series, -1)
    least = np.repeat(CARRYING * known.max(axis=1), mean.shape[0] // series)[:, None]
    carries = (mean > 0.0) & (mean >= least)
    return np.asarray(np.divide(largest, mean, out=np.full(mean.shape, np.nan), where=carries))


@cache
def _stretches(slices: int) -> FloatArray:
    """Shares of the slices in means over stretches, shape (stretches, slices): those that begin or end where a slice does.

    Line loads are even over each slice, so that the largest mean over any stretch is among these.
    """
    edges = np.arange(slices + 1.0)
    length = max(1.0, slices / STRETCHES)
    start = np.unique(np.concatenate((edges, edges - length)).clip(0.0, slices - length).round(12))[:, None]
    within = np.minimum(start + length, edges[1:]) - np.maximum(start, edges[:-1])
    return np.asarray(np.maximum(within, 0.0) / length)


def width_coordinates(drives: Mapping[str, Drive]) -> dict[str, Any]:
    """Return the coordinates of slices and axes; none in the plane."""
    slices = next(iter(drives.values())).contact.slices
    if slices == 1:
        return {}
    place = (np.arange(slices) - 0.5 * (slices - 1)) / slices
    lengths = {
        "z_pin": [drive.disc.thickness for drive in drives.values()],
        "z_roller": [drive.roller_length for drive in drives.values()],
        "z_hole": [drive.disc.thickness for drive in drives.values()],
    }
    return {
        "slice": np.arange(slices),
        "axis": list(AXES),
        **{name: QUANTITIES[name].labelled(np.outer(each, place)) for name, each in lengths.items()},
    }
