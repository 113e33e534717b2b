"""A value of a drive file changed in its text: comments, order and spelling of everything else stay.

The text is scanned for statements, not read into a document: headers, keys and the places of their values. What comes out is
read again, and must say what it said with that one value changed; otherwise the change is refused.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ltca.drive.declaration import Field
from ltca.drive.members.named_materials import LIKE
from ltca.errors import DriveError, shortened
from ltca.reading.toml_text import parse_toml

BARE = re.compile(r"[A-Za-z0-9_-]+")
_PART = re.compile(r"""[ \t]*(?:([A-Za-z0-9_-]+)|"((?:[^"\\\n]|\\.)*)"|'([^'\n]*)')[ \t]*""")
_SPACE = re.compile(r"(?:[ \t\r\n]+|#[^\n]*)*")
_STRING = re.compile(r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL)
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_WHOLE = re.compile(r"[+-]?[0-9]{1,18}")

DOTTED = ("tolerances",)
"""Tables whose keys are paths, which stand in them with their dots."""

Path = tuple[str, ...]
"""Keys and numbers of entries, counted from 0: ("disc", "of", "1", "runout", "amount")."""


@dataclass(frozen=True, slots=True)
class _Statement:
    """A key with its value in a text.

    Attributes
    ----------
    path : tuple of str
        With the tables it stands in.
    first, start, end : int
        Where its key, its value and what follows it begin.
    """

    path: Path
    first: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class _Header:
    """A line that opens a table: its path, and where it begins and what follows it."""

    path: Path
    first: int
    end: int
    of_array: bool


class _UnreadableError(Exception):
    """The scanner does not understand the text, or cannot change it."""


def literal(field: Field, typed: str) -> str:
    """Return what was typed for a field as TOML: numbers as numbers, words and numbers with units as texts.

    Examples
    --------
    >>> from ltca.drive.declaration import declared_fields
    >>> fields = declared_fields()
    >>> literal(fields["clearance.bearing"], "0.02"), literal(fields["clearance.bearing"], "20 µm")
    ('0.02', '"20 µm"')
    >>> literal(fields["disc.phases"], "0 deg, 3.14")
    '["0 deg", 3.14]'
    """
    if field.is_array:
        parts = [part.strip() for part in re.split(r"[,;]", typed.strip().strip("[]")) if part.strip()]
        return f"[{', '.join(_literal(field, part.strip(chr(34))) for part in parts)}]"
    return _literal(field, typed.strip())


def _literal(field: Field, typed: str) -> str:
    if field.kind == "choice" and not field.choices and typed in ("true", "false"):
        return typed
    if field.kind == "quantity" and _NUMBER.fullmatch(typed):
        return typed if _is_toml(typed) else repr(float(typed))
    if field.kind == "count" and _WHOLE.fullmatch(typed):
        return str(int(typed))
    return json.dumps(typed, ensure_ascii=False).replace("\x7f", "\\u007f")


def _is_toml(typed: str) -> bool:
    try:
        return isinstance(tomllib.loads(f"a = {typed}")["a"], int | float)
    except ValueError:
        return False


@lru_cache(maxsize=16)
def tables_of(text: str) -> dict[str, Any]:
    """Return the tables of a text as `parse_toml` does, once for every text; they must not be changed."""
    return parse_toml(text, "the text")


def with_values(text: str, changes: Mapping[str, str | None] | Mapping[Path, str | None]) -> str:
    """Return the text of a TOML file with some values replaced.

    Parameters
    ----------
    text : str
        Valid TOML.
    changes : mapping of str or tuple of str to str or None
        New values as TOML by dotted path, entries of arrays of tables by their number, ``case.0.clearance.bearing``, or by its
        parts where keys have dots; None takes a key away.

    Returns
    -------
    str
        The same text everywhere else.

    Raises
    ------
    DriveError
        When the text is no TOML, or a value cannot be changed without writing more of it anew.

    Examples
    --------
    >>> print(with_values("[disc]\\nthickness = 8.0  # measured\\n", {"disc.thickness": "9.5", "disc.gap": "1.0"}), end="")
    [disc]
    thickness = 9.5  # measured
    gap = 1.0
    """
    for place, value in changes.items():
        path = tuple(place.split(".")) if isinstance(place, str) else place
        try:
            before = tables_of(text)
            wanted = _with_value(before, path, None if value is None else tomllib.loads(f"a = {value}")["a"])
            if wanted == before:
                continue
            changed = _written(text, path, value)
            found = tables_of(changed)
            if found != wanted and (value is not None or _without_empty(found) != _without_empty(wanted)):
                raise _UnreadableError
        except (ValueError, RecursionError, _UnreadableError, LookupError, TypeError, DriveError) as error:
            told = "cannot be changed by itself where it stands; change the text of the file"
            raise DriveError([f"{shortened('.'.join(path))[1:-1]}: {told}"]) from error
        text = changed
    return text


