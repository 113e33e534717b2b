"""Arguments that the commands of one position share: which drive, case, crank angle and element edge."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.errors import CycloError

if TYPE_CHECKING:
    from ltca.drive.parts import Drive


def add_drive_arguments(parser: argparse.ArgumentParser) -> None:
    """Add drive file and case."""
    parser.add_argument("drive", help="drive file (TOML), or 'paper' for the drive that ships with cyclo")
    parser.add_argument("--case", metavar="NAME", help="case of the drive file; its first one by default")


def add_position_arguments(parser: argparse.ArgumentParser) -> None:
    """Add drive file, case, crank angle and element edge."""
    add_drive_arguments(parser)
    parser.add_argument("--angle", type=float, default=0.0, metavar="PHI", help="crank angle, rad (default 0)")
    parser.add_argument(
        "--size",
        type=float,
        default=1.0,
        metavar="S",
        help="element edge as a multiple of the default of 8 elements for each contact half-width; 0.5 halves it",
    )


def check_position_arguments(arguments: argparse.Namespace) -> None:
    """Refuse a crank angle or an element edge that is none.

    Raises
    ------
    CycloError
        Naming the argument.
    """
    import math

    angle, size = arguments.angle, arguments.size
    if not math.isfinite(angle):
        raise CycloError(f"--angle {angle:g}: must be a finite number (rad)")
    if not (math.isfinite(size) and size > 0.0):
        raise CycloError(f"--size {size:g}: must be a finite number greater than 0 (a multiple of the default edge)")


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


def output_folder(arguments: argparse.Namespace) -> Path:
    """Return the folder of ``--out``; it need not be there yet.

    Raises
    ------
    CycloError
        When there is a file in its place.
    """
    out = Path(arguments.out)
    if out.exists() and not out.is_dir():
        raise CycloError(f"--out {out}: is a file, not a folder")
    return out
