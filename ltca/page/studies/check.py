"""Page of ``cyclo check``: a verdict with what drives each value and what would mend it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ltca.analysis.verdict.advice import Driver
from ltca.drive.members.verdict_words import urgency
from ltca.page.study_page import Section, StudyPage
from ltca.page.tables import Table, folded, minus, number, word
from ltca.page.verdict_tables import Checks, verdict_of, verdict_tables

Drivers = Mapping[str, Mapping[str, Sequence[Driver]]]
"""By case and quantity."""


def check_page(
    name: str, text: str, told: str, checks: Checks, drivers: Drivers, notes: Mapping[str, Sequence[str]], made: Any
) -> StudyPage:
    """Return the page of a check: verdicts, what drives each value by case and quantity, and notes by case.

    `told` says what was judged; `made` has options of the engine and positions.
    """
    sentence, state = verdict_of(checks)
    sections = [Section(heading="Verdict", tables=folded(verdict_tables(checks)), notes=_notes(notes))]
    rows = [
        [
            word(case), word(check.title), word(driver.input), number(driver.elasticity, "{:+.2f}"),
            word(minus(driver.change) or (f"none: it would fail {', '.join(driver.breaks)}" if driver.breaks else "")),
        ]
        for case, each in checks.items()
        for check in sorted(each, key=urgency)
        for driver in drivers[case].get(check.value.quantity, ())
    ]  # fmt: skip
    if rows:
        columns = ["case", "check", "input", "d ln value/d ln input", "change that would about mend it"]
        table = Table(name="drivers", caption="", columns=columns, rows=rows, words=2)
        note = (
            "A change stands only where the value fails its limit and one input alone would mend it without failing another "
            "check."
        )
        sections.append(Section(heading="What drives each value", notes=[note], tables=[table]))
    return StudyPage(name=name, told=told, sentence=sentence, state=state, sections=sections, made=made, text=text)


def _notes(notes: Mapping[str, Sequence[str]]) -> list[str]:
    """Every note once, with the cases that have it unless all have."""
    owners: dict[str, list[str]] = {}
    for case, each in notes.items():
        for note in each:
            owners.setdefault(note, []).append(case)
    return [
        note if len(own) == len(notes) else f"{', '.join(dict.fromkeys(own))}: {note}" for note, own in owners.items()
    ]
