"""Files of a study: finished batches while it runs, then one dataset and one table that are whole or not there.

Nothing in the final files depends on time, on who solved it or on the order in which batches came.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.fields import field_kind, with_whose
from ltca.errors import CycloError, DamagedFileError, one_line
from ltca.output.files import whole_file, write_json
from ltca.output.netcdf import DiscStream, netcdf_stream, require_sound_netcdf
from ltca.output.provenance import code_hash, code_version
from ltca.output.regular_files import read_regular
from ltca.output.run_folder import BATCHES, PLAN
from ltca.quantities import SCALARS
from ltca.reading.writing import drive_text
from ltca.studies.designs import SweepDesign
from ltca.studies.execution.batch_files import DAMAGE, batch_files, read_batch, write_batch
from ltca.studies.study import BatchResult, Study

WHAT_DIFFERS = "drive, tolerances, samples, positions, seed, quantities, compliance, coefficients or the code differ"
LARGEST_PLAN = 1_000_000
"""Bytes of a plan, which has five short entries."""
CHUNK = 4096
"""Samples of one chunk of the final files."""


@contextmanager
def opened_results(path: Path) -> Iterator[Any]:
    """Open the dataset of a finished study (h5netcdf); `DamagedFileError` where it is unreadable within the block."""
    import h5netcdf

    try:
        require_sound_netcdf(path, "the results of a study", whole=False)
        with h5netcdf.File(path, "r") as file:
            yield file
    except DamagedFileError as error:
        raise DamagedFileError(f"{error}; solve it again with --force") from error
    except (*DAMAGE, AttributeError, IndexError) as error:
        raise DamagedFileError(
            f"{path}: cannot be read as the results of a study: {one_line(error)}; solve it again with --force"
        ) from error


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
        """Make the folder ready and return the batches that are still to be solved.

        Parameters
        ----------
        study : Study
            What is to be solved.
        resume : bool
            Whether to continue what the folder holds.
        told : callable
            Told which batches are set aside, and why.
        replace : bool
            Whether another study in the folder, finished or not, makes room.

        Raises
        ------
        CycloError
            When the folder holds another or an unfinished study and that was not expected.
        """
        fingerprint = study.fingerprint()
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

    def _in_chunks(self, study: Study) -> Iterator[tuple[int, FloatArray, FloatArray, list[str]]]:
        """Samples in order: first number, factors, values and messages of each chunk."""
        factors: list[FloatArray] = []
        values: list[FloatArray] = []
        messages: list[str] = []
        first = 0
        for number in range(study.batches):
            batch = self._load(study, number)
            factors.append(batch.factors)
            values.append(batch.values)
            messages += batch.messages
            if len(messages) >= CHUNK or number == study.batches - 1:
                yield first, np.concatenate(factors), np.concatenate(values), messages
                first += len(messages)
                factors, values, messages = [], [], []

    def failures(self, study: Study) -> list[tuple[int, str]]:
        """Return the failed samples of the finished dataset and why."""
        with opened_results(self.results) as file:
            if "failed_sample" not in file.variables:
                return []
            numbers = file.variables["failed_sample"][...].tolist()
            reasons = file.variables["failure_message"][...]
            texts = [reason.decode() if isinstance(reason, bytes) else str(reason) for reason in reasons]
            return list(zip(numbers, texts, strict=True))

    def finish(self, study: Study) -> list[tuple[int, str]]:
        """Write dataset and table from all batches, then remove those; return failed samples and why.

        Memory holds one chunk at a time.
        """
        failures: list[tuple[int, str]] = []
        for first, _, _, messages in self._in_chunks(study):
            failures += [(first + place, message) for place, message in enumerate(messages) if message]
        with whole_file(self.results) as part, netcdf_stream(part) as stream:
            self._write_dataset(study, stream, failures)
        with whole_file(self.table) as part:
            self._write_table(study, part)
        for path in list(batch_files(self._batches)):
            path.unlink()
        with suppress(OSError):  # what is not ours stays, and so does the folder then
            self._batches.rmdir()
        return failures

    def _write_dataset(self, study: Study, stream: DiscStream, failures: list[tuple[int, str]]) -> None:
        import h5netcdf

        samples, names = study.design.samples, study.design.names
        with h5netcdf.File(stream, "w") as file:
            file.dimensions = {"sample": samples, "factor": len(names), "failure": len(failures)}
            file.attrs.update(_attributes(study))
            text = {"dtype": h5netcdf.core.h5py.string_dtype()}
            file.create_variable("factor", ("factor",), **text)[:] = np.array(names, dtype=object)
            units = file.create_variable("factor_units", ("factor",), **text)
            units[:] = np.array([_factor_column(study, name)["units"] for name in names], dtype=object)
            units.attrs["long_name"] = "unit of each factor"
            file.create_variable("sample", ("sample",), dtype="i8")[:] = np.arange(samples)
            length = min(CHUNK, samples)
            drawn = file.create_variable("factor_value", ("sample", "factor"), dtype="f8", chunks=(length, len(names)))
            drawn.attrs["long_name"] = "value of each factor, in its unit (factor_units); of a text its level"
            failed = file.create_variable("failed", ("sample",), dtype="i1")
            failed.attrs["long_name"] = "1 where the sample failed; its quantities are no numbers then"
            columns = []
            for name in study.quantities:
                column = file.create_variable(name, ("sample",), dtype="f8")
                column.attrs.update({"units": SCALARS[name].unit, "long_name": SCALARS[name].title})
                columns.append(column)
            if failures:
                numbers = file.create_variable("failed_sample", ("failure",), dtype="i8")
                numbers[:] = np.array([number for number, _ in failures])
                reasons = file.create_variable("failure_message", ("failure",), **text)
                reasons[:] = np.array([message for _, message in failures], dtype=object)
            for first, factors, values, messages in self._in_chunks(study):
                rows = slice(first, first + len(messages))
                drawn[rows] = factors
                failed[rows] = np.array([bool(message) for message in messages], dtype="i1")
                for column, numbers_of in zip(columns, values.T, strict=True):
                    column[rows] = numbers_of
                stream.check()

    def _write_table(self, study: Study, path: Path) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        schema = pa.schema(
            [
                pa.field("sample", pa.int64(), metadata={"units": "1", "description": "number of the sample, from 0"}),
                *(pa.field(name, pa.float64(), metadata=_factor_column(study, name)) for name in study.design.names),
                *(pa.field(name, pa.float64(), metadata=quantity_column(name)) for name in study.quantities),
                pa.field("message", pa.string(), metadata={"units": "", "description": "why it failed, else empty"}),
            ],
            metadata={name: str(value) for name, value in _attributes(study).items()},
        )
        with parquet.ParquetWriter(path, schema) as writer:
            for first, factors, values, messages in self._in_chunks(study):
                columns = [np.arange(first, first + len(messages)), *factors.T, *values.T]
                arrays = [pa.array(column) for column in columns]
                writer.write_table(pa.Table.from_arrays([*arrays, pa.array(messages)], schema=schema))


def _attributes(study: Study) -> dict[str, Any]:
    """What a file of a study says of itself; no clock and no folder among it."""
    found = {
        "Conventions": "CF-1.11",
        "title": f"study of {study.name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca"),
        "study": study.name,
        "study_definition": study.definition,
        "drive_file": study.drive_file or drive_text(study.cases[0][1]),
        "fingerprint": study.fingerprint(),
        "positions": study.positions,
        "samples": study.design.samples,
        **study.engine.options,
    }
    if owners := study.eccentrics():
        found["eccentrics"] = json.dumps(owners)
    if isinstance(study.design, SweepDesign):
        found["levels"] = json.dumps({f.path: list(f.levels) for f in study.design.factors if f.is_text})
    return found


def quantity_column(name: str) -> dict[str, str]:
    """Return the metadata of the column of a quantity in a table."""
    return {"units": SCALARS[name].unit, "description": SCALARS[name].title}


def field_column(path: str, owner: str = "") -> dict[str, str]:
    """Return the metadata of the column of a field of the drive in a table, with whose it is."""
    kind = field_kind(path) or field_kind(path.rpartition(".")[0])
    plain = "" if kind is None else kind.unit
    unit = {"": "1", "dimensionless": "1"}.get(plain, plain.replace("*", " "))
    return {"units": unit, "description": f"drive field {with_whose(path, owner)}"}


def _factor_column(study: Study, name: str) -> dict[str, str]:
    if isinstance(study.design, SweepDesign):
        factor = next(item for item in study.design.factors if item.path == name)
        if factor.is_text:
            levels = ", ".join(f"{number} {level}" for number, level in enumerate(factor.levels))
            return {"units": "1", "description": f"number of the level of {name}: {levels}"}
    return field_column(name, study.whose(name))
