"""Flat scenes of triangles and lines: fields by pyvista off-screen or, without GL, matplotlib; text by matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fem.pictures.flat_view import coordinate_pairs, flat_lines, flat_surface, may_show, snapshot
from fem.pictures.offscreen import rendering_problem
from ltca.arrays import ComplexArray, FloatArray, IntArray
from ltca.figures.house_style import COLOUR_MAP, STYLE
from ltca.output.files import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure


PIXELS_PER_INCH = 200.0
"""Of pictures; the text keeps its size, so it is relatively larger on a smaller picture."""
BAR_INCHES, TITLE_INCHES = 1.25, 0.85
"""Inches for the scales beside a panel, and for its title and the scale below."""
LETTERS_PER_INCH = 12.5
MIN_INCHES = 4.0


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
    logarithmic : bool
        Whether equal steps of colour are equal ratios; what is below the limits has the colour of the lower one.
    """

    title: str
    centre: complex
    half_side: float
    triangles: tuple[Triangles, ...]
    lines: tuple[Lines, ...]
    label: str = ""
    limits: tuple[float, float] = (0.0, 1.0)
    logarithmic: bool = False


def render(path: Path, panels: Sequence[Panel], *, side: int = 1100) -> str:
    """Render panels of `side` pixels side by side into a PNG file; return why matplotlib drew it, "" when pyvista did."""
    write_panels(path, panels, paint_panels(panels, side), side)
    return rendering_problem()


def paint_panels(panels: Sequence[Panel], side: int) -> list[NDArray[np.uint8]]:
    """Return the fields of panels without their axes, on a clear ground, of shape (side, side, 4) each."""
    paint = _painted_by_matplotlib if rendering_problem() else _painted_by_pyvista
    return [paint(_clip(panel), side) for panel in panels]


def write_panels(path: Path, panels: Sequence[Panel], images: Sequence[NDArray[np.uint8]], side: int) -> None:
    """Write panels side by side into a PNG file from their painted fields (`paint_panels`)."""
    import matplotlib as mpl

    left = iter(images)

    def paint(axes: Any, panel: Panel, *_: Any) -> None:
        reach, middle = panel.half_side, panel.centre
        extent = (middle.real - reach, middle.real + reach, middle.imag - reach, middle.imag + reach)
        axes.imshow(next(left), extent=extent, interpolation="antialiased")

    with mpl.rc_context({**STYLE, "axes.grid": False}), whole_file(path) as part:
        figure = compose(panels, side, paint)
        figure.savefig(part, dpi=side / _inches(side))


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


def compose(panels: Sequence[Panel], side: int, paint: Callable[[Any, Panel, Any, int], None]) -> Figure:
    """Return panels side by side: title above, axes in mm, colour bar beside the field.

    `paint` draws a panel into axes by a norm of colours, with `side` pixels.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    width = _inches(side)
    figure = Figure(figsize=((width + BAR_INCHES) * len(panels), width + TITLE_INCHES), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        norm = colour_norm(panel)
        paint(axes, panel, norm, side)
        letters = int(LETTERS_PER_INCH * width)
        axes.set_title("\n".join(fill(line, letters) for line in panel.title.split("\n")), parse_math=False)
        axes.set_aspect("equal")
        axes.set_xlim(panel.centre.real - panel.half_side, panel.centre.real + panel.half_side)
        axes.set_ylim(panel.centre.imag - panel.half_side, panel.centre.imag + panel.half_side)
        axes.set(xlabel="x [mm]", ylabel="y [mm]")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(5))
        axes.ticklabel_format(useOffset=False)
        if panel.label:
            bar = figure.colorbar(
                ScalarMappable(norm, COLOUR_MAP), ax=axes, label=panel.label, shrink=0.75, pad=0.02,
                extend="min" if panel.logarithmic else "neither",
            )  # fmt: skip
            bar.outline.set_visible(False)
            ticks = bar_ticks(panel)
            bar.set_ticks([tick for tick, _ in ticks], labels=[words for _, words in ticks])
            bar.minorticks_off()
    return figure


def colour_norm(panel: Panel) -> Any:
    """Return what takes values of a panel to parts of its colours."""
    from matplotlib.colors import LogNorm, Normalize

    return LogNorm(*panel.limits, clip=True) if panel.logarithmic else Normalize(*panel.limits)


def bar_ticks(panel: Panel) -> list[tuple[float, str]]:
    """Return ticks of the scale of the colours, and what they say."""
    from matplotlib.ticker import MaxNLocator

    if panel.logarithmic:
        return [(tick, f"{tick:g}") for tick in _round_values(*panel.limits)]
    ticks = MaxNLocator(6).tick_values(*panel.limits)
    return [(float(tick), f"{tick:g}") for tick in ticks if tick <= panel.limits[1]]


def window_ticks(centre: float, half_side: float) -> list[float]:
    """Return ticks of an axis of a window, mm."""
    from matplotlib.ticker import MaxNLocator

    low, high = centre - half_side, centre + half_side
    return [float(tick) for tick in MaxNLocator(5).tick_values(low, high) if low <= tick <= high]


def _inches(side: int) -> float:
    """Return the side of a panel, inches; below `MIN_INCHES` the text shrinks with the panel."""
    return max(side / PIXELS_PER_INCH, MIN_INCHES)


def _round_values(low: float, high: float) -> list[float]:
    """1, 2 and 5 of every power of ten within limits."""
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    return [step * 10.0**power for power in powers for step in (1.0, 2.0, 5.0) if low <= step * 10.0**power <= high]


def _painted_by_pyvista(panel: Panel, side: int) -> NDArray[np.uint8]:
    norm, layers = colour_norm(panel), list[tuple[Any, dict[str, Any]]]()
    for surface in panel.triangles:
        mesh = flat_surface(surface.points, surface.faces)
        if surface.values is None:
            layers.append((mesh, {"color": surface.colour}))
            continue
        coloured = np.asarray(norm(surface.values))
        layers.append((mesh, {"scalars": coloured, "cmap": COLOUR_MAP, "clim": (0.0, 1.0), "show_scalar_bar": False}))
    for number, item in enumerate(panel.lines):
        height = (0.01 + 1e-4 * number) * panel.half_side
        layers.append((flat_lines(item.points, height), {"color": item.colour, "line_width": item.width}))
    return snapshot(layers, panel.centre, panel.half_side, side)


def _painted_by_matplotlib(panel: Panel, side: int) -> NDArray[np.uint8]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    figure, norm = Figure(figsize=(1.0, 1.0), dpi=side, facecolor="none"), colour_norm(panel)
    figure.set_layout_engine("none")
    axes: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    for surface in panel.triangles:
        coloured = surface.values is not None
        axes.tripcolor(
            surface.points.real,
            surface.points.imag,
            surface.faces,
            np.zeros(len(surface.points)) if surface.values is None else np.asarray(norm(surface.values)),
            shading="gouraud",
            cmap=COLOUR_MAP if coloured else _single(surface.colour),
            vmin=0.0,
            vmax=1.0,
        )
    for number, item in enumerate(panel.lines):
        segments = coordinate_pairs(item.points)
        width = item.width * 72.0 / side  # points, of which 72 are the side
        axes.add_collection(LineCollection(segments, colors=item.colour, linewidths=width, zorder=3 + 0.01 * number))
    reach, middle = panel.half_side, panel.centre
    axes.set_xlim(middle.real - reach, middle.real + reach)
    axes.set_ylim(middle.imag - reach, middle.imag + reach)
    canvas: Any = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba(), dtype=np.uint8)


def _single(colour: str) -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap([colour])
