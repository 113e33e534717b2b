"""Fields of a drive by dotted path: read, replace, count, unit; and a drive as the text of a drive file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from typing import Annotated, Any, cast, get_args, get_origin, get_type_hints

from pydantic import ValidationError
from pydantic.functional_validators import BeforeValidator

from ltca.drive import Drive
from ltca.drive_checks import find_contradictions
from ltca.errors import DriveError
from ltca.units import QuantityCheck


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldKind:
    """What the definition says about one field.

    Attributes
    ----------
    unit : str
        Unit of a quantity, ``""`` for counts and names, ``"dimensionless"`` for ratios.
    is_array : bool
        Whether it holds one number for each pin, hole, roller, order or point.
    """

    unit: str
    is_array: bool


@cache
def field_kinds() -> dict[str, FieldKind]:
    """Return every field of a drive by its dotted path.

    Examples
    --------
    >>> field_kinds()["disc.thickness"]
    FieldKind(unit='mm', is_array=False)
    """
    return dict(_kinds(Drive, ""))


def _kinds(owner: type, prefix: str) -> Iterator[tuple[str, FieldKind]]:
    for name, hint in get_type_hints(owner, include_extras=True).items():
        path = f"{prefix}{name}"
        if is_dataclass(hint):
            yield from _kinds(cast(type, hint), f"{path}.")
            continue
        is_array = get_origin(hint) is tuple
        yield path, FieldKind(unit=_unit(get_args(hint)[0] if is_array else hint), is_array=is_array)


def _unit(hint: Any) -> str:
    if get_origin(hint) is Annotated:
        for extra in get_args(hint)[1:]:
            if isinstance(extra, BeforeValidator) and isinstance(extra.func, QuantityCheck):
                return extra.func.unit
    return ""


def element_count(drive: Drive, path: str) -> int | None:
    """Return how many numbers an array field has when filled; None for a single number.

    Raises
    ------
    DriveError
        When there is no such field.
    """
    kind = field_kinds().get(path)
    if kind is None:
        raise DriveError([f"{path}: is not a field of the drive definition"])
    if not kind.is_array:
        return None
    errors = drive.disc.profile_errors
    counts = {
        "pin_wheel.pin_errors": drive.pin_wheel.number_of_pins,
        "disc.hole_errors": drive.pin_shaft.number_of_pins,
        "pin_shaft.pin_errors": drive.pin_shaft.number_of_pins,
        "crank_bearing.roller_errors": drive.crank_bearing.number_of_rollers,
        "disc.profile_errors": len(errors.parameter) if path.endswith(".deviation") else len(errors.orders),
    }
    return counts[path.rpartition(".")[0]]


def read_field(drive: Drive, path: str) -> Any:
    """Return the value of a field; an array that was left out comes as its zeros.

    Parameters
    ----------
    drive : Drive
        The drive.
    path : str
        ``disc.thickness``, ``pin_wheel.pin_errors.radial``, or one element of an array, ``….radial.3``.

    Raises
    ------
    DriveError
        When there is no such field or element.
    """
    parent, _, last = path.rpartition(".")
    if last.isdigit() and parent in field_kinds():
        values = read_field(drive, parent)
        if not isinstance(values, tuple) or int(last) >= len(values):
            raise DriveError([f"{path}: {parent} has no element {last}"])
        return values[int(last)]
    count = element_count(drive, path)
    value: Any = drive
    for name in path.split("."):
        value = getattr(value, name)
    if count is not None and not value:
        return (0.0,) * count
    return value


def with_fields(drive: Drive, values: Mapping[str, Any], *, check: bool = True) -> Drive:
    """Return a drive with some fields replaced, validated like a drive file.

    Parameters
    ----------
    drive : Drive
        The drive to start from.
    values : mapping of str to value
        New values by dotted path, see `read_field`.
    check : bool
        Whether to look for physical contradictions as well.

    Raises
    ------
    DriveError
        When a path is no field or a value or the whole is wrong; all mistakes together.

    Examples
    --------
    >>> from ltca.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> with_fields(drive, {"crank.axis_offset.x": 0.01}).crank.axis_offset.x
    0.01
    """
    tree: dict[str, Any] = {}
    if "disc.number_of_discs" in values and "disc.torque_share" not in values:  # as in a drive file
        values = {**values, "disc.torque_share": 1.0 / max(1, int(values["disc.number_of_discs"]))}
    arrays: dict[str, list[Any]] = {}
    whole = {}
    for path, value in values.items():
        parent, _, last = path.rpartition(".")
        if last.isdigit() and parent in field_kinds():
            if parent not in arrays:
                arrays[parent] = list(values.get(parent, read_field(drive, parent)))
            if int(last) >= len(arrays[parent]):
                raise DriveError([f"{path}: {parent} has no element {last}"])
            arrays[parent][int(last)] = value
        elif path not in field_kinds():
            raise DriveError([f"{path}: is not a field of the drive definition"])
        else:
            whole[path] = value
    for path, value in {**whole, **{name: tuple(row) for name, row in arrays.items()}}.items():
        branch = tree
        *above, name = path.split(".")
        for step in above:
            branch = branch.setdefault(step, {})
        branch[name] = value
    problems: list[str] = []
    changed: Drive = _replaced(drive, tree, "", problems)
    if not problems and check:
        problems += find_contradictions(changed)
    if problems:
        raise DriveError(problems)
    return changed


def _replaced(part: Any, tree: dict[str, Any], prefix: str, problems: list[str]) -> Any:
    changes = {}
    for name, value in tree.items():
        below = getattr(part, name)
        nested = isinstance(value, dict) and is_dataclass(below)
        changes[name] = _replaced(below, value, f"{prefix}{name}.", problems) if nested else value
    try:
        return replace(part, **changes)
    except ValidationError as error:
        from ltca.drive_file import describe_mistake

        for detail in error.errors():
            detail["loc"] = (*prefix.rstrip(".").split("."), *detail["loc"]) if prefix else detail["loc"]
            problems.append(describe_mistake(detail))
        return part


def drive_text(drive: Drive) -> str:
    """Return a drive as the text of a drive file that reads back as the same drive, bit for bit.

    Examples
    --------
    >>> from ltca.drive_file import load_drive, parse_drive
    >>> drive = load_drive("paper").cases["CS-3"]
    >>> parse_drive(drive_text(drive)).cases["nominal"] == drive
    True
    """
    lines: list[str] = []
    _write_table(drive, "", lines)
    return "\n".join(lines).strip() + "\n"


def _write_table(part: Any, path: str, lines: list[str]) -> None:
    inner = []
    if path:
        lines.append(f"\n[{path}]")
    for item in fields(part):
        value = getattr(part, item.name)
        if is_dataclass(value):
            inner.append((f"{path}.{item.name}" if path else item.name, value))
        elif value != ():
            lines.append(f"{item.name} = {_literal(value)}")
    for name, value in inner:
        _write_table(value, name, lines)


def _literal(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_literal(item) for item in value) + "]"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    return repr(value)
