"""Search of ``cyclo optimise``; the starting drive and the optimum are solved finely, written, drawn and printed."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np

from ltca.analysis.engines import SHARED_BODY, Engine, HalfSpace, describe_engine
from ltca.analysis.extremes import sampling_warning
from ltca.analysis.time_need import TOLD_FROM
from ltca.commands.actions.study import name_width, tell
from ltca.compliance.coefficient_files import derivation_words, expected_seconds, told_seconds
from ltca.compliance.ring import expected_ring_seconds
from ltca.drive.fields import read_field, whose, with_whose
from ltca.drive.parts import Drive
from ltca.errors import DriveError, did_you_mean, shortened, told_twice
from ltca.geometry.placement import position_angles
from ltca.output.files import whole_file, write_json
from ltca.output.progress import progress
from ltca.output.provenance import code_hash, code_version
from ltca.page.studies.optimum import optimum_page
from ltca.page.study_page import write_study_page
from ltca.quantities import SCALARS
from ltca.reading.writing import drive_text
from ltca.studies.fine_solution import FineSolution, solve_finely
from ltca.studies.optimiser import (
    Optimum,
    Problem,
    batch_analysis,
    broken_limits,
    describe_bound,
    designs_of_front,
    most_candidates,
    optimise,
    parse_bound,
    parse_variable,
    varies_ring,
    varies_shape,
)
from ltca.studies.quantities import STAGES, with_what_varies
from ltca.studies.shapes import find_beforehand, find_rings_beforehand, rings_of, shapes_of
from ltca.studies.study_results import field_column, quantity_column

FRONT = "front"
"""Beginning of the names of drive files of a Pareto front."""


def search_and_write(
    problem: Problem, name: str, case: str, engine: Engine, arguments: argparse.Namespace, out: Path
) -> int:
    """Search, solve starting drive and optimum finely, write, draw and print the results; return the exit status."""
    search = _prepared(problem, engine, arguments)
    most, began, solved = most_candidates(problem, arguments.generations), time.monotonic(), 0

    with progress("candidates", most, at_most=True) as bar:

        def advance(candidates: int) -> None:
            nonlocal solved
            solved += candidates
            bar("solved", candidates)
            if solved == candidates and (rest := (most - solved) * (time.monotonic() - began) / solved) > TOLD_FROM:
                tell(f"the other candidates take at most {told_seconds(rest)}, by the first {solved}")

        optimum = optimise(
            problem,
            batch_analysis(problem, arguments.positions, search),
            seed=arguments.seed,
            generations=arguments.generations,
            told=advance,
        )
    best = optimum.drive(optimum.best)
    fine = [solve_finely(drive, problem.quantities, engine) for drive in (problem.drive, best)]
    with whole_file(out / "optimum.toml") as part:
        part.write_text(drive_text(best), encoding="utf-8", newline="\n")
    _write_candidates(optimum, search, arguments.positions, out / "candidates.parquet")
    front = _write_front(optimum, out)
    outcome = _outcome(optimum, fine, engine, arguments.positions) | {"candidates_compliance": search.compliance}
    write_json(out / "optimum.json", outcome)
    if not arguments.no_page:
        aims = " and ".join(SCALARS[aim].title for aim in problem.aims)
        told = f"least {aims} of {case}, {problem.drive.load_words()}, {describe_engine(engine)}"
        write_study_page(optimum_page(name, told, optimum, outcome, front, drive_text(best)), out)
    print(f"{name} {case}, {problem.drive.load_words()}, {describe_engine(engine)}")
    _print(optimum, fine, engine, search, arguments.positions)
    if front:
        print(f"designs of the front: {out / next(iter(front))} … {next(reversed(front))}")
    print("results: " + ", ".join(str(out / name) for name in ("optimum.toml", "optimum.json", "candidates.parquet")))
    if arguments.figures:
        from ltca.figures.optimum_figures import write_optimum_figure

        told_how = f"{arguments.positions} positions, {describe_engine(search)}"
        print(f"figure: {write_optimum_figure(optimum, told_how, out, arguments.figures)}")
    return 0


def problem_of(drive: Drive, arguments: argparse.Namespace) -> Problem:
    """Return the problem that the arguments describe."""
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


def _prepared(problem: Problem, engine: Engine, arguments: argparse.Namespace) -> Engine:
    """Warn of few positions, say what has to be derived and derive it for the drive as it is; return the engine of candidates.

    Where candidates reshape the bodies and nobody named the engine, on the command line or in the drive file, they are solved on
    half-spaces.
    """
    search = engine.lending([problem.drive]).lending_rings([problem.drive])
    warning = sampling_warning(problem.drive, position_angles(arguments.positions), refined=False)
    if warning is not None:
        tell(f"warning: {warning}")
    if not engine.batches and varies_shape(problem, search):
        if arguments.coefficients is not None:
            raise DriveError(
                [
                    f"--coefficients {' '.join(map(str, arguments.coefficients))}: serves one shape, and --vary "
                    f"{' '.join(arguments.vary)} changes it; leave it out, so that each candidate gets its own"
                ]
            )
        bodies = shapes_of([problem.drive], engine).values()
        each = derivation_words(bodies, engine.bodies) + (" each" if engine.bodies == "plane" else "")
        if arguments.engine_is_named:
            most = most_candidates(problem, arguments.generations)
            named = "--compliance" if arguments.compliance_is_given else "[analysis] of the drive file"
            all_of_them = f"{each}, {told_seconds(most * sum(expected_seconds(bodies)))} in all"
            tell(
                f"every candidate is a shape of its own, and {named} names {engine.compliance}: up to {most} of them are "
                f"derived, {all_of_them if engine.bodies == 'plane' else each}, and kept; --quick solves all on half-spaces"
            )
        else:
            search = HalfSpace().lending_rings([problem.drive])
            tell(
                f"candidates reshape the bodies by more than {SHARED_BODY:.1%}: they are solved on half-spaces, the drive as it "
                f"is and the optimum on {engine.compliance} ({each}); --compliance {engine.compliance} derives the "
                "coefficients of every candidate"
            )
    find_beforehand(engine, shapes_of([problem.drive]), tell)
    find_rings_beforehand(rings_of([problem.drive], search), tell)
    if varies_ring(problem, search):
        one, many = expected_ring_seconds(problem.drive), most_candidates(problem, arguments.generations)
        tell(
            f"candidates reshape the ring of finite elements by more than {SHARED_BODY:.1%} of its height: up to {many} are "
            f'derived, {told_seconds(many * one)} in all, and kept; ring.model = "beam" takes none'
        )
    return search


def _write_front(optimum: Optimum, out: Path) -> dict[str, int]:
    """Write designs of a Pareto front as drive files; return their candidates by file, in the order of the first aim."""
    if len(optimum.problem.aims) < 2:
        return {}
    written = {f"{FRONT}-{number}.toml": candidate for number, candidate in enumerate(designs_of_front(optimum), 1)}
    for file, candidate in written.items():
        with whole_file(out / file) as part:
            part.write_text(drive_text(optimum.drive(candidate)), encoding="utf-8", newline="\n")
    return written


def _write_candidates(optimum: Optimum, search: Engine, positions: int, path: Path) -> None:
    import pyarrow as pa
    from pyarrow import parquet

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
        metadata={
            "version": code_version(),
            "code_hash": code_hash("ltca"),
            **search.options,
            "positions": str(positions),
        },
    )
    columns = [*optimum.variables.T, *optimum.values.T, *(values for values, _ in flags.values())]
    with whole_file(path) as part:
        parquet.write_table(pa.Table.from_arrays([pa.array(column) for column in columns], schema=schema), part)


def _outcome(optimum: Optimum, fine: list[FineSolution], engine: Engine, positions: int) -> dict[str, Any]:
    """Content of ``optimum.json``: starting drive and optimum, solved finely and at the positions of the search."""
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


def _print(optimum: Optimum, fine: list[FineSolution], engine: Engine, search: Engine, positions: int) -> None:
    problem, nominal, found = optimum.problem, *fine
    print(
        f"{len(optimum.variables)} candidates × {positions} positions in {optimum.generations} batches, "
        f"{describe_engine(search)}, {optimum.feasible.sum()} within the limits"
    )
    paths = [with_whose(variable.path, whose(problem.drive, variable.path)) for variable in problem.variables]
    wide = name_width([*paths, *(SCALARS[name].heading for name in problem.quantities)], 48)
    engines = describe_engine(engine), describe_engine(search)
    both = name_width(engines, 24)
    both += both % 2
    print(f"{'':<{wide}}" + "".join(f"{each:>{both}}" for each in engines))
    print(f"{'':<{wide}}{f'{found.positions} positions, refined':>{both}}{f'{positions} positions':>{both}}")
    print(f"{'':<{wide}}" + f"{'as it is':>{both // 2}}{'found':>{both // 2}}" * 2)
    for head, variable, value in zip(paths, problem.variables, optimum.variables[optimum.best], strict=True):
        print(f"{head:<{wide}}{float(read_field(problem.drive, variable.path)):>{both // 2}.5g}{value:>{both // 2}.5g}")
    for column, name in enumerate(problem.quantities):
        values = nominal.values[name], found.values[name], optimum.start[column], optimum.values[optimum.best, column]
        print(f"{SCALARS[name].heading:<{wide}}" + "".join(f"{value:>{both // 2}.5g}" for value in values))
    for limit in broken_limits(problem, found.values):
        print(
            f"beyond {describe_bound(limit)} when solved finely: {found.values[limit.quantity]:.5g}; the search saw "
            f"{positions} positions only, more --positions come nearer"
        )
    if len(problem.aims) == 2:
        print(f"Pareto front of {optimum.front.size} candidates; the one found is its compromise")
