"""The verdict of a design on a page: one sentence, then tables, worst first, cases side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ltca.drive.members.judgement import Check
from ltca.drive.members.verdict_words import WORDS, is_of_sampling, place_words, urgency, with_unit
from ltca.page.tables import NOTHING, Cell, Table, minus, number, word

Checks = Mapping[str, Sequence[Check]]
"""By case."""

MARKS = {"pass": "✓ pass", "fail": "✗ FAIL"}
"""Verdicts with a sign, so that none hangs on its colour alone."""


def verdict_of(checks: Checks) -> tuple[str, str]:
    """Return the verdict in one sentence, and its state: ``pass``, ``fail`` or nothing."""
    every = [check for case in checks.values() for check in case]
    failed = [check for check in every if check.fails]
    kept = [check for check in every if check.verdict == "pass"]
    unknown = [check for check in every if check.limit is not None and check.verdict == "not known"]
    others = sum(check.limit is None and check.value.value is not None for check in every)
    if not checks:
        return "No verdict: some positions have no answer.", "fail"
    if failed:
        if all(is_of_sampling(check) for check in failed):
            return (
                f"All {len(kept)} checks of the drive pass at these positions, which are too few for the peaks.",
                "fail",
            )
        cases = sum(any(check.fails for check in case) for case in checks.values())
        of = f", in {cases} of {len(checks)} cases" if len(checks) > 1 else ""
        return f"{len(failed)} of {len(failed) + len(kept)} checks fail{of}.", "fail"
    if not kept:
        return "Nothing is judged: neither drive file nor materials have limits.", ""
    told = [f"All {len(kept)} values that can be judged keep their limits."]
    told += [f"{len(unknown)} limits meet no value that this run knows."] if unknown else []
    told += [f"{others} values have no limit and only inform."] if others else []
    return " ".join(told), "pass"


def verdict_tables(checks: Checks) -> list[Table]:
    """Return tables of judged values (worst first), limits without a value and values without a limit; cases side by side."""
    judged = _by_check(checks, lambda check: check.fails or check.verdict in ("pass", "fail"))
    unknown = _by_check(
        checks, lambda check: check.limit is not None and check.verdict == "not known" and not check.fails
    )
    others = _by_check(checks, lambda check: check.limit is None and not check.fails and check.value.value is not None)
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
            [word(title), word(minus(bound)), word(next(iter(each.values())).value.reason), word(source)]
            for (title, bound, source), each in unknown.items()
        ]
        columns = ["check", "limit", "why there is no value", "where the limit comes from"]
        found.append(
            Table(
                name="not_known", caption="limits that meet no value of this run", columns=columns, rows=rows, words=3
            )
        )
    if others:
        rows = [[word(title), *(_told(each.get(case)) for case in checks)] for (title, _, _), each in others.items()]
        columns = ["", *(list(checks) if several else ["value"])]
        found.append(Table(name="without_limit", caption="values without a limit", columns=columns, rows=rows))
    return found


def _urgency(line: tuple[Any, dict[str, Check]]) -> tuple[bool, bool, float]:
    """What fails in any case comes first, then the least safety of all."""
    failed, sampling, safety = zip(*(urgency(check) for check in line[1].values()), strict=True)
    return min(failed), min(sampling), min(safety)


def _by_check(checks: Checks, wanted: Any) -> dict[tuple[str, str, str], dict[str, Check]]:
    """Checks by title, limit and source, then by case."""
    found: dict[tuple[str, str, str], dict[str, Check]] = {}
    for case, each in checks.items():
        for check in filter(wanted, each):
            limit = check.limit
            bound = (
                NOTHING
                if limit is None
                else f"{'≤' if limit.sense == 'max' else '≥'} {with_unit(limit.value, check.value, 5)}"
            )
            found.setdefault((check.title, bound, "" if limit is None else limit.source), {})[case] = check
    return found


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
