"""Pairs of solid bodies in contact: Hertz' point, a long line and its free ends, crowned lines aligned and tilted, CalculiX."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.solved_pair import (
    ELEMENTS_PER_HALF_WIDTH,
    END_ROOM,
    PairLoad,
    PairMeshes,
    SolvedPair,
    smooth_along_width,
    solve_pair,
)
from ltca.arrays import FloatArray
from ltca.contact.contact_kind import ContactKind, Separation
from ltca.contact.free_end import guilbault_factor
from ltca.contact.hertz import line_half_width, line_peak_pressure
from ltca.contact.pressure_cells import PatchSolution, solve_cylinder_patch
from ltca.contact.tilted_grid import press_tilted
from ltca.drive.parts import Material, contact_modulus
from ltca.geometry.length_profile import Relief
from validation.levels.other_code_problems import CODES, CROWNED_PAIRS
from validation.levels.other_codes import compare_answers, stored_answer
from validation.manual.case import Case, Figure, Reference, absolute_figure, relative_figure
from validation.manual.error_bars import error_by_size
from validation.methods.grid_pressures import solve_along_width

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)
MODULUS = contact_modulus(STEEL, STEEL)
CLOSED_FORM = "None beyond round-off: a closed form."
PRESSURE_BOUND, LOAD_BOUND = 3e-2, 1e-2
ASKED = "asked of solid pairs against other theories where bodies are large"
BLOCKS = (
    "Two blocks cut from the bodies and pressed together (`fem.solid_contact.solved_pair.solve_pair`), held in all directions "
    "at sides and bottom, free along the axis; nine-node quadrilaterals times quadratic layers, pressure bilinear over arc and "
    "height, p ≥ 0 and gap ≥ 0 in the mean."
)
PATCH = 0.5
"""Half the width of the patch over which pressures are read, by the half-width of theory: that of the parabola by which `fem`
reads a peak (`fem.contact.pressure_measures.PEAK_WINDOW`), for which the coarse meshes here have too few vertices."""
PATCH_MEAN = float(0.5 * (np.sqrt(1.0 - PATCH**2) + np.arcsin(PATCH) / PATCH))
"""Mean of √(1 − t²) over the patch: that of an ellipse by its peak."""
PATCHES = (
    "Pressures are means over a patch half as wide as the contact of theory, the same on all meshes and in the reference: single "
    "vertices swing with where the rim falls in a cell, means over a patch far from it little."
)
NOT_NESTED = (
    "Where the rim of a contact falls within a cell changes with the size, so that values swing; the error bar is then their "
    "whole spread, or three times that (`fem.discretisation_error`)."
)


def _error(found: Sequence[SolvedPair], values: Sequence[float]) -> float:
    """Error bar of the last of values on meshes, with the ratios of their elements."""
    ratios = [coarse.element_edge / fine.element_edge for coarse, fine in pairwise(found)]
    return error_by_size(values, ratios)


def _origin(found: Sequence[SolvedPair], half_width: float) -> str:
    per_half_width = ", ".join(f"{half_width / one.element_edge:.2g}" for one in found)
    return (
        f"three meshes, {per_half_width} elements for the half-width: grid convergence index, or the spread where values swing "
        "(ASME V&V 20, `fem.discretisation_error`)"
    )


def means_over_patch(solved: SolvedPair, half_width: float) -> FloatArray:
    """Return means of the pressure over a patch along the width, MPa, shape (heights,).

    Parameters
    ----------
    solved : SolvedPair
        A pair that is symmetric about the middle of the profile.
    half_width : float
        By theory, mm; the patch reaches `PATCH` of it to either side.
    """
    pressure, x, reach = smooth_along_width(solved.height, solved.pressure), solved.x, PATCH * half_width
    # Piecewise linear: the trapezoidal rule with the ends of the patch among the places is exact.
    places = np.sort(np.concatenate([x[np.abs(x) < reach], [-reach, reach]]))
    return np.array([np.trapezoid(np.interp(places, x, each), places) for each in pressure.T]) / (2.0 * reach)


# A point

POINT_RADIUS, POINT_LOAD, POINT_BLOCK = 10.0, 100.0, 1.5
POINT_SIZES = (2.0, 1.4, 1.0)


@cache
def press_point(size: float) -> SolvedPair:
    """Press a sphere-like body, a cylinder with a crown of its own radius, on a flat."""

    def crown(z: FloatArray) -> FloatArray:
        return np.asarray(np.square(z) / (2.0 * POINT_RADIUS))

    pair = SolidPair.round_bodies(POINT_RADIUS, 0.0, STEEL, 2.0 * POINT_BLOCK, relief=crown)
    return solve_pair(pair, PairLoad(load=POINT_LOAD), PairMeshes(size=size, block=POINT_BLOCK))


def radius_along_width(solved: SolvedPair) -> float:
    """Return the radius of a point contact from how its load is spread along the width, mm: ⟨z²⟩ = a²/5 of an ellipsoid."""
    z, line = solved.height, solved.line_load
    return float(np.sqrt(5.0 * np.trapezoid(line * z**2, z) / np.trapezoid(line, z)))


def _point() -> list[Figure]:
    radius = (3.0 * POINT_LOAD * POINT_RADIUS / (4.0 * MODULUS)) ** (1.0 / 3.0)
    peak = 3.0 * POINT_LOAD / (2.0 * np.pi * radius**2)
    found = [press_point(size) for size in POINT_SIZES]
    cell = "the rim lies within an element, an eighth of the radius at the finest: errors go by its square"
    return [
        relative_figure(
            quantity, values[-1], reference, unit, bound, reason,
            numerical_error=_error(found, values) / reference, numerical_origin=_origin(found, radius),
        )
        for quantity, values, reference, unit, bound, reason in (
            ("pressure in the middle, mean over the patch", [_middle(one, means_over_patch(one, radius)) for one in found],
             PATCH_MEAN * peak, "MPa", PRESSURE_BOUND, ASKED),
            ("radius of the contact along the width", [radius_along_width(one) for one in found], radius, "mm", 2e-2, cell),
            ("half-width of the contact in the middle", [_middle(one, one.half_width) for one in found], radius, "mm",
             PRESSURE_BOUND, f"{cell}; 3 %, set when values of coarser meshes had been seen (−1.5 %)"),
            ("approach", [one.approach for one in found], radius**2 / POINT_RADIUS, "mm", None,
             "blocks end eight radii away, where half-spaces go on yielding by F/(π E* 8a) and more: 5 to 10 % of the approach"),
        )
    ]  # fmt: skip


def _middle(solved: SolvedPair, values: FloatArray) -> float:
    """Of values along the width the one at mid-height."""
    return float(values[solved.height.size // 2])


# A long line and its ends

LINE_RADIUS, LINE_LENGTH, LINE_LOAD = 5.0, 11.8, 2000.0
LINE_SIZES = tuple(END_ROOM * ELEMENTS_PER_HALF_WIDTH / columns for columns in (6, 8, 12))
"""Columns from the middle to the end of the zone: with these the rim lies at 0.2, 0.3 and 0.4 of a cell, so that values of three
meshes fall evenly."""


@cache
def press_line(size: float) -> SolvedPair:
    """Press a straight roller on a flat, both with flush free ends."""
    pair = SolidPair.round_bodies(LINE_RADIUS, 0.0, STEEL, LINE_LENGTH)
    return solve_pair(pair, PairLoad(load=LINE_LOAD), PairMeshes(size=size, block=12.0))


def _long_line() -> list[Figure]:
    found = [press_line(size) for size in LINE_SIZES]
    # By the line load in the middle of each: what the ends leave to it is another question.
    lines = [_middle(one, one.line_load) for one in found]
    width = line_half_width(lines[-1], LINE_RADIUS, MODULUS).item()
    peak = line_peak_pressure(lines[-1], LINE_RADIUS, MODULUS).item()
    origin = _origin(found, width)
    figures = [
        relative_figure(
            quantity, values[-1], reference, unit, 1e-2,
            "60 half-widths from either end; five elements and more for the half-width leave some tenths of a per cent",
            numerical_error=_error(found, values) / reference, numerical_origin=origin,
        )
        for quantity, values, reference, unit in (
            ("pressure in the middle, mean over the patch", [_middle(one, means_over_patch(one, width)) for one in found],
             PATCH_MEAN * peak, "MPa"),
            ("half-width in the middle", [_middle(one, one.half_width) for one in found], width, "mm"),
        )
    ]  # fmt: skip
    totals = [float(np.trapezoid(one.line_load, one.height)) for one in found]
    return [
        *figures,
        relative_figure(
            "line load along the width, integrated", totals[-1], LINE_LOAD, "N", 5e-3,
            "line loads are straight lines between the heights of the mesh, thin at the ends, where they fall",
            numerical_error=_error(found, totals) / LINE_LOAD, numerical_origin=origin,
        ),
    ]  # fmt: skip


LINE_WIDTH = line_half_width(LINE_LOAD / LINE_LENGTH, LINE_RADIUS, MODULUS).item()
"""Half-width under the mean line load, mm."""
INSIDE = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Places by half-widths from the end; the law is asked for from one half-width on."""


