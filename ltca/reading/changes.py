"""A drive with some fields replaced, validated like a drive file."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import is_dataclass, replace
from typing import Any

from pydantic import ValidationError

from ltca.drive.fields import field_kinds, is_element, read_field
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.parts import Drive
from ltca.drive.units import even_share
from ltca.errors import DriveError, did_you_mean
from ltca.reading.physical_checks import find_contradictions


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
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> with_fields(drive, {"crank.axis_offset.x": 0.01}).crank.axis_offset.x
    0.01
    """
    tree: dict[str, Any] = {}
    even = abs(drive.disc.torque_share * drive.disc.number_of_discs - 1.0) < 1e-12  # not a share of its own
    if "disc.number_of_discs" in values and "disc.torque_share" not in values and even:  # as in a drive file
        with suppress(ValueError):
            values = {**values, "disc.torque_share": even_share(values["disc.number_of_discs"])}
    arrays: dict[str, list[Any]] = {}
    whole = {}
    for path, value in values.items():
        parent, _, last = path.rpartition(".")
        if is_element(last) and parent in field_kinds():
            if parent not in arrays:
                arrays[parent] = list(values.get(parent, read_field(drive, parent)))
            if int(last) >= len(arrays[parent]):
                raise DriveError([f"{path}: {parent} has no element {last}"])
            arrays[parent][int(last)] = value
        elif path not in field_kinds():
            raise DriveError([f"{path}: is not a field of the drive definition{did_you_mean(path, field_kinds())}"])
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
        problems += describe_mistakes(error.errors(), prefix.rstrip(".").split(".") if prefix else ())
        return part
