"""The main figures, and the files ``validation.json`` and ``rows.csv``."""

from __future__ import annotations

import csv
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ltca.output.files import whole_file, write_json
from validation.compare.compared_positions import ComparedPosition
from validation.compare.comparison import PositionDifference
from validation.compare.model_positions import MODELS
from validation.levels.flexible_disc import full_solution_changes
from validation.report.verdict import verdict_content
from validation.rows import LEVELS, failed_rows, rounded
from validation.study import Study

COLUMNS = (
    "level", "quantity", "case", "angle_rad", "contact", "model", "against", "reference", "value", "unit", "difference",
    "difference_unit", "limit", "reason", "pass", "error_bar", "below_error_bar",
)  # fmt: skip


def headline(study: Study) -> dict[str, Any]:
    """Return the worst differences of each model and what the full solution changes.

    ``worst_difference_from_full_fe``: by compliance model the largest load difference (of the largest load of its kind),
    pressure difference (relative) and wheel-angle difference (arc seconds), with their places;
    ``change_half_space_to_full_fe``: by case, relative change of the largest pin, roller and pin-shaft load that it has;
    ``rows`` in all, ``checked`` by a limit, ``informing`` without one, and ``failed``.
    """
    positions = [item for case in study.compared.values() for item in case]
    return {
        "worst_difference_from_full_fe": {model: _worst(positions, model) for model in MODELS},
        "change_half_space_to_full_fe": {
            case: {name: rounded(change) for name, change in full_solution_changes(items).items()}
            for case, items in study.compared.items()
        },
        "rows": len(study.rows),
        "checked": sum(row.limit is not None for row in study.rows),
        "informing": sum(row.limit is None for row in study.rows),
        "failed": len(failed_rows(study.rows)),
        "below_error_bar": sum(bool(row.below_error_bar) for row in study.rows),
    }


def _worst(positions: list[ComparedPosition], model: str) -> dict[str, Any]:
    def place(item: ComparedPosition, contact: str = "") -> dict[str, Any]:
        found: dict[str, Any] = {"case": item.full.case, "angle_rad": rounded(item.full.crank_angle)}
        return {**found, "contact": contact} if contact else found

    def difference(item: ComparedPosition) -> PositionDifference:
        return item.differences[model]

    load = max(positions, key=lambda item: abs(difference(item).worst_load[2]))
    pressure = max(positions, key=lambda item: abs(difference(item).worst_pressure[2]))
    wheel = max(positions, key=lambda item: abs(difference(item).wheel_angle))
    kind, number, of_load = difference(load).worst_load
    pressed, at, of_pressure = difference(pressure).worst_pressure
    return {
        "load": {"difference": rounded(of_load), **place(load, difference(load).contact_name(kind, number))},
        "pressure": {
            "difference": rounded(of_pressure),
            **place(pressure, difference(pressure).contact_name(pressed, at)),
        },
        "wheel_angle": {"difference_arcsec": rounded(difference(wheel).wheel_angle), **place(wheel)},
    }


def validation_content(study: Study) -> dict[str, Any]:
    """Return the content of ``validation.json``."""
    plan = study.plan
    return {
        "drive": plan.name,
        "cases": {case: drive.fingerprint() for case, drive in plan.drives.items()},
        "crank_angles_rad": [rounded(angle) for angle in plan.crank_angles],
        "depth": plan.level,
        "element_size": plan.options.size,
        "levels": {str(level): title for level, title in LEVELS.items()},
        "headline": headline(study),
        "verdict": verdict_content(study),
        "error_bars": {case: None if bars is None else asdict(bars) for case, bars in study.error_bars.items()},
        "rows": [row.content() for row in study.rows],
    }


def write_files(study: Study, folder: Path) -> list[Path]:
    """Write ``validation.json`` and ``rows.csv``; return their paths."""
    content = validation_content(study)
    write_json(folder / "validation.json", content)
    table = folder / "rows.csv"
    with whole_file(table) as part, part.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(content["rows"])
    return [folder / "validation.json", table]
