"""Run of a study: claim its folder, solve its samples, then write, draw and print the results."""

from __future__ import annotations

import argparse
import sys
import textwrap
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path

from ltca.analysis.engines import describe_engine
from ltca.analysis.extremes import sampling_warning
from ltca.analysis.half_space_errors import half_space_notes
from ltca.analysis.light_torque import light_torque_lines
from ltca.arrays import FloatArray
from ltca.errors import DriveError, as_sentences
from ltca.geometry.placement import position_angles
from ltca.output.processes import Terminated
from ltca.output.progress import progress
from ltca.output.resources import require_room
from ltca.output.run_folder import BATCHES, claimed_folder, figure_files
from ltca.output.terminal import shell_words
from ltca.page.studies.samples import samples_page, values_of_one_factor, yield_words
from ltca.page.study_page import write_study_page
from ltca.quantities import SCALARS, printed
from ltca.reading.arguments import refuse_impossible_torques, tell_unit_mistakes
from ltca.studies.designs import SweepDesign
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers
from ltca.studies.run_study import StudySummary, run_study, sample_file, write_sample
from ltca.studies.sensitivity import is_chance, together_words
from ltca.studies.study import Study
from ltca.studies.study_results import read_quantity
from ltca.studies.yields import CONFIDENCE, METHOD, Yield, left_out

COPIES = 3
"""Of all numbers of a study there are for a while batches, dataset and table."""
MOST_REASONS = 5
"""Reasons of failing samples that are printed."""
COLUMN, SCREEN = 14, 100
"""Letters of a heading beside others, and of a line."""


def execute_study(study: Study, folder: StudyFolder, arguments: argparse.Namespace) -> int:
    """Run a study with progress; write its figures and page, print its results."""
    workers = Workers(processes=arguments.workers, scheduler=arguments.scheduler)
    if arguments.sample is not None:
        if not 0 <= arguments.sample < study.design.samples:
            raise DriveError([f"--sample = {arguments.sample}: must be from 0 to {study.design.samples - 1}"])
        with claimed_folder(
            folder.path, "study", writes=[sample_file(f"{arguments.sample:08d}")], adding=True, beside=(BATCHES,)
        ):
            print(f"drive of sample {arguments.sample}: {write_sample(study, folder, arguments.sample)}")
        return 0
    if study.near_nominal:  # what a sweep varies may carry the torque
        refuse_impossible_torques(drive for _, drive in study.cases)
    columns = len(study.design.names) + len(study.quantities)
    size = COPIES * 8.0 * columns * study.design.samples
    require_room(size, memory=0.0, folder=folder.path, option=f"{study.design.samples} samples")
    figures = figure_files(arguments.figures, "responses", "distributions", "sensitivity")
    writes = [*(path.name for path in folder.files), "summary.json", sample_file("[0-9]" * 8), *figures]
    writes += [] if arguments.no_page else ["report.html"]
    # Of its own files that are not as it wrote them a study tells what to do, or it was told to replace them.
    renewing = tuple(path.name for path in folder.files) if arguments.resume or arguments.force else ()
    with claimed_folder(folder.path, "study", writes=writes, beside=(BATCHES,), renewing=renewing) as held:
        if arguments.resume:
            if not folder.has_batches():
                held.require_whole(*folder.files[1:])
            held.keep(*folder.files)
        try:
            return _solve_and_write(study, folder, workers, arguments)
        except (KeyboardInterrupt, Terminated):
            if folder.has_batches():
                tell(f"finished batches are kept in {folder.path}: continue with --resume")
            raise


