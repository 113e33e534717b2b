"""Influence coefficients: laws of elasticity, closed forms, and direct solutions on other meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from refusals import error_says

from fem.body.elasticity import area_loads, assemble_stiffness, rigid_modes
from fem.body.stress import recover_stress
from fem.body.wall_stress import stress_along_wall
from fem.coefficients.bodies import derive_disc, derive_pin, derive_race, derive_roller
from fem.coefficients.patch_loads import patch_loads
from fem.coefficients.stations import DiscStations, patch_half_width
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_disc
from fem.shapes import CircleShape, DriveShapes, RingShape
from ltca.contact.round_bodies import compressed_cylinder
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.parts import Material
from ltca.drive.single_discs import nominal_shape, single_discs
from ltca.reading.changes import with_fields
from ltca.reading.coefficient_laws import project_rigid_motions
from ltca.testing.field_changes import change_of, leaf_fields, sensible_change

STEEL = Material(youngs_modulus=206_000.0, poisson_ratio=0.3)
THICKNESS = 11.8
UNIT = 2.0 * (1.0 - 0.3**2) / (np.pi * 206_000.0 * THICKNESS)
SIZE = 1.0


def own_near_field(half_width):
    """Return the pressure-weighted mean approach of a half-plane, less a constant, in UNIT."""
    return 0.25 - np.log(0.5 * half_width)


@pytest.fixture(scope="module")
def disc_shape(paper_cases):
    return DriveShapes.of_drive(nominal_shape(paper_cases["CS-6"], keep_clearance=False)).disc


@pytest.fixture(scope="module")
def stations(disc_shape):
    return DiscStations.of_disc(disc_shape, 0.25)


@pytest.fixture(scope="module")
def disc(disc_shape, stations):
    return derive_disc(disc_shape, stations, STEEL, thickness=THICKNESS, size=SIZE)


@pytest.mark.slow
def test_reciprocity(disc):
    """Maxwell–Betti: the displacement solved for at i by j is that at j by i; round-off of a direct solver."""
    assert disc.reciprocity < 1e-11
    np.testing.assert_array_equal(disc.approach, disc.approach.T)


@pytest.mark.slow
def test_balanced_loads_do_positive_work(disc):
    eigenvalues = np.linalg.eigvalsh(project_rigid_motions(disc.approach, disc.resultants)) / UNIT
    # Three rigid motions, then nothing softer than a patch alone in its half-plane.
    np.testing.assert_allclose(eigenvalues[:3], 0.0, atol=1e-11)
    assert eigenvalues[3] > 1.0


@pytest.mark.slow
def test_rigid_motions_and_datums(disc):
    assert disc.rigid_residual < 1e-12


@pytest.mark.slow
def test_loads_act_at_their_stations(disc, stations):
    expected = stations.resultants()
    np.testing.assert_allclose(disc.resultants[:2], expected[:2], atol=1e-12)
    # The middle of a patch leaves its station by the change of curvature along it, of third order.
    np.testing.assert_allclose(disc.resultants[2], expected[2], atol=1e-5)


@pytest.mark.slow
def test_disc_is_mirror_symmetric(disc, stations):
    """θ → −θ maps flank, bore and holes onto themselves, but not the mesh: what differs is its error."""
    order = np.empty(stations.count, dtype=int)
    places = stations.points
    for index, point in enumerate(places):
        order[index] = np.argmin(np.abs(places - point.conjugate()))
    assert np.max(np.abs(places[order] - places.conjugate())) < 1e-9
    mirrored = disc.approach[np.ix_(order, order)]
    # As large as the error of the mesh itself at most.
    assert np.max(np.abs(mirrored - disc.approach)) < 1.5e-3 * np.max(disc.approach)


@pytest.mark.slow
def test_wall_stress_is_mirror_symmetric(disc, stations, disc_shape):
    rows, columns = (
        np.argmin(np.abs(places[:, None] - places.conjugate()), axis=0)
        for places in (stations.refined(disc_shape).points, stations.points)
    )
    mirrored = disc.stress[np.ix_(rows, columns)]
    apart = np.max(np.abs(mirrored - disc.stress), axis=1) / np.max(np.abs(disc.stress))
    # The meshes of both sides differ, and so leave 0.1 % of the largest stress (measured). Places between the stations of
    # the loads are not refined for: 0.7 % there with elements of one and a half times the size (its bound set after that).
    measured, loaded = stations.refined(disc_shape).points, stations.points
    on_station = np.min(np.abs(measured[:, None] - loaded), axis=1) < 1e-9
    assert np.max(apart[on_station]) < 3e-3
    assert np.max(apart) < 1.5e-2


def balanced_forces(resultants, loaded, seed):
    """Return forces on the loaded stations that balance, of order 1 kN."""
    rng = np.random.default_rng(seed)
    forces = np.zeros(resultants.shape[1])
    forces[loaded] = rng.uniform(0.2, 1.0, len(loaded))
    own = resultants[:, loaded]
    forces[loaded] -= own.T @ np.linalg.solve(own @ own.T, own @ forces[loaded])
    return 1e3 * forces


LOADED = np.array([3, 40, 77, 104, 110, 121, 130, 145, 160])


@pytest.fixture(scope="module")
def direct(disc_shape, stations):
    """Another mesh, fine at some stations only: body, their patches, and a solver with three unknowns held."""
    width = stations.half_width[0]
    spots = [Refinement(point.real, point.imag, 0.25 * width, 2.0 * width) for point in stations.points[LOADED]]
    body = mesh_disc(disc_shape, spots, coarse_size=0.9, growth=0.25)
    patches = [
        patch_loads(body, disc_shape.curves[stations.boundary[index]], stations.parameter[[index]], width)
        for index in LOADED
    ]
    stiffness = assemble_stiffness(body, STEEL, thickness=THICKNESS)
    bore = body.boundary_nodes("bore")
    held = np.array([2 * bore[0, 0], 2 * bore[0, 0] + 1, 2 * bore[len(bore) // 2, 0] + 1])
    free = np.setdiff1d(np.arange(body.unknowns), held)
    options = {"SymmetricMode": True}
    factor = spla.splu(stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options=options)

    def solve(force):
        solution = np.zeros_like(force)
        solution[free] = factor.solve(force[free])
        return solution

    return body, sp.hstack(patches).toarray(), solve


@pytest.mark.slow
def test_superposition_against_a_direct_solution(direct, stations, disc):
    """Several patches at once on another mesh, the bore fitted node by node."""
    body, patches, solve = direct
    forces = balanced_forces(stations.resultants(), LOADED, seed=4)
    solution = solve(patches @ forces[LOADED])
    bore = body.boundary_nodes("bore")
    x, y = body.mesh.doflocs
    length = np.hypot(x[bore[:, 2]] - x[bore[:, 0]], y[bore[:, 2]] - y[bore[:, 0]])
    weight = np.zeros(body.unknowns)
    for local, share in enumerate((1.0, 4.0, 1.0)):
        for component in range(2):
            np.add.at(weight, 2 * bore[:, local] + component, share * length / 6.0)
    modes, root = rigid_modes(body), np.sqrt(weight)
    motion = np.linalg.lstsq(modes * root[:, None], solution * root, rcond=None)[0]
    measured = patches.T @ (solution - modes @ motion)
    found = (disc.approach @ forces)[LOADED]
    # The coarse derivation is 0.15 % off its largest entry; Simpson's rule on the bore's edges adds little.
    np.testing.assert_allclose(found, measured, atol=3e-3 * np.max(np.abs(measured)))


@pytest.mark.slow
def test_wall_stress_against_recovered_stress(direct, disc_shape, stations, disc):
    """The same loads on another mesh, stress recovered at its nodes: at stations clear of them."""
    body, patches, solve = direct
    forces = balanced_forces(stations.resultants(), LOADED, seed=4)
    stress = recover_stress(body, solve(patches @ forces[LOADED]), STEEL)
    walls = [stress_along_wall(body, stress, curve) for curve in disc_shape.curves]
    found, measured = disc.stress @ forces, stations.refined(disc_shape)
    expected = np.array(
        [
            walls[boundary].at(np.array([parameter]))[0]
            for boundary, parameter in zip(measured.boundary.tolist(), measured.parameter.tolist(), strict=True)
        ]
    )
    clear = np.min(np.abs(measured.points[:, None] - stations.points[LOADED]), axis=1) > 4.0 * stations.half_width[0]
    assert np.count_nonzero(clear) > 0.9 * measured.count
    # Nodal stresses beside a load, of both meshes, at four half-widths from it: 2 % of the largest stress (measured).
    assert np.max(np.abs(found - expected)[clear]) < 3e-2 * np.max(np.abs(expected[clear]))
    assert np.sqrt(np.mean((found - expected)[clear] ** 2)) < 6e-3 * np.max(np.abs(expected[clear]))


@pytest.mark.slow
def test_body_forces_balance_as_well(direct, disc):
    """Unit loads balanced by body forces, as if in free fall: balanced sets of loads feel no difference."""
    body, patches, solve = direct
    modes, area = rigid_modes(body), area_loads(body)
    fallen = patches - area @ np.linalg.solve(modes.T @ area, modes.T @ patches)
    here = project_rigid_motions(patches.T @ solve(fallen), modes.T @ patches)
    there = project_rigid_motions(disc.approach[np.ix_(LOADED, LOADED)], disc.resultants[:, LOADED])
    np.testing.assert_allclose(there, here, atol=3e-3 * np.max(np.abs(here)))


@pytest.mark.nightly
@pytest.mark.slow
def test_smooth_part_does_not_depend_on_the_patch(disc_shape, stations, disc):
    """Half the width: the half-plane's own approach grows by ln 2, the rest stays."""
    narrow = replace(stations, half_width=0.5 * stations.half_width)
    found = derive_disc(disc_shape, narrow, STEEL, thickness=THICKNESS, size=SIZE)
    smooth = np.diag(disc.approach) / UNIT - own_near_field(stations.half_width)
    other = np.diag(found.approach) / UNIT - own_near_field(narrow.half_width)
    # Against entries of 14: curvature and walls 0.003 (measured on fine meshes), the error of the coarse ones the rest.
    np.testing.assert_allclose(other, smooth, atol=0.03)
    apart = np.abs(stations.points[:, None] - stations.points) > 12.0 * stations.half_width.max()
    np.testing.assert_allclose(found.approach[apart] / UNIT, disc.approach[apart] / UNIT, atol=0.01)