@cache
def press_images(cells: int) -> PatchSolution:
    """Press the line on half-spaces with its images in both ends, so many cells over the half-width, at the same load."""
    factor = guilbault_factor(STEEL.poisson_ratio)

    def images(approach: float) -> PatchSolution:
        return solve_cylinder_patch(LINE_LENGTH, LINE_RADIUS, MODULUS, approach, cells=cells, end_factor=factor)

    return images(float(brentq(lambda each: images(each).load - LINE_LOAD, 3e-3, 2e-2, xtol=1e-7)))


def ends_of_solids(solved: SolvedPair) -> list[float]:
    """Return the pressure by that in the middle at places inside the end, means over the patch, and K_Hβ."""
    upper = solved.height >= 0.0
    z, mean = solved.height[upper], means_over_patch(solved, LINE_WIDTH)[upper]
    return [*(float(np.interp(place, z, mean) / mean[0]) for place in _places()), solved.load_factor]


def ends_of_images(images: PatchSolution) -> list[float]:
    """Return the same of half-spaces with images."""
    grid = images.grid
    z = 0.5 * (grid.y_edges[1:] + grid.y_edges[:-1])
    # A quarter of the grid carries for the whole contact across.
    line = grid.images / 2 * np.diff(grid.x_edges) @ images.pressure
    # Constant over each cell: exact up to the end of the patch, in part of a cell too.
    up_to = np.vstack([np.zeros(z.size), np.cumsum(np.diff(grid.x_edges)[:, None] * images.pressure, axis=0)])
    mean = np.array([np.interp(PATCH * LINE_WIDTH, grid.x_edges, each) for each in up_to.T])
    return [
        *(float(np.interp(place, z, mean) / mean[0]) for place in _places()),
        float(line.max() / (LINE_LOAD / LINE_LENGTH)),
    ]


