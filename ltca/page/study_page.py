"""``report.html`` of commands other than ``run``: tables and curves in sections, the drive file behind them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.figures.shared_axes import Axis
from ltca.output.provenance import code_hash, code_version
from ltca.page.packing import pack
from ltca.page.tables import Table, texts
from ltca.page.writing import page_text, script_data, write_page

PAGE = "report.html"


@dataclass(frozen=True, slots=True, kw_only=True)
class Curves:
    """Curves, stems or points over one axis.

    Attributes
    ----------
    title, unit, axis : str
        What it shows, in which unit, over what.
    x : array, shape (points,)
        Along the axis.
    lines : mapping of str to array, shape (points,)
        By name; of a single one the name may be empty.
    kind : str
        ``line``, ``stems`` or ``points``.
    degrees : bool
        Whether the axis is an angle in degrees.
    along, up : Axis or None
        Range and ticks of both axes where they are those of a figure; by default those of the lines.
    dashed : collection of str
        Lines that are dashed, in the colour of the one before.
    """

    title: str
    unit: str
    axis: str
    x: FloatArray
    lines: Mapping[str, FloatArray]
    kind: str = "line"
    degrees: bool = False
    along: Axis | None = None
    up: Axis | None = None
    dashed: Collection[str] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A picture of one or several panels.

    Attributes
    ----------
    name, title : str
        Of its kind, and what it shows.
    panels : sequence of (str, str)
        What each shows, and the panel as SVG, whose texts are escaped and whose colours are classes of ``page.css``.
    """

    name: str
    title: str
    panels: Sequence[tuple[str, str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Part of a page: a heading, then sentences, pictures, curves and tables in this order."""

    heading: str
    notes: Sequence[str] = ()
    pictures: Sequence[Picture] = ()
    curves: Sequence[Curves] = ()
    tables: Sequence[Table] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyPage:
    """What a page shows.

    Attributes
    ----------
    name, told : str
        Of the drive or study, and what was done with it.
    sentence, state : str
        The outcome in one sentence, and whether it is a ``pass``, a ``fail`` or neither.
    sections : sequence of Section
        In their order.
    made : mapping of str to str
        What the numbers were computed by, beside version and hash of the code.
    text : str
        The drive file.
    """

    name: str
    told: str
    sections: Sequence[Section]
    sentence: str = ""
    state: str = ""
    made: Mapping[str, Any] = field(default_factory=dict)
    text: str = ""


def write_study_page(page: StudyPage, folder: Path) -> Path:
    """Write the page of a command into its folder; return where it is."""
    return write_page(folder / PAGE, study_page(page))


def curves_content(sections: Sequence[Section]) -> tuple[dict[str, FloatArray], list[dict[str, Any]]]:
    """Return the numbers of the curves of sections, by name, and what the script ``sections.js`` is told of each."""
    arrays: dict[str, FloatArray] = {}
    plots: list[dict[str, Any]] = []
    for section in sections:
        for curves in section.curves:
            first = f"plot/{len(plots)}"
            arrays[f"{first}/x"] = np.asarray(curves.x, dtype=float)
            for place, values in enumerate(curves.lines.values()):
                arrays[f"{first}/{place}"] = np.asarray(values, dtype=float)
            told: dict[str, Any] = {
                "title": curves.title,
                "unit": curves.unit,
                "axis": curves.axis,
                "names": list(curves.lines),
            }
            told |= {"kind": curves.kind, "degrees": curves.degrees, "along": curves.along, "up": curves.up}
            plots.append(told | {"dashed": [name in curves.dashed for name in curves.lines]})
    return arrays, plots


def study_page(page: StudyPage) -> str:
    """Return the page of a command; the same content gives the same page."""
    arrays, plots = curves_content(page.sections)
    places, numbers = pack(arrays)
    made = [("version of cyclo", code_version()), ("hash of its code", code_hash("ltca"))]
    made += [(name.replace("_", " "), str(value)) for name, value in page.made.items()]
    return page_text(
        "study.html",
        {
            "title": f"{page.name}: {page.told}",
            "page": page,
            "made": Table(name="computed_by", caption="", columns=["", "value"], rows=texts(made), words=1),
            "data": script_data({"places": places, "plots": plots}),
            "numbers": numbers,
        },
        scripts=("plots", "motion", "sections", "study"),
    )
