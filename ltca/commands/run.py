"""``cyclo run``: the loaded tooth contact analysis of a drive, all cases."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.errors import ConvergenceError
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
    torque_argument,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from xarray import Dataset

    from ltca.analysis.engines import Engine
    from ltca.analysis.loaded_analysis import LoadedAnalysis
    from ltca.arrays import FloatArray
    from ltca.drive.members.judgement import Check
    from ltca.drive.members.limits import Limits
    from ltca.drive.parts import Drive
    from ltca.page.compared import Compared
    from ltca.reading.drive_file import DriveFile

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
    """Run the analysis and write results, summary and figures."""
    from ltca.commands.compliance_arguments import check_compliance
    from ltca.errors import DriveError
    from ltca.output.run_folder import claimed_folder, require_folder
    from ltca.reading.drive_file import load_drive

    # Before the analysis is imported: what is wrong is told at once.
    check_compliance(arguments)
    if arguments.compare is not None and arguments.no_page:
        raise DriveError(["--compare: has no effect with --no-page"])
    file = load_drive(arguments.drive)
    cases = file.select(arguments.case)
    out = arguments.out or default_folder(file.name, "run")
    require_folder(out)
    from ltca.analysis.memory_need import require_room_for
    from ltca.analysis.results import check_common_shape
    from ltca.commands.compliance_arguments import find_coefficients_of

    angles, pressure_angles = _crank_angles(arguments), _pressure_angles(arguments)
    torque, engine = arguments.torque, _engine(arguments)
    check_common_shape(cases)
    compared = _compared(arguments.compare)
    require_room_for(cases.values(), angles.size, out, f"--positions {angles.size}")
    with claimed_folder(out, "run", writes=_files(arguments, cases)):
        find_coefficients_of(cases, arguments)
        chosen = _Chosen(file=file, cases=cases, engine=engine, torque=torque)
        wanted = _Wanted(figures=arguments.figures, page=not arguments.no_page, compared=compared)
        return _solve_and_write(chosen, angles, pressure_angles, out, wanted)


def _parts(cases: Mapping[str, Drive]) -> tuple[int, int, int]:
    """Numbers of discs, of holes and of cranks, which all cases of a run have."""
    drive = next(iter(cases.values()))
    return drive.disc.number_of_discs, drive.number_of_holes, drive.crank.number


def _files(arguments: argparse.Namespace, cases: Mapping[str, Drive]) -> Iterator[str]:
    """Names of all files that the run may write."""
    from glob import escape

    yield from ("results.nc", "summary.json", *(() if arguments.no_page else ("report.html",)))
    if arguments.pressure is not None:
        yield "pressure.nc"
    if arguments.figures:
        from ltca.figures.pressure_figures import PRESSURE_FIGURES
        from ltca.figures.run_figures import figure_names
        from ltca.output.run_folder import figure_files

        yield from figure_files(arguments.figures, *figure_names(*_parts(cases)))
        if arguments.pressure is not None:
            yield from figure_files(arguments.figures, *PRESSURE_FIGURES)
            yield from (f"figures/fig31_roller_pressure_{escape(name)}.png" for name in cases)


class _Chosen(NamedTuple):
    """What is analysed."""

    file: DriveFile
    cases: dict[str, Drive]
    engine: Engine
    torque: float | None


class _Wanted(NamedTuple):
    """What is written beside the numbers."""

    figures: str | None
    page: bool
    compared: Compared | None


def _compared(path: Path | None) -> Compared | None:
    """What is to stand beside the run, read before anything is computed."""
    if path is None:
        return None
    from ltca.page.compared import read_compared

    return read_compared(path)


def _solve_and_write(
    chosen: _Chosen, angles: FloatArray, pressure_angles: FloatArray | None, out: Path, wanted: _Wanted
) -> int:
    from ltca.analysis.engines import describe_engine
    from ltca.analysis.results import build_dataset
    from ltca.analysis.summary import summarise
    from ltca.output.files import whole_file, write_json
    from ltca.output.netcdf import write_netcdf

    file, cases, engine, torque = chosen
    analyses, failures = _analyse(cases, angles, torque, engine, "cases")
    cases = {name: analysis.drive for name, analysis in analyses.items()}
    shown: dict[str, LoadedAnalysis] = {}
    also: dict[str, ConvergenceError] = {}
    if pressure_angles is not None:
        shown, also = _analyse(cases, pressure_angles, torque, engine, "pressure fields")
    if also:  # a field of a position without an answer is no field
        raise next(iter(also.values()))
    summaries = {name: summarise(analysis) for name, analysis in analyses.items()}
    dataset = build_dataset(file.name, analyses, file.text)
    with whole_file(out / "results.nc") as part:
        write_netcdf(dataset, part)
    write_json(out / "summary.json", {"drive": file.name, "cases": summaries})
    files, fields = ["results.nc", "summary.json"], None
    if pressure_angles is not None:
        from ltca.analysis.pressure_fields import build_pressure_dataset

        fields = build_pressure_dataset(file.name, shown, drive_file=file.text)
        packed = {name: {"zlib": True} for name in fields if str(name).endswith(("_pressure", "_outer", "_inner"))}
        with whole_file(out / "pressure.nc") as part:
            write_netcdf(fields, part, packed)
        files.append("pressure.nc")
    loads = {name: drive.load_words(torque) for name, drive in cases.items()}
    (load, *others) = dict.fromkeys(loads.values())
    how = [describe_engine(engine), _many(angles)]
    print(f"{file.name}: {', '.join(how if others else [load, *how])}")
    yields = any(drive.crank.support or drive.pin_wheel.support_stiffness for drive in cases.values())
    checks = _checks(analyses, summaries, file.limits)
    sampling = _sampling(analyses, summaries, angles)
    proportions = _proportions(analyses)
    print(_verdicts(checks, proportions))
    print(_table(summaries, loads if others else {}, bool(yields)))
    print("\n".join(sampling))
    if wanted.page:
        from ltca.page.run_page import PAGE, Run, run_page
        from ltca.page.writing import write_page

        run = Run(
            name=file.name, text=file.text, analyses=analyses, summaries=summaries, checks=checks,
            sampling=[*sampling, *dict.fromkeys(f"warning: {one}" for each in proportions.values() for one in each)],
            compared=wanted.compared,
        )  # fmt: skip
        write_page(out / PAGE, run_page(run))
        files.append(PAGE)
    print("results: " + ", ".join(str(out / name) for name in files))
    for name, failure in failures.items():
        left = 2 * angles.size
        if failure.partial is not None:
            left = sum(int((~known).sum()) for known in (failure.partial.balanced, failure.partial.balanced_light))
        told = f"case {name}: partial: {left} of {2 * angles.size} states have no answer"
        print(f"cyclo: error: {told}: {failure}", file=sys.stderr)
    if wanted.figures:
        _draw(dataset, fields, cases, out / "figures", wanted.figures)
    return ConvergenceError.exit_status if failures else 0


def _checks(
    analyses: dict[str, LoadedAnalysis], summaries: dict[str, dict[str, float | None]], limits: dict[str, Limits]
) -> dict[str, list[Check]]:
    """The checks of each case that has an answer everywhere."""
    from ltca.analysis.verdict.values import judge_analysis

    return {
        name: judge_analysis(analysis, summaries[name], limits[name], lives=False)
        for name, analysis in analyses.items()
        if analysis.is_complete
    }


def _proportions(analyses: dict[str, LoadedAnalysis]) -> dict[str, list[str]]:
    """What is odd about the sizes of each case that has an answer everywhere."""
    from ltca.analysis.verdict.proportions import odd_proportions

    return {
        name: [*odd_proportions(analysis.as_written)] for name, analysis in analyses.items() if analysis.is_complete
    }


def _verdicts(checks: dict[str, list[Check]], proportions: dict[str, list[str]]) -> str:
    """A line for each case, the check nearest to its limit in it, and what is odd."""
    from ltca.drive.members.verdict_words import verdict_line

    if not checks:
        return "no verdict on partial results"
    width = max(map(len, checks))
    told = ["verdict, with the check nearest to its limit"]
    told += [f"  {name:<{width}}  {verdict_line(each)}" for name, each in checks.items()]
    told += [f"  note: {note}" for note in dict.fromkeys(note for each in proportions.values() for note in each)]
    return "\n".join([*told, "every check, what drives it and would mend it: cyclo check"])


def _engine(arguments: argparse.Namespace) -> Engine:
    from ltca.commands.compliance_arguments import compliance_of
    from ltca.errors import DriveError

    if arguments.pressure is not None and arguments.compliance != "half-space":
        raise DriveError(
            [f"--pressure: fields over the width need --compliance half-space, not {arguments.compliance}"]
        )
    return compliance_of(arguments)


def _analyse(
    cases: dict[str, Drive], angles: FloatArray, torque: float | None, engine: Engine, title: str
) -> tuple[dict[str, LoadedAnalysis], dict[str, ConvergenceError]]:
    """Analyses of all cases; those without an answer at some positions, and why."""
    from ltca.analysis.loaded_analysis import analyse_cases
    from ltca.errors import ConvergenceError
    from ltca.output.progress import progress

    analyses, failures = {}, {}
    with progress(title, len(cases)) as advance:
        for name, found in analyse_cases(cases, angles, torque, engine):
            if isinstance(found, ConvergenceError):
                failures[name] = found
                found = found.partial
            if found is not None:
                analyses[name] = found
            advance(name)
    if not analyses:
        raise next(iter(failures.values()))
    return analyses, failures


def _draw(dataset: Dataset, fields: Dataset | None, cases: dict[str, Drive], folder: Path, kind: str) -> None:
    from ltca.figures.run_figures import figure_names, write_figures
    from ltca.output.progress import progress

    names = figure_names(dataset.sizes["disc"], dataset.sizes["hole"], dataset.sizes["crank"])
    with progress("figures", len(names)) as advance:
        for path in write_figures(dataset, folder, kind):
            advance(path.name)
    print(f"figures: {folder} ({len(names)} as {kind.upper()})")
    if fields is None:
        return
    from ltca.figures.pressure_figures import write_pressure_figures

    with progress("pressure figures", 3 + len(cases)) as advance:
        for path in write_pressure_figures(dataset, fields, next(iter(cases.values())), folder, kind):
            advance(path.name)


def _crank_angles(arguments: argparse.Namespace) -> FloatArray:
    import numpy as np

    from ltca.geometry.placement import position_angles

    if arguments.angles is not None:
        return np.array(arguments.angles)
    return position_angles(DEFAULT_POSITIONS if arguments.positions is None else arguments.positions)


def _pressure_angles(arguments: argparse.Namespace) -> FloatArray | None:
    import numpy as np

    return None if arguments.pressure is None else np.array(arguments.pressure or [0.0])


def _table(summaries: dict[str, dict[str, float | None]], loads: dict[str, str], yields: bool) -> str:
    from ltca.analysis.summary import refined_value
    from ltca.analysis.summary_rows import rows_of, with_residual_part

    summaries = {name: with_residual_part(case) for name, case in summaries.items()}
    rows = [("case", list(summaries))]
    if loads:  # of cases that differ in them
        rows.append(("torque, direction of the crank", list(loads.values())))
    for row in rows_of(summaries, yields=yields):
        values = [refined_value(case, row.key) for case in summaries.values()]
        rows.append((row.heading, ["–" if value is None else f"{value:{row.digits}}" for value in values]))
    return "\n".join(_side_by_side(rows))


def _side_by_side(rows: list[tuple[str, list[str]]]) -> list[str]:
    """Rows with their cells in columns, as many columns beside each other as a terminal shows."""
    from shutil import get_terminal_size

    head = max(len(title) for title, _ in rows)
    widths = [max(10, *(len(cells[column]) + 2 for _, cells in rows)) for column in range(len(rows[0][1]))]
    seen = get_terminal_size(fallback=(10_000, 24)).columns if sys.stdout.isatty() else 10_000
    many = max(1, (seen - head) // max(widths))
    return [
        f"{title:<{head}}" + "".join(f"{cells[c]:>{widths[c]}}" for c in range(first, min(first + many, len(widths))))
        for first in range(0, len(widths), many)
        for title, cells in rows
    ]


def _many(angles: FloatArray) -> str:
    return f"{angles.size} positions" if angles.size > 1 else f"1 position, φ_C = {angles[0]:g} rad"


def _sampling(
    analyses: dict[str, LoadedAnalysis], summaries: dict[str, dict[str, float | None]], angles: FloatArray
) -> list[str]:
    """What the values stand for: which positions, whether they see the mesh, and what to know of drive and answer."""
    from ltca.analysis.extremes import is_full_turn, sampling_warning

    many = _many(angles)
    whole = is_full_turn(angles)
    lines = [f"means over {many}; extremes over the turn, refined between them" if whole else f"values of {many}"]
    lines += sorted({analysis.hole_words for analysis in analyses.values()} - {""})
    warnings = {
        warning
        for analysis in analyses.values()
        for warning in (sampling_warning(analysis.drive, angles), *analysis.warnings)
        if warning is not None
    }
    for name, case in summaries.items():
        if whole and analyses[name].is_complete and case["refined_max_pin_load_N"] is None:
            warnings.add(f"extremes of case {name} are those of its positions: one between them has no answer")
    return [*lines, *(f"warning: {text}" for text in sorted(warnings))]
