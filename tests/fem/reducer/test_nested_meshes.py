"""Nested meshes of a drive: one family of meshes, equilibrium on each, error bars that hold, files, print, page, refusals."""

import argparse
import json
from dataclasses import replace

import numpy as np
import pytest
from refusals import error_says

from fem.commands import fem as command
from fem.errors import MemoryLimitError, MeshError
from fem.options import SolutionOptions
from fem.reducer import nested_meshes
from fem.reducer.nested_meshes import solve_nested
from fem.reducer.solution import POSE_TOLERANCE, settle_pose, solve_reducer, solve_refined
from fem.reducer.solution_files import summarise
from ltca.errors import CycloError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

ANGLE = 0.5
COARSE = SolutionOptions(size=6.0, growth=0.5)


def run(*words):
    parser = argparse.ArgumentParser()
    command.configure(parser)
    return command.execute(parser.parse_args(words))


@pytest.mark.slow
def test_refined_meshes_of_a_drive(paper_cases):
    """Four elements for one, the same contacts, twice the pressure unknowns, equilibrium, the wheel moved by little."""
    drive = paper_cases["CS-1"]
    coarse = settle_pose(solve_reducer(drive, ANGLE, COARSE))
    fine = solve_refined(drive, coarse.torque, coarse.coarse)
    before, after = (solution.discs[0].model for solution in (coarse, fine))
    assert after.meshes.disc.mesh.nelements == 4 * before.meshes.disc.mesh.nelements
    assert [(pair.kind, pair.index) for pair in after.pairs] == [(pair.kind, pair.index) for pair in before.pairs]
    for old, new in zip(before.pairs, after.pairs, strict=True):
        # Edges whose middle is within the reach: one more or less at either end.
        assert abs(new.zone.edge_count - 2 * old.zone.edge_count) <= 2
    for solution in (coarse, fine):
        assert solution.discs[0].state.increments[-1] <= POSE_TOLERANCE
        assert solution.equilibrium_residual < 1e-6
        assert solution.wheel_moment == pytest.approx(drive.wheel_moment(), rel=1e-12)
    assert fine.discs[0].options.refined_size == 3.0
    assert summarise(fine)["size"] == 3.0
    # Wind-up 465″; elements of one to a half-width leave less than half a per cent of it, and it is not zero.
    assert 0.0 < abs(fine.wheel_angle / coarse.wheel_angle - 1.0) < 5e-3


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("name", ["rv", "ring", "held"])
def test_other_drives_are_refined(name, paper_cases):
    """Several cranks and discs with the wheel held; an elastic ring: moments in balance, discs at one wheel angle."""
    changes = {
        "ring": {"ring": {"inner_radius": 87.0, "outer_radius": 105.0, "width": 20.0, "model": "fe"}},
        "held": {"installation.held": "pin-wheel", "disc.number_of_discs": 2},
    }
    rv = load_drive("rv").cases["nominal"]
    rigid = replace(rv, crank=replace(rv.crank, support=None))
    drive = rigid if name == "rv" else with_fields(paper_cases["CS-1"], changes[name])
    coarse = settle_pose(solve_reducer(drive, ANGLE, COARSE))
    fine = solve_refined(drive, coarse.torque, coarse.coarse)
    assert np.ptp([disc.pose.wheel_angle for disc in fine.discs]) <= 1e-9
    assert fine.wheel_moment == pytest.approx(coarse.wheel_moment, rel=1e-3)
    assert fine.wheel_angle == pytest.approx(coarse.wheel_angle, rel=1e-2)
    assert fine.wheel_angle != coarse.wheel_angle


@pytest.fixture(scope="module")
def folder(tmp_path_factory, paper_cases):
    out = tmp_path_factory.mktemp("error")
    words = ("paper", "--case", "CS-1", "--angle", "0.5", "--size", "3", "--error", "--out", str(out))
    assert run(*words) == 0
    return out


@pytest.mark.slow
@pytest.mark.nightly
def test_error_bars_of_the_command(folder, paper_cases):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    error = summary["error"]
    assert [mesh["size"] for mesh in error["meshes"]] == [6.0, 3.0, 1.5]
    assert summary["size"] == 1.5
    figures = {(figure["quantity"], figure["place"]): figure for figure in error["figures"]}
    wheel = figures["wheel_angle", None]
    assert wheel["values"][-1] == summary["wheel_angle_rad"]
    # On the same mesh the middle value; theory gives the order 3, two elements to a half-width scatter by one.
    assert abs(wheel["values"][1] - wheel["values"][2]) > 0.0
    assert 2.0 < wheel["observed_order"] < 4.0
    # Another family with a third of the edges of the middle mesh leaves less than twice its error: where ends of contacts lie in
    # their edges differs.
    other = solve_reducer(paper_cases["CS-1"], ANGLE, SolutionOptions(size=1.0))
    of_middle = abs(wheel["values"][1] - wheel["values"][2]) + wheel["error_bar"]
    assert abs(other.wheel_angle - wheel["values"][2]) <= 2.0 * of_middle
    pins = [figure for (name, _), figure in figures.items() if name == "pin_load"]
    assert max(figure["values"][-1] for figure in pins) == max(summary["pin_load_N"][0])
    for name in ("roller_load", "pin_shaft_load", "pin_pressure_mid", "root_stress", "bore_stress", "hole_stress"):
        assert any(quantity == name and figure["error_bar"] > 0.0 for (quantity, _), figure in figures.items())
    assert all(reference["within_error_bar"] for reference in error["closed_forms"])
    page = (folder / "report.html").read_text(encoding="utf-8")
    for words in ("Error bars", "observed order", "Kirsch", "numerical uncertainty alone"):
        assert words in page


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--meshes", "3"), "--meshes 3: has no meaning without --error"),
        (("--error", "--referee", "calculix"), "--referee calculix: does not go with --error"),
        (("--error", "--export", "calculix"), "--export calculix: does not go with --error"),
    ],
)
def test_refusals_name_the_option(words, told, tmp_path):
    with error_says(CycloError, told):
        run("paper", "--angle", "0.5", "--out", str(tmp_path / "out"), *words)
    assert not (tmp_path / "out").exists()


def test_number_of_meshes_is_bounded(paper_cases):
    with pytest.raises(MeshError, match="2 nested meshes: must be 3 to 5"):
        solve_nested(paper_cases["CS-1"], ANGLE, meshes=2)


@pytest.mark.slow
def test_memory_of_the_finest_is_told_from_the_coarsest(paper_cases, monkeypatch):
    """Refused before anything is refined, with the need in the message."""
    told = []
    monkeypatch.setattr("fem.mesh.memory_need.available_memory", lambda: 1.0e9)
    monkeypatch.setattr(nested_meshes, "solve_refined", lambda *_: pytest.fail("refined without memory"))
    with error_says(MemoryLimitError, starts="the finest of the nested meshes would have about"):
        solve_nested(paper_cases["CS-1"], ANGLE, SolutionOptions(size=3.0), progress=told.append)
    assert told
