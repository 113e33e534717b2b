"""``report.html``: one self-contained page."""

from __future__ import annotations

from math import degrees
from pathlib import Path
from typing import Any

from ltca.drive.single_discs import single_discs
from ltca.page.scene import drive_scene
from ltca.page.study_page import Picture
from ltca.page.tables import minus
from ltca.page.writing import page_text, script_data, write_page
from validation.compare.error_bars import bars_words
from validation.compare.finite_element_positions import disc_case, kept_pictures
from validation.compare.model_positions import FULL, MODELS
from validation.levels.flexible_disc import TITLES, judge_half_space, turn_content
from validation.report.headline import headline
from validation.report.scene import position_scene
from validation.report.verdict import verdict_lines
from validation.rows import LEVELS, Row
from validation.study import Study

SHARED = (
    (
        "Profile",
        "the modified flank of Eq. 1, with tests of its own: envelope condition, curvature",
    ),
    ("Placement", "nominal places and clearances of all parts"),
    ("Material", "Young's modulus and Poisson's ratio of each part"),
    ("Elasticity assembly", "stiffness of quadratic triangles: full solutions and coefficients use the same routine"),
    (
        "Not shared",
        "meshes (coefficients: coarse, stations for any angle; full solution: graded for the contacts of one angle), the "
        "contact algorithm (Hertz laws and stations against pressure unknowns with mortar integration), equilibrium and pose",
    ),
)


def write_report(study: Study, path: Path) -> Path:
    """Write the page of a finished validation and return its path."""
    text = page_text(
        "report.html", _context(study), scripts=("drawing", "report"), styles=("report",), package="validation.report"
    )
    return write_page(path, text)


def _context(study: Study) -> dict[str, Any]:
    plan, first = study.plan, next(iter(study.plan.drives.values()))
    positions = [position_scene(item) for items in study.compared.values() for item in items]
    data = {
        "models": [FULL, *MODELS],
        "drives": {
            disc_case(case, disc, drive.disc.number_of_discs): drive_scene(single)
            for case, drive in plan.drives.items()
            for disc, single in enumerate(single_discs(drive))
        },
        "positions": positions,
    }
    head = headline(study)
    return {
        "title": f"Validation of {plan.name}",
        "error_bars": bars_words(study.error_bars),
        "drive": plan.name,
        "cases": list(plan.drives),
        "angles": [_angle(angle) for angle in plan.crank_angles],
        "depth": plan.level,
        "size": plan.options.size,
        "torque": f"{first.load.torque / 1000.0:g}",
        "headline": head,
        "worst": [_worst_line(model, head["worst_difference_from_full_fe"][model]) for model in MODELS],
        "changes": [
            (case, *(_signed_percent(values.get(name)) for name in ("pin_load", "roller_load", "pin_shaft_load")))
            for case, values in head["change_half_space_to_full_fe"].items()
        ],
        "verdicts": verdict_lines(study),
        "verdict_models": [FULL, *MODELS],
        "sentences": [minus(line) for line in judge_half_space(study.flexibility)],
        "turns": [_turn_table(case, turn_content(item)) for case, item in study.flexibility.items()],
        "levels": [_level(number, [row for row in study.rows if row.level == number]) for number in LEVELS],
        "pictures": _pictures(study),
        "shared": SHARED,
        "data": script_data(data),
    }


def _worst_line(model: str, worst: dict[str, Any]) -> dict[str, str]:
    load, pressure, wheel = worst["load"], worst["pressure"], worst["wheel_angle"]

    def place(item: dict[str, Any]) -> str:
        contact = f"{item['contact']}, " if "contact" in item else ""
        return f"{contact}{item['case']}, {_angle(item['angle_rad'])}"

    return {
        "model": model,
        "load": _signed_percent(load["difference"]),
        "load_place": place(load),
        "pressure": _signed_percent(pressure["difference"]),
        "pressure_place": place(pressure),
        "wheel": minus(f"{wheel['difference_arcsec']:+.3g}″"),
        "wheel_place": place(wheel),
    }


