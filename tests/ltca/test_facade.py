"""The front door: what `import ltca` gives, names checked at once, results that do not change."""

from __future__ import annotations

import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from refusals import error_says, refused_field

import ltca
from ltca.analysis.engines import engine_named
from ltca.analysis.results import build_dataset
from ltca.errors import DriveError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.reading.writing import drive_text
from ltca.testing.closed_form_bodies import without_coupling

DRIVE = load_drive("paper").cases["CS-3"]
ANGLES = [0.1, 2.3]


@pytest.fixture(scope="module")
def result():
    return ltca.analyse(DRIVE, crank_angle=ANGLES, case="CS-3")


def test_import_is_light():
    """Nothing but the standard library is loaded until a name is asked for."""
    code = "import sys, ltca; print(sorted({'numpy', 'scipy', 'pydantic', 'xarray', 'matplotlib'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_front_door_names():
    assert {"load_drive", "analyse", "Drive", "HalfSpace", "PlaneStrain", "Hybrid", "__version__"} <= set(dir(ltca))
    assert all(getattr(ltca, name) is not None for name in ltca.__all__)
    with pytest.raises(AttributeError, match="no attribute 'analyze'"):
        _ = ltca.analyze


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "table"}, "method = 'table': is unknown; must be one of 'tables', 'direct', 'paper'"),
        ({"compliance": "FE"}, "compliance = 'FE': is unknown"),
        ({"contacts": "cells"}, "contacts = 'cells': is unknown"),
        ({"method": "direct", "contacts": "tables"}, "method direct runs on grids"),
        ({"compliance": "fe", "method": "direct"}, "runs on half-space compliance only"),
        ({"coefficients": "file.nc"}, "coefficients: has no effect with compliance half-space"),
        ({"hole_near_field": False}, "hole_near_field: has no effect with compliance half-space"),
        ({"compliance": ltca.HalfSpace(), "method": "tables"}, "method: is an option of the engine"),
        ({"compliance": 3}, "must be an engine or one of"),
        ({"torque": -1.0}, "torque = -1: must be finite and at least 0 N·mm"),
        ({"torque": float("nan")}, "must be finite"),
        ({"torque": "377 mm"}, "torque = '377 mm': must have the unit N·mm or another of torque"),
        ({"torque": "-3 N m"}, "torque = '-3 N m': must be at least 0 N·mm (load.direction turns it)"),
        ({"torque": True}, "must be a number in N·mm"),
        ({"crank_angle": []}, "must be one row of at least one angle"),
        ({"crank_angle": [[0.0]]}, "must be one row of at least one angle"),
        ({"crank_angle": [np.inf]}, "must be finite, in rad"),
        ({"crank_angle": ["a"]}, "crank_angle = 'a': is not a quantity; write a number in rad"),
        ({"crank_angle": [0.1, "20 mm"]}, "crank_angle = '20 mm': must have the unit rad or another of angle"),
        ({"crank_angle": ["20 deg", [1.0]]}, "must be numbers in rad"),
        ({"crank_angle": [1j]}, "must be numbers in rad"),
        ({"crank_angle": [True]}, "must be numbers in rad"),
        ({"compliance": "fe", "hole_near_field": "no"}, "hole_near_field = 'no': must be true or false"),
        (
            {"compliance": "fe", "coefficients": 3},
            "coefficients = 3: must be influence coefficients, a file or several",
        ),
        ({"positions": 0}, "must be a whole number from 1"),
        ({"positions": 2.5}, "must be a whole number from 1"),
        ({"positions": 4, "crank_angle": [0.0]}, "give one of them"),
    ],
)
def test_what_makes_no_sense_is_refused_at_once(options, message):
    with error_says(DriveError, message):
        ltca.analyse(DRIVE, **options)


def test_quantities_are_given_as_texts():
    """`torque="377.3 N·m"` was refused; a text is the number that it stands for, at the last bit."""
    plain = ltca.analyse(DRIVE, crank_angle=[np.deg2rad(20.0), 0.5], torque=188_650.0)
    for angles in (["20 deg", 0.5], ("20 deg", "0.5 rad"), np.array(["20 deg", "0.5"])):
        told = ltca.analyse(DRIVE, crank_angle=angles, torque="188.65 N·m")
        xr.testing.assert_identical(told.dataset, plain.dataset)
    one = ltca.analyse(DRIVE, crank_angle="20 deg", torque="188.65 N m")
    assert one.loaded.full.crank_angle.tolist() == [np.deg2rad(20.0)]


