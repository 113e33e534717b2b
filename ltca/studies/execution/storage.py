"""Files of a study: finished batches while it runs, then one dataset and one table that are whole or not there.

Nothing in the final files depends on time, on the engine or on the order in which batches came.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ltca.errors import CycloError
from ltca.output.files import whole_file, write_json
from ltca.studies.designs import SweepDesign
from ltca.studies.quantities import QUANTITIES
from ltca.studies.study import BatchResult, Study

FloatArray = NDArray[np.float64]

CHUNK = 4096
"""Samples of one chunk of the final files."""


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
    def _batches(self) -> Path:
        return self.path / "batches"

    @property
    def _plan(self) -> Path:
        return self.path / "study.json"

    def prepare(self, study: Study, resume: bool) -> list[int]:
        """Make the folder ready and return the batches that are still to be solved.

        Raises
        ------
        CycloError
            When the folder holds another or an unfinished study and that was not expected.
        """
        fingerprint = study.fingerprint()
        held = self._held()
        unfinished = self._batches.is_dir() and any(self._batches.iterdir())
        if resume:
            if held is None:
                raise CycloError(f"{self.path}: holds no study to resume")
            if held != fingerprint:
                raise CycloError(
                    f"{self.path}: holds another study (drive, tolerances, samples, positions, seed or quantities "
                    "differ); resume with the options it was started with, or use another --out"
                )
            if self.results.exists() and not unfinished:
                return []
        elif unfinished:
            raise CycloError(
                f"{self.path}: holds finished batches of an interrupted study; continue it with --resume, or remove "
                f"{self._batches} to start over"
            )
        done = {int(item.stem) for item in self._batches.glob("[0-9]*.npz")} if resume else set()
        if not resume:
            for stale in (self.results, self.table):
                stale.unlink(missing_ok=True)
        write_json(
            self._plan,
            {
                "fingerprint": fingerprint,
                "name": study.name,
                "samples": study.design.samples,
                "positions": study.positions,
                "version": version("cyclo-ltca"),
            },
        )
        return [number for number in range(study.batches) if number not in done]

    def _held(self) -> str | None:
        try:
            return str(json.loads(self._plan.read_text(encoding="utf-8"))["fingerprint"])
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError) as error:
            raise CycloError(f"{self._plan}: cannot be read: {error}") from error

    def store(self, result: BatchResult) -> None:
        """Keep one finished batch, whole or not at all."""
        with whole_file(self._batches / f"{result.number:08d}.npz") as part:
            np.savez(
                part,
                factors=result.factors,
                values=result.values,
                messages=np.array(result.messages, dtype=str),
            )

    def _load(self, number: int) -> BatchResult:
        with np.load(self._batches / f"{number:08d}.npz") as stored:
            return BatchResult(
                number=number,
                factors=stored["factors"],
                values=stored["values"],
                messages=tuple(str(text) for text in stored["messages"]),
            )

    def _in_chunks(self, study: Study) -> Iterator[tuple[int, FloatArray, FloatArray, list[str]]]:
        """Samples in order: first number, factors, values and messages of each chunk."""
        factors: list[FloatArray] = []
        values: list[FloatArray] = []
        messages: list[str] = []
        first = 0
        for number in range(study.batches):
            batch = self._load(number)
            factors.append(batch.factors)
            values.append(batch.values)
            messages += batch.messages
            if len(messages) >= CHUNK or number == study.batches - 1:
                yield first, np.concatenate(factors), np.concatenate(values), messages
                first += len(messages)
                factors, values, messages = [], [], []

    def failures(self, study: Study) -> list[tuple[int, str]]:
        """Return the failed samples of the finished dataset and why."""
        import h5netcdf

        with h5netcdf.File(self.results, "r") as file:
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
        with whole_file(self.results) as part:
            self._write_dataset(study, part, failures)
        with whole_file(self.table) as part:
            self._write_table(study, part)
        shutil.rmtree(self._batches)
        return failures

    def _write_dataset(self, study: Study, path: Path, failures: list[tuple[int, str]]) -> None:
        import h5netcdf

        samples, names = study.design.samples, study.design.names
        with h5netcdf.File(path, "w") as file:
            file.dimensions = {"sample": samples, "factor": len(names), "failure": len(failures)}
            file.attrs.update(
                {
                    "study": study.name,
                    "fingerprint": study.fingerprint(),
                    "positions": study.positions,
                    "samples": samples,
                    "version": version("cyclo-ltca"),
                }
            )
            if isinstance(study.design, SweepDesign):
                levels = {f.path: list(f.levels) for f in study.design.factors if f.is_text}
                file.attrs["levels"] = json.dumps(levels)
            text = {"dtype": h5netcdf.core.h5py.string_dtype()}
            file.create_variable("factor", ("factor",), **text)[:] = np.array(names, dtype=object)
            file.create_variable("sample", ("sample",), dtype="i8")[:] = np.arange(samples)
            length = min(CHUNK, samples)
            drawn = file.create_variable("factor_value", ("sample", "factor"), dtype="f8", chunks=(length, len(names)))
            drawn.attrs["long_name"] = "value of each factor, in the unit of its field"
            failed = file.create_variable("failed", ("sample",), dtype="i1")
            failed.attrs["long_name"] = "1 where the sample failed; its quantities are no numbers then"
            columns = []
            for name in study.quantities:
                column = file.create_variable(name, ("sample",), dtype="f8")
                column.attrs.update({"units": QUANTITIES[name].unit, "long_name": QUANTITIES[name].description})
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

    def _write_table(self, study: Study, path: Path) -> None:
        import pyarrow as pa
        from pyarrow import parquet

        names = [*study.design.names, *study.quantities]
        kinds = [("sample", pa.int64()), *((name, pa.float64()) for name in names), ("message", pa.string())]
        schema = pa.schema(kinds)
        with parquet.ParquetWriter(path, schema) as writer:
            for first, factors, values, messages in self._in_chunks(study):
                columns = [np.arange(first, first + len(messages)), *factors.T, *values.T]
                arrays = [pa.array(column) for column in columns]
                writer.write_table(pa.Table.from_arrays([*arrays, pa.array(messages)], schema=schema))
