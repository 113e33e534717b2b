"""Locks on the folder or file that a run writes: one process at a time, until it ends, however that is."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ltca.errors import FaultError, PlaceError
from ltca.output.files import remove_parts_of
from ltca.output.regular_files import read_regular

LOCKLESS = (errno.ENOLCK, errno.ENOTSUP, errno.ENOSYS)
"""What a file system answers that knows no locks: two runs are not kept apart there."""
FAULTS = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
"""What is no fault of whoever chose the folder."""


@contextmanager
def claimed_file(path: Path, command: str) -> Iterator[None]:
    """Hold one file, whose folder is made, while a command makes it.

    Raises `PlaceError` when another process makes it or its folder cannot be written to, `FaultError` when the disc fails.
    """
    if path.is_dir():
        raise PlaceError(f"--out {path}: is a folder, not a file")
    with held(path.with_name(f".{path.name}.lock"), f"--out {path}", command):
        remove_parts_of(path, 0.0)
        yield


@contextmanager
def held(lock: Path, what: str, command: str, *, wait: bool = False) -> Iterator[None]:
    """Hold a lock that ends with the process, however that ends; its file is removed.

    `what` is locked for `command`, as messages name both; with `wait` another holder is waited for. The folder of the lock is
    made, and removed again where it stays empty. Raises `PlaceError` when another process holds it or the folder cannot be
    written to, `FaultError` when the disc is full or fails.
    """
    made = [folder for folder in lock.parents if not folder.exists()]
    try:
        with _held(lock, what, command, wait):
            yield
    finally:
        with suppress(OSError):  # a run that wrote nothing leaves nothing
            for folder in made:
                folder.rmdir()


@contextmanager
def _held(lock: Path, what: str, command: str, wait: bool) -> Iterator[None]:
    try:
        lock.parent.mkdir(parents=True, exist_ok=True)
        descriptor = _take(lock, wait)
    except BlockingIOError:
        raise PlaceError(f"{what}: {_holder(lock)} is writing there: wait for it, or choose another place") from None
    except OSError as error:
        kind = FaultError if error.errno in FAULTS else PlaceError
        raise kind(f"{what}: cannot be written to: {error.strerror or error}") from error
    try:
        with suppress(OSError):  # a full disc keeps no name, the lock holds all the same
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, f"cyclo {command} (process {os.getpid()})".encode(), 0)
        yield
    finally:
        with suppress(OSError):
            lock.unlink(missing_ok=True)
        os.close(descriptor)


def _take(lock: Path, wait: bool) -> int:
    """Open and lock a file; whoever held it may have removed it meanwhile: then again."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        try:
            _lock(descriptor, wait)
            if os.path.samestat(os.fstat(descriptor), os.stat(lock, follow_symlinks=False)):
                return descriptor
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _lock(descriptor: int, wait: bool) -> None:
    try:
        import fcntl
    except ImportError:  # no such locks on this system: two runs are not kept apart
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        if error.errno not in LOCKLESS:
            raise


def _holder(lock: Path) -> str:
    try:
        text = read_regular(lock, 1000).decode("utf-8", "replace")[:80]
    except OSError:
        text = ""
    return text if text.isprintable() and text.startswith("cyclo ") else "another process"
