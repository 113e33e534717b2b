"""Coefficients of the discs that a validation needs, derived once and kept in files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem.body.elasticity import PlaneState
from fem.coefficients.dataset import derive_coefficients
from ltca.compliance.coefficients import InfluenceCoefficients, load_coefficients
from ltca.drive.parts import Clearance, Drive
from ltca.drive.single_discs import single_discs
from ltca.errors import DamagedFileError
from ltca.output.provenance import code_hash
from ltca.reading.coefficient_file import read_coefficients, write_coefficients
from validation.compare.model_positions import DiscCoefficients

if TYPE_CHECKING:
    from ltca.output.labelled import Labelled


def nominal_coefficients_of(
    drive: Drive, case: str, folder: Path, *, progress: Callable[[str], None] | None = None
) -> DiscCoefficients | None:
    """Return the coefficients derived without clearance that all clearance cases could share; None without clearance."""
    singles = single_discs(drive)
    if all(single.clearance == Clearance() for single in singles):
        return None
    found = []
    for single in singles:
        _, nominal = coefficients_of(replace(single, clearance=Clearance()), case, folder, progress=progress)
        found.append(nominal.lent_to(single))
    return _one_or_each(found)


def disc_coefficients_of(
    drive: Drive, case: str, folder: Path, **options: Any
) -> tuple[dict[str, Labelled], DiscCoefficients]:
    """Return the coefficients of all discs of a case, derived once for each distinct shape; options as for `coefficients_of`.

    The datasets are keyed by the case, of several shapes by case and first disc.
    """
    singles = single_discs(drive)
    shapes: dict[str, tuple[str, Labelled]] = {}
    found = []
    for number, single in enumerate(singles):
        dataset, coefficients = coefficients_of(single, case, folder, **options)
        shapes.setdefault(single.shape_fingerprint(), (f"{case}, disc {number}", dataset))
        found.append(coefficients)
    datasets = dict(shapes.values())
    return (datasets if len(datasets) > 1 else {case: next(iter(datasets.values()))}), _one_or_each(found)


def _one_or_each(found: list[InfluenceCoefficients]) -> DiscCoefficients:
    return found[0] if len(found) == 1 else tuple(found)


def coefficients_of(
    drive: Drive,
    case: str,
    folder: Path,
    *,
    plane: PlaneState = "strain",
    size: float = 1.0,
    progress: Callable[[str], None] | None = None,
) -> tuple[Labelled, InfluenceCoefficients]:
    """Return the coefficients of a drive of one disc, from its kept file if that fits: content, and as the LTCA reads it."""
    # The code that derived them is in the name: what older code kept is never compared.
    path = folder / f"{drive.shape_fingerprint()}_{plane}_{size:g}_{code_hash('fem', 'ltca')}.nc"
    try:
        dataset = read_coefficients(path)
    except DamagedFileError as error:
        if path.exists() and progress is not None:
            progress(f"{error}; derived again")
        derived = derive_coefficients(drive, case=case, size=size, state=plane, progress=progress)
        write_coefficients(derived, path)
        dataset = read_coefficients(path)
    return dataset, load_coefficients(path, drive)