def _with_value(table: Mapping[str, Any], path: Path, value: Any) -> Any:
    """The tables with a value at a path, or without; the name of a material in the place of its table becomes ``like``."""
    found: Any = deepcopy(table)
    branch = found
    for place, key in enumerate(path[:-1]):
        if isinstance(branch, list):
            branch = branch[int(key)]
            continue
        if not isinstance(branch, dict):
            raise _UnreadableError
        below = branch.get(key)
        if isinstance(below, str) and _names_a_material(path[: place + 1]):
            below = branch[key] = {LIKE: below}
        elif below is None:
            if value is None:
                return found
            if path[place + 1].isdigit():
                raise _UnreadableError
            below = branch[key] = {}
        branch = below
    if not isinstance(branch, dict):
        raise _UnreadableError
    if value is None:
        branch.pop(path[-1], None)
    else:
        branch[path[-1]] = value
    return found


def _without_empty(table: Any) -> Any:
    """Tables without those that hold nothing: a table of one dotted key ends with it."""
    if not isinstance(table, dict):
        return table
    kept = {key: _without_empty(value) for key, value in table.items()}
    return {key: value for key, value in kept.items() if value not in ({}, [])}


def _names_a_material(path: Path) -> bool:
    """Whether a text in the place of a table is the name of a material."""
    return path[-2:-1] == ("materials",) or path[-1] == "material"


def _written(text: str, path: Path, value: str | None) -> str:
    """The text with a value put in or taken away."""
    headers, statements = _scanned(text)
    for each in statements:
        if each.path == path:
            if value is not None:
                return text[: each.start] + value + text[each.end :]
            first, end = text.rfind("\n", 0, each.first) + 1, text.find("\n", each.end)
            return text[:first] + (text[end + 1 :] if end >= 0 else "")
    for each in statements:
        if path[: len(each.path)] == each.path:
            inner = _within(text[each.start : each.end], path[len(each.path) :], value)
            return text[: each.start] + inner + text[each.end :]
    if value is None:
        raise _UnreadableError
    return _added(text, headers, statements, path, value)


def _added(text: str, headers: Sequence[_Header], statements: Sequence[_Statement], path: Path, value: str) -> str:
    """The text with a new key: at the end of the table it belongs to, of the nearest one above, or in a table of its own."""
    above = [header for header in headers if header.path == path[: len(header.path)] and len(header.path) < len(path)]
    dotted = path[0] in DOTTED or any(part.isdigit() for part in path)
    if above and (len(path) - len(max(above, key=lambda one: len(one.path)).path) == 1 or dotted or above[-1].of_array):
        header = max(above, key=lambda one: len(one.path))
        later = [other.first for other in headers if other.first > header.first]
        last = max(
            (one.end for one in statements if header.end <= one.first < min(later, default=len(text))),
            default=header.end,
        )
        return _line_after(text, last, f"{_dotted(path[len(header.path) :])} = {value}")
    if len(path) == 1:
        first = min((header.first for header in headers), default=len(text))
        before = max((one.end for one in statements if one.end <= first), default=0)
        return (
            _line_after(text, before, f"{_dotted(path)} = {value}") if before else f"{_dotted(path)} = {value}\n{text}"
        )
    beside = [one for one in statements if len(one.path) > 1 and one.path[:-1] == path[:-1]]
    if beside:  # dotted keys at the head of the file, or of a table above
        last_one = beside[-1]
        key = text[last_one.first : last_one.start].partition("=")[0].strip().rpartition(".")[0]
        return _line_after(text, last_one.end, f"{key}.{_dotted(path[-1:])} = {value}")
    head = path[:1] if path[0] in DOTTED else path[:-1]
    return _with_table(text, headers, f"[{_dotted(head)}]\n{_dotted(path[len(head) :])} = {value}\n")


