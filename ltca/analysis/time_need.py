"""Time that an analysis will take, estimated before it starts."""

from __future__ import annotations

from collections.abc import Iterable

from ltca.analysis.engines import Engine
from ltca.analysis.memory_need import pairs_of
from ltca.compliance.coefficient_files import told_seconds
from ltca.drive.parts import Drive

TOLD_FROM = 20.0
"""Time from which it is told beforehand, s."""
SECONDS_PER_PAIR = {
    ("half-space", False): (8e-6, 0.009),
    ("half-space", True): (40e-6, 0.016),
    ("coupled", False): (45e-6, 0.036),
    ("coupled", True): (190e-6, 0.093),
}
"""Processor time for each pair of contacts, s: at one position, and of extremes between the positions; by engine and whether
friction is there. Measured on the shipped drives (``benchmarks/study_costs.py``)."""


PER_SLICE = {"positions": (5.0, 1.0), "extremes": (1.0, 1.4)}
"""Factors of contacts in slices on that: the first number plus the second times the slices. The paper's drive in 5, 9, 17 and 33
slices takes 5, 9, 14 and 30 times as long on half-spaces, 14 times in 9 on hybrid."""


def expected_seconds(drives: Iterable[Drive], positions: int, engine: Engine) -> float:
    """Return about how long the analysis of drives at some positions each takes on one core, coefficients left out, s.

    Known to a factor of two. Methods that solve grids are dearer and not covered.
    """
    kind = "half-space" if engine.compliance == "half-space" else "coupled"
    found = 0.0
    for drive in drives:
        each, extremes = SECONDS_PER_PAIR[kind, drive.friction is not None]
        if (slices := drive.contact.slices) > 1:
            each, extremes = (
                seconds * (fixed + more * slices)
                for seconds, (fixed, more) in zip((each, extremes), PER_SLICE.values(), strict=True)
            )
        found += pairs_of(drive) * (each * positions + (extremes if positions > 1 else 0.0))
    return found


def time_words(drives: Iterable[Drive], positions: int, engine: Engine) -> str:
    """Return what to say of the time beforehand; empty below `TOLD_FROM`.

    Examples
    --------
    >>> from ltca.analysis.engines import Hybrid
    >>> from ltca.reading.changes import with_fields
    >>> from ltca.reading.drive_file import load_drive
    >>> drive = load_drive("robot-joint").cases["nominal"]
    >>> time_words([drive], 360, Hybrid())
    ''
    >>> time_words([with_fields(drive, {"friction.pin": 0.06})], 360, Hybrid())
    'the solution takes some 20 s on one core (360 positions, hybrid, with friction)'
    """
    cases = list(drives)
    seconds = expected_seconds(cases, positions, engine)
    if seconds < TOLD_FROM:
        return ""
    rubs = ", with friction" if any(drive.friction is not None for drive in cases) else ""
    slices = max(drive.contact.slices for drive in cases)
    rubs += f", {slices} slices" if slices > 1 else ""
    several = f"{len(cases)} cases, " if len(cases) > 1 else ""
    many = f"{positions} position{'s' * (positions > 1)}"
    return f"the solution takes {told_seconds(seconds)} on one core ({several}{many}, {engine.compliance}{rubs})"
