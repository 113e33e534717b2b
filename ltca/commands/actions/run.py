"""Solve the cases of ``cyclo run``; write dataset, summary, page and figures, print verdicts and the table of scalars."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ltca.analysis.engines import Engine, describe_engine, lent_words
from ltca.analysis.extremes import is_full_turn, sampling_warning
from ltca.analysis.half_space_errors import at_torque, half_space_cautions, half_space_notes
from ltca.analysis.life.bearing_lives import BearingLives, bearing_lives
from ltca.analysis.life.equivalent_load import covers_whole_turns
from ltca.analysis.light_torque import at_light_torque, light_torque_lines
from ltca.analysis.loaded_analysis import LoadedAnalysis, analyse_cases
from ltca.analysis.reactions import relieved_rows_warning
from ltca.analysis.results import labelled_results
from ltca.analysis.summary import summarise_cases
from ltca.analysis.summary_rows import with_residual_part
from ltca.analysis.verdict.proportions import odd_proportions
from ltca.analysis.verdict.values import judge_analysis
from ltca.arrays import FloatArray
from ltca.commands.actions.run_table import lives_told, run_table, whose_stiffness
from ltca.drive.members.judgement import Check
from ltca.drive.members.limits import Limits
from ltca.drive.members.verdict_words import verdict_line
from ltca.drive.parts import Drive
from ltca.drive.unit_mistakes import unit_warnings
from ltca.drive.yielding_parts import yielding_parts
from ltca.errors import ConvergenceError, CycloError
from ltca.output.case_texts import with_case_names
from ltca.output.files import whole_file, write_json
from ltca.output.labelled import LabelledDataset
from ltca.output.netcdf import write_netcdf
from ltca.output.progress import progress, steps
from ltca.page.compared import Compared
from ltca.reading.drive_file import DriveFile

if TYPE_CHECKING:
    from xarray import Dataset

Analyses = dict[str, LoadedAnalysis]
Summaries = dict[str, dict[str, float | None]]


class RunTask(NamedTuple):
    """Settings of ``cyclo run``.

    Attributes
    ----------
    file : DriveFile
        The drive.
    cases : dict of str to Drive
        Those of its cases that are analysed.
    engine : Engine
        What they are solved on.
    torque : float or None
        Output torque, N·mm; that of the drive otherwise.
    angles : array, shape (positions,)
        φ_C, rad.
    pressure_angles : array or None
        φ_C of pressure fields, rad.
    figures : str or None
        What figures are written as.
    page : bool
        Whether a page is written.
    compared : Compared or None
        What the page shows beside the run.
    """

    file: DriveFile
    cases: dict[str, Drive]
    engine: Engine
    torque: float | None
    angles: FloatArray
    pressure_angles: FloatArray | None
    figures: str | None
    page: bool
    compared: Compared | None


def solve_and_write(task: RunTask, out: Path) -> int:
    """Solve the cases, write and print the results; return the exit status."""
    file, engine, angles, torque = task.file, task.engine, task.angles, task.torque
    analyses, failures = _analyse(task.cases, angles, torque, engine, "cases")
    cases = {name: analysis.drive for name, analysis in analyses.items()}
    shown: Analyses = {}
    if task.pressure_angles is not None:
        shown, also = _analyse(cases, task.pressure_angles, torque, engine, "pressure fields")
        if also:  # a field of a position without an answer is no field
            raise next(iter(also.values()))
    with steps() as show:
        show("extremes between the positions")
        summaries = summarise_cases(analyses)
        show("results.nc")
        dataset = labelled_results(file.name, analyses, file.text)
        with whole_file(out / "results.nc") as part:
            write_netcdf(dataset, part)
    whose = {name: yielding_parts(drive).content for name, drive in cases.items()}
    content = {"drive": file.name, "cases": summaries, "torsional_stiffness_of": whose}
    # Of engines on coefficients, what bodies these are of.
    content |= {name: value for name, value in engine.options.items() if name == "bodies"}
    write_json(out / "summary.json", content)
    files, fields = ["results.nc", "summary.json"], None
    if shown:
        from ltca.analysis.pressure_fields import build_pressure_dataset

        fields = build_pressure_dataset(file.name, shown, drive_file=file.text)
        packed = [str(name) for name in fields if str(name).endswith(("_pressure", "_outer", "_inner"))]
        with whole_file(out / "pressure.nc") as part:
            write_netcdf(fields, part, packed)
        files.append("pressure.nc")
    loads = {name: drive.load_words(torque) for name, drive in cases.items()}
    (load, *others) = dict.fromkeys(loads.values())
    how = [describe_engine(engine), _many(angles)]
    print(f"{file.name}: {', '.join(how if others else [load, *how])}")
    checks = _checks(analyses, summaries, file.limits)
    method, warnings = _method(analyses, summaries, angles), _warnings(analyses, summaries, angles)
    proportions = _proportions(analyses)
    lives = {name: _lives(analysis) for name, analysis in analyses.items()}
    print(_verdicts(checks, proportions, half_space_cautions(engine, _loaded(analyses))))
    print(run_table(analyses, summaries, lives, loads if others else {}))
    light_torques = light_torque_lines(cases, torque)
    lines = [*whose_stiffness(analyses), *light_torques, *lives_told(lives)]
    print("\n".join([*lines, *(text for _, text in method), *warnings]))
    if task.page:
        messages = [*warnings, *(f"warning: {one}" for one in with_case_names(proportions))]
        with steps() as show:
            show("page")
            files.append(_write_page(task, analyses, dataset, summaries, checks, lives, messages, method, out))
    print("results: " + ", ".join(str(out / name) for name in files))
    for name, failure in failures.items():
        left = 2 * angles.size
        if failure.partial is not None:
            left = sum(int((~known).sum()) for known in (failure.partial.balanced, failure.partial.balanced_light))
        told_of = f"case {name}: partial: {left} of {2 * angles.size} states have no answer"
        print(f"cyclo: error: {told_of}: {failure}", file=sys.stderr)
    if task.figures:
        _draw(dataset, fields, cases, out / "figures", task.figures)
    return ConvergenceError.exit_status if failures else 0


def _write_page(
    task: RunTask, analyses: Analyses, dataset: LabelledDataset, summaries: Summaries, checks: dict[str, list[Check]],
    lives: dict[str, BearingLives | str], sampling: list[str], method: list[tuple[str, str]], out: Path,
) -> str:  # fmt: skip
    """Write the page of the run; return its name."""
    from ltca.page.run_page import PAGE, Run, run_page
    from ltca.page.writing import write_page

    light = {name: at_light_torque(analysis) for name, analysis in analyses.items()}
    run = Run(
        dataset=dataset,
        drives={name: analysis.as_written for name, analysis in analyses.items()},
        engine=task.engine,
        summaries=summaries,
        checks=checks,
        lives=lives,
        sampling=sampling,
        method=method,
        light=labelled_results(task.file.name, light, task.file.text),
        compared=task.compared,
    )
    write_page(out / PAGE, run_page(run))
    return PAGE


def _lives(analysis: LoadedAnalysis) -> BearingLives | str:
    """Lives of the crank bearings of a case, or why it has none."""
    if not (analysis.is_complete and covers_whole_turns(analysis.full.crank_angle)):
        return "positions cover no whole turn or have no answer."
    try:
        return bearing_lives(analysis)
    except CycloError as error:
        return str(error)


def _analyse(
    cases: dict[str, Drive], angles: FloatArray, torque: float | None, engine: Engine, title: str
) -> tuple[Analyses, dict[str, ConvergenceError]]:
    """Analyses of all cases; those without an answer at some positions, and why."""
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


def _checks(analyses: Analyses, summaries: Summaries, limits: Mapping[str, Limits]) -> dict[str, list[Check]]:
    """The checks of each case that has an answer everywhere."""
    return {
        name: judge_analysis(analysis, summaries[name], limits[name], lives=False)
        for name, analysis in analyses.items()
        if analysis.is_complete
    }


def _proportions(analyses: Analyses) -> dict[str, list[str]]:
    """Unusual proportions of each case that has an answer everywhere."""
    return {
        name: [*odd_proportions(analysis.as_written)] for name, analysis in analyses.items() if analysis.is_complete
    }


def _verdicts(checks: dict[str, list[Check]], proportions: dict[str, list[str]], cautions: Sequence[str]) -> str:
    """A line for each case with the check nearest to its limit, then how far the engine is off, and unusual proportions."""
    if not checks:
        return "no verdict on partial results"
    width = max(map(len, checks))
    told = ["verdict, with the check nearest to its limit"]
    told += [f"  {name:<{width}}  {verdict_line(each)}" for name, each in checks.items()]
    told += [f"  {caution}" for caution in cautions]
    told += [f"  note: {note}" for note in with_case_names(proportions)]
    return "\n".join([*told, "  every check, what drives it and would mend it: cyclo check", ""])


def _draw(dataset: LabelledDataset, fields: Dataset | None, cases: dict[str, Drive], folder: Path, kind: str) -> None:
    from ltca.figures.pressure_figures import write_pressure_figures
    from ltca.figures.run_figures import figures_of, write_figures

    drawn = dataset.to_xarray()
    names = figures_of(drawn)
    with progress("figures", len(names)) as advance:
        for path in write_figures(drawn, folder, kind):
            advance(path.name)
    print(f"figures: {folder} ({len(names)} as {kind.upper()})")
    if fields is None:
        return
    with progress("pressure figures", 3 + len(cases)) as advance:
        for path in write_pressure_figures(drawn, fields, next(iter(cases.values())), folder, kind):
            advance(path.name)


def _many(angles: FloatArray) -> str:
    return f"{angles.size} positions" if angles.size > 1 else f"1 position, φ_C = {angles[0]:g} rad"


def _loaded(analyses: Analyses) -> dict[str, Drive]:
    """Drives as written, at the torques that they were analysed at."""
    return {name: at_torque(one.as_written, one.torque) for name, one in analyses.items()}


def _method(analyses: Analyses, summaries: Summaries, angles: FloatArray) -> list[tuple[str, str]]:
    """Method behind the values: names and texts on positions, bodies, width and holes."""
    many = _many(angles)
    sampling = f"values of {many}"
    if is_full_turn(angles):
        sampling = f"means over {many}; extremes over the turn, refined between them"
    parts = [part for case in summaries.values() if (part := with_residual_part(case)["residual_part"]) is not None]
    if parts:
        sampling += f"; forces balance within {max(parts):.1e} of the largest bearing load"
    found = {
        row
        for one in analyses.values()
        for row in (
            ("bodies", lent_words(one.engine, one.drive)),
            ("width", one.width_words),
            ("holes", one.hole_words),
        )
    }
    engine = next(iter(analyses.values())).engine
    found |= {("bodies", words) for words in half_space_notes(engine, _loaded(analyses))}
    shares = with_case_names({name: [one.share_words] * bool(one.share_words) for name, one in analyses.items()})
    return [("sampling", sampling), *sorted(row for row in found if row[1]), *(("disc shares", one) for one in shares)]


def _warnings(analyses: Analyses, summaries: Summaries, angles: FloatArray) -> list[str]:
    """Warnings on sampling, drive and solution, as lines."""
    whole = is_full_turn(angles)
    warnings: dict[str, list[str]] = {}
    for name, analysis in analyses.items():
        found = [sampling_warning(analysis.drive, angles), relieved_rows_warning(analysis), *analysis.warnings]
        if whole and analysis.is_complete and summaries[name]["refined_max_pin_load_N"] is None:
            found.append("extremes are those of the positions: one between them has no answer")
        before = unit_warnings(analysis.as_written, analysis.torque)  # told before the work began
        warnings[name] = [warning for warning in found if warning is not None and warning not in before]
    return [f"warning: {text}" for text in with_case_names(warnings)]
