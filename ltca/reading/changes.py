"""A drive with some fields replaced, validated like a drive file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass, replace
from functools import cache
from typing import Any

from pydantic import TypeAdapter, ValidationError

from ltca.drive.declaration import ANY, REQUIRED
from ltca.drive.deviations import BoreErrors, DiscClearance, OneDisc, OneEccentric
from ltca.drive.fields import (
    LISTED,
    field_kind,
    field_kinds,
    is_element,
    listed_entries,
    missing_part,
    no_entry,
    not_a_field,
    numbered,
    read_field,
)
from ltca.drive.materials import PARTS
from ltca.drive.members.bearings import named_bearing
from ltca.drive.members.named_materials import LIKE, named_material, numbers_of
from ltca.drive.members.preload import preload_table
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.parts import BearingRow, Drive, Duty, ExternalLoad, MainBearing
from ltca.errors import DriveError, Problem, shortened
from ltca.reading.alternatives import Alternatives
from ltca.reading.contradictions import explain_change
from ltca.reading.physical_checks import find_contradictions


def with_fields(drive: Drive, values: Mapping[str, Any], *, check: bool = True) -> Drive:
    """Return a drive with some fields replaced, validated like a drive file.

    Parameters
    ----------
    drive : Drive
        The drive to start from.
    values : mapping of str to value
        New values by dotted path, see `read_field`, or tables of them as a drive file nests them; ``materials.disc`` and the
        like take a material's name, ``crank_bearing.bearing`` that of a shipped bearing. Numbers in the units of the suite,
        or texts with a unit.
    check : bool
        Whether to look for physical contradictions as well.

    Raises
    ------
    DriveError
        When a path is no field or a value or the whole is wrong; all mistakes together.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> with_fields(drive, {"crank.axis_offset.x": 0.01}).crank.axis_offset.x
    0.01
    >>> with_fields(drive, {"clearance": {"bearing": "30 µm"}}).clearance.bearing
    0.03
    """
    arrays: dict[str, list[Any]] = {}
    whole = {}
    values = _without_names(_by_path(values))
    only = next(iter(values)) if len(values) == 1 else None
    if "disc.planes" in values or "disc.gap" in values:  # one stands in the place of the other
        values = {"disc.planes": (), "disc.gap": 0.0, **values}
    for path, value in values.items():
        parent, _, last = path.rpartition(".")
        if is_element(last) and field_kind(parent) is not None:
            if parent not in arrays:
                arrays[parent] = list(values.get(parent, read_field(drive, parent)))
            if int(last) >= len(arrays[parent]):
                raise DriveError([f"{path}: {parent} has no element {last}"])
            arrays[parent][int(last)] = value
        elif field_kind(path) is None:
            raise DriveError([Problem.of(path, "", not_a_field(drive, path))])
        else:
            whole[path] = value
            missing = missing_part(drive, path)
            if missing is not None and (lacking := [name for name in _required(missing) if name not in values]):
                raise DriveError(
                    [f"{path}: there is no {missing} in this drive; to add it, give {', '.join(lacking)}, too"]
                )
    own: dict[tuple[str, int], dict[str, Any]] = {}
    common = {}
    for path, value in {**whole, **{name: tuple(row) for name, row in arrays.items()}}.items():
        if (place := numbered(path)) is not None:
            own.setdefault(place[:2], {})[place[2]] = value
        else:
            common[path] = value
    tree = _nested(common)
    if drive.pin_shaft is not None and len(given := INSTEAD.keys() & tree.get("pin_shaft", {}).keys()) == 1:
        tree["pin_shaft"][INSTEAD[given.pop()]] = None
    problems: list[str] = []
    changed: Drive = _replaced(drive, tree, "", problems)
    if own and not problems:
        changed = _with_own(changed, own, problems)
    if problems:
        raise DriveError(problems)
    if check and (found := [_named_by_change(problem, values) for problem in find_contradictions(changed)]):
        raise DriveError(found if only is None else explain_change(drive, changed, only, found))
    return changed


def _named_by_change(problem: Problem, values: Mapping[str, Any]) -> Problem:
    """A contradiction that either of two fields resolves by the one that was changed, of both by the later change."""
    if not isinstance(problem, Alternatives):
        return problem
    changed = [path for path in values if path in (problem.path, problem.other)]
    return problem.other_first if changed[-1:] == [problem.other] else problem


INSTEAD = {"stiffness": "beam", "beam": "stiffness", "planes": "gap", "gap": "planes"}
"""Alternative fields of one table: a case or a change that gives one removes the other."""


def _by_path(values: Mapping[str, Any], above: str = "") -> dict[str, Any]:
    """Changes by dotted path, the tables among them by their fields; the name behind ``like`` is that of the table."""
    if not isinstance(values, Mapping) or not all(isinstance(name, str) for name in values):
        raise DriveError(
            [f"changes = {shortened(values)}: must be values by the names of their fields, as disc.thickness"]
        )
    found: dict[str, Any] = {}
    for name, value in values.items():
        path = f"{above}{name}".removesuffix(f".{LIKE}")
        each = _by_path(value, f"{path}.") if isinstance(value, Mapping) and value else {path: value}
        if twice := found.keys() & each.keys():
            raise DriveError([f"{one}: is given twice" for one in sorted(twice)])
        found |= each
    return found


def _without_names(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Changes with named materials and bearings as their properties, which properties given beside them replace."""
    readers = {f"materials.{part}": (_numbers_of_material, "a material") for part in PARTS}
    readers["ring.material"] = (_numbers_of_material, "a material")
    readers[BEARING] = (_numbers_of_bearing, "a bearing")
    values = _without_preloads(values)
    named = readers.keys() & values.keys()
    if not named:
        return values
    found: dict[str, Any] = {}
    for path in sorted(named):
        numbers, what = readers[path]
        if not isinstance(values[path], str):
            raise DriveError([f"{path} = {shortened(values[path])}: must be the name of {what}"])
        try:
            table = path.removesuffix(".bearing")
            found |= {f"{table}.{name}": number for name, number in numbers(values[path]).items()}
        except DriveError as error:
            raise DriveError([f"{path} = {problem}" for problem in error.problems]) from error
    return found | {path: value for path, value in values.items() if path not in named}


