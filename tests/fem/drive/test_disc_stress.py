"""Stress in the disc of a full solution: what is reported of it, and the LTCA's stresses against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.body.stress import Stress
from fem.body.wall_stress import WallStress, stress_along_wall
from fem.coefficients.dataset import derive_coefficients
from fem.contact.subsurface_shear import largest_shear_below
from fem.drive.disc_stress import recover_disc_stress, stress_variables, summarise_stress
from fem.drive.meshes import wall_refinements
from fem.drive.solution import solve_drive
from fem.errors import MeshError
from fem.mesh.element_size import Refinement
from fem.mesh.triangulation import mesh_circle
from fem.shapes import CircleShape, DriveShapes
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.coefficients import load_coefficients
from ltca.contact.hertz import line_contact_stress
from validation.compare.disc_stresses import answer_of_content, compare_stresses, stress_content, stresses_of

# Of the issue of these stresses: walls relative to the largest stress along them, shear relative to itself.
WALL_LIMIT, SHEAR_LIMIT = 2e-2, 3e-2


def hertz_field(body, half_width, peak):
    """McEwen's stresses at the nodes of a body whose surface at (0, −R) is pressed upward, as if it were a half-plane."""
    x, y = body.mesh.doflocs
    depth = np.maximum(y - y.min(), 1e-9)
    found = line_contact_stress(x, depth, half_width, peak)
    return Stress(xx=found.across, yy=found.depthwise, xy=-found.shear, zz=0.3 * (found.across + found.depthwise))


def test_largest_shear_of_mcewens_field():
    """0.300 p0 at 0.786 b, read from nodes b/16 apart; a stress along the wall adds half of itself."""
    half_width, peak, radius = 0.2, 1000.0, 6.0
    shape = CircleShape(name="pin", radius=radius)
    body = mesh_circle(shape, [Refinement(0.0, -radius, half_width / 8.0, 1.5 * half_width)])
    stress = hertz_field(body, half_width, peak)
    shear, depth = largest_shear_below(body, stress, -1j * radius, 1j, half_width)
    # Straight lines between nodes cut the crest by 0.1 %; it is flat, so its place is known to a node or two.
    assert shear == pytest.approx(0.30028 * peak, rel=2e-3)
    assert depth == pytest.approx(0.786 * half_width, abs=0.06 * half_width)
    along = replace(stress, xx=stress.xx + 60.0)
    assert largest_shear_below(body, along, -1j * radius, 1j, half_width)[0] == pytest.approx(shear + 30.0, rel=2e-3)
    with pytest.raises(MeshError, match="contact"):
        largest_shear_below(body, stress, 3j * radius, 1j, half_width)


def test_stress_along_a_wall_turns_with_it():
    """Uniform tension along x: cos² of the angle between wall and x, at nodes in order of their parameter."""
    shape = CircleShape(name="pin", radius=5.0, core_radius=2.0)
    body = mesh_circle(shape, coarse_size=1.5)
    nodes = body.node_count
    stress = Stress(xx=np.full(nodes, 80.0), yy=np.zeros(nodes), xy=np.zeros(nodes), zz=np.zeros(nodes))
    for curve in shape.curves:
        wall = stress_along_wall(body, stress, curve)
        assert np.all(np.diff(wall.parameter) > 0.0)
        np.testing.assert_allclose(np.abs(wall.points), curve.radius)
        np.testing.assert_allclose(wall.stress, 80.0 * np.sin(wall.parameter) ** 2, atol=1e-9)
    made = WallStress(
        name="w", parameter=np.array([1.0, 4.0]), points=np.zeros(2, complex), stress=np.array([2.0, 8.0])
    )
    # Over the end of the period the wall goes on at its beginning.
    np.testing.assert_allclose(
        made.at(np.array([2.0, 2.5 + np.pi])), [4.0, 8.0 - 6.0 * (np.pi - 1.5) / (2 * np.pi - 3.0)]
    )


def test_fine_walls_follow_every_wall(paper_cases):
    shape = DriveShapes.of_drive(paper_cases["CS-1"]).disc
    spots = wall_refinements(shape)
    places = np.array([spot.point for spot in spots])
    assert max(spot.size for spot in spots) == pytest.approx(shape.narrowest_wall / 6.0)
    for curve in (shape.bore, *shape.holes):
        along = curve.points(np.linspace(0.0, 2.0 * np.pi, 97))
        assert np.max(np.min(np.abs(along[:, None] - places), axis=1)) < 1.01 * shape.narrowest_wall / 6.0
    roots = shape.flank.points(2.0 * np.pi * np.arange(13) / 13)
    assert np.max(np.min(np.abs(roots[:, None] - places), axis=1)) < 1e-9


