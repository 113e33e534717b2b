"""The same problem by CalculiX (CPE6, surface-to-surface penalty): loads, pressures, wheel angle."""

import numpy as np
import pytest

from fem.drive.solution import solve_drive
from fem.options import SolutionOptions
from fem.referee.calculix import ask_calculix, load_differences
from fem.referee.calculix_deck import write_deck
from ltca.errors import CycloError
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

pytestmark = [
    pytest.mark.needs("calculix"),
    pytest.mark.slow,
]


# Of bronze, so that the pins' material is not that of all other bodies.
ELASTIC = {"pin_shaft.elastic_contact": True, "materials.shaft_pin.youngs_modulus": 110_000.0}


@pytest.mark.parametrize(
    ("fields", "angle", "scale"),
    [
        pytest.param(ELASTIC, 0.7, 7.0, id="elastic", marks=pytest.mark.nightly),
        pytest.param(ELASTIC, 0.5, 4.0, id="elastic, finer", marks=pytest.mark.nightly),
        pytest.param({}, 0.5, 4.0, id="rigid", marks=pytest.mark.nightly),
    ],
)
def test_full_drive(fields, angle, scale, tmp_path):
    """Elements of some times the default size, the same in both codes; the default size is a test of its own.

    Nightly, for CalculiX takes 25 s on any mesh that is fine enough: of every full run are the answers that it left of such a
    drive (`tests/validation/levels/test_other_codes.py`) and, of elastic pins, `tests/fem/drive/test_elastic_contact.py`.
    CS-6: offsets, play in the bearing and the holes, four pins loaded, a little fewer iterations than CS-1 takes. With seven
    times the size, in half of the time that four times take, loads are 0.4 % apart at worst, the wheel 0.12″.
    """
    solution = solve_drive(with_fields(load_drive("paper").cases["CS-6"], fields), angle, SolutionOptions(size=scale))
    answer = ask_calculix(solution, write_deck(solution, tmp_path / "drive.inp"), "ccx")
    for name, difference in load_differences(solution, answer).items():
        assert abs(difference) < 5e-3, name
    # 0.3″ of the wheel is 0.13 µm at the pins: the penalty gives way by a quarter of that.
    assert np.degrees(solution.pose.wheel_angle - answer.wheel_angle) * 3600.0 == pytest.approx(0.0, abs=0.3)


@pytest.mark.nightly
def test_the_default_size(tmp_path):
    """CalculiX ended there with contacts that pull; three minutes of processor time."""
    solution = solve_drive(load_drive("paper").cases["CS-1"], 0.5)
    answer = ask_calculix(solution, write_deck(solution, tmp_path / "drive.inp"), "ccx")
    # 0.036 % with eight elements for each half-width; 0.18 % with two.
    assert max(map(abs, load_differences(solution, answer).values())) < 1e-3
    # The penalty gives way by 0.08″; the rest, 0.01″, is the mesh's.
    assert np.degrees(solution.pose.wheel_angle - answer.wheel_angle) * 3600.0 == pytest.approx(0.08, abs=0.05)


def test_failure_of_ccx_is_one_error(tmp_path):
    from fem.referee.calculix import run_calculix

    (tmp_path / "broken.inp").write_text("*ELEMENT, TYPE=CPE6\n1,1,2,3,4,5,6\n", encoding="ascii")
    with pytest.raises(CycloError, match="ccx failed"):
        run_calculix(tmp_path / "broken.inp", "ccx")
