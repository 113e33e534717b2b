"""Options of ``cyclo dynamics --time``."""

from __future__ import annotations

import argparse

from ltca.errors import DriveError
from ltca.reading.arguments import quantity_argument

MOTIONS = ("steady", "start", "ramp", "step", "reverse", "sine")
"""Names of `ltca.analysis.time_run.MOTIONS`, without its import."""
OPTIONS = ("motion", "driven_by", "within", "at", "from_speed", "factor", "amplitude", "frequency")
LONGEST = 3600.0
"""Longest run, s."""


def add_time_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of a run in time."""
    group = parser.add_argument_group("in time")
    group.add_argument(
        "--time",
        metavar="SECONDS",
        type=quantity_argument("--time", "s", gt=0.0, le=LONGEST),
        help="run the drive in time that long (or a text such as '200 ms') at --speed, load.speed by default; writes time.nc and "
        "time.json in place of the modes",
    )
    group.add_argument(
        "--motion",
        choices=MOTIONS,
        help="steady (default): evenly under the load; start: from rest; ramp: from one speed to the other; step: the torque "
        "changes by a factor; reverse: it changes its sign, through the play; sine: it swings",
    )
    group.add_argument(
        "--driven-by",
        choices=("speed", "torque"),
        help="whether the input turns as told (default) or inertia.input is driven by the even torque that balances load and "
        "friction in the mean of a turn",
    )
    for option, unit, words in (
        ("--within", "s", "time that start, step or reverse takes; default a tenth of the whole"),
        ("--at", "s", "when step or reverse begins; default half the whole time"),
        ("--from-speed", "rpm", "first speed of a ramp; default 0"),
        ("--frequency", "Hz", "of the torque of a sine"),
    ):
        name = option.removeprefix("--").replace("-", "_").upper()
        group.add_argument(option, metavar=name, type=quantity_argument(option, unit, ge=0.0), help=words)
    for option, words in (
        ("--factor", "torque after a step by that before; default 2"),
        ("--amplitude", "of the torque of a sine, by the load; default 0.5"),
    ):
        name = option.removeprefix("--").upper()
        group.add_argument(option, metavar=name, type=quantity_argument(option, "dimensionless"), help=words)
    group.add_argument(
        "--resume", action="store_true", help="continue an interrupted run in time in the folder of --out"
    )


def check_time_arguments(arguments: argparse.Namespace, positions: int) -> None:
    """Refuse options without effect: those of a run in time without one, those of modes with one.

    `positions` is the default of ``--positions``.
    """
    problems = []
    if arguments.time is None:
        given = [name for name in OPTIONS if getattr(arguments, name) is not None]
        given += ["resume"] if arguments.resume else []
        problems = [f"--{name.replace('_', '-')}: has no effect without --time; leave it out" for name in given]
    else:
        if arguments.positions != positions:
            problems.append(f"--positions = {arguments.positions}: has no effect with --time; leave it out")
        if arguments.turns is not None:
            problems.append(f"--turns = {arguments.turns}: has no effect with --time; leave it out")
    if problems:
        raise DriveError(problems)
