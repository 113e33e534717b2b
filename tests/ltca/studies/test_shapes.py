"""Studies on bodies that yield: each shape gets its own coefficients, once, before samples are solved."""

from __future__ import annotations

import argparse
import json
import pickle
import tomllib
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr
from refusals import error_says, refused_field

from ltca.analysis import engines
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain, engine_named
from ltca.commands import optimise, sweep, tolerance
from ltca.compliance.coefficient_files import cached_file
from ltca.errors import CycloError, DriveError
from ltca.geometry.placement import position_angles
from ltca.output.provenance import code_hash
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive
from ltca.studies import shapes
from ltca.studies.batch_analysis import BatchSettings, analyse_samples
from ltca.studies.execution.storage import StudyFolder
from ltca.studies.execution.workers import Workers
from ltca.studies.optimiser import Problem, Variable, most_candidates, optimise as search, varies_shape
from ltca.studies.run_study import run_study
from ltca.studies.study import run_batch
from ltca.studies.sweep_file import parse_sweep
from ltca.studies.tolerance_study import tolerance_study
from ltca.testing.closed_form_bodies import without_coupling

pytestmark = pytest.mark.slow

ALONE = Hybrid(hole_near_field=False)
"""Without coupling, as the coefficients below are, this is the half-space."""
SHAPES = """
positions = 3
quantities = ["max_pin_load", "ptp_transmission_error"]
[factors]
"disc.thickness" = [11.8, 12.0]
"load.torque" = [3e5, 3.5e5]
"""


def run(module, *words):
    parser = argparse.ArgumentParser()
    module.configure(parser)
    return module.execute(parser.parse_args([str(word) for word in words]))


@pytest.fixture(scope="module")
def paper():
    return load_drive("paper")


@pytest.fixture
def derived(monkeypatch, tmp_path):
    """Coefficients without coupling in place of derived ones; the drives they were asked for."""
    asked = []

    def find(drive, *given, **options):
        asked.append(drive)
        return without_coupling(drive)

    def find_all(cases, **options):
        asked.append(list(cases))
        return {}

    monkeypatch.setattr(engines, "find_coefficients", find)
    monkeypatch.setattr(shapes, "find_case_coefficients", find_all)
    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(shapes, "_ENGINES", shapes.OrderedDict())
    return asked


@pytest.mark.slow
def test_a_sweep_derives_each_shape_once_and_beforehand(derived, tmp_path):
    study, half = (parse_sweep(tomllib.loads(SHAPES), "paper", engine=engine) for engine in (ALONE, None))
    told = []
    folder = StudyFolder(path=tmp_path / "hybrid")
    run_study(study, folder, Workers(), told=lambda text: told.append((text, len(derived))))
    together, *alone = derived  # several at once first, then each is found
    assert together == ["shape 1", "shape 2"]
    assert [drive.disc.thickness for drive in alone] == [11.8, 12.0]
    (lent, _), *told = told
    assert "at most 0.2 % in every number take its influence coefficients" in lent.replace("%", " %").replace("  ", " ")
    assert told == [("2 shapes have no influence coefficients yet: derived first, some 5 s each, some 10 s in all", 0)]
    run_study(half, StudyFolder(path=tmp_path / "half"), Workers())
    with (
        xr.open_dataset(folder.results, engine="h5netcdf") as found,
        xr.open_dataset(tmp_path / "half" / "results.nc", engine="h5netcdf") as plain,
    ):
        assert (found.attrs["compliance"], found.attrs["hole_near_field"]) == ("hybrid", "no")
        # one model solves sample by sample, the other all together: balanced to 1e-9 of the load each
        np.testing.assert_allclose(found["max_pin_load"], plain["max_pin_load"], rtol=1e-7)
        assert len(np.unique(found["max_pin_load"])) == 4
    assert json.loads((folder.path / "summary.json").read_text())["compliance"] == "hybrid"


def test_errors_of_parts_do_not_change_the_shape(paper, derived):
    """A tolerance study derives once, however many samples it has."""
    study = tolerance_study(paper, case="CS-6", samples=100_000, positions=4, engine=ALONE)
    assert len(study.shapes(range(study.batches))) == 1
    small = replace(study, quantities=("max_pin_load",), batch_positions=12)
    hybrid, plain = run_batch(small, 2), run_batch(replace(small, engine=HalfSpace()), 2)
    assert hybrid.messages == ("", "", "")
    np.testing.assert_allclose(hybrid.values, plain.values, rtol=1e-7)
    assert len(derived) == 1


