"""Each case finds the coefficients of its own bodies; what belongs to others is refused by name."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from refusals import error_says, refused_field

from ltca.analysis.engines import Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset
from ltca.commands.program import main
from ltca.compliance import coefficient_files
from ltca.compliance.coefficient_files import (
    cached_file,
    expected_seconds,
    find_case_coefficients,
    find_coefficients,
)
from ltca.compliance.coefficients import load_coefficients
from ltca.drive.deviations import OneDisc, Runout
from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError
from ltca.output.provenance import code_hash
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients
from ltca.testing.practical_drives import practical_drive

ALUMINIUM = {"materials.disc.youngs_modulus": 70_000.0, "materials.disc.poisson_ratio": 0.33}


@pytest.fixture
def derived(monkeypatch, tmp_path):
    """Bodies in closed form in place of finite elements, an empty cache, and the list of what was derived."""
    shapes = []

    def derive(drive, *, bodies, processes, store):
        shapes.append(drive.body_shape())
        store(closed_form_coefficients(drive, half_width=0.05, depth=300.0))

    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(coefficient_files, "derivation", lambda: derive)
    monkeypatch.setattr(coefficient_files, "MAX_DERIVATIONS", 1)
    return shapes


def write(drive, path, **attributes):
    """Write a coefficient file of a drive."""
    dataset = closed_form_coefficients(drive, half_width=0.05, depth=300.0)
    dataset.assign_attrs(attributes).to_netcdf(path, engine="h5netcdf")
    return path


@pytest.mark.slow
def test_every_case_has_the_coefficients_of_its_own_bodies(paper_cases, derived):
    """All cases used the first one's: an aluminium disc as third case read 242 N together and 1496 N alone."""
    steel = paper_cases["CS-1"]
    cases = {
        "steel": steel,
        "heavy": with_fields(steel, {"load.torque": 500_000.0, "pin_shaft.stiffness": 2e6}),
        "aluminium": with_fields(steel, ALUMINIUM),
        "clearance": paper_cases["CS-6"],
    }
    found = find_case_coefficients(cases)
    # one for each distinct shape: load and spring are none of the bodies' business
    assert derived == [cases[name].body_shape() for name in ("steel", "aluminium", "clearance")]
    for name, drive in cases.items():
        assert found[name].fingerprint == drive.shape_fingerprint()
        assert not found[name].shared
    assert found["aluminium"].disc_logarithm > 2.0 * found["steel"].disc_logarithm
    engine = PlaneStrain()
    together = {name: analyse(drive, np.array([0.5]), engine=engine) for name, drive in cases.items()}
    alone = analyse(cases["aluminium"], np.array([0.5]), engine=PlaneStrain(coefficients=found["aluminium"]))
    assert len(derived) == 3  # kept
    np.testing.assert_array_equal(together["aluminium"].full.response.pin_load, alone.full.response.pin_load)
    assert np.ptp([analysis.full.response.pin_load.max() for analysis in together.values()]) > 100.0


@pytest.mark.slow
def test_files_are_given_to_the_cases_they_belong_to(paper_cases, derived, tmp_path, capsys):
    cases = {name: paper_cases[name] for name in ("CS-1", "CS-6")}
    files = [write(drive, tmp_path / f"{name}.nc") for name, drive in cases.items()]
    found = find_case_coefficients(cases, files[::-1])
    assert {name: own.fingerprint for name, own in found.items()} == {
        name: drive.shape_fingerprint() for name, drive in cases.items()
    }
    assert find_coefficients(cases["CS-6"], files).fingerprint == cases["CS-6"].shape_fingerprint()
    assert derived == []
    assert capsys.readouterr().err == ""
    with error_says(CycloError, "case CS-6: ", "CS-1.nc: belongs to the clearances"):
        find_case_coefficients(cases, files[:1])
    other = write(with_fields(cases["CS-1"], ALUMINIUM), tmp_path / "other.nc")
    with error_says(CycloError, "--coefficients ", "other.nc: serves no case of this run"):
        find_case_coefficients(cases, [*files, other])


@pytest.mark.slow
def test_files_of_other_bodies_are_refused_by_what_differs(paper_cases, tmp_path):
    drive = paper_cases["CS-1"]
    other = with_fields(drive, {"crank.eccentricity": 3.9, **ALUMINIUM})
    path = write(drive, tmp_path / "c.nc")
    with pytest.raises(CycloError) as refused:
        load_coefficients(path, other)
    for part in (
        "belongs to another drive (paper)",
        "crank.eccentricity 4 (here 3.9)",
        "materials.disc.youngs_modulus 206000 (here 70000)",
        "materials.disc.poisson_ratio 0.3 (here 0.33)",
        "cyclo derive",
    ):
        assert part in str(refused.value)
    assert "thickness" not in str(refused.value)


