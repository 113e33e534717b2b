"""Quantities of the drive file: plain numbers are mm, N, MPa, N·mm, rad; a text may carry another unit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from numbers import Integral, Real
from typing import Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from ltca.drive.units.table import QuantityError, is_plain_number, label as label, range_of, read_quantity
from ltca.errors import DriveError, shortened

ARCMIN = 180.0 / math.pi * 60.0
"""Arcminutes of one radian."""
ARCSEC = 60.0 * ARCMIN
"""Arcseconds of one radian."""


def _number(value: Any, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise PydanticCustomError("quantity", "must be a number{unit}", {"unit": _in(unit)})
    try:
        return read_quantity(value, unit) if isinstance(value, str) else float(value)
    except QuantityError as error:
        raise PydanticCustomError("quantity", "{text}", {"text": str(error)}) from error
    except OverflowError:  # a whole number of hundreds of digits
        return math.inf


def _in(unit: str) -> str:
    return f" in {label(unit)}" if label(unit) else ""


def quantity(
    unit: str,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
    divides: bool = False,
) -> BeforeValidator:
    """Return the validator of a quantity, for ``Annotated[float, quantity("mm", gt=0)]``; `divides` of `QuantityCheck`.

    It converts texts, and refuses values that are not finite or out of bounds (greater than, at least, less than, at most),
    which are in the unit inside the suite: ``mm``, ``N``, ``MPa``, ``N*mm``, ``N/mm``, ``rad``, ``dimensionless``.
    """
    bounds = (("greater than", gt), ("at least", ge), ("less than", lt), ("at most", le))
    return BeforeValidator(QuantityCheck(unit=unit, bounds=bounds, divides=divides or unit == "N*mm"))


@dataclass(frozen=True, kw_only=True)
class QuantityCheck:
    """Check of a value by `quantity`, with the unit and bounds of the field for readers of the definition.

    Attributes
    ----------
    unit : str
        The unit inside the suite.
    bounds : tuple of (str, float or None)
        Greater than, at least, less than, at most.
    divides : bool
        Whether results are divided by it: where it may be 0, it is that or no less than the smallest positive size. Lengths, to
        which others are added, may have any size: differences leave some 1e-17 mm.
    """

    unit: str
    bounds: tuple[tuple[str, float | None], ...]
    divides: bool = False

    @cached_property
    def inner(self) -> tuple[float, float]:
        """Ends of the open interval in which every number is valid."""
        smallest, largest = range_of(self.unit)
        (_, gt), (_, ge), (_, lt), (_, le) = self.bounds
        low = max(-largest if bound is None else bound for bound in (gt, ge))
        high = min(largest if bound is None else bound for bound in (lt, le))
        return smallest if gt == 0.0 or (self.divides and low == 0.0) else low, high

    def __call__(self, value: Any) -> float:
        """Return the value in the unit of the field, or refuse it."""
        low, high = self.inner
        if type(value) is float and low < value < high:  # the usual case: studies validate millions
            return value
        number = value if type(value) is float else _number(value, self.unit)
        if not math.isfinite(number):
            raise PydanticCustomError("quantity", "must be finite{unit}", {"unit": _in(self.unit)})
        (_, gt), (_, ge), (_, lt), (_, le) = self.bounds
        holds = (
            (gt is None or number > gt)
            and (ge is None or number >= ge)
            and (lt is None or number < lt)
            and (le is None or number <= le)
        )
        # Far outside of any drive; products of a few such numbers stay within the range of floats.
        smallest, largest = range_of(self.unit)
        small = 0.0 < abs(number) < smallest and self.divides
        if holds and abs(number) <= largest and not small and (gt != 0.0 or number >= smallest):
            return number
        unit = f" {label(self.unit)}".rstrip()
        if not holds:
            text = " and ".join(f"{word} {bound:g}" for word, bound in self.bounds if bound is not None)
            raise PydanticCustomError("quantity", "must be {text}{unit}", {"text": text, "unit": unit})
        least = f"{'' if gt == 0.0 else '0 or '}at least {smallest:g}{unit}"
        text = f"at most {largest:g}{unit} in size" if abs(number) > largest else least
        raise PydanticCustomError("quantity", "must be {text}", {"text": text})


@dataclass(frozen=True, slots=True)
class Grows:
    """Thermal growth of a length, or of all lengths in a table, as part of their type (`grows`).

    Attributes
    ----------
    part : str
        Name of the factor in `ltca.drive.members.temperatures.Growth`.
    upon : str
        Path of the nominal length that the field is a deviation from: what grows by the factor is their sum, and the
        nominal length itself may grow by another one. Empty where the field grows by itself.
    but : tuple of (str, Grows)
        Fields of the table that grow in another way.
    """

    part: str
    upon: str = ""
    but: tuple[tuple[str, Grows], ...] = ()

    def of(self, name: str) -> Grows:
        """Return the growth of a field of the table."""
        return dict(self.but).get(name, Grows(self.part))


def grows(part: str, *, upon: str = "", **but: Grows) -> Grows:
    """Declare how a length, or every length in a table, grows with temperature.

    Examples
    --------
    >>> growth = grows("wheel", diameter=grows("wheel_sleeve"))
    >>> growth.of("radial").part, growth.of("diameter").part
    ('wheel', 'wheel_sleeve')
    """
    return Grows(part, upon, tuple(but.items()))


MOST_COUNTED = 10**15
"""Far beyond any count, within the 64 bits of the validator."""


class _Beyond(int):
    """A whole number beyond any count: compared as such, printed as it was given."""

    given: int

    def __new__(cls, given: int) -> _Beyond:
        self = super().__new__(cls, MOST_COUNTED if given > 0 else -MOST_COUNTED)
        self.given = given
        return self

    def __str__(self) -> str:
        return str(self.given)


def check_count(value: Any) -> int:
    """Return a count, or refuse truth values, texts other than digits, and numbers that are not whole."""
    if isinstance(value, str) and value.isascii() and value.isdigit() and len(value) < 10:
        return int(value)
    if isinstance(value, float) and abs(value) < 1e15 and value == int(value):
        return int(value)
    if isinstance(value, Integral) and not isinstance(value, bool):
        # The bounds of the field limit it.
        whole = int(value)
        return whole if abs(whole) <= MOST_COUNTED else _Beyond(whole)
    raise PydanticCustomError("quantity", "must be a whole number")


COUNT = BeforeValidator(check_count)
"""To be used in ``Annotated[int, Field(ge=4, le=1000), COUNT]``."""


def parse_quantity(
    given: object, unit: str, name: str, *, gt: float | None = None, ge: float | None = None, le: float | None = None
) -> float:
    """Return a number, or a text with unit as ``"377.3 N m"``, of a command or function, in a unit of the suite.

    Bounds (greater than, at least, at most) are in that unit; `name` is the option or argument, for the message. DriveError
    when it is no finite quantity of that kind within the bounds.

    Examples
    --------
    >>> parse_quantity("377.3 N m", "N*mm", "torque"), parse_quantity(0.5, "rad", "crank_angle")
    (377300.0, 0.5)
    """
    bounds = (("greater than", gt), ("at least", ge), ("less than", None), ("at most", le))
    check = QuantityCheck(unit=unit, bounds=bounds, divides=unit == "N*mm")
    number = float(given) if isinstance(given, Real) and not isinstance(given, int) else given  # those of numpy, too
    try:
        return check(number)
    except PydanticCustomError as error:
        told = number if isinstance(number, str) and is_plain_number(number) else shortened(number)
        raise DriveError([f"{name} = {told}: {error.message()}"]) from error
