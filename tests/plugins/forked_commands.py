"""Commands of ``cyclo``, each in a fork of a process that has the libraries already; coefficients on coarse meshes.

Summaries have no extremes between positions, which cost a small run a hundred times as many positions as it asks for; an optimum
is solved at few positions, torque curves at one crank angle; other codes answer as stored: tests of their own compute these.

A line of the standard input is a command as JSON, ``[words, folder, seconds]``, with the processor time that it may take;
its answer is a line too, ``[status, told, seconds]``: exit status (negative by a signal), the end of what it printed, and its
processor time with that of its processes.
"""

from __future__ import annotations

import json
import multiprocessing.util
import os
import resource
import signal
import sys
import tempfile
from dataclasses import replace
from importlib import import_module

LIBRARIES = (
    "ltca.facade", "ltca.analysis.engines", "ltca.studies.study", "fem.reducer.solution", "fem.coefficients.dataset",
    "xarray", "scipy.optimize", "scipy.interpolate", "scipy.integrate", "matplotlib.figure",
)  # fmt: skip

FEW_POSITIONS = 17


def run_fork(words: list[str], seconds: int) -> int:
    """Run a command in this process, a fork, and return its exit status."""
    from ltca.commands.program import main

    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    signal.alarm(10 * seconds)  # of one that waits for ever
    try:
        return main(words)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    finally:
        multiprocessing.util._exit_function()  # type: ignore[attr-defined]  # folders and processes of pools
        sys.stdout.flush()
        sys.stderr.flush()


def answer(words: list[str], folder: str, seconds: int) -> tuple[int, str, float]:
    """Run a command in a fork and return its answer."""
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            status = 3
            try:
                os.chdir(folder)
                for number, to in ((0, os.open(os.devnull, os.O_RDONLY)), (1, printed.fileno()), (2, printed.fileno())):
                    os.dup2(to, number)
                status = run_fork(words, seconds)
            finally:
                os._exit(status)
        _, status, usage = os.wait4(child, 0)
        printed.seek(0)
        told = printed.read().decode("utf-8", "replace")
    return os.waitstatus_to_exitcode(status), told[-1000:], usage.ru_utime + usage.ru_stime


def main() -> None:
    """Answer commands until there are no more."""
    from coarse_derivations import coarse_derivation

    from ltca.analysis import summary, torque_curve
    from ltca.compliance import coefficient_files
    from ltca.output.provenance import code_hash
    from ltca.studies.fine_solution import solve_finely
    from validation.levels.other_code_problems import CODES

    for name in LIBRARIES:
        import_module(name)
    code_hash("ltca", "fem")  # kept for all forks
    coefficient_files.derivation = coarse_derivation
    coefficient_files.MAX_DERIVATIONS = 1  # in the fork itself: other processes would derive on fine meshes
    summary._refined = lambda analyses: [{} for _ in analyses]
    solve_finely.__defaults__ = (FEW_POSITIONS,)
    torque_curve.CURVE_ANGLES = 1
    CODES.update({name: replace(code, installed=lambda: False) for name, code in CODES.items()})
    for line in sys.stdin:
        print(json.dumps(answer(*json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
