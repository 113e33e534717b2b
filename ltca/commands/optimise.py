"""``cyclo optimise``: fields of a drive that make one quantity small, or the Pareto front of two, under limits."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    check_compliance,
    compliance_of,
    settle_compliance,
)
from ltca.commands.study_arguments import add_positions_argument, add_seed_argument
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    refuse_impossible_torques,
    tell_unit_mistakes,
)

SUMMARY = "vary fields of a drive for the least of one quantity, or the Pareto front of two"
EXAMPLES = (
    (
        "cyclo optimise paper --vary equidistant_offset shifting_offset --minimise ptp_transmission_error "
        "--subject 'max_pin_pressure_mid <= 1500 MPa'",
        "one aim under a limit",
    ),
    (
        "cyclo optimise my.toml --vary disc.equidistant_offset=0:0.2 --minimise max_pin_load mean_backlash_wheel",
        "the Pareto front of two",
    ),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case to start from; default the first", several=False)
    parser.add_argument(
        "--vary",
        metavar="FIELD[=LOW:HIGH]",
        nargs="+",
        required=True,
        help="fields to vary; half to one and a half of their value without a range",
    )
    parser.add_argument("--minimise", metavar="QUANTITY", nargs="+", required=True, help="one or two quantities")
    parser.add_argument(
        "--subject", metavar="LIMIT", action="append", default=[], help="'quantity <= value unit', repeatable"
    )
    add_positions_argument(parser, "candidate")
    parser.add_argument(
        "--generations",
        metavar="G",
        type=count_argument("--generations", 1, 10_000),
        default=40,
        help="of the search; default 40",
    )
    add_seed_argument(parser)
    add_compliance_arguments(parser)
    add_out_argument(parser, "optimise")
    add_page_argument(parser)
    add_figures_argument(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Search, solve starting drive and optimum finely, write, draw and print the results."""
    from ltca.output.run_folder import claimed_folder, figure_files, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    arguments.compliance_is_given = arguments.compliance is not None
    arguments.engine_is_named = arguments.compliance is not None or file.names_compliance
    settle_compliance(arguments, file.cases.values())
    name, case = file.name, next(iter(file.select(None if arguments.case is None else [arguments.case])))
    out = arguments.out or default_folder(name, "optimise")
    require_folder(out)
    from ltca.commands.actions.optimise import FRONT, problem_of, search_and_write

    engine = compliance_of(arguments, file.cases.values())
    refuse_impossible_torques([file.cases[case]])
    tell_unit_mistakes([file.cases[case]])
    problem = problem_of(file.cases[case], arguments)
    figures = figure_files(arguments.figures, "pareto" if len(problem.aims) == 2 else "search")
    page = [] if arguments.no_page else ["report.html"]
    writes = ["optimum.toml", "optimum.json", "candidates.parquet", f"{FRONT}-[0-9]*.toml", *page, *figures]
    with claimed_folder(out, "optimise", writes=writes):
        return search_and_write(problem, name, case, engine, arguments, out)