@pytest.mark.nightly
@pytest.mark.slow
def test_plane_stress_is_softer(disc_shape, stations, disc):
    """By up to 1/(1 − ν²) = 1.099, which a body without holes would show in full."""
    stress = derive_disc(disc_shape, stations, STEEL, thickness=THICKNESS, state="stress", size=SIZE)
    ratio = np.diag(project_rigid_motions(stress.approach, disc.resultants)) / np.diag(
        project_rigid_motions(disc.approach, disc.resultants)
    )
    assert np.all((ratio > 1.08) & (ratio < 1.0 / 0.91 + 1e-3))


@pytest.mark.slow
@pytest.mark.parametrize("state", ["strain", "stress"])
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.45])
def test_roller_is_johnsons_compressed_cylinder(poisson_ratio, state):
    radius = 5.0
    material = Material(youngs_modulus=70_000.0, poisson_ratio=poisson_ratio)
    roller = derive_roller(CircleShape(name="roller", radius=radius), material, thickness=3.0, state=state)
    flat = 1.0 if state == "stress" else 1.0 - poisson_ratio**2
    unit = 2.0 * flat / (np.pi * 70_000.0 * 3.0)
    # 0.05 % of the mesh at this size, 0.3 (b/R)² = 0.0008 of 3.6 for the patch on a circle.
    assert roller.approach.sum(axis=1) / unit == pytest.approx(compressed_cylinder(radius, roller.half_width), rel=1e-3)


