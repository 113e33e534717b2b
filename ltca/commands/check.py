"""``cyclo check``: a verdict on a design, with what drives each value and what would mend it."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    check_compliance,
    compliance_of,
    find_coefficients_of,
    settle_compliance,
)
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    refuse_impossible_torques,
    tell_unit_mistakes,
    torque_argument,
)

SUMMARY = "judge a design: value, limit and safety of every check, what drives it and what would mend it"
EXAMPLES = (
    ("cyclo check my.toml", "every check of every case; exit status 1 where one fails"),
    ("cyclo check paper --case CS-3 --no-advice", "verdicts alone"),
)
DEFAULT_POSITIONS = 360
FAILED = 1


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case, repeatable; default all")
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 2, 100_000),
        default=DEFAULT_POSITIONS,
        help=f"crank positions of a turn; default {DEFAULT_POSITIONS}",
    )
    parser.add_argument(
        "--torque", metavar="T", type=torque_argument, help="output torque in N mm (or a text such as '377.3 N m')"
    )
    parser.add_argument("--no-advice", action="store_true", help="verdicts alone, without what drives each value")
    add_compliance_arguments(parser)
    add_out_argument(parser, "check")
    add_page_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Judge every case, print and write the checks; the exit status is 1 when one fails."""
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case)
    settle_compliance(arguments, cases.values())
    refuse_impossible_torques(cases.values(), arguments.torque, in_parts=True)
    tell_unit_mistakes(cases.values(), arguments.torque, (file.limits[name] for name in cases))
    out = arguments.out or default_folder(file.name, "check")
    require_folder(out)
    from ltca.analysis.memory_need import require_room_for

    require_room_for(cases.values(), arguments.positions, out, f"--positions {arguments.positions}")
    from ltca.analysis.engines import lending_between
    from ltca.commands.actions.check import judge_and_write

    engine = lending_between(file.cases.values(), compliance_of(arguments, cases.values()))
    writes = ["check.json", *([] if arguments.no_page else ["report.html"])]
    with claimed_folder(out, "check", writes=writes):
        find_coefficients_of(cases, engine, arguments, warn=False)
        failed = judge_and_write(file, cases, engine, arguments, out)
    print("results: " + ", ".join(str(out / name) for name in writes))
    return FAILED if failed else 0
