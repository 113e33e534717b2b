"""Flat scenes of coloured triangles and lines, rendered by pyvista off-screen or, without GL, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.pictures.flat_view import (
    coordinate_pairs,
    flat_lines,
    flat_surface,
    look_down,
    may_show,
    open_plotter,
    plain_text,
)
from fem.pictures.offscreen import rendering_problem
from ltca.output.files import whole_file

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]

COLOUR_MAP = "turbo"


@dataclass(frozen=True, slots=True, kw_only=True)
class Triangles:
    """Filled triangles.

    Attributes
    ----------
    points : array of complex, shape (n,)
        mm.
    faces : array of int, shape (m, 3)
        Straight triangles.
    values : array, shape (n,), or None
        To be shown by colour; None for `colour`.
    colour : str
        Without values.
    """

    points: ComplexArray
    faces: IntArray
    values: FloatArray | None = None
    colour: str = "#dddddd"


@dataclass(frozen=True, slots=True, kw_only=True)
class Lines:
    """Polylines of equal length.

    Attributes
    ----------
    points : array of complex, shape (lines, points)
        mm.
    colour : str
        Of all of them.
    width : float
        Pixels.
    """

    points: ComplexArray
    colour: str = "#303030"
    width: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One square window on a scene.

    Attributes
    ----------
    title : str
        Above it.
    centre : complex
        mm.
    half_side : float
        mm.
    triangles : tuple of Triangles
        Below the lines.
    lines : tuple of Lines
        Above the triangles.
    label : str
        Of the colour bar; "" for none.
    limits : tuple of two floats
        Of the colours.
    """

    title: str
    centre: complex
    half_side: float
    triangles: tuple[Triangles, ...]
    lines: tuple[Lines, ...]
    label: str = ""
    limits: tuple[float, float] = (0.0, 1.0)


def render(path: Path, panels: Sequence[Panel], *, side: int = 1100) -> str:
    """Render panels side by side into a PNG file.

    Parameters
    ----------
    path : Path
        The file; it appears only when complete.
    panels : sequence of Panel
        From left to right.
    side : int
        Pixels of each panel.

    Returns
    -------
    str
        "" when pyvista drew it, else why matplotlib did.

    Raises
    ------
    CycloError
        When the file cannot be written.
    """
    problem = rendering_problem()
    clipped = [_clip(panel) for panel in panels]
    with whole_file(path) as part:
        (_render_with_matplotlib if problem else _render_with_pyvista)(part, clipped, side)
    return problem


def _clip(panel: Panel) -> Panel:
    """Leave out what lies outside the window."""

    def shows(points: ComplexArray) -> NDArray[np.bool_]:
        return may_show(points, panel.centre, panel.half_side)

    triangles = [
        replace(surface, faces=faces)
        for surface in panel.triangles
        if len(faces := surface.faces[shows(surface.points[surface.faces])])
    ]
    lines = [replace(item, points=points) for item in panel.lines if len(points := item.points[shows(item.points)])]
    return replace(panel, triangles=tuple(triangles), lines=tuple(lines))


def _render_with_pyvista(path: Path, panels: Sequence[Panel], side: int) -> None:
    plotter = open_plotter(shape=(1, len(panels)), window_size=[side * len(panels), side])
    for column, panel in enumerate(panels):
        plotter.subplot(0, column)
        plotter.set_background("white")
        bar = bool(panel.label)
        for surface in panel.triangles:
            mesh = flat_surface(surface.points, surface.faces)
            if surface.values is None:
                plotter.add_mesh(mesh, color=surface.colour, lighting=False)
                continue
            plotter.add_mesh(
                mesh,
                scalars=surface.values,
                cmap=COLOUR_MAP,
                clim=panel.limits,
                lighting=False,
                show_scalar_bar=bar,
                scalar_bar_args={
                    "title": panel.label + " " * column,
                    "color": "black",
                    "n_labels": 5,
                    "vertical": True,
                    "position_x": 0.90,
                    "position_y": 0.2,
                    "width": 0.06,
                    "height": 0.6,
                    "title_font_size": 16,
                    "label_font_size": 14,
                },
            )
            bar = False
        for item in panel.lines:
            lines = flat_lines(item.points, 0.01 * panel.half_side)
            plotter.add_mesh(lines, color=item.colour, lighting=False, line_width=item.width)
        plotter.add_text(plain_text(panel.title), font_size=11, color="black", position="upper_edge")
        look_down(plotter, panel.centre, panel.half_side, 10.0 * panel.half_side)
    plotter.screenshot(str(path))
    plotter.close()


def _render_with_matplotlib(path: Path, panels: Sequence[Panel], side: int) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    figure = Figure(figsize=(side * len(panels) / 100.0, side / 100.0), layout="constrained")
    FigureCanvasAgg(figure)
    for column, panel in enumerate(panels):
        axes = figure.add_subplot(1, len(panels), column + 1)
        coloured: Any = None
        for surface in panel.triangles:
            values = np.zeros(len(surface.points)) if surface.values is None else surface.values
            drawn: Any = axes.tripcolor(  # type: ignore[call-overload]
                surface.points.real,
                surface.points.imag,
                surface.faces,
                values,
                shading="gouraud",
                cmap=COLOUR_MAP if surface.values is not None else _single(surface.colour),
                vmin=panel.limits[0],
                vmax=panel.limits[1],
            )
            coloured = drawn if surface.values is not None else coloured
        for item in panel.lines:
            segments = coordinate_pairs(item.points)
            axes.add_collection(LineCollection(segments, colors=item.colour, linewidths=0.6 * item.width))
        if coloured is not None and panel.label:
            figure.colorbar(coloured, ax=axes, label=panel.label, shrink=0.8)
        axes.set_aspect("equal")
        axes.set_xlim(panel.centre.real - panel.half_side, panel.centre.real + panel.half_side)
        axes.set_ylim(panel.centre.imag - panel.half_side, panel.centre.imag + panel.half_side)
        axes.set(xlabel="x, mm", ylabel="y, mm")
        axes.set_title(panel.title, parse_math=False)
    figure.savefig(path, dpi=100.0)


def _single(colour: str) -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap([colour])
