"""Coefficients of the discs that a validation needs, each derived once and kept as a file of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fem.body.elasticity import PlaneState
from fem.coefficients.dataset import derive_coefficients
from ltca.compliance.coefficients import InfluenceCoefficients, load_coefficients
from ltca.drive.parts import Clearance, Drive
from ltca.errors import DamagedFileError
from ltca.output.provenance import code_hash
from ltca.reading.coefficient_file import read_coefficients, write_coefficients

if TYPE_CHECKING:
    import xarray as xr


def nominal_coefficients_of(
    drive: Drive, case: str, folder: Path, *, progress: Callable[[str], None] | None = None
) -> InfluenceCoefficients | None:
    """Return the coefficients that all clearance cases could share, lent to this one; None when it has no clearance.

    Parameters
    ----------
    drive : Drive
        In the case.
    case : str
        Its name, for the record.
    folder : Path
        Where files are kept.
    progress : callable, optional
        Called with each step.
    """
    if drive.clearance == Clearance():
        return None
    _, nominal = coefficients_of(replace(drive, clearance=Clearance()), case, folder, progress=progress)
    return nominal.lent_to(drive)


def coefficients_of(
    drive: Drive,
    case: str,
    folder: Path,
    *,
    plane: PlaneState = "strain",
    size: float = 1.0,
    progress: Callable[[str], None] | None = None,
) -> tuple[xr.Dataset, InfluenceCoefficients]:
    """Return the coefficients of a case's disc, from its file if there is one that fits.

    Parameters
    ----------
    drive : Drive
        In the case.
    case : str
        Its name, for the record.
    folder : Path
        Where files are kept.
    plane : {"strain", "stress"}
        State of the bodies.
    size : float
        Multiple of the element edges.
    progress : callable, optional
        Called with each step.

    Returns
    -------
    Dataset, InfluenceCoefficients
        The file's content, and as the LTCA reads it from the file.

    Raises
    ------
    CycloError
        When meshing fails or the file cannot be written.
    """
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
