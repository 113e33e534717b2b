"""Files of arrays with a checksum, with which interrupted work goes on: batches of studies, checkpoints of runs in time.

They are numpy's archives. A damaged file is found out before any of its numbers are used; nothing in it is executed.
"""

from __future__ import annotations

import hashlib
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ltca.errors import DamagedFileError, one_line
from ltca.output.files import whole_file
from ltca.output.regular_files import regular_file

CHECKSUM = "checksum"
LARGEST = 1 << 31
"""Bytes that no such file has."""
# What numpy and zip raise on files that are cut off, foreign, encrypted or declare what no memory holds.
DAMAGE = (
    OSError, ValueError, KeyError, TypeError, EOFError, OverflowError, MemoryError, NotImplementedError, RuntimeError,
    SyntaxError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip


def write_arrays(path: Path, arrays: Mapping[str, ArrayLike]) -> None:
    """Write arrays of numbers or texts by name, with their checksum, whole or not at all."""
    kept: dict[str, Any] = {name: np.asarray(values) for name, values in arrays.items()}
    kept[CHECKSUM] = np.array(_checksum(kept))
    with whole_file(path) as part, part.open("wb") as stream:
        np.savez(stream, **kept)


def read_arrays(path: Path, what: str) -> dict[str, NDArray[Any]]:
    """Read the arrays of a file of `write_arrays`.

    Parameters
    ----------
    path : Path
        The file.
    what : str
        Its kind in words, for messages: "a batch of a study".

    Returns
    -------
    dict of str to array
        By name, without the checksum.

    Raises
    ------
    DamagedFileError
        Where the file cannot be read, is cut off, declares more than `LARGEST` bytes or does not match its checksum.
    """
    try:
        # Opened here: of a file that is no archive numpy leaves its own stream open.
        with regular_file(path, LARGEST) as stream, zipfile.ZipFile(stream) as archive:
            declared = sum(entry.file_size for entry in archive.infolist())
        if declared > LARGEST:
            raise DamagedFileError(f"{path}: declares {declared:,} bytes, which {what} has not")
        with regular_file(path, LARGEST) as stream, np.load(stream, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        stated = str(arrays.pop(CHECKSUM))
    except DAMAGE as error:
        raise DamagedFileError(f"{path}: cannot be read as {what}: {one_line(error)}") from error
    if stated != _checksum(arrays):
        raise DamagedFileError(f"{path}: is damaged (checksum)")
    return arrays


def _checksum(arrays: Mapping[str, NDArray[Any]]) -> str:
    digest = hashlib.sha256()
    for name, values in sorted(arrays.items()):
        digest.update(f"{name} {values.shape} {values.dtype.str} ".encode("utf-8", "backslashreplace"))
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()
