"""The fields of a drive file as a page shows them: what is declared of each, and what a text has written for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from ltca.drive.declaration import ANY, REQUIRED, Field, declared_fields, declared_tables, naming_fields
from ltca.drive.engine_support import refusals
from ltca.drive.materials import PARTS
from ltca.drive.members.named_materials import LIKE, named_materials
from ltca.errors import DriveError, shortened
from ltca.reading.measured.tables import FIELD as MEASURED
from ltca.reading.toml_edit import literal, tables_of, with_values

TURNED = {
    "disc.equidistant_offset": ("around", 0.002), "disc.shifting_offset": ("around", 0.002),
    "clearance.bearing": ("above", 0.001), "clearance.pin_hole": ("above", 0.001),
    "crank.eccentricity": ("part", 0.3), "pin_wheel.pin_radius": ("part", 0.3), "load.torque": ("part", 1.0),
}  # fmt: skip
"""Fields with a slider: about the value or above zero by a part of the radius of the pin circle, or about it by a part of
itself."""
STEPS = 200
"""Of a slider from end to end."""
NOT_HERE = ("tolerances", "limits", "case", "bearings")
"""Tables whose entries have names of their own (`ltca.studio.entries`)."""


@cache
def declarations() -> dict[str, Any]:
    """Return what is declared of every field and table, as plain data; entries of lists have ``N`` for their number."""
    tables: dict[str, dict[str, Any]] = {"": {"meaning": "", "optional": False, "fields": []}}
    tables |= {
        path: {"meaning": plain(table.meaning), "optional": table.optional, "fields": []}
        for path, table in declared_tables().items()
    }
    for field in known_fields().values():
        tables[field.table]["fields"].append(declared(field))
    return {
        "tables": {path: table for path, table in tables.items() if table["fields"]},
        "turned": {path: list(how) for path, how in TURNED.items()},
        "steps": STEPS,
    }


@cache
def known_fields() -> dict[str, Field]:
    """Fields by path, with the names of materials and bearings before the properties that they stand for."""
    found: dict[str, Field] = {}
    named = {f"materials.{part}": part for part in PARTS} | {"ring.material": "ring"}
    for path, field in declared_fields().items():
        table = field.table
        if table in named and f"{table}.{LIKE}" not in found:
            found[f"{table}.{LIKE}"] = Field(
                path=f"{table}.{LIKE}", kind="choice", unit="", is_array=False, default="left out",
                choices=tuple(named_materials()), bounds="", grows=None,
                meaning="Material by its name, which brings the properties below that are left out.",
            )  # fmt: skip
        found[path] = field
    found |= {path: field for path, field in naming_fields().items() if path.startswith("crank_bearing.")}
    return found


@lru_cache(maxsize=2048)  # every edit tells of rows
def declared(field: Field) -> Mapping[str, Any]:
    """Return what is declared of a field as plain data."""
    told = [f"refused by {', '.join(engines)}: {reason}" for reason, engines in refusals(field.path).items() if engines]
    choices = field.choices
    if field.kind == "choice" and not choices:
        choices = ("true", "false")
    return {
        "path": field.path,
        "name": field.name,
        "kind": field.kind,
        "unit": field.label,
        "array": field.is_array,
        "choices": list(choices),
        "bounds": "" if field.kind == "choice" else field.bounds,
        "default": "" if field.default == REQUIRED else field.default.strip('"'),
        "required": field.default == REQUIRED,
        "meaning": plain(field.meaning),
        "refused": [plain(one) for one in told],
    }


def plain(text: str) -> str:
    """Return a sentence without the marks of code."""
    return text.replace("``", "").replace("`", "")


def written_values(text: str, case: str) -> dict[str, Any]:
    """Return what a text has written: values by path, which of them the case has of its own, and the names of its cases.

    Raises
    ------
    DriveError
        When the text is no TOML.
    """
    table = tables_of(text)
    cases = [one for one in listed(table.get("case")) if isinstance(one.get("name"), str)]
    names = [str(one["name"]) for one in cases]
    common = dict(leaves({key: value for key, value in table.items() if key not in NOT_HERE}, ""))
    own: dict[str, str] = {}
    if case in names:
        entry = cases[names.index(case)]
        own = dict(leaves({key: value for key, value in entry.items() if key not in ("name", *NOT_HERE)}, ""))
    entries: dict[str, int] = {}
    _count(table, "", entries)
    return {"values": common | own, "own": list(own), "cases": names, "entries": entries}


def _count(table: Mapping[str, Any], above: str, entries: dict[str, int]) -> None:
    """Count the entries of arrays of tables, by path."""
    for key, value in table.items():
        if isinstance(value, dict):
            _count(value, f"{above}{key}.", entries)
        elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
            entries[f"{above}{key}"] = len(value)


def leaves(table: Mapping[str, Any], above: str) -> Iterator[tuple[str, str]]:
    """Yield the values of tables as they are shown, each with its path below another one."""
    for key, value in table.items():
        path = f"{above}{key}"
        if isinstance(value, dict):
            yield from leaves(value, f"{path}.")
        elif isinstance(value, list) and value and all(isinstance(one, dict) for one in value):
            for number, one in enumerate(value):
                yield from leaves(one, f"{path}.{number}.")
        elif isinstance(value, str) and f"{path}.{LIKE}" in known_fields():
            yield f"{path}.{LIKE}", value
        elif isinstance(value, list):
            yield path, ", ".join(shown(one) for one in value)
        else:
            yield path, shown(value)


def measured_files(table: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return the paths of all measured flanks in the tables of a file, each with the name of its file."""
    return [(path, name) for path, name in leaves(table, "") if path.rpartition(".")[2] == MEASURED]


