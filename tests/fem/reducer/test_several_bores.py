"""Discs with several bores by finite elements: gaps of the pairs, balance, numbers of the cranks, held wheels, the LTCA."""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from refusals import refused_field

from fem.coefficients.dataset import derive_coefficients
from fem.commands import fem as command
from fem.drive.expected_contacts import expect_contacts
from fem.drive.fields import recover_fields
from fem.drive.pose import WheelLoad
from fem.drive.rigid_bodies import RigidBodies
from fem.drive.solution import solve_discs
from fem.options import SolutionOptions
from fem.pictures.mesh_picture import choose_zooms, place_bodies
from fem.reducer.solution import solve_reducer
from fem.reducer.solution_files import build_dataset, summarise
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.results import build_dataset as results_dataset
from ltca.drive.parts import Material
from ltca.drive.single_discs import equal_parts, single_discs
from ltca.geometry.pairs import ContactGeometry
from ltca.reading.changes import with_fields
from ltca.reading.coefficient_file import write_coefficients
from ltca.reading.drive_file import parse_drive, shipped_drive
from ltca.reading.writing import drive_text

ANGLE = 0.5
ROLLERS = 9
PITCH = 2.0 * np.pi / 3.0


@pytest.fixture(scope="module")
def rv():
    """The made-up RV reducer on rigid cranks."""
    drive = parse_drive(shipped_drive("rv"), "rv").cases["nominal"]
    return replace(drive, crank=replace(drive.crank, support=None))


@pytest.fixture(scope="module")
def small(rv):
    """One disc with few teeth and rollers: few meshes; the bores stand at no angle that a symmetry likes."""
    fields = {
        "crank.eccentricity": 4.0,
        "crank.angle": 0.4,
        "crank_bearing.number_of_rollers": ROLLERS,
        "pin_wheel.number_of_pins": 12,
        "pin_wheel.pin_radius": 8.0,
        "disc.number_of_teeth": 11,
        "disc.number_of_discs": 1,
        "disc.phases": (),
        "disc.planes": (),
        "load.torque": 400e3,
        "load.light_torque": 12e3,
    }
    return with_fields(rv, fields)


@pytest.fixture(scope="module")
def solved(small):
    return solve_reducer(small, ANGLE, SolutionOptions(size=6.0))


def renumbered(drive):
    """The first crank a pitch further on: the same drive with other numbers."""
    return with_fields(drive, {"crank.angle": drive.crank.angle + PITCH})


@pytest.mark.parametrize("disc", [0, 1])
def test_gaps_are_those_of_the_pairs(rv, disc):
    """Finite elements start from the same rigid bodies as the LTCA, bores and eccentrics off their places and turned."""
    fields = {
        "disc.of.0.bore_errors.radial": (0.003, 0.0, -0.002),
        "disc.of.0.bore_errors.tangential": (0.0, 0.004, 0.0),
        "crank.of.1.eccentricity_error": 0.005,  # disc 0, crank 1
        "crank.of.5.phase_error": 1e-3,  # disc 1, crank 2
    }
    single, angle = single_discs(with_fields(rv, fields))[disc], np.array([1.3])
    pose = np.array([[0.012, -0.02, 3e-4, -1.9e-3]])
    gaps = RigidBodies.of_drive(single, 1.3).gaps(complex(0.012, -0.02), 3e-4, -1.9e-3)
    geometry = ContactGeometry.of_drive(single)
    rays, bores = geometry.rollers(angle), geometry.bores(angle, pose)
    displacement = bores.each(bores.displacement, gaps.rollers.size)
    np.testing.assert_allclose(
        gaps.rollers,
        (rays.touching(rays.direction.conjugate() * displacement) - rays.outermost)[0],
        rtol=0.0,
        atol=1e-12,
    )
    np.testing.assert_allclose(gaps.pins, -geometry.flank(angle, pose).approach[0], rtol=0.0, atol=1e-11)
    assert gaps.holes.size == 0
    assert np.abs(displacement - displacement.mean()).max() > 1e-3


