"""Trees of arrays: nested dataclasses and tuples that are mapped, stacked and frozen as a whole.

Results have the position on axis 0 of every array: positions are taken, put, joined and spread. Models of a drive say which
of their fields may differ from drive to drive (`by_drive`); models that agree in everything else are stacked to that of a
batch, in which what differs gets the positions as its first axis and what is equal stays as it is. Frozen results are copies
whose arrays are read-only.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import field, fields, is_dataclass, replace
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


EQUAL_PARTS = 1e-9
"""Relative difference up to which values of equal parts are equal: more than round-off, less than any physical difference."""


def place_of_largest(values: FloatArray) -> tuple[int, ...]:
    """Return the first place at which values are the largest, round-off aside; what is not a number is left out.

    Of equal parts the last bit would decide, and another machine would name another part.

    Examples
    --------
    >>> place_of_largest(np.array([[1.0, 3.0], [3.0 * (1.0 + 1e-15), np.nan]]))
    (0, 1)
    """
    largest = float(np.nanmax(values))
    least = largest - EQUAL_PARTS * abs(largest) if np.isfinite(largest) else largest
    return tuple(map(int, np.unravel_index(np.flatnonzero(values >= least)[0], values.shape)))


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


def by_drive(axes: int, **options: Any) -> Any:
    """Return a dataclass field for numbers that may differ between the drives of a batch.

    Parameters
    ----------
    axes : int
        Number of axes for one drive. In a batch an array has the positions as one more in front, and a single number becomes
        a column, shape (positions, 1).
    options
        Of `dataclasses.field`.
    """
    return field(metadata={"axes": axes}, **options)


_AXES: dict[type[Any], tuple[tuple[str, int | None], ...]] = {}
"""Names of the fields of the dataclasses met so far, with the axes given to `by_drive`."""


def _declared(kind: type[Any]) -> tuple[tuple[str, int | None], ...]:
    """Names of the fields of a dataclass with their axes for one drive, None for those that are equal in a batch."""
    if kind not in _AXES:
        known = fields(kind) if is_dataclass(kind) else ()
        _AXES[kind] = tuple((item.name, item.metadata.get("axes")) for item in known if item.init)
    return _AXES[kind]


def has_rows(model: Any, axes: int | None = None) -> bool:
    """Tell whether something in a model differs from position to position; `axes` are those of the field it stands in."""
    kind = type(model)
    if axes is not None:
        return kind is np.ndarray and model.ndim > axes
    if kind is tuple:
        return any(has_rows(item) for item in model)
    return any(has_rows(getattr(model, name), own) for name, own in _declared(kind))


def take_rows(model: Result, rows: NDArray[np.intp] | NDArray[np.bool_], axes: int | None = None) -> Result:
    """Return the model of some positions of a batch; the model itself where all its positions are of one drive."""
    value: Any = model
    if axes is not None:
        found: Result = value[rows] if has_rows(value, axes) else value
        return found
    if type(value) is tuple:
        items = tuple(take_rows(item, rows) for item in value)
        return model if all(new is old for new, old in zip(items, value, strict=True)) else items  # type: ignore[return-value]
    changed = {}
    for name, own in _declared(type(value)):
        old = getattr(value, name)
        if (new := take_rows(old, rows, own)) is not old:
            changed[name] = new
    return replace(value, **changed) if changed else model


def batch_layout(model: Any, known: dict[int, Hashable] | None = None) -> Hashable:
    """Return what models must agree in to be stacked: shapes of what may differ, and the values of everything else.

    Parameters
    ----------
    model : dataclass instance
        Of one drive.
    known : dict, optional
        Layouts of parts met before, by identity, for models that share parts; they must outlive it.
    """
    return _layout(model, {} if known is None else known)


def _layout(value: Any, known: dict[int, Hashable]) -> Hashable:
    kind = type(value)
    if kind is tuple:
        return tuple([_layout(item, known) for item in value])
    if kind is np.ndarray:
        return value.shape, value.tobytes()
    names = _declared(kind)
    if all(own is None for _, own in names):
        try:
            hash(value)  # what holds nothing but plain values says itself what it is
        except TypeError:
            if not names:
                return id(value)
        else:
            plain: Hashable = value
            return plain
    if id(value) not in known:
        parts: list[Any] = [kind]
        for name, own in names:
            part = getattr(value, name)
            parts.append(_layout(part, known) if own is None else getattr(part, "shape", ()))
        known[id(value)] = tuple(parts)
    return known[id(value)]


def stack_drives(models: Sequence[Result], positions: int) -> Result:
    """Return the model of several drives as a batch.

    Parameters
    ----------
    models : sequence of dataclass instances
        Of one `batch_layout`, one for each drive.
    positions : int
        Of each drive: drive s takes the rows s·positions … (s + 1)·positions − 1.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Pins:
    ...     radii: FloatArray = by_drive(1)
    ...     circle: float = by_drive(0)
    >>> models = [Pins(np.array([5.0, 5.0]), 88.0), Pins(np.array([5.0, 5.1]), 88.0)]
    >>> stack_drives(models, 1)
    Pins(radii=array([[5. , 5. ],
           [5. , 5.1]]), circle=88.0)
    """
    found: Result = _stacked(tuple(models), None, positions)
    return found


def _stacked(values: tuple[Any, ...], axes: int | None, positions: int) -> Any:
    first = values[0]
    if axes is not None:
        rows = np.array(values)
        if (rows == rows[:1]).all():
            return first
        return np.repeat(rows if rows.ndim > 1 else rows[:, None], positions, axis=0)
    if all(value is first for value in values):
        return first
    if type(first) is tuple:
        return tuple(_stacked(items, None, positions) for items in zip(*values, strict=True))
    changed = {}
    for name, own in _declared(type(first)):
        old = tuple([getattr(value, name) for value in values])
        if (new := _stacked(old, own, positions)) is not old[0]:
            changed[name] = new
    return replace(first, **changed) if changed else first


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


def named_arrays(tree: Any, name: str) -> dict[str, NDArray[Any]]:
    """Return every array and number of a tree by a name of its own, which begins with `name`; None has none.

    `with_named_arrays` is the inverse.

    Examples
    --------
    >>> named_arrays((np.ones(1), None, 2.0), "start")
    {'start.0': array([1.]), 'start.2': array(2.)}
    """
    if tree is None:
        return {}
    parts = _parts(tree)
    if parts is None:
        return {name: np.asarray(tree)}
    named: dict[str, NDArray[Any]] = {}
    for key, part in parts.items():
        named |= named_arrays(part, f"{name}.{key}")
    return named


def with_named_arrays(like: Any, arrays: Mapping[str, NDArray[Any]], name: str) -> Any:
    """Return a tree like another one with the arrays of `named_arrays`.

    Raises
    ------
    ValueError
        Where one is missing, or has another shape or kind.
    """
    if like is None:
        return None
    parts = _parts(like)
    if parts is None:
        old, new = np.asarray(like), arrays.get(name)
        if new is None or new.shape != old.shape or new.dtype.kind != old.dtype.kind:
            raise ValueError(f"{name}: there is none of shape {old.shape}")
        return new if isinstance(like, np.ndarray) else new.item()
    made = {key: with_named_arrays(part, arrays, f"{name}.{key}") for key, part in parts.items()}
    if isinstance(like, np.ndarray):
        objects = np.empty(like.size, dtype=object)
        objects[:] = list(made.values())
        return objects.reshape(like.shape)
    if isinstance(like, tuple):
        return tuple(made.values()) if type(like) is tuple else type(like)(*made.values())
    return replace(like, **made)


def _parts(tree: Any) -> dict[str, Any] | None:
    """Parts of a dataclass, a tuple or an array of objects by name; None for an array and a number."""
    if isinstance(tree, np.ndarray):
        return None if tree.dtype != object else {str(place): part for place, part in enumerate(tree.ravel())}
    if isinstance(tree, tuple):
        return {str(place): part for place, part in enumerate(tree)}
    if isinstance(tree, float | int):
        return None
    return {name: getattr(tree, name) for name in _field_names(type(tree))}
