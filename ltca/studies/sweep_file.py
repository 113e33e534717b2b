"""``study.toml``: which fields of a drive a sweep varies, how, and what it keeps.

::

    drive = "paper"                  # or another shipped drive, or a drive file, relative to this file
    case = "CS-3"                    # default the first
    positions = 90                   # crank angles 2πk/N; default 28
    quantities = ["ptp_transmission_error", "max_pin_pressure_mid"]   # default all at the torque that every case has

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
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ltca.analysis.engines import Engine, engine_of
from ltca.drive.declaration import naming_fields
from ltca.drive.fields import field_kind, may_be_left_out, read_field
from ltca.drive.members.bearings import bought_size
from ltca.drive.mistakes import describe_mistakes
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import quantity
from ltca.errors import MOST_TOLD, DriveError, Problem, did_you_mean, shortened
from ltca.reading.arguments import SHIPPED_DRIVES
from ltca.reading.changes import BEARING, with_fields
from ltca.reading.drive_file import listed, load_drive
from ltca.reading.toml_text import parse_toml, read_text, require_kind
from ltca.studies.designs import SweepDesign, SweepFactor
from ltca.studies.quantities import DEFAULT_QUANTITIES, check_quantities, quantities_for_all, with_what_varies
from ltca.studies.study import Study

KINDS = ("grid", "list", "latin-hypercube", "sobol")
SCALES = ("linear", "logarithmic")
RANGE = {"low", "high", "levels", "scale"}
DESIGN = {"kind", "samples", "seed"}
MOST_LEVELS = 100_000
MOST_VALUES = 2_000_000
"""Of a study file: a list of many factors has a value of each for every sample."""
MANY_LEVELS = 200
"""Numbers of which the ends are asked alone: what a field takes is an interval."""
MOST_SAMPLES = 100_000_000
KEYS = {"drive", "case", "positions", "quantities", "design", "factors"}


EngineChoice: TypeAlias = Callable[[Iterable[Drive]], Engine]
"""What chooses the engine of drives that are analysed together."""


@dataclass(slots=True, kw_only=True)
class _Reader:
    """What is wrong so far, and where the study came from."""

    source: str
    problems: list[str]

    def check(self) -> None:
        if self.problems:
            raise DriveError(self.problems, self.source)


def load_sweep(path: Path, engine: Engine | EngineChoice | None = None) -> Study:
    """Read a sweep from ``study.toml``; `DriveError` names all mistakes of file, drive, design and factors together.

    `engine` is one, or chooses it for the cases of the drive; by default as the drive says.
    """
    text = read_text(path, "no such file; docs/how-to/studies.md says what a study file holds")
    table = parse_toml(text, str(path), MOST_VALUES, MOST_VALUES)
    require_kind(table, "study", str(path))
    source = table.get("drive")
    if not isinstance(source, str) or not source:
        told = "drive: is missing" if source is None else f"drive = {shortened(source)}: is no name of a file"
        raise DriveError([f"{told}; give 'paper', another shipped drive or a drive file"], str(path))
    # A drive file is looked for beside the study, so that both can be moved together.
    study = parse_sweep(table, source if source in SHIPPED_DRIVES else str(path.parent / source), str(path), engine)
    return replace(study, definition=text)


def parse_sweep(
    table: Mapping[str, Any], drive: str, source: str = "study", engine: Engine | EngineChoice | None = None
) -> Study:
    """Validate the table of a sweep file; see `load_sweep`."""
    reader = _Reader(source=source, problems=[])
    reader.problems += [
        f"{shortened(key)[1:-1]}: is not a key of a study; there are {', '.join(sorted(KEYS))}{did_you_mean(key, KEYS)}"
        for key in table.keys() - KEYS
    ]
    file = load_drive(drive)
    factors_table = table.get("factors")
    if not isinstance(factors_table, Mapping) or not factors_table:
        reader.problems.append("factors: is missing or empty; name at least one field to vary")
        factors_table = {}
    _require_possible_grid(table.get("design", {}), factors_table, reader)
    positions = table.get("positions", 28)
    if not _is_count(positions) or not 1 <= positions <= 100_000:
        reader.problems.append(f"positions = {shortened(positions)}: must be a whole number from 1 to 100000")
    quantities = table.get("quantities", list(DEFAULT_QUANTITIES))
    names = tuple(quantities) if isinstance(quantities, list) and all(isinstance(n, str) for n in quantities) else ()
    if names:
        try:
            names = check_quantities(names)
        except DriveError as error:
            reader.problems += [f"quantities: {problem}" for problem in error.problems]
    else:
        reader.problems.append(f"quantities = {shortened(quantities)}: must be an array of names")
    case = table.get("case")
    if case is not None and not isinstance(case, str):
        reader.problems.append(
            f"case = {shortened(case)}: must be the name of one case, a text; several are factors: case = [...] in [factors]"
        )
    reader.check()
    try:
        selected = file.select(None if case is None else [case])
    except DriveError as error:
        raise DriveError([f"{problem} (of {drive})" for problem in error.problems], source) from error
    base = with_what_varies(next(iter(selected.values())), factors_table)
    factors = tuple(_factors(factors_table, base, file.cases, reader))
    several = {name: with_what_varies(drive, factors_table) for name, drive in file.cases.items()}
    swept = {str(name): several[str(name)] for factor in factors if factor.path == "case" for name in factor.levels}
    studied = swept or {next(iter(selected)): base}
    in_plane = any(factor.path == "contact.slices" and 1 in factor.levels for factor in factors)
    plane = {
        f"{name} with contact.slices = 1": replace(drive, contact=replace(drive.contact, slices=1))
        for name, drive in studied.items()
        if in_plane
    }
    try:
        names = quantities_for_all(studied | plane, names if "quantities" in table else None)
    except DriveError as error:
        reader.problems += [f"quantities: {problem}" for problem in error.problems]
    design = _design(table.get("design", {}), factors, reader)
    reader.check()
    assert design is not None
    cases = tuple((several if swept else studied).items())
    return Study(
        name=file.name if swept else f"{file.name} {cases[0][0]}",
        cases=cases,
        design=design,
        positions=positions,
        quantities=names,
        near_nominal=False,
        engine=_chosen(engine, file.cases.values()),
        definition=json.dumps(table, ensure_ascii=False, default=str),
        drive_file=file.text,
    )


def _chosen(engine: Engine | EngineChoice | None, drives: Iterable[Drive]) -> Engine:
    """Return the engine of a study, which may be chosen by the drives."""
    if engine is None:
        return engine_of(drives)
    return engine(drives) if callable(engine) else engine


def _is_whole(path: str) -> bool:
    """Tell whether a field takes no fractions; elements of arrays all have a unit."""
    kind = field_kind(path)
    return path == BEARING or (kind is not None and not kind.unit)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _factors(table: Mapping[str, Any], drive: Drive, cases: Mapping[str, Drive], reader: _Reader) -> list[SweepFactor]:
    found: list[SweepFactor] = []
    for path, entry in _flat(table, ""):
        if path in [factor.path for factor in found]:
            reader.problems.append(f"factors.{path}: is given twice, as a table and by its path")
            continue
        if path == "case":
            names = entry if isinstance(entry, list) and all(isinstance(name, str) for name in entry) else []
            unknown = [name for name in names if name not in cases]
            if unknown or not names:
                told = shortened(unknown[0] if unknown else entry)
                meant = did_you_mean(unknown[0], cases) if unknown else ""
                reader.problems.append(
                    f"factors.case = {told}: must be an array of cases; there are {listed(cases)}{meant}"
                )
            elif len(names) > MOST_LEVELS:
                reader.problems.append(f"factors.case: has {len(names)} values, must be at most {MOST_LEVELS}")
            else:
                found.append(SweepFactor(path=path, levels=tuple(names)))
            continue
        if path.partition(".")[0] == "analysis":
            said = "cannot vary, all samples of a study are analysed alike (--compliance)"
            reader.problems.append(Problem.of(f"factors.{path}", "", said))
            continue
        if refused := bought_size(drive.crank_bearing, path):
            reader.problems.append(f"factors.{refused}")
            continue
        try:
            if not may_be_left_out(path) and path != BEARING:
                read_field(drive, path)
        except DriveError as error:
            reader.problems += [f"factors.{problem}" for problem in error.problems]
            continue
        factor = _factor(path, entry, reader)
        if factor is not None:
            found.append(factor)
            reader.problems += _refused(drive, factor)
    return found


def _require_possible_grid(design: Any, factors: Mapping[str, Any], reader: _Reader) -> None:
    """Refuse a grid that nobody solves before its levels are looked at, one by one."""
    if not isinstance(design, Mapping) or design.get("kind", "grid") != "grid":
        return
    samples = 1
    for _, entry in _flat(factors, ""):
        count = entry.get("levels") if isinstance(entry, Mapping) else len(entry) if isinstance(entry, list) else 1
        samples *= count if isinstance(count, int) and 0 < count <= MOST_LEVELS else 1
    if samples > MOST_SAMPLES:
        told = f"{samples}" if samples < 10**15 else f"{samples:.3g}"
        said = f"make a grid of {told} samples, must be at most {MOST_SAMPLES}"
        reader.problems.append(Problem.of("factors", "", said, bound=("at most", MOST_SAMPLES)))
        reader.check()


def _refused(drive: Drive, factor: SweepFactor) -> list[str]:
    """What the definition of the field says to the levels, or to the ends of the range, each by itself."""
    problems: list[str] = []
    levels = factor.levels or (factor.low, factor.high)
    if len(levels) > MANY_LEVELS and not factor.is_text:
        levels = (min(levels), max(levels))
    for level in levels:
        try:
            with_fields(drive, {factor.path: level}, check=False)
        except DriveError as error:
            problems += error.problems
            if len(problems) >= MOST_TOLD:
                break
    return [f"factors.{problem}" for problem in problems]


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
    own = naming_fields()[path] if path == BEARING else field_kind(path)
    kind = own or field_kind(path.rpartition(".")[0])
    if kind is None:
        raise ValueError(f"{path} is no field")  # looked up before
    if own is not None and own.is_array:
        reader.problems.append(f"factors.{path}: is an array; vary one element of it, as {path}.0")
        return None

    quantities: TypeAdapter[float] | None = TypeAdapter(Annotated[float, quantity(kind.unit)]) if kind.unit else None

    def number(value: Any) -> Any:
        if quantities is None:
            # Counts, names, true and false: a range has numbers at its ends, the field itself says what it takes.
            if not isinstance(value, int | str):
                raise DriveError(
                    [f"factors.{path} = {shortened(value)}: must be a whole number, a name, true or false"],
                    reader.source,
                )
            return value if isinstance(value, str) or abs(value) < 10**9 else 10**9
        return quantities.validate_python(value)

    try:
        if isinstance(entry, list) and len(entry) > MOST_LEVELS:
            reader.problems.append(f"factors.{path}: has {len(entry)} values, must be at most {MOST_LEVELS}")
            return None
        if isinstance(entry, list) and entry:
            return SweepFactor(path=path, levels=tuple(number(value) for value in entry))
        if isinstance(entry, Mapping) and "low" in entry and "high" in entry and entry.keys() <= RANGE:
            return _range(path, entry, number(entry["low"]), number(entry["high"]), reader)
    except ValidationError as error:
        reader.problems += describe_mistakes([{**detail, "loc": ()} for detail in error.errors()], ("factors", path))
        return None
    unknown = sorted(entry.keys() - RANGE) if isinstance(entry, Mapping) else []
    meant = f"; {unknown[0]} is no key of it{did_you_mean(unknown[0], RANGE)}" if unknown else ""
    reader.problems.append(
        f"factors.{path} = {shortened(entry)}: must be an array of values or a table with low and high{meant}"
    )
    return None


def _range(path: str, entry: Mapping[str, Any], low: Any, high: Any, reader: _Reader) -> SweepFactor | None:
    scale = entry.get("scale", "linear")
    logarithmic = scale == "logarithmic"
    if scale not in SCALES:
        meant = did_you_mean(scale, SCALES) if isinstance(scale, str) else ""
        reader.problems.append(f"factors.{path}.scale = {shortened(scale)}: must be linear or logarithmic{meant}")
        return None
    if not isinstance(low, int | float) or not isinstance(high, int | float) or not low < high:
        reader.problems.append(
            f"factors.{path}: low = {shortened(low)} must be a number less than high = {shortened(high)}"
        )
        return None
    if logarithmic and low <= 0:
        reader.problems.append(f"factors.{path}.low = {low:g}: must be greater than 0 on a logarithmic scale")
        return None
    levels = entry.get("levels")
    if levels is None:
        return SweepFactor(path=path, low=float(low), high=float(high), logarithmic=logarithmic)
    if not _is_count(levels) or not 2 <= levels <= MOST_LEVELS:
        reader.problems.append(
            f"factors.{path}.levels = {shortened(levels)}: must be a whole number from 2 to {MOST_LEVELS}"
        )
        return None
    places = np.geomspace(low, high, levels) if logarithmic else np.linspace(low, high, levels)
    whole = isinstance(low, int) and isinstance(high, int) and bool(np.all(places == np.round(places)))
    return SweepFactor(path=path, levels=tuple(int(p) if whole else float(p) for p in places))


def _design(table: Any, factors: tuple[SweepFactor, ...], reader: _Reader) -> SweepDesign | None:
    if not isinstance(table, Mapping) or not table.keys() <= DESIGN:
        unknown = sorted(table.keys() - DESIGN) if isinstance(table, Mapping) else []
        meant = f"; {unknown[0]} is no key of it{did_you_mean(unknown[0], DESIGN)}" if unknown else ""
        reader.problems.append(f"design = {shortened(table)}: must be a table with kind, samples and seed{meant}")
        return None
    kind = table.get("kind", "grid")
    if not isinstance(kind, str) or kind not in KINDS:
        meant = did_you_mean(kind, KINDS) if isinstance(kind, str) else ""
        reader.problems.append(f"design.kind = {shortened(kind)}: must be one of {', '.join(KINDS)}{meant}")
        return None
    ranges = [factor.path for factor in factors if not factor.levels]
    if kind in ("grid", "list"):
        reader.problems += [f"factors.{path}: must have levels in a {kind}" for path in ranges]
        reader.problems += [f"design.{key}: has no meaning in a {kind}" for key in ("samples", "seed") if key in table]
        if kind == "list" and len({len(factor.levels) for factor in factors}) > 1:
            reader.problems.append("factors: must all have equally many values in a list")
        return SweepDesign(factors=factors, kind=kind)
    reader.problems += [
        Problem.of(
            f"factors.{path}",
            "",
            f"takes whole numbers, {kind} draws fractions between low and high; give an array of values, or levels",
        )
        for path in ranges
        if _is_whole(path)
    ]
    samples, seed = table.get("samples"), table.get("seed", 0)
    if samples is None:
        reader.problems.append(f"design.samples: is missing; {kind} needs a whole number of them")
        return None
    if not _is_count(samples) or not 1 <= samples <= MOST_SAMPLES:
        reader.problems.append(
            f"design.samples = {shortened(samples)}: must be a whole number from 1 to {MOST_SAMPLES}"
        )
        return None
    if not _is_count(seed) or not 0 <= seed < 2**63:
        reader.problems.append(f"design.seed = {shortened(seed)}: must be a whole number from 0 to 2⁶³ − 1")
        return None
    return SweepDesign(factors=factors, kind=kind, number=samples, seed=seed)
