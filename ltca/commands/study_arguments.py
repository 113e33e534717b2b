"""Arguments and output that the study commands share."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ltca.commands.compliance_arguments import add_compliance_arguments
from ltca.reading.arguments import (
    add_figures_argument,
    add_out_argument,
    add_page_argument,
    count_argument,
    tell_unit_mistakes,
)

if TYPE_CHECKING:
    from ltca.studies.execution.storage import StudyFolder
    from ltca.studies.execution.workers import Workers
    from ltca.studies.run_study import StudySummary
    from ltca.studies.study import Study

DEFAULT_POSITIONS = 28
COPIES = 3
"""Of all numbers of a study there are for a while batches, dataset and table."""
SCHEDULER = re.compile(r"inproc://\S+|((tcp|tls|ws|wss|ucx)://)?(\[[0-9a-fA-F:.%]+\]|[\w.-]+):(?P<port>[0-9]{1,5})")
"""Addresses of a dask scheduler; at anything else dask itself looks for 20 s and ends in tracebacks."""
MOST_REASONS = 5
"""Reasons of failing samples that are printed."""


def add_positions_argument(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the positions of every sample or candidate."""
    parser.add_argument(
        "--positions",
        metavar="N",
        type=count_argument("--positions", 1, 100_000),
        default=DEFAULT_POSITIONS,
        help=f"crank angles 2πk/N of every {what}; default {DEFAULT_POSITIONS}",
    )


def add_seed_argument(parser: argparse.ArgumentParser) -> None:
    """Add the seed of random numbers."""
    parser.add_argument(
        "--seed",
        metavar="S",
        type=count_argument("--seed", 0, 2**63 - 1),
        default=0,
        help="of the random numbers; default 0",
    )


def add_worker_arguments(parser: argparse.ArgumentParser) -> None:
    """Add who solves: local processes or a cluster."""
    parser.add_argument(
        "--workers",
        metavar="W",
        type=count_argument("--workers", 1, 1024),
        default=1,
        help="local processes; default 1",
    )
    parser.add_argument("--scheduler", metavar="URL", default="", help="dask.distributed scheduler, tcp://host:port")


def add_study_arguments(parser: argparse.ArgumentParser, command: str) -> None:
    """Add what every study has: compliance, who solves it, folder, resuming, figures."""
    add_compliance_arguments(parser)
    add_worker_arguments(parser)
    add_out_argument(parser, command)
    parser.add_argument("--resume", action="store_true", help="continue an interrupted study in --out")
    parser.add_argument("--force", action="store_true", help="replace another study in --out")
    add_figures_argument(parser)
    add_page_argument(parser)
    parser.add_argument(
        "--sample",
        metavar="I",
        type=count_argument("--sample", 0, 100_000_000),
        help="write the drive of sample I as a drive file and solve nothing",
    )


def check_worker_arguments(arguments: argparse.Namespace) -> None:
    """Refuse local processes beside a cluster, and addresses at which dask would look for no scheduler."""
    from ltca.errors import DriveError, shortened

    if arguments.scheduler:
        found = SCHEDULER.fullmatch(arguments.scheduler)
        if found is None or not 0 < int(found["port"] or 1) < 65536:
            told = "must be the address of a dask scheduler, host and port, as tcp://127.0.0.1:8786"
            raise DriveError([f"--scheduler = {shortened(arguments.scheduler)}: {told}"])

    if arguments.scheduler and arguments.workers > 1:
        raise DriveError(["--workers and --scheduler: give one of them; a cluster has its own workers"])


def check_study_arguments(arguments: argparse.Namespace) -> None:
    """Refuse options that contradict each other, before anything is imported."""
    from ltca.errors import DriveError

    check_worker_arguments(arguments)
    if arguments.resume and arguments.force:
        raise DriveError(
            ["--resume and --force: give one of them; one goes on with the study in --out, one replaces it"]
        )


def workers_of(arguments: argparse.Namespace) -> Workers:
    """Return the workers asked for."""
    from ltca.studies.execution.workers import Workers

    return Workers(processes=arguments.workers, scheduler=arguments.scheduler)


