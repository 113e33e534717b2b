"""``coefficients.nc``: written whole or not at all, read back as the dataset that was written."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from fem.coefficients.schema import require_schema
from fem.errors import MeshError
from ltca.output.files import whole_file

if TYPE_CHECKING:
    import xarray as xr


def require_writable(path: Path) -> None:
    """Make the folder of a file to come and check that it can be written to, before the work for it is done.

    Raises
    ------
    MeshError
        When it cannot.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise MeshError(f"cannot write {path}: {error.strerror or error}") from error


def write_coefficients(dataset: xr.Dataset, path: Path) -> Path:
    """Write coefficients.

    Parameters
    ----------
    dataset : Dataset
        From `derive_coefficients`.
    path : Path
        The file; its folder is made.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CycloError
        When it cannot be written.
    """
    with whole_file(path) as part:
        dataset.to_netcdf(part, engine="h5netcdf")
    return path


def read_coefficients(path: Path) -> xr.Dataset:
    """Read coefficients into memory.

    Raises
    ------
    MeshError
        When there is no such file, or it holds something else (`fem.coefficients.schema.require_schema`).
    """
    import xarray as xr

    if not path.is_file():
        raise MeshError(f"{path}: no such file")
    try:
        dataset = xr.load_dataset(path, engine="h5netcdf")
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        raise MeshError(f"{path}: cannot be read as coefficients (netCDF-4): {error}") from error
    require_schema(dataset, str(path))
    return dataset
