"""CSV files of measured points: columns x and y in mm, others by their names; mistakes in one sentence."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltca.errors import DriveError, shortened
from ltca.reading.toml_text import read_text

COORDINATES = ("x", "y")
NORMALS = ("normal_x", "normal_y")
SEPARATORS = ",;\t"
MOST_POINTS = 20_000
"""Largest number of points of a flank; the spline passes through all of them, and more are noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredPoints:
    """Points of a measured flank.

    Attributes
    ----------
    source : str
        Name of the file.
    points : array of complex, shape (n,)
        Places, mm.
    normals : array of complex, shape (n,), or None
        Normals out of the disc, of any length.
    lines : array of int, shape (n,)
        Lines of the file, counted from 1.
    """

    source: str
    points: NDArray[np.complex128]
    normals: NDArray[np.complex128] | None
    lines: NDArray[np.int64]


def read_points(path: Path) -> MeasuredPoints:
    """Return the points of a CSV file.

    Lines that begin with ``#`` are comments. The first other line names the columns; without names the first two are x and
    y. Columns are separated by commas, semicolons or tabs, numbers have a point. DriveError when the file cannot be read,
    has no columns x and y, holds anything but finite numbers, or is marked as compensated.
    """
    text, source = read_text(path), str(path)
    lines = [
        (number, line)
        for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise DriveError(["holds no points"], source)
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip("# \t").startswith("compensation ") and line.lstrip().startswith("#"):
            told = "is a flank compensated for a printer, which no machine measured: export it without --compensate"
            raise DriveError([f"line {number}: {told}"], source)
    separator = max(SEPARATORS, key=lines[0][1].count)
    names = [name.strip().strip('"').casefold() for name in lines[0][1].split(separator)]
    if _is_number(names[0]):
        names = list(COORDINATES)
    else:
        lines = lines[1:]
    _require_columns(names, lines[0][0] if lines else 1, source)
    if len(lines) > MOST_POINTS:
        raise DriveError([f"holds {len(lines)} points: must be at most {MOST_POINTS}; leave some out"], source)
    wanted = [*COORDINATES, *(NORMALS if all(name in names for name in NORMALS) else ())]
    columns = [names.index(name) for name in wanted]
    rows = np.array([_row(line, number, separator, columns, wanted, source) for number, line in lines])
    rows = rows.reshape(len(lines), len(wanted))
    return MeasuredPoints(
        source=source,
        points=rows[:, 0] + 1j * rows[:, 1],
        normals=rows[:, 2] + 1j * rows[:, 3] if len(wanted) > 2 else None,
        lines=np.array([number for number, _ in lines], dtype=np.int64),
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _require_columns(names: list[str], line: int, source: str) -> None:
    missing = [name for name in COORDINATES if name not in names]
    if missing:
        told = shortened(", ".join(names))
        raise DriveError(
            [f"has no column {' and no column '.join(missing)}: the columns are {told}; x and y must be there, in mm"],
            source,
        )
    half = [name for name in NORMALS if name in names]
    if len(half) == 1:
        other = next(name for name in NORMALS if name not in names)
        raise DriveError([f"has a column {half[0]} and none {other}: give both or none"], source)


def _row(line: str, number: int, separator: str, columns: list[int], names: list[str], source: str) -> list[float]:
    """The wanted numbers of a line."""
    cells = line.split(separator)
    found = []
    for column, name in zip(columns, names, strict=True):
        cell = cells[column].strip() if column < len(cells) else ""
        value = float(cell) if _is_number(cell) else float("nan")
        if not isfinite(value):
            told = f"{name} = {shortened(cell)}" if cell else f"{name} is missing"
            raise DriveError([f"line {number}: {told}: must be a finite number, with a point"], source)
        found.append(value)
    return found
