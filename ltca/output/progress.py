"""Progress: a bar on a terminal, a line every few seconds without one."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

SECONDS = 5.0
"""Between two lines where there is no terminal."""

FIRST = 10.0
"""Before the first of them; what takes less time says nothing."""

WIDTH = 118
"""Letters of a line on a terminal."""


_SILENT = threading.Event()
"""Set in workers, whose progress the process that has started them tells."""


def be_silent() -> None:
    """Tell no progress of this process any more."""
    _SILENT.set()


class Advance(Protocol):
    """Told of every finished part."""

    def __call__(self, name: str, size: int = 1) -> None:
        """Show the name and move on by the size."""
        ...


@contextmanager
def progress(title: str, total: int, *, at_most: bool = False) -> Iterator[Advance]:
    """Show on stderr how far the block is: a bar with time left on a terminal, else a line every few seconds.

    Gives a function to be called with the name of each finished part of `total`, and its size when that is not 1; `at_most`
    tells that there may be fewer.
    """
    if _SILENT.is_set() or not sys.stderr.isatty():
        done, last = 0, ""

        def describe() -> str:
            of = f"{'at most ' if at_most else ''}{total}"
            return f"{title}: {done} of {of}" + (f", {last}" if last else "")

        def count(name: str, size: int = 1) -> None:
            nonlocal done, last
            done, last = done + size, name

        with _said_regularly(describe):
            yield count
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=total)

        def advance(name: str, size: int = 1) -> None:
            bar.update(task, advance=size, description=f"{title}: {name}")

        yield advance


@contextmanager
def steps(title: str = "") -> Iterator[Callable[[str], None]]:
    """Show on stderr what is being done: one line that overwrites itself on a terminal, else one every few seconds.

    Gives a function to be called with the name of each step before it starts.
    """
    head, now = f"{title}: " if title else "", ""
    if _SILENT.is_set() or not sys.stderr.isatty():

        def note(step: str) -> None:
            nonlocal now
            now = step

        with _said_regularly(lambda: f"{head}{now}" if now else ""):
            yield note
        return

    def show(step: str) -> None:
        print(f"\r\x1b[K{(head + step)[:WIDTH]}", end="", file=sys.stderr, flush=True)

    try:
        yield show
    finally:
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)


_TOLD: list[Callable[[], str]] = []
"""Descriptions of blocks that run one within the other in this process, the outermost first."""


@contextmanager
def _said_regularly(describe: Callable[[], str]) -> Iterator[None]:
    """Print a description with the time so far every few seconds while the block runs, whatever it is busy with.

    A block within another one adds its words to the lines of that one.
    """
    _TOLD.append(describe)
    if len(_TOLD) > 1 or _SILENT.is_set():
        try:
            yield
        finally:
            _TOLD.remove(describe)
        return
    ended, began = threading.Event(), time.monotonic()

    def say() -> None:
        seconds = FIRST
        while not ended.wait(seconds):
            seconds, text = SECONDS, "; ".join(filter(None, (told() for told in [*_TOLD])))
            if text:
                print(f"{text} ({time.monotonic() - began:.0f} s)", file=sys.stderr, flush=True)

    thread = threading.Thread(target=say, daemon=True)
    thread.start()
    try:
        yield
    finally:
        _TOLD.remove(describe)
        ended.set()
        thread.join()
