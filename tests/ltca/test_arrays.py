"""Frozen results: no name of theirs, of the caller's or of a view writes into them."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass
from typing import NamedTuple

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.arrays import freeze
from ltca.compliance.response import ContactPressures, KindPressures
from ltca.reading.drive_file import load_drive


@dataclass(frozen=True, slots=True, kw_only=True)
class Inner:
    load: np.ndarray
    note: str = "N"


@dataclass(frozen=True)
class Outer:
    inner: Inner
    pairs: tuple
    angle: np.ndarray
    history: list = field(default_factory=list)


class Corner(NamedTuple):
    place: np.ndarray
    name: str


def arrays(value):
    """Every array of a result, however deep."""
    if isinstance(value, np.ndarray):
        return [value]
    if isinstance(value, tuple):
        return [array for item in value for array in arrays(item)]
    if hasattr(value, "__dataclass_fields__"):
        return [array for item in fields(value) for array in arrays(getattr(value, item.name))]
    return []


def test_no_array_of_a_nested_result_can_be_written():
    angle = np.arange(3.0)
    given = Outer(Inner(load=np.ones((2, 2))), (np.zeros(2), Corner(np.zeros(1), "pin")), angle)
    frozen = freeze(given)
    assert len(arrays(frozen)) == 4
    for array in arrays(frozen):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 7.0
    assert isinstance(frozen.pairs[1], Corner)
    assert frozen.history is given.history  # passed through, as documented


def test_what_the_caller_writes_later_does_not_arrive():
    whole = np.arange(6.0)
    frozen = freeze(Inner(load=whole[:3]))
    whole[:] = -1.0
    np.testing.assert_array_equal(frozen.load, [0.0, 1.0, 2.0])


def test_the_arrays_given_stay_writable():
    load = np.ones(2)
    freeze(Inner(load=load))
    load[0] = 2.0
    assert load[0] == 2.0


def test_a_read_only_view_of_a_writable_array_is_copied():
    whole = np.arange(3.0)
    view = whole[:]
    view.flags.writeable = False
    frozen = freeze(Inner(load=view))
    whole[0] = 5.0
    assert frozen.load[0] == 0.0


def test_freezing_twice_changes_nothing_and_copies_nothing():
    once = freeze(Outer(Inner(load=np.ones(2)), (), np.zeros(1)))
    assert freeze(once) is once


def test_what_holds_no_array_is_shared():
    shared = Corner("no array", "pin")
    assert freeze(shared) is shared
    assert freeze(Outer(None, (), np.zeros(1))).pairs == ()


def test_an_array_in_two_places_stays_one():
    mid = np.ones((1, 2))
    pins = KindPressures(mid=mid, largest=mid, half_width=np.ones((1, 2)), end_cell=0.1)
    frozen = freeze(ContactPressures(pins=pins, outer=pins, inner=pins, holes=pins, rigid_shaft_pins=False))
    assert frozen.pins.mid is frozen.pins.largest
    assert frozen.pins is frozen.outer
    assert type(frozen) is ContactPressures
    with pytest.raises(ValueError, match="read-only"):
        frozen.pins.mid[0, 0] = 0.0


def declared_axes(model, known):
    """Fields of a model that may differ by drive: class, name, axes as declared and axes as they are."""
    if id(model) in known:
        return
    known[id(model)] = model
    if isinstance(model, tuple):
        for item in model:
            yield from declared_axes(item, known)
    elif is_dataclass(model) and not isinstance(model, type):
        for item in fields(model):
            value, axes = getattr(model, item.name), item.metadata.get("axes")
            if axes is None:
                yield from declared_axes(value, known)
            elif value is not None:
                yield type(model).__name__, item.name, axes, np.ndim(value)


@pytest.mark.parametrize("name", ["paper", "rv"])
def test_numbers_that_differ_by_drive_have_the_declared_axes_in_one_drive(name):
    """A number too many would pass: columns of a batch have two axes, of which one is enough to be seen."""
    drive = next(iter(load_drive(name).cases.values()))
    found = [*declared_axes(HalfSpace().prepare(drive).model, {})]
    assert ("FlankProfile", "centre", 0, 0) in found
    assert [one for one in found if one[2] != one[3]] == []
