"""``cyclo optimise``: fields of a drive that make one quantity small, or the Pareto front of two, under limits."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ltca.studies.optimiser import Optimum

SUMMARY = "vary fields of a drive for the least of one quantity, or the Pareto front of two"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("drive", metavar="DRIVE", help="drive file (TOML), or 'paper' for the shipped drive")
    parser.add_argument("--case", metavar="NAME", help="case to start from; default the first")
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
    parser.add_argument("--positions", metavar="M", type=int, default=28, help="crank angles 2πk/M; default 28")
    parser.add_argument("--generations", metavar="G", type=int, default=40, help="of the search; default 40")
    parser.add_argument("--seed", metavar="S", type=int, default=0, help="of the random numbers; default 0")
    parser.add_argument("--out", metavar="DIR", type=Path, help="folder for the results; default out/<drive>_optimum")
    parser.add_argument("--no-figures", action="store_true", help="write the drive and the candidates only")


def execute(arguments: argparse.Namespace) -> int:
    """Search, write the drive found and all candidates, draw and print them."""
    from ltca.errors import DriveError
    from ltca.output.files import whole_file
    from ltca.output.progress import progress
    from ltca.reading.drive_file import load_drive
    from ltca.reading.writing import drive_text
    from ltca.studies.optimiser import Problem, batch_analysis, optimise, parse_limit, parse_variable
    from ltca.studies.quantities import QUANTITIES

    for name, value, bound in (
        ("--positions", arguments.positions, 100_000),
        ("--generations", arguments.generations, 10_000),
    ):
        if not 1 <= value <= bound:
            raise DriveError([f"{name} = {value}: must be from 1 to {bound}"])
    aims = tuple(dict.fromkeys(arguments.minimise))
    unknown = [aim for aim in aims if aim not in QUANTITIES]
    if unknown or len(aims) > 2:
        raise DriveError([f"--minimise {' '.join(aims)}: give one or two of {', '.join(QUANTITIES)}"])
    file = load_drive(arguments.drive)
    case = arguments.case or next(iter(file.cases))
    drive = file.select([case])[case]
    problem = Problem(
        drive=drive,
        variables=tuple(parse_variable(text, drive) for text in arguments.vary),
        aims=aims,
        limits=tuple(parse_limit(text) for text in arguments.subject),
    )
    out = arguments.out or Path("out") / f"{file.name}_optimum"
    with progress("candidates", 0) as bar:
        optimum = optimise(
            problem,
            batch_analysis(problem, arguments.positions),
            seed=arguments.seed,
            generations=arguments.generations,
            told=lambda candidates: bar("solved", candidates),
        )
    with whole_file(out / "optimum.toml") as part:
        part.write_text(drive_text(optimum.drive(optimum.best)), encoding="utf-8")
    _write_candidates(optimum, out / "candidates.parquet")
    _print(optimum)
    print(f"results: {out / 'optimum.toml'}, {out / 'candidates.parquet'}")
    if not arguments.no_figures:
        from ltca.figures.optimum_figures import write_optimum_figure

        print(f"figure: {write_optimum_figure(optimum, out)}")
    return 0


def _write_candidates(optimum: Optimum, path: Path) -> None:
    import numpy as np
    import pyarrow as pa
    from pyarrow import parquet

    from ltca.output.files import whole_file

    problem = optimum.problem
    front = np.zeros(len(optimum.variables), dtype=bool)
    front[optimum.front] = True
    columns = {v.path: column for v, column in zip(problem.variables, optimum.variables.T, strict=True)}
    columns |= dict(zip(problem.quantities, optimum.values.T, strict=True))
    with whole_file(path) as part:
        parquet.write_table(pa.table({**columns, "feasible": optimum.feasible, "front": front}), part)


def _print(optimum: Optimum) -> None:
    from ltca.drive.fields import read_field
    from ltca.figures.study_figures import shown
    from ltca.studies.quantities import QUANTITIES

    problem = optimum.problem
    print(
        f"{len(optimum.variables)} candidates in {optimum.generations} batches, {optimum.feasible.sum()} within the limits"
    )
    print(f"{'':<48}{'as it is':>12}{'found':>12}")
    for variable, value in zip(problem.variables, optimum.variables[optimum.best], strict=True):
        print(f"{variable.path:<48}{float(read_field(problem.drive, variable.path)):>12.5g}{value:>12.5g}")
    for name, before, after in zip(problem.quantities, optimum.start, optimum.values[optimum.best], strict=True):
        factor, unit = shown(name)
        head = f"{QUANTITIES[name].description}{f' [{unit}]' if unit else ''}"
        print(f"{head:<48}{before * factor:>12.5g}{after * factor:>12.5g}")
    if len(problem.aims) == 2:
        print(f"Pareto front of {optimum.front.size} candidates; the one found is its compromise")
