"""Every field of a drive file with unit, default, bounds and meaning, read off the definitions themselves.

There is no second list: types bring units and bounds, the dataclasses bring defaults, the ``Attributes`` of their docstrings
the meaning. A field whose docstring says nothing is told without a word, which a test forbids.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import cache
from inspect import getdoc
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, cast, get_args, get_origin, get_type_hints

from pydantic import StrictBool
from pydantic.fields import FieldInfo
from pydantic.functional_validators import BeforeValidator

from ltca.drive.fields import ANY, field_kinds
from ltca.drive.materials import PARTS
from ltca.drive.members.bearings import NAMING_FIELDS
from ltca.drive.names import Name
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import COUNT, QuantityCheck
from ltca.drive.units.table import label

REQUIRED = "required"
LEFT_OUT = "left out"
ANY_PART = "PART"
"""Stands for each part of `materials`, which have the same fields."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldDescription:
    """What is told of one field.

    Attributes
    ----------
    path : str
        Dotted path in the drive file, with ``N`` for the number of an entry.
    kind : str
        ``quantity``, ``count``, ``choice`` or ``text``; of arrays that of their elements.
    unit : str
        Unit of a plain number as it is printed; empty for ratios, counts and words.
    is_array : bool
        Whether it holds a list.
    default : str
        What it is when left out; `REQUIRED` where it may not be (of a table that may be left out: where the table is given).
    bounds : str
        What values it takes, in words; empty where any is taken.
    meaning : str
        One sentence or a few.
    """

    path: str
    kind: str
    unit: str
    is_array: bool
    default: str
    bounds: str
    meaning: str

    @property
    def table(self) -> str:
        """Path of the table it stands in, empty for the head of the file."""
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Last part of the path."""
        return self.path.rpartition(".")[2]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableDescription:
    """What is told of one table.

    Attributes
    ----------
    path : str
        Dotted path in the drive file, with ``N`` for the number of an entry.
    optional : bool
        Whether leaving it out says something else than its defaults do: a part that is not there.
    meaning : str
        What it holds.
    """

    path: str
    optional: bool
    meaning: str


def attribute_sentences(owner: type) -> dict[str, str]:
    """Return what the docstring of a dataclass says of each attribute.

    Parameters
    ----------
    owner : type
        A dataclass with a numpydoc section ``Attributes``.

    Examples
    --------
    >>> from ltca.drive.parts import Clearance
    >>> attribute_sentences(Clearance)["pin_hole"]
    'Pin-hole clearance, added whole to r_PSH − r_PS, mm.'
    """
    _, _, section = (getdoc(owner) or "").partition("Attributes\n----------\n")
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.splitlines():
        if re.match(r"-{4,}$", line):  # the next section: its heading was taken for a name
            found.pop(names[0], None)
            break
        if line and not line.startswith(" "):
            names = [name.strip() for name in line.partition(" : ")[0].split(",")]
            found |= dict.fromkeys(names, "")
        else:
            for name in names:
                found[name] = f"{found[name]} {line.strip()}".strip()
    return found


@cache
def describe_fields() -> tuple[FieldDescription, ...]:
    """Return every field of a drive, in the order of the definition.

    Examples
    --------
    >>> thickness = next(field for field in describe_fields() if field.path == "disc.thickness")
    >>> thickness.unit, thickness.default, thickness.bounds, thickness.meaning
    ('mm', 'required', 'greater than 0', 'Thickness of one disc.')
    """
    return tuple(entry for entry in _walk(Drive, "") if isinstance(entry, FieldDescription))


@cache
def naming_fields() -> tuple[FieldDescription, ...]:
    """Return what drive files may say in the place of fields: names that stand for several."""
    return tuple(
        FieldDescription(
            path=path, kind=kind, unit="", is_array=False, default=LEFT_OUT, bounds=bounds, meaning=meaning
        )
        for path, (kind, bounds, meaning) in NAMING_FIELDS.items()
    )


@cache
def describe_tables() -> dict[str, TableDescription]:
    """Return every table of a drive by its path, in the order of the definition."""
    return {entry.path: entry for entry in _walk(Drive, "") if isinstance(entry, TableDescription)}


def table_description(path: str) -> TableDescription:
    """Return what is told of a table, also of ``materials.PART``.

    Parameters
    ----------
    path : str
        From `FieldDescription.table`.
    """
    if path != f"materials.{ANY_PART}":
        return describe_tables()[path]
    told = (f"{part} ({describe_tables()[f'materials.{part}'].meaning.rstrip('.')})" for part in PARTS)
    return TableDescription(path=path, optional=True, meaning=f"PART is one of {', '.join(told)}.")


def by_table(described: tuple[FieldDescription, ...]) -> dict[str, list[FieldDescription]]:
    """Return fields by the table they stand in, tables in the order of the definition.

    Parameters
    ----------
    described : tuple of FieldDescription
        From `describe_fields`.
    """
    found: dict[str, list[FieldDescription]] = {}
    for field in described:
        found.setdefault(field.table, []).append(field)
    return found


def gathered(described: tuple[FieldDescription, ...]) -> tuple[FieldDescription, ...]:
    """Return fields with those of all parts of `materials` told once, as ``materials.PART``.

    Parameters
    ----------
    described : tuple of FieldDescription
        From `describe_fields`.
    """
    first, others = PARTS[0], tuple(f"materials.{part}." for part in PARTS[1:])
    return tuple(
        field
        if not field.path.startswith("materials.")
        else FieldDescription(
            path=field.path.replace(f"materials.{first}.", f"materials.{ANY_PART}."),
            kind=field.kind,
            unit=field.unit,
            is_array=field.is_array,
            default=field.default,
            bounds=field.bounds,
            meaning=field.meaning,
        )
        for field in described
        if not field.path.startswith(others)
    )


def find_fields(name: str) -> tuple[FieldDescription, ...]:
    """Return the fields that a name may mean: a path, a table with all in it, or the last part of paths.

    Parameters
    ----------
    name : str
        ``disc.thickness``, ``pin_wheel``, ``disc.of.0.runout`` or ``thickness``; a number stands for ``N``.

    Returns
    -------
    tuple of FieldDescription
        Empty where it means none.
    """
    plain = re.sub(r"\.[0-9]+(?=\.|$)", f".{ANY}", name).removesuffix(".")
    described = (*describe_fields(), *naming_fields())
    if plain.startswith(f"materials.{ANY_PART}"):
        described = gathered(described)
    within = tuple(f for f in described if f.path == plain or f.path.startswith(f"{plain}."))
    if not within:  # an element of an array: disc.phases.1
        within = tuple(f for f in described if f.is_array and f"{f.path}.{ANY}" == plain)
    return within or tuple(f for f in described if f.name == plain)


def _walk(owner: type, prefix: str) -> Iterator[FieldDescription | TableDescription]:
    told = attribute_sentences(owner)
    defaults = {item.name: item for item in fields(owner)}
    for name, hint in get_type_hints(owner, include_extras=True).items():
        path, meaning, optional = f"{prefix}{name}", told.get(name, ""), False
        if not defaults[name].compare:  # the name of a case
            continue
        if get_origin(hint) in (Union, UnionType):
            (hint,) = (part for part in get_args(hint) if part is not NoneType)
            optional = True
        if is_dataclass(hint):
            yield TableDescription(path=path, optional=optional, meaning=meaning)
            yield from _walk(cast(type, hint), f"{path}.")
            continue
        is_array = get_origin(hint) is tuple
        if is_array and is_dataclass(get_args(hint)[0]):
            yield TableDescription(path=f"{path}.{ANY}", optional=True, meaning=meaning)
            yield from _walk(cast(type, get_args(hint)[0]), f"{path}.{ANY}.")
            continue
        kind, unit, bounds = _values(get_args(hint)[0] if is_array else hint)
        default = defaults[name]
        yield FieldDescription(
            path=path,
            kind=kind,
            unit=unit,
            is_array=is_array,
            default=_IN_FILES.get(path) or _shown(default.default),
            bounds=bounds,
            meaning=_without_unit(meaning, unit),
        )


def _values(hint: Any) -> tuple[str, str, str]:
    """Kind, unit and bounds of a type."""
    if get_origin(hint) is Literal:
        return "choice", "", ", ".join(f'"{word}"' for word in get_args(hint))
    if hint == StrictBool:
        return "choice", "", "true, false"
    if hint == Name:
        return "text", "", "what can name a file"
    kind, unit, bounds = "text", "", []
    for extra in get_args(hint)[1:] if get_origin(hint) is Annotated else ():
        if isinstance(extra, BeforeValidator) and isinstance(extra.func, QuantityCheck):
            kind, unit = "quantity", label(extra.func.unit)
            bounds += [f"{word} {bound:g}" for word, bound in extra.func.bounds if bound is not None]
        elif extra is COUNT:
            kind = "count"
        elif isinstance(extra, FieldInfo):
            bounds += [
                f"{word} {getattr(limit, name)}"
                for limit in extra.metadata
                for name, word in (("ge", "at least"), ("le", "at most"))
                if hasattr(limit, name)
            ]
    return kind, unit, " and ".join(bounds)


_IN_FILES = {"name": "that of the file"}
"""What files have in the place of a default of the definition."""


def _shown(default: Any) -> str:
    if default is MISSING:
        return REQUIRED
    if default is None or default == ():
        return LEFT_OUT
    if isinstance(default, bool):
        return "true" if default else "false"
    return f'"{default}"' if isinstance(default, str) else f"{default:g}"


def _without_unit(meaning: str, unit: str) -> str:
    """The sentence without the unit at the end of one of its parts, which stands beside it."""
    return re.sub(rf",? {re.escape(unit)}(?=[.;:]| \()", "", meaning) if unit else meaning


def known_paths() -> tuple[str, ...]:
    """Return what `find_fields` is asked for: paths of fields and tables, and last parts of paths."""
    paths = [*field_kinds(), *NAMING_FIELDS]
    return (*paths, *describe_tables(), *dict.fromkeys(path.rpartition(".")[2] for path in paths))
