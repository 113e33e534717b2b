"""Commands in the background: exports, finite elements, coefficients and tolerance studies of what a page has."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ltca.drive.names import NAMING, names_a_file
from ltca.errors import CycloError, DriveError, FaultError, printable, shortened
from ltca.output.file_names import file_word
from ltca.output.files import whole_file
from ltca.output.processes import Supervised
from ltca.output.terminal import shell_words
from ltca.reading.toml_edit import tables_of, with_values
from ltca.studio.sections import listed, measured_files

MOST_RUNNING = 2
"""Jobs at a time: each of them takes a processor."""
MOST_SAMPLES = 100_000
LAST_LINES = 12
"""Of the output, which a page shows."""
MOST_FILES = 60
LOG = "output.txt"
DONE_OF = re.compile(r": ([0-9]+) of (?:at most )?([0-9]+)(?:, .*)? \([0-9]+ s\)$")
"""What a command says every few seconds of how far it is (`ltca.output.progress`)."""


@cache
def exports() -> dict[str, list[str]]:
    """Return what ``cyclo export`` offers: ``formats``, ``parts`` and the ``simulators`` of ``--for``."""
    parser = argparse.ArgumentParser()
    found: dict[str, list[str]] = {"formats": [], "parts": [], "simulators": []}
    for entry in entry_points(group="cyclo.commands", name="export"):
        entry.load().configure(parser)
        for name, option in (("formats", "--format"), ("parts", "--part"), ("simulators", "--for")):
            action = parser._option_string_actions.get(option)
            found[name] = [str(one) for one in (action.choices or ())] if action is not None else []
    return found


def job_words(asked: Mapping[str, Any]) -> list[str]:
    """Return the words of the command behind ``cyclo``, without drive, case and folder.

    Raises
    ------
    DriveError
        For a kind or an option that is not among the known ones.
    """
    kind = asked.get("kind")
    if kind in ("fem", "derive"):
        return [str(kind)]
    if kind == "tolerance":
        samples = asked.get("samples", 0)
        if isinstance(samples, bool) or not isinstance(samples, int) or not 1 <= samples <= MOST_SAMPLES:
            told = f"must be a whole number from 1 to {MOST_SAMPLES}"
            raise DriveError([f"samples = {shortened(samples)}: {told}"])
        return ["tolerance", "--samples", str(samples)]
    if kind == "export":
        return ["export", "--format", _one_of(asked, "format", "formats"), "--part", _one_of(asked, "part", "parts")]
    if kind == "simulator":
        return ["export", "--for", _one_of(asked, "simulator", "simulators")]
    raise DriveError([f"kind = {shortened(kind)}: must be fem, derive, tolerance, export or simulator"])


def _one_of(asked: Mapping[str, Any], name: str, known: str) -> str:
    value, choices = asked.get(name), exports()[known]
    if value not in choices:
        raise DriveError(
            [f"{name} = {shortened(value)}: must be one of {', '.join(choices) or 'none that is installed'}"]
        )
    return str(value)


@dataclass(kw_only=True)
class Job:
    """A command that runs or has run.

    Attributes
    ----------
    number : int
        Counted from 1.
    words : list of str
        Behind ``cyclo``.
    folder : Path
        Its drive file, output and results.
    began : float
        When, s on the monotonic clock.
    took : float or None
        Time, s; None while it runs.
    status : int or None
        What it ended with; None while it runs.
    cancelled : bool
        Whether it was to end.
    program : Supervised or None
        The process; None before it is started.
    """

    number: int
    words: list[str]
    folder: Path
    began: float = field(default_factory=time.monotonic)
    took: float | None = None
    status: int | None = None
    cancelled: bool = False
    program: Supervised | None = None


class Jobs:
    """The jobs of a studio, which end with it.

    Parameters
    ----------
    folder : Path
        That the studio was started in.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._jobs: list[Job] = []
        self._lock = threading.Lock()

    def start(self, asked: Mapping[str, Any], text: str, source: str, case: str) -> int:
        """Start a job on the text of a drive file; return its number.

        Raises
        ------
        DriveError
            For options that are not known, a name that cannot name a file, or too many jobs.
        FaultError
            When its folder cannot be made or no process be started.
        """
        words = job_words(asked)
        table = tables_of(text)
        name = str(table.get("name", Path(source).stem))
        if not names_a_file(name):
            raise DriveError([f"name = {shortened(name)}: {NAMING}"])
        with self._lock:
            if sum(job.status is None for job in self._jobs) >= MOST_RUNNING:
                raise DriveError([f"{MOST_RUNNING} jobs run already: cancel one, or wait until it is done"])
            folder = self._new_folder(name)
            drive = folder / f"{file_word(name)}.toml"
            with whole_file(drive) as part:
                part.write_text(_from_elsewhere(text, table, self.folder / source), encoding="utf-8", newline="\n")
            words += _drive_words(words[0], drive.relative_to(self.folder).as_posix(), folder.relative_to(self.folder))
            names = [one.get("name") for one in listed(table.get("case"))]
            words += [f"--case={case}"] if case in names else []  # in one word: a case may be called --debug
            job = Job(number=len(self._jobs) + 1, words=words, folder=folder)
            self._jobs.append(job)
        threading.Thread(target=self._run, args=(job,), daemon=True, name=f"job {job.number}").start()
        return job.number

    def _new_folder(self, name: str) -> Path:
        above = self.folder / "out" / f"{file_word(name)}_studio"
        try:
            # Before anything is made: "out" may be a link to elsewhere.
            if not above.resolve().is_relative_to(self.folder):
                raise DriveError([f"{above}: leads out of the folder of the studio"])
            above.mkdir(parents=True, exist_ok=True)
            number = 1 + max((int(one.name) for one in above.iterdir() if one.name.isdecimal()), default=0)
            (above / str(number)).mkdir()
        except (OSError, RuntimeError) as error:  # RuntimeError: links in a circle, before Python 3.13
            raise FaultError(f"{above}: cannot be made: {getattr(error, 'strerror', None) or error}") from error
        return above / str(number)

    def _run(self, job: Job) -> None:
        words = [sys.executable, "-m", "ltca.commands.program", *job.words]
        with TemporaryDirectory(prefix="cyclo-job-", ignore_cleanup_errors=True) as place:
            try:
                with (job.folder / LOG).open("wb") as log:
                    # A page is UTF-8, whatever the locale.
                    environment = {**os.environ, "PYTHONIOENCODING": "utf-8"}
                    options = {"cwd": self.folder, "stdout": log, "stderr": subprocess.STDOUT, "env": environment}
                    job.program = Supervised(words, Path(place), options)
                    if job.cancelled:
                        job.program.end()
                    status = job.program.wait()
                    job.program.end()  # of its pipe
            except OSError as error:
                (job.folder / LOG).write_text(f"cyclo: error: {error}\n", encoding="utf-8", newline="\n")
                status = CycloError.exit_status
        job.took = time.monotonic() - job.began
        job.status = status

    def cancel(self, number: int) -> bool:
        """End a job; False when there is none of that number that runs."""
        job = next((one for one in self._jobs if one.number == number and one.status is None), None)
        if job is None:
            return False
        job.cancelled = True
        if job.program is not None:
            threading.Thread(target=job.program.end, daemon=True).start()
        return True

    def close(self) -> None:
        """End all jobs."""
        for job in self._jobs:
            if job.status is None and job.program is not None:
                job.cancelled = True
                job.program.end()

    def told(self) -> list[dict[str, Any]]:
        """Return what a page shows of every job, the last one first."""
        return [self._told(job) for job in reversed(self._jobs)]

    def _told(self, job: Job) -> dict[str, Any]:
        state = (
            "running"
            if job.status is None
            else "cancelled"
            if job.cancelled
            else "done"
            if job.status == 0
            else "failed"
        )
        if state == "failed" and job.status == 1 and any(job.folder.rglob("report.html")):
            state = "done, a check fails"
        lines = _last_lines(job.folder / LOG)
        return {
            "number": job.number,
            "command": f"cyclo {shell_words(job.words)}",
            "state": state,
            "seconds": round(time.monotonic() - job.began if job.took is None else job.took),
            "lines": lines,
            "done": _done(lines) if state == "running" else [],
            "files": [] if state == "running" else [*self._files(job)],
        }

    def _files(self, job: Job) -> Iterator[str]:
        found = sorted(one for one in job.folder.rglob("*") if one.is_file() and not one.name.startswith("."))
        shown = sorted(found, key=lambda one: one.suffix != ".html")[:MOST_FILES]
        yield from (one.relative_to(self.folder).as_posix() for one in shown)

    def file(self, path: str) -> Path | None:
        """Return a file that a job wrote, by its path in the folder of the studio; None for any other."""
        try:
            found = (self.folder / path).resolve()
            inside = any(found.is_relative_to(job.folder.resolve()) for job in self._jobs)
            return found if inside and found.is_relative_to(self.folder) and found.is_file() else None
        except (OSError, RuntimeError, ValueError):  # RuntimeError: links in a circle, before Python 3.13
            return None


def _drive_words(command: str, drive: str, folder: Path) -> Sequence[str]:
    out = folder / "results"
    return [drive, "--out", (out / "coefficients.nc" if command == "derive" else out).as_posix()]


def _from_elsewhere(text: str, table: Mapping[str, Any], source: Path) -> str:
    """The text for a file in another folder: measured flanks are named by their whole paths."""
    named = {path: json.dumps(str(source.parent / name), ensure_ascii=False) for path, name in measured_files(table)}
    return with_values(text, named)


def _done(lines: Sequence[str]) -> list[int]:
    """How many parts are done, of how many, by the last line that says so; nothing where none does."""
    found = next((match for line in reversed(lines) if (match := DONE_OF.search(line))), None)
    return [] if found is None else [int(found[1]), int(found[2])]


def _last_lines(path: Path) -> list[str]:
    try:
        with path.open("rb") as file:
            file.seek(0, 2)
            file.seek(max(0, file.tell() - 8000))
            text = file.read().decode("utf-8", "replace")
    except OSError:
        return []
    return [printable(line) for line in text.splitlines()[-LAST_LINES:]]
