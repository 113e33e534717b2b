"""Which engine refuses which fields: the one table behind engines, finite elements, validation and the reference pages.

A field that a model cannot represent has a row in `REFUSALS`, and `require` refuses every drive that gives it. The contract
(``tests/contract``, and ``benchmarks/contract.py`` for full finite elements) holds the table against the engines, field by
field.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from operator import attrgetter
from typing import Any

from ltca.drive.declaration import ANY, declared_fields
from ltca.drive.members.width import needs_slices
from ltca.drive.parts import Drive
from ltca.drive.pin_beams import shaft_pin_spring
from ltca.drive.units.table import label
from ltca.errors import DriveError, Problem

ENGINES = {
    "tables": "half-space, tabulated laws (`--method tables`, the default)",
    "direct": "half-space, contact grids (`--method direct`)",
    "paper": "the paper's iteration (`--method paper`)",
    "fe": "plane strain (`--compliance fe`)",
    "hybrid": "half-spaces of finite length on bodies (`--compliance hybrid`)",
    "full FE": "full finite elements (`cyclo fem`, `validate`)",
}
"""Engines that a user can choose, with their descriptions for the reference pages."""
_IN_MESSAGES = {
    "direct": "method direct",
    "paper": "method paper",
    "fe": "compliance fe",
    "hybrid": "compliance hybrid",
    "full FE": "full finite elements",
    "FE mesh": "meshes of full finite elements",
    "clearance-free": "the clearance-free analysis",
    "solid pair": "a pair of solid bodies",
    "solid disc": "discs of solid bodies",
}
"""Names of engines in messages. The last four are no choice of an analysis: ``cyclo mesh``, a reference of the tests, and
``cyclo fem --bodies solid`` with and without ``--pair``."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """A field or table that some engines cannot represent.

    Attributes
    ----------
    path : str
        Of the field or table, with ``N`` for the number of an entry.
    engines : tuple of str
        Engines that refuse it.
    reason : str
        Why, as it stands behind "refused by ENGINE:".
    instead : str or callable
        What to do instead, for the message, or a function that says it of a drive; empty where leaving the field out is all that
        can be done.
    equals : str
        Path of the field whose value is accepted; by default the value of a drive that leaves the field out is.
    accepts : callable, optional
        Further values that are accepted, because they mean the same as leaving the field out.
    """

    path: str
    engines: tuple[str, ...]
    reason: str
    instead: str | Callable[[Drive], str] = ""
    equals: str = ""
    accepts: Callable[[Any], bool] | None = None


def _spring_of_pins(drive: Drive) -> str:
    """The spring that stands in the place of the beams of the shaft pins."""
    spring = shaft_pin_spring(drive)
    if spring is None:
        return "give pin_shaft.stiffness in its place"
    near = f" {spring.accuracy}" if spring.accuracy else ""
    alike = "" if drive.disc.number_of_discs == 1 else ", but lets the discs share the torque alike"
    return f"give pin_shaft.stiffness in its place: {spring.stiffness:g} N/mm turns the output as far{near}{alike}"


_PLANE = ("fe", "full FE")
_TWO_DIMENSIONS = (
    "the model is two-dimensional: nothing varies along the length, and rollers are as long as the disc is thick"
)
_RIGID = ("paper", "full FE", "FE mesh", "clearance-free", "solid pair", "solid disc")
_FIXED = ("direct", *_RIGID)
_WITHOUT_BEAMS = tuple(engine for engine in _FIXED if engine not in ("full FE", "FE mesh"))
_WITHOUT_SUPPORTS = tuple(engine for engine in _RIGID if engine not in ("full FE", "FE mesh"))
_WITHOUT_SPRING = tuple(engine for engine in _WITHOUT_SUPPORTS if engine != "solid disc")
_ONE_BORE = ("paper", "clearance-free")
_HYBRID = "use --compliance hybrid"
_TABLES = "use --method tables"
REFUSALS = (
    Refusal("crank.number", _ONE_BORE, "the model has one crank"),
    Refusal("crank.circle_radius", _ONE_BORE, "the model has one crank"),
    Refusal("crank.angle", _ONE_BORE, "the model has one crank"),
    Refusal("crank.support", _WITHOUT_SUPPORTS, "cranks are rigid in the model"),
    *(
        Refusal(f"crank.support.{name}", ("full FE",), reason)
        for name, reason in (
            ("clearance", "bearings of cranks are linear springs in the model"),
            ("preload", "bearings of cranks are linear springs in the model"),
            ("torsion", "cranks do not twist in the model"),
        )
    ),
    Refusal("pin_wheel.pin_profile", _PLANE, _TWO_DIMENSIONS, _HYBRID, accepts=attrgetter("is_cylinder")),
    Refusal("pin_wheel.axis_offset", ("solid pair",), "wheel and pin shaft have the same axis in the model"),
    Refusal("pin_wheel.support_stiffness", _WITHOUT_SPRING, "the axis of the wheel is fixed in the model"),
    Refusal("pin_wheel.seat", _FIXED, "pins are fixed in the model"),
    Refusal("pin_wheel.beam", _WITHOUT_BEAMS, "pins do not bend in the model"),
    Refusal("first_stage", _RIGID, "the model has no first stage", "give installation.first_stage_ratio"),
    Refusal(f"load.external.{ANY}", _RIGID, "the axis of the wheel is fixed in the model"),
    Refusal("disc.number_of_discs", ("paper",), "the model has one disc"),
    Refusal(f"disc.of.{ANY}.bore_errors", _ONE_BORE, "the model has one crank"),
    Refusal("crank_bearing.roller_length", _PLANE, _TWO_DIMENSIONS, _HYBRID, equals="disc.thickness"),
    Refusal("crank_bearing.roller_profile", _PLANE, _TWO_DIMENSIONS, _HYBRID, accepts=attrgetter("is_cylinder")),
    Refusal("pin_shaft.seat", _FIXED, "pins are fixed in the model"),
    Refusal("pin_shaft.beam", _WITHOUT_BEAMS, "pins do not bend in the model", _spring_of_pins),
    Refusal("main_bearing", _WITHOUT_SUPPORTS, "the axis of the wheel is fixed in the model"),
    *(
        Refusal(f"main_bearing.{name}", ("full FE",), "the main bearing is a linear spring in the model")
        for name in ("clearance", "preload", f"bearings.{ANY}")
    ),
    Refusal("carrier.stiffness_torsion", _WITHOUT_SUPPORTS, "the carrier is rigid in the model"),
    Refusal("carrier.flange", _WITHOUT_SUPPORTS, "the carrier is rigid in the model"),
    Refusal("carrier.posts", _WITHOUT_SUPPORTS, "the carrier is rigid in the model"),
    Refusal("installation.first_stage_ratio", _ONE_BORE, "the model has one crank"),
    Refusal("ring", _ONE_BORE, "the wheel pins stand in a rigid ring in the model"),
    Refusal("friction", _FIXED, "the model is frictionless"),
    Refusal("contact.slices", ("paper",), "discs do not tilt in the model", _TABLES),
    Refusal("contact.slices", ("full FE", "FE mesh"), _TWO_DIMENSIONS),
    Refusal("contact.slices", ("clearance-free",), "discs do not tilt in the model"),
    *(
        Refusal(path, ("solid pair",), "a pair alone does not know by what its members tilt it", "give --tilt")
        for path in (
            "crank.inclination",
            "pin_wheel.inclination",
            "pin_wheel.pin_errors.inclination_x",
            "pin_wheel.pin_errors.inclination_y",
            "pin_shaft.inclination",
            "pin_shaft.pin_errors.inclination_x",
            "pin_shaft.pin_errors.inclination_y",
            "disc.hole_errors.inclination_x",
            "disc.hole_errors.inclination_y",
            f"disc.of.{ANY}.hole_errors.inclination_x",
            f"disc.of.{ANY}.hole_errors.inclination_y",
        )
    ),
    Refusal("disc.axial_play", ("solid pair",), "the disc is not a part of the model"),
)
"""Everything that an engine refuses, in the order of the definition of a drive."""
ROUNDING = 1e-9
"""Relative difference up to which two lengths are equal."""


def require(drive: Drive, engine: str) -> None:
    """Refuse a drive with anything that an engine cannot represent: DriveError with one sentence for each field.

    Examples
    --------
    >>> from ltca.reading.changes import with_fields
    >>> from ltca.reading.drive_file import load_drive
    >>> require(with_fields(load_drive("paper").cases["CS-1"], {"crank_bearing.roller_length": 8.0}), "hybrid")
    """
    rows = [row for row in REFUSALS if engine in row.engines]
    problems = [problem for row in rows for problem in _problems(drive, row, engine)]
    if problems:
        raise DriveError(problems)


def refusal(engine: str, path: str) -> str | None:
    """Return why an engine refuses a field; None where it takes it.

    Examples
    --------
    >>> refusal("full FE", "friction.pin")
    'the model is frictionless'
    >>> refusal("fe", "disc.thickness")
    """
    rows = (row for row in REFUSALS if engine in row.engines)
    return next((row.reason for row in rows if _covers(row, path)), None)


def refusals(path: str) -> dict[str, list[str]]:
    """Return the engines that refuse a field, by reason."""
    found: dict[str, list[str]] = {}
    for engine in ENGINES:
        if (reason := refusal(engine, path)) is not None:
            found.setdefault(reason, []).append(engine)
    return found


def _covers(row: Refusal, path: str) -> bool:
    of_slices = row.path == "contact.slices" and needs_slices(path)
    return path == row.path or path.startswith(f"{row.path}.") or of_slices


def _problems(drive: Drive, row: Refusal, engine: str) -> Iterator[Problem]:
    """One sentence for every place where a drive gives what a row refuses."""
    for path, value, default in given(drive, row.path.split(".")):
        bound, unit = "left out", unit_of(row.path)
        number: float | None = None
        if row.equals and value is None:
            continue
        if row.equals:
            ((_, accepted, _),) = given(drive, row.equals.split("."))
            if abs(value - accepted) <= ROUNDING * accepted:
                continue
            bound, number = f"{accepted:g}{unit} ({row.equals})", accepted
        elif value == default or (row.accepts is not None and row.accepts(value)):
            continue
        elif default is not None and default != () and not is_dataclass(default):
            bound, number = f"{default:g}{unit}", default
        held = f"({_contents(path, value, row.path)})" if is_dataclass(value) else f"= {shown(value)}{unit}"
        instead = row.instead if isinstance(row.instead, str) else row.instead(drive)
        instead = f"; {instead}" if instead else ""
        yield Problem.of(
            path,
            held,
            f"must be {bound} for {_IN_MESSAGES[engine]} ({row.reason}){instead}",
            bound=None if number is None else ("equal to", number),
        )


def given(part: Any, names: Sequence[str], above: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield path, value and default of a field, of every entry where its path has ``N``; nothing where its table is left out."""
    name, *below = names
    value, path = getattr(part, name), f"{above}{name}"
    if not below:
        yield path, value, _default(part, name)
    elif below[0] == ANY:
        for number, entry in enumerate(value):
            if below[1:]:
                yield from given(entry, below[1:], f"{path}.{number}.")
            else:
                yield f"{path}.{number}", entry, None
    elif value is not None:
        yield from given(value, below, f"{path}.")


