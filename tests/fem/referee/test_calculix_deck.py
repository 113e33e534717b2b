"""What the deck asks of CalculiX's contact, without running it."""

from itertools import pairwise

import numpy as np
import pytest

from fem.drive.solution import solve_drive
from fem.referee.calculix_deck import PENALTY_FACTOR, write_deck
from ltca.reading.drive_file import load_drive


def values_after(lines, keyword):
    """The data line of every card with this keyword."""
    return [after for line, after in pairwise(lines) if line.startswith(keyword)]


@pytest.mark.slow
def test_the_penalty_gives_way_alike_on_every_mesh(tmp_path):
    """By the edge it was four times as stiff at the default size as at size 4, and ccx ended with contacts that pull there."""
    drive = load_drive("paper").cases["CS-1"]
    stiffness = {}
    for size in (6.0, 4.0):
        solution = solve_drive(drive, 0.5, scale=size)
        lines = write_deck(solution, tmp_path / "drive.inp").read_text(encoding="ascii").splitlines()
        found = np.array(values_after(lines, "*SURFACE BEHAVIOR"), dtype=float)
        width = np.array([pair.expected_half_width for pair in solution.model.pairs])
        # Written with six digits.
        assert found == pytest.approx(PENALTY_FACTOR * drive.materials.disc.youngs_modulus / width, rel=1e-5)
        stiffness[size] = found
        # The number of points that touch must stand still before an answer counts, and none is removed at random.
        (controls,) = values_after(lines, "*CONTROLS, PARAMETERS=CONTACT")
        change, at_random = map(float, controls.split(",")[:2])
        assert change == 0.0
        assert at_random == 0.0
    # The half-widths are those expected from the loads of a coarse solution: alike within a few per cent.
    assert stiffness[6.0] == pytest.approx(stiffness[4.0], rel=0.05)
