r"""Gaps between displaced surfaces, and what they differ by from the gaps that are linear in the displacements.

The contact of a pair is solved with gaps that are linear: distances along the normals of the undeformed carrier, opened by
displacements along these normals. Where strains p/E* are some per cent (plastics), points of the two surfaces slide along
each other by some per cent of their distance from the middle, and partners are others: with :math:`X` a point of the carrier at
height z, the point opposite is

.. math:: Z = X + u^c_x(X) - u^o_x(Z), \qquad
          g = y^o(Z) + u^o_y(Z) - \delta - \theta z - y^c(X) - u^c_y(X) ,

measured across the tangent of the contact and turned onto the carrier's normal, and the relief r(z) on top. The
correction, this gap less the linear one, is found from a solution and added to the gap of the next. Elasticity
remains linear, and pressures act along the undeformed normals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem.body.surface import GAUSS_POINTS, GAUSS_WEIGHTS, PressureZone, quadratic_shapes
from fem.contact.coupling import Pose, gap_to_opposite
from fem.solid.layers import Layers, with_middles
from fem.solid_contact.block import Block, circle_height
from fem.solid_contact.bodies import CondensedSolid
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.pressing import PressedFaces
from fem.solid_contact.widths import WidthGrid
from ltca.arrays import FloatArray

SEARCH = 12
"""Steps in the search of partners; each leaves some per cent of the error before."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceGaps:
    """Gaps at the nodes of the carrier's surface in the zone, by ascending x, and at heights, vertices and middles.

    Attributes
    ----------
    displaced : array, shape (nodes, heights)
        Between the displaced surfaces, along the carrier's undeformed normals, mm.
    correction : array, shape (nodes, heights)
        These less the gaps that are linear in the displacements, mm.
    """

    displaced: FloatArray
    correction: FloatArray


def surface_gaps(
    pair: SolidPair,
    blocks: tuple[Block, Block],
    width: WidthGrid,
    bodies: tuple[CondensedSolid, ...],
    pressed: PressedFaces,
) -> SurfaceGaps:
    """Return the gaps of a solution; both blocks have the same columns and, within the contact, the same layers."""
    nodes = np.unique(blocks[0].surface_edges)
    x, y = blocks[0].section.places[:, nodes]
    z = with_middles(width.heights)
    zone = blocks[0].pressure_zone(pair.curve)
    exact, normals = zone.exact(x + 1j * y)
    moved = [_surface_displacement(body, nodes, width, pressed.solution.pressure) for body in bodies]
    still = np.zeros((nodes.size, z.size))
    (across, down), (across_opposite, down_opposite) = moved if len(moved) == 2 else (*moved, (still, still))
    travel = -pressed.approach - pressed.tilt * z
    # Linear: partners along the undeformed normals, and displacements along them.
    centre = Pose(centre=1j * pair.radius)
    free = gap_to_opposite(exact, normals, centre, pair.radius)
    partner = np.broadcast_to((exact + free * normals).real[:, None], still.shape)
    slide = _interpolate(x, across_opposite, partner) - across
    rise = _interpolate(x, down_opposite, partner) - down
    linear = free[:, None] + normals.real[:, None] * slide + normals.imag[:, None] * (rise + travel)
    # Displaced: the point opposite that has come to stand over the displaced point.
    over = x[:, None] + across
    place = over - across_opposite
    for _ in range(SEARCH):
        place = over - _interpolate(x, across_opposite, place)
    height = circle_height(1.0 / pair.radius, pair.shape_reach)
    gap = height(place) + _interpolate(x, down_opposite, place) + travel - exact.imag[:, None] - down
    along_normals = gap * normals.imag[:, None]
    # The relief, which may have no end, is in both alike.
    return SurfaceGaps(displaced=along_normals + pair.relief(z), correction=along_normals - linear)


def weighted_correction(zone: PressureZone, width: WidthGrid, gaps: SurfaceGaps) -> FloatArray:
    """Return the weighted gap by which displaced surfaces differ from linear gaps, arc by arc, all heights of each, mm·mm²."""
    edge = np.repeat(np.arange(zone.edge_count), len(GAUSS_POINTS))
    xi = np.tile(GAUSS_POINTS, zone.edge_count)
    _, speed = zone.points(edge, xi)
    area = np.tile(GAUSS_WEIGHTS, zone.edge_count) * speed
    nodes = sp.csr_matrix(
        (quadratic_shapes(xi).ravel(), ((2 * edge + np.arange(3)[:, None]).ravel(), np.tile(np.arange(edge.size), 3))),
        shape=(2 * zone.edge_count + 1, edge.size),
    )
    hats = np.zeros((edge.size, zone.unknown_count))
    for vertex, hat in ((edge, 1.0 - xi), (edge + 1, xi)):
        inner, column = zone.unknowns_at(vertex)
        hats[np.flatnonzero(inner), column] = (area * hat)[inner]
    # The zone runs by descending x.
    correction = gaps.correction[::-1]
    along = width.onto(Layers(vertices=width.heights, parity="symmetric" if width.even else "whole"))
    return np.asarray((hats.T @ (nodes.T @ correction) @ along).ravel())


def _surface_displacement(
    body: CondensedSolid, nodes: np.ndarray, width: WidthGrid, pressures: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Displacement of nodes along x and y at the vertices and middles of the heights, mm, shape (nodes, heights) each."""
    upper = with_middles(width.heights[width.heights >= 0.0]).size
    total = np.zeros((2, nodes.size, upper if width.even else 2 * upper - 1))
    for each in body.classes:
        moved = each.displacement(pressures)
        factor = -1.0 if each.body.layers.parity == "antisymmetric" else 1.0
        for component in range(2):
            values = np.zeros((nodes.size, each.body.layers.heights.size))
            values[:, each.body.layers.free_in_plane] = moved[each.body.unknowns_of(nodes, component)]
            values = values[:, :upper]
            total[component] += values if width.even else np.concatenate([factor * values[:, :0:-1], values], axis=1)
    return total[0], total[1]


def _interpolate(x: FloatArray, values: FloatArray, places: FloatArray) -> FloatArray:
    """Values at nodes of quadratic edges, (nodes, heights), at places of each height, (m, heights); the last edges go on."""
    ends = x[::2]
    edge = np.clip(np.searchsorted(ends, places, side="right") - 1, 0, ends.size - 2)
    shapes = quadratic_shapes((places - ends[edge]) / (ends[edge + 1] - ends[edge]))
    height = np.arange(values.shape[1])
    return np.asarray(sum(shape * values[2 * edge + corner, height] for corner, shape in enumerate(shapes)))
