"""Pools of worker processes that end with the process that started them, whatever ends it.

The folder in which a pool has its sockets ends with its workers. Where all of them are killed at once it is removed at the
next start of a pool: it carries a lock that ends with its process, so what is named as ours and locked by nobody is left over.
"""

from __future__ import annotations

import atexit
import os
import shutil
import signal
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import (
    active_children,
    current_process,
    get_all_start_methods,
    get_context,
)
from multiprocessing.context import BaseContext
from pathlib import Path

from ltca.errors import FaultError
from ltca.output.locks import lock_descriptor
from ltca.output.processes import interrupts_held

PREFIX = "cyclo-pool-"
LOCK = "lock"
SHORT_PLACE, LONGEST_PLACE = "/tmp", 69
"""Where sockets go when the path of the folder for temporary files is longer: theirs may have 107 bytes, names in it take 38."""
FRESH = 10.0
"""Age, s, up to which a folder may be one that is about to be locked."""
LETTING_GO = 0.3
"""Time, s, after which an ended process has let go of its lock; its pipes may be closed a moment earlier."""
MOST_ON_WINDOWS = 61
"""Processes of a pool: Windows waits for no more at a time, and the standard library refuses them."""
NEEDED = (
    "the folder for temporary files must be writable"
    if sys.platform in ("win32", "darwin")
    else "/dev/shm and TMPDIR must be writable"
)
NOTICING = 5.0
"""Time, s, in which a pool has to notice that its workers were ended; it takes milliseconds."""


@contextmanager
def process_pool(
    processes: int, *, preload: str = "", initializer: Callable[[], None] | None = None
) -> Iterator[ProcessPoolExecutor]:
    """Give a pool of processes; an exception that leaves the block leaves no worker behind.

    A fork server, where there is one, imports `preload` once, and every worker starts as its copy. `initializer` is called first
    in every worker and has to call `become_worker`, which is the default. Raises `FaultError` when the system gives no
    processes, or none of the semaphores and pipes between them.
    """
    try:
        pool = _started_pool(processes, preload, initializer)
    except OSError as error:
        told = f"{processes} worker processes cannot be started: {error.strerror or error}"
        raise FaultError(f"{told}: {NEEDED}; or take --workers 1") from error
    try:
        yield pool
    except BaseException as error:
        for child in active_children():
            child.terminate()
        if not isinstance(error, BrokenProcessPool):  # which is built anew, from the same server
            _end_fork_server()  # now: children of a server that is gone pass for dead
        _let_go(pool)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _started_pool(processes: int, preload: str, initializer: Callable[[], None] | None) -> ProcessPoolExecutor:
    context = start_context(preload)
    if os.name == "nt":
        processes = min(processes, MOST_ON_WINDOWS)
    return ProcessPoolExecutor(processes, mp_context=context, initializer=initializer or become_worker)


def start_context(preload: str) -> BaseContext:
    """Return what starts processes: as copies of a server that has imported `preload`, which runs then, or each by itself.

    By itself without `preload`, on Windows, which copies no processes, and on macOS, whose own libraries (Accelerate,
    Objective-C) do not work in copies.
    """
    if not preload or sys.platform == "darwin" or "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    from multiprocessing import forkserver, resource_tracker

    context = get_context("forkserver")
    make_pool_folder()
    context.set_forkserver_preload([preload])
    resource_tracker.ensure_running()  # first: when it starts, held signals come through again
    with interrupts_held():
        # While the server loads, Ctrl-C would end it with a traceback of its own.
        forkserver.ensure_running()
    return context


def _end_fork_server() -> None:
    """End the fork server at once: still loading, it would start a worker for a process that is gone, which complains."""
    if "forkserver" not in get_all_start_methods():
        return
    from multiprocessing import forkserver

    server = getattr(forkserver, "_forkserver", None)
    number, forget = getattr(server, "_forkserver_pid", None), getattr(server, "_stop", None)
    if number is not None and forget is not None:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
        forget()


def _let_go(pool: ProcessPoolExecutor) -> None:
    """Let the thread that looks after a pool notice that its workers are gone, so that shutting the pool down returns.

    Two things can keep it for ever, for this process holds the other ends of both pipes: a batch half written, larger than
    the pipe holds (CPython before 3.11.5, gh-94777), and a result half read. By itself it notices in milliseconds and
    closes those ends; closing them before is a race for who does.
    """
    manager = getattr(pool, "_executor_manager_thread", None)
    if manager is None:  # nothing was handed in
        return
    manager.join(NOTICING)
    if manager.is_alive():
        for queue, end in (("_call_queue", "_reader"), ("_result_queue", "_writer")):
            connection = getattr(getattr(pool, queue, None), end, None)
            if connection is not None:
                connection.close()


def become_worker() -> None:
    """Make this worker of a pool of processes deaf to Ctrl-C and end with its parent; for ``initializer``."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it reaches the whole group; the parent decides what ends
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    from multiprocessing import parent_process
    from multiprocessing.connection import wait

    parent = parent_process()
    if parent is None:
        return

    folder = pool_folder()

    def watch() -> None:
        wait([parent.sentinel])
        # It may live on and have lost this worker alone, with the fork server: then it holds the lock and needs the folder.
        until = time.monotonic() + LETTING_GO
        while folder is not None and not _remove_unlocked(folder) and time.monotonic() < until:
            time.sleep(0.02)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="ends with its parent").start()


def make_pool_folder() -> None:
    """Let `multiprocessing` put sockets into a folder of ours, once in a process; remove those of dead ones before."""
    config = current_process()._config  # type: ignore[attr-defined]
    place = Path(tempfile.gettempdir())
    if len(os.fsencode(place)) > LONGEST_PLACE and os.path.isdir(SHORT_PLACE):
        place = Path(SHORT_PLACE)
    remove_stale_folders(place)
    if os.path.isdir(config.get("tempdir") or ""):
        return
    folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=place))
    descriptor = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
    _lock(descriptor)  # held until this process ends, however that is
    config["tempdir"] = str(folder)
    atexit.register(_remove_own, os.getpid(), folder)


def _remove_own(maker: int, folder: Path) -> None:
    if os.getpid() == maker:
        shutil.rmtree(folder, ignore_errors=True)


def pool_folder() -> Path | None:
    """Return the folder of the pool that this worker belongs to; None where it is not one of ours."""
    name = current_process()._config.get("tempdir")  # type: ignore[attr-defined]
    return Path(name) if name and Path(name).name.startswith(PREFIX) else None


def remove_stale_folders(place: Path, fresh: float = FRESH) -> None:
    """Remove temporary folders of this program whose processes are dead, if older than `fresh` seconds."""
    if not hasattr(os, "getuid"):  # Windows has no fork server, and no folders of sockets
        return
    with suppress(OSError):
        for folder in place.glob(f"{PREFIX}*"):
            with suppress(OSError):
                found = folder.lstat()
                if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
                    continue
                if time.time() - found.st_mtime < fresh:
                    continue
                _remove_unlocked(folder)


def _remove_unlocked(folder: Path) -> bool:
    """Remove a folder whose process has ended; False while that holds its lock."""
    try:
        descriptor = os.open(folder / LOCK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return True  # it has gone, or is none of ours
    try:
        if not _lock(descriptor):
            return False
        shutil.rmtree(folder, ignore_errors=True)
        return True
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> bool:
    """Lock a file, and tell whether that could be done: another process holds it, or there are no locks here."""
    try:
        return lock_descriptor(descriptor, wait=False)
    except OSError:
        return False
