"""Forces and moments of the housing on the output."""

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.reactions import reaction_values
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

FORCE = {"load.external.0.force.x": 800.0, "load.external.0.force.y": -300.0}


@pytest.mark.parametrize("held", ["pin-shaft", "pin-wheel"])
@pytest.mark.parametrize("frame", ["housing", "output"])
def test_a_force_further_along_the_axis_adds_its_moment(held, frame):
    """z × F with the arm of 45 mm, turned with the output where the force turns with it; a rigid bearing moves nothing else."""
    drive = load_drive("paper").cases["CS-1"]
    drive = with_fields(drive, FORCE | {"installation.held": held, "load.external.0.frame": frame})
    angle = np.array([0.05, 2.1])
    far, near = (reaction_values(analyse(with_fields(drive, {"load.external.0.at.z": z}), angle)) for z in (60.0, 15.0))
    turn = angle / drive.reduction_ratio * (-1.0 if held == "pin-wheel" else 1.0)
    force = complex(800.0, -300.0) * np.exp(1j * (turn if frame == "output" else np.zeros(2)))
    expected = np.cross([0.0, 0.0, 45.0], np.stack([force.real, force.imag, np.zeros(2)], axis=1))
    for axis, name in enumerate("xy"):
        change = far[f"main_bearing_moment_{name}"] - near[f"main_bearing_moment_{name}"]
        np.testing.assert_allclose(change, -expected[:, axis], rtol=1e-9, atol=1e-9 * 45.0 * abs(force[0]))
        np.testing.assert_allclose(far[f"main_bearing_{name}"], near[f"main_bearing_{name}"], rtol=1e-9)


def test_a_flank_that_leans_the_other_way_turns_the_moment_round():
    """The mirror image in mid-width: forces stay, moments of contacts in slices turn round. They are a part of F L/2."""
    paper, angle = load_drive("paper").cases["CS-1"], np.array([0.05, 2.1])
    one, other = (
        reaction_values(analyse(with_fields(paper, {"contact.slices": 5, "disc.lead_slope": slope}), angle))
        for slope in (2e-4, -2e-4)
    )
    force = np.hypot(one["main_bearing_x"], one["main_bearing_y"]).max()
    arm = force * 0.5 * paper.disc.thickness
    largest = 0.0
    for name in "xy":
        np.testing.assert_allclose(one[f"main_bearing_{name}"], other[f"main_bearing_{name}"], atol=1e-6 * force)
        moment = one[f"main_bearing_moment_{name}"]
        np.testing.assert_allclose(moment, -other[f"main_bearing_moment_{name}"], atol=1e-6 * arm)
        largest = max(largest, float(np.abs(moment).max()))
    assert 1e-3 * arm < largest < arm
