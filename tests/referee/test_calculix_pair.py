"""A pair of solid bodies by CalculiX, C3D20R on the same mesh: load and largest pressure, aligned and tilted."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fem.referee.calculix_deck import find_calculix
from fem.referee.calculix_pair import ask_about_pair, referee_rows, tabulate_referee, write_pair_deck
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.solved_pair import PairLoad, PairMeshes, solve_pair
from ltca.drive.parts import Material
from ltca.errors import CycloError

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)

pytestmark = [
    pytest.mark.needs("calculix"),
    pytest.mark.slow,
    pytest.mark.nightly,
]


@pytest.mark.parametrize("tilt", [0.0, 5e-4])
def test_a_crowned_pair_on_the_same_mesh(tilt, tmp_path):
    """Issue 31: load 0.3 %, pressure 2 %; 14 to 30 layers of elements keep CalculiX at a minute."""
    pair = SolidPair.round_bodies(10.0, 0.0, STEEL, 4.0, relief=lambda z: z**2 / 800.0)
    solved = solve_pair(pair, PairLoad(load=800.0, tilt=tilt), PairMeshes(size=3.0, block=3.0))
    answer = ask_about_pair(solved, tmp_path / "pair.inp", find_calculix())
    assert answer.load == pytest.approx(solved.load, rel=0.003)
    assert answer.largest == pytest.approx(answer.own_largest, rel=0.02)
    assert answer.faces >= 5
    assert any("C3D20R" in line for line in tabulate_referee(solved, answer))


def test_a_soft_body_on_a_hard_one_in_a_hollow(tmp_path):
    """Issue 31, the same bounds where points slide along each other: p/E is some per cent."""
    pair = SolidPair.round_bodies(1.0, 0.4, Material(youngs_modulus=2700.0, poisson_ratio=0.35), 2.0)
    pair = replace(pair, opposite_material=STEEL)
    solved = solve_pair(pair, PairLoad(load=50.0), PairMeshes(size=2.0, block=1.0))
    answer = ask_about_pair(solved, tmp_path / "pair.inp", find_calculix())
    assert all(row.passed for row in referee_rows(solved, answer))
    # In the middle faces have fewer points than further out, and are compared all the same.
    assert answer.own_largest > 0.95 * solved.largest_pressure


def test_rigid_bodies_are_refused(tmp_path):
    pair = SolidPair.round_bodies(10.0, 0.0, STEEL, 1.0)
    solved = solve_pair(replace(pair, opposite_material=None), PairLoad(load=100.0), PairMeshes(size=8.0, block=1.0))
    with pytest.raises(CycloError, match="the body opposite is rigid"):
        write_pair_deck(solved, tmp_path / "pair.inp")
