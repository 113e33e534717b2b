"""Discs of solid bodies: plane bodies at ν = 0, balance in space, mirror in z, energies, what they refuse."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refused_field

from fem.drive.condensed import condense_drive
from fem.drive.expected_contacts import guess_contacts
from fem.drive.full_solution import FullSolution
from fem.drive.meshes import mesh_drive
from fem.drive.pose import WheelLoad, joint_problem, pair_forces, solve_pose, solve_poses
from fem.drive.supports import Supports
from fem.errors import MemoryLimitError, MeshError
from fem.options import SolutionOptions
from fem.reducer.solution import solve_reducer
from fem.shapes import DriveShapes
from fem.solid_contact.reliefs import relief_of
from fem.solid_drive.along_width import DriveWidths
from fem.solid_drive.solid_bodies import condense_solids
from fem.solid_drive.width_results import along_width, bore_lean, disc_lean, pressures_over, roller_leans
from ltca.drive.parts import Material
from ltca.drive.single_discs import single_discs
from ltca.geometry.placement import Placement
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLE, LEAN = 0.3, {"contact.slices": 5, "pin_shaft.inclination.x": 3e-3, "pin_wheel.inclination.y": -1e-3}
TWO = {"disc.number_of_discs": 2, "disc.gap": 2.0}
OFFSET = {"pin_wheel.support_stiffness": 2e4, "pin_wheel.axis_offset.x": 0.02, "pin_wheel.axis_offset.y": -0.01}
OPTIONS = SolutionOptions(size=6.0, layers=2)
SECTIONS = SolutionOptions(size=6.0, growth=0.6)


def plastic():
    return load_drive("examples/drives/plastic.toml").cases["aligned"]


def condense(drive, layers=2):
    """Meshes for the guess of rigid bodies on springs: coarse, but the same for whatever is compared."""
    shapes, contacts = DriveShapes.of_drive(drive), guess_contacts(drive, ANGLE)
    meshes = mesh_drive(shapes, contacts, SECTIONS)
    model = condense_solids(drive, shapes, contacts, meshes, DriveWidths(drive=drive, layers=layers))
    return SimpleNamespace(drive=drive, shapes=shapes, contacts=contacts, meshes=meshes, model=model)


def standing(model, drive):
    """The same condensed bodies as they stand in another drive of their shape."""
    return replace(model, drive=drive, placement=Placement.of_drive(drive), widths=DriveWidths(drive=drive, layers=2))


def solve(model, drive, factor=1.0):
    return solve_pose(model, factor * drive.wheel_moment(), pose_tolerance=1e-9)


def solution(model, state):
    return FullSolution(model=model, state=state, contacts=None, options=OPTIONS, rounds=(), seconds={})


@pytest.fixture(scope="module")
def leaning():
    made = condense(with_fields(plastic(), LEAN))
    return SimpleNamespace(**vars(made), state=solve(made.model, made.drive))


def without_poisson(drive):
    """The drive of a plastic whose displacements along the width are none."""
    soft = Material(youngs_modulus=3100.0, poisson_ratio=0.0)
    return replace(drive, materials=replace(drive.materials, disc=soft, wheel_pin=soft, roller=soft, inner_race=soft))


def joint(models, drive):
    """All discs on one wheel."""
    return solve_poses(models, Supports.of_drive(drive), WheelLoad.of_drive(drive), pose_tolerance=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [{}, pytest.param({"installation.held": "pin-wheel", **TWO, **OFFSET}, marks=pytest.mark.nightly)],
    ids=["one disc", "two discs on a yielding wheel"],
)
def test_without_poisson_ratio_solids_are_plane(changes):
    # Nothing varies along the width then: the displacements of plane bodies are those of solid ones, in the elements as well.
    drive = without_poisson(with_fields(plastic(), changes))
    made = [condense(single) for single in single_discs(drive)]
    planes = [condense_drive(each.drive, each.shapes, each.contacts, each.meshes) for each in made]
    flat, solid = joint(planes, drive), joint([each.model for each in made], drive)
    for own, plane, on_plane, on_solid in zip(made, planes, flat, solid, strict=True):
        # What the condensations lose to round-off: the condition of the compliance, 1e6.
        assert on_solid.pose.wheel_angle == pytest.approx(on_plane.pose.wheel_angle, rel=1e-8)
        assert on_solid.wheel_moment == pytest.approx(on_plane.wheel_moment, rel=1e-7)
        largest = on_plane.contact.pressure.max()
        for solid_pair, plane_pair in zip(own.model.pairs, plane.pairs, strict=True):
            of_solid = own.model.pressures_of(solid_pair, on_solid.contact.pressure)
            expected = np.repeat(on_plane.contact.pressure[plane_pair.unknowns][:, None], of_solid.shape[1], axis=1)
            np.testing.assert_allclose(of_solid, expected, atol=1e-6 * largest)
        assert stored(own.model, on_solid) == pytest.approx(stored(plane, on_plane), rel=1e-7)
        np.testing.assert_allclose(
            own.model.bore_fit(on_solid.contact.pressure),
            plane.bore_fit(on_plane.contact.pressure),
            rtol=1e-6,
            atol=1e-10,
        )
        points = own.model.probed_places
        np.testing.assert_allclose(
            own.model.wall_displacements(points, on_solid.contact.pressure),
            plane.wall_displacements(points, on_plane.contact.pressure),
            rtol=1e-6,
            atol=1e-9,
        )
    if len(made) > 1:
        assert abs(solid[0].wheel_moment / solid[1].wheel_moment - 1.0) > 0.1


@pytest.mark.nightly
@pytest.mark.slow
def test_rollers_of_several_cranks_do_not_press_each_other_through_their_races():
    """One condensed race stands for all: plane bodies as above. Three cranks, few teeth and rollers."""
    drive = load_drive("rv").cases["nominal"]
    few = {
        "crank.eccentricity": 4.0, "crank.angle": 0.4, "crank_bearing.number_of_rollers": 5, "pin_wheel.number_of_pins": 6,
        "pin_wheel.pin_radius": 8.0, "disc.number_of_teeth": 5, "disc.number_of_discs": 1, "disc.phases": (), "disc.planes": (),
        "load.torque": 200e3, "load.light_torque": 6e3,
    }  # fmt: skip
    drive = without_poisson(with_fields(replace(drive, crank=replace(drive.crank, support=None)), few))
    made = condense(drive)
    plane = condense_drive(drive, made.shapes, made.contacts, made.meshes)
    (flat,), (solid,) = joint([plane], drive), joint([made.model], drive)
    assert solid.pose.wheel_angle == pytest.approx(flat.pose.wheel_angle, rel=1e-8)
    for pair in made.model.pairs:
        if pair.kind == "roller_inner":
            (same,) = (each for each in plane.pairs if (each.kind, each.index) == (pair.kind, pair.index))
            middle = made.model.profile_of(pair, solid.contact.pressure)
            expected = flat.contact.pressure[same.unknowns]
            np.testing.assert_allclose(middle, expected, atol=1e-6 * flat.contact.pressure.max())


@pytest.mark.nightly
@pytest.mark.slow
def test_two_discs_all_leaning_alike_are_the_drive_turned_as_a_whole():
    """Axes pass through the middle of the drive, so that pins stand elsewhere at each disc: the same answer, leans as given."""
    upright = with_fields(plastic(), TWO)
    members = ("pin_wheel", "pin_shaft", "crank")
    leans = {f"{member}.inclination.{axis}": value for member in members for axis, value in (("x", 2e-3), ("y", 1e-3))}
    turned = with_fields(upright, leans)
    models = [condense(single).model for single in single_discs(turned)]
    assert abs(models[0].placement.wheel_axis) == pytest.approx(5.0 * np.hypot(2e-3, 1e-3), rel=1e-12)
    straight = [
        replace(standing(model, single), widths=model.widths)
        for model, single in zip(models, single_discs(upright), strict=True)
    ]
    found, expected = joint(models, turned), joint(straight, upright)
    for model, state, other in zip(models, found, expected, strict=True):
        assert state.pose.wheel_angle == pytest.approx(other.pose.wheel_angle, rel=1e-8)
        assert state.wheel_moment == pytest.approx(other.wheel_moment, rel=1e-7)
        np.testing.assert_allclose(
            state.contact.pressure, other.contact.pressure, atol=1e-6 * other.contact.pressure.max()
        )
        assert disc_lean(solution(model, state)) == pytest.approx(turned.crank.inclination.lean, rel=1e-8)


def stored(model, state):
    """Strain energy by the compliance, N·mm."""
    supports, pressure = Supports.of_drive(model.drive), state.contact.pressure
    problem = joint_problem([model], supports, [state.pose], [list(state.integrals)], state.wheel_moment)
    return 0.5 * pressure @ problem.compliance @ pressure


@pytest.mark.nightly
@pytest.mark.slow
def test_on_a_held_wheel_the_shaft_pins_bring_the_output_torque():
    """Whatever the wheel and the crank take: the moment on the wheel alone was set by the iteration."""
    drive = with_fields(plastic(), {"installation.held": "pin-wheel"})
    model = condense(drive).model
    start = solve_pose(model, drive.wheel_moment())
    (state,) = solve_poses((model,), Supports.of_drive(drive), WheelLoad.of_drive(drive), (start.pose,))
    forces = pair_forces(model, list(state.integrals), state.contact.pressure)
    of_holes = sum(force[2] for pair, force in zip(model.pairs, forces, strict=True) if pair.kind == "hole")
    bore = [force for pair, force in zip(model.pairs, forces, strict=True) if pair.kind == "roller_outer"]
    # The rest is of the cage, which turns with crank and disc: r_i/(r_i + r_o) of the one, what is left of the other.
    bearing, (race,) = drive.crank_bearing, model.race_centres
    inner, outer = bearing.inner_race_radius, bearing.outer_race_radius
    of_cage = sum(force[2] - (race.conjugate() * complex(*force[:2])).imag for force in bore)
    output = of_holes + outer / (inner + outer) * of_cage
    # Round-off of the disc's balance; the first guess of the moment is 2e-3 off.
    assert output == pytest.approx(-drive.driving_sign * drive.load.torque, rel=5e-6)
    assert abs(state.wheel_moment) > 1.001 * abs(drive.wheel_moment())


@pytest.mark.nightly
@pytest.mark.slow
class TestLeaning:
    """One condensation of a drive whose shaft pins and wheel stand askew."""

    def test_disc_balances_in_five_directions(self, leaning):
        # Forces from pressures and exact normals by a rule of our own: Simpson over both, fine, on the exact curves.
        forces, couples, moment = [], [], 0.0
        model, state = leaning.model, leaning.state
        for pair in model.pairs:
            if pair.kind == "roller_inner":
                continue
            grid = model.grids[pair.kind]
            pressure = model.pressures_of(pair, state.contact.pressure)
            full = np.vstack([0.0 * pressure[:1], pressure, 0.0 * pressure[:1]])
            # Bilinear in z: exact by two moments of every hat.
            along, rising = grid.moments(np.ones_like), grid.moments(np.asarray)
            xi = (np.arange(200) + 0.5) / 200
            edge, local = np.repeat(np.arange(pair.zone.edge_count), 200), np.tile(xi, pair.zone.edge_count)
            points, speed = pair.zone.points(edge, local)
            exact, normal = pair.zone.exact(points)
            pose = model.carrier_pose(pair, state.pose)
            normal, place = pose.turn(normal), pose.turn(exact)
            p = full[edge] * (1.0 - local)[:, None] + full[edge + 1] * local[:, None]
            push = -normal * speed / 200
            forces.append(push @ (p @ along))
            couples.append(push @ (p @ rising))
            moment += float((np.conj(place) * push).imag @ (p @ along))
        largest = max(map(abs, forces))
        # Normal forces meet exactly; the middle rule on 200 points of an edge leaves (1/200)² of it.
        assert abs(sum(forces)) < 1e-4 * largest
        assert abs(sum(couples)) < 1e-4 * largest * 4.0
        assert abs(moment) < 1e-4 * largest * 20.0
        assert max(map(abs, couples)) > 0.05 * largest
        assert abs(disc_lean(solution(model, state))) > 1e-4

    def test_rollers_balance_in_force_and_moment(self, leaning):
        model = leaning.model
        along = dict(zip(((p.kind, p.index) for p in model.pairs), along_width(model, leaning.state), strict=True))
        largest = max(each.load for each in along.values())
        for index in model.rollers:
            bore, race = along["roller_outer", index], along["roller_inner", index]
            # Along the ray: the forces are off it by the square of the angle between ray and normal in the bore.
            assert bore.load == pytest.approx(race.load, abs=2e-3 * largest)
            assert bore.moment == pytest.approx(race.moment, abs=2e-3 * largest * 8.0)

    def test_mirrored_inclinations_have_the_mirrored_answer(self, leaning):
        mirrored = with_fields(leaning.drive, {"pin_shaft.inclination.x": -3e-3, "pin_wheel.inclination.y": 1e-3})
        model = standing(leaning.model, mirrored)
        state = solve(model, mirrored)
        assert state.pose.wheel_angle == pytest.approx(leaning.state.pose.wheel_angle, rel=1e-9)
        assert disc_lean(solution(model, state)) == pytest.approx(
            -disc_lean(solution(leaning.model, leaning.state)), rel=1e-7
        )
        np.testing.assert_allclose(
            roller_leans(solution(model, state)),
            -roller_leans(solution(leaning.model, leaning.state)),
            rtol=1e-6,
            atol=1e-10,
        )
        for pair in model.pairs:
            (_, there), (_, here) = (
                pressures_over(solution(*own), pair) for own in ((model, state), (leaning.model, leaning.state))
            )
            np.testing.assert_allclose(there, here[:, ::-1], atol=1e-6 * max(here.max(), 1.0))

    def test_aligned_parts_tilt_nothing(self, leaning):
        model = standing(leaning.model, plastic())
        # Both classes are there; nothing but round-off asks for the antisymmetric one.
        model = replace(model, widths=leaning.model.widths)
        state = solve(model, plastic())
        assert abs(disc_lean(solution(model, state))) < 1e-10
        for each in along_width(model, state):
            np.testing.assert_allclose(each.line_load, each.line_load[::-1], atol=1e-7 * max(each.line_load.max(), 1.0))

    def test_all_leaning_alike_is_the_drive_turned_as_a_whole(self, leaning):
        # Wheel, crank and shaft pins lean alike: so do disc and rollers, and nothing is pressed otherwise.
        members = ("pin_wheel", "pin_shaft", "crank")
        fields = {
            f"{member}.inclination.{axis}": value for member in members for axis, value in (("x", 2e-3), ("y", 1e-3))
        }
        turned = with_fields(plastic(), fields)
        model = standing(leaning.model, turned)
        state = solve(model, turned)
        lean = turned.crank.inclination.lean
        assert lean == 1e-3 - 2e-3j
        assert disc_lean(solution(model, state)) == pytest.approx(lean, rel=1e-8)
        assert bore_lean(solution(model, state)) == pytest.approx(lean, rel=1e-7)
        rays = model.roller_rays[list(model.rollers)]
        carrying = {pair.index for pair, each in zip(model.pairs, along_width(model, state), strict=True)
                    if pair.kind == "roller_outer" and each.load > 0.0}  # fmt: skip
        on = [number in carrying for number in model.rollers]
        leans = roller_leans(solution(model, state))[list(model.rollers)]
        np.testing.assert_allclose(leans[on], (np.conj(rays) * lean).real[on], rtol=1e-6, atol=1e-10)
        for each in along_width(model, state):
            np.testing.assert_allclose(each.line_load, each.line_load[::-1], atol=1e-7 * max(each.line_load.max(), 1.0))

    def test_torque_does_what_is_stored(self, leaning):
        model = leaning.model
        # dE = M dφ of all that is held or free: central about the torque, third order of 2 %.
        less, more = solve(model, leaning.drive, 0.98), solve(model, leaning.drive, 1.02)
        rise = [stored(model, each) for each in (less, more)]
        turn = more.pose.wheel_angle - less.pose.wheel_angle
        # Gaps are linearised about a pose within the plane and linear in tilts: some 1e-4 of normals that turn.
        assert rise[1] - rise[0] == pytest.approx(leaning.drive.wheel_moment() * turn, rel=2e-3)


def test_lengths_reliefs_and_classes():
    drive = with_fields(
        plastic(),
        {
            "contact.slices": 5,
            "disc.lead_slope": 1e-3,
            "disc.lead_crown_drop": 0.004,
            "crank_bearing.roller_length": 6.0,
        },
    )
    widths = DriveWidths(drive=drive, layers=3)
    assert not widths.even
    assert DriveWidths(drive=plastic(), layers=3).even
    assert [each.parity for each in widths.layers_of("disc")] == ["symmetric", "antisymmetric"]
    # The disc has an end of a layer where the rollers end.
    assert np.any(widths.layers_of("disc")[0].vertices == 3.0)
    assert widths.layers_of("roller")[0].vertices[-1] == widths.grid("roller_inner").heights[-1] == 3.0
    assert widths.grid("pin").heights[-1] == widths.layers_of("wheel_pin")[0].vertices[-1] == 4.0
    relief, _ = relief_of(drive, "pin")
    # Metal is left where z is positive; the crown takes 4 µm off both ends.
    np.testing.assert_allclose(relief(np.array([-4.0, 0.0, 4.0])), [0.008, 0.0, 0.0], atol=1e-15)
    assert relief_of(drive, "hole")[0] is None
    assert relief_of(drive, "roller_outer")[0] is None
    crowned = with_fields(plastic(), {"crank_bearing.roller_profile.crown_drop": 0.002})
    assert DriveWidths(drive=crowned, layers=3).even
    assert relief_of(crowned, "roller_inner")[0](4.0) == pytest.approx(0.002, rel=1e-12)


@pytest.mark.parametrize(
    ("field", "value", "refused", "said"),
    [
        ("main_bearing.radial_stiffness", 1e5, "main_bearing", "the axis of the wheel is fixed"),
        ("pin_shaft.beam", {"tip": "free"}, "pin_shaft.beam", "pins do not bend in the model"),
        ("friction.pin", 0.1, "friction", "frictionless"),
    ],
)
def test_what_it_does_not_know_is_refused_by_name(field, value, refused, said):
    with refused_field(refused, "", said):
        solve_reducer(with_fields(plastic(), {field: value}), ANGLE, OPTIONS)


def test_memory_is_known_before():
    with pytest.raises(MemoryLimitError, match="the disc as a solid body"):
        solve_reducer(plastic(), ANGLE, SolutionOptions(size=0.01, layers=40))


def test_one_layer_is_too_few():
    with pytest.raises(MeshError, match="layers = 1: must be at least 2"):
        DriveWidths(drive=plastic(), layers=1)
