"""netCDF files: read without trust, written so that they survive a full disc.

What is read may come from anybody: links to other files are not followed, what a file only declares is refused before
memory is taken for it, nothing in it is executed. What is written goes to a stream of ours: HDF5 ends the process with a
segmentation fault when its last write fails. The stream keeps in memory what the disc no longer takes; when the file is
closed it says what went wrong.
"""

from __future__ import annotations

import io
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ltca.errors import DamagedFileError, FaultError, one_line
from ltca.output.labelled import LabelledArray, LabelledDataset
from ltca.output.regular_files import NotReadableError, regular_file
from ltca.output.resources import available_memory
from ltca.quantities import SCHEMA_VERSION

if TYPE_CHECKING:
    import h5py
    import xarray as xr


# HDF5's own filters (deflate, shuffle, Fletcher, szip, n-bit, scale-offset); any other is code from elsewhere.
LARGEST_FILTER = 6
# Deflate packs no more than 1032 to one; what is declared beyond that is not in the file.
LARGEST_PACKING = 1100
SMALL = 1 << 20
# Bytes of alike place together: of numbers kept to few bits the last bytes are zero.
DEFLATED = {"compression": "gzip", "compression_opts": 6, "shuffle": True}
NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable."
HIDDEN = frozenset((
    "CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "_Netcdf4Dimid", "_Netcdf4Coordinates", "_NCProperties",
))  # fmt: skip
"""Attributes by which netCDF lies in HDF5."""
CONVENTIONS = frozenset((
    "scale_factor", "add_offset", "missing_value", "_Unsigned", "dtype", "_Encoding", "_ChunkSizes", "bounds", "grid_mapping",
    "ancillary_variables", "formula_terms", "cell_measures",
))  # fmt: skip
"""Attributes by which values mean something else than what is stored, or name other variables."""
DAMAGE = (
    OSError, ValueError, KeyError, RuntimeError, TypeError, AttributeError, OverflowError, MemoryError, IndexError,
)  # fmt: skip
"""What HDF5, netCDF and numpy raise on damaged files."""


@contextmanager
def opened_hdf5(path: Path) -> Iterator[Any]:
    """Open an HDF5 file that has not been checked, for reading (`h5py.File`).

    Raises `OSError` when it is no regular file, or no HDF5; `DAMAGE` names what may be raised while the block runs.
    """
    import h5py

    with regular_file(path), h5py.File(path, "r") as file:
        yield file


def require_sound_netcdf(path: Path, what: str, *, whole: bool) -> None:
    """Refuse a file with links, data that lie elsewhere, filters from elsewhere, or sizes that are not there.

    `what` names the file in messages, as "a coefficient file"; `whole` tells whether all of it is going to be read into memory.
    Raises `DamagedFileError`, also when it cannot be read.
    """
    try:
        with opened_hdf5(path) as file:
            problems = list(_foreign(file, path.stat().st_size, whole))
    except FileNotFoundError as error:
        raise DamagedFileError(f"{path}: no such file") from error
    except DAMAGE as error:
        raise _unreadable(path, what, error) from error
    if problems:
        raise DamagedFileError(f"{path}: cannot be read as {what}: {'; '.join(problems[:3])}")


def read_netcdf(path: Path, what: str) -> LabelledDataset:
    """Return a netCDF file of any origin, read into memory, after `require_sound_netcdf`, whose errors it raises."""
    require_sound_netcdf(path, what, whole=True)
    try:
        with opened_hdf5(path) as file:
            found = _plain(file)
        if found is not None:
            return found
        import xarray as xr

        return LabelledDataset.of(xr.load_dataset(path, engine="h5netcdf", decode_times=False, decode_timedelta=False))
    except DAMAGE as error:
        raise _unreadable(path, what, error) from error


