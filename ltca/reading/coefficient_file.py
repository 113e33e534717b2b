"""Files of influence coefficients: written whole with a checksum, read only when schema, laws and checksum hold.

What is read may come from anybody: links to other files are not followed, what a file only declares is refused before
memory is taken for it, nothing in it is executed.
"""

from __future__ import annotations

import hashlib
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.errors import DamagedFileError, PlaceError
from ltca.output.files import whole_file
from ltca.output.netcdf import DAMAGE, opened_hdf5, read_netcdf, write_netcdf
from ltca.reading.coefficient_laws import STATED_QUALITY, check_coefficients
from ltca.reading.coefficient_schema import NEEDED, require_schema

if TYPE_CHECKING:
    import xarray as xr

CHECKSUM = "checksum"

_LAWFUL: set[str] = set()
"""Checksums of contents whose laws this process has found to hold: a run reads its file more than once."""


def write_coefficients(dataset: xr.Dataset, path: Path) -> Path:
    """Write coefficients with a checksum.

    Parameters
    ----------
    dataset : Dataset
        As ``docs/theory/coefficients.md`` describes it.
    path : Path
        The file; its folder is made.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FaultError
        When it cannot be written.
    """
    with whole_file(path) as part:
        write_netcdf(dataset.assign_attrs({CHECKSUM: checksum_of(dataset)}), part)
    return path


def read_coefficients(path: Path, *, lawful: bool = True) -> xr.Dataset:
    """Read coefficients into memory.

    Parameters
    ----------
    path : Path
        The file.
    lawful : bool
        Whether to refuse what breaks a law; ``cyclo derive --check`` prints which instead.

    Returns
    -------
    Dataset
        Of the right schema.

    Raises
    ------
    DamagedFileError
        When there is no such file, it holds something else, its checksum is another, or a law is broken.
    """
    dataset = read_netcdf(path, "a coefficient file")
    require_schema(dataset, str(path))
    stated, checksum = dataset.attrs.get(CHECKSUM), checksum_of(dataset)
    if stated is not None and str(stated) != checksum:
        raise DamagedFileError(
            f"{path}: is damaged: its content does not have the checksum it states (who changed it on purpose removes the "
            f"attribute {CHECKSUM})"
        )
    if lawful and checksum not in _LAWFUL:
        broken = [
            check for check in check_coefficients(dataset) if not check.passed and check.name not in STATED_QUALITY
        ]
        if broken:
            said = "; ".join(f"{check.name} is {check.value:.4g}: must be {check.bounds}" for check in broken)
            raise DamagedFileError(f"{path}: breaks laws of influence coefficients (cyclo derive --check): {said}")
        _LAWFUL.add(checksum)
    return dataset


def require_replaceable(path: Path) -> None:
    """Refuse to derive into the place of a file that no derivation wrote.

    Parameters
    ----------
    path : Path
        ``--out``.

    Raises
    ------
    PlaceError
        When there is something else than coefficients with the checksum that `write_coefficients` gives them: notes, results
        of a run, a file of another code, a link.
    """
    if path.is_symlink() or (path.exists() and not _is_written_by_us(path)):
        raise PlaceError(
            f"--out {path}: is there and is no coefficient file that cyclo derive wrote: move it, or choose another place"
        )


def _is_written_by_us(path: Path) -> bool:
    """Look at names only, no number is read."""
    try:
        with opened_hdf5(path) as file:
            return CHECKSUM in file.attrs and all(name in file for name in NEEDED)
    except DAMAGE:
        return False


def checksum_of(dataset: xr.Dataset) -> str:
    """Return a hash of variables and attributes (hex), independent of how they are stored.

    Parameters
    ----------
    dataset : Dataset
        Units and descriptions of single variables do not count.
    """
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        variable = dataset.variables[name]
        if variable.dtype.kind not in "iubf":  # labels, and whatever else somebody has put in
            digest.update(f"{name} {variable.dims} {variable.values.tolist()}".encode("utf-8", "backslashreplace"))
            continue
        kind = "<f8" if variable.dtype.kind == "f" else "<i8"
        digest.update(f"{name} {variable.dims} {variable.shape} {kind}".encode())
        digest.update(np.ascontiguousarray(variable.values, dtype=kind).tobytes())
    for name in sorted(map(str, dataset.attrs)):
        if name != CHECKSUM:
            digest.update(f"{name} {_canonical(dataset.attrs[name])}".encode())
    return digest.hexdigest()


def _canonical(value: Any) -> str:
    if isinstance(value, Integral):
        return str(int(value))
    if isinstance(value, Real):
        return float(value).hex()
    return str(value)
