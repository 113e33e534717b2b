"""Nodes of a pair in the deck for CalculiX."""

from types import SimpleNamespace

import numpy as np
import pytest

from fem.referee.calculix_pair import face_means, write_pair_deck
from fem.solid_contact.pair_shapes import SolidPair
from fem.solid_contact.solved_pair import PairLoad, PairMeshes, solve_pair
from ltca.drive.parts import Material

STEEL = Material(youngs_modulus=210e3, poisson_ratio=0.3)


def nodes_of(deck, body):
    """Numbers and places of the nodes of a body, shape (nodes, 4)."""
    lines = deck.split(f"*NODE, NSET=N_{body}\n")[1].split("*")[0].splitlines()
    return np.array([[float(value) for value in line.split(",")] for line in lines])


@pytest.mark.parametrize("tilt", [0.0, 5e-4])
def test_the_body_opposite_is_round_crowned_and_in_the_loaded_pose(tilt, tmp_path):
    """R − √(R² − x²) + z²/160 less approach and tilt below; its far face is plane, what the crown takes fades up to there."""
    pair = SolidPair.round_bodies(10.0, 0.0, STEEL, 1.0, relief=lambda z: z**2 / 160.0)
    solved = solve_pair(pair, PairLoad(load=100.0, tilt=tilt), PairMeshes(size=8.0, block=1.0))
    deck = write_pair_deck(solved, tmp_path / "pair.inp").read_text(encoding="ascii")
    number, x, y, z = nodes_of(deck, 1).T
    assert np.unique(number).size == number.size
    into = solved.approach + solved.tilt * z
    assert (solved.tilt != 0.0) == (tilt != 0.0)
    y = y + into
    columns = set(zip(np.round(x, 9).tolist(), np.round(z, 9).tolist(), strict=True))
    for across, height in columns:
        own = np.sort(y[(np.abs(x - across) < 1e-8) & (np.abs(z - height) < 1e-8)])
        below = 10.0 - np.sqrt(100.0 - across**2)
        assert own[0] == pytest.approx(below + height**2 / 160.0, abs=1e-8)
        assert own[-1] == pytest.approx(1.0, abs=1e-8)
        assert np.all(np.diff(own) > 0.0)
    assert len({across for across, _ in columns}) >= 9


@pytest.mark.parametrize(
    ("symmetric", "even", "columns", "layers"), [(False, False, 4, 6), (True, False, 2, 6), (True, True, 2, 3)]
)
def test_means_over_faces_are_those_of_their_corners(symmetric, even, columns, layers):
    """Of a pressure that is bilinear they are its values in the middle; only faces that are in the deck count."""
    x, z = np.arange(5.0), np.arange(7.0)
    solved = SimpleNamespace(
        pressure=3.0 + 2.0 * x[:, None] + 0.5 * z + 0.25 * x[:, None] * z,
        pair=SimpleNamespace(symmetric=symmetric),
        width=SimpleNamespace(even=even),
    )
    x, z = x[:-1][-columns:] + 0.5, z[:-1][-layers:] + 0.5
    expected = 3.0 + 2.0 * x[:, None] + 0.5 * z + 0.25 * x[:, None] * z
    np.testing.assert_allclose(face_means(solved), expected, rtol=1e-14)
