"""Cause of contradictions: the field that alone can resolve all of them, not the one whose bound is violated."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import exp, log
from typing import Any

from ltca.drive.fields import read_field
from ltca.drive.parts import Drive
from ltca.errors import DriveError, Problem
from ltca.geometry.interference import ROUNDING, drawn_interference
from ltca.reading.disc_checks import has_loops, hole_that_fits, largest_eccentricity, rounded_down
from ltca.reading.physical_checks import is_sound

CAUSES = (
    "pin_wheel.pin_circle_radius", "crank.eccentricity", "pin_wheel.pin_radius", "disc.thickness",
    "disc.equidistant_offset", "disc.shifting_offset", "crank_bearing.inner_race_radius",
    "crank_bearing.outer_race_radius", "crank_bearing.roller_radius", "crank_bearing.roller_length",
    "crank.circle_radius", "pin_shaft.pin_circle_radius", "pin_shaft.pin_radius", "pin_shaft.hole_radius", "clearance.bearing",
    "clearance.pin_hole", "pin_wheel.seat.radius", "pin_wheel.seat.pin_radius", "pin_wheel.seat.bore_radius",
    "pin_shaft.seat.pin_radius", "pin_shaft.seat.bore_radius",
)  # fmt: skip
# Fields of a part that are easily exchanged, the smaller first.
SWAPPED = (("crank_bearing", "inner_race_radius", "outer_race_radius"), ("pin_shaft", "pin_radius", "hole_radius"))
# Modifications of the flank are hundredths of the pin radius; one beyond this fraction of it is the likeliest mistake.
OFFSETS = ("disc.equidistant_offset", "disc.shifting_offset")
LARGE_OFFSET = 0.2
# Logarithmic steps beyond the bound of one case that are tried for another.
FARTHER = (0.0, 0.01, 0.1)
COUNTS = ("pin_shaft.number_of_pins", "crank_bearing.number_of_rollers")
# Whole numbers and lengths that are no likely cause, but may be what was changed.
CHANGED_COUNTS = (*COUNTS, "pin_wheel.number_of_pins", "disc.number_of_discs")
CHANGED = (*CAUSES, *CHANGED_COUNTS, "disc.gap")
# Logarithms of the changes that are tried, from 1 % to a wrong prefix: steps of 1.12 up to five times, as fine as a hole
# bounds the eccentricity; then of 1.22.
SIZES = (0.01, 0.03, 0.06, *(0.113 * k for k in range(1, 15)), *(1.6 + 0.2 * k for k in range(40)))


Mend = Callable[[Drive], bool]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """A field that alone can resolve all contradictions of a drive.

    Attributes
    ----------
    path : str
        The field.
    value, bound : float
        Its value, and the nearest sound value, mm.
    alone : bool
        Whether it is the only sound value about there, of a number that others have to go with.
    """

    path: str
    value: float
    bound: float
    alone: bool = False

    @property
    def distance(self) -> float:
        """Logarithm of the ratio of bound and value."""
        return abs(log(self.bound / self.value))

    def rounded(self) -> tuple[str, float]:
        """Return the relation and the number of the bound, rounded to the sound side."""
        least = self.bound > self.value
        if self.alone:
            return "equal to", self.bound
        relation = "at least" if least else "at most"
        if self.path in CHANGED_COUNTS:
            return relation, self.bound
        return relation, -rounded_down(-self.bound) if least else rounded_down(self.bound)

    def bounded(self) -> str:
        """Return the bound in words."""
        relation, number = self.rounded()
        words = f"{number:g}" if relation == "equal to" else f"{relation} {number:g}"
        return words if self.alone or self.path in CHANGED_COUNTS else f"{words} mm"

    def mends(self, drive: Drive) -> bool:
        """Tell whether a similar drive is sound with the field at its bound, or a little beyond."""
        if self.path in COUNTS:
            return _sound_with(drive, self.path, self.bound)
        away = 1.0 if abs(self.bound) > abs(self.value) else -1.0
        return any(_sound_with(drive, self.path, self.bound * exp(away * step)) for step in FARTHER)

    def problem(self, problems: Sequence[Problem], instead: str = "") -> Problem:
        """Return the sentence on the field that stands for these contradictions; `instead` is another field with its bound."""
        value = f"= {self.value:g}" + ("" if self.path in CHANGED_COUNTS else " mm")
        reasons = "; ".join(dict.fromkeys(problem.reason(self.path) for problem in problems[:2]))
        said = f"must be {self.bounded()}{instead} for the rest of the drive: {reasons}"
        return Problem.of(self.path, value, said, bound=self.rounded())


def explain_contradictions(drive: Drive, problems: list[Problem]) -> list[Problem]:
    """Return one sentence on the field that causes all contradictions of a drive, or the contradictions themselves if there
    is none.

    They are those of `ltca.reading.physical_checks.find_contradictions`.
    """
    return find_cause(drive, problems)[0]


def find_cause(drive: Drive, problems: list[Problem]) -> tuple[list[Problem], Mend]:
    """Return the explanation of contradictions (`explain_contradictions`), and whether its field resolves those of another
    drive.

    The second result is a function of that drive.
    """
    if not problems:
        return [], lambda other: False
    named = {problem.path for problem in problems}
    if not all(
        path in COUNTS or (path in CAUSES and _has(drive, path) and read_field(drive, path) > 0.0) for path in named
    ):
        return problems, lambda other: False  # deviations and negative offsets are the cause themselves
    for part, smaller, larger in SWAPPED:
        if getattr(drive, part) is None:
            continue
        if getattr(getattr(drive, part), smaller) > getattr(getattr(drive, part), larger) and _sound_swapped(
            drive, part
        ):
            value, most = (getattr(getattr(drive, part), name) for name in (smaller, larger))
            said = f"must be less than {larger} = {most:g} mm; the two seem to be swapped"
            swapped = Problem.of(f"{part}.{smaller}", f"= {value:g} mm", said, bound=("less than", most))
            return [swapped], partial(_sound_swapped, part=part)
    if len(problems) == 1 and has_loops(drive) and _sound_without_loops(drive):
        return problems, _sound_without_loops
    causes = sorted(_causes(drive), key=lambda cause: cause.distance)
    if not causes:
        return problems, lambda other: False
    large = LARGE_OFFSET * drive.pin_wheel.pin_radius
    offsets = [cause for cause in causes if cause.path in OFFSETS and abs(cause.bound) < abs(cause.value) > large]
    # A field that is named already and resolves everything needs no other message.
    if len(named) == 1 and named <= {cause.path for cause in offsets or causes}:
        (own,) = (cause for cause in causes if cause.path in named)
        return problems, own.mends
    causes = offsets or causes
    # A field that violates a bound itself is likelier, unless another is very much nearer to a sound value.
    least = causes[0].distance
    near = [cause for cause in causes if cause.distance <= 10.0 * least]
    first, *others = sorted(near, key=lambda cause: (cause.path not in named, cause.distance))
    instead = "".join(
        f" (or {cause.path} {cause.bounded()})" for cause in others[:1] if cause.distance <= 2.5 * first.distance
    )
    return [first.problem(problems, instead)], first.mends


def explain_change(before: Drive, after: Drive, path: str, problems: list[Problem]) -> list[Problem]:
    """Return one sentence on the only field that was changed, or the contradictions where they name it or its bound is not known.

    The bound is the last sound value on the way from a sound drive to the changed one: where the flank is undercut, another field
    than the changed one may be named, and be sound itself.
    """
    named = all(problem.is_about(path) for problem in problems)
    if named or path not in CHANGED or not (_has(before, path) and _has(after, path) and is_sound(before)):
        return problems
    if path in CHANGED_COUNTS:
        return [_last_sound_count(before, after, path).problem(problems)]
    sound, wrong = float(read_field(before, path)), float(read_field(after, path))
    value = wrong
    for _ in range(20):
        middle = 0.5 * (sound + wrong)
        sound, wrong = (middle, wrong) if _sound_with(after, path, middle) else (sound, middle)
    return [Cause(path=path, value=value, bound=_without_overlap(after, path, sound)).problem(problems)]


def _last_sound_count(before: Drive, after: Drive, path: str) -> Cause:
    """The last sound whole number on the way from that of a sound drive to a changed one."""
    value, sound = int(read_field(after, path)), int(read_field(before, path))
    wrong = value
    while abs(wrong - sound) > 1:
        middle = (sound + wrong) // 2
        sound, wrong = (middle, wrong) if _sound_with(after, path, middle) else (sound, middle)
    beyond = 2 * sound - wrong  # on the other side of it
    return Cause(path=path, value=value, bound=sound, alone=not _sound_with(after, path, beyond))


def _sound_swapped(drive: Drive, part: str) -> bool:
    """Tell whether a drive is sound with two fields of a part exchanged."""
    (names,) = ((smaller, larger) for name, smaller, larger in SWAPPED if name == part)
    own = getattr(drive, part)
    try:
        changed: Any = replace(own, **{names[0]: getattr(own, names[1]), names[1]: getattr(own, names[0])})
        return is_sound(replace(drive, **{part: changed}))
    except (ValueError, ArithmeticError):
        return False


def _causes(drive: Drive) -> Iterator[Cause]:
    for path in CAUSES:
        if not _has(drive, path):
            continue
        value = float(read_field(drive, path))
        if value == 0.0 or (value < 0.0 and path not in OFFSETS):
            continue
        fitting = _fitting(drive, path)
        if fitting > 0.0 and fitting != value and _sound_with(drive, path, fitting):
            bound = _nearest(drive, path, value, log(fitting / value))
            yield Cause(path=path, value=value, bound=_without_overlap(drive, path, bound))
            continue
        for size in (sign * size for size in SIZES for sign in (1.0, -1.0)):
            if _sound_with(drive, path, value * exp(size)):
                bound = _nearest(drive, path, value, size)
                yield Cause(path=path, value=value, bound=_without_overlap(drive, path, bound))
                break
    for path in COUNTS:
        if not _has(drive, path):
            continue
        count = int(read_field(drive, path))
        for other in (other for step in range(1, 200) for other in (count - step, count + step)):
            if other >= 3 and _sound_with(drive, path, other):
                yield Cause(path=path, value=count, bound=other)
                break


def _has(drive: Drive, path: str) -> bool:
    """Tell whether a drive has a field; one without pin shaft, with one crank or with fixed pins lacks some."""
    try:
        read_field(drive, path)
    except DriveError:
        return False
    return True


def _fitting(drive: Drive, path: str) -> float:
    """Value that follows from the other fields where there is little room, mm; 0 for other fields."""
    bearing = drive.crank_bearing
    return {
        "crank_bearing.inner_race_radius": bearing.outer_race_radius - 2.0 * bearing.roller_radius,
        "crank_bearing.outer_race_radius": bearing.inner_race_radius + 2.0 * bearing.roller_radius,
        "crank_bearing.roller_radius": 0.5 * (bearing.outer_race_radius - bearing.inner_race_radius),
    }.get(path, 0.0)


def _without_overlap(drive: Drive, path: str, bound: float) -> float:
    """The nearest sound value of a field, or the exact fit where rollers or shaft pins would overlap at it as far as they may."""
    drawn, shaft = drawn_interference(_with(drive, path.split("."), bound)), drive.pin_shaft
    overlap, fit = drawn.rollers, _fitting(drive, path)
    if shaft is not None and (path == "crank.eccentricity" or path.startswith("pin_shaft.")):
        play = shaft.hole_radius - shaft.pin_radius + shaft.seat_play
        overlap, fit = (
            drawn.holes,
            {
                "crank.eccentricity": play,
                "pin_shaft.hole_radius": hole_that_fits(drive, drive.crank.eccentricity),
                "pin_shaft.pin_radius": shaft.pin_radius + play - drive.crank.eccentricity,
            }.get(path, 0.0),
        )
    return fit if overlap > ROUNDING and fit > 0.0 and _sound_with(drive, path, fit) else bound


def _sound_without_loops(drive: Drive) -> bool:
    """Tell whether a drive is sound with the largest eccentricity that leaves its flank no loops, and holes that fit."""
    most = rounded_down(largest_eccentricity(drive))
    changed = _with(drive, ["crank", "eccentricity"], most) if most > 0.0 else drive
    if drive.pin_shaft is not None and not _sound_with(drive, "crank.eccentricity", most):
        return _sound_with(changed, "pin_shaft.hole_radius", hole_that_fits(drive, most))
    return most > 0.0 and is_sound(changed)


def _nearest(drive: Drive, path: str, value: float, size: float) -> float:
    """Sound value nearest to the present one, by bisection between it and a sound one."""
    wrong, sound = 0.0, size
    for _ in range(16):
        middle = 0.5 * (wrong + sound)
        if _sound_with(drive, path, value * exp(middle)):
            sound = middle
        else:
            wrong = middle
    return value * exp(sound)


def _sound_with(drive: Drive, path: str, value: float) -> bool:
    try:
        return is_sound(_with(drive, path.split("."), value))
    except (ValueError, ArithmeticError):
        return False


def _with(part: Any, names: list[str], value: float) -> Any:
    """A definition with one field, by its path, replaced."""
    name, *below = names
    return replace(part, **{name: _with(getattr(part, name), below, value) if below else value})
