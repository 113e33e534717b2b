"""``study.toml``: which fields of a drive a sweep varies, how, and what it keeps.

::

    drive = "paper"                  # or a drive file, relative to this file
    case = "CS-3"                    # default the first
    positions = 90                   # crank angles 2πk/N; default 28
    quantities = ["ptp_transmission_error", "max_pin_pressure_mid"]   # default all at the torque of the drive

    [design]
    kind = "grid"                    # grid, list, latin-hypercube, sobol
    # samples = 256                  # of latin-hypercube and sobol
    # seed = 0

    [factors]                        # any field of the drive by its path, or "case"
    "disc.equidistant_offset" = [0.13, 0.15, 0.17]
    "clearance.bearing" = { low = 0.0, high = 0.03, levels = 4 }
    # "load.torque" = { low = "100 N m", high = "400 N m", scale = "logarithmic" }
    # "case" = ["CS-1", "CS-6"]
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ltca.analysis.engines import Engine, HalfSpace
from ltca.drive.fields import field_kinds, read_field
from ltca.drive.mistakes import describe_mistake
from ltca.drive.parts import Drive
from ltca.drive.units import quantity
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive
from ltca.studies.designs import SweepDesign, SweepFactor, check_samples
from ltca.studies.quantities import DEFAULT_QUANTITIES, check_quantities
from ltca.studies.study import Study, positions_together

KINDS = ("grid", "list", "latin-hypercube", "sobol")
KEYS = {"drive", "case", "positions", "quantities", "design", "factors"}


@dataclass(slots=True, kw_only=True)
class _Reader:
    """What is wrong so far, and where the study came from."""

    source: str
    problems: list[str]

    def check(self) -> None:
        if self.problems:
            raise DriveError(self.problems, self.source)


def load_sweep(path: Path, engine: Engine | None = None) -> Study:
    """Read a sweep from its TOML file.

    Parameters
    ----------
    path : Path
        ``study.toml``.
    engine : Engine, optional
        How bodies yield; half-spaces by default.

    Returns
    -------
    Study

    Raises
    ------
    DriveError
        When file, drive, design or a factor is wrong; all mistakes together.
    """
    try:
        text = path.read_text(encoding="utf-8")
        table = tomllib.loads(text)
    except (OSError, UnicodeDecodeError) as error:
        raise DriveError([f"cannot be read: {error}"], str(path)) from error
    except tomllib.TOMLDecodeError as error:
        raise DriveError([f"is not valid TOML: {error}"], str(path)) from error
    source = table.get("drive")
    if not isinstance(source, str):
        raise DriveError(["drive: is missing; give 'paper' or a drive file"], str(path))
    # A drive file is looked for beside the study, so that both can be moved together.
    study = parse_sweep(table, source if source == "paper" else str(path.parent / source), str(path), engine)
    return replace(study, definition=text)


def parse_sweep(table: Mapping[str, Any], drive: str, source: str = "study", engine: Engine | None = None) -> Study:
    """Validate the table of a sweep file; see `load_sweep`."""
    reader = _Reader(source=source, problems=[])
    reader.problems += [
        f"{key}: is not a key of a study; there are {', '.join(sorted(KEYS))}" for key in table.keys() - KEYS
    ]
    file = load_drive(drive)
    factors_table = table.get("factors")
    if not isinstance(factors_table, Mapping) or not factors_table:
        reader.problems.append("factors: is missing or empty; name at least one field to vary")
        factors_table = {}
    positions = table.get("positions", 28)
    if not isinstance(positions, int) or not 1 <= positions <= 100_000:
        reader.problems.append(f"positions = {positions}: must be a whole number from 1 to 100000")
    quantities = table.get("quantities", list(DEFAULT_QUANTITIES))
    names = tuple(quantities) if isinstance(quantities, list) and all(isinstance(n, str) for n in quantities) else ()
    if not names:
        reader.problems.append("quantities: must be an array of names")
    reader.check()
    selected = file.select([table["case"]] if "case" in table else None)
    base = next(iter(selected.values()))
    factors = tuple(_factors(factors_table, base, file.cases, reader))
    design = _design(table.get("design", {}), factors, reader)
    reader.check()
    assert design is not None
    varied = "case" in design.names
    used: Engine = HalfSpace() if engine is None else engine
    cases = tuple((file.cases if varied else {next(iter(selected)): base}).items())
    return Study(
        name=file.name if varied else f"{file.name} {cases[0][0]}",
        cases=cases,
        design=design,
        positions=positions,
        quantities=check_quantities(names),
        near_nominal=False,
        engine=used,
        batch_positions=positions_together(used),
        definition=json.dumps(table, ensure_ascii=False),
        drive_file=file.text,
    )


def _factors(table: Mapping[str, Any], drive: Drive, cases: Mapping[str, Drive], reader: _Reader) -> list[SweepFactor]:
    found: list[SweepFactor] = []
    for path, entry in _flat(table, ""):
        if path == "case":
            unknown = [name for name in entry if name not in cases] if isinstance(entry, list) else [entry]
            if unknown or not entry:
                reader.problems.append(f"factors.case: must be an array of cases; there are {', '.join(cases)}")
            else:
                found.append(SweepFactor(path=path, levels=tuple(entry)))
            continue
        try:
            read_field(drive, path)
        except DriveError as error:
            reader.problems += [f"factors.{problem}" for problem in error.problems]
            continue
        factor = _factor(path, entry, reader)
        if factor is not None:
            found.append(factor)
    return found


def _flat(table: Mapping[str, Any], prefix: str) -> list[tuple[str, Any]]:
    """Entries by dotted path, written in quotes or as nested tables."""
    entries: list[tuple[str, Any]] = []
    for name, value in table.items():
        if isinstance(value, Mapping) and "low" not in value and "high" not in value:
            entries += _flat(value, f"{prefix}{name}.")
        else:
            entries.append((f"{prefix}{name}", value))
    return entries


def _factor(path: str, entry: Any, reader: _Reader) -> SweepFactor | None:
    parent = path.rpartition(".")[0]
    kinds = field_kinds()
    kind = kinds.get(path) or kinds[parent]
    if kind.is_array and path in kinds:
        reader.problems.append(f"factors.{path}: is an array; vary one element of it, as {path}.0")
        return None

    def number(value: Any) -> Any:
        if not kind.unit:
            return value
        return TypeAdapter(Annotated[float, quantity(kind.unit)]).validate_python(value)

    try:
        if isinstance(entry, list) and entry:
            return SweepFactor(path=path, levels=tuple(number(value) for value in entry))
        if isinstance(entry, Mapping) and entry.keys() <= {"low", "high", "levels", "scale"}:
            return _range(path, entry, number(entry.get("low")), number(entry.get("high")), reader)
    except ValidationError as error:
        for detail in error.errors():
            detail["loc"] = ("factors", path)
            reader.problems.append(describe_mistake(detail))
        return None
    reader.problems.append(f"factors.{path}: must be an array of values or a table with low and high")
    return None


def _range(path: str, entry: Mapping[str, Any], low: Any, high: Any, reader: _Reader) -> SweepFactor | None:
    logarithmic = entry.get("scale", "linear") == "logarithmic"
    if entry.get("scale", "linear") not in ("linear", "logarithmic"):
        reader.problems.append(f"factors.{path}.scale = {entry['scale']}: must be linear or logarithmic")
        return None
    if not isinstance(low, int | float) or not isinstance(high, int | float) or not low < high:
        reader.problems.append(f"factors.{path}: low = {low} must be a number less than high = {high}")
        return None
    if logarithmic and low <= 0:
        reader.problems.append(f"factors.{path}.low = {low:g}: must be greater than 0 on a logarithmic scale")
        return None
    levels = entry.get("levels")
    if levels is None:
        return SweepFactor(path=path, low=float(low), high=float(high), logarithmic=logarithmic)
    if not isinstance(levels, int) or levels < 2:
        reader.problems.append(f"factors.{path}.levels = {levels}: must be a whole number of at least 2")
        return None
    places = np.geomspace(low, high, levels) if logarithmic else np.linspace(low, high, levels)
    whole = isinstance(low, int) and isinstance(high, int) and bool(np.all(places == np.round(places)))
    return SweepFactor(path=path, levels=tuple(int(p) if whole else float(p) for p in places))


def _design(table: Any, factors: tuple[SweepFactor, ...], reader: _Reader) -> SweepDesign | None:
    if not isinstance(table, Mapping) or not table.keys() <= {"kind", "samples", "seed"}:
        reader.problems.append("design: must be a table with kind, samples and seed")
        return None
    kind = table.get("kind", "grid")
    if kind not in KINDS:
        reader.problems.append(f"design.kind = {kind}: must be one of {', '.join(KINDS)}")
        return None
    ranges = [factor.path for factor in factors if not factor.levels]
    if kind in ("grid", "list"):
        reader.problems += [f"factors.{path}: must have levels in a {kind}" for path in ranges]
        if kind == "list" and len({len(factor.levels) for factor in factors}) > 1:
            reader.problems.append("factors: must all have equally many values in a list")
        return SweepDesign(factors=factors, kind=kind)
    samples, seed = table.get("samples"), table.get("seed", 0)
    if not isinstance(samples, int):
        reader.problems.append(f"design.samples = {samples}: must be a whole number for {kind}")
        return None
    if not isinstance(seed, int) or seed < 0:
        reader.problems.append(f"design.seed = {seed}: must be a whole number of at least 0")
        return None
    try:
        check_samples(samples, "design.samples")
    except DriveError as error:
        reader.problems += error.problems
        return None
    return SweepDesign(factors=factors, kind=kind, number=samples, seed=seed)
