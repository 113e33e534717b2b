"""Measured flanks in a drive file: ``disc.measured_flank``, and those of single discs in ``disc.of``.

They are read into profile errors, which every engine uses.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ltca.drive.deviations import OneDisc, ProfileErrors
from ltca.drive.parts import Drive
from ltca.drive.single_discs import single_discs
from ltca.errors import DriveError, printable, shortened
from ltca.reading.measured.deviation import measured_errors
from ltca.reading.measured.points import MeasuredPoints, read_points
from ltca.reading.physical_checks import find_contradictions

FIELD = "measured_flank"

FILTER = "the spline of a measured flank passes through every point: filter noise, or leave points out"

Named = dict[int | None, Any]
"""File names by disc; None for all discs."""


def without_files(table: Mapping[str, Any]) -> tuple[dict[str, Any], Named]:
    """Return the tables of a drive file, partly validated perhaps, without the files of measured flanks, and these files."""
    disc = table.get("disc")
    if not isinstance(disc, dict):
        return dict(table), {}
    named: Named = {None: disc[FIELD]} if FIELD in disc else {}
    left = {name: value for name, value in disc.items() if name != FIELD}
    entries = disc.get("of")
    if isinstance(entries, list):
        for number, entry in enumerate(entries):
            if isinstance(entry, dict) and FIELD in entry:
                named[number] = entry[FIELD]
        left["of"] = [_without(entry) for entry in entries]
    return {**table, "disc": left}, named


def _without(entry: Any) -> Any:
    return {name: value for name, value in entry.items() if name != FIELD} if isinstance(entry, dict) else entry


class MeasuredFiles:
    """Measured flanks of one drive file, with paths relative to its folder; every file is read once for all cases."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._read: dict[str, MeasuredPoints] = {}

    def with_measured(self, drive: Drive, named: Named, problems: list[str]) -> Drive:
        """Return a drive with the deviations of its measured flanks (`without_files`); mistakes are appended to `problems`."""
        if find_contradictions(drive):
            return drive  # there is no flank to measure from; the caller reports them
        for disc, name in named.items():
            path = f"disc.{FIELD}" if disc is None else f"disc.of.{disc}.{FIELD}"
            try:
                drive = self._with_one(drive, disc, name)
            except DriveError as error:
                where = f": {printable(error.source)}:" if error.source else ""
                problems += [f"{path}{where} {problem}" for problem in error.problems]
                continue
            # Points that leave no flank are reported with their file.
            for problem in find_contradictions(drive):
                problems.append(f"{path}: {self._folder / name}: {problem.said or problem}; {FILTER}")
        return drive

    def _with_one(self, drive: Drive, disc: int | None, name: Any) -> Drive:
        if not isinstance(name, str) or not name.strip():
            raise DriveError([f"= {shortened(name)}: must be the name of a CSV file, relative to the drive file"])
        own = drive.disc.of[disc].profile_errors if disc is not None else drive.disc.profile_errors
        if own is not None and not (own.is_zero and not own.parameter):
            beside = "disc.profile_errors" if disc is None else f"disc.of.{disc}.profile_errors"
            raise DriveError([f"= {shortened(name)}: holds all of the deviation; leave out {beside}, or its numbers"])
        cold = replace(drive, temperature=None)
        single = single_discs(cold)[disc or 0]
        single = replace(single, disc=replace(single.disc, profile_errors=own or drive.disc.profile_errors))
        errors = measured_errors(single, self._points(name))
        if disc is None:
            return replace(drive, disc=replace(drive.disc, profile_errors=errors))
        entries = list(drive.disc.of)
        entries[disc] = _with_errors(entries[disc], errors)
        return replace(drive, disc=replace(drive.disc, of=tuple(entries)))

    def _points(self, name: str) -> MeasuredPoints:
        if name not in self._read:
            self._read[name] = read_points(self._folder / name)
        return self._read[name]


def _with_errors(entry: OneDisc, errors: ProfileErrors) -> OneDisc:
    return replace(entry, profile_errors=errors)
