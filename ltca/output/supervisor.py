"""Run a program that ends with whoever asked for it, together with its folder of temporary files.

Run as a file of its own, by nothing but the standard library: ``python supervisor.py FOLDER PROGRAM ARGUMENT …``. Its
standard input is a pipe from the asking process. When that ends, however it ends (SIGKILL too), the pipe does: the
program is ended with all it started, and the folder is removed. Temporary files of the program go there.
"""

from __future__ import annotations

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

    Parameters
    ----------
    folder : str
        Removed when the asking process ends before the program does.
    words : sequence of str
        Program and arguments.
    """
    program = subprocess.Popen(
        words, stdin=subprocess.DEVNULL, start_new_session=True, env={**os.environ, "TMPDIR": folder}
    )

    def end(*_: object) -> None:
        for number in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(program.pid, number)
                program.wait(GRACE)
            except (ProcessLookupError, subprocess.TimeoutExpired):
                continue
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(128 + signal.SIGTERM)

    def watch() -> None:
        while os.read(0, 1):
            pass
        end()

    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the asking process, which then ends this one
    threading.Thread(target=watch, daemon=True).start()
    return program.wait()


if __name__ == "__main__":
    sys.exit(supervise(sys.argv[1], sys.argv[2:]) % 256)
