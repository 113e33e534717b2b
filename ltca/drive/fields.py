"""Fields of a drive by dotted path: read, count, unit.

Values per disc stand in ``disc.of`` and ``crank.of``: ``disc.of.1.runout.amount`` is that of disc 1, and where it is left out,
it reads as the common field ``disc.runout.amount``. Eccentrics of several cranks are counted disc after disc: ``crank.of.N`` is
that of disc N // cranks on crank N % cranks, in whatever order the file has them. ``duty.N`` and ``load.external.N`` are
entries N of ``[[duty]]`` and ``[[load.external]]``, counted from 0 in the order of the file, ``main_bearing.bearings.N``
likewise.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any

from ltca.drive.declaration import ANY as ANY, INDICES, LEFT_OUT, Field, declared_fields, naming_fields
from ltca.drive.members.width import FEWEST_SLICES, needs_slices
from ltca.drive.parts import Drive, Friction
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError, Problem, nearest

OWN = {
    "disc.runout": "disc.of.N.runout",
    "disc.profile_errors": "disc.of.N.profile_errors",
    "disc.hole_errors": "disc.of.N.hole_errors",
    "disc.lead_crown_drop": "disc.of.N.lead_crown_drop",
    "disc.lead_relief_length": "disc.of.N.lead_relief_length",
    "disc.lead_relief_depth": "disc.of.N.lead_relief_depth",
    "disc.lead_slope": "disc.of.N.lead_slope",
    "clearance": "disc.of.N.clearance",
    "crank_bearing.roller_errors": "disc.of.N.roller_errors",
    "crank.eccentricity_error": "crank.of.N.eccentricity_error",
}
"""Common fields and tables, and those of single discs that replace them."""
_NUMBERED = re.compile(r"^((?:disc|crank)\.of|duty|load\.external|main_bearing\.bearings)\.([0-9]{1,6})\.")
LISTED = ("duty", "load.external", "main_bearing.bearings")
"""Tables whose entries are counted from 0 in the order of the file."""


@cache
def field_kinds() -> dict[str, Field]:
    """Return every field of a drive by its dotted path, those of one disc with ``N`` for its number.

    Examples
    --------
    >>> field_kinds()["disc.thickness"].unit, field_kinds()["crank.of.N.phase_error"].unit
    ('mm', 'rad')
    """
    return {path: field for path, field in declared_fields().items() if path not in INDICES}


@lru_cache(maxsize=4096)
def field_kind(path: str) -> Field | None:
    """Return the declaration of a field, also of one of a numbered disc; None where there is none.

    Examples
    --------
    >>> field_kind("disc.of.0.runout.amount").path
    'disc.of.N.runout.amount'
    """
    if f".{ANY}." in path:
        return None
    return field_kinds().get(_NUMBERED.sub(rf"\1.{ANY}.", path))


def own_paths(drive: Drive, path: str) -> tuple[str, ...]:
    """Return the paths of the values per disc or eccentric that replace a common field; empty for other fields.

    Examples
    --------
    >>> from ltca.reading.drive_file import parse_drive, shipped_drive
    >>> drive = parse_drive(shipped_drive("robot-joint")).cases["nominal"]
    >>> own_paths(drive, "clearance.bearing"), own_paths(drive, "disc.thickness")
    (('disc.of.0.clearance.bearing', 'disc.of.1.clearance.bearing'), ())
    """
    for common, own in OWN.items():
        if path == common or path.startswith(f"{common}."):
            count = _entries(drive, own.partition(".")[0])
            return tuple(own.replace(ANY, str(number)) + path[len(common) :] for number in range(count))
    return ()


def _entries(drive: Drive, table: str) -> int:
    """Number of discs or eccentrics."""
    discs = drive.disc.number_of_discs
    return discs * drive.crank.number if table == "crank" else discs


def numbered(path: str) -> tuple[str, int, str] | None:
    """Return table, disc and name of a field of one disc: ``("disc.of", 0, "runout.amount")``; None for others."""
    found = _NUMBERED.match(path)
    return None if found is None else (found.group(1), int(found.group(2)), path[found.end() :])


def whose(drive: Drive, path: str) -> str:
    """Return disc and crank of a field of one eccentric of several cranks; empty for fields whose path says it.

    Examples
    --------
    >>> from ltca.reading.drive_file import parse_drive, shipped_drive
    >>> whose(parse_drive(shipped_drive("rv")).cases["nominal"], "crank.of.4.phase_error")
    'disc 1, crank 1'
    """
    found = numbered(path)
    if found is None or found[0] != "crank.of" or drive.crank.number == 1:
        return ""
    disc, crank = divmod(found[1], drive.crank.number)
    return f"disc {disc}, crank {crank}"


def with_whose(path: str, owner: str) -> str:
    """Return a path followed by disc and crank (`whose`), if any.

    Examples
    --------
    >>> with_whose("crank.of.4.phase_error", "disc 1, crank 1")
    'crank.of.4.phase_error (disc 1, crank 1)'
    """
    return f"{path} ({owner})" if owner else path


def _counting(drive: Drive, table: str) -> str:
    """Meaning and range of N in ``disc.of.N`` and ``crank.of.N``, and in an entry of `LISTED`."""
    if table in LISTED:
        return f"N of {table}.N is the entry, counted from 0"
    last, cranks = _entries(drive, table.partition(".")[0]) - 1, drive.crank.number
    means = f"disc · {cranks} + crank" if table == "crank.of" and cranks > 1 else "the disc"
    return f"N of {table}.N is {means}, " + (f"from 0 to {last}" if last else "and 0 alone")


def not_a_field(drive: Drive | None, path: str, known: Iterable[str] | None = None) -> str:
    """Return the message for a path that is not a field, with the field of the drive that it is close to.

    Candidates are `known`, all fields by default; without a drive (None) also those that a drive may be without.
    """
    if path in naming_fields():
        return "stands for other fields in a drive file and is none itself; give each bearing a [[case]], or vary those fields"
    there = tuple(
        name
        for name in (field_kinds() if known is None else known)
        if drive is None or absence(drive, name.replace(f".{ANY}.", ".0.")) is None
    )
    if inside := [name for name in there if name.startswith(f"{path}.") and f".{ANY}." not in name]:
        return f"is a table; name its fields, as `{inside[0]}`"
    written = re.fullmatch(r"(disc|crank)\.of\.(\w+)\.(.*)", path)
    plain = path if written is None else f"{written.group(1)}.of.{ANY}.{written.group(3)}"
    table, _, name = path.partition(".")
    of_one = f"{table}.of.{ANY}.{name}"
    meant = plain if plain in there else of_one if of_one in there else nearest(plain, there)
    told = ""
    if f".{ANY}." in meant and drive is not None:
        told = f"; {_counting(drive, meant.partition(f'.{ANY}.')[0])}"
    if meant == plain and written is not None:
        return f"must have a number in the place of {written.group(2)}{told}"
    if written is not None and written.group(2).isdigit():
        meant, told = meant.replace(f".{ANY}.", f".{written.group(2)}."), ""
    return "is not a field of the drive definition" + (f"; did you mean `{meant}`?{told[1:]}" if meant else "")


def element_count(drive: Drive, path: str) -> int | None:
    """Return the number of elements of an array field when filled; None for a single number.

    DriveError when there is no such field, or no such disc.
    """
    kind = field_kind(path)
    if kind is None:
        raise DriveError([Problem.of(path, "", not_a_field(drive, path))])
    if missing := missing_part(drive, path):
        raise DriveError([Problem.of(path, "", f"there is no {missing} in this drive")])
    drive, path = _of_disc(drive, path)
    if not kind.is_array:
        return None
    errors = drive.disc.profile_errors
    counts = {
        "pin_wheel.pin_errors": drive.pin_wheel.number_of_pins,
        "disc": drive.disc.number_of_discs,
        "disc.hole_errors": drive.number_of_holes,
        "pin_shaft.pin_errors": drive.number_of_holes,
        "disc.of.0.bore_errors": drive.crank.number,
        "first_stage.planet_runout": drive.crank.number,
        "crank.support": 2,
        "carrier": 2,
        "crank_bearing.roller_errors": drive.crank_bearing.number_of_rollers,
        "disc.profile_errors": len(errors.parameter) if path.endswith(".deviation") else len(errors.orders),
    }
    return counts[path.rpartition(".")[0]]


def missing_part(drive: Drive, path: str) -> str | None:
    """Return the table that a field belongs to where the drive is without it: its pin shaft, supports or beams; None
    elsewhere.

    Coefficients of friction are zero without friction, and never missing.
    """
    if drive.pin_shaft is None and (path.startswith("disc.hole_errors") or ".hole_errors." in path):
        return "pin_shaft"
    part: Any = drive
    tables = path.split(".")[:-1] if numbered(path) is None and not path.startswith("friction.") else []
    for depth, name in enumerate(tables):
        part = getattr(part, name)
        if part is None:
            return ".".join(tables[: depth + 1])
    return None


_OF_SEVERAL_CRANKS = ("crank.circle_radius", "crank.angle", "installation.first_stage_ratio")
_OF_PARTS = {
    "materials.shaft_pin.": "pin_shaft",
    "clearance.pin_hole": "pin_shaft",
    "friction.hole": "pin_shaft",
    "materials.crankshaft.": "crank.support",
    "materials.carrier.": "carrier.posts",
}
"""Fields of a part that may be left out, which stand in other tables."""


def absence(drive: Drive, path: str) -> str | None:
    """Return why a drive cannot have a number in a field; None where it can."""
    found = numbered(path)
    if found is not None and (problem := no_entry(drive, found[0], found[1])) is not None:
        return problem
    held = {
        "pin_shaft": drive.pin_shaft,
        "crank.support": drive.crank.support,
        "carrier.posts": None if drive.carrier is None else drive.carrier.posts,
    }
    name = path if found is None else found[2]
    beside = [part for head, part in _OF_PARTS.items() if held[part] is None and name.startswith(head)]
    if missing := missing_part(drive, path) or next(iter(beside), None):
        return f"there is no {missing} in this drive"
    if drive.crank.number == 1 and (path in _OF_SEVERAL_CRANKS or name.startswith("bore_errors.")):
        return "must be left out with one crank (crank.number = 1), which stands in the centre"
    return None


def lacks_slices(drive: Drive, path: str) -> str | None:
    """Return why a field of the width cannot vary in a plane drive; None where it can, and for other fields."""
    if drive.contact.slices >= FEWEST_SLICES or not needs_slices(path):
        return None
    return f"needs slices along the width, contact.slices = {FEWEST_SLICES} or more (it is {drive.contact.slices})"


def no_entry(drive: Drive, table: str, number: int) -> str | None:
    """Return the message for an entry of ``disc.of``, ``crank.of`` or one of `LISTED` that the drive is without; None where
    it has it.
    """
    discs, cranks = drive.disc.number_of_discs, drive.crank.number
    entries = len(listed_entries(drive, table)) if table in LISTED else _entries(drive, table.partition(".")[0])
    if number < entries:
        return None
    if table in LISTED:
        told = table if table == "main_bearing.bearings" else f"[[{table}]]"
        return f"there is no entry {number}; {told} has {entries}, counted from 0"
    if table == "crank.of" and cranks > 1:
        sizes = f"disc.number_of_discs = {discs}, crank.number = {cranks}"
        return f"there is no eccentric {number}; {sizes}: {_counting(drive, table)}"
    return f"there is no disc {number}; disc.number_of_discs = {discs}: {_counting(drive, table)}"


def listed_entries(drive: Drive, table: str) -> tuple[Any, ...]:
    """Return the entries of one of `LISTED`; none without the table they stand in."""
    if table == "duty":
        return drive.duty
    if table == "load.external":
        return drive.load.external
    return () if drive.main_bearing is None else drive.main_bearing.bearings


def _of_disc(drive: Drive, path: str) -> tuple[Drive, str]:
    """A field of one disc as the field of a drive of that disc alone."""
    found = numbered(path)
    if found is None:
        return drive, path
    table, number, name = found
    if (problem := no_entry(drive, table, number)) is not None:
        raise DriveError([Problem.of(path, "", problem)])
    if table in LISTED:
        return drive, path
    disc, crank = divmod(number, drive.crank.number) if table == "crank.of" else (number, 0)
    single = single_discs(drive)[disc]
    if table == "crank.of" and (name == "phase_error" or drive.crank.number > 1):
        return single, f"crank.of.{crank}.{name}"
    if name.startswith("bore_errors."):
        return single, f"disc.of.0.{name}"
    own = f"{table}.{ANY}.{name}"
    common = next(known for known, mine in OWN.items() if own == mine or own.startswith(f"{mine}."))
    return single, common + own[len(OWN[common]) :]


def _own_value(single: Drive, crank: int, name: str, count: int | None) -> Any:
    """Errors of the eccentrics and of the bores of one disc, which have no common field."""
    if name.startswith("bore_errors."):
        errors = single.disc.of[0].bore_errors if single.disc.of else None
        held = () if errors is None else getattr(errors, name.partition(".")[2])
        return held or (0.0,) * (count or 0)
    value = getattr(single.crank.eccentric(0, crank), name)
    return single.crank.eccentricity_error if value is None else value


_FOLLOWS = {
    "crank_bearing.roller_length": "roller_length",
    "disc.phases": "disc.disc_phases",
    "pin_shaft.beam.span": "shaft_pin_span",
    "pin_wheel.beam.span": "wheel_pin_span",
    "disc.planes": "disc.disc_planes",
    "pin_shaft.beam.diameter": "pin_shaft.beam_diameter",
    "carrier.posts.length": "post_length",
    "pin_wheel.beam.diameter": "pin_wheel.beam_diameter",
}
"""Fields that follow from others where they are left out, and the property with their value."""


def may_be_left_out(path: str) -> bool:
    """Tell whether a drive may be without a number in a field, such as a radius or a strength; a study may give one to all."""
    field = field_kinds().get(path)
    return field is not None and field.default == LEFT_OUT and not field.is_array and path not in _FOLLOWS


def is_element(name: str) -> bool:
    """Tell whether the last part of a path is the index of an element."""
    return name.isascii() and name.isdigit() and len(name) <= 6


def read_field(drive: Drive, path: str) -> Any:
    """Return the value of a field, as ``disc.thickness``; an array that was left out comes as its zeros.

    The path may end with the index of an element of an array, ``pin_wheel.pin_errors.radial.3``. DriveError when there is
    no such field or element.
    """
    parent, _, last = path.rpartition(".")
    if is_element(last) and field_kind(parent) is not None:
        values = read_field(drive, parent)
        if not isinstance(values, tuple) or int(last) >= len(values):
            raise DriveError([f"{path}: {parent} has no element {last}"])
        return values[int(last)]
    count = element_count(drive, path)
    drive, path = _of_disc(drive, path)
    value: Any
    if (place := numbered(path)) is not None and place[0] in LISTED:
        value = listed_entries(drive, place[0])[place[1]]
        for name in place[2].split("."):
            value = None if value is None else getattr(value, name)
        if value is None:
            raise DriveError([Problem.of(path, "", "is left out in this drive")])
        return value
    if place is not None:
        return _own_value(drive, place[1], place[2], count)
    value = drive if drive.friction is not None else replace(drive, friction=Friction())
    for name in (_FOLLOWS.get(path) or path).split("."):
        value = getattr(value, name)
    if value is None:
        raise DriveError([Problem.of(path, "", "is left out in this drive")])
    if count is not None and not value:
        return (0.0,) * count
    return value
