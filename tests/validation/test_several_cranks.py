"""Drives of several cranks: bearing forces, rollers and bores are told by crank. No finite elements here."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from refusals import refused_field

from fem.body.wall_stress import WallStress
from fem.drive.disc_stress import DiscStress
from fem.options import SolutionOptions
from ltca.analysis.engines import PlaneStrain
from ltca.analysis.loaded_analysis import analyse
from ltca.compliance.stress_coefficients import StressCoefficients
from ltca.drive.single_discs import single_discs
from ltca.geometry.boundary_stations import Boundary
from ltca.page.scene import drive_scene
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive
from ltca.testing.closed_form_bodies import without_coupling
from validation.compare.compared_positions import _AnsweredDisc, _station_distances
from validation.compare.comparison import KINDS, KindAnswer, PositionAnswer, compare_positions
from validation.compare.disc_stresses import (
    DiscStressAnswer,
    answer_of_content,
    compare_stresses,
    stress_content,
    stresses_of,
)
from validation.compare.finite_element_positions import answer_of_summary
from validation.levels.closed_forms import power_rows
from validation.levels.disc_stresses import disc_stress_rows
from validation.levels.flexible_disc import (
    flexibility_rows,
    full_solution_changes,
    judge_half_space,
    turn_content,
)
from validation.levels.model_laws import _uncoupled
from validation.levels.positions import _body_rows, _contact_rows, _faint
from validation.report.page import write_report
from validation.report.scene import position_scene
from validation.rows import failed_rows
from validation.study import plan_study

ANGLE = 0.3
ROLLERS = 9


@pytest.fixture(scope="module")
def drive(crank_drive):
    return crank_drive


@pytest.fixture(scope="module")
def compared(crank_study):
    """What the half-space says stands for the full solution."""
    (item,) = crank_study.compared["nominal"]
    return item


def made(rollers, radial=(300.0, 0.0), tangential=(400.0, 1000.0), holes=()):
    """Two cranks of three rollers, two pins."""

    def kind(load):
        load = np.array(load, dtype=float)
        return KindAnswer(load=load, pressure=50.0 * np.sqrt(load), half_width=0.01 * np.sqrt(load))

    loads = {"pin": [100.0, 50.0], "roller_outer": rollers, "roller_inner": rollers, "hole": holes}
    return PositionAnswer(
        kinds={name: kind(loads[name]) for name in KINDS}, bearing_radial=np.array(radial),
        bearing_tangential=np.array(tangential), wheel_angle=-1e-3, disc_radial=0.0, disc_tangential=0.0,
        disc_rotation=0.0,
    )  # fmt: skip


def made_position(drive):
    reference = made([0.0, 400.0, 20.0, 0.0, 0.0, 800.0])
    model = made([0.0, 402.0, 20.0, 0.0, 12.0, 800.0], radial=(302.0, 0.0), tangential=(400.0, 994.0))
    difference = compare_positions(model, reference)
    return SimpleNamespace(
        drive=drive,
        full=SimpleNamespace(case="nominal", crank_angle=ANGLE, answer=reference),
        answers={"fe": model},
        differences={"fe": difference},
    )


def test_rows_of_bearings_name_the_crank(drive):
    rows = _body_rows(made_position(drive), "fe")
    bearings = {(row.quantity, row.contact): row for row in rows if row.quantity.startswith("bearing")}
    assert len(bearings) == 4
    # Relative to the largest force of any crank, 1000 N, not to the crank's own 500 N.
    assert bearings["bearing force, radial", "crank 0"].difference == pytest.approx(2e-3)
    row = bearings["bearing force, tangential", "crank 1"]
    assert (row.value, row.reference, row.difference) == (994.0, 1000.0, pytest.approx(-6e-3))
    assert not row.passed
    assert "all cranks" in row.reason


def test_rows_of_rollers_name_the_crank(drive):
    position = made_position(drive)
    names = {row.contact for row in _contact_rows(position, "fe") if row.quantity == "load"}
    assert names == {
        "pin 0", "pin 1", *(f"crank {place} {side}" for place in ("0, roller 1", "0, roller 2", "1, roller 1", "1, roller 2")
                            for side in ("bore", "race")),
    }  # fmt: skip
    assert position.differences["fe"].missing == ("crank 1, roller 1 bore", "crank 1, roller 1 race")


def test_rows_of_a_disc_without_shaft_pins(drive):
    rows = {row.quantity: row for row in _body_rows(made_position(drive), "fe")}
    assert "number of loaded shaft pins" not in rows
    assert "number of loaded rollers" in rows
    assert _faint(made([1.0] * 6), "hole") == 0
    # Its rotation is held at the cranks, on a circle of 42 mm; the wheel's pins stand at 80 mm.
    assert rows["disc rotation"].limit == pytest.approx(0.3 * 80.0 / 42.0)
    assert "cranks" in rows["disc rotation"].reason


def test_stations_of_every_bore_are_its_own(drive):
    """Ten stations in the first bore; twenty in the second, from 0.1 rad on."""
    turn = 0.02
    rollers = np.array([[0.0, 2.5, 3.0, 3.25]]) * 2.0 * np.pi / np.array([10, 10, 20, 20]) + np.array([0, 0, 0.1, 0.1])
    response = SimpleNamespace(
        flank=SimpleNamespace(parameter=np.zeros((1, 1))),
        rollers=SimpleNamespace(outer_direction=np.exp(1j * (rollers + turn))),
        holes=SimpleNamespace(gradient=np.zeros((1, 0, 4))),
    )
    analysis = SimpleNamespace(full=SimpleNamespace(response=response, pose=np.array([[0.0, 0.0, turn, 0.0]])))
    bores = (Boundary(first=0, count=10), Boundary(first=10, count=20, offset=0.1))
    coefficients = SimpleNamespace(flank=Boundary(first=0, count=40), bores=bores, holes=())
    found = _station_distances(analysis, coefficients)
    np.testing.assert_allclose(found["roller_outer"], [[0.0, 0.5, 0.0, 0.25]], atol=1e-12)
    assert found["hole"].shape == (1, 0)


def test_stations_of_a_part_that_stands_turned_are_turned(paper_cases):
    """Discs half a turn apart are one part: a flank contact on a station of the part is on one in either disc."""
    two = with_fields(paper_cases["CS-1"], {"disc.number_of_discs": 2})
    single = single_discs(two)[1]
    coefficients = without_coupling(single)
    assert single.part_turn[1:] != (0, 0)
    analysis = analyse(two, np.array([ANGLE])).discs[1]
    place = coefficients.placed_in(single).flank.parameters()
    (part,) = analysis.full.response.parts
    part = replace(part, flank=replace(part.flank, parameter=place[None]))
    response = replace(analysis.full.response, parts=(part,))
    there = replace(analysis, full=replace(analysis.full, response=response))
    found = _AnsweredDisc.of_analyses({"fe": there}, coefficients)
    np.testing.assert_allclose(found.distances["pin"], 0.0, atol=1e-12)


def stresses(factor=1.0, places=64):
    """Flank, three bores, no holes: a hundredth off in all, and in the second bore by five."""
    parameter = 2.0 * np.pi * np.arange(places) / places
    factors = np.array([factor, factor, 1.0 + 5.0 * (factor - 1.0), factor])
    return DiscStressAnswer(
        parameter=(parameter,) * 4,
        stress=tuple(own * 100.0 * np.cos(parameter) for own in factors),
        clear=(np.ones(places, dtype=bool),) * 4,
        largest={
            "flank": factor * np.full(11, 90.0), "bore": factors[1:] * np.array([40.0, 50.0, 60.0]), "holes": np.zeros(0)
        },
        shear={"pin": np.zeros(2), "roller_outer": factor * np.array([0, 300.0, 0, 0, 0, 200.0]), "hole": np.zeros(0)},
    )  # fmt: skip


def test_stresses_of_bores_name_the_crank(drive):
    difference = compare_stresses(stresses(1.01, places=16), stresses())
    assert difference.stations["bore"].place == "bore of crank 1 at 0.0°"
    assert difference.largest["bore"].place == "bore of crank 1"
    assert difference.largest["bore"].difference == pytest.approx(0.05 * 50.0 / 100.0)
    assert set(difference.stations) == set(difference.largest) == {"flank", "bore"}
    full = made_position(drive).full
    rows = disc_stress_rows(SimpleNamespace(full=full, stress={"fe": difference}))
    assert len(rows) == 2 + 2 + 2
    assert {row.contact for row in rows} >= {"crank 0, roller 1 bore", "crank 1, roller 2 bore", "root 0"}


@pytest.mark.slow
def test_a_model_knows_the_stress_of_every_bore(drive):
    """The largest of them is what the LTCA reports of all bores together."""
    plain, stations = without_coupling(drive), 12
    walls = tuple(Boundary(first=stations * wall, count=stations) for wall in range(4))
    loaded = (plain.flank, *plain.bores)
    made_up = np.random.default_rng(3).normal(size=(4 * stations, plain.disc.shape[0]))
    own = replace(plain, stress=StressCoefficients(walls=walls, loaded=loaded, stress=made_up), pin=1e-7)
    analysis = analyse(drive, np.array([ANGLE, 1.0]), engine=PlaneStrain(coefficients=own))
    largest = np.array([answer.largest["bore"] for answer in stresses_of(analysis)])
    assert largest.shape == (2, 3)
    np.testing.assert_array_equal(largest.max(axis=1), analysis.wall_stresses[0].bore)
    assert np.ptp(largest, axis=1).min() > 0.0


def test_a_full_solution_keeps_the_stress_of_every_bore():
    def wall(name, *stress):
        values = np.array(stress)
        return WallStress(name=name, parameter=np.arange(values.size) * 1.0, points=values + 0j, stress=values)

    clear = tuple(np.array(own) for own in ([True, True], [True, False], [True, True], [False, False], [True, True]))
    walls = (wall("flank", 1.0, 2.0), wall("bore_0", 3.0, 9.0), wall("bore_1", 4.0, 7.0), wall("bore_2", 5.0, 5.0))
    stress = DiscStress(
        walls=(*walls, wall("hole_0", 8.0, 6.0)), clear=clear, root_stress=np.ones(2), bore_stress=7.0,
        hole_stress=np.array([8.0]), pin_shear_max=np.zeros(2), roller_shear_max_outer=np.zeros(6),
        pin_shaft_shear_max=np.zeros(1),
    )  # fmt: skip
    found = answer_of_content(stress_content(stress)).largest["bore"]
    np.testing.assert_array_equal(found, [3.0, 7.0, np.nan])


@pytest.mark.parametrize("discs", [1, 2])
def test_summary_is_read_by_disc_and_crank(drive, discs):
    loads = {}
    for name in ("pin_{}", "pin_shaft_{}", "roller_{}_outer", "roller_{}_inner"):
        for what, unit in (("load", "N"), ("pressure_max", "MPa"), ("half_width", "mm")):
            loads[f"{name.format(what)}_{unit}"] = [[1.0 + disc] for disc in range(discs)]
    motion = {"x_mm": 1.0, "y_mm": 0.0, "rotation_rad": 1e-4}
    summary = loads | {
        "crank_angle_rad": 0.3, "wheel_angle_rad": -1e-3, "bearing_radial_N": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        "bearing_tangential_N": [[7.0, 8.0, 9.0], [10.0, 11.0, 12.0]], "disc_displacement": [motion, motion],
    }  # fmt: skip
    if discs == 1:
        summary |= {
            name: summary[name][0] for name in ("bearing_radial_N", "bearing_tangential_N", "disc_displacement")
        }
    answer = answer_of_summary(summary, drive, discs - 1)
    np.testing.assert_array_equal(answer.bearing_radial, [1.0, 2.0, 3.0] if discs == 1 else [4.0, 5.0, 6.0])
    np.testing.assert_array_equal(answer.bearing_tangential, [7.0, 8.0, 9.0] if discs == 1 else [10.0, 11.0, 12.0])


@pytest.mark.slow
def test_the_page_draws_every_bore_and_race(compared, drive):
    """Contacts lie on rollers and bores, rollers about their races; each bearing's forces on the disc are its force."""
    scene, still = position_scene(compared), drive_scene(drive)
    turn = np.exp(1j * scene["disc"][2])
    disc = complex(*scene["disc"][:2])
    bores = np.array([complex(x, y) for x, y, _ in still["bores"]])
    np.testing.assert_allclose(bores, drive.crank.places, atol=1e-4)
    assert [radius for *_, radius in still["bores"]] == pytest.approx([18.004] * 3)
    assert still["holes"] == scene["shafts"] == []
    cranks = np.array(scene["cranks"])
    axes, races = cranks[:, 0] + 1j * cranks[:, 1], cranks[:, 2] + 1j * cranks[:, 3]
    np.testing.assert_allclose(axes, bores, atol=2e-4)
    np.testing.assert_allclose(races - axes, 4.0 * np.exp(1j * ANGLE), atol=2e-4)
    rollers = np.array([complex(x, y) for x, y, _ in scene["rollers"]])
    np.testing.assert_allclose(np.abs(rollers.reshape(3, ROLLERS) - races[:, None]), 15.5, atol=2e-4)
    total, forces = 0j, np.zeros(3, dtype=complex)
    for contact in scene["contacts"]:
        if contact["kind"] == "roller_inner":
            continue
        at, to, load = complex(*contact["at"]), complex(*contact["to"]), contact["models"]["half-space"][0]
        total += load * to
        if contact["kind"] == "roller_outer":
            _, crank, _, roller, _ = contact["name"].replace(",", "").split()
            own = int(crank)
            assert abs(at - rollers[ROLLERS * own + int(roller)]) == pytest.approx(2.5, abs=3e-4)
            # where the roller reaches it, the wall of the bore: off by the approach of some micrometres
            assert abs(at - disc - turn * bores[own]) == pytest.approx(18.004, abs=0.05)
            forces[own] += load * to
    assert abs(total) < 5.0  # directions have four digits, and loads some 10 kN in sum
    along = forces * np.exp(-1j * ANGLE)
    answer = compared.full.answer
    np.testing.assert_allclose(along.real, answer.bearing_radial, atol=5.0)
    np.testing.assert_allclose(along.imag, answer.bearing_tangential, atol=5.0)
    titles = [line["title"] for line in scene["totals"]]
    assert titles.count("bearing of crank 2, tangential, N") == 1
    assert "loaded shaft pins" not in titles
    line = scene["totals"][titles.index("bearing of crank 2, tangential, N")]
    assert line["models"]["half-space"] == pytest.approx(answer.bearing_tangential[2], rel=1e-4)


