"""TOML files as plain tables: any file is read, or refused in one sentence."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ltca.errors import DriveError, printable
from ltca.output.regular_files import read_regular

DEEPEST = 20
"""Largest depth of nested tables and arrays; a drive file needs five."""
# Possessive and anchored, so that the time is linear in the length of a word.
_MANY_DOTS = re.compile(r"""(?<![\w"'-])(?:[\w"'-]++[ \t]*+\.[ \t]*+){60}""")
LARGEST = 50_000_000
"""Largest number of bytes of a file; a drive of 10,000 cases has some 2 MB."""
MOST_VALUES = 500_000
"""Largest number of values of a drive file: ten measured flanks of `ltca.reading.measured.points.MOST_POINTS` have 400,000."""
LONGEST = 20_000
"""Largest number of entries of an array: so many mistakes take seconds to report."""


def read_text(path: Path, missing: str = "no such file") -> str:
    """Return the text of a TOML file; DriveError when it cannot be read, with the message `missing` when it does not exist."""
    try:
        return read_regular(path, LARGEST).decode("utf-8")
    except FileNotFoundError as error:
        raise DriveError([missing], str(path)) from error
    except UnicodeDecodeError as error:
        raise DriveError([f"cannot be read: byte {error.start} is not UTF-8"], str(path)) from error
    except UnicodeEncodeError as error:
        told = f"cannot be a name of a file in the encoding {error.encoding}: LC_ALL=C.UTF-8 helps"
        raise DriveError([told], str(path)) from error
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        reason = error.strerror if isinstance(error, OSError) else None
        raise DriveError([f"cannot be read: {reason or error}"], str(path)) from error


def parse_toml(text: str, source: str, most_values: int = MOST_VALUES, longest: int = LONGEST) -> dict[str, Any]:
    """Return the tables of a TOML text, with or without a byte-order mark; `source` is its file, for messages.

    DriveError when it is not TOML, or has more than `most_values` values, an array of more than `longest` entries, or
    tables nested more than `DEEPEST` deep, which would take seconds to read.
    """
    # An upper bound without reading: there is a comma or an equals sign for each value but one of an array.
    values = text.count(",") + text.count("=")
    if values > most_values:
        raise DriveError([f"holds some {values} values: must be at most {most_values}"], source)
    if _MANY_DOTS.search(text):  # the parser takes seconds for a key of thousands of parts
        raise DriveError([_too_deep()], source)
    try:
        table = tomllib.loads(text.removeprefix("\ufeff").replace("\r\n", "\n"))
    except RecursionError as error:
        raise DriveError([_too_deep()], source) from error
    except ValueError as error:  # TOMLDecodeError, and what int() says to thousands of digits
        about = "a whole number has thousands of digits" if "digits" in str(error) else printable(str(error))[:200]
        raise DriveError([f"is not valid TOML: {about}"], source) from error
    level: list[Any] = [table]
    for _ in range(DEEPEST):
        length = max((len(array) for array in level if isinstance(array, list)), default=0)
        if length > longest:
            raise DriveError([f"an array has {length} entries: must be at most {longest}"], source)
        level = [
            inner
            for outer in level
            for inner in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(inner, dict | list)
        ]
        if not level:
            return table
    raise DriveError([_too_deep()], source)


FILE_KINDS = {
    "drive": (("pin_wheel", "crank_bearing"), "a drive file, which cyclo show, check and run take"),
    "study": (("factors",), "a study file, which cyclo sweep takes"),
    "requirements": (("ratio", "outer_diameter"), "a requirement file, which cyclo design takes"),
}
"""Keys that only files of a kind have, and its words, by kind."""


def require_kind(table: Mapping[str, Any], kind: str, source: str) -> None:
    """Refuse (`DriveError`) the table of a file of another kind in one sentence, in place of all that it lacks of this one.

    Files of a kind are those with a key that only it has; a file with keys of both kinds is taken for the wanted one.
    """
    if any(key in table for key in FILE_KINDS[kind][0]):
        return
    for other, (keys, words) in FILE_KINDS.items():
        if other != kind and any(key in table for key in keys):
            wanted = FILE_KINDS[kind][1].partition(",")[0]
            raise DriveError([f"is {words}; must be {wanted}"], source)


def _too_deep() -> str:
    return f"tables or arrays are nested more than {DEEPEST} deep"
