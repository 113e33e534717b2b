"""Quantities with units: conversion, bounds, messages."""

from __future__ import annotations

import math
from typing import Annotated

import pytest
from pydantic import TypeAdapter, ValidationError

from ltca.drive.units import parse_quantity, quantity
from ltca.errors import DriveError


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("377.3 N m", "N*mm", 377_300.0),
        ("0.3773 kN*m", "N*mm", 377_300.0),
        ("206 GPa", "MPa", 206_000.0),
        ("2 in", "mm", 50.8),
        ("90 µm", "mm", 0.09),
        ("1000 N/um", "N/mm", 1e6),
        ("20 deg", "rad", math.radians(20.0)),
        ("12.5", "mm", 12.5),
        ("-4e-1", "rad", -0.4),
    ],
)
def test_conversion(text, unit, value):
    assert parse_quantity(text, unit, "--x") == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("3 kg", "mm", "not known; it must have the unit mm"),
        ("3 mm", "N*mm", "must have the unit N·mm"),
        ("three", "mm", "mm"),
        ("", "mm", "not a quantity"),
        ("3 +", "mm", "not a quantity"),
        ("nan", "rad", "must be finite in rad"),
        ("inf", "rad", "must be finite in rad"),
        ("1e400", "rad", "must be finite in rad"),
        ("[1, 2]", "mm", "mm"),
        ("__import__('os')", "mm", "not a quantity"),
    ],
)
def test_what_is_no_quantity_is_refused_with_its_name(text, unit, words):
    with pytest.raises(DriveError, match=words) as caught:
        parse_quantity(text, unit, "--torque")
    assert caught.value.problems[0].startswith(f"--torque = {text!r}: ")


def validate(value, **bounds):
    return TypeAdapter(Annotated[float, quantity("mm", **bounds)]).validate_python(value)


def test_bounds_are_where_they_are_said_to_be():
    assert validate(0.0, ge=0.0) == 0.0
    assert validate(1.0, le=1.0) == 1.0
    assert validate("0.01 m", lt=10.1) == 10.0
    for value, bounds, words in (
        (0.0, {"gt": 0.0}, "must be greater than 0 mm"),
        (-1e-12, {"ge": 0.0}, "must be at least 0 mm"),
        (2.0, {"lt": 2.0}, "must be less than 2 mm"),
        ("3 mm", {"gt": 0.0, "le": 2.0}, "must be greater than 0 and at most 2 mm"),
        (math.nan, {}, "must be finite in mm"),
        (math.inf, {}, "must be finite in mm"),
        (True, {}, "must be a number in mm"),
        ([1.0], {}, "must be a number in mm"),
    ):
        with pytest.raises(ValidationError, match=words):
            validate(value, **bounds)
