"""Level 4: the derived influence coefficients against laws, closed forms and a finer mesh."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ltca.reading.coefficient_laws import Check, check_coefficients
from validation.rows import Row

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled

HALVED_LIMIT = 3e-3


def check_file(dataset: Labelled, case: str, plane: str) -> list[Row]:
    """Return the checks of one set of derived coefficients as rows, labelled with case and plane state."""
    return [_row(check, case, f"coefficients, plane {plane}") for check in check_coefficients(dataset)]


def _row(check: Check, case: str, model: str) -> Row:
    """Return a check as a row: of two bounds the distance from their middle, else the amount by which the bound is missed."""
    if math.isfinite(check.highest):
        middle = 0.0 if check.lowest == 0.0 else 0.5 * (check.lowest + check.highest)
        difference, limit = check.value - middle, check.highest - middle
        reference: float | None = middle
    else:
        difference = check.value if math.isnan(check.value) else max(0.0, check.lowest - check.value)
        limit, reference = 0.0, check.lowest
    return Row(
        level=4,
        quantity=check.name,
        value=check.value,
        reference=reference,
        unit="",
        difference=difference,
        limit=limit,
        reason=check.reason,
        case=case,
        model=model,
        against="law or closed form",
    )


def halved_mesh_row(finer: Labelled, case: str) -> Row:
    """Return the row on the change by a mesh of half the size, from coefficients derived on it.

    Their convergence estimate compares with twice the element size, the default one.
    """
    change = float(finer.attrs["convergence_estimate"])
    return Row(
        level=4,
        quantity="change by a mesh of half the size",
        value=change,
        reference=0.0,
        unit="",
        difference=change,
        limit=HALVED_LIMIT,
        reason="of the largest entry, rigid motions projected out; quadratic elements, four to five times less than "
        "the step before",
        case=case,
        model="coefficients, plane strain",
        against="half the element size",
    )
