"""The folder of a run: one process at a time writes to it, and what it holds comes from one run.

A run keeps a manifest of what it wrote. Before its first file takes its place it removes what the last manifest lists,
so that numbers of one run never lie beside pictures of another. What is not listed, or was changed since, is the user's
and stays: a run that would write where such a file is ends before its work.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath
from typing import Any

from ltca.errors import CycloError, DamagedFileError, PlaceError
from ltca.output.file_names import spelled_alike
from ltca.output.files import PART, told_of_files, whole_file
from ltca.output.locks import held
from ltca.output.regular_files import read_regular, regular_file

MANIFEST = "cyclo-manifest.json"
LOCK = ".cyclo.lock"
PLAN, BATCHES = "study.json", "batches"
"""Of a study, the only run that goes on after an interruption: its plan, and the folder of what is finished."""
FORMAT = 1
LARGEST_MANIFEST = 200_000_000
"""Bytes of a manifest; that of a study whose million samples all failed has 100 MB."""
FOLDERS = ("figures", "samples")
"""Folders of results in the folder of a run."""
ELSEWHERE = "move it, or choose another place"
CHANGED = f"was changed since the last run wrote it (it has not the checksum of {MANIFEST}): {ELSEWHERE}"
NOT_OURS = f"is there and was not written by the last run ({MANIFEST} does not list it): {ELSEWHERE}"


class RunFolder:
    """Manifest and lock of an output folder.

    Parameters
    ----------
    path : Path
        The folder.
    command : str
        Whose it is, for the manifest.
    beside : tuple of str
        Folders in it whose files outlive a run: kept answers, finished batches.
    adding : bool
        Whether files of earlier runs stay.
    renewing : tuple of str
        Names of files of earlier runs that are replaced even where they were changed since.
    origins : mapping of str to str, optional
        What files are made from, as drive and case, by their names.
    """

    def __init__(
        self,
        path: Path,
        command: str,
        beside: tuple[str, ...],
        adding: bool,
        renewing: tuple[str, ...] = (),
        origins: Mapping[str, str] | None = None,
    ) -> None:
        self.path, self.command = path.resolve(), command
        self._beside = {self.path / name for name in beside}
        self._old, self._replaced = _read_manifest(self.path, "files"), _read_manifest(self.path, "replaced")
        self._renewing = renewing
        self._origins, self._old_origins = dict(origins or {}), _read_manifest(self.path, "origins") if adding else {}
        self._files = dict(self._old) if adding else {}
        self._kept: set[str] = set(self._old) if adding else set()
        self._cleared = adding

    def keep(self, *paths: Path) -> None:
        """Take files of an earlier run over into this one, as a resumed study does; only those that its manifest lists."""
        for path in paths:
            name = self._name(path)
            if name in self._old:
                self._kept.add(name)
                self._files[name] = self._old[name]

    def require_whole(self, *paths: Path) -> None:
        """Refuse (`DamagedFileError`) files of the last run that are damaged or missing; only those that its manifest lists."""
        for path in paths:
            known = self._checksums(self._name(path) or "")
            if known and (not path.is_file() or _checksum(path) not in known):
                what = (
                    f"has not the checksum of {MANIFEST}: it was damaged or changed" if path.is_file() else "is missing"
                )
                raise DamagedFileError(f"{path}: {what}; solve it again with --force, or choose another --out")

    def place(self, path: Path, part: Path) -> None:
        """Enter a finished file into the manifest just before it takes its place."""
        name = self._name(path)
        if name is None:
            return
        there = os.path.lexists(path)
        if there and not self._may_be_replaced(path):  # it came while we worked; those before are found at the start
            raise PlaceError(f"{path}: {self._why_not(name)}")
        # Who is killed before the file takes its place leaves the one before: that is not the user's either.
        replaced = {name: _checksum(path)} if there else {}
        self._clear(name)
        self._files[name] = _checksum(part)
        self._write(complete=False, replaced=replaced)

    def discard(self, *paths: Path) -> None:
        """Remove files that this run wrote on its way, in the place of which its results stand."""
        names = {name for name in map(self._name, paths) if name in self._files}
        self._remove(names)
        self._files = {name: checksum for name, checksum in self._files.items() if name not in names}
        self._write(complete=False)

    def finish(self) -> None:
        """Say in the manifest that the run is complete."""
        if self._files:
            self._clear("")
            self._write(complete=True)

    def withdraw(self, *, refused: bool) -> None:
        """Remove what this run has written where it has ended without a result.

        Solved batches of a study stay, for ``--resume``, unless its input was `refused`; a plan alone goes.
        """
        written, batches = set(self._files) - self._kept, self.path / BATCHES
        if batches in self._beside:
            refused = written == {PLAN} and not any(batches.glob("*.npz"))
        if not refused or not written:
            return
        self._remove(written)
        self._files = {name: self._files[name] for name in self._kept}
        if self._files:
            self._write(complete=True)
        else:
            (self.path / MANIFEST).unlink(missing_ok=True)

    def require_room_for(self, writes: Iterable[str], what: str) -> None:
        """Refuse (`PlaceError`) to start where files of the user are in the way of names or patterns in `writes`.

        Nothing is asked for in an empty folder; `what` is the folder as the user gave it, for the message.
        """
        there = {
            path.relative_to(self.path).as_posix(): path
            for folder in (self.path, *(self.path / name for name in FOLDERS))
            for path in sorted(folder.glob("*"))
            if path.name not in (MANIFEST, LOCK)
        }
        patterns = tuple(writes) if there else ()
        patterns += tuple({pattern.rpartition("/")[0] for pattern in patterns} - {""})
        met = [name for name in there if any(fnmatchcase(name, pattern) for pattern in patterns)]
        found = [name for name in met if not self._may_be_replaced(there[name])]
        if found:
            more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
            raise PlaceError(f"{what}: {found[0]}{more} {self._why_not(found[0])}")
        # Where names differ in capitals alone, Windows and macOS would have one file for both, now or after a copy.
        before = {spelled_alike(name): (name, self._old_origins[name]) for name in self._old_origins if name in there}
        for name, origin in self._origins.items():
            other, made = before.get(spelled_alike(name), (name, origin))
            if made != origin:
                where = "" if other == name else f" by {name} on Windows and macOS"
                raise PlaceError(
                    f"{what}: {other} was made from {made}, {origin} would replace it{where}: choose another --out"
                )

    def _may_be_replaced(self, path: Path) -> bool:
        """Tell whether what lies in the folder is as a run wrote it; links never are, for a run writes none."""
        if path.is_symlink():
            return False
        if path.parent == self.path and path.name in FOLDERS:
            return path.is_dir()
        name = self._name(path)
        if name is None or not path.is_file():
            return path.is_file()
        known = self._checksums(name)
        return bool(known) and (name in self._renewing or _checksum(path) in known)

    def _checksums(self, name: str) -> set[str]:
        """What runs wrote under a name: this one, the last one, and the one before where the last was killed."""
        return {files[name] for files in (self._files, self._old, self._replaced) if name in files}

    def _why_not(self, name: str) -> str:
        changed = self._checksums(name) and (self.path / name).is_file() and not (self.path / name).is_symlink()
        return CHANGED if changed else NOT_OURS

    def _name(self, path: Path) -> str | None:
        """Return the name of a file in the manifest; None for one that is kept beside the results or lies elsewhere."""
        place = path.parent.resolve() / path.name
        if not place.is_relative_to(self.path) or any(place.is_relative_to(folder) for folder in self._beside):
            return None
        return None if place.name == MANIFEST and place.parent == self.path else place.relative_to(self.path).as_posix()

    def _clear(self, name: str) -> None:
        """Remove what the last run wrote and nobody changed since, but for the file that is replaced right now."""
        if self._cleared:
            return
        self._remove(set(self._old) - self._kept - {name})
        self._cleared = True

    def _remove(self, names: set[str]) -> None:
        """Remove files that are as a run wrote them, with folders that are empty then."""
        for name in sorted(names):
            place = self.path / name
            if place.is_file() and not place.is_symlink() and _checksum(place) in self._checksums(name):
                place.unlink()
                if place.parent != self.path:
                    with suppress(OSError):  # the folder stays while anything is in it
                        place.parent.rmdir()

    def _write(self, *, complete: bool, replaced: Mapping[str, str] | None = None) -> None:
        content: dict[str, Any] = {
            "cyclo": FORMAT,
            "command": self.command,
            "complete": complete,
            "files": dict(sorted(self._files.items())),
        }
        if replaced:
            content["replaced"] = dict(replaced)
        known = self._old_origins | self._origins
        if origins := {name: known[name] for name in content["files"] if name in known}:
            content["origins"] = origins
        with whole_file(self.path / MANIFEST) as part:
            part.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n")


def figure_files(kind: str | None, *names: str) -> list[str]:
    """Return the files of figures, for ``writes`` of `claimed_folder`; none where `kind` is None.

    Examples
    --------
    >>> figure_files("svg", "search")
    ['figures/search.svg']
    """
    return [] if kind is None else [f"figures/{name}.{kind}" for name in names]


def require_folder(path: Path) -> None:
    """Refuse (`PlaceError`) a file in the place of the folder that ``--out`` gives, which need not be there yet, and a root."""
    if path.exists() and not path.is_dir():
        raise PlaceError(f"--out {path}: is a file, not a folder")
    place = path.resolve()
    if place == place.parent:
        raise PlaceError(f"--out {path}: is the root of a file system, must be a folder below it")


def _require_no_interrupted_study(path: Path) -> None:
    """Refuse a folder with an interrupted study: without its plan, a file of the last run, its batches are useless."""
    if (path / PLAN).exists() and any((path / BATCHES).glob("*.npz")):
        raise PlaceError(
            f"--out {path}: holds an interrupted study; continue it with --resume, or choose another --out"
        )


@contextmanager
def claimed_folder(
    path: Path,
    command: str,
    *,
    writes: Iterable[str] = (),
    beside: tuple[str, ...] = (),
    adding: bool = False,
    renewing: tuple[str, ...] = (),
    origins: Mapping[str, str] | None = None,
) -> Iterator[RunFolder]:
    """Hold a folder, which is made, while a command writes to it.

    Every file of `ltca.output.files.whole_file` is entered into its manifest.

    Parameters
    ----------
    path : Path
        The folder.
    command : str
        Name of the command, for manifest and messages.
    writes : iterable of str
        Names, or patterns of names, of all files that may be written: where the user has one of them nothing starts.
    beside : tuple of str
        Folders in it whose files outlive a run.
    adding : bool
        Whether files are added to those of earlier runs, which are otherwise replaced.
    renewing : tuple of str
        Names of files of earlier runs that are replaced even where they were changed since.
    origins : mapping of str to str, optional
        What files are made from, as drive and case, by their names: a file of another origin is not replaced.

    Raises
    ------
    PlaceError
        When another process holds it, it cannot be made or written to, a file of the user is in the way, or it holds an
        interrupted study and this is none.
    FaultError
        When the disc is full or fails.
    """
    require_folder(path)
    for name in beside:
        if os.path.lexists(path / name) and not (path / name).is_dir():
            raise PlaceError(f"--out {path}: {name} is a file in the place of a folder: {ELSEWHERE}")
    with held(path / LOCK, f"--out {path}", command):
        if BATCHES not in beside:
            _require_no_interrupted_study(path)
        _remove_parts(path, beside)
        folder = RunFolder(path, command, beside, adding, renewing, origins)
        folder.require_room_for(writes, f"--out {path}")
        with told_of_files(path, folder.place):
            try:
                yield folder
            except CycloError as error:
                folder.withdraw(refused=error.exit_status == 2 and not isinstance(error, PlaceError))
                raise
            folder.finish()


def _read_manifest(folder: Path, key: str) -> dict[str, str]:
    """Return files that the last run lists, by name with checksum; nothing where the manifest is damaged or not ours."""
    try:
        content: Any = json.loads(read_regular(folder / MANIFEST, LARGEST_MANIFEST).decode())
        files = dict(content.get(key, {})) if content["cyclo"] == FORMAT else {}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}
    return {name: checksum for name, checksum in files.items() if _ours(folder, name) and isinstance(checksum, str)}


def _ours(folder: Path, name: object) -> bool:
    """Tell whether a name in a manifest is that of a file below the folder, reached by no link."""
    if not isinstance(name, str) or not name or "\0" in name or "\\" in name:
        return False
    parts = PurePosixPath(name).parts
    if PurePosixPath(name).is_absolute() or ".." in parts:
        return False
    return (folder / name).parent.resolve() == (folder.resolve() / name).parent


def _checksum(path: Path) -> str:
    """Return the checksum of a file; of one that cannot be read, which no manifest lists, it is empty."""
    try:
        with regular_file(path) as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except PermissionError:
        return ""


def _remove_parts(folder: Path, beside: tuple[str, ...]) -> None:
    """Remove what a killed run left half-written: the lock is held, so nobody writes to it."""
    patterns = [".*.part*", *(f"{name}/.*.part*" for name in FOLDERS)]
    patterns += [f"{name}/{below}.*.part*" for name in beside for below in ("", "*/")]
    for path in (path for pattern in patterns for path in folder.glob(pattern)):
        if PART.fullmatch(path.name) and not path.is_symlink():
            with suppress(OSError):
                path.unlink()
