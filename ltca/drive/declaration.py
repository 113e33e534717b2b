"""The declaration of a drive: every field with its type, unit, bounds, default, meaning and growth with temperature.

There is no second list: types bring units, bounds and growth, the dataclasses bring defaults, the ``Attributes`` of their
docstrings the meaning. Paths (`ltca.drive.fields`), messages (`ltca.drive.mistakes`), warm drives
(`ltca.drive.members.temperatures`), ``cyclo fields`` and the reference pages read it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from functools import cache
from inspect import getdoc
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, cast, get_args, get_origin, get_type_hints

from pydantic import StrictBool
from pydantic.fields import FieldInfo
from pydantic.functional_validators import BeforeValidator

from ltca.drive.materials import PARTS
from ltca.drive.members.bearings import BearingName, NamedBearing
from ltca.drive.members.operation import LIGHT_DEFAULT
from ltca.drive.names import Name
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import COUNT, Grows, QuantityCheck
from ltca.drive.units.table import label

ANY = "N"
"""Stands for the number of an entry of ``disc.of``, ``crank.of`` or ``duty`` in paths."""
REQUIRED = "required"
LEFT_OUT = "left out"
ANY_PART = "PART"
"""Stands for each part of `materials`, which have the same fields."""
OWN_BEARING = "bearings.NAME"
"""Table of a bearing in a drive file."""
INDICES = ("crank.of.N.disc", "crank.of.N.crank")
"""Index keys of an entry, as opposed to fields: which eccentric the entry belongs to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """Declaration of one field.

    Attributes
    ----------
    path : str
        Dotted path in the drive file, with ``N`` for the number of an entry.
    kind : str
        ``quantity``, ``count``, ``choice`` or ``text``; of arrays that of their elements.
    unit : str
        Unit of a quantity, ``dimensionless`` for ratios; empty for counts and words.
    is_array : bool
        Whether it holds one value for each pin, hole, roller, order or point.
    default : str
        Value when left out, as printed; `REQUIRED` where it may not be (of a table that may be left out: where the table is
        given).
    choices : tuple of str
        Words of a choice.
    bounds : str
        Values it accepts, in words; empty where any is accepted.
    meaning : str
        One sentence or a few.
    grows : Grows or None
        How it grows with temperature; None for what does not.
    """

    path: str
    kind: str
    unit: str
    is_array: bool
    default: str
    choices: tuple[str, ...]
    bounds: str
    meaning: str
    grows: Grows | None

    @property
    def label(self) -> str:
        """Unit of a plain number as it is printed; empty for ratios, counts and words."""
        return label(self.unit)

    @property
    def table(self) -> str:
        """Path of the table it stands in, empty for the head of the file."""
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Last part of the path."""
        return self.path.rpartition(".")[2]


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Declaration of one table.

    Attributes
    ----------
    path : str
        Dotted path in the drive file, with ``N`` for the number of an entry.
    optional : bool
        Whether leaving it out differs from giving its defaults: the drive is without that part.
    meaning : str
        Its contents.
    """

    path: str
    optional: bool
    meaning: str


