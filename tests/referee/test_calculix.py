"""The same problem by CalculiX (CPE6, surface-to-surface penalty): loads, pressures, wheel angle."""

import shutil

import numpy as np
import pytest

from fem.drive.solution import solve_drive
from fem.referee.calculix import ask_calculix
from fem.referee.calculix_deck import pair_name, write_deck
from ltca.errors import CycloError
from ltca.reading.drive_file import load_drive

pytestmark = [
    pytest.mark.referee,
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed (apt install calculix-ccx)"),
]


def test_full_drive(tmp_path):
    """Elements of four times the default size, the same in both codes; the full-size comparison is benchmarks/fem.py --ccx.

    CS-6: offsets, play in the bearing and the holes, four pins loaded, a little fewer iterations than CS-1 takes.
    """
    solution = solve_drive(load_drive("paper").cases["CS-6"], 0.5, scale=4.0)
    answer = ask_calculix(solution, write_deck(solution, tmp_path / "drive.inp"), "ccx")
    largest = {}
    for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True):
        largest[pair.kind] = max(largest.get(pair.kind, 0.0), detail.load)
    for pair, detail in zip(solution.model.pairs, solution.contacts.details, strict=True):
        theirs = answer.load.get(pair_name(pair), 0.0)
        assert abs(detail.load - theirs) < 5e-3 * largest[pair.kind], pair_name(pair)
    # 0.3″ of the wheel is 0.13 µm at the pins: the penalty gives way by a fifth of that.
    assert np.degrees(solution.pose.wheel_angle - answer.wheel_angle) * 3600.0 == pytest.approx(0.0, abs=0.3)


def test_failure_of_ccx_is_one_error(tmp_path):
    from fem.referee.calculix import run_calculix

    (tmp_path / "broken.inp").write_text("*ELEMENT, TYPE=CPE6\n1,1,2,3,4,5,6\n", encoding="ascii")
    with pytest.raises(CycloError, match="ccx failed"):
        run_calculix(tmp_path / "broken.inp", "ccx")