@pytest.mark.slow
def test_files_of_other_clearances_are_used_only_if_they_say_so(paper_cases, tmp_path, capsys):
    nominal, clear = paper_cases["CS-1"], paper_cases["CS-6"]
    path = write(nominal, tmp_path / "nominal.nc")
    with pytest.raises(CycloError) as refused:
        load_coefficients(path, clear)
    for part in ("bearing 0 mm and pin hole 0 mm", "clearance.bearing = 0.03 mm", "clearance.pin_hole = 0.03 mm"):
        assert part in str(refused.value)
    assert "cyclo derive --without-clearance" in str(refused.value)
    on_purpose = write(nominal, tmp_path / "shared.nc", clearances_left_out=1)
    found = find_case_coefficients({"CS-1": nominal, "CS-6": clear}, [on_purpose])
    assert not found["CS-1"].shared
    assert found["CS-6"].shared
    assert capsys.readouterr().err == f"{on_purpose}: leaves the clearances of CS-6 out, on purpose\n"
    # left out are the clearances, nothing else; and a file with clearances of its own is shared by nobody
    with pytest.raises(CycloError, match="belongs to another drive"):
        load_coefficients(on_purpose, with_fields(clear, {"crank.eccentricity": 3.9}))
    with pytest.raises(CycloError, match=r"bearing 0.03 mm and pin hole 0.03 mm"):
        load_coefficients(write(clear, tmp_path / "own.nc", clearances_left_out=1), nominal)


def test_files_that_are_none_are_refused(paper_cases, tmp_path):
    drive, path = paper_cases["CS-1"], tmp_path / "broken.nc"
    path.write_bytes(b"not netCDF")
    with pytest.raises(CycloError, match="cannot be read as a coefficient file"):
        load_coefficients(path, drive)
    with error_says(CycloError, "shape must be a JSON object of numbers"):
        load_coefficients(write(drive, path, shape="{"), drive)
    bare = closed_form_coefficients(drive, half_width=0.05, depth=300.0).drop_vars("race_approach")
    del bare.attrs["shape"]
    bare.to_netcdf(path, engine="h5netcdf")
    with error_says(CycloError, "it lacks race_approach; it lacks the attributes shape"):
        load_coefficients(path, drive)


def test_damaged_files_in_the_cache_are_made_again(paper_cases, derived):
    drive = paper_cases["CS-1"]
    first = find_coefficients(drive)
    cached_file(drive).write_bytes(cached_file(drive).read_bytes()[:-2000])
    second = find_coefficients(drive)
    assert len(derived) == 2
    np.testing.assert_array_equal(first.disc, second.disc)


def test_what_plane_strain_cannot_say_is_refused_before_any_work(paper_cases, derived):
    short = with_fields(paper_cases["CS-1"], {"crank_bearing.roller_length": 8.0})
    for find in (
        lambda: find_coefficients(short, engine="fe"),
        lambda: find_case_coefficients({"CS-1": paper_cases["CS-1"], "short": short}, engine="fe"),
        lambda: analyse(short, np.array([0.5]), engine=PlaneStrain()),
    ):
        with refused_field("crank_bearing.roller_length", "= 8 mm"):
            find()
    assert derived == []
    analyse(short, np.array([0.5]), engine=Hybrid())
    assert derived == [short.body_shape()]


def test_what_does_not_fit_beside_another_is_derived_alone(paper_cases, derived, monkeypatch):
    """Two at once share the memory: one that fails beside another is tried once more by itself."""
    tried = []

    def derive(drive, *, bodies, processes, store):
        tried.append((drive.name, processes))
        if drive.name == "large" and processes > 1:
            raise CycloError("too large")
        store(closed_form_coefficients(drive, half_width=0.05, depth=300.0))

    monkeypatch.setattr(coefficient_files, "derivation", lambda: derive)
    monkeypatch.setattr(coefficient_files, "MAX_DERIVATIONS", 2)
    monkeypatch.setattr(coefficient_files.os, "cpu_count", lambda: 4)
    monkeypatch.setattr(coefficient_files, "process_pool", lambda count: ThreadPoolExecutor(1))
    cases = {"small": replace(paper_cases["CS-1"], name="small"), "large": replace(paper_cases["CS-6"], name="large")}
    found = find_case_coefficients(cases)
    assert sorted(tried) == [("large", 1), ("large", 2), ("small", 2)]
    assert found["large"].fingerprint == cases["large"].shape_fingerprint()


