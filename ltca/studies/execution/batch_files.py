"""Files of finished batches: each says whose it is and carries a checksum; nothing in them is executed."""

from __future__ import annotations

import hashlib
import re
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ltca.errors import DamagedFileError, one_line
from ltca.output.files import whole_file
from ltca.output.regular_files import regular_file
from ltca.studies.study import BatchResult, Study

NAME = re.compile(r"[0-9]{8}\.npz")
PARTS = ("number", "factors", "values", "messages", "fingerprint", "checksum")
# What numpy and zip raise on files that are cut off, foreign, encrypted or declare what no memory holds.
DAMAGE = (
    OSError, ValueError, KeyError, TypeError, EOFError, OverflowError, MemoryError, NotImplementedError, RuntimeError,
    zipfile.BadZipFile, zlib.error,
)  # fmt: skip
LARGEST = 1 << 31
"""Bytes that no batch has."""


def batch_files(folder: Path) -> Iterator[Path]:
    """Yield the files of batches in a folder, by number; none when it is not there."""
    if folder.is_dir():
        yield from sorted(path for path in folder.iterdir() if NAME.fullmatch(path.name))


def write_batch(path: Path, study: Study, result: BatchResult) -> None:
    """Write one batch, whole or not at all."""
    fingerprint = study.fingerprint()  # once: it reads the coefficient files of the engine
    messages = np.array(result.messages, dtype=str)
    with whole_file(path) as part, part.open("wb") as stream:
        np.savez(
            stream,
            number=np.array(result.number),
            factors=result.factors,
            values=result.values,
            messages=messages,
            fingerprint=np.array(fingerprint),
            checksum=np.array(_checksum(result, fingerprint)),
        )


def read_batch(path: Path, study: Study) -> BatchResult:
    """Read one batch of a study.

    Parameters
    ----------
    path : Path
        Its file.
    study : Study
        Whose it must be.

    Returns
    -------
    BatchResult

    Raises
    ------
    DamagedFileError
        When it is damaged, belongs to another study or to another number.
    """
    try:
        # Opened here: of a file that is no archive numpy leaves its own stream open.
        with regular_file(path, LARGEST) as stream, zipfile.ZipFile(stream) as archive:
            declared = sum(entry.file_size for entry in archive.infolist())
        if declared > LARGEST:
            raise DamagedFileError(f"{path}: declares {declared:,} bytes, which no batch has")
        with regular_file(path, LARGEST) as stream, np.load(stream, allow_pickle=False) as stored:
            found = {name: stored[name] for name in PARTS}
        result = BatchResult(
            number=int(found["number"]),
            factors=found["factors"],
            values=found["values"],
            messages=tuple(str(text) for text in found["messages"].tolist()),
        )
    except DAMAGE as error:
        raise DamagedFileError(f"{path}: cannot be read as a batch of a study: {one_line(error)}") from error
    fingerprint = study.fingerprint()
    if str(found["fingerprint"]) != fingerprint:
        raise DamagedFileError(f"{path}: belongs to another study")
    if str(found["checksum"]) != _checksum(result, fingerprint):
        raise DamagedFileError(f"{path}: is damaged (checksum)")
    if f"{result.number:08d}" != path.stem or not 0 <= result.number < study.batches:
        raise DamagedFileError(f"{path}: is batch {result.number} of the study")
    first, last = study.samples_of(result.number)
    if not len(result.factors) == len(result.values) == len(result.messages) == last - first:
        raise DamagedFileError(f"{path}: has not the {last - first} samples of its number")
    return result


def _checksum(result: BatchResult, fingerprint: str) -> str:
    digest = hashlib.sha256(f"{fingerprint} {result.number}".encode())
    for values in (result.factors, result.values):
        digest.update(f"{values.shape} {values.dtype.str}".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    digest.update("\0".join(result.messages).encode())
    return digest.hexdigest()
