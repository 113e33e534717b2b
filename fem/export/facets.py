"""STL files of parts: closed surfaces of triangles whose corners lie on the exact curves, within a stated chord.

Sections are divided here and filled by gmsh without any node inside; sides are two triangles for each edge. So every edge
belongs to two triangles, and the surface closes to the last bit.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np

from fem.errors import MeshError
from fem.mesh.gmsh_session import gmsh_model
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.export.flank_outline import FlankSpline
from ltca.export.parts import Body, Circle, Part
from ltca.output.files import whole_file

DEFAULT_CHORD = 1e-3
"""mm."""
MIN_CIRCLE_EDGES = 360
"""Least number of edges of a circle: the error of its area is then 5e-5, however small it is."""
ALONG_WIDTH = 0.1
"""Part of the chord that a flank may depart by along its width, between heights at which it has corners."""
MAX_EDGE_BY_LOBE = 1.0 / 40
"""Longest edge of a flank by the length of a lobe."""
START_OFFSET = 0.381966
"""Place of the first corner of a circle, as a part of the step between corners: bodies that touch (rollers and races) then share
no corner, which readers would take for one body that is not closed."""
INITIAL_MESH_ONLY = 3
TRIANGLE, LINE = 2, 1
HEADER = 80
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_facets(part: Part, path: Path, chord: float = DEFAULT_CHORD) -> int:
    """Write a part of straight bodies as a binary STL file in mm and return the number of triangles.

    `chord` is the largest distance of a triangle from the exact surface, mm. Walls of the part bound no body and are left out.
    MeshError when gmsh cannot be loaded or fill a section.

    Examples
    --------
    >>> import ltca, tempfile
    >>> from ltca.export.parts import make_parts
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     part = make_parts(ltca.load_drive("paper").cases["CS-1"], "CS-1", "pin-shaft")[0]
    ...     count = write_facets(part, path := Path(folder) / "shaft.stl", chord=0.1)
    ...     path.stat().st_size == 84 + 50 * count  # a binary STL file
    True
    """
    with gmsh_model(part.name) as gmsh:
        corners = [body_facets(gmsh, body, chord) for body in part.bodies]
    every = np.concatenate(corners)
    facets = np.zeros(len(every), dtype=_FACET)
    facets["corners"] = every
    cross = np.cross(every[:, 1] - every[:, 0], every[:, 2] - every[:, 0])
    facets["normal"] = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    # "solid" at the start would make readers take it for text.
    told = f"cyclo {part.title}, mm, chord {chord:g} mm".encode("ascii", "replace")[:HEADER].ljust(HEADER)
    with whole_file(path) as file:
        file.write_bytes(told + np.uint32(len(facets)).astype("<u4").tobytes() + facets.tobytes())
    return len(facets)


def body_facets(gmsh: ModuleType, body: Body, chord: float) -> FloatArray:
    """Return the triangles of a body within a chord, mm, corners counter-clockwise seen from outside, shape (n, 3, 3)."""
    circles = [divide(circle, chord) for circle in body.inner]
    # The flank along its width takes a part of the chord: both depart at the same place.
    heights = body.heights(ALONG_WIDTH * chord)
    outlines = [divide(body.outer, chord)]
    if body.lead is not None:
        outlines = _along_width(body, heights, chord)
    # What the file can hold is 32 bits: rounded before, so that corners of neighbours are equal.
    circles, outlines = ([loop.astype(np.complex64).astype(complex) for loop in loops] for loops in (circles, outlines))
    caps = [_cap(gmsh, body, [outline, *circles]) for outline in outlines[:: max(len(outlines) - 1, 1)]]
    bottom, top = _at(caps[0][:, ::-1], body.bottom), _at(caps[-1], body.top)
    rows = [outlines[0], outlines[0]] if len(outlines) == 1 else outlines
    sides = [
        _between(low, high, *ends) for (low, high), ends in zip(pairwise(rows), pairwise(heights.tolist()), strict=True)
    ]
    sides += [_between(loop, loop, body.bottom, body.top)[:, ::-1] for loop in circles]
    return np.concatenate([top, bottom, *sides])


def _along_width(body: Body, heights: FloatArray, chord: float) -> list[ComplexArray]:
    """Corners of the flank at heights, at the same parameters."""
    assert isinstance(body.outer, FlankSpline)
    parameter, centre = _parameters(body.outer, chord), body.outer.centre
    return [np.asarray(body.flank(height).points(parameter) + centre) for height in heights.tolist()]


def _cap(gmsh: ModuleType, body: Body, loops: list[ComplexArray]) -> ComplexArray:
    """Corners of the triangles that fill a section, counter-clockwise, shape (n, 3)."""
    triangles = _fill_round(body, loops)
    if triangles is None:
        triangles = _fill(gmsh, body.name, loops)
    return np.asarray(np.concatenate(loops)[triangles])


def _at(points: ComplexArray, height: float) -> FloatArray:
    return np.stack([points.real, points.imag, np.full(points.shape, height)], axis=-1)


def divide(curve: FlankSpline | Circle, chord: float) -> ComplexArray:
    """Return corners on a closed curve, counter-clockwise, whose edges are no further from it than a chord, mm."""
    if isinstance(curve, Circle):
        half = np.arccos(max(1.0 - chord / curve.radius, 0.0))
        count = max(MIN_CIRCLE_EDGES, int(np.ceil(np.pi / half)))
        return np.asarray(curve.centre + curve.radius * np.exp(2j * np.pi * (np.arange(count) + START_OFFSET) / count))
    return np.asarray(curve.flank.points(_parameters(curve, chord)) + curve.centre)


def _parameters(curve: FlankSpline, chord: float) -> FloatArray:
    """θ of corners on a flank whose edges are no further from it than a chord, mm."""
    # On a fine table: the chord of an edge of length s is κ s²/8.
    flank = curve.flank
    fine = np.linspace(0.0, 2.0 * np.pi, 16 * curve.parameter.size + 1)
    points = flank.points(fine)
    lengths = np.abs(np.diff(points))
    middle = 0.5 * (fine[:-1] + fine[1:])
    # A tenth less than allowed, for edges over which the curvature changes.
    edges = np.sqrt(0.9 * chord * 8.0 / np.maximum(np.abs(flank.curvature(middle)), 1e-12))
    edges = np.minimum(edges, MAX_EDGE_BY_LOBE * lengths.sum() / flank.lobes)
    needed = np.concatenate([[0.0], np.cumsum(lengths / edges)])
    count = int(np.ceil(needed[-1]))
    return np.asarray(np.interp(np.arange(count) * needed[-1] / count, needed, fine))


def _fill_round(body: Body, loops: list[ComplexArray]) -> IntArray | None:
    """Triangles of a circle or of a ring whose circles have equally many corners; None of other sections."""
    count = loops[0].size
    here = np.arange(count)
    if isinstance(body.outer, FlankSpline) or len(loops) > 2 or any(loop.size != count for loop in loops):
        return None
    if len(loops) == 1:
        return np.column_stack([np.zeros(count - 2, dtype=np.int64), here[1:-1], here[2:]])
    there = np.roll(here, -1)
    return np.concatenate(
        [np.column_stack([here, there, count + there]), np.column_stack([here, count + there, count + here])]
    )


def _fill(gmsh: ModuleType, name: str, loops: list[ComplexArray]) -> IntArray:
    """Triangles of a section, counter-clockwise, by the numbers of its corners."""
    gmsh.model.add(f"{name} section")
    geometry = gmsh.model.geo
    first, outlines = 1, []
    for loop in loops:
        tags = [geometry.addPoint(point.real, point.imag, 0.0) for point in loop.tolist()]
        lines = [geometry.addLine(here, there) for here, there in zip(tags, [*tags[1:], tags[0]], strict=True)]
        for line in lines:
            geometry.mesh.setTransfiniteCurve(line, 2)
        outlines.append(geometry.addCurveLoop(lines))
        first += len(loop)
    geometry.addPlaneSurface(outlines)
    geometry.synchronize()
    gmsh.option.setNumber("Mesh.Algorithm", INITIAL_MESH_ONLY)
    gmsh.option.setNumber("Mesh.Renumber", 0)
    try:
        gmsh.model.mesh.generate(2)
    except Exception as error:  # gmsh raises nothing more specific
        raise MeshError(f"gmsh cannot fill the section of {name}: {error}") from error
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    _, corners = gmsh.model.mesh.getElementsByType(TRIANGLE)
    gmsh.model.remove()
    points = np.concatenate(loops)
    places = np.asarray(coordinates).reshape(-1, 3)
    number = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    number[np.asarray(tags, dtype=np.int64)] = _numbers_of(places[:, 0] + 1j * places[:, 1], points)
    triangles = number[np.asarray(corners, dtype=np.int64)].reshape(-1, 3)
    # A polygon of n corners with h holes has n + 2h − 2 triangles when no node lies inside.
    if len(triangles) != len(points) + 2 * (len(loops) - 1) - 2 or triangles.min() < 0:
        raise MeshError(f"gmsh filled the section of {name} with {len(triangles)} triangles of {len(points)} corners")
    a, b, c = points[triangles.T]
    clockwise = ((b - a).conjugate() * (c - a)).imag < 0.0
    triangles[clockwise] = triangles[clockwise, ::-1]
    return triangles


def _numbers_of(found: ComplexArray, points: ComplexArray) -> IntArray:
    """Return the numbers of the points at which the nodes lie, −1 for none."""
    known = {point: number for number, point in enumerate(points.tolist())}
    return np.array([known.get(place, -1) for place in found.tolist()], dtype=np.int64)


def _between(lower: ComplexArray, upper: ComplexArray, bottom: float, top: float) -> FloatArray:
    """Two triangles for each edge between counter-clockwise loops of equally many corners, looking out of them."""
    here, above = _at(lower, bottom), _at(upper, top)
    there, beyond = (np.roll(loop, -1, axis=0) for loop in (here, above))
    return np.concatenate([np.stack([here, there, beyond], axis=1), np.stack([here, beyond, above], axis=1)])
