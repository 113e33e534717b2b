"""A study from start to files: solve what is left, finish the dataset, sum it up, draw it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from ltca.analysis.engines import SHARED_BODY
from ltca.analysis.time_need import TOLD_FROM
from ltca.compliance.coefficient_files import told_seconds
from ltca.errors import CycloError
from ltca.output.files import whole_file, write_json
from ltca.output.threads import on_one_thread
from ltca.quantities import SCALARS
from ltca.reading.writing import drive_text
from ltca.studies.batch_analysis import analyse_samples
from ltca.studies.binding import Binding, find_binding
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers, solve_batches
from ltca.studies.sensitivity import rank
from ltca.studies.shapes import find_beforehand, find_rings_beforehand
from ltca.studies.study import Study
from ltca.studies.study_results import (
    PERCENTILES,
    QuantitySummary,
    read_binds,
    read_failures,
    read_quantity,
    summarise_quantity,
)
from ltca.studies.yields import Yield, find_yield


@dataclass(frozen=True, slots=True, kw_only=True)
class StudySummary:
    """What a finished study says.

    Attributes
    ----------
    quantities : dict of str to QuantitySummary
        Quantities with at least one sound sample.
    nominal : dict of str to float
        Quantities of the first case without deviations; empty when it cannot be solved.
    ranking : dict
        Of `ltca.studies.sensitivity.rank`.
    judged : Yield or None
        Parts of the samples that keep the limits; None without limits, and of sweeps, whose samples are no chance.
    binding : Binding or None
        Which samples bind; None of sweeps.
    failures : tuple of (int, str)
        Failed samples and why.
    solved_positions : int
        Positions solved in this call, without those a resumed study had.
    seconds : float
        Wall time of solving them.
    """

    quantities: dict[str, QuantitySummary]
    nominal: dict[str, float]
    ranking: dict[str, Any]
    judged: Yield | None
    binding: Binding | None
    failures: tuple[tuple[int, str], ...]
    solved_positions: int
    seconds: float


@on_one_thread
def run_study(
    study: Study,
    folder: StudyFolder,
    workers: Workers,
    *,
    resume: bool = False,
    replace: bool = False,
    advance: Callable[[int, float], None] = lambda samples, rate: None,
    told: Callable[[str], None] = lambda message: None,
) -> StudySummary:
    """Run a study, or what is left of it, and write its files.

    `resume` continues what the folder holds, `replace` makes room for another study. `advance` is called with the number of
    samples of every finished batch and the rate so far in positions per second; `told` with lines on what is derived before
    samples are solved and on kept batches that cannot be used. Raises `CycloError` when the folder holds something else, no
    sample has influence coefficients, or workers die again and again.
    """
    left = folder.prepare(study, resume, told, replace=replace)
    if study.engine.rings:
        told(
            f"samples whose ring differs from that of the drive by at most {SHARED_BODY:.1%} of its height and of its seats take "
            "its finite elements (single loads within some 0.3 % of the largest)"
        )
        find_rings_beforehand(study.rings(left), told)
    if not study.engine.batches:
        told(
            f"samples whose bodies differ from those of the drive by at most {SHARED_BODY:.1%} in every number take its "
            "influence coefficients (single loads within some 0.4 %, stresses 0.7 %)"
        )
        find_beforehand(study.engine, study.shapes(left), told)
    waiting = sum(last - first for first, last in map(study.samples_of, left))
    advance(study.design.samples - waiting, 0.0)
    began, solved, timed = time.perf_counter(), 0, False
    for result in solve_batches(study, left, workers):
        folder.store(study, result)
        solved += len(result.messages) * study.positions
        waiting -= len(result.messages)
        if (
            not timed
            and (rest := waiting * (time.perf_counter() - began) / len(result.messages) / workers.processes) > TOLD_FROM
        ):
            told(f"the other {waiting} samples take {told_seconds(rest)}, by the first {len(result.messages)}")
        timed = True
        advance(len(result.messages), solved / (time.perf_counter() - began))
    seconds = time.perf_counter() - began
    failures = read_failures(folder.results) if not left and folder.results.exists() else folder.finish(study)
    quantities, values = {}, {name: read_quantity(folder.results, name) for name in study.quantities}
    for name, each in values.items():
        summary = summarise_quantity(each)
        if summary is not None:
            quantities[name] = summary
    binding = find_binding(study, values, read_binds(folder.results) if study.counts_binding else None)
    without_play = None if binding is None else binding.keeps_no_limit
    found = StudySummary(
        quantities=quantities,
        nominal=_nominal(study),
        ranking=rank(folder.results, study),
        judged=find_yield(study.judged, values, study.design, study.not_judged, without_play),
        binding=binding,
        failures=tuple(failures),
        solved_positions=solved,
        seconds=seconds,
    )
    _write_summary(study, folder, found)
    return found


def _nominal(study: Study) -> dict[str, float]:
    solved = analyse_samples([study.cases[0][1]], study.settings)
    if solved.messages[0]:
        return {}
    return dict(zip(study.quantities, map(float, solved.values[0]), strict=True))


def _write_summary(study: Study, folder: StudyFolder, found: StudySummary) -> None:
    """Write ``summary.json`` and the drives of failed samples; nothing in them depends on time."""
    write_json(
        folder.path / "summary.json",
        {
            "study": study.name,
            "samples": study.design.samples,
            "positions": study.positions,
            "failed": len(found.failures),
            "percentiles": list(PERCENTILES),
            "compliance": study.engine.compliance,
            "units": {name: SCALARS[name].unit for name in study.quantities},
            "nominal": found.nominal,
            "quantities": {name: asdict(summary) for name, summary in found.quantities.items()},
            "sensitivity": found.ranking,
            **({} if found.judged is None else {"yield": found.judged.content()}),
            **({} if found.binding is None or found.binding.counted is None else {"binding": found.binding.content()}),
            **({"eccentrics": owners} if (owners := study.eccentrics()) else {}),
        },
    )
    for sample, _ in found.failures:
        write_sample(study, folder, sample)


def sample_file(number: str) -> str:
    """Return where the drive of a sample, by its number of eight digits, lies in the folder of a study."""
    return f"samples/sample_{number}.toml"


def write_sample(study: Study, folder: StudyFolder, sample: int) -> str:
    """Write the drive of one sample as a drive file, ready for ``cyclo run``; return where it is.

    A sample that is no sound drive is written as a list of its fields with the reason.
    """
    path = folder.path / sample_file(f"{sample:08d}")
    try:
        text = drive_text(study.sample_drive(sample))
    except CycloError as error:
        fields = study.design.fields(study.design.rows(sample, sample + 1)[0])
        reason = "\n".join(f"# {line}" for line in str(error).splitlines())
        told = {
            study.field_words(name): list(value) if isinstance(value, tuple) else value
            for name, value in fields.items()
        }
        lines = [f"# {name} = {value}" for name, value in told.items()]
        text = f"# Sample {sample} of {study.name} is no sound drive:\n{reason}\n" + "\n".join(lines) + "\n"
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    return str(path)
