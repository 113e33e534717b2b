"""Mistakes in a definition as sentences: field, value, bound, and the name that a misspelt one is close to."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any

from ltca.drive.declaration import naming_fields
from ltca.drive.fields import LISTED, field_kind, field_kinds
from ltca.errors import Problem, did_you_mean, nearest, printable, shortened


def describe_mistakes(
    details: Sequence[Any], prefix: Sequence[str] = (), known: Sequence[str] | None = None
) -> list[str]:
    """Return errors of pydantic (``ValidationError.errors()``) as sentences; a missing field and its misspelling become
    one.

    `prefix` is the path of the validated table, `known` the names of its fields; by default those of the drive.
    """
    found = [(tuple(map(str, (*prefix, *detail["loc"]))), detail) for detail in details]
    missing = {place for place, detail in found if detail["type"].startswith("missing")}
    meant: dict[tuple[str, ...], tuple[str, ...]] = {}
    for place, detail in found:
        if detail["type"] in UNKNOWN and (name := nearest(place[-1], [p[-1] for p in missing if p[:-1] == place[:-1]])):
            meant[place] = (*place[:-1], name)
    told: list[str] = []
    shaft = (*map(str, prefix), "pin_shaft")
    if [name for name in PIN_SHAFT if (*shaft, name) in missing and (*shaft, name) not in meant.values()] == list(
        PIN_SHAFT
    ):
        words = f"{', '.join(PIN_SHAFT[:-1])} and {PIN_SHAFT[-1]}"
        said = f"{words} are missing; without them the drive has no pin shaft, and nothing of it is used"
        told.append(Problem.of(_path(shaft), "", said))
        found = [(place, detail) for place, detail in found if place[:-1] != shaft or place[-1] not in PIN_SHAFT]
    for place, detail in found:
        if place in meant:
            said = f"is not a field; did you mean `{meant[place][-1]}`, which is missing?"
            told.append(Problem.of(_path(place), "", said, shown=_words(place, len(prefix))))
        elif place not in meant.values():
            told.append(_sentence(place, _words(place, len(prefix)), detail, known))
    return told


GONE = {
    "disc.torque_share": "is no longer a field: the load of each disc is computed (disc.number_of_discs); leave it out"
}
"""Fields of earlier versions, and their replacement."""
HINTS = {"held": "; a housing with the wheel pins in it is 'pin-wheel', a flange with the shaft pins 'pin-shaft'"}
"""What values of a field mean, by its name, where another word was given."""
PIN_SHAFT = ("number_of_pins", "pin_circle_radius", "pin_radius", "hole_radius")
"""Fields that every pin shaft needs: where none of them is given, the drive has none."""
UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden")


def entry_words(number: int | str) -> str:
    """Return an entry of ``crank.of`` by its place in the file, which is not the number of an eccentric as in the paths of
    studies.
    """
    return f"crank.of, entry {number}"


def _path(place: Iterable[str]) -> str:
    return printable(".".join(part[:60] for part in place))


def _words(place: tuple[str, ...], given: int) -> str:
    """The path of a mistake; an entry of ``crank.of`` by its place in the file where no part of the path was given."""
    if given == 0 and place[:2] == ("crank", "of") and len(place) > 2:
        below = _path(place[3:])
        return entry_words(place[2]) + (f": {below}" if below else "")
    return _path(place)


def _sentence(place: tuple[str, ...], path: str, detail: Any, known: Sequence[str] | None) -> Problem:
    value, said = _said(place, path, detail, known)
    return Problem.of(_path(place), value, said, shown=path)


def _said(place: tuple[str, ...], path: str, detail: Any, known: Sequence[str] | None) -> tuple[str, str]:
    """The value of a mistake, empty where it has none, and what is said of it."""
    value = f"= {shortened(detail['input'])}"
    match detail["type"]:
        case "missing" | "missing_argument" | "missing_keyword_only_argument":
            return "", "is missing"
        case "unexpected_keyword_argument" | "extra_forbidden" if path in GONE and known is None:
            return "", GONE[path]
        case "unexpected_keyword_argument" | "extra_forbidden":
            siblings = fields_of(".".join(place[:-1])) if known is None else known
            where = "the drive definition" if known is None else "such a table"
            return "", f"is not a field of {where}{did_you_mean(place[-1], siblings)}"
        case "dataclass_type" | "dataclass_exact_type" | "model_type" | "dict_type":
            return value, "must be a table"
        case "tuple_type" if path in LISTED:
            return value, f"must be an array of tables, written [[{path}]]"
        case "tuple_type":
            return value, f"must be an array of numbers{_unit_of(_path(place))}"
        case "literal_error":
            expected = detail["ctx"]["expected"]
            choices = [name.strip("' ") for name in expected.replace(" or ", ",").split(",")]
            meant = did_you_mean(detail["input"], choices) if isinstance(detail["input"], str) else ""
            return value, f"must be {expected}{meant}{HINTS.get(place[-1], '')}"
        case "bool_type":
            return value, "must be true or false"
        case "int_type" | "int_parsing" | "int_from_float" | "int_parsing_size":
            return value, "must be a whole number"
    return value, str(detail["msg"]).replace("Input should be", "must be")


def _unit_of(path: str) -> str:
    kind = field_kind(path)
    return f" in {kind.label}" if kind is not None and kind.unit else ""


@cache
def fields_of(table: str) -> tuple[str, ...]:
    """Return the names of the fields and tables in a table of the drive, by its dotted path; empty for none.

    Examples
    --------
    >>> fields_of("clearance")
    ('bearing', 'pin_hole')
    """
    table = re.sub(r"(\.of|^duty|^load\.external|\.bearings)\.[0-9]+\b", r"\1.N", table)
    head = f"{table}." if table else ""
    paths = (*field_kinds(), *naming_fields())
    return tuple(dict.fromkeys(path[len(head) :].partition(".")[0] for path in paths if path.startswith(head)))
