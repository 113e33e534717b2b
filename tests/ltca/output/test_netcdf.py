"""What is written is netCDF-4 as another writer lays it out: the same names, attributes, dimensions and bytes of values."""

from __future__ import annotations

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr
from xarray.backends import H5NetCDFStore

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import labelled_results
from ltca.output.labelled import LabelledDataset
from ltca.output.netcdf import read_netcdf, write_netcdf
from ltca.reading.drive_file import parse_drive, shipped_drive

ODD = xr.Dataset(
    {
        "empty": (("x", "y"), np.zeros((3, 0)), {"units": "mm"}),
        "named": ("x", ["a", "bé", ""]),
        "whether": ("x", [True, False, True]),
        "alone": ((), 2.5),
        "word": ((), "text"),
        "single": ("z", np.float32([1.0, np.nan])),
        "more": (("q", "x"), np.arange(12).reshape(4, 3)),
    },
    coords={"q": [1.0, 2.0, 3.0, 4.0], "lone": ("w", [1, 2], {"long_name": "beside no variable"}), "place": ("x", [3, 2, 1])},
    attrs={"whole": 1, "half": 0.5, "texts": ["a", "bé"], "one": ["a"], "wholes": [1, 2], "nothing": ""},
)  # fmt: skip


def content(path):
    """Everything in an HDF5 file but who wrote it; references by the names they lead to."""

    def told(file, item):
        found = {}
        for name, value in item.attrs.items():
            if name == "DIMENSION_LIST":
                found[name] = [[file[one].name for one in row] for row in value]
            elif name == "REFERENCE_LIST":
                found[name] = sorted((file[one].name, int(axis)) for one, axis in value)
            elif name != "_NCProperties":
                kind = h5py.h5a.open(item.id, name.encode()).get_type()
                found[name] = repr(value), str(kind.dtype), np.shape(value)
        return found

    with h5py.File(path) as file:
        return list(file), {"/": told(file, file)} | {
            name: (
                told(file, item), str(item.dtype), item.shape, item.maxshape, item.compression, item.compression_opts,
                repr(item.fillvalue), item.id.get_create_plist().get_attr_creation_order(),
                item[...].tolist() if item.dtype.kind == "O" else item[...].tobytes(),
            )
            for name, item in file.items()
        }  # fmt: skip


def check_written(dataset, tmp_path, packed=()):
    with h5netcdf.File(tmp_path / "theirs.nc", "w") as file:
        dataset.dump_to_store(
            H5NetCDFStore(file), encoding={name: {"zlib": True, "complevel": 6, "shuffle": True} for name in packed}
        )
    write_netcdf(dataset, tmp_path / "ours.nc", packed)
    assert content(tmp_path / "ours.nc") == content(tmp_path / "theirs.nc")
    ours, theirs = (xr.load_dataset(tmp_path / f"{name}.nc", engine="h5netcdf") for name in ("ours", "theirs"))
    xr.testing.assert_identical(ours, theirs)
    read = read_netcdf(tmp_path / "ours.nc", "results").to_xarray()
    xr.testing.assert_identical(read, theirs)
    assert {name: each.dtype for name, each in read.variables.items()} == {
        name: each.dtype for name, each in theirs.variables.items()
    }


AS_WRITTEN_TODAY = pytest.mark.skipif(
    tuple(int(part) for part in h5netcdf.__version__.split(".")[:3]) < (1, 8, 2),
    reason="older h5netcdf stores attributes otherwise; that it reads what we write is tested below",
)


@pytest.mark.family(quick=1)
@AS_WRITTEN_TODAY
@pytest.mark.parametrize("packed", [(), ("more", "single")])
def test_every_kind_of_variable(packed, tmp_path):
    check_written(ODD, tmp_path, packed)


@pytest.mark.slow
@AS_WRITTEN_TODAY
@pytest.mark.parametrize("name", [pytest.param("paper", marks=pytest.mark.nightly), "rv"])
def test_results_of_a_run(name, tmp_path):
    """One crank and holes; several discs and cranks and no holes, a dimension of no size."""
    drive = next(iter(parse_drive(shipped_drive(name)).cases.values()))
    labelled = labelled_results(name, {"a": analyse(drive, np.array([0.3, 1.0]))})
    check_written(labelled.to_xarray(), tmp_path)
    write_netcdf(labelled, tmp_path / "labelled.nc")
    assert (tmp_path / "labelled.nc").read_bytes() == (tmp_path / "ours.nc").read_bytes()
    xr.testing.assert_identical(LabelledDataset.of(labelled.to_xarray()).to_xarray(), labelled.to_xarray())


@pytest.mark.parametrize(
    "encoding",
    [{"scale_factor": 0.1, "dtype": "i2", "_FillValue": -1}, {"_FillValue": -1.0}, {"dtype": ">f4"}],
    ids=["packed", "masked", "byte order"],
)
def test_values_that_conventions_change_are_read_as_xarray_does(encoding, tmp_path):
    path = tmp_path / "a.nc"
    dataset = xr.Dataset({"a": ("x", [1.0, np.nan, 3.0]), "b": ("x", [1, 2, 3])})
    dataset.to_netcdf(path, engine="h5netcdf", encoding={"a": encoding})
    xr.testing.assert_identical(read_netcdf(path, "results").to_xarray(), xr.load_dataset(path, engine="h5netcdf"))


@pytest.mark.parametrize(
    "dataset", [xr.Dataset({"a": ("x", [1j])}), xr.Dataset(attrs={"a": True})], ids=["value", "attribute"]
)
def test_types_that_netcdf_has_not(dataset, tmp_path):
    with pytest.raises(TypeError, match="netCDF has no"):
        write_netcdf(dataset, tmp_path / "a.nc")
