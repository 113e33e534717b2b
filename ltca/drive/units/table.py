"""The units a text may carry, and exact conversion between them.

A quantity is a number with a point, one space or none, and a unit of `UNITS`. Nothing is evaluated. Number and factor
are multiplied as fractions and rounded once, so "377.3 N m" is 377300.0 and every text gives the nearest float.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from ltca.errors import shortened

PI = Fraction(
    31415926535897932384626433832795028841971693993751058209749445923078164062862089986280348253421170679, 10**100
)
"""π to a hundred decimals: products with it still round to the nearest float."""
LONGEST = 80
"""Largest number of characters of a text that is parsed; no quantity needs more."""

_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_UNIT = r"1/K|[%′″'\"’]|°C?|[A-Za-zµμ][A-Za-zµμ ·⋅*/²³ⁿ^23]*"
_QUANTITY = re.compile(rf"({_NUMBER})(?: ?({_UNIT}))?")
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]+,[0-9]+(?:[eE][+-]?[0-9]+)?(.*)")
_GROUPS = re.compile(r"[+-]?[0-9]{1,3}(?:[ _'’\u00a0\u2009\u202f,][0-9]{3})+(?:\.[0-9]*)?(.*)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """One unit.

    Attributes
    ----------
    kind : str
        Physical quantity; units of one kind convert into each other.
    factor : Fraction
        Factor to the first unit of its kind.
    offset : Fraction
        Added after the factor: temperatures alone have one.
    """

    kind: str
    factor: Fraction
    offset: Fraction = Fraction(0)


def _spelled(*spellings: str) -> tuple[str, ...]:
    """Every way to write a product: with a dot, a space, a star, or side by side."""
    return tuple(
        dict.fromkeys(
            form
            for text in spellings
            for form in (text, text.replace("·", " "), text.replace("·", ""), text.replace("·", "*"))
        )
    )


def _squared(text: str) -> tuple[str, ...]:
    """Every way to write a product whose last factor is squared: with a raised or a plain 2."""
    return tuple(form for spelled in _spelled(text) for form in (spelled, spelled.replace("²", "2")))


_DEGREE = PI / 180
# kind, spellings (the first is printed), factor, offset; factors refer to the first unit of a kind.
_TABLE: tuple[tuple[str, tuple[str, ...], Fraction | int, Fraction | int], ...] = (
    ("length", ("mm",), 1, 0),
    ("length", ("m",), 1000, 0),
    ("length", ("µm", "um"), Fraction(1, 1000), 0),
    ("length", ("nm",), Fraction(1, 10**6), 0),
    ("length", ("in",), Fraction(254, 10), 0),
    ("force", ("N",), 1, 0),
    ("force", ("kN",), 1000, 0),
    ("pressure", ("MPa",), 1, 0),
    ("pressure", ("GPa",), 1000, 0),
    ("pressure", ("kPa",), Fraction(1, 1000), 0),
    ("torque", _spelled("N·mm"), 1, 0),
    ("torque", _spelled("N·m"), 1000, 0),
    ("torque", _spelled("kN·m"), 10**6, 0),
    ("angle", ("rad",), 1, 0),
    ("angle", ("deg", "°"), _DEGREE, 0),
    ("angle", ("arcmin", "′", "'"), _DEGREE / 60, 0),
    ("angle", ("arcsec", "″", '"'), _DEGREE / 3600, 0),
    ("angle", ("mrad",), Fraction(1, 1000), 0),
    ("angle", ("µrad", "urad"), Fraction(1, 10**6), 0),
    ("angle", ("mm/m", "µm/mm", "um/mm"), Fraction(1, 1000), 0),
    ("stiffness", ("N/mm",), 1, 0),
    ("stiffness", ("N/µm", "N/um"), 1000, 0),
    ("load deflection constant", ("N/mmⁿ", "N/mm^n"), 1, 0),
    ("speed", ("rpm", "rev/min"), 1, 0),
    ("speed", ("Hz", "rev/s"), 60, 0),
    ("speed", ("kHz",), 60_000, 0),
    ("speed", ("rad/s",), 30 / PI, 0),
    ("speed", ("deg/s",), Fraction(1, 6), 0),
    ("torsional stiffness", _spelled("N·mm/rad"), 1, 0),
    ("torsional stiffness", _spelled("N·m/rad"), 1000, 0),
    ("torsional stiffness", _spelled("N·m/arcmin"), 1000 * 60 / _DEGREE, 0),
    ("temperature", ("°C",), 1, 0),
    ("temperature", ("K",), 1, Fraction(-27315, 100)),
    ("temperature difference", ("K",), 1, 0),
    ("thermal expansion", ("1/K",), 1, 0),
    ("ratio", ("%",), Fraction(1, 100), 0),
    ("power", ("W",), 1, 0),
    ("pressure times speed", ("MPa·m/s", "MPa m/s", "MPa*m/s"), 1, 0),
    ("time", ("h",), 1, 0),
    ("time", ("s",), Fraction(1, 3600), 0),
    ("time", ("ms",), Fraction(1, 3_600_000), 0),
    ("density", ("kg/m³", "kg/m3"), 1, 0),
    ("density", ("g/cm³", "g/cm3"), 1000, 0),
    ("viscosity", ("mm²/s", "mm2/s", "cSt"), 1, 0),
    ("mass", ("kg",), 1, 0),
    ("mass", ("g",), Fraction(1, 1000), 0),
    ("mass", ("t",), 1000, 0),
    ("moment of inertia", _squared("kg·m²"), 1, 0),
    ("moment of inertia", _squared("kg·cm²"), Fraction(1, 10**4), 0),
    ("moment of inertia", _squared("kg·mm²"), Fraction(1, 10**6), 0),
    ("moment of inertia", _squared("g·cm²"), Fraction(1, 10**7), 0),
)
UNITS: dict[str, dict[str, Unit]] = {}
"""By kind, then by spelling."""
for _kind, _spellings, _factor, _offset in _TABLE:
    for _spelling in _spellings:
        UNITS.setdefault(_kind, {})[_spelling] = Unit(kind=_kind, factor=Fraction(_factor), offset=Fraction(_offset))
# Ratios are written without a unit; its name is "1" in results of studies, "dimensionless" in definitions.
UNITS["ratio"][""] = UNITS["ratio"]["1"] = Unit(kind="ratio", factor=Fraction(1))
_NAMES = {"dimensionless": ("ratio", "1"), "ΔK": ("temperature difference", "K")}


def unit_named(name: str) -> Unit:
    """Return a unit by its name in definitions: a spelling, ``dimensionless``, or ``ΔK`` for a difference.

    Examples
    --------
    >>> unit_named("N*mm").kind
    'torque'
    """
    if name in _NAMES:
        kind, spelling = _NAMES[name]
        return UNITS[kind][spelling]
    return next(units[name] for units in UNITS.values() if name in units)


def shown_units(kind: str) -> list[str]:
    """Return the units of a kind as they are printed, each in its first spelling."""
    return [spellings[0] for name, spellings, _, _ in _TABLE if name == kind]


def spellings_of(kind: str) -> list[tuple[str, ...]]:
    """Return the units of a kind, each with all its spellings, for the documents."""
    return [spellings for name, spellings, _, _ in _TABLE if name == kind]


def is_plain_number(text: str) -> bool:
    """Tell whether a text is a short finite number without a unit."""
    return len(text) <= 24 and re.fullmatch(_NUMBER, text) is not None and math.isfinite(float(text))


class QuantityError(ValueError):
    """A text is not a quantity of the kind asked for; the message continues a sentence that starts with its value."""


def read_quantity(text: str, unit: str) -> float:
    """Return a quantity given as text, ``"377.3 N m"``, in a unit (see `unit_named`); a text without a unit is in that
    unit.

    The result is the nearest float; infinite or zero where floats end. QuantityError says how to write the text.

    Examples
    --------
    >>> read_quantity("377.3 N m", "N*mm")
    377300.0
    """
    wanted = unit_named(unit)
    if text.lower().lstrip("+-") in ("nan", "inf", "infinity"):
        return math.nan  # numbers that TOML writes bare: the message is that they are not finite
    match = _QUANTITY.fullmatch(text) if len(text) <= LONGEST else None
    if match is None:
        raise QuantityError(_how_to_write(text, wanted.kind, unit))
    number, name = match.groups()
    given = wanted if name is None else UNITS[wanted.kind].get(_plain(name))
    if given is None:
        raise QuantityError(_about_unit(name or "", wanted.kind, unit))
    value = float(number)
    if not math.isfinite(value):
        return value
    # A float that is neither zero nor infinite bounds the exponent, and so the size of the fraction.
    exact = Fraction(number) if value else Fraction(0)
    exact = (exact * given.factor + given.offset - wanted.offset) / wanted.factor
    try:
        return float(exact)
    except OverflowError:
        return math.copysign(math.inf, exact)


def read_text_unit(text: str) -> str:
    """Return the unit of a quantity given as text, in the spelling of `UNITS`; empty without one.

    Examples
    --------
    >>> read_text_unit("5 µm"), read_text_unit("5")
    ('µm', '')
    """
    match = _QUANTITY.fullmatch(text) if len(text) <= LONGEST else None
    return _plain((match.group(2) if match else "") or "")


def _plain(name: str) -> str:
    """A unit with one sign for those that look alike: the two micro signs, raised dots and minute marks."""
    return name.replace("\u03bc", "\u00b5").replace("\u22c5", "·").replace("\u2019", "'")


def _example(kind: str, unit: str) -> str:
    if kind == "ratio":
        return ', as 0.125, or "12.5 %"'
    spelled = label(unit) or shown_units(kind)[0]
    return f' in {spelled}, as 12.5, or with its unit, as "12.5 {spelled}"'


def _how_to_write(text: str, kind: str, unit: str) -> str:
    if match := _GROUPS.fullmatch(text):
        rest = match.group(1)
        head = text[: len(text) - len(rest)] if rest else text
        joined = re.sub(r"[^0-9.+-]", "", head)
        comma = f', or "{head.replace(",", ".")}{rest}"' if head.count(",") == 1 and "." not in head else ""
        return f'has a gap or mark within its number; write it without, "{joined}{rest}"{comma}'
    if match := _DECIMAL_COMMA.fullmatch(text):
        return f'has a comma; write it with a point, "{text.replace(",", ".", 1)}"'
    return f"is not a quantity; write a number{_example(kind, unit)}"


def _about_unit(name: str, kind: str, unit: str) -> str:
    if kind == "ratio":
        told = "must be a plain number or have the unit %"
    else:
        first = label(unit) or shown_units(kind)[0]
        others = ", ".join(shown for shown in shown_units(kind) if shown != first)
        told = f"must have the unit {first}" + (f" or another of {kind} ({others})" if others else "")
    known = any(_plain(name) in units for units in UNITS.values())
    return told if known else f'has a unit "{shortened(name)[1:-1]}" that is not known; it {told}'


RANGES = {
    "length": (1e-9, 1e6),
    "force": (1e-9, 1e12),
    "pressure": (1e-6, 1e18),
    "torque": (1e-9, 1e15),
    "angle": (1e-12, 1e6),
    "stiffness": (1e-9, 1e18),
    "load deflection constant": (1e-9, 1e18),
    "torsional stiffness": (1e-9, 1e24),
    "ratio": (1e-9, 1e9),
}
"""Smallest positive and largest size of a quantity in the first unit of its kind: far outside of any drive (lengths from a
picometre to a kilometre), well inside of the range of floats, also for products of a few."""


@cache
def range_of(unit: str) -> tuple[float, float]:
    """Return the smallest positive and the largest size accepted of a quantity, in a unit."""
    wanted = unit_named(unit)
    smallest, largest = RANGES.get(wanted.kind, (1e-12, 1e12))
    return smallest / float(wanted.factor), largest / float(wanted.factor)


LABELS = {"N*mm": "N·mm", "N*mm/rad": "N·mm/rad", "dimensionless": "", "1": "", "ΔK": "K"}


def label(unit: str) -> str:
    """Return the printed form of a unit, e.g. ``N·mm`` for ``N*mm``."""
    return LABELS.get(unit, unit)