def _solve_and_write(study: Study, folder: StudyFolder, workers: Workers, arguments: argparse.Namespace) -> int:
    typed = "`positions = {}` in the study file" if isinstance(study.design, SweepDesign) else "--positions {}"
    warning = sampling_warning(study.cases[0][1], position_angles(study.positions), refined=False, typed=typed)
    if warning is not None:
        tell(f"warning: {warning}")
    tell_unit_mistakes((drive for _, drive in study.cases), limits=[study.limits])
    with progress("samples", study.design.samples) as bar:

        def advance(samples: int, rate: float) -> None:
            bar(f"{rate:.0f} positions/s" if rate else "", samples)

        found = run_study(
            study, folder, workers, resume=arguments.resume, replace=arguments.force, advance=advance, told=tell
        )
    values = {name: read_quantity(folder.results, name) for name in study.quantities}
    _print(study, folder, found, values, _compliance_words(study, arguments.coefficients))
    if not arguments.no_page:
        print(f"page: {write_study_page(samples_page(study, found, values), folder.path)}")
    if found.quantities and arguments.figures:
        from ltca.figures.study_figures import write_study_figures

        paths = list(write_study_figures(folder, study, found.ranking, found.nominal, arguments.figures))
        print(f"figures: {folder.path / 'figures'} ({len(paths)} as {arguments.figures.upper()})")
    if found.failures:
        # Said last and as `run` says it: what stands above is that of the samples that have an answer.
        tell(f"cyclo: error: partial: {len(found.failures)} of {study.design.samples} samples failed")
    return 1 if found.failures else 0


def tell(message: str) -> None:
    """Print a message to stderr, beside the results."""
    print(message, file=sys.stderr)


def name_width(names: Sequence[str], least: int) -> int:
    """Return the width of the column of names of a table, wider than `least` where one of them is longer."""
    return max(least, 2 + max(map(len, names), default=0))


def _print(
    study: Study, folder: StudyFolder, found: StudySummary, values: Mapping[str, FloatArray], compliance: str
) -> None:
    samples = f"{study.design.samples} samples × {study.positions} positions"
    print(f"{study.name}, {study.load_words()}: {samples}, {describe_engine(study.engine)}")
    for line in (*half_space_notes(study.engine, dict(study.cases)), *light_torque_lines(dict(study.cases))):
        print(line)
    if found.solved_positions:
        rate = found.solved_positions / found.seconds
        print(f"solved in {found.seconds:.1f} s, {rate:.0f} positions/s")
    print(study.sampled_words)
    if (one := values_of_one_factor(study)) is not None:
        print(_value_table(*one, values))
    else:
        _print_statistics(study, found)
    _print_failures(study, folder, found)
    leading = next(iter(found.quantities), None)
    if leading is not None:
        summary = found.quantities[leading]
        worst = summary.smallest_sample if SCALARS[leading].more_is_better else summary.largest_sample
        words = f"{shell_words([write_sample(study, folder, worst)])}{compliance}"
        print(f"worst by {SCALARS[leading].title}: cyclo run {words}")
    if found.judged is not None:
        _print_yield(found.judged)
    for line in [] if found.binding is None else found.binding.words():
        print(line)
    for key, reason in left_out(study.judged, study.quantities, study.not_judged).items():
        print(f"  limit {key} is not judged: {reason}")
    print(f"results: {folder.results}, {folder.table}, {folder.path / 'summary.json'}")


def _value_table(title: str, values: Sequence[str], quantities: Mapping[str, FloatArray]) -> str:
    """Quantities of a sweep with one row for every value of its factor, as many columns side by side as the screen takes."""
    cells = [
        [printed(number, "{:.5g}", SCALARS[name].unit) if isfinite(number) else "–" for number in each]
        for name, each in quantities.items()
    ]
    heads = [textwrap.wrap(SCALARS[name].heading, COLUMN, break_long_words=False) for name in quantities]
    heads, cells = [textwrap.wrap(title, 2 * COLUMN, break_long_words=False), *heads], [[*values], *cells]
    wide = [max(map(len, [*head, *column])) for head, column in zip(heads, cells, strict=True)]
    lines: list[str] = []
    first = 1
    while first < len(heads):
        last = first + 1
        while last < len(heads) and wide[0] + sum(2 + width for width in wide[first : last + 1]) <= SCREEN:
            last += 1
        shown = [0, *range(first, last)]
        deep = max(len(heads[column]) for column in shown)
        rows = [[""] * (deep - len(heads[column])) + heads[column] + cells[column] for column in shown]
        lines += [""] if lines else []
        lines += [
            "  ".join(f"{text:>{wide[column]}}" for column, text in zip(shown, row, strict=True)).rstrip()
            for row in zip(*rows, strict=True)
        ]
        first = last
    return "\n".join(lines)


