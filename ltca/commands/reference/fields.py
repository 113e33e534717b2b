"""``cyclo fields``: every field of a drive file with unit, default, bounds, meaning and the engines that take it."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ltca.drive.declaration import Field

SUMMARY = "fields of a drive file: unit, default, bounds, meaning, and which engines take them"
EXAMPLES = (
    ("cyclo fields", "all of them"),
    ("cyclo fields pin_wheel.seat", "one table"),
    ("cyclo fields thickness", "by the last part of the path"),
)
WIDTH = 100


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "name", metavar="NAME", nargs="?", help="a path (disc.thickness), a table (pin_wheel) or the last part of paths"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the fields, table by table."""
    from ltca.drive.declaration import find_fields, gathered, known_paths
    from ltca.errors import DriveError, did_you_mean, shortened

    if arguments.name is None:
        print(_text(gathered()))
        return 0
    found = find_fields(arguments.name)
    if not found:
        meant = did_you_mean(arguments.name, known_paths())
        raise DriveError([f"{shortened(arguments.name)[1:-1]}: is no field or table of a drive file{meant}"])
    print(_text(found))
    return 0


def _text(described: tuple[Field, ...]) -> str:
    from ltca.drive.declaration import by_table

    lines: list[str] = []
    for table, fields in by_table(described).items():
        lines += ["", *(_heading(table) if table else ["at the head of the file"])]
        refused = [_refusals(field) for field in fields]
        alike = len(fields) > 1 and all(lines == refused[0] for lines in refused)
        lines += refused[0] if alike else []
        for field, told in zip(fields, refused, strict=True):
            lines.append(f"  {field.path}{_values(field)}")
            lines += _wrapped(field.meaning) + ([] if alike else told)
    return "\n".join(lines).strip("\n").replace("``", "")


def _heading(table: str) -> list[str]:
    from ltca.drive.declaration import table_of

    told = table_of(table)
    left_out = ", may be left out" if told.optional else ""
    return [f"[{table}]{left_out}", *_wrapped(told.meaning)]


def _refusals(field: Field) -> list[str]:
    from ltca.drive.engine_support import refusals

    return [
        line
        for reason, engines in refusals(field.path).items()
        for line in _wrapped(f"refused by {', '.join(engines)}: {reason}")
    ]


def _values(field: Field) -> str:
    from ltca.drive.declaration import REQUIRED

    kind = field.label or {"quantity": "number", "count": "whole number"}.get(field.kind, field.kind)
    told = [f"a list, {kind}" if field.is_array else kind, field.bounds]
    told.append(REQUIRED if field.default == REQUIRED else f"default {field.default}")
    return f": {'; '.join(part for part in told if part)}"


def _wrapped(text: str) -> list[str]:
    from textwrap import wrap

    return wrap(text, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6)
