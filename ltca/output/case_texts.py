"""Texts about several cases of a drive, each printed once with the names of its cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence


def with_case_names(texts: Mapping[str, Sequence[str]]) -> list[str]:
    """Return each text once, after the names of its cases unless it is about all of them.

    Examples
    --------
    >>> with_case_names({"CS-1": ["few positions", "edges"], "CS-2": ["few positions"], "CS-3": ["few positions"]})
    ['few positions', 'case CS-1: edges']
    >>> with_case_names({"CS-1": ["edges"], "CS-2": [], "CS-3": ["edges"]}), with_case_names({"CS-1": ["edges"]})
    (['cases CS-1, CS-3: edges'], ['edges'])
    """
    lines = []
    for text in dict.fromkeys(text for each in texts.values() for text in each):
        cases = [name for name, each in texts.items() if text in each]
        names = f"case{'s' * (len(cases) > 1)} {', '.join(cases)}: " if len(cases) < len(texts) else ""
        lines.append(names + text)
    return lines
