"""Tables of a drive file whose entries have names of their own, as rows of a page: limits, tolerances, cases, bearings.

A row has a path as a field has, with the name of its entry in it: ``limits.max_pin_load.value``,
``tolerances.disc.runout.amount.cpk``, ``bearings.K20x26x12.bore``, ``case.0.clearance.bearing``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields
from functools import cache, lru_cache
from typing import Any, get_args, get_type_hints

from ltca.drive.declaration import OWN_BEARING, REQUIRED, Field, attribute_sentences, naming_fields, table_of
from ltca.drive.fields import field_kind, field_kinds
from ltca.drive.members.limits import SENSES, Limit, limited_quantity, parse_limits
from ltca.drive.names import NAMING, names_a_file
from ltca.drive.tolerances import Distribution, parse_tolerances, tolerance_entries
from ltca.errors import DriveError, shortened
from ltca.quantities import LIMITED
from ltca.reading.toml_edit import Path, literal, tables_of, with_entry, with_values, without_entry
from ltca.studio.sections import (
    changed_text,
    declarations,
    declared,
    declared_path,
    known_fields,
    leaves,
    listed,
    place_of,
    plain,
    shown,
)

LIMITS, TOLERANCES, CASE, BEARINGS = "limits", "tolerances", "case", "bearings"
VALUE, SOURCE, DISTRIBUTION, NAME = "value", "source", "distribution", "name"
KEPT = (VALUE, DISTRIBUTION, "tolerance", NAME)
"""What an entry is not without: nothing typed is written as an empty text, which is refused beside it."""
ARRAYS = ".N"


@cache
def declared_entries() -> dict[str, Any]:
    """Return what a page says of the tables and offers for their entries, as plain data."""
    limits = [f"{sense}_{quantity}" for quantity in LIMITED for sense in SENSES]
    scattering = [path for path, kind in field_kinds().items() if kind.unit]
    own = [path for path in known_fields() if path not in ("name", "analysis.compliance")]
    return {
        LIMITS: {
            "meaning": "Bounds of results, by which they are judged. They change no load.",
            "key": "limit", "value": "value", "keys": limits,
        },
        TOLERANCES: {
            "meaning": "How fields scatter about their values in tolerance studies. They change no load of the drive itself.",
            "key": "field", "value": "tolerance, ±", "keys": scattering,
        },
        CASE: {
            "meaning": "Cases, each with some fields of its own. A field that the chosen case has is changed in it above, too.",
            "key": "name", "value": "", "keys": [],
            "own": {"key": "field of its own", "value": "value", "keys": own + [f"{LIMITS}.{one}" for one in limits]},
        },
        BEARINGS: {
            "meaning": plain(table_of(OWN_BEARING).meaning),
            "key": "name", "value": "inner_race_diameter, mm", "keys": [],
        },
    }  # fmt: skip


def written_entries(text: str) -> dict[str, Any]:
    """Return the entries of a text by table, each with its path, title and rows, and the values of all rows by path.

    Raises
    ------
    DriveError
        When the text is no TOML.
    """
    table = tables_of(text)
    found: dict[str, list[dict[str, Any]]] = {}
    values: dict[str, str] = {}
    for name, entries in (
        (BEARINGS, _bearings(table)), (LIMITS, _limits(table.get(LIMITS), LIMITS)), (TOLERANCES, _tolerances(table)),
        (CASE, _cases(table)),
    ):  # fmt: skip
        found[name] = []
        for path, title, rows in entries:
            found[name].append({"path": path, "title": title, "fields": [row for row, _ in rows]})
            values |= {row["path"]: value for row, value in rows if value is not None}
    return {"named": found, "values": values}


_Row = tuple[dict[str, Any], str | None]
_Entry = tuple[str, str, list[_Row]]


def _bearings(table: Mapping[str, Any]) -> Iterator[_Entry]:
    for name, entry in _pairs(table.get(BEARINGS)):
        written = dict(leaves(entry, "")) if isinstance(entry, Mapping) else {}
        rows = [_row(field, f"{BEARINGS}.{name}.{field.name}", written.get(field.name)) for field in _of_bearings()]
        yield f"{BEARINGS}.{name}", name, rows


@lru_cache(maxsize=1024)
def _of_bearings() -> tuple[Field, ...]:
    return tuple(field for field in naming_fields().values() if field.table == OWN_BEARING)


def _limits(table: Any, above: str) -> Iterator[_Entry]:
    for key, entry in _pairs(table):
        path = f"{above}.{key}"
        given = entry if isinstance(entry, Mapping) else {VALUE: entry}
        rows = [
            _row(field, f"{path}.{field.name}", shown(given[field.name]) if field.name in given else None)
            for field in _of_limit(key)
        ]
        yield path, key, rows


@lru_cache(maxsize=1024)
def _of_limit(key: str) -> tuple[Field, ...]:
    """The value and the source of a limit."""
    quantity, told = limited_quantity(key), attribute_sentences(Limit)
    scalar = None if quantity is None else LIMITED[quantity]
    unit = "" if scalar is None else "dimensionless" if scalar.unit == "1" else scalar.unit
    least, most = (None, None) if scalar is None or scalar.limit is None else scalar.limit
    bounds = [f"{word} {end:g}" for word, end in (("at least", least), ("at most", most)) if end is not None]
    meaning = "" if scalar is None else f"{scalar.judged or scalar.title}."
    return (
        _field(f"{LIMITS}.{VALUE}", "quantity", unit, " and ".join(bounds), meaning[:1].upper() + meaning[1:]),
        _field(f"{LIMITS}.{SOURCE}", "text", "", "", told[SOURCE], "left out"),
    )


def _tolerances(table: Mapping[str, Any]) -> Iterator[_Entry]:
    for path, entry in tolerance_entries(table.get(TOLERANCES, {}), []):
        rows = [
            _row(field, f"{TOLERANCES}.{path}.{field.name}", shown(entry[field.name]) if field.name in entry else None)
            for field in _of_tolerance(path)
        ]
        yield f"{TOLERANCES}.{path}", path, rows


@lru_cache(maxsize=1024)
def _of_tolerance(path: str) -> tuple[Field, ...]:
    """What a distribution has of a field."""
    kind, told = field_kind(path), attribute_sentences(Distribution)
    left_out = {item.name: f"{item.default:g}" for item in fields(Distribution) if isinstance(item.default, float)}
    unit = "" if kind is None else kind.unit
    choices = get_args(get_type_hints(Distribution)[DISTRIBUTION])
    return (
        _field(f"{TOLERANCES}.{DISTRIBUTION}", "choice", "", "", told[DISTRIBUTION], choices=choices),
        _field(f"{TOLERANCES}.tolerance", "quantity", unit, "greater than 0", told["tolerance"]),
        _field(f"{TOLERANCES}.cpk", "quantity", "dimensionless", "greater than 0", told["cpk"], left_out["cpk"]),
        _field(f"{TOLERANCES}.mean", "quantity", unit, "", told["mean"], left_out["mean"]),
    )


def _cases(table: Mapping[str, Any]) -> Iterator[_Entry]:
    for number, entry in enumerate(listed(table.get(CASE))):
        above = f"{CASE}.{number}"
        name = shown(entry[NAME]) if NAME in entry else None
        rows = [
            _row(
                _of_case_name(),
                f"{above}.{NAME}",
                name,
            )
        ]
        own = {key: value for key, value in entry.items() if key not in (NAME, LIMITS)}
        for path, value in leaves(own, ""):
            if (field := known_fields().get(declared_path(path))) is not None:
                rows.append(_row(field, f"{above}.{path}", value, path, name or ""))
        for _, key, limit in _limits(entry.get(LIMITS), f"{above}.{LIMITS}"):
            rows += [(row | {NAME: f"{LIMITS}.{key}.{row[NAME]}"}, value) for row, value in limit if value is not None]
        yield above, f"{number}: {name or 'without a name'}", rows


@cache
def _of_case_name() -> Field:
    return _field(f"{CASE}.{NAME}", "text", "", "", "Of the case, its own and such as can name a file.")


def _pairs(table: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(table, Mapping):
        yield from table.items()


def _field(
    path: str,
    kind: str,
    unit: str,
    bounds: str,
    meaning: str,
    default: str = REQUIRED,
    *,
    choices: tuple[str, ...] = (),
) -> Field:
    return Field(
        path=path, kind=kind, unit=unit, is_array=False, default=default, choices=choices, bounds=bounds, meaning=meaning,
        grows=None,
    )  # fmt: skip


def _row(field: Field, path: str, value: str | None, name: str = "", case: str = "") -> _Row:
    """A declared field as a row: at its path, under its name or another one, of a case or of none."""
    row = {**declared(field), "path": path, "row": True, "case": case, "of": name}
    return row | ({"name": name} if name else {}), value


def changed_entries(text: str, case: str, changes: Mapping[str, str]) -> str:
    """Return the text of a drive file with rows and fields changed to what was typed.

    Raises
    ------
    DriveError
        For what is neither a field nor a row, and where the text has no place for it.
    """
    of_fields = {}
    for path, typed in changes.items():
        found = _row_at(text, path)
        if found is None:
            of_fields[path] = typed
            continue
        field, place = found
        if typed.strip() or field.name in KEPT:
            value: str | None = literal(field, typed) if typed.strip() else '""'
        else:
            value = None
        if field.path == f"{LIMITS}.{SOURCE}" and not isinstance(_at(tables_of(text), place[:-1]), Mapping):
            if value is None:
                continue
            number = literal(_of_limit(place[-2])[0], shown(_at(tables_of(text), place[:-1])))
            place, value = place[:-1], f"{{ {VALUE} = {number}, {SOURCE} = {value} }}"
        text = with_values(text, {place: value})
    return changed_text(text, case, of_fields) if of_fields else text


def _row_at(text: str, path: str) -> tuple[Field, Path] | None:
    """The field of a row and where it stands; None for what is in no table of entries."""
    table, (head, _, rest) = tables_of(text), path.partition(".")
    if head == LIMITS:
        return _limit_at(table, (), rest)
    key, _, last = rest.rpartition(".")
    if head == TOLERANCES:
        return _named(_of_tolerance(key), last, path), (TOLERANCES, *key.split("."), last)
    if head == BEARINGS:
        return _named(_of_bearings(), last, path), (BEARINGS, key, last)
    if head != CASE:
        return None
    number, _, rest = rest.partition(".")
    cases = listed(table.get(CASE))
    if not number.isdecimal() or int(number) >= len(cases):
        raise DriveError([f"{shortened(path)[1:-1]}: is no case of the file"])
    own, place = cases[int(number)], (CASE, str(int(number)))
    if rest == NAME:
        return _of_case_name(), (*place, NAME)
    if rest.startswith(f"{LIMITS}."):
        return _limit_at(own, place, rest.removeprefix(f"{LIMITS}."))
    field = known_fields().get(declared_path(rest))
    if field is None:
        raise DriveError([f"{shortened(path)[1:-1]}: is no field of a drive file"])
    return field, (*place, *place_of(own, rest).split("."))


def _limit_at(table: Mapping[str, Any], above: Path, rest: str) -> tuple[Field, Path]:
    key, _, last = rest.rpartition(".")
    field = _named(_of_limit(key), last, f"{LIMITS}.{rest}")
    whole = last == VALUE and not isinstance(_at(table, (LIMITS, key)), Mapping)
    return field, (*above, LIMITS, key) if whole else (*above, LIMITS, key, last)


def _named(rows: tuple[Field, ...], name: str, path: str) -> Field:
    for field in rows:
        if field.name == name:
            return field
    raise DriveError([f"{shortened(path)[1:-1]}: is no field of a drive file"])


def _at(table: Any, path: Path) -> Any:
    """What stands at a path, None where nothing does."""
    for key in path:
        if isinstance(table, list):
            table = table[int(key)] if key.isdecimal() and int(key) < len(table) else None
        else:
            table = table.get(key) if isinstance(table, Mapping) else None
    return table


def with_named_entry(text: str, table: str, key: str, value: str) -> str:
    """Return the text of a drive file with a further entry.

    Parameters
    ----------
    text : str
        Of the file.
    table : str
        ``limits``, ``tolerances``, ``bearings``, ``case``, ``case.N`` for a field of its own, or an array of tables.
    key, value : str
        Its name, and what is typed for what it cannot be without.

    Raises
    ------
    DriveError
        For a name that is taken or means nothing, a value that is not accepted, and where the text has no place for it.
    """
    key, value = key.strip(), value.strip()
    head, _, number = table.partition(".")
    if head == CASE and number:
        return _with_own(text, number, key, value)
    adding: dict[str, Callable[[str, str, str], str]] = {
        LIMITS: _with_limit, TOLERANCES: _with_tolerance, CASE: _with_case, BEARINGS: _with_bearing,
    }  # fmt: skip
    if table in adding:
        return adding[table](text, key, value)
    arrays = [path.removesuffix(ARRAYS) for path in declarations()["tables"] if path.endswith(ARRAYS)]
    if table not in arrays:
        raise DriveError([f"entry = {shortened(table)}: must be one of {', '.join(sorted([*arrays, *adding]))}"])
    return with_entry(text, table)


def _with_limit(text: str, key: str, value: str, above: Path = ()) -> str:
    written = literal(_of_limit(key)[0], value)
    problems: list[str] = []
    parse_limits({key: json.loads(written) if written.startswith('"') else float(written)}, problems)
    return _with(text, (*above, LIMITS, key), written, problems)


def _with_tolerance(text: str, key: str, value: str) -> str:
    written = literal(_of_tolerance(key)[1], value)
    number = json.loads(written) if written.startswith('"') else float(written)
    problems: list[str] = []
    parse_tolerances({key: {DISTRIBUTION: "normal", "tolerance": number}}, problems)
    if any(path == key for path, _ in tolerance_entries(tables_of(text).get(TOLERANCES, {}), [])):
        problems = [f"{TOLERANCES}.{key}: is there already"]
    entry = f'{{ {DISTRIBUTION} = "normal", tolerance = {written} }}'
    return _with(text, (TOLERANCES, *key.split(".")), entry, problems)


def _with_case(text: str, key: str, value: str) -> str:
    cases = listed(tables_of(text).get(CASE))
    if not names_a_file(key):
        raise DriveError([f"{CASE}: name = {shortened(key)}: {NAMING}"])
    if any(one.get(NAME) == key for one in cases):
        raise DriveError([f"{CASE} {key}: name is used already; must be unique"])
    place: Path = (CASE, str(len(cases)), NAME)
    return with_values(with_entry(text, CASE), {place: json.dumps(key, ensure_ascii=False)})


def _with_bearing(text: str, key: str, value: str) -> str:
    if not key:
        raise DriveError([f"{BEARINGS}: name = '': must be what crank_bearing.bearing calls it"])
    first = _of_bearings()[0]
    problems = [] if value else [f"{BEARINGS}.{key}.{first.name}: is missing"]
    if _at(tables_of(text), (BEARINGS, key)) is not None:
        problems = [f"{BEARINGS}.{key}: is there already"]
    return _with(text, (BEARINGS, key, first.name), literal(first, value), problems)


def _with_own(text: str, number: str, key: str, value: str) -> str:
    if key.startswith(f"{LIMITS}."):
        _row_at(text, f"{CASE}.{number}.{key}.{VALUE}")
        return _with_limit(text, key.removeprefix(f"{LIMITS}."), value, (CASE, number))
    found = _row_at(text, f"{CASE}.{number}.{key}")
    if not value:
        raise DriveError([f"{CASE}.{number}.{key} = '': must be what the case has of its own"])
    assert found is not None
    field, place = found
    return _with(text, place, literal(field, value), [])


def _with(text: str, place: Path, value: str, problems: list[str]) -> str:
    if problems:
        raise DriveError(problems)
    if _at(tables_of(text), place) is not None:
        raise DriveError([f"{'.'.join(place)}: is there already"])
    return with_values(text, {place: value})


def without_named_entry(text: str, path: str) -> str:
    """Return the text of a drive file without an entry, by its path: ``limits.max_pin_load``, ``case.2``, ``disc.of.0``.

    Raises
    ------
    DriveError
        For what is no entry, and where the text has no way to be without it alone.
    """
    head, _, rest = path.partition(".")
    if head == TOLERANCES:
        place: Path = (TOLERANCES, *rest.split("."))
    elif head in (LIMITS, BEARINGS):
        place = (head, rest)
    else:
        place = tuple(path.split("."))
        array = path.rpartition(".")[0]
        if array != CASE and f"{array}{ARRAYS}" not in declarations()["tables"]:
            raise DriveError([f"{shortened(path)[1:-1]}: is no entry of a drive file"])
    return without_entry(text, place)