def test_a_drive_file_is_no_drive():
    with error_says(DriveError, "not a DriveFile; a drive file has them in .cases"):
        ltca.analyse(load_drive("paper"))


def test_names_become_engines():
    coefficients = without_coupling(DRIVE)
    assert engine_named() == ltca.HalfSpace()
    assert engine_named(method="direct") == ltca.HalfSpace(method="direct", contacts="grids")
    assert engine_named("fe", coefficients=coefficients) == ltca.PlaneStrain(coefficients=coefficients)
    assert not engine_named("hybrid", hole_near_field=False).hole_near_field


def test_an_engine_keeps_the_files_it_was_given():
    """A list that grew afterwards changed the engine, and a file given as text failed when it was read."""
    files = [Path("one.nc")]
    engine = ltca.Hybrid(coefficients=files)
    files.append(Path("two.nc"))
    assert engine.coefficients == (Path("one.nc"),)
    assert ltca.Hybrid(coefficients="one.nc") == engine
    assert hash(engine) == hash(ltca.Hybrid(coefficients=(Path("one.nc"),)))


def test_dataset_is_one_case_of_the_runs_results(result):
    loaded = {"CS-3": result.loaded}
    xr.testing.assert_identical(result.dataset.drop_indexes("crank_angle"), build_dataset("paper", loaded))
    both = build_dataset("paper", {"A": result.loaded, "CS-3": result.loaded})
    xr.testing.assert_equal(both.isel(case=[1]), result.dataset)


def test_summary_and_figures_and_repr(result):
    assert result.summary["max_pin_load_N"] == float(result.dataset["pin_load"].max())
    axes = result.plot.pin_load().axes[0]
    drawn = np.asarray(axes.lines[0].get_ydata())
    np.testing.assert_array_equal(drawn, result.dataset["pin_load"].values[0, 0, :, 0])
    assert "pin_load" in repr(result.plot)
    lines = repr(result).splitlines()
    assert len(lines) < 25
    assert max(map(len, lines)) < 80
    assert "half-space, 2 positions, 377.3 N·m" in lines[0]


def test_what_is_handed_out_changes_nothing(result):
    before = result.dataset
    changed = result.dataset
    with pytest.raises(ValueError, match="read-only"):
        changed["pin_load"].values[:] = 0.0
    changed["pin_load"] = 0.0 * changed["pin_load"]
    result.summary.clear()
    xr.testing.assert_identical(result.dataset, before)
    assert result.summary


def test_arrays_of_a_result_are_read_only(result):
    full, pressures = result.loaded.full, result.loaded.pressures
    for array in (
        full.pose, full.residual, full.response.pin_load, full.response.flank.approach,
        full.response.rollers.outer_load, pressures.pins.mid, result.loaded.bearing_radial, result.loaded.light.pose,
    ):  # fmt: skip
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_angles_of_the_caller_stay_the_callers():
    angles = np.array([0.1, 0.2])
    kept = ltca.analyse(DRIVE, crank_angle=angles)
    angles[:] = 9.0
    np.testing.assert_array_equal(kept.loaded.full.crank_angle, [0.1, 0.2])


def test_one_angle_says_nothing_of_ranges():
    """Once it printed a transmission error of 0.00″ and a loaded range of 90°."""
    one = ltca.analyse(DRIVE, crank_angle=[0.5])
    assert one.summary["ptp_transmission_error_arcsec"] is None
    assert one.summary["pin_shaft_loaded_range_deg"] is None
    assert "peak to peak" not in repr(one)


def test_attributes_say_what_made_it(result):
    attributes = result.dataset.attrs
    assert attributes["version"] == ltca.__version__
    assert len(attributes["code_hash"]) == 16
    assert attributes["Conventions"].startswith("CF-")
    assert (attributes["compliance"], attributes["method"], attributes["contacts"]) == (
        "half-space",
        "tables",
        "tables",
    )
    assert parse_drive(attributes["drive_file"]).cases["nominal"] == DRIVE
    assert attributes["drive_file"] == drive_text(DRIVE)


