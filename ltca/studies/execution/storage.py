"""The folder of a study: its plan and finished batches while it runs, then one dataset and one table.

Each file is whole or not there. A batch says whose it is and carries a checksum; nothing in it is executed.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ltca.errors import CycloError, DamagedFileError, one_line
from ltca.output.checked_arrays import DAMAGE, read_arrays, write_arrays
from ltca.output.files import whole_file, write_json
from ltca.output.provenance import code_version
from ltca.output.regular_files import read_regular
from ltca.output.run_folder import BATCHES, PLAN
from ltca.studies.study import BatchResult, Study
from ltca.studies.study_results import CHUNK, Failures, write_results

WHAT_DIFFERS = "drive, tolerances, samples, positions, seed, quantities, compliance, coefficients or the code differ"
LARGEST_PLAN = 1_000_000
"""Bytes of a plan, which has five short entries."""
BATCH_NAME = re.compile(r"[0-9]{8}\.npz")
PARTS = ("number", "factors", "values", "messages", "fingerprint")


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFolder:
    """The folder of a study.

    Attributes
    ----------
    path : Path
        ``--out``.
    """

    path: Path

    @property
    def results(self) -> Path:
        """The final dataset."""
        return self.path / "results.nc"

    @property
    def table(self) -> Path:
        """The final table."""
        return self.path / "results.parquet"

    @property
    def files(self) -> tuple[Path, ...]:
        """Plan, dataset and table, with which a finished study goes on."""
        return self._plan, self.results, self.table

    @property
    def _batches(self) -> Path:
        return self.path / BATCHES

    @property
    def _plan(self) -> Path:
        return self.path / PLAN

    def has_batches(self) -> bool:
        """Tell whether there are finished batches of an interrupted study."""
        return any(True for _ in batch_files(self._batches))

    def prepare(
        self,
        study: Study,
        resume: bool,
        told: Callable[[str], None] = lambda message: None,
        *,
        replace: bool = False,
    ) -> list[int]:
        """Make the folder ready and return the numbers of the batches that are still to be solved.

        With `resume` the study that the folder holds goes on; with `replace` another one, finished or not, makes room. Raises
        `CycloError` when the folder holds another or an unfinished study and neither was asked for. `told` is called with a
        line for each batch that is set aside.
        """
        fingerprint = study.fingerprint
        held = None if replace else self._held()
        unfinished = self.has_batches()
        if resume:
            if held is None:
                raise CycloError(f"{self.path}: holds no study to resume")
            if held != fingerprint:
                raise CycloError(
                    f"{self.path}: holds another study ({WHAT_DIFFERS}); resume with the options it was started with, or use "
                    "another --out"
                )
            if self.results.exists() and not unfinished:
                return []
        elif unfinished and not replace:
            raise CycloError(
                f"{self.path}: holds finished batches of an interrupted study; continue it with --resume, or start over with "
                "--force"
            )
        elif self.results.exists() and held not in (None, fingerprint) and not replace:
            raise CycloError(
                f"{self.path}: holds a finished study that is another ({WHAT_DIFFERS}); give another --out, or --force to "
                "replace it"
            )
        done = self._done(study, told) if resume else set()
        if not resume:
            for stale in (self.results, self.table, *batch_files(self._batches)):
                stale.unlink(missing_ok=True)
        write_json(
            self._plan,
            {
                "fingerprint": fingerprint,
                "name": study.name,
                "samples": study.design.samples,
                "positions": study.positions,
                "version": code_version(),
            },
        )
        return [number for number in range(study.batches) if number not in done]

    def _held(self) -> str | None:
        try:
            return str(json.loads(read_regular(self._plan, LARGEST_PLAN))["fingerprint"])
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
            raise DamagedFileError(
                f"{self._plan}: cannot be read as the plan of a study: {error}; start over with --force"
            ) from error

    def _done(self, study: Study, told: Callable[[str], None]) -> set[int]:
        """Finished batches of this study; what is damaged or of another is set aside and solved again."""
        done = set()
        for path in batch_files(self._batches):
            try:
                done.add(read_batch(path, study).number)
            except DamagedFileError as error:
                aside = path.with_suffix(".npz.aside")
                path.replace(aside)
                told(f"{error}; set aside as {aside.name}, its samples are solved again")
        return done

    def store(self, study: Study, result: BatchResult) -> None:
        """Keep one finished batch, whole or not at all, and whose it is."""
        write_batch(self._batches / f"{result.number:08d}.npz", study, result)

    def _load(self, study: Study, number: int) -> BatchResult:
        try:
            return read_batch(self._batches / f"{number:08d}.npz", study)
        except DamagedFileError as error:
            raise DamagedFileError(f"{error}; continue with --resume, which solves its samples again") from error

    def _samples(self, study: Study) -> Iterator[BatchResult]:
        """Samples in order, batches joined to parts of some `CHUNK`."""
        waiting: list[BatchResult] = []
        for number in range(study.batches):
            waiting.append(self._load(study, number))
            if sum(len(batch.messages) for batch in waiting) >= CHUNK or number == study.batches - 1:
                yield BatchResult(
                    number=waiting[0].number,
                    factors=np.concatenate([batch.factors for batch in waiting]),
                    values=np.concatenate([batch.values for batch in waiting]),
                    messages=tuple(message for batch in waiting for message in batch.messages),
                    binds=np.concatenate([batch.binds for batch in waiting if batch.binds is not None])
                    if study.counts_binding
                    else None,
                )
                waiting = []

    def finish(self, study: Study) -> Failures:
        """Write dataset and table from all batches, then remove those; return failed samples and why."""
        with whole_file(self.results) as dataset, whole_file(self.table) as table:
            failures = write_results(study, self._samples(study), dataset, table)
        for path in list(batch_files(self._batches)):
            path.unlink()
        with suppress(OSError):  # what is not ours stays, and so does the folder then
            self._batches.rmdir()
        return failures


def batch_files(folder: Path) -> Iterator[Path]:
    """Yield the files of batches in a folder, by number; none when it is not there."""
    if folder.is_dir():
        yield from sorted(path for path in folder.iterdir() if BATCH_NAME.fullmatch(path.name))


def write_batch(path: Path, study: Study, result: BatchResult) -> None:
    """Write one batch, whole or not at all."""
    content = {
        "number": np.array(result.number),
        "factors": result.factors,
        "values": result.values,
        "messages": np.array(result.messages, dtype=str),
        "fingerprint": np.array(study.fingerprint),
        **({} if result.binds is None else {"binds": result.binds}),
    }
    write_arrays(path, content)


def read_batch(path: Path, study: Study) -> BatchResult:
    """Read one batch; `DamagedFileError` when it is damaged, or belongs to another study or to another number."""
    kind = "a batch of a study"
    arrays = read_arrays(path, kind)
    try:
        number, factors, values, messages, fingerprint = (arrays[name] for name in PARTS)
        result = BatchResult(
            number=int(number),
            factors=factors,
            values=values,
            messages=tuple(str(text) for text in messages.tolist()),
            binds=arrays["binds"] if study.counts_binding else None,
        )
    except DAMAGE as error:
        raise DamagedFileError(f"{path}: cannot be read as {kind}: {one_line(error)}") from error
    if str(fingerprint) != study.fingerprint:
        raise DamagedFileError(f"{path}: belongs to another study")
    if f"{result.number:08d}" != path.stem or not 0 <= result.number < study.batches:
        raise DamagedFileError(f"{path}: is batch {result.number} of the study")
    first, last = study.samples_of(result.number)
    binds = result.messages if result.binds is None else result.binds
    if not len(result.factors) == len(result.values) == len(result.messages) == len(binds) == last - first:
        raise DamagedFileError(f"{path}: has not the {last - first} samples of its number")
    return result
