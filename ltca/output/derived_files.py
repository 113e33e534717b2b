"""Where files are kept that are derived once: in the user's cache, or where that cannot be written in a folder of this run."""

from __future__ import annotations

import atexit
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from ltca.errors import DamagedFileError, PlaceError
from ltca.output.provenance import cache_home, code_hash, code_version

Content = TypeVar("Content")
INSTEAD = "CYCLO_TEMPORARY_CACHE"
"""Variable that names a cache that cannot be written and, on a line of its own, the folder of this run instead of it."""
LEAST_CACHE_ROOM = 1 << 20
"""Least free space of a folder that is used as cache, bytes."""


def kept_file(name: str) -> Path:
    """Return where a derived file of a name is kept, or would be; PlaceError where a folder stands there."""
    new, kept = (folder / name for folder in (cache_folder(), _kept_folder()))
    for path in (new, kept):
        if path.is_dir():
            raise PlaceError(f"{path}: is a folder in the place of a file that is derived and kept: remove it")
    return kept if kept.exists() and not new.exists() else new


def cache_folder() -> Path:
    """Return where new coefficients are kept."""
    kept = _kept_folder()
    of, _, instead = os.environ.get(INSTEAD, "").partition("\n")
    return Path(instead) if instead and of == str(kept) else kept


def _kept_folder() -> Path:
    return cache_home() / f"{code_version()}-{code_hash('ltca', 'fem')}"


def require_cache() -> None:
    """Make sure, before anything is derived, that it can be kept; in a temporary folder of this run if need be, with a word."""
    folder = _kept_folder()
    if cache_folder() != folder:
        return
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(LEAST_CACHE_ROOM))
            probe.flush()
    except OSError as error:
        print(
            f"warning: {folder}: cannot be written ({error.strerror or error}): what is derived is used but not kept; "
            "XDG_CACHE_HOME names another place",
            file=sys.stderr,
        )
        instead = tempfile.mkdtemp(prefix="cyclo-cache-")
        # The workers of this run inherit it and find there what has been derived.
        os.environ[INSTEAD] = f"{folder}\n{instead}"
        atexit.register(_forget, instead, os.getpid())


def _forget(folder: str, process: int) -> None:
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def read_kept(name: str, read: Callable[[Path], Content]) -> Content | None:
    """Return what a derived file in the cache holds; None where there is none, or a damaged one, which is made again."""
    path = kept_file(name)
    if not path.exists():
        return None
    try:
        return read(path)
    except DamagedFileError as error:
        print(f"warning: {error}; derived again", file=sys.stderr)
        with suppress(OSError):
            path.unlink()
        return None
