"""``cyclo optimise``: fields of a drive that make one quantity small, or the Pareto front of two, under limits."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.commands.study_arguments import add_positions_argument, add_seed_argument
from ltca.reading.arguments import (
    add_case_argument,
    add_drive_argument,
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    default_folder,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from ltca.analysis.engines import Engine
    from ltca.drive.parts import Drive
    from ltca.studies.fine_solution import FineSolution
    from ltca.studies.optimiser import Optimum, Problem

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
    """Search, solve what was found and where it started finely, write, draw and print all of it."""
    from ltca.commands.compliance_arguments import check_compliance, compliance_of
    from ltca.output.run_folder import claimed_folder, figure_files, require_folder
    from ltca.reading.drive_file import load_drive

    check_compliance(arguments)
    file = load_drive(arguments.drive)
    name, case = file.name, next(iter(file.select(None if arguments.case is None else [arguments.case])))
    out = arguments.out or default_folder(name, "optimise")
    require_folder(out)
    engine = compliance_of(arguments)
    tell_unit_mistakes([file.cases[case]])
    problem = _problem(file.cases[case], arguments)
    figures = figure_files(arguments.figures, "pareto" if len(problem.aims) == 2 else "search")
    page = [] if arguments.no_page else ["report.html"]
    writes = ["optimum.toml", "optimum.json", "candidates.parquet", *page, *figures]
    with claimed_folder(out, "optimise", writes=writes):
        return _search_and_write(problem, name, case, engine, arguments, out)


def _search_and_write(
    problem: Problem, name: str, case: str, engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    from ltca.analysis.engines import describe_engine
    from ltca.output.files import whole_file, write_json
    from ltca.output.progress import progress
    from ltca.reading.writing import drive_text
    from ltca.studies.fine_solution import solve_finely
    from ltca.studies.optimiser import batch_analysis, most_candidates, optimise

    _tell_beforehand(problem, engine, arguments)
    with progress("candidates", most_candidates(problem, arguments.generations), at_most=True) as bar:
        optimum = optimise(
            problem,
            batch_analysis(problem, arguments.positions, engine),
            seed=arguments.seed,
            generations=arguments.generations,
            told=lambda candidates: bar("solved", candidates),
        )
    best = optimum.drive(optimum.best)
    fine = [solve_finely(drive, problem.quantities, engine) for drive in (problem.drive, best)]
    with whole_file(out / "optimum.toml") as part:
        part.write_text(drive_text(best), encoding="utf-8")
    _write_candidates(optimum, out / "candidates.parquet")
    outcome = _outcome(optimum, fine, engine, arguments.positions)
    write_json(out / "optimum.json", outcome)
    if not arguments.no_page:
        from ltca.page.studies.optimum import optimum_page
        from ltca.page.study_page import write_study_page

        told = f"least {' and '.join(problem.aims)} of {case}, {problem.drive.load_words()}, {describe_engine(engine)}"
        write_study_page(optimum_page(name, told, optimum, outcome, drive_text(best)), out)
    print(f"{name} {case}, {problem.drive.load_words()}, {describe_engine(engine)}")
    _print(optimum, fine, arguments.positions)
    print("results: " + ", ".join(str(out / name) for name in ("optimum.toml", "optimum.json", "candidates.parquet")))
    if arguments.figures:
        from ltca.figures.optimum_figures import write_optimum_figure

        print(f"figure: {write_optimum_figure(optimum, arguments.positions, out, arguments.figures)}")
    return 0


def _problem(drive: Drive, arguments: argparse.Namespace) -> Problem:
    """What is asked of a drive."""
    from ltca.errors import DriveError, did_you_mean, shortened, told_twice
    from ltca.studies.optimiser import Problem, parse_bound, parse_variable
    from ltca.studies.quantities import STAGES, with_what_varies

    aims = tuple(arguments.minimise)
    unknown = [aim for aim in aims if aim not in STAGES]
    if unknown:
        meant = did_you_mean(unknown[0], STAGES) or "; there are " + ", ".join(STAGES)
        told = f"is no quantity of a study{meant}"
        raise DriveError([f"--minimise {shortened(unknown[0])[1:-1]}: {told}"])
    if len(aims) > 2 or told_twice(aims):
        raise DriveError(
            [f"--minimise {shortened(' '.join(aims), 200)[1:-1]}: give one quantity, or two different ones"]
        )
    drive = with_what_varies(drive, [text.strip() for text in arguments.vary])
    variables = tuple(parse_variable(text, drive) for text in arguments.vary)
    if repeated := told_twice([variable.path for variable in variables]):
        raise DriveError([f"--vary {repeated}: is given twice"])
    return Problem(
        drive=drive, variables=variables, aims=aims, limits=tuple(parse_bound(text) for text in arguments.subject)
    )


def _tell_beforehand(problem: Problem, engine: Engine, arguments: argparse.Namespace) -> None:
    """Warn of few positions, and say what has to be derived; derive it for the drive as it is."""
    from ltca.analysis.extremes import sampling_warning
    from ltca.commands.study_arguments import tell
    from ltca.compliance.coefficient_files import expected_seconds, told_seconds
    from ltca.geometry.placement import position_angles
    from ltca.studies.optimiser import most_candidates, varies_shape
    from ltca.studies.shapes import find_beforehand, shapes_of

    warning = sampling_warning(problem.drive, position_angles(arguments.positions), refined=False)
    if warning is not None:
        tell(f"warning: {warning}")
    if not engine.batches and varies_shape(problem):
        if arguments.coefficients is not None:
            from ltca.errors import DriveError

            raise DriveError(
                [
                    f"--coefficients {' '.join(map(str, arguments.coefficients))}: serves one shape, and --vary "
                    f"{' '.join(arguments.vary)} changes it; leave it out, so that each candidate gets its own"
                ]
            )
        tell(
            f"every candidate is a shape of its own: up to {most_candidates(problem, arguments.generations)} of them are "
            f"derived, {told_seconds(sum(expected_seconds(shapes_of([problem.drive]).values())))} each, and kept"
        )
    find_beforehand(engine, shapes_of([problem.drive]), tell)


def _write_candidates(optimum: Optimum, path: Path) -> None:
    import numpy as np
    import pyarrow as pa
    from pyarrow import parquet

    from ltca.drive.fields import whose
    from ltca.output.files import whole_file
    from ltca.output.provenance import code_hash, code_version
    from ltca.studies.study_results import field_column, quantity_column

    problem = optimum.problem
    front = np.zeros(len(optimum.variables), dtype=bool)
    front[optimum.front] = True
    flags = {
        "feasible": (optimum.feasible, "whether it is sound and within the limits"),
        "front": (front, "whether it is on the Pareto front, or the best of one aim"),
    }
    schema = pa.schema(
        [
            *(
                pa.field(v.path, pa.float64(), metadata=field_column(v.path, whose(problem.drive, v.path)))
                for v in problem.variables
            ),
            *(pa.field(name, pa.float64(), metadata=quantity_column(name)) for name in problem.quantities),
            *(
                pa.field(name, pa.bool_(), metadata={"units": "1", "description": text})
                for name, (_, text) in flags.items()
            ),
        ],
        metadata={"version": code_version(), "code_hash": code_hash("ltca")},
    )
    columns = [*optimum.variables.T, *optimum.values.T, *(values for values, _ in flags.values())]
    with whole_file(path) as part:
        parquet.write_table(pa.Table.from_arrays([pa.array(column) for column in columns], schema=schema), part)


def _outcome(optimum: Optimum, fine: list[FineSolution], engine: Engine, positions: int) -> dict[str, Any]:
    """What ``optimum.json`` holds: the drive as it is and the one found, solved finely, and as the search saw them."""
    from ltca.drive.fields import read_field, whose
    from ltca.output.provenance import code_hash, code_version
    from ltca.studies.optimiser import broken_limits, describe_bound
    from ltca.studies.study_results import field_column, quantity_column

    problem, nominal, found = optimum.problem, *fine
    return {
        "drive": problem.drive.name,
        "version": code_version(),
        "code_hash": code_hash("ltca"),
        **engine.options,
        "candidates": len(optimum.variables),
        "positions_of_candidates": positions,
        "positions": found.positions,
        "extremes": "refined between the positions",
        "variables": {
            variable.path: {
                **field_column(variable.path, whose(problem.drive, variable.path)),
                "low": variable.low,
                "high": variable.high,
                "as_it_is": float(read_field(problem.drive, variable.path)),
                "found": float(value),
            }
            for variable, value in zip(problem.variables, optimum.variables[optimum.best], strict=True)
        },
        "quantities": {
            name: {
                **quantity_column(name),
                "as_it_is": nominal.values[name],
                "found": found.values[name],
                "as_it_is_in_search": float(optimum.start[column]),
                "found_in_search": float(optimum.values[optimum.best, column]),
            }
            for column, name in enumerate(problem.quantities)
        },
        "limits": [describe_bound(limit) for limit in problem.limits],
        "broken_limits": [describe_bound(limit) for limit in broken_limits(problem, found.values)],
    }


def _print(optimum: Optimum, fine: list[FineSolution], positions: int) -> None:
    from ltca.drive.fields import read_field, whose, with_whose
    from ltca.quantities import SCALARS
    from ltca.studies.optimiser import broken_limits, describe_bound

    problem, nominal, found = optimum.problem, *fine
    print(
        f"{len(optimum.variables)} candidates × {positions} positions in {optimum.generations} batches, "
        f"{optimum.feasible.sum()} within the limits"
    )
    print(f"{'':<48}{f'{found.positions} positions, refined':>24}{f'{positions} positions':>24}")
    print(f"{'':<48}{'as it is':>12}{'found':>12}{'as it is':>12}{'found':>12}")
    for variable, value in zip(problem.variables, optimum.variables[optimum.best], strict=True):
        head = with_whose(variable.path, whose(problem.drive, variable.path))
        print(f"{head:<48}{float(read_field(problem.drive, variable.path)):>12.5g}{value:>12.5g}")
    for column, name in enumerate(problem.quantities):
        values = nominal.values[name], found.values[name], optimum.start[column], optimum.values[optimum.best, column]
        print(f"{SCALARS[name].heading:<48}" + "".join(f"{value:>12.5g}" for value in values))
    for limit in broken_limits(problem, found.values):
        print(
            f"beyond {describe_bound(limit)} when solved finely: {found.values[limit.quantity]:.5g}; the search saw "
            f"{positions} positions only, more --positions come nearer"
        )
    if len(problem.aims) == 2:
        print(f"Pareto front of {optimum.front.size} candidates; the one found is its compromise")
