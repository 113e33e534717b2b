"""Finished positions are kept and used again; whatever does not fit is solved again. No finite elements here."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

import validation.compare.finite_element_positions as kept
from fem.body.wall_stress import WallStress
from fem.drive.disc_stress import DiscStress
from fem.options import SolutionOptions
from ltca.errors import ConvergenceError
from validation.compare.finite_element_positions import solve_positions

ANGLE = 0.5


def summary_of(drive, angle):
    rng = np.random.default_rng(5)
    content = {
        "crank_angle_rad": angle, "wheel_angle_rad": -2e-3, "bearing_radial_N": 5e3, "bearing_tangential_N": 6.7e3,
        "disc_displacement": {"x_mm": -0.01, "y_mm": -0.02, "rotation_rad": 4e-4},
        "equilibrium_residual_N": 1e-10, "dof": 1234, "seconds": 3.25,
    }  # fmt: skip
    counts = {"pin": 14, "pin_shaft": 8, "roller": 11}
    for name in ("pin_load", "pin_shaft_load", "roller_load_outer", "roller_load_inner"):
        count = counts[name.split("_load")[0]]
        pressure = name.replace("load", "pressure_max")
        for key in (f"{name}_N", f"{pressure}_MPa", f"{name.replace('load', 'half_width')}_mm"):
            content[key] = [rng.uniform(0.0, 3e3, count).tolist()]  # by disc
    return content


def stress_of(solution):
    wall = WallStress(
        name="flank", parameter=np.array([0.0, 1.0]), points=np.array([1.0, 1j]), stress=np.array([3.0, 0.1])
    )
    return DiscStress(
        walls=(wall,) * 10, clear=(np.array([True, False]),) * 10, root_stress=np.array([3.0, np.nan]), bore_stress=1.5,
        hole_stress=np.ones(8), pin_shear_max=np.arange(14.0), roller_shear_max_outer=np.zeros(11),
        pin_shaft_shear_max=np.zeros(8),
    )  # fmt: skip


@pytest.fixture
def solved(monkeypatch):
    """Replace the solver by one that counts its calls."""
    calls = []

    def solve(drive, crank_angle, options, *, rounds, progress):
        calls.append((crank_angle, options.size, options.plane, rounds))
        return SimpleNamespace(discs=(None,), drive=drive, crank_angle=crank_angle, rounds=(crank_angle,))

    monkeypatch.setattr(kept, "solve_reducer", solve)
    monkeypatch.setattr(kept, "summarise", lambda solution: summary_of(solution.drive, solution.crank_angle))
    monkeypatch.setattr(kept, "recover_disc_stress", stress_of)
    return calls


def test_a_finished_position_is_not_solved_again(solved, paper_cases, tmp_path):
    drive = paper_cases["CS-1"]
    (first,) = next(solve_positions(drive, "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    (again,) = next(solve_positions(drive, "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    assert len(solved) == 1
    assert first.seconds == again.seconds == 3.25
    for kind, own in first.answer.kinds.items():
        np.testing.assert_array_equal(own.load, again.answer.kinds[kind].load)
    # e-frame: (x + iy) e^(−iφ)
    along = complex(-0.01, -0.02) * np.exp(-1j * ANGLE)
    assert first.answer.disc_radial == pytest.approx(along.real)
    assert first.answer.disc_tangential == pytest.approx(along.imag)
    np.testing.assert_array_equal(again.stress.stress[0], [3.0, 0.1])
    np.testing.assert_array_equal(again.stress.clear[0], [True, False])
    # What is no number stays none through the file, where it is null.
    np.testing.assert_array_equal(again.stress.largest["flank"], [3.0, np.nan])
    np.testing.assert_array_equal(again.stress.shear["pin"], np.arange(14.0))


def test_in_a_series_pins_and_rollers_travel_and_files_are_those_of_positions_alone(solved, paper_cases, tmp_path):
    drive, said = paper_cases["CS-1"], []
    (tmp_path / "alone").mkdir(), (tmp_path / "series").mkdir()
    for angle in (0.1, 0.2, 0.3):
        next(solve_positions(drive, "CS-1", [angle], tmp_path / "alone", SolutionOptions()))
    (tmp_path / "series" / next((tmp_path / "alone").glob("*_0.2*")).name).write_bytes(
        next((tmp_path / "alone").glob("*_0.2*")).read_bytes()
    )
    solved.clear()
    found = list(
        solve_positions(drive, "CS-1", (0.1, 0.2, 0.3), tmp_path / "series", SolutionOptions(), begin=said.append)
    )
    # The one kept is not solved again and passes on what came before it.
    assert [(call[0], call[3]) for call in solved] == [(0.1, ()), (0.3, (0.1,))]
    assert [position.crank_angle for (position,) in found] == [0.1, 0.2, 0.3]
    assert said == [f"full FE of CS-1 at {angle} rad" for angle in (0.1, 0.2, 0.3)]
    for path in (tmp_path / "alone").iterdir():
        assert (tmp_path / "series" / path.name).read_bytes() == path.read_bytes()


def test_another_drive_angle_or_setting_is_another_file(solved, paper_cases, tmp_path, vary):
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE + 1e-6], tmp_path, SolutionOptions()))
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions(size=2.0)))
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions(plane="stress")))
    next(solve_positions(paper_cases["CS-3"], "CS-3", [ANGLE], tmp_path, SolutionOptions()))
    next(solve_positions(vary(disc={"thickness": 12.0}), "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    assert len(solved) == 6
    assert len(list(tmp_path.glob("*.json"))) == 6


@pytest.mark.parametrize("damage", ["", "{", "[]", '{"key": 1}', "another version", "another code", "one digit"])
def test_damaged_or_foreign_files_are_solved_again(damage, solved, paper_cases, tmp_path):
    drive = paper_cases["CS-1"]
    next(solve_positions(drive, "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    path = next(tmp_path.glob("*.json"))
    text = path.read_text(encoding="utf-8")
    content = json.loads(text)
    if damage == "another version":
        content["key"]["version"] = "0.0.0"
    elif damage == "another code":
        content["key"]["code"] = "0" * 16
    elif damage == "one digit":
        content["summary"]["pin_load_N"][0][3] += 1.0
    damage = json.dumps(content) if damage.startswith(("another", "one")) else damage
    path.write_text(damage, encoding="utf-8")
    next(solve_positions(drive, "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    assert len(solved) == 2
    assert path.read_text(encoding="utf-8") == text


def test_what_older_code_kept_is_solved_again(solved, paper_cases, tmp_path, monkeypatch):
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    monkeypatch.setattr(kept, "code_hash", lambda *packages: "another")
    next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    assert len(solved) == 2


def test_a_failed_solution_leaves_nothing(monkeypatch, paper_cases, tmp_path):
    def fail(*words, **options):
        raise ConvergenceError("no", [1.0])

    monkeypatch.setattr(kept, "solve_reducer", fail)
    with pytest.raises(ConvergenceError):
        next(solve_positions(paper_cases["CS-1"], "CS-1", [ANGLE], tmp_path, SolutionOptions()))
    assert not list(tmp_path.iterdir())
