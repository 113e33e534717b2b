"""Physical checks of a drive: contradictions between numbers that are valid by themselves."""

from __future__ import annotations

from dataclasses import replace

from ltca.drive.members.temperatures import temperature_words, warm_drive
from ltca.drive.parts import Drive, Temperature
from ltca.drive.single_discs import single_discs, without_own
from ltca.drive.unit_mistakes import kelvin_words
from ltca.errors import DriveError, Problem
from ltca.geometry.interference import lost_play
from ltca.reading.disc_checks import CHECKS, find_disc_problems
from ltca.reading.member_checks import find_member_problems, named_in_disc


def find_contradictions(drive: Drive) -> list[Problem]:
    """Return every physical contradiction of a drive whose single numbers are valid, one sentence each; empty for a sound
    drive.

    Sentences have field, value, bound and unit; the field is data as well (`Problem.path`).
    """
    problems = [*find_member_problems(drive)]
    if problems:
        return problems
    if drive.temperature is not None:
        return _find_at_temperatures(drive)
    common = single_discs(without_own(drive))[0]
    problems = find_disc_problems(common)
    for number, single in enumerate(single_discs(drive)):
        if single is common:
            continue
        alike = replace(single, disc=replace(single.disc, phases=common.disc.phases, planes=common.disc.planes))
        if alike != common:
            own = [named_in_disc(drive, problem, number) for problem in find_disc_problems(single)]
            problems += [problem for problem in own if problem not in problems]
    return problems


def _find_at_temperatures(drive: Drive) -> list[Problem]:
    """Contradictions of the drive at 20 °C or, where there are none, at its temperatures."""
    cold = _cold(drive)
    if problems := find_contradictions(cold):
        return problems
    try:
        warm = warm_drive(drive)
    except DriveError as error:
        return [problem if isinstance(problem, Problem) else Problem(problem) for problem in error.problems]
    problems = find_contradictions(warm)
    if not problems or drive.temperature is None:
        return problems
    at = kelvin_words(drive) or f"temperature: {temperature_words(drive.temperature)}"
    if gone := lost_play(cold, warm):
        seizes = f"the drive seizes, {'; '.join(gone)}; parts overlap by more than bodies yield elastically"
        return [Problem.of("temperature", "", seizes, shown=at)]
    return [problem.within("temperature", at) for problem in problems]


def _cold(drive: Drive) -> Drive:
    """The drive at 20 °C, without materials that are given for their expansion alone."""
    return warm_drive(replace(drive, temperature=Temperature()))


def is_sound(drive: Drive) -> bool:
    """Tell whether a drive has no contradictions; faster than `find_contradictions`, since cheap checks come first."""
    if next(find_member_problems(drive), None) is not None:
        return False
    if drive.temperature is not None:
        try:
            return is_sound(_cold(drive)) and is_sound(warm_drive(drive))
        except DriveError:
            return False
    singles = single_discs(drive)
    if len(singles) > 1:  # of discs that are alike one is enough
        alike = {replace(each, disc=replace(each.disc, phases=(), planes=())): each for each in singles}
        singles = tuple(alike.values())
    return all(next(iter(check(single)), None) is None for single in singles for check in CHECKS)