def test_race_under_uniform_pressure_is_lames_ring():
    """The mean over all angles is the answer to an even pressure on the ring, its bore held."""
    shape = RingShape(inner_radius=10.0, outer_radius=19.5)
    race = derive_race(shape, STEEL, thickness=THICKNESS, angles=1024)
    lam, mu = 206_000.0 * 0.3 / (1.3 * 0.4), 206_000.0 / 2.6
    pressure = 1.0 / (2.0 * np.pi * 19.5 * THICKNESS)
    stretch = pressure / (2.0 * (lam + mu) + 2.0 * mu * (10.0 / 19.5) ** 2)
    expected = stretch * (19.5 - 10.0**2 / 19.5)
    # The patch presses along one direction: its radial part is short by (b/R)²/8, 1e-4; the mesh adds the rest.
    assert np.mean(race.approach) == pytest.approx(expected, rel=1e-3)


def test_race_is_the_same_on_both_sides():
    race = derive_race(RingShape(inner_radius=10.0, outer_radius=19.5), STEEL, thickness=THICKNESS)
    # Before the mean of both sides is taken they differ by the error of the mesh alone.
    assert race.mirror < 1e-3
    np.testing.assert_array_equal(race.approach[1:], race.approach[:0:-1])
    spectrum = np.fft.rfft(race.approach).real
    assert np.all(spectrum > 0.0)