def _places() -> FloatArray:
    return np.asarray(0.5 * LINE_LENGTH - np.array(INSIDE) * LINE_WIDTH)


def _free_ends() -> list[Figure]:
    solved = [press_line(size) for size in LINE_SIZES]
    found = np.array([ends_of_solids(one) for one in solved])
    coarse, laws = (np.array(ends_of_images(press_images(cells))) for cells in (16, 24))
    asked = "asked of the law of the end: 5 % of the largest pressure from a half-width inside on, and of K_Hβ"
    figures = []
    for number, inside in enumerate((*INSIDE, None)):
        name = "K_Hβ" if inside is None else f"pressure {inside:g} b inside the end, by that in the middle"
        near = inside is not None and inside < 1.0
        figures.append(
            absolute_figure(
                name, float(found[-1, number]), float(laws[number]), "", None if near else 5e-2,
                "no bound nearer to the end than a half-width: images leave more there than solid bodies have" if near else asked,
                numerical_error=_error(solved, found[:, number].tolist()), numerical_origin=_origin(solved, LINE_WIDTH),
                reference_error=abs(float(laws[number] - coarse[number])),
            )
        )  # fmt: skip
    return figures


# A crowned line

CROWN_RADIUS, CROWN_LENGTH, CROWN_DROP, CROWN_LOAD, TILT = 10.0, 8.0, 0.01, 1500.0, 3e-4
CROWN_SIZES = (2.8, 2.0, 1.4)
NEAR, FAR_SIZE = 12.0, 4.0
"""Depth of the blocks, mm, and the size with which what is beyond them is found."""
CROWN = Relief(length=CROWN_LENGTH, crown_radius=CROWN_LENGTH**2 / (8.0 * CROWN_DROP))


