"""Fields of a drive by dotted path: read, count, unit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, is_dataclass
from functools import cache
from typing import Annotated, Any, cast, get_args, get_origin, get_type_hints

from pydantic.functional_validators import BeforeValidator

from ltca.drive.parts import Drive
from ltca.drive.units import QuantityCheck
from ltca.errors import DriveError, did_you_mean


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


def _kinds(owner: Any, prefix: str) -> Iterator[tuple[str, FieldKind]]:
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
        raise DriveError([f"{path}: is not a field of the drive definition{did_you_mean(path, field_kinds())}"])
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


def is_element(name: str) -> bool:
    """Tell whether the last part of a path is the number of an element."""
    return name.isascii() and name.isdigit() and len(name) <= 6


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
    if is_element(last) and parent in field_kinds():
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