@pytest.mark.parametrize("scale", [0.1, 7.0])
def test_plane_elasticity_has_no_length(scale):
    """Similar bodies of one thickness have equal coefficients; E and thickness divide them."""
    first = derive_pin(CircleShape(name="pin", radius=6.5, core_radius=2.0), STEEL, thickness=1.0)
    soft = Material(youngs_modulus=103_000.0, poisson_ratio=0.3)
    similar = CircleShape(name="pin", radius=6.5 * scale, core_radius=2.0 * scale)
    second = derive_pin(similar, soft, thickness=4.0)
    # Meshes of similar bodies are similar to round-off of their coordinates, which may flip a diagonal.
    assert second.approach[0, 0] == pytest.approx(0.5 * first.approach[0, 0], rel=1e-4)
    assert second.half_width == pytest.approx(scale * first.half_width)


def test_pin_meets_its_near_field():
    shape = CircleShape(name="pin", radius=6.5, core_radius=2.0)
    pin = derive_pin(shape, STEEL, thickness=THICKNESS)
    drop = (pin.approach[0, 0] - pin.wide_approach) / UNIT
    # b doubles to a tenth of the wall: its square, 1 % of ln 2, remains.
    assert drop == pytest.approx(np.log(2.0), rel=0.01)


def test_halving_divides_the_error():
    """Quadratic elements: the error falls by more than four, so twice the size tells more than half of it."""
    shape = CircleShape(name="roller", radius=5.0)
    values = [derive_roller(shape, STEEL, thickness=1.0, size=size).approach[0, 0] for size in (4.0, 2.0, 1.0)]
    assert abs(values[0] - values[1]) > 4.0 * abs(values[1] - values[2])


@pytest.mark.nightly
@pytest.mark.slow
def test_mesh_halved(disc_shape, stations, disc):
    """The issue's bound: 0.3 % of the largest entry once rigid motions are projected out; measured 0.05 % at the default.

    Held already from one and a half times the default size, whose error is the larger: see `test_halving_divides_the_error`.
    """
    fine = derive_disc(disc_shape, stations, STEEL, thickness=THICKNESS, size=0.5 * SIZE)
    reference = project_rigid_motions(fine.approach, fine.resultants)
    change = np.max(np.abs(project_rigid_motions(disc.approach, disc.resultants) - reference))
    print(f"mesh halved: {change / np.max(reference):.2e} of the largest entry")
    assert change < 3e-3 * np.max(reference)


@pytest.mark.nightly
@pytest.mark.slow
def test_clearance_changes_little(paper_cases, disc_shape, stations, disc):
    """0.03 mm in the holes thin the ligaments by 0.4 %; CS-6 has the largest clearances of the paper."""
    drive = nominal_shape(paper_cases["CS-6"])
    shape = DriveShapes.of_drive(drive).disc
    assert shape.holes[0].radius == pytest.approx(disc_shape.holes[0].radius + 0.03)
    wide = derive_disc(shape, DiscStations.of_disc(shape, 0.25), STEEL, thickness=THICKNESS, size=SIZE)
    reference = project_rigid_motions(disc.approach, disc.resultants)
    change = project_rigid_motions(wide.approach, wide.resultants) - reference
    # Measured 0.54 % on the fine mesh.
    assert 1e-3 * np.max(reference) < np.max(np.abs(change)) < 7e-3 * np.max(reference)


def test_cases_share_their_nominal_shape(paper_cases):
    shapes = {nominal_shape(drive, keep_clearance=False).shape_fingerprint() for drive in paper_cases.values()}
    assert len(shapes) == 1
    assert nominal_shape(paper_cases["CS-6"], keep_clearance=False).bore_radius == 29.5
    assert nominal_shape(paper_cases["CS-6"]).bore_radius == pytest.approx(29.515)


