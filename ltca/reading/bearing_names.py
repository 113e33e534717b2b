"""Bought bearings in drive files: ``crank_bearing.bearing``, ``clearance_class`` and ``[bearings."NAME"]`` as fields."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ltca.drive.deviations import PositiveLength
from ltca.drive.members.bearings import (
    CLASSES,
    NamedBearing,
    clearance_classes,
    clearance_range,
    named_bearing,
    named_bearings,
    spelled,
)
from ltca.drive.members.preload import Force
from ltca.drive.mistakes import describe_mistakes
from ltca.errors import DriveError, Problem, shortened

BEARING = "bearing"
CLEARANCE_CLASS = "clearance_class"
HINTS = {
    "roller_radius": "half the difference of outer_race_diameter and inner_race_diameter is that of the rollers",
    "roller_diameter": "half the difference of outer_race_diameter and inner_race_diameter is that of the rollers",
    "clearance_class": "it stands beside the name, in [crank_bearing]",
    "clearance": "it stands in [clearance], or as clearance_class beside the name",
    "C": "did you mean `dynamic_load_rating`?",
    "C0": "did you mean `static_load_rating`?",
}
"""What to say of keys that are no fields of a bearing, by their names."""
_ADAPTER = TypeAdapter(NamedBearing)
_LENGTH = TypeAdapter(PositiveLength)
_FORCE = TypeAdapter(Force)


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingNames:
    """Bearings that a drive file can name, and what the names it used stand for.

    Attributes
    ----------
    own : dict of str to NamedBearing
        Of ``[bearings."NAME"]``; they go before those shipped.
    stands_for : dict of str to str
        Name of the bearing by "field = value" of each field that came from it.
    mistaken : frozenset of str
        Names of entries of the drive file with mistakes, which are told: they are not unknown besides.
    """

    own: dict[str, NamedBearing]
    stands_for: dict[str, str]
    mistaken: frozenset[str] = frozenset()

    @classmethod
    def of_table(cls, table: Any, problems: list[str]) -> BearingNames:
        """Return the names of the table ``bearings`` of a drive file; its mistakes are added to `problems`."""
        if not isinstance(table, Mapping):
            problems.append('bearings: must be a table of tables, written [bearings."NAME"]')
            table = {}
        found = {}
        for name, entry in table.items():
            try:
                bearing = _ADAPTER.validate_python(entry)
            except ValidationError as error:
                names = list(NamedBearing.__dataclass_fields__)
                problems += [_hinted(each) for each in describe_mistakes(error.errors(), ("bearings", name), names)]
                continue
            told = bearing.problems()
            problems += [f"bearings.{name}.{problem}" for problem in told]
            if not told:
                found[name] = bearing
        mistaken = frozenset(spelled(name) for name in table if name not in found)
        return cls(own=found, stands_for={}, mistaken=mistaken)

    def resolved(self, table: Mapping[str, Any], problems: list[str], common: Any = None) -> dict[str, Any]:
        """Return the plain tables of a drive, or of one case, with the fields of a named bearing in the place of its name.

        Fields beside the name must be those of the bearing. ``clearance_class`` becomes ``clearance.bearing``, its middle.
        `common` is ``crank_bearing`` of the common part as it was written: its name and class hold in a case that gives
        others of its fields. Mistakes are added to `problems`; the table is then no drive, another bearing may stand in it.
        """
        part = table.get("crank_bearing")
        written = {**(common if isinstance(common, Mapping) else {}), **(part if isinstance(part, Mapping) else {})}
        if not isinstance(part, Mapping) or not {BEARING, CLEARANCE_CLASS} & written.keys():
            return dict(table)
        name, clearance_class = written.get(BEARING), written.get(CLEARANCE_CLASS)
        below = {key: value for key, value in part.items() if key not in (BEARING, CLEARANCE_CLASS)}
        # What is not named is no missing field besides: any bearing stands in, so that other mistakes are told too.
        unnamed = {**table, "crank_bearing": {**named_bearings()["RN205"].fields, **below}}
        if not isinstance(name, str) or not name.strip():
            told = "must be the designation of a bearing" if name is not None else "must be given with clearance_class"
            problems.append(f"crank_bearing.bearing{'' if name is None else f' = {shortened(name)}'}: {told}")
            return unnamed
        if spelled(name) in self.mistaken:
            return unnamed
        try:
            bearing = named_bearing(name, self.own)
        except DriveError as error:
            problems += [f"crank_bearing.bearing = {problem}" for problem in error.problems]
            return unnamed
        known = {field: value for field, value in bearing.fields.items() if value is not None}
        problems += [
            f"crank_bearing.{field} = {shortened(below[field])}: must be left out, or {value:g}, beside "
            f"crank_bearing.bearing = {shortened(name)}"
            for field, value in known.items()
            if field in below and _differs(field, below[field], value)
        ]
        self.stands_for.update({f"crank_bearing.{field} = {value:g}": name for field, value in known.items()})
        found = {**table, "crank_bearing": {**bearing.fields, **below}}
        if clearance_class is not None and {BEARING, CLEARANCE_CLASS} & part.keys():
            _set_clearance(found, bearing, clearance_class, CLEARANCE_CLASS in part, problems)
        return found

    def told(self, problems: Iterable[str]) -> list[str]:
        """Return problems in which fields that a name stands for are followed by that name: nobody wrote them."""
        found = []
        for problem in problems:
            for text, name in self.stands_for.items():
                value = re.compile(rf"{re.escape(text)}(?![0-9.e])( mm)?")
                add_name = partial(value.sub, rf'\g<0> (of bearing "{name}")')
                problem = problem.reworded(add_name) if isinstance(problem, Problem) else add_name(problem)
            found.append(problem)
        return found


def _hinted(problem: str) -> str:
    """A mistake of an entry, with what its key is elsewhere in the place of the field that looks most like it."""
    path, found, _ = problem.partition(": is not a field")
    hint = HINTS.get(path.rpartition(".")[2]) if found else None
    return problem if hint is None else f"{path}: is not a field of such a table; {hint}"


def _set_clearance(
    table: dict[str, Any], bearing: NamedBearing, clearance_class: Any, is_given: bool, problems: list[str]
) -> None:
    path = f"crank_bearing.clearance_class = {shortened(clearance_class)}"
    if clearance_class not in CLASSES:
        problems.append(f"{path}: must be {', '.join(CLASSES[:-1])} or {CLASSES[-1]}")
        return
    limits = clearance_range(bearing, clearance_class)
    if limits is None:
        most = clearance_classes().diameters[-1]
        problems.append(f"{path}: bores up to {most:g} mm have their classes here; give clearance.bearing")
        return
    middle, clearance = round(0.5 * sum(limits), 9), table.get("clearance", {})
    if not isinstance(clearance, Mapping):  # wrong, and told where tables are validated
        return
    if "bearing" in clearance:
        if is_given and _differs("bearing", clearance["bearing"], middle):
            problems.append(
                f"clearance.bearing = {shortened(clearance['bearing'])}: must be left out, or {middle:g} mm, beside {path} "
                f"({limits[0]:g} to {limits[1]:g} mm)"
            )
        return
    table["clearance"] = {**clearance, "bearing": middle}


def _differs(field: str, given: Any, value: float) -> bool:
    """Tell whether a number, or a text with a unit, is another; what is neither is told where fields are validated."""
    try:
        adapter = _FORCE if field.endswith("_rating") else _LENGTH
        return abs(adapter.validate_python(given) - value) > 1e-9 * max(value, 1.0)
    except ValidationError:
        return False