@pytest.mark.slow
def test_what_a_disc_without_shaft_pins_changes_leaves_them_out(crank_study, tmp_path):
    effect, compared = crank_study.flexibility["nominal"], crank_study.compared["nominal"]
    assert np.isnan(effect.turn["fe"].max_pin_shaft_load)
    assert set(effect.by_torque[1.0]) == {"max_pin_load", "max_roller_load"}
    rows = flexibility_rows("nominal", effect)
    assert len(rows) == 2 * 7 + 2
    assert not any("shaft" in row.quantity for row in rows)
    assert set(full_solution_changes(compared)) == {"pin_load", "roller_load"}
    assert not any("shaft pin" in sentence for sentence in judge_half_space({"nominal": effect}))
    assert turn_content(effect)["fe"]["max_pin_shaft_load"] is None
    page = write_report(crank_study, tmp_path / "report.html").read_text(encoding="utf-8")
    assert "largest load of a shaft pin" not in page
    assert "bearing of crank 2" in page


@pytest.mark.slow
def test_power_balance_of_several_cranks(drive):
    (row,) = power_rows(drive)
    assert row.quantity.endswith("sum of all cranks")
    # 400 N·m on the carrier; the housing bears (i − 1)/i of it, i = 1 + 2·12; its work per crank angle is over z_P.
    assert row.reference == pytest.approx(400e3 * 24.0 / 25.0 / (12.0 * 4.0), rel=1e-3)
    assert row.passed, row.difference


def test_models_agree_without_shaft_pins(drive):
    assert not failed_rows(_uncoupled(drive, "nominal", np.array([ANGLE])))


def test_cranks_are_planned_and_clearance_of_supports_refused(drive):
    file = load_drive("paper")
    plan = plan_study(replace(file, cases={"nominal": drive}), None, [ANGLE], "quick", SolutionOptions())
    assert plan.drives == {"nominal": drive}
    support = parse_drive(shipped_drive("rv"), "rv").cases["nominal"].crank.support
    yielding = replace(drive, crank=replace(drive.crank, support=support))
    assert plan_study(replace(file, cases={"nominal": yielding}), None, [ANGLE], "quick", SolutionOptions()).drives
    loose = replace(drive, crank=replace(drive.crank, support=replace(support, clearance=0.01)))
    with refused_field("crank.support.clearance"):
        plan_study(replace(file, cases={"nominal": loose}), None, None, "quick", SolutionOptions())