def test_places_of_the_parts_are_coordinates(result):
    data = result.dataset.isel(case=0, disc=0, crank=0)
    wheel, shaft = DRIVE.pin_wheel, DRIVE.pin_shaft
    np.testing.assert_allclose(np.hypot(data["pin_x"], data["pin_y"]), wheel.pin_circle_radius)
    np.testing.assert_allclose(np.arctan2(data["pin_y"], data["pin_x"])[1], 2.0 * np.pi / wheel.number_of_pins)
    for part in ("hole", "shaft_pin"):
        np.testing.assert_allclose(np.hypot(data[f"{part}_x"], data[f"{part}_y"]), shaft.pin_circle_radius)
    np.testing.assert_allclose(np.diff(data["roller_angle"]), 2.0 * np.pi / DRIVE.crank_bearing.number_of_rollers)
    assert float(data["torque"]) == DRIVE.load.torque
    assert float(data["light_torque"]) == DRIVE.load.light_torque


@pytest.mark.slow
def test_repr_tells_the_refined_transmission_error():
    """CS-1 printed 2.14″ with 13 positions, 5.38″ with 360."""
    drive = ltca.load_drive("paper").cases["CS-1"]
    coarse, fine = (ltca.analyse(drive, positions=count) for count in (13, 360))
    rows = [next(row for row in repr(found).splitlines() if "peak to peak" in row) for found in (coarse, fine)]
    told = [float(row.split()[-2]) for row in rows]
    assert told[0] == pytest.approx(told[1], abs=0.02)  # printed to 0.01″, refined to 0.1 %
    assert coarse.summary["ptp_transmission_error_arcsec"] < 0.9 * told[0]


def test_cases_keep_their_names_beside_each_other():
    """Datasets of several cases that were joined read ['nominal', 'nominal']."""
    cases = ltca.load_drive("paper").cases
    found = [ltca.analyse(cases[name], 2) for name in ("CS-1", "CS-3")]
    joined = xr.concat([one.dataset for one in found], "case")
    assert joined["case"].values.tolist() == ["CS-1", "CS-3"]
    assert float(joined["pin_load"].sel(case="CS-3").sum()) == float(found[1].dataset["pin_load"].sum())
    changed = with_fields(replace(cases["CS-3"], name="mine"), {"disc.thickness": 20.0})
    assert (changed.case, pickle.loads(pickle.dumps(changed)).case) == ("CS-3", "CS-3")
    assert ltca.analyse(changed, 2, case="mine").dataset["case"].values.tolist() == ["mine"]
    assert parse_drive(drive_text(changed)).cases["nominal"].case == "nominal"


def test_the_name_of_a_case_is_no_field():
    """Nor does it tell drives apart: coefficients and results of a case are those of the same drive without a name."""
    drive = ltca.load_drive("paper").cases["CS-3"]
    plain = replace(drive, case="nominal")
    assert drive == plain
    assert (drive.fingerprint(), hash(drive)) == (plain.fingerprint(), hash(plain))
    with refused_field("case", "", "is not a field"):
        with_fields(drive, {"case": "CS-1"})
    with error_says(DriveError, "case A: case: must be left out; `name` is"):
        parse_drive(shipped_drive("rv") + '\n[[case]]\nname = "A"\ncase = "B"\n')


def test_an_engine_class_is_no_engine():
    with pytest.raises(DriveError, match="must be an engine or one of"):
        ltca.analyse(DRIVE, crank_angle=[0.1], compliance=ltca.HalfSpace)


@pytest.mark.parametrize("front", ["analyse", "check", "curves", "vibration", "motion"])
def test_a_torque_beyond_the_bound_of_a_command_was_searched_for(front):
    drive = ltca.load_drive("paper").cases["CS-1"].with_fields({"load.torque": 1e12})
    words = ("1 ms",) if front == "motion" else ()
    with pytest.raises(ltca.DriveError, match=r"load.torque = 1e\+12 N·mm is 1e\+09 N·m: must be at most"):
        getattr(ltca, front)(drive, *words, compliance="half-space")
