"""Tables of a page: cells with their text, and the full number for copies and downloads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

from ltca.drive.members.verdict_words import CLOSE
from ltca.quantities import printed, unit_sign

NOTHING = "–"


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One cell.

    Attributes
    ----------
    text : str
        What it says.
    value : str
        What it is in a file of comma separated values: the number in full where the text is rounded.
    note : str
        What stands below, smaller.
    state : str
        ``pass`` or ``fail`` of a verdict, ``chance`` of what may be nothing; empty otherwise.
    link : str
        File beside the page that the cell opens; empty without.
    """

    text: str
    value: str
    note: str = ""
    state: str = ""
    link: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table.

    Attributes
    ----------
    name : str
        Of the file it is downloaded as, without ending.
    caption : str
        What it shows.
    columns : sequence of str
        Heads; the first column names the rows.
    rows : sequence of sequence of Cell
        As many as columns each.
    words : int
        How many columns after the first are words, which stand on the left; numbers stand on the right.
    last_words : int
        How many of the last columns are.
    folded : bool
        Whether a line with the number of rows and the caption has to be clicked to see it.
    """

    name: str
    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    words: int = field(default=0)
    last_words: int = field(default=0)
    folded: bool = field(default=False)


def folded(tables: Sequence[Table]) -> list[Table]:
    """Return tables of which the first stands open and the others are folded."""
    return [replace(table, folded=number > 0) for number, table in enumerate(tables)]


def minus(text: str) -> str:
    """Return a text with the sign of subtraction in place of hyphens before digits.

    Examples
    --------
    >>> minus("-1.5e-07 N, mid-width")
    '−1.5e−07 N, mid-width'
    """
    parts = list(text)
    for place, sign in enumerate(parts[:-1]):
        before = parts[place - 1] if place else " "
        if sign == "-" and parts[place + 1].isdigit() and (not before.isalnum() or before == "e"):
            parts[place] = "−"
    return "".join(parts)


def word(text: str) -> Cell:
    """Return a cell of words."""
    return Cell(text=text, value=text)


def number(value: float | None, form: str = "{:.5g}", unit: str = "", *, note: str = "", state: str = "") -> Cell:
    """Return a cell of a number printed by `form`, a dash for none, with its unit behind it and a note below."""
    if value is None or not isfinite(value):
        return Cell(text=NOTHING, value="", note=note, state=state)
    sign = unit_sign(unit)
    text = minus(printed(value, form, unit)) + (sign if sign in CLOSE else f" {sign}" if sign else "")
    return Cell(text=text, value=repr(float(value)), note=note, state=state)


def texts(rows: Iterable[tuple[str, str]]) -> list[list[Cell]]:
    """Return rows of a name and a text."""
    return [[word(title), word(minus(text))] for title, text in rows]