@pytest.mark.slow
def test_equal_discs_are_derived_once(paper_cases, derived):
    """Also where one of them has a runout: that is no matter of its body."""
    drive = with_fields(paper_cases["CS-1"], {"disc.number_of_discs": 2})
    of = (OneDisc(), OneDisc(runout=Runout(amount=0.01, angle=0.0)))
    drive = replace(drive, disc=replace(drive.disc, of=of))
    found = find_case_coefficients({"two": drive})
    assert list(found) == ["two, disc 0", "two, disc 1"]
    Hybrid().prepare(drive)
    assert len(derived) == 1


def test_how_long_a_derivation_takes_is_said_by_the_disc(paper_cases, derived, capsys):
    """Half an hour was told as 20 s: the time follows the number of teeth, and two shapes one after the other add up."""
    find_case_coefficients({name: paper_cases[name] for name in ("CS-1", "CS-6")})
    assert "CS-1, CS-6, once for each shape (some 10 s; kept in" in capsys.readouterr().err
    many = single_discs(practical_drive(2)[0])[0]
    assert (many.disc.number_of_teeth, many.number_of_holes) == (75, 4)
    paper, many_teeth = expected_seconds([paper_cases["CS-1"], many])
    # Processor time of the paper's disc and of one of 75 teeth and four holes (docs/theory/coefficients.md), to a factor of two.
    assert 2.3 < paper < 9.2  # 4.6 s
    assert 4.0 < many_teeth < 16.0  # 8 s


@pytest.mark.slow
def test_run_of_cases_of_different_bodies(derived, tmp_path, capsys):
    """Together as alone, and nothing said of pressures at ends that plane strain does not have."""
    aluminium = '\n[[case]]\nname = "AL"\nmaterials.disc = { youngs_modulus = 70e3, poisson_ratio = 0.33 }\n'
    path = tmp_path / "drive.toml"
    path.write_text(shipped_drive() + aluminium, encoding="utf-8")
    words = ["run", str(path), "--angles", "0.5", "--compliance", "fe", "--no-figures"]
    summaries = {}
    for name, cases in (("together", ["CS-1", "AL"]), ("alone", ["AL"])):
        chosen = [word for case in cases for word in ("--case", case)]
        assert main([*words, *chosen, "--out", str(tmp_path / name)]) == 0
        summaries[name] = json.loads((tmp_path / name / "summary.json").read_text(encoding="utf-8"))["cases"]
    told = capsys.readouterr()
    assert summaries["together"]["AL"] == summaries["alone"]["AL"]
    assert summaries["together"]["AL"]["max_pin_load_N"] != summaries["together"]["CS-1"]["max_pin_load_N"]
    assert told.err.startswith("deriving influence coefficients of CS-1, AL, once for each shape")
    assert told.err.count("deriving") == 1
    case = summaries["alone"]["AL"]
    for key in ("max_pin_pressure_max_MPa", "max_roller_pressure_max_MPa", "pin_end_cell_mm", "roller_end_cell_mm"):
        assert case[key] is None
    assert case["max_pin_pressure_mid_MPa"] > 500.0


@pytest.mark.slow
def test_results_say_when_coefficients_are_shared(paper_cases, tmp_path):
    path = write(paper_cases["CS-1"], tmp_path / "shared.nc", clearances_left_out=1)
    words = ["run", "paper", "--case", "CS-1", "--case", "CS-6", "--angles", "0.5", "--compliance", "hybrid"]
    assert main([*words, "--coefficients", str(path), "--no-figures", "--out", str(tmp_path)]) == 0
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as results:
        assert results.attrs["shared_coefficients"].tolist() == [0, 1]
        assert np.all(results["pin_pressure_max"] >= results["pin_pressure_mid"])


def test_half_spaces_take_no_coefficients(tmp_path, capsys):
    words = ["run", "paper", "--angles", "0.5", "--coefficients", "c.nc", "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert "coefficients: has no effect with compliance half-space" in capsys.readouterr().err


def test_results_carry_the_code_that_derived_their_coefficients(paper_cases, tmp_path):
    """A run's own hash cannot vouch for the finite elements behind its coefficients."""
    drive = paper_cases["CS-1"]
    path = write(drive, tmp_path / "c.nc", code_hash="0123abcd")
    engine = Hybrid(coefficients=load_coefficients(path, drive))
    found = build_dataset("paper", {"CS-1": analyse(drive, np.array([0.5]), engine=engine)})
    assert found.attrs["coefficients_code_hash"] == ["0123abcd"]
    assert found.attrs["code_hash"] != "0123abcd"
