"""The same dataset bit for bit with any number of workers and after a resume; failures told; memory flat."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from pyarrow import parquet
from refusals import error_says

import ltca
from ltca.analysis.engines import Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.errors import CycloError
from ltca.geometry.placement import position_angles
from ltca.output.provenance import code_hash
from ltca.reading.drive_file import load_drive
from ltca.studies.designs import SweepDesign, SweepFactor
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers
from ltca.studies.quantities import OF_FRICTION, OF_WIDTH, STAGES
from ltca.studies.run_study import run_study
from ltca.studies.study import Study, run_batch
from ltca.studies.tolerance_study import tolerance_study
from ltca.testing.closed_form_bodies import without_coupling

POSITIONS = 16


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper")


def small_study(paper, samples=30, quantities=("ptp_transmission_error", "max_pin_load"), positions=POSITIONS):
    study = tolerance_study(paper, case="CS-6", samples=samples, positions=positions, seed=4, quantities=quantities)
    return replace(study, batch_positions=4 * positions)


@pytest.fixture(scope="module")
def reference(paper, tmp_path_factory):
    """Files of the small study solved in this process."""
    folder = StudyFolder(path=tmp_path_factory.mktemp("reference"))
    run_study(small_study(paper, samples=12), folder, Workers())
    return folder


def same_files(one, other):
    for name in ("results.nc", "results.parquet", "summary.json"):
        assert (one.path / name).read_bytes() == (other.path / name).read_bytes(), name


@pytest.mark.slow
def test_every_quantity_against_the_run_of_its_sample(paper):
    """The worst sample re-run by index gives what the study says of it."""
    study = small_study(paper, samples=3, quantities=("all",), positions=24)
    result = run_batch(study, 0)
    assert result.messages == ("", "", "")
    drive = study.sample_drive(2)
    found = dict(zip(study.quantities, result.values[2], strict=True))
    assert set(found) == set(STAGES) - {*OF_FRICTION, *OF_WIDTH}
    alone = analyse(drive, position_angles(24))
    from ltca.analysis.summary import summarise
    from ltca.drive.units.quantities import ARCSEC

    told = summarise(alone)
    pairs = {
        "ptp_transmission_error": told["ptp_transmission_error_arcsec"],
        "ptp_transmission_error_light": told["ptp_transmission_error_light_arcsec"],
        "mean_backlash_wheel": told["backlash_wheel_arcmin"],
        "max_pin_load": told["max_pin_load_N"],
        "max_pin_pressure_mid": told["max_pin_pressure_mid_MPa"],
        "max_roller_load": told["max_roller_load_N"],
        "max_roller_pressure_mid": told["max_roller_pressure_mid_MPa"],
        "max_pin_shaft_load": told["max_pin_shaft_load_N"],
        "mean_bearing_load": told["mean_bearing_load_N"],
        "mean_radial_bearing_load": told["mean_radial_bearing_load_N"],
        "mean_tangential_bearing_load": told["mean_tangential_bearing_load_N"],
        "ptp_tangential_bearing_load": told["ptp_tangential_bearing_load_N"],
        "mean_loaded_pins": told["mean_loaded_pins"],
        "mean_loaded_rollers": told["mean_loaded_rollers"],
        "mean_loaded_pin_shaft_pins": told["mean_loaded_pin_shaft_pins"],
        "mean_transmission_error": alone.full.pose[:, 3].mean() * ARCSEC,
        "max_bearing_load": np.hypot(alone.bearing_radial, alone.bearing_tangential).max(),
    }
    for name, expected in pairs.items():
        # both starts balance to 1e-9 of the load; differences of two such loads lose two digits
        assert found[name] == pytest.approx(expected, rel=1e-6), name
    assert found["min_backlash_wheel"] <= found["mean_backlash_wheel"]


def test_the_dataset_holds_what_was_drawn_and_found(paper, reference):
    study = small_study(paper, samples=12)
    with xr.open_dataset(reference.results, engine="h5netcdf") as data:
        assert data.sizes["sample"] == 12
        assert list(data["factor"].values) == list(study.design.names)
        np.testing.assert_array_equal(data["factor_value"].values, study.design.rows(0, 12))
        np.testing.assert_array_equal(data["max_pin_load"].values[4:8], run_batch(study, 1).values[:, 1])
        assert not data["failed"].values.any()
        table = parquet.read_table(reference.table).to_pydict()
        np.testing.assert_array_equal(table["ptp_transmission_error"], data["ptp_transmission_error"].values)
    assert not (reference.path / "batches").exists()


def test_files_say_what_they_hold_and_what_made_them(paper, reference):
    """Units as in runs, of the drawn numbers too; drive, study, code and engine; no clock and no folder."""
    study = small_study(paper, samples=12)
    schema = parquet.read_schema(reference.table)
    with xr.open_dataset(reference.results, engine="h5netcdf") as data:
        assert data["ptp_transmission_error"].attrs["units"] == "arcsec"
        assert data["max_pin_load"].attrs["units"] == "N"
        units = dict(zip(data["factor"].values.tolist(), data["factor_units"].values.tolist(), strict=True))
        attributes = dict(data.attrs)
    assert units["disc.runout.angle"] == "rad"
    assert units["pin_wheel.pin_errors.radial.3"] == "mm"
    for name in schema.names:
        metadata = schema.field(name).metadata
        assert metadata.keys() == {b"units", b"description"}, name
        assert metadata[b"units"].decode() == {
            **units, "sample": "1", "message": "", "ptp_transmission_error": "arcsec", "max_pin_load": "N"
        }[name]  # fmt: skip
    assert load_drive(write_text(reference.path / "again.toml", attributes["drive_file"])).cases == paper.cases
    (reference.path / "again.toml").unlink()
    definition = json.loads(attributes["study_definition"])
    assert (definition["samples"], definition["seed"], definition["case"]) == (12, 4, "CS-6")
    assert attributes["version"] == ltca.__version__
    assert attributes["code_hash"] == code_hash("ltca")
    assert attributes["Conventions"].startswith("CF-")
    assert (attributes["compliance"], attributes["fingerprint"]) == ("half-space", study.fingerprint)
    told = json.loads((reference.path / "summary.json").read_text(encoding="utf-8"))
    assert told["units"] == {"ptp_transmission_error": "arcsec", "max_pin_load": "N"}
    # thousands of N and tens of arcsec, not 1e-4 rad
    assert 10.0 < told["quantities"]["ptp_transmission_error"]["mean"] < 100.0
    assert str(reference.path).encode() not in reference.results.read_bytes() + reference.table.read_bytes()


def write_text(path, text):
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.slow
def test_two_workers_write_the_same_files(paper, reference, tmp_path):
    folder = StudyFolder(path=tmp_path)
    run_study(small_study(paper, samples=12), folder, Workers(processes=2))
    same_files(folder, reference)


def test_resume_solves_what_is_left_and_no_more(paper, reference, tmp_path):
    study, folder = small_study(paper, samples=12), StudyFolder(path=tmp_path)
    assert folder.prepare(study, resume=False) == [0, 1, 2]
    folder.store(study, run_batch(study, 1))
    with pytest.raises(CycloError, match="continue it with --resume"):
        folder.prepare(study, resume=False)
    with pytest.raises(CycloError, match="holds another study"):
        folder.prepare(replace(study, positions=8), resume=True)
    assert folder.prepare(study, resume=True) == [0, 2]
    found = run_study(study, folder, Workers(), resume=True)
    assert found.solved_positions == 8 * POSITIONS
    same_files(folder, reference)
    # a finished study is not solved again
    again = run_study(study, folder, Workers(), resume=True)
    assert again.solved_positions == 0
    same_files(folder, reference)
    with error_says(CycloError, "compliance, coefficients or the code differ"):
        folder.prepare(replace(study, engine=Hybrid(coefficients=without_coupling(paper.cases["CS-6"]))), resume=True)
    with pytest.raises(CycloError, match="no study to resume"):
        StudyFolder(path=tmp_path / "empty").prepare(study, resume=True)


def test_whatever_the_results_depend_on_is_in_the_fingerprint(paper, tmp_path):
    """Else --resume would mix two studies."""
    study = small_study(paper)
    wider = {**paper.tolerances}
    wider["crank.eccentricity_error"] = replace(wider["crank.eccentricity_error"], cpk=1.0)
    others = [
        small_study(paper, samples=31),
        small_study(paper, positions=8),
        small_study(paper, quantities=("max_pin_load",)),
        small_study(replace(paper, tolerances=wider)),
        replace(study, design=replace(study.design, seed=5)),
        replace(study, design=replace(study.design, sequence="sobol")),
        replace(study, cases=(("CS-5", paper.cases["CS-5"]),)),
        replace(study, engine=Hybrid()),
        replace(study, engine=PlaneStrain()),
        replace(study, engine=Hybrid(hole_near_field=False)),
        replace(study, engine=Hybrid(coefficients=without_coupling(paper.cases["CS-6"]))),
    ]
    assert len({item.fingerprint for item in [study, *others]}) == 12
    one, two = (write_text(tmp_path / name, name) for name in ("one.nc", "two.nc"))
    files = [replace(study, engine=Hybrid(coefficients=path)) for path in (one, two)]
    assert len({item.fingerprint for item in (study, *files)}) == 3
    same = write_text(tmp_path / "same.nc", "one.nc")
    assert replace(study, engine=Hybrid(coefficients=same)).fingerprint == files[0].fingerprint
    assert small_study(paper).fingerprint == study.fingerprint


def test_damaged_and_foreign_batches_are_solved_again(paper, tmp_path):
    """Cut off, a flipped bit, no archive at all, or of a study with another seed."""
    study, folder = small_study(paper, samples=20), StudyFolder(path=tmp_path)
    other = replace(study, design=replace(study.design, seed=5))
    folder.prepare(study, resume=False)
    for number in range(5):
        folder.store(other if number == 3 else study, run_batch(study, number))
    kept = sorted((tmp_path / "batches").glob("*.npz"))
    assert len(kept) == 5
    kept[0].write_bytes(kept[0].read_bytes()[:-300])
    whole = bytearray(kept[1].read_bytes())
    whole[len(whole) // 2] ^= 8
    kept[1].write_bytes(whole)
    kept[2].write_bytes(b"nothing")
    assert folder.prepare(study, resume=True) == [0, 1, 2, 3]


def bad_sweep(paper):
    """Thickness so small that the torque cannot be carried, and a flank that overlaps its pins too far, among sound samples."""
    factors = (
        SweepFactor(path="disc.equidistant_offset", levels=(0.15, -0.6, 0.15, 0.16)),
        SweepFactor(path="load.torque", levels=(3e5, 3e5, 1e8, 3e5)),
    )
    return Study(
        name="bad",
        cases=(("CS-3", paper.cases["CS-3"]),),
        design=SweepDesign(factors=factors, kind="list"),
        positions=6,
        quantities=("max_pin_load",),
        near_nominal=False,
    )


@pytest.mark.slow
def test_failed_samples_are_listed_with_their_drive_and_stop_nobody(paper, tmp_path):
    folder = StudyFolder(path=tmp_path)
    found = run_study(bad_sweep(paper), folder, Workers())
    assert [sample for sample, _ in found.failures] == [1, 2]
    assert "overlap" in found.failures[0][1]
    assert "cannot be carried" in found.failures[1][1]
    with xr.open_dataset(folder.results, engine="h5netcdf") as data:
        np.testing.assert_array_equal(data["failed"].values, [0, 1, 1, 0])
        np.testing.assert_array_equal(np.isfinite(data["max_pin_load"].values), [True, False, False, True])
        assert list(data["failed_sample"].values) == [1, 2]
    unsound = (tmp_path / "samples" / "sample_00000001.toml").read_text()
    assert "disc.equidistant_offset = -0.6" in unsound
    heavy = load_drive(tmp_path / "samples" / "sample_00000002.toml").cases["nominal"]
    assert heavy.load.torque == 1e8
    # told again by a resumed, finished study
    assert run_study(bad_sweep(paper), folder, Workers(), resume=True).failures == found.failures


def test_sample_drive_file_is_the_sample(paper, tmp_path):
    from ltca.studies.run_study import write_sample

    study = small_study(paper)
    path = write_sample(study, StudyFolder(path=tmp_path), 7)
    assert load_drive(path).cases["nominal"] == study.sample_drive(7)


MEMORY = """
import resource, sys
from pathlib import Path
from ltca.reading.drive_file import load_drive
from ltca.studies.execution.workers import Workers
from ltca.studies.run_study import run_study
from ltca.studies import study_results
from ltca.studies.execution import storage
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.tolerance_study import tolerance_study
storage.CHUNK = study_results.CHUNK = 1024  # so that the smaller study fills several as well
paper, samples = load_drive("paper"), int(sys.argv[1])
study = tolerance_study(paper, case="CS-6", samples=samples, positions=1, quantities=("max_pin_load",))
run_study(study, StudyFolder(path=Path(sys.argv[2])), Workers())
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


@pytest.mark.nightly
@pytest.mark.slow
def test_memory_is_flat_against_the_number_of_samples(tmp_path):
    """Four times the samples: the factors alone of the greater would be 6 MB more if they were kept."""

    def peak(samples):
        command_line = [sys.executable, "-c", MEMORY, str(samples), str(tmp_path / str(samples))]
        text = subprocess.run(command_line, check=True, capture_output=True, text=True).stdout
        return int(text.split()[-1]) / 1024.0  # MB

    small, large = peak(2048), peak(8192)
    assert large - small < 3.0
