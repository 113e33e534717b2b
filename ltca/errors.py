"""Errors the suite raises on purpose; the command line turns them into one message and exit status 2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar


class CycloError(Exception):
    """Base of every error that carries a message for the user."""

    exit_status: ClassVar[int] = 2
    """What the program ends with: 2 for wrong input, 1 for a fault or what has no answer."""


class DriveError(CycloError):
    """The drive definition is wrong.

    Parameters
    ----------
    problems : sequence of str
        One complete sentence per mistake: field, value, bound and unit.
    source : str, optional
        Where the definition came from (a file name).
    """

    def __init__(self, problems: Sequence[str], source: str = "") -> None:
        self.problems = tuple(problems)
        self.source = source
        head = f"{source}: " if source else ""
        if len(self.problems) == 1:
            text = head + self.problems[0]
        else:
            text = f"{head}{len(self.problems)} mistakes\n" + "\n".join(f"  {p}" for p in self.problems)
        super().__init__(text)


class FaultError(CycloError):
    """Something beside the input failed: the disc is full, workers died."""

    exit_status = 1


class PlaceError(CycloError):
    """A file or folder that was asked for cannot be used: another process writes to it, or nobody may."""


class DamagedFileError(CycloError):
    """A file is damaged, or is not what it should be."""


class ConvergenceError(CycloError):
    """An iteration ended without an answer.

    Parameters
    ----------
    message : str
        What did not converge, and where.
    history : sequence of float
        The residual after each iteration, in the unit the message states.
    """

    def __init__(self, message: str, history: Sequence[float] = ()) -> None:
        self.history = tuple(float(value) for value in history)
        tail = ", ".join(f"{value:.3g}" for value in self.history[-8:])
        super().__init__(f"{message}; last residuals: {tail}" if tail else message)
