"""Quantities of the drive file: plain numbers are mm, N, MPa, N·mm, rad; a text may carry another unit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from ltca.errors import DriveError

ARCMIN = 180.0 / math.pi * 60.0
"""Arcminutes of one radian."""
ARCSEC = 60.0 * ARCMIN
"""Arcseconds of one radian."""

UNIT_LABELS = {"N*mm": "N·mm", "N/mm": "N/mm", "dimensionless": ""}


def label(unit: str) -> str:
    """Return the printed form of a unit, e.g. ``N·mm`` for ``N*mm``."""
    return UNIT_LABELS.get(unit, unit)


def _number(value: Any, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise PydanticCustomError("quantity", "must be a number{unit}", {"unit": _in(unit)})
    if not isinstance(value, str):
        return float(value)
    # pint costs half a second to import: only files that carry units in texts pay for it.
    import pint

    try:
        quantity = _registry().Quantity(value)
        return float(quantity.to(unit).magnitude)
    except pint.DimensionalityError as error:
        raise PydanticCustomError(
            "quantity", "must have the unit {unit} or one that converts to it", {"unit": label(unit) or "1"}
        ) from error
    except (pint.PintError, ValueError, TypeError, AttributeError, AssertionError, SyntaxError) as error:
        raise PydanticCustomError(
            "quantity",
            'is not a quantity; write a number{unit} or a text like "{example}"',
            {"unit": _in(unit), "example": f"12.5 {unit}".replace("*", " ")},
        ) from error


_REGISTRY: list[Any] = []


def _registry() -> Any:
    if not _REGISTRY:
        import pint

        _REGISTRY.append(pint.UnitRegistry(cache_folder=None))
    return _REGISTRY[0]


def _in(unit: str) -> str:
    return f" in {label(unit)}" if label(unit) else ""


def quantity(
    unit: str,
    *,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> BeforeValidator:
    """Validate a quantity: convert texts, refuse what is not finite or out of bounds.

    Parameters
    ----------
    unit : str
        The unit inside the suite: ``mm``, ``N``, ``MPa``, ``N*mm``, ``N/mm``, ``rad`` or ``dimensionless``.
    gt, ge, lt, le : float, optional
        Bounds (greater than, at least, less than, at most) in that unit.

    Returns
    -------
    pydantic.BeforeValidator
        To be used in ``Annotated[float, quantity("mm", gt=0)]``.
    """
    bounds = (("greater than", gt), ("at least", ge), ("less than", lt), ("at most", le))
    return BeforeValidator(QuantityCheck(unit=unit, bounds=bounds))


@dataclass(frozen=True, slots=True, kw_only=True)
class QuantityCheck:
    """What `quantity` asks of a value; keeps the unit of the field for whoever reads the definition.

    Attributes
    ----------
    unit : str
        The unit inside the suite.
    bounds : tuple of (str, float or None)
        Greater than, at least, less than, at most.
    """

    unit: str
    bounds: tuple[tuple[str, float | None], ...]

    def __call__(self, value: Any) -> float:
        """Return the value in the unit of the field, or refuse it."""
        number = _number(value, self.unit)
        if not math.isfinite(number):
            raise PydanticCustomError("quantity", "must be finite{unit}", {"unit": _in(self.unit)})
        gt, ge, lt, le = (bound for _, bound in self.bounds)
        holds = (
            (gt is None or number > gt)
            and (ge is None or number >= ge)
            and (lt is None or number < lt)
            and (le is None or number <= le)
        )
        if not holds:
            text = " and ".join(f"{word} {bound:g}" for word, bound in self.bounds if bound is not None)
            raise PydanticCustomError(
                "quantity", "must be {text}{unit}", {"text": text, "unit": f" {label(self.unit)}".rstrip()}
            )
        return number


def parse_quantity(text: str, unit: str, name: str) -> float:
    """Return a number or a text with unit from the command line, in a unit of the suite.

    Parameters
    ----------
    text : str
        ``"377300"`` or ``"377.3 N m"``.
    unit : str
        Unit of the result and of plain numbers.
    name : str
        Option, for the message.

    Returns
    -------
    float
        The value in `unit`.

    Raises
    ------
    DriveError
        When the text is no finite quantity of that kind.
    """
    try:
        value = float(text)
    except ValueError:
        try:
            value = _number(text, unit)
        except PydanticCustomError as error:
            raise DriveError([f"{name} = {text!r}: {error.message()}"]) from error
    if not math.isfinite(value):
        raise DriveError([f"{name} = {text!r}: must be finite{_in(unit)}"])
    return value