def files_elsewhere(text: str, source: Path) -> list[str]:
    """Return a sentence for every measured flank whose file is not in the folder of the drive file, or below it."""
    folder = source.parent.resolve()
    return [
        f"{path} = {shortened(name)}: must be a file in the folder of the studio, or below it"
        for path, name in measured_files(tables_of(text))
        if not _inside(folder, name)
    ]


def _inside(folder: Path, name: str) -> bool:
    try:
        return (folder / name).resolve().is_relative_to(folder)
    except (OSError, ValueError):
        return False


def shown(value: Any) -> str:
    """Return a value as it is shown."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)


def listed(value: Any) -> Sequence[dict[str, Any]]:
    """Return the tables of an array of tables; none of anything else."""
    return [one for one in value if isinstance(one, dict)] if isinstance(value, list) else []


def changed_text(text: str, case: str, changes: Mapping[str, str]) -> str:
    """Return the text of a drive file with fields changed to what was typed; nothing typed leaves a field out.

    A field that the case has of its own is changed there, any other one in the common part.

    Raises
    ------
    DriveError
        For what is no field, and where the text has no place for it.
    """
    table = tables_of(text)
    cases = listed(table.get("case"))
    number = next((place for place, one in enumerate(cases) if one.get("name") == case), None)
    known = known_fields()
    found: dict[str, str | None] = {}
    for path, typed in changes.items():
        field = known.get(declared_path(path))
        if field is None:
            raise DriveError([f"{shortened(path)[1:-1]}: is no field of a drive file"])
        place = place_of(table, path)
        if number is not None and is_written(cases[number], place.split(".")):
            place = f"case.{number}.{place_of(cases[number], path)}"
        written = cases[number] if place.startswith("case.") and number is not None else table
        if f"{field.table}.{LIKE}" not in known and _is_text(written, path):
            raise DriveError([f"{path}: its table is written as one value; change the text of the file"])
        found[place] = literal(field, typed) if typed.strip() else None
    return with_values(text, found)


def _is_text(table: Mapping[str, Any], path: str) -> bool:
    """Whether a text or number stands in the place of the table of a field."""
    branch: Any = table
    for part in path.split(".")[:-1]:
        if isinstance(branch, list):
            return False
        branch = branch.get(part, {})
        if not isinstance(branch, dict | list):
            return True
    return False


def declared_path(path: str) -> str:
    """The path with ``N`` in the place of numbers of entries."""
    return ".".join(ANY if part.isdigit() else part for part in path.split("."))


def place_of(table: Mapping[str, Any], path: str) -> str:
    """Where the value of a field stands: a material that is a name alone is that name."""
    above, _, last = path.rpartition(".")
    if last != LIKE:
        return path
    branch: Any = table
    for part in above.split("."):
        branch = branch.get(part) if isinstance(branch, dict) else None
    return path if isinstance(branch, dict) else above


def is_written(table: Mapping[str, Any], path: Sequence[str]) -> bool:
    """Whether a table has a value at a path, or one in its place."""
    branch: Any = table
    for part in path:
        if isinstance(branch, list) and part.isdigit() and int(part) < len(branch):
            branch = branch[int(part)]
        elif isinstance(branch, dict) and part in branch:
            branch = branch[part]
        else:
            return isinstance(branch, str)
    return True
