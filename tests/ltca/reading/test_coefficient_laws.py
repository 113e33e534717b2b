"""Laws that coefficients obey, on a dataset made by hand: every figure is known, and each bound bites on both sides."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from ltca.contact.round_bodies import compressed_cylinder, held_ring_approach
from ltca.geometry.boundary_stations import clustered_parameter
from ltca.reading import coefficient_laws
from ltca.reading.coefficient_laws import (
    NEIGHBOURS,
    check_coefficients,
    even_pressure,
    near_field_unit,
    station_resultants,
    unstated_laws,
)
from ltca.reading.station_walls import LARGEST_DISTANCE, missed_between_stations, wall_bending
from ltca.testing.closed_form_bodies import closed_form_coefficients

RADIUS, COUNT, THICKNESS = 20.0, 24, 11.8
MATERIALS = {"disc": (206e3, 0.3), "pin": (110e3, 0.25), "roller": (310e3, 0.27), "race": (72e3, 0.34)}
UNIT = {body: 2.0 * (1.0 - nu**2) / (np.pi * modulus * THICKNESS) for body, (modulus, nu) in MATERIALS.items()}


def made(plane="strain"):
    """A round disc of 20 mm with 24 stations, its approach that of patches alone and of nothing else."""
    angle = 2.0 * np.pi * np.arange(COUNT) / COUNT
    unit = UNIT if plane == "strain" else {
        body: 2.0 / (np.pi * modulus * THICKNESS) for body, (modulus, _) in MATERIALS.items()
    }  # fmt: skip
    alone = 3.0 * unit["disc"] * np.eye(COUNT)
    width = np.full(COUNT, 0.2)
    cylinder = compressed_cylinder(5.0, 0.1) * unit["roller"]
    points = RADIUS * np.exp(1j * angle)
    out = np.exp(1j * angle)
    data = xr.Dataset(
        {
            "station_x": ("station", points.real), "station_y": ("station", points.imag),
            "station_normal_x": ("station", out.real), "station_normal_y": ("station", out.imag),
            "station_boundary": ("station", np.zeros(COUNT, dtype=int)), "station_half_width": ("station", width),
            "disc_approach": (("station", "loaded"), alone),
            "roller_approach": (("side", "loaded_side"), np.array([[0.9, 0.1], [0.1, 0.9]]) * cylinder),
            "roller_half_width": ("side", [0.1, 0.1]),
            "roller_wide_approach": 0.9 * cylinder - np.log(2.0) * unit["roller"],
            "pin_approach": 4.0 * unit["pin"], "pin_wide_approach": (4.0 - np.log(2.0)) * unit["pin"],
            "race_approach": ("lag", 2.0 * unit["race"] * (np.arange(8) == 0)),
            "race_wide_approach": (2.0 - np.log(2.0)) * unit["race"],
            "wide_station": ("wide", [3, 17]), "wide_half_width": ("wide", [0.4, 0.3]),
            "wide_approach": ("wide", (3.0 - np.log([2.0, 1.5])) * unit["disc"]),
        },
        attrs={
            "plane": plane, "thickness": THICKNESS, "roller_radius": 5.0, "symmetry": 1e-13, "rigid_residual": 1e-13,
            "convergence_estimate": 5e-3,
        },
    )  # fmt: skip
    for body, (modulus, nu) in MATERIALS.items():
        data.attrs[f"{body}_youngs_modulus"], data.attrs[f"{body}_poisson_ratio"] = modulus, nu
    data["disc_resultant"] = (("motion", "station"), station_resultants(data))
    return data


def figures(dataset):
    return {check.name: check for check in check_coefficients(dataset)}


def test_closed_forms_by_hand():
    data = made()
    for body, unit in UNIT.items():
        assert near_field_unit(data, body) == pytest.approx(unit, rel=1e-14)
    assert near_field_unit(made("stress"), "pin") == pytest.approx(2.0 / (np.pi * 110e3 * THICKNESS), rel=1e-14)
    # Johnson 5.57: ln(4R/b) − 1/2, and 1/4 less in the mean
    assert compressed_cylinder(5.0, 0.1) == pytest.approx(np.log(200.0) - 0.75, rel=1e-14)


def test_resultants_push_inward_through_the_centre():
    found = station_resultants(made())
    angle = 2.0 * np.pi * np.arange(COUNT) / COUNT
    np.testing.assert_allclose(found, [-np.cos(angle), -np.sin(angle), 0.0 * angle], atol=1e-13)
    skew = made()
    # a normal turned back by 90° pushes along the tangent: its moment is the radius
    x, y = skew["station_normal_x"].values.copy(), skew["station_normal_y"].values.copy()
    skew["station_normal_x"], skew["station_normal_y"] = ("station", y), ("station", -x)
    np.testing.assert_allclose(station_resultants(skew)[2], RADIUS, rtol=1e-13)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_what_is_right_has_the_figures_it_must_have(plane):
    found = figures(made(plane))
    assert all(check.passed for check in found.values())
    expected = {
        "symmetry of the stored matrices": 0.0,
        "reciprocity of displacements solved for": 1e-13,
        "smallest eigenvalue, disc": 3.0,
        "rigid motions and change of datum": 1e-13,
        "resultants of the patches and of the stations": 0.0,
        "near field, disc, worst station": 1.0,
        "near field, pin, roller, race": 1.0,
        "roller against the compressed cylinder": 1.0,
        "convergence: error of the mesh, estimated": 5e-3,
    }
    assert expected.keys() <= found.keys()
    for name, value in expected.items():
        assert found[name].value == pytest.approx(value, abs=1e-12), name
    # the softest of pin 4, roller 0.8 of the cylinder's, race 2
    assert found["smallest eigenvalue, pin, roller, race"].value == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("name", "spoil"),
    [
        (
            "symmetry of the stored matrices",
            {"roller_approach": lambda value: np.add(value, [[0.0, 1e-12], [0.0, 0.0]])},
        ),
        ("near field, disc, worst station", {"wide_approach": lambda value: np.add(value, [0.0, 0.05 * UNIT["disc"]])}),
        ("near field, pin, roller, race", {"pin_wide_approach": lambda value: value - 0.05 * UNIT["pin"]}),
        ("roller against the compressed cylinder", {"roller_approach": lambda value: 1.004 * value}),
        ("resultants of the patches and of the stations", {"disc_resultant": lambda value: 1.0002 * value}),
        ("smallest eigenvalue, disc", {"disc_approach": lambda value: 0.03 * value}),
        ("smallest eigenvalue, pin, roller, race", {"race_approach": lambda value: 0.04 * value}),
    ],
)
def test_what_is_a_little_wrong_is_told(name, spoil):
    data = made()
    for variable, change in spoil.items():
        data[variable] = (data[variable].dims, np.asarray(change(data[variable].values)))
    assert not figures(data)[name].passed


@pytest.mark.parametrize("name", ["symmetry", "rigid_residual", "convergence_estimate"])
def test_what_a_file_states_of_itself_is_bounded(name):
    data = made()
    data.attrs[name] = {"symmetry": 2e-8, "rigid_residual": 2e-10, "convergence_estimate": 1.3e-2}[name]
    assert [check.passed for check in check_coefficients(data)].count(False) == 1
    before = unstated_laws(data)
    del data.attrs[name]
    assert [what for law, what in unstated_laws(data).items() if law not in before] == [name]
    assert all(check.passed for check in check_coefficients(data))


def test_what_a_race_is_off_the_held_ring_counts_by_the_largest_approach():
    data, inner, outer = made(), 10.0, 19.5
    angle, nu = 2.0 * np.pi * np.arange(8) / 8, MATERIALS["race"][1]
    data["race_half_width"] = 0.15
    ring = held_ring_approach(inner, outer, 0.15, 3.0 - 4.0 * nu, angle)
    wrong = ring + 1e-3 * np.abs(ring).max() * (np.arange(8) == 3)
    for values, off in ((ring, 0.0), (wrong, 1e-3)):
        data["race_approach"] = "lag", UNIT["race"] * values
        assert coefficient_laws._off_held_ring(data, "race", inner, outer) == pytest.approx(off, rel=1e-9, abs=1e-12)


def test_even_pressure_is_the_arc_between_stations():
    """A circle of 20 mm in 24 parts; boundaries of another size have their own."""
    data = made()
    np.testing.assert_allclose(even_pressure(data), THICKNESS * 2.0 * np.pi * RADIUS / COUNT, rtol=1e-12)


def test_neighbours_of_a_half_plane_fall_like_the_logarithm(paper_cases):
    """Patches of half-planes, own approaches that differ: half of both own ones less that between them, which is 1 here but
    for the width of a patch by its distance, b²/(4 s²) of some 5."""
    data = closed_form_coefficients(paper_cases["CS-1"], half_width=0.05, depth=300.0)
    data.attrs["shape"] = "{}"  # neither race nor pin: the disc alone
    (check,) = [check for check in check_coefficients(data) if check.name == NEIGHBOURS]
    assert check.value == pytest.approx(1.0, abs=1e-3)
    # What is taken from one patch and given to the next stays.
    own = np.arange(data.sizes["station"])
    data["disc_approach"].values[own, own] += 0.2 * UNIT["disc"] * (-1.0) ** own
    (shifted,) = [check for check in check_coefficients(data) if check.name == NEIGHBOURS]
    assert shifted.value == pytest.approx(check.value, abs=1e-3)


def ring(thickness):
    """That dataset as one of a ring, its inner wall so far from the stations, with as many stations of its own."""
    outer = made()
    inner = made()
    for name in ("station_x", "station_y"):
        inner[name] = inner[name] * (RADIUS - thickness) / RADIUS
    inner["station_boundary"] = inner["station_boundary"] + 1
    walls = [name for name in outer if outer[name].dims == ("station",)]
    joined = xr.concat([outer[walls], inner[walls]], "station")
    return joined.assign(wide_station=outer["wide_station"], wide_half_width=outer["wide_half_width"])


def test_a_thin_wall_may_bend_between_a_patch_and_a_wider_one():
    """A ring under a force has M = FR/π there (Roark), curvature 12 M/(Eh³t); a patch sees a quarter of it times b²."""
    for thickness in (0.5, 1.0):
        found = wall_bending(ring(thickness), np.array([3, 17]))
        curvature = 12.0 * RADIUS / np.pi / thickness**3 * np.pi / 2.0  # of a force, by 2/(πEt)
        wide, narrow = np.array([0.4, 0.3]), 0.2
        expected = 0.25 * (wide**2 - narrow**2) * curvature / np.log(wide / narrow)
        # the circumference by chords, and distances by points a twelfth of a station apart
        np.testing.assert_allclose(found, expected, rtol=2e-3)
    assert np.all(wall_bending(made(), np.array([3, 17])) == 0.0)  # one boundary, no wall


def test_what_stations_miss_of_a_function_with_a_pole_a_wall_away():
    """Σ s/(h² + (x + ks)²) is at most coth(πh/s) of the integral π/h: by the sum itself, on a ring nearly straight."""
    for thickness in (1.0, 2.0, 6.0):
        data = ring(thickness)
        points = data["station_x"].values + 1j * data["station_y"].values
        missed, wall, distance = missed_between_stations(data["station_boundary"].values, points)
        # From the outer wall, whose stations are farther apart; by chords a twelfth of a station long.
        assert wall == pytest.approx(thickness, rel=2e-3)
        assert distance == pytest.approx(2.0 * np.pi * RADIUS / COUNT, rel=2e-4)
        places = distance * np.arange(-200_000, 200_001)
        summed = distance * np.sum(thickness / np.pi / (thickness**2 + places**2))
        # What lies beyond 200,000 stations, and the 2e-3 above.
        assert missed == pytest.approx(summed - 1.0, rel=4e-3, abs=2e-5)
    one = made()
    points = one["station_x"].values + 1j * one["station_y"].values
    assert missed_between_stations(one["station_boundary"].values, points)[0] == 0.0
    assert 2.0 / np.expm1(2.0 * np.pi / LARGEST_DISTANCE) == pytest.approx(1.0, rel=1e-12)


def test_thickness_of_a_wall_whose_stations_do_not_face_each_other():
    """The wall is thinner than points along it are apart: its thickness is the distance to the line between them."""
    thickness, angle = 0.1, 2.0 * np.pi * np.arange(40) / 40
    turned = np.pi / (40 * 12)  # half of a twelfth of a station
    outer, inner = RADIUS * np.exp(1j * angle), (RADIUS - thickness) * np.exp(1j * (angle + turned))
    _, wall, _ = missed_between_stations(np.repeat([0, 1], 40), np.concatenate((outer, inner)))
    sagitta = RADIUS * (1.0 - np.cos(turned))  # of the outer chords, towards the inner points
    assert wall == pytest.approx(thickness - sagitta, rel=1e-6)


def test_coefficients_of_a_thin_wall_are_not_refused_for_its_bending():
    """Those of 5 pins with a wall of 0.585 mm were rejected as 'near field 1.044' right after they had been derived."""
    data, bending = made(), np.array([0.08, 0.0])
    drop = np.array([0.044 * np.log(2.0), 0.0]) * UNIT["disc"]
    data["wide_approach"] = data["wide_approach"] - drop
    assert not figures(data)["near field, disc, worst station"].passed
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(coefficient_laws, "wall_bending", lambda *_: bending)
        check = figures(data)["near field, disc, worst station"]
        assert check.passed
        assert (check.lowest, check.highest) == pytest.approx((0.96, 1.12))
        assert check.value == pytest.approx(1.044)
        for spoil in (
            -2.0 * drop[::-1],
            -4.0 * drop,
            3.0 * drop,
        ):  # of the thick wall, too far, and less than a half-plane's
            wrong = data.assign(wide_approach=data["wide_approach"] + spoil)
            assert not figures(wrong)["near field, disc, worst station"].passed


def strained_flank(ratio, per_lobe, clustering):
    """Flank of 20 lobes with λ = e u/R under nine known displacements u, and its strain t·du/ds, as a file would hold them.

    Fields are those of a dilation, of one that grows with r², and of centres inside: no stress is solved for, the law relates
    strain and displacement alone. They are the "loads" of a second wall.
    """
    teeth, u, radius, offset = 20, 21, 18.0, 1.6 if ratio < 0.9 else 1.25
    e = ratio * radius / u
    angle = 2.0 * np.pi * np.arange(teeth * per_lobe) / (teeth * per_lobe)
    theta = clustered_parameter(angle, teeth, clustering)
    centre = radius * np.exp(1j * theta) - e * np.exp(1j * u * theta)
    slope = 1j * (radius * np.exp(1j * theta) - e * u * np.exp(1j * u * theta))
    tangent = slope / np.abs(slope)
    normal = -1j * tangent
    points, step = centre - offset * normal, 1e-5

    def fields(place):
        yield place
        yield place * np.abs(place) ** 2 / radius**2
        for share in (0.6, 0.75):
            for turned in (0.0, 0.03, 0.1):
                away = place - share * radius * np.exp(1j * turned)
                yield away / np.abs(away) ** 2
        yield 1j * place  # a rotation, which strains nothing

    moved, ahead, behind = (np.array([*fields(points + side * step * tangent)]) for side in (0.0, 1.0, -1.0))
    strain = np.real(np.conj(tangent) * (ahead - behind)) / (2.0 * step)
    count, loads = points.size, len(moved)
    approach = np.zeros((count + loads, count + loads))
    approach[:count, count:] = -np.real(np.conj(normal) * moved).T  # into the body
    hole = 5.0 * np.exp(2j * np.pi * np.arange(loads) / loads)
    every, out = np.append(points, hole), np.append(normal, -hole / 5.0)
    stress = np.zeros((count + loads, count + loads))
    stress[:count, count:] = strain.T * MATERIALS["disc"][0]
    boundary = np.repeat([0, 1], [count, loads])
    parameter = np.append(theta, np.angle(hole) % (2.0 * np.pi))
    return xr.Dataset(
        {
            "station_x": ("station", every.real), "station_y": ("station", every.imag),
            "station_normal_x": ("station", out.real), "station_normal_y": ("station", out.imag),
            "station_boundary": ("station", boundary), "stress_station_boundary": ("stress_station", boundary),
            "station_parameter": ("station", parameter), "stress_station_parameter": ("stress_station", parameter),
            "disc_approach": (("station", "loaded"), approach), "disc_stress": (("stress_station", "loaded"), stress),
        },
        attrs={
            "plane": "stress", "thickness": THICKNESS, "flank_clustering": clustering,
            "disc_youngs_modulus": MATERIALS["disc"][0], "disc_poisson_ratio": 0.3,
            "shape": f'{{"disc.number_of_teeth": {teeth}}}',
        },
    )  # fmt: skip


def walls_close(dataset):
    (check,) = [
        check for check in coefficient_laws._check_stresses(dataset) if check.name == coefficient_laws.WALLS_CLOSE
    ]
    return check


@pytest.mark.parametrize(
    ("ratio", "per_lobe", "clustering", "missed"),
    [
        (0.875, 16, 0.6, True), (0.92, 16, 0.6, True), (0.875, 8, 0.8, True), (0.92, 8, 0.85, True), (0.92, 24, 0.6, True),
        (0.6, 8, 0.6, False), (0.92, 32, 0.85, False),
    ],
)  # fmt: skip
def test_true_strains_of_a_flank_that_few_stations_follow_break_no_law(ratio, per_lobe, clustering, missed):
    """Sound coefficients of public drives were refused for 1.62 and 2.40, at most 0.10: the stations missed the turn of the
    roots.
    """
    check = walls_close(strained_flank(ratio, per_lobe, clustering))
    assert check.passed, (check.value, check.highest)
    assert (check.value > 0.1) is missed


@pytest.mark.parametrize(("ratio", "clustering"), [(0.6, 0.6), (0.875, 0.793), (0.92, 0.8455)])
def test_strains_wrong_by_a_factor_are_told_where_stations_follow_the_flank(ratio, clustering):
    """As the stations of a derivation do: there the bound is that of any wall."""
    data = strained_flank(ratio, 16, clustering)
    check = walls_close(data)
    assert check.value < 0.01
    assert check.highest < 0.11
    for factor in (0.8, 1.2):
        assert not walls_close(data.assign(disc_stress=factor * data["disc_stress"])).passed


def uneven_wall(own):
    """That dataset with approaches that depend on the distance alone, but for those of patches on themselves, in units."""
    data, place = made(), np.arange(COUNT)
    around = 3.0 * np.cos(2.0 * np.pi * (place[:, None] - place) / COUNT)
    data["disc_approach"].values[:] = UNIT["disc"] * (around + np.diag(own))
    return data


def lone(dataset):
    (check,) = coefficient_laws._check_lone_entries(dataset)
    return check


def test_a_wall_that_bends_under_its_own_patch_over_each_hole_is_in_line():
    """Four stations a hole, 24 in all: 11.7, at most 10, for a bore with six holes behind 3 mm of wall."""
    data = uneven_wall(np.tile([9.19, 8.53, 8.07, 8.53], 6) - 3.0)
    assert lone(data).passed
    for row, column in ((5, 9), (7, 7)):
        wrong = data.copy(deep=True)
        wrong["disc_approach"].values[row, column] += 10.0 * UNIT["disc"]
        wrong["disc_approach"].values[column, row] = wrong["disc_approach"].values[row, column]
        assert not lone(wrong).passed


def test_a_wall_thinner_than_its_stations_are_apart_may_bend_under_one_of_them_alone():
    """Only one of 24 stations stands over what thins the wall; one as thick as two steps says that it is an error."""
    own = np.full(COUNT, 5.0)
    own[7] += 2.0
    data = uneven_wall(own)
    spacing = 2.0 * np.pi * RADIUS / COUNT
    for thickness, passed in ((0.5 * spacing, True), (2.0 * spacing, False)):
        both = ring(thickness)
        approach = np.zeros((2 * COUNT, 2 * COUNT))
        approach[:COUNT, :COUNT] = data["disc_approach"].values
        both = both.assign(disc_approach=(("station", "loaded"), approach)).assign_attrs(data.attrs)
        assert lone(both).passed is passed
