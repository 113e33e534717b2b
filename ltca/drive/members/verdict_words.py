"""Checks as tables and files print them."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from ltca.drive.members.judgement import Check
from ltca.quantities import unit_sign

WORDS = {"pass": "pass", "fail": "FAIL", "no limit": "no limit", "not known": "–"}


def verdict_table(checks: Sequence[Check], *, limited: bool = False) -> str:
    """Return the checks of one case as a table; with `limited`, checks without a limit are counted only."""
    shown = [check for check in checks if check.limit is not None or not limited]
    rows = [("check", "value", "limit", "safety", "verdict", "where")]
    for check in shown:
        value, limit = check.value, check.limit
        unit = f" {unit_sign(value.unit)}".rstrip()
        bound = "" if limit is None else f"{'≤' if limit.sense == 'max' else '≥'} {limit.value:.5g}{unit}"
        safety = "" if check.safety is None else f"{check.safety:.3f}"
        told = "–" if value.value is None else f"{value.value:.5g}{unit}"
        rows.append((check.title, told, bound, safety, WORDS[check.verdict], place_words(check)))
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    lines = [
        f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:>{widths[2]}}  {row[3]:>{widths[3]}}  "
        f"{row[4]:<{widths[4]}}  {row[5]}".rstrip()
        for row in rows
    ]
    counts = {verdict: sum(check.verdict == verdict for check in checks) for verdict in WORDS}
    words = {"pass": "passed", "fail": "failed", "no limit": "without a limit", "not known": "not known"}
    lines.append("  " + ", ".join(f"{counts[verdict]} {word}" for verdict, word in words.items()))
    return "\n".join(lines)


def verdict_line(checks: Sequence[Check]) -> str:
    """Return the verdict on a case in one line: pass or fail, and the check that fails worst or is nearest to its limit."""
    judged = [check for check in checks if check.fails or check.verdict == "pass"]
    if not judged:
        return "not judged: neither drive file nor materials have limits"
    failed = sum(check.fails for check in judged)
    word = WORDS["fail" if failed else "pass"]
    nearest = min(judged, key=urgency)
    told = f"{word}  {nearest.title}"
    if nearest.value.value is None:
        told += f" cannot be judged: {nearest.value.reason}"
    elif nearest.limit is not None:
        unit = f" {unit_sign(nearest.value.unit)}".rstrip()
        bound = f"{'≤' if nearest.limit.sense == 'max' else '≥'} {nearest.limit.value:.4g}{unit}"
        told += f" {nearest.value.value:.4g}{unit} ({bound})"
    if nearest.safety is not None:
        told += f", safety {nearest.safety:.3g}"
    return told + (f"; {failed} of {len(judged)} checks fail" if failed > 1 else "")


def urgency(check: Check) -> tuple[bool, bool, float]:
    """Return a sort key: failed checks first, checks of the drive before those of the sampling, then by increasing safety."""
    of_sampling = check.value.quantity == "distinct_mesh_phases"
    return not check.fails, of_sampling, float("inf") if check.safety is None else check.safety


def place_words(check: Check) -> str:
    """Return where the value of a check occurs, or why it is not known."""
    value = check.value
    if value.value is None or (check.limit is None and value.reason):
        return value.reason
    at = "" if value.crank_angle is None else f"φ_C = {degrees(value.crank_angle):.4g}°"
    return ", ".join(part for part in (value.part, at) if part)


def check_content(check: Check, case: str) -> dict[str, Any]:
    """Return a check as it stands in files, with the name of its case."""
    value, limit = check.value, check.limit
    return {
        "check": check.title,
        "quantity": value.quantity,
        "unit": value.unit,
        "value": value.value,
        "limit": None if limit is None else limit.value,
        "sense": None if limit is None else limit.sense,
        "source": None if limit is None else limit.source,
        "safety": check.safety,
        "verdict": check.verdict,
        "case": case,
        "part": value.part,
        "crank_angle_rad": value.crank_angle,
        "reason": value.reason,
    }
