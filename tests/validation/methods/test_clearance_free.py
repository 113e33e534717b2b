"""The clearance-free linear system against the equilibrium by minimum potential: two formulations of one drive."""

import numpy as np
import pytest
from refusals import refused_field

from ltca.analysis.loaded_analysis import analyse
from ltca.errors import ConvergenceError
from ltca.reading.drive_file import parse_drive, shipped_drive
from validation.methods import clearance_free
from validation.methods.clearance_free import analyse_without_clearance

PAPER = parse_drive(shipped_drive()).cases
WITHOUT_OFFSETS = parse_drive(
    shipped_drive()
    .replace("equidistant_offset = 0.15", "equidistant_offset = 0.0")
    .replace("shifting_offset = 0.09", "shifting_offset = 0.0")
).cases["CS-1"]


def _differences(drive, angle, torque):
    linear = analyse_without_clearance(drive, angle, torque, cells=10)
    nonlinear = analyse(drive, np.array([angle]), torque).full.response
    pairs = [
        (linear.pin_load, nonlinear.pin_load[0]),
        (linear.roller_load, nonlinear.rollers.outer_load[0]),
        (linear.pin_shaft_load, nonlinear.hole_load[0]),
    ]
    return linear, np.array([np.max(np.abs(one - other)) / np.max(other) for one, other in pairs])


@pytest.mark.parametrize(
    "drive",
    [
        pytest.param(PAPER["CS-1"], id="paper", marks=pytest.mark.slow),
        pytest.param(WITHOUT_OFFSETS, id="no offsets", marks=[pytest.mark.slow, pytest.mark.nightly]),
    ],
)
def test_agreement_is_limited_by_linearisation_alone(drive):
    # Displacements of 20 µm on levers of 4 mm (pin holes) turn normals by 5 mrad: differences of half a per cent at
    # full load are of that order, and vanish with the load. Ten cells leave 1e-5 of the load.
    linear, full = _differences(drive, 0.3, 377_300.0)
    _, tenth = _differences(drive, 0.3, 37_730.0)
    assert np.all(full < 6e-3)
    assert np.all(tenth < 0.2 * full)
    assert linear.residual < 1e-9 * 6737.5


@pytest.mark.nightly
@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.0, 1.0, 2.0, 4.5])
def test_other_angles_of_the_paper_agree(angle):
    _, differences = _differences(PAPER["CS-1"], angle, 3_773.0)
    # A hundredth of the load: linearisation leaves 1e-4, the grids of lightly loaded rollers as much.
    assert np.all(differences < 3e-4)


@pytest.mark.nightly
@pytest.mark.slow
def test_reverse_direction_is_the_mirror_image():
    reverse = parse_drive(shipped_drive().replace('direction = "ccw"', 'direction = "cw"')).cases["CS-1"]
    forward = analyse_without_clearance(PAPER["CS-1"], 0.4, cells=8)
    mirrored = analyse_without_clearance(reverse, -0.4, cells=8)
    # Pin i mirrors to pin −i; round-off of the factorisation is far below 1e-6 N.
    np.testing.assert_allclose(mirrored.pin_load, np.roll(forward.pin_load[::-1], 1), atol=1e-6)
    np.testing.assert_allclose(mirrored.pin_shaft_load, np.roll(forward.pin_shaft_load[::-1], 1), atol=1e-6)


def test_drives_with_clearance_are_refused():
    with refused_field("clearance.bearing", "= 0.03 mm", bound=("equal to", 0.0)):
        analyse_without_clearance(PAPER["CS-3"], 0.0)


def test_cells_that_do_not_settle_are_counted(monkeypatch):
    """The history of the error is how many cells and holes changed, of all contacts together."""
    monkeypatch.setattr(clearance_free, "MAX_FACTORISATIONS", 1)
    system = clearance_free._System(PAPER["CS-1"], 0.3, -377_300.0, 6)
    cells, holes = [patch.carrying.copy() for patch in system.patches.values()], system.hole_carrying.copy()
    with pytest.raises(ConvergenceError, match="do not settle") as caught:
        system.solve()
    changed = [
        np.count_nonzero(one != patch.carrying) for one, patch in zip(cells, system.patches.values(), strict=True)
    ]
    assert np.count_nonzero(changed) > 3
    # one more where the first step was cut, as it says
    told = sum(changed) + np.count_nonzero(holes != system.hole_carrying)
    assert caught.value.history[0] - told in (0, 1)


def test_the_first_block_was_left_out_of_the_matrix():
    """Sparse libraries look at blocks before they use them: of a generator the first was gone, an empty one without notice."""
    generator = np.random.default_rng(5)
    blocks = [matrix @ matrix.T + np.eye(len(matrix)) for matrix in (generator.normal(size=(n, n)) for n in (3, 0, 2))]
    coupling, springs = generator.normal(size=(5, 2)), np.eye(2)
    whole = np.zeros((7, 7))
    whole[:3, :3], whole[3:5, 3:5] = blocks[0], blocks[2]
    whole[:5, 5:], whole[5:, :5], whole[5:, 5:] = -coupling, -coupling.T, -springs
    right = np.arange(1.0, 8.0)
    found = clearance_free._factor(blocks, coupling, springs).solve(right)
    np.testing.assert_allclose(found, np.linalg.solve(whole, right), rtol=1e-10)
