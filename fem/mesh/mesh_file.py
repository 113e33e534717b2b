"""Meshes on disk: ``.msh`` (gmsh 2.2, groups kept, both orders) and ``.vtu`` (curved quadratic cells).

The text format 2.2 is read by gmsh, meshio and CalculiX pre-processors alike and keeps physical groups of
second-order meshes, which the reader of scikit-fem loses. A file appears under its name only when complete.
"""

from __future__ import annotations

import base64
import struct
import sys
import warnings
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fem.errors import MeshError
from fem.mesh.body_mesh import BodyMesh, triangle_mesh
from fem.mesh.quality import require_valid_elements
from ltca.arrays import FloatArray, IntArray
from ltca.output.files import whole_file

if TYPE_CHECKING:
    import meshio


BODY_TAG = 1
VTK_TRIANGLES = {3: 5, 6: 22}
"""Cell types of VTK by number of nodes."""
# The fastest compression: coordinates and stresses pack a tenth better with the default one, in four times the time.
VTU_LEVEL, VTU_BLOCK = 1, 1 << 20
# meshio reports broken files by whatever its parser stumbles over.
_PARSER_ERRORS = (
    ValueError,
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    AssertionError,
    EOFError,
    OverflowError,
    MemoryError,
    struct.error,
)


def body_stem(name: str, disc: int, discs: int) -> str:
    """Return the stem of the files of a body: of several discs with the number of the disc.

    Examples
    --------
    >>> body_stem("pin_3", 0, 1), body_stem("disc", 1, 2), body_stem("pin_3", 1, 2)
    ('pin_3', 'disc_1', 'disc_1_pin_3')
    """
    if discs == 1:
        return name
    return f"disc_{disc}" if name == "disc" else f"disc_{disc}_{name}"


def _boundary_lines(body: BodyMesh, name: str) -> IntArray:
    nodes = body.boundary_nodes(name)
    return nodes if body.order == 1 else nodes[:, [0, 2, 1]]


def _points(body: BodyMesh) -> FloatArray:
    return np.column_stack([body.mesh.doflocs.T, np.zeros(body.node_count)])


def write_msh(body: BodyMesh, path: str | Path) -> Path:
    """Write a mesh with its named boundaries as gmsh 2.2 text (``.msh``), coordinates in full precision; return the path."""
    import meshio

    names = sorted(body.boundary_names)
    triangles, lines = ("triangle", "line") if body.order == 1 else ("triangle6", "line3")
    cells: list[tuple[str, IntArray]] = [(triangles, body.element_nodes)]
    cells += [(lines, _boundary_lines(body, name)) for name in names]
    tags = [np.full(len(block), BODY_TAG + index, dtype=np.int32) for index, (_, block) in enumerate(cells)]
    groups = {body.name: np.array([BODY_TAG, 2])}
    groups |= {name: np.array([BODY_TAG + index, 1]) for index, name in enumerate(names, start=1)}
    content = meshio.Mesh(
        _points(body), cells, cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags}, field_data=groups
    )
    path = Path(path)
    with whole_file(path) as part:
        meshio.gmsh.write(part, content, fmt_version="2.2", binary=False, float_fmt=".16e")
    return path


def write_vtu(body: BodyMesh, path: str | Path, point_data: Mapping[str, FloatArray] | None = None) -> Path:
    """Write a mesh, and fields on its nodes, for ParaView (``.vtu``): quadratic cells for order 2; return the path.

    Fields have the shape (nodes,) or (nodes, components); MeshError when one does not fit the nodes.
    """
    fields = {key: np.asarray(values) for key, values in (point_data or {}).items()}
    for key, values in fields.items():
        if len(values) != body.node_count:
            raise MeshError(f"field {key!r} has {len(values)} values, but {body.name} has {body.node_count} nodes")
    cells = body.element_nodes
    count, corners = cells.shape
    parts = {
        "Points": {"Points": _points(body)},
        "Cells": {
            "connectivity": cells.ravel(),
            "offsets": corners * np.arange(1, count + 1, dtype=np.int64),
            "types": np.full(count, VTK_TRIANGLES[corners], dtype=np.uint8),
        },
        "PointData": fields,
    }
    path = Path(path)
    with whole_file(path) as part, part.open("w", encoding="ascii", newline="\n") as stream:
        stream.write(
            '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" '
            f'byte_order="{"LittleEndian" if sys.byteorder == "little" else "BigEndian"}" header_type="UInt64" '
            'compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{body.node_count}" NumberOfCells="{count}">\n'
        )
        for name, arrays in parts.items():
            stream.write(f"<{name}>\n")
            stream.writelines(_data_array(key, values) for key, values in arrays.items())
            stream.write(f"</{name}>\n")
        stream.write("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")
    return path


def _data_array(name: str, values: NDArray[Any]) -> str:
    """Return an array as an element of ``.vtu``: compressed blocks as base64 behind their number and sizes."""
    kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
    content = np.ascontiguousarray(values).tobytes()
    blocks = [content[start : start + VTU_BLOCK] for start in range(0, len(content), VTU_BLOCK)]
    packed = [zlib.compress(block, VTU_LEVEL) for block in blocks]
    sizes = [len(blocks), VTU_BLOCK, len(blocks[-1]) if blocks else 0, *map(len, packed)]
    header = np.array(sizes, dtype=np.uint64).tobytes()
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    text = (base64.b64encode(header) + base64.b64encode(b"".join(packed))).decode("ascii")
    return f'<DataArray type="{kind}" Name={quoteattr(name)}{components} format="binary">\n{text}\n</DataArray>\n'


