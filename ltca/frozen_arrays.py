"""Results that stay as they were returned: a copy of a result whose arrays, nested ones too, are read-only."""

from __future__ import annotations

import copy
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import numpy as np

Result = TypeVar("Result")


def freeze(result: Result) -> Result:
    """Return a result with read-only arrays: nothing that is done later, here or by the caller, changes it.

    Arrays are copied, since a view or an array of the caller's could be written through its other name; those that
    are read-only already are shared. So is everything that holds no writable array, and an array that stands in
    several places of the result still stands there once.

    Parameters
    ----------
    result : dataclass instance, array, or tuple of these
        Nested as deep as you like. Lists, dictionaries and other objects in it are passed through untouched, and so
        are the objects in an array of objects.

    Returns
    -------
    same type
        The result itself where nothing in it could be written.

    Examples
    --------
    >>> values = np.zeros(2)
    >>> kept = freeze((values, "N"))
    >>> values[0] = 1.0
    >>> kept
    (array([0., 0.]), 'N')
    >>> kept[0][0] = 1.0
    Traceback (most recent call last):
    ...
    ValueError: assignment destination is read-only
    """
    frozen: Result = _frozen(result, {})
    return frozen


def _frozen(value: Any, known: dict[int, Any]) -> Any:
    """The frozen form of a value; `known` holds those of the arrays and dataclasses met so far, by identity."""
    if isinstance(value, np.ndarray):
        if id(value) not in known:
            known[id(value)] = _read_only(value)
        return known[id(value)]
    if isinstance(value, tuple):
        items = [_frozen(item, known) for item in value]
        if all(new is old for new, old in zip(items, value, strict=True)):
            return value
        return type(value)(*items) if hasattr(value, "_fields") else tuple(items)
    if is_dataclass(value) and not isinstance(value, type):
        if id(value) not in known:
            known[id(value)] = _frozen_fields(value, known)
        return known[id(value)]
    return value


def _frozen_fields(value: Any, known: dict[int, Any]) -> Any:
    # Fields that an __init__ sets by itself may be missing from an instance: left missing.
    held = {item.name: getattr(value, item.name) for item in fields(value) if hasattr(value, item.name)}
    changed = {name: new for name, old in held.items() if (new := _frozen(old, known)) is not old}
    if not changed:
        return value
    # Not `replace`: the values are the same, nothing has to be checked or derived again.
    fresh = copy.copy(value)
    for name, new in changed.items():
        object.__setattr__(fresh, name, new)
    return fresh


def _read_only(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    owner: Any = array
    while isinstance(owner, np.ndarray) and not owner.flags.writeable:
        if owner.base is None:
            return array
        owner = owner.base
    fresh = array.copy(order="K")
    fresh.flags.writeable = False
    return fresh
