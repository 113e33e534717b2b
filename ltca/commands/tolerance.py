"""``cyclo tolerance``: what the tolerances of a drive do to it, over thousands of random samples."""

from __future__ import annotations

import argparse
from pathlib import Path

from ltca.commands.study_arguments import DEFAULT_POSITIONS, add_study_arguments

SUMMARY = "tolerance study: percentiles, worst sample, what matters"
DEFAULT_SAMPLES = 1000


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("drive", metavar="DRIVE", help="drive file with [tolerances], or 'paper' for the shipped drive")
    parser.add_argument("--case", metavar="NAME", help="case to study; default the first")
    parser.add_argument("--samples", metavar="N", type=int, default=DEFAULT_SAMPLES, help=f"default {DEFAULT_SAMPLES}")
    parser.add_argument(
        "--positions",
        metavar="M",
        type=int,
        default=DEFAULT_POSITIONS,
        help=f"crank angles 2πk/M of every sample; default {DEFAULT_POSITIONS}",
    )
    parser.add_argument("--seed", metavar="S", type=int, default=0, help="of the random numbers; default 0")
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
    add_study_arguments(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Draw the samples, solve them, write and print the results."""
    from ltca.commands.compliance_arguments import compliance_of
    from ltca.commands.study_arguments import execute_study
    from ltca.errors import DriveError
    from ltca.reading.drive_file import load_drive
    from ltca.studies.designs import check_samples
    from ltca.studies.execution.storage import StudyFolder
    from ltca.studies.tolerance_study import tolerance_study

    check_samples(arguments.samples, "--samples")
    if not 1 <= arguments.positions <= 100_000:
        raise DriveError([f"--positions = {arguments.positions}: must be from 1 to 100000"])
    if not 0 <= arguments.seed < 2**64:
        raise DriveError([f"--seed = {arguments.seed}: must be from 0 to 2⁶⁴ − 1"])
    file = load_drive(arguments.drive)
    study = tolerance_study(
        file,
        case=arguments.case,
        samples=arguments.samples,
        positions=arguments.positions,
        seed=arguments.seed,
        sequence=arguments.design,
        quantities=None if arguments.quantities is None else tuple(arguments.quantities),
        engine=compliance_of(arguments),
    )
    out = arguments.out or Path("out") / f"{file.name}_tolerance"
    return execute_study(study, StudyFolder(path=out), arguments)