def read_msh(path: str | Path, *, required_boundaries: Sequence[str] = ()) -> BodyMesh:
    """Read a mesh of triangles with named boundaries from any ``.msh`` version that meshio reads.

    Parameters
    ----------
    path : str or Path
        The file; all triangles belong to one body and lie in the plane z = 0.
    required_boundaries : sequence of str
        Names that must be there; when any is given, the named boundaries must also cover the whole outline.

    Returns
    -------
    BodyMesh
        Named after the group of the triangles, or the file; construction points dropped.

    Raises
    ------
    MeshError
        When the file is missing or corrupt, holds no triangles or mixed orders, an element is inverted, or a
        required boundary is missing.
    """
    path = Path(path)
    content = _parse(path)
    blocks = {kind: content.get_cells_type(kind) for kind in ("triangle", "triangle6")}
    present = [kind for kind, block in blocks.items() if len(block)]
    if len(present) != 1:
        raise MeshError(f"{path}: holds {'no' if not present else 'both 3-node and 6-node'} triangles")
    order = 1 if present[0] == "triangle" else 2
    elements = np.asarray(blocks[present[0]], dtype=np.int64)
    points = np.asarray(content.points, dtype=float)
    if elements.min() < 0 or elements.max() >= len(points) or not np.isfinite(points).all():
        raise MeshError(f"{path}: elements name nodes that are not there, or coordinates are no numbers")
    if points.shape[1] > 2 and np.any(points[np.unique(elements), 2] != 0.0):
        raise MeshError(f"{path}: nodes lie outside the plane z = 0")
    name, lines = _groups(content, path, order)
    body = _assemble(name, points[:, :2], elements, lines, order, path)
    try:
        for boundary in required_boundaries:
            body.require_boundary(boundary)
        if required_boundaries:
            body.require_complete_boundaries()
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error
    return body


def _parse(path: Path) -> meshio.Mesh:
    import meshio

    if not path.is_file():
        raise MeshError(f"{path}: no such file")
    # The format ends every section; a file cut short would otherwise be read as far as it goes.
    text = path.read_bytes()
    for section in (b"MeshFormat", b"Nodes", b"Elements"):
        if b"$" + section not in text or b"$End" + section not in text:
            raise MeshError(f"{path}: corrupt or no gmsh mesh (no complete section ${section.decode()})")
    try:
        with warnings.catch_warnings():
            # numpy before 2.3 only warns of numbers that break off, and reads on.
            warnings.simplefilter("error", DeprecationWarning)
            return meshio.gmsh.read(path)
    except (meshio.ReadError, DeprecationWarning, *_PARSER_ERRORS) as error:
        raise MeshError(f"{path}: corrupt, cannot be read as a gmsh mesh ({error or type(error).__name__})") from error
    except SystemExit as error:
        raise MeshError(f"{path}: corrupt, cannot be read as a gmsh mesh") from error


def _groups(content: meshio.Mesh, path: Path, order: int) -> tuple[str, dict[str, IntArray]]:
    """Return the name of the body and the nodes of each named line group."""
    names = {(int(tag), int(dimension)): key for key, (tag, dimension) in content.field_data.items()}
    wanted = {"line": 1, "line3": 2}
    lines: dict[str, list[IntArray]] = {}
    body = path.stem
    physical = content.cell_data.get("gmsh:physical", [])
    for block, tags in zip(content.cells, physical, strict=False):
        for tag in np.unique(tags).tolist():
            if block.type in wanted:
                if wanted[block.type] != order:
                    raise MeshError(f"{path}: boundary lines and triangles are of different order")
                name = names.get((tag, 1))
                if name is not None:
                    lines.setdefault(name, []).append(np.asarray(block.data[np.asarray(tags) == tag]))
            elif block.type.startswith("triangle"):
                body = names.get((tag, 2), body)
    return body, {name: np.vstack(parts).astype(np.int64) for name, parts in lines.items()}


def _assemble(
    name: str, points: FloatArray, elements: IntArray, lines: dict[str, IntArray], order: int, path: Path
) -> BodyMesh:
    used, first_use = np.unique(elements[:, :3], return_inverse=True)
    corners = first_use.reshape(-1, 3)
    number = np.full(len(points), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    edges = {}
    for key, nodes in lines.items():
        if nodes.min() < 0 or nodes.max() >= len(points) or np.any(number[nodes[:, :2]] < 0):
            raise MeshError(f"{path}: boundary {key!r} has nodes that belong to no triangle")
        edges[key] = number[nodes[:, :2]]
    # Inverted elements would be turned silently by a sort, so the order of the file stays.
    try:
        mesh = triangle_mesh(np.ascontiguousarray(points[used].T), np.ascontiguousarray(corners.T), edges, order=order)
        if order == 2:
            # triangle6: mid-sides of (0,1), (1,2), (2,0); the facets of an element stand in the same order.
            facets = mesh.nvertices + mesh.t2f
            mesh.doflocs[:, facets.ravel()] = points[elements[:, 3:].T.ravel()].T
        body = BodyMesh(name=name, mesh=mesh)
        require_valid_elements(body)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error
    return body
