"""Checks as tables and files print them."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from ltca.drive.members.judgement import Check, Value
from ltca.drive.parts import Drive
from ltca.quantities import printed, unit_sign

CLOSE = ("°", "′", "″")
"""Signs that stand right behind their number."""
WORDS = {"pass": "pass", "fail": "FAIL", "no limit": "no limit", "not known": "–"}


def part_words(drive: Drive, name: str, pair: int, pairs: int, disc: int | None = None) -> str:
    """Return what a part is called where it is told: "disc 1, crank 2, roller 5", without what a drive has one of.

    `pair` is its place among the `pairs` of one disc, `disc` the number of that disc, none for what all discs share; rollers
    count anew in every bearing.
    """
    told = [] if disc is None or drive.disc.number_of_discs == 1 else [f"disc {disc}"]
    if "roller" in name and drive.crank.number > 1:
        crank, pair = divmod(pair, pairs // drive.crank.number)
        told.append(f"crank {crank}")
    words = name if pairs == 1 else f"{name} {pair}"
    return ", ".join([*told, *([words] if words else [])])


def verdict_table(checks: Sequence[Check]) -> str:
    """Return the checks of one case as a table: what fails, what passes by its safety, what only informs; then what is not
    known, and why.

    A value that the drive file limits and that is not known fails.
    """
    known = [check for check in checks if check.fails or check.value.value is not None]
    rows = [("check", "value", "limit", "safety", "verdict", "where")]
    for check in sorted(known, key=lambda check: (check.limit is None, urgency(check))):
        value, limit = check.value, check.limit
        bound = "" if limit is None else f"{'≤' if limit.sense == 'max' else '≥'} {with_unit(limit.value, value, 5)}"
        safety = "" if check.safety is None else f"{check.safety:.3f}"
        value_text = WORDS["not known"] if value.value is None else with_unit(value.value, value, 5)
        verdict = WORDS["fail" if check.fails else check.verdict]
        rows.append((check.title, value_text, bound, safety, verdict, place_words(check)))
    widths = [max(len(row[column]) for row in rows) for column in range(5)]
    lines = [
        f"  {row[0]:<{widths[0]}}  {row[1]:>{widths[1]}}  {row[2]:>{widths[2]}}  {row[3]:>{widths[3]}}  "
        f"{row[4]:<{widths[4]}}  {row[5]}".rstrip()
        for row in rows
    ]
    unknown = [check for check in checks if check.verdict == "not known" and not check.fails]
    reasons: dict[str, list[str]] = {}
    for check in unknown:
        reasons.setdefault(check.value.reason, []).append(check.title)
    lines += [f"  not known ({reason}): {'; '.join(dict.fromkeys(titles))}" for reason, titles in reasons.items()]
    counts = {
        "passed": sum(check.verdict == "pass" for check in checks),
        "failed": sum(check.fails for check in checks),
        "without a limit": sum(check.verdict == "no limit" for check in checks),
        "not known": len(unknown),
    }
    of_them = f" ({sum(check.limit is not None for check in unknown)} of them with a limit)" if unknown else ""
    lines.append("  " + ", ".join(f"{count} {word}" for word, count in counts.items()) + of_them)
    return "\n".join(lines)


def with_unit(number: float, value: Value, digits: int) -> str:
    """Return a number with the unit of a value; minutes and seconds of arc stand right behind it."""
    sign = unit_sign(value.unit)
    return printed(number, f"{{:.{digits}g}}", value.unit) + (sign if sign in CLOSE else f" {sign}" if sign else "")


def verdict_line(checks: Sequence[Check]) -> str:
    """Return the verdict on a case in one line: pass or fail, and the check that fails worst or is nearest to its limit.

    Positions that are too few fail no drive; it is told.
    """
    judged = [check for check in checks if check.fails or check.verdict == "pass"]
    of_drive = [check for check in judged if not is_of_sampling(check)]
    if not of_drive:
        return "not judged: neither drive file nor materials have limits"
    failed, few = sum(check.fails for check in of_drive), sum(check.fails for check in judged if is_of_sampling(check))
    word = WORDS["fail"] if failed else "pass at these positions" if few else WORDS["pass"]
    nearest = min(of_drive, key=urgency)
    told = f"{word}  {nearest.title}"
    if nearest.value.value is None:
        told += f" cannot be judged: {nearest.value.reason}"
    elif nearest.limit is not None:
        bound = f"{'≤' if nearest.limit.sense == 'max' else '≥'} {with_unit(nearest.limit.value, nearest.value, 4)}"
        told += f" {with_unit(nearest.value.value, nearest.value, 4)} ({bound})"
    if nearest.safety is not None:
        told += f", safety {nearest.safety:.3g}"
    told += f"; {failed} of {len(of_drive)} checks fail" if failed > 1 else ""
    return told + ("; too few positions for the peaks" if few else "")


def urgency(check: Check) -> tuple[bool, bool, float]:
    """Return a sort key: failed checks first, checks of the drive before those of the sampling, then by increasing safety.

    A value beyond a limit that no ratio measures, as a wall thinner than nothing, is worst of all; one that keeps such a limit,
    or is not known, comes last.
    """
    safety = check.safety
    if safety is None:
        safety = 0.0 if check.verdict == "fail" else float("inf")
    return not check.fails, is_of_sampling(check), safety


def is_of_sampling(check: Check) -> bool:
    """Whether a check is of the positions of a run, not of the drive."""
    return check.value.quantity == "distinct_mesh_phases"


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
