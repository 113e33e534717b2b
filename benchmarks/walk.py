"""Path of a drive through the code: files in the order in which functions that take the drive are first called.

    python benchmarks/walk.py [analyse|run|study] [--files]

Every function of the packages is counted once, when it is first called with a `Drive` or a collection of drives. A stay is a
sequence of such calls within one file; a return is a stay in a file that was left before. Methods and properties of the drive
itself and cached calls are not counted. The path of an analysis begins at `ltca.analyse`, those of a run and of a study at the
command line.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import ltca
from ltca.commands.program import main as cyclo
from ltca.drive.parts import Drive
from ltca.reading.drive_file import load_drive

ROOT = Path(__file__).resolve().parents[1]
PAPER = load_drive("paper").cases["CS-1"]
PACKAGES = tuple(str(ROOT / name) for name in ("ltca", "fem", "validation"))


def of_an_analysis() -> None:
    """Analyse one case through the façade."""
    ltca.analyse(PAPER, 4)


def of_a_run() -> None:
    """Run all cases of a drive without the page."""
    with tempfile.TemporaryDirectory() as folder:
        cyclo(["run", "paper", "--positions", "4", "--no-page", "--out", f"{folder}/out"])


def of_a_study() -> None:
    """Solve a tolerance study of a few samples in this process."""
    with tempfile.TemporaryDirectory() as folder:
        asked = ["tolerance", "paper", "--case", "CS-6", "--samples", "4", "--positions", "17", "--no-figures"]
        cyclo([*asked, "--out", f"{folder}/out"])


ENTRIES: dict[str, Callable[[], None]] = {"analyse": of_an_analysis, "run": of_a_run, "study": of_a_study}


def holds_a_drive(value: Any) -> bool:
    """Return whether an argument is a drive or a collection of drives."""
    if isinstance(value, Drive):
        return True
    if isinstance(value, dict):
        return any(isinstance(item, Drive) for item in list(value.values())[:1])
    return isinstance(value, list | tuple) and any(isinstance(item, Drive) for item in value[:1])


def visits(work: Callable[[], None]) -> list[str]:
    """Return the files of all functions called with a drive, in the order of their first calls."""
    seen: set[CodeType] = set()
    files: list[str] = []

    def watch(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        if event != "call" or code in seen or not code.co_filename.startswith(PACKAGES):
            return
        given = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        if given[:1] == ("self",):
            given = given[1:]
        if any(holds_a_drive(frame.f_locals.get(name)) for name in given):
            seen.add(code)
            files.append(str(Path(code.co_filename).relative_to(ROOT)))

    sys.setprofile(watch)
    try:
        work()
    finally:
        sys.setprofile(None)
    return files


def stays_of(files: list[str]) -> list[str]:
    """Return the sequence of files, with consecutive duplicates removed."""
    return [name for place, name in enumerate(files) if place == 0 or files[place - 1] != name]


def main() -> None:
    """Print stays and returns."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("entry", nargs="?", choices=[*ENTRIES], help="which path; default all")
    parser.add_argument("--files", action="store_true", help="print the files")
    arguments = parser.parse_args()
    for name in [arguments.entry] if arguments.entry else ENTRIES:
        stays = stays_of(visits(ENTRIES[name]))
        returns = len(stays) - len(set(stays))
        print(f"{name}: {len(stays)} stays in {len(set(stays))} files, {returns} returns")
        if arguments.files:
            print("\n".join(f"  {number + 1:3} {stay}" for number, stay in enumerate(stays)))


if __name__ == "__main__":
    main()
