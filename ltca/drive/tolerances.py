r"""Distributions of the fields of a drive: the ``[tolerances]`` table that studies read.

A tolerance is the ±T of the drawing about the field's value. A normal distribution takes its standard deviation from
it by the process capability, C_pk = (T − |mean|)/(3σ) (ISO 22514-2 for a symmetric tolerance); truncated means that
parts outside ±T are sorted out.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import fields
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Strict, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from ltca.arrays import FloatArray
from ltca.drive.fields import (
    absence,
    element_count,
    field_kind,
    field_kinds,
    lacks_slices,
    may_be_left_out,
    not_a_field,
    own_paths,
    read_field,
)
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import quantity
from ltca.errors import DriveError, Problem, printable, shortened


@dataclass(frozen=True, slots=True, kw_only=True, config=ConfigDict(extra="forbid"))
class Distribution:
    """How a field scatters about its value; an array field draws every element independently.

    Attributes
    ----------
    distribution : {"normal", "uniform", "truncated-normal"}
        Normal without bounds, uniform over the tolerance, or normal with parts out of tolerance sorted out.
    tolerance : float
        T of ±T about the field's value, in the unit of the field.
    cpk : float
        Process capability C_pk of a normal distribution: σ = (T − |mean|)/(3 C_pk).
    mean : float
        Mean deviation from the field's value, smaller in size than T.
    """

    distribution: Literal["normal", "uniform", "truncated-normal"]
    # The unit of the field is applied before; here only numbers are accepted, no truth values.
    tolerance: Annotated[float, Strict()]
    cpk: Annotated[float, quantity("dimensionless", gt=0.0)] = 1.0
    mean: Annotated[float, Strict()] = 0.0

    @property
    def standard_deviation(self) -> float:
        """σ of the distribution before truncation; of the rectangle for a uniform one."""
        room = self.tolerance - abs(self.mean)
        return room / 3.0**0.5 if self.distribution == "uniform" else room / (3.0 * self.cpk)

    def quantile(self, probability: FloatArray) -> FloatArray:
        """Return the inverse distribution function: the deviation below which a fraction `probability` of all parts lies.

        Fractions are between 0 and 1, both excluded for the unbounded normal distribution.

        Examples
        --------
        >>> rectangle = Distribution(distribution="uniform", tolerance=0.02)
        >>> rectangle.quantile(np.array([0.0, 0.5, 1.0])).tolist()
        [-0.02, 0.0, 0.02]
        """
        probability = np.asarray(probability, dtype=float)
        room = self.tolerance - abs(self.mean)
        if self.distribution == "uniform":
            return self.mean + room * (2.0 * probability - 1.0)
        from scipy.special import ndtr, ndtri

        sigma = self.standard_deviation
        if self.distribution == "normal":
            return np.asarray(self.mean + sigma * ndtri(probability))
        low, high = ndtr((-self.tolerance - self.mean) / sigma), ndtr((self.tolerance - self.mean) / sigma)
        deviation = self.mean + sigma * ndtri(low + probability * (high - low))
        return np.asarray(np.clip(deviation, -self.tolerance, self.tolerance))


_ADAPTER: TypeAdapter[Distribution] = TypeAdapter(Distribution)
Tolerances = dict[str, Distribution]


def parse_tolerances(table: Any, problems: list[str], drive: Drive | None = None) -> Tolerances:
    """Read a ``[tolerances]`` table into distributions by dotted path, in the order of the file.

    A nested table with the key ``distribution`` is an entry. Mistakes are appended to `problems`, one sentence each; the
    drive, if given, helps to find the field that a misspelt path is close to.
    """
    found: Tolerances = {}
    for path, entry in tolerance_entries(table, problems):
        kind = field_kind(path)
        if kind is None or not kind.unit:
            scattering = [name for name, known in field_kinds().items() if known.unit]
            told = not_a_field(drive, path, scattering)
            told = told.replace(
                "is not a field of the drive definition", "is not a field of the drive that can scatter"
            )
            problems.append(f"tolerances.{printable(path)}: {told}")
            continue
        values = dict(entry)
        try:
            for name in ("tolerance", "mean"):
                if name in values:
                    bound = {"gt": 0.0} if name == "tolerance" else {}
                    values[name] = TypeAdapter(Annotated[float, quantity(kind.unit, **bound)]).validate_python(
                        values[name]
                    )
            distribution = _ADAPTER.validate_python(values)
        except ValidationError as error:
            details: list[Any] = [{**detail, "loc": detail["loc"] or (name,)} for detail in error.errors()]
            problems += describe_mistakes(details, ("tolerances", path), [item.name for item in fields(Distribution)])
            continue
        if abs(distribution.mean) >= distribution.tolerance:
            problems.append(
                f"tolerances.{path}.mean = {distribution.mean:g}: must be smaller in size than the tolerance"
            )
        elif distribution.distribution == "uniform" and "cpk" in values:
            problems.append(f"tolerances.{path}.cpk: has no meaning for a uniform distribution")
        else:
            found[path] = distribution
    return found


def tolerance_entries(table: Any, problems: list[str], prefix: str = "") -> list[tuple[str, Mapping[str, Any]]]:
    """Return the entries of a ``[tolerances]`` table by dotted path; what is no table is added to `problems`."""
    if not isinstance(table, Mapping):
        where = printable(f"tolerances.{prefix}".rstrip("."))
        problems.append(f"{where} = {shortened(table)}: must be a table with a distribution")
        return []
    entries = []
    for name, value in table.items():
        if isinstance(value, Mapping) and "distribution" in value:
            entries.append((f"{prefix}{name}", value))
        else:
            entries += tolerance_entries(value, problems, f"{prefix}{name}.")
    return entries


def nothing_scatters(drive: Drive, path: str) -> str | None:
    """Return why a field cannot scatter in a drive that is without it; None where it can."""
    if (problem := absence(drive, path)) is not None:
        return problem
    if (problem := lacks_slices(drive, path)) is not None:
        return problem
    try:
        if may_be_left_out(path):
            read_field(drive, path)
    except DriveError as error:
        return error.problems[0].partition(": ")[2]
    return None


def find_absent(tolerances: Tolerances, drives: Collection[Drive]) -> list[str]:
    """Return the problems of tolerances on fields that none of the drives has, one sentence each."""
    found: list[str] = []
    for path in tolerances:
        problems = [nothing_scatters(drive, path) for drive in drives]
        if problems and problems[0] is not None and None not in problems:
            found.append(Problem.of(f"tolerances.{path}", "", problems[0]))
    return found


def _per_disc(drive: Drive, tolerances: Tolerances) -> Tolerances:
    """Tolerances per disc where discs have values of their own; an entry for a disc replaces the common one."""
    each: Tolerances = {}
    for path, distribution in tolerances.items():
        own = own_paths(drive, path)
        if len(own) < 2:
            each[path] = distribution
        else:
            each |= {one: distribution for one in own if one not in tolerances}
    return each


@dataclass(frozen=True, slots=True, kw_only=True)
class Factors:
    """The scattering numbers of a drive in a row, which a sample draws together.

    Attributes
    ----------
    fields : tuple of (str, int or None)
        Path of each scattering field, and its number of elements if it is an array.
    centres : tuple of float
        Values of the fields in the drive, elements of arrays one by one.
    distributions : tuple of Distribution
        Distribution of each field.
    """

    fields: tuple[tuple[str, int | None], ...]
    centres: tuple[float, ...]
    distributions: tuple[Distribution, ...]

    @classmethod
    def of_tolerances(cls, drive: Drive, tolerances: Tolerances) -> Factors:
        """Return the factors of a drive; where discs have values of their own, every disc scatters independently.

        DriveError when nothing scatters, when the drive is without a scattering field, or when a scattering array has no
        elements in this drive (harmonics without orders).
        """
        found: list[tuple[str, int | None]] = []
        centres: list[float] = []
        problems: list[str] = []
        each = _per_disc(drive, tolerances)
        for path in each:
            if (problem := nothing_scatters(drive, path)) is not None:
                problems.append(Problem.of(f"tolerances.{path}", "", problem))
                continue
            count = element_count(drive, path)
            if count == 0:
                said = "has no elements to scatter in this drive; give disc.profile_errors.orders"
                problems.append(Problem.of(f"tolerances.{path}", "", said))
            found.append((path, count))
            value = read_field(drive, path)
            centres += [value] if count is None else value
        if not found and not problems:
            problems.append(
                "tolerances: is missing or empty, so nothing scatters; see the shipped drive for an example"
            )
        if problems:
            raise DriveError(problems)
        return cls(fields=tuple(found), centres=tuple(centres), distributions=tuple(each.values()))

    @property
    def paths(self) -> tuple[str, ...]:
        """Dotted path of each number, elements of arrays one by one."""
        return tuple(
            name
            for path, count in self.fields
            for name in ([path] if count is None else [f"{path}.{number}" for number in range(count)])
        )

    def draw(self, probability: FloatArray) -> FloatArray:
        """Return the values of the fields, in their units, from uniform numbers between 0 and 1: shape (samples, numbers)
        both.
        """
        drawn = np.empty_like(probability)
        column = 0
        for (_, count), distribution in zip(self.fields, self.distributions, strict=True):
            columns = slice(column, column + (count or 1))
            drawn[:, columns] = distribution.quantile(probability[:, columns])
            column = columns.stop
        return np.asarray(drawn + np.array(self.centres))

    def values(self, row: FloatArray) -> dict[str, float | tuple[float, ...]]:
        """Return the fields of one sample by path, arrays whole."""
        numbers = row.tolist()
        fields: dict[str, float | tuple[float, ...]] = {}
        column = 0
        for path, count in self.fields:
            fields[path] = numbers[column] if count is None else tuple(numbers[column : column + count])
            column += count or 1
        return fields