def _print_statistics(study: Study, found: StudySummary) -> None:
    """Print mean, percentiles and largest of every quantity, and what matters."""
    wide = name_width([SCALARS[name].heading for name in found.quantities], 48)
    print(f"{'':<{wide}}{'nominal':>10}{'mean':>10}{'1 %':>10}{'50 %':>10}{'99 %':>10}{'largest':>10}  sample")
    for name, summary in found.quantities.items():
        numbers = [found.nominal.get(name, float("nan")), summary.mean, *(summary.percentiles[i] for i in (1, 3, 5))]
        cells = "".join(f"{value:>10.4g}" for value in [*numbers, summary.largest])
        print(f"{SCALARS[name].heading:<{wide}}{cells}  {summary.largest_sample}")
    print(f"sensitivity: {found.ranking['method']}")
    for name, entry in list(found.ranking["quantities"].items())[:3]:
        first = [
            f"{study.field_words(path)} {100.0 * share:z.0f} %"
            for path, share in list(entry["shares"].items())[:3]
            if not is_chance(entry, path)
        ]
        told = ", ".join(first) or "nothing beyond chance"
        print(f"  {SCALARS[name].title}: {told} ({together_words(entry)})")
    linear = [entry["explained"] for entry in found.ranking["quantities"].values()]
    if "regression" in found.ranking["method"] and linear and min(linear) < 0.5:
        print("  regression misses what is curved or mutual; 'cyclo tolerance --design saltelli' ranks that too")


def _print_yield(found: Yield) -> None:
    """Print which part of the samples keeps each limit, and all of them."""
    samples = f"{found.together.samples} samples, {100.0 * CONFIDENCE:g} % intervals of {METHOD}"
    print(f"yield, {samples}:")
    wide = name_width([f"{one.title} {one.bound}" for one, _ in found.each], 62)
    for one, kept in found.each:
        print(f"  {f'{one.title} {one.bound}':<{wide}}{yield_words(kept)}")
    if len(found.each) > 1:
        print(f"  {'all limits together':<{wide}}{yield_words(found.together)}")


def _print_failures(study: Study, folder: StudyFolder, found: StudySummary) -> None:
    """Print how many samples failed, and their reasons with the first sample of each."""
    if not found.failures:
        return
    print(f"{len(found.failures)} of {study.design.samples} samples failed; their drives: {folder.path / 'samples'}")
    reasons: dict[str, list[int]] = {}
    for sample, message in found.failures:
        reasons.setdefault(as_sentences(message), []).append(sample)
    for message, samples in list(reasons.items())[:MOST_REASONS]:
        more = f" and {len(samples) - 1} more" if len(samples) > 1 else ""
        print(f"  sample {samples[0]}{more}: {message}")
    if len(reasons) > MOST_REASONS:
        print(f"  and {len(reasons) - MOST_REASONS} other reasons")


def _compliance_words(study: Study, coefficients: Sequence[Path] | None) -> str:
    """Options with which `cyclo run` solves a sample as the study did."""
    options = study.engine.options
    own = study.cases[0][1].analysis
    words = "" if options["compliance"] == own.compliance else f" --compliance {options['compliance']}"
    words += "" if options.get("bodies", own.bodies) == own.bodies else f" --bodies {options['bodies']}"
    words += "".join(f" --coefficients {path}" for path in coefficients or ())
    return words + (" --no-hole-near-field" if options.get("hole_near_field") == "no" else "")
