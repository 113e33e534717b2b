"""Pieces of a long derivation, kept in a folder until all of it is done: what was interrupted goes on where it stood."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ltca.arrays import FloatArray
from ltca.output.files import whole_file

KEY = "key"


@dataclass(frozen=True, slots=True, kw_only=True)
class Pieces:
    """Arrays by name, each computed once.

    Attributes
    ----------
    folder : Path or None
        Where they are kept; None keeps nothing.
    key : str
        Of all that they depend on: pieces of another key are computed again.
    """

    folder: Path | None
    key: str

    def get(self, name: str, compute: Callable[[], dict[str, FloatArray]]) -> dict[str, FloatArray]:
        """Return the arrays of a name: those kept under the same key, else computed and kept."""
        if self.folder is None:
            return compute()
        path = self.folder / f"{name}.npz"
        # What cannot be read, cut short or of somebody else, is computed again and replaced.
        with suppress(OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile), np.load(path) as kept:
            if str(kept[KEY]) == self.key:
                return {entry: np.asarray(kept[entry]) for entry in kept.files if entry != KEY}
        found = compute()
        self.folder.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as part, part.open("wb") as file:
            np.savez(file, **found, **{KEY: np.array(self.key)})
        return found


def pieces_folder(target: Path) -> Path:
    """Return the folder beside a file in which the pieces of its derivation are kept."""
    return target.with_name(f"{target.name}.pieces")


def forget_pieces(target: Path) -> None:
    """Remove the pieces of a file that is there."""
    shutil.rmtree(pieces_folder(target), ignore_errors=True)
