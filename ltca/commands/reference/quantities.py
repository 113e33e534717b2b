"""``cyclo quantities``: names that studies, ``--minimise``, ``--subject`` and ``[limits]`` take, with unit and meaning."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from ltca.reading.arguments import DRIVE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ltca.drive.parts import Drive

SUMMARY = "names of results that studies, --minimise, --subject and [limits] take, with units and meaning"
EXAMPLES = (
    ("cyclo quantities", "all of them"),
    ("cyclo quantities --drive paper", "those that a drive has, and the limits of its file"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--drive", metavar="DRIVE", help=f"{DRIVE}: tell what it has not, and its limits")


def execute(arguments: argparse.Namespace) -> int:
    """Print both lists."""
    from ltca.quantities import LIMITED, SCALARS, unit_sign
    from ltca.studies.quantities import DEFAULT_QUANTITIES, STAGES

    lacking: Mapping[str, str] = {}
    known: Mapping[str, str] = {}
    if arguments.drive is not None:
        from ltca.reading.drive_file import load_drive

        file = load_drive(arguments.drive)
        case, drive = next(iter(file.cases.items()))
        lacking, known = _missing(drive), _judged(drive)
        known |= {
            key.partition("_")[2]: f"{limit.sense} {limit.value:g}, {limit.source}"
            for key, limit in file.limits[case].items()
        }
        print(f"{file.name} {case}\n")
    print("Studies (cyclo tolerance --quantities, quantities of a sweep, cyclo optimise --minimise and --subject);")
    print("a star: not unless named, since it costs another solution")
    for name in STAGES:
        star = "" if name in DEFAULT_QUANTITIES else " *"
        told = f" [{lacking[name]}]" if name in lacking else ""
        print(f"  {name + star:<34}{unit_sign(SCALARS[name].unit) or '–':<6}{SCALARS[name].title}{told}")
    print("\nLimits ([limits] of a drive file; max_… or min_… before the name)")
    for name, limited in LIMITED.items():
        told = f" [{known[name]}]" if name in known else ""
        print(f"  {name:<34}{unit_sign(limited.unit) or '–':<10}{limited.verdict_title}{told}")
    return 0


def _missing(drive: Drive) -> dict[str, str]:
    """Reasons why a drive lacks quantities of studies, by name."""
    from ltca.errors import DriveError
    from ltca.studies.quantities import STAGES, quantities_for

    found = {}
    for name in STAGES:
        try:
            quantities_for(drive, (name,))
        except DriveError as error:
            found[name] = error.problems[0].partition(": ")[2]
    return found


def _judged(drive: Drive) -> dict[str, str]:
    """Reasons why a drive lacks values that may be limited, by name, from half-spaces at a few positions."""
    from ltca.analysis.loaded_analysis import analyse
    from ltca.analysis.summary import summarise
    from ltca.analysis.verdict.values import find_values
    from ltca.drive.members.judgement import WHOLE
    from ltca.geometry.placement import position_angles
    from ltca.quantities import LIMITED

    analysis = analyse(drive, position_angles(POSITIONS))
    values = {value.quantity: value for value in find_values(analysis, summarise(analysis))}
    found = {}
    for name in LIMITED:
        # Of rollers one limit bounds either side; the part of the torque that is carried is told of any drive.
        told = [value for quantity, value in values.items() if quantity == name or quantity.startswith(f"{name}_")]
        if name != WHOLE.quantity and all(value.value is None for value in told):
            found[name] = told[0].reason if told else "none in this drive, or not by half-spaces"
    return found


POSITIONS = 8
"""Enough for every value to be there; none is told."""
