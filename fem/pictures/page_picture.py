"""Pictures of a page: the field as a raster with a clear ground, axes and scale as SVG in the colours of the page.

So they follow light and dark, and their words stay sharp where a phone scales them down.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from math import floor, log10
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from fem.pictures.scene import Panel, bar_ticks, colour_norm, window_ticks
from ltca.figures.house_style import COLOUR_MAP

SIDE, SIDE_OF_SEVERAL = 800, 640
"""Pixels of the field on a page, alone and beside others."""
QUALITY, QUALITY_OF_EDGES = 75, 60
"""Of its WebP, and of what is clear in it: six positions have two megabytes."""
WIDTH, HEIGHT = 640, 580
"""Of a panel with its axes and scale, units of its SVG."""
LEFT, TOP, FIELD = 64, 8, 500
"""Place and side of the field."""
BAR, BAR_WIDTH, BAR_STEPS = 582, 14, 40
"""Place and width of the scale, and how many colours it has."""


def panel_svg(panel: Panel, image: NDArray[np.uint8], side: int = SIDE) -> str:
    """Return a panel as SVG from its field, of shape (side, side, 4), of which `side` pixels are kept; texts are escaped."""
    name = escape(" ".join(panel.title.split()), {'"': "&quot;"})
    parts = [
        f'<svg class="stress" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{name}">',
        f'<image x="{LEFT}" y="{TOP}" width="{FIELD}" height="{FIELD}" href="{_webp(image, side)}"/>',
        f'<rect class="frame" x="{LEFT}" y="{TOP}" width="{FIELD}" height="{FIELD}"/>',
    ]
    parts += _scale(panel.centre.real, panel.half_side, "x [mm]", upright=False)
    parts += _scale(panel.centre.imag, panel.half_side, "y [mm]", upright=True)
    if panel.label:
        parts += _bar(panel)
    return "".join([*parts, "</svg>"])


def _webp(image: NDArray[np.uint8], side: int) -> str:
    """An image as a data URL, no larger than a page shows it."""
    from PIL import Image

    picture = Image.fromarray(image)
    if picture.width > side:
        picture = picture.resize((side, side), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    picture.save(stream, "WEBP", quality=QUALITY, alpha_quality=QUALITY_OF_EDGES, method=4)
    return "data:image/webp;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def _text(x: float, y: float, words: str, anchor: str, turned: bool = False) -> str:
    turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
    return f'<text class="stress-text" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{turn}>{escape(words)}</text>'


def _scale(centre: float, half_side: float, label: str, *, upright: bool) -> list[str]:
    ticks, parts = window_ticks(centre, half_side), list[str]()
    for tick, words in zip(ticks, _words(ticks), strict=True):
        part = 0.5 + 0.5 * (tick - centre) / half_side
        if upright:
            y = TOP + FIELD * (1.0 - part)
            parts.append(f'<path class="tick" d="M{LEFT},{y:.1f}h-5"/>{_text(LEFT - 9, y + 5, words, "end")}')
        else:
            x = LEFT + FIELD * part
            parts.append(
                f'<path class="tick" d="M{x:.1f},{TOP + FIELD}v5"/>{_text(x, TOP + FIELD + 22, words, "middle")}'
            )
    middle = 0.5 * FIELD
    if upright:
        return [*parts, _text(15, TOP + middle, label, "middle", turned=True)]
    return [*parts, _text(LEFT + middle, HEIGHT - 26, label, "middle")]


def _words(ticks: Sequence[float]) -> list[str]:
    """Ticks as texts with the digits that their step asks for."""
    step = ticks[1] - ticks[0] if len(ticks) > 1 else 1.0
    digits = max(0, -floor(log10(step) + 1e-9))
    return [f"{tick:.{digits}f}".replace("-", "−") for tick in ticks]


def _bar(panel: Panel) -> list[str]:
    """The scale of the colours."""
    import matplotlib as mpl

    norm, colours = colour_norm(panel), mpl.colormaps[COLOUR_MAP]
    each, parts = FIELD / BAR_STEPS, list[str]()
    for step in range(BAR_STEPS):
        colour = mpl.colors.to_hex(colours((step + 0.5) / BAR_STEPS))
        top = TOP + FIELD - (step + 1) * each
        # Half a unit over the next one: no seams.
        size = f'width="{BAR_WIDTH}" height="{each + 0.5:.1f}"'
        parts.append(f'<rect x="{BAR}" y="{top:.1f}" {size} fill="{colour}"/>')
    for tick, words in bar_ticks(panel):
        y = TOP + FIELD * (1.0 - float(norm(tick)))
        parts.append(_text(BAR + BAR_WIDTH + 4, y + 5, words, "start"))
    return [*parts, _text(WIDTH - 2, HEIGHT - 26, panel.label, "end")]
