"""Meshes of the bodies: boundary on the exact curves, interior by gmsh, curved quadratic triangles.

The boundary is divided here, from the exact curves, and handed to gmsh as discrete curves; gmsh fills the
interior (frontal Delaunay) by the same size field. So every boundary node, mid-side nodes included, is a
point of the exact curve to round-off, and meshing needs no spline.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from types import ModuleType

import numpy as np

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from fem.mesh.boundary_division import MAX_TURN, Outline, curve_middles, divide_curve, serve_curvature
from fem.mesh.element_size import DEFAULT_GROWTH, MANY_BALLS, Refinement, SizeField
from fem.mesh.gmsh_session import gmsh_model
from fem.mesh.memory_need import UNKNOWNS_PER_TRIANGLE, mesh_memory, require_memory
from fem.mesh.quality import require_quality
from fem.shapes import CircleShape, DiscShape, PinRingShape, RingShape, Shape
from ltca.arrays import ComplexArray, IntArray

FRONTAL_DELAUNAY = 6
TRIANGLE, LINE, POINT = 2, 1, 15
ELEMENTS_ACROSS_WALL = 3.0


def default_coarse_size(shape: Shape, scale: float = 1.0) -> float:
    """Return the coarse element edge of a body, mm: three elements across its narrowest wall, times `scale`."""
    return scale * shape.narrowest_wall / ELEMENTS_ACROSS_WALL


def estimate_unknowns(
    shape: Shape,
    refinements: Sequence[Refinement],
    *,
    coarse_size: float | None = None,
    growth: float = DEFAULT_GROWTH,
    order: int = 2,
    turn: float = MAX_TURN,
) -> int:
    """Return the number of unknowns to expect of a mesh, without making it (see `SizeField`)."""
    field = size_field(shape, tuple(refinements), coarse_size, growth, turn)
    return int(UNKNOWNS_PER_TRIANGLE[order] * field.estimate_triangles(shape.area))


def mesh_disc(
    shape: DiscShape,
    refinements: Sequence[Refinement] = (),
    *,
    coarse_size: float | None = None,
    growth: float = DEFAULT_GROWTH,
    order: int = 2,
    turn: float = MAX_TURN,
) -> BodyMesh:
    """Mesh the disc; boundaries "flank", "bore", "hole_0", ….

    Parameters
    ----------
    shape : DiscShape
        The disc.
    refinements : sequence of Refinement
        Places of small elements in the disc frame.
    coarse_size : float, optional
        Element edge far from them, mm; `default_coarse_size` when left out.
    growth : float
        Growth of the edge by distance from a refinement.
    order : int
        1 (straight) or 2 (curved, mid-side nodes).
    turn : float
        Largest angle by which an edge of a boundary may turn, rad.

    Returns
    -------
    BodyMesh
        In the disc frame.

    Raises
    ------
    MeshError
        When gmsh fails or cannot be loaded, or the mesh is bad.
    MemoryLimitError
        When the mesh would not fit into memory.
    """
    return _mesh_shape(shape, refinements, coarse_size, growth, order, turn)


def mesh_circle(
    shape: CircleShape,
    refinements: Sequence[Refinement] = (),
    *,
    coarse_size: float | None = None,
    growth: float = DEFAULT_GROWTH,
    order: int = 2,
    turn: float = MAX_TURN,
) -> BodyMesh:
    """Mesh a pin or roller about the origin; boundaries "surface" and, with a core, "core".

    One mesh, `BodyMesh.turned`, serves all pins of one radius. Parameters, result and errors as for `mesh_disc`.
    """
    return _mesh_shape(shape, refinements, coarse_size, growth, order, turn)


def mesh_ring(
    shape: RingShape,
    refinements: Sequence[Refinement] = (),
    *,
    coarse_size: float | None = None,
    growth: float = DEFAULT_GROWTH,
    order: int = 2,
    turn: float = MAX_TURN,
) -> BodyMesh:
    """Mesh the inner race about the origin; boundaries "inner" and "outer".

    Parameters, result and errors as for `mesh_disc`.
    """
    return _mesh_shape(shape, refinements, coarse_size, growth, order, turn)


def mesh_pin_ring(
    shape: PinRingShape,
    refinements: Sequence[Refinement] = (),
    *,
    coarse_size: float | None = None,
    growth: float = DEFAULT_GROWTH,
    order: int = 2,
) -> BodyMesh:
    """Mesh the ring of the pin wheel; boundaries "inner", edges ending at the ends of every seat, and "outer".

    Parameters, result and errors as for `mesh_disc`.
    """
    return _mesh_shape(shape, refinements, coarse_size, growth, order)


# A drive asks for the field of each body to estimate its memory, alone and in all, and to mesh it.
@functools.lru_cache(maxsize=256)
def size_field(
    shape: Shape, refinements: tuple[Refinement, ...], coarse_size: float | None, growth: float, turn: float
) -> SizeField:
    """Return the size field of a body with edges that turn by no more than an angle, rad, on its boundaries."""
    coarse = default_coarse_size(shape) if coarse_size is None else coarse_size
    field = SizeField(balls=refinements, coarse_size=coarse, growth=growth)
    return serve_curvature(shape.curves, field, turn)


def _mesh_shape(
    shape: Shape,
    refinements: Sequence[Refinement],
    coarse_size: float | None,
    growth: float,
    order: int,
    turn: float = MAX_TURN,
) -> BodyMesh:
    if order not in (1, 2):
        raise MeshError(f"element order {order} of the mesh of {shape.name}: must be 1 or 2")
    field = size_field(shape, tuple(refinements), coarse_size, growth, turn)
    unknowns = int(UNKNOWNS_PER_TRIANGLE[order] * field.estimate_triangles(shape.area))
    require_memory(unknowns, mesh_memory(unknowns), f"the mesh of {shape.name}")
    return mesh_within(shape.name, [divide_curve(curve, field, turn) for curve in shape.curves], field, order)


def mesh_within(name: str, outlines: Sequence[Outline], field: SizeField, order: int = 2) -> BodyMesh:
    """Mesh what some outlines bound, the outer one first; MeshError when gmsh fails or the mesh is bad."""
    places, triangles = _fill_interior(name, [line.vertices for line in outlines], field)
    edges: dict[str, IntArray] = {}
    first = 0
    for line in outlines:
        nodes = first + np.arange(len(line.vertices))
        edges[line.name] = np.column_stack([nodes, np.roll(nodes, -1)])
        first += len(nodes)
    mesh = triangle_mesh(np.vstack([places.real, places.imag]), triangles, edges, order=order)
    if order == 2:
        mesh = curve_middles(mesh, outlines)
    body = BodyMesh(name=name, mesh=mesh)
    body.require_complete_boundaries()
    require_quality(body)
    return body


def _fill_interior(name: str, boundary: Sequence[ComplexArray], field: SizeField) -> tuple[ComplexArray, IntArray]:
    """Return vertices (those of the boundary first, outline by outline) and counter-clockwise triangles."""
    with gmsh_model(name) as gmsh:
        loops = []
        count = 0
        for points in boundary:
            loops.append(gmsh.model.geo.addCurveLoop([_add_boundary(gmsh, points, count + 1)]))
            count += len(points)
        gmsh.model.geo.addPlaneSurface(loops)
        gmsh.model.geo.synchronize()
        _set_size_field(gmsh, field)
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:  # gmsh raises nothing more specific
            raise MeshError(f"gmsh cannot mesh {name}: {error}") from error
        tags, coordinates, _ = gmsh.model.mesh.getNodes(2)
        _, corners = gmsh.model.mesh.getElementsByType(TRIANGLE)
    # Node tags 1…count are ours; nodes of the interior follow. Anything gmsh keeps besides (construction
    # points) is no corner of a triangle.
    interior = np.asarray(coordinates, dtype=float).reshape(-1, 3)
    order = np.argsort(tags)
    number = np.full(int(max(tags, default=count)) + 1, -1, dtype=np.int64)
    number[1 : count + 1] = np.arange(count)
    number[np.asarray(tags)[order]] = count + np.arange(len(tags))
    places = np.concatenate([*boundary, (interior[:, 0] + 1j * interior[:, 1])[order]])
    triangles = np.ascontiguousarray(number[np.asarray(corners, dtype=np.int64)].reshape(-1, 3).T)
    if triangles.size == 0 or triangles.min() < 0 or len(np.unique(triangles)) != len(places):
        raise MeshError(f"gmsh left nodes of {name} without elements, or made none")
    a, b, c = places[triangles]
    clockwise = ((b - a).conjugate() * (c - a)).imag < 0.0
    triangles[1:, clockwise] = triangles[:0:-1, clockwise]
    return places, triangles


def _add_boundary(gmsh: ModuleType, points: ComplexArray, first: int) -> int:
    """Add a closed line of edges as a discrete curve with node tags from `first`; return its tag."""
    tags = np.arange(first, first + len(points))
    coordinates = np.column_stack([points.real, points.imag, np.zeros(len(points))])
    start = gmsh.model.addDiscreteEntity(0)
    gmsh.model.setCoordinates(start, *coordinates[0])
    gmsh.model.mesh.addNodes(0, start, tags[:1], coordinates[0])
    gmsh.model.mesh.addElementsByType(start, POINT, [], tags[:1])
    curve: int = gmsh.model.addDiscreteEntity(1, -1, [start, start])
    gmsh.model.mesh.addNodes(1, curve, tags[1:], coordinates[1:].ravel())
    gmsh.model.mesh.addElementsByType(curve, LINE, [], np.column_stack([tags, np.roll(tags, -1)]).ravel())
    return curve


def _set_size_field(gmsh: ModuleType, field: SizeField) -> None:
    fields = []
    for ball, centres in field.balls_alike():
        zone = {
            "inner": min(ball.size, field.coarse_size),
            "outer": field.coarse_size,
            "width": max(field.coarse_size - ball.size, 0.0) / field.growth,
        }
        many = len(centres) >= MANY_BALLS and zone["width"] > 0.0
        fields += (
            _field_of_many(gmsh, centres, ball.radius, zone)
            if many
            else _fields_of_few(gmsh, centres, ball.radius, zone)
        )
    options = {
        "Mesh.MeshSizeExtendFromBoundary": 0,
        "Mesh.MeshSizeFromPoints": 0,
        "Mesh.MeshSizeFromCurvature": 0,
        "Mesh.MeshSizeMax": field.coarse_size,
        "Mesh.Algorithm": FRONTAL_DELAUNAY,
        # Renumbering would lose which node is which point of the boundary.
        "Mesh.Renumber": 0,
    }
    for key, value in options.items():
        gmsh.option.setNumber(key, value)
    if fields:
        smallest = gmsh.model.mesh.field.add("Min")
        gmsh.model.mesh.field.setNumbers(smallest, "FieldsList", fields)
        gmsh.model.mesh.field.setAsBackgroundMesh(smallest)


def _fields_of_few(gmsh: ModuleType, centres: ComplexArray, radius: float, zone: dict[str, float]) -> list[int]:
    """Add a field for each ball; return their tags."""
    tags = []
    for centre in centres.tolist():
        tag = gmsh.model.mesh.field.add("Ball")
        values = {
            "XCenter": centre.real,
            "YCenter": centre.imag,
            "ZCenter": 0.0,
            "Radius": radius,
            "Thickness": zone["width"],
            "VIn": zone["inner"],
            "VOut": zone["outer"],
        }
        for key, value in values.items():
            gmsh.model.mesh.field.setNumber(tag, key, value)
        tags.append(tag)
    return tags


def _field_of_many(gmsh: ModuleType, centres: ComplexArray, radius: float, zone: dict[str, float]) -> list[int]:
    """Add one field by the distance to the nearest centre, which gmsh finds in a tree; return its tag."""
    points = [gmsh.model.geo.addPoint(centre.real, centre.imag, 0.0) for centre in centres.tolist()]
    gmsh.model.geo.synchronize()
    distance, tag = gmsh.model.mesh.field.add("Distance"), gmsh.model.mesh.field.add("Threshold")
    gmsh.model.mesh.field.setNumbers(distance, "PointsList", points)
    values = {
        "InField": distance,
        "DistMin": radius,
        "DistMax": radius + zone["width"],
        "SizeMin": zone["inner"],
        "SizeMax": zone["outer"],
    }
    for key, value in values.items():
        gmsh.model.mesh.field.setNumber(tag, key, value)
    return [tag]
