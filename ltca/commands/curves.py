"""``cyclo curves``: torque against wind-up, orders of the transmission error, bearing life, pressure safety."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    find_coefficients_of,
    open_drives,
)
from ltca.errors import DriveError
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    quantity_argument,
)

SUMMARY = "torque curve and lost motion, orders of the transmission error, bearing life, pressure safety"
EXAMPLES = (
    ("cyclo curves my.toml", "torque curve, orders, bearing lives; curves.json"),
    (
        "cyclo curves my.toml --parts",
        "what the torsional stiffness is made of: each part that yields left out, and alone",
    ),
    ("cyclo curves my.toml --speed '1500 rpm' --load-rating '40 kN'", "lives at a speed and a maker's load rating"),
)
MANY_POSITIONS = 20_000
"""Positions beyond which it is said that fewer turns would do."""
FIGURES = ("torque_curve", "transmission_error_orders", "flank_pressure")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--turns",
        metavar="N",
        type=count_argument("--turns", 1, 1000),
        help="crank turns behind the orders; default z_P",
    )
    parser.add_argument(
        "--pressure-limit",
        metavar="P",
        type=quantity_argument("--pressure-limit", "MPa", gt=0.0),
        help="permissible flank pressure in MPa (or a text such as '1.5 GPa'); default that of [limits] or of the materials",
    )
    parser.add_argument(
        "--lost-motion",
        metavar="PART",
        type=quantity_argument("--lost-motion", "dimensionless", ge=0.001, le=0.5),
        default=0.03,
        help="part of the rated torque at which lost motion is read, as '3%%' or 0.03; default 3%%",
    )
    parser.add_argument(
        "--parts",
        action="store_true",
        help="what the torsional stiffness is made of: with and without each part that the file describes (ring, carrier, "
        "bearings, shafts, first stage)",
    )
    parser.add_argument(
        "--speed",
        metavar="N",
        type=quantity_argument("--speed", "rpm", gt=0.0),
        help="crank speed in turns a minute (or a text such as '1500 rpm'), for the life in hours: of a central crank "
        "against the held member, of several cranks against the carrier (what that is of the input is printed); default from "
        "load.speed, if the drive has it; not with [[duty]]",
    )
    parser.add_argument(
        "--load-rating",
        metavar="C",
        type=quantity_argument("--load-rating", "N", gt=0.0),
        help="dynamic load rating of the crank bearing in N (or a text such as '40 kN'); default by ISO 281",
    )
    add_compliance_arguments(parser)
    add_out_argument(parser, "curves")
    add_figures_argument(parser)
    add_page_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Solve every case; write curves.json and figures, print the results."""
    from ltca.output.run_folder import claimed_folder, figure_files

    opened = open_drives(arguments, "curves")
    file, cases, engine, out = opened.file, opened.cases, opened.engine, opened.out
    from ltca.analysis.drive_curves import CurveSettings, positions_per_turn, require_turns
    from ltca.analysis.memory_need import require_room_for_parts
    from ltca.commands.actions.curves import solve_and_write, tell_of_turns

    asked = (arguments.pressure_limit, arguments.load_rating, arguments.speed, arguments.lost_motion, arguments.parts)
    settings = CurveSettings(*asked)
    for drive in cases.values():
        if drive.duty and settings.speed is not None:
            raise DriveError(["--speed: has no effect with [[duty]], whose entries have their own"])
        turns = arguments.turns or drive.pin_wheel.number_of_pins
        positions = turns * positions_per_turn(drive)
        require_room_for_parts(drive, positions, out, f"--turns {turns}")
        if turns < drive.pin_wheel.number_of_pins:
            require_turns(drive, turns)
        elif arguments.turns is None and positions > MANY_POSITIONS:
            tell_of_turns(drive, turns, positions)
    figures = figure_files(
        arguments.figures, *(name + ending for name in FIGURES for ending in opened.figure_endings())
    )
    writes = ["curves.json", *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "curves", writes=[*writes, *figures]):
        find_coefficients_of(cases, engine, arguments)
        return solve_and_write(file, cases, settings, engine, arguments, out)
