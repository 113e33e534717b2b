"""Entries of a duty that ask more than the load: the worst of their values beside those of the load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from ltca.analysis.life.bearing_lives import at_entry
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.summary import summarise
from ltca.drive.members.judgement import Value
from ltca.errors import OverloadError
from ltca.quantities import LIMITED

FindValues = Callable[..., list[Value]]


def worst_of_duty(analysis: LoadedAnalysis, values: Sequence[Value], find_values: FindValues) -> list[Value]:
    """Return the values of a case, where an entry of its duty has a larger one that, with the entry as its part.

    Parameters
    ----------
    analysis : LoadedAnalysis
        The case at its load.
    values : sequence of Value
        Of it.
    find_values : callable
        ``find_values(analysis, summary, lives=False)`` returns values alike for an entry.

    Raises
    ------
    DriveError, ConvergenceError
        When an entry has no answer; it is named. One that bodies cannot carry is a value of its own.
    """
    found = list(values)
    for number, entry in _heavier(analysis):
        if isinstance(entry, OverloadError):
            carried = analysis.torque / analysis.drive.duty[number].torque
            part = f"duty.{number}, of which the load is carried"
            found.insert(0, Value(quantity="carried_torque", value=carried, part=part))
            continue
        others = {one.quantity: one for one in find_values(entry, summarise(entry), lives=False)}
        for at, value in enumerate(found):
            other = others.get(value.quantity, value) if LIMITED[value.quantity].by_load else value
            if other.value is not None and (value.value is None or other.value > value.value):
                found[at] = replace(other, part=f"{other.part} in duty.{number}".strip())
    return found


def _heavier(analysis: LoadedAnalysis) -> Iterator[tuple[int, LoadedAnalysis | OverloadError]]:
    """Entries that are heavier or quicker than the load, solved at the same positions by the same engine."""
    if not analysis.drive.duty:
        return
    drive, speed = analysis.drive, analysis.drive.load.speed
    for number, entry in enumerate(drive.duty):
        quicker = drive.friction is not None and (
            speed is None or entry.speed > speed
        )  # what goes with speed is friction's
        if entry.torque <= analysis.torque and not quicker:
            continue
        try:
            yield number, at_entry(analysis, number)
        except OverloadError as error:
            yield number, error
