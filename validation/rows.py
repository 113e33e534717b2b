"""Rows of the report: a compared figure with its limit and the reason for the limit."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

DIGITS = 6
"""Significant digits of figures in files: more would be round-off of another machine or another run."""

LEVELS = {
    1: "The codes against closed forms",
    2: "The codes against other codes",
    3: "The LTCA against the paper's printed results",
    4: "Derived influence coefficients",
    5: "Compliance models against the full finite-element solution",
    6: "What it means",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One compared figure.

    Attributes
    ----------
    level : int
        Rung, 1 to 6.
    quantity : str
        What is compared.
    value : float
        Ours.
    reference : float or None
        What it is held against; None where the figure itself is an error.
    unit : str
        Of value and reference.
    difference : float
        What the limit bounds.
    difference_unit : str
        Unit of the difference, "" for a ratio.
    limit : float or None
        The difference may be this large in magnitude; None for a row that only informs.
    reason : str
        Why the limit has that size, or what causes the difference of an informing row.
    case, contact, model, against : str
        Case of the drive, contact, compliance model, and what the reference is; "" where they mean nothing.
    crank_angle : float or None
        rad.
    error_bar : float or None
        Numerical uncertainty of the reference by the size of its elements, in the unit of the difference; None where none was
        found. Of input and model it says nothing.
    """

    level: int
    quantity: str
    value: float
    reference: float | None
    unit: str
    difference: float
    limit: float | None
    reason: str
    difference_unit: str = ""
    case: str = ""
    contact: str = ""
    model: str = ""
    against: str = ""
    crank_angle: float | None = None
    error_bar: float | None = None

    def __post_init__(self) -> None:
        """Refuse a row outside the levels or without a reason."""
        if self.level not in LEVELS:
            raise ValueError(f"level {self.level}: must be one of {sorted(LEVELS)}")
        if not self.reason:
            raise ValueError(f"{self.quantity}: a row says why its limit has that size, or what causes the difference")

    @property
    def passed(self) -> bool:
        """Whether the difference is within the limit; NaN is not."""
        return self.limit is None or bool(abs(self.difference) <= self.limit)

    @property
    def below_error_bar(self) -> bool | None:
        """Whether the difference is smaller than the error bar of the reference, so that it says nothing of the model."""
        return None if self.error_bar is None else bool(abs(self.difference) < self.error_bar)

    def content(self) -> dict[str, Any]:
        """Return the row as `validation.json` holds it."""
        return {
            "level": self.level,
            "quantity": self.quantity,
            "case": self.case or None,
            "angle_rad": self.crank_angle,
            "contact": self.contact or None,
            "model": self.model or None,
            "against": self.against or None,
            "reference": rounded(self.reference),
            "value": rounded(self.value),
            "unit": self.unit,
            "difference": rounded(self.difference),
            "difference_unit": self.difference_unit,
            "limit": self.limit,
            "reason": self.reason,
            "pass": self.passed,
            "error_bar": rounded(self.error_bar),
            "below_error_bar": self.below_error_bar,
        }


def rounded(value: float | None) -> float | None:
    """Return a figure with `DIGITS` significant digits; None for what is no finite number.

    Examples
    --------
    >>> rounded(1.0 / 3.0)
    0.333333
    """
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value:.{DIGITS}g}")


def relative_row(
    level: int, quantity: str, value: float, reference: float, unit: str, limit: float | None, reason: str, **place: Any
) -> Row:
    """Return a row whose difference is relative to the reference."""
    return Row(
        level=level,
        quantity=quantity,
        value=value,
        reference=reference,
        unit=unit,
        difference=value / reference - 1.0,
        limit=limit,
        reason=reason,
        **place,
    )


def range_row(
    level: int,
    quantity: str,
    value: float,
    reference: float,
    lowest: float,
    highest: float,
    unit: str,
    reason: str,
    **place: Any,
) -> Row:
    """Return a row whose value must lie in a range that holds the reference.

    The difference is value less reference; its limit is the distance of the reference from the bound on that side.
    """
    if not lowest <= reference <= highest:
        raise ValueError(f"{quantity}: reference {reference:g} outside {lowest:g} to {highest:g}")
    return Row(
        level=level,
        quantity=quantity,
        value=value,
        reference=reference,
        unit=unit,
        difference=value - reference,
        difference_unit=unit,
        limit=highest - reference if value >= reference else reference - lowest,
        reason=f"within {lowest:g} … {highest:g}{f' {unit}' if unit else ''}: {reason}",
        **place,
    )


def positive_row(level: int, quantity: str, value: float, unit: str, reason: str, **place: Any) -> Row:
    """Return a row whose value must not be negative: the difference is the amount below zero."""
    return Row(
        level=level,
        quantity=quantity,
        value=value,
        reference=None,
        unit=unit,
        difference=value if math.isnan(value) else max(0.0, -value),
        difference_unit=unit,
        limit=0.0,
        reason=f"must be positive: {reason}",
        **place,
    )


def failed_rows(rows: Iterable[Row]) -> list[Row]:
    """Return the rows that do not pass."""
    return [row for row in rows if not row.passed]