# An aluminium disc on steel parts: other numbers, other sizes, ligaments that differ.
OTHER = {
    "name": "other",
    "crank": {"eccentricity": 3.2},
    "pin_wheel": {"number_of_pins": 20, "pin_circle_radius": 100.0, "pin_radius": 6.0},
    "disc": {
        "number_of_teeth": 19, "thickness": 14.0, "equidistant_offset": 0.12, "shifting_offset": 0.07,
        "profile_errors": {},
    },
    "crank_bearing": {
        "inner_race_radius": 22.0, "outer_race_radius": 32.0, "number_of_rollers": 12, "roller_radius": 5.0,
        "roller_length": 14.0,
    },
    "pin_shaft": {
        "number_of_pins": 8, "pin_circle_radius": 61.0, "pin_radius": 14.8, "hole_radius": 18.0, "stiffness": 8.0e5,
    },
    "load": {"torque": 200_000.0, "light_torque": 10_000.0, "direction": "ccw"},
    "materials": {"disc": {"youngs_modulus": 71_000.0, "poisson_ratio": 0.33}},
}  # fmt: skip


@pytest.fixture(scope="module", params=["paper", "aluminium"])
def compared(request, paper_cases, vary, tmp_path_factory):
    """Coarse but for contacts and walls: full solution, its stress, and the LTCA's on coefficients of half again the size."""
    drive, angle = (paper_cases["CS-1"], 0.5) if request.param == "paper" else (vary(**OTHER), 0.3)
    path = tmp_path_factory.mktemp("stress") / "coefficients.nc"
    derive_coefficients(drive, size=1.5).to_netcdf(path, engine="h5netcdf")
    engine = PlaneStrain(coefficients=load_coefficients(path, drive))
    analysis = analyse(drive, np.array([angle]), None, engine)
    solution = solve_drive(drive, angle, scale=2.0, fine_walls=True)
    stress = recover_disc_stress(solution)
    return (
        solution,
        stress,
        analysis,
        compare_stresses(stresses_of(analysis)[0], answer_of_content(stress_content(stress))),
    )


@pytest.mark.slow
def test_wall_stress_of_the_ltca_is_that_of_full_fe(compared):
    *_, difference = compared
    for found in (*difference.stations.values(), *difference.largest.values()):
        assert abs(found.difference) < WALL_LIMIT, found
    assert set(difference.stations) == set(difference.largest) == {"flank", "bore", "holes"}


@pytest.mark.slow
def test_shear_of_the_ltca_is_that_of_full_fe(compared):
    """Contacts over 5 % of the largest load; without the disc's own stress some are 7 % off."""
    solution, stress, analysis, difference = compared
    contacts = solution.contacts
    for kind, load in (
        ("pin", contacts.pin_load),
        ("roller_outer", contacts.roller_load_outer),
        ("hole", contacts.pin_shaft_load),
    ):
        assert set(difference.shear[kind]) == set(np.flatnonzero(load > 0.05 * load.max()).tolist())
        for number, found in difference.shear[kind].items():
            assert abs(found.difference) < SHEAR_LIMIT, (kind, number, found)
    hertz = 0.30028 * analysis.pressures.outer.mid[0] / np.where(stress.roller_shear > 0.0, stress.roller_shear, np.nan)
    assert np.nanmax(np.abs(hertz - 1.0)) > SHEAR_LIMIT


@pytest.mark.slow
def test_files_say_what_was_found(compared):
    import xarray as xr

    solution, stress, *_ = compared
    summary, data = summarise_stress(stress), xr.Dataset(stress_variables(stress))
    lobes = solution.model.drive.disc.number_of_teeth
    assert data["root_stress"].shape == (1, 1, 1, lobes)
    np.testing.assert_array_equal(data["root_stress"].values[0, 0, 0], summary["root_stress_MPa"][0])
    assert data["bore_stress"].item() == summary["bore_stress_MPa"][0]
    assert data["roller_shear_max_outer"].dims == ("case", "disc", "crank", "position", "roller")
    # Contacts hide what is right beside them: under the pressure walls are compressed by as much.
    pressed = data["wall_stress"].where(data["wall_clear"] == 0)
    assert pressed.min() < -0.8 * solution.contacts.pin_pressure_max.max()
    clear = data["wall_stress"].where(data["wall_clear"] == 1)
    assert clear.max() == pytest.approx(
        max(max(summary["root_stress_MPa"][0]), *summary["bore_stress_MPa"], *summary["hole_stress_MPa"][0])
    )
    assert solution.fine_walls
