"""``cyclo dynamics``: eigenfrequencies and modes, Campbell diagram, critical speeds, response over speed."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    find_coefficients_of,
    open_drives,
)
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    quantity_argument,
)

SUMMARY = "eigenfrequencies and modes under load, Campbell diagram, critical speeds, response over speed"
EXAMPLES = (
    ("cyclo dynamics my.toml", "modes over a turn and over torque, critical speeds; dynamics.json"),
    ("cyclo dynamics my.toml --speed '3000 rpm'", "up to that speed of the input"),
)
FIGURES = ("campbell_diagram", "response")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 4, 1000),
        default=24,
        help="crank angles of a turn at which modes are told; default 24",
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
    add_compliance_arguments(parser)
    add_out_argument(parser, "dynamics")
    add_figures_argument(parser)
    add_page_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Solve every case; write dynamics.json, page and figures, print the results."""
    from ltca.output.run_folder import claimed_folder, figure_files

    opened = open_drives(arguments, "dynamics")
    file, cases, engine, out = opened.file, opened.cases, opened.engine, opened.out
    from ltca.analysis.drive_curves import require_turns
    from ltca.commands.actions.dynamics import require_vibrations, solve_and_write

    for name, drive in cases.items():
        require_vibrations(file.cases[name])
        if arguments.turns is not None:
            require_turns(drive, arguments.turns)
    figures = figure_files(
        arguments.figures, *(name + ending for name in FIGURES for ending in opened.figure_endings())
    )
    writes = ["dynamics.json", *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "dynamics", writes=[*writes, *figures]):
        find_coefficients_of(cases, engine, arguments)
        return solve_and_write(file, cases, engine, arguments, out)
