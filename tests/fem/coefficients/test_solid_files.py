"""Files of solid coefficients: laws that hold, laws that are broken on purpose, options and memory refused by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from fem.coefficients import solid_bodies
from fem.coefficients.dataset import derive_coefficients
from fem.coefficients.solid_dataset import need_of_solid
from fem.coefficients.stations import DiscStations
from fem.errors import MemoryLimitError, MeshError
from fem.shapes import DriveShapes
from ltca.commands.program import main
from ltca.drive.single_discs import nominal_shape
from ltca.errors import DamagedFileError, FaultError
from ltca.output.provenance import cache_home, code_hash
from ltca.reading.changes import with_fields
from ltca.reading.coefficient_file import read_coefficients, require_laws, write_coefficients
from ltca.reading.coefficient_laws import check_coefficients, station_tilt_resultants
from ltca.reading.coefficient_schema import require_schema
from ltca.reading.drive_file import load_drive

# One derivation serves them all; another goes on where it was interrupted.
pytestmark = pytest.mark.slow

DRIVE = """
name = "small"
[crank]
eccentricity = 1.5
[pin_wheel]
number_of_pins = 6
pin_circle_radius = 22.0
pin_radius = 4.5
[disc]
number_of_teeth = 5
thickness = 8.0
[crank_bearing]
inner_race_radius = 3.5
outer_race_radius = 6.5
number_of_rollers = 5
roller_radius = 1.5
roller_length = 6.0
[pin_shaft]
number_of_pins = 3
pin_circle_radius = 11.0
pin_radius = 1.0
hole_radius = 2.5
stiffness = 2.0e4
[load]
torque = 5000.0
light_torque = 500.0
[materials]
disc = { youngs_modulus = 2600.0, poisson_ratio = 0.38 }
wheel_pin = { youngs_modulus = 2600.0, poisson_ratio = 0.38 }
roller = { youngs_modulus = 206000.0, poisson_ratio = 0.3 }
inner_race = { youngs_modulus = 206000.0, poisson_ratio = 0.3 }
shaft_pin = { youngs_modulus = 206000.0, poisson_ratio = 0.3 }
"""
COARSE = {"stations": 0.5, "size": 2.0, "layers": 2}


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """A cache of its own for every test."""
    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture(scope="module")
def drive_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("drive") / "small.toml"
    path.write_text(DRIVE)
    return path


@pytest.fixture(scope="module")
def drive(drive_file):
    return next(iter(load_drive(drive_file).cases.values()))


@pytest.fixture(scope="module")
def solutions():
    """What the derivation found of every body, class and mesh, in its order."""
    return []


@pytest.fixture(scope="module")
def derived(drive, tmp_path_factory, solutions):
    solve = solid_bodies.solve_solid
    patch = pytest.MonkeyPatch()
    patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
    patch.setattr(
        solid_bodies, "solve_solid", lambda *args, **options: solutions.append(solve(*args, **options)) or solutions[-1]
    )
    dataset = derive_coefficients(drive, bodies="solid", **COARSE)
    patch.undo()
    return dataset


@pytest.fixture(scope="module")
def read(derived, tmp_path_factory):
    return read_coefficients(write_coefficients(derived, tmp_path_factory.mktemp("file") / "solid.nc"))


def test_a_derived_file_keeps_all_laws_but_those_of_fineness(read):
    checks = check_coefficients(read)
    names = [check.name for check in checks]
    assert len(set(names)) == len(names)
    assert sum(name.endswith(", tilt") for name in names) == 8
    # On meshes four times as coarse, half of the stations: what a file states of its fineness is not a law.
    require_laws(read, "solid.nc")
    assert read.attrs["dimensions"] == 3
    assert read.attrs["plane"] == "solid"
    assert 0.0 <= read.attrs["bracket_lowest"] < read.attrs["bracket"] < read.attrs["bracket_highest"] < 1.0
    # Two layers, the last half as thick as the first.
    np.testing.assert_allclose(read["layer_height"].values, [0.0, 8.0 / 3.0, 4.0], rtol=1e-14)
    assert not list(cache_home().glob("pieces-*"))


def test_rollers_have_their_own_length(read):
    # A linear load of 1 N mm on 6 mm is 12/6² of the near field's unit of 6 mm: patch and wide patch tell.
    drop = read["roller_tilt_approach"].values[0, 0] - float(read["roller_wide_tilt_approach"].values)
    unit = 2.0 * (1.0 - 0.3**2) / (np.pi * 206e3 * 6.0) * 12.0 / 6.0**2
    # Curvature under patches of a twentieth and a tenth of the radius, and the free ends under them: 4 % as in the law.
    assert drop / np.log(2.0) == pytest.approx(unit, rel=0.04)


def test_linear_loads_are_moments_along_the_walls(read):
    np.testing.assert_allclose(read["disc_tilt_resultant"].values, station_tilt_resultants(read), atol=1e-12)


def changed(read, name, change):
    variable = read[name]
    return replace(
        read, variables=dict(read.variables) | {name: replace(variable, values=change(variable.values.copy()))}
    )


def uneven(values):
    values[3, 17] *= 1.001
    return values


@pytest.mark.parametrize(
    ("name", "change", "law"),
    [
        ("disc_tilt_approach", uneven, "symmetry of the stored matrices"),
        ("disc_tilt_approach", lambda values: 1.1 * values, "near field, disc, worst station, tilt"),
        ("disc_tilt_approach", lambda values: -values, "smallest eigenvalue, disc, tilt"),
        ("disc_approach", lambda values: 1.1 * values, "near field, disc, worst station"),
        ("pin_tilt_approach", lambda values: 1.1 * values, "near field, pin, roller, race, tilt"),
        ("race_tilt_approach", lambda values: -values, "smallest eigenvalue, pin, roller, race, tilt"),
        ("race_approach", lambda values: 1.3 * values, "race against the held ring"),
        ("pin_approach", lambda values: 0.9 * values, "pin against the held ring"),
        ("roller_approach", lambda values: 1.2 * values, "roller against the compressed cylinder"),
        ("disc_tilt_resultant", lambda values: values[::-1], "resultants of the patches and of the stations, tilt"),
        ("disc_stress", lambda values: 1.5 * values, "stress along closed walls"),
    ],
)
def test_a_broken_law_is_named(read, name, change, law):
    with error_says(DamagedFileError, law):
        require_laws(changed(read, name, change), "solid.nc")


@pytest.mark.parametrize(
    ("attribute", "value", "law"),
    [
        ("bracket_lowest", -0.1, "least share of plane stress"),
        ("bracket_highest", 1.2, "largest share of plane stress"),
        ("symmetry", 1e-3, "reciprocity"),
    ],
)
def test_a_broken_statement_is_named(read, attribute, value, law):
    with error_says(DamagedFileError, law):
        require_laws(replace(read, attrs=dict(read.attrs) | {attribute: value}), "solid.nc")


def without(read, *names):
    return replace(read, variables={name: own for name, own in read.variables.items() if name not in names})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda read: without(read, "disc_tilt_approach"), "it lacks disc_tilt_approach"),
        (lambda read: without(read, "wide_approach", "wide_station", "wide_half_width"), "it lacks wide_approach"),
        (lambda read: replace(read, attrs=dict(read.attrs) | {"plane": "strain"}), "must be solid"),
        (lambda read: replace(read, attrs=dict(read.attrs) | {"dimensions": 4}), "dimensions = 4"),
        (
            lambda read: replace(read, attrs=dict(read.attrs) | {"dimensions": 2, "plane": "strain"}),
            "no meaning without",
        ),
        (lambda read: replace(read, attrs=dict(read.attrs) | {"roller_length": 7.0}), "roller_length = 7"),
        (
            lambda read: replace(
                read, attrs={name: own for name, own in read.attrs.items() if name != "roller_length"}
            ),
            "lacks the attributes roller_length",
        ),
        (lambda read: changed(read, "layer_height", lambda values: 1.2 * values), "layer_height must ascend"),
    ],
)
def test_a_file_of_another_form_is_refused(read, change, words):
    with error_says(DamagedFileError, words):
        require_schema(change(read), "solid.nc")


def test_roller_length_belongs_to_the_shape_of_solid_bodies_alone(drive):
    shorter = with_fields(drive, {"crank_bearing.roller_length": 5.0})
    assert drive.shape_fingerprint() == shorter.shape_fingerprint()
    assert drive.shape_fingerprint("solid") != shorter.shape_fingerprint("solid")
    assert drive.shape_fingerprint("solid") != drive.shape_fingerprint()


def test_what_was_interrupted_goes_on(drive, monkeypatch, derived, solutions):
    """What is solved is taken from the derivation before: which pieces are asked for, kept and put together is looked at."""
    solved, answers = [], iter(solutions)

    def interrupted(*args, **options):
        if len(solved) == 3:
            raise KeyboardInterrupt
        solved.append(options["parity"])
        return next(answers)

    monkeypatch.setattr("fem.coefficients.solid_bodies.solve_solid", interrupted)
    with pytest.raises(KeyboardInterrupt):
        derive_coefficients(drive, bodies="solid", **COARSE)
    (kept,) = cache_home().glob("pieces-*")
    assert len(list(kept.glob("*.npz"))) == 3
    again, full = [], []

    def store(dataset):
        full.append(dataset)
        if len(full) == 1:
            raise FaultError("coefficients.nc: cannot be written: No space left on device")

    monkeypatch.setattr(
        "fem.coefficients.solid_bodies.solve_solid",
        lambda *args, **options: again.append(options["parity"]) or next(answers),
    )
    with pytest.raises(FaultError, match="No space left"):
        derive_coefficients(drive, bodies="solid", **COARSE, store=store)
    # Four bodies, two classes, two meshes; no room for the file costs none of them.
    assert len(again) == 16 - 3
    found = derive_coefficients(drive, bodies="solid", **COARSE, store=store)
    assert len(again) == 16 - 3
    assert full[-1] is found
    np.testing.assert_array_equal(found["disc_tilt_approach"].values, derived["disc_tilt_approach"].values)
    assert not list(cache_home().glob("pieces-*"))


def test_a_solid_disc_that_does_not_fit_is_refused_beforehand(drive, monkeypatch):
    monkeypatch.setattr("fem.coefficients.dataset.available_memory", lambda: 4.0e8)
    with pytest.raises(MemoryLimitError, match="--bodies solid"):
        derive_coefficients(drive, bodies="solid", stations=2.0)


def test_need_grows_with_layers_and_loads(drive):
    shape = DriveShapes.of_drive(nominal_shape(drive)).disc
    few, many = (DiscStations.of_disc(shape, scale) for scale in (0.5, 2.0))
    one = need_of_solid(shape, few, size=1.0, layers=1)
    assert need_of_solid(shape, few, size=1.0, layers=3).memory > one.memory
    assert need_of_solid(shape, many, size=1.0, layers=1).seconds > one.seconds
    assert one.words.startswith("solid disc: some")


def test_plane_stress_and_too_many_layers_have_no_meaning(drive):
    with pytest.raises(MeshError, match="plane stress: has no meaning"):
        derive_coefficients(drive, bodies="solid", state="stress")
    with pytest.raises(MeshError, match="layers = 41"):
        derive_coefficients(drive, bodies="solid", layers=41)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--bodies", "solid", "--plane", "strain"], "--plane strain: has no meaning with --bodies solid"),
        (["--layers", "3"], "--layers 3: has no meaning with plane bodies"),
        (["--part", "ring", "--bodies", "solid"], "--bodies: has no meaning with --part ring"),
        (["--check", "x.nc", "--bodies", "solid"], "--bodies: has no meaning with --check"),
    ],
)
def test_options_without_meaning_are_refused(drive_file, options, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["derive", str(drive_file), *options]) == 2
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_file_is_checked_and_told(read, derived, drive_file, capsys, tmp_path):
    path = write_coefficients(derived, tmp_path / "solid.nc")
    assert main(["derive", "--check", str(path), str(drive_file)]) in (
        0,
        1,
    )  # fineness is told, and may be too little here
    told = capsys.readouterr().out
    assert "stations, solid (" in told
    assert "smallest eigenvalue, disc, tilt" in told
    broken = [line for line in told.splitlines() if line.endswith("FAILED")]
    assert all(line.startswith(("convergence", "interpolation")) for line in broken)
