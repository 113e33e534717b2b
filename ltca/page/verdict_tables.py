"""The verdict of a design on a page: one sentence, then tables, worst first, cases side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ltca.drive.members.judgement import Check
from ltca.drive.members.verdict_words import WORDS, is_of_sampling, place_words, urgency, with_unit
from ltca.page.tables import NOTHING, Cell, Table, minus, number, word

Checks = Mapping[str, Sequence[Check]]
"""By case."""
_Rows = dict[tuple[str, str, str], dict[str, Check]]
"""Checks by title, limit and source, then by case: a row of a table each."""

MARKS = {"pass": "✓ pass", "fail": "✗ FAIL"}
"""Verdicts with a sign, so that none hangs on its colour alone."""


def verdict_of(checks: Checks) -> tuple[str, str]:
    """Return the verdict in one sentence, and its state: ``pass``, ``fail`` or nothing."""
    judged, unknown, others = _judged_unknown_others(checks)
    failed = [check for each in judged.values() for check in each.values() if check.fails]
    failing = sum(any(check.fails for check in each.values()) for each in judged.values())
    several = len(checks) > 1
    if not checks:
        return "No verdict: some positions have no answer.", "fail"
    if failed:
        if all(is_of_sampling(check) for check in failed):
            return (
                f"All {len(judged) - failing} checks of the drive pass at these positions, which are too few for the peaks.",
                "fail",
            )
        cases = sum(any(check.fails for check in case) for case in checks.values())
        of = f", in {cases} of {len(checks)} cases" if several else ""
        return f"{failing} of {len(judged)} checks fail{'s' if failing == 1 else ''}{of}.", "fail"
    if not judged:
        return "Nothing is judged: neither drive file nor materials have limits.", ""
    sentences = [f"All {len(judged)} values that can be judged keep their limits{' in every case' if several else ''}."]
    if unknown:
        limited = sum(bound != NOTHING for _, bound, _ in unknown)
        sentences.append(
            f"{_values(len(unknown))} not known, {limited} of them with a limit: the reasons are listed below."
        )
    sentences += (
        [f"{_values(len(others))} without a limit and only inform{'s' if len(others) == 1 else ''}."] if others else []
    )
    return " ".join(sentences), "pass"


def _values(count: int) -> str:
    """A number of values and the verb."""
    return f"{count} value{' is' if count == 1 else 's are'}"


def verdict_tables(checks: Checks) -> list[Table]:
    """Return tables of judged values (worst first), values that are not known and values without a limit; cases side by side."""
    judged, unknown, others = _judged_unknown_others(checks)
    several, found = len(checks) > 1, []
    if judged:
        rows = []
        for (title, bound, source), each in sorted(judged.items(), key=_urgency):
            cells = [_judged(each.get(case)) for case in checks]
            if not several:
                cells.append(word(minus(place_words(next(iter(each.values()))))))
            rows.append([word(title), word(minus(bound)), *cells, word(source)])
        columns = ["check", "limit", *(list(checks) if several else ["value", "where"]), "where the limit comes from"]
        found.append(Table(name="verdict", caption="", columns=columns, rows=rows, last_words=1 if several else 2))
    if unknown:
        rows = [
            [word(title), word(minus(bound)), word(_reasons(each, len(checks))), word(source)]
            for (title, bound, source), each in unknown.items()
        ]
        columns = ["check", "limit", "why there is no value", "where the limit comes from"]
        found.append(
            Table(name="not_known", caption="values that are not known, and why", columns=columns, rows=rows, words=3)
        )
    if others:
        rows = [[word(title), *(_told(each.get(case)) for case in checks)] for (title, _, _), each in others.items()]
        columns = ["", *(list(checks) if several else ["value"])]
        found.append(Table(name="without_limit", caption="values without a limit", columns=columns, rows=rows))
    return found


def _reasons(each: Mapping[str, Check], cases: int) -> str:
    """Reasons for a missing value, with the names of the cases unless all have the same reason."""
    names: dict[str, list[str]] = {}
    for case, check in each.items():
        names.setdefault(check.value.reason, []).append(case)
    return "; ".join(
        reason if len(affected) == cases else f"{', '.join(affected)}: {reason}" for reason, affected in names.items()
    )


def _urgency(line: tuple[Any, dict[str, Check]]) -> tuple[bool, bool, float]:
    """What fails in any case comes first, then the least safety of all."""
    failed, sampling, safety = zip(*(urgency(check) for check in line[1].values()), strict=True)
    return min(failed), min(sampling), min(safety)


def _judged_unknown_others(checks: Checks) -> tuple[_Rows, _Rows, _Rows]:
    """Rows of the tables: judged values, values that are not known, values without a limit; the verdict counts the same."""
    return (
        _by_check(checks, lambda check: check.fails or check.verdict == "pass"),
        _by_check(checks, lambda check: check.verdict == "not known" and not check.fails),
        _by_check(checks, lambda check: check.verdict == "no limit"),
    )


def _by_check(checks: Checks, wanted: Callable[[Check], bool]) -> _Rows:
    """Checks by title, limit and source, then by case."""
    cells: _Rows = {}
    for case, each in checks.items():
        for check in filter(wanted, each):
            limit = check.limit
            bound = (
                NOTHING
                if limit is None
                else f"{'≤' if limit.sense == 'max' else '≥'} {with_unit(limit.value, check.value, 5)}"
            )
            cells.setdefault((check.title, bound, "" if limit is None else limit.source), {})[case] = check
    return cells


def _judged(check: Check | None) -> Cell:
    if check is None:
        return word(NOTHING)
    state = "fail" if check.fails else "pass" if check.verdict == "pass" else ""
    note = MARKS.get("fail" if check.fails else check.verdict, WORDS[check.verdict])
    if check.safety is not None:
        note += f" · {check.safety:.3g}"
    return number(check.value.value, note=minus(note), state=state)


def _told(check: Check | None) -> Cell:
    if check is None:
        return word(NOTHING)
    return number(check.value.value, unit=check.value.unit, note=minus(place_words(check)))