def _with_table(text: str, headers: Sequence[_Header], table: str) -> str:
    """The text with a table before the arrays of tables and what is no part of the drive, which stand last."""
    last = [header.first for header in headers if header.path[0] in ("case", "tolerances", "limits")]
    first = min(last, default=len(text))
    lines = text[:first].splitlines(keepends=True)
    while lines and lines[-1].lstrip().startswith("#"):  # what is said of the table that follows
        lines.pop()
    head = "".join(lines)
    rest = text[len(head) :]
    gap = "" if not head or head.endswith("\n\n") else "\n" if head.endswith("\n") else "\n\n"
    return head + gap + table + ("\n" if rest else "") + rest


def with_entry(text: str, table: str) -> str:
    """Return the text of a TOML file with a further, empty entry of an array of tables.

    Raises
    ------
    DriveError
        When the text is no TOML, or its entries are not written as ``[[table]]``.

    Examples
    --------
    >>> print(with_entry("[disc]\\nthickness = 8.0\\n", "disc.of"), end="")
    [disc]
    thickness = 8.0
    <BLANKLINE>
    [[disc.of]]
    """
    try:
        headers, statements = _scanned(text)
        path = tuple(table.split("."))
        if any(one.path == path for one in statements):
            raise _UnreadableError
        line = f"[[{_dotted(path)}]]\n"
        same = [header for header in headers if header.of_array and header.path[:-1] == path]
        if same:
            later = [one.first for one in headers if one.first > same[-1].first and one.path[: len(path)] != path]
            place = min(later, default=len(text))
            head = text[:place].rstrip("\n")
            found = f"{head}\n\n{line}" + (f"\n{text[place:]}" if text[place:] else "")
        else:
            found = _with_table(text, headers, line)
        tables_of(found)
    except (ValueError, RecursionError, _UnreadableError, LookupError, DriveError) as error:
        told = "an entry cannot be added where they stand; change the text of the file"
        raise DriveError([f"{shortened(table)[1:-1]}: {told}"]) from error
    return found


def without_entry(text: str, path: Path) -> str:
    r"""Return the text of a TOML file without an entry: a key, a table, or one of an array of tables, with all that is in it.

    Raises
    ------
    DriveError
        When the text is no TOML, has no such entry, or more would have to be written anew.

    Examples
    --------
    >>> print(without_entry("[[case]]\nname = 'a'\n[case.load]\ntorque = 1\n[[case]]\nname = 'b'\n", ("case", "0")), end="")
    [[case]]
    name = 'b'
    """
    try:
        before = tables_of(text)
        wanted = _without(before, path)
        changed = _cut(text, path)
        if _without_empty(tables_of(changed)) != _without_empty(wanted):
            raise _UnreadableError
    except (ValueError, RecursionError, _UnreadableError, LookupError, TypeError, DriveError) as error:
        told = "cannot be taken away by itself where it stands; change the text of the file"
        raise DriveError([f"{shortened('.'.join(path))[1:-1]}: {told}"]) from error
    return changed


