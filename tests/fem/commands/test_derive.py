"""``cyclo derive``: the file, its checks, messages."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from refusals import error_is, error_says

from fem.coefficients.dataset import derive_coefficients
from fem.coefficients.stations import DiscStations
from fem.commands import derive
from fem.shapes import DriveShapes
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficient_files import find_case_coefficients
from ltca.compliance.coefficients import load_coefficients
from ltca.drive.deviations import DiscClearance, OneDisc
from ltca.drive.single_discs import nominal_shape
from ltca.errors import CycloError, DamagedFileError, FaultError
from ltca.reading.coefficient_file import read_coefficients, write_coefficients
from ltca.reading.coefficient_laws import check_coefficients
from ltca.reading.drive_file import load_drive
from ltca.reading.writing import drive_text

COARSE = ("--stations", "0.25", "--size", "1.5")


# One derivation serves them all, and takes most of a minute.
pytestmark = pytest.mark.slow


def run(*words: str) -> int:
    parser = argparse.ArgumentParser()
    derive.configure(parser)
    return derive.execute(parser.parse_args(words))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """File, printed text and exit status of a coarse run for CS-6, its clearances left out on purpose."""
    path = tmp_path_factory.mktemp("derive") / "new" / "coefficients.nc"
    command = [
        sys.executable,
        "-c",
        "import sys; from fem.commands import derive; import argparse; "
        "p = argparse.ArgumentParser(); derive.configure(p); sys.exit(derive.execute(p.parse_args()))",
    ]
    words = ["paper", "--case", "CS-6", *COARSE, "--without-clearance", "--out", str(path)]
    done = subprocess.run([*command, *words], capture_output=True, text=True, check=False, env=dict(os.environ))
    return path, done


@pytest.fixture(scope="module")
def dataset(made):
    return read_coefficients(made[0]).to_xarray()


def test_file_is_made_and_checked(made):
    path, done = made
    assert done.returncode == 0, done.stdout + done.stderr
    assert "FAILED" not in done.stdout
    assert done.stdout.count(" ok\n") == len(check_coefficients(read_coefficients(path)))
    assert "clearances: bearing 0 mm, pin hole 0 mm, those of the case left out" in done.stdout
    # No terminal: a line now and then on a machine that takes longer than ten seconds; no half file beside the whole one.
    assert [
        line for line in done.stderr.splitlines() if not re.fullmatch(r"deriving coefficients: .* \(\d+ s\)", line)
    ] == []
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_file_follows_its_format(dataset):
    drive = load_drive("paper").cases["CS-1"]
    stations = DiscStations.of_disc(DriveShapes.of_drive(nominal_shape(drive)).disc, 0.25)
    np.testing.assert_array_equal(dataset["station_boundary"], stations.boundary)
    np.testing.assert_allclose(dataset["station_x"] + 1j * dataset["station_y"], stations.points)
    np.testing.assert_allclose(dataset["station_normal_x"] + 1j * dataset["station_normal_y"], stations.normals)
    for boundary in range(10):
        own = dataset["station_parameter"].values[dataset["station_boundary"].values == boundary]
        uniform = 2.0 * np.pi * np.arange(len(own)) / len(own)
        # θ = t − (a/z) sin(z t): closer in the roots of the flank.
        closer = 0.0 if boundary else 0.6 / 13.0 * np.sin(13.0 * uniform)
        np.testing.assert_allclose(own, uniform - closer, atol=1e-15)
    count = stations.count
    assert dataset["disc_approach"].dims == ("station", "station_loaded")
    assert dataset["disc_approach"].shape == (count, count)
    assert dataset["roller_approach"].shape == (2, 2)
    assert dataset["race_approach"].shape == dataset["race_angle"].shape
    assert dataset["pin_approach"].shape == dataset["pin_half_width"].shape == ()
    for name, variable in dataset.variables.items():
        assert "units" in variable.attrs, name
    expected = {
        "drive": "paper",
        "case": "CS-6",
        "plane": "strain",
        "thickness": 11.8,
        "core_radius": 2.0,
        "race_bore_radius": 10.0,
        "bearing_clearance": 0.0,
        "pin_hole_clearance": 0.0,
        "clearances_left_out": 1,
        "fingerprint": drive.shape_fingerprint(),
        "shape": json.dumps(drive.body_shape()),
    }
    assert {name: dataset.attrs[name] for name in expected} == expected
    for name in ("datum", "unknowns_disc", "mesh_size", "convergence_estimate", "symmetry", "version", "gmsh"):
        assert dataset.attrs[name], name


@pytest.mark.slow
def test_same_numbers_again_whichever_case(dataset):
    """Clearances left out, gmsh seeded: the case without any gives the same numbers, bit by bit."""
    again = derive_coefficients(load_drive("paper").cases["CS-1"], stations=0.25, size=1.5)
    largest = np.max(np.abs(again["disc_approach"].values))  # the file keeps 18 bits below it
    np.testing.assert_allclose(dataset["disc_approach"], again["disc_approach"], rtol=0.0, atol=2.0**-18 * largest)
    np.testing.assert_array_equal(again["race_approach"], dataset["race_approach"])
    assert again.attrs["clearances_left_out"] == 0


@pytest.mark.slow
def test_a_run_takes_the_file_for_its_own_case_and_as_shared(made):
    """What is written is what a run reads: for the case without clearances its own, for another said to be shared."""
    cases = load_drive("paper").cases
    found = find_case_coefficients({name: cases[name] for name in ("CS-1", "CS-6")}, [made[0]])
    assert [found[name].shared for name in ("CS-1", "CS-6")] == [False, True]
    pressed = analyse(cases["CS-6"], np.array([0.5]), engine=PlaneStrain(coefficients=found["CS-6"]))
    # by the default file of its own 2848.8 N; this one is coarse, and shared
    assert pressed.full.response.pin_load.max() == pytest.approx(2848.8, rel=0.01)


def spoiled(dataset, name):
    """Return the coefficients with one mistake."""
    wrong = dataset.copy(deep=True)
    disc = wrong["disc_approach"].values
    if name == "symmetry of the stored matrices":
        disc[3, 5] *= 1.0 + 1e-6
    elif name == "reciprocity of displacements solved for":
        wrong.attrs["symmetry"] = 1e-7
    elif name == "smallest eigenvalue, disc":
        disc[40, 40] *= 0.5
    elif name == "smallest eigenvalue, pin, roller, race":
        wrong["roller_approach"].values[0, 1] = wrong["roller_approach"].values[1, 0] = 1e-6
    elif name == "rigid motions and change of datum":
        wrong.attrs["rigid_residual"] = float("nan")
    elif name == "resultants of the patches and of the stations":
        wrong["station_normal_x"].values[7] *= -1.0
    elif name == "near field, disc, worst station":
        wrong["wide_approach"].values[2] *= 1.01
    elif name == "near field, pin, roller, race":
        wrong["pin_wide_approach"] *= 0.9
    elif name == "entry out of line against those beside it":
        disc[50, 80] += 10.0 * disc.max()
        disc[80, 50] = disc[50, 80]
    elif name == "roller against the compressed cylinder":
        wrong["roller_approach"] *= 1.01
    elif name == "pin against the held ring":
        wrong["pin_half_width"] *= 1.5
    elif name == "race against the held ring, worst angle":
        wrong["race_half_width"] *= 1.5
    elif name == "stress left by even pressure on all walls":
        wrong["disc_stress"].values[:] = np.abs(wrong["disc_stress"].values)  # signs lost: nothing cancels
    elif name == "stress along closed walls against their displacement":
        wrong["disc_stress"].values[:] *= (
            1.5  # a quarter of the stations: the walls' bound is 0.30 here, 0.10 with all of them
        )
    elif name == "convergence of the stresses: error of the mesh, estimated":
        wrong.attrs["convergence_stress"] = 0.5
    else:
        wrong.attrs["convergence_estimate"] = 0.02
    return wrong


STRESS_ALONG_WALLS = "stress along closed walls against their displacement"
NAMES = [
    "symmetry of the stored matrices",
    "reciprocity of displacements solved for",
    "smallest eigenvalue, disc",
    "smallest eigenvalue, pin, roller, race",
    "rigid motions and change of datum",
    "resultants of the patches and of the stations",
    "near field, disc, worst station",
    "near field, pin, roller, race",
    "entry out of line against those beside it",
    "roller against the compressed cylinder",
    "pin against the held ring",
    "race against the held ring, worst angle",
    "stress left by even pressure on all walls",
    STRESS_ALONG_WALLS,
    "convergence: error of the mesh, estimated",
    "convergence of the stresses: error of the mesh, estimated",
]


@pytest.mark.parametrize("name", NAMES)
def test_every_check_can_fail(dataset, name):
    before = {check.name: check.passed for check in check_coefficients(dataset)}
    assert list(before) == NAMES
    assert all(before.values())
    after = {check.name: check.passed for check in check_coefficients(spoiled(dataset, name))}
    assert not after[name]


@pytest.mark.parametrize(("words", "kept"), [((), True), (("--without-clearance",), False)])
def test_clearances_of_the_case_are_kept_unless_told(words, kept, dataset, tmp_path, monkeypatch):
    asked = []

    def derive(drive, **options):
        asked.append((drive.clearance.bearing, options["keep_clearance"]))
        options["store"](dataset)
        return dataset

    monkeypatch.setattr("fem.coefficients.dataset.derive_coefficients", derive)
    assert run("paper", "--case", "CS-6", *words, "--out", str(tmp_path / "c.nc")) == 0
    assert asked == [(0.03, kept)]


def test_failed_check_gives_status_one(dataset, tmp_path, monkeypatch, capsys):
    wrong = spoiled(dataset, "roller against the compressed cylinder")

    def derive(drive, **options):
        options["store"](wrong)
        return wrong

    monkeypatch.setattr("fem.coefficients.dataset.derive_coefficients", derive)
    assert run("paper", "--out", str(tmp_path / "c.nc")) == 1
    assert "FAILED" in capsys.readouterr().out


def test_failure_leaves_the_old_file(dataset, tmp_path, monkeypatch):
    path = tmp_path / "c.nc"
    path.write_text("old")

    def fail(dataset, part, packed):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("ltca.reading.coefficient_file.write_netcdf", fail)
    with pytest.raises(FaultError, match="No space left"):
        write_coefficients(dataset, path)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["c.nc"]


def test_folder_as_file_is_refused(tmp_path):
    with pytest.raises(CycloError, match="is a folder"):
        run("paper", "--out", str(tmp_path))


def test_other_files_are_refused(tmp_path):
    with pytest.raises(DamagedFileError, match="no such file"):
        read_coefficients(tmp_path / "none.nc")
    text = tmp_path / "text.nc"
    text.write_text("nothing")
    with pytest.raises(DamagedFileError, match="cannot be read"):
        read_coefficients(text)


def test_other_datasets_are_refused(tmp_path):
    import xarray as xr

    other = tmp_path / "other.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(other, engine="h5netcdf")
    with pytest.raises(DamagedFileError, match="is no file of influence coefficients"):
        read_coefficients(other)


def foreign(dataset):
    """What another code would give: nothing on how it was derived, nothing that serves checking alone."""
    used = dataset.drop_vars(
        ["disc_resultant", "wide_station", "wide_half_width", "wide_approach"]
        + [name for name in dataset.variables if "stress" in name]
        + [f"{body}_wide_approach" for body in ("pin", "roller", "race")]
    )
    kept = ("shape", "flank_clustering", "plane", "thickness", "roller_radius", "clearances_left_out")
    ends = ("_modulus", "_ratio", "_clearance")
    used.attrs = {name: value for name, value in dataset.attrs.items() if name in kept or name.endswith(ends)}
    return used


def write(dataset, tmp_path):
    path = tmp_path / "file.nc"
    dataset.to_netcdf(path, engine="h5netcdf")
    return str(path)


def test_check_of_our_own_file(made, capsys):
    assert run("--check", str(made[0]), "paper", "--case", "CS-6") == 0
    out = capsys.readouterr().out
    assert "FAILED" not in out
    assert "not checked" not in out
    for name in (*NAMES, "places of the stations on the drive's bodies"):
        assert name in out
    assert "at least 0.1 " in out  # a law without an upper bound


def test_check_of_another_codes_file(made, dataset, tmp_path, capsys):
    path = write(foreign(dataset), tmp_path)
    assert run("--check", path) == 0
    assert run("--check", path, "paper", "--case", "CS-6") == 0
    out = capsys.readouterr().out
    assert out.count("not checked: the file has no") == 2 * 11
    assert "not checked: the file has no symmetry" in out
    # What passes can be used, and says the same as the whole file.
    drive = load_drive("paper").cases["CS-6"]
    used, whole = (load_coefficients(Path(name), drive) for name in (path, made[0]))
    np.testing.assert_array_equal(used.disc, whole.disc)
    np.testing.assert_array_equal(used.race, whole.race)
    # What it does hold is checked: a softer roller is no cylinder.
    wrong = foreign(dataset)
    wrong["roller_approach"] = 1.01 * wrong["roller_approach"]
    assert run("--check", write(wrong, tmp_path)) == 1
    assert "FAILED" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("variable", "change", "law"),
    [
        ("station_x", 1e-3, "places of the stations on the drive's bodies"),
        ("station_normal_x", 0.01, "normals of the stations on the drive's bodies"),
    ],
)
def test_a_file_that_only_claims_to_be_the_drives_is_found_out(variable, change, law, dataset, tmp_path, capsys):
    wrong = foreign(dataset)
    if variable == "station_x":
        wrong[variable] = wrong[variable] + change
    else:
        turned = (wrong["station_normal_x"] + 1j * wrong["station_normal_y"]).values * np.exp(1j * change)
        wrong = wrong.assign(station_normal_x=("station", turned.real), station_normal_y=("station", turned.imag))
    assert run("--check", write(wrong, tmp_path), "paper", "--case", "CS-6") == 1
    failed = [line for line in capsys.readouterr().out.splitlines() if line.endswith("FAILED")]
    assert any(line.startswith(law) for line in failed)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.drop_vars(["race_approach", "pin_half_width"]), "it lacks pin_half_width, race_approach"),
        (lambda d: d.drop_attrs(), "it lacks the attributes shape, clearances_left_out, bearing_clearance"),
        (lambda d: d.assign(wide_station=("wide", [0])), "it lacks wide_half_width, wide_approach"),
        (lambda d: d.assign(station_x=("place", d["station_x"].values)), "station_x has the dimensions (place)"),
        (lambda d: d.isel(station_loaded=slice(5)), "station and station_loaded differ in length"),
        (lambda d: d.assign(pin_approach=np.nan), "pin_approach holds values that are no finite numbers"),
        (lambda d: d.assign(pin_approach="soft"), "pin_approach holds no numbers"),
        (lambda d: d.assign(station_parameter=0.5 * d["station_parameter"]), "must be uniform over one turn"),
        (lambda d: d.assign(station_boundary=-d["station_boundary"]), "station_boundary must be 0"),
        (lambda d: d.assign(station_normal_x=2.0 * d["station_normal_x"]), "must be of unit length"),
        (lambda d: d.assign(race_half_width=0.0), "race_half_width must be greater than 0"),
        (lambda d: d.assign_attrs(plane="axial"), "plane = axial: must be strain or stress"),
        (lambda d: d.assign_attrs(thickness=0.0), "thickness = 0.0: must be greater than 0"),
        (lambda d: d.assign_attrs(disc_youngs_modulus=2e5), "disc_youngs_modulus = 200000: must be 206000 as in shape"),
        (lambda d: d.assign_attrs(shape="steel"), "shape must be a JSON object of numbers"),
        (lambda d: d.assign_attrs(clearances_left_out="no"), "clearances_left_out = no: must be a number"),
        (lambda d: d.assign(disc_stress=("stress_station", [0.0])), "it lacks stress_station_boundary"),
        (lambda d: d.assign_attrs(disc_poisson_ratio="steel"), "disc_poisson_ratio = steel: must be at least 0"),
        (lambda d: d.assign_attrs(symmetry="exact"), "symmetry = exact: must be a number"),
    ],
)
def test_a_wrong_schema_is_one_line(change, message, dataset, tmp_path):
    lacking = message if message.endswith("_approach") else ""  # those, and no others
    with error_says(CycloError, message, ends=lacking) as caught:
        run("--check", write(change(foreign(dataset)), tmp_path))
    assert "\n" not in str(caught.value)


def test_check_of_another_drives_file(dataset, tmp_path):
    shape = json.loads(dataset.attrs["shape"])
    shape["crank.eccentricity"] = 3.9
    path = write(foreign(dataset).assign_attrs(shape=json.dumps(shape)), tmp_path)
    assert run("--check", path) == 0
    with error_says(CycloError, "other bodies than those of paper: crank.eccentricity 3.9 (4 there)"):
        run("--check", path, "paper", "--case", "CS-6")


def test_check_knows_files_that_leave_clearances_out_on_purpose(dataset, tmp_path):
    """Of CS-6 without its clearances: it serves that case when it says so, not otherwise."""
    silent = write(foreign(dataset).assign_attrs(clearances_left_out=0), tmp_path)
    with error_says(CycloError, "bore_radius 29.5 (29.515 there), hole_radius"):
        run("--check", silent, "paper", "--case", "CS-6")
    assert run("--check", silent, "paper", "--case", "CS-1") == 0


def test_check_derives_nothing(made, tmp_path):
    with error_says(CycloError, "--size: has no meaning with --check"):
        run("--check", str(made[0]), "--size", "0.5")
    with error_is(CycloError, "derive: give a drive file, or a file of coefficients with --check"):
        run()
    with pytest.raises(CycloError, match="no such file"):
        run("--check", str(tmp_path / "none.nc"))
    whole = made[0].read_bytes()
    (tmp_path / "half.nc").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(CycloError, match="cannot be read"):
        run("--check", str(tmp_path / "half.nc"))


def test_help_is_light():
    """Listing the command loads neither gmsh nor scikit-fem."""
    code = (
        "import sys, argparse; from fem.commands import derive; derive.configure(argparse.ArgumentParser()); "
        "sys.exit(any(m in sys.modules for m in ('gmsh', 'skfem', 'xarray', 'numpy')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("factor", [2.0, -1.0, 0.0])
def test_stresses_of_another_size_or_sign_are_found_out(dataset, factor):
    """Twice the stresses passed every check and doubled all root stresses of a run."""
    wrong = dataset.copy(deep=True)
    wrong["disc_stress"].values[:] *= factor
    assert [check.name for check in check_coefficients(wrong) if not check.passed][-1:] == [STRESS_ALONG_WALLS]


def test_discs_cut_otherwise_get_a_file_each(dataset, paper_cases, tmp_path, monkeypatch, capsys):
    """Half a turn apart the paper's discs are one part, a third of a turn apart three; a clearance of its own makes another."""
    made = []

    def derived(drive, **options):
        made.append(drive)
        options["store"](dataset)
        return dataset

    monkeypatch.setattr("fem.coefficients.dataset.derive_coefficients", derived)
    drive = paper_cases["CS-1"]
    other = (OneDisc(), OneDisc(clearance=DiscClearance(bearing=0.02)))
    for name, discs, of, files in (
        ("alike", 2, (), {"c.nc": "discs 0, 1:"}),
        ("cut", 3, (), {f"c_disc_{disc}.nc": f"disc {disc}:" for disc in range(3)}),
        ("wide", 2, other, {f"c_disc_{disc}.nc": f"disc {disc}:" for disc in range(2)}),
    ):
        folder = tmp_path / name
        folder.mkdir()
        several = replace(drive, disc=replace(drive.disc, number_of_discs=discs, of=of))
        (folder / "drive.toml").write_text(drive_text(several), encoding="utf-8")
        made.clear()
        assert run(str(folder / "drive.toml"), "--out", str(folder / "c.nc")) == 0
        assert {path.name for path in folder.iterdir()} == {*files, "drive.toml"}
        out = capsys.readouterr().out
        for words in files.values():
            assert f"{words}\n" in out
        assert len({single.shape_fingerprint() for single in made}) == len(made) == len(files)


def test_a_derivation_imports_nothing_heavy(tmp_path):
    """xarray alone, with pandas and dask, took a tenth of the time of a derivation that uses nothing of them."""
    heavy = ("xarray", "pandas", "dask", "matplotlib", "pyvista", "meshio", "h5netcdf")
    program = (
        "import sys; from ltca.commands.program import main; "
        "status = main(['derive', 'paper', '--case', 'CS-1', '--stations', '0.25', '--size', '2', '--out', 'found.nc']); "
        f"sys.exit(status or ', '.join(name for name in {heavy!r} if name in sys.modules) or None)"
    )
    found = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (found.returncode, (tmp_path / "found.nc").is_file()) == (0, True), found.stderr
