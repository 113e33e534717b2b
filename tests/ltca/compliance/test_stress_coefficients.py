"""Stress along the walls from loads: reading, interpolation, masks, and what is said where a file has no stresses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance import wall_stress
from ltca.compliance.coefficients import load_coefficients
from ltca.compliance.stress_coefficients import evaluate_wall_stress
from ltca.compliance.wall_stress import CLEAR_HALF_WIDTHS, wall_profiles, wall_stresses
from ltca.contact.subsurface import LINE_SHEAR_DEPTH, line_contact_shear
from ltca.errors import CycloError
from ltca.geometry.boundary_stations import Boundary
from ltca.testing.closed_form_bodies import closed_form_coefficients
from validation.hertz import line_contact_stress

ANGLES = np.array([0.0, 0.5, 1.7])


def smooth_stress(boundary, parameter, loaded_boundary, loaded_parameter):
    """A made-up stress that is smooth in both places, MPa/N: what a newton at the second place does at the first.

    Every term turns with the loaded place, so even pressure leaves nothing, as the law wants.
    """
    wave = np.cos(2.0 * parameter - loaded_parameter + 0.3 * boundary)
    wave += 0.5 * np.sin(parameter + loaded_boundary) * np.cos(loaded_parameter)
    return 1e-2 * (wave + 0.2 * np.cos(2.0 * loaded_parameter))


@pytest.fixture(scope="module")
def drive(paper_cases):
    return paper_cases["CS-3"]


def make_file(path, drive, *, per_lobe=16, bore=30, per_hole=20):
    """Closed-form coefficients with a made-up stress at stress stations of their own."""
    data = closed_form_coefficients(drive, half_width=0.05, depth=300.0)
    loaded = data["station_boundary"].values
    loaded_parameter = np.concatenate([2.0 * np.pi * np.arange(n) / n for n in np.bincount(loaded).tolist()])
    counts = [per_lobe * drive.disc.number_of_teeth, bore, *[per_hole] * drive.pin_shaft.number_of_pins]
    boundary = np.repeat(np.arange(len(counts)), counts)
    parameter = np.concatenate([2.0 * np.pi * np.arange(count) / count for count in counts])
    stress = smooth_stress(boundary[:, None], parameter[:, None], loaded, loaded_parameter)
    data = data.assign(
        disc_stress=(("stress_station", "station_loaded"), stress),
        stress_station_boundary=("stress_station", boundary),
        stress_station_parameter=("stress_station", parameter),
    )
    data.to_netcdf(path, engine="h5netcdf")
    return path


@pytest.fixture(scope="module")
def coefficients(drive, tmp_path_factory):
    return load_coefficients(make_file(tmp_path_factory.mktemp("stress") / "coefficients.nc", drive), drive)


@pytest.fixture(scope="module")
def analysis(drive, coefficients):
    return analyse(drive, ANGLES, None, PlaneStrain(coefficients=coefficients))


def stresses_of(analysis):
    return wall_stresses(
        analysis.model.discs[0], analysis.full.response.parts[0], analysis.pressures, analysis.full.pose[:, 2]
    )


def profiles_of(analysis, **options):
    arguments = (analysis.model.discs[0], analysis.full.response.parts[0], analysis.pressures, analysis.full.pose[:, 2])
    return wall_profiles(*arguments, **options)


def test_fourier_series_between_stations():
    boundary = Boundary(first=2, count=10)
    coarse, fine = boundary.parameters(), boundary.parameters(4)

    def wave(x):
        return 3.0 + np.cos(4.0 * x - 1.0) - 0.5 * np.sin(x)

    values = np.concatenate([[7.0, 7.0], wave(coarse), [7.0]])
    np.testing.assert_allclose(boundary.refined(values, 4), wave(fine), atol=1e-13)
    np.testing.assert_allclose(boundary.refined(values, 1), wave(coarse), atol=1e-13)
    # Of the highest order of an even number of stations only the cosine is seen.
    alone = Boundary(first=0, count=10)
    np.testing.assert_allclose(alone.refined(np.cos(5.0 * coarse), 2), np.cos(5.0 * alone.parameters(2)), atol=1e-13)


def test_stress_is_that_of_the_places_between_stations(coefficients):
    """Six points interpolate a smooth stress over the place of the load: loads between stations, several at once."""
    stress = coefficients.stress
    rng = np.random.default_rng(11)
    contacts = tuple(
        (rng.uniform(-7.0, 7.0, (2, n)), rng.uniform(0.0, 1e3, (2, n))) for n in (5, 4, *[1] * len(coefficients.holes))
    )
    found = evaluate_wall_stress(stress, contacts)
    expected = np.zeros_like(found)
    for number, wall in enumerate(stress.walls):
        rows = slice(wall.first, wall.first + wall.count)
        for other, (parameter, load) in enumerate(contacts):
            each = smooth_stress(number, wall.parameters()[:, None], other, parameter[:, None, :])
            expected[:, rows] += np.sum(load[:, None, :] * each, axis=-1)
    # Six points on waves of order two, of which a hole's 8 stations have four each: 0.2 % (measured).
    np.testing.assert_allclose(found, expected, atol=5e-3 * np.abs(expected).max())
    doubled = [(parameter, 2.0 * load) for parameter, load in contacts]
    np.testing.assert_allclose(evaluate_wall_stress(stress, doubled), 2.0 * found, rtol=1e-12)


def test_largest_stresses_are_those_of_clear_places(drive, analysis):
    found = stresses_of(analysis)
    profiles = profiles_of(analysis, refinement=4)
    lobes = drive.disc.number_of_teeth
    assert found.root.shape == (len(ANGLES), lobes)
    assert found.bore.shape == (len(ANGLES),)
    assert found.hole.shape == (len(ANGLES), drive.pin_shaft.number_of_pins)
    flank = profiles[0]
    for row in range(len(ANGLES)):
        for root in range(lobes):
            middle = 2.0 * np.pi * root / lobes
            away = np.angle(np.exp(1j * (flank.parameter - middle)))
            # Places midway between two roots belong to either.
            own = (np.abs(away) < np.pi / lobes - 1e-9) & flank.clear[row]
            assert found.root[row, root] >= flank.stress[row, own].max() - 1e-12
            near = (np.abs(away) < np.pi / lobes + 1e-9) & flank.clear[row]
            assert found.root[row, root] in flank.stress[row, near]
        assert found.bore[row] == profiles[1].stress[row, profiles[1].clear[row]].max()
        for hole, wall in enumerate(profiles[2:]):
            assert found.hole[row, hole] == wall.stress[row, wall.clear[row]].max()


def test_walls_are_not_clear_beside_loaded_contacts(drive, analysis):
    profiles = profiles_of(analysis, refinement=64)
    response, geometry = analysis.full.response, analysis.model.discs[0].geometry
    pressures = analysis.pressures
    for row in range(len(ANGLES)):
        expected = np.ones(profiles[0].parameter.size, dtype=bool)
        for pin in np.flatnonzero(response.pin_load[row] > 0.0):
            place = geometry.profile.flank(response.flank.parameter[row, pin])
            away = np.abs(geometry.profile.flank(profiles[0].parameter) - place)
            expected &= away > CLEAR_HALF_WIDTHS * pressures.pins.half_width[row, pin]
        np.testing.assert_array_equal(profiles[0].clear[row], expected)
        assert not expected.all()
        for hole, wall in enumerate(profiles[2:]):
            assert wall.clear[row].all() == (response.hole_load[row, hole] == 0.0)
    # The contact of a shaft pin lies where the pin stands in its hole.
    row, hole = np.unravel_index(np.argmax(response.hole_load), response.hole_load.shape)
    wall = profiles[2 + hole]
    middle = np.angle(np.mean(np.exp(1j * wall.parameter[~wall.clear[row]])))
    pose = analysis.full.pose[row]
    place = geometry.placement
    centre = (
        place.races(ANGLES[row]).middle + complex(pose[0], pose[1]) + place.hole_centres[hole] * np.exp(1j * pose[2])
    )
    toward = np.angle(place.shaft_pin_centres[hole] - centre) - pose[2]
    assert np.angle(np.exp(1j * (middle - toward))) == pytest.approx(0.0, abs=2.0 * np.pi / wall.parameter.size)


def test_nothing_clear_is_no_number(analysis):
    """Contacts as wide as the wall: there is nothing left to report there."""
    wide = replace(analysis.pressures.pins, half_width=np.full_like(analysis.pressures.pins.half_width, 1e3))
    pressures = replace(analysis.pressures, pins=wide)
    found = wall_stresses(analysis.model.discs[0], analysis.full.response.parts[0], pressures, analysis.full.pose[:, 2])
    assert np.all(np.isnan(found.root))
    assert np.all(np.isfinite(found.bore))


def test_stress_under_contacts(analysis):
    """That of the profile at the contact's own place."""
    found, profiles = stresses_of(analysis), profiles_of(analysis, refinement=16)
    theta = np.mod(analysis.full.response.flank.parameter, 2.0 * np.pi)
    for row in range(len(ANGLES)):
        along = np.interp(theta[row], profiles[0].parameter, profiles[0].stress[row], period=2.0 * np.pi)
        np.testing.assert_allclose(found.pin_contact[row], along, atol=1e-3 * np.abs(along).max())
    assert found.roller_contact.shape == analysis.full.response.rollers.outer_load.shape
    assert found.hole_contact.shape == analysis.full.response.hole_load.shape


