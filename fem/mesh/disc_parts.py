"""The mesh of a disc in parts that fit together: one cell for all cells of a wall, and the core between them.

The lobes of a nominal disc are alike but turned, and so are the cells of which bores and holes consist, a few stations each; fine
elements are needed along these walls alone. So one cell of the flank is meshed, one of the bores and one of the holes: what
lies between the wall, two radial cuts and a circle, the *collar*, about the wall's centre. Copies of them and the core, which is
coarse, share the nodes of cuts and collars: together they are a mesh of the disc as good as one of it as a whole.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.mesh.body_mesh import BodyMesh
from fem.mesh.boundary_division import MAX_TURN, DividedCurve, Outline, divide_curve, middle_parameters
from fem.mesh.element_size import SizeField
from fem.mesh.triangulation import mesh_within
from fem.shapes import CircleCurve, Curve, DiscShape
from ltca.arrays import BoolArray, ComplexArray, FloatArray, IntArray

# Of the wall to the next boundary, under the roots and around bores and holes: a quarter of it at least is left between collars.
RIM_DEPTH, COLLAR_WIDTH = 0.5, 0.25
# Places along a line for each of its smallest edges at which the size field is read.
SAMPLES_PER_EDGE, FEWEST_SAMPLES = 8.0, 200
# With fewer a cell is no narrow sector.
FEWEST_CELLS = 3
# Lobes and holes that differ by this part of the disc's radius are not alike.
ALIKE = 1e-12
# Nodes closer than this part of the disc's radius are one: edges are 1e-4 of it, round-off 1e-15.
SAME_NODE = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Cells:
    """Walls that consist of cells all alike.

    Attributes
    ----------
    walls : tuple of int
        Numbers of the boundaries of the disc: 0 flank, then bores and holes.
    count : int
        Cells of each wall.
    cut : float
        Parameter at which the first cell of each wall begins, rad: no patch lies across it.
    """

    walls: tuple[int, ...]
    count: int
    cut: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscPart:
    """A cell and where its copies are, wall by wall.

    Attributes
    ----------
    cells : Cells
        Walls and cells.
    mesh : BodyMesh
        The first copy, in the disc frame; all of its outline is called after the wall.
    wall_edges : array of bool
        Which edges of the outline lie on the wall.
    turns, shifts : array of complex, shape (copies,)
        Rotation about the disc centre from the first copy to each, as a factor, then shift, mm.
    shared : array of int
        Nodes that the part shares with others.
    """

    cells: Cells
    mesh: BodyMesh
    wall_edges: BoolArray
    turns: ComplexArray
    shifts: ComplexArray
    shared: IntArray


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscParts:
    """A disc in parts: the core, with the walls that do not consist of cells, and cells."""

    core: BodyMesh
    parts: tuple[DiscPart, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Line:
    """A closed line of edges: vertices and mid-side nodes, mm."""

    name: str
    vertices: ComplexArray
    middle_points: ComplexArray


def lobe_count(shape: DiscShape) -> int:
    """Return the number of lobes of a disc."""
    return round(shape.flank.profile.reduction_ratio) - 1


def lobes_alike(shape: DiscShape) -> bool:
    """Return whether all lobes of the flank are one, turned, and there are enough of them for straight cuts."""
    profile, lobes = shape.flank.profile, lobe_count(shape)
    theta, turns = np.linspace(0.0, 2.0 * np.pi / lobes, 200), 2.0 * np.pi * np.arange(lobes) / lobes
    first = shape.flank.points(theta)
    away = np.abs(shape.flank.points(theta[:, None] + turns) - first[:, None] * np.exp(1j * turns))
    around = np.diff(np.unwrap(np.angle(first)))
    return lobes >= FEWEST_CELLS and bool(np.all(around > 0.0) and np.max(away) < ALIKE * profile.tip_radius)


def circles_alike(circles: Sequence[CircleCurve]) -> bool:
    """Return whether some bores or holes, one at least, have one radius."""
    radii = [circle.radius for circle in circles]
    return bool(radii) and max(radii) - min(radii) <= ALIKE * max(radii)


def mesh_disc_parts(shape: DiscShape, field: SizeField, cells: Sequence[Cells]) -> DiscParts:
    """Mesh a disc in parts.

    Parameters
    ----------
    shape : DiscShape
        The disc.
    field : SizeField
        Of the whole disc; the edges of copies follow what the first of them asks for.
    cells : sequence of Cells
        Walls that consist of cells; all others belong to the core, and so do those with collars narrower than elements are long.

    Returns
    -------
    DiscParts
        Core and parts.

    Raises
    ------
    MeshError
        When gmsh fails or cannot be loaded, or a mesh is bad.
    """
    parts = []
    outlines: list[Outline | None] = [None] * len(shape.curves)
    for each in cells:
        cell = _mesh_cell(shape, field, each)
        if cell is None:
            continue
        part, collars = cell
        parts.append(part)
        for wall, collar in zip(each.walls, collars, strict=True):
            outlines[wall] = collar
    around = [divide_curve(shape.curves[wall], field) if line is None else line for wall, line in enumerate(outlines)]
    return DiscParts(core=mesh_within(f"{shape.name}_core", around, field), parts=tuple(parts))


def _mesh_cell(shape: DiscShape, field: SizeField, cells: Cells) -> tuple[DiscPart, list[DividedCurve]] | None:
    """Mesh the first cell of the first of some walls; return it and the collars of all of them, None where they are narrow."""
    curve, pitch = shape.curves[cells.walls[0]], 2.0 * np.pi / cells.count
    centre = centre_of(curve)
    (start,) = curve.points(np.array([cells.cut])) - centre
    if isinstance(curve, CircleCurve):
        width = COLLAR_WIDTH * min(wall_beside(shape, number) for number in cells.walls)
        radius = abs(start) + width
    else:
        width = RIM_DEPTH * wall_beside(shape, 0)
        radius = shape.flank.profile.root_radius - width
    polar, depth = float(np.angle(start)), abs(start) - radius
    reach = max(abs(depth), 2.0 * abs(start) * np.sin(0.5 * pitch))
    middle_of_wall = complex(curve.points(np.array([cells.cut + 0.5 * pitch]))[0])
    near = [ball for ball in field.balls if abs(ball.point - middle_of_wall) < 2.0 * reach + ball.radius]
    own = replace(field, balls=tuple(near))

    def wall(share: FloatArray) -> ComplexArray:
        return curve.points(cells.cut + pitch * share)

    def side(share: FloatArray) -> ComplexArray:
        return np.asarray(centre + (radius + depth * (1.0 - share)) * np.exp(1j * polar))

    def collar(share: FloatArray) -> ComplexArray:
        return np.asarray(centre + radius * np.exp(1j * (polar + pitch * (1.0 - share))))

    if np.max(own.at(collar(np.linspace(0.0, 1.0, FEWEST_SAMPLES)))) > width:
        return None
    along = _divide(wall, own, lambda share: MAX_TURN * curve.curvature_radius(cells.cut + pitch * share))
    edges = len(_divide(collar, own)) - 1
    before = side(_divide(side, own))
    turn, middle = np.exp(1j * pitch), 0.5 * (before[1:] + before[:-1])
    vertices = np.concatenate(
        [
            wall(along)[:-1],
            (centre + (before - centre) * turn)[:-1],
            collar(np.arange(edges) / edges),
            before[:0:-1],
        ]
    )
    middles = np.concatenate(
        [
            curve.points(middle_parameters(curve, cells.cut + pitch * along)),
            centre + (middle - centre) * turn,
            collar((np.arange(edges) + 0.5) / edges),
            middle[::-1],
        ]
    )
    if not curve.encloses_body:
        vertices, middles = vertices[::-1], np.roll(middles[::-1], -1)
    # All around it is called after the wall: patches look for their places on a closed line.
    mesh = mesh_within(f"cell_of_{curve.name}", [_Line(name=curve.name, vertices=vertices, middle_points=middles)], own)
    nodes = mesh.boundary_nodes(curve.name)
    arms, same = mesh.places[nodes] - centre, SAME_NODE * shape.flank.profile.tip_radius
    shared = np.abs(np.abs(arms) - radius) < same
    for angle in (polar, polar + pitch):
        shared |= np.abs((arms * np.exp(-1j * angle)).imag) < same
    each_turn = np.exp(1j * pitch * np.arange(cells.count))
    centres = np.array([centre_of(shape.curves[number]) for number in cells.walls])
    part = DiscPart(
        cells=cells,
        mesh=mesh,
        wall_edges=~shared[:, 1],
        turns=np.tile(each_turn, len(centres)),
        shifts=(centres[:, None] - each_turn * centre).ravel(),
        shared=np.unique(nodes[shared]),
    )
    around = polar + 2.0 * np.pi * np.arange(edges * cells.count) / (edges * cells.count)
    collars = [
        DividedCurve(
            curve=CircleCurve(
                name=f"collar_{number}",
                radius=radius,
                centre=complex(place),
                encloses_body=curve.encloses_body,
            ),
            parameters=around,
        )
        for number, place in zip(cells.walls, centres, strict=True)
    ]
    return part, collars


def wall_beside(shape: DiscShape, number: int) -> float:
    """Return the wall from a boundary to the nearest other one, mm; the root circle stands for the flank."""
    root, circles = shape.flank.profile.root_radius, [*shape.bores, *shape.holes]
    under_roots = [root - abs(circle.centre) - circle.radius for circle in circles]
    if number == 0:
        return min(under_roots)
    own = circles.pop(number - 1)
    between = [abs(own.centre - other.centre) - own.radius - other.radius for other in circles]
    return min(under_roots[number - 1], *between) if between else under_roots[0]


def centre_of(curve: Curve) -> complex:
    """Return the centre of a wall, mm."""
    return curve.centre if isinstance(curve, CircleCurve) else 0j


def _divide(
    line: Callable[[FloatArray], ComplexArray],
    field: SizeField,
    limit: Callable[[FloatArray], FloatArray] = lambda share: np.full(share.shape, np.inf),
) -> FloatArray:
    """Return the places from 0 to 1 of vertices on a line whose edges follow the size field, or a smaller limit."""
    share = np.linspace(0.0, 1.0, FEWEST_SAMPLES)
    shortest = min(float(np.min(field.at(line(share)))), field.smallest)
    length = float(np.sum(np.abs(np.diff(line(share)))))
    share = np.linspace(0.0, 1.0, max(FEWEST_SAMPLES, int(SAMPLES_PER_EDGE * length / shortest)))
    points = line(share)
    density = 1.0 / np.minimum(field.at(points), limit(share))
    count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.abs(np.diff(points)))])
    edges = max(int(np.ceil(count[-1])), 1)
    return np.asarray(np.interp(np.arange(edges + 1) * (count[-1] / edges), count, share))
