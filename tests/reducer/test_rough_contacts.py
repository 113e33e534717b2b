"""Contacts in slices that a search is content with while it is on its way: what it may accept is what exact contacts give."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.compliance.response import Start
from ltca.equilibrium.newton import TOLERANCE
from ltca.equilibrium.output_torque import solve_at_output
from ltca.reading.drive_file import load_drive

ANGLES = np.linspace(0.0, 2.0, 8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fields"),
    [
        pytest.param("paper", {"disc.lead_slope": 3e-4, "disc.lead_crown_drop": 2e-3}, id="sloping and crowned"),
        pytest.param("robot-joint", {"pin_wheel.inclination.x": 2e-4}, id="two discs, inclined"),
    ],
)
def test_rough_contacts_that_tell_nothing_is_left_are_exact(name, fields):
    """Steps of all sizes from balanced poses, with the rough contacts of one as the start of the next.

    Forces, in N by the coordinates' own levers, differ by no more than what is told to be left, and where that is below what a
    balance accepts by no more than this.
    """
    drive = next(iter(load_drive(name).cases.values())).with_fields({"contact.slices": 5} | fields)
    model = HalfSpace().prepare(drive).model
    found = solve_at_output(model, [drive], ANGLES, drive.load.torque)
    random, load = np.random.default_rng(1), float(np.max(found.response.pin_load))
    rough = model.respond(ANGLES, found.pose)
    accepted = 0
    for size in (1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10):
        pose = found.pose * (1.0 + size * random.normal(size=found.pose.shape))
        rough = model.respond(ANGLES, pose, Start.after(rough), roughly=True)
        exact = model.respond(ANGLES, pose)
        forces = (0, 1)  # of the first disc, along x and y
        off = np.max(np.abs(rough.force - exact.force)[:, forces], axis=1)
        left = np.zeros(ANGLES.size) if rough.left is None else rough.left
        assert np.all(off <= np.maximum(left, TOLERANCE * load))
        accepted += np.count_nonzero(left <= TOLERANCE * load)
    assert 0 < accepted < 6 * ANGLES.size