def test_springs_balance_and_do_not_ask_for_numbers(small):
    """Forces and moments on the disc vanish, and the crank that is called the first one changes nothing else."""
    guess, other = expect_contacts(small, ANGLE), expect_contacts(renumbered(small), ANGLE)
    turn = np.exp(1j * guess.disc_rotation)
    places = np.concatenate([guess.flank_points, guess.bore_points]) * turn
    pins, rollers = guess.pins, guess.rollers_outer
    # directions point from pin and roller to the disc, whose wall they press
    forces = np.concatenate([pins.load * np.exp(1j * pins.direction), rollers.load * np.exp(1j * rollers.direction)])
    size = rollers.load.max()
    assert abs(forces.sum()) < 1e-5 * size
    # points on the bores are those of rays, off the line of the force by the play of the pose over the radius
    assert abs(np.sum((places.conjugate() * forces).imag)) < 1e-4 * size * 80.0
    np.testing.assert_allclose(guess.pins.load, other.pins.load, rtol=0.0, atol=1e-4 * size)
    np.testing.assert_allclose(np.roll(rollers.load, -ROLLERS), other.rollers_outer.load, rtol=0.0, atol=1e-4 * size)
    loads = rollers.load.reshape(3, ROLLERS).max(axis=1)
    assert np.ptp(loads) > 0.1 * size


@pytest.mark.parametrize(("field", "value"), [("clearance", 0.01), ("torsion", True)])
def test_members_that_yield_otherwise_than_springs_are_refused_by_name(rv, field, value):
    support = parse_drive(shipped_drive("rv"), "rv").cases["nominal"].crank.support
    yielding = replace(rv, crank=replace(rv.crank, support=replace(support, **{field: value})))
    with refused_field(f"crank.support.{field}"):
        solve_reducer(yielding, ANGLE)


@pytest.mark.slow
def test_the_disc_is_in_equilibrium(solved, small):
    """From the places and normals of the contacts alone: forces and moment on the disc, and what the cranks take."""
    (disc,) = solved.discs
    contacts, model, pose = disc.contacts, disc.model, disc.pose
    largest = contacts.roller_load.max()
    assert contacts.equilibrium_residual < 1e-6 * largest
    total = contacts.pin_force.sum() + contacts.roller_force.sum()
    assert abs(total) < 1e-6 * largest
    moment = 0.0
    for kind, forces in (("pin", contacts.pin_force), ("roller_outer", contacts.roller_force)):
        for index in np.flatnonzero(np.abs(forces) > 0.0).tolist():
            # normal forces on a circle act through its centre
            moment += (model.circle_centre(kind, index, pose).conjugate() * forces[index]).imag
    # The resultant leaves the centre by what the pressure is skewed, on coarse meshes by some tenths of a micrometre.
    assert abs(moment) < 1e-4 * abs(solved.wheel_moment)
    np.testing.assert_allclose(contacts.roller_load, contacts.roller_load_inner, rtol=1e-5)
    forces = contacts.roller_force.reshape(3, ROLLERS).sum(axis=1)
    np.testing.assert_allclose(contacts.bearing_force, forces, rtol=1e-12)
    along = forces * np.exp(-1j * ANGLE)
    np.testing.assert_allclose(disc.bearing_components, np.column_stack([along.real, along.imag]), rtol=1e-9)
    # Eccentrics lie at φ_C: a tangential force has the lever e about its crank's own axis. The cage, which turns by
    # r_i/(r_i + r_o) of the crank's angle, takes the force's moment at the displaced centre of the bore.
    place = np.array([[pose.disc_x, pose.disc_y, pose.disc_rotation, pose.wheel_angle]])
    bores = ContactGeometry.of_drive(small).bores(np.array([ANGLE]), place).displacement[0]
    cages = 13.0 / 31.0 * (bores.conjugate() * forces).imag
    np.testing.assert_allclose(disc.crank_moments, 4.0 * along.imag + cages, rtol=0.0, atol=1e-7 * 4.0 * largest)
    assert np.abs(cages).max() > 1e-5 * 4.0 * largest


@pytest.mark.slow
def test_a_held_wheel_takes_the_moment_of_the_sun(solved, small):
    """Behind a first stage the sun bears −1/i₁ of the cranks' moments; in the mean the wheel bears T (i − 1)/i."""
    cranks, torque = solved.discs[0].crank_moments.sum(), small.load.torque
    assert solved.wheel_moment - cranks / 2.0 + torque == pytest.approx(0.0, abs=1e-7 * torque)
    # virtual work: the cranks take 1/u but for the slope of the wheel's angle, some tenths of a per cent of it
    assert cranks == pytest.approx(-solved.wheel_moment / 12.0, rel=5e-3)
    assert solved.transmission_error == pytest.approx(-24.0 / 25.0 * solved.wheel_angle, rel=1e-12)