def execute_study(study: Study, folder: StudyFolder, arguments: argparse.Namespace) -> int:
    """Run a study with progress, write its figures and print what it says."""
    from ltca.errors import DriveError
    from ltca.output.processes import Terminated
    from ltca.output.resources import require_room
    from ltca.output.run_folder import BATCHES, claimed_folder, figure_files
    from ltca.studies.run_study import sample_file, write_sample

    workers = workers_of(arguments)
    if arguments.sample is not None:
        if not 0 <= arguments.sample < study.design.samples:
            raise DriveError([f"--sample = {arguments.sample}: must be from 0 to {study.design.samples - 1}"])
        with claimed_folder(
            folder.path, "study", writes=[sample_file(f"{arguments.sample:08d}")], adding=True, beside=(BATCHES,)
        ):
            print(f"drive of sample {arguments.sample}: {write_sample(study, folder, arguments.sample)}")
        return 0
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
    from ltca.analysis.extremes import sampling_warning
    from ltca.geometry.placement import position_angles
    from ltca.output.progress import progress
    from ltca.studies.run_study import run_study

    warning = sampling_warning(study.cases[0][1], position_angles(study.positions), refined=False)
    if warning is not None:
        tell(f"warning: {warning}")
    tell_unit_mistakes(drive for _, drive in study.cases)
    with progress("samples", study.design.samples) as bar:

        def advance(samples: int, rate: float) -> None:
            bar(f"{rate:.0f} positions/s" if rate else "", samples)

        found = run_study(
            study, folder, workers, resume=arguments.resume, replace=arguments.force, advance=advance, told=tell
        )
    _print(study, folder, found, _compliance_words(study, arguments.coefficients))
    if not arguments.no_page:
        from ltca.page.studies.samples import samples_page
        from ltca.page.study_page import write_study_page

        print(f"page: {write_study_page(samples_page(study, found), folder.path)}")
    if found.quantities and arguments.figures:
        from ltca.figures.study_figures import write_study_figures

        paths = list(write_study_figures(folder, study, found.ranking, found.nominal, arguments.figures))
        print(f"figures: {folder.path / 'figures'} ({len(paths)} as {arguments.figures.upper()})")
    if found.failures:
        # Said last and as `run` says it: what stands above is that of the samples that have an answer.
        tell(f"cyclo: error: partial: {len(found.failures)} of {study.design.samples} samples failed")
    return 1 if found.failures else 0


def tell(message: str) -> None:
    """Tell something beside the results, on stderr."""
    print(message, file=sys.stderr)


def _print(study: Study, folder: StudyFolder, found: StudySummary, compliance: str) -> None:
    from ltca.analysis.engines import describe_engine
    from ltca.quantities import SCALARS
    from ltca.studies.run_study import write_sample

    samples = f"{study.design.samples} samples × {study.positions} positions"
    print(f"{study.name}, {study.load_words()}: {samples}, {describe_engine(study.engine)}")
    if found.solved_positions:
        rate = found.solved_positions / found.seconds
        print(f"solved in {found.seconds:.1f} s, {rate:.0f} positions/s")
    print(f"{'':<48}{'nominal':>10}{'mean':>10}{'1 %':>10}{'50 %':>10}{'99 %':>10}{'largest':>10}  sample")
    for name, summary in found.quantities.items():
        numbers = [found.nominal.get(name, float("nan")), summary.mean, *(summary.percentiles[i] for i in (1, 3, 5))]
        cells = "".join(f"{value:>10.4g}" for value in [*numbers, summary.largest])
        print(f"{SCALARS[name].heading:<48}{cells}  {summary.largest_sample}")
    print(f"sensitivity: {found.ranking['method']}")
    for name, entry in list(found.ranking["quantities"].items())[:3]:
        first = [
            f"{study.field_words(path)} {100.0 * share:.0f} %" for path, share in list(entry["shares"].items())[:3]
        ]
        print(f"  {SCALARS[name].title}: {', '.join(first)} (first order together: {100.0 * entry['explained']:.0f} %)")
    linear = [entry["explained"] for entry in found.ranking["quantities"].values()]
    if "regression" in found.ranking["method"] and linear and min(linear) < 0.5:
        print("  regression misses what is curved or mutual; 'cyclo tolerance --design saltelli' ranks that too")
    _print_failures(study, folder, found)
    leading = next(iter(found.quantities), None)
    if leading is not None:
        summary = found.quantities[leading]
        worst = summary.smallest_sample if SCALARS[leading].more_is_better else summary.largest_sample
        words = f"{write_sample(study, folder, worst)}{compliance}"
        print(f"worst by {SCALARS[leading].title}: cyclo run {words}")
    print(f"results: {folder.results}, {folder.table}, {folder.path / 'summary.json'}")


def _print_failures(study: Study, folder: StudyFolder, found: StudySummary) -> None:
    """How many samples failed, and each reason once with its first sample."""
    if not found.failures:
        return
    print(f"{len(found.failures)} of {study.design.samples} samples failed; their drives: {folder.path / 'samples'}")
    reasons: dict[str, list[int]] = {}
    for sample, message in found.failures:
        reasons.setdefault(" ".join(message.split()), []).append(sample)
    for message, samples in list(reasons.items())[:MOST_REASONS]:
        more = f" and {len(samples) - 1} more" if len(samples) > 1 else ""
        print(f"  sample {samples[0]}{more}: {message[:300]}")
    if len(reasons) > MOST_REASONS:
        print(f"  and {len(reasons) - MOST_REASONS} other reasons")


def _compliance_words(study: Study, coefficients: Sequence[Path] | None) -> str:
    """What `cyclo run` has to be told to solve a sample as the study did."""
    options = study.engine.options
    words = "" if options["compliance"] == "half-space" else f" --compliance {options['compliance']}"
    words += "".join(f" --coefficients {path}" for path in coefficients or ())
    return words + (" --no-hole-near-field" if options.get("hole_near_field") == "no" else "")