def _signed_percent(value: float | None) -> str:
    if value is None:
        return "–"
    return minus(f"{100.0 * value:+.3g} %")


def _angle(radians: float) -> str:
    return minus(f"{degrees(radians):.4g}° = {radians:.4g} rad")


def _turn_table(case: str, content: dict[str, dict[str, float | None]]) -> dict[str, Any]:
    lines = []
    for name, (title, unit) in TITLES.items():
        values = [content[model][name] for model in MODELS]
        if all(value is None for value in values):  # no shaft pins
            continue
        half, fe = content["half-space"][name], content["fe"][name]
        lines.append(
            (
                title,
                unit.replace('"', "″"),
                [minus(f"{value:.4g}") if value is not None else "–" for value in values],
                _signed_percent(fe / half - 1.0 if half and fe is not None else None),
            )
        )
    return {"case": case, "lines": lines}


def _level(number: int, rows: list[Row]) -> dict[str, Any]:
    bounded = [row for row in rows if row.limit is not None]
    groups: dict[str, list[dict[str, str]]] = {}
    for row, count in _condense(rows) if number == 5 else [(row, 1) for row in rows]:
        title = row.model if number in (5, 6) else ""
        groups.setdefault(title, []).append(_line(row, count))
    return {
        "number": number,
        "title": LEVELS[number],
        "checked": len(bounded),
        "informing": len(rows) - len(bounded),
        "failed": sum(not row.passed for row in rows),
        "groups": list(groups.items()),
        "condensed": number == 5,
    }


def _condense(rows: list[Row]) -> list[tuple[Row, int]]:
    """Return the row with the largest difference of each quantity, case and model, and the number of rows it represents."""
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        groups.setdefault((row.model, row.against, row.quantity, row.case), []).append(row)
    order = {model: place for place, model in enumerate(("fe", "hybrid", "half-space"))}
    found = [
        (max(items, key=lambda row: (not row.passed, abs(row.difference))), len(items)) for items in groups.values()
    ]
    return sorted(found, key=lambda item: order.get(item[0].model, len(order)))


def _line(row: Row, count: int) -> dict[str, str]:
    place = [row.case, _angle(row.crank_angle) if row.crank_angle is not None else "", row.contact]
    return {
        "quantity": row.quantity,
        "place": ", ".join(part for part in place if part),
        "count": f"worst of {count}" if count > 1 else "",
        "model": row.model,
        "against": row.against,
        "value": _figure(row.value, row.unit),
        "reference": _figure(row.reference, row.unit) if row.reference is not None else "–",
        "difference": _difference(row.difference, row.difference_unit),
        "error_bar": _error_bar(row),
        "limit": _difference(row.limit, row.difference_unit, sign="±") if row.limit is not None else "informs",
        "state": "failed" if not row.passed else "informs" if row.limit is None else "passed",
        "reason": minus(row.reason),
    }


def _error_bar(row: Row) -> str:
    """Return what is told of the error bar of the reference."""
    if row.error_bar is None:
        return ""
    bar = _difference(row.error_bar, row.difference_unit, sign="±")
    return f"below its error bar, {bar}" if row.below_error_bar else f"error bar {bar}"


def _figure(value: float, unit: str) -> str:
    return minus(f"{value:.5g} {unit.replace(chr(34), '″')}".strip())


def _difference(value: float, unit: str, sign: str = "") -> str:
    ratio = unit == "" and abs(value) >= 1e-6
    text = f"{100.0 * value:.3g} %" if ratio else f"{value:.3g} {unit.replace(chr(34), '″')}".strip()
    return minus(f"±{text}" if sign and value else text)


def _pictures(study: Study) -> list[tuple[str, Picture]]:
    """Pictures of every position that has them, with case and angle."""
    return [
        (f"{item.full.case}, {_angle(item.full.crank_angle)}: ", picture)
        for items in study.compared.values()
        for item in items
        if item.full.pictures is not None
        for picture in kept_pictures(item.full.pictures)
    ]