@pytest.mark.parametrize(("tolerance", "shapes_of_its_own"), [(0.01, 1), (0.5, 5)])
def test_bodies_that_hardly_differ_take_the_coefficients_of_the_drive(tolerance, shapes_of_its_own, paper, derived):
    """Up to 0.2 % in every number, 0.013 mm of the 6.6 mm that generate the flank; the nominal shape itself is none of five."""
    scatter = replace(next(iter(paper.tolerances.values())), tolerance=tolerance)
    offsets = tolerance_study(
        replace(paper, tolerances={"disc.equidistant_offset": scatter}), samples=5, positions=4, engine=ALONE
    )
    assert len(offsets.shapes(range(offsets.batches))) == shapes_of_its_own


def test_batches_are_smaller_where_samples_are_solved_one_by_one(paper):
    many, few = (tolerance_study(paper, samples=1000, positions=28, engine=engine) for engine in (None, ALONE))
    assert many.batch_samples > 5 * few.batch_samples > 0


def test_only_what_is_left_is_derived_when_resuming(derived, tmp_path):
    study = replace(parse_sweep(tomllib.loads(SHAPES), "paper", engine=ALONE), batch_positions=6)
    folder = StudyFolder(path=tmp_path)
    folder.prepare(study, resume=False)
    folder.store(study, run_batch(study, 0))
    derived.clear()
    shapes._ENGINES.clear()
    run_study(study, folder, Workers(), resume=True)
    assert [drive.disc.thickness for drive in derived] == [12.0, 11.8]  # 11.8 for the drive as it is, in the summary


def test_a_shape_without_coefficients_is_told_by_its_samples(derived, monkeypatch, tmp_path):
    def find(drive, *given, **options):
        if drive.disc.thickness > 11.9:
            raise CycloError("cannot be meshed")
        return without_coupling(drive)

    monkeypatch.setattr(engines, "find_coefficients", find)
    study = parse_sweep(tomllib.loads(SHAPES), "paper", engine=ALONE)
    found = run_study(study, StudyFolder(path=tmp_path / "some"), Workers())
    assert found.failures == ((2, "cannot be meshed"), (3, "cannot be meshed"))

    def none(drive, *given, **options):
        raise CycloError("nothing derives")

    monkeypatch.setattr(engines, "find_coefficients", none)
    shapes._ENGINES.clear()
    with pytest.raises(CycloError, match="nothing derives"):
        run_study(study, StudyFolder(path=tmp_path / "none"), Workers())


def test_a_file_serves_its_shape_only(paper, tmp_path, monkeypatch):
    """Refused before anything is solved, whichever sample it does not serve."""
    monkeypatch.setattr(shapes, "_ENGINES", shapes.OrderedDict())
    file = tmp_path / "coefficients.nc"
    file.write_bytes(b"none")
    study = parse_sweep(tomllib.loads(SHAPES), "paper", engine=Hybrid(coefficients=file))
    with pytest.raises(CycloError, match="cannot be read as a coefficient file"):
        run_study(study, StudyFolder(path=tmp_path / "out"), Workers())
    path = tmp_path / "study.toml"
    path.write_text('drive = "paper"\n' + SHAPES, encoding="utf-8")
    for words, message in (
        (["--coefficients", file], "coefficients: has no effect with compliance half-space"),
        (["--no-hole-near-field"], "hole_near_field: has no effect with compliance half-space"),
    ):
        with error_says(DriveError, message):
            run(sweep, path, *words)
        with error_says(DriveError, message):
            run(tolerance, "paper", *words)
        with error_says(DriveError, message):
            run(optimise, "paper", "--vary", "thickness", "--minimise", "max_pin_load", *words)
    words = ["--vary", "thickness", "--minimise", "max_pin_load", "--compliance", "fe", "--coefficients", file]
    with error_says(DriveError, "serves one shape, and --vary thickness changes it"):
        run(optimise, "paper", *words)


@pytest.mark.parametrize("method", ["direct", "paper"])
def test_methods_that_studies_would_leave_out_are_refused(paper, method):
    with error_says(DriveError, f"method = {method}: studies balance samples on tables only"):
        run_batch(tolerance_study(paper, samples=2, positions=2, engine=HalfSpace(method=method)), 0)