def _without_preloads(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Changes with every ``preload`` that is a number or a text as that of its force or its displacement."""
    found: dict[str, Any] = {}
    for path, value in values.items():
        if value is not None and path.endswith(".preload") and field_kind(f"{path}.force") is not None:
            found |= {f"{path}.{name}": each for name, each in preload_table(value).items()}
        else:
            found[path] = value
    return found


BEARING = "crank_bearing.bearing"
"""Path that takes the name of a shipped bearing."""


def _numbers_of_material(name: str) -> Mapping[str, Any]:
    return numbers_of(named_material(name))


def _numbers_of_bearing(name: str) -> Mapping[str, Any]:
    return named_bearing(name).fields


@cache
def _required(table: str) -> tuple[str, ...]:
    """Paths of the fields without which a table that may be left out cannot be made."""
    return tuple(path for path, field in field_kinds().items() if field.table == table and field.default == REQUIRED)


def _with_own(drive: Drive, own: Mapping[tuple[str, int], Mapping[str, Any]], problems: list[str]) -> Drive:
    """Replace values of single discs; those left out so far start as the common ones."""
    rows: dict[str, list[Any]] = {
        "disc": [*(drive.disc.of or (OneDisc(),) * drive.disc.number_of_discs)],
        "crank": _eccentrics(drive),
    }
    listed = {table: [*listed_entries(drive, table)] for table in LISTED}
    for (table, number), values in sorted(own.items()):
        part = table.partition(".")[0]
        entries = listed.get(table, [])
        if table in LISTED and number == len(entries) and _required_of(table) <= {*values}:
            entries.append(_made(table, _nested(values), number, problems))
            continue
        if table in LISTED and number < len(entries):
            entries[number] = _replaced(entries[number], _nested(values), f"{table}.{number}.", problems)
            continue
        if (problem := no_entry(drive, table, number)) is not None:
            problems.append(Problem.of(f"{table}.{number}", "", problem))
            continue
        tree: dict[str, Any] = {}
        for name, value in values.items():
            first, _, rest = name.partition(".")
            tree.setdefault(first, {})[rest] = value
        entry = rows[part][number]
        filled = {name: _begun(drive, entry, name) for name, below in tree.items() if "" not in below}
        changes = {name: below.get("", below) for name, below in tree.items()}
        rows[part][number] = _replaced(replace(entry, **filled), changes, f"{table}.{number}.", problems)
    if problems:
        return drive
    return replace(
        drive,
        duty=tuple(listed["duty"]),
        load=replace(drive.load, external=tuple(listed["load.external"])),
        main_bearing=_with_rows(drive, listed["main_bearing.bearings"]),
        disc=replace(drive.disc, of=tuple(rows["disc"]) if any(key[0] == "disc.of" for key in own) else drive.disc.of),
        crank=replace(
            drive.crank, of=tuple(rows["crank"]) if any(key[0] == "crank.of" for key in own) else drive.crank.of
        ),
    )


_ENTRIES: dict[str, TypeAdapter[Any]] = {
    "duty": TypeAdapter(Duty),
    "load.external": TypeAdapter(ExternalLoad),
    "main_bearing.bearings": TypeAdapter(BearingRow),
}
"""What makes an entry of a list of the drive file."""


def _with_rows(drive: Drive, rows: list[Any]) -> MainBearing | None:
    """The main bearing with the entries of its rows."""
    held = drive.main_bearing
    if not rows or (held is not None and held.bearings == tuple(rows)):
        return held
    return replace(held or MainBearing(), bearings=tuple(rows))


def _required_of(table: str) -> set[str]:
    """Names without which an entry of a list cannot be made."""
    return {path.rpartition(".")[2] for path in _required(f"{table}.{ANY}")}


def _nested(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values by dotted name as nested tables."""
    tree: dict[str, Any] = {}
    for name, value in values.items():
        *above, last = name.split(".")
        branch = tree
        for step in above:
            branch = branch.setdefault(step, {})
        branch[last] = value
    return tree


def _made(table: str, values: dict[str, Any], number: int, problems: list[str]) -> Any:
    """A further entry of a list; None with its mistakes in `problems`."""
    try:
        return _ENTRIES[table].validate_python(values)
    except ValidationError as error:
        problems += describe_mistakes(error.errors(), [*table.split("."), str(number)])
        return None


def _eccentrics(drive: Drive) -> list[OneEccentric]:
    """An entry for every eccentric, disc after disc, with index keys where there are several cranks."""
    cranks = drive.crank.number
    entries = [(disc, crank) for disc in range(drive.disc.number_of_discs) for crank in range(cranks)]
    if cranks == 1:
        return [replace(drive.crank.eccentric(*entry), disc=None, crank=None) for entry in entries]
    return [replace(drive.crank.eccentric(*entry), disc=entry[0], crank=entry[1]) for entry in entries]


def _begun(drive: Drive, entry: Any, name: str) -> Any:
    """A table of one disc, or the common one that it replaces."""
    mine = getattr(entry, name)
    if mine is not None:
        return mine
    if name == "clearance":
        return DiscClearance()
    if name == "bore_errors":
        return BoreErrors()
    return drive.crank_bearing.roller_errors if name == "roller_errors" else getattr(drive.disc, name)


def _replaced(part: Any, tree: dict[str, Any], prefix: str, problems: list[str]) -> Any:
    changes = {}
    for name, value in tree.items():
        below = getattr(part, name)
        nested = isinstance(value, dict) and is_dataclass(below)
        # A part that is absent so far is made of the given fields.
        changes[name] = _replaced(below, value, f"{prefix}{name}.", problems) if nested else value
    try:
        return replace(part, **changes)
    except ValidationError as error:
        problems += describe_mistakes(error.errors(), prefix.rstrip(".").split(".") if prefix else ())
        return part
