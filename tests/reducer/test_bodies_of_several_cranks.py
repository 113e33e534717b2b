"""Discs with several bores in `fe` and `hybrid`: laws that need no finite elements, and bodies derived from them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says, refused_field

from fem.coefficients.dataset import derive_coefficients
from ltca.analysis.engines import HalfSpace, Hybrid, PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficients import BodyPlaces, load_coefficients
from ltca.compliance.response import bearing_pushes
from ltca.compliance.stress_coefficients import StressCoefficients, evaluate_wall_stress
from ltca.compliance.wall_stress import wall_profiles
from ltca.drive.parts import CrankSupport
from ltca.drive.single_discs import single_discs
from ltca.equilibrium.balance import lever_arms
from ltca.equilibrium.output_torque import solve_at_output
from ltca.errors import CycloError
from ltca.geometry.boundary_stations import Boundary
from ltca.geometry.coordinates import DISC_ROTATION, X, Y
from ltca.geometry.flank import FlankProfile
from ltca.geometry.placement import Placement
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients, without_coupling

pytestmark = pytest.mark.slow

ANGLES = np.array([0.31, 1.7, 4.4])
LOAD = 1e-4
"""Loads of equal drives solved from different sides, N: the balance closes to 1e-9 of 10 kN, and stiffness adds a digit."""
SMALL = {
    "pin_wheel.number_of_pins": 14,
    "disc.number_of_teeth": 13,
    "pin_wheel.pin_circle_radius": 40.0,
    "pin_wheel.pin_radius": 4.0,
    "crank.eccentricity": 1.5,
    "crank.circle_radius": 18.0,
    "crank.angle": 0.2,
    "crank.support.diameter": 8.0,
    "crank_bearing.inner_race_radius": 4.5,
    "crank_bearing.outer_race_radius": 7.0,
    "crank_bearing.roller_radius": 1.25,
    "crank_bearing.roller_length": 8.0,
    "crank_bearing.number_of_rollers": 10,
    "disc.thickness": 8.0,
    "disc.phases": (0.0, 2.0 * np.pi / 3.0),
    "load.torque": 60e3,
    "load.light_torque": 2e3,
}
"""The shipped reducer made small: its second disc is the part of the first, turned by crank pitches."""
HOLES = {
    "pin_shaft.number_of_pins": 3,
    "pin_shaft.pin_circle_radius": 16.0,
    "pin_shaft.pin_radius": 3.0,
    "pin_shaft.hole_radius": 4.5,
    "pin_shaft.stiffness": 1e5,
    "crank.angle": np.pi / 3.0,
}


@pytest.fixture(scope="module")
def small():
    return with_fields(parse_drive(shipped_drive("rv"), "rv").cases["nominal"], SMALL)


def kind(small, name):
    """The small reducer with what yields, or with holes."""
    rigid = replace(small, crank=replace(small.crank, support=None))
    if name == "cranks":
        support = CrankSupport(diameter=8.0, positions=(-15.0, 15.0), stiffness=(2e5, 3e5))
        return replace(rigid, crank=replace(rigid.crank, support=support))
    if name == "wheel":
        return replace(rigid, pin_wheel=replace(small.pin_wheel, support_stiffness=5e5))
    return with_fields(rigid, HOLES) if name == "holes" else rigid


KINDS = ["cranks", "holes"]
ENGINES = {"fe": PlaneStrain, "hybrid": Hybrid}


@pytest.fixture(scope="module")
def closed_forms(tmp_path_factory):
    """Return a function that gives the coefficients of each disc in closed form, read from files like those of a run."""
    folder = tmp_path_factory.mktemp("closed_forms")

    def load(drive):
        found = []
        for single in single_discs(drive):
            path = folder / f"{single.shape_fingerprint()}.nc"
            if not path.exists():
                data = closed_form_coefficients(single, half_width=0.05, depth=300.0)
                data.to_netcdf(path, engine="h5netcdf")
            found.append(load_coefficients(path, single))
        return tuple(found)

    return load


@pytest.fixture(scope="module")
def derived(small, tmp_path_factory):
    """Bodies by finite elements, a quarter of the stations on elements of twice the size: one file for both discs."""
    path = tmp_path_factory.mktemp("derived") / "coarse.nc"
    first, second = single_discs(small)
    derive_coefficients(first, stations=0.25, size=2.0).to_netcdf(path, engine="h5netcdf")
    return load_coefficients(path, first), load_coefficients(path, second)


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_without_coupling_it_is_the_half_space(small, name):
    drive = kind(small, name)
    nothing = tuple(without_coupling(single) for single in single_discs(drive))
    found = analyse(drive, ANGLES, engine=Hybrid(coefficients=nothing, hole_near_field=False)).full.response
    expected = analyse(drive, ANGLES, engine=HalfSpace()).full.response
    # Near-field approaches settle to 1e-13 mm, 1e-7 N.
    np.testing.assert_allclose(found.pin_load, expected.pin_load, atol=LOAD)
    np.testing.assert_allclose(found.rollers.outer_load, expected.rollers.outer_load, atol=LOAD)
    np.testing.assert_allclose(found.hole_load, expected.hole_load, atol=LOAD)


def test_contacts_feel_those_in_their_own_bore_and_on_their_own_race(small, closed_forms):
    """Half-planes by hand: −κ ln(distance) between rollers of one crank, nothing between those of different ones."""
    single = single_discs(small)[0]
    coefficients = closed_forms(small)[0]
    rng, place = np.random.default_rng(7), Placement.of_drive(single)
    bore, theta = rng.uniform(0.0, 6.28, (2, 30)), rng.uniform(0.0, 6.28, (2, 14))
    on_flank = FlankProfile.of_drive(single).flank(theta)
    places = BodyPlaces.on_walls(theta, on_flank, bore, float(place.bore_radius), np.zeros((2, 0)), 3)
    few = np.array([[3, 14, 26, 43], [5, 18, 23, 35]])
    matrix, chosen = coefficients.disc_matrix(places), coefficients.disc_matrix(places.take(few))
    crank = np.repeat(np.arange(3), 10)
    points = place.bore_radius * np.exp(1j * bore)
    apart = np.abs(points[:, :, None] - points[:, None, :])
    same = (crank[:, None] == crank) & ~np.eye(30, dtype=bool)
    unit = 2.0 * (1.0 - 0.3**2) / (np.pi * 206e3 * 8.0)
    between = matrix[:, 14:, 14:] / unit + np.log(np.where(same, apart, 1.0))
    # What is left of a half-plane is one number everywhere: the depth of its datum.
    own = np.ptp(between[:, same])
    assert own < 1e-9
    np.testing.assert_allclose(matrix[:, 14:, 14:][:, crank[:, None] != crank], 0.0, atol=1e-12 * unit)
    np.testing.assert_allclose(matrix[:, 14:, :14], 0.0, atol=1e-12 * unit)
    for row, some in enumerate(few):
        np.testing.assert_allclose(chosen[row], matrix[row][some[:, None], some], rtol=0.0, atol=1e-12 * unit)
    load = rng.uniform(0.0, 1e3, (2, 44))
    together = np.matmul(matrix, load[..., None])[..., 0]
    np.testing.assert_allclose(coefficients.disc_approach(places, load), together, rtol=0.0, atol=1e-9 * unit)
    race = coefficients.race_matrix(place.roller_cage_angles, 4.5)
    assert np.all(race[crank[:, None] != crank] == 0.0)
    blocks = [race[10 * c : 10 * c + 10, 10 * c : 10 * c + 10] for c in range(3)]
    assert np.all(blocks[0] != 0.0)
    assert all(np.array_equal(block, blocks[0]) for block in blocks)


@pytest.mark.parametrize("phase", [2.0 * np.pi / 3.0, 1.3])
@pytest.mark.parametrize("holes", [0, 3, 6])
def test_coefficients_of_the_part_are_found_where_it_stands(small, phase, holes):
    """A field over the part, f(x) f(y) of the places of its walls, is met at the same metal in the disc that it is in."""
    changes = {"disc.number_of_discs": 1, "disc.phases": (phase,), "disc.planes": (0.0,)}
    drive = with_fields(kind(small, "rigid"), changes)
    if holes:
        drive = with_fields(drive, HOLES | {"pin_shaft.number_of_pins": holes}, check=False)
    part = with_fields(drive, {"disc.phases": (-drive.part_turn[0] * 13.0,)}, check=False)
    # −1/39 of a turn and s thirds are whole teeth of a thirteenth: s = 2
    assert drive.part_turn[1] == {2.0 * np.pi / 3.0: 2}.get(phase, drive.part_turn[1])
    place, flank = Placement.of_drive(part), FlankProfile.of_drive(part)

    def field(points):
        return 1.0 + 0.01 * points.real - 0.02 * points.imag + 1e-4 * points.real * points.imag

    counts = (1000, *[100] * 3, *[60] * holes)
    firsts = np.cumsum((0, *counts[:-1]))
    boundaries = [Boundary(first=int(f), count=c) for f, c in zip(firsts, counts, strict=True)]
    centres = np.concatenate((place.bore_centres, place.hole_centres))
    radii = np.concatenate((np.full(3, place.bore_radius), place.hole_radii))
    walls = [flank.flank(boundaries[0].parameters())]
    walls += [
        centre + radius * np.exp(1j * own.parameters())
        for centre, radius, own in zip(centres, radii, boundaries[1:], strict=True)
    ]
    value = field(np.concatenate(walls))
    both, stations = np.outer(value, value), tuple(boundaries)
    found = replace(
        without_coupling(part), flank=stations[0], bores=stations[1:4], holes=stations[4:], disc=both,
        stress=StressCoefficients(walls=stations, loaded=stations, stress=both),
    ).placed_in(drive)  # fmt: skip
    rng, disc = np.random.default_rng(3), Placement.of_drive(drive)
    theta, bore, hole = (rng.uniform(0.0, 6.28, (1, count)) for count in (14, 30, holes))
    turned = FlankProfile.of_drive(drive).flank(theta)
    points = np.concatenate(
        [
            turned,
            np.repeat(disc.bore_centres, 10) + disc.bore_radius * np.exp(1j * bore),
            disc.hole_centres + disc.hole_radii * np.exp(1j * hole),
        ],
        axis=1,
    )
    matrix = found.disc_matrix(BodyPlaces.on_walls(theta, turned, bore, float(disc.bore_radius), hole, 3))[0]

    def at_metal(places):
        return field(places * np.exp(-2j * np.pi * drive.part_turn[1] / drive.pattern))

    metal = at_metal(points[0])
    # interpolation between stations: to round-off on circles, 1e-6 on the lobes
    np.testing.assert_allclose(matrix, np.outer(metal, metal), rtol=1e-5)
    # stresses likewise, by a newton on every contact
    walls = [theta, *np.split(bore, 3, axis=1), *np.split(hole, max(1, holes), axis=1)][: len(stations)]
    stress = evaluate_wall_stress(found.stress, [(own, np.ones_like(own)) for own in walls])
    for centre, radius, wall in zip(
        np.concatenate((disc.bore_centres, disc.hole_centres)), radii, found.stress.walls[1:], strict=True
    ):
        expected = at_metal(centre + radius * np.exp(1j * wall.parameters())) * metal.sum()
        np.testing.assert_allclose(stress[0, wall.first : wall.first + wall.count], expected, rtol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_tangent_is_the_slope_of_the_force(small, closed_forms, name):
    """By differences, with the supports."""
    drive = kind(small, name)
    check_tangent(drive, PlaneStrain(coefficients=closed_forms(drive)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "engine"), [("cranks", "hybrid"), pytest.param("wheel", "fe", marks=pytest.mark.slow)]
)
def test_tangent_of_bodies_by_finite_elements(small, derived, name, engine):
    check_tangent(kind(small, name), ENGINES[engine](coefficients=derived))


def check_tangent(drive, engine):
    model = engine.prepare(drive).model
    balanced = solve_at_output(model, [drive], ANGLES[:1], drive.load.torque)
    lever, step = lever_arms(model), 1e-6
    scaled = balanced.response.tangent[0] / np.outer(lever, lever)
    np.testing.assert_allclose(scaled, scaled.T, rtol=0.0, atol=1e-9 * np.abs(scaled).max())
    for column in range(lever.size):
        moved = [balanced.pose + side * step * (np.arange(lever.size) == column) / lever[column] for side in (1, -1)]
        up, down = (model.respond(ANGLES[:1], each).force[0] / lever for each in moved)
        # The change of the coefficients and of ρ with the place is left out of the tangent: some 1e-4 of it.
        np.testing.assert_allclose(
            (up - down) / (2.0 * step), scaled[:, column], rtol=0.0, atol=2e-3 * np.abs(scaled).max()
        )


def test_every_disc_is_in_equilibrium_by_hand(small, derived):
    """Forces at the places where pins and rollers touch: no resultant and no moment on any disc, the torque on the wheel."""
    found = analyse(kind(small, "rigid"), ANGLES, engine=PlaneStrain(coefficients=derived))
    wheel = np.zeros(ANGLES.size)
    for number, part in enumerate(found.full.response.parts):
        geometry = found.model.discs[number].geometry
        place, columns = geometry.placement, found.model.coordinates.columns(number)
        rotation = np.exp(1j * found.full.pose[:, columns[DISC_ROTATION], None])
        centre = place.races(ANGLES).middle + found.full.pose[:, columns[X]] + 1j * found.full.pose[:, columns[Y]]
        theta = part.flank.parameter
        push = -part.pin_load * geometry.profile.normal(theta) * rotation
        points = geometry.profile.flank(theta) * rotation
        bearings = bearing_pushes(part.rollers, 3)
        force = push.sum(axis=1) + bearings.sum(axis=1)
        arms = place.bore_centres * rotation
        moment = (points.conjugate() * push).imag.sum(axis=1) + (arms.conjugate() * bearings).imag.sum(axis=1)
        size = np.abs(bearings).max()
        np.testing.assert_allclose(np.abs(force), 0.0, atol=1e-6 * size)
        np.testing.assert_allclose(moment, 0.0, atol=1e-6 * size * 18.0)
        assert np.count_nonzero(np.abs(bearings).max(axis=0) > 0.05 * size) == 3
        wheel -= ((centre[:, None] + points).conjugate() * push).imag.sum(axis=1)
    np.testing.assert_allclose(wheel, -found.full.wheel_moment, rtol=1e-6)


@pytest.mark.slow
def test_numbering_of_the_cranks_is_a_matter_of_names(small, closed_forms):
    """The first crank a pitch further on: the same drive with other numbers, bores and rollers with theirs."""
    drive = with_fields(kind(small, "cranks"), {"crank.of.1.eccentricity_error": 0.002, "crank.of.5.phase_error": 1e-3})
    turned = with_fields(drive, {"crank.angle": drive.crank.angle + 2.0 * np.pi / 3.0})
    of = tuple(replace(entry, crank=(entry.crank - 1) % 3) for entry in drive.crank.of)
    turned = replace(turned, crank=replace(turned.crank, of=of))
    first, second = (
        analyse(each, ANGLES[:1], engine=PlaneStrain(coefficients=closed_forms(each))) for each in (drive, turned)
    )
    np.testing.assert_allclose(first.full.response.pin_load, second.full.response.pin_load, rtol=0.0, atol=LOAD)
    np.testing.assert_allclose(
        np.roll(first.bearing_tangential, -1, axis=2), second.bearing_tangential, rtol=0.0, atol=LOAD
    )
    assert np.ptp(first.bearing_tangential, axis=2).min() > 1e3 * LOAD


def test_stress_of_the_bores_is_the_largest_of_all(small, derived):
    """Along each bore clear of its rollers, in both discs: the one of which the part's bores are counted from another."""
    found = analyse(kind(small, "rigid"), ANGLES, engine=Hybrid(coefficients=derived))
    for number, (walls, part) in enumerate(zip(found.wall_stresses, found.full.response.parts, strict=True)):
        disc, columns = found.model.discs[number], found.model.coordinates.columns(number)
        own = disc.pressures(part)
        profiles = wall_profiles(disc, part, own, found.full.pose[:, columns[DISC_ROTATION]], refinement=4)
        assert len(profiles) == 4
        largest = np.array([[bore.stress[row, bore.clear[row]].max() for bore in profiles[1:]] for row in range(3)])
        np.testing.assert_array_equal(walls.bore, largest.max(axis=1))
        assert np.ptp(largest, axis=1).min() > 0.0
        # A wall is not clear within four half-widths of the loaded rollers in it, and of no others.
        touched = np.angle(part.rollers.outer_direction) - found.full.pose[:, columns[DISC_ROTATION], None]
        for crank, bore in enumerate(profiles[1:]):
            rollers = slice(10 * crank, 10 * crank + 10)
            chord = 2.0 * 7.004 * np.abs(np.sin(0.5 * (bore.parameter - touched[:, rollers, None])))
            reach = np.where(part.rollers.outer_load > 0.0, 4.0 * own.outer.half_width, -1.0)[:, rollers, None]
            np.testing.assert_array_equal(bore.clear, np.all(chord > reach, axis=1))
            assert np.any(~bore.clear)
        assert walls.hole.shape == walls.hole_contact.shape == (3, 0)
        assert walls.roller_contact.shape == (3, 30)


def test_a_file_of_several_cranks_is_refused_by_a_drive_of_one(small, tmp_path):
    """Numbers that the drive does not have were no difference: the clearances, which agree, were blamed."""
    several = single_discs(kind(small, "holes"))[0]
    alone = replace(several.crank, number=1, circle_radius=None, angle=0.0)
    closed_form_coefficients(several, half_width=0.05, depth=300.0).to_netcdf(tmp_path / "c.nc", engine="h5netcdf")
    with error_says(CycloError, "differs from rv in crank.number 3 (here none), crank.circle_radius 18"):
        load_coefficients(tmp_path / "c.nc", replace(several, crank=alone))


def test_coefficients_of_other_numbers_of_bores_are_refused(small):
    lent = without_coupling(single_discs(small)[0])
    with refused_field("crank.number", "= 2", "that of the drive whose influence coefficients", bound=("equal to", 3)):
        lent.lent_to(with_fields(single_discs(small)[0], {"crank.number": 2}, check=False))
