"""Largest loads and pressures over all positions, judged by the limits of the drive file and its materials."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fem.drive.contact_kinds import CONTACT_KINDS
from fem.reducer.verdict import Candidate, judge_largest, judged_contacts
from ltca.drive.members.judgement import Check
from ltca.drive.members.verdict_words import WORDS, check_content
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import Kind, PositionAnswer
from validation.compare.model_positions import FULL, MODELS
from validation.study import Study


def verdicts(study: Study) -> dict[str, dict[str, list[Check]]]:
    """Return the checks of every case of a finished validation by model, the full solution first."""
    return {
        case: {
            model: judge_largest(
                study.plan.drives[case],
                {quantity: _candidates(items, model, quantity, kind) for quantity, kind, _ in judged_contacts()},
                study.plan.limits.get(case, {}),
            )
            for model in (FULL, *MODELS)
        }
        for case, items in study.compared.items()
    }


def _candidates(items: list[ComparedPosition], model: str, quantity: str, kind: Kind) -> Iterator[Candidate]:
    """Yield the loads or pressures of one kind, position by position."""
    for item in items:
        answer: PositionAnswer = item.full.answer if model == FULL else item.answers[model]
        contacts = answer.kinds[kind]
        values = contacts.load if quantity == CONTACT_KINDS[kind].load else contacts.pressure

        def name_of(number: int, answer: PositionAnswer = answer, case: str = item.full.case) -> str:
            return f"{answer.contact_name(kind, number)}, {case}"

        yield values, name_of, item.full.crank_angle


def verdict_content(study: Study) -> dict[str, dict[str, list[dict[str, Any]]]]:
    """Return the verdicts as ``validation.json`` holds them: by case and model."""
    return {
        case: {model: [check_content(check, case) for check in checks] for model, checks in models.items()}
        for case, models in verdicts(study).items()
    }


def verdict_lines(study: Study) -> list[dict[str, Any]]:
    """Return a line for each case and check that has a limit: its name, limit and source, and value and verdict by model."""
    lines = []
    for case, models in verdicts(study).items():
        for check in models[FULL]:
            if check.limit is None:
                continue
            each = [_cell(checks, check) for checks in models.values()]
            sign = "≤" if check.limit.sense == "max" else "≥"
            lines.append(
                {
                    "case": case,
                    "check": check.title,
                    "limit": f"{sign} {check.limit.value:.5g} {check.value.unit}",
                    "source": check.limit.source,
                    "models": each,
                }
            )
    return lines


def _cell(checks: list[Check], like: Check) -> dict[str, str]:
    same = next((one for one in checks if one.value.quantity == like.value.quantity and one.limit == like.limit), None)
    if same is None or same.value.value is None:
        return {"value": "–", "verdict": ""}
    return {"value": f"{same.value.value:.5g}", "verdict": WORDS[same.verdict]}
