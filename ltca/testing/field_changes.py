"""One sensible change for every leaf field of a drive: what the contract is walked with.

The contract says that every field of a drive is used by every model and command, or refused by name. So each leaf
field is changed by an amount that a person could have meant, and the answer has to move or the field's name has to
come up in a `DriveError`.
"""

from __future__ import annotations

from typing import Any

from ltca.drive.fields import element_count, field_kinds, read_field
from ltca.drive.parts import Drive

# Fields whose change must be a small one, or the drive stops being a drive: mm, as a part of the value.
_CLOSE = {
    "crank.eccentricity": 0.999,
    "pin_wheel.pin_circle_radius": 1.0005,
    "crank_bearing.inner_race_radius": 0.9995,
    "crank_bearing.outer_race_radius": 1.0005,
    "crank_bearing.roller_radius": 0.9995,
    "pin_shaft.pin_radius": 0.999,
    "pin_shaft.hole_radius": 1.001,
    "pin_shaft.pin_circle_radius": 1.002,
    "pin_wheel.pin_radius": 0.9995,
}
_COUNTS = {
    "pin_wheel.number_of_pins": 1,
    "disc.number_of_teeth": 1,
    "disc.number_of_discs": 1,
    "crank_bearing.number_of_rollers": -1,
    "pin_shaft.number_of_pins": 1,
}
_FROM_ZERO = {"mm": 1e-3, "rad": 0.3, "dimensionless": 0.5}
_OTHER_WORD = {"load.direction": {"ccw": "cw", "cw": "ccw"}}


def leaf_fields() -> tuple[str, ...]:
    """Return the dotted paths of all leaf fields of a drive."""
    return tuple(field_kinds())


def sensible_change(drive: Drive, path: str) -> Any:
    """Return another value for a field, one that a person could have meant.

    Parameters
    ----------
    drive : Drive
        The drive to change.
    path : str
        One of `leaf_fields`.

    Returns
    -------
    value
        For `ltca.reading.changes.with_fields`; it may make the drive unsound, which then has to be said by name.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> sensible_change(drive, "load.direction")
    'cw'
    >>> sensible_change(drive, "crank.axis_offset.x")
    0.001
    """
    value, kind = read_field(drive, path), field_kinds()[path]
    if path == "name":
        return f"{value} too"
    if path in _OTHER_WORD:
        return _OTHER_WORD[path][value]
    if path in _COUNTS:
        return value + _COUNTS[path]
    if kind.is_array:
        return _changed_array(drive, path, list(value))
    if path in _CLOSE:
        return value * _CLOSE[path]
    if path.endswith("roller_length"):
        return 0.8 * value
    if value == 0.0:
        return _FROM_ZERO.get(kind.unit, 1.0)
    return 0.9 * value


def _changed_array(drive: Drive, path: str, values: list[Any]) -> tuple[Any, ...]:
    if path == "disc.profile_errors.orders":
        return (values[0] + 1, *values[1:]) if values else (2,)
    if path == "disc.profile_errors.parameter":
        return (*values[:-1], values[-1] + 0.1) if values else ()
    count = element_count(drive, path)
    # Of each part another amount: a circle that shifts or grows as a whole could hide in a free motion.
    step = _FROM_ZERO["mm"]
    return tuple(value + step * (1.0 if number % 2 else -0.6) for number, value in enumerate(values[: count or 0]))
