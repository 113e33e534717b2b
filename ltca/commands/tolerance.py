"""``cyclo tolerance``: what the tolerances of a drive do to it, over thousands of random samples."""

from __future__ import annotations

import argparse

from ltca.commands.compliance_arguments import check_compliance, compliance_of, settle_compliance
from ltca.commands.study_arguments import (
    add_positions_argument,
    add_seed_argument,
    add_study_arguments,
    check_study_arguments,
)
from ltca.reading.arguments import DRIVE, add_case_argument, add_drive_argument, count_argument, default_folder

SUMMARY = "tolerance study: percentiles, worst sample, what matters"
EXAMPLES = (
    (
        "cyclo tolerance paper --case CS-6 --samples 1000 --workers 2 --out out/t",
        "percentiles, worst sample, what matters",
    ),
    ("cyclo tolerance paper --case CS-6 --samples 1000 --out out/t --resume", "go on with an interrupted one"),
    ("cyclo tolerance paper --case CS-6 --samples 1000 --out out/t --sample 7", "the drive file of one sample"),
)
DEFAULT_SAMPLES = 1000


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser, f"{DRIVE}; with [tolerances]")
    add_case_argument(parser, "case to study; default the first", several=False)
    parser.add_argument(
        "--samples",
        metavar="N",
        type=count_argument("--samples", 1, 100_000_000),
        default=DEFAULT_SAMPLES,
        help=f"default {DEFAULT_SAMPLES}",
    )
    add_positions_argument(parser, "sample")
    add_seed_argument(parser)
    parser.add_argument(
        "--design",
        choices=("random", "sobol", "saltelli"),
        default="random",
        help="random numbers, a Sobol sequence, or blocks for Sobol indices; default random",
    )
    parser.add_argument(
        "--quantities",
        metavar="NAME",
        nargs="+",
        help="what to keep, 'all' for everything; default what the solution at the torque of the drive gives",
    )
    add_study_arguments(parser, "tolerance")


def execute(arguments: argparse.Namespace) -> int:
    """Draw the samples, solve them, write and print the results."""
    from ltca.output.run_folder import require_folder
    from ltca.reading.drive_file import load_drive

    check_study_arguments(arguments)
    check_compliance(arguments)
    file = load_drive(arguments.drive)
    settle_compliance(arguments, file.cases.values())
    file.select([arguments.case] if arguments.case is not None else None)
    out = arguments.out or default_folder(file.name, "tolerance")
    require_folder(out)
    from ltca.commands.actions.study import execute_study
    from ltca.studies.execution.storage import StudyFolder
    from ltca.studies.tolerance_study import tolerance_study

    study = tolerance_study(
        file,
        case=arguments.case,
        samples=arguments.samples,
        positions=arguments.positions,
        seed=arguments.seed,
        sequence=arguments.design,
        quantities=None if arguments.quantities is None else tuple(arguments.quantities),
        engine=compliance_of(arguments, file.cases.values()),
    )
    return execute_study(study, StudyFolder(path=out), arguments)
