"""What a case of the manual is: a problem with a reference, and figures with an error bar, a bound and a verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import hypot, isfinite
from typing import Literal

from validation.rows import Row

Bodies = Literal["plane", "solid"]
PLAIN = "1"
"""Unit of differences of numbers without a unit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """Where reference values come from.

    Attributes
    ----------
    source : str
        Publication, standard, code or law, with edition, page or version.
    uncertainty : str
        How well the reference values are known, in words; sizes are in the figures.
    """

    source: str
    uncertainty: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """One compared quantity.

    Attributes
    ----------
    quantity : str
        What is compared.
    value : float
        Ours.
    reference : float or None
        What it is held against; None where the figure must only have a sign.
    unit : str
        Of value and reference.
    difference : float
        What the bound holds.
    difference_unit : str
        Unit of difference, bound and errors; "" for a ratio to the reference, printed in per cent, `PLAIN` for the difference of
        numbers without a unit.
    bound : float or None
        The difference may be this large in magnitude; None for a figure that only informs.
    bound_reason : str
        Why the bound has that size, or what causes the difference of a figure that informs.
    numerical_error : float
        Error bar of the value from its computation.
    numerical_origin : str
        How the error bar was found.
    reference_error : float
        Of the reference, in the unit of the difference.
    input_error : float
        What the uncertainty of the input makes of the value, in the unit of the difference.
    """

    quantity: str
    value: float
    reference: float | None
    unit: str
    difference: float
    difference_unit: str
    bound: float | None
    bound_reason: str
    numerical_error: float
    numerical_origin: str
    reference_error: float = 0.0
    input_error: float = 0.0

    def __post_init__(self) -> None:
        """Refuse figures without a reason, or with an error bar that is none."""
        for name in ("numerical_error", "reference_error", "input_error"):
            error = getattr(self, name)
            if not (isfinite(error) and error >= 0.0):
                raise ValueError(f"{self.quantity}: {name} = {error}: must be at least 0 and finite")
        if not (self.bound_reason and self.numerical_origin):
            raise ValueError(f"{self.quantity}: says why its bound has that size and how its error bar was found")

    @property
    def passed(self) -> bool:
        """Whether the difference is within the bound; NaN is not."""
        return self.bound is None or abs(self.difference) <= self.bound

    @property
    def error_bar(self) -> float:
        """Numerical, reference and input error together, √(Σ²) (ASME V&V 20), in the unit of the difference."""
        return hypot(self.numerical_error, self.reference_error, self.input_error)

    @property
    def beyond_error_bar(self) -> bool:
        """Whether the difference is larger than the errors of numbers, reference and input: the rest is of the model."""
        return not abs(self.difference) <= self.error_bar

    @classmethod
    def of_row(cls, row: Row, *, numerical_error: float, numerical_origin: str, reference_error: float = 0.0) -> Figure:
        """Return a row of the validation report as a figure; errors are in the unit of its difference."""
        return cls(
            quantity=", ".join(part for part in (row.quantity, row.contact, row.case) if part),
            value=row.value,
            reference=row.reference,
            unit=row.unit,
            difference=row.difference,
            difference_unit=row.difference_unit,
            bound=row.limit,
            bound_reason=row.reason,
            numerical_error=numerical_error,
            numerical_origin=numerical_origin,
            reference_error=reference_error,
        )


def _figure(
    quantity: str,
    value: float,
    reference: float,
    unit: str,
    bound: float | None,
    bound_reason: str,
    *,
    relative: bool,
    numerical_error: float,
    numerical_origin: str,
    reference_error: float = 0.0,
    input_error: float = 0.0,
) -> Figure:
    return Figure(
        quantity=quantity,
        value=value,
        reference=reference,
        unit=unit,
        difference=value / reference - 1.0 if relative else value - reference,
        difference_unit="" if relative else unit or PLAIN,
        bound=bound,
        bound_reason=bound_reason,
        numerical_error=numerical_error,
        numerical_origin=numerical_origin,
        reference_error=reference_error,
        input_error=input_error,
    )


relative_figure = partial(_figure, relative=True)
"""Figure whose difference, bound and errors are relative to the reference."""
absolute_figure = partial(_figure, relative=False)
"""Figure whose difference, bound and errors are in the unit of the reference."""


EXACT = "None: the problem is stated in exact numbers."
SAME_EQUATIONS = "None: the reference is a solution of the equations that are solved."


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One page of the manual.

    Attributes
    ----------
    name : str
        Name of the page and of the case in commands: small letters, digits and underscores.
    title : str
        Of the page.
    problem : str
        What is asked, with all numbers (Markdown).
    references : tuple of Reference
        What it is held against.
    model : str
        How it is modelled here, with the functions that do it (Markdown).
    input_uncertainty : str
        What is not known of the problem's numbers, in words.
    model_uncertainty : str
        What the model leaves out or does otherwise than the reference, in words.
    run : callable
        Computes the figures.
    long : bool
        Whether it takes more than some seconds; such pages are computed anew in the nightly tests.
    bodies : {"plane", "solid"}
        Whether bodies, if any, are plane or solid.
    """

    name: str
    title: str
    problem: str
    references: tuple[Reference, ...]
    model: str
    run: Callable[[], Sequence[Figure]]
    input_uncertainty: str = EXACT
    model_uncertainty: str = SAME_EQUATIONS
    long: bool = False
    bodies: Bodies = "plane"

    @property
    def command(self) -> str:
        """The command that computes the case alone."""
        return f"cyclo validate --manual {self.name}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """A case with the figures found now.

    Attributes
    ----------
    case : Case
        The case.
    figures : tuple of Figure
        At least one with a bound; ValueError without.
    """

    case: Case
    figures: tuple[Figure, ...]

    def __post_init__(self) -> None:
        """Refuse a case that holds nothing."""
        if all(figure.bound is None for figure in self.figures):
            raise ValueError(f"{self.case.name}: no figure has a bound")

    @property
    def failed(self) -> tuple[Figure, ...]:
        """Figures that miss their bound."""
        return tuple(figure for figure in self.figures if not figure.passed)

    @property
    def passed(self) -> bool:
        """Whether all figures are within their bounds."""
        return not self.failed


def solve_case(case: Case) -> Outcome:
    """Compute a case.

    Examples
    --------
    >>> from validation.manual.register import chosen_cases
    >>> found = solve_case(chosen_cases(["crankshaft"])[0])
    >>> found.passed, len(found.figures), found.failed
    (True, 2, ())
    """
    return Outcome(case=case, figures=tuple(case.run()))
