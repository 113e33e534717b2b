"""Run a program that ends with whoever asked for it, together with its folder of temporary files.

Run as a file of its own, ``python ltca/output/supervisor.py FOLDER PROGRAM ARGUMENT …``, by nothing but the standard library
(on Windows also psutil). Its standard input is a pipe from the asking process. When that ends, however it ends (SIGKILL
too), the pipe does: the program is ended with all it started, and the folder is removed. Temporary files of the program
go there.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence

GRACE = 3.0
"""Time, s, a program has to end by itself."""


def supervise(folder: str, words: Sequence[str]) -> int:
    """Run a program and return its exit status; end it when standard input does.

    The folder is removed when the asking process ends before the program does.
    """
    # Ctrl-C reaches the asking process, which then ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    environment = {**os.environ, "TMPDIR": folder}
    program = subprocess.Popen(
        words,
        stdin=subprocess.DEVNULL,
        start_new_session=True,
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),
        env=environment,
    )
    ended = threading.Event()  # the program, or who asked for it

    def wait() -> None:
        program.wait()
        ended.set()

    def listen() -> None:
        with contextlib.suppress(OSError):
            while os.read(0, 1):
                pass
        ended.set()

    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    threading.Thread(target=listen, daemon=True).start()
    try:
        ended.wait()
        if program.returncode is not None:
            return program.returncode
    except _EndedError:
        pass
    _end_all(program, waiting)
    shutil.rmtree(folder, ignore_errors=True)
    return 128 + signal.SIGTERM


def _end_all(program: subprocess.Popen[bytes], waiting: threading.Thread) -> None:
    """End a program with all it started: it is asked to, then ended."""
    if hasattr(os, "killpg"):
        for number in (signal.SIGTERM, signal.SIGKILL):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(program.pid, number)
            waiting.join(GRACE)
        return
    import psutil

    started: list[psutil.Process] = []
    with contextlib.suppress(psutil.Error):
        first = psutil.Process(program.pid)
        started = [first, *first.children(recursive=True)]
    with contextlib.suppress(OSError):
        program.send_signal(getattr(signal, "CTRL_BREAK_EVENT", signal.SIGTERM))
    waiting.join(GRACE)
    for one in started:
        with contextlib.suppress(psutil.Error):
            one.kill()
    waiting.join(GRACE)


class _EndedError(Exception):
    """Raised on SIGTERM."""


def _end(number: int, frame: object) -> None:
    raise _EndedError


if __name__ == "__main__":
    # At once: on Windows the interpreter's exit would wait for the thread that reads.
    os._exit(supervise(sys.argv[1], sys.argv[2:]) % 256)
