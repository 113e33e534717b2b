"""Arguments shared by the commands of one position: drive, case, crank angle and element edge."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ltca.reading.arguments import (
    add_angle_argument,
    add_case_argument,
    add_drive_argument,
    add_size_argument,
    refuse_impossible_torques,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from ltca.drive.parts import Drive
    from ltca.reading.drive_file import DriveFile


BODIES = ("disc", "inner_race", *(f"{part}_[0-9]*" for part in ("inner_race", "pin", "roller", "shaft_pin")))
"""Names of all bodies, those of pins, rollers and inner races of several cranks as patterns."""


def disc_prefix(disc: int, discs: int) -> str:
    """Return the prefix of the names of files of one disc, empty where it is the only one."""
    return "" if discs == 1 else f"disc_{disc}_"


def body_files(ending: str, discs: int) -> list[str]:
    """Return the names of all files of bodies with an ending, those of pins and rollers as patterns."""
    names = BODIES if discs == 1 else ("disc_[0-9]*",)
    return [f"{name}.{ending}" for name in names]


def add_position_arguments(parser: argparse.ArgumentParser) -> None:
    """Add drive file, case, crank angle and element edge."""
    add_drive_argument(parser)
    add_case_argument(parser, "case; default the first", several=False)
    add_angle_argument(parser)
    add_size_argument(parser, "element edge as a multiple of the default of 8 elements for each contact half-width")


def chosen_drive(arguments: argparse.Namespace) -> tuple[str, str, Drive]:
    """Return the name of the drive file, the name of the case and its drive; see `chosen_case`."""
    file, case, drive = chosen_case(arguments)
    return file.name, case, drive


def chosen_case(arguments: argparse.Namespace) -> tuple[DriveFile, str, Drive]:
    """Return the drive file, the name of the case and its drive."""
    from ltca.reading.drive_file import load_drive

    file = load_drive(arguments.drive)
    case, drive = next(iter(file.select_warm([arguments.case] if arguments.case else None).items()))
    if hasattr(arguments, "torque"):
        refuse_impossible_torques([file.cases[case]], arguments.torque, duty=False)
    tell_unit_mistakes([file.cases[case]], getattr(arguments, "torque", None))
    return file, case, drive
