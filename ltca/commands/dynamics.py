"""``cyclo dynamics``: eigenfrequencies and modes, Campbell diagram, critical speeds, response over speed; runs in time."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    OpenedDrives,
    add_compliance_arguments,
    find_coefficients_of,
    open_drives,
)
from ltca.commands.time_arguments import add_time_arguments, check_time_arguments
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    quantity_argument,
)

SUMMARY = "eigenfrequencies and modes under load, Campbell diagram, critical speeds, response over speed; run in time"
EXAMPLES = (
    (
        "cyclo dynamics my.toml",
        "modes over a turn and over torque, critical speeds, forces by orders; dynamics.json, dynamics.nc",
    ),
    ("cyclo dynamics my.toml --speed '3000 rpm'", "up to that speed of the input"),
    (
        "cyclo dynamics my.toml --time '200 ms' --speed '1500 rpm' --motion start",
        "in time, from rest to that speed; time.nc and time.json",
    ),
)
FIGURES = ("campbell_diagram", "response")
POSITIONS = 24


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 4, 1000),
        default=POSITIONS,
        help="crank angles of a turn at which modes are told, and the stiffness, whose orders ask for some by themselves; "
        f"default {POSITIONS}",
    )
    parser.add_argument(
        "--turns",
        metavar="N",
        type=count_argument("--turns", 1, 1000),
        help="crank turns behind the orders of the transmission error; default the fewest that tell them apart",
    )
    parser.add_argument(
        "--speed",
        metavar="N",
        type=quantity_argument("--speed", "rpm", gt=0.0),
        help="largest speed of the input in turns a minute (or a text such as '3000 rpm'); default the largest of [[duty]], "
        "load.speed, or 3000",
    )
    add_time_arguments(parser)
    add_compliance_arguments(parser)
    add_out_argument(parser, "dynamics")
    add_figures_argument(parser)
    add_page_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Solve every case; write dynamics.json, dynamics.nc, page and figures, print the results."""
    from ltca.output.run_folder import claimed_folder, figure_files

    check_time_arguments(arguments, POSITIONS)
    opened = open_drives(arguments, "dynamics")
    file, cases, engine, out = opened.file, opened.cases, opened.engine, opened.out
    from ltca.analysis.drive_curves import require_turns
    from ltca.commands.actions.dynamics import require_vibrations, solve_and_write

    for name, drive in cases.items():
        require_vibrations(file.cases[name])
        if arguments.turns is not None:
            require_turns(drive, arguments.turns)
    if arguments.time is not None:
        return _run_in_time(opened, arguments)
    figures = figure_files(
        arguments.figures, *(name + ending for name in FIGURES for ending in opened.figure_endings())
    )
    data = [f"dynamics{ending}.nc" for ending in opened.figure_endings()]
    writes = ["dynamics.json", *data, *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "dynamics", writes=[*writes, *figures]):
        find_coefficients_of(cases, engine, arguments)
        return solve_and_write(file, cases, engine, arguments, out)


def _run_in_time(opened: OpenedDrives, arguments: argparse.Namespace) -> int:
    """Run every case in time; write time.nc, time.json, page and figures, print the results."""
    from ltca.commands.actions.time_run import CHECKPOINTS, course_of, require_checkpoints, run_and_write
    from ltca.output.run_folder import claimed_folder, figure_files

    file, cases, engine, out = opened.file, opened.cases, opened.engine, opened.out
    for drive in cases.values():
        course_of(drive, arguments)
    endings = opened.figure_endings()
    figures = figure_files(arguments.figures, *(f"time_run{ending}" for ending in endings))
    writes = [*(f"time{ending}.nc" for ending in endings), "time.json"]
    writes += [] if arguments.no_page else ["report.html"]
    require_checkpoints(out, arguments.resume)
    with claimed_folder(out, "dynamics", writes=[*writes, *figures], beside=(CHECKPOINTS,)):
        find_coefficients_of(cases, engine, arguments)
        return run_and_write(file, cases, engine, arguments, out)
