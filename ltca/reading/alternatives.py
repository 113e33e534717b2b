"""Sentences about contradictions that a bound of either of two fields resolves, with the fields as data."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Self

from ltca.drive.fields import read_field
from ltca.drive.parts import Drive
from ltca.errors import Problem


class Bound(NamedTuple):
    """Bound of a length, mm, with what is said beside it."""

    relation: str
    number: float
    beside: str = ""

    def __str__(self) -> str:
        """The bound as it stands in a sentence."""
        return f"{self.relation} {self.number:.6g} mm{self.beside}"


class Alternatives(Problem):
    """A sentence that names first one of two fields, either of which resolves a contradiction.

    Attributes
    ----------
    other_first : Problem
        The sentence that names the other field first.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> bounds = {"crank.eccentricity": Bound("at most", 3.0), "pin_wheel.pin_circle_radius": Bound("at least", 80.0)}
    >>> problem = Alternatives.between(drive, bounds, "the flank has loops")
    >>> problem
    'crank.eccentricity = 4 mm: must be at most 3 mm or pin_wheel.pin_circle_radius at least 80 mm, or the flank has loops'
    >>> problem.path, problem.other, problem.other_first[:44]
    ('crank.eccentricity', 'pin_wheel.pin_circle_radius', 'pin_wheel.pin_circle_radius = 88 mm: must be')
    """

    other_first: Problem

    @property
    def other(self) -> str:
        """Path of the field that is not named first."""
        return self.other_first.path

    @classmethod
    def between(cls, drive: Drive, bounds: dict[str, Bound], otherwise: str) -> Self:
        """Return the sentence on the lengths of a drive that have these bounds, two by path, and what is wrong beyond them."""
        (first, bound), (other, other_bound) = bounds.items()

        def parts(path: str, its_bound: Bound, beside: str, bound_beside: Bound) -> tuple[str, str, str]:
            return path, f"= {read_field(drive, path):g} mm", f"must be {its_bound} or {beside} {bound_beside}"

        problem = cls.of(*parts(first, bound, other, other_bound), otherwise=otherwise, bound=bound[:2])
        problem.other_first = Problem.of(
            *parts(other, other_bound, first, bound), otherwise=otherwise, bound=other_bound[:2]
        )
        return problem

    def reworded(self, reword: Callable[[str], str]) -> Self:
        """Return the sentence with other words, as of the paths of a single disc."""
        problem = super().reworded(reword)
        problem.other_first = self.other_first.reworded(reword)
        return problem


def bounded(drive: Drive, bounds: dict[str, Bound], otherwise: str) -> Problem:
    """Return the sentence on the length of a drive that has a bound, by path, or on either of two, and what is wrong beyond."""
    if len(bounds) == 2:
        return Alternatives.between(drive, bounds, otherwise)
    ((path, bound),) = bounds.items()
    value = f"= {read_field(drive, path):g} mm"
    return Problem.of(path, value, f"must be {bound}", otherwise=otherwise, bound=bound[:2])
