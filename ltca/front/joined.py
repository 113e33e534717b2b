"""`ltca.concat`: several results in one dataset, with a case for each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.analysis.loaded_analysis import LoadedAnalysis
from ltca.analysis.results import build_dataset, check_common_shape
from ltca.errors import DriveError, shortened
from ltca.facade import AnalysisResult, by_angle

if TYPE_CHECKING:
    import xarray as xr

OF_CASES = ("fingerprint", "shared_coefficients", "coefficients_code_hash", "title", "status")
"""Attributes that have an entry for each case already, or are of all cases together."""


def concat(
    results: Iterable[AnalysisResult] | Mapping[str, AnalysisResult], names: Sequence[str] | None = None
) -> xr.Dataset:
    """Join results in one dataset along the dimension ``case``.

    Parameters
    ----------
    results : iterable of AnalysisResult, or mapping of str to AnalysisResult
        At the same crank angles, of drives with as many pins, rollers, holes, discs and cranks. Torques, drives and engines may
        differ; attributes that differ, ``compliance`` or ``drive_file``, become coordinates of the case.
    names : sequence of str, optional
        Name of each case; by default the keys of a mapping, or the names that the results have.

    Returns
    -------
    xarray.Dataset
        As ``results.nc`` of ``cyclo run``. What one case has and another has not, as stresses along walls, is NaN there.

    Raises
    ------
    DriveError
        When results do not fit one dataset, each with its name and reason.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> found = [ltca.analyse(drive, 4, torque=f"{torque} N·m") for torque in (100, 200)]
    >>> both = ltca.concat(found, names=["light", "heavy"])
    >>> both["torque"].sel(case="heavy").item(), both["pin_load"].sizes["case"]
    (200000.0, 2)
    """
    analyses = {name: result.loaded for name, result in _named(results, names).items()}
    check_common_shape({name: analysis.drive for name, analysis in analyses.items()}, "leave it out")
    _check_angles_and_teeth(analyses)
    dataset = build_dataset(", ".join(dict.fromkeys(one.drive.name for one in analyses.values())), analyses)
    own = [build_dataset(one.drive.name, {name: one}).attrs for name, one in analyses.items()]
    for key in dict.fromkeys(key for attrs in own for key in attrs if key not in OF_CASES):
        each = [attrs.get(key, "") for attrs in own]
        if any(value != each[0] for value in each):
            dataset.attrs.pop(key, None)
            dataset = dataset.assign_coords({key: ("case", each)})
    return by_angle(dataset)


def _named(results: Any, names: Sequence[str] | None) -> dict[str, AnalysisResult]:
    """Results by the names of their cases."""
    if isinstance(results, Mapping):
        if names is not None:
            raise DriveError(["names: must be left out, a mapping has the names of the results"])
        names, results = list(results), results.values()
    if isinstance(results, AnalysisResult) or not isinstance(results, Iterable):
        raise DriveError([f"results: must be several results of analyse, not one {type(results).__name__}"])
    each = list(results)
    if not each:
        raise DriveError(["results: is empty; must be one result of analyse at least"])
    problems = [
        f"results: entry {number} is a {type(one).__name__}, must be a result of analyse"
        for number, one in enumerate(each)
        if not isinstance(one, AnalysisResult)
    ]
    if problems:
        raise DriveError(problems)
    if names is None:
        names = [one.case for one in each]
    elif isinstance(names, str) or len(names) != len(each):
        count = "a single text" if isinstance(names, str) else f"{len(names)} names"
        raise DriveError([f"names: has {count}, must have one for each of {len(each)} results"])
    for number, name in enumerate(names):
        if not isinstance(name, str) or not name:
            raise DriveError([f"names: entry {number} is {shortened(name)}, must be a name"])
        if name in names[:number]:
            first = list(names).index(name)
            raise DriveError(
                [f"case {shortened(name)}: is the name of results {first} and {number}; give names=[…] that differ"]
            )
    return dict(zip(names, each, strict=True))


def _check_angles_and_teeth(analyses: Mapping[str, LoadedAnalysis]) -> None:
    """Refuse cases at other crank angles than the first, and others of another number of lobes where walls have stresses."""
    (first, one), *others = analyses.items()
    angles, teeth = one.full.crank_angle, one.drive.disc.number_of_teeth
    problems = []
    for name, other in others:
        found = other.full.crank_angle
        if found.size != angles.size:
            problems.append(
                f"case {name}: is at {found.size} crank angles, must be at the {angles.size} of case {first}"
            )
        elif not np.array_equal(found, angles):
            place = int(np.argmax(found != angles))
            problems.append(
                f"case {name}: crank_angle {place} is {found[place]:.9g} rad, must be {angles[place]:.9g} rad as in case {first}"
            )
    walls = any(analysis.wall_stresses for analysis in analyses.values())
    problems += [
        f"case {name}: has {other.drive.disc.number_of_teeth} lobes, must have the {teeth} of case {first}"
        for name, other in others
        if walls and other.drive.disc.number_of_teeth != teeth
    ]
    if problems:
        raise DriveError(problems)
