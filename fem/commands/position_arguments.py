"""Arguments that the commands of one position share: which drive, case, crank angle and element edge."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.errors import CycloError
from ltca.reading.arguments import (
    add_angle_argument,
    add_case_argument,
    add_drive_argument,
    add_size_argument,
    default_folder,
)

if TYPE_CHECKING:
    from ltca.drive.parts import Drive


def add_drive_arguments(parser: argparse.ArgumentParser) -> None:
    """Add drive file and case."""
    add_drive_argument(parser)
    add_case_argument(parser, "case; default the first", several=False)


def add_position_arguments(parser: argparse.ArgumentParser) -> None:
    """Add drive file, case, crank angle and element edge."""
    add_drive_arguments(parser)
    add_angle_argument(parser)
    add_size_argument(parser, "element edge as a multiple of the default of 8 elements for each contact half-width")


def chosen_drive(arguments: argparse.Namespace) -> tuple[str, str, Drive]:
    """Return the name of the drive file, the name of the case and its drive.

    Raises
    ------
    CycloError
        When the file is broken or has no such case.
    """
    from ltca.reading.drive_file import load_drive

    file = load_drive(arguments.drive)
    case, drive = next(iter(file.select([arguments.case] if arguments.case else None).items()))
    return file.name, case, drive


def output_folder(arguments: argparse.Namespace, name: str, command: str) -> Path:
    """Return the folder of ``--out``, or the default one of a command; it need not be there yet.

    Parameters
    ----------
    arguments : argparse.Namespace
        With ``out``.
    name, command : str
        Of the drive and of the command.

    Raises
    ------
    CycloError
        When there is a file in its place.
    """
    out = Path(arguments.out or default_folder(name, command))
    if out.exists() and not out.is_dir():
        raise CycloError(f"--out {out}: is a file, not a folder")
    return out
