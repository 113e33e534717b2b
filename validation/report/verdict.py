"""What full solutions and models reach over all positions, judged by the limits of the drive file and its materials."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.members.judgement import Check, Value, judge
from ltca.drive.members.verdict_words import WORDS, check_content
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import Kind, PositionAnswer
from validation.compare.model_positions import MODELS
from validation.study import Study

FULL = "full FE"
QUANTITIES: tuple[tuple[str, str, tuple[Kind, ...]], ...] = (
    ("pin_load", "load", ("pin",)),
    ("roller_load", "load", ("roller_outer",)),
    ("pin_shaft_load", "load", ("hole",)),
    ("pin_pressure_mid", "pressure", ("pin",)),
    ("roller_pressure_mid_outer", "pressure", ("roller_outer",)),
    ("roller_pressure_mid_inner", "pressure", ("roller_inner",)),
    ("pin_shaft_pressure_mid", "pressure", ("hole",)),
)
"""What is judged, what it is of a contact, and of which kinds."""


def verdicts(study: Study) -> dict[str, dict[str, list[Check]]]:
    """Return the checks of every case by model, the full solution first.

    Parameters
    ----------
    study : Study
        A finished validation.
    """
    found: dict[str, dict[str, list[Check]]] = {}
    for case, items in study.compared.items():
        limits = study.plan.limits.get(case, {})
        found[case] = {}
        for model in (FULL, *MODELS):
            values = [value for spec in QUANTITIES if (value := _largest(items, model, *spec)) is not None]
            told = {value.quantity for value in values} | {"roller_pressure_mid"}
            own = {key: limit for key, limit in limits.items() if limit.quantity in told}
            found[case][model] = judge(study.plan.drives[case], values, own)
    return found


def _largest(
    items: list[ComparedPosition], model: str, quantity: str, name: str, kinds: tuple[Kind, ...]
) -> Value | None:
    best: Value | None = None
    for item in items:
        answer: PositionAnswer = item.full.answer if model == FULL else item.answers[model]
        for kind in kinds:
            each: FloatArray = getattr(answer.kinds[kind], name)
            if not np.any(np.isfinite(each)):
                continue
            number = int(np.nanargmax(each))
            if best is None or each[number] > (best.value or 0.0):
                part = f"{answer.contact_name(kind, number)}, {item.full.case}"
                best = Value(quantity=quantity, value=float(each[number]), part=part, crank_angle=item.full.crank_angle)
    return best


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