def _plain(file: h5py.File) -> LabelledDataset | None:
    """The content of a file as `write_netcdf` writes it, without xarray, whose import takes half a second.

    None of a file with anything that needs conventions: packed or masked values, texts of fixed length, groups, dimensions
    without scales. Those are xarray's.
    """
    import h5py

    variables, related, scales = dict[str, LabelledArray](), set[str](), list[str]()
    attrs = _plain_attributes(file, ())
    if attrs is None:
        return None
    related |= {*str(attrs.pop("coordinates", "")).split()}
    for name, item in file.items():
        if not isinstance(item, h5py.Dataset):
            return None
        if bytes(item.attrs.get("NAME", b"")).startswith(NO_VARIABLE):
            continue
        is_scale = item.attrs.get("CLASS") == b"DIMENSION_SCALE"
        own = [[name]] if is_scale else [[scale.name[1:] for scale in axis.values()] for axis in item.dims]
        told = _plain_attributes(item, ("_FillValue",))
        text = h5py.check_string_dtype(item.dtype) is not None
        fill = item.attrs.get("_FillValue")
        masked = fill is not None and not (item.dtype.kind == "f" and np.all(np.isnan(fill)))
        plain = all(len(names) == 1 for names in own) and len(own) == item.ndim and (text or item.dtype.kind in "iuf")
        if told is None or masked or not plain or {*told} & CONVENTIONS or (text and item.dtype.kind != "O"):
            return None
        related |= {*str(told.pop("coordinates", "")).split()}
        scales += [name] if is_scale else []
        values = np.asarray(item.asstr()[...] if text else item[...])
        # As xarray has them: of the machine's byte order, texts as texts.
        values = values.astype(str) if text else values.astype(values.dtype.newbyteorder("="), copy=False)
        variables[name] = LabelledArray(tuple(names[0] for names in own), values, told)
    return LabelledDataset(variables, tuple(name for name in variables if name in related or name in scales), attrs)


def _plain_attributes(item: Any, without: Collection[str]) -> dict[str, Any] | None:
    """Attributes as h5netcdf gives them, one value alone; None where one needs decoding."""
    found = dict[str, Any]()
    for name, value in item.attrs.items():
        if name in HIDDEN or name in without:
            continue
        if isinstance(value, bytes) or np.asarray(value).dtype.kind in "SV":
            return None
        if isinstance(value, np.ndarray):
            if value.size == 1:
                value = value.reshape(-1)[0]
            elif value.dtype.kind == "O":
                value = value.tolist()
        found[name] = value
    return found


def require_known_schema(path: Path, attributes: Mapping[str, Any]) -> None:
    """Refuse (`DamagedFileError`) a dataset of a later schema than this version knows; older files may have no number."""
    try:
        version = int(attributes.get("schema_version", 0))
    except (TypeError, ValueError) as error:
        raise DamagedFileError(f"{path}: schema_version is no whole number") from error
    if version > SCHEMA_VERSION:
        raise DamagedFileError(
            f"{path}: has schema version {version}, this version of cyclo reads up to {SCHEMA_VERSION}: update cyclo"
        )


def _unreadable(path: Path, what: str, error: Exception) -> DamagedFileError:
    told = error.strerror if isinstance(error, NotReadableError) else one_line(error)
    return DamagedFileError(f"{path}: cannot be read as {what} (netCDF-4): {told}")


def _foreign(file: Any, size: int, whole: bool) -> Iterator[str]:
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
    if declared > LARGEST_PACKING * size + SMALL or (whole and declared > 0.5 * available_memory()):
        yield f"it declares {declared:.3g} bytes; the file has {size}"


