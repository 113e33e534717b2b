"""DXF drawings of parts: one closed spline for each flank, circles, a layer for each feature; the same input, the same bytes.

The spline has the control points and knots of `ltca.export.flank_outline`. It is clamped and closes because its last control
point is its first; the flag of closed splines is left out, which some readers take as an order to repeat control points.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.arrays import ComplexArray
from ltca.export.flank_outline import FlankSpline
from ltca.export.parts import Body, Circle, Part
from ltca.output.files import whole_file

if TYPE_CHECKING:
    from types import ModuleType


RELEASE = "R2010"
PLANAR = 8
"""Flag of splines in one plane."""
COLOURS = {
    "bore": 4, "hole": 3, "pin": 30, "slot": 8, "sleeve": 6, "sleeve-bore": 6, "shaft-pin": 1, "shaft-sleeve": 6,
    "shaft-sleeve-bore": 6, "inner-race": 150, "roller": 140, "ring": 9, "ring-bore": 9,
    "post": 2, "flange": 9, "flange-hole": 9,
}  # fmt: skip
"""AutoCAD colour index of each feature."""
FLANKS = (7, 2, 6, 4)
"""Of the flanks of an assembly; 7 is black on white and white on black."""
REMARKS = ("Part", "Lengths", "Frame", "Compensation")
"""Properties of the drawing."""
MARGIN = 1.1
"""Height of the view by that of the part."""
_options = threading.Lock()


def write_drawing(part: Part, path: Path) -> None:
    """Write a part as a DXF file in mm; `FaultError` when the file cannot be written.

    Examples
    --------
    >>> import ezdxf, ltca, tempfile
    >>> from ltca.export.parts import make_parts
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_drawing(make_parts(ltca.load_drive("paper").cases["CS-1"], "CS-1")[0], path := Path(folder) / "disc.dxf")
    ...     sorted(layer.dxf.name for layer in ezdxf.readfile(path).layers if layer.dxf.name not in ("0", "Defpoints"))
    ['BORE', 'FLANK', 'HOLE']
    """
    import ezdxf
    from ezdxf.filemanagement import new

    with _without_clock(ezdxf):
        document = new(RELEASE, units=ezdxf.units.MM)
        for name, remark in zip(REMARKS, part.remarks, strict=False):
            document.header.custom_vars.append(name, remark)
        for number, lead in enumerate(part.leads):
            document.header.custom_vars.append(f"Lead {number}", lead)
        space = document.modelspace()
        for body in part.bodies:
            _draw(document, space, body)
        for wall in part.walls:
            _draw_circle(document, space, wall.circle, "")
        _show_all(document, _corners(part))
        for kind in sorted(document.entitydb.dxf_types_in_use()):  # written in the order of a set, unless known before
            document.classes.add_class(kind)
        stream = io.StringIO()
        document.write(stream)
    # From R2007 on drawings are UTF-8.
    with whole_file(path) as file:
        file.write_text(stream.getvalue(), encoding="utf-8", newline="\n")


def _draw(document: Any, space: Any, body: Body) -> None:
    disc = f"{body.of.replace(' ', '_').upper()}_" if body.of else ""
    if isinstance(body.outer, FlankSpline):
        curve = body.outer.clamped()
        points = np.column_stack([curve.control_points.real, curve.control_points.imag, np.zeros(curve.knots.size - 4)])
        spline = space.add_open_spline(points.tolist(), degree=3, dxfattribs={"layer": _layer(document, "flank", disc)})
        spline.knots = curve.knots.tolist()
        spline.dxf.flags = PLANAR
        spline.dxf.extrusion = (0.0, 0.0, 1.0)
    else:
        _draw_circle(document, space, body.outer, disc)
    for circle in body.inner:
        _draw_circle(document, space, circle, disc)


def _draw_circle(document: Any, space: Any, circle: Circle, disc: str) -> None:
    layer = _layer(document, circle.feature, disc)
    space.add_circle((circle.centre.real, circle.centre.imag, 0.0), circle.radius, dxfattribs={"layer": layer})


def _layer(document: Any, feature: str, disc: str) -> str:
    """Return the name of a feature's layer, made if it is not there."""
    name = f"{disc}{feature.replace('-', '_').upper()}"
    if name not in document.layers:
        flanks = sum(layer.dxf.name.endswith("FLANK") for layer in document.layers)
        document.layers.add(name, color=FLANKS[flanks % len(FLANKS)] if feature == "flank" else COLOURS[feature])
    return name


def _corners(part: Part) -> ComplexArray:
    """Two opposite corners of what is drawn."""
    points = [body.outer.points for body in part.bodies if isinstance(body.outer, FlankSpline)]
    circles = [body.outer for body in part.bodies if isinstance(body.outer, Circle)] + [w.circle for w in part.walls]
    corners = [circle.centre + sign * circle.radius * (1 + 1j) for circle in circles for sign in (-1.0, 1.0)]
    every = np.concatenate([*points, np.array(corners, dtype=complex)])
    return np.array([every.real.min() + 1j * every.imag.min(), every.real.max() + 1j * every.imag.max()])


def _show_all(document: Any, corners: ComplexArray) -> None:
    """Let a program that opens the drawing show all of it."""
    low, high = corners.tolist()
    document.modelspace().reset_extents((low.real, low.imag, 0.0), (high.real, high.imag, 0.0))
    middle = 0.5 * (low + high)
    document.set_modelspace_vport(height=MARGIN * (high - low).imag, center=(middle.real, middle.imag))


@contextmanager
def _without_clock(ezdxf: ModuleType) -> Iterator[None]:
    """Let the library write no times and no random numbers: equal input gives equal bytes."""
    with _options:
        before = ezdxf.options.write_fixed_meta_data_for_testing
        ezdxf.options.write_fixed_meta_data_for_testing = True
        try:
            yield
        finally:
            ezdxf.options.write_fixed_meta_data_for_testing = before
