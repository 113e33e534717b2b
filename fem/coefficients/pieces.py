"""Pieces of a long derivation, kept in the cache until all of it is done: what was interrupted goes on where it stood."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ltca.arrays import FloatArray
from ltca.errors import DamagedFileError, FaultError, PlaceError
from ltca.output.checked_arrays import read_arrays, write_arrays
from ltca.output.provenance import cache_home


@dataclass(frozen=True, slots=True, kw_only=True)
class Pieces:
    """Arrays by name, each computed once.

    Attributes
    ----------
    folder : Path or None
        Where they are kept, one for all that they depend on; None where there is no place to keep anything.
    """

    folder: Path | None

    @classmethod
    def of_key(cls, key: str) -> Pieces:
        """Return the pieces of a derivation, which the key tells from all others, in the cache."""
        try:
            home = cache_home()
        except RuntimeError:  # no home of the user's
            return cls(folder=None)
        return cls(folder=home / f"pieces-{hashlib.sha256(key.encode()).hexdigest()[:16]}")

    def get(self, name: str, compute: Callable[[], FloatArray]) -> FloatArray:
        """Return the array of a name: the one that is kept, else computed and, where the cache can be written, kept."""
        if self.folder is None:
            return compute()
        path = self.folder / f"{name}.npz"
        # What is damaged, cut short or of somebody else, is computed again and replaced.
        with suppress(DamagedFileError, KeyError):
            return np.asarray(read_arrays(path, "a piece of a derivation")["values"])
        found = compute()
        with suppress(FaultError, PlaceError):
            write_arrays(path, {"values": found})
        return found

    def forget(self) -> None:
        """Remove what is kept."""
        if self.folder is not None:
            shutil.rmtree(self.folder, ignore_errors=True)
