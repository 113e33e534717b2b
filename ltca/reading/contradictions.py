"""Which field is behind a contradiction: the one that alone can mend all of it, not the one whose bound it breaks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import exp, log
from typing import Any

from ltca.drive.fields import read_field
from ltca.drive.parts import Drive
from ltca.reading.physical_checks import is_sound

CAUSES = (
    "pin_wheel.pin_circle_radius", "crank.eccentricity", "pin_wheel.pin_radius", "disc.thickness",
    "disc.equidistant_offset", "disc.shifting_offset", "crank_bearing.inner_race_radius",
    "crank_bearing.outer_race_radius", "crank_bearing.roller_radius", "crank_bearing.roller_length",
    "pin_shaft.pin_circle_radius", "pin_shaft.pin_radius", "pin_shaft.hole_radius", "clearance.bearing",
    "clearance.pin_hole",
)  # fmt: skip
# Steps of 1.12 (a hole leaves the eccentricity a factor of 1.5), from a typing error of a hundred down to one of 1 %.
FACTORS = tuple(exp(sign * size) for size in (0.01, 0.03, 0.06, *(0.113 * k for k in range(1, 42))) for sign in (1, -1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A field that alone can mend a drive.

    Attributes
    ----------
    path : str
        The field.
    value, bound : float
        What it is, and the nearest value that is sound, mm.
    """

    path: str
    value: float
    bound: float

    @property
    def distance(self) -> float:
        """How far off the field is, as a logarithm."""
        return abs(log(self.bound / self.value))

    def bounded(self) -> str:
        """Return the bound in words, rounded to the sound side."""
        least = self.bound > self.value
        text = f"{self.bound * (1.0 + (5e-5 if least else -5e-5)):.4g}"
        return f"{'at least' if least else 'at most'} {text} mm"


def explain_contradictions(drive: Drive, problems: list[str]) -> list[str]:
    """Return contradictions with the field that causes them in the place of those that suffer from it.

    Parameters
    ----------
    drive : Drive
        What they were found in.
    problems : list of str
        Of `ltca.reading.physical_checks.find_contradictions`.

    Returns
    -------
    list of str
        One sentence that names the cause, when one field mends all; otherwise the problems as they are.
    """
    if not problems:
        return []
    named = {problem.partition(" ")[0].rstrip(":") for problem in problems}
    causes = sorted(_causes(drive), key=lambda cause: cause.distance)
    # A field that is named already and mends everything is said well enough.
    if not causes or (len(named) == 1 and named <= {cause.path for cause in causes}):
        return problems
    first, *others = causes
    instead = "".join(f" (or {cause.path} {cause.bounded()})" for cause in others[:1] if cause.distance < 2 * first.distance)
    reasons = "; ".join(dict.fromkeys(_consequence(problem) for problem in problems[:2]))
    return [f"{first.path} = {first.value:g} mm: must be {first.bounded()}{instead} for the rest of the drive: {reasons}"]


def _causes(drive: Drive) -> Iterator[Cause]:
    for path in CAUSES:
        value = float(read_field(drive, path))
        if value <= 0.0:
            continue
        for factor in FACTORS:
            if _sound_with(drive, path, value * factor):
                yield Cause(path=path, value=value, bound=_nearest(drive, path, value, factor))
                break


def _nearest(drive: Drive, path: str, value: float, factor: float) -> float:
    """Sound value nearest to the present one, by bisection between it and one that is known to be sound."""
    wrong, sound = 0.0, log(factor)
    for _ in range(18):
        middle = 0.5 * (wrong + sound)
        if _sound_with(drive, path, value * exp(middle)):
            sound = middle
        else:
            wrong = middle
    return value * exp(sound)


def _sound_with(drive: Drive, path: str, value: float) -> bool:
    part, name = path.split(".")
    try:
        changed: Any = replace(getattr(drive, part), **{name: value})
        return is_sound(replace(drive, **{part: changed}))
    except (ValueError, ArithmeticError):
        return False


def _consequence(problem: str) -> str:
    """What a contradiction says beside its own bound."""
    if match := re.search(r"(?:, or (?:the |these )?)(.+)$", problem):
        return match.group(1)
    head, _, tail = problem.partition(": ")
    return f"{head} {'' if tail.startswith('must') else 'says that '}{tail.partition('; must')[0]}".replace(" says that", ":")