def test_many_positions_are_as_each_alone(analysis, monkeypatch):
    """Chunks join in order."""
    together = stresses_of(analysis)
    monkeypatch.setattr(wall_stress, "POSITIONS_PER_CHUNK", 2)
    chunked = stresses_of(analysis)
    for name in ("root", "bore", "hole", "roller_contact"):
        np.testing.assert_allclose(getattr(chunked, name), getattr(together, name), rtol=1e-12, err_msg=name)


def test_a_file_without_stresses_gives_loads_and_no_numbers(drive, tmp_path):
    path = tmp_path / "bare.nc"
    closed_form_coefficients(drive, half_width=0.05, depth=300.0).to_netcdf(path, engine="h5netcdf")
    bare = load_coefficients(path, drive)
    assert bare.stress is None
    answer = analyse(drive, ANGLES, None, PlaneStrain(coefficients=bare))
    assert answer.full.response.pin_load.max() > 0.0
    found = stresses_of(answer)
    assert np.all(np.isnan(found.root))
    assert found.root.shape == (len(ANGLES), drive.disc.number_of_teeth)
    assert np.all(np.isnan(found.bore))
    assert np.all(np.isnan(found.hole_contact))
    assert profiles_of(answer) == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda data: data.drop_vars("stress_station_parameter"), "lacks stress_station_parameter"),
        (lambda data: data.isel(station_loaded=slice(0, -1)), "dimensions"),
        (
            lambda data: data.assign(disc_stress=data["disc_stress"].where(data["disc_stress"] < 0.0)),
            "no finite numbers",
        ),
        (lambda data: data.assign(stress_station_parameter=data["stress_station_parameter"] + 0.01), "uniform"),
        (
            lambda data: data.isel(stress_station=data["stress_station_boundary"].values != 1),
            "boundaries of station_boundary",
        ),
    ],
    ids=["missing", "shape", "numbers", "places", "wall"],
)
def test_damaged_stresses_are_refused(drive, tmp_path, spoil, message):
    import xarray as xr

    data = xr.load_dataset(make_file(tmp_path / "sound.nc", drive), engine="h5netcdf")
    if "dimensions" in message:
        keep = data.isel(station_loaded=slice(0, -1))["disc_stress"].rename(station_loaded="fewer")
        data = data.drop_vars("disc_stress").assign(disc_stress=keep)
    else:
        data = spoil(data)
    data.to_netcdf(tmp_path / "damaged.nc", engine="h5netcdf")
    with error_says(CycloError, message):
        load_coefficients(tmp_path / "damaged.nc", drive)


def test_shear_below_a_line_contact_in_a_stressed_wall():
    """McEwen's stresses with a stress along the wall: the largest shear on the axis by a fine search."""
    depth = np.linspace(0.3, 2.0, 17001) * 0.2
    alone = line_contact_stress(0.0, depth, 0.2, 1000.0)
    for along in (0.0, 62.0, -30.0):
        shear = 0.5 * (alone.across + along - alone.depthwise)
        assert float(line_contact_shear(1000.0, along)) == pytest.approx(shear.max(), rel=1e-6)
        assert depth[np.argmax(shear)] == pytest.approx(LINE_SHEAR_DEPTH * 0.2, abs=1e-4)
    np.testing.assert_array_equal(line_contact_shear(np.zeros(2), np.array([50.0, -50.0])), 0.0)
