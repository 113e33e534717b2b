"""netCDF files that survive a full disc: the HDF5 library never sees a failed write.

HDF5 ends the process with a segmentation fault when its last write fails. It writes to a stream of ours, which keeps in
memory what the disc no longer takes; when the file is closed the stream says what went wrong.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ltca.errors import FaultError

if TYPE_CHECKING:
    import xarray as xr


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
                    done += os.pwrite(self._descriptor, content[done:], self._place + done)
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
        found = bytearray(os.pread(self._descriptor, count, self._place).ljust(count, b"\0"))
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
    """Give a stream for ``h5netcdf.File(stream, "w")``; what the disc did not take is raised when the block ends.

    Parameters
    ----------
    path : Path
        From `ltca.output.files.whole_file`.

    Yields
    ------
    DiscStream
        Call its ``check`` between the parts of a large file.

    Raises
    ------
    OSError
        When the disc is full or fails.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o666)
    try:
        stream = DiscStream(descriptor)
        yield stream
        stream.check()
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_netcdf(dataset: xr.Dataset, part: Path, encoding: Mapping[Any, Mapping[str, Any]] | None = None) -> None:
    """Write a dataset as netCDF-4.

    Parameters
    ----------
    dataset : Dataset
        What to write.
    part : Path
        From `ltca.output.files.whole_file`.
    encoding : mapping, optional
        Of single variables, as in ``Dataset.to_netcdf``.

    Raises
    ------
    OSError
        When the disc is full or fails.
    FaultError
        When memory is not enough.
    """
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    try:
        with netcdf_stream(part) as stream, h5netcdf.File(stream, "w") as file:
            dataset.dump_to_store(H5NetCDFStore(file), encoding=encoding)
    except MemoryError as error:
        raise FaultError(f"{part.name}: {dataset.nbytes / 1e9:.3g} GB do not fit into memory: take fewer") from error
