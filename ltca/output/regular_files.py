"""Reading of files: only regular ones of bounded size are opened.

A pipe nobody writes to would be waited for without end, a device such as ``/dev/zero`` read without end.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path

KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
    stat.S_IFDIR: "a folder",
}
"""What lies where a file should."""


class NotReadableError(OSError):
    """A file is not one that is read; ``strerror`` says why."""


@contextmanager
def regular_file(path: Path, largest: int | None = None) -> Iterator[BufferedReader]:
    """Open a regular file, links followed, for reading bytes; every reader of the program opens its files here.

    Raises `OSError`, whose ``strerror`` says why, when there is none, when it is a pipe, a device, a socket or a folder, or when
    it has more than `largest` bytes.
    """
    # Not blocking: to open a pipe for reading waits for somebody who writes. On regular files it has no effect.
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except PermissionError:
        if path.is_dir():  # which Windows does not open
            raise NotReadableError(errno.EINVAL, f"not a regular file but {KINDS[stat.S_IFDIR]}", str(path)) from None
        raise
    try:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode):
            kind = KINDS.get(stat.S_IFMT(found.st_mode), "something else")
            raise NotReadableError(errno.EINVAL, f"not a regular file but {kind}", str(path))
        if largest is not None and found.st_size > largest:
            told = f"it has {found.st_size / 1e6:,.0f} MB, such files have at most {largest / 1e6:,.0f} MB"
            raise NotReadableError(errno.EFBIG, told, str(path))
        with os.fdopen(descriptor, "rb", closefd=False) as stream:
            yield stream
    finally:
        os.close(descriptor)


def read_regular(path: Path, largest: int) -> bytes:
    """Return the content of a regular file; see `regular_file`. A file that grows meanwhile is cut at `largest` bytes."""
    with regular_file(path, largest) as stream:
        return stream.read(largest)
