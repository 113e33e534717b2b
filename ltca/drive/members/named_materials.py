"""Materials by name: ``materials.disc = "PA12"`` stands for numbers that ship as data, each with its scatter and source."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from importlib import resources
from typing import Any

from ltca.drive.materials import PARTS, Material, Materials
from ltca.errors import DriveError, nearest, shortened

FILE = "named_materials.toml"
LIKE = "like"
"""Key of a table that takes the properties it leaves out from a named material."""
FAR = 1.25
"""Factor beyond the scatter of a modulus from which it belongs to another material."""
MOST_OTHER = 3
"""Largest number of differing properties of a material that is still printed as "like" a named one."""
PRINTED = "printed "
"""Beginning of the names of materials that are printed from filament."""
FINEST_PRINT = 0.05
"""Smallest tolerance of a length that printed parts are assumed to have, mm. A choice, without source or measurement: above the
hundredths that machined parts hold, a quarter of the offset of 0.2 mm between pins and flank of a small published drive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SourcedNumber:
    """One property of a named material.

    Attributes
    ----------
    value : float
        In the unit of the field.
    low, high : float
        Range that parts of this material are known to have.
    source : str
        Source of the value.
    scatter_source : str
        Source of the range.
    confirmed : bool
        Whether the source of the value was looked up.
    """

    value: float
    low: float
    high: float
    source: str
    scatter_source: str
    confirmed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedMaterial:
    """A named material.

    Attributes
    ----------
    name : str
        Name in drive files.
    aliases : tuple of str
        Other names.
    state : str
        Heat treatment or manufacture that the properties belong to.
    numbers : dict of str to SourcedNumber
        By field of `ltca.drive.materials.Material`.
    """

    name: str
    aliases: tuple[str, ...]
    state: str
    numbers: dict[str, SourcedNumber]

    @property
    def material(self) -> Material:
        """The material as a drive holds it."""
        return Material(**{name: number.value for name, number in self.numbers.items()})


@cache
def named_materials() -> dict[str, NamedMaterial]:
    """Return all named materials by name.

    Examples
    --------
    >>> sorted(named_materials())[:3]
    ['100Cr6', '16MnCr5', '42CrMo4']
    """
    table = tomllib.loads((resources.files("ltca") / "drive" / "members" / FILE).read_text(encoding="utf-8"))
    sources = table.pop("sources")
    found = {}
    for name, entry in table.items():
        numbers = {field: _sourced(field, cell, sources) for field, cell in entry.items() if isinstance(cell, dict)}
        found[name] = NamedMaterial(name=name, aliases=tuple(entry["aliases"]), state=entry["state"], numbers=numbers)
    return found


def _sourced(field: str, cell: Mapping[str, Any], sources: Mapping[str, Any]) -> SourcedNumber:
    # Read like quantities of a drive file: by the field, with its unit and bounds.
    value, low, high = (getattr(Material(**{field: cell[key]}), field) for key in ("value", "low", "high"))
    source = sources[cell["source"]]
    return SourcedNumber(
        value=value,
        low=low,
        high=high,
        source=source["text"],
        scatter_source=sources[cell.get("range", cell["source"])]["text"],
        confirmed=source["confirmed"],
    )


def sourced_material(name: str) -> NamedMaterial:
    """Return a named material with scatter and sources, by its name or an alias in any case; DriveError for an unknown
    name.
    """
    spelled = {
        spelling.casefold(): entry for entry in named_materials().values() for spelling in (entry.name, *entry.aliases)
    }
    entry = spelled.get(name.strip().casefold())
    if entry is None:
        raise DriveError([f"{shortened(name)}: {_unknown(name)}"])
    return entry


def _unknown(name: str) -> str:
    every = [spelling for entry in named_materials().values() for spelling in (entry.name, *entry.aliases)]
    meant = nearest(name, every)
    asked = f"; did you mean `{meant}`?" if meant else ""
    return f"is no named material; there are {', '.join(named_materials())}{asked}"


