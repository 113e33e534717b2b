"""Trees of arrays: dataclasses and tuples of arrays whose axis 0 is the position, of which positions are taken, put and joined.

And results that stay as they were returned: a copy of a tree whose arrays are read-only.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

Result = TypeVar("Result")

_NAMES: dict[type[Any], tuple[str, ...]] = {}
"""Fields of the types met so far: `dataclasses.fields` costs as much as a small array."""


def map_arrays(function: Callable[..., Any], *trees: Any) -> Any:
    """Return a tree with every array, of one axis at least, replaced by a function of it and of those in its place elsewhere.

    Parameters
    ----------
    function : callable
        Of as many arrays as there are trees.
    trees : dataclass instance, tuple or array
        All alike, nested as deep as you like; anything else in the first is left as it is.

    Examples
    --------
    >>> map_arrays(np.add, (np.ones(2), "N"), (np.arange(2), "N"))
    (array([1., 2.]), 'N')
    """
    return _mapped(function, trees, {})


def _mapped(function: Callable[..., Any], trees: tuple[Any, ...], known: dict[tuple[int, ...], Any]) -> Any:
    """A tree mapped; what stands in it twice, as in a reducer of one disc, is mapped once."""
    first = trees[0]
    kind = type(first)
    if kind is np.ndarray and not first.ndim:
        return first
    names = () if kind is np.ndarray else _field_names(kind)
    if kind is np.ndarray or names:
        place = tuple(map(id, trees))
        if place not in known:
            if not names:
                known[place] = function(*trees)
            else:
                known[place] = fresh = object.__new__(kind)
                for name in names:
                    value = _mapped(function, tuple([getattr(tree, name) for tree in trees]), known)
                    object.__setattr__(fresh, name, value)
        return known[place]
    if isinstance(first, tuple):
        items = [_mapped(function, each, known) for each in zip(*trees, strict=True)]
        return kind(*items) if hasattr(first, "_fields") else tuple(items)
    return first


def _field_names(kind: type[Any]) -> tuple[str, ...]:
    """Names of the fields of a dataclass; none of another type."""
    if kind not in _NAMES:
        _NAMES[kind] = tuple(item.name for item in fields(kind)) if is_dataclass(kind) else ()
    return _NAMES[kind]


def take_positions(tree: Result, rows: NDArray[np.intp] | NDArray[np.bool_]) -> Result:
    """Return what belongs to some of the positions."""
    numbers = np.nonzero(rows)[0] if rows.dtype == bool else rows
    found: Result = map_arrays(lambda array: array.take(numbers, axis=0), tree)
    return found


def put_positions(tree: Result, rows: NDArray[np.intp], other: Result) -> Result:
    """Return a copy with some positions taken from another tree, which has just these."""

    def put(array: NDArray[Any], fresh: NDArray[Any]) -> NDArray[Any]:
        found = array.copy()
        found[rows] = fresh
        return found

    found: Result = map_arrays(put, tree, other)
    return found


def join_positions(trees: Sequence[Result]) -> Result:
    """Return the positions of several trees as those of one, tree after tree."""
    found: Result = trees[0] if len(trees) == 1 else map_arrays(lambda *arrays: np.concatenate(arrays), *trees)
    return found


def spread_positions(tree: Result, rows: NDArray[np.intp], positions: int) -> Result:
    """Return what belongs to some of the positions as that of all: no numbers, None or zeros elsewhere."""

    def spread(array: NDArray[Any]) -> NDArray[Any]:
        if array.shape[0] != rows.size:
            return array
        empty: Any = {"f": np.nan, "c": np.nan, "O": None}.get(array.dtype.kind, 0)
        whole = np.full((positions, *array.shape[1:]), empty, dtype=array.dtype)
        whole[rows] = array
        return whole

    found: Result = map_arrays(spread, tree)
    return found


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