def attribute_sentences(owner: type) -> dict[str, str]:
    """Return the sentences on each attribute in the docstring of a dataclass with a numpydoc section ``Attributes``.

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
def declared_fields() -> dict[str, Field]:
    """Return every field of a drive by its path, in the order of the definition.

    Examples
    --------
    >>> thickness = declared_fields()["disc.thickness"]
    >>> thickness.unit, thickness.default, thickness.bounds, thickness.meaning, thickness.grows.part
    ('mm', 'required', 'greater than 0', 'Thickness of one disc.', 'disc')
    """
    return {entry.path: entry for entry in _walk(Drive, "", None) if isinstance(entry, Field)}


@cache
def declared_tables() -> dict[str, Table]:
    """Return every table of a drive by its path, in the order of the definition."""
    return {entry.path: entry for entry in _walk(Drive, "", None) if isinstance(entry, Table)}


@cache
def naming_fields() -> dict[str, Field]:
    """Return the keys of a drive file that stand for fields of the drive, by path: names of bearings and their entries.

    Examples
    --------
    >>> naming_fields()["crank_bearing.clearance_class"].choices
    ('C2', 'CN', 'C3', 'C4', 'C5')
    """
    walked = (*_walk(BearingName, "crank_bearing.", None), *_walk(NamedBearing, f"{OWN_BEARING}.", None))
    return {entry.path: entry for entry in walked if isinstance(entry, Field)}


def table_of(path: str) -> Table:
    """Return the declaration of a table, also of ``materials.PART`` and ``bearings.NAME``."""
    if path == OWN_BEARING:
        meaning = "Bearing of your own, or of a catalogue, that ``crank_bearing.bearing`` then names."
        return Table(path=path, optional=True, meaning=meaning)
    if path != f"materials.{ANY_PART}":
        return declared_tables()[path]
    parts = (f"{part} ({declared_tables()[f'materials.{part}'].meaning.rstrip('.')})" for part in PARTS)
    return Table(path=path, optional=True, meaning=f"PART is one of {', '.join(parts)}.")


def by_table(chosen: tuple[Field, ...]) -> dict[str, list[Field]]:
    """Return fields by the path of their table, tables in the order of the definition."""
    found: dict[str, list[Field]] = {}
    for field in chosen:
        found.setdefault(field.table, []).append(field)
    return found


def gathered() -> tuple[Field, ...]:
    """Return every field and the keys that stand for some, with those of all parts of `materials` once, as
    ``materials.PART``.
    """
    first, others = PARTS[0], tuple(f"materials.{part}." for part in PARTS[1:])
    fields_once = (
        replace(field, path=path.replace(f"materials.{first}.", f"materials.{ANY_PART}."))
        for path, field in declared_fields().items()
        if not path.startswith(others)
    )
    return (*fields_once, *naming_fields().values())


def find_fields(name: str) -> tuple[Field, ...]:
    """Return the fields that a name may mean: a path, a table with all in it, or the last part of paths of fields or tables;
    empty for none.

    Parameters
    ----------
    name : str
        ``disc.thickness``, ``pin_wheel``, ``disc.of.0.runout``, ``thickness`` or ``beam``; a number stands for ``N``.
    """
    plain = re.sub(r"\.[0-9]+(?=\.|$)", f".{ANY}", name).removesuffix(".")
    every = (*declared_fields().values(), *naming_fields().values())
    known = gathered() if plain.startswith(f"materials.{ANY_PART}") else every
    within = tuple(f for f in known if f.path == plain or f.path.startswith(f"{plain}."))
    if not within:  # an element of an array: disc.phases.1
        within = tuple(f for f in known if f.is_array and f"{f.path}.{ANY}" == plain)
    if not within:
        within = tuple(f for f in known if f.name == plain)
    return within or tuple(f for f in known if f".{plain}." in f".{f.path}")  # tables of that name: beam


def known_paths() -> tuple[str, ...]:
    """Return the names that `find_fields` knows: paths of fields and tables, and last parts of paths."""
    paths = [path for path in (*declared_fields(), *naming_fields()) if path not in INDICES]
    tables = [*declared_tables(), OWN_BEARING]
    return (*paths, *tables, *dict.fromkeys(path.rpartition(".")[2] for path in (*paths, *tables)))


def _walk(owner: type, prefix: str, grows: Grows | None) -> Iterator[Field | Table]:
    """Yield the fields and tables of a dataclass; `grows` is the growth of lengths that declare no other."""
    meanings = attribute_sentences(owner)
    defaults = {item.name: item for item in fields(owner)}
    for name, annotated in get_type_hints(owner, include_extras=True).items():
        path, meaning = f"{prefix}{name}", meanings.get(name, "")
        if not defaults[name].compare:  # the name of a case
            continue
        hint, optional, said = _unwrapped(annotated)
        growth = said or (None if grows is None else grows.of(name))
        if is_dataclass(hint):
            yield Table(path=path, optional=optional, meaning=meaning)
            yield from _walk(cast(type, hint), f"{path}.", growth)
            continue
        is_array = get_origin(hint) is tuple
        element = get_args(hint)[0] if is_array else hint
        if is_dataclass(element):
            yield Table(path=f"{path}.{ANY}", optional=True, meaning=meaning)
            yield from _walk(cast(type, element), f"{path}.{ANY}.", growth)
            continue
        kind, unit, choices, bounds = _values(element)
        yield Field(
            path=path,
            kind=kind,
            unit=unit,
            is_array=is_array,
            default=_IN_FILES.get(path) or _shown(defaults[name].default),
            choices=choices,
            bounds=bounds,
            meaning=_without_unit(meaning, label(unit)),
            grows=growth if unit == "mm" else None,
        )


def _unwrapped(hint: Any) -> tuple[Any, bool, Grows | None]:
    """A type without its growth and without None, whether it may be None, and its growth."""
    optional, grows = False, None
    if get_origin(hint) is Annotated:
        grows = next((extra for extra in get_args(hint)[1:] if isinstance(extra, Grows)), None)
        if grows is not None and len(get_args(hint)) == 2:
            hint = get_args(hint)[0]
    if get_origin(hint) in (Union, UnionType):
        (hint,) = (part for part in get_args(hint) if part is not NoneType)
        optional = True
    return hint, optional, grows


def _values(hint: Any) -> tuple[str, str, tuple[str, ...], str]:
    """Kind, unit, choices and bounds of a type."""
    if get_origin(hint) is Literal:
        return "choice", "", get_args(hint), ", ".join(f'"{word}"' for word in get_args(hint))
    if hint == StrictBool:
        return "choice", "", (), "true, false"
    if hint == Name:
        return "text", "", (), "what can name a file"
    kind, unit, bounds = "text", "", []
    for extra in get_args(hint)[1:] if get_origin(hint) is Annotated else ():
        if isinstance(extra, BeforeValidator) and isinstance(extra.func, QuantityCheck):
            kind, unit = "quantity", extra.func.unit
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
    return kind, unit, (), " and ".join(bounds)


_IN_FILES = {"name": "that of the file", "load.light_torque": LIGHT_DEFAULT}
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
