"""``report.html`` of commands other than ``run``: tables and curves in sections, the drive file behind them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
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
        ``line``, ``stems``, ``points``, or ``bars`` about evenly spaced places.
    degrees : bool
        Whether the axis is an angle in degrees.
    along, up : Axis or None
        Range and ticks of both axes where they are those of a figure; by default those of the lines.
    dashed : collection of str
        Lines that are dashed, in the colour of the one before.
    marks : sequence of Mark
        Upright lines at places of the axis.
    span : tuple of float
        Least and most along the axis, least and most of the values: what is drawn; empty for everything.
    large : sequence of str
        Lines whose points are drawn larger.
    beside : mapping of str to str
        Lines that are drawn thin, dashed and all in the same quiet colour, with the text on each.
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
    marks: Sequence[Mark] = ()
    span: tuple[float, ...] = ()
    large: Sequence[str] = ()
    beside: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A picture of one or several panels.

    Attributes
    ----------
    name, title : str
        Of its kind, and what it shows.
    panels : sequence of (str, str)
        What each shows, and the panel as SVG, whose texts are escaped and whose colours are classes of ``page.css``.
    keys : sequence of (str, str, str)
        What stands behind the title: words, classes of a sign, empty without one, and words behind it.
    """

    name: str
    title: str
    panels: Sequence[tuple[str, str]]
    keys: Sequence[tuple[str, str, str]] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Responses:
    """Quantities of samples, each over one factor that the reader chooses.

    Attributes
    ----------
    samples : array, shape (samples,)
        Their numbers.
    factors : sequence of Factor
        What was varied.
    quantities : mapping of str to array, shape (samples,)
        By title with unit.
    """

    samples: FloatArray
    factors: Sequence[Factor]
    quantities: Mapping[str, FloatArray]


@dataclass(frozen=True, slots=True, kw_only=True)
class Factor:
    """One factor of `Responses`.

    Attributes
    ----------
    title : str
        With unit.
    values : array, shape (samples,)
        Numbers, or numbers of `levels`.
    levels : sequence of str
        Texts in place of numbers; empty for numbers.
    path : array, shape (places,)
        Places of samples in the order in which lines join them, not a number between lines; empty without lines.
    """

    title: str
    values: FloatArray
    levels: Sequence[str] = ()
    path: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """An upright line: its name, where it stands, whether it is in sight of what is drawn, colour and dashes."""

    name: str
    value: float
    shown: bool = True
    colour: str = "c2"
    dashed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Part of a page: a heading, then sentences, pictures, curves, responses of samples (of one section), tables."""

    heading: str
    notes: Sequence[str] = ()
    pictures: Sequence[Picture] = ()
    curves: Sequence[Curves] = ()
    tables: Sequence[Table] = ()
    responses: Responses | None = None


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
            told |= {"dashed": [name in curves.dashed for name in curves.lines], "large": list(curves.large)}
            if curves.beside:
                told["beside"] = [curves.beside.get(name) for name in curves.lines]
            if curves.marks:
                told["marks"] = [asdict(mark) for mark in curves.marks]
            if curves.span:
                told["range"] = list(curves.span)
            plots.append(told)
    return arrays, plots


def responses_content(sections: Sequence[Section]) -> tuple[dict[str, FloatArray], dict[str, Any]]:
    """Return the numbers of the responses of sections by name, and what the script ``responses.js`` is told of them."""
    for responses in (section.responses for section in sections if section.responses is not None):
        arrays = {"responses/sample": responses.samples}
        for number, factor in enumerate(responses.factors):
            arrays |= {f"responses/factor/{number}": factor.values, f"responses/path/{number}": factor.path}
        arrays |= {
            f"responses/quantity/{number}": values for number, values in enumerate(responses.quantities.values())
        }
        factors = [{"title": one.title, "levels": list(one.levels) or None} for one in responses.factors]
        return arrays, {"factors": factors, "quantities": list(responses.quantities)}
    return {}, {}


def study_page(page: StudyPage) -> str:
    """Return the page of a command; the same content gives the same page."""
    arrays, plots = curves_content(page.sections)
    sampled, responses = responses_content(page.sections)
    places, numbers = pack(arrays | sampled)
    made = [("version of cyclo", code_version()), ("hash of its code", code_hash("ltca"))]
    made += [(name.replace("_", " "), str(value)) for name, value in page.made.items()]
    return page_text(
        "study.html",
        {
            "title": f"{page.name}: {page.told}",
            "page": page,
            "made": Table(name="computed_by", caption="", columns=["", "value"], rows=texts(made), words=1),
            "data": script_data({"places": places, "plots": plots, "responses": responses}),
            "numbers": numbers,
        },
        scripts=("plots", "motion", "sections", "responses", "study"),
        styles=("study",),
    )
