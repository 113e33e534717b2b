"""Run a program that ends with whoever asked for it, together with its folder of temporary files.

Run as a file of its own, by nothing but the standard library: ``python ltca/output/supervisor.py FOLDER PROGRAM ARGUMENT …``. Its
standard input is a pipe from the asking process. When that ends, however it ends (SIGKILL too), the pipe does: the
program is ended with all it started, and the folder is removed. Temporary files of the program go there.
"""

from __future__ import annotations

import contextlib
import os
import select
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
    program = subprocess.Popen(words, stdin=subprocess.DEVNULL, start_new_session=True, env=environment)
    told, tells = os.pipe()

    def wait() -> None:
        program.wait()
        os.close(tells)

    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    try:
        if told in select.select([0, told], [], [])[0]:
            return program.returncode
    except _EndedError:
        pass
    for number in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(program.pid, number)
        waiting.join(GRACE)
    shutil.rmtree(folder, ignore_errors=True)
    return 128 + signal.SIGTERM


class _EndedError(Exception):
    """Raised on SIGTERM."""


def _end(number: int, frame: object) -> None:
    raise _EndedError


if __name__ == "__main__":
    sys.exit(supervise(sys.argv[1], sys.argv[2:]) % 256)
