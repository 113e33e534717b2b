"""``report.html`` of a run: verdict first, the drive as it turns, its curves and tables, and what it was computed from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees
from typing import Any

from ltca.analysis.engines import describe_engine
from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.summary import refined_value
from ltca.analysis.summary_rows import rows_of, with_residual_part
from ltca.drive.members.judgement import Check
from ltca.drive.single_discs import single_discs
from ltca.output.provenance import code_hash, code_version
from ltca.page.compared import Compared, matched
from ltca.page.packing import pack
from ltca.page.run_arrays import run_arrays, shown_positions
from ltca.page.run_sections import lives_of_cases, wind_up
from ltca.page.run_tables import (
    derived_tables,
    input_tables,
    orders_table,
    summary_tables,
    turn_orders,
)
from ltca.page.scene import moving_scene
from ltca.page.tables import Table, number, texts, word
from ltca.page.verdict_tables import verdict_of, verdict_tables
from ltca.page.writing import page_text, script_data

PAGE = "report.html"
SCRIPTS = ("drawing", "plots", "motion", "stage", "run")
LOSSES = {
    "pin": "flank on wheel pins", "seat": "seats", "hole": "holes on shaft pins", "roller": "rollers",
    "support_bearing": "bearings of cranks and wheel", "no_load": "seals and oil",
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What a page of a run shows.

    Attributes
    ----------
    name, text : str
        Of the drive, and its file.
    analyses : mapping of str to LoadedAnalysis
        By case.
    summaries : mapping of str to mapping
        Scalars by case (`ltca.analysis.summary.summarise`).
    checks : mapping of str to sequence of Check
        Verdict by case; none of cases without an answer somewhere.
    sampling : sequence of str
        What the values stand for, and warnings.
    compared : Compared or None
        What stands beside it.
    """

    name: str
    text: str
    analyses: Mapping[str, LoadedAnalysis]
    summaries: Mapping[str, Mapping[str, float | None]]
    checks: Mapping[str, Sequence[Check]]
    sampling: Sequence[str]
    compared: Compared | None = None


def run_page(run: Run) -> str:
    """Return the page of a run; the same run gives the same page.

    Parameters
    ----------
    run : Run
        What it shows.
    """
    first = next(iter(run.analyses.values()))
    shown = shown_positions(run.analyses)
    sentence, state = verdict_of(run.checks)
    unjudged = [name for name in run.analyses if name not in run.checks]
    if unjudged and run.checks:
        sentence, state = f"No answer at some positions, not judged: {', '.join(unjudged)}. {sentence}", "fail"
    summary = summary_tables(run.analyses, run.summaries)
    sections = [wind_up(run.analyses, run.summaries), lives_of_cases(run.analyses)]
    places, numbers = pack(_arrays(run))
    content = {
        "cases": [_case(one) for one in run.analyses.values()],
        "names": list(run.analyses),
        "places": places,
        "cranks": first.drive.crank.number,
        "discs": first.drive.disc.number_of_discs,
        "losses": LOSSES,
        "compared": _compared(run),
    }
    return page_text(
        "run.html",
        {
            "title": f"{run.name}: loaded tooth contact analysis",
            "drive": run.name,
            "cases": list(run.analyses),
            "model": describe_engine(first.engine),
            "loads": list(dict.fromkeys(one.drive.load_words(one.torque) for one in run.analyses.values())),
            "positions": first.full.crank_angle.size,
            "thinned": 0 if shown.size == first.full.crank_angle.size else int(shown[1]),
            "version": code_version(),
            "sentence": sentence,
            "state": state,
            "verdicts": verdict_tables(run.checks),
            "summary": summary,
            "orders": orders_table(run.analyses),
            "sections": list(zip(("wind_up", "life"), sections, strict=True)),
            "friction": first.losses is not None,
            "several": len(run.analyses) > 1,
            "comparison": _comparison(run),
            "compared": run.compared,
            "warnings": [line.removeprefix("warning: ") for line in run.sampling if line.startswith("warning: ")],
            "sampling": [line for line in run.sampling if not line.startswith("warning: ")],
            "inputs": input_tables({name: one.as_written for name, one in run.analyses.items()}),
            "derived": derived_tables(run.analyses),
            "made": _made(run, first),
            "text": run.text,
            "data": script_data(content),
            "numbers": numbers,
        },
        scripts=SCRIPTS,
    )


def _arrays(run: Run) -> dict[str, Any]:
    arrays = run_arrays(run.analyses, shown_positions(run.analyses))
    for number_of, one in enumerate(run.analyses.values()):
        lines = turn_orders(one)
        if lines is not None:
            most = max(5 * one.drive.disc.number_of_teeth, 2 * one.drive.number_of_holes, 40)
            arrays[f"{number_of}/orders"] = lines[:most]
    beside = {} if run.compared is None else run.compared.arrays
    return arrays | {f"b/{name}": values for name, values in beside.items()}


def _case(analysis: LoadedAnalysis) -> dict[str, Any]:
    drive = analysis.drive
    return {
        "scenes": [moving_scene(single) for single in single_discs(drive)],
        "torque": analysis.torque / 1000.0,
        "light": drive.load.light_torque / 1000.0,
        "direction": drive.load.direction,
        "sign": int(drive.driving_sign),
    }


def _compared(run: Run) -> dict[str, Any] | None:
    beside = run.compared
    if beside is None:
        return None
    own = next(iter(run.analyses.values())).engine.options["compliance"]
    name = beside.name if beside.name != own else "second run"
    match = matched(run.analyses, beside) if beside.cases else []
    return {"name": name, "cases": list(beside.cases), "match": match}


def _comparison(run: Run) -> list[Table]:
    """Scalars of both runs side by side, a table for each case."""
    beside, tables = run.compared, list[Table]()
    for case, place in zip(
        run.analyses, matched(run.analyses, beside) if beside and beside.cases else (), strict=False
    ):
        assert beside is not None
        other = beside.summaries.get(beside.cases[place])
        if other is None:
            continue
        both = {"first": with_residual_part(run.summaries[case])}
        rows = []
        for row in rows_of(both, yields=False):
            mine, theirs = refined_value(both["first"], row.key), refined_value(other, row.key)
            change = 100.0 * (theirs / mine - 1.0) if mine and theirs is not None else None
            values = [number(value, f"{{:{row.digits}}}", row.unit) for value in (mine, theirs)]
            rows.append([word(row.title), *values, number(change, "{:+.2f}", "%")])
        heads = ["", f"this run, {case}", f"second run, {beside.cases[place]}", "change"]
        tables.append(Table(name=f"compared_{len(tables)}", caption=case, columns=heads, rows=rows))
    return tables


def _made(run: Run, first: LoadedAnalysis) -> Table:
    """What the numbers were computed by."""
    angles = first.full.crank_angle
    where = f"{angles.size}, {degrees(angles.min()):.6g}° … {degrees(angles.max()):.6g}°"
    options = [(name.replace("_", " "), str(value)) for name, value in first.engine.options.items()]
    rows = [
        ("version of cyclo", code_version()),
        ("hash of its code", code_hash("ltca")),
        *options,
        ("positions of the crank", where),
        *(("sampling", line) for line in run.sampling if not line.startswith("warning: ")),
        *(
            (f"fingerprint of {name}" if len(run.analyses) > 1 else "fingerprint of the drive", one.drive.fingerprint())
            for name, one in run.analyses.items()
        ),
    ]
    return Table(name="computed_by", caption="", columns=["", "value"], rows=texts(rows), words=1)
