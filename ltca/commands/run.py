"""``cyclo run``: the loaded tooth contact analysis of a drive, all cases."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from ltca.commands.compliance_arguments import (
    add_compliance_arguments,
    check_compliance,
    compliance_of,
    find_coefficients_of,
    settle_compliance,
)
from ltca.errors import DriveError
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    path_argument,
    quantity_argument,
    refuse_impossible_torques,
    tell_unit_mistakes,
    torque_argument,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ltca.drive.parts import Drive

SUMMARY = "loaded tooth contact analysis: loads, pressures, bearing forces, transmission error"
EXAMPLES = (
    ("cyclo run paper", "the paper's six cases over a turn of the crank; out/paper"),
    (
        "cyclo run my.toml --angles 0.5 '20 deg' --pressure 0.5",
        "two crank angles, and the pressure over every contact at one",
    ),
    ("cyclo run my.toml --positions 97 --torque '200 N m' --compliance hybrid", "bodies that yield as a whole"),
)
DEFAULT_POSITIONS = 360


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser)
    add_case_argument(parser, "case to run, repeatable; default all")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 1, 1_000_000),
        help=f"crank angles 2πk/N, k = 0 … N−1; default {DEFAULT_POSITIONS}",
    )
    where.add_argument(
        "--angles",
        metavar="φ",
        nargs="+",
        type=quantity_argument("--angles", "rad"),
        help="crank angles in rad (or texts such as '20 deg')",
    )
    parser.add_argument(
        "--torque",
        metavar="T",
        type=torque_argument,
        help="output torque in N·mm (or a text such as '377.3 N m'); default that of the drive",
    )
    parser.add_argument(
        "--method",
        choices=("tables", "direct", "paper"),
        help="equilibrium on tabulated contact laws (default), with contact grids solved inside every iteration, or by "
        "the paper's iteration with held wheel",
    )
    parser.add_argument(
        "--contacts", choices=("tables", "grids"), help="what the paper's iteration runs on; default tables"
    )
    add_compliance_arguments(parser)
    parser.add_argument(
        "--pressure",
        metavar="φ",
        nargs="*",
        type=quantity_argument("--pressure", "rad"),
        help="pressure fields of all loaded contacts at these crank angles (default 0) into pressure.nc; --figures draws them",
    )
    add_out_argument(parser, "run")
    add_figures_argument(parser)
    add_page_argument(parser)
    parser.add_argument(
        "--compare",
        metavar="DIR",
        type=path_argument("--compare"),
        help="a second run (its folder or results.nc) or a measured transmission error (.csv) beside this one on the page",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Check the options and claim the folder, then run the analysis and write results, summary, page and figures."""
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    # Before the analysis is imported: what is wrong is told at once.
    check_compliance(arguments)
    if arguments.compare is not None and arguments.no_page:
        raise DriveError(["--compare: has no effect with --no-page"])
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case)
    settle_compliance(arguments, cases.values())
    refuse_impossible_torques(cases.values(), arguments.torque)
    tell_unit_mistakes(cases.values(), arguments.torque, (file.limits[name] for name in cases))
    out = arguments.out or default_folder(file.name, "run")
    require_folder(out)
    import numpy as np

    from ltca.analysis.engines import lending_between
    from ltca.analysis.memory_need import require_room_for
    from ltca.analysis.results import check_common_shape
    from ltca.analysis.time_need import time_words
    from ltca.commands.actions.run import RunTask, solve_and_write
    from ltca.geometry.placement import position_angles
    from ltca.page.compared import read_compared

    positions = DEFAULT_POSITIONS if arguments.positions is None else arguments.positions
    angles = position_angles(positions) if arguments.angles is None else np.array(arguments.angles)
    if arguments.pressure is not None and arguments.compliance == "fe":
        raise DriveError(
            ["--pressure: plane strain has no fields over the width; take --compliance hybrid or half-space"]
        )
    check_common_shape(cases)
    task = RunTask(
        file=file,
        cases=cases,
        engine=lending_between(file.cases.values(), compliance_of(arguments, cases.values())),
        torque=arguments.torque,
        angles=angles,
        pressure_angles=None if arguments.pressure is None else np.array(arguments.pressure or [0.0]),
        figures=arguments.figures,
        page=not arguments.no_page,
        compared=None if arguments.compare is None else read_compared(arguments.compare),
    )
    require_room_for(cases.values(), angles.size, out, f"--positions {angles.size}")
    with claimed_folder(out, "run", writes=_files(arguments, cases)):
        if words := time_words(cases.values(), angles.size, task.engine):
            print(words, file=sys.stderr)
        find_coefficients_of(cases, task.engine, arguments, warn=False)
        return solve_and_write(task, out)


def _files(arguments: argparse.Namespace, cases: Mapping[str, Drive]) -> Iterator[str]:
    """Names of all files that the run may write."""
    from glob import escape

    yield from ("results.nc", "summary.json", *(() if arguments.no_page else ("report.html",)))
    if arguments.pressure is not None:
        yield "pressure.nc"
    if arguments.figures:
        from ltca.figures.pressure_figures import PRESSURE_FIGURES
        from ltca.figures.run_figures import figure_names
        from ltca.output.file_names import file_words
        from ltca.output.run_folder import figure_files

        drive = next(iter(cases.values()))  # all cases of a run have as many discs, holes, cranks and slices
        numbers = drive.disc.number_of_discs, drive.number_of_holes, drive.crank.number, drive.contact.slices
        yield from figure_files(arguments.figures, *figure_names(*numbers))
        if arguments.pressure is not None:
            yield from figure_files(arguments.figures, *PRESSURE_FIGURES)
            yield from (f"figures/fig31_roller_pressure_{escape(word)}.png" for word in file_words(cases).values())
