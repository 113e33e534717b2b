"""Cases that are analysed as rows of one batch answer what each answers alone."""

from __future__ import annotations

import numpy as np
import pytest
from refusals import error_says

from ltca.analysis.engines import HalfSpace
from ltca.analysis.loaded_analysis import analyse, analyse_cases
from ltca.analysis.summary import summarise, summarise_cases
from ltca.errors import ConvergenceError, DriveError
from ltca.geometry.placement import position_angles
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive, parse_drive, shipped_drive

ANGLES = position_angles(6)


def shipped(name):
    return next(iter(parse_drive(shipped_drive(name), name).cases.values()))


def assert_same(together, alone):
    for state in ("full", "light"):
        mine, theirs = getattr(together, state), getattr(alone, state)
        # Both end at a residual of 1e-9 of the load on stiffnesses of 1e5 N/mm and more.
        np.testing.assert_allclose(mine.pose, theirs.pose, rtol=0.0, atol=1e-11)
        for name in ("pin_load", "hole_load"):
            expected = getattr(theirs.response, name)
            bound = 1e-8 * max(expected.max(initial=0.0), theirs.response.pin_load.max())
            np.testing.assert_allclose(getattr(mine.response, name), expected, rtol=0.0, atol=bound)
    np.testing.assert_array_equal(together.balanced, alone.balanced)
    assert together.drive == alone.drive
    assert together.torque == alone.torque


def cases_of_the_paper():
    return load_drive("paper").cases


def cases_held_at_the_wheel():
    """Two discs, the wheel held: what holds it is found for each case by itself; one torque is that of another case."""
    drive = shipped("robot-joint")
    return {
        "a": drive,
        "b": with_fields(drive, {"disc.shifting_offset": drive.disc.shifting_offset + 0.001}),
        "c": with_fields(drive, {"load.torque": 0.5 * drive.load.torque, "load.light_torque": drive.load.light_torque}),
        "d": drive,
    }


def cases_of_other_kinds():
    """Numbers of parts, friction and temperature differ: some share a batch, others stand alone."""
    paper = load_drive("paper").cases["CS-2"]
    return {
        "plain": paper,
        "more pins": shipped("rv"),
        "rubs": with_fields(paper, {"friction.pin": 0.05, "friction.hole": 0.05}),
        "rubs, too": with_fields(paper, {"friction.pin": 0.05, "friction.hole": 0.05, "clearance.bearing": 0.02}),
        "warm": with_fields(paper, {"temperature.disc": 60.0}),
    }


@pytest.mark.parametrize(
    "cases",
    [
        cases_of_the_paper,
        *(pytest.param(one, marks=pytest.mark.slow) for one in (cases_held_at_the_wheel, cases_of_other_kinds)),
    ],
)
def test_cases_together_are_those_alone(cases):
    drives = cases()
    found = dict(analyse_cases(drives, ANGLES))
    assert list(found) == list(drives)
    for name, drive in drives.items():
        assert_same(found[name], analyse(drive, ANGLES))


def test_cases_of_discs_in_other_planes_share_a_batch():
    """Drives that differ in the planes of their discs and in no length of the residual broke a batch with a ValueError."""
    drive = shipped("rv")
    cases = {str(plane): with_fields(drive, {"disc.planes": (-plane, plane)}) for plane in (9.0, 10.0)}
    angle = ANGLES[:1]
    for name, together in analyse_cases(cases, angle):
        assert_same(together, analyse(cases[name], angle))


@pytest.mark.slow
def test_cases_from_poses_of_a_drive_near_by_are_those_from_first_contact():
    """Whatever the search starts from it ends at a residual of 1e-9 of the load; drives with other coordinates start anew."""
    drives = {**cases_held_at_the_wheel(), "more pins": shipped("rv")}
    near = analyse(with_fields(drives["a"], {"clearance.bearing": 0.0}), ANGLES)
    for name, found in analyse_cases(drives, ANGLES, near=near):
        assert_same(found, analyse(drives[name], ANGLES))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cases", "names"),
    [
        (cases_of_the_paper, ("CS-1", "CS-5")),
        pytest.param(cases_held_at_the_wheel, "ab", marks=pytest.mark.nightly),
        pytest.param(cases_of_other_kinds, None, marks=pytest.mark.nightly),
    ],
)
def test_summaries_together_are_those_alone(cases, names):
    """Positions between those of a turn end at a residual of 1e-9 of the load, up to 1e-5 N: so far their extremes may differ."""
    drives = {name: drive for name, drive in cases().items() if names is None or name in names}
    analyses = dict(analyse_cases(drives, position_angles(8)))
    found = summarise_cases(analyses)
    assert list(found) == list(analyses)
    for name, analysis in analyses.items():
        alone = summarise(analysis)
        assert list(found[name]) == list(alone)
        assert {key for key, value in alone.items() if value is None} == {
            key for key, value in found[name].items() if value is None
        }
        for key, value in alone.items():
            assert value is None or found[name][key] == pytest.approx(value, rel=1e-7, abs=1e-5), key


@pytest.mark.slow
def test_a_case_without_an_answer_costs_the_others_nothing(monkeypatch):
    drive = load_drive("paper").cases["CS-2"]
    # Less than round-off of the approaches makes of the loads: refused in a file, let through here.
    monkeypatch.setattr("ltca.reading.member_checks.torque_problem", lambda *_, **__: ())
    lost = with_fields(drive, {"load.torque": 2e-5, "load.light_torque": 1e-5})
    found = dict(analyse_cases({"sound": drive, "lost": lost, "light": drive}, ANGLES[:2]))
    assert isinstance(found["lost"], ConvergenceError)
    for name in ("sound", "light"):
        assert_same(found[name], analyse(drive, ANGLES[:2]))


def test_a_torque_that_cannot_be_carried_is_refused_by_its_case():
    drive = load_drive("paper").cases["CS-2"]
    with error_says(DriveError, "load.torque = 1e+08"):
        list(analyse_cases({"sound": drive, "heavy": with_fields(drive, {"load.torque": 1e8})}, ANGLES))


@pytest.mark.slow
def test_engines_that_take_no_batch_go_case_by_case():
    drives = {"a": load_drive("paper").cases["CS-1"], "b": load_drive("paper").cases["CS-2"]}
    for name, found in analyse_cases(drives, ANGLES[:1], engine=HalfSpace(method="direct")):
        assert_same(found, analyse(drives[name], ANGLES[:1], engine=HalfSpace(method="direct")))
