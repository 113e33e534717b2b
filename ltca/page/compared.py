"""A second run, or a measured transmission error, beside the first."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import degrees, isfinite, pi
from pathlib import Path
from typing import Any

import numpy as np

from ltca.arrays import FloatArray
from ltca.drive.units.quantities import ARCMIN, ARCSEC
from ltca.errors import DamagedFileError, DriveError, one_line, printable, shortened
from ltca.output.netcdf import DAMAGE, read_netcdf, require_known_schema
from ltca.output.regular_files import read_regular
from ltca.page.run_arrays import bearing_curves, contact_arrays
from ltca.reading.toml_text import read_text

ANGLES = {"crank_angle_deg": pi / 180.0, "crank_angle_rad": 1.0}
ERRORS = {
    "transmission_error_arcsec": 1.0, "transmission_error_arcmin": ARCSEC / ARCMIN, "transmission_error_rad": ARCSEC,
}  # fmt: skip
"""Columns of a measured transmission error, and what they are times, in rad and arc seconds."""
LARGEST_SUMMARY = 50_000_000
"""Bytes of a ``summary.json``; one of a hundred cases has a megabyte."""
MOST_MEASURED = 200_000
"""Values of a measured curve."""
MOST_POSITIONS = 3600
"""Of a measured curve on a page; every second of more, or every third."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """A second run or measured curve for comparison.

    Attributes
    ----------
    name : str
        Of it, for legends.
    told : str
        What it is, in words.
    cases : tuple of str
        Its cases; none of a measured curve.
    arrays : dict of str to array
        As `ltca.page.run_arrays.run_arrays` has them, of the torque of the run.
    summaries : dict of str to dict
        Scalars by case; none of a measured curve, or where ``summary.json`` is not beside the results.
    """

    name: str
    told: str
    cases: tuple[str, ...]
    arrays: dict[str, FloatArray]
    summaries: dict[str, dict[str, float | None]] = field(default_factory=dict)


def read_compared(path: Path) -> Compared:
    """Read what a run is to be compared with; `DriveError` when there is none, or it holds something else.

    The path is a folder that ``cyclo run`` wrote, its ``results.nc``, or a file of comma separated values with a measured
    transmission error: columns ``crank_angle_deg`` (or ``_rad``) and ``transmission_error_arcsec`` (or ``_arcmin``, ``_rad``).
    """
    results = path / "results.nc" if path.is_dir() else path
    if results.suffix == ".csv":
        return _measured(results)
    if results.exists() and not results.is_file():
        raise DriveError(
            [f"--compare = {path}: {results.name} is not a regular file; give the folder of a run or a .csv"]
        )
    if results.suffix != ".nc" or not results.exists():
        raise DriveError([f"--compare = {path}: holds no results.nc; give the folder of a run or a .csv"])
    return _of_run(results)


def _of_run(results: Path) -> Compared:
    try:
        dataset = read_netcdf(results, "results of cyclo run")
        require_known_schema(results, dataset.attrs)
        cases = tuple(str(name) for name in dataset["case"].values)
        arrays: dict[str, FloatArray] = {"angle": dataset["crank_angle"].values}
        for number in range(len(cases)):
            one = dataset.isel(case=number)
            arrays |= {f"{number}/full/{name}": values for name, values in contact_arrays(one).items()}
            arrays[f"{number}/full/te"] = one["transmission_error"].values * ARCSEC
            arrays[f"{number}/light/te"] = one["transmission_error_light"].values * ARCSEC
            arrays |= {f"{number}/{name}": values for name, values in bearing_curves(one).items()}
        _require_positions(arrays)
    except DamagedFileError as error:
        raise DriveError([f"--compare = {error}"]) from error
    except DAMAGE as error:
        raise DriveError([f"--compare = {results}: is no result of cyclo run: {shortened(str(error))}"]) from error
    told = dataset.attrs
    model = printable(str(told.get("compliance", "")))
    words = f"{printable(str(told.get('drive', '')))}, {model}, cyclo {printable(str(told.get('version', '')))}"
    return Compared(
        name=model or "second run", told=words, cases=cases, arrays=arrays, summaries=_summaries(results.parent)
    )


def _require_positions(arrays: dict[str, FloatArray]) -> None:
    """Refuse arrays without a number for every position."""
    positions = arrays["angle"].shape
    for name, values in arrays.items():
        alone = name == "angle" or name.endswith("/te")
        if values.dtype.kind != "f" or values.shape[-1:] != positions or values.ndim != (1 if alone else 3):
            raise ValueError(f"{name} has not one number for each position")


def _summaries(folder: Path) -> dict[str, dict[str, float | None]]:
    path = folder / "summary.json"
    try:
        cases = json.loads(read_regular(path, LARGEST_SUMMARY))["cases"]
        if any(not isinstance(one, int | float | None) for case in cases.values() for one in case.values()):
            raise ValueError("it holds what is no number")
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DriveError([f"--compare = {path}: is no summary of cyclo run: {one_line(error)}"]) from error
    return dict(cases)


def _measured(path: Path) -> Compared:
    lines = [line for line in read_text(path).lstrip("\ufeff").splitlines() if line.strip() and line[0] != "#"]
    head = next(csv.reader(lines[:1]), [])
    names = [name.strip() for name in head]
    angle, error = ([name for name in names if name in known] for known in (ANGLES, ERRORS))
    if len(angle) != 1 or len(error) != 1:
        raise DriveError(
            [
                f"--compare = {path}: must have one column of {' | '.join(ANGLES)} and one of {' | '.join(ERRORS)}, "
                f"divided by commas; it has {shortened(', '.join(names))}"
            ]
        )
    if len(lines) > MOST_MEASURED:
        told = f"holds {len(lines) - 1} values: must be at most {MOST_MEASURED}; leave some out"
        raise DriveError([f"--compare = {path}: {told}"])
    places, found = (names.index(angle[0]), names.index(error[0])), []
    for number, row in enumerate(csv.reader(lines[1:]), start=2):
        try:
            values = [float(row[place]) for place in places]
        except (ValueError, IndexError):
            values = [float("nan")]
        if not all(isfinite(value) for value in values):
            raise DriveError([f"--compare = {path}: row {number}: must hold two finite numbers, not {shortened(row)}"])
        found.append(values)
    if not found:
        raise DriveError([f"--compare = {path}: holds no measured value"])
    table = np.array(found)[:: 1 + len(found) // MOST_POSITIONS]
    turned = np.mod(table[:, 0] * ANGLES[angle[0]], 2.0 * np.pi)
    order = np.argsort(turned, kind="stable")
    arrays = {"measured/angle": turned[order], "measured/te": table[order, 1] * ERRORS[error[0]]}
    span = f"{degrees(turned.min()):.4g}° … {degrees(turned.max()):.4g}°"
    range_of = f"peak to peak {np.ptp(arrays['measured/te']):.3g}″"
    told = f"{path.name}, {len(found)} measured values, {span}, {range_of}"
    return Compared(name="measured", told=told, cases=(), arrays=arrays)


def matched(cases: Mapping[str, Any], compared: Compared) -> list[int]:
    """Return the case of the second run for each of the first: that of the same name, otherwise the first."""
    return [compared.cases.index(name) if name in compared.cases else 0 for name in cases]