def named_material(name: str) -> Material:
    """Return a named material by its name or an alias; DriveError for an unknown name.

    Examples
    --------
    >>> named_material("PA12").youngs_modulus
    1600.0
    """
    return sourced_material(name).material


def material_sources(name: str) -> dict[str, str]:
    """Return the sources of the properties of a named material, by field; DriveError for an unknown name.

    Examples
    --------
    >>> material_sources("PLA")["poisson_ratio"]
    'typical, not confirmed'
    """
    return {field: number.source for field, number in sourced_material(name).numbers.items()}


def name_of(material: Material) -> str | None:
    """Return the name of a material, the nearest name with the fields that differ, or None.

    Examples
    --------
    >>> from dataclasses import replace
    >>> name_of(replace(named_material("PA12"), youngs_modulus=1400.0))
    'like PA12, but youngs_modulus'
    """
    name, other = _nearest(material)
    return name if not other or name is None else f"like {name}, but {', '.join(other)}"


def _nearest(material: Material) -> tuple[str | None, list[str]]:
    """The named material with the fewest differing properties, and their fields; None beyond `MOST_OTHER`."""
    best: str | None = None
    least = [item.name for item in fields(Material)][: MOST_OTHER + 1]
    for name, entry in named_materials().items():
        known = entry.material
        other = [item.name for item in fields(Material) if getattr(known, item.name) != getattr(material, item.name)]
        if len(other) < len(least):
            best, least = name, other
    return best, least


def strength_warning(materials: Materials) -> str | None:
    """Return a warning where a part has the strength of a named material but a modulus far from it, None elsewhere."""
    told = []
    for part in PARTS:
        material: Material = getattr(materials, part)
        name, other = _nearest(material)
        if name is None or "youngs_modulus" not in other or "allowable_pressure" in other:
            continue
        known = named_materials()[name].numbers["youngs_modulus"]
        if not known.low / FAR < material.youngs_modulus < known.high * FAR:
            told.append(
                f"materials.{part}: youngs_modulus = {material.youngs_modulus:g} MPa is none of {name} ({known.low:g} … "
                f"{known.high:g} MPa), by whose strength it is judged"
            )
    return "; ".join(told) or None


def with_named_materials(table: Mapping[str, Any], problems: list[str]) -> dict[str, Any]:
    """Return the plain tables of a drive file with the properties of named materials in the places of their names.

    Mistakes are appended to `problems`.
    """
    found, parts, ring = dict(table), table.get("materials"), table.get("ring")
    if isinstance(parts, Mapping):
        found["materials"] = {
            part: _resolved(f"materials.{part}", given, problems) if part in PARTS else given
            for part, given in parts.items()
        }
    if isinstance(ring, Mapping) and "material" in ring:
        found["ring"] = {**ring, "material": _resolved("ring.material", ring["material"], problems)}
    return found


def _resolved(path: str, given: Any, problems: list[str]) -> Any:
    below: Mapping[str, Any] = {}
    if isinstance(given, Mapping) and LIKE in given:
        given, below = given[LIKE], {key: value for key, value in given.items() if key != LIKE}
        path = f"{path}.{LIKE}"
        if not isinstance(given, str):
            problems.append(f"{path} = {shortened(given)}: must be the name of a material")
            return dict(below)
    elif not isinstance(given, str):
        return given
    try:
        known = named_material(given)
    except DriveError:
        problems.append(f"{path} = {shortened(given)}: {_unknown(given)}")
        return dict(below)
    return {**numbers_of(known), **below}


def numbers_of(material: Material) -> dict[str, float | None]:
    """Return the properties of a material by field, None for unknown ones."""
    return {item.name: getattr(material, item.name) for item in fields(Material)}


def named_parts(materials: Materials) -> dict[str, str]:
    """Return the names of the materials by part (field of `Materials`), for the parts whose material has a name."""
    names = {part: name_of(getattr(materials, part)) for part in PARTS}
    return {part: name for part, name in names.items() if name is not None}
