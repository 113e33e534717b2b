"""Locks on the folder or file that a run writes: one process at a time, until it ends, however that is.

They are those of the system, by `flock` or on Windows `msvcrt`, which end with their process. The package filelock takes the
same ones but empties the file before it holds it, so the name of the holder would be lost, and gives up on file systems
without locks.
"""

from __future__ import annotations

import errno
import importlib
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
LOCKED_BYTE = 1 << 30
"""Place of the byte that is locked on Windows, where nobody else can read it: far behind the name of the holder."""


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
            os.lseek(descriptor, 0, os.SEEK_SET)
            os.write(descriptor, f"cyclo {command} (process {os.getpid()})".encode())
        yield
    finally:
        if os.name == "nt":  # no open file is removed there, so it stays where somebody has opened it since
            os.close(descriptor)
        with suppress(OSError):
            lock.unlink(missing_ok=True)
        if os.name != "nt":
            os.close(descriptor)


def _take(lock: Path, wait: bool) -> int:
    """Open and lock a file; whoever held it may have removed it meanwhile: then again."""
    while True:
        descriptor = os.open(lock, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        try:
            lock_descriptor(descriptor, wait=wait)
            if os.path.samestat(os.fstat(descriptor), os.stat(lock, follow_symlinks=False)):
                return descriptor
        except FileNotFoundError:
            pass
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def lock_descriptor(descriptor: int, *, wait: bool) -> bool:
    """Lock an open file until it is closed; False where its file system has no locks.

    `BlockingIOError` when another process holds it and is not to be waited for.
    """
    try:
        import fcntl
    except ImportError:
        _lock_byte(descriptor, wait)
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except OSError as error:
        if error.errno not in LOCKLESS:
            raise
        return False
    return True


def _lock_byte(descriptor: int, wait: bool) -> None:
    """Lock one byte of a file as Windows does; it need not be there."""
    msvcrt = importlib.import_module("msvcrt")
    while True:
        os.lseek(descriptor, LOCKED_BYTE, os.SEEK_SET)
        try:
            # LK_LOCK itself tries for ten seconds, then raises.
            msvcrt.locking(descriptor, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
        except OSError as error:
            if error.errno not in (errno.EACCES, errno.EDEADLK):
                raise
            if not wait:
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN)) from error
        else:
            return


def _holder(lock: Path) -> str:
    try:
        text = read_regular(lock, 1000).decode("utf-8", "replace")[:80]
    except OSError:
        text = ""
    return text if text.isprintable() and text.startswith("cyclo ") else "another process"
