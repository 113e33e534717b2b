"""Files that are either whole or not there: written beside their place, then moved into it."""

from __future__ import annotations

import errno
import json
import os
import re
import secrets
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from ltca.errors import FaultError, PlaceError

PART = re.compile(r"\..*\.[0-9a-f]{16}\.part(\.[^.]*)?")
"""Names of files that are being written."""

STALE = 86400.0
"""Age, s, beyond which nobody writes a part any more."""

UNUSABLE = (
    errno.ENOENT, errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.EISDIR, errno.ELOOP,
    errno.EINVAL, errno.ENAMETOOLONG,
)  # fmt: skip
"""What a folder answers in which no file can be made: another one is to be chosen, nothing has failed."""

PAUSES = (0.05, 0.1, 0.2, 0.4)
"""Times, s, between trials to replace a file on Windows."""

Placed = Callable[[Path, Path], None]
_HELD: ContextVar[tuple[Path, Placed] | None] = ContextVar("held", default=None)


@contextmanager
def told_of_files(folder: Path, placed: Placed) -> Iterator[None]:
    """Call `placed` with the place and the finished part of every file before it takes its place, while the block runs."""
    token = _HELD.set((folder.resolve(), placed))
    try:
        yield
    finally:
        _HELD.reset(token)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary name to write to; the file takes its place only when the block ends without an exception.

    The name is in the same folder, which is made, and has the same suffix. Raises `PlaceError` when no file can be made there,
    `FaultError` when it cannot be written.
    """
    part = path.with_name(f".{path.stem}.{secrets.token_hex(8)}.part{path.suffix}")
    opened = False
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        held = _HELD.get()
        if held is None or not path.parent.resolve().is_relative_to(held[0]):
            remove_parts_of(path, STALE)
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY | getattr(os, "O_NOFOLLOW", 0), 0o666))
        opened = True
        yield part
        if held is not None:
            held[1](path, part)
        _move(part, path)
    except OSError as error:
        folder_in_the_way = error.errno == errno.EEXIST and not path.parent.is_dir()
        wrong_place = not opened and (error.errno in UNUSABLE or folder_in_the_way)
        kind = PlaceError if wrong_place else FaultError
        raise kind(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):  # without a folder there is nothing to take away either
            part.unlink(missing_ok=True)


def _move(part: Path, path: Path) -> None:
    """Let a part take its place; on Windows others keep a file for a moment, such as scanners for viruses."""
    for pause in PAUSES if os.name == "nt" else ():
        try:
            part.replace(path)
        except PermissionError:
            time.sleep(pause)
        else:
            return
    part.replace(path)


def remove_parts_of(path: Path, age: float) -> None:
    """Remove parts of a file left by killed programs, at least `age` seconds old; 0 for the holder of a lock on the file."""
    head, now = f".{path.stem}.", time.time()
    with os.scandir(path.parent) as entries:
        for entry in entries:
            if entry.name.startswith(head) and PART.fullmatch(entry.name):
                with suppress(OSError):
                    if now - entry.stat(follow_symlinks=False).st_mtime >= age:
                        os.unlink(entry.path)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file, whole or not at all; numbers must be finite."""
    with whole_file(path) as part:
        part.write_text(
            json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8", newline="\n"
        )
