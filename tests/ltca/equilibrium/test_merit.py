"""Every accepted step of the search leads downhill: the energy stored, less the work of the moment on the wheel, falls."""

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.members.temperatures import warm_drive
from ltca.equilibrium.newton import Search
from ltca.equilibrium.output_torque import solve_at_output
from ltca.geometry.coordinates import WHEEL_ANGLE
from ltca.mechanics.contacts import ContactSystem
from ltca.mechanics.energy import stored_by_disc, stored_by_pins
from ltca.reading.drive_file import load_drive
from ltca.testing.random_drives import COORDINATES, random_drive

SEEDS = (1, 2, 3, 4, 5, 6)
ANGLES = np.array([0.3, 2.1])
RING = {"ring.inner_radius": 88.0, "ring.outer_radius": 120.0, "ring.width": 30.0}
SLICES = {"contact.slices": 5, "disc.lead_slope": 1e-4}


def stored_at(model, angle, pose):
    """What contacts of every disc store, and what pins and supports do, N·mm."""
    at = ContactSystem(model).respond(angle, pose, None, roughly=False, everything=True)
    behind = stored_by_pins(at)
    if model.supports is not None:
        behind = behind + model.supports.energy(pose, None)
    return stored_by_disc(at), behind


def rise(model, angle, moment, pose, taken):
    """By how much Π rises from poses to others, N·mm, radii of curvature and flexibilities of bodies held, and Π itself."""
    (before, held), (after, displaced) = (stored_at(model, angle, each) for each in (pose, taken))
    found = displaced - held - moment * (taken - pose)[:, WHEEL_ANGLE]
    for one, other in zip(before, after, strict=True):
        found = found + other.energy - one.energy - sum(one.work_to(other))
    return found, held + sum(one.energy for one in before)


def prepared(name):
    """A drive, its model and crank angles: a shipped one, also on a ring or in slices, or a random one."""
    source, _, more = name.partition(", ")
    if source == "random":
        drive, angle = random_drive(np.random.default_rng(int(more)).random(COORDINATES))
        return drive, HalfSpace().prepare(drive).model, np.array([angle])
    drive = next(iter(load_drive(source).cases.values()))
    drive = warm_drive(drive.with_fields({"ring": RING, "slices": SLICES}.get(more, {})))
    return drive, HalfSpace().prepare(drive).model, ANGLES


NAMES = [
    "paper",
    "rv",
    "robot-joint",
    "sleeved",
    "paper, ring",
    "paper, slices",
    *(f"random, {seed}" for seed in SEEDS),
]


@pytest.mark.parametrize("name", NAMES)
def test_every_accepted_step_leads_downhill(name, monkeypatch):
    drive, model, angles = prepared(name)
    fell, walk = [], Search.walk

    def watched(self, rows, step, slope, start):
        pose = self.pose[rows].copy()
        found = walk(self, rows, step, slope, start)
        rose, stored = rise(model, self.angle[rows], self.moment[rows], pose, found[0])
        fell.append(-rose)
        # Round-off of energies and of places (1e-12 mm), and of slopes below what a step is judged by.
        noise = 1e-12 * stored + (1e-12 + 1e-9 * np.max(np.abs(step), axis=1)) * self.load[rows]
        assert np.all(rose <= noise)
        return found

    monkeypatch.setattr(Search, "walk", watched)
    solve_at_output(model, [drive], angles, drive.load.torque)
    assert len(fell) > 4
    assert max(np.max(each) for each in fell) > 0.0
