"""The final dataset and table of a study: written from its samples in order, and read back in flat memory.

Nothing in them depends on time, on who solved the samples or on the order in which batches came.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import BoolArray, FloatArray
from ltca.drive.fields import field_kind, with_whose
from ltca.errors import DamagedFileError, one_line
from ltca.output.netcdf import DAMAGE, netcdf_stream, require_known_schema, require_sound_netcdf
from ltca.output.provenance import code_hash, code_version
from ltca.quantities import SCALARS, SCHEMA_VERSION
from ltca.reading.writing import drive_text
from ltca.studies.designs import SweepDesign
from ltca.studies.study import BatchResult, Study

CHUNK = 4096
"""Samples written and read together."""
PERCENTILES = (0.1, 1.0, 5.0, 50.0, 95.0, 99.0, 99.9)

BINDS = "binds"
BINDS_WORDS = "1 where the sample has no backlash at the output at some position, as parts overlap there in every pose"

Failures = list[tuple[int, str]]
"""Failed samples and why."""


def write_results(study: Study, samples: Iterable[BatchResult], dataset: Path, table: Path) -> Failures:
    """Write dataset and table of a study; return the failed samples and why.

    `samples` are all of them in order, in parts of some `CHUNK`; memory holds one part at a time. Both paths come from
    `ltca.output.files.whole_file`.
    """
    import h5netcdf
    import pyarrow as pa
    from pyarrow import parquet

    number, names, attributes = study.design.samples, study.design.names, _attributes(study)
    owners, failures, first = study.eccentrics(), Failures(), 0
    described = [_factor_column(study, name, owners.get(name, "")) for name in names]
    schema = pa.schema(
        [
            pa.field("sample", pa.int64(), metadata={"units": "1", "description": "number of the sample, from 0"}),
            *(pa.field(name, pa.float64(), metadata=of) for name, of in zip(names, described, strict=True)),
            *(pa.field(name, pa.float64(), metadata=quantity_column(name)) for name in study.quantities),
            *(
                [pa.field(BINDS, pa.int8(), metadata={"units": "1", "description": BINDS_WORDS})]
                if study.counts_binding
                else []
            ),
            pa.field("message", pa.string(), metadata={"units": "", "description": "why it failed, else empty"}),
        ],
        metadata={name: str(value) for name, value in attributes.items()},
    )
    with (
        netcdf_stream(dataset) as stream,
        h5netcdf.File(stream, "w") as file,
        parquet.ParquetWriter(table, schema) as writer,
    ):
        file.dimensions = {"sample": number, "factor": len(names)}
        file.attrs.update(attributes)
        text = {"dtype": h5netcdf.core.h5py.string_dtype()}
        file.create_variable("factor", ("factor",), **text)[:] = np.array(names, dtype=object)
        units = file.create_variable("factor_units", ("factor",), **text)
        units[:] = np.array([of["units"] for of in described], dtype=object)
        units.attrs["long_name"] = "unit of each factor"
        file.create_variable("sample", ("sample",), dtype="i8")[:] = np.arange(number)
        chunks = (min(CHUNK, number), len(names))
        drawn = file.create_variable("factor_value", ("sample", "factor"), dtype="f8", chunks=chunks)
        drawn.attrs["long_name"] = "value of each factor, in its unit (factor_units); of a text its level"
        failed = file.create_variable("failed", ("sample",), dtype="i1")
        failed.attrs["long_name"] = "1 where the sample failed; its quantities are no numbers then"
        bound = file.create_variable(BINDS, ("sample",), dtype="i1") if study.counts_binding else None
        if bound is not None:
            bound.attrs["long_name"] = BINDS_WORDS
        columns = [file.create_variable(name, ("sample",), dtype="f8") for name in study.quantities]
        for column, name in zip(columns, study.quantities, strict=True):
            column.attrs.update({"units": SCALARS[name].unit, "long_name": SCALARS[name].title})
        for part in samples:
            rows = slice(first, first + len(part.messages))
            drawn[rows] = part.factors
            failed[rows] = np.array([bool(message) for message in part.messages], dtype="i1")
            for column, values in zip(columns, part.values.T, strict=True):
                column[rows] = values
            stream.check()
            arrays = [pa.array(column) for column in (np.arange(first, rows.stop), *part.factors.T, *part.values.T)]
            if bound is not None and part.binds is not None:
                bound[rows] = part.binds.astype("i1")
                arrays.append(pa.array(part.binds.astype("i1")))
            writer.write_table(pa.Table.from_arrays([*arrays, pa.array(part.messages)], schema=schema))
            failures += [(first + place, message) for place, message in enumerate(part.messages) if message]
            first = rows.stop
        file.dimensions["failure"] = len(failures)
        if failures:
            numbers, reasons = zip(*failures, strict=True)
            file.create_variable("failed_sample", ("failure",), dtype="i8")[:] = np.array(numbers)
            file.create_variable("failure_message", ("failure",), **text)[:] = np.array(reasons, dtype=object)
    return failures


def _attributes(study: Study) -> dict[str, Any]:
    """What a file of a study says of itself; no clock and no folder among it."""
    found = {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "title": f"study of {study.name}",
        "source": f"cyclo {code_version()}",
        "version": code_version(),
        "code_hash": code_hash("ltca"),
        "study": study.name,
        "study_definition": study.definition,
        "drive_file": study.drive_file or drive_text(study.cases[0][1]),
        "fingerprint": study.fingerprint,
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


def _factor_column(study: Study, name: str, owner: str) -> dict[str, str]:
    if isinstance(study.design, SweepDesign):
        factor = next(item for item in study.design.factors if item.path == name)
        if factor.is_text:
            levels = ", ".join(f"{number} {level}" for number, level in enumerate(factor.levels))
            return {"units": "1", "description": f"number of the level of {name}: {levels}"}
    return field_column(name, owner)


@contextmanager
def opened_results(path: Path) -> Iterator[Any]:
    """Open the dataset of a finished study (h5netcdf); `DamagedFileError` where it is unreadable within the block."""
    import h5netcdf

    try:
        require_sound_netcdf(path, "the results of a study", whole=False)
        with h5netcdf.File(path, "r") as file:
            require_known_schema(path, file.attrs)
            yield file
    except DamagedFileError as error:
        raise DamagedFileError(f"{error}; solve it again with --force") from error
    except (*DAMAGE, AttributeError, IndexError) as error:
        raise DamagedFileError(
            f"{path}: cannot be read as the results of a study: {one_line(error)}; solve it again with --force"
        ) from error


def read_failures(path: Path) -> Failures:
    """Return the failed samples of a finished dataset and why."""
    with opened_results(path) as file:
        if "failed_sample" not in file.variables:
            return []
        numbers = file.variables["failed_sample"][...].tolist()
        reasons = file.variables["failure_message"][...]
        texts = [reason.decode() if isinstance(reason, bytes) else str(reason) for reason in reasons]
        return list(zip(numbers, texts, strict=True))


def read_binds(path: Path) -> BoolArray:
    """Return which samples bind, of a study that keeps it (`Study.counts_binding`)."""
    with opened_results(path) as file:
        return np.asarray(file.variables[BINDS][...], dtype=bool)


def read_quantity(path: Path, name: str) -> FloatArray:
    """Return one quantity of all samples, not a number where they failed."""
    with opened_results(path) as file:
        return np.asarray(file.variables[name][...])


def read_chunks(path: Path, quantities: Sequence[str]) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield factors and quantities of the sound samples, some thousands at a time."""
    with opened_results(path) as file:
        samples = file.dimensions["sample"].size
        for first in range(0, samples, CHUNK):
            rows = slice(first, min(first + CHUNK, samples))
            sound = np.asarray(file.variables["failed"][rows]) == 0
            factors = np.asarray(file.variables["factor_value"][rows])
            values = np.stack([np.asarray(file.variables[name][rows]) for name in quantities], axis=1)
            yield factors[sound], values[sound]


@dataclass(frozen=True, slots=True, kw_only=True)
class QuantitySummary:
    """One quantity over the sound samples.

    Attributes
    ----------
    mean, standard_deviation : float
        In the unit of the quantity.
    percentiles : tuple of float
        At `PERCENTILES`.
    smallest, largest : float
        Extremes.
    smallest_sample, largest_sample : int
        Where they are.
    """

    mean: float
    standard_deviation: float
    percentiles: tuple[float, ...]
    smallest: float
    largest: float
    smallest_sample: int
    largest_sample: int


def summarise_quantity(values: FloatArray) -> QuantitySummary | None:
    """Return the scalars of one quantity, None when every sample failed."""
    sound = np.isfinite(values)
    if not sound.any():
        return None
    kept = values[sound]
    return QuantitySummary(
        mean=float(kept.mean()),
        standard_deviation=float(kept.std(ddof=1)) if kept.size > 1 else 0.0,
        percentiles=tuple(float(value) for value in np.percentile(kept, PERCENTILES)),
        smallest=float(kept.min()),
        largest=float(kept.max()),
        smallest_sample=int(np.nanargmin(values)),
        largest_sample=int(np.nanargmax(values)),
    )
