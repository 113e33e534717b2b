"""Page of a tolerance study or a sweep: yield, distributions or responses over all samples, and what matters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ltca.analysis.engines import describe_engine
from ltca.analysis.half_space_errors import half_space_notes
from ltca.analysis.light_torque import light_torque_lines
from ltca.arrays import FloatArray
from ltca.drive.units.quantities import label
from ltca.errors import as_sentences
from ltca.page.study_page import Curves, Factor, Mark, Responses, Section, StudyPage
from ltca.page.tables import Cell, Table, number, word
from ltca.quantities import SCALARS
from ltca.studies.designs import SweepDesign, SweepFactor
from ltca.studies.run_study import StudySummary
from ltca.studies.sensitivity import CHANCE_WORDS, is_chance
from ltca.studies.study import Study
from ltca.studies.study_results import PERCENTILES, field_column
from ltca.studies.yields import CONFIDENCE, METHOD, Kept, Yield

MOST_SHARES = 5
"""Fields told of a quantity."""
MOST_FAILURES = 50
MOST_POINTS = 50_000
"""Samples of a sweep that a page holds; of more of them evenly many."""
MOST_JOINED = 2000
"""Samples of a grid up to which those alike in all other factors are joined by lines."""
MOST_BINS = 60
MOST_ROWS = 12
"""Values of the one factor of a sweep up to which each has a row, in the place of percentiles."""
SEEN_BEYOND = 1.0
"""Distance of a limit from the samples, by their span, up to which a histogram goes as far as the limit."""


def values_of_one_factor(study: Study) -> tuple[str, list[str]] | None:
    """Heading and values of the one factor of a sweep, by sample; None for other studies, or above `MOST_ROWS`."""
    design = study.design
    if not isinstance(design, SweepDesign) or len(design.factors) > 1 or design.samples > MOST_ROWS:
        return None
    (factor,) = design.factors
    numbers = design.rows(0, design.samples)[:, 0]
    values = [factor.value(number) for number in numbers]
    return _factor_title(study, factor), [value if isinstance(value, str) else f"{value:.6g}" for value in values]


def samples_page(study: Study, found: StudySummary, values: Mapping[str, FloatArray]) -> StudyPage:
    """Return the page of a study; `values` of every quantity have shape (samples,), not a number where a sample failed."""
    binding = [] if found.binding is None else [f"{one[0].upper()}{one[1:]}." for one in found.binding.words()]
    sampled = f"{study.sampled_words[0].upper()}{study.sampled_words[1:]}."
    sections = [_yield_section(found.judged, binding)] if found.judged is not None else []
    if binding and not sections:
        sections.append(Section(heading="Samples that bind", notes=binding))
    if isinstance(study.design, SweepDesign):
        sections.append(_responses(study, study.design, values))
    else:
        sections.append(_distributions(study, found, values))
    if (one := values_of_one_factor(study)) is not None:
        sections.append(_one_row_a_value(*one, values, sampled))
    else:
        sections += [_statistics(found, sampled), *_ranking(study, found)]
    failures = [[word(str(sample)), word(as_sentences(message))] for sample, message in found.failures]
    if failures:
        table = Table(name="failures", caption="", columns=["sample", "reason"], rows=failures[:MOST_FAILURES], words=1)
        sections.append(Section(heading="Samples without an answer", tables=[table]))
    sentences, state = [], ""
    if found.judged is not None:
        sentences.append(f"{yield_words(found.judged.together)} of the samples keep all limits.")
    if failures:
        sentences.append(f"{len(failures)} of {study.design.samples} samples have no answer.")
        state = "fail"
    told = f"{study.load_words()}: {study.design.samples} samples × {study.positions} positions, {describe_engine(study.engine)}"
    made = {**study.engine.options, "positions": str(study.positions), "samples": str(study.design.samples)}
    told = "; ".join([told, *half_space_notes(study.engine, dict(study.cases)), *light_torque_lines(dict(study.cases))])
    return StudyPage(
        name=study.name, told=told, sentence=" ".join(sentences), state=state, sections=sections, made=made
    )


def yield_words(kept: Kept) -> str:
    """Return a part with its interval, per cent.

    Examples
    --------
    >>> yield_words(Kept(kept=20, samples=20, low=0.83157, high=1.0))
    '100.0 % (83.2 … 100.0 %)'
    """
    return f"{100.0 * kept.part:.1f} % ({100.0 * kept.low:.1f} … {100.0 * kept.high:.1f} %)"


def _yield_section(found: Yield, binding: list[str]) -> Section:
    def cells(kept: Kept) -> list[Cell]:
        ends = f"{100.0 * kept.low:.1f} … {100.0 * kept.high:.1f} %"
        return [number(float(kept.kept), "{:.0f}"), number(100.0 * kept.part, "{:.1f}", "%"), word(ends)]

    rows = [[word(one.title), word(one.bound), *cells(kept), word(one.limit.source)] for one, kept in found.each]
    rows.append([word("all together"), word(""), *cells(found.together), word("")])
    columns = [
        "quantity",
        "limit",
        "samples that keep it",
        "part",
        f"{100.0 * CONFIDENCE:g} % interval",
        "source of the limit",
    ]
    table = Table(name="yield", caption="", columns=columns, rows=rows, last_words=1)
    told = (
        f"Of {found.together.samples} independent samples; interval of {METHOD} for the part of all drives made so. "
        "A sample without an answer keeps no limit."
    )
    left = [[word(key), word(reason)] for key, reason in found.not_judged.items()]
    columns, caption = ["limit", "reason"], "Limits that samples are not judged by"
    others = [Table(name="not_judged", caption=caption, columns=columns, rows=left, words=1)] if left else []
    return Section(heading="Yield", notes=[told, *binding], tables=[table, *others])


def _statistics(found: StudySummary, sampled: str) -> Section:
    heads = ["", "nominal", "mean", "standard deviation", *(f"{part:g} %" for part in PERCENTILES), "largest", "sample"]
    rows = [
        [
            word(SCALARS[name].heading),
            number(found.nominal.get(name), "{:.4g}"),
            number(each.mean, "{:.4g}"),
            number(each.standard_deviation, "{:.3g}"),
            *(number(value, "{:.4g}") for value in each.percentiles),
            number(each.largest, "{:.4g}"),
            word(str(each.largest_sample)),
        ]
        for name, each in found.quantities.items()
    ]
    table = Table(name="quantities", caption="", columns=heads, rows=rows)
    return Section(heading="Over all samples", notes=[sampled], tables=[table])


def _one_row_a_value(title: str, values: Sequence[str], quantities: Mapping[str, FloatArray], sampled: str) -> Section:
    rows = [
        [word(value), *(number(float(each[row]), "{:.4g}") for each in quantities.values())]
        for row, value in enumerate(values)
    ]
    columns = [title, *(SCALARS[name].heading for name in quantities)]
    table = Table(name="values", caption="", columns=columns, rows=rows)
    return Section(heading="Values", notes=[sampled], tables=[table])


def _distributions(study: Study, found: StudySummary, values: Mapping[str, FloatArray]) -> Section:
    curves = []
    for name in found.quantities:
        finite = values[name][np.isfinite(values[name])]
        count, edges = np.histogram(finite, bins=min(MOST_BINS, max(8, int(np.sqrt(finite.size)))))
        span = float(np.ptp(edges))
        marks = []
        if name in found.nominal:
            marks.append(Mark(name="without deviations", value=found.nominal[name], colour="c-second"))
        for one in study.judged:
            if one.quantity == name:
                value = one.limit.value
                shown = bool(edges[0] - SEEN_BEYOND * span <= value <= edges[-1] + SEEN_BEYOND * span)
                beyond = "" if shown else ", beyond the axis"
                marks.append(Mark(name=f"limit {one.bound}{beyond}", value=value, shown=shown, dashed=True))
        curves.append(
            Curves(
                title=SCALARS[name].heading,
                unit="",
                axis="samples in each bin, over the value",
                x=0.5 * (edges[1:] + edges[:-1]),
                lines={"": count.astype(float)},
                kind="bars",
                marks=marks,
            )
        )
    return Section(heading="Distributions", curves=curves)


def _responses(study: Study, design: SweepDesign, values: Mapping[str, FloatArray]) -> Section:
    every = np.arange(design.samples)
    shown = every if every.size <= MOST_POINTS else np.linspace(0, every.size - 1, MOST_POINTS).astype(int)
    numbers = design.rows(0, design.samples)[shown]
    joins = design.kind == "grid" and shown.size <= MOST_JOINED
    factors = []
    for column, factor in enumerate(design.factors):
        factors.append(
            Factor(
                title=_factor_title(study, factor),
                values=numbers[:, column],
                levels=[str(level) for level in factor.levels] if factor.is_text else (),
                path=_joined(numbers, column) if joins else np.zeros(0),
            )
        )
    notes = (
        []
        if shown.size == every.size
        else [f"{shown.size} of {every.size} samples, evenly chosen; all of them are in the files."]
    )
    quantities = {SCALARS[name].heading: values[name][shown] for name in study.quantities}
    responses = Responses(samples=shown.astype(float), factors=factors, quantities=quantities)
    return Section(heading="Responses", notes=notes, responses=responses)


def _factor_title(study: Study, factor: SweepFactor) -> str:
    """A field of a sweep with its unit."""
    unit = "" if factor.is_text else label(field_column(factor.path)["units"])
    words = study.field_words(factor.path)
    return f"{words} [{unit}]" if unit not in ("", "1") else words


def _joined(numbers: FloatArray, column: int) -> FloatArray:
    """Places of samples along one factor, those alike in all others one after another, not a number between."""
    others = np.delete(numbers, column, axis=1)
    order = np.lexsort((numbers[:, column], *others.T))
    breaks = 1 + np.flatnonzero(np.any(np.diff(others[order], axis=0) != 0.0, axis=1))
    return np.insert(order.astype(float), breaks, np.nan)


def _ranking(study: Study, found: StudySummary) -> list[Section]:
    rows, doubted = [], False
    for name, entry in found.ranking["quantities"].items():
        for path, share in list(entry["shares"].items())[:MOST_SHARES]:
            state = "chance" if is_chance(entry, path) else ""
            doubted |= bool(state)
            part = number(100.0 * share, "{:.1f}", "%", state=state)
            words = study.field_words(path)
            rows.append([word(SCALARS[name].title), Cell(text=words, value=words, state=state), part])
    if not rows:
        return []
    table = Table(name="sensitivity", caption="", columns=["quantity", "field", "part"], rows=rows, words=1)
    note = f"Ranked by {found.ranking['method']}; small parts are noise of the samples."
    if doubted:
        note = f"Ranked by {found.ranking['method']}. Grey: {CHANCE_WORDS}."
    return [Section(heading="What matters", notes=[note], tables=[table])]