@cache
def press_crown(size: float, tilt: float, block: float) -> SolvedPair:
    """Press a crowned line on a flat: bodies as deep as they go on beyond it, so that they are half-spaces but for their size."""
    pair = SolidPair.round_bodies(CROWN_RADIUS, 0.0, STEEL, CROWN_LENGTH, relief=CROWN.relief)
    return solve_pair(
        pair, PairLoad(load=CROWN_LOAD, tilt=tilt), PairMeshes(size=size, block=block, overhang=block)
    )  # fmt: skip


def approach_beyond() -> tuple[float, float]:
    """Return what half-spaces yield beyond the blocks under the load, and its error, mm.

    Bodies held at the distance D yield less by c F/D: blocks twice and half as deep give c, and the difference between both is
    the error.
    """
    half, near, double = (press_crown(FAR_SIZE, 0.0, block).approach for block in (0.5 * NEAR, NEAR, 2.0 * NEAR))
    beyond = 2.0 * (double - near)
    return beyond, abs(beyond - (near - half))


@dataclass(frozen=True, slots=True, kw_only=True)
class CrownOnGrid:
    """A crowned line on grids of half-spaces under the load.

    Attributes
    ----------
    approach, stiffness, moment, largest : float
        mm, N/mm, N·mm, MPa.
    """

    approach: float
    stiffness: float
    moment: float
    largest: float


@cache
def press_on_grid(tilt: float, cells: int) -> CrownOnGrid:
    """Press the crowned line on half-spaces, so many cells over the half-width and half of the length."""
    kind = ContactKind(length=CROWN_LENGTH, contact_modulus=MODULUS, generator=CROWN, symmetric=True, cells=cells)
    separation = Separation(effective_radius=CROWN_RADIUS, departure=lambda _, x: x**2 / (2.0 * CROWN_RADIUS))

    def missing(approach: float) -> float:
        found = press_tilted(kind, separation, approach, tilt)
        return (0.0 if found is None else found.load) - CROWN_LOAD

    approach = float(brentq(missing, 2e-3, 3e-2, xtol=1e-9))
    found = press_tilted(kind, separation, approach, tilt)
    if found is None:
        raise ValueError(f"tilt {tilt:g}: the line is open")
    along = solve_along_width(kind, np.array([approach]), np.array([tilt]), np.array([CROWN_RADIUS]))
    return CrownOnGrid(
        approach=approach, stiffness=found.by_approach, moment=found.moment, largest=float(along.largest[0])
    )  # fmt: skip


