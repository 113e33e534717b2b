"""Quantities with units: conversion, bounds, messages."""

from __future__ import annotations

import math
import re
from decimal import Decimal, localcontext
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import TypeAdapter, ValidationError
from refusals import error_says

from ltca.drive.units.quantities import parse_quantity, quantity
from ltca.drive.units.table import UNITS, label, shown_units, spellings_of
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
        ("3 lb", "mm", "not known; it must have the unit mm"),
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
    with error_says(DriveError, words) as caught:
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
        with error_says(ValidationError, words):
            validate(value, **bounds)


TABLE = Path(__file__).parents[3] / "docs" / "reference" / "units.md"


def documented():
    """Kind, unit of plain numbers, and units with their spellings, as docs/reference/units.md has them."""
    rows = re.findall(r"^\| ([a-z ]+) \| (\S[^|]*) \| (`.*`) \|$", TABLE.read_text(encoding="utf-8"), re.MULTILINE)
    return {
        kind: (plain, [tuple(re.findall(r"`([^`]+)`", unit)) for unit in units.split("; ")])
        for kind, plain, units in rows
    }


def test_the_documented_units_are_those_that_are_read():
    table = documented()
    assert table.keys() == UNITS.keys()
    for kind, (plain, units) in table.items():
        assert [set(spellings) for spellings in units] == [set(spellings) for spellings in spellings_of(kind)], kind
        assert plain == (label(shown_units(kind)[0]) if kind != "ratio" else "–")


@pytest.mark.parametrize(("kind", "plain"), [(kind, row[0]) for kind, row in documented().items() if kind != "ratio"])
def test_every_spelling_is_read_with_a_space_and_without(kind, plain):
    unit = "ΔK" if kind == "temperature difference" else plain
    for spellings in documented()[kind][1]:
        values = {parse_quantity(f"2.5{gap}{spelled}", unit, "x") for spelled in spellings for gap in ("", " ")}
        assert len(values) == 1, spellings
    assert parse_quantity("2.5", unit, "x") == 2.5


# Definitions: SI prefixes, 1 in = 25.4 mm (ISO 80000-3), 0 °C = 273.15 K, 1 arcmin = 1/60°.
SIZES = [
    ("1 m", "mm", 1000.0), ("1 µm", "mm", 1e-3), ("1 um", "mm", 1e-3), ("1 nm", "mm", 1e-6), ("1 in", "mm", 25.4),
    ("1 kN", "N", 1000.0), ("1 GPa", "MPa", 1000.0), ("1 kPa", "MPa", 1e-3), ("1 N·m", "N·mm", 1000.0),
    ("1 kNm", "N·mm", 1e6), ("180 deg", "rad", math.pi), ("60′", "rad", math.pi / 180.0), ("3600″", "rad", math.pi / 180.0),
    ("8'", "arcmin", 8.0), ("1 N/µm", "N/mm", 1000.0), ("1 Nm/rad", "N·mm/rad", 1000.0), ("20 °C", "°C", 20.0),
    ("293.15 K", "°C", 20.0), ("5 K", "ΔK", 5.0), ("1 g/cm³", "kg/m³", 1000.0), ("12.5 %", "dimensionless", 0.125),
    ("1 N·m/arcmin", "N·mm/rad", 1000.0 * 10800.0 / math.pi), ("1500 rev/min", "rpm", 1500.0),
    ("25 Hz", "rpm", 1500.0), ("25 rev/s", "rpm", 1500.0), ("9000 deg/s", "rpm", 1500.0),
    ("1 rad/s", "rpm", 30.0 / math.pi),
]  # fmt: skip


@pytest.mark.parametrize(("text", "unit", "value"), SIZES)
def test_units_have_their_sizes(text, unit, value):
    # Exact up to the rounding of the expected value itself.
    assert parse_quantity(text, unit, "x") == pytest.approx(value, rel=2.3e-16)


def test_decimals_round_to_the_nearest_float():
    """Multiplying floats is an ulp off for one in five of these; decimals of 50 digits say what is nearest."""
    with localcontext() as context:
        context.prec = 50
        for number in range(1, 2000):
            text = f"{number / 7:.4f}"
            assert parse_quantity(f"{text} µm", "mm", "x") == float(Decimal(text) / 1000)
            assert parse_quantity(f"{text} in", "mm", "x") == float(Decimal(text) * Decimal("25.4"))
    assert parse_quantity("377.3 N m", "N*mm", "x") == 377_300.0
    assert parse_quantity("20 deg", "rad", "x") == math.radians(20.0)


