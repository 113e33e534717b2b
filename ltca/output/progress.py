"""Progress on a terminal; nothing in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol


class Advance(Protocol):
    """Told of every finished part."""

    def __call__(self, name: str, size: int = 1) -> None:
        """Show the name and move on by the size."""
        ...


@contextmanager
def progress(title: str, total: int) -> Iterator[Advance]:
    """Show a bar with rate and time left on stderr while the block runs, if stderr is a terminal.

    Parameters
    ----------
    title : str
        What is counted.
    total : int
        How many there are.

    Yields
    ------
    callable
        To be called with the name of each finished part, and its size when it is not 1.
    """
    if not sys.stderr.isatty():
        yield lambda name, size=1: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=total)

        def advance(name: str, size: int = 1) -> None:
            bar.update(task, advance=size, description=f"{title}: {name}")

        yield advance