class DiscStream(io.RawIOBase):
    """A file opened for reading and writing that remembers the first failed write instead of raising it.

    Parameters
    ----------
    descriptor : int
        Of a file opened for both.
    """

    def __init__(self, descriptor: int) -> None:
        super().__init__()
        self._descriptor = descriptor
        self._place = self._size = 0
        self._kept: list[tuple[int, bytes]] = []
        self.failure: OSError | None = None

    def readable(self) -> bool:
        """Tell that it can be read."""
        return True

    def writable(self) -> bool:
        """Tell that it can be written."""
        return True

    def seekable(self) -> bool:
        """Tell that it has places."""
        return True

    def tell(self) -> int:
        """Return the place."""
        return self._place

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to a place and return it."""
        self._place = offset + {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        return self._place

    def truncate(self, size: int | None = None) -> int:
        """Cut the file off, or lengthen it, and return its size."""
        self._size = self._place if size is None else size
        if self.failure is None:
            try:
                os.ftruncate(self._descriptor, self._size)
            except OSError as error:
                self.failure = error
        return self._size

    def write(self, data: Any) -> int:
        """Write to the disc, or to memory once the disc takes no more; return the number of bytes."""
        content = bytes(data)
        if self.failure is None:
            try:
                done = 0
                while done < len(content):
                    os.lseek(self._descriptor, self._place + done, os.SEEK_SET)
                    done += os.write(self._descriptor, content[done:])
            except OSError as error:
                self.failure = error
        if self.failure is not None:
            self._kept.append((self._place, content))
        self._place += len(content)
        self._size = max(self._size, self._place)
        return len(content)

    def readinto(self, buffer: Any) -> int:
        """Read what was written, wherever it is, and return the number of bytes."""
        count = max(0, min(len(buffer), self._size - self._place))
        os.lseek(self._descriptor, self._place, os.SEEK_SET)
        found = bytearray(os.read(self._descriptor, count).ljust(count, b"\0"))
        for place, content in self._kept:
            first, last = max(place, self._place), min(place + len(content), self._place + count)
            if first < last:
                found[first - self._place : last - self._place] = content[first - place : last - place]
        buffer[:count] = found
        self._place += count
        return count

    def check(self) -> None:
        """Raise the failed write, if there was one."""
        if self.failure is not None:
            raise self.failure


@contextmanager
def netcdf_stream(path: Path) -> Iterator[DiscStream]:
    """Give a `DiscStream` to a part of `ltca.output.files.whole_file`, for ``h5netcdf.File(stream, "w")``.

    Its ``check`` is called between the parts of a large file; `OSError` is raised when the block ends and the disc was full.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0), 0o666)
    try:
        stream = DiscStream(descriptor)
        yield stream
        stream.check()
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_netcdf(dataset: xr.Dataset | LabelledDataset, part: Path, packed: Collection[str] = ()) -> None:
    """Write a dataset as netCDF-4 to a part of `ltca.output.files.whole_file`; variables in `packed` are deflated.

    Raises `OSError` when the disc is full or fails, `FaultError` when memory is not enough.
    """
    import h5py

    labelled = dataset if isinstance(dataset, LabelledDataset) else LabelledDataset.of(dataset)
    try:
        with netcdf_stream(part) as stream, h5py.File(stream, "w", track_order=True) as file:
            _write(file, labelled, packed)
    except MemoryError as error:
        size = sum(each.values.nbytes for each in labelled.variables.values())
        raise FaultError(f"{part.name}: {size / 1e9:.3g} GB do not fit into memory: take fewer") from error


