"""CSV of parts: points, normals and curvature of flanks, as grinders and measuring machines take them; circles in a row each.

The points of a flank are those its spline runs through: another periodic cubic spline by chord length through them is the same.
A measured file of the same columns is read back by ``disc.measured_flank`` (`ltca.reading.measured`).
"""

from __future__ import annotations

from pathlib import Path

from ltca.export.flank_outline import FlankSpline
from ltca.export.parts import Circle, Part
from ltca.output.files import whole_file

FLANK_COLUMNS = "x,y,normal_x,normal_y,curvature,theta"
CIRCLE_COLUMNS = "name,x,y,radius,bottom,top"
LAST = 9
"""Decimals of mm: a picometre, far below anything measured, so that what is read back has no steps."""


def table_paths(part: Part, folder: Path) -> tuple[list[Path], Path]:
    """Return the files of a part: one for each flank, one for its circles."""
    flanks = [body.name for body in part.bodies if isinstance(body.outer, FlankSpline)]
    named = [f"_{name.replace(' ', '_')}" if part.name == "assembly" else "" for name in flanks]
    return [folder / f"{part.stem}{name}_flank.csv" for name in named], folder / f"{part.stem}_circles.csv"


def write_tables(part: Part, folder: Path) -> list[Path]:
    """Write the tables of a part and return their files; `FaultError` when a file cannot be written."""
    flanks, circles = table_paths(part, folder)
    head = "".join(f"# {line}\n" for line in (*part.remarks, *part.leads))
    splines = [body.outer for body in part.bodies if isinstance(body.outer, FlankSpline)]
    for path, spline in zip(flanks, splines, strict=True):
        _write(path, head + _flank_table(spline))
    _write(circles, head + _circle_table(part))
    return [*flanks, circles]


def _write(path: Path, text: str) -> None:
    with whole_file(path) as file:
        file.write_text(text, encoding="utf-8", newline="\n")


def _flank_table(spline: FlankSpline) -> str:
    theta = spline.parameter
    points, normals, curvature = spline.points, spline.flank.normals(theta), spline.flank.curvature(theta)
    lines = [
        "# x, y in mm; normal out of the material; curvature in 1/mm, positive where the disc is convex; theta in rad\n",
        f"{FLANK_COLUMNS}\n",
    ]
    rows = zip(
        points.real.tolist(), points.imag.tolist(), normals.real.tolist(), normals.imag.tolist(), curvature.tolist(),
        theta.tolist(), strict=True,
    )  # fmt: skip
    lines += [",".join(f"{value:.{LAST}f}" for value in row[:-1]) + f",{row[-1]:.{LAST + 3}f}\n" for row in rows]
    return "".join(lines)


def _circle_table(part: Part) -> str:
    circles: list[tuple[Circle, float, float]] = []
    for body in part.bodies:
        outer = [body.outer] if isinstance(body.outer, Circle) else []
        circles += [(circle, body.bottom, body.top) for circle in (*outer, *body.inner)]
    circles += [(wall.circle, wall.bottom, wall.top) for wall in part.walls]
    rows = [
        f"{circle.name},"
        + ",".join(f"{value:.{LAST}f}" for value in (circle.centre.real, circle.centre.imag, circle.radius, low, high))
        for circle, low, high in circles
    ]
    return "\n".join(["# centre, radius and z of the ends in mm", CIRCLE_COLUMNS, *rows]) + "\n"
