"""``tables``, ``direct`` and ``paper`` give one answer; figures asked for by issue 3, part 2."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import error_is

import validation.methods.paper_method
from ltca.analysis import methods
from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse
from ltca.commands.program import main
from ltca.compliance.half_space import HalfSpaceCompliance
from ltca.drive.parts import LengthProfile, Material
from ltca.equilibrium.balance import solve_equilibrium
from ltca.equilibrium.reducer import Reducer
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.placement import position_angles
from ltca.reading.drive_file import load_drive
from validation.methods.grids import GridCompliance
from validation.methods.paper_method import lead_of_pose, pose_of_lead, solve_paper_equilibrium

CASES = load_drive("paper").cases


def loads(contacts):
    return contacts.pin_load, contacts.rollers.outer_load, contacts.rollers.inner_load, contacts.hole_load


def apart(first, second):
    """Largest difference of loads as a part of the largest of their kind."""
    return max(np.max(np.abs(a - b)) / np.max(a) for a, b in zip(loads(first), loads(second), strict=True))


def pressures_apart(first, second):
    pairs = [(first.pins, second.pins), (first.outer, second.outer), (first.inner, second.inner)]
    return max(np.max(np.abs(a.mid - b.mid)) / np.max(a.mid) for a, b in pairs)


def compare_direct(drive, angles):
    tables, direct = analyse(drive, angles), analyse(drive, angles, engine=HalfSpace(method="direct"))
    # The issue asks for 0.1 % and 0.5 %; 12 cells per half-width leave 0.013 % and 0.12 %.
    assert apart(tables.full.response, direct.full.response) < 1e-3
    assert pressures_apart(tables.pressures, direct.pressures) < 5e-3
    return tables, direct


def test_direct_agrees_with_tables():
    """With a material of its own for every body, so that no contact can borrow that of another."""
    materials = replace(
        CASES["CS-3"].materials,
        disc=Material(youngs_modulus=110e3, poisson_ratio=0.28),
        wheel_pin=Material(youngs_modulus=310e3, poisson_ratio=0.26),
        inner_race=Material(youngs_modulus=72e3, poisson_ratio=0.34),
    )
    compare_direct(replace(CASES["CS-3"], materials=materials), np.array([0.4]))


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [case if case in ("CS-1", "CS-6") else pytest.param(case, marks=pytest.mark.nightly) for case in CASES]
)
def test_direct_agrees_with_tables_in_six_cases(case):
    compare_direct(CASES[case], position_angles(8) + 0.1)


@pytest.mark.nightly
@pytest.mark.slow
def test_grid_halved():
    """Mid pressure moves by less than 0.3 %, load by less than 0.05 % (measured 0.04 %, 0.01 %)."""
    drive, angle = CASES["CS-3"], np.array([0.4, 2.0])
    near = solve_equilibrium(Reducer(discs=(HalfSpaceCompliance.of_drive(drive),)), angle, drive.wheel_moment())
    coarse, fine = (GridCompliance.of_drive(drive, cells) for cells in (12, 24))
    first = solve_equilibrium(Reducer(discs=(coarse,)), angle, drive.wheel_moment(), near.pose).response
    second = solve_equilibrium(Reducer(discs=(fine,)), angle, drive.wheel_moment(), near.pose).response
    assert apart(second, first) < 5e-4
    assert pressures_apart(fine.pressures(second.parts[0]), coarse.pressures(first.parts[0])) < 3e-3


@pytest.mark.slow
@pytest.mark.family(full=2)
@pytest.mark.parametrize("case", CASES)
def test_paper_agrees_on_the_same_law(case):
    """The issue asks for 0.01 %; both end at the same residual, so they agree to 1e-8."""
    angles = position_angles(12) + 0.05
    ours, theirs = analyse(CASES[case], angles), analyse(CASES[case], angles, engine=HalfSpace(method="paper"))
    assert apart(ours.full.response, theirs.full.response) < 1e-7
    assert apart(ours.light.response, theirs.light.response) < 1e-6
    np.testing.assert_array_equal(theirs.full.crank_angle, angles)
    np.testing.assert_allclose(theirs.full.pose, ours.full.pose, rtol=0.0, atol=1e-9)
    assert np.all(theirs.full.iterations > 0)


@pytest.mark.slow
def test_paper_on_grids_agrees_with_direct():
    drive, angle = CASES["CS-1"], np.array([0.9])
    direct = analyse(drive, angle, engine=HalfSpace(method="direct"))
    theirs = analyse(drive, angle, engine=HalfSpace(method="paper", contacts="grids"))
    assert theirs.engine.contacts == "grids"
    # Loads follow from the pose alone; the paper's finite-difference tangents end at the same residual.
    assert apart(direct.full.response, theirs.full.response) < 1e-7


def test_paper_answers_at_the_actual_crank_angle():
    """Held wheel and lead map to the requested angle; without the correction it would be 1.2° to 1.7° off."""
    drive, angle = CASES["CS-3"], np.array([0.3, 2.2])
    model = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),))
    found = solve_equilibrium(model, angle, drive.wheel_moment())
    wheel, unknowns = lead_of_pose(model, angle, found.pose)
    actual, pose = pose_of_lead(model, wheel, unknowns)
    np.testing.assert_allclose(actual, angle, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(pose, found.pose, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(unknowns[:, 3], -14.0 * found.pose[:, 3], rtol=1e-14)
    assert np.all(np.degrees(unknowns[:, 3]) > 1.0)
    assert np.all(np.degrees(unknowns[:, 3]) < 2.0)


def test_paper_fails_loudly_from_a_floating_start(monkeypatch, tmp_path, capsys):
    """From the ideal pose nothing touches and the tangent is singular: ConvergenceError, exit status 2."""
    drive = CASES["CS-6"]
    model = Reducer(discs=(HalfSpaceCompliance.of_drive(drive),))
    with pytest.raises(ConvergenceError, match="iteration of the paper fails") as caught:
        solve_paper_equilibrium(model, np.array([0.3]), drive.wheel_moment(), np.zeros((1, 4)))
    assert "singular tangent" in str(caught.value)
    monkeypatch.setattr(
        validation.methods.paper_method, "solve_equilibrium", lambda model, angle, moment, start: _Floating
    )
    command = ["run", "paper", "--case", "CS-6", "--positions", "1", "--method", "paper", "--out", str(tmp_path)]
    assert main(command) == 1
    assert "the iteration of the paper fails at crank angle 0 rad" in capsys.readouterr().err


class _Floating:
    pose = np.zeros((1, 4))


@pytest.mark.parametrize(
    ("engine", "told"),
    [
        (HalfSpace(method="direct"), "method = direct on contacts = grids"),
        (HalfSpace(method="paper", contacts="grids"), "method = paper on contacts = grids"),
        (HalfSpace(method="paper"), "method = paper"),
    ],
)
def test_methods_without_their_package_are_refused_by_name(engine, told, monkeypatch):
    monkeypatch.setattr(methods, "entry_points", lambda group: ())
    with error_is(DriveError, f"{told}: comes with the package validation, which is not installed"):
        engine.prepare(CASES["CS-1"])


def test_methods_and_contacts_that_contradict_each_other():
    with pytest.raises(DriveError, match="method tables runs on tables"):
        HalfSpace(contacts="grids")


def test_flank_pressure_of_cs3_against_cs1():
    """At mid-width +3.4 %, at the unrelieved ends less than half as much more; contact moves toward the tip.

    The print says about +1 %. At the positions of largest load the end peaks grow by 1.9, 1.5, 1.1 % with end cells of
    1, 0.5, 0.2 % of the length: reading the largest value of a grid with fine end cells would give what is printed.
    The paper does not say which value it reads.
    """
    angles = position_angles(180)
    first, third = (analyse(CASES[case], angles) for case in ("CS-1", "CS-3"))
    mid = np.max(third.pressures.pins.mid) / np.max(first.pressures.pins.mid) - 1.0
    largest = np.max(third.pressures.pins.largest) / np.max(first.pressures.pins.largest) - 1.0
    assert 0.01 < mid < 0.05
    assert 0.01 < largest < 0.02
    assert largest < 0.6 * mid
    tooth = 2.0 * np.pi / 13.0
    places = []
    for analysis in (first, third):
        top = np.unravel_index(np.argmax(analysis.pressures.pins.mid), analysis.pressures.pins.mid.shape)
        theta = analysis.full.response.flank.parameter[top] % tooth
        places.append(min(theta, tooth - theta))
    assert places[1] > places[0] + 0.002  # rad of the parameter from the root; measured 0.006


@pytest.mark.slow
def test_relieved_rollers_direct_agrees_with_tables():
    """A logarithmic profile through its table and through grids."""
    drive = CASES["CS-1"]
    bearing = replace(drive.crank_bearing, roller_profile=LengthProfile(logarithmic_factor=1.0))
    drive = replace(drive, crank_bearing=bearing)
    angle = np.array([0.4])
    tables, direct = analyse(drive, angle), analyse(drive, angle, engine=HalfSpace(method="direct"))
    assert apart(tables.full.response, direct.full.response) < 1e-3
    assert pressures_apart(tables.pressures, direct.pressures) < 5e-3
    straight = analyse(CASES["CS-1"], angle)
    assert np.max(np.abs(straight.full.pose - tables.full.pose)) > 1e-4  # the profile is not ignored