def _default(part: Any, name: str) -> Any:
    item = next(item for item in fields(part) if item.name == name)
    return item.default_factory() if item.default_factory is not MISSING else item.default


def _contents(path: str, table: Any, declared: str) -> str:
    """Fields of a table with their values where they differ from the default; all names where none does."""
    changed = ", ".join(_changes(path, table, declared))
    return changed or ", ".join(f"{path}.{item.name}" for item in fields(table))


def _changes(path: str, table: Any, declared: str) -> Iterator[str]:
    """Fields of a table that differ from their defaults, those of tables and entries in it as well."""
    for item in fields(table):
        value, own, name = getattr(table, item.name), f"{path}.{item.name}", f"{declared}.{item.name}"
        if value == _default(table, item.name):
            continue
        if is_dataclass(value):
            yield from _changes(own, value, name)
        elif isinstance(value, tuple) and value and is_dataclass(value[0]):
            for number, entry in enumerate(value):
                yield from _changes(f"{own}.{number}", entry, f"{name}.{ANY}")
        else:
            yield f"{own} = {shown(value)}{unit_of(name)}"


def shown(value: Any) -> str:
    """Return a value of a field as messages print it."""
    if is_dataclass(value):
        return f"{{{', '.join(f'{item.name} = {shown(getattr(value, item.name))}' for item in fields(value))}}}"
    if isinstance(value, tuple):
        return f"[{', '.join(shown(each) for each in value)}]"
    return f'"{value}"' if isinstance(value, str) else f"{value:g}"


def unit_of(path: str) -> str:
    """Return the unit of a field as it stands behind its value."""
    declared = declared_fields().get(path)
    return f" {label(declared.unit)}".rstrip() if declared is not None else ""
