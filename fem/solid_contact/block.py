"""A block of a body around a contact: structured quadrilaterals of nine nodes, graded to the contact.

Blocks stand in the frame of the contact: the point of contact is the origin, x runs along the tangent, y from the
carrier of the pressure to the body opposite. Columns are even over the zone of the pressure and grow geometrically to
the sides, rows grow with the depth; nodes of the surface lie on the exact curve, mid-sides too. Away from the contact
the surface goes on along its tangent, so that a block may be larger than the circle it belongs to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem.body.surface import OppositeZone, PressureZone
from fem.errors import MeshError
from fem.shapes import Curve
from fem.solid.extruded import ExtrudedBody
from fem.solid.layers import with_middles
from fem.solid.section import Section
from ltca.arrays import BoolArray, FloatArray, IntArray

GROWTH = 2.0
"""Growth of columns and rows from one to the next away from the contact."""

Height = Callable[[FloatArray], FloatArray]
"""Height y of a surface over x, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A block of quadrilaterals under a surface.

    Attributes
    ----------
    section : Section
        Mesh; nodes row by row from the surface down, each row by ascending x.
    columns, rows : int
        Numbers of elements.
    zone_columns : tuple of int
        First and last column of the pressure zone, half open.
    symmetric : bool
        Whether only x ≥ 0 is meshed.
    """

    section: Section
    columns: int
    rows: int
    zone_columns: tuple[int, int]
    symmetric: bool

    def row_nodes(self, row: int) -> IntArray:
        """Return the nodes of a row of nodes, 0 at the surface, by ascending x; element k has 2k, 2k + 1 and 2k + 2."""
        return np.arange(2 * self.columns + 1) + row * (2 * self.columns + 1)

    @property
    def surface_edges(self) -> IntArray:
        """Nodes of the edges of the zone by ascending x: first, middle and last, shape (edges, 3)."""
        surface, (first, last) = self.row_nodes(0), self.zone_columns
        return np.asarray(surface[2 * np.arange(first, last)[:, None] + np.arange(3)])

    @property
    def far_nodes(self) -> IntArray:
        """Nodes of the sides and of the bottom: all of the boundary but the surface and the plane of symmetry."""
        across, down = 2 * self.columns + 1, 2 * self.rows + 1
        grid = np.arange(across * down).reshape(down, across)
        sides = [grid[-1], grid[:, -1]] + ([] if self.symmetric else [grid[:, 0]])
        return np.unique(np.concatenate(sides))

    @property
    def plane_nodes(self) -> IntArray:
        """Nodes of the plane of symmetry x = 0; none of a whole block."""
        across, down = 2 * self.columns + 1, 2 * self.rows + 1
        return np.arange(down) * across if self.symmetric else np.zeros(0, dtype=np.int64)

    def held(self, body: ExtrudedBody) -> BoolArray:
        """Return which unknowns are held: sides and bottom in all directions, the plane of symmetry across."""
        still = np.zeros(body.unknowns, dtype=bool)
        still[body.all_unknowns_of(self.far_nodes)] = True
        still[body.unknowns_of(self.plane_nodes, 0).ravel()] = True
        return still

    def pressure_zone(self, curve: Curve) -> PressureZone:
        """Return the zone of a block below its surface, of thickness 1, body on the left: by descending x."""
        edges = self.surface_edges[::-1, ::-1]
        x, y = self.section.places
        return PressureZone(nodes=edges, places=x[edges] + 1j * y[edges], curve=curve, thickness=1.0, loaded_ends=True)

    def opposite_zone(self, centre: complex) -> OppositeZone:
        """Return the zone of a block above its surface, on a circle with its centre above."""
        edges = self.surface_edges
        nodes = np.append(edges[:, :2].ravel(), edges[-1, 2])
        x, y = self.section.places[:, nodes]
        return OppositeZone(nodes=nodes, coordinates=-0.5 * np.pi + np.angle((x + 1j * y - centre) * 1j))

    def plane_loads(self, zone: OppositeZone, loads: FloatArray) -> sp.csc_matrix:
        """Return loads on the nodes of a zone as loads on all nodes of the section, shape (2 nodes, loads)."""
        return sp.csc_matrix(zone.unit_loads(2 * self.section.node_count) @ loads)


def graded_columns(edge: float, zone: float, extent: float, growth: float = GROWTH) -> tuple[FloatArray, int]:
    """Return ends of columns from 0, mm: even ones up to `zone`, then growing up to `extent`; and how many are even."""
    if not 0.0 < edge <= zone < extent:
        raise MeshError(
            f"block: edge {edge:g} mm, zone {zone:g} mm, extent {extent:g} mm: must be ascending and greater than 0"
        )
    even = int(np.ceil(zone / edge - 1e-9))
    return np.concatenate([np.linspace(0.0, zone, even + 1), _grow(zone, zone / even, extent, growth)]), even


def graded_rows(edge: float, even: float, extent: float, growth: float = GROWTH) -> FloatArray:
    """Return depths of rows from 0: of `edge` down to the depth `even`, then growing down to `extent`, mm."""
    count = max(int(np.ceil(even / edge - 1e-9)), 1)
    first = edge * np.arange(count + 1.0)
    return np.concatenate([first, _grow(float(first[-1]), edge, extent, growth)])


def _grow(start: float, edge: float, extent: float, growth: float) -> FloatArray:
    """Ends beyond `start` that grow up to `extent` exactly: the last one is as large as the rest needs."""
    span = (extent - start) / edge
    count = max(int(np.ceil(np.log1p(span * (growth - 1.0) / growth) / np.log(growth) - 1e-9)), 1)
    sizes = growth ** np.arange(1.0, count + 1.0)
    return np.asarray(start + (extent - start) * np.cumsum(sizes) / sizes.sum())


def make_block(
    name: str,
    surface: Height,
    columns: FloatArray,
    zone_columns: int,
    rows: FloatArray,
    *,
    above: bool,
    symmetric: bool,
) -> Block:
    """Return a block below a surface, or above it.

    Parameters
    ----------
    name : str
        Of the body.
    surface : callable
        Height of the surface over x.
    columns : array
        Ends of the columns for x ≥ 0, mm.
    zone_columns : int
        How many of them belong to the pressure zone.
    rows : array
        Depths of the ends of the rows, mm.
    above : bool
        Whether the body lies above the surface.
    symmetric : bool
        Whether only x ≥ 0 is meshed.
    """
    ends = columns if symmetric else np.concatenate([-columns[:0:-1], columns])
    x, depth = with_middles(ends), with_middles(rows)
    top = surface(x)
    # The shape of the surface fades with the depth: the bottom is flat.
    fade = 1.0 - depth / depth[-1]
    sign = 1.0 if above else -1.0
    y = fade[:, None] * top + sign * depth[:, None]
    places = np.stack([np.broadcast_to(x, y.shape).ravel(), y.ravel()])
    across = x.size
    count, deep = ends.size - 1, rows.size - 1
    corner = (2 * np.arange(deep)[:, None] * across + 2 * np.arange(count)).ravel()
    # Rows run away from the surface: counter-clockwise above is along x first, below along the depth first.
    along, down = 1, across
    if above:
        steps = (
            0,
            2 * along,
            2 * along + 2 * down,
            2 * down,
            along,
            2 * along + down,
            along + 2 * down,
            down,
            along + down,
        )
    else:
        steps = (
            0,
            2 * down,
            2 * along + 2 * down,
            2 * along,
            down,
            along + 2 * down,
            2 * along + down,
            along,
            along + down,
        )
    nodes = corner[:, None] + np.array(steps)
    first = 0 if symmetric else count // 2 - zone_columns
    last = zone_columns if symmetric else count // 2 + zone_columns
    return Block(
        section=Section(name=name, places=places, element_nodes=nodes.astype(np.int64)),
        columns=count,
        rows=deep,
        zone_columns=(first, last),
        symmetric=symmetric,
    )


def circle_height(curvature: float, reach: float) -> Height:
    """Return the height of a circle through the origin by its curvature upwards, 1/mm; along its tangent beyond `reach`, mm."""

    def height(x: FloatArray) -> FloatArray:
        inner = np.clip(x, -reach, reach)
        root = np.sqrt(1.0 - (curvature * inner) ** 2)
        return np.asarray(curvature * inner**2 / (1.0 + root) + curvature * inner / root * (x - inner))

    return height
