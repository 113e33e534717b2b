"""Errors by the data that they carry, field, value and bound, or by their sentences, without regular expressions."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from typing import Any

import pytest

from ltca.errors import DriveError, Problem


def stands_in(pieces: Sequence[str], text: str) -> bool:
    """Tell whether pieces of text stand in a text, one behind the other."""
    at = 0
    for piece in pieces:
        if (at := text.find(piece, at)) < 0:
            return False
        at += len(piece)
    return True


def says_bound(problem: Problem) -> bool:
    """Tell whether a sentence says the bound that it carries: its relation, unless it is "equal to", and its number, rounded."""
    assert problem.bound is not None
    relation, number = problem.bound
    words, _, size = relation.partition(" in ")  # "at most in size" reads "at most 3 mm in size"
    said = relation == "equal to" or (words in problem.said and size in problem.said)
    return said and any(f"{number:.{digits}g}" in problem.said for digits in range(2, 13))


@contextmanager
def refused_field(
    path: str,
    value: str = "",
    *said: str,
    bound: Any = None,
    alone: bool = False,
    source: str = "",
    error: type[DriveError] = DriveError,
) -> Generator[pytest.ExceptionInfo[DriveError], None, None]:
    """Require an error about a field with its value, "= 4 mm" or empty for any, and its bound, such as ("at most", 3.5).

    Pieces of what is `said` stand in the sentence in this order; with `alone` it is the only one. `source` is the file.
    """
    with pytest.raises(error) as caught:
        yield caught
    problems = caught.value.problems
    assert not alone or len(problems) == 1, problems
    assert not source or caught.value.source == source
    about = [problem for problem in problems if isinstance(problem, Problem) and problem.path == path]
    assert any(
        (not value or problem.subject == f"{path} {value}")
        and (bound is None or (problem.bound == bound and says_bound(problem)))
        and stands_in(said, problem.said)
        for problem in about
    ), f"{path} {value}, {bound}, {said}: {[(problem, problem.bound) for problem in about] or problems}"


@contextmanager
def error_says(
    error: type[BaseException] | tuple[type[BaseException], ...], *pieces: str, starts: str = "", ends: str = ""
) -> Generator[pytest.ExceptionInfo[Any], None, None]:
    """Require an error with a line in which pieces of text stand in this order, and whose message `starts` and `ends` so."""
    with pytest.raises(error) as caught:
        yield caught
    text = str(caught.value)
    assert text.startswith(starts), text
    assert text.endswith(ends), text
    assert any(stands_in(pieces, line) for line in text.splitlines()), (text, pieces)


@contextmanager
def error_is(
    error: type[BaseException] | tuple[type[BaseException], ...], sentence: str
) -> Generator[pytest.ExceptionInfo[Any], None, None]:
    """Require an error whose whole message is a sentence."""
    with pytest.raises(error) as caught:
        yield caught
    assert str(caught.value) == sentence


def reads_as(sentence: str, text: str) -> bool:
    """Tell whether a text is a sentence in which each "…" stands for any words, or none, on its line."""
    first, *pieces = sentence.split("…")
    if not pieces:
        return text == sentence
    *within, last = pieces
    inner = text.removeprefix(first)
    long_enough = len(text) >= len(first) + len(last)
    return (
        long_enough
        and text.startswith(first)
        and text.endswith(last)
        and "\n" not in text
        and stands_in(within, inner[: len(inner) - len(last)])
    )
