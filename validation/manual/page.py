"""Pages of the manual as Markdown: one for each case in one form, and an index with the verdicts.

Figures are printed with few enough digits to be the same on every machine: what is below its own round-off is said to be so.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from ltca.output.files import whole_file
from validation.manual.case import PLAIN, Case, Figure, Outcome
from validation.manual.register import HEADINGS

COMMAND = "cyclo validate --manual"
ROUND_OFF = 1e-6
"""Error bars below this part of the reference (of one unit where that is zero) are round-off; what they cover is not printed."""
TIGHT = ("′", "'", '"', "°")
"""Units that follow their number without a space."""
NOTE = f"<!-- Written by `{COMMAND}`: do not edit. -->\n"


def write_page(outcome: Outcome, folder: Path) -> Path:
    """Write the page of a case into a folder; return the file."""
    return _write(folder / f"{outcome.case.name}.md", page(outcome))


def write_index(outcomes: Sequence[Outcome], folder: Path, *, left: int = 0) -> Path:
    """Write the index of the cases that were computed, of which so many are `left`, into a folder; return the file."""
    return _write(folder / "index.md", index(outcomes, left=left))


def _write(path: Path, text: str) -> Path:
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    return path


def file_names(cases: Iterable[Case]) -> list[str]:
    """Return the names of the files of a manual of some cases."""
    return [*(f"{case.name}.md" for case in cases), "index.md"]


def page(outcome: Outcome) -> str:
    """Return the page of a case."""
    case = outcome.case
    references = "".join(f"- {one.source}.\n  Uncertainty: {one.uncertainty}\n" for one in case.references)
    return "\n".join(
        [
            f"# {case.title}\n",
            NOTE,
            f"## Problem\n\n{case.problem}\n",
            f"## Reference\n\n{references}",
            f"## Model\n\n{case.model}\n",
            f"## Result\n\n{_figures(outcome.figures)}",
            f"## Uncertainty\n\n{_uncertainty(outcome)}",
            f"## Verdict\n\n{_verdict(outcome)}\n",
            f"## Command\n\n```sh\n{case.command}\n```\n",
        ]
    )


def index(outcomes: Sequence[Outcome], *, left: int = 0) -> str:
    """Return the index of the cases that were computed; it tells how many are left."""
    found = {outcome.case.name: outcome for outcome in outcomes}
    passed, bounded = (
        sum(one.passed for one in outcomes),
        [f for one in outcomes for f in one.figures if f.bound is not None],
    )
    beyond = sum(figure.beyond_error_bar for figure in bounded)
    unfinished = f"**Unfinished: {left} of {len(outcomes) + left} cases have not been computed.** " if left else ""
    text = f"""# Verification manual

{NOTE}
One page for each case in one form: problem, reference with its source and its uncertainty, model, result with error bar, verdict,
command. `{COMMAND}` writes all of them, `{COMMAND} CASE` some; exit status 1 when a verdict is FAILED.

{unfinished}**{passed} of {len(outcomes)} cases pass**; {len(bounded)} figures have a bound. Three uncertainties are kept apart
(ASME V&V 10, V&V 20): that of the input, that of numbers (meshes, cells, positions, tables, round-off) and that of the model.
A difference beyond the error bars of numbers, reference and input together is one of the model, or of what the reference leaves
out; {beyond} of the figures with a bound have one. A bound is no error bar: each page gives its reason.