def _crown(tilt: float) -> list[Figure]:
    found = [press_crown(size, tilt, NEAR) for size in CROWN_SIZES]
    coarse, grid = press_on_grid(tilt, 12), press_on_grid(tilt, 20)
    beyond, error = approach_beyond()
    # At the approach of the grids the load differs by the stiffness times the difference of the approaches.
    loads = [CROWN_LOAD - (one.approach + beyond - grid.approach) * grid.stiffness for one in found]
    width = 2.0 * CROWN_RADIUS * grid.largest / MODULUS
    means = [float(means_over_patch(one, width).max()) for one in found]
    moments = [one.moment for one in found]
    largest = PATCH_MEAN * grid.largest
    origin = _origin(found, width)
    figures = [
        relative_figure(
            "largest pressure, mean over the patch", means[-1], largest, "MPa", PRESSURE_BOUND, ASKED,
            numerical_error=_error(found, means) / largest, numerical_origin=origin,
            reference_error=abs(coarse.largest / grid.largest - 1.0),
        ),
        relative_figure(
            "load at the approach of half-spaces", loads[-1], CROWN_LOAD, "N", LOAD_BOUND, ASKED,
            numerical_error=float(np.hypot(_error(found, loads), error * grid.stiffness)) / CROWN_LOAD,
            numerical_origin=f"{origin}; with what is beyond the blocks, from blocks of 6, 12 and 24 mm",
            reference_error=abs(coarse.approach - grid.approach) * grid.stiffness / CROWN_LOAD,
        ),
    ]  # fmt: skip
    if tilt:
        figures.append(
            relative_figure(
                "moment about mid-length", moments[-1], grid.moment, "N·mm", PRESSURE_BOUND,
                "a crown rolls by R θ, 0.24 mm: layers of 0.2 to 0.35 mm at the ends of the contact leave a per cent in doubt",
                numerical_error=_error(found, moments) / grid.moment, numerical_origin=origin,
                # The grids find a crown's roll exactly: what is left is that of their balance.
                reference_error=max(abs(coarse.moment / grid.moment - 1.0), 1e-6),
            )
        )  # fmt: skip
    return figures


# CalculiX

FINER = 2.0
"""Size with which the error bar of the pairs is found."""


def _calculix() -> list[Figure]:
    code = CODES[CALCULIX]
    rows = compare_answers(CALCULIX, code.ours(), stored_answer(CALCULIX), CALCULIX)
    errors = []
    for pair in CROWNED_PAIRS:
        same, finer = pair.solved(), replace(pair, size=FINER).solved()
        errors += [finer.load / same.load - 1.0, finer.largest_pressure / same.largest_pressure - 1.0]
    return [
        Figure.of_row(
            row,
            numerical_error=abs(error),
            numerical_origin="change of load and largest pressure by two thirds of the size, which both codes share in part",
            reference_error=abs(error),
        )
        for row, error in zip(rows, errors, strict=True)
    ]