def _without(table: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """The tables without what is at a path."""
    found = deepcopy(dict(table))
    branch: Any = found
    for key in path[:-1]:
        branch = branch[int(key)] if isinstance(branch, list) else branch[key]
    if isinstance(branch, list):
        del branch[int(path[-1])]
    else:
        del branch[path[-1]]
    return found


def _cut(text: str, path: Path) -> str:
    """The text without the statements and headers at and below a path."""
    headers, statements = _scanned(text)
    spans = []
    for each in statements:
        if each.path[: len(path)] == path:
            spans.append((each.first, each.end))
        elif path[: len(each.path)] == each.path:
            inner = _within(text[each.start : each.end], path[len(each.path) :], None)
            return text[: each.start] + inner + text[each.end :]
    for header in headers:
        if header.path[: len(path)] == path:
            later = min((one.first for one in headers if one.first > header.first), default=len(text))
            ends = [one.end for one in statements if header.end <= one.first < later]
            spans.append((header.first, max(ends, default=header.end)))
    kept, place = "", 0
    for first, end in sorted(spans):
        start, after = text.rfind("\n", 0, first) + 1, text.find("\n", end)
        kept += text[place : max(start, place)]
        place = max(place, len(text) if after < 0 else after + 1)
    return kept + text[place:]


def _line_after(text: str, place: int, line: str) -> str:
    end = text.find("\n", place)
    if end < 0:
        return f"{text}\n{line}\n"
    return f"{text[: end + 1]}{line}\n{text[end + 1 :]}"


def _within(inner: str, path: Path, value: str | None) -> str:
    """An inline table, an array of them or the name of a material with a value in it changed."""
    if inner[:1] in "\"'":
        if value is None or len(path) != 1:
            raise _UnreadableError
        return f"{{ {LIKE} = {inner}, {_dotted(path)} = {value} }}"
    if inner[:1] == "[":
        start, end = list(_items(inner))[int(path[0])]
        changed = value if len(path) == 1 else _within(inner[start:end], path[1:], value)
        if changed is None:
            raise _UnreadableError
        return inner[:start] + changed + inner[end:]
    if inner[:1] != "{":
        raise _UnreadableError
    items = list(_items(inner))
    for place, (first, end) in enumerate(items):
        keys, start = _key(inner, first, "=")
        if keys == path[: len(keys)]:
            start = _skipped(inner, start)
            if len(keys) < len(path):
                return inner[:start] + _within(inner[start:end], path[len(keys) :], value) + inner[end:]
            if value is not None:
                return inner[:start] + value + inner[end:]
            kept = [inner[a:b] for number, (a, b) in enumerate(items) if number != place]
            return f"{{ {', '.join(kept)} }}" if kept else "{}"
    if value is None:
        raise _UnreadableError
    added = f"{_dotted(path)} = {value}"
    if not items:
        return f"{{ {added} }}"
    return f"{inner[: items[-1][1]]}, {added}{inner[items[-1][1] :]}"


def _items(inner: str) -> Iterator[tuple[int, int]]:
    """Where the entries of an inline table or array begin and end."""
    place = _skipped(inner, 1)
    while place < len(inner) - 1:
        end = _value_end(inner, place, ",]}")
        yield place, end
        place = _skipped(inner, end)
        if inner[place] == ",":
            place = _skipped(inner, place + 1)


def _scanned(text: str) -> tuple[list[_Header], list[_Statement]]:
    headers, statements = list[_Header](), list[_Statement]()
    counts: dict[Path, int] = {}
    above: Path = ()
    place = _skipped(text, 0)
    while place < len(text):
        first = place
        if text[place] == "[":
            of_array = text.startswith("[[", place)
            keys, place = _key(text, place + 1 + of_array, "]")
            place += of_array
            path: Path = ()
            for number, key in enumerate(keys):
                path = (*path, key)
                if of_array and number == len(keys) - 1:
                    counts[path] = counts.get(path, -1) + 1
                if path in counts:
                    path = (*path, str(counts[path]))
            above = path
            headers.append(_Header(path, first, place, of_array))
        else:
            keys, place = _key(text, place, "=")
            start = _skipped_blanks(text, place)
            place = _value_end(text, start, "\n#")
            statements.append(_Statement((*above, *keys), first, start, place))
        place = _skipped(text, place)
    return headers, statements


def _key(text: str, place: int, end: str) -> tuple[Path, int]:
    """The parts of a dotted key, and the place behind the sign that ends it."""
    parts: list[str] = []
    while True:
        found = _PART.match(text, place)
        if found is None:
            raise _UnreadableError
        bare, basic, raw = found.groups()
        parts.append(bare if bare is not None else raw if raw is not None else str(json.loads(f'"{basic}"')))
        place = found.end()
        if text.startswith(end, place):
            return tuple(parts), place + 1
        if not text.startswith(".", place):
            raise _UnreadableError
        place += 1


def _value_end(text: str, place: int, ends: str) -> int:
    """The place behind a value that one of some signs ends, blanks before them left out."""
    depth, last = 0, place
    while place < len(text):
        sign = text[place]
        if depth == 0 and sign in ends:
            break
        if sign in "\"'":
            found = _STRING.match(text, place)
            if found is None:
                raise _UnreadableError
            place = last = found.end()
            continue
        if sign == "#":
            place = text.find("\n", place)
            if place < 0:
                raise _UnreadableError
            continue
        depth += (sign in "[{") - (sign in "]}")
        place += 1
        if not sign.isspace():
            last = place
    return last


def _skipped(text: str, place: int) -> int:
    found = _SPACE.match(text, place)
    return place if found is None else found.end()


def _skipped_blanks(text: str, place: int) -> int:
    while text[place : place + 1] in (" ", "\t"):
        place += 1
    return place


def _dotted(path: Path) -> str:
    return ".".join(part if BARE.fullmatch(part) else json.dumps(part, ensure_ascii=False) for part in path)