"""
    for heading, cases in HEADINGS.items():
        rows = [index_row(found[case.name]) for case in cases if case.name in found]
        if rows:
            text += f"## {heading}\n\n" + _table(("case", "figures", "largest part of its bound", "verdict"), rows)
    names = "\n".join(found)
    return text + f"```{{toctree}}\n:hidden:\n\n{names}\n```\n"


def index_row(outcome: Outcome) -> tuple[str, str, str, str]:
    """Return the cells of a case in the index: link, number of figures, worst figure, verdict."""
    case, informing = outcome.case, sum(figure.bound is None for figure in outcome.figures)
    parts = [abs(one.difference) / one.bound for one in outcome.figures if one.bound]
    count = f"{len(outcome.figures)}" + (f", {informing} inform" if informing else "")
    largest = max(parts, default=0.0)
    worst = f"{100.0 * largest:.0f} %" if largest >= 0.01 else "< 1 %"
    return f"[{case.title}]({case.name}.md)", count, worst, verdict_word(outcome)


def verdict_word(outcome: Outcome) -> str:
    """Return PASSED or FAILED."""
    return "PASSED" if outcome.passed else "FAILED"


def printed_difference(figure: Figure) -> str:
    """Return a difference with its sign, or that it is below the round-off of its own computation."""
    scale = 1.0 if figure.difference_unit == "" else abs(figure.reference or 1.0)
    error = figure.numerical_error
    if abs(figure.difference) <= error and error < ROUND_OFF * scale:
        return f"< {_amount(error, figure.difference_unit)}" if error else "0"
    return f"{'+' if figure.difference > 0.0 else '−'}{_amount(abs(figure.difference), figure.difference_unit)}"


def _figures(figures: Sequence[Figure]) -> str:
    """Table of the figures, then the reasons of their bounds."""
    reasons = list(dict.fromkeys(figure.bound_reason for figure in figures))
    rows = [
        (
            figure.quantity,
            "" if figure.reference is None else _value(figure.reference, figure),
            _value(figure.value, figure),
            "must be positive" if figure.reference is None else printed_difference(figure),
            _amount(figure.numerical_error, figure.difference_unit),
            _amount(figure.reference_error, figure.difference_unit),
            _amount(figure.input_error, figure.difference_unit),
            "informs" if figure.bound is None else _amount(figure.bound, figure.difference_unit),
            str(1 + reasons.index(figure.bound_reason)),
            _row_verdict(figure),
        )
        for figure in figures
    ]
    head = (
        "quantity", "reference", "result", "difference", "numerical error", "reference error", "input error", "bound", "reason",
        "verdict",
    )  # fmt: skip
    listed = "".join(f"{number}. {reason}.\n" for number, reason in enumerate(reasons, start=1))
    return _table(head, rows) + f"Reasons of the bounds, or of differences that inform:\n\n{listed}"


def _row_verdict(figure: Figure) -> str:
    if figure.bound is None:
        return "–"
    return "passed" if figure.passed else "FAILED"


def _uncertainty(outcome: Outcome) -> str:
    """Input, numerical and model uncertainty, each on its own."""
    case = outcome.case
    origins = list(dict.fromkeys(figure.numerical_origin for figure in outcome.figures))
    beyond = [figure.quantity for figure in outcome.figures if figure.reference is not None and figure.beyond_error_bar]
    told = (
        f"{len(beyond)} of {len(outcome.figures)} differences are beyond the error bars of numbers, reference and "
        "input together and "
        "belong to the model (or to what the reference leaves out)."
        if beyond
        else "No difference is beyond the error bars of numbers, reference and input together: none can be told from zero."
    )
    return _table(
        ("kind", "where from"),
        (
            ("input", case.input_uncertainty),
            ("numerical", "; ".join(origins) + "."),
            ("model", f"{case.model_uncertainty} {told}"),
        ),
    )


def _verdict(outcome: Outcome) -> str:
    bounded = [figure for figure in outcome.figures if figure.bound is not None]
    if outcome.passed:
        return f"**PASSED**: all {len(bounded)} figures are within their bounds."
    failed = "; ".join(
        f"{figure.quantity}: {printed_difference(figure)} beyond {_amount(figure.bound or 0.0, figure.difference_unit)}"
        for figure in outcome.failed
    )
    return f"**FAILED**: {len(outcome.failed)} of {len(bounded)} figures miss their bounds: {failed}."


def _value(value: float, figure: Figure) -> str:
    """A value with its unit; one of which only round-off is left is zero."""
    if figure.reference == 0.0 and printed_difference(figure).startswith("<"):
        value = 0.0
    unit = figure.unit
    space = "" if unit in ("", *TIGHT) else " "
    return f"{value:.6g}{space}{unit}".replace("-", "−")


def _amount(size: float, unit: str) -> str:
    """A size with two digits: ratios in per cent, very small ones as they are."""
    if size == 0.0:
        return "0"
    if unit == "":
        return f"{100.0 * size:.2g} %" if size >= 1e-6 else f"{size:.1g}"
    if unit == PLAIN:
        return f"{size:.2g}"
    space = "" if unit in TIGHT else " "
    return f"{size:.2g}{space}{unit}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines) + "\n"