# What was written, and what the message has to say beside refusing it.
REFUSED = [
    ("377,3 N m", "N*mm", '"377.3 N m"'), ("1,5 mm", "mm", '"1.5 mm"'), ("377 300 N mm", "N*mm", '"377300 N mm"'),
    ("377'300 N mm", "N*mm", '"377300 N mm"'), ("1_000 mm", "mm", '"1000 mm"'), ("1,000.5 mm", "mm", '"1000.5 mm"'),
    ("1,500 mm", "mm", '"1500 mm", or "1.500 mm"'), ("1.500,5 mm", "mm", '"12.5 mm"'), ("9**9**9**9 mm", "mm", "not a quantity"),
    ("1/0 mm", "mm", "not a quantity"), ("2*3 mm", "mm", "not a quantity"), ("(3) mm", "mm", "not a quantity"),
    ("1e mm", "mm", "not known"), ("1 e3 mm", "mm", "not"), ("e3", "mm", "not a quantity"), ("0x10 mm", "mm", "not a quantity"),
    ("12.5  mm", "mm", "not a quantity"), (" 12.5 mm", "mm", "not a quantity"), ("12.5 mm ", "mm", "not"),
    ("12.5\tmm", "mm", "not a quantity"), ("12.5\u00a0mm", "mm", "not a quantity"), ("12.5 mm\n", "mm", "not a quantity"),
    ("--5 mm", "mm", "not a quantity"), ("- 5 mm", "mm", "not a quantity"), ("−5 mm", "mm", "not a quantity"),
    ("٣ mm", "mm", "not a quantity"), ("½ mm", "mm", "not a quantity"), ("1.2.3 mm", "mm", "not a quantity"),
    ("1..2 mm", "mm", "not a quantity"), (". mm", "mm", "not a quantity"), ("5 mm mm", "mm", "not known"),
    ("5 MM", "mm", "not known"), ("5 Mm", "mm", "not known"), ("5 cm", "mm", "length (m, µm, nm, in)"), ("5 inch", "mm", "not"),
    ("5 mm²", "mm", "not known"), ("5 °", "mm", "must have the unit mm"), ("5 °C", "mm", "must have the unit mm"),
    ("5 %", "mm", "must have the unit mm"), ("5 Nm", "mm", "must have the unit mm"), ("5 lbf in", "N*mm", "not known"),
    ("5 mN·m", "N*mm", "not known"), ("5 N.m", "N*mm", "not"), ("5 kgf m", "N*mm", "not known"), ("5 N·m·m", "N*mm", "not known"),
    ("5 ksi", "MPa", "not known"), ("5 Pa", "MPa", "MPa or another of pressure (GPa, kPa)"), ("5 bar", "MPa", "not known"),
    ("20 grad", "rad", "not known"), ("20 degrees", "rad", "not known"),
    ("5 ppm", "dimensionless", "plain number or have the unit %"),
    ("nan mm", "mm", "not a quantity"), ("infinity", "mm", "finite"), ("NaN", "mm", "finite"), ("1e999999999 mm", "mm", "finite"),
    ("1e309", "mm", "finite"), ("1e308", "mm", "at most 1e+06 mm"), ("7" * 400, "mm", "not a quantity"),
    ("__import__('os').system('x')", "mm", "not a quantity"), ("${HOME}", "mm", "not a quantity"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "unit", "told"), REFUSED, ids=range(len(REFUSED)))
def test_what_is_not_in_the_grammar_is_refused_with_a_way_to_write_it(text, unit, told):
    """377,3 N m was read as 3,773,000 N·mm, 377 300 N mm as 113,100, 8' as 8 rad, and powers of powers hung."""
    with pytest.raises(DriveError) as caught:
        parse_quantity(text, unit, "--x")
    assert told in str(caught.value)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 250


def test_sizes_beyond_any_drive_are_refused():
    assert validate("1 m", gt=0.0) == 1000.0
    for value, words in (
        (5e-324, "at least 1e-09 mm"),
        (1e308, "at most 1e"),
        (10**400, "finite"),
        (-(10**400), "finite"),
    ):
        with error_says(ValidationError, words):
            validate(value, gt=0.0)
    assert validate(5e-324) == 5e-324  # of an error of a part: as good as zero