@pytest.mark.slow
def test_numbering_of_the_cranks_is_a_matter_of_names(solved, small):
    load = WheelLoad(moment=solved.wheel_moment)
    one, (other,) = solved.discs[0], solve_discs(renumbered(small), ANGLE, load, SolutionOptions(size=6.0))
    for name, shift in (("pin_load", 0), ("roller_load", ROLLERS), ("roller_load_inner", ROLLERS)):
        first, second = getattr(one.contacts, name), getattr(other.contacts, name)
        # The same circles in another order give other meshes: 1.3 elements for a half-width, a load is good to 1 % or 2.
        assert np.max(np.abs(np.roll(first, -shift) - second)) < 0.02 * first.max(), name
        assert shift == 0 or np.max(np.abs(first - second)) > 0.2 * first.max(), name
    largest = one.crank_moments.max()
    np.testing.assert_allclose(np.roll(one.crank_moments, -1), other.crank_moments, rtol=0.0, atol=0.02 * largest)


@pytest.mark.nightly
@pytest.mark.slow
def test_rigid_body_limit_comes_near_the_half_space_drive(solved, small):
    """Disc and race 1000 times as stiff, pins and rollers half: every E* unchanged, only local yielding left.

    The limits are those of the same comparison for a central crank (`tests/fem/drive/test_solution.py`), and 2 % more for
    the coarser meshes.
    """
    soft, hard = (Material(youngs_modulus=value, poisson_ratio=0.3) for value in (103.0e3, 206.0e6))
    materials = replace(small.materials, disc=hard, inner_race=hard, wheel_pin=soft, roller=soft)
    load = WheelLoad(moment=solved.wheel_moment)
    (found,) = solve_discs(replace(small, materials=materials), ANGLE, load, SolutionOptions(size=6.0))
    contacts = found.contacts
    half_space = analyse(small, np.array([ANGLE]), None).full.response
    for name, limit, theirs in (
        ("pin_load", 0.17, half_space.pin_load[0]),
        ("roller_load", 0.07, half_space.rollers.outer_load[0]),
    ):
        away = np.max(np.abs(getattr(contacts, name) - theirs)) / theirs.max()
        flexible = np.max(np.abs(getattr(solved.discs[0].contacts, name) - theirs)) / theirs.max()
        assert away < limit, name
        assert away < flexible, name


@pytest.mark.nightly
@pytest.mark.slow
def test_the_ltca_on_plane_strain_bodies_says_the_same(small, tmp_path):
    """Loads within 1 % of the largest of a kind on these meshes, wheel within 0.3″; half of that per cent on default ones.

    Two cranks, turned in the carrier, and two discs half a turn apart: one part, so one file of coefficients serves both, and
    no input outside, so the wheel bears the torque.
    """
    fields = {
        "disc.number_of_discs": 2,
        "crank.number": 2,
        "load.torque": 600e3,
        "installation.first_stage_ratio": None,
    }
    two = with_fields(small, fields)
    assert equal_parts(two)
    path = tmp_path / "coefficients.nc"
    write_coefficients(derive_coefficients(single_discs(two)[0], stations=0.5, size=2.0), path)
    full = solve_reducer(two, ANGLE, SolutionOptions(size=4.0))
    assert full.wheel_moment == pytest.approx(-two.load.torque, rel=1e-7)
    assert full.transmission_error == -full.wheel_angle
    answer = analyse(two, np.array([ANGLE]), engine=PlaneStrain(coefficients=(path,)))
    for own, disc in zip(answer.discs, full.discs, strict=True):
        for load, theirs in (
            (own.full.response.pin_load[0], disc.contacts.pin_load),
            (own.full.response.rollers.outer_load[0], disc.contacts.roller_load),
        ):
            assert np.max(np.abs(load - theirs)) < 0.01 * theirs.max()
    assert abs(np.degrees(answer.full.pose[0, -1] - full.wheel_angle)) * 3600.0 < 0.3
    np.testing.assert_allclose(answer.torque_share[0], full.torque_share, atol=2e-3)


