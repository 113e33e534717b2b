"""Style of all figures: colours, maps, fonts, symbols, and reproducible files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from ltca.output.files import whole_file

# Okabe and Ito's palette, readable with every kind of colour vision; black first for the clearance-free case.
COLOURS = ("#000000", "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A7A7A")
OTHERS = "#cccccc"
"""What stands behind for comparison."""
MARK = "#7a7a7a"
"""Lines of reference and their words."""
INK = "#222222"
"""Names: text in the colour of a light line would be hard to read."""
COLOUR_MAP = "viridis"
"""Perceptually even, told apart with every kind of colour vision."""
DASHED = (0, (4, 2))
DOTS_PER_INCH = 130
STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "figure.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.2,
    "image.cmap": COLOUR_MAP,
    # Names of drives and cases are the user's: a dollar sign in them starts no formula.
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "cyclo",
    "pdf.fonttype": 42,
    "figure.constrained_layout.use": True,
}
CRANK_ANGLE = r"$\varphi_\mathrm{C}$"
"""The crank angle, as a formula: only texts of ours are set with `formula`."""
CRANK = f"crank angle {CRANK_ANGLE} [°]"
"""Label of the axis that most figures share."""


def formula(text: Any) -> Any:
    """Let matplotlib read a text as a formula between dollar signs, and return it; for texts without any name of a user's."""
    text.set_parse_math(True)
    return text


def shortened_label(name: str, letters: int) -> str:
    """Return a name with its middle left out where it has more letters than there is room for."""
    if len(name) <= letters:
        return name
    head = (letters - 1) // 2
    return f"{name[:head]}…{name[len(name) - (letters - 1 - head) :]}"


def save_figure(figure: Figure, path: Path) -> Path:
    """Write a figure and return the file; same input, same bytes: no clock in it, and identifiers from a fixed salt."""
    clock: dict[str, Any] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with mpl.rc_context(STYLE):
        # To find the layout takes as long as to draw, and saving would find it twice.
        layout = figure.get_layout_engine()
        if layout is not None:
            layout.execute(figure)
        figure.set_layout_engine("none")
        # To a stream of bytes: Windows would end the lines of a picture in its own way.
        with whole_file(path) as part, part.open("wb") as stream:
            figure.savefig(stream, format=path.suffix[1:], dpi=DOTS_PER_INCH, metadata=clock.get(path.suffix))
    return path
