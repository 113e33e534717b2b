"""Sentences about contradictions that a bound of either of two fields resolves, with the fields as data."""

from __future__ import annotations

from collections.abc import Callable
from typing import Self

from ltca.drive.fields import read_field
from ltca.drive.parts import Drive


class Alternatives(str):
    """A sentence that names first one of two fields, either of which resolves a contradiction.

    Attributes
    ----------
    field, other : str
        Paths of the field named first and of the other one.
    other_first : str
        The sentence that names the other field first.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("paper").cases["CS-1"]
    >>> bounds = {"crank.eccentricity": "at most 3 mm", "pin_wheel.pin_circle_radius": "at least 80 mm"}
    >>> problem = Alternatives.of(drive, bounds, ", or the flank has loops")
    >>> problem
    'crank.eccentricity = 4 mm: must be at most 3 mm or pin_wheel.pin_circle_radius at least 80 mm, or the flank has loops'
    >>> problem.other, problem.other_first[:44]
    ('pin_wheel.pin_circle_radius', 'pin_wheel.pin_circle_radius = 88 mm: must be')
    """

    field: str
    other: str
    other_first: str

    @classmethod
    def of(cls, drive: Drive, bounds: dict[str, str], consequence: str) -> Self:
        """Return the sentence on the lengths of a drive that have these bounds, two by path, and what is wrong beyond them."""
        (field, bound), (other, other_bound) = bounds.items()

        def sentence(first: str, its_bound: str, second: str, second_bound: str) -> str:
            return f"{first} = {read_field(drive, first):g} mm: must be {its_bound} or {second} {second_bound}{consequence}"

        problem = cls(sentence(field, bound, other, other_bound))
        problem.field, problem.other = field, other
        problem.other_first = sentence(other, other_bound, field, bound)
        return problem

    def reworded(self, reword: Callable[[str], str]) -> Self:
        """Return the sentence with other words, as of the paths of a single disc."""
        problem = type(self)(reword(self))
        problem.field, problem.other, problem.other_first = map(reword, (self.field, self.other, self.other_first))
        return problem
