"""A disc that takes no more: one line, exit status 1, nothing half-written. A limit on the size of files stands for it."""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from ltca.errors import FaultError
from ltca.output.files import whole_file
from ltca.output.netcdf import DiscStream, write_netcdf

with suppress(ImportError):  # of POSIX: where limits on the size of files are missing, so are these tests
    import resource

pytestmark = pytest.mark.skipif("resource" not in globals(), reason="no limits on the size of files")
LIMIT = 16_384
# Commands as a program, with the limit from the start: HDF5 ended the process with a segmentation fault.
PROGRAM = """
import resource, sys
from ltca.commands.program import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
sys.exit(main(sys.argv[2:]))
"""


@contextmanager
def small_disc(limit=LIMIT):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def picture(path):
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots().imshow(np.random.default_rng(0).random((300, 300)))
    figure.savefig(path)


def table(path):
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table({"x": np.random.default_rng(0).random(20_000)}), path)


def archive(path):
    with path.open("wb") as stream:
        np.savez(stream, x=np.random.default_rng(0).random(20_000))


def dataset(path):
    write_netcdf(xr.Dataset({"x": ("a", np.random.default_rng(0).random(20_000)), "y": ("b", np.arange(9))}), path)


def mesh(path):
    import meshio

    points = np.random.default_rng(0).random((5000, 3))
    content = meshio.Mesh(points, [("triangle", np.arange(4998).reshape(-1, 3))])
    meshio.write(path, content, **({"file_format": "gmsh22"} if path.suffix == ".msh" else {}))


WRITERS = {
    ".nc": dataset, ".parquet": table, ".npz": archive, ".png": picture, ".svg": picture, ".pdf": picture, ".vtu": mesh,
    ".msh": mesh, ".json": lambda path: path.write_text("1" * 40_000), ".html": lambda path: path.write_text("1" * 40_000),
}  # fmt: skip


@pytest.mark.parametrize(
    "suffix", [pytest.param(suffix, marks=pytest.mark.slow if suffix in (".svg", ".pdf") else ()) for suffix in WRITERS]
)
def test_every_writer_on_a_full_disc(suffix, tmp_path):
    path = tmp_path / f"file{suffix}"

    def write():
        with whole_file(path) as part:
            WRITERS[suffix](part)

    with small_disc(), pytest.raises(FaultError, match=r"cannot be written: .+"):
        write()
    assert list(tmp_path.iterdir()) == []
    write()  # and without the limit it is written, by a process that is still sound
    assert path.stat().st_size > LIMIT


@pytest.mark.slow
def test_a_full_disc_is_no_segmentation_fault(tmp_path):
    words = ["run", "paper", "--case", "CS-1", "--angles", "0.5", "--no-figures", "--out", str(tmp_path / "out")]
    done = subprocess.run([sys.executable, "-c", PROGRAM, "40000", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    # Beside it there is progress, on a slow machine.
    assert len([line for line in done.stderr.splitlines() if line.startswith("cyclo: error: ")]) == 1
    assert "unforeseen" not in done.stderr
    assert [path for path in (tmp_path / "out").glob("**/*") if path.suffix in (".nc", ".json")] == []


def test_a_stream_reads_back_what_the_disc_did_not_take(tmp_path):
    """HDF5 reads what it has written: pieces on the disc and pieces in memory are one file to it."""
    rng = np.random.default_rng(3)
    content, path = bytearray(60_000), Path(tmp_path / "file")
    with path.open("w+b", buffering=0) as file, small_disc(20_000):
        stream = DiscStream(file.fileno())
        for _ in range(60):
            place, piece = int(rng.integers(0, 50_000)), rng.bytes(int(rng.integers(1, 9000)))
            stream.seek(place)
            assert stream.write(piece) == len(piece)
            content[place : place + len(piece)] = piece
        size = stream.seek(0, 2)
        stream.seek(0)
        assert stream.read(size) == bytes(content[:size])
        with pytest.raises(OSError, match="File too large"):
            stream.check()


def test_what_the_disc_takes_is_the_same_file(tmp_path):
    """The same bytes twice, and netCDF reads what was written."""
    for name in ("a.nc", "b.nc"):
        dataset(tmp_path / name)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    found = xr.load_dataset(tmp_path / "a.nc", engine="h5netcdf")
    np.testing.assert_array_equal(found["x"].values, np.random.default_rng(0).random(20_000))


@pytest.mark.slow
def test_step_on_a_full_disc_is_told_in_a_line(tmp_path):
    """It was "unforeseen Exception"."""
    words = [
        "export",
        "paper",
        "--case",
        "CS-1",
        "--format",
        "step",
        "--part",
        "pin-wheel",
        "--out",
        str(tmp_path / "out"),
    ]
    done = subprocess.run([sys.executable, "-c", PROGRAM, "20000", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stderr
    said = [line for line in done.stderr.splitlines() if line.startswith("cyclo: error: ")]
    assert len(said) == 1
    assert "pin-wheel.step: cannot be written" in said[0]
    assert "unforeseen" not in done.stderr
    assert list((tmp_path / "out").glob("**/*.step")) == []