def _write(file: h5py.File, dataset: LabelledDataset, packed: Collection[str]) -> None:
    """Write a dataset as netCDF-4 lies in HDF5 (netCDF User's Guide, "File Format Specifications"), with xarray's conventions.

    HDF5 itself takes a seventh of the time of h5netcdf, which opens every dimension again for each variable.
    """
    import h5py

    version = f"version=2,h5py={h5py.__version__},hdf5={h5py.version.hdf5_version}"
    file.attrs["_NCProperties"] = np.array(version, dtype=h5py.string_dtype("ascii", len(version)))
    related, apart = _related_coordinates(dataset)
    for name, value in {**dataset.attrs, **apart}.items():
        file.attrs[name] = _attribute(value)
    scales: dict[str, h5py.Dataset] = {}
    numbers = {name: number for number, name in enumerate(dataset.sizes)}
    for name, size in dataset.sizes.items():
        if name not in dataset or dataset[name].dims != (name,):
            scales[name] = file.create_dataset(name, (size,), ">f4", track_order=True, **_growing((size,)))
            scales[name].make_scale(NO_VARIABLE + f"{size:10d}".encode("ascii"))
            scales[name].attrs["_Netcdf4Dimid"] = np.int32(numbers[name])
    written = {name: _written(file, name, each, packed) for name, each in dataset.variables.items()}
    for name in [name for name in numbers if name not in scales]:
        scales[name] = written[name]
        scales[name].make_scale(name)
    for name, variable in dataset.variables.items():
        place, told = written[name], dict[str, Any]()
        for axis, dim in enumerate(variable.dims):
            if dim != name:
                place.dims[axis].attach_scale(scales[dim])
        if variable.dims:
            told["_Netcdf4Coordinates"] = np.array([numbers[dim] for dim in variable.dims], dtype=np.int32)
            place.attrs["_Netcdf4Dimid"] = np.int32(numbers[variable.dims[0]])
        if variable.values.dtype.kind == "f":
            told["_FillValue"] = np.full(1, np.nan, dtype=variable.values.dtype)
        if variable.values.dtype.kind == "b":
            told["dtype"] = "bool"  # xarray reads it back as such
        for key, value in {**told, **variable.attrs, **related.get(name, {})}.items():
            place.attrs[key] = _attribute(value)


def _written(file: h5py.File, name: str, variable: LabelledArray, packed: Collection[str]) -> h5py.Dataset:
    """Write the values of a variable."""
    import h5py

    values = variable.values
    kind = values.dtype.kind
    if kind not in "biufUO":
        raise TypeError(f"{name}: netCDF has no values of type {values.dtype}")
    stored: Any = {"U": h5py.string_dtype(), "O": h5py.string_dtype(), "b": "i1"}.get(kind, values.dtype)
    options: dict[str, Any] = dict(DEFLATED) if name in packed and values.ndim else {}
    if kind == "f":
        options["fillvalue"] = np.array(np.nan, dtype=values.dtype)
    place = file.create_dataset(name, values.shape, stored, track_order=True, **options, **_growing(values.shape))
    if values.size:
        place[...] = values.astype(object) if kind == "U" else values
    return place


def _growing(shape: tuple[int, ...]) -> dict[str, Any]:
    """How HDF5 stores what has no size: a dimension of none is an unlimited one in netCDF."""
    if 0 not in shape:
        return {}
    return {"maxshape": tuple(size or None for size in shape), "chunks": tuple(max(size, 1) for size in shape)}


def _attribute(value: Any) -> Any:
    """An attribute as netCDF has it: texts alone or a row of them, numbers in a row."""
    import h5py

    array = np.asarray(value)
    if array.dtype.kind == "U":
        return str(value) if array.ndim == 0 else array.astype(h5py.string_dtype())
    if array.dtype.kind not in "iuf":
        raise TypeError(f"netCDF has no attributes of type {array.dtype}")
    return np.atleast_1d(array)


def _related_coordinates(dataset: LabelledDataset) -> tuple[dict[str, dict[str, str]], dict[str, str]]:
    """Attributes ``coordinates`` of the variables whose dimensions they share, and of the file those of none (CF, chapter 5)."""
    places = {name: {*dataset[name].dims} for name in dataset.coordinates if dataset[name].dims != (name,)}
    related = {
        name: sorted(place for place, dims in places.items() if dims <= {*each.dims})
        for name, each in dataset.data_vars.items()
    }
    apart = sorted({*places}.difference(*related.values()))
    return (
        {name: {"coordinates": " ".join(own)} for name, own in related.items() if own},
        {"coordinates": " ".join(apart)} if apart else {},
    )