def test_engines_travel_to_workers(paper):
    for engine in (HalfSpace(), ALONE, PlaneStrain(), engine_named("fe", coefficients=None)):
        study = tolerance_study(paper, samples=2, positions=2, engine=engine)
        assert pickle.loads(pickle.dumps(study)).fingerprint == study.fingerprint


def test_kept_coefficients_are_those_of_the_shape_and_few(paper, derived):
    drive = paper.cases["CS-1"]
    others = [
        with_fields(drive, {"disc.thickness": 12.0 + 0.1 * number}) for number in range(shapes.MAX_KEPT_SHAPES + 1)
    ]
    first = shapes.with_kept_coefficients(ALONE, drive)
    again = shapes.with_kept_coefficients(ALONE, with_fields(drive, {"load.torque": 1e5}))
    assert again.coefficients.disc is first.coefficients.disc
    assert shapes.with_kept_coefficients(Hybrid(), drive).coefficients.disc is not first.coefficients.disc
    for other in others:
        assert shapes.with_kept_coefficients(ALONE, other).coefficients.thickness == other.disc.thickness
    assert len(shapes._ENGINES) == shapes.MAX_KEPT_SHAPES
    assert shapes.with_kept_coefficients(HalfSpace(), drive) == HalfSpace()


def test_what_is_in_the_cache_is_read_without_a_lock(paper, derived, monkeypatch):
    """A cache that cannot be written but has everything was warned about, and workers waited for each other to read."""

    def refuse():
        raise AssertionError("the cache is tried")

    monkeypatch.setattr(shapes, "require_cache", refuse)
    drive = paper.cases["CS-1"]
    with pytest.raises(AssertionError, match="tried"):
        shapes.with_kept_coefficients(ALONE, drive)
    kept = cached_file(drive)
    kept.parent.mkdir(parents=True)
    kept.touch()
    assert shapes.with_kept_coefficients(ALONE, drive).coefficients.thickness == drive.disc.thickness


def derive_slowly(directory, shape, queue):
    """One of two processes that want the same shape: the second one finds it there."""
    import time

    with shapes._one_process(shape):
        there = (directory / shape).exists()
        time.sleep(0.3)
        (directory / shape).touch()
    queue.put(there)


def test_two_processes_do_not_derive_the_same_at_once(tmp_path):
    context = get_context("fork")
    queue = context.Queue()
    shape = tmp_path.name
    both = [context.Process(target=derive_slowly, args=(tmp_path, shape, queue)) for _ in range(2)]
    for process in both:
        process.start()
    for process in both:
        process.join(timeout=300)
    assert sorted(queue.get(timeout=300) for _ in both) == [False, True]


def test_search_on_another_engine(paper, derived, capsys):
    """Hybrid without coupling finds what the half-space finds; a shape for each candidate is told beforehand."""
    drive = paper.cases["CS-3"]
    torque = Problem(
        drive=drive, variables=(Variable(path="load.torque", low=3e5, high=4e5),), aims=("max_pin_load",), limits=()
    )
    thickness = replace(torque, variables=(Variable(path="disc.thickness", low=12.0, high=13.0),))
    assert not varies_shape(torque, ALONE)
    assert varies_shape(thickness, ALONE)
    solved = []

    def count(drives):
        solved.append(len(drives))
        return np.array([[one.disc.thickness] for one in drives])

    search(thickness, count, generations=3)
    assert sum(solved) - 1 <= most_candidates(thickness, 3)
    settings = [
        BatchSettings(crank_angle=position_angles(3), quantities=("max_pin_load",), engine=engine)
        for engine in (ALONE, HalfSpace())
    ]
    drives = [drive, with_fields(drive, {"disc.thickness": 12.5})]
    hybrid, plain = (analyse_samples(drives, one).values for one in settings)
    np.testing.assert_allclose(hybrid, plain, rtol=1e-7)
    assert len(derived) == 2


def test_the_engine_is_no_factor():
    """Samples with another engine in their drive file were all solved on one."""
    with refused_field("factors.analysis.compliance", "", "cannot vary, all samples of a study are analysed alike"):
        parse_sweep(tomllib.loads('factors."analysis.compliance" = ["half-space", "hybrid"]'), "paper")
