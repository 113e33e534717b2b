"""Run pytest in forks of a process: third-party packages are imported once, those of the tree in every fork.

A fork works in a given tree, with limits of time and memory, and returns its result as JSON.
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

WARM = (
    "numpy", "numpy.testing", "scipy.linalg", "scipy.sparse.linalg", "scipy.sparse.csgraph", "scipy.optimize",
    "scipy.interpolate", "scipy.integrate", "scipy.special", "scipy.stats", "scipy.spatial", "skfem", "meshio", "xarray",
    "h5netcdf", "h5py", "pydantic", "threadpoolctl", "jinja2", "rich.progress", "matplotlib.figure",
    "pytest", "hypothesis",
)  # fmt: skip
# Third-party plugins are not loaded in forks, so their options (``--dist``) are omitted.
PYTEST_WORDS = (
    "-q", "-p", "no:cacheprovider", "--no-header",
    "-o", "addopts=--import-mode=importlib --doctest-modules --strict-markers",
)  # fmt: skip
MEMORY = 8 * 2**30
PARENT_DEATH_SIGNAL = 1  # of prctl, Linux


def warm_up() -> None:
    """Import the third-party packages that all runs need."""
    for name in WARM:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def in_fork(work: Callable[[], Any], tree: Path, *, seconds: float) -> tuple[str, Any]:
    """Run a function in a fork whose working directory and first import path is a tree.

    Parameters
    ----------
    work : callable
        Function with a JSON-serialisable result.
    tree : Path
        Working directory, first on the path.
    seconds : float
        Limit of processor time, s; the limit of wall time is eight times as long.

    Returns
    -------
    how : {"done", "time", "crash"}
        How it ended.
    answer
        Result of the function, or the end of its output.
    """
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        answer, words = Path(folder) / "answer.json", Path(folder) / "words.txt"
        child = os.fork()
        if child == 0:
            _stand_in(work, tree, Path(folder), answer, words, seconds)
        status, began = None, time.monotonic()
        while status is None:
            done, code = os.waitpid(child, os.WNOHANG)
            if done:
                status = code
            elif time.monotonic() - began > 8.0 * seconds + 60.0:
                os.killpg(child, signal.SIGKILL)
            else:
                time.sleep(0.02)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child, signal.SIGKILL)  # remaining child processes
        if answer.exists():
            return "done", json.loads(answer.read_text(encoding="utf-8"))
        killed = os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL)
        last = words.read_text(encoding="utf-8", errors="replace")[-2000:] if words.exists() else ""
        return ("time" if killed else "crash"), last


def _stand_in(work: Callable[[], Any], tree: Path, folder: Path, answer: Path, words: Path, seconds: float) -> None:
    """Run as the child process; never returns."""
    code = 1
    try:
        os.setpgid(0, 0)
        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL)
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        stream = os.open(words, os.O_WRONLY | os.O_CREAT)
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        os.chdir(tree)
        sys.path.insert(0, str(tree))
        sys.dont_write_bytecode = True
        os.environ.update(PYTHONPATH=str(tree), XDG_CACHE_HOME=str(folder / "cache"), PYTHONDONTWRITEBYTECODE="1")
        os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # assertion rewriting of plugins takes a second
        found = work()
        part = answer.with_suffix(".part")
        part.write_text(json.dumps(found), encoding="utf-8")
        part.replace(answer)
        code = 0
    except BaseException:  # noqa: BLE001 - reported to the parent
        traceback.print_exc()
    finally:
        os._exit(code)
