"""Programs that end with the process that started them, and signals that end a command cleanly."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

AGAIN = 0.05
"""Time, s, after which a signal that nobody heard is sent again."""

ENDS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGBREAK") if hasattr(signal, name))
"""Signals that end a program; by SIGBREAK `ltca.output.supervisor` asks for it on Windows."""

ENDING = 10.0
"""Time, s, in which a supervised program has to be gone."""


class Terminated(BaseException):
    """SIGTERM has come: unwinds like Ctrl-C, so that temporary files and children go."""


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Turn SIGTERM into `Terminated` while the block runs; only the main thread can.

    Compiled libraries, while they are loaded for one, turn any exception that comes inside them into one of their own: an error
    that leaves the block after a signal has come is that signal's, of Ctrl-C as well.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    armed, told = True, sys.unraisablehook
    heard: type[BaseException] | None = None

    def end(number: int, frame: Any) -> None:
        nonlocal armed, heard
        if armed:
            armed = False  # a second one would cut the cleaning short
            heard = Terminated
            raise Terminated

    def interrupt(number: int, frame: Any) -> None:
        nonlocal heard
        heard = KeyboardInterrupt
        raise KeyboardInterrupt

    def again(unraisable: Any) -> None:
        # A signal that comes while an object is being removed raises where nobody hears it: it is sent once more.
        nonlocal armed
        if unraisable.exc_type is Terminated:
            armed = True
            number = signal.SIGTERM
        elif unraisable.exc_type is KeyboardInterrupt:
            number = signal.SIGINT
        else:
            told(unraisable)
            return
        timer = threading.Timer(AGAIN, _send, (number,))
        timer.daemon = True
        timer.start()

    before = {number: signal.signal(number, end) for number in ENDS}
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        before[signal.SIGINT] = signal.signal(signal.SIGINT, interrupt)
    sys.unraisablehook = again
    try:
        yield
    except Exception as error:
        if heard is None:
            raise
        raise heard from error
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = told


def _send(number: int) -> None:
    """Send a signal to this process."""
    if os.name == "nt":  # where os.kill ends a process, whatever the signal
        signal.raise_signal(number)
    else:  # which ends the waiting of the main thread as well
        os.kill(os.getpid(), number)


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold Ctrl-C back while children are started: they inherit that, and this process hears it after the block."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class Supervised:
    """A program under supervision: it ends with this process, and so does its temporary folder.

    Parameters
    ----------
    words : sequence of str
        Program and arguments.
    folder : Path
        Its temporary files; removed when this process ends.
    options : mapping
        Of `subprocess.Popen`: where it runs, where its output goes, its environment.
    """

    def __init__(self, words: Sequence[str], folder: Path, options: Mapping[str, Any]) -> None:
        supervisor = Path(__file__).with_name("supervisor.py")
        # Without groups of processes it needs psutil, and so the packages of this environment.
        alone = ["-S", "-E"] if hasattr(os, "killpg") else ["-P"]
        with interrupts_held():
            self._process = subprocess.Popen(
                [sys.executable, *alone, str(supervisor), str(folder), *words],
                stdin=subprocess.PIPE,
                start_new_session=True,
                creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
                **options,
            )

    def wait(self, seconds: float | None = None) -> int:
        """Wait until the program ends and return its exit status; `subprocess.TimeoutExpired` after so many seconds."""
        return self._process.wait(seconds)

    def end(self) -> None:
        """End the program with all it started, if it still runs."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(ENDING)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


@contextmanager
def supervised(words: Sequence[str], folder: Path, **options: Any) -> Iterator[Supervised]:
    """Give a program that runs beside the block, its temporary files in `folder`, and is ended with it.

    Options are those of `subprocess.Popen`. Raises `OSError` when no process can be started.
    """
    program = Supervised(words, folder, options)
    try:
        yield program
    finally:
        program.end()
