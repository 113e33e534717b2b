"""Page of a tolerance study or a sweep: statistics of quantities over the samples, and their sensitivity."""

from __future__ import annotations

from ltca.analysis.engines import describe_engine
from ltca.page.study_page import Section, StudyPage
from ltca.page.tables import Table, number, word
from ltca.quantities import SCALARS
from ltca.studies.run_study import StudySummary
from ltca.studies.study import Study
from ltca.studies.study_results import PERCENTILES

MOST_SHARES = 5
"""Fields told of a quantity."""
MOST_FAILURES = 50


def samples_page(study: Study, found: StudySummary) -> StudyPage:
    """Return the page of a study: settings, statistics, sensitivity and failed samples."""
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
    sections = [
        Section(heading="Over all samples", tables=[Table(name="quantities", caption="", columns=heads, rows=rows)])
    ]
    shares = [
        [word(SCALARS[name].title), word(study.field_words(path)), number(100.0 * share, "{:.1f}", "%")]
        for name, entry in found.ranking["quantities"].items()
        for path, share in list(entry["shares"].items())[:MOST_SHARES]
    ]
    if shares:
        table = Table(name="sensitivity", caption="", columns=["quantity", "field", "part"], rows=shares, words=1)
        note = f"Ranked by {found.ranking['method']}; small parts are noise of the samples."
        sections.append(Section(heading="What matters", notes=[note], tables=[table]))
    failures = [[word(str(sample)), word(" ".join(message.split())[:300])] for sample, message in found.failures]
    if failures:
        table = Table(name="failures", caption="", columns=["sample", "reason"], rows=failures[:MOST_FAILURES], words=1)
        sections.append(Section(heading="Samples without an answer", tables=[table]))
    sentence, state = "", ""
    if failures:
        sentence, state = f"{len(failures)} of {study.design.samples} samples have no answer.", "fail"
    told = f"{study.load_words()}: {study.design.samples} samples × {study.positions} positions, {describe_engine(study.engine)}"
    made = {**study.engine.options, "positions": str(study.positions), "samples": str(study.design.samples)}
    return StudyPage(name=study.name, told=told, sentence=sentence, state=state, sections=sections, made=made)
