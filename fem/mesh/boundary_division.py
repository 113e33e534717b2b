"""Division of the exact boundary curves into edges that follow the size field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from skfem import MeshTri1

from fem.mesh.body_mesh import move_nodes
from fem.mesh.element_size import Refinement, SizeField, cover_small_edges, nearest_distance
from fem.shapes import Curve
from ltca.arrays import ComplexArray, FloatArray

# Largest angle α a boundary edge may turn through. Between its nodes, which are exact, a quadratic edge leaves a
# circle by up to (1 − cos(α/2))²/8 = 9e-6 of the radius; at contacts edges are shorter and the rest is nil.
MAX_TURN = np.pi / 12.0
SAMPLES_PER_EDGE = 4.0


class Outline(Protocol):
    """A closed line of edges around a body or a part of one, body on either side."""

    @property
    def name(self) -> str:
        """Name of the boundary in the mesh."""

    @property
    def vertices(self) -> ComplexArray:
        """First vertex of each edge, mm."""

    @property
    def middle_points(self) -> ComplexArray:
        """Mid-side node of each edge, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DividedCurve:
    """A closed curve divided into edges.

    Attributes
    ----------
    curve : Curve
        The exact curve.
    parameters : array of float, shape (edges,)
        Parameter of the first vertex of each edge, increasing.
    """

    curve: Curve
    parameters: FloatArray

    @property
    def middles(self) -> FloatArray:
        """Parameter of the mid-side node of each edge."""
        return middle_parameters(self.curve, np.append(self.parameters, self.parameters[0] + 2.0 * np.pi))

    @property
    def name(self) -> str:
        """Name of the boundary in the mesh."""
        return self.curve.name

    @property
    def vertices(self) -> ComplexArray:
        """First vertex of each edge, mm."""
        return self.curve.points(self.parameters)

    @property
    def middle_points(self) -> ComplexArray:
        """Mid-side node of each edge, mm."""
        return self.curve.points(self.middles)


def middle_parameters(curve: Curve, parameters: FloatArray) -> FloatArray:
    """Return the parameters halfway along a curve between neighbouring vertices, one less than vertices, rad."""
    start, end = parameters[:-1], parameters[1:]
    guess = 0.5 * (start + end)
    # One secant step to equal chords keeps the mapping of the edge even where the parameter is not arc length.
    middle = curve.points(guess)
    first, second = np.abs(middle - curve.points(start)), np.abs(curve.points(end) - middle)
    return np.asarray(guess + 0.5 * (end - start) * (second - first) / (first + second))


def sample_parameters(curve: Curve, field: SizeField) -> FloatArray:
    """Return parameters over one period, both ends included, dense where the size field asks for small edges."""
    parameters = np.linspace(0.0, 2.0 * np.pi, 2 * curve.samples + 1)
    points = curve.points(parameters)
    wanted = field.at(points)
    alike = list(field.balls_alike())
    found = [parameters]
    # Interval halving: an interval is split as long as it is longer than a part of the wanted edge; only the halves of those
    # split before can be. Rows: first and last end.
    ends, places, sizes = (np.array([values[:-1], values[1:]]) for values in (parameters, points, wanted))
    for _ in range(40):
        length = np.abs(places[1] - places[0])
        split = SAMPLES_PER_EDGE * length > np.minimum(sizes[1], sizes[0])
        # An interval may jump over a small ball: near every ball look at the distance to its zone, too.
        for ball, centres in alike:
            small = np.flatnonzero((SAMPLES_PER_EDGE * length > ball.size) & ~split)
            if len(small):
                reach = nearest_distance(places[:, small], centres)
                split[small] = np.minimum(reach[1], reach[0]) - length[small] < ball.radius
        if not np.any(split):
            break
        ends, places, sizes = ends[:, split], places[:, split], sizes[:, split]
        middles = 0.5 * (ends[1] + ends[0])
        between = curve.points(middles)
        found.append(middles)
        ends, places, sizes = (
            np.hstack([[values[0], new], [new, values[1]]])
            for values, new in ((ends, middles), (places, between), (sizes, field.at(between)))
        )
    return np.sort(np.concatenate(found))


def divide_curve(curve: Curve, field: SizeField, turn: float = MAX_TURN) -> DividedCurve:
    """Divide a closed curve into edges whose lengths follow the size field and that turn by so much at most, rad."""
    parameters = sample_parameters(curve, field)
    if len(curve.corners):
        parameters = np.union1d(parameters, curve.corners)
    points = curve.points(parameters)
    wanted = np.minimum(field.at(points), turn * curve.curvature_radius(parameters))
    density = 1.0 / wanted
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.abs(np.diff(points)))])
    if not len(curve.corners):
        edges = max(int(np.ceil(count[-1])), round(2.0 * np.pi / turn))
        places = np.arange(edges) * (count[-1] / edges)
        return DividedCurve(curve=curve, parameters=np.interp(places, count, parameters))
    # Every piece between corners by itself; the first begins at parameter 0.
    ends = np.interp(np.concatenate([[0.0], curve.corners, [2.0 * np.pi]]), parameters, count)
    pieces = [
        start + (end - start) * np.arange(edges) / edges
        for start, end in pairwise(ends)
        if (edges := int(np.ceil(end - start))) > 0
    ]
    return DividedCurve(curve=curve, parameters=np.interp(np.concatenate(pieces), count, parameters))


def curve_middles(mesh: MeshTri1, outlines: Sequence[Outline]) -> MeshTri1:
    """Return a quadratic mesh with the mid-side nodes of its boundaries, edge by edge as divided, on the exact curves."""
    doflocs = mesh.doflocs.copy()
    for line in outlines:
        middles = line.middle_points
        nodes = mesh.nvertices + mesh.boundaries[line.name]
        doflocs[0, nodes], doflocs[1, nodes] = middles.real, middles.imag
    return move_nodes(mesh, doflocs)


def serve_curvature(curves: tuple[Curve, ...], field: SizeField, turn: float = MAX_TURN) -> SizeField:
    """Return the size field with balls added where edges of a boundary would turn by more than an angle, rad."""
    added: list[Refinement] = []
    for curve in curves:
        parameters = np.linspace(0.0, 2.0 * np.pi, 4 * curve.samples, endpoint=False)
        limit = turn * curve.curvature_radius(parameters)
        so_far = SizeField(balls=field.balls + tuple(added), coarse_size=field.coarse_size, growth=field.growth)
        added += cover_small_edges(curve.points(parameters), limit, so_far)
    return SizeField(balls=field.balls + tuple(added), coarse_size=field.coarse_size, growth=field.growth)