@pytest.mark.slow
def test_files_are_by_crank(solved, small, tmp_path, monkeypatch, capsys):
    data = build_dataset(solved, "nominal")
    (disc,) = solved.discs
    run = results_dataset("small", {"nominal": analyse(small, np.array([ANGLE]))})
    for name in set(run.data_vars) & set(data.data_vars):
        assert data[name].dims == run[name].dims, name
        assert data[name].shape == run[name].shape, name
    for name in set(run.coords) - {"light_torque", "case"}:
        np.testing.assert_allclose(data[name], run[name], rtol=1e-12, err_msg=name)
    np.testing.assert_array_equal(data["roller_load"].values.ravel(), disc.contacts.roller_load)
    np.testing.assert_array_equal(data["bearing_tangential"].values.ravel(), disc.bearing_components[:, 1])
    assert len(summarise(solved)["bearing_radial_N"]) == 3
    monkeypatch.setattr("fem.reducer.solution.solve_reducer", lambda *words, **options: solved)
    source = tmp_path / "small.toml"
    source.write_text(drive_text(small), encoding="utf-8")
    parser = argparse.ArgumentParser()
    command.configure(parser)
    words = [str(source), "--angle", "0.5", "--size", "6", "--out", str(tmp_path / "out"), "--no-pictures"]
    assert command.execute(parser.parse_args([*words, "--export", "calculix"])) == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {f"inner_race_{crank}.vtu" for crank in range(3)} | {"roller_26.vtu"} <= names
    assert "inner_race.vtu" not in names
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert all(page.count(f"<title>crank {crank}, roller ") > 0 for crank in range(3))
    assert ">crank 2</text>" in page
    assert "shaft pins</span>" not in page
    deck = (tmp_path / "out" / "calculix.inp").read_text(encoding="ascii")
    assert all(f"ELSET=RACE_{crank}\n" in deck for crank in range(3))
    with xr.open_dataset(tmp_path / "out" / "fem.nc", engine="h5netcdf") as written:
        assert dict(written["roller_shear_max_outer"].sizes) == {
            "case": 1, "disc": 1, "crank": 3, "position": 1, "roller": ROLLERS
        }  # fmt: skip
        assert set(written["wall_boundary"].values) == {0, 1, 2, 3}
        assert np.isfinite(written["bore_stress"].item())
    out = capsys.readouterr().out
    assert "bearing force on the disc at crank 2" in out


@pytest.mark.slow
def test_pictures_place_every_race_with_its_rollers(solved):
    model = solved.discs[0].model
    placed = place_bodies(model.meshes, model.placement, model.contacts)
    races = np.array([body.centre for body in placed if body.kind == "inner_race"])
    np.testing.assert_allclose(races, model.placement.crank_axes + 4.0 * np.exp(1j * ANGLE), rtol=1e-12)
    rollers = np.array([body.centre for body in placed if body.kind == "roller"]).reshape(3, ROLLERS)
    play = np.abs(rollers - races[:, None]) - (13.0 + 2.5)
    # the middle of the play, which the displaced disc takes from one side and gives to the other
    assert np.all(np.abs(play) < 0.02)
    titles = [zoom.title for zoom in choose_zooms(model.contacts, model.placement)]
    assert len(titles) == 3  # no shaft pins


@pytest.mark.slow
def test_every_race_bends_under_its_own_rollers(solved):
    """Against the force of its bearing on the disc, and is pressed on that side."""
    (disc,) = solved.discs
    races = [field for field in recover_fields(disc) if field.kind == "inner_race"]
    assert [field.body.name for field in races] == ["inner_race_0", "inner_race_1", "inner_race_2"]
    forces = disc.contacts.bearing_force
    for race, force in zip(races, forces.tolist(), strict=True):
        local = race.places - race.pose.centre
        bent, pressed = np.sum(race.elastic), np.sum(local * race.pressure)
        # nodes are dense under rollers, each roller's as dense as its load asks: sums over them lean to one side
        assert (bent.conjugate() * force).real < -0.9 * abs(bent * force)
        assert (pressed.conjugate() * force).real > 0.9 * abs(pressed * force)
    directions = forces / np.abs(forces)
    assert np.abs(directions - np.roll(directions, 1)).min() > 0.5  # no race could stand for another
