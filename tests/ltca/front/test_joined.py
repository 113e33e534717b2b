"""`ltca.concat`: results as cases of one dataset, what differs told of each, what does not fit refused by name."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from refusals import error_says

import ltca
from ltca.errors import DriveError
from ltca.reading.drive_file import load_drive

FILE = load_drive("paper")
ANGLES = [0.1, 0.7, 2.3]


@pytest.fixture(scope="module")
def results():
    return [ltca.analyse(FILE.cases[name], crank_angle=ANGLES) for name in ("CS-1", "CS-3")]


def test_cases_are_those_of_the_results(results):
    joined = ltca.concat(results)
    assert joined["case"].values.tolist() == ["CS-1", "CS-3"]
    for result in results:
        one = joined.sel(case=[result.case])
        for name, values in result.dataset.data_vars.items():
            xr.testing.assert_equal(one[name].drop_vars("drive_file"), values)
    # the clearances differ, and with them the drive: its text is that of each case
    texts = joined["drive_file"].values.tolist()
    assert texts == [result.dataset.attrs["drive_file"] for result in results]
    assert "drive_file" not in joined.attrs
    assert joined.attrs["compliance"] == "half-space"
    assert [*joined.attrs["fingerprint"]] == [result.drive.fingerprint() for result in results]


def test_names_may_be_given(results):
    named = {"tight": results[0], "loose": results[1]}
    xr.testing.assert_identical(ltca.concat(named), ltca.concat(results, names=["tight", "loose"]))
    assert ltca.concat(iter(results))["case"].values.tolist() == ["CS-1", "CS-3"]


@pytest.mark.slow
def test_torques_and_engines_may_differ():
    drive = FILE.cases["CS-1"]
    each = {
        "half": ltca.analyse(drive, crank_angle=ANGLES, torque="188.65 N·m"),
        "grids": ltca.analyse(drive, crank_angle=ANGLES, method="direct"),
    }
    joined = ltca.concat(each)
    assert joined["torque"].values.tolist() == [188_650.0, 377_300.0]
    assert joined["method"].values.tolist() == ["tables", "direct"]
    assert "method" not in joined.attrs
    assert joined.attrs["compliance"] == "half-space"
    # the load of the tangential bearing force is T/(u e) in the mean: half of it by half the torque
    mean = joined["bearing_tangential"].sum(["disc", "crank"]).mean("position")
    assert float(mean.sel(case="half") / mean.sel(case="grids")) == pytest.approx(0.5, abs=2e-3)  # three positions


@pytest.mark.slow
def test_what_one_case_has_alone_is_no_number_in_the_others(tmp_path):
    plain = FILE.cases["CS-1"]
    bent = plain.with_fields({"pin_wheel.beam.span": "30 mm", "pin_wheel.beam.ends": "clamped"})
    joined = ltca.concat([ltca.analyse(one, crank_angle=ANGLES) for one in (plain, bent)], names=["plain", "bent"])
    assert np.all(np.isnan(joined["pin_deflection"].sel(case="plain")))
    assert float(joined["pin_deflection"].sel(case="bent").max()) > 0.0
    joined.to_netcdf(tmp_path / "joined.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "joined.nc", engine="h5netcdf") as read:
        xr.testing.assert_equal(read.load().set_xindex("crank_angle"), joined)


def test_positions_are_found_by_their_crank_angle(results):
    """`.sel(crank_angle=…)` had no index; positions keep their numbers beside it."""
    for dataset in (results[0].dataset, ltca.concat(results), ltca.derivatives(results[0], ["load.torque"])):
        found = dataset.sel(crank_angle=0.75, method="nearest")
        xr.testing.assert_equal(found["pin_load"], dataset["pin_load"].sel(position=1))
        assert dataset.sel(crank_angle=slice(0.5, 3.0))["crank_angle"].values.tolist() == [0.7, 2.3]
    assert results[0].dataset["position"].values.tolist() == [0, 1, 2]


@pytest.mark.slow
def test_results_that_do_not_fit_are_refused_by_name(results):
    first, second = results
    rv = ltca.analyse(load_drive("rv").cases["nominal"], crank_angle=ANGLES)
    fewer = ltca.analyse(FILE.cases["CS-1"], crank_angle=ANGLES[:2])
    elsewhere = ltca.analyse(FILE.cases["CS-1"], crank_angle=[0.1, 0.8, 2.3])
    for given, names, message in (
        ([first, first], None, "case 'CS-1': is the name of results 0 and 1; give names"),
        ([first, rv], None, "case nominal: has 40 wheel pins, …must be 14 wheel pins, … as in case CS-1"),
        ([second, fewer], None, "case CS-1: is at 2 crank angles, must be at the 3 of case CS-3"),
        ([second, elsewhere], None, "case CS-1: crank_angle 1 is 0.8 rad, must be 0.7 rad as in case CS-3"),
        ([], None, "results: is empty"),
        (first, None, "results: must be several results of analyse, not one AnalysisResult"),
        (5, None, "not one int"),
        ([first.dataset], None, "results: entry 0 is a Dataset"),
        (results, ["a"], "names: has 1 names, must have one for each of 2 results"),
        (results, "ab", "names: has a single text"),
        (results, ["a", 3], "names: entry 1 is 3, must be a name"),
        ({"a": first}, ["b"], "names: must be left out"),
    ):
        with error_says(DriveError, *message.split("…")):
            ltca.concat(given, names)
