"""Files of influence coefficients: written whole with a checksum, read only when schema, laws and checksum hold.

What is read may come from anybody: links to other files are not followed, what a file only declares is refused before
memory is taken for it, nothing in it is executed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.errors import DamagedFileError, PlaceError, one_line
from ltca.output.files import whole_file
from ltca.output.netcdf import write_netcdf
from ltca.output.resources import available_memory
from ltca.reading.coefficient_laws import STATED_QUALITY, check_coefficients
from ltca.reading.coefficient_schema import NEEDED, require_schema

if TYPE_CHECKING:
    import xarray as xr

CHECKSUM = "checksum"
# HDF5's own filters (deflate, shuffle, Fletcher, szip, n-bit, scale-offset); any other is code from elsewhere.
LARGEST_FILTER = 6
# Deflate packs no more than 1032 to one; what is declared beyond that is not in the file.
LARGEST_PACKING = 1100
SMALL = 1 << 20
# What HDF5, netCDF and numpy raise on damaged files.
DAMAGE = (
    OSError,
    ValueError,
    KeyError,
    RuntimeError,
    TypeError,
    AttributeError,
    OverflowError,
    MemoryError,
    IndexError,
)

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
    dataset = _read(path)
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
    import h5py

    try:
        with h5py.File(path, "r") as file:
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


def _read(path: Path) -> xr.Dataset:
    import h5py
    import xarray as xr

    if not path.is_file():
        raise DamagedFileError(f"{path}: no such file")
    try:
        with h5py.File(path, "r") as file:
            problems = list(_foreign(file, path.stat().st_size))
        if not problems:
            return xr.load_dataset(path, engine="h5netcdf", decode_times=False, decode_timedelta=False)
    except DAMAGE as error:
        raise DamagedFileError(f"{path}: cannot be read as a coefficient file (netCDF-4): {one_line(error)}") from error
    raise DamagedFileError(f"{path}: cannot be read as a coefficient file: {'; '.join(problems[:3])}")


def _foreign(file: Any, size: int) -> Iterator[str]:
    """What a file must not have: links, data that lie elsewhere, filters from elsewhere, sizes that are not there."""
    import h5py

    declared = 0
    for name in file:
        link = file.get(name, getlink=True)
        if not isinstance(link, h5py.HardLink):
            yield f"{name} is a link to {getattr(link, 'filename', None) or 'another place'}, which is not followed"
            continue
        item = file[name]
        if not isinstance(item, h5py.Dataset):
            continue  # groups are not read
        if item.external or item.is_virtual:
            yield f"{name} lies in another file, which is not read"
        filters = item.id.get_create_plist()
        if any(filters.get_filter(number)[0] > LARGEST_FILTER for number in range(filters.get_nfilters())):
            yield f"{name} is packed by a filter that HDF5 does not bring"
        declared += int(np.prod(item.shape or (1,), dtype=object)) * item.dtype.itemsize
    if declared > LARGEST_PACKING * size + SMALL or declared > 0.5 * available_memory():
        yield f"it declares {declared:.3g} bytes; the file has {size}"