RATINGS = ("crank_bearing.dynamic_load_rating", "crank_bearing.static_load_rating")
LEFT_OUT = (
    "pin_wheel.support_stiffness",
    "pin_wheel.core_radius",
    "crank_bearing.race_bore_radius",
    "installation.first_stage_ratio",
    "crank.circle_radius",
    "load.speed",
    "disc.axial_play",
    *RATINGS,
)
TABLES_LEFT_OUT = (
    "ring",
    "ring.material",
    "ring.bolts",
    "carrier",
    "carrier.posts",
    "first_stage",
    *(f"load.external.0{part}" for part in ("", ".force", ".moment", ".at")),
    "main_bearing",
    "crank.support",
    "pin_wheel.seat",
    "pin_wheel.beam",
    "pin_shaft.seat",
    "pin_shaft.beam",
    "duty.0",
    "lubricant",
    "inertia",
    "damping",
    "temperature",
)
OF_MATERIALS = (
    "allowable_pressure", "yield_strength", "bending_fatigue_limit", "hardness", "hardness_depth", "density",
    "thermal_expansion",
)  # fmt: skip


def bodies(drive):
    """All that a derivation takes of a drive."""
    nominal = nominal_shape(drive)
    shapes, parts = DriveShapes.of_drive(nominal), nominal.materials
    round_bodies = (shapes.wheel_pins[0], shapes.rollers[0], shapes.inner_race)
    made_of = (parts.disc, parts.wheel_pin, parts.roller, parts.inner_race)
    materials = tuple((part.youngs_modulus, part.poisson_ratio) for part in made_of)
    return repr((shapes.disc, round_bodies, materials, nominal.disc.thickness))


def changed_pair(drive, path):
    """The drive and the same with one field changed, both as warm as they run."""
    # one tooth more, as many as pins, makes no flank
    change = {path: 12}
    table, _, name = path.rpartition(".")
    if path in LEFT_OUT or table.startswith(TABLES_LEFT_OUT) or name in OF_MATERIALS:
        drive, change = change_of(drive, path)
    elif path != "disc.number_of_teeth":
        change = {path: sensible_change(drive, path)}
    drive, other = (warm_drive(one) for one in (drive, with_fields(drive, change, check=False)))
    return drive, single_discs(other)[0]


def test_fingerprint_follows_the_bodies(paper_cases):
    """A field that changes a body changes the fingerprint of the shape, and no other does."""
    wrong, of_bodies = [], 0
    for path in leaf_fields():
        if path == "disc.number_of_discs":
            continue  # a shape is that of one disc
        drive, other = changed_pair(paper_cases["CS-6"], path)
        another = bodies(other) != bodies(drive)
        of_bodies += another
        if another != (other.shape_fingerprint() != drive.shape_fingerprint()):
            wrong.append(path)
    assert wrong == []
    assert 20 < of_bodies < len(leaf_fields()) - 100  # both kinds of field are walked


def test_random_drives_have_stations(random_drives):
    for drive in random_drives:
        shape = DriveShapes.of_drive(nominal_shape(drive)).disc
        for scale in (0.25, 1.0, 4.0):
            stations = DiscStations.of_disc(shape, scale)
            for index in range(len(shape.curves)):
                own = stations.points[stations.boundary == index]
                assert np.min(np.abs(np.diff(np.append(own, own[0])))) > 2.4 * stations.half_width.max()
        assert np.all(stations.half_width <= patch_half_width(shape))


@pytest.mark.parametrize("scale", [0.0, 0.2, -1.0, 9.0, float("nan")])
def test_unfit_numbers_of_stations_are_refused(disc_shape, scale):
    with pytest.raises(MeshError, match="stations"):
        DiscStations.of_disc(disc_shape, scale)


@pytest.mark.parametrize("size", [0.0, -1.0, 5.0, float("nan")])
def test_unfit_sizes_are_refused(disc_shape, stations, size):
    with error_says(MeshError, "size = ", " (--size): must be"):
        derive_disc(disc_shape, stations, STEEL, thickness=1.0, size=size)
    with error_says(MeshError, "size = ", " (--size): must be"):
        derive_pin(CircleShape(name="pin", radius=5.0, core_radius=1.0), STEEL, thickness=1.0, size=size)
