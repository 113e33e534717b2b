"""The figures of the headline: LTCA on FE coefficients against full FE, the paper's CS-1, default sizes.

`docs/validation/index.md` prints the worst of three cases at twelve angles. Of these the angles of CS-1 where `fe` is
farthest off in load (0.061 %) and in the wheel angle (0.071″), and `hybrid` in load (0.27 %) and wheel angle (−0.63″). Both
meshes and all else are fixed, so the figures are too; 0.02 % of load and 0.02″ are room for other mesh generators, and half of
what a formula that is a little wrong moves: the near field of a pin taken at an eighth of its turn in the place of a quarter
(0.04 % and 0.04″ of `hybrid`).
"""

from __future__ import annotations

import pytest

from fem.options import SolutionOptions
from validation.compare.compared_positions import compare_case
from validation.compare.derived_coefficients import coefficients_of
from validation.compare.finite_element_positions import solve_positions

pytestmark = [pytest.mark.slow, pytest.mark.nightly]

STEP = 0.04027682889217683
"""A twelfth of the period of positions, rad."""
ROOM = 0.02
"""Per cent of the largest load, and arc seconds."""


@pytest.fixture(scope="module")
def compared(paper_cases, tmp_path_factory):
    """Differences from full FE by angle, in steps."""
    drive, folder = paper_cases["CS-1"], tmp_path_factory.mktemp("headline")
    _, coefficients = coefficients_of(drive, "CS-1", folder / "coefficients", size=1.0)
    found = {}
    for steps in (0, 3, 10):
        full = next(solve_positions(drive, "CS-1", [steps * STEP], folder / "positions", SolutionOptions()))
        (position,) = compare_case(drive, full, coefficients)
        found[steps] = position.differences
    return found


def test_fe_is_as_near_as_the_headline_says(compared):
    for differences in compared.values():
        assert 100.0 * abs(differences["fe"].worst_load[2]) < 0.07 + ROOM
        assert abs(differences["fe"].wheel_angle) < 0.07 + ROOM
    assert 100.0 * abs(compared[3]["fe"].worst_load[2]) == pytest.approx(0.061, abs=ROOM)
    assert abs(compared[10]["fe"].wheel_angle) == pytest.approx(0.071, abs=ROOM)


def test_hybrid_is_as_near_as_the_headline_says(compared):
    kind, _, load = compared[3]["hybrid"].worst_load
    assert kind == "pin"
    assert 100.0 * load == pytest.approx(0.27, abs=ROOM)
    assert compared[0]["hybrid"].wheel_angle == pytest.approx(-0.63, abs=ROOM)