CALCULIX = "CalculiX C3D20R"
GRIDS = Reference(
    source="Half-space grids of the whole surface (`ltca.contact.tilted_grid`), 20 cells over the half-width and half of the "
    "length: Boussinesq's solution by Love's rectangles",
    uncertainty="Difference to 12 cells, on the page; tamaas judges the grids in turn (tests/referee).",
)
CROWNED_PROBLEM = (
    "A crowned cylinder (radius 10 mm, 8 mm long, drop 10 µm at the ends) on a flat, E 210 000 MPa, ν 0.3, 1500 N, {}: largest "
    "pressure, and the load at the same approach{}."
)
CROWNED_MODEL = (
    f"{BLOCKS} Blocks 12 mm deep, 24 mm wide and 32 mm long, where half-spaces go on: what those yield beyond is in proportion "
    "to the load and by one over the depth, and is found from blocks half and twice the size. Compared at the same load; the "
    "load at the same approach follows from the difference of the approaches and the stiffness of the grid. The finest mesh "
    "has about six elements for the half-width, so that the page takes some minutes."
)
CASES = (
    Case(
        name="solid_point_contact",
        title="Hertz' point contact by solid finite elements",
        problem="A body with both radii 10 mm on a flat, E 210 000 MPa, ν 0.3, 100 N: largest pressure, radius of the contact "
        "along the width and across, and the approach.",
        references=(
            Reference(source="Hertz; Johnson, *Contact Mechanics*, Eqs. 4.22 to 4.24", uncertainty=CLOSED_FORM),
        ),
        model=f"{BLOCKS} Blocks 1.5 mm deep, 3 mm wide and long, eight radii of the contact. {PATCHES}",
        model_uncertainty=f"Half-spaces are cut off at eight radii, which moves the approach. {NOT_NESTED}",
        long=True,
        run=_point,
        bodies="solid",
    ),
    Case(
        name="solid_long_line",
        title="The middle of a long line of contact",
        problem="A straight cylinder (radius 5 mm, 11.8 mm long) on a flat of the same length, E 210 000 MPa, ν 0.3, 2000 N: "
        "pressure and half-width in the middle, by the line load found there.",
        references=(
            Reference(
                source="Hertz' line in plane strain under the line load in the middle; Johnson, *Contact Mechanics*, 4.2(c)",
                uncertainty="Plane strain in the middle of a line 60 half-widths long to either side: end effects fall with "
                "the distance; the line load is our own.",
            ),
        ),
        model=f"{BLOCKS} Blocks 12 mm deep, 24 mm wide. The finest mesh has 6.4 elements for the half-width, so that the page "
        f"takes some minutes. {PATCHES}",
        model_uncertainty=NOT_NESTED,
        long=True,
        run=_long_line,
        bodies="solid",
    ),
    Case(
        name="solid_free_end",
        title="Free ends of a straight line",
        problem="The ends of a straight cylinder (radius 5 mm, 11.8 mm long) and of a flat of the same length, flush and free, E "
        "210 000 MPa, ν 0.3, 2000 N: pressure near the end by that in the middle, and K_Hβ, the line load in the middle "
        "by the mean.",
        references=(
            Reference(
                source="Images in the free ends: de Mul, Kalker and Fredriksson, J. Tribol. 108 (1986) 140, with the factor of "
                "Guilbault, J. Tribol. 133 (2011) 031402 (`ltca/contact/free_end.py`), 24 cells over the half-width",
                uncertainty="Difference to 16 cells, on the page. Images are an approximation, and Guilbault's factor is "
                "quoted from secondary literature: the law is what is judged.",
            ),
        ),
        model=f"{BLOCKS} Blocks 12 mm deep, 24 mm wide, flush; compared at the same load, since what is cut off moves the "
        f"approach alone. {PATCHES}",
        model_uncertainty=f"Images cancel the shear stress of the end alone. {NOT_NESTED}",
        long=True,
        run=_free_ends,
        bodies="solid",
    ),
    Case(
        name="solid_crowned_line",
        title="A crowned line by solid finite elements",
        problem=CROWNED_PROBLEM.format("aligned", ""),
        references=(GRIDS,),
        model=f"{CROWNED_MODEL} {PATCHES}",
        model_uncertainty=NOT_NESTED,
        long=True,
        run=lambda: _crown(0.0),
        bodies="solid",
    ),
    Case(
        name="solid_tilted_line",
        title="A crowned line that tilts by solid finite elements",
        problem=CROWNED_PROBLEM.format("tilted by 0.3 mrad", "; moment about mid-length"),
        references=(GRIDS,),
        model=f"{CROWNED_MODEL} {PATCHES}",
        model_uncertainty=NOT_NESTED,
        long=True,
        run=lambda: _crown(TILT),
        bodies="solid",
    ),
    Case(
        name="solid_calculix",
        title="A crowned pair against CalculiX on the same mesh",
        problem="A crowned cylinder (radius 10 mm, crown radius 400 mm, 4 mm long) on a flat, E 210 000 MPa, ν 0.3, pressed by "
        "5 µm, aligned and tilted by 0.5 mrad: load and largest mean pressure of an element's face.",
        references=(
            Reference(
                source="CalculiX 2.20, C3D20R with surface-to-surface penalty contact on the same mesh; stored answers of "
                "`validation.levels.other_code_problems`, written by `python -m validation.levels.other_codes`; `cyclo "
                "validate` asks it anew where it is installed",
                uncertainty="That of its mesh, taken as large as ours; the penalty takes hundredths of a per cent of the load.",
            ),
        ),
        model=f"{BLOCKS} Blocks 3 mm deep, 6 mm wide, 4 mm long; 2.7 elements for the half-width.",
        model_uncertainty="Both codes solve the same bodies; nine-node sections and full integration here, eight nodes and "
        "reduced integration there.",
        long=True,
        run=_calculix,
        bodies="solid",
    ),
)
