"""STEP files of parts: a product for each body, flanks as exact B-splines; the same input, the same bytes.

Flanks are B-splines with the control points and knots of `ltca.export.flank_outline`: splines fitted by the kernel are microns
away. It integrates volumes with a fixed rule for each face, so there are several for each lobe: one closed spline reads 7 %
wrong, whole lobes of `robot-joint` 1e-4.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np

from fem.errors import MeshError
from fem.mesh.gmsh_session import gmsh_model
from ltca.errors import FaultError, one_line
from ltca.export.flank_outline import ClampedSpline, FlankSpline
from ltca.export.parts import Body, Circle, Part, Wall
from ltca.output.files import whole_file

POINT, CURVE, SURFACE, VOLUME = 0, 1, 2, 3
SAME_VOLUME = 1e-4
"""Relative difference between the volume of a solid and its exact section times its height at which it is refused: the kernel
integrates to some 1e-5, a wrong loop is far beyond it."""
ALONG_WIDTH = 5e-4
"""Departure of straight lines between the outlines of a lofted flank, mm; the smooth surface through them departs by a fifth."""
LAST_LINE = "END-ISO-10303-21;"
_PRODUCT = re.compile(r"PRODUCT\('Open CASCADE STEP translator [0-9.]+ [0-9]+(?:\.([0-9]+))?',\s*'[^']*'")
_HEADER = re.compile(r"HEADER;.*?ENDSEC;", re.DOTALL)
_SCHEMA = re.compile(r"FILE_SCHEMA\(.*?\);", re.DOTALL)
_SOLID = re.compile(r"(MANIFOLD_SOLID_BREP|SHELL_BASED_SURFACE_MODEL)\(''")
_OCCURRENCE = re.compile(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[0-9]+','[^']*'")


def write_solids(part: Part, path: Path, note: Callable[[str], None] = lambda step: None) -> None:
    """Write a part of bodies as a STEP file in mm; `note` is told of each step before it starts.

    MeshError when gmsh cannot be loaded or makes a solid of a wrong volume.

    Examples
    --------
    >>> import ltca, tempfile
    >>> from ltca.export.parts import make_parts
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_solids(make_parts(drive, "CS-1", "pin-wheel")[0], path := Path(folder) / "wheel.step")
    ...     path.read_text().count("MANIFOLD_SOLID_BREP") == drive.pin_wheel.number_of_pins
    True
    """
    with gmsh_model(part.name) as gmsh:
        for body in part.bodies:
            _add_solid(gmsh, body, note)
        for wall in part.walls:
            _add_wall(gmsh, wall)
        note("volumes")
        gmsh.model.occ.synchronize()
        _require_volumes(gmsh, part.bodies)
        note("file")
        with whole_file(path) as file:
            try:
                with _quiet_kernel():
                    gmsh.write(str(file))
            except Exception as error:  # gmsh raises no other kind
                raise FaultError(f"{path}: cannot be written: {one_line(error)}") from error
            names = [body.name for body in part.bodies] + [wall.circle.name for wall in part.walls]
            text = file.read_text(encoding="ascii")
            if LAST_LINE not in text:  # the kernel does not say that it failed
                raise FaultError(f"{path}: cannot be written whole")
            file.write_text(_named(text, part, names), encoding="ascii", newline="\n")


def _add_solid(gmsh: ModuleType, body: Body, note: Callable[[str], None]) -> None:
    """Extrude the section of a body, or loft it along its lead; solids are numbered in the order they are added."""
    occ = gmsh.model.occ
    if body.lead is not None:
        _add_lofted(gmsh, body, note)
        return
    note(body.name)
    loops = [_add_loop(gmsh, curve, body.bottom) for curve in (body.outer, *body.inner)]
    face = occ.addPlaneSurface(loops)
    occ.extrude([(SURFACE, face)], 0.0, 0.0, body.top - body.bottom)


def _add_lofted(gmsh: ModuleType, body: Body, note: Callable[[str], None]) -> None:
    """A smooth surface through the outlines at several heights, with the holes cut out of it."""
    occ = gmsh.model.occ
    heights, loops = body.heights(ALONG_WIDTH).tolist(), list[int]()
    for number, height in enumerate(heights, 1):
        note(f"{body.name}, outline {number} of {len(heights)} along its lead")
        loops.append(_add_loop(gmsh, body.outline(height), height))
    note(f"{body.name}, surface through {len(heights)} outlines")
    ((_, solid),) = [one for one in occ.addThruSections(loops, makeSolid=True) if one[0] == VOLUME]
    occ.remove([(CURVE, tag) for _, tag in occ.getEntities(CURVE)], recursive=True)
    height = body.top - body.bottom
    holes = [
        (VOLUME, occ.addCylinder(one.centre.real, one.centre.imag, body.bottom, 0.0, 0.0, height, one.radius))
        for one in body.inner
    ]
    if holes:
        note(f"{body.name}, {len(holes)} holes")
        occ.cut([(VOLUME, solid)], holes)


def _add_loop(gmsh: ModuleType, curve: FlankSpline | Circle, height: float) -> int:
    occ = gmsh.model.occ
    if isinstance(curve, Circle):
        lines = [occ.addCircle(curve.centre.real, curve.centre.imag, height, curve.radius)]
    else:
        arcs = curve.arcs()
        starts = [_add_point(gmsh, arc.control_points[0], height) for arc in arcs]
        ends = [*starts[1:], starts[0]]
        lines = [_add_arc(gmsh, arc, start, end, height) for arc, start, end in zip(arcs, starts, ends, strict=True)]
    loop: int = occ.addCurveLoop(lines)
    return loop


def _add_arc(gmsh: ModuleType, arc: ClampedSpline, start: int, end: int, height: float) -> int:
    inner = [_add_point(gmsh, point, height) for point in arc.control_points[1:-1].tolist()]
    knots, counts = np.unique(arc.knots, return_counts=True)
    line: int = gmsh.model.occ.addBSpline(
        [start, *inner, end], degree=3, knots=knots.tolist(), multiplicities=counts.tolist()
    )
    gmsh.model.occ.remove([(POINT, tag) for tag in inner])  # or they would be vertices in the file
    return line


def _add_point(gmsh: ModuleType, point: complex, height: float) -> int:
    tag: int = gmsh.model.occ.addPoint(point.real, point.imag, height)
    return tag


def _add_wall(gmsh: ModuleType, wall: Wall) -> None:
    """A cylindrical surface that bounds no body."""
    occ, circle = gmsh.model.occ, wall.circle
    line = occ.addCircle(circle.centre.real, circle.centre.imag, wall.bottom, circle.radius)
    occ.extrude([(CURVE, line)], 0.0, 0.0, wall.top - wall.bottom)


def _require_volumes(gmsh: ModuleType, bodies: Sequence[Body]) -> None:
    """Check the volumes, which a loop that does not close or a missing hole would change."""
    solids = gmsh.model.getEntities(VOLUME)
    if len(solids) != len(bodies):
        raise MeshError(f"gmsh made {len(solids)} solids of {len(bodies)} bodies")
    for (_, tag), body in zip(solids, bodies, strict=True):
        volume, exact = gmsh.model.occ.getMass(VOLUME, tag), body.volume
        if abs(volume - exact) > SAME_VOLUME * exact:
            raise MeshError(
                f"gmsh made {body.name} with {volume:.8g} mm³, its section times its height is {exact:.8g} mm³"
            )


def _named(text: str, part: Part, names: Sequence[str]) -> str:
    """Give the products of a STEP file their names, and a header without clock or machine."""
    title = _quoted(part.title)
    own = [_quoted(f"{part.drive} {part.case} {name}") for name in names] if len(names) > 1 else [title]

    def product(found: re.Match[str]) -> str:
        name = title if found[1] is None else own[int(found[1]) - 1]
        return f"PRODUCT('{name}','{name}'"

    solids: Iterator[str] = iter(own)
    text = _PRODUCT.sub(product, text)
    text = _SOLID.sub(lambda found: f"{found[1]}('{next(solids)}'", text)
    occurrences = iter(enumerate(own, 1))  # the kernel counts on through all files of a process
    text = _OCCURRENCE.sub(lambda _: "NEXT_ASSEMBLY_USAGE_OCCURRENCE('{}','{}'".format(*next(occurrences)), text)
    schema = _SCHEMA.search(text)
    remarks = ",".join(f"'{_quoted(remark)}'" for remark in (*part.remarks, *part.leads))
    header = (
        f"HEADER;\nFILE_DESCRIPTION(({remarks}),'2;1');\n"
        f"FILE_NAME('{_quoted(part.stem)}.step','',(''),(''),'cyclo','cyclo','');\n{schema[0] if schema else ''}\nENDSEC;"
    )
    return _HEADER.sub(lambda _: header, text, count=1)


def _quoted(text: str) -> str:
    """A text as STEP writes it (ISO 10303-21): quotes and backslashes doubled, what is not ASCII by its code point."""

    def signs(found: re.Match[str]) -> str:
        code, digits = ("X4", 8) if max(found[0]) > "\uffff" else ("X2", 4)
        return f"\\{code}\\{''.join(f'{ord(letter):0{digits}X}' for letter in found[0])}\\X0\\"

    return re.sub(r"[^\x20-\x7e]+", signs, text.replace("\\", "\\\\").replace("'", "''"))


@contextmanager
def _quiet_kernel() -> Iterator[None]:
    """Discard the kernel's statistics, which no option of gmsh silences."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(nowhere)
        os.close(kept)
